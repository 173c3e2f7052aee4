#!/usr/bin/env python3
"""Checks solver decks and second-order meshes with readers that are not ours.

usage: decks.py FOLDER     all of FOLDER/expected.json's files: {"points", "tets", "triangles", "labels": {number: count},
                           "order", "volume", "files": [...]}
       decks.py FILE.feb   structure only: well-formed, every reference names what exists, faces are faces of elements
       decks.py FILE.bdf   every card by its fields, every reference; with `tied` all nodes at one place must follow one of them

Mid-side nodes must lie near the middle of the edge that the format says they are on. Exits 77 without meshio or VTK.
"""
import json
import os
import sys
import warnings
import xml.etree.ElementTree as ET

try:
    import meshio
    import numpy as np
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    import febio_rules
    import nastran_rules
    import other_decks
except ImportError as error:
    print(f"SKIPPED: {error}")
    sys.exit(77)

warnings.simplefilter("ignore")
EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]  # of VTK and meshio; FEBio's tet10 is the same


def need(condition, text):
    if not condition:
        print(f"MISMATCH: {text}")
        sys.exit(1)


def volume(points, tets):
    a, b, c, d = (points[tets[:, k]] for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def check_mids(name, points, tets):
    for k, (a, b) in enumerate(EDGES):
        middle = (points[tets[:, a]] + points[tets[:, b]]) / 2
        edge = np.linalg.norm(points[tets[:, a]] - points[tets[:, b]], axis=1)
        need((np.linalg.norm(points[tets[:, 4 + k]] - middle, axis=1) < 0.2 * edge).all(),
             f"{name}: mid-side node {k} is not on edge {a}{b}")


def check_mesh(name, expected, points, tets, labels=None, triangles=None):
    need(len(points) == expected["points"], f"{name}: {len(points)} points")
    need(tets.shape == (expected["tets"], 4 if expected["order"] == 1 else 10), f"{name}: tets {tets.shape}")
    v = volume(points, tets)
    need((v > 0).all(), f"{name}: an element is inside out")
    need(abs(v.sum() / expected["volume"] - 1) < (1e-6 if name.endswith(".exo") else 1e-9),  # VTK's Exodus reader rounds coordinates to float
         f"{name}: volume {v.sum()}")
    if expected["order"] == 2:
        check_mids(name, points, tets)
    if labels is not None:
        numbers, counts = np.unique(labels, return_counts=True)
        need({str(int(n)): int(c) for n, c in zip(numbers, counts)} == expected["labels"], f"{name}: labels {numbers} {counts}")
    if triangles is not None:
        need(len(triangles) == expected["triangles"], f"{name}: {len(triangles)} triangles")


def check_sets(name, expected, deck):
    """Parts are the labels; a set for each pair of labels, whose faces (where the format has sets of faces) are the triangles and whose
    nodes are those of the faces."""
    need(sorted(len(p) for p in deck.parts.values()) == sorted(expected["labels"].values()), f"{name}: parts {({n: len(p) for n, p in deck.parts.items()})}")
    faces = {frozenset(int(v) for v in t[list(f)]): set(int(v) for v in t) for t in deck.tets for f in ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3))}
    if not name.endswith(".cdb"):
        need(sum(len(f) for f in deck.face_sets.values()) == expected["triangles"], f"{name}: {({n: len(f) for n, f in deck.face_sets.items()})}")
        need(all(frozenset(int(v) for v in f) in faces for rows in deck.face_sets.values() for f in rows), f"{name}: a face of a set is no face of an element")
        for set_name, rows in deck.face_sets.items():
            nodes = {int(v) for v in deck.node_sets["N_" + set_name[2:]]}
            need({int(v) for v in rows.ravel()} <= nodes, f"{name}: nodes of {set_name}")
    need(len(deck.node_sets) == expected["pairs"], f"{name}: node sets {list(deck.node_sets)}")


