"""What FEBio 4 takes: its sections, elements, attributes and parameters, as far as decks of stackmesh use them.

Written down from the format's documentation and from what FEBio 4's own reader accepts (it stops at what it does not know); nothing here
is taken from the writer. check(root) returns what a deck does wrong, as a list of texts.
"""

NUMBER, WHOLE, FLAG, TEXT, NUMBERS = "number", "whole", "flag", "text", "numbers"
AXES = ("x", "y", "z")

# A tag: (attributes that must be there, that may be there, children).
# Children: a tag's name to its rule, "PARAMETERS" to {name: kind or tuple of words}, or a kind where the tag holds text.
LAGRANGE = {"laugon": ("PENALTY", "AUGLAG"), "tolerance": NUMBER, "gaptol": NUMBER, "penalty": NUMBER, "auto_penalty": FLAG, "two_pass": FLAG,
            "knmult": NUMBER, "search_tol": NUMBER, "symmetric_stiffness": FLAG, "search_radius": NUMBER, "minaug": WHOLE, "maxaug": WHOLE}
BY_TYPE = {
    "material": {"isotropic elastic": {"density": NUMBER, "E": NUMBER, "v": NUMBER},
                 "orthotropic elastic": {"density": NUMBER, **{n: NUMBER for n in ("E1", "E2", "E3", "G12", "G23", "G31", "v12", "v23", "v31")}},
                 "Mooney-Rivlin": {"density": NUMBER, "c1": NUMBER, "c2": NUMBER, "k": NUMBER},
                 "Holzapfel-Gasser-Ogden": {"density": NUMBER, **{n: NUMBER for n in ("c", "k1", "k2", "kappa", "gamma", "k")}},
                 "rigid body": {"density": NUMBER, "center_of_mass": NUMBERS}},
    "surface_load": {"pressure": {"pressure": NUMBER, "linear": FLAG, "symmetric_stiffness": FLAG, "shell_bottom": FLAG}},
    "body_load": {"body force": {"force": NUMBERS}},
    "rigid_bc": {"rigid_fixed": {"rb": TEXT, **{f"R{d}_dof": FLAG for d in "xyzuvw"}},
                 "rigid_displacement": {"rb": TEXT, "dof": AXES, "value": NUMBER, "relative": FLAG},
                 "rigid_rotation": {"rb": TEXT, "dof": ("Ru", "Rv", "Rw"), "value": NUMBER, "relative": FLAG}},
    "rigid_load": {"rigid_force": {"rb": TEXT, "dof": ("Rx", "Ry", "Rz"), "value": NUMBER},
                   "rigid_moment": {"rb": TEXT, "dof": ("Ru", "Rv", "Rw"), "value": NUMBER}},
    "discrete_material": {"linear spring": {"E": NUMBER}},
    "bc": {"rigid": {"rb": TEXT}, "zero displacement": {f"{a}_dof": FLAG for a in AXES},
           "prescribed displacement": {"dof": AXES, "value": NUMBER, "relative": FLAG}},
    "nodal_load": {"nodal_force": {"value": NUMBERS}},
    "contact": {"tied-elastic": LAGRANGE,
                "sliding-elastic": {**LAGRANGE, "update_penalty": FLAG, "seg_up": WHOLE, "tension": FLAG, "node_reloc": FLAG, "fric_coeff": NUMBER,
                                    "smooth_aug": FLAG, "flip_primary": FLAG, "flip_secondary": FLAG, "offset": NUMBER}},
    "load_controller": {"loadcurve": {"interpolate": ("STEP", "LINEAR", "SMOOTH"), "extend": ("CONSTANT", "EXTRAPOLATE", "REPEAT", "REPEAT OFFSET"), "points": None}},
    "solver": {"solid": {"symmetric_stiffness": ("symmetric", "non-symmetric", "structure")}},
}
# The attribute that names what a tag refers to, and what that is.
REFERENCES = {"surface_load": ("surface", "Surface"), "discrete": ("discrete_set", "DiscreteSet"), "bc": ("node_set", "NodeSet"), "nodal_load": ("node_set", "NodeSet"), "contact": ("surface_pair", "SurfacePair"),
              "NodeData": ("node_set", "NodeSet"), "ElementData": ("elem_set", "Elements"), "SolidDomain": ("name", "Elements"), "ShellDomain": ("name", "Elements")}
