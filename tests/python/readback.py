#!/usr/bin/env python3
"""Reads mesh files back with VTK and meshio and compares them with what was meant.

usage: readback.py FOLDER
       readback.py --report R.json FILE...

With a report of the program, the FILEs (one .vtu and one .vtp among them) are those of that run: counts, labels and
volumes must be the report's, coordinates those of the .vtu, and triangles of a pair as many as in the .vtp.

FOLDER/expected.json holds
  files             names of the files to check, all of one mesh
  space             "LPS", "RAS" or ""
  points, surface_points, tets, triangles
  order             2 when the cells have mid-side nodes; each must lie near the middle of its edge, in VTK's order
  labels            [{label, name, set, tets, volume}]   set: name of the element set in decks
  pairs             [{below, above, name, triangles}]
and FOLDER/points.bin the points of the volume as raw float64 x, y, z; every format that holds doubles must give
them back bit by bit. Prints a line per file and reader; exits 1 on a mismatch, 77 when VTK or meshio are absent.
"""
import json
import os
import re
import sys
import warnings

try:
    import numpy as np
    import meshio
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-vtk9 and python3-meshio")
    sys.exit(77)

warnings.simplefilter("ignore")
EXACT = "exact"  # coordinates come back bit by bit


class Mismatch(Exception):
    pass


def need(condition, text):
    if not condition:
        raise Mismatch(text)


def near(a, b, tolerance=1e-9):
    return abs(a - b) <= tolerance * max(1.0, abs(b))


class Mesh:
    """points, tets with labels, triangles with (below, above); None where the format cannot say."""

    def __init__(self, points, triangles, pairs=None, tets=None, labels=None, precision=EXACT, space=None):
        self.points, self.triangles, self.pairs = np.asarray(points), np.asarray(triangles), pairs
        self.tets, self.labels, self.precision, self.space = tets, labels, precision, space


def without_mids(points, tets, triangles, order):
    """The corners of the cells, once their mid-side nodes were found near the middles of the edges."""
    if order == 1:
        return tets, triangles
    points = np.asarray(points, float)
    for cells, corners, edges in ((tets, 4, ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))),
                                  (triangles, 3, ((0, 1), (1, 2), (2, 0)))):
        need(cells.shape[1] == corners + len(edges), f"{cells.shape[1]} nodes a cell")
        for k, (i, j) in enumerate(edges):
            a, b, m = points[cells[:, i]], points[cells[:, j]], points[cells[:, corners + k]]
            off = np.linalg.norm(m - (a + b) / 2, axis=1) / np.linalg.norm(b - a, axis=1)
            need(off.max() < 0.2, f"node {corners + k} is not on edge {i}{j}")
    return tets[:, :4], triangles[:, :3]


def text_of(path):
    with open(path, "rb") as file:
        return file.read().decode("latin-1")


def marked_space(path, pattern=r"SPACE=(\w+)"):
    found = re.search(pattern, text_of(path)[:4000])
    return found.group(1) if found else ""


# ---- readers ---------------------------------------------------------------------------------------------------

def vtk_output(reader, path):
    reader.SetFileName(path)
    if hasattr(reader, "ReadAllFieldsOn"):
        reader.ReadAllFieldsOn()
    reader.Update()
    need(reader.GetErrorCode() == 0, "VTK reports an error")
    return reader.GetOutput()


def vtk_space(data):
    array = data.GetFieldData().GetAbstractArray("SPACE")
    if array is None:
        return ""
    values = [array.GetValue(i) for i in range(array.GetNumberOfValues())]
    return "".join(chr(v) if isinstance(v, int) else v for v in values)


def vtk_cells(cells):
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    corners = vtk_to_numpy(cells.GetConnectivityArray())
    return offsets, corners