def read_feb(path):
    root = ET.parse(path).getroot()
    wrong = febio_rules.check(root)
    need(not wrong, f"{path}: {wrong[:5]}")
    mesh = root.find("Mesh")
    points = np.array([[float(v) for v in n.text.split(",")] for n in mesh.find("Nodes")])
    ids = [int(n.get("id")) for n in mesh.find("Nodes")]
    need(ids == list(range(1, len(ids) + 1)), "node ids")
    domains, element_ids, tets, shells = {}, [], [], []
    sizes = {"tet4": 4, "tet10": 10, "tri3": 3, "tri6": 6}
    for block in mesh.findall("Elements"):
        rows = [[int(v) - 1 for v in e.text.split(",")] for e in block]
        need(all(len(r) == sizes[block.get("type")] for r in rows), f"nodes of {block.get('name')}")
        need(block.get("name") not in domains, f"domain {block.get('name')} twice")
        domains[block.get("name")] = len(rows)
        element_ids += [int(e.get("id")) for e in block]
        (tets if block.get("type").startswith("tet") else shells).append(np.array(rows))
    need(element_ids == list(range(1, len(element_ids) + 1)), "element ids")
    tets = np.concatenate(tets)
    need(tets.min() >= 0 and tets.max() < len(points), "an element names a node that is not there")
    faces = {}
    for a, b, c, d in tets[:, :4]:
        for f in ((a, c, b), (a, b, d), (b, c, d), (a, d, c)):  # from outside
            faces.setdefault(frozenset(int(v) for v in f), []).append(tuple(int(v) for v in f))

    def same_turn(f, g):
        return any(f == tuple(g[(i + s) % 3] for i in range(3)) for s in range(3))

    sets, surfaces = {}, {}
    for s in mesh.findall("NodeSet"):
        nodes = [int(v) for v in s.text.split(",")]
        need(s.get("name") not in sets, f"node set {s.get('name')} twice")
        need(len(set(nodes)) == len(nodes) and 0 < min(nodes) and max(nodes) <= len(points), f"node set {s.get('name')}")
        sets[s.get("name")] = nodes
    for s in mesh.findall("Surface"):
        need(s.get("name") not in surfaces and len(s) > 0, f"surface {s.get('name')}")
        surfaces[s.get("name")] = len(s)
        for face in s:
            nodes = [int(v) - 1 for v in face.text.split(",")]
            need(len(nodes) == (3 if tets.shape[1] == 4 else 6), "nodes of a face")
            own = faces.get(frozenset(nodes[:3]), [])
            need(any(same_turn(tuple(nodes[:3]), f) for f in own), f"surface {s.get('name')}: not the outside of an element's face")
            for k in range(3, len(nodes)):
                a, b = nodes[k - 3], nodes[(k - 2) % 3]
                need(np.linalg.norm(points[nodes[k]] - (points[a] + points[b]) / 2) < 0.2 * np.linalg.norm(points[a] - points[b]),
                     f"mid-side node of a face of {s.get('name')}")
    for pair in mesh.findall("SurfacePair"):
        need(pair.find("primary").text in surfaces and pair.find("secondary").text in surfaces, f"pair {pair.get('name')}")
    need(len({c.get("surface_pair") for c in root.iter("contact")}) == len(list(root.iter("contact"))), "a pair is in contact twice")
    materials = {}
    maps = {d.get("name"): d for d in root.iter("ElementData")}
    node_maps = {d.get("name"): d for d in root.iter("NodeData")}
    for m in root.find("Material"):
        need(m.get("name") not in materials, f"material {m.get('name')} twice")
        materials[m.get("name")] = m
        for value in m:
            if value.get("type") == "map":
                need(value.text in maps, f"map {value.text}")
        need(m.find("E").get("type") == "map" or float(m.find("E").text) > 0, "E must be positive")
        need(0 <= float(m.find("v").text) < 0.5, "v")
    used = []
    for d in root.find("MeshDomains"):
        need(d.get("name") in domains and d.get("mat") in materials, f"domain {d.get('name')}")
        used.append(d.get("name"))
    need(sorted(used) == sorted(domains), "every element block has one domain")
    for d in maps.values():
        need(domains[d.get("elem_set")] == len(d), f"map {d.get('name')} has {len(d)} values")
        need([int(e.get("lid")) for e in d] == list(range(1, len(d) + 1)), "lids")
        need(all(float(e.text) > 0 for e in d) or d.get("name").startswith("density"), f"map {d.get('name')} has a value that is not positive")
    for d in node_maps.values():
        need(len(sets[d.get("node_set")]) == len(d), f"map {d.get('name')}")
    for bc in root.iter("bc"):
        need(bc.get("node_set") in sets, f"bc {bc.get('name')}")
    for load in root.iter("nodal_load"):
        need(load.get("node_set") in sets and load.find("value").text in node_maps, "nodal load")
    controllers = {c.get("id") for c in root.iter("load_controller")}
    need(all(v.get("lc") in controllers for v in root.iter("value") if v.get("lc")), "load controllers")
    return points, tets, domains, sets, surfaces


