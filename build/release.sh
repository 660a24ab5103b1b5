#!/usr/bin/env bash
# Makes the files of a release, on one Debian machine: libraries for all platforms, and for each host that commands are
# wanted for an archive and a Python wheel, with checksums.
#
#     build/release.sh [--only LIST] [--again] [FOLDER]
#
# Hosts are x86_64-linux and x86_64-windows, or those of --only, as of build/platforms.sh. FOLDER is target/release-files.
# Every command carries the libraries of all five platforms. With --again all is built a second time, from nothing, and
# the files must be the same, byte by byte; it takes as long again.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=build/platforms/tools.sh
. "$root/build/platforms/tools.sh"
wanted=(x86_64-linux x86_64-windows)
small=yes
folder=
again=

while [ $# -gt 0 ]; do
  case $1 in
    --only)
      select_platforms "${2:-}"
      shift
      ;;
    --again) again=yes ;;
    -*) wrong "there is no option '$1'; there are --only LIST and --again" ;;
    *) folder=$1 ;;
  esac
  shift
done
folder=${folder:-$target/release-files}
version=$(sed -n '/^\[workspace.package\]/,/^version/s/^version = "\(.*\)"/\1/p' "$root/Cargo.toml")

"$root/build/platforms.sh" --all "$target/libraries"
prepare
export URDF2FMU_LIBRARY_DIR=$target/libraries

if ! "$work/tools/bin/python" -m hatchling version >/dev/null 2>&1; then
  "$work/tools/bin/pip" --disable-pip-version-check install --quiet --only-binary :all: hatchling==1.33.0 >&2 || {
    say "pip cannot install hatchling"
    exit 3
  }
fi

# What pip calls a host.
wheel() {
  case $1 in
    *-linux) echo "manylinux2014_${1%-linux}" ;;
    x86_64-windows) echo win_amd64 ;;
    x86_64-darwin) echo macosx_11_0_x86_64 ;;
    aarch64-darwin) echo macosx_11_0_arm64 ;;
  esac
}

rm -rf "${folder:?}"
mkdir -p "$folder"
for platform in "${wanted[@]}"; do
  compile "$platform" --bin urdf2fmu --manifest-path "$root/build/Cargo.toml" --
  binary=$work/$triple/release/urdf2fmu
  [[ $platform = *-windows ]] && binary+=.exe
  name=urdf2fmu-$version-$platform
  stage=$work/stage/$name
  rm -rf "$stage"
  mkdir -p "$stage"
  cp "$binary" "$root"/{README.md,CHANGELOG.md,LICENSE-MIT,LICENSE-APACHE} "$stage"
  cp -r "$root/examples" "$stage"
  # The same bytes for the same files: names sorted, no times, no users.
  find "$stage" -name __pycache__ -prune -exec rm -rf {} +
  chmod -R u=rwX,go=rX "$stage"
  tar --create --directory "$work/stage" --sort=name --format=ustar --owner=0 --group=0 --numeric-owner --mtime=@315532800 \
    "$name" | gzip --no-name --best >"$folder/$name.tar.gz"
  (cd "$root" && SOURCE_DATE_EPOCH=315532800 URDF2FMU_BINARY=$binary URDF2FMU_WHEEL=$(wheel "$platform") \
    "$work/tools/bin/python" -m hatchling build -t wheel -d "$folder" >&2)
done
for file in "$URDF2FMU_LIBRARY_DIR"/*/*.{so,dll,dylib}; do
  cp "$file" "$folder/library-$(basename "$(dirname "$file")").${file##*.}"
done
(cd "$folder" && sha256sum -- * >SHA256SUMS && cat SHA256SUMS)

if [ -n "$again" ]; then
  list=$(IFS=, && echo "${wanted[*]}")
  CARGO_TARGET_DIR=$target/again "$0" --only "$list" "$target/again/release-files" >/dev/null
  if ! diff "$folder/SHA256SUMS" "$target/again/release-files/SHA256SUMS"; then
    say "the second build differs from the first"
    exit 1
  fi
  say "the second build is the same, byte by byte"
  rm -rf "$target/again"
fi
