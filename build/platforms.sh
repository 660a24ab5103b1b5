#!/usr/bin/env bash
# Builds the FMU's library for Linux and for Windows, on one Debian machine: build/platforms.sh [FOLDER]
#
# Writes FOLDER/linux64/liburdf2fmu_fmi.so and FOLDER/win64/urdf2fmu_fmi.dll (FOLDER: target/libraries). A command
# that packs both into every FMU is then built by
#
#     URDF2FMU_LIBRARY_DIR=$PWD/target/libraries cargo build --release
#
# Needs nothing but Debian's packages, PyPI and cargo's registry, and as root installs what is missing. What it cannot
# get is told: exit code 3. What the libraries need, and why so: docs/platforms.md.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
folder=${1:-$target/libraries}
work=$target/platforms
linux=x86_64-unknown-linux-gnu
windows=x86_64-pc-windows-gnu
glibc=2.17
pinned=(ziglang==0.17.0 cargo-zigbuild==0.24.0)

say() { printf 'platforms: %s\n' "$*" >&2; }

# --- tools ---------------------------------------------------------------------------------------------------------

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

packages=()
command -v cc >/dev/null || packages+=(gcc libc6-dev)
command -v python3 >/dev/null || packages+=(python3)
python3 -c 'import venv, ensurepip' 2>/dev/null || packages+=(python3-venv)
command -v x86_64-w64-mingw32-gcc >/dev/null || packages+=(gcc-mingw-w64-x86-64)
# Debian's newest Rust; its plain rustc is the one of the day when that Debian came out.
command -v cargo >/dev/null || packages+=(rustc-web cargo-web)
need "${packages[@]}"

# Rust for Windows: rustup knows how; where it cannot reach its server, or there is none, Debian has the sources of the
# standard library. `windows_rust` is the folder of the cargo to use, `build_std` what it is told.
windows_rust=$(dirname "$(command -v cargo)")
build_std=()
if ! has_std rustc "$windows" && command -v rustup >/dev/null; then
  timeout 300 rustup target add "$windows" >&2 || say "rustup cannot fetch $windows"
fi
if ! has_std rustc "$windows"; then
  if ! has_source rustc; then
    has_source /usr/bin/rustc 2>/dev/null || need rustc-web cargo-web rust-web-src
    windows_rust=/usr/bin
  fi
  build_std=(-Zbuild-std=std,panic_unwind)
fi

if [ "$(cat "$work/tools/pinned" 2>/dev/null)" != "${pinned[*]}" ]; then
  rm -rf "$work/tools"
  python3 -m venv "$work/tools"
  if ! "$work/tools/bin/pip" --disable-pip-version-check install --quiet --only-binary :all: "${pinned[@]}" >&2; then
    say "pip cannot install ${pinned[*]}"
    exit 3
  fi
  echo "${pinned[*]}" >"$work/tools/pinned"
fi

# --- builds --------------------------------------------------------------------------------------------------------

# As build.rs: no flag of this machine counts, and messages name no folder of it.
for name in $(compgen -e | grep -E '^(CARGO_BUILD_|CARGO_PROFILE_|CARGO_TARGET_.*_RUSTFLAGS$|RUSTFLAGS$)' || true); do
  unset "$name"
done
flags=("--remap-path-prefix=$root=urdf2fmu" "--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo")
CARGO_ENCODED_RUSTFLAGS=$(IFS=$'\x1f' && echo "${flags[*]}")
export CARGO_ENCODED_RUSTFLAGS

common=(rustc --locked --release --lib --crate-type cdylib --manifest-path "$root/fmi/Cargo.toml" --target-dir "$work")

say "linux64, for glibc $glibc"
"$work/tools/bin/python" -m ziglang cc -target x86_64-linux-gnu.$glibc -O2 -fPIC -Wall -Wextra -Werror \
  -c "$root/build/platforms/unwinder.c" -o "$work/unwinder.o"
PATH=$work/tools/bin:$PATH cargo-zigbuild "${common[@]}" --target $linux.$glibc -- \
  -Clink-arg="$work/unwinder.o" -Clink-arg=-Wl,-Bsymbolic -Clink-arg=-Wl,-z,relro,-z,now

say "win64, by $("$windows_rust/rustc" --version) ${build_std[*]}"
PATH=$windows_rust:$PATH RUSTC_BOOTSTRAP=${build_std[*]:+1} "$windows_rust/cargo" "${common[@]}" \
  "${build_std[@]}" --target $windows -- -Clink-arg=-Wl,--no-insert-timestamp

# One file a platform, and no other.
put() {
  rm -rf "${folder:?}/$1"
  mkdir -p "$folder/$1"
  cp "$2" "$folder/$1/"
  say "$folder/$1/$(basename "$2"), $(stat -c %s "$2") bytes"
}
put linux64 "$work/$linux/release/liburdf2fmu_fmi.so"
put win64 "$work/$windows/release/urdf2fmu_fmi.dll"
