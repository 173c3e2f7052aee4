"""What Python makes is what the command line makes, byte for byte."""

import json
import os
import unittest

import numpy as np
import stackmesh
from support import FolderTest, arrays_of, ball, command_line, read_bytes, same, testdata

try:
    import nibabel
except ImportError:
    nibabel = None


class SameBytes(FolderTest):
    def saves_as(self, mesh, command, arguments, endings, **save):
        outputs = [self.path("cli" + e) for e in endings]
        command_line(command, *arguments, *[a for o in outputs for a in ("-o", o)])
        for ending, output in zip(endings, outputs):
            mesh.save(self.path("py" + ending), **save)
            self.assertEqual(read_bytes(self.path("py" + ending)).replace(b"py" + ending.encode(), b"cli" + ending.encode()), read_bytes(output), ending)

    def test_a_path_in_every_format(self):
        femur = testdata("femur.nii.gz")
        volumes = [".vtu", ".msh", ".inp", ".feb", ".bdf", ".cdb", ".k", ".vtk", ".mesh"]
        self.saves_as(stackmesh.mesh(femur, edge_length=6), "mesh", [femur, "--edge-length", "6"], volumes + [".stl", ".ply", ".obj", ".off", ".vtp"])

    def test_options(self):
        heart = testdata("heart4.nii.gz")
        self.saves_as(stackmesh.mesh(heart, label=[1, 2, 5], edge_length={1: 4.0, 2: 5, 5: 6}, smooth=8, order=2, space="ras", caps={1: "round", 2: "flat", 5: "flat"}, msh2=True),
                      "mesh", [heart, "--label", "1,2,5", "--edge-length", "1=4,2=5,5=6", "--smooth", "8", "--order", "2", "--space", "ras", "--caps", "1=round,2=flat,5=flat", "--msh2"],
                      [".vtu", ".msh", ".inp", ".stl"])

    def test_voids_and_merge(self):
        heart = testdata("heart4.nii.gz")
        self.saves_as(stackmesh.mesh(heart, void=1, edge_length=6), "mesh", [heart, "--void", "1", "--edge-length", "6"], [".vtu", ".inp", ".vtp", ".stl"])
        self.saves_as(stackmesh.mesh(heart, merge=True, edge_length=6), "mesh", [heart, "--merge", "--edge-length", "6"], [".vtu", ".stl"])

    def test_surface(self):
        shells = testdata("shells.nii.gz")
        self.saves_as(stackmesh.surface(shells), "surface", [shells], [".stl", ".ply", ".vtp"])
        self.saves_as(stackmesh.surface(shells, raw=True), "surface", [shells, "--raw"], [".stl"])

    def test_per_label(self):
        shells = testdata("shells.nii.gz")
        command_line("surface", shells, "-o", self.path("cli.stl"), "--per-label")
        stackmesh.surface(shells).save(self.path("py.stl"), per_label=True)
        written = sorted(n for n in os.listdir(self.folder) if n.startswith("cli_"))
        self.assertEqual(len(written), 4)
        for name in written:
            self.assertEqual(read_bytes(self.path(name)), read_bytes(self.path(name.replace("cli", "py"))), name)

    def test_outputs_of_the_run_and_their_report(self):
        femur = testdata("femur.nii.gz")
        mesh = stackmesh.mesh(femur, output=[self.path("a.vtu"), self.path("a.stl")], report=self.path("py.json"))
        command_line("mesh", femur, "-o", self.path("b.vtu"), "--report", self.path("cli.json"))
        self.assertEqual(read_bytes(self.path("a.vtu")), read_bytes(self.path("b.vtu")))
        with open(self.path("cli.json")) as a, open(self.path("py.json")) as b:
            cli, py = json.load(a), json.load(b)
        for key in ("options", "contours", "stitched", "surface", "volume", "labels", "verdict", "verdicts", "defects", "limits", "warnings"):
            self.assertEqual(cli[key], py[key], key)
            self.assertEqual(cli[key], mesh.report[key], key)
        full = stackmesh.mesh(femur, report=True)
        self.assertEqual(full.report["verdicts"], cli["verdicts"])
        self.assertEqual(full.report["labels"], cli["labels"])

    def test_contours(self):
        """A drawn tube, from its file and from memory."""
        circle = 10 * np.array([[np.cos(a), np.sin(a)] for a in np.linspace(0, 2 * np.pi, 40, endpoint=False)])
        sections = {float(z): np.round(circle * (1 + 0.1 * z / 12) + [z / 3, 0], 6) for z in range(0, 13, 3)}
        with open(self.path("tube.cnt"), "w") as f:
            f.write(f"S {len(sections)}\n")
            for z, p in sections.items():
                f.write(f"v {len(p)} z {z!r}\n{{\n" + "".join(f"{x!r} {y!r}\n" for x, y in p.tolist()) + "}\n")
        memory = stackmesh.mesh_contours({1: sections})
        self.assertTrue(same(memory, stackmesh.mesh([self.path("tube.cnt")])))
        self.assertTrue(same(memory, stackmesh.mesh_contours({"tube": {z: [p] for z, p in sections.items()}})))
        self.saves_as(memory, "mesh", [self.path("tube.cnt")], [".mesh", ".stl"])

    def test_the_array_of_a_file(self):
        if nibabel is None:
            self.skipTest("NOT TESTED: needs python3-nibabel")
        for name in ("femur.nii.gz", "shells.nii.gz", "oblique.nii.gz"):
            with self.subTest(name):
                image = nibabel.load(testdata(name))
                file, of_image = stackmesh.mesh(testdata(name)), stackmesh.mesh(image)
                of_array = stackmesh.mesh(np.asarray(image.dataobj), image.affine)
                self.assertTrue(same(file, of_image))
                self.saves_as(of_image, "mesh", [testdata(name)], [".vtu", ".stl"])
                self.assertTrue(np.allclose(of_array.points, file.points, atol=1e-4) if of_array.points.shape == file.points.shape else name == "oblique.nii.gz")

    def test_an_array_and_the_file_that_holds_it(self):
        if nibabel is None:
            self.skipTest("NOT TESTED: needs python3-nibabel")
        affine = np.diag([-1.0, -1, 1.5, 1])
        affine[:3, 3] = [3, 4.5, -7]
        nibabel.save(nibabel.Nifti1Image(ball(dtype=np.int16), affine), self.path("ball.nii.gz"))
        self.saves_as(stackmesh.mesh(ball(dtype=np.int64), affine), "mesh", [self.path("ball.nii.gz")], [".vtu", ".inp", ".stl"])

    def test_points_are_those_of_the_file(self):
        """Bit for bit, and node n is row n."""
        mesh = stackmesh.mesh(ball())
        mesh.save(self.path("m.msh"), msh2=True)
        with open(self.path("m.msh")) as f:
            lines = f.read().split("\n")
        at = lines.index("$Nodes")
        nodes = [line.split() for line in lines[at + 2 : at + 2 + int(lines[at + 1])]]
        self.assertEqual([int(n[0]) for n in nodes], list(range(1, len(mesh.points) + 1)))
        self.assertEqual(np.array([[float(x) for x in n[1:]] for n in nodes]).tobytes(), np.array(mesh.points).tobytes())
        at = lines.index("$Elements")
        elements = [[int(x) for x in line.split()] for line in lines[at + 2 : at + 2 + int(lines[at + 1])]]
        self.assertEqual([e[-4:] for e in elements if e[1] == 4], (np.array(mesh.tets) + 1).tolist())

    def test_fem(self):
        femur, law = testdata("femur.nii.gz"), testdata("femur_law.json")
        names = testdata("femur_names.ctbl")
        report = stackmesh.fem(femur, output=self.path("py.inp"), materials=law, names=names, edge_length=14, caps="flat", interpolate=0)
        command_line("fem", femur, "-o", self.path("cli.inp"), "--materials", law, "--names", names, "--edge-length", "14", "--caps", "flat", "--interpolate", "0")
        self.assertEqual(read_bytes(self.path("py.inp")).replace(b"py.inp", b"cli.inp"), read_bytes(self.path("cli.inp")))
        self.assertEqual(report["fem"]["order"], 2)

    def test_fem_of_a_mesh_and_of_an_array(self):
        mesh = stackmesh.mesh(ball(), spacing=1)
        stackmesh.fem(mesh, output=self.path("a.inp"))
        mesh.save(self.path("m.vtu"))
        command_line("fem", self.path("m.vtu"), "-o", self.path("b.inp"))
        self.assertEqual(read_bytes(self.path("a.inp")), read_bytes(self.path("b.inp")))
        report = stackmesh.fem(ball(), spacing=1, output=self.path("c.inp"), order=1, parts={"A": 2, "B": [5]}, select=["top=normal:0,0,1,40"], skin={5: 0.3})
        self.assertIn("top", [s["name"] for s in report["fem"]["sets"]])

    def test_validate_and_info(self):
        femur = testdata("femur.nii.gz")
        command_line("mesh", femur, "-o", self.path("m.vtu"))
        command_line("validate", self.path("m.vtu"), "--against", femur, "--report", self.path("v.json"))
        with open(self.path("v.json")) as f:
            expected = json.load(f)
        mesh = stackmesh.mesh(femur)
        for judged in (stackmesh.validate(self.path("m.vtu"), femur), stackmesh.validate(mesh, against=femur, merge=False)):
            self.assertEqual(judged["verdicts"], expected["verdicts"])
        labels = ball()
        good = stackmesh.validate(stackmesh.mesh(labels, spacing=1), against=labels, spacing=1)
        bad = stackmesh.validate(stackmesh.mesh(labels, spacing=1), against=np.roll(labels, 2, axis=0), spacing=1)
        self.assertNotEqual(good["verdict"], "fail")
        self.assertEqual(bad["verdict"], "fail")
        self.assertEqual(len(stackmesh.validate([mesh, self.path("m.vtu")], against=femur)["meshes"]), 2)
        self.assertEqual(stackmesh.info(femur)["dimensions"], [112, 78, 115])
        counts = {r["label"]: r["voxels"] for r in stackmesh.info(labels, spacing=(1, 1, 2))["labels"]}
        self.assertEqual(counts, {2: int((labels == 2).sum()), 5: int((labels == 5).sum())})


if __name__ == "__main__":
    unittest.main()