def vtk_grid(reader, path, order=1):
    grid = vtk_output(reader, path)
    types = vtk_to_numpy(grid.GetCellTypesArray())
    offsets, corners = vtk_cells(grid.GetCells())
    starts = offsets[:-1]
    tet_type, tri_type = ((10, 5), (24, 22))[order - 1]
    need(set(types) == {tet_type, tri_type}, f"cell types {set(types)}")
    data = {n: vtk_to_numpy(grid.GetCellData().GetArray(n)) for n in ("label", "label_below", "label_above")}
    tet, tri = types == tet_type, types == tri_type
    behind = np.where(data["label_below"][tri] != 0, data["label_below"][tri], data["label_above"][tri])
    need((data["label"][tri] == behind).all(), "a triangle has not the label of the tet behind it")
    need((data["label_below"][tet] == -1).all() and (data["label_above"][tet] == -1).all(), "a tet has a pair")
    points = vtk_to_numpy(grid.GetPoints().GetData())
    tets, triangles = without_mids(points, corners[starts[tet][:, None] + np.arange((4, 10)[order - 1])],
                                   corners[starts[tri][:, None] + np.arange((3, 6)[order - 1])], order)
    return Mesh(points, triangles, np.column_stack((data["label_below"][tri], data["label_above"][tri])), tets,
                data["label"][tet], space=vtk_space(grid))


def vtk_poly(reader, path, labelled=False, precision=EXACT, space=None):
    poly = vtk_output(reader, path)
    offsets, corners = vtk_cells(poly.GetPolys())
    need((np.diff(offsets) == 3).all(), "a polygon is no triangle")
    pairs = None
    if labelled:
        pairs = np.column_stack([vtk_to_numpy(poly.GetCellData().GetArray(n)) for n in ("label_below", "label_above")])
        space = vtk_space(poly)
    return Mesh(vtk_to_numpy(poly.GetPoints().GetData()), corners.reshape(-1, 3), pairs, precision=precision,
                space=space)


def meshio_blocks(mesh, kind):
    return [(i, b.data) for i, b in enumerate(mesh.cells) if b.type == kind]


def meshio_volume(path, expected):
    """.vtu .vtk .msh .mesh .inp through meshio."""
    mesh = meshio.read(path)
    ending = os.path.splitext(path)[1]
    order = expected.get("order", 1)
    tetra, triangle = (("tetra", "triangle"), ("tetra10", "triangle6"))[order - 1]
    all_tets = np.concatenate([d for _, d in meshio_blocks(mesh, tetra)])
    triangles = [d for _, d in meshio_blocks(mesh, triangle)]
    triangles = np.concatenate(triangles) if triangles else np.empty((0, (3, 6)[order - 1]), int)
    if order == 2 and ending == ".inp":
        triangles = all_tets[:, [0, 1, 2, 4, 5, 6]]  # a deck has no triangles: any faces will do
    tets, triangles = without_mids(mesh.points, all_tets, triangles, order)

    def data(key, kind):
        return np.concatenate([np.asarray(mesh.cell_data[key][i]) for i, _ in meshio_blocks(mesh, kind)])

    if ending in (".vtu", ".vtk"):
        pairs = np.column_stack((data("label_below", triangle), data("label_above", triangle)))
        space = marked_space(path)
        if ending == ".vtu":
            field = mesh.field_data.get("SPACE")
            need(("" if field is None else "".join(map(chr, field))) == space, "field data and comment differ")
        return Mesh(mesh.points, triangles, pairs, tets, data("label", tetra), space=space)
    if ending == ".msh":
        names = {(int(dim), int(tag)): name for name, (tag, dim) in mesh.field_data.items()}
        labels = data("gmsh:physical", tetra)
        for row in expected["labels"]:
            need(names.get((3, row["label"])) == row["name"], f"physical volume of label {row['label']}")
        by_name = {row["name"]: (row["below"], row["above"]) for row in expected["pairs"]}
        pairs = np.array([by_name[names[2, int(t)]] for t in data("gmsh:physical", triangle)])
        return Mesh(mesh.points, triangles, pairs, tets, labels, space=marked_space(path))
    if ending == ".mesh":
        by_reference = {int(r): (int(b), int(a)) for r, b, a in
                        re.findall(r"# triangles of reference (\d+): labels (\d+)\|(\d+)", text_of(path))}
        pairs = np.array([by_reference[int(r)] for r in data("medit:ref", "triangle")])
        return Mesh(mesh.points, triangles, pairs, tets, data("medit:ref", "tetra"), space=marked_space(path))
    # A deck: labels are element sets, interfaces are faces of elements.
    labels = np.zeros(len(tets), int)
    firsts = np.cumsum([0] + [len(d) for _, d in meshio_blocks(mesh, tetra)])
    for row in expected["labels"]:
        need(row["set"] in mesh.cell_sets, f"no element set {row['set']}")
        for block, ids in enumerate(mesh.cell_sets[row["set"]]):
            if ids is not None and len(ids):
                labels[firsts[block] + np.asarray(ids, int)] = row["label"]
    text = text_of(path)
    mids = {frozenset((int(t[i]), int(t[j]))): int(t[4 + k]) for t in all_tets if order == 2
            for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)))}
    faces = {1: (0, 2, 1), 2: (0, 1, 3), 3: (1, 2, 3), 4: (2, 0, 3)}  # corners seen from outside
    triangles, pairs = [], []
    for below, above, body in re.findall(r"\*\* labels (\d+)\|(\d+):[^\n]*\n\*NSET[^*]*\*SURFACE, NAME=\w+, TYPE=ELEMENT\n([^*]*)",
                                         text):
        for element, face in re.findall(r"(\d+), S(\d)", body):
            need(labels[int(element) - 1] == int(below), "a surface is not on the elements of its first label")
            triangles.append(tets[int(element) - 1][list(faces[int(face)])])
            pairs.append((int(below), int(above)))
    for below, above, body in re.findall(r"\*\* labels (\d+)\|(\d+):[^\n]*\n\*NSET, NSET=\w+\n([^*]*)", text):
        mine = {int(v) for t, p in zip(triangles, pairs) if p == (int(below), int(above)) for v in t}
        if order == 2:
            mine |= {mids[frozenset((int(t[i]), int(t[j])))] for t, p in zip(triangles, pairs)
                     if p == (int(below), int(above)) for i, j in ((0, 1), (1, 2), (2, 0))}
        need({int(n) - 1 for n in re.findall(r"\d+", body)} == mine, f"node set of {below}|{above}")
    need(max(len(f.strip()) for line in text.split("*NODE, NSET=NALL\n")[1].split("*")[0].splitlines()
             for f in line.split(",")) <= 20, "a number is wider than 20 characters")
    return Mesh(mesh.points, np.array(triangles), np.array(pairs), tets, labels, precision=1e-14,
                space=marked_space(path))


