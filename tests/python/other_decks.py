"""Readers of .cdb, .k, .exo and .med for decks.py: each returns a Deck in VTK's order of nodes.

.exo is read by VTK, .med by meshio (with python3-h5py). No program of Debian's reads .cdb and .k, so these are read here, by the
documented columns of their blocks and cards, and by nothing that the writer uses.
"""
import numpy as np


class Deck:
    def __init__(self, points, tets, labels=None):
        self.points, self.tets, self.labels = np.asarray(points, float), np.asarray(tets), labels
        self.node_sets, self.face_sets, self.parts = {}, {}, {}  # names to node numbers; to rows of corners; to element numbers (from 0)
        self.materials, self.values = {}, {}                     # by name or number: (E, poisson, density); per element
        self.fixed, self.forces, self.pressures, self.gravity = {}, {}, [], np.zeros(3)
        self.coupled = []                                        # (axes, nodes)


class Broken(Exception):
    pass


def need(condition, text):
    if not condition:
        raise Broken(text)


# Faces of SOLID187 and of SOLID185 (I J K K M M M M), by corners.
ANSYS_FACES = {10: {1: (1, 0, 2), 2: (0, 1, 3), 3: (1, 2, 3), 4: (2, 0, 3)}, 4: {1: (1, 0, 2), 2: (0, 1, 3), 3: (1, 2, 3), 5: (2, 0, 3)}}


