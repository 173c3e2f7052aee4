"""What a mesh offers: arrays that fit together, other libraries' meshes, a notebook's view, help and stubs."""

import ast
import inspect
import os
import struct
import unittest
import zlib

import numpy as np
import stackmesh
from support import ball, testdata


class Result(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = stackmesh.mesh(ball(), spacing=(1, 1, 1.5), report=True, names={2: "core"})
        cls.quadratic = stackmesh.mesh(ball(), order=2)
        cls.surface = stackmesh.surface(ball())

    def test_volumes_and_areas_close(self):
        """Tetrahedra of a label fill what its triangles enclose."""
        m = self.mesh
        a, b, c, d = (m.points[m.tets[:, n]] for n in range(4))
        volumes = np.einsum("nd,nd->n", np.cross(b - a, c - a), d - a) / 6
        self.assertGreater(volumes.min(), 0)
        p, q, r = (m.points[m.triangles[:, n]] for n in range(3))
        cones = np.einsum("nd,nd->n", p, np.cross(q, r)) / 6
        for label in (2, 5):
            enclosed = cones[m.triangle_labels[:, 0] == label].sum() - cones[m.triangle_labels[:, 1] == label].sum()
            self.assertAlmostEqual(volumes[m.tet_labels == label].sum(), enclosed, places=6)
            row = next(r for r in m.report["labels"] if r["label"] == label)
            self.assertAlmostEqual(row["tet_volume_mm3"], enclosed, places=5)

    def test_shapes_and_types(self):
        m = self.quadratic
        n = len(m.tets)
        self.assertEqual((m.points.dtype, m.tets.dtype, m.tet_labels.dtype), (np.float64, np.int32, np.int32))
        self.assertEqual((m.tets.shape, m.tet_mids.shape, m.tet_labels.shape), ((n, 4), (n, 6), (n,)))
        self.assertEqual(self.mesh.tet_mids.shape, (0, 6))
        for mids, (a, b) in zip(m.tet_mids.T, ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))):
            off = m.points[mids] - (m.points[m.tets[:, a]] + m.points[m.tets[:, b]]) / 2
            self.assertLess(np.linalg.norm(off, axis=1).max(), 1)
        s = self.surface
        self.assertEqual((s.tets.shape, s.is_volume), ((0, 4), False))
        self.assertEqual(self.mesh.surface.tets.shape, (0, 4))
        self.assertEqual(set(np.unique(self.mesh.surface.triangles)), set(range(len(self.mesh.surface.points))))

    def test_layers_are_wedges(self):
        """A layer under the outer label: nothing of the mesh is lost, in the arrays or on the way to other libraries."""
        m = stackmesh.mesh(ball(), spacing=(1, 1, 1.5), layer=["5=1,2"])
        self.assertGreater(len(m.wedges), 100)
        self.assertEqual((m.wedges.shape[1], len(m.wedge_labels), len(m.tet_labels)), (6, len(m.wedges), len(m.tets)))
        self.assertEqual(set(m.wedge_labels), {5})
        p = m.points

        def volume(a, b, c, d):
            return np.einsum("nd,nd->n", np.cross(p[b] - p[a], p[c] - p[a]), p[d] - p[a]) / 6

        w = m.wedges.T
        of_wedges = np.abs(volume(w[0], w[1], w[2], w[3])) + np.abs(volume(w[1], w[2], w[3], w[4])) + np.abs(volume(w[2], w[3], w[4], w[5]))
        of_tets = volume(*m.tets.T)
        row = next(r for r in m.report["labels"] if r["label"] == 5)
        total = of_tets[m.tet_labels == 5].sum() + of_wedges.sum()
        self.assertAlmostEqual(total / row["tet_volume_mm3"], 1, delta=0.01)
        cells = {block.type: len(block.data) for block in m.to_meshio().cells}
        self.assertEqual(cells["tetra"], len(m.tets))
        self.assertEqual(cells.get("wedge", 0) + cells.get("pyramid", 0), len(m.wedges))
        self.assertEqual(m.to_vtk().GetNumberOfCells(), len(m.tets) + len(m.wedges))
        self.assertIn("wedges", repr(m))

    def test_report_is_a_dict(self):
        self.assertEqual(self.mesh.report["surface"]["triangles"], len(self.mesh.surface.triangles))
        self.assertEqual(self.mesh.report["volume"]["tets"], len(self.mesh.tets))
        self.assertEqual(self.mesh.report["volume"]["closure"], "verified")
        self.assertGreater(len(self.mesh.report["verdicts"]), 3)
        self.assertEqual(self.surface.report["verdicts"], [])

    def test_meshio(self):
        try:
            import meshio  # noqa: F401
        except ImportError:
            self.skipTest("NOT TESTED: needs python3-meshio")
        m = self.mesh.to_meshio()
        self.assertTrue((m.points == self.mesh.points).all() and (m.cells[0].data == self.mesh.tets).all())
        self.assertTrue((m.cell_data["label"][0] == self.mesh.tet_labels).all())
        self.assertEqual(self.quadratic.to_meshio().cells[0].type, "tetra10")
        self.assertEqual(self.surface.to_meshio().cells[0].type, "triangle")

    def test_vtk(self):
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
            from vtkmodules.vtkFiltersVerdict import vtkMeshQuality
        except ImportError:
            self.skipTest("NOT TESTED: needs python3-vtk9")
        for mesh, kind, count in ((self.mesh, 10, len(self.mesh.tets)), (self.quadratic, 24, len(self.quadratic.tets)), (self.surface, 5, len(self.surface.triangles))):
            grid = mesh.to_vtk()
            self.assertEqual((grid.GetNumberOfCells(), grid.GetNumberOfPoints(), grid.GetCellType(0)), (count, len(mesh.points), kind))
            self.assertTrue((vtk_to_numpy(grid.GetPoints().GetData()) == mesh.points).all())
        self.assertTrue((vtk_to_numpy(self.mesh.to_vtk().GetCellData().GetArray("label")) == self.mesh.tet_labels).all())
        quality = vtkMeshQuality()
        quality.SetInputData(self.mesh.to_vtk())
        quality.SetTetQualityMeasureToVolume()
        quality.Update()
        volumes = vtk_to_numpy(quality.GetOutput().GetCellData().GetArray("Quality"))
        self.assertAlmostEqual(volumes.sum(), sum(r["tet_volume_mm3"] for r in self.mesh.report["labels"]), places=4)

    def test_pyvista(self):
        try:
            import pyvista  # noqa: F401
        except ImportError:
            self.skipTest("NOT TESTED: needs pyvista, which Debian 12 does not have")
        self.assertEqual(self.mesh.to_pyvista().n_cells, len(self.mesh.tets))

    def test_picture_shows_the_labels(self):
        png = self.mesh.picture(width=64)
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        data, at = b"", 8
        while at < len(png):
            size, kind = struct.unpack(">I4s", png[at : at + 8])
            self.assertEqual(zlib.crc32(png[at + 4 : at + 8 + size]), struct.unpack(">I", png[at + 8 + size : at + 12 + size])[0])
            data += png[at + 8 : at + 8 + size] if kind == b"IDAT" else b""
            at += 12 + size
        rows = np.frombuffer(zlib.decompress(data), np.uint8).reshape(64, 1 + 3 * 64)[:, 1:].reshape(64, 64, 3)
        drawn = (rows != 255).any(axis=2)
        self.assertGreater(drawn.mean(), 0.2)  # a ball in its square
        self.assertLess(drawn.mean(), 0.8)
        self.assertFalse(drawn[0].any() or drawn[:, 0].any())
        self.assertTrue(drawn[32, 32])
        self.assertEqual(np.abs(np.diff(drawn.astype(int), axis=1)).sum(axis=1).max(), 2, "no holes")

    def test_repr_html_has_picture_and_verdicts(self):
        text = self.mesh._repr_html_()
        for part in ("<img", "data:image/png;base64,", "core", self.mesh.report["verdicts"][0]["title"], f"{len(self.mesh.tets)}"):
            self.assertIn(part, text)
        named = stackmesh.surface(ball(), names={5: "<script>"})
        self.assertNotIn("<script>", named._repr_html_())
        self.assertIn("labels [2, 5]", repr(named))


