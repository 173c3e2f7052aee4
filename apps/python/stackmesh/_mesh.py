"""The result of a run."""

import os

from . import _picture
from ._error import Error


class Mesh:
    """A closed, checked surface and, of `mesh` and `mesh_contours`, the tetrahedra that fill it. Coordinates are mm.

    All arrays are read-only views of the mesh's own memory: nothing is copied, and the mesh lives as long as any of them.
    Row n of `points` is node n of every file that `save` writes (counted from 0 here), row n of `tets` is element n.

    Attributes
    ----------
    points : float64, shape (n, 3), mm
        In `space`: "lps" (x to the left, y to the back, z to the head), "ras", or "none" where no anatomy is known.
    triangles : int32, shape (n, 3)
        Corners of every interface between two labels, each once, as rows of `points`.
    triangle_labels : int32, shape (n, 2)
        The label behind and the label before each triangle, as its normal (right-hand rule) points; 0 is the background.
    tets : int32, shape (n, 4)
        Corners as rows of `points`; positive volume. No rows for a surface.
    tet_mids : int32, shape (n, 6)
        With order=2 the nodes on the edges 01, 12, 02, 03, 13, 23 (VTK, Abaqus); else no rows.
    tet_labels : int32, shape (n,)
    wedges : int32, shape (n, 6)
        Of layers (`layer=["5=1.5,3"]`): an outer triangle, then the inner one below it, as Abaqus numbers them. Where corners 2 and 5 are one point it is a pyramid.
    wedge_mids : int32, shape (n, 9)
        With order=2 the nodes on the edges 01, 12, 20, 34, 45, 53, 03, 14, 25; else no rows.
    wedge_labels : int32, shape (n,)
    names : dict of int to str
        The labels of the mesh by number, as files name them.
    colours : dict of int to (red, green, blue)
        Where the input has them.
    report : dict
        The figures of the run (docs/report.md); fidelity and verdicts where `report` was requested.
    """

    def __init__(self, data, report, surface_only=False):
        self._data, self._surface_only, self.report = data, surface_only, report

    is_volume = property(lambda self: self._data.has_tets and not self._surface_only, doc="Whether there are tetrahedra.")
    space = property(lambda self: self._data.space, doc='The frame of the coordinates: "lps", "ras" or "none".')
    names = property(lambda self: self._data.names, doc="{label number: name}, as files name them.")
    colours = property(lambda self: self._data.colours, doc="{label number: (red, green, blue)}, where the input has colours.")
    points = property(lambda self: self._data.points(self._surface_only), doc="float64, shape (n, 3), mm; a read-only view.")
    triangles = property(lambda self: self._data.triangles(self._surface_only), doc="int32, shape (n, 3): rows of points.")
    triangle_labels = property(lambda self: self._data.triangle_labels(self._surface_only), doc="int32, shape (n, 2): the labels behind and before each triangle.")

    @property
    def tets(self):
        """int32, shape (n, 4): rows of points."""
        return self._data.tets()[: None if self.is_volume else 0]

    @property
    def tet_mids(self):
        """int32, shape (n, 6): with order=2 the nodes on the edges; else no rows."""
        return self._data.tet_mids()[: None if self.is_volume else 0]

    @property
    def tet_labels(self):
        """int32, shape (n,)"""
        return self._data.tet_labels()[: None if self.is_volume else 0]

    @property
    def wedges(self):
        """int32, shape (n, 6): rows of points; of layers."""
        return self._data.wedges()[: None if self.is_volume else 0]

    @property
    def wedge_mids(self):
        """int32, shape (n, 9): with order=2 the nodes on the edges; else no rows."""
        return self._data.wedge_mids()[: None if self.is_volume else 0]

    @property
    def wedge_labels(self):
        """int32, shape (n,)"""
        return self._data.wedge_labels()[: None if self.is_volume else 0]

    def _through_a_file(self, read):
        """What `read` makes of this mesh as a .vtu file: layers have elements of several kinds, which the file tells apart."""
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mesh.vtu")
            self.save(path)
            return read(path)

    @property
    def surface(self):
        """The surface alone, with points of its own: what `save` writes to a surface format."""
        return Mesh(self._data, self.report, surface_only=True)

    def save(self, path, *, per_label=None, msh2=None):
        """Writes one file, in the format of its ending; the bytes are those that the command line writes.

        Parameters
        ----------
        path : str or path
            Surfaces: .stl .ply .obj .off .vtp; volumes: .vtu .msh .inp .feb .bdf .cdb .k .exo .med .vtk .mesh.
        per_label : bool, default: as given to `mesh`
            Surfaces: NAME_<label>.EXT for each label, closed on its own.
        msh2 : bool, default: as given to `mesh`
            .msh as Gmsh 2.2.
        """
        if self.is_volume and len(self.tet_mids) and os.fspath(path).lower().endswith(".mesh"):
            raise Error("usage", "second-order tetrahedra are not written to Medit's .mesh", f"'{path}'", "choose .vtu .msh .inp .feb .bdf or .vtk")
        self._data.save(os.fspath(path), self._surface_only, per_label, msh2)

    def to_meshio(self):
        """A meshio.Mesh with cell data "label" (tetrahedra) or "label_below" and "label_above" (triangles of a surface). Needs meshio."""
        import meshio
        import numpy as np

        if not self.is_volume:
            below, above = self.triangle_labels.T
            return meshio.Mesh(self.points, [("triangle", self.triangles)], cell_data={"label_below": [below], "label_above": [above]})
        if len(self.wedges):
            mesh = self._through_a_file(meshio.read)
            solid = [n for n, block in enumerate(mesh.cells) if not block.type.startswith("triangle")]  # the file holds the interfaces, too
            return meshio.Mesh(mesh.points, [mesh.cells[n] for n in solid], cell_data={"label": [mesh.cell_data["label"][n] for n in solid]})
        quadratic = len(self.tet_mids) > 0
        cells = np.hstack([self.tets, self.tet_mids]) if quadratic else self.tets
        return meshio.Mesh(self.points, [("tetra10" if quadratic else "tetra", cells)], cell_data={"label": [self.tet_labels]})

    def to_vtk(self):
        """A vtkUnstructuredGrid (volume) or vtkPolyData (surface), with labels as cell data. Needs vtk (python3-vtk9)."""
        import numpy as np
        import vtkmodules.vtkCommonDataModel as model
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
        from vtkmodules.vtkCommonCore import vtkPoints

        if len(self.wedges):
            from vtkmodules.vtkCommonCore import vtkIdList
            from vtkmodules.vtkFiltersExtraction import vtkExtractCells
            from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

            def read(path):
                reader = vtkXMLUnstructuredGridReader()
                reader.SetFileName(path)
                reader.Update()
                grid, solid = reader.GetOutput(), vtkIdList()
                for n in range(grid.GetNumberOfCells()):  # the file holds the interfaces, too
                    if grid.GetCell(n).GetCellDimension() == 3:
                        solid.InsertNextId(n)
                extract = vtkExtractCells()
                extract.SetInputData(grid)
                extract.SetCellList(solid)
                extract.Update()
                return extract.GetOutput()

            return self._through_a_file(read)
        points = vtkPoints()
        points.SetData(numpy_to_vtk(np.ascontiguousarray(self.points), deep=True))
        corners = np.hstack([self.tets, self.tet_mids]) if len(self.tet_mids) else self.tets if self.is_volume else self.triangles
        cells = model.vtkCellArray()
        width = corners.shape[1]
        rows = np.hstack([np.full((len(corners), 1), width, np.int64), corners.astype(np.int64)])
        cells.SetCells(len(corners), numpy_to_vtkIdTypeArray(np.ascontiguousarray(rows).ravel(), deep=True))
        if self.is_volume:
            grid = model.vtkUnstructuredGrid()
            grid.SetCells(model.VTK_QUADRATIC_TETRA if width == 10 else model.VTK_TETRA, cells)
            data = {"label": self.tet_labels}
        else:
            grid = model.vtkPolyData()
            grid.SetPolys(cells)
            data = {"label_below": self.triangle_labels[:, 0], "label_above": self.triangle_labels[:, 1]}
        grid.SetPoints(points)
        for name, values in data.items():
            array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
            array.SetName(name)
            grid.GetCellData().AddArray(array)
        return grid

    def to_pyvista(self):
        """A pyvista.UnstructuredGrid or pyvista.PolyData, with labels as cell data. Needs pyvista."""
        import pyvista

        return pyvista.wrap(self.to_vtk())

    def picture(self, width=480, direction=(0.5, -0.75, 0.4)):
        """A picture of the surface as the bytes of a PNG file, drawn without other programs.

        Parameters
        ----------
        width : int
            Pixels; the height is the same.
        direction : three numbers
            From the mesh towards the eye, in the mesh's frame.
        """
        return _picture.png_of(self.surface, width, direction)

    def _repr_html_(self):
        return _picture.html_of(self)

    def __repr__(self):
        what = f"{len(self.tets)} tetrahedra of {10 if len(self.tet_mids) else 4} nodes, " if self.is_volume else ""
        what += f"{len(self.wedges)} wedges, " if len(self.wedges) else ""
        return f"<stackmesh.Mesh: {what}{len(self.points)} points, {len(self.triangles)} triangles, labels {sorted(self.names)}, mm, {self.space}>"