def read_cdb(path):
    lines = open(path, encoding="ascii").read().split("\n")
    i, points, tets, material, components, commands, kind = 0, [], [], [], {}, [], None
    while i < len(lines):
        line = lines[i]
        if line.startswith("NBLOCK"):
            fields = line.split(",")
            need(fields[1:3] == ["6", "SOLID"] and lines[i + 1] == "(3i9,6e21.13e3)", line)
            i += 2
            while not lines[i].startswith("N,R5.3"):
                need(len(lines[i]) == 27 + 63 and int(lines[i][:9]) == len(points) + 1, lines[i])
                need(all(lines[i][27 + 21 * k:48 + 21 * k][-5] == "E" for k in range(3)), lines[i])
                points.append([float(lines[i][27 + 21 * k:48 + 21 * k]) for k in range(3)])
                i += 1
            need(len(points) == int(fields[4]), "number of nodes")
        elif line.startswith("ET,"):
            kind = int(line.split(",")[2])
            need(kind in (185, 187), line)
        elif line.startswith("EBLOCK"):
            need(line.split(",")[1:3] == ["19", "SOLID"] and lines[i + 1] == "(19i9)", line)
            count = int(line.split(",")[4])
            i += 2
            while lines[i].strip() != "-1":
                f = [int(lines[i][9 * k:9 * k + 9]) for k in range(len(lines[i]) // 9)]
                nodes = f[11:]
                if f[8] > 8:
                    i += 1
                    nodes += [int(lines[i][9 * k:9 * k + 9]) for k in range(len(lines[i]) // 9)]
                need(len(nodes) == f[8] and f[10] == len(tets) + 1 and f[1] == 1, f"element {f}")
                if kind == 185:
                    need(nodes[2] == nodes[3] and len(set(nodes[4:])) == 1, f"not a tetrahedron: {nodes}")
                    nodes = nodes[:3] + nodes[4:5]
                tets.append(nodes)
                material.append(f[0])
                i += 1
            need(len(tets) == count, "number of elements")
        elif line.startswith("CMBLOCK"):
            _, name, what, count = line.split(",")
            need(name[0].isalpha() and len(name.strip()) <= 32 and lines[i + 1] == "(8i10)", line)
            rows, ids = (int(count) + 7) // 8, []
            for row in lines[i + 2:i + 2 + rows]:
                ids += [int(row[10 * k:10 * k + 10]) for k in range(len(row) // 10)]
            need(len(ids) == int(count) and name.strip() not in components, line)
            components[name.strip()] = (what, np.array(ids) - 1)
            i += rows + 1
        elif line and not line.startswith("/"):
            commands.append(line.split(","))
        i += 1
    deck = Deck(points, np.array(tets) - 1)
    deck.node_sets = {n: ids for n, (what, ids) in components.items() if what == "NODE"}
    deck.parts = {n: ids for n, (what, ids) in components.items() if what == "ELEM"}
    faces, order = ANSYS_FACES[10 if kind == 187 else 4], len(deck.tets[0])
    by_number, coupled = {}, {}
    for c in commands:
        if c[0] == "MP":
            by_number.setdefault(int(c[2]), {})[c[1]] = float(c[3])
        elif c[0] == "D":
            deck.fixed[int(c[1]) - 1, "XYZ".index(c[2][1])] = float(c[3])
        elif c[0] == "F":
            deck.forces[int(c[1]) - 1, "XYZ".index(c[2][1])] = float(c[3])
        elif c[0] == "SFE":
            need(c[3:5] == ["PRES", ""] and order in (4, 10), str(c))
            deck.pressures.append((deck.tets[int(c[1]) - 1][list(faces[int(c[2])])], float(c[5])))
        elif c[0] == "ACEL":
            deck.gravity = -np.array([float(v) for v in c[1:4]])
        elif c[0] == "CP":
            coupled.setdefault((int(c[1]), c[2]), []).extend(int(v) - 1 for v in c[3:])
        else:
            need(c[0] in ("ET", "N", "FINISH", "ANTYPE", "NLGEOM"), f"unknown command {c}")
    deck.coupled = [(axis[1].lower(), nodes) for (_, axis), nodes in coupled.items()]
    deck.materials = {n: (m["EX"], m["PRXY"], m.get("DENS", 0)) for n, m in by_number.items()}
    deck.values["E"] = np.array([deck.materials[m][0] for m in material])
    return deck


def read_k(path):
    blocks, name = [], None
    for line in open(path, encoding="ascii"):
        line = line.rstrip("\n")
        if line.startswith("$"):
            continue
        if line.startswith("*"):
            blocks.append((line, []))
        else:
            blocks[-1][1].append(line)
    need(blocks[0][0] == "*KEYWORD" and blocks[-1][0] == "*END", "first or last keyword")

    def cut(text, *widths):
        values, at = [], 0
        for w in widths:
            values.append(text[at:at + w].strip())
            at += w
        return values

    def tens(text):
        need(len(text) % 10 == 0 and len(text) <= 80, f"a card of tens: '{text}'")
        return cut(text, *[10] * (len(text) // 10))

    points, elements, parts, materials, sections = [], [], {}, {}, {}
    for key, cards in blocks:
        if key == "*NODE":
            for n, card in enumerate(cards):
                number, *xyz = cut(card, 8, 16, 16, 16)
                need(int(number) == n + 1 and len(card) == 56 and all("." in v for v in xyz), card)
                points.append([float(v) for v in xyz])
        elif key == "*ELEMENT_SOLID":
            for head, nodes in zip(cards[::2], cards[1::2]):
                number, part = (int(v) for v in cut(head, 8, 8))
                need(number == len(elements) + 1, head)
                elements.append((part, [int(v) for v in cut(nodes, *[8] * (len(nodes) // 8))]))
        elif key == "*PART":
            parts[int(tens(cards[1])[0])] = (cards[0], *[int(v) for v in tens(cards[1])[1:]])
        elif key == "*MAT_ELASTIC":
            number, density, young, poisson = tens(cards[0])
            materials[int(number)] = (float(young), float(poisson), float(density))
        elif key in ("*SECTION_SOLID", "*SECTION_SHELL"):
            sections[int(tens(cards[0])[0])] = (key, int(tens(cards[0])[1]))
    ten = len(set(elements[0][1])) > 4
    need(sections[1] == ("*SECTION_SOLID", 16 if ten else 10), "formulation of the tetrahedra")
    need(all(len(n) == (10 if ten else 8) and (ten or len(set(n[3:])) == 1) for _, n in elements), "nodes of a tetrahedron")
    deck = Deck(points, np.array([n[:10 if ten else 4] for _, n in elements]) - 1)
    for number, (name, section, material) in parts.items():
        need(section in sections and material in materials, f"part {number}")
        deck.materials[name] = materials[material]
    deck.values["E"] = np.array([materials[parts[p][2]][0] for p, _ in elements])
    nodes_of, segments_of, dofs = {}, {}, {1: "x", 2: "y", 3: "z", 4: "xy", 5: "yz", 6: "zx", 7: "xyz"}
    for key, cards in blocks:
        if key.startswith("*SET_"):
            number = int(tens(cards[1])[0])
            if key == "*SET_SEGMENT_TITLE":
                need(number not in segments_of, f"segment set {number} twice")
                segments_of[number] = np.array([[int(v) for v in tens(c)] for c in cards[2:]]) - 1
                need((segments_of[number][:, 2] == segments_of[number][:, 3]).all(), "segments are triangles")
                deck.face_sets[cards[0]] = segments_of[number][:, :3]
                continue
            ids = [int(v) for c in cards[2:] for v in tens(c)]
            if key == "*SET_NODE_LIST_TITLE":
                need(number not in nodes_of, f"node set {number} twice")
                nodes_of[number] = np.array(ids) - 1
                if not cards[0].startswith("tied_to_"):
                    deck.node_sets[cards[0]] = nodes_of[number]
            else:
                need(key == "*SET_PART_LIST_TITLE", key)
                deck.parts[cards[0]] = np.array([e for e, (p, _) in enumerate(elements) if p in ids])
    curves = {int(tens(c[0])[0]) for k, c in blocks if k == "*DEFINE_CURVE"}
    for key, cards in blocks:
        f = tens(cards[0]) if key.startswith(("*BOUNDARY", "*LOAD", "*CONSTRAINED")) else []
        if key == "*BOUNDARY_SPC_SET":
            for node in nodes_of[int(f[0])]:
                deck.fixed.update({(node, axis): 0.0 for axis in range(3) if int(f[2 + axis])})
        elif key == "*BOUNDARY_PRESCRIBED_MOTION_SET":
            need(int(f[2]) == 2 and int(f[3]) in curves, "a displacement by a curve")
            deck.fixed.update({(node, int(f[1]) - 1): float(f[4]) for node in nodes_of[int(f[0])]})
        elif key == "*LOAD_NODE_POINT":
            for card in cards:
                node, axis, curve, force = tens(card)
                need(int(curve) in curves, card)
                deck.forces[int(node) - 1, int(axis) - 1] = float(force)
        elif key == "*LOAD_SEGMENT_SET":
            need(int(f[1]) in curves, key)
            deck.pressures += [(s[:3], float(f[2])) for s in segments_of[int(f[0])]]
        elif key.startswith("*LOAD_BODY_"):
            deck.gravity["XYZ".index(key[-1])] = -float(f[1])
        elif key == "*CONSTRAINED_NODE_SET":
            deck.coupled.append((dofs[int(f[1])], list(nodes_of[int(f[0])])))
    return deck


def read_exo(path):
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    reader = vtk.vtkExodusIIReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    kinds = (reader.ELEM_BLOCK, reader.SIDE_SET, reader.NODE_SET)
    for kind in kinds:
        for k in range(reader.GetNumberOfObjects(kind)):
            reader.SetObjectStatus(kind, k, 1)
    for k in range(reader.GetNumberOfElementResultArrays()):
        reader.SetElementResultArrayStatus(reader.GetElementResultArrayName(k), 1)
    reader.GenerateGlobalNodeIdArrayOn()
    reader.GenerateGlobalElementIdArrayOn()
    reader.Update()
    out, names = reader.GetOutput(), {kind: [reader.GetObjectName(kind, k) for k in range(reader.GetNumberOfObjects(kind))] for kind in kinds}
    place = {kind: [k for k in range(out.GetNumberOfBlocks()) if out.GetMetaData(k).Get(vtk.vtkCompositeDataSet.NAME()) == text][0]
             for kind, text in zip(kinds, ("Element Blocks", "Side Sets", "Node Sets"))}
    points, tets, labels, values = {}, {}, {}, {}

    def cells(grid, count):
        ids = vtk_to_numpy(grid.GetPointData().GetArray("GlobalNodeId"))
        rows = []
        for c in range(grid.GetNumberOfCells()):
            rows.append([int(ids[grid.GetCell(c).GetPointId(k)]) - 1 for k in range(count or grid.GetCell(c).GetNumberOfPoints())])
        return rows, ids

    parts = {}
    for k, name in enumerate(names[reader.ELEM_BLOCK]):
        grid = out.GetBlock(place[reader.ELEM_BLOCK]).GetBlock(k)
        rows, ids = cells(grid, 0)
        number = vtk_to_numpy(grid.GetCellData().GetArray("GlobalElementId")) - 1
        points.update(zip((int(v) - 1 for v in ids), vtk_to_numpy(grid.GetPoints().GetData()).astype(float)))
        tets.update(zip(number, rows))
        labels.update({n: reader.GetObjectId(reader.ELEM_BLOCK, k) for n in number})
        parts[name] = number
        for a in range(reader.GetNumberOfElementResultArrays()):
            array = grid.GetCellData().GetArray(reader.GetElementResultArrayName(a))
            values.setdefault(array.GetName(), {}).update(zip(number, vtk_to_numpy(array)))
    deck = Deck([points[k] for k in sorted(points)], [tets[k] for k in sorted(tets)], np.array([labels[k] for k in sorted(labels)]))
    deck.parts, deck.values = parts, {n: np.array([v[k] for k in sorted(v)]) for n, v in values.items()}
    deck.values["E"] = deck.values.get("modulus_MPa")
    for k, name in enumerate(names[reader.NODE_SET]):
        deck.node_sets[name] = vtk_to_numpy(out.GetBlock(place[reader.NODE_SET]).GetBlock(k).GetPointData().GetArray("GlobalNodeId")) - 1
    for k, name in enumerate(names[reader.SIDE_SET]):
        deck.face_sets[name] = np.array(cells(out.GetBlock(place[reader.SIDE_SET]).GetBlock(k), 3)[0])
    return deck


def read_med(path):
    import meshio
    mesh = meshio.read(path)
    cells = {c.type: (c.data, tags) for c, tags in zip(mesh.cells, mesh.cell_data["cell_tags"])}
    tets, tags = cells.get("tetra", cells.get("tetra10"))
    # MED looks at a tetrahedron from the other side: its second and third corner change places, and the mid-side nodes of
    # edges 12, 23, 31, 14, 24, 34 with them.
    tets = tets[:, [0, 2, 1, 3] + ([6, 5, 4, 7, 9, 8] if tets.shape[1] == 10 else [])]
    deck = Deck(mesh.points, tets)
    names = {n for groups in mesh.cell_tags.values() for n in groups}
    for name in names:
        families = [f for f, groups in mesh.cell_tags.items() if name in groups]
        if np.isin(tags, families).any():
            deck.parts[name] = np.flatnonzero(np.isin(tags, families))
        for kind in ("triangle", "triangle6"):
            if kind in cells and np.isin(cells[kind][1], families).any():
                deck.face_sets[name] = cells[kind][0][np.isin(cells[kind][1], families)][:, :3]
    for family, groups in mesh.point_tags.items():
        for name in groups:
            deck.node_sets[name] = np.sort(np.append(deck.node_sets.get(name, np.empty(0, int)), np.flatnonzero(mesh.point_data["point_tags"] == family)))
    for name, values in mesh.cell_data.items():
        if name.startswith(("modulus_MPa", "density")):
            deck.values[name.split("[")[0]] = values[[c.type for c in mesh.cells].index("tetra10" if tets.shape[1] == 10 else "tetra")].ravel()
    deck.values["E"] = deck.values.get("modulus_MPa")
    return deck


READERS = {".cdb": read_cdb, ".k": read_k, ".exo": read_exo, ".med": read_med}


def summary(path):
    """What a deck says of materials and loads, in a few numbers."""
    import os
    deck = READERS[os.path.splitext(path)[1]](path)
    force, pressed = np.zeros(3), np.zeros(3)
    for (_, axis), value in deck.forces.items():
        force[axis] += value
    for corners, p in deck.pressures:
        a, b, c = deck.points[list(corners)]
        pressed -= p * np.cross(b - a, c - a) / 2  # against the outward normal
    apart = [float(np.ptp(deck.points[nodes], axis=0).max()) for _, nodes in deck.coupled]
    young = deck.values.get("E")
    return {"tets": len(deck.tets), "force": force.tolist(), "pressed": pressed.tolist(), "gravity": deck.gravity.tolist(),
            "held": sum(v == 0 for v in deck.fixed.values()), "moved": sum(v != 0 for v in deck.fixed.values()),
            "moved_mm": max(deck.fixed.values(), default=0), "E": None if young is None else [float(young.min()), float(young.max())],
            "materials": len(deck.materials), "coupled": len({(n, a) for axes, nodes in deck.coupled for n in nodes[1:] for a in axes}),
            "coupled_apart": max(apart, default=0), "parts": {n: len(v) for n, v in deck.parts.items()},
            "node_sets": {n: len(v) for n, v in deck.node_sets.items()}, "face_sets": {n: len(v) for n, v in deck.face_sets.items()}}


if __name__ == "__main__":
    import json
    import sys
    print(json.dumps({path: summary(path) for path in sys.argv[1:]}))