class Documented(unittest.TestCase):
    def test_defaults_are_those_of_the_command_line(self):
        parameters = inspect.signature(stackmesh.mesh).parameters
        self.assertEqual({n: parameters[n].default for n in ("gradation", "smooth", "caps", "interpolate", "space", "order", "timeout", "merge", "edge_length", "band")},
                         {"gradation": 1.3, "smooth": 5, "caps": "auto", "interpolate": "auto", "space": "lps", "order": 1, "timeout": 600, "merge": False, "edge_length": None, "band": 0.5})
        self.assertEqual(inspect.signature(stackmesh.fem).parameters["order"].default, 2)
        self.assertIn("raw", inspect.signature(stackmesh.surface).parameters)
        for absent in ("quiet", "progress_", "max_memory", "return_parameters", "help"):
            self.assertNotIn(absent, parameters)

    def test_every_default_can_be_given(self):
        given = {n: p.default for n, p in inspect.signature(stackmesh.mesh).parameters.items() if p.kind is p.KEYWORD_ONLY}
        plain = stackmesh.mesh(ball())
        said = stackmesh.mesh(ball(), **given)
        self.assertEqual(plain.points.tobytes(), said.points.tobytes())

    def test_every_function_has_help(self):
        for name in stackmesh.__all__:
            text = inspect.getdoc(getattr(stackmesh, name))
            self.assertGreater(len(text), 60, name)
        for word in ("shape", "mm", "edge_length", "uniform edge length", "default 'auto'"):
            self.assertIn(word, inspect.getdoc(stackmesh.mesh))

    def test_stubs_name_what_the_module_has(self):
        with open(os.path.join(os.path.dirname(stackmesh.__file__), "__init__.pyi")) as f:
            tree = ast.parse(f.read())
        functions = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
        classes = {n.name: n for n in tree.body if isinstance(n, ast.ClassDef)}
        self.assertEqual(set(functions) | set(classes), set(stackmesh.__all__))
        for name, node in functions.items():
            stub = [a.arg for a in node.args.args + node.args.kwonlyargs]
            self.assertEqual(stub, list(inspect.signature(getattr(stackmesh, name)).parameters), name)
        members = {n.name for n in classes["Mesh"].body if isinstance(n, ast.FunctionDef)}
        self.assertEqual(members, {n for n, v in vars(stackmesh.Mesh).items() if not n.startswith("_")})

    def test_the_worker_travels_with_the_module(self):
        self.assertTrue(os.access(os.path.join(os.path.dirname(stackmesh.__file__), "stackmesh-tetgen"), os.X_OK))


if __name__ == "__main__":
    unittest.main()
