#!/usr/bin/env python3
"""Measures a surface of one label with VTK, and compares with the JSON report of `stackmesh validate`.

usage: judge_agreement.py SURFACE LABELS.nii[.gz] LABEL REPORT.json [--space lps|ras]

Compared to 1 %: Dice of voxel centres (vtkPolyDataToImageStencil), distances both ways (mean, 95 %; vtkStaticCellLocator against all
voxel faces), volume, distance outside the band (cells of the dual grid as VTK quads), wrong centres, bends, and the number of pairs of triangles that cross (VTK's triangle-triangle test for pairs that share nothing,
numpy for those that share a corner). Shares no code with stackmesh. Exit 0 agrees, 1 does not, 77 without VTK or nibabel.
"""
import argparse
import json
import sys

try:
    import nibabel
    import numpy as np
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-vtk9 and python3-nibabel")
    sys.exit(77)


def read_surface(path):
    reader = {"vtp": vtk.vtkXMLPolyDataReader, "vtk": vtk.vtkPolyDataReader, "stl": vtk.vtkSTLReader, "ply": vtk.vtkPLYReader}[path.rsplit(".", 1)[-1]]()
    reader.SetFileName(path)
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(reader.GetOutputPort())
    clean = vtk.vtkCleanPolyData()
    clean.SetInputConnection(triangles.GetOutputPort())
    clean.ToleranceIsAbsoluteOn()
    clean.SetAbsoluteTolerance(0)
    clean.Update()
    data = clean.GetOutput()
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float), vtk_to_numpy(data.GetPolys().GetData()).reshape(-1, 4)[:, 1:]


def poly_data(points, cells):
    data = vtk.vtkPolyData()
    p = vtk.vtkPoints()
    p.SetData(numpy_to_vtk(np.ascontiguousarray(points, float), deep=1))
    data.SetPoints(p)
    n = cells.shape[1]
    array = vtk.vtkCellArray()
    array.SetCells(len(cells), numpy_to_vtkIdTypeArray(np.hstack([np.full((len(cells), 1), n), cells]).astype(np.int64).ravel(), deep=1))
    data.SetPolys(array)
    return data


def distances(points, data):
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(data)
    locator.BuildLocator()
    closest, cell, sub, d2 = [0, 0, 0], vtk.reference(0), vtk.reference(0), vtk.reference(0.0)
    out = np.empty(len(points))
    for i, p in enumerate(points):
        locator.FindClosestPoint(p, closest, cell, sub, d2)
        out[i] = d2.get()
    return np.sqrt(out)


def face_quads(mask):
    """Corners (voxel index space) and normals' axes of the faces between the label and the rest."""
    quads, axes = [], []
    padded = np.pad(mask, 1)
    for axis in range(3):
        a = np.moveaxis(padded, axis, 0)
        where = np.argwhere(a[1:] != a[:-1])  # face between i and i + 1 of the padded grid
        centre = where.astype(float) - 1
        centre[:, 0] += 0.5
        u, v = np.array([0, 0.5, 0]), np.array([0, 0, 0.5])
        corners = np.stack([centre - u - v, centre + u - v, centre + u + v, centre - u + v], 1)
        corners = corners[:, :, np.argsort([axis] + [k for k in range(3) if k != axis])]
        quads.append(corners)
        axes += [axis] * len(corners)
    return np.concatenate(quads), np.array(axes)


def outside_band(points_index, mask, spacing):
    """Distances in mm from the cells between eight centres of which some, not all, are in the label."""
    padded = np.pad(mask, 1)
    n = sum(padded[i:padded.shape[0] - 1 + i, j:padded.shape[1] - 1 + j, k:padded.shape[2] - 1 + k].astype(int) for i in (0, 1) for j in (0, 1) for k in (0, 1))
    mixed = (n > 0) & (n < 8)  # [i, j, k] lies between the centres i - 1 and i
    at = np.floor(points_index).astype(int) + 1
    known = ((at >= 0) & (at < mixed.shape)).all(1)
    out = np.ones(len(points_index), bool)
    out[known] = ~mixed[tuple(at[known].T)]
    cells = np.argwhere(mixed) - 1.0
    corner = np.array([[c & 1, c >> 1 & 1, c >> 2] for c in range(8)], float)
    sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
    quads = np.concatenate([cells[:, None, :] + corner[side] for side in sides]) * spacing
    d = np.zeros(len(points_index))
    d[out] = distances(points_index[out] * spacing, poly_data(quads.reshape(-1, 3), np.arange(4 * len(quads)).reshape(-1, 4)))
    return d


