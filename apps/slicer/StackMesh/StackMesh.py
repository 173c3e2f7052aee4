"""3D Slicer: a segmentation to a conforming tetrahedral mesh and closed surfaces, by the program stackmesh."""

import json
import os
import shutil
import subprocess
import tempfile
import time

import qt
import slicer
from slicer.ScriptedLoadableModule import ScriptedLoadableModule, ScriptedLoadableModuleLogic, ScriptedLoadableModuleTest, ScriptedLoadableModuleWidget

SETTING = "StackMesh/Program"


class StackMesh(ScriptedLoadableModule):
    """What Slicer shows of the module."""

    def __init__(self, parent):
        ScriptedLoadableModule.__init__(self, parent)
        self.parent.title = "StackMesh"
        self.parent.categories = ["Segmentation"]
        self.parent.dependencies = []
        self.parent.contributors = ["The founders of stackmesh"]
        self.parent.helpText = (
            "Makes one conforming tetrahedral mesh, and one closed surface for each segment, of a segmentation: segments that touch share their faces, and no surface "
            "crosses itself, which is checked before anything is loaded. Needs the program stackmesh; set its path below, or put it into PATH."
        )
        self.parent.acknowledgementText = (
            "Licence: AGPL-3.0-or-later. Method: D. Wang, O. Hassan, K. Morgan, N. Weatherill, Efficient surface reconstruction from contours based on "
            "two-dimensional Delaunay triangulation, Int. J. Numer. Meth. Engng (2005). Tetrahedra: H. Si, TetGen, ACM Trans. Math. Softw. 41 (2015)."
        )


class StackMeshWidget(ScriptedLoadableModuleWidget):
    """A segmentation, a few options, a button."""

    def setup(self):
        ScriptedLoadableModuleWidget.setup(self)
        form = qt.QFormLayout()
        self.layout.addLayout(form)
        self.segmentation = slicer.qMRMLNodeComboBox()
        self.segmentation.nodeTypes = ["vtkMRMLSegmentationNode"]
        self.segmentation.addEnabled = False
        self.segmentation.setMRMLScene(slicer.mrmlScene)
        form.addRow("Segmentation:", self.segmentation)
        self.edge = qt.QDoubleSpinBox()
        self.edge.setRange(0, 1000)
        self.edge.setSpecialValueText("by curvature")
        self.edge.setSuffix(" mm")
        form.addRow("Edge length:", self.edge)
        self.volume = qt.QCheckBox()
        self.volume.setChecked(True)
        form.addRow("Tetrahedra:", self.volume)
        self.more = qt.QLineEdit()
        self.more.setToolTip("As stackmesh mesh --help lists them: --caps flat --smooth 8")
        form.addRow("More options:", self.more)
        self.program = qt.QLineEdit(slicer.app.settings().value(SETTING, ""))
        form.addRow("Program:", self.program)
        self.button = qt.QPushButton("Mesh")
        self.button.connect("clicked(bool)", self.onApply)
        self.layout.addWidget(self.button)
        self.layout.addStretch(1)

    def onApply(self, *_):
        slicer.app.settings().setValue(SETTING, self.program.text)
        with slicer.util.tryWithErrorDisplay("The segmentation could not be meshed.", waitCursor=True):
            StackMeshLogic().mesh(self.segmentation.currentNode(), edgeLength=self.edge.value or None, tetrahedra=self.volume.checked, more=self.more.text.split(), program=self.program.text)