ELEMENTS = {"tet4": 4, "tet10": 10, "penta6": 6, "penta15": 15, "pyra5": 5, "pyra13": 13, "tri3": 3, "tri6": 6}
SECTIONS = {  # section: the children it may have, and the sections that must have been read before it
    "Module": ({"units"}, ()),
    "Control": ({"analysis", "time_steps", "step_size", "solver"}, ("Module",)),
    "Material": ({"material"}, ("Module",)),
    "Mesh": ({"Nodes", "Elements", "NodeSet", "Surface", "SurfacePair", "DiscreteSet"}, ("Module",)),
    "MeshDomains": ({"SolidDomain", "ShellDomain"}, ("Material", "Mesh")),
    "MeshData": ({"NodeData", "ElementData"}, ("MeshDomains",)),
    "Boundary": ({"bc"}, ("MeshDomains",)),
    "Rigid": ({"rigid_bc", "rigid_load"}, ("MeshDomains",)),
    "Loads": ({"nodal_load", "surface_load", "body_load"}, ("MeshDomains",)),
    "Discrete": ({"discrete_material", "discrete"}, ("MeshDomains",)),
    "Step": ({"step"}, ("MeshDomains",)),
    "Contact": ({"contact"}, ("MeshDomains",)),
    "LoadData": ({"load_controller"}, ("Module",)),
    "Output": ({"plotfile"}, ("Module",)),
}
ATTRIBUTES = {  # needed, possible
    "febio_spec": ({"version"}, set()), "Module": ({"type"}, set()), "material": ({"id", "name", "type"}, set()), "Nodes": (set(), {"name"}),
    "node": ({"id"}, set()), "Elements": ({"type", "name"}, set()), "elem": ({"id"}, set()), "NodeSet": ({"name"}, set()), "Surface": ({"name"}, set()),
    "tri3": ({"id"}, set()), "tri6": ({"id"}, set()), "SurfacePair": ({"name"}, set()), "SolidDomain": ({"name", "mat"}, {"type", "elem_type"}),
    "ShellDomain": ({"name", "mat"}, {"type", "elem_type"}), "NodeData": ({"name", "node_set"}, {"data_type"}), "ElementData": ({"elem_set"}, {"name", "type", "data_type"}),
    "surface_load": ({"surface", "type"}, {"name"}), "pressure": (set(), {"lc", "type"}), "body_load": ({"type"}, {"name"}), "force": (set(), {"lc"}),
    "rigid_bc": ({"type"}, {"name"}), "rigid_load": ({"type"}, {"name"}), "DiscreteSet": ({"name"}, set()), "discrete_material": ({"id", "type"}, {"name"}),
    "discrete": ({"dmat", "discrete_set"}, set()), "step": ({"id"}, {"name"}),
    "bc": ({"node_set", "type"}, {"name"}), "nodal_load": ({"node_set", "type"}, {"name"}), "contact": ({"surface_pair", "type"}, {"name"}),
    "load_controller": ({"id", "type"}, {"name"}), "solver": ({"type"}, set()), "plotfile": ({"type"}, {"file"}), "var": ({"type"}, set()),
    "value": (set(), {"lc", "type"}), "E": (set(), {"type"}), "density": (set(), {"type"}),
}


def is_kind(text, kind):
    text = (text or "").strip()
    if isinstance(kind, tuple):
        return text in kind
    if kind == TEXT:
        return text != ""
    try:
        numbers = [float(v) for v in text.split(",")]
    except ValueError:
        return False
    if kind == FLAG:
        return text in ("0", "1")
    if kind == WHOLE:
        return len(numbers) == 1 and numbers[0] == int(numbers[0])
    return kind == NUMBERS or len(numbers) == 1


def attributes(tag, wrong):
    # In MeshData a node or an element has its place in the set.
    needed, possible = ATTRIBUTES.get(tag.tag, (set(), set()))
    if "lid" in tag.keys() and tag.tag in ("node", "elem"):
        needed = {"lid"}
    given = set(tag.keys())
    if needed - given:
        wrong.append(f"<{tag.tag}> lacks {sorted(needed - given)}")
    if given - needed - possible:
        wrong.append(f"<{tag.tag}> has an attribute that is not known: {sorted(given - needed - possible)}")


def parameters(tag, wrong):
    known = BY_TYPE[tag.tag].get(tag.get("type"))
    if known is None:
        wrong.append(f"<{tag.tag}> has type '{tag.get('type')}'")
        return
    names = [p.tag for p in tag]
    if len(set(names)) != len(names):
        wrong.append(f"a parameter of <{tag.tag}> is there twice")
    for p in tag:
        if p.tag not in known:
            wrong.append(f"<{p.tag}> is no parameter of {tag.tag} '{tag.get('type')}'")
        elif known[p.tag] is not None and p.get("type") != "map" and not is_kind(p.text, known[p.tag]):
            wrong.append(f"<{p.tag}> of {tag.tag} '{tag.get('type')}' is '{p.text}'")


