#!/usr/bin/env python3
"""Checks a module description against the rules of 3D Slicer's execution model (its ModuleDescription.xsd), and what its
parser asks for beyond: distinct names and flags, indices from 0 on, defaults of the right kind. Prints every breach; exits 1.

usage: slicer_xml.py FILE
"""
import sys
import xml.etree.ElementTree as tree

SEQUENCE = ["category", "title", "description", "version", "documentation-url", "license", "contributor"]
SCALAR = {"integer", "integer-vector", "boolean", "boolean-vector", "float", "float-vector", "double", "double-vector"}
PARAM = {"string", "string-vector", "directory"}
INDEXED = {"file", "transform", "image", "geometry", "table", "measurement"}
faults = []


def need(condition, text):
    if not condition:
        faults.append(text)


def text(element, tag):
    found = element.findall(tag)
    need(len(found) <= 1, f"{element.tag}: {tag} twice")
    return (found[0].text or "") if found else None


root = tree.parse(sys.argv[1]).getroot()
need(root.tag == "executable", "the root is no executable")
tags = [e.tag for e in root]
need(tags[: len(SEQUENCE)] == SEQUENCE, f"the description begins with {tags}")
need(tags[len(SEQUENCE):] and set(tags[len(SEQUENCE):]) == {"parameters"}, "only parameters may follow")
need(all(text(root, t) for t in ("category", "title", "description", "version")), "an empty head")

names, flags, indices = [], [], []
for group in root.findall("parameters"):
    need(text(group, "label") and text(group, "description"), "a group of parameters without label or description")
    for p in group:
        if p.tag in ("label", "description"):
            continue
        children = [c.tag for c in p]
        name = text(p, "name")
        need(name and name.isidentifier(), f"a {p.tag} has the name {name!r}")
        names.append(name)
        need(text(p, "label") and text(p, "description"), f"{name}: no label or description")
        if p.tag in INDEXED:
            need(sorted(children) == ["channel", "description", "index", "label", "name"], f"{name}: has {children}")
            need(text(p, "channel") in ("input", "output"), f"{name}: channel")
            indices.append(int(text(p, "index")))
            need(set(p.attrib) <= {"fileExtensions", "reference", "type", "hidden"}, f"{name}: attributes {p.attrib}")
        elif p.tag in SCALAR | PARAM:
            allowed = {"name", "flag", "longflag", "description", "label", "default"} | ({"constraints"} if p.tag in SCALAR else set())
            need(set(children) <= allowed, f"{name}: has {children}")
            need(set(p.attrib) <= {"multiple", "hidden"}, f"{name}: attributes {p.attrib}")
            flag = text(p, "longflag")
            need(flag and flag.startswith("--"), f"{name}: flag {flag!r}")
            flags.append(flag)
            default = text(p, "default")
            need(default is not None, f"{name}: no default")
            if p.tag == "boolean":
                need(default in ("true", "false"), f"{name}: default {default!r}")
            if p.tag in ("double", "integer"):
                need(float(default) == (float(default) if p.tag == "double" else int(default)), f"{name}: default {default!r}")
        else:
            need(False, f"an element {p.tag}")
need(len(set(names)) == len(names), "names are not distinct")
need(len(set(flags)) == len(flags), "flags are not distinct")
need(sorted(indices) == list(range(len(indices))), f"indices {indices}")
print("\n".join(faults))
sys.exit(1 if faults else 0)
