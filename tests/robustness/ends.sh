#!/usr/bin/env bash
# The ends of runs, with the built program: killed at random instants, with a full disk, with little memory. Nothing may be half-written or left behind, an error is one
# line, and no run crashes or hangs. Prints one line for each part and each finding; exit 1 where there are findings.
#   tests/robustness/ends.sh [--kills N] [--disks N] [--memory] [--program build/stackmesh] [--input FILE]...
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
kills=0 disks=0 memory=0 program=$PWD/build/stackmesh inputs=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --kills) kills=$2; shift ;;
    --disks) disks=$2; shift ;;
    --memory) memory=1 ;;
    --program) program=$(realpath "$2"); shift ;;
    --input) inputs+=("$(realpath "$2")"); shift ;;
    *) sed -n '2,4p' "$0" >&2; exit 2 ;;
  esac
  shift
done
[[ -x $program ]] || { echo "ends.sh: error: there is no program $program; build it first" >&2; exit 2; }
work=$(mktemp -d)
mounted=()
trap 'for m in "${mounted[@]}"; do umount "$m" 2>/dev/null; done; rm -rf "$work"' EXIT
findings=0
finding() { echo "  FINDING: $*"; findings=$((findings + 1)); }
outputs=(-o a.vtu -o a.stl -o a.msh -o a.inp --report a.json --report a.html)
names="a.html a.inp a.json a.msh a.stl a.vtu"

# A small input that takes about a second, so that kills fall into every stage.
python3 - "$work/blobs.nrrd" <<'P'
import sys
n, m = 44, 24
with open(sys.argv[1], "wb") as f:
    f.write(b"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: %d %d %d\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\nspace origin: (0,0,0)\nencoding: raw\n\n" % (n, n, m))
    f.write(bytes(1 if (x - 15) ** 2 + (y - 20) ** 2 + 2 * (z - 12) ** 2 < 150 else 2 if (x - 28) ** 2 + (y - 22) ** 2 + 2 * (z - 11) ** 2 < 170 else 0
                  for z in range(m) for y in range(n) for x in range(n)))
P

# What a folder may hold: nothing, or every output as a whole run writes it. `a.json` and `a.html` tell times, so only their ends are looked at.
check_folder() { # check_folder FOLDER WHAT
  local there
  there=$(cd "$1" && ls -A | grep -v '\.part' | sort | tr '\n' ' ' | sed 's/ $//')
  if [[ -n $there && $there != "$names" ]]; then
    for f in $there; do [[ " $names " == *" $f "* ]] || finding "$2: unknown file $f"; done
  fi
  for f in a.vtu a.stl a.msh a.inp; do
    [[ ! -e $1/$f ]] || cmp -s "$1/$f" "$work/whole/$f" || finding "$2: $f is not what a whole run writes"
  done
  [[ ! -e $1/a.json ]] || python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$1/a.json" 2>/dev/null || finding "$2: a.json is no JSON"
  [[ ! -e $1/a.html ]] || tail -c 20 "$1/a.html" | grep -q '</html>' || finding "$2: a.html has no end"
}

