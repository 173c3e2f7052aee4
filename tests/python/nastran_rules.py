"""A reader of the bulk data that decks of stackmesh use, by the fixed fields that Nastran documents; it knows no writer.

check(path) returns what a deck does wrong, as a list of texts, and what it holds.
"""
import re


def fields(lines, at):
    """The card that begins at a line: its name, its fields, and the line behind it."""
    first = lines[at]
    large = first[:8].rstrip().endswith("*")
    width, per_line = (16, 4) if large else (8, 8)
    name = first[:8].strip().rstrip("*")
    values, i = [], at
    while True:
        body = lines[i][8:8 + width * per_line].ljust(width * per_line)
        values += [body[k:k + width].strip() for k in range(0, width * per_line, width)]
        i += 1
        if i == len(lines) or lines[i][:1] not in ("+", "*"):
            return name, values, i


def real(text):
    """Nastran's reals have a point; an exponent may stand without E."""
    if "." not in text:
        raise ValueError(text)
    return float(re.sub(r"(?<=[0-9.])([+-])", r"E\1", text) if "E" not in text.upper() else text)


def more(name, f, wrong, solids, materials, numbers, sets, pressures):
    """Cards of materials other than MAT1, springs, and loads other than forces."""
    if name == "PLSOLID":
        solids[int(f[0])] = int(f[1])
    elif name == "MATHP":
        if not real(f[1]) + real(f[2]) > 0 or not real(f[3]) > 0:
            wrong.append(f"MATHP {f[0]}")
        materials[int(f[0])] = 6 * (real(f[1]) + real(f[2]))
    elif name == "MAT11":
        if not all(real(v) > 0 for v in f[1:4] + f[7:10]) or not all(-1 < real(v) < 1 for v in f[4:7]):
            wrong.append(f"MAT11 {f[0]}")
        materials[int(f[0])] = real(f[1])
    elif name == "CORD2R":
        if f[1] != "" or [real(v) for v in f[2:5]] != [0, 0, 0] or len([real(v) for v in f[5:11]]) != 6:
            wrong.append(f"CORD2R {f[0]}")
    elif name == "CONROD":
        if not real(f[4]) > 0 or int(f[3]) not in materials:
            wrong.append(f"CONROD {f[0]}")
        numbers.append(int(f[0]))
    elif name == "CELAS2":
        if not real(f[1]) > 0 or f[3] not in ("1", "2", "3") or any(f[4:6]):
            wrong.append(f"CELAS2 {f[0]}")
        numbers.append(int(f[0]))
    elif name == "MOMENT":
        if f[2] != "0" or real(f[3]) != 1:
            wrong.append(f"MOMENT on {f[1]}")
        sets.add(("LOAD", f[0]))
    elif name == "GRAV":
        if f[1] != "0" or not real(f[2]) > 0 or abs(sum(real(v) ** 2 for v in f[3:6]) - 1) > 1e-9:
            wrong.append(f"GRAV {f[0]}")
        sets.add(("LOAD", f[0]))
    elif name == "LOAD":  # a sum of others, which then are not asked for by themselves
        parts = [v for v in f[2:] if v]
        if real(f[1]) != 1 or len(parts) % 2 or any(real(v) != 1 for v in parts[::2]):
            wrong.append(f"LOAD {f[0]}")
        sets.add(("LOAD", f[0]))
        sets.update(("PART", v) for v in parts[1::2])
    elif name == "NLPARM":
        sets.add(("NLPARM", f[0]))
    elif name == "EIGRL":
        if f[1] or f[2] or not int(f[3]) > 0:
            wrong.append(f"EIGRL {f[0]}")
        sets.add(("METHOD", f[0]))
    elif name == "PARAM":
        if f[:2] != ["LGDISP", "1"]:
            wrong.append(f"PARAM {f[0]}")
    elif name == "PLOAD4":
        real(f[2])
        if any(f[3:6]):
            wrong.append(f"PLOAD4 {f[1]}: four pressures")
        sets.add(("LOAD", f[0]))
        pressures.append((int(f[1]), [int(v) for v in f[6:8] if v]))


