#!/usr/bin/env bash
# Fuzzes every reader, and the pipeline behind them, for so many seconds each, from a corpus made of the tests' own inputs; what is found stays in build-fuzz/found.
#   tests/fuzz/run.sh SECONDS [TARGET...]      targets: volumes slices dicom contours meshes tables pipeline
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:?usage: tests/fuzz/run.sh SECONDS [TARGET...]}
shift
readers=("$@")
[[ ${#readers[@]} -gt 0 ]] || readers=(volumes slices dicom contours meshes tables pipeline)
cmake --preset fuzz >/dev/null
cmake --build build-fuzz --parallel "${STACKMESH_JOBS:-$(nproc)}" --target "${readers[@]/#/fuzz_}"
mkdir -p build-fuzz/found

# The first byte of an input chooses among the endings that tests/fuzz/CMakeLists.txt lists for the reader.
seed() { # seed READER ENDING NUMBER
  local file
  mkdir -p "build-fuzz/corpus/$1"
  while IFS= read -r file; do
    { printf "\\x$(printf %02x "$3")"; cat "$file"; } >"build-fuzz/corpus/$1/$(basename "$file").$3"
  done < <(find testdata tests ${STACKMESH_FUZZ_SEEDS:-} -type f -iname "*$2" -size -200k)
}
seed_all() { # seed_all READER ENDING...
  local reader=$1 number=0 ending
  shift
  for ending in "$@"; do
    seed "$reader" "$ending" "$number"
    number=$((number + 1))
  done
}
seed_all volumes .nii .nii.gz .nrrd .nhdr .mha .mhd .gipl .gipl.gz
seed_all slices .png .tif
seed_all dicom .dcm .dcm
seed_all contours .cnt
seed_all meshes .stl .ply .obj .off .vtp .vtk .vtu .msh .inp .mesh
seed_all tables .json
python3 tests/fuzz/make_seeds.py build-fuzz/corpus
mkdir -p build-fuzz/corpus/pipeline
cp tests/fuzz/stacks/* build-fuzz/corpus/pipeline  # read by tests/enhance, too

status=0
for reader in "${readers[@]}"; do
  mkdir -p "build-fuzz/corpus/$reader"
  if [[ -z $(ls -A "build-fuzz/corpus/$reader") ]]; then
    echo "tests/fuzz/run.sh: error: no input of the tests seeds '$reader'" >&2
    exit 1
  fi
  echo "== $reader"
  ASAN_OPTIONS=allocator_may_return_null=0:detect_leaks=0:handle_abort=1 "build-fuzz/fuzz_$reader" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -malloc_limit_mb=1024 -max_len=300000 \
    -print_final_stats=1 -verbosity=0 -artifact_prefix="build-fuzz/found/$reader-" "build-fuzz/corpus/$reader" 2>"build-fuzz/found/$reader.log" || status=1
  grep -E "stat::number_of_executed_units|^SUMMARY|^artifact|Test unit written" "build-fuzz/found/$reader.log" || true
done
exit "$status"