if [[ $kills -gt 0 || $disks -gt 0 ]]; then
  mkdir "$work/whole"
  start=$(date +%s%N)
  (cd "$work/whole" && "$program" mesh "$work/blobs.nrrd" "${outputs[@]}" --quiet) || { echo "ends.sh: error: the input is not meshed" >&2; exit 1; }
  took_ms=$((($(date +%s%N) - start) / 1000000))
  bytes=$(cat "$work"/whole/* | wc -c)
fi

if [[ $kills -gt 0 ]]; then
  before=$findings whole=0 none=0 some=0
  RANDOM=18
  for ((i = 0; i < kills; ++i)); do
    mkdir "$work/k"
    (cd "$work/k" && exec "$program" mesh "$work/blobs.nrrd" "${outputs[@]}" --quiet 2>/dev/null) &
    pid=$!
    if ((i % 2 == 0)); then # any instant
      sleep "$(awk -v r=$RANDOM -v t=$took_ms 'BEGIN { printf "%.3f", 1.15 * t / 1000 * r / 32768 }')"
    else # while files are written and put in their places
      for ((w = 0; w < 3000; ++w)); do
        compgen -G "$work/k/*.part*" >/dev/null && break
        kill -0 $pid 2>/dev/null || break
        sleep 0.003
      done
      sleep "$(awk -v r=$RANDOM 'BEGIN { printf "%.3f", 0.12 * r / 32768 }')"
    fi
    kill -KILL $pid 2>/dev/null
    wait $pid 2>/dev/null
    check_folder "$work/k" "kill $i"
    count=$(ls -A "$work/k" | grep -vc '\.part')
    case $count in 0) none=$((none + 1)) ;; 6) whole=$((whole + 1)) ;; *) some=$((some + 1)) ;; esac
    # The next run takes away what is left of the killed one, and gives all outputs.
    if ls -A "$work/k" | grep -q '\.part'; then
      (cd "$work/k" && "$program" mesh "$work/blobs.nrrd" "${outputs[@]}" --quiet 2>/dev/null) || finding "kill $i: the next run fails"
      ls -A "$work/k" | grep -q '\.part' && finding "kill $i: the next run leaves .part files"
      check_folder "$work/k" "after kill $i"
    fi
    rm -rf "$work/k"
  done
  sleep 1
  pgrep -P 1 -f "stackmesh-tetgen --tetgen-worker" >/dev/null && finding "a worker outlives its parent"
  echo "kills: $kills at random instants of a run of $took_ms ms, every other one from the first byte written on: $none left nothing, $whole all 6 outputs, $some some outputs, each whole; $((findings - before)) findings"
fi

if [[ $disks -gt 0 ]]; then
  before=$findings full=0 fit=0
  how="tmpfs"
  mkdir "$work/d"
  if ! mount -t tmpfs -o size=64k tmpfs "$work/d" 2>/dev/null; then how="RLIMIT_FSIZE (no tmpfs may be mounted here)"; else umount "$work/d"; fi
  for ((i = 1; i <= disks; ++i)); do
    kb=$(((bytes / 1024 + 64) * i * 11 / (disks * 10) + 4))
    status=0
    if [[ $how == tmpfs ]]; then
      mount -t tmpfs -o size=${kb}k tmpfs "$work/d" || { finding "tmpfs of $kb kB cannot be mounted"; continue; }
      mounted=("$work/d")
      (cd "$work/d" && timeout 120 "$program" mesh "$work/blobs.nrrd" "${outputs[@]}" --quiet 2>"$work/err") || status=$?
    else
      (cd "$work/d" && ulimit -f "$kb" && timeout 120 "$program" mesh "$work/blobs.nrrd" "${outputs[@]}" --quiet 2>"$work/err") || status=$?
    fi
    there=$(ls -A "$work/d" | wc -l) lines=$(wc -l <"$work/err")
    if [[ $status -eq 0 ]]; then
      fit=$((fit + 1))
      check_folder "$work/d" "disk of $kb kB"
      [[ $there -eq 6 ]] || finding "disk of $kb kB: exit 0 with $there files"
    else
      full=$((full + 1))
      [[ $status -eq 5 ]] || finding "disk of $kb kB: exit $status, not 5: $(head -c 200 "$work/err")"
      [[ $lines -eq 1 ]] && grep -q '^stackmesh: error: .*; ' "$work/err" || finding "disk of $kb kB: not one line but: $(head -c 300 "$work/err" | tr '\n' '|')"
      [[ $there -eq 0 ]] || finding "disk of $kb kB: leaves $(ls -A "$work/d" | tr '\n' ' ')"
    fi
    if [[ $how == tmpfs ]]; then umount "$work/d"; mounted=(); else rm -f "$work"/d/*; fi
  done
  status=0
  (cd "$work/d" && "$program" info "$work/blobs.nrrd" >/dev/full 2>"$work/err") || status=$?
  [[ $status -eq 5 && $(wc -l <"$work/err") -eq 1 ]] || finding "info to /dev/full: exit $status, $(head -c 200 "$work/err")"
  echo "disks: $disks sizes up to 110 % of what is written ($((bytes / 1024)) kB), by $how, and /dev/full: $full exit 5 in one line with nothing left, $fit whole; $((findings - before)) findings"
fi

if [[ $memory -gt 0 ]]; then
  before=$findings
  mkdir -p "$work/m"
  [[ ${#inputs[@]} -gt 0 ]] || inputs=("$work/blobs.nrrd")
  for input in "${inputs[@]}"; do
    for mb in 256 512 1024 2048 4096; do
      for how in bound limit; do # our own bound, and the kernel's
        status=0 start=$SECONDS
        if [[ $how == bound ]]; then
          (cd "$work/m" && timeout 600 "$program" mesh "$input" -o a.vtu -o a.stl --max-memory ${mb}MB --quiet 2>"$work/err") || status=$?
        else
          (cd "$work/m" && ulimit -v $((mb * 1024)) && timeout 600 "$program" mesh "$input" -o a.vtu -o a.stl --quiet 2>"$work/err") || status=$?
        fi
        there=$(ls -A "$work/m" | tr '\n' ' ')
        echo "  $(basename "$input"), $mb MB, $([[ $how == bound ]] && echo --max-memory || echo ulimit -v): exit $status, $((SECONDS - start)) s: $(grep -a error "$work/err" | head -c 160)"
        case $status in
          0) [[ $there == "a.stl a.vtu " ]] || finding "exit 0 with '$there'" ;;
          4) [[ -z $there ]] || finding "leaves $there"
             [[ $(grep -ac 'stackmesh: error: ' "$work/err") -eq 1 ]] || finding "not one error line: $(head -c 300 "$work/err" | tr '\n' '|')" ;;
          *) finding "exit $status: $(head -c 300 "$work/err" | tr '\n' '|')" ;;
        esac
        rm -f "$work"/m/*
        [[ $how == bound && $status -eq 124 ]] && break
      done
    done
  done
  echo "memory: 256 MB to 4 GB, ${#inputs[@]} inputs: $((findings - before)) findings"
fi
[[ $findings -eq 0 ]]
