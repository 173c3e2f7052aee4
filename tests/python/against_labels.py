#!/usr/bin/env python3
"""Compares a mesh of the program, and the report of its run, with the label volume as nibabel reads it.

usage: against_labels.py [--exact] REPORT.json MESH.vtu LABELS.nii.gz

For each label of the report, in the frame that the mesh says it is in:
- the centroid of its tets is within a pixel of that of its voxels, and it fills the box of its voxels within half a
  voxel (with --exact, for --simplify 0, to a thousandth of a pixel within the sections);
- its volume and voxel count are those of the report;
- Dice, from VTK's stencil of its boundary on the voxel centres, is the report's within 0.002;
- the distance of the in-plane voxel-face centres to its boundary, by VTK's cell locator, is the report's distance_mm
  within 5 %.
Prints a line per label; exits 1 on a difference, 77 when nibabel or VTK are absent.
"""
import json
import sys

try:
    import numpy as np
    import nibabel
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-nibabel and python3-vtk9")
    sys.exit(77)


def read_mesh(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    space = grid.GetFieldData().GetAbstractArray("SPACE")
    space = "".join(chr(int(space.GetValue(i))) for i in range(space.GetNumberOfValues()))
    corners = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    starts = vtk_to_numpy(grid.GetCells().GetOffsetsArray())[:-1]
    tets = vtk_to_numpy(grid.GetCellTypesArray()) == 10
    labels = vtk_to_numpy(grid.GetCellData().GetArray("label"))[tets]
    return vtk_to_numpy(grid.GetPoints().GetData()), corners[starts[tets][:, None] + np.arange(4)], labels, space


def boundary(tets):
    faces = np.concatenate([tets[:, [1, 2, 3]], tets[:, [0, 3, 2]], tets[:, [0, 1, 3]], tets[:, [0, 2, 1]]])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def poly_data(points, triangles):
    poly, holder, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    holder.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=1))
    rows = np.column_stack((np.full(len(triangles), 3), triangles)).astype(np.int64).ravel()
    cells.SetCells(len(triangles), numpy_to_vtkIdTypeArray(rows, deep=1))
    poly.SetPoints(holder)
    poly.SetPolys(cells)
    return poly


def distances(points, triangles, places):
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(poly_data(points, triangles))
    locator.BuildLocator()
    closest, cell, part, square = [0, 0, 0], vtk.reference(0), vtk.reference(0), vtk.reference(0.0)
    found = np.empty(len(places))
    for i, p in enumerate(places):
        locator.FindClosestPoint(p, closest, cell, part, square)
        found[i] = float(square) ** 0.5
    return found


def dice(index_points, triangles, mask):
    stencil = vtk.vtkPolyDataToImageStencil()
    stencil.SetInputData(poly_data(index_points, triangles))
    stencil.SetOutputSpacing(1, 1, 1)
    stencil.SetOutputOrigin(0, 0, 0)
    x, y, z = mask.shape
    stencil.SetOutputWholeExtent(0, x - 1, 0, y - 1, 0, z - 1)
    stencil.SetTolerance(1e-6)
    image = vtk.vtkImageStencilToImage()
    image.SetInputConnection(stencil.GetOutputPort())
    image.SetInsideValue(1)
    image.SetOutsideValue(0)
    image.SetOutputScalarTypeToUnsignedChar()
    image.Update()
    inside = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars()).reshape(z, y, x).transpose(2, 1, 0) > 0
    return 2 * (inside & mask).sum() / (inside.sum() + mask.sum())


def main(report_path, mesh_path, labels_path, exact):
    with open(report_path) as file:
        report = json.load(file)
    points, tets, labels, space = read_mesh(mesh_path)
    image = nibabel.load(labels_path)
    voxels = np.rint(np.asanyarray(image.dataobj)).astype(np.int64)
    if voxels.ndim == 4:
        voxels = voxels[..., 0]
    to_ras = {"LPS": np.array([-1.0, -1, 1]), "RAS": np.ones(3)}[space]
    affine = image.affine  # voxel index to RAS, mm
    ras = points * to_ras
    index = (ras - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T
    stacked = "xyz".index(report["input"]["axis"])
    size = np.linalg.norm(affine[:3, :3], axis=0)
    pixel = np.delete(size, stacked).max()
    bad = 0
    for row in report["labels"]:
        label, mask = row["label"], voxels == row["label"]
        mine = tets[labels == label]
        corners = ras[mine]
        volumes = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
                            corners[:, 3] - corners[:, 0]) / 6
        where = np.argwhere(mask)
        centroid = np.average(corners.mean(axis=1), axis=0, weights=volumes)
        meant = affine[:3, :3] @ where.mean(axis=0) + affine[:3, 3]
        used = index[np.unique(mine)]
        over = np.concatenate(((where.min(axis=0) - 0.5) - used.min(axis=0), used.max(axis=0) - (where.max(axis=0) + 0.5)))
        surface = boundary(mine)
        face_centres = []
        padded = np.pad(mask, 1).astype(np.int8)
        for axis in range(3):
            if axis != stacked:
                at = np.argwhere(np.diff(padded, axis=axis) != 0) - 1.0
                at[:, axis] += 0.5
                face_centres.append(at)
        places = np.concatenate(face_centres) @ affine[:3, :3].T + affine[:3, 3]
        away = distances(ras, surface, places)
        told = row["distance_mm"]
        ours = {"mean": away.mean(), "p95": np.percentile(away, 95), "max": away.max()}
        counted = dice(index, surface, mask)
        faults = []
        if not (volumes > 0).all():
            faults.append("inverted tets")
        if np.linalg.norm(centroid - meant) > pixel:
            faults.append(f"centroid {centroid} where nibabel has {meant}")
        slack = np.full(3, 1e-3 if exact else 0.5)
        slack[stacked] = 0.5  # round ends are lower, and sheets between labels lie between the sections
        if (np.abs(over.reshape(2, 3)) > slack + 1e-6).any():
            faults.append(f"low and high beyond the voxels' box by {over} voxels")
        if abs(volumes.sum() - row["tet_volume_mm3"]) > 1e-9 * volumes.sum():
            faults.append(f"volume {volumes.sum()}")
        if abs(mask.sum() * size.prod() - row["input_volume_mm3"]) > 1e-5 * row["input_volume_mm3"]:
            faults.append(f"voxel volume {mask.sum() * size.prod()}")
        if abs(counted - row["dice"]) > 0.002:
            faults.append(f"Dice {counted} where the report has {row['dice']}")
        for name, value in ours.items():
            if abs(value - told[name]) > 0.05 * told[name] + 1e-4 * pixel:
                faults.append(f"distance {name} {value} where the report has {told[name]}")
        bad += len(faults)
        print(f"label {label}: centroid off by {np.linalg.norm(centroid - meant) / pixel:.3f} pixels, Dice {counted:.4f}, "
              f"distance {ours['mean']:.4f} {ours['p95']:.4f} {ours['max']:.4f} mm of {len(places)} faces",
              *(f"\n  DIFFERS: {f}" for f in faults))
    return 1 if bad else 0


if __name__ == "__main__":
    words = [w for w in sys.argv[1:] if w != "--exact"]
    if len(words) != 3:
        sys.exit(__doc__)
    sys.exit(main(*words, "--exact" in sys.argv))
