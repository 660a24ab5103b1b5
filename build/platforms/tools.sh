# Sourced by platforms.sh and release.sh: names of platforms, tools, and how cargo is called for a platform.
# shellcheck shell=bash
# In: root, the repository.

target=${CARGO_TARGET_DIR:-$root/target}
work=$target/platforms
glibc=2.17
# The first macOS for Apple's own processors.
macos=11.0
pinned=(ziglang==0.17.0 cargo-zigbuild==0.24.0)
packer=zopfli==0.4.3
all=(x86_64-linux x86_64-windows aarch64-linux x86_64-darwin aarch64-darwin)

say() { printf '%s: %s\n' "$(basename "$0" .sh)" "$*" >&2; }

wrong() {
  say "$*"
  exit 2
}

# Sets `wanted` to the platforms of a list such as linux64,aarch64-darwin.
select_platforms() {
  local name
  wanted=()
  for name in $(tr ',' ' ' <<<"$1"); do
    case $name in
      linux64) wanted+=(x86_64-linux) ;;
      win64) wanted+=(x86_64-windows) ;;
      darwin64) wanted+=(x86_64-darwin aarch64-darwin) ;;
      *)
        [[ " ${all[*]} " = *" $name "* ]] || wrong "'$name' is none of: ${all[*]}, linux64, win64, darwin64"
        wanted+=("$name")
        ;;
    esac
  done
  [ ${#wanted[@]} -gt 0 ] || wrong "--only needs a list such as x86_64-linux,aarch64-darwin"
}

# The compiler's name of a platform.
triple() {
  case $1 in
    x86_64-linux) echo x86_64-unknown-linux-gnu ;;
    x86_64-windows) echo x86_64-pc-windows-gnu ;;
    aarch64-linux) echo aarch64-unknown-linux-gnu ;;
    x86_64-darwin) echo x86_64-apple-darwin ;;
    aarch64-darwin) echo aarch64-apple-darwin ;;
  esac
}

