#!/usr/bin/env bash
# Tests the libraries of all platforms: builds what has changed, installs what is missing (as root, on Debian), and runs
# every test of tests/platforms. What .ci/run leaves out are the libraries for 64-bit ARM Linux and for Macs.
set -euo pipefail
cd "$(dirname "$0")/../.."

missing=()
command -v wine64 >/dev/null || [ -x /usr/lib/wine/wine64 ] || missing+=(wine64)
command -v objdump >/dev/null || missing+=(binutils)
command -v qemu-aarch64 >/dev/null || missing+=(qemu-user)
command -v aarch64-linux-gnu-gcc >/dev/null || missing+=(gcc-aarch64-linux-gnu libc6-dev-arm64-cross)
command -v llvm-lipo >/dev/null || [ -x /usr/lib/llvm-19/bin/llvm-lipo ] || missing+=(llvm)
if [ ${#missing[@]} -gt 0 ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
fi
build/platforms.sh --all
# With CI=true a test that cannot run fails.
URDF2FMU_LIBRARY_DIR=${CARGO_TARGET_DIR:-$PWD/target}/libraries CI=true cargo test -p urdf2fmu --test platforms "$@"
