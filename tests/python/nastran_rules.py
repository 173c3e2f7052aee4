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


def check(path):
    wrong = []
    with open(path) as file:
        lines = [line for line in file.read().split("\n") if not line.startswith("$")]
    if any(len(line) > 80 for line in lines):
        wrong.append("a line is longer than 80 characters")
    begin = lines.index("BEGIN BULK")
    end = lines.index("ENDDATA")
    if lines[0] != "SOL 101" or lines[1] != "CEND" or any(lines[end + 1:]):
        wrong.append("SOL, CEND or ENDDATA")
    nodes, elements, materials, solids, shells = {}, {}, {}, {}, {}
    held, forces, enforced, followers, numbers = {}, {}, {}, {}, []
    i = begin + 1
    while i < end:
        name, f, i = fields(lines, i)
        if name == "GRID":
            if f[1] != "" or int(f[0]) in nodes:
                wrong.append(f"GRID {f[0]}")
            nodes[int(f[0])] = tuple(real(v) for v in f[2:5])
        elif name in ("CTETRA", "CTRIA3", "CTRIA6"):
            count = {"CTETRA": (4, 10), "CTRIA3": (3,), "CTRIA6": (6,)}[name]
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
        elif name == "SPC1":
            for v in f[2:]:
                if v:
                    held.setdefault(int(v), set()).update(f[1])
        elif name == "SPCD":
            enforced[int(f[1]), f[2]] = real(f[3])
        elif name == "FORCE":
            if f[2] != "0" or real(f[3]) != 1 or int(f[1]) in forces:
                wrong.append(f"FORCE on {f[1]}")
            forces[int(f[1])] = tuple(real(v) for v in f[4:7])
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
        of = (solids if name == "CTETRA" else shells).get(property_id)
        if of not in materials or not set(v) <= nodes.keys():
            wrong.append(f"{name} {number}: property, material or node is not there")
            break
    for what, where in (("SPC1", held), ("FORCE", forces), ("SPCD", [n for n, _ in enforced])):
        if not set(where) <= nodes.keys():
            wrong.append(f"{what} names a node that is not there")
    if any(axis not in held.get(n, ()) for n, axis in enforced):
        wrong.append("SPCD without SPC1")
    # Case control: sets of numbers that are there, and the loads that are.
    control = "\n".join(lines[2:begin])
    for text in re.findall(r"^SET \d+ = ((?:[\d, ]+\n?)+)", control, re.M):
        if not {int(v) for v in text.replace("\n", "").split(",")} <= nodes.keys() | elements.keys():
            wrong.append("a SET names what is not there")
    if bool(held) != ("SPC = 1" in control) or bool(forces or enforced) != ("LOAD = 2" in control):
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
