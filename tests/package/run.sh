#!/usr/bin/env bash
# Installs the build beside itself and builds throw-away projects against the installed package, by CMake and by pkg-config.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$work/installed"  # it may be moved
if grep -rn "$work/first\|/usr/lib\|/usr/include" "$work/installed"/lib*/cmake/stackmesh/*Targets*.cmake "$work/installed"/lib*/*/cmake/stackmesh/*Targets*.cmake 2>/dev/null; then
  echo "run.sh: error: the export holds absolute paths" >&2
  exit 1
fi
# The page shows these very programs.
for example in labels drawn; do
  python3 - "$here/$example.cpp" "$here/../../docs/library.md" <<'PY' || exit 1
import sys
if open(sys.argv[1]).read() not in open(sys.argv[2]).read(): sys.exit(f"run.sh: error: docs/library.md does not show {sys.argv[1]}")
PY
done
# Neither ITK nor DCMTK is touched by component core.
cmake -S "$here" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/installed" \
  -DCMAKE_DISABLE_FIND_PACKAGE_ITK=ON -DCMAKE_DISABLE_FIND_PACKAGE_DCMTK=ON >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake --build "$work/build" >>"$work/log" 2>&1 || { tail -40 "$work/log"; exit 1; }
worker=$(find "$work/installed/libexec" -name stackmesh-tetgen)
STACKMESH_WORKER=$worker "$work/build/labels"
"$work/build/drawn"
"$work/installed/bin/stackmesh" --version
# Every installed header compiles on its own.
find "$work/installed/include" -name '*.h' | sort | sed 's/.*/#include "&"/' | while read -r line; do echo "$line"; done >"$work/all.cpp"
g++ -std=c++17 -fsyntax-only -I "$work/installed/include" "$work/all.cpp"
pc=$(dirname "$(find "$work/installed" -name stackmesh.pc)")
sed -i "s#^prefix=.*#prefix=$work/installed#" "$pc/stackmesh.pc"
PKG_CONFIG_PATH=$pc g++ -std=c++17 "$here/drawn.cpp" -o "$work/by_pkg_config" $(PKG_CONFIG_PATH=$pc pkg-config --cflags --libs stackmesh)
"$work/by_pkg_config"