# Installs Debian packages, or says which are missing.
need() {
  [ $# -gt 0 ] || return 0
  if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
    say "missing; on Debian: apt-get install $*"
    exit 3
  fi
  say "installing $*"
  if ! { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@"; } >&2; then
    say "apt-get cannot install $*"
    exit 3
  fi
}

# The folder of a toolchain's standard library for a target, if it is there.
has_std() { compgen -G "$("$1" --print target-libdir --target "$2" 2>/dev/null)/libstd-*.rlib" >/dev/null; }
# The standard library's sources, from which cargo can build it for any target.
has_source() { [ -f "$("$1" --print sysroot)/lib/rustlib/src/rust/library/std/Cargo.toml" ]; }

# provide NOTE PACKAGES…: installs Python packages, and notes that in a file.
provide() {
  if ! "$work/tools/bin/pip" --disable-pip-version-check install --quiet --only-binary :all: "${@:2}" >&2; then
    say "pip cannot install ${*:2}"
    exit 3
  fi
  echo "${*:2}" >"$work/tools/$1"
}

# What is needed for the wanted platforms, in place.
prepare() {
  local packages=() flags name
  command -v cc >/dev/null || packages+=(gcc libc6-dev)
  command -v python3 >/dev/null || packages+=(python3)
  python3 -c 'import venv, ensurepip' 2>/dev/null || packages+=(python3-venv)
  if [[ " ${wanted[*]} " = *-windows* ]] && ! command -v x86_64-w64-mingw32-gcc >/dev/null; then
    packages+=(gcc-mingw-w64-x86-64)
  fi
  # Debian's newest Rust; its plain rustc is the one of the day when that Debian came out.
  command -v cargo >/dev/null || packages+=(rustc-web cargo-web)
  need "${packages[@]}"
  if [ "$(cat "$work/tools/pinned" 2>/dev/null)" != "${pinned[*]}" ]; then
    rm -rf "$work/tools"
    python3 -m venv "$work/tools"
    provide pinned "${pinned[@]}"
  fi
  if [ -n "${small:-}" ] && [ "$(cat "$work/tools/packer" 2>/dev/null)" != "$packer" ]; then
    provide packer "$packer"
  fi
  own=$(dirname "$(command -v cargo)")
  # As build.rs: no flag of this machine counts, and messages name no folder of it.
  for name in $(compgen -e | grep -E '^(CARGO_BUILD_|CARGO_PROFILE_|CARGO_TARGET_.*_RUSTFLAGS$|RUSTFLAGS$)' || true); do
    unset "$name"
  done
  flags=("--remap-path-prefix=$root=urdf2fmu" "--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo")
  if [ -n "${smallest:-}" ]; then
    # What each of these takes from a packed library, and what it costs, is in docs/platforms.md: what runs once is
    # compiled for size, loops are not made longer for counts that are known only when they run, jumps are joined rather
    # than copied, and checks that panic carry no place.
    flags+=(
      --cfg small
      "-Cllvm-args=-unroll-runtime=false -force-vector-interleave=1 -tail-dup-placement-aggressive-threshold=2"
      -Zlocation-detail=none
    )
  fi
  CARGO_ENCODED_RUSTFLAGS=$(IFS=$'\x1f' && echo "${flags[*]}")
  export CARGO_ENCODED_RUSTFLAGS
  export MACOSX_DEPLOYMENT_TARGET=$macos
}

# Rust for a target: rustup knows how; where it cannot reach its server, or there is none, Debian has the sources of the
# standard library. With `small` it is always built from them, without what prints backtraces: that is a tenth of a
# library, and nobody reads a backtrace without names. Sets `rust`, the folder of the cargo to use, and `build_std`, what
# that is told.
rust_for() {
  local name
  rust=$own
  build_std=()
  if [ -z "${small:-}" ]; then
    if ! has_std rustc "$1" && command -v rustup >/dev/null && [ -z "${deaf:-}" ]; then
      timeout 300 rustup target add "$1" >&2 || { deaf=yes && say "rustup cannot fetch $1"; }
    fi
    has_std rustc "$1" && return
  fi
  if ! has_source rustc; then
    has_source /usr/bin/rustc 2>/dev/null || need rustc-web cargo-web rust-web-src
    rust=/usr/bin
  fi
  build_std=(-Zbuild-std=std,panic_unwind -Zbuild-std-features=default)
  if [ -n "${smallest:-}" ]; then
    # Sorts above all: each kind of element has a copy of them.
    build_std[1]+=,optimize_for_size
    for name in core alloc std serde_core; do
      build_std+=(--config "profile.release.package.$name.opt-level=\"s\"")
    done
  fi
}

# pack FILE OUTPUT: with `small` a file as a zip has it, in as few bytes as it takes; the command then packs it no more.
pack() {
  if [ -n "${small:-}" ]; then
    "$work/tools/bin/python" "$root/build/platforms/pack.py" "$work/packed" "$1" "$2"
    say "$2, $(stat -c %s "$2") bytes"
  else
    rm -f "$2"
  fi
}

# compile PLATFORM ARGUMENTS… -- LINK_ARGUMENTS…: `cargo rustc` for a platform. Sets `triple`, under which it works.
compile() {
  local platform=$1 arguments=() command=cargo-zigbuild name objcopy
  shift
  while [ "$1" != -- ]; do
    arguments+=("$1")
    shift
  done
  shift
  triple=$(triple "$platform")
  name=$triple
  rust_for "$triple"
  case $platform in
    *-linux) name=$triple.$glibc ;;
    *-windows)
      command=$rust/cargo
      # Without the time of day the same sources make the same file.
      set -- "$@" -Wl,--no-insert-timestamp
      ;;
    *-darwin)
      # rustc strips by it; rustup's toolchains bring it along. What links signs, and what strips signs anew.
      objcopy=$("$rust/rustc" --print sysroot)/lib/rustlib/$("$rust/rustc" -vV | sed -n 's/^host: //p')/bin/rust-objcopy
      if ! [ -x "$objcopy" ]; then
        [ -x /usr/lib/llvm-19/bin/llvm-objcopy ] || need llvm-19
        ln -sf /usr/lib/llvm-19/bin/llvm-objcopy "$work/tools/bin/rust-objcopy"
      fi
      ;;
  esac
  say "$platform, by $("$rust/rustc" --version) ${build_std[*]}"
  PATH=$work/tools/bin:$rust:$PATH RUSTC_BOOTSTRAP=${build_std[*]:+1} "$command" rustc --locked --release \
    "${arguments[@]}" --target-dir "$work" "${build_std[@]}" --target "$name" -- "${@/#/-Clink-arg=}"
}