def meshio_surface(path, expected):
    mesh = meshio.read(path)
    triangles = np.concatenate([d for _, d in meshio_blocks(mesh, "triangle")])
    pairs = None
    if path.endswith(".obj"):
        # Groups come in the order of the pairs.
        pairs = np.array([(r["below"], r["above"]) for r in expected["pairs"] for _ in range(r["triangles"])])
    return Mesh(mesh.points, triangles, pairs, precision=1e-6 if path.endswith(".stl") else EXACT,
                space=marked_space(path))


def own_ply(path):
    """VTK keeps PLY coordinates as floats and drops the labels, and meshio cannot read face properties."""
    with open(path, "rb") as file:
        data = file.read()
    header, body = data.split(b"end_header\n", 1)
    header = header.decode()
    points = int(re.search(r"element vertex (\d+)", header).group(1))
    faces = int(re.search(r"element face (\d+)", header).group(1))
    layout = re.findall(r"property (.+)", header)
    need(layout == ["double x", "double y", "double z", "list uchar int vertex_indices", "int label_below",
                    "int label_above"], f"properties {layout}")
    record = np.dtype([("n", "u1"), ("v", "<i4", 3), ("pair", "<i4", 2)])
    need(len(body) == 24 * points + record.itemsize * faces, "length")
    face = np.frombuffer(body, record, faces, 24 * points)
    need((face["n"] == 3).all(), "a face is no triangle")
    found = re.search(r"comment SPACE=(\w+)", header)
    return Mesh(np.frombuffer(body, "<f8", 3 * points).reshape(-1, 3), face["v"], face["pair"],
                space=found.group(1) if found else "")


# ---- checks ----------------------------------------------------------------------------------------------------

def check_closed(triangles):
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    big = edges.max() + 1
    there, back = np.sort(edges[:, 0] * big + edges[:, 1]), np.sort(edges[:, 1] * big + edges[:, 0])
    need(np.array_equal(there, back), "the surface of a label is open")


