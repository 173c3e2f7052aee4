#!/usr/bin/env bash
# What autopkgtest would do: uses the installed package python3-stackmesh (and, where they are there, stackmesh's program) on an example.
#   try_installed.sh FOLDER WITH femur.nii.gz
set -euo pipefail
data=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"  # no source tree is near
cat >ten_lines.py <<'PYTHON'
import sys
import numpy as np
import stackmesh
femur = stackmesh.mesh(sys.argv[1])
femur.save("femur_py.vtu")
i, j, k = np.ogrid[:30, :30, :20]
labels = ((i - 14.5) ** 2 + (j - 14.5) ** 2 < 100) * (1 + (k > 9)).astype(np.int16)
pipe = stackmesh.mesh(labels, affine=np.diag([-1.0, -1.0, 2.0, 1.0]))
pipe.save("pipe_py.inp")
with open("pipe.nrrd", "wb") as f:  # the same array, for the command line
    f.write(b"NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 30 30 20\nspace directions: (1,0,0) (0,1,0) (0,0,2)\n"
            b"kinds: domain domain domain\nendian: little\nencoding: raw\nspace origin: (0,0,0)\n\n" + labels.astype("<i2").tobytes(order="F"))
print(stackmesh.__file__, femur, pipe, stackmesh._stackmesh.worker(), sep="\n")
PYTHON
python3 ten_lines.py "$data/femur.nii.gz"
[[ $(python3 -c 'import stackmesh; print(stackmesh.__file__)') == /usr/lib/python3/dist-packages/stackmesh/__init__.py ]]
sha256sum femur_py.vtu pipe_py.inp
if command -v stackmesh >/dev/null; then
  stackmesh mesh "$data/femur.nii.gz" -o femur_cli.vtu --quiet
  cmp femur_py.vtu femur_cli.vtu
  stackmesh mesh pipe.nrrd -o pipe_cli.inp --quiet
  cmp <(sed s/pipe_py/pipe_cli/ pipe_py.inp) pipe_cli.inp
  echo "same bytes as the installed program"
fi
echo "try_installed.sh: passed"
