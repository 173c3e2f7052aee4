#!/usr/bin/env python3
"""Materials from intensities, recomputed without the program's code.

usage: map_oracle.py make FOLDER [--mirror]      labels.nii.gz (a body without symmetry) and ct.nii.gz: another, oblique, left-handed grid
       map_oracle.py check MODEL.vtu CT.nii.gz SLOPE INTERCEPT     modulus of each element = mean over points inside it of the
                                                           nearest voxel's modulus, E = 6850 rho^1.49 (rho in g/cm3)

The CT is finer than the elements, and its values rise steeply along a skew direction, so that a swapped axis, a shift by a voxel or
a mirrored frame shows in every element. Exits 77 without numpy, nibabel or VTK.
"""
import sys

try:
    import nibabel as nib
    import numpy as np
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"SKIPPED: {error}")
    sys.exit(77)


def need(condition, text):
    if not condition:
        print(f"MISMATCH: {text}")
        sys.exit(1)


def field(p):
    """HU at world positions (RAS, mm): no symmetry, always positive density."""
    x, y, z = p[..., 0] - 40, p[..., 1] + 20, p[..., 2] - 7
    return 700 + 14 * x - 9 * y + 11 * z + 0.12 * x * y - 0.2 * y * z


def make(folder):
    shape = (24, 20, 10)
    i, j, k = np.meshgrid(*(np.arange(n) for n in shape), indexing="ij")
    body = ((i - 11.5) / 9) ** 2 + ((j - 9.5) / 7) ** 2 + ((k - 4.5) / 4.2) ** 2 < 1
    body |= (i > 15) & (i < 21) & (j > 8) & (j < 13) & (k > 3) & (k < 7)  # a horn to one side
    labels = np.where(body, np.where(i + j > 24, 2, 1), 0).astype(np.uint8)
    a, b = 0.4, -0.3
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    grid = np.eye(4)
    grid[:3, :3] = turn @ np.diag([1.5, 1.5, 3])
    grid[:3, 3] = np.array([40, -20, 7]) - grid[:3, :3] @ np.array([11.5, 9.5, 4.5])
    nib.save(nib.Nifti1Image(labels, grid), f"{folder}/labels.nii.gz")
    c, d = 1.1, 0.5
    other = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]]) @ np.array(
        [[np.cos(d), 0, np.sin(d)], [0, 1, 0], [-np.sin(d), 0, np.cos(d)]])
    spacing, size = np.array([0.5, 0.6, 0.7]), np.array([120, 104, 92])
    ct = np.eye(4)
    ct[:3, :3] = other[:, [1, 0, 2]] @ np.diag(spacing)  # axes exchanged: left-handed
    ct[:3, 3] = np.array([41, -19, 8]) - ct[:3, :3] @ ((size - 1) / 2)
    at = np.stack(np.meshgrid(*(np.arange(n) for n in size), indexing="ij"), axis=-1)
    values = field(at @ ct[:3, :3].T + ct[:3, 3])
    nib.save(nib.Nifti1Image(values.astype(np.float32), ct), f"{folder}/ct.nii.gz")


def check(mesh, image, slope, intercept):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(mesh)
    reader.Update()
    grid = reader.GetOutput()
    points = vtk_to_numpy(grid.GetPoints().GetData()) * np.array([-1, -1, 1])  # LPS to RAS
    modulus = vtk_to_numpy(grid.GetCellData().GetArray("modulus_MPa"))
    kinds = vtk_to_numpy(grid.GetCellTypesArray())
    tets = [i for i, kind in enumerate(kinds) if kind in (vtk.VTK_TETRA, vtk.VTK_QUADRATIC_TETRA)]
    corners = np.array([[grid.GetCell(i).GetPointId(k) for k in range(4)] for i in tets])
    found = modulus[tets]
    volume = np.abs(np.einsum("ij,ij->i", np.cross(points[corners[:, 1]] - points[corners[:, 0]], points[corners[:, 2]] - points[corners[:, 0]]),
                              points[corners[:, 3]] - points[corners[:, 0]])) / 6
    ct = nib.load(image)
    hu, to_voxel = ct.get_fdata(), np.linalg.inv(ct.affine)
    rng = np.random.default_rng(5)
    weights = rng.exponential(size=(4000, 4))
    weights /= weights.sum(axis=1, keepdims=True)  # evenly over the element
    meant = np.empty(len(corners))
    for e, row in enumerate(corners):
        p = weights @ points[row]
        voxel = np.rint(p @ to_voxel[:3, :3].T + to_voxel[:3, 3]).astype(int)
        need((voxel >= 0).all() and (voxel < hu.shape).all(), "an element lies outside of the image")
        rho = slope * hu[tuple(voxel.T)] + intercept
        meant[e] = (6850 * rho ** 1.49).mean()
    mean = (volume * found).sum() / (volume * meant).sum() - 1
    apart = np.abs(found / meant - 1)
    print(f"{len(found)} elements, mean modulus {mean:+.4%}, 99 % of elements within {np.quantile(apart, 0.99):.3%}, worst {apart.max():.3%}, "
          f"moduli {meant.min():.0f} to {meant.max():.0f} MPa")
    need(meant.max() > 2 * meant.min(), "the field is too even to show anything")
    need(abs(mean) < 0.01, "mean modulus")
    need(np.quantile(apart, 0.99) < 0.02, "moduli of elements")


if sys.argv[1] == "make":
    make(sys.argv[2])
else:
    check(sys.argv[2], sys.argv[3], float(sys.argv[4]), float(sys.argv[5]))
