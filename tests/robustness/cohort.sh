#!/usr/bin/env bash
# A cohort of 200 small cases, some broken on purpose: undisturbed, against plain calls, with the runner killed at random instants, and through Slurm.
# Prints a line for each part and each finding, and a table in the end; exit 1 where there are findings.
#   tests/robustness/cohort.sh [--cases N] [--kills N] [--program build/stackmesh] [--keep FOLDER] [--parts run,plain,kills,slurm,overhead]
# What is in the folder that is kept is not made again: the parts can be run one by one.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cases=200 kills=20 program=$PWD/build/stackmesh work='' parts=run,plain,kills,slurm,overhead
while [[ $# -gt 0 ]]; do
  case $1 in
    --cases) cases=$2; shift ;;
    --kills) kills=$2; shift ;;
    --program) program=$(realpath "$2"); shift ;;
    --keep) mkdir -p "$2"; work=$(realpath "$2"); shift ;;
    --parts) parts=$2; shift ;;
    *) sed -n '2,5p' "$0" >&2; exit 2 ;;
  esac
  shift
done
[[ -x $program ]] || { echo "cohort.sh: error: there is no program $program; build it first" >&2; exit 2; }
here=$PWD/tests/robustness
if [[ -z $work ]]; then work=$(mktemp -d); trap 'bash tests/support/small_slurm.sh stop "$work/slurmd" 2>/dev/null; rm -rf "$work"' EXIT; fi
findings=0
finding() { echo "  FINDING: $*"; findings=$((findings + 1)); }
wants() { [[ ,$parts, == *,$1,* ]]; }
table=()
row() { table+=("$(printf '%-62s %s' "$1" "$2")"); echo "$1: $2"; }
limits=(--timeout 300 --case-memory 500MB)
check() { /usr/bin/python3 "$here/check_cohort.py" "$@"; }

[[ -s $work/cases.csv ]] || /usr/bin/python3 "$here/make_cohort.py" "$work" --cases "$cases" || exit 2
cd "$work"

if wants run; then
  rm -rf run
  start=$SECONDS
  "$program" batch cases.csv -o run "${limits[@]}" -- --threads 1 >run.log 2>run.err
  row "exit code of the undisturbed run (4: some failed)" $?
  row "its wall time, s" $((SECONDS - start))
  check expected expected.tsv run || finding "the undisturbed run is not as expected"
  row "cases as expected (done and verified, or failed with the reason)" "$(check expected expected.tsv run | tail -1)"
  start=$(date +%s%N)
  "$program" batch cases.csv -o run "${limits[@]}" --no-page -- --threads 1 >again.log 2>&1
  row "the same command again" "$((($(date +%s%N) - start) / 1000000)) ms, $(check twice run)"
fi

if wants plain; then
  # Each good case by the plain command, a few at once; the same bytes.
  mkdir -p plain
  "$program" batch cases.csv -o none --dry-run --json -- --threads 1 >plan.json
  check plain plan.json expected.tsv "$program" plain run || finding "the plain command gives other bytes"
  row "meshes that are the same bytes as those of the plain command" "$(check plain plan.json expected.tsv "$program" plain run | tail -1)"
fi

if wants kills; then
  rm -rf killed
  done_kills=0
  for ((k = 1; k <= kills; ++k)); do
    "$program" batch cases.csv -o killed "${limits[@]}" --no-page -- --threads 1 >>kills.log 2>&1 &
    runner=$!
    # A random instant of what is left; children have to go with the runner.
    sleep "$(awk -v s=$((k * 7919 + 13)) -v k="$k" 'BEGIN { srand(s); print 0.2 + rand() * '"${STACKMESH_KILL_SPAN:-8}"' }')"
    if kill -9 "$runner" 2>/dev/null; then done_kills=$((done_kills + 1)); fi
    wait "$runner" 2>/dev/null
    sleep 0.3
    left=$(pgrep -f "$work/killed\|-o killed/\." | wc -l)
    [[ $left -eq 0 ]] || finding "$left processes go on after the runner was killed ($k)"
  done
  "$program" batch cases.csv -o killed "${limits[@]}" -- --threads 1 >>kills.log 2>&1
  row "runner killed with -9" "$done_kills times"
  row "cases done more than once, and lost" "$(check twice killed)"
  check same run killed || finding "the disturbed run gives other results"
  row "results that are the same bytes as undisturbed" "$(check same run killed | tail -1)"
  row "hidden folders left" "$(find killed -maxdepth 1 -name '.*.work-*' | wc -l)"
fi

if wants slurm; then
  rm -rf slurm slurmd
  bash "$here/../support/small_slurm.sh" start slurmd
  started=$?
  if [[ $started -eq 77 ]]; then
    row "through Slurm" "SKIPPED"
  elif [[ $started -ne 0 ]]; then
    finding "Slurm does not start"
  else
    export SLURM_CONF=$work/slurmd/slurm.conf
    start=$SECONDS
    "$program" batch cases.csv -o slurm "${limits[@]}" --slurm "--nice=0" -- --threads 1 | tee submit.log
    node=$(hostname -s)
    while [[ $(find slurm -maxdepth 2 -name done | wc -l) -lt $((cases / 5)) ]]; do sleep 1; done
    before=$(find slurm -maxdepth 2 -name done | wc -l)
    scontrol update "nodename=$node" state=down reason=test
    sleep 3
    "$program" batch --status -o slurm | head -4
    scontrol update "nodename=$node" state=resume
    row "node set down and up again after" "$before cases"
    while squeue -h -t PENDING,RUNNING,COMPLETING | grep -q .; do sleep 2; done
    "$program" batch --status -o slurm | head -1
    row "through Slurm, s" $((SECONDS - start))
    row "tasks that Slurm requeued" "$(grep -c 'requeue' slurmd/slurmctld.log)"
    check expected expected.tsv slurm || finding "the run through Slurm is not as expected"
    row "cases as expected" "$(check expected expected.tsv slurm | tail -1)"
    check same run slurm || finding "the run through Slurm gives other results"
    row "results that are the same bytes as those made here" "$(check same run slurm | tail -1)"
    row "cases done more than once, and lost" "$(check twice slurm)"
    "$program" collect slurm >/dev/null 2>&1
    row "exit code of collect (4: some failed)" $?
  fi
  bash "$here/../support/small_slurm.sh" stop slurmd
fi

if wants overhead; then
  [[ -s plan.json ]] || "$program" batch cases.csv -o none --dry-run --json -- --threads 1 >plan.json
  check overhead plan.json expected.tsv "$program" cases.csv >overhead.log || finding "the overhead was not measured"
  while IFS=$'\t' read -r what figure; do row "$what" "$figure"; done <overhead.log
fi

echo
printf '%s\n' "${table[@]}"
echo "$findings findings"
[[ $findings -eq 0 ]]