class StackMeshLogic(ScriptedLoadableModuleLogic):
    """Saves a segmentation, calls the program, loads what it wrote."""

    def mesh(self, segmentation, edgeLength=None, tetrahedra=True, more=(), program=""):
        """
        The models of a vtkMRMLSegmentationNode: {segment name: vtkMRMLModelNode} in a folder of the subject hierarchy, and, with `tetrahedra`, {"tetrahedra": node}.

        edgeLength is in mm (None: by curvature); more are words of the command line; program is its path ("": in PATH). Raises ValueError for a missing segmentation or program,
        RuntimeError with the program's own words where it fails.
        """
        if segmentation is None:
            raise ValueError("no segmentation is chosen")
        found = program or shutil.which("stackmesh")
        if not found or not os.access(found, os.X_OK):
            raise ValueError(f"the program stackmesh is not at '{program}'" if program else "the program stackmesh is not in PATH: give its path")
        folder = tempfile.mkdtemp(prefix="stackmesh-")
        try:
            labels = os.path.join(folder, "labels.seg.nrrd")
            if not slicer.util.saveNode(segmentation, labels):
                raise RuntimeError("the segmentation could not be saved")
            self.run(self.command(found, labels, folder, edgeLength, tetrahedra, more))
            return self.load(folder, segmentation.GetName(), tetrahedra)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def command(self, program, labels, folder, edgeLength, tetrahedra, more):
        """The command line: a surface for each label, the labels' names and colours, and the tetrahedra."""
        words = [program, "mesh" if tetrahedra else "surface", labels, "-o", os.path.join(folder, "surface.stl"), "--per-label", "--names", os.path.join(folder, "names.json"), "--quiet"]
        if tetrahedra:
            words += ["-o", os.path.join(folder, "tetrahedra.vtu")]
        if edgeLength:
            words += ["--edge-length", repr(float(edgeLength))]
        return words + list(more)

    def run(self, words):
        """Runs the program to its end while Slicer goes on."""
        # Slicer's own libraries are not those that the program was built with.
        environment = {k: v for k, v in os.environ.items() if k not in ("LD_LIBRARY_PATH", "PYTHONHOME", "PYTHONPATH")}
        with tempfile.TemporaryFile() as said:
            process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=said, env=environment)
            try:
                while process.poll() is None:
                    slicer.app.processEvents()
                    time.sleep(0.05)
            finally:
                if process.poll() is None:
                    process.terminate()
                    process.wait()
            said.seek(0)
            if process.returncode != 0:
                raise RuntimeError(said.read().decode(errors="replace").strip() or f"stackmesh ended with {process.returncode}")

    def load(self, folder, name, tetrahedra):
        """Loads what is in the folder as models below one folder of the subject hierarchy. The files are in LPS, Slicer in RAS: it turns them where it is told so."""
        with open(os.path.join(folder, "names.json"), encoding="utf-8") as f:
            rows = json.load(f)["labels"]
        hierarchy = slicer.mrmlScene.GetSubjectHierarchyNode()
        parent = hierarchy.CreateFolderItem(hierarchy.GetSceneItemID(), name + " mesh")
        models = {}
        for row in rows:
            path = os.path.join(folder, f"surface_{row['label']}.stl")
            if not os.path.exists(path):
                continue  # a label without a surface
            models[row["name"] or f"label_{row['label']}"] = self.model(path, row["name"] or f"label_{row['label']}", row["colour"], hierarchy, parent)
        if tetrahedra:
            models["tetrahedra"] = self.model(os.path.join(folder, "tetrahedra.vtu"), name + " tetrahedra", None, hierarchy, parent)
            models["tetrahedra"].GetDisplayNode().SetVisibility(False)
        return models

    def model(self, path, name, colour, hierarchy, parent):
        node = slicer.util.loadNodeFromFile(path, "ModelFile", {"name": name, "coordinateSystem": slicer.vtkMRMLStorageNode.CoordinateSystemLPS})
        node.SetName(name)
        if colour:
            node.GetDisplayNode().SetColor(*[c / 255 for c in colour])
        node.SetAndObserveStorageNodeID(None)  # the file goes away
        hierarchy.SetItemParent(hierarchy.GetItemByDataNode(node), parent)
        return node


class StackMeshTest(ScriptedLoadableModuleTest):
    """Inside Slicer: a sphere and a cone as segments become two models and tetrahedra."""

    def runTest(self):
        slicer.mrmlScene.Clear()
        import vtk

        node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLSegmentationNode", "test")
        for source, name in ((vtk.vtkSphereSource(), "sphere"), (vtk.vtkConeSource(), "cone")):
            source.SetRadius(20)
            source.Update()
            node.AddSegmentFromClosedSurfaceRepresentation(source.GetOutput(), name, [1, 0.5, 0])
        node.CreateBinaryLabelmapRepresentation()
        models = StackMeshLogic().mesh(node)
        self.assertIn("sphere", models)
        self.assertIn("tetrahedra", models)
        self.delayDisplay("passed")
