#!/usr/bin/env bash
# Makes the Debian packages stackmesh, libstackmesh-dev and python3-stackmesh in build/packages, and asks lintian about them where it is installed.
#   apps/packages/make.sh [BUILD FOLDER]      default: build-packages
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build-packages}
for needed in dpkg-shlibdeps dpkg-deb cpack; do
  command -v "$needed" >/dev/null || { echo "make.sh: error: '$needed' is missing; install dpkg-dev and cmake" >&2; exit 1; }
done
# For the prefix /usr, so that the library knows where its worker is; without libraries that nothing uses, so that the packages ask for no more than they need.
as_needed=-Wl,--as-needed
cmake -S . -B "$build" -G Ninja -D CMAKE_BUILD_TYPE=Release -D CMAKE_INSTALL_PREFIX=/usr -D STACKMESH_TESTS=OFF -D STACKMESH_BENCHMARKS=OFF -D STACKMESH_PYTHON=ON \
  -D CMAKE_EXE_LINKER_FLAGS=$as_needed -D CMAKE_MODULE_LINKER_FLAGS=$as_needed
cmake --build "$build" --parallel "$(nproc)"
[[ -d $build/python/stackmesh ]] || { echo "make.sh: error: the Python module was not built; install python3-dev and pybind11-dev" >&2; exit 1; }
rm -f "$build"/packages/*.deb
(cd "$build" && cpack -G DEB)
mkdir -p build/packages
cp "$build"/packages/*.deb build/packages/
ls -l build/packages/*.deb
if command -v lintian >/dev/null; then
  status=0
  lintian --allow-root --fail-on error build/packages/*.deb || status=$?
  [[ $status -eq 0 ]] || { echo "make.sh: error: lintian found errors" >&2; exit "$status"; }
  echo "lintian: no errors"
else
  echo "lintian is not installed: the packages were not judged"
fi