def flux(points, triangles):
    p = (points - points.mean(axis=0))[triangles]
    return np.einsum("ij,ij->", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6


def sort_rows(rows):
    return rows[np.lexsort(rows.T)]


def check(mesh, expected, all_points, tolerance):
    volume = mesh.tets is not None
    need(len(mesh.points) == expected["points" if volume else "surface_points"], f"{len(mesh.points)} points")
    need(len(mesh.triangles) == expected["triangles"], f"{len(mesh.triangles)} triangles")
    points = np.asarray(mesh.points, float)
    if mesh.precision == EXACT:
        need(mesh.points.dtype.newbyteorder("=") == np.float64, f"coordinates are {mesh.points.dtype}")
        if volume:
            need(np.array_equal(sort_rows(points), sort_rows(all_points)), "coordinates differ")
        else:
            need({p.tobytes() for p in points} <= {p.tobytes() for p in all_points}, "coordinates differ")
    else:
        # Points of a surface are compared by its triangles; those of a deck come in the mesh's order.
        need(not volume or np.abs(points - all_points).max() <= mesh.precision, "coordinates differ")
    if mesh.space is not None:
        need(mesh.space == expected["space"], f"SPACE is '{mesh.space}'")
    if volume:
        need(len(mesh.tets) == expected["tets"], f"{len(mesh.tets)} tets")
        p = points[mesh.tets]
        volumes = np.einsum("ij,ij->i", p[:, 1] - p[:, 0], np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 0])) / 6
        need((volumes > 0).all(), "inverted tets")
        need(set(map(int, mesh.labels)) == {r["label"] for r in expected["labels"]}, f"labels {set(mesh.labels)}")
        for row in expected["labels"]:
            mine = mesh.labels == row["label"]
            need(mine.sum() == row["tets"], f"label {row['label']} has {mine.sum()} tets")
            need(near(volumes[mine].sum(), row["volume"], tolerance), f"volume of the tets of label {row['label']}")
        need(near(volumes.sum(), sum(r["volume"] for r in expected["labels"]), tolerance), "total volume")
    if mesh.pairs is not None:
        below, above = mesh.pairs[:, 0], mesh.pairs[:, 1]
        need(((above == 0) & (below != 0) | (0 < below) & (below < above)).all(), "orientation of a pair")
        for row in expected["pairs"]:
            count = ((below == row["below"]) & (above == row["above"])).sum()
            need(count == row["triangles"], f"{count} triangles between {row['below']} and {row['above']}")
        for row in expected["labels"]:
            out, into = mesh.triangles[below == row["label"]], mesh.triangles[above == row["label"]][:, ::-1]
            shell = np.concatenate([out, into])
            check_closed(shell)
            need(near(flux(points, shell), row["volume"], tolerance), f"volume of the surface of label {row['label']}")


def same_corners(mesh, reference):
    """Same triangles, same winding, same order, for formats without labels."""
    a = np.asarray(mesh.points, float)[mesh.triangles]
    b = np.asarray(reference.points, float)[reference.triangles]
    need(a.shape == b.shape and np.abs(a - b).max() <= (0 if mesh.precision == EXACT else 1e-7 * np.abs(b).max()),
         "triangles differ")


def check_label_file(path, expected):
    label = int(re.search(r"_(\d+)\.\w+$", path).group(1))
    row = next(r for r in expected["labels"] if r["label"] == label)
    if path.endswith(".vtp"):
        mesh = vtk_poly(vtk.vtkXMLPolyDataReader(), path, labelled=True)
        need((mesh.pairs[:, 0] == label).all(), "label_below is another label")
    else:
        mesh = own_ply(path) if path.endswith(".ply") else meshio_surface(path, expected)
    need(len(np.unique(mesh.triangles)) == len(mesh.points), "a point is unused")
    check_closed(mesh.triangles)
    tolerance = 1e-9 if mesh.precision == EXACT else 1e-4
    need(near(flux(np.asarray(mesh.points, float), mesh.triangles), row["volume"], tolerance), "volume")
    need(mesh.space == expected["space"], f"SPACE is '{mesh.space}'")


