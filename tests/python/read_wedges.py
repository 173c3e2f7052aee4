#!/usr/bin/env python3
"""Reads wedges and pyramids with programs that we did not write, and checks their number and that each is right side out.

usage: read_wedges.py REPORT.json FILE...     (linear meshes of `stackmesh mesh --layer`)

VTK reads .vtu and .exo; meshio .msh .med .bdf .inp (there a pyramid is a wedge with a repeated corner). No program of Debian's reads .cdb and .k:
their blocks are read here by the documented columns, and their elements taken as the bricks that ANSYS and LS-DYNA say they are, with corners
that coincide. Exits 1 with what differs, 77 without the libraries.
"""
import json
import sys

try:
    import meshio
    import numpy as np
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"SKIPPED: {error}")
    sys.exit(77)

FACES = {"wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)),   # of positive wedges, outwards
         "pyramid": ((0, 3, 2), (0, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
         "brick": ((0, 3, 2), (0, 2, 1), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7))}


def volumes(points, cells, kind):
    p = points[np.asarray(cells)]
    o = p.mean(axis=1)
    return sum(np.einsum("ni,ni->n", p[:, a] - o, np.cross(p[:, b] - o, p[:, c] - o)) for a, b, c in FACES[kind]) / 6


def by_vtk(path):
    reader = vtk.vtkExodusIIReader() if path.endswith(".exo") else vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grids = [reader.GetOutput()]
    if path.endswith(".exo"):
        it = reader.GetOutput().NewIterator()
        grids = []
        while not it.IsDoneWithTraversal():
            grids.append(it.GetCurrentDataObject())
            it.GoToNextItem()
    out = {13: [], 14: []}
    for grid in grids:
        sizes = vtk.vtkCellSizeFilter()
        sizes.SetInputData(grid)
        sizes.Update()
        volume = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
        for i in range(grid.GetNumberOfCells()):
            if grid.GetCellType(i) in out:
                out[grid.GetCellType(i)].append(volume[i])
    return np.array(out[13]), np.array(out[14])


def by_meshio(path):
    mesh = meshio.read(path)
    wedges, pyramids = [np.zeros(0)], [np.zeros(0)]
    sign = 1
    for block in mesh.cells:
        if block.type == "wedge":
            flat = block.data[:, 2] == block.data[:, 5]
            v = sign * volumes(mesh.points, block.data, "wedge")
            wedges.append(v[~flat])
            pyramids.append(v[flat])
        if block.type == "pyramid":
            pyramids.append(sign * volumes(mesh.points, block.data, "pyramid"))
    return np.concatenate(wedges), np.concatenate(pyramids)


def bricks(points, cells, is_wedge):
    cells = np.array(cells)
    v, wedge = volumes(np.array(points), cells, "brick"), np.array([is_wedge(c) for c in cells])
    return v[wedge], v[~wedge]


def by_columns_cdb(path):
    lines, points, cells, i = open(path, encoding="ascii").read().split("\n"), [], [], 0
    while i < len(lines):
        if lines[i].startswith("NBLOCK"):
            i += 2
            while not lines[i].startswith("N,R5.3"):
                points.append([float(lines[i][27 + 21 * k:48 + 21 * k]) for k in range(3)])
                i += 1
        elif lines[i].startswith("EBLOCK"):
            i += 2
            while lines[i].strip() != "-1":
                f = [int(lines[i][9 * k:9 * k + 9]) for k in range(19)]
                assert f[8] == 8 and f[1] == 1, f
                c = [n - 1 for n in f[11:]]
                if len(set(c)) > 4:  # I J K K M N O O or I J K L M M M M
                    assert (c[2] == c[3] and c[6] == c[7] and len(set(c)) == 6) or (len(set(c[4:])) == 1 and len(set(c)) == 5), c
                    cells.append(c)
                i += 1
        i += 1
    return bricks(points, cells, lambda c: c[2] == c[3])


def by_columns_k(path):
    block, points, cells, head, sections, parts, rows = "", [], [], None, {}, {}, []
    for line in open(path, encoding="ascii"):
        line = line.rstrip("\n")
        if line.startswith("*"):
            block, rows = line, []
        elif line.startswith("$"):
            continue
        elif block == "*NODE":
            points.append([float(line[8 + 16 * k:24 + 16 * k]) for k in range(3)])
        elif block == "*SECTION_SOLID":
            sections[int(line[:10])] = int(line[10:20])
        elif block == "*PART":
            rows.append(line)
            if len(rows) == 2:
                parts[int(line[:10])] = int(line[10:20])
        elif block == "*ELEMENT_SOLID":
            if head is None:
                head = [int(line[:8]), int(line[8:16])]
                continue
            c = [int(line[8 * k:8 * k + 8]) - 1 for k in range(8)]
            if len(set(c)) > 4:  # n5 = n6 and n7 = n8, or n5 = ... = n8
                assert (c[4] == c[5] and c[6] == c[7] and len(set(c)) in (5, 6)), c
                assert sections[parts[head[1]]] == 15, "wedges have a formulation of their own"
                cells.append(c)
            else:
                assert sections[parts[head[1]]] == 10
            head = None
    return bricks(points, cells, lambda c: c[4] != c[6])


def main():
    volume = json.load(open(sys.argv[1]))["volume"]
    wanted, sums = (volume["wedges"], volume["pyramids"]), None
    assert wanted[0] > 0 and wanted[1] > 0, wanted
    for path in sys.argv[2:]:
        read = {"vtu": by_vtk, "exo": by_vtk, "cdb": by_columns_cdb, "k": by_columns_k}.get(path.rsplit(".", 1)[1], by_meshio)
        wedges, pyramids = read(path)
        if path.endswith(".exo") and (wedges < 0).all():
            wedges = -wedges  # VTK 9.1's Exodus reader keeps Exodus's order, which VTK's own volume takes for the other way round
        if path.endswith(".med"):
            wedges, pyramids = -wedges, -pyramids  # MED winds all cells the other way
        found = (len(wedges), len(pyramids))
        print(path, found, "smallest", wedges.min(), pyramids.min())
        if found != wanted or wedges.min() <= 0 or pyramids.min() <= 0:
            sys.exit(f"MISMATCH: {path}: {found} of {wanted}, smallest volumes {wedges.min()}, {pyramids.min()}")
        sums = sums or (wedges.sum(), pyramids.sum())
        for a, b in zip(sums, (wedges.sum(), pyramids.sum())):
            if abs(a - b) > 2e-2 * a:  # sides that are not plane are divided one way or the other
                sys.exit(f"MISMATCH: {path}: volumes {a} and {b}")


main()