def check(root):
    wrong = []
    if root.tag != "febio_spec" or root.get("version") != "4.0":
        return ["it is no febio_spec 4.0"]
    for tag in root.iter():
        attributes(tag, wrong)
        if tag.tag in BY_TYPE:
            parameters(tag, wrong)
    read = []
    for section in root:
        if section.tag not in SECTIONS:
            wrong.append(f"<{section.tag}> is no section")
            continue
        if section.tag in read:
            wrong.append(f"section {section.tag} is there twice")
        children, before = SECTIONS[section.tag]
        for b in before:
            if b not in read:
                wrong.append(f"section {section.tag} stands before {b}")
        read.append(section.tag)
        if len(section) == 0 and section.tag != "Module":
            wrong.append(f"section {section.tag} is empty")
        for child in section:
            if child.tag not in children:
                wrong.append(f"<{child.tag}> does not belong in {section.tag}")
    if not read or read[0] != "Module":
        wrong.append("the first section is not Module")
    steps = root.findall("Step/step")
    for needed in ("Material", "Mesh", "MeshDomains", "Output") + (() if steps else ("Control",)):
        if needed not in read:
            wrong.append(f"no section {needed}")
    if wrong:
        return wrong
    if root.find("Module").get("type") != "solid":
        wrong.append("the module is not solid")
    for step in steps:  # each with a Control of its own, and what acts in it
        parts = [part.tag for part in step]
        if parts[:1] != ["Control"] or len(set(parts)) != len(parts) or set(parts) - {"Control", "Boundary", "Rigid", "Loads", "Contact"}:
            wrong.append(f"step {step.get('id')}: {parts}")
        for part in step:
            wrong += [f"<{child.tag}> does not belong in {part.tag}" for child in part if child.tag not in SECTIONS[part.tag][0]]
    if steps and root.find("Control") is not None:
        wrong.append("Control beside steps")
    for control in root.iter("Control"):
        if not is_kind(control.findtext("time_steps"), WHOLE) or not float(control.findtext("step_size") or 0) > 0 or control.findtext("analysis") not in ("STATIC", "DYNAMIC"):
            wrong.append("Control")
    mesh = root.find("Mesh")
    if mesh[0].tag != "Nodes":
        wrong.append("Mesh does not begin with Nodes")
    for block in mesh.findall("Elements"):
        count = ELEMENTS.get(block.get("type"))
        if count is None or any(len(e.text.split(",")) != count for e in block):
            wrong.append(f"elements of {block.get('name')}")
    for surface in mesh.findall("Surface"):
        for face in surface:
            if face.tag not in ("tri3", "tri6") or len(face.text.split(",")) != int(face.tag[3:]):
                wrong.append(f"a face of surface {surface.get('name')}")
    for pair in mesh.findall("SurfacePair"):
        if [p.tag for p in pair] != ["primary", "secondary"]:
            wrong.append(f"surface pair {pair.get('name')}")
        for p in pair:
            if mesh.find(f"Surface[@name='{p.text}']") is None:
                wrong.append(f"surface pair {pair.get('name')}: no surface {p.text}")
    for tag in root.iter():
        attribute, what = REFERENCES.get(tag.tag, (None, None))
        if attribute and mesh.find(f"{what}[@name='{tag.get(attribute)}']") is None:
            wrong.append(f"<{tag.tag}> names {what} '{tag.get(attribute)}', which is not there")
    materials = {m.get("name") for m in root.find("Material")}
    rigid = {m.get("name") for m in root.find("Material") if m.get("type") == "rigid body"}
    wrong += [f"<rb> names '{tag.text}', which is no rigid body" for tag in root.iter("rb") if tag.text not in rigid]
    springs = {m.get("id") for m in root.iter("discrete_material")}
    wrong += [f"discrete material {d.get('dmat')} is not there" for d in root.iter("discrete") if d.get("dmat") not in springs]
    ids = {node.get("id") for node in mesh.find("Nodes")}
    for element in mesh.iter("delem"):
        ends = element.text.split(",")
        if len(ends) != 2 or not set(ends) <= ids:
            wrong.append(f"<delem> {element.text}")
    for data in root.iter("ElementData"):
        if data.get("type") == "mat_axis":
            block = mesh.find(f"Elements[@name='{data.get('elem_set')}']")
            if block is None or len(block) != len(data) or any([v.tag for v in e] != ["a", "d"] or not all(len(v.text.split(",")) == 3 for v in e) for e in data):
                wrong.append("mat_axis")
        elif data.get("name") is None:
            wrong.append("ElementData without a name")
    ids = [int(m.get("id")) for m in root.find("Material")]
    if ids != list(range(1, len(ids) + 1)):
        wrong.append("ids of materials")
    for domain in root.find("MeshDomains"):
        if domain.get("mat") not in materials:
            wrong.append(f"domain {domain.get('name')}: no material {domain.get('mat')}")
        for p in domain:
            if domain.tag != "ShellDomain" or p.tag != "shell_thickness" or not is_kind(p.text, NUMBER):
                wrong.append(f"<{p.tag}> of domain {domain.get('name')}")
    controllers = [int(c.get("id")) for c in root.iter("load_controller")]
    if controllers != list(range(1, len(controllers) + 1)):
        wrong.append("ids of load controllers")
    for tag in root.iter():
        if tag.get("lc") and int(tag.get("lc")) not in controllers:
            wrong.append(f"<{tag.tag}> names load controller {tag.get('lc')}")
    return wrong


if __name__ == "__main__":  # FILE.feb: exit 1 with what is wrong
    import sys
    import xml.etree.ElementTree as ET
    found = check(ET.parse(sys.argv[1]).getroot())
    print("\n".join(found))
    sys.exit(1 if found else 0)