def check_bdf(path, tied):
    wrong, deck = nastran_rules.check(path)
    need(not wrong, f"{path}: {wrong}")
    if tied:
        need(deck["followers"], "nothing is tied")
        places = {}
        for node, p in deck["nodes"].items():
            places.setdefault(p, []).append(node)
        for nodes in places.values():
            roots = {deck["followers"].get(n, (n, None))[0] for n in nodes}
            free = [n for n in roots if deck["held"].get(n, set()) != set("123")]
            need(len(roots) == 1 or len(free) <= 1, f"nodes {nodes} are not joined")
    print(f"ok {len(deck['nodes'])} nodes, {len(deck['elements'])} elements, {len(deck['followers'])} nodes tied")


def vtk_mesh(path):
    reader = vtk.vtkXMLUnstructuredGridReader() if path.endswith(".vtu") else vtk.vtkUnstructuredGridReader()
    reader.SetFileName(path)
    if path.endswith(".vtk"):
        reader.ReadAllFieldsOn()
    reader.Update()
    grid = reader.GetOutput()
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    tets, triangles, labels = [], [], []
    label = vtk_to_numpy(grid.GetCellData().GetArray("label"))
    for i in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(i)
        nodes = [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]
        if cell.GetCellType() in (vtk.VTK_TETRA, vtk.VTK_QUADRATIC_TETRA):
            tets.append(nodes)
            labels.append(label[i])
        else:
            triangles.append(nodes)
    return points, np.array(tets), np.array(labels), triangles


def main():
    if sys.argv[1].endswith(".feb"):
        points, tets, domains, sets, surfaces = read_feb(sys.argv[1])
        print(f"ok {len(points)} nodes, {len(tets)} tets, {len(domains)} domains, {len(sets)} node sets, {len(surfaces)} surfaces")
        return
    if sys.argv[1].endswith(".bdf"):
        check_bdf(sys.argv[1], "tied" in sys.argv[2:])
        return
    folder = sys.argv[1]
    with open(os.path.join(folder, "expected.json")) as file:
        expected = json.load(file)
    for name in expected["files"]:
        path = os.path.join(folder, name)
        ending = os.path.splitext(name)[1]
        if ending == ".feb":
            points, tets, domains, _, _ = read_feb(path)
            check_mesh(name, expected, points, tets)
            need(sorted(domains.values()) == sorted(expected["labels"].values()), f"{name}: domains {domains}")
        elif ending in other_decks.READERS:
            try:
                deck = other_decks.READERS[ending](path)
            except other_decks.Broken as error:
                need(False, f"{name}: {error}")
            check_mesh(name, expected, deck.points, deck.tets, deck.labels)
            check_sets(name, expected, deck)
        else:
            mesh = meshio.read(path)
            kind = "tetra" if expected["order"] == 1 else "tetra10"
            flat = "triangle" if expected["order"] == 1 else "triangle6"
            tets = np.concatenate([c.data for c in mesh.cells if c.type == kind])
            triangles = [c.data for c in mesh.cells if c.type == flat]
            labels = None
            for key in ("label", "gmsh:physical", "nastran:ref", "medit:ref"):
                if key in mesh.cell_data:
                    labels = np.concatenate([d for c, d in zip(mesh.cells, mesh.cell_data[key]) if c.type == kind])
            need(labels is not None or ending == ".inp", f"{name}: no labels")
            check_mesh(f"{name} (meshio)", expected, mesh.points, tets, labels, np.concatenate(triangles) if triangles else None)
            if ending in (".vtu", ".vtk"):
                points, tets, labels, triangles = vtk_mesh(path)
                check_mesh(f"{name} (VTK)", expected, points, tets, labels, triangles)
        print(f"ok {name}")


main()