def bends(points, triangles):
    """(mean angle between neighbours weighted by length, share above 40 degrees) over edges of two triangles."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    size = np.linalg.norm(normals, axis=1)
    normals /= np.where(size > 0, size, 1)[:, None]
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), 1)
    of = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort(edges.T)
    edges, of = edges[order], of[order]
    first = np.flatnonzero(np.r_[True, (edges[1:] != edges[:-1]).any(1)])
    two = first[np.diff(np.r_[first, len(edges)]) == 2]
    m, n = of[two], of[two + 1]
    good = (size[m] > 0) & (size[n] > 0)
    m, n, e = m[good], n[good], edges[two][good]
    bend = np.degrees(np.arccos(np.clip((normals[m] * normals[n]).sum(1), -1, 1)))
    return np.average(bend, weights=np.linalg.norm(points[e[:, 0]] - points[e[:, 1]], axis=1)), (bend > 40).mean()


def crossing_pairs(points, triangles):
    """Pairs of triangles that meet beyond what they share by index."""
    corners = points[triangles]
    low, high = corners.min(1), corners.max(1)
    order = np.argsort(low[:, 0])
    count, pairs = 0, []
    starts = low[order, 0]
    for k, i in enumerate(order):
        last = np.searchsorted(starts, high[i, 0], side="right")
        near = order[k + 1:last]
        near = near[(low[near, 1:] <= high[i, 1:]).all(1) & (high[near, 1:] >= low[i, 1:]).all(1)]
        pairs.append(np.stack([np.full(len(near), i), near], 1))
    pairs = np.concatenate(pairs)
    shared = (triangles[pairs[:, 0]][:, :, None] == triangles[pairs[:, 1]][:, None, :]).any(2).sum(1)
    coplanar = vtk.reference(0)
    tolerance = 1e-9
    for i, j in pairs[shared == 0]:
        p1, p2, s = [0.0] * 3, [0.0] * 3, [0.0, 0.0]
        a, b = corners[i], corners[j]
        count += vtk.vtkIntersectionPolyDataFilter.TriangleTriangleIntersection(a[0], a[1], a[2], b[0], b[1], b[2], coplanar, p1, p2, s, tolerance) != 0
    def orient(a, b, c, d):
        return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)
    def pierces(p, q, t):  # segments p q through triangles t
        sides = orient(t[:, 0], t[:, 1], t[:, 2], p) * orient(t[:, 0], t[:, 1], t[:, 2], q) < 0
        o = np.stack([orient(p, q, t[:, k], t[:, (k + 1) % 3]) for k in range(3)], 1)
        return sides & ((o > 0).all(1) | (o < 0).all(1))
    one = pairs[shared == 1]
    hit = np.zeros(len(one), bool)
    for first, second in ((one[:, 0], one[:, 1]), (one[:, 1], one[:, 0])):
        a, b = triangles[first], triangles[second]
        common = (a[:, :, None] == b[:, None, :]).any(2)
        at = common.argmax(1)
        p = points[a[np.arange(len(a)), (at + 1) % 3]]
        q = points[a[np.arange(len(a)), (at + 2) % 3]]
        hit |= pierces(p, q, corners[second])
    return int(count) + int(hit.sum())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("surface")
    parser.add_argument("labels")
    parser.add_argument("label", type=int)
    parser.add_argument("report")
    parser.add_argument("--space", default="lps")
    o = parser.parse_args()
    report = json.load(open(o.report))
    row = next(r for r in report["labels"] if r["label"] == o.label)
    points, triangles = read_surface(o.surface)
    if o.space == "lps":
        points = points * [-1, -1, 1]
    image = nibabel.load(o.labels)
    mask = np.asarray(image.dataobj).astype(int) == o.label
    affine = image.affine
    index = (points - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T  # voxel index space
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    axis = {"x": 0, "y": 1, "z": 2}[report["input"]["axis"]]

    stencil = vtk.vtkPolyDataToImageStencil()
    data = poly_data(index, triangles)
    stencil.SetInputData(data)
    stencil.SetOutputSpacing(1, 1, 1)
    stencil.SetOutputOrigin(0, 0, 0)
    stencil.SetOutputWholeExtent(0, mask.shape[0] - 1, 0, mask.shape[1] - 1, 0, mask.shape[2] - 1)
    stencil.SetTolerance(0)
    blank = vtk.vtkImageData()
    blank.SetDimensions(*mask.shape)
    blank.AllocateScalars(vtk.VTK_UNSIGNED_CHAR, 1)
    blank.GetPointData().GetScalars().Fill(1)
    cut = vtk.vtkImageStencil()
    cut.SetInputData(blank)
    cut.SetStencilConnection(stencil.GetOutputPort())
    cut.SetBackgroundValue(0)
    cut.Update()
    inside = vtk_to_numpy(cut.GetOutput().GetPointData().GetScalars()).reshape(mask.shape[::-1]).transpose() > 0
    dice = 2 * (inside & mask).sum() / (inside.sum() + mask.sum())

    mm = index * spacing
    quads, axes = face_quads(mask)
    surface = poly_data(mm, triangles)
    to_mesh = distances(quads[axes != axis].mean(1) * spacing, surface)
    boundary = poly_data((quads * spacing).reshape(-1, 3), np.arange(4 * len(quads)).reshape(-1, 4))
    rng = np.random.default_rng(7)
    area = np.linalg.norm(np.cross(mm[triangles[:, 1]] - mm[triangles[:, 0]], mm[triangles[:, 2]] - mm[triangles[:, 0]]), axis=1)
    pick = rng.choice(len(triangles), 250000, p=area / area.sum())
    uv = rng.random((len(pick), 2))
    uv[uv.sum(1) > 1] = 1 - uv[uv.sum(1) > 1]
    t = mm[triangles[pick]]
    spread = t[:, 0] + uv[:, :1] * (t[:, 1] - t[:, 0]) + uv[:, 1:] * (t[:, 2] - t[:, 0])
    back = distances(spread, boundary)
    band = outside_band(spread / spacing, mask, spacing)
    bend, sharp = bends(points, triangles)

    a, b, c = (points[triangles[:, k]] for k in range(3))
    volume = abs(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)
    failed = False
    def compare(name, theirs, ours, relative=0.01, absolute=0.0):
        nonlocal failed
        fine = abs(theirs - ours) <= max(absolute, relative * abs(theirs))
        failed |= not fine
        print(f"{'ok' if fine else 'WRONG':6} {name:28} VTK {theirs:12.5f}  stackmesh {ours:12.5f}")
    compare("Dice", dice, row["dice"])
    compare("1 - Dice", 1 - dice, 1 - row["dice"], 0.1, 0.001)
    compare("volume", volume, row["surface_volume_mm3"])
    compare("labels to mesh, mean", to_mesh.mean(), row["distance_mm"]["mean"])
    compare("labels to mesh, 95 %", np.quantile(to_mesh, 0.95), row["distance_mm"]["p95"])
    if len(to_mesh) <= 60000:
        compare("labels to mesh, largest", to_mesh.max(), row["distance_mm"]["max"])
    # 20,000 points of a shaken surface: three standard errors of their mean
    compare("mesh to labels, mean", back.mean(), row["reverse_distance_mm"]["mean"], 0.016)
    compare("mesh to labels, 95 %", np.quantile(back, 0.95), row["reverse_distance_mm"]["p95"])
    compare("wrong centres", (inside ^ mask).sum(), row["wrong_centres"], 0.1, 0.002 * mask.sum())
    compare("outside the band, mean", band.mean(), row["band_distance_mm"]["mean"], 0.05, 0.0005)  # 20,000 points: three standard errors
    compare("outside the band, share", (band > 1e-4).mean(), row["band_distance_mm"]["outside_share"], 0.03, 0.002)
    compare("bends, mean", bend, row["mean_bend_deg"])
    compare("bends above 40, share", sharp, row["bends_above_40_share"])
    compare("crossing pairs", crossing_pairs(points, triangles), report["surface"]["self_intersections"], 0.01, 0)
    sys.exit(1 if failed else 0)


main()
