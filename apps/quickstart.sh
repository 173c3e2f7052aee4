#!/usr/bin/env bash
# From a fresh clone to a volume mesh: installs the packages, builds the program, meshes testdata/femur.nii.gz.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

step() { # step NAME COMMAND...: runs it, says how long it took
  local name=$1 start=$SECONDS
  shift
  echo "== $name"
  "$@" || {
    echo "quickstart: error: '$name' failed after $((SECONDS - start)) s; the lines above say why" >&2
    exit 1
  }
  echo "== $name: $((SECONDS - start)) s"
}

out=build/quickstart
step "packages" bash apps/install-packages.sh
step "configure" cmake --preset program
step "build" cmake --build --preset program --parallel "$(nproc)"
mkdir -p "$out"
rm -f "$out/femur.vtu" "$out/femur.stl" "$out/report.json"
step "mesh testdata/femur.nii.gz" build/stackmesh mesh testdata/femur.nii.gz \
  -o "$out/femur.vtu" -o "$out/femur.stl" --report "$out/report.json"

cat <<TEXT

Done in $SECONDS s. A femur, cortical bone (label 1) around its medullary canal (label 2), from label slices:
  $PWD/$out/femur.vtu    the tetrahedra; open with ParaView, colour by 'label', add a Clip to look inside
  $PWD/$out/femur.stl    the surface; any mesh viewer shows it
  $PWD/$out/report.json  what was checked: closure, intersections, volumes per label
Next: build/stackmesh mesh YOUR_LABELS.nii.gz -o OUT.vtu    (build/stackmesh --help says more)
TEXT
