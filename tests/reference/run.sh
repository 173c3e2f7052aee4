#!/usr/bin/env bash
# The reference of the public headers (Doxygen), with warnings as errors; every citation in the code resolves, and every entry of the bibliography is used.
#   tests/reference/run.sh BUILD
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf 'BIBINPUTS = .\nBSTINPUTS = .\nopenin_any = a\nopenout_any = a\n' >"$work/texmf.cnf"  # bibtex alone, without a TeX installation
TEXMFCNF=$work STACKMESH_BUILD=$(cd "$1" && pwd) STACKMESH_SOURCE=$source doxygen "$source/docs/Doxyfile"
keys=$(sed -n 's/^@[a-z]*{\([a-z0-9]*\),.*/\1/p' "$source/docs/bibliography.bib")
[[ -n $keys ]] || { echo "run.sh: error: no entry was found in docs/bibliography.bib" >&2; exit 1; }
status=0
while read -r key; do
  grep -qx "$key" <<<"$keys" || { echo "run.sh: error: \\cite $key is not in docs/bibliography.bib" >&2; status=1; }
done < <(grep -rhoE '\\cite [a-z0-9]+' "$source/modules" "$source/apps" | sed 's/.* //' | sort -u)
for key in $keys; do
  grep -rqw --include='*.h' --include='*.cpp' --include='*.md' "$key" "$source/modules" "$source/docs" || { echo "run.sh: error: nothing refers to $key of docs/bibliography.bib" >&2; status=1; }
done
cmp -s <(python3 "$source/apps/draw_modules.py" -o /dev/stdout) "$source/docs/modules.svg" || { echo "run.sh: error: docs/modules.svg is older than the modules: run apps/draw_modules.py" >&2; status=1; }
exit $status