def readings(path, expected):
    """(reader's name, function that reads) for each way to read the file."""
    ending = os.path.splitext(path)[1]
    order = expected.get("order", 1)
    by_meshio = ("meshio", lambda: meshio_volume(path, expected))
    surface_by_meshio = ("meshio", lambda: meshio_surface(path, expected))
    return {
        ".vtu": [("VTK", lambda: vtk_grid(vtk.vtkXMLUnstructuredGridReader(), path, order)), by_meshio],
        ".vtk": [("VTK", lambda: vtk_grid(vtk.vtkUnstructuredGridReader(), path, order)), by_meshio],
        ".msh": [by_meshio], ".mesh": [by_meshio], ".inp": [by_meshio],
        ".vtp": [("VTK", lambda: vtk_poly(vtk.vtkXMLPolyDataReader(), path, labelled=True))],
        ".ply": [("numpy", lambda: own_ply(path)),
                 ("VTK", lambda: vtk_poly(vtk.vtkPLYReader(), path, precision=1e-6))],
        ".stl": [surface_by_meshio, ("VTK", lambda: vtk_poly(vtk.vtkSTLReader(), path, precision=1e-6))],
        ".obj": [surface_by_meshio, ("VTK", lambda: vtk_poly(vtk.vtkOBJReader(), path, precision=1e-6))],
        ".off": [surface_by_meshio],
    }[ending]


def from_folder(folder):
    with open(os.path.join(folder, "expected.json")) as file:
        expected = json.load(file)
    expected["files"] = [os.path.join(folder, name) for name in expected["files"]]
    return expected, np.fromfile(os.path.join(folder, "points.bin")).reshape(-1, 3)


def from_report(path, files):
    with open(path) as file:
        report = json.load(file)
    order = report["volume"].get("order", 1)
    names = {0: "background"}
    labels = []
    for row in report["labels"]:
        name = names[row["label"]] = row["name"] or f"label_{row['label']}"
        labels.append({"label": row["label"], "name": name, "set": re.sub(r"\W", "_", name), "tets": row["tets"],
                       "volume": row["tet_volume_mm3" if order == 1 else "surface_volume_mm3"]})  # within straight sides
    surface = vtk_poly(vtk.vtkXMLPolyDataReader(), next(f for f in files if f.endswith(".vtp")), labelled=True)
    pairs, counts = np.unique(surface.pairs, axis=0, return_counts=True)
    grid = vtk_grid(vtk.vtkXMLUnstructuredGridReader(), next(f for f in files if f.endswith(".vtu")), order)
    space = report["input"]["space"]
    return {"files": files, "order": order, "space": "" if space == "none" else space.upper(), "points": report["volume"]["nodes"],
            "surface_points": report["surface"]["vertices"], "tets": report["volume"]["tets"],
            "triangles": report["surface"]["triangles"], "labels": labels,
            "pairs": [{"below": int(b), "above": int(a), "name": f"{names[b]}|{names[a]}", "triangles": int(n)}
                      for (b, a), n in zip(pairs, counts)]}, np.asarray(grid.points)


def main(expected, all_points):
    surface_files = [f for f in expected["files"] if f.endswith(".vtp") and not re.search(r"_\d+\.", f)]
    reference = vtk_poly(vtk.vtkXMLPolyDataReader(), surface_files[0], labelled=True)
    bad = 0
    for path in expected["files"]:
        name = os.path.basename(path)
        if re.search(r"_\d+\.\w+$", name):
            tasks = [("closed", lambda: check_label_file(path, expected))]
        else:
            def verify(read):
                mesh = read()
                check(mesh, expected, all_points, 1e-9 if mesh.precision == EXACT else 1e-4)
                if mesh.tets is None:
                    same_corners(mesh, reference)
            tasks = [(reader, lambda read=read: verify(read)) for reader, read in readings(path, expected)]
        for reader, task in tasks:
            try:
                task()
                print(f"ok        {name} ({reader})")
            except (Exception, SystemExit) as error:
                print(f"MISMATCH  {name} ({reader}): {type(error).__name__}: {error}")
                bad += 1
    return 1 if bad else 0


if __name__ == "__main__":
    if len(sys.argv) > 3 and sys.argv[1] == "--report":
        sys.exit(main(*from_report(sys.argv[2], sys.argv[3:])))
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(*from_folder(sys.argv[1])))
