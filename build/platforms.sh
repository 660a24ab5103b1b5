#!/usr/bin/env bash
# Builds the FMU's library for several systems, on one Debian machine.
#
#     build/platforms.sh [--all | --only LIST] [--quick] [FOLDER]
#
# Without options for Linux and Windows on x86-64; with --all for 64-bit ARM Linux and both Macs, too, and smaller, with
# a standard library of their own (see build/platforms/tools.sh) and deflated by zopfli; --only takes names such as
# x86_64-linux,aarch64-darwin, or FMI 2's: linux64, win64, darwin64. With --quick that for Windows is optimised less,
# for tests: it is made in less time, is larger and slower, and gives the same bits. Writes
# FOLDER/<platform>/<library> (FOLDER: target/libraries). A command that packs them into FMUs is then built by
#
#     URDF2FMU_LIBRARY_DIR=$PWD/target/libraries cargo build --release
#
# Needs nothing but Debian's packages, PyPI and cargo's registry, and as root installs what is missing. What it cannot
# get is told: exit code 3. What the libraries need, and why so: docs/platforms.md.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=build/platforms/tools.sh
. "$root/build/platforms/tools.sh"
wanted=(x86_64-linux x86_64-windows)
universal=universal.dylib
folder=
quick=

while [ $# -gt 0 ]; do
  case $1 in
    --all)
      wanted=("${all[@]}")
      small=yes
      # For the library alone: sorts may put equal things in another order than in the command, which results of the
      # library do not depend on.
      smallest=yes
      ;;
    --only)
      select_platforms "${2:-}"
      shift
      ;;
    --quick) quick=yes ;;
    -*) wrong "there is no option '$1'; there are --all, --only LIST and --quick" ;;
    *) folder=$1 ;;
  esac
  shift
done
folder=${folder:-$target/libraries}
prepare

# Under FMI 2's names, of an earlier version of this script.
rm -rf "${folder:?}"/{linux64,win64}

for platform in "${wanted[@]}"; do
  faster=()
  case $platform in
    *-linux)
      unwinder=$work/unwinder-$platform.o
      "$work/tools/bin/python" -m ziglang cc -target "$platform-gnu.$glibc" -O2 -fPIC -Wall -Wextra -Werror \
        -c "$root/build/platforms/unwinder.c" -o "$unwinder"
      link=("$unwinder" -Wl,-Bsymbolic -Wl,-z,relro,-z,now)
      made=liburdf2fmu_fmi.so
      ;;
    *-windows)
      # Optimised as a whole all the same: else it needs bcryptprimitives.dll, which older versions of Wine lack, by
      # code that nothing calls, and a library for Linux libpthread.
      [ -z "$quick" ] || faster=(--config profile.release.opt-level=1)
      link=()
      made=urdf2fmu_fmi.dll
      ;;
    *-darwin)
      link=(-Wl,-install_name,@rpath/liburdf2fmu_fmi.dylib)
      made=liburdf2fmu_fmi.dylib
      ;;
  esac
  compile "$platform" --lib --crate-type cdylib --manifest-path "$root/fmi/Cargo.toml" "${faster[@]}" -- "${link[@]}"
  # One file a platform, and no other.
  rm -rf "${folder:?}/$platform"
  mkdir -p "$folder/$platform"
  cp "$work/$triple/release/$made" "$folder/$platform/"
  if [[ $platform = *-darwin ]]; then
    "$work/tools/bin/python" "$root/build/platforms/uuid.py" "$folder/$platform/$made"
  fi
  say "$folder/$platform/$made, $(stat -c %s "$folder/$platform/$made") bytes"
  pack "$folder/$platform/$made" "$folder/$platform/$made.deflate"
done
# Both Macs share a file in FMI 2.0.
macs=("$folder"/{x86_64,aarch64}-darwin/liburdf2fmu_fmi.dylib)
rm -f "$folder/$universal.deflate"
if [ -f "${macs[0]}" ] && [ -f "${macs[1]}" ] && [ -n "${small:-}" ]; then
  "$work/tools/bin/python" "$root/build/platforms/universal.py" "$work/$universal" "${macs[@]}"
  pack "$work/$universal" "$folder/$universal.deflate"
fi
pack "$root/build/page/dist/page.js" "$folder/page.js.deflate"