def check(path):
    wrong = []
    with open(path) as file:
        lines = [line for line in file.read().split("\n") if not line.startswith("$")]
    if any(len(line) > 80 for line in lines):
        wrong.append("a line is longer than 80 characters")
    begin = lines.index("BEGIN BULK")
    end = lines.index("ENDDATA")
    solution = lines[0].split()[-1]
    if lines[0] not in ("SOL 101", "SOL 103", "SOL 106") or lines[1] != "CEND" or any(lines[end + 1:]):
        wrong.append("SOL, CEND or ENDDATA")
    nodes, elements, materials, solids, shells = {}, {}, {}, {}, {}
    held, forces, enforced, followers, numbers = {}, {}, {}, {}, []
    forces_seen = set()
    sets, bound, pressures = set(), {}, []  # load and support sets; nodes of rigid elements; faces
    i = begin + 1
    while i < end:
        name, f, i = fields(lines, i)
        if name == "GRID":
            if f[1] != "" or int(f[0]) in nodes or (len(f) > 6 and f[6] not in ("", "123456")):
                wrong.append(f"GRID {f[0]}")
            nodes[int(f[0])] = tuple(real(v) for v in f[2:5])
        elif name in ("CTETRA", "CPENTA", "CPYRAM", "CTRIA3", "CTRIA6"):
            count = {"CTETRA": (4, 10), "CPENTA": (6, 15), "CPYRAM": (5, 13), "CTRIA3": (3,), "CTRIA6": (6,)}[name]
            v = [int(x) for x in f[2:] if x]
            if len(v) not in count or len(set(v)) != len(v) or any(x for x in f[2 + len(v):]):
                wrong.append(f"{name} {f[0]}")
            elements[int(f[0])] = (name, int(f[1]), v)
            numbers.append(int(f[0]))
        elif name == "MAT1":
            if f[2] != "" or not (real(f[1]) > 0 and -1 < real(f[3]) < 0.5 and real(f[4]) >= 0):
                wrong.append(f"MAT1 {f[0]}")
            materials[int(f[0])] = real(f[1])
        elif name == "PSOLID":
            solids[int(f[0])] = int(f[1])
        elif name == "PSHELL":
            if not real(f[2]) > 0:
                wrong.append(f"PSHELL {f[0]}")
            shells[int(f[0])] = int(f[1])
        elif name in ("PLSOLID", "MATHP", "MAT11", "CORD2R", "CONROD", "CELAS2", "MOMENT", "GRAV", "LOAD", "NLPARM", "EIGRL", "PARAM", "PLOAD4"):
            more(name, f, wrong, solids, materials, numbers, sets, pressures)
        elif name == "SPC1":
            sets.add(("SPC", f[0]))
            for v in f[2:]:
                if v:
                    held.setdefault(int(v), set()).update(f[1])
        elif name == "SPCD":
            sets.add(("LOAD", f[0]))
            enforced[int(f[1]), f[2]] = real(f[3])
        elif name == "FORCE":
            if f[2] != "0" or real(f[3]) != 1 or (f[0], int(f[1])) in forces_seen:
                wrong.append(f"FORCE on {f[1]}")
            forces_seen.add((f[0], int(f[1])))
            sets.add(("LOAD", f[0]))
            forces[int(f[1])] = tuple(real(v) for v in f[4:7])
        elif name == "RBE2" and len([v for v in f if v]) > 4:  # many nodes bound to a point
            members = [int(v) for v in f[3:] if v]
            if f[2] != "123" or len(set(members)) != len(members) or int(f[1]) in members:
                wrong.append(f"RBE2 {f[0]}")
            bound.update({v: int(f[1]) for v in members})
            numbers.append(int(f[0]))
        elif name == "RBE2":
            if int(f[3]) in followers or any(f[4:]):
                wrong.append(f"RBE2 {f[0]}: node {f[3]} follows twice")
            followers[int(f[3])] = (int(f[1]), set(f[2]))
            numbers.append(int(f[0]))
        else:
            wrong.append(f"unknown card {name}")
    if len(set(numbers)) != len(numbers):
        wrong.append("an element number is there twice")
    for number, (name, property_id, v) in elements.items():
        of = (solids if name in ("CTETRA", "CPENTA", "CPYRAM") else shells).get(property_id)
        if of not in materials or not set(v) <= nodes.keys():
            wrong.append(f"{name} {number}: property, material or node is not there")
            break
    for what, where in (("SPC1", held), ("FORCE", forces), ("SPCD", [n for n, _ in enforced])):
        if not set(where) <= nodes.keys():
            wrong.append(f"{what} names a node that is not there")
    if any(axis not in held.get(n, ()) for n, axis in enforced):
        wrong.append("SPCD without SPC1")
    for number, face in pressures:  # a corner of the face, and the corner that is not on it
        corners = elements.get(number, ("", 0, []))[2][:4]
        kind = elements.get(number, ("",))[0]
        if kind == "CPENTA" and len(face) == 1 and face[0] in elements[number][2][:6]:
            continue  # a triangle: any of its corners
        base = elements[number][2][:4] if kind == "CPYRAM" else []
        if len(face) == 2 and set(face) <= set(base) and (base.index(face[0]) - base.index(face[1])) % 4 in (1, 3):
            continue  # a triangle: the edge that it shares with the base
        if kind != "CTETRA" or len(face) != 2 or not set(face) <= set(corners) or face[0] == face[1]:
            wrong.append(f"PLOAD4 on {number}")
    if any(v in held or v in followers for v in bound):
        wrong.append("a node that is bound to a point is held, or follows another")
    # Case control: sets of numbers that are there, and the loads that are.
    control = "\n".join(lines[2:begin])
    for text in re.findall(r"^SET \d+ = ((?:[\d, ]+\n?)+)", control, re.M):
        if not {int(v) for v in text.replace("\n", "").split(",")} <= nodes.keys() | elements.keys():
            wrong.append("a SET names what is not there")
    asked = set()
    for kind, number in re.findall(r"^ *(SPC|LOAD|METHOD|NLPARM) = (\d+)$", control, re.M):
        asked.add((kind, number))
    given = {s for s in sets if s[0] != "PART"} - {("LOAD", n) for kind, n in sets if kind == "PART"}
    if asked != given:
        wrong.append(f"asked for {sorted(asked - given)}, not asked for {sorted(given - asked)}")
    if solution == "103" and any(kind == "LOAD" for kind, _ in asked):
        wrong.append("case control does not say what the bulk data hold")
    # Ties: no node follows one that follows; they lie on each other; nothing that is held follows.
    for node, (other, axes) in followers.items():
        if other in followers or nodes[node] != nodes[other] or not axes or axes & held.get(node, set()) or axes | held.get(node, set()) != set("123"):
            wrong.append(f"node {node} cannot follow {other}")
            break
    return wrong, {"nodes": nodes, "elements": elements, "held": held, "forces": forces, "followers": followers}


if __name__ == "__main__":  # FILE.bdf: exit 1 with what is wrong
    import sys
    found, _ = check(sys.argv[1])
    print("\n".join(found))
    sys.exit(1 if found else 0)
