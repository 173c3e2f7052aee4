#!/usr/bin/env bash
# Installs what the build and the tests need, builds, runs every test.
# The last line is 'N passed, N failed, N skipped'; the exit code is 0 only when tests ran and none failed.
#   tests/run.sh [CTEST ARGUMENTS...]      for example: tests/run.sh -R Contour
#   tests/run.sh --fuzz SECONDS [READER...]      fuzzes the readers in place of it (clang); findings are in build-fuzz/found
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [[ ${1:-} == --fuzz ]]; then
  shift
  exec bash tests/fuzz/run.sh "$@"
fi

step() { # step NAME COMMAND...: runs it, says how long it took
  local name=$1 start=$SECONDS
  shift
  echo "== $name"
  "$@" || {
    echo "tests/run.sh: error: '$name' failed after $((SECONDS - start)) s; the lines above say why" >&2
    exit 1
  }
  echo "== $name: $((SECONDS - start)) s"
}

step "packages" bash apps/install-packages.sh --tests
# Said aloud, as the quickstart's build in the same folder turns them off.
step "configure" cmake --preset default -D STACKMESH_TESTS=ON -D STACKMESH_BENCHMARKS=ON
step "build" cmake --build --preset default --parallel "$(nproc)"

results=$PWD/build/test-results.xml
rm -f "$results"
start=$SECONDS
echo "== test"
status=0
ctest --preset default --no-tests=error --output-junit "$results" "$@" || status=$?
echo "== test: $((SECONDS - start)) s; all: $SECONDS s"

if [[ ! -s $results ]]; then
  echo "tests/run.sh: error: ctest stopped with status $status and left no results" >&2
  exit 1
fi
count() { grep -c "$1" "$results" || true; }
passed=$(count '<testcase .*status="run"')
# Tests that chose to skip; any other 'notrun' (a missing program, a failed fixture) is a failure, as for ctest.
chose=$(count '<skipped message="SKIP_')
skipped=$((chose + $(count '<testcase .*status="disabled"')))
failed=$(($(count '<testcase .*status="fail"') + $(count '<testcase .*status="notrun"') - chose))
if [[ $status -eq 0 && ($failed -gt 0 || $((passed + failed)) -eq 0) ]]; then
  status=1
fi
echo "$passed passed, $failed failed, $skipped skipped"
exit "$status"
