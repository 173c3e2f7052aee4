#!/usr/bin/python3
"""Measures surfaces from drawn contours against the TRUE surfaces that the contours were cut from, and writes a table.

  make_drawn.py                               the bones of foot, sacrum and femur heads, to the terminal
  make_drawn.py --docs                        the same into docs/interpolate.md, between its two marks
  make_drawn.py --before old/stackmesh        an older build beside the one at hand
  make_drawn.py --only Talus,femur_12         those alone

The cuts (.cnt) are plane sections of scanned bones whose surface is known (STL, PLY). `stackmesh surface` joins them with no
option, and once with --interpolate 0 --raw (the paper's direct stitch). Distances are measured both ways, from points
spread evenly over one surface to the nearest point of the other, between the first and the last section only: beyond them nothing was
drawn, and the flat ends are no bone. Mean and 95 % in mm. Needs Debian's python3-vtk9; data of --data, which are not part of
this project. The exit code is 1 when a bone has no result.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BONES = ([(n, f"foot_vhf/sections/{n}_142.cnt", f"foot_vhf/VHF_Left_{n}.stl")
          for n in ("Calcaneous", "Cuboid", "IntermediateCuneiform", "LateralCuneiform", "MedialCuneiform", "Navicular", "Phalanges", "Talus")]
         + [("Sacrum", "sacrum_vhf/sections/Sacrum_78.cnt", "sacrum_vhf/VHF_Left_Sacrum.stl")]
         + [(f"femur_{n}", f"femur_proximal/sections/femur_{n}_50.cnt", f"femur_proximal/femur_{n}.ply") for n in ("01", "05", "12")])
WAYS = (("no option", ()), ("direct", ("--interpolate", "0", "--raw")))
MARKS = ("<!-- drawn: made by apps/make_drawn.py -->", "<!-- end of drawn -->")
POINTS = 40000


def read_surface(path):
    import numpy as np
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    reader = {".stl": vtk.vtkSTLReader, ".ply": vtk.vtkPLYReader}[pathlib.Path(path).suffix]()
    reader.SetFileName(str(path))
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(reader.GetOutputPort())
    triangles.Update()
    data = triangles.GetOutput()
    if data.GetNumberOfPolys() == 0:
        sys.exit(f"no triangles in {path}")
    return data, vtk_to_numpy(data.GetPoints().GetData()).astype(float), vtk_to_numpy(data.GetPolys().GetData()).reshape(-1, 4)[:, 1:]


def spread(points, triangles, low, high):
    """Points spread evenly over a surface, those between two heights."""
    import numpy as np
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    random = np.random.default_rng(1)
    chosen = random.choice(len(triangles), POINTS, p=area / area.sum())
    u, v = random.random(POINTS), random.random(POINTS)
    over = u + v > 1
    u[over], v[over] = 1 - u[over], 1 - v[over]
    p = a[chosen] + u[:, None] * (b - a)[chosen] + v[:, None] * (c - a)[chosen]
    return p[(p[:, 2] > low) & (p[:, 2] < high)]


def distances(points, surface):
    import numpy as np
    import vtk
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    at, cell, sub, squared = [0.0, 0.0, 0.0], vtk.reference(0), vtk.reference(0), vtk.reference(0.0)
    out = np.empty(len(points))
    for i, p in enumerate(points):
        locator.FindClosestPoint(p, at, cell, sub, squared)
        out[i] = float(squared) ** 0.5
    return out.mean(), np.percentile(out, 95)


def heights(path):
    """First and last section that holds a contour."""
    found = []
    with open(path) as file:
        for line in file:
            words = line.split()
            if len(words) == 4 and words[0].lower() == "v" and int(words[1]) > 0:
                found.append(float(words[3]))
    return min(found), max(found)


def judge(program, cuts, options, truth, folder):
    mesh = os.path.join(folder, "a.ply")
    run = subprocess.run([program, "surface", cuts, *options, "--quiet", "-o", mesh], capture_output=True, text=True)
    if run.returncode != 0:
        print(run.stderr, file=sys.stderr)
        return None
    made = read_surface(mesh)
    low, high = heights(cuts)
    margin = 1e-3 * (high - low)  # the flat ends do not count
    low, high = low + margin, high - margin
    there, back = distances(spread(*truth[1:], low, high), made[0]), distances(spread(*made[1:], low, high), truth[0])
    os.remove(mesh)
    return there, back, len(made[2])


def cell(result):
    if result is None:
        return "**no result**"
    (mean, p95), (mean_back, p95_back), triangles = result
    return f"{mean:.3f}, {p95:.3f} / {mean_back:.3f}, {p95_back:.3f}; {triangles:,}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build" / "stackmesh"))
    parser.add_argument("--before", help="an older build of the program")
    parser.add_argument("--data", default=str(ROOT.parent / "shared" / "data"))
    parser.add_argument("--only", default="", help="names, with commas between")
    parser.add_argument("--docs", action="store_true", help="write the table into docs/interpolate.md")
    args = parser.parse_args()
    columns = [(name, args.program, options) for name, options in WAYS]
    if args.before:
        columns.insert(1, ("no option, before", args.before, ()))
    lines = ["| bone | sections mm apart | " + " | ".join(name for name, _, _ in columns) + " |", "|---|---:|" + "---:|" * len(columns)]
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        for name, cuts, surface in BONES:
            if args.only and name not in args.only.split(","):
                continue
            cuts, surface = os.path.join(args.data, cuts), os.path.join(args.data, surface)
            truth = read_surface(surface)
            low, high = heights(cuts)
            sections = sum(1 for line in open(cuts) if line.lower().startswith("v ") and line.split()[1] != "0")
            results = [judge(program, cuts, options, truth, folder) for _, program, options in columns]
            failed = failed or None in results
            lines.append(f"| {name} | {(high - low) / (sections - 1):.2f} | " + " | ".join(cell(r) for r in results) + " |")
            print(lines[-1], flush=True)
    if args.docs:
        page = ROOT / "docs" / "interpolate.md"
        text = page.read_text()
        begin, end = (text.index(mark) for mark in MARKS)
        page.write_text(text[:begin + len(MARKS[0])] + "\n" + "\n".join(lines) + "\n" + text[end:])
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
