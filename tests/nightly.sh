#!/usr/bin/env bash
# What takes too long for every change: sanitized tests, many random stacks with enhancement, fuzzers, kills at random instants, full disks, little memory, a cohort. Each part can be
# shortened, and 0 leaves it out; the last lines are one table of what was run and what was found. Logs are in build/nightly.
#   tests/nightly.sh [--stacks N] [--fuzz SECONDS] [--kills N] [--disks N] [--memory 0|1] [--cohort N] [--sanitized REGEX|none] [--threads REGEX|none]
# Defaults: 100,000 stacks, 600 s for each fuzzer, 100 kills, 20 disks, memory with the shared lungs and skull where they are, a cohort of 200 cases, the whole suite under the address and
# undefined-behaviour sanitizers, what runs in parallel under the thread sanitizer. Ten minutes' try: --stacks 100 --fuzz 10 --kills 6 --disks 4 --memory 0 --cohort 0 --sanitized none --threads none
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
stacks=100000 fuzz=600 kills=100 disks=20 memory=1 cohort=200 sanitized=. threads='Parallel|SameBytes|WhateverTheThreadCount|AnyThreads|FillVolume'
while [[ $# -gt 0 ]]; do
  [[ $# -gt 1 ]] || { echo "tests/nightly.sh: error: $1 needs a value" >&2; exit 2; }
  case $1 in
    --stacks) stacks=$2 ;;
    --fuzz) fuzz=$2 ;;
    --kills) kills=$2 ;;
    --disks) disks=$2 ;;
    --memory) memory=$2 ;;
    --cohort) cohort=$2 ;;
    --sanitized) sanitized=$2 ;;
    --threads) threads=$2 ;;
    *) sed -n '2,7p' "$0" >&2; exit 2 ;;
  esac
  shift 2
done
jobs=${STACKMESH_JOBS:-$(nproc)}
logs=$PWD/build/nightly
mkdir -p "$logs"
rows=() status=0
part() { # part NAME HOW_MANY SUMMARY_PATTERN COMMAND...: runs it, keeps a row of the table
  local name=$1 many=$2 pattern=$3 start=$SECONDS result
  shift 3
  echo "== $name ($many)"
  if "$@" >"$logs/$name.log" 2>&1; then result="none"; else result="SEE $logs/$name.log"; status=1; fi
  local summary
  summary=$(grep -aE "$pattern" "$logs/$name.log" | tail -1 | cut -c1-110)
  rows+=("$(printf '| %-10s | %-14s | %6d s | %-32s | %s |' "$name" "$many" $((SECONDS - start)) "$result" "$summary")")
  echo "${rows[-1]}"
}

part build default 'Linking|no work' bash -c "cmake --preset default -D STACKMESH_TESTS=ON >/dev/null && cmake --build build --parallel $jobs"
[[ $status -eq 0 ]] || { echo "tests/nightly.sh: error: the build failed; $logs/build.log says why" >&2; exit 1; }
if [[ $stacks != 0 ]]; then
  part stitched "$stacks stacks" 'tests ran|OK \]' env STACKMESH_RANDOM_STACKS="$stacks" build/test_stitch --gtest_filter='RandomStacks.Are*'
  part enhanced "$stacks stacks" 'stacks from seed' env STACKMESH_RANDOM_STACKS="$stacks" build/test_enhance --gtest_filter='RandomStacksAtDefaults.*'
fi
[[ $fuzz == 0 ]] || part fuzzers "$fuzz s each" 'stat::number' bash tests/run.sh --fuzz "$fuzz"
[[ $kills == 0 ]] || part kills "$kills kills" '^kills:' bash tests/robustness/ends.sh --kills "$kills"
[[ $disks == 0 ]] || part disks "$disks sizes" '^disks:' bash tests/robustness/ends.sh --disks "$disks"
if [[ $memory != 0 ]]; then
  inputs=()
  for f in ../shared/data/lung_lr_cip/lungs_32sections_8p5mm.nii.gz ../shared/data/skull_ct_invesalius/bone_mask.nii.gz; do [[ ! -e $f ]] || inputs+=(--input "$f"); done
  part memory "5 bounds" '^memory:' bash tests/robustness/ends.sh --memory "${inputs[@]}"
fi
[[ $cohort == 0 ]] || part cohort "$cohort cases" 'findings' bash tests/robustness/cohort.sh --cases "$cohort"
sanitizer() { # sanitizer PRESET REGEX
  cmake --preset "$1" -D STACKMESH_TESTS=ON -D STACKMESH_BENCHMARKS=OFF && cmake --build --preset "$1" --parallel "$jobs" &&
    TSAN_OPTIONS="suppressions=$PWD/tests/robustness/threads.supp ignore_noninstrumented_modules=1" ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 \
      ctest --test-dir "build-$1" --no-tests=error --timeout 3600 --parallel "$jobs" --output-on-failure -R "$2"
}
[[ $sanitized == none ]] || part sanitized "$sanitized" 'tests passed|tests failed' sanitizer debug "$sanitized"
[[ $threads == none ]] || part threads "$threads" 'tests passed|tests failed' sanitizer threads "$threads"

printf '\n| %-10s | %-14s | %8s | %-32s | %s |\n|---|---|---|---|---|\n' part "how many" time findings "last line"
printf '%s\n' "${rows[@]}"
exit $status
