"""The module of 3D Slicer (apps/slicer), with a stub of Slicer's API that records its calls, and the real program. NOT TESTED here: Slicer itself."""

import importlib.util
import os
import sys
import types
import unittest

import numpy as np
from support import PROGRAM, SOURCE, ball


def write_seg_nrrd(path, labels, segments):
    """A segmentation as Slicer saves it: {number: (name, colour)}."""
    head = ["NRRD0004", "type: unsigned char", "dimension: 3", "space: left-posterior-superior", "sizes: %d %d %d" % labels.shape,
            "space directions: (1,0,0) (0,1,0) (0,0,1.5)", "kinds: domain domain domain", "encoding: raw", "space origin: (3,4,5)"]
    for n, (value, (name, colour)) in enumerate(segments.items()):
        head += [f"Segment{n}_ID:={name}", f"Segment{n}_Name:={name}", f"Segment{n}_LabelValue:={value}", f"Segment{n}_Layer:=0",
                 f"Segment{n}_Color:={' '.join(str(c) for c in colour)}", f"Segment{n}_Extent:=0 {labels.shape[0] - 1} 0 {labels.shape[1] - 1} 0 {labels.shape[2] - 1}"]
    with open(path, "wb") as f:
        f.write(("\n".join(head) + "\n\n").encode() + labels.astype(np.uint8).tobytes(order="F"))


class Display:
    def __init__(self):
        self.colour, self.visible = None, True

    def SetColor(self, r, g, b):
        self.colour = (r, g, b)

    def SetVisibility(self, on):
        self.visible = on


class Model:
    """A vtkMRMLModelNode."""

    def __init__(self, name):
        self.name, self.display, self.storage = name, Display(), "set"

    def SetName(self, name):
        self.name = name

    def GetName(self):
        return self.name

    def GetDisplayNode(self):
        return self.display

    def SetAndObserveStorageNodeID(self, value):
        self.storage = value


class Hierarchy:
    """A vtkMRMLSubjectHierarchyNode: items are numbers."""

    def __init__(self):
        self.folders, self.parents, self.items = {}, {}, {}

    def GetSceneItemID(self):
        return 1

    def CreateFolderItem(self, parent, name):
        item = 10 + len(self.folders)
        self.folders[item] = (parent, name)
        return item

    def GetItemByDataNode(self, node):
        return self.items.setdefault(id(node), 100 + len(self.items))

    def SetItemParent(self, item, parent):
        self.parents[item] = parent


class Segmentation:
    """A vtkMRMLSegmentationNode."""

    def __init__(self, labels, segments):
        self.labels, self.segments = labels, segments

    def GetName(self):
        return "Segmentation"


class FakeSlicer:
    def __init__(self):
        self.hierarchy, self.loaded, self.saved, self.events = Hierarchy(), [], [], 0
        module = types.ModuleType("slicer")
        base = types.ModuleType("slicer.ScriptedLoadableModule")
        for name in ("ScriptedLoadableModule", "ScriptedLoadableModuleLogic", "ScriptedLoadableModuleTest", "ScriptedLoadableModuleWidget"):
            setattr(base, name, type(name, (), {"__init__": lambda self, parent=None: setattr(self, "parent", parent)}))
        module.ScriptedLoadableModule = base
        module.util = types.SimpleNamespace(saveNode=self.save, loadNodeFromFile=self.load)
        module.app = types.SimpleNamespace(processEvents=self.event)
        module.mrmlScene = types.SimpleNamespace(GetSubjectHierarchyNode=lambda: self.hierarchy)
        module.vtkMRMLStorageNode = types.SimpleNamespace(CoordinateSystemLPS=1, CoordinateSystemRAS=0)
        self.modules = {"slicer": module, "slicer.ScriptedLoadableModule": base, "qt": types.ModuleType("qt")}

    def event(self):
        self.events += 1

    def save(self, node, path):
        self.saved.append(path)
        write_seg_nrrd(path, node.labels, node.segments)
        return True

    def load(self, path, kind, properties):
        self.loaded.append((os.path.basename(path), kind, properties, os.path.getsize(path)))
        return Model(properties["name"])


class Slicer(unittest.TestCase):
    def setUp(self):
        self.slicer = FakeSlicer()
        before = {name: sys.modules.get(name) for name in self.slicer.modules}
        sys.modules.update(self.slicer.modules)
        self.addCleanup(lambda: [sys.modules.pop(n) if m is None else sys.modules.__setitem__(n, m) for n, m in before.items()])
        spec = importlib.util.spec_from_file_location("StackMesh", os.path.join(SOURCE, "apps", "slicer", "StackMesh", "StackMesh.py"))
        self.module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.module)
        self.logic = self.module.StackMeshLogic()
        self.node = Segmentation(ball(), {2: ("core of it", (1, 0, 0)), 5: ("shell", (0, 0.5019607843137255, 1))})

    def test_segments_become_models_with_names_colours_and_a_folder(self):
        models = self.logic.mesh(self.node, program=PROGRAM)
        self.assertEqual(sorted(models), ["core of it", "shell", "tetrahedra"])
        self.assertEqual(models["core of it"].display.colour, (1, 0, 0))
        self.assertTrue(np.allclose(models["shell"].display.colour, (0, 128 / 255, 1)))
        self.assertFalse(models["tetrahedra"].display.visible)
        self.assertEqual([(n, k) for n, k, _, _ in self.slicer.loaded], [("surface_2.stl", "ModelFile"), ("surface_5.stl", "ModelFile"), ("tetrahedra.vtu", "ModelFile")])
        self.assertTrue(all(p["coordinateSystem"] == 1 and size > 1000 for _, _, p, size in self.slicer.loaded))
        (folder, (parent, name)), = self.slicer.hierarchy.folders.items()
        self.assertEqual((parent, name), (1, "Segmentation mesh"))
        self.assertEqual(set(self.slicer.hierarchy.parents.values()), {folder})
        self.assertEqual(len(self.slicer.hierarchy.parents), 3)
        self.assertTrue(all(m.storage is None for m in models.values()))
        self.assertGreater(self.slicer.events, 0)
        self.assertFalse(os.path.exists(os.path.dirname(self.slicer.saved[0])), "the folder of the run stays behind")

    def test_surfaces_alone_and_options(self):
        models = self.logic.mesh(self.node, edgeLength=2, tetrahedra=False, more=["--label", "5", "--caps", "flat"], program=PROGRAM)
        self.assertEqual(list(models), ["shell"])
        words = self.logic.command("p", "l", "f", 2, False, ["--smooth", "3"])
        self.assertEqual(words[:3], ["p", "surface", "l"])
        self.assertEqual(words[-4:], ["--edge-length", "2.0", "--smooth", "3"])

    def test_what_the_program_says_is_told(self):
        with self.assertRaisesRegex(RuntimeError, "stackmesh: error: .*--caps"):
            self.logic.mesh(self.node, more=["--caps", "pointed"], program=PROGRAM)
        self.assertEqual(self.slicer.loaded, [])
        with self.assertRaisesRegex(ValueError, "no segmentation"):
            self.logic.mesh(None, program=PROGRAM)
        with self.assertRaisesRegex(ValueError, "/no/such/program"):
            self.logic.mesh(self.node, program="/no/such/program")

    def test_description_has_licence_and_reference(self):
        parent = types.SimpleNamespace()
        self.module.StackMesh(parent)
        self.assertEqual(parent.title, "StackMesh")
        for part in ("AGPL-3.0-or-later", "Wang", "TetGen"):
            self.assertIn(part, parent.acknowledgementText)


if __name__ == "__main__":
    unittest.main()
