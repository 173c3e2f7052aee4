#!/usr/bin/python3
"""Draws meshes to a PNG: surfaces shaded by label, tetrahedra cut open, contours; a panel per mesh.

  render.py femur.vtu -o femur.png --cut
  render.py raw.vtp enhanced.vtp femur.vtu@cut -o steps.png --edges --title stitched --title enhanced --title filled

Needs Debian's python3-vtk9; without a display also xvfb and xauth (it starts xvfb-run by itself).
"""
import argparse
import colorsys
import os
import pathlib
import re
import shutil
import sys

VIEWS = {  # azimuth, elevation in degrees, for LPS: x to the left, y to the back, z to the head
    "front": (0, 0), "back": (180, 0), "left": (90, 0), "right": (-90, 0), "top": (0, 90), "bottom": (0, -90),
    "iso": (35, 18), "iso-back": (145, 18),
}
COLORS = ["#e8d9b5", "#c9564a", "#4f86c6", "#6aa66a", "#e0a33e", "#9a6fb0", "#55b0ae", "#d987a8", "#8c8c6d", "#a0714f"]


def fail(text):
    sys.exit(f"render.py: error: {text}")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter, epilog=__doc__.split("\n\n", 1)[1])
    parser.add_argument("meshes", nargs="+", metavar="MESH", help=".vtp .ply .stl .obj .vtu .vtk or .cnt; MESH@cut, MESH@cut=x, "
                        "MESH@edges and MESH@VIEW set an option for that panel alone")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, metavar="OUT.png")
    parser.add_argument("--color", default="label", help="label (default), none, or a colour such as '#d9c7a3'")
    parser.add_argument("--edges", action="store_true", help="draw the edges of the triangles")
    parser.add_argument("--cut", nargs="?", const="auto", metavar="PLANE",
                        help="take away what is in front of a plane: auto (through the middle), x, y, z, or x=MM; tets stay whole")
    parser.add_argument("--view", default="iso", help=f"{', '.join(VIEWS)}, or AZIMUTH,ELEVATION in degrees (default iso)")
    parser.add_argument("--zoom", type=float, default=1.0, help="enlarges; 1 fits the mesh into its panel")
    parser.add_argument("--size", default="900x900", metavar="WxH", help="pixels of one panel (default 900x900)")
    parser.add_argument("--title", action="append", default=[], help="once per panel, in order")
    return parser.parse_args()


def panels_of(args):
    """(file, cut, edges, view) per panel."""
    panels = []
    for text in args.meshes:
        # An '@' inside a path stays part of it.
        name, *options = [text] if os.path.exists(text) else text.split("@")
        cut, edges, view = args.cut, args.edges, args.view
        for option in options:
            if option == "edges":
                edges = True
            elif option == "cut":
                cut = "auto"
            elif option.startswith("cut="):
                cut = option[4:]
            elif option in VIEWS or "," in option:
                view = option
            else:
                fail(f"unknown panel option '@{option}' of {name}; use @cut, @cut=x, @edges or @VIEW")
        if not os.path.isfile(name):
            fail(f"no such file: {name}")
        if cut and not re.fullmatch(r"auto|[xyz](=[-+0-9.eE]+)?", cut):
            fail(f"bad cut '{cut}'; use auto, x, y, z, or for example x=12.5")
        if view not in VIEWS and not re.fullmatch(r"[-+0-9.]+,[-+0-9.]+", view):
            fail(f"unknown view '{view}'; use {', '.join(VIEWS)}, or AZIMUTH,ELEVATION")
        panels.append((name, cut, edges, view))
    return panels


args = arguments()
if not re.fullmatch(r"[1-9]\d*x[1-9]\d*", args.size):
    fail(f"bad size '{args.size}'; use for example 900x700")
if args.color not in ("label", "none") and not re.fullmatch(r"#[0-9a-fA-F]{6}", args.color):
    fail(f"bad colour '{args.color}'; use label, none, or for example '#d9c7a3'")
panels = panels_of(args)
if len(args.title) > len(panels):
    fail(f"{len(args.title)} titles for {len(panels)} panels")
if not os.environ.get("DISPLAY"):
    if not shutil.which("xvfb-run"):
        fail("no display; run it under one, or install xvfb and xauth")
    os.execvp("xvfb-run", ["xvfb-run", "-a", sys.executable] + sys.argv)

try:
    import numpy as np
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
except ImportError as error:
    fail(f"{error}; install python3-vtk9 and python3-numpy, and run it with /usr/bin/python3")


# ---- reading: every mesh becomes a polydata or an unstructured grid -------------------------------------------

def read_with(reader, name):
    reader.SetFileName(name)
    reader.Update()
    return reader.GetOutput()


def polydata(points, cells, lines=False):
    """A polydata of triangles (cells is n x 3) or of polylines (cells is a list of index lists)."""
    data = vtk.vtkPolyData()
    vtk_points = vtk.vtkPoints()
    vtk_points.SetData(numpy_to_vtk(np.ascontiguousarray(points, float), deep=1))
    data.SetPoints(vtk_points)
    array = vtk.vtkCellArray()
    if lines:
        for cell in cells:
            array.InsertNextCell(len(cell), list(cell))
        data.SetLines(array)
    else:
        offsets = np.arange(0, 3 * len(cells) + 1, 3, dtype=np.int64)
        array.SetData(numpy_to_vtkIdTypeArray(offsets, deep=1),
                      numpy_to_vtkIdTypeArray(np.ascontiguousarray(cells, np.int64).ravel(), deep=1))
        data.SetPolys(array)
    return data


def set_cells(data, name, values):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
    array.SetName(name)
    data.GetCellData().AddArray(array)


def cells_of(data, name):
    array = data.GetCellData().GetArray(name)
    return None if array is None else vtk_to_numpy(array)


def read_ply(name):
    """VTK's reader drops the faces' own properties, such as their labels, so this reads triangles itself."""
    raw = pathlib.Path(name).read_bytes()
    end = raw.find(b"end_header")
    if not raw.startswith(b"ply") or end < 0:
        fail(f"{name} is not a PLY file")
    end = raw.index(b"\n", end) + 1
    types = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
             "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
             "double": "f8", "float64": "f8"}
    elements, form = [], "ascii"
    for line in raw[:end].decode("latin-1").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"] and words[1] == "list":
            elements[-1][2].extend([("list_size", types[words[2]]), (words[4], types[words[3]], (3,))])
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], types[words[1]]))
    tables, at = {}, end
    text = raw[end:].split() if form == "ascii" else None
    word = 0
    for kind, count, fields in elements:
        if kind not in ("vertex", "face"):
            continue
        if text is not None:
            width = sum(f[2][0] if len(f) > 2 else 1 for f in fields)
            values = np.array(text[word:word + count * width], float).reshape(count, width)
            word += count * width
            table, column = {}, 0
            for field in fields:
                wide = field[2][0] if len(field) > 2 else 1
                table[field[0]] = values[:, column:column + wide] if wide > 1 else values[:, column]
                column += wide
        else:
            order = ">" if "big" in form else "<"
            layout = np.dtype([(f[0], order + f[1], *f[2:]) for f in fields])
            values = np.frombuffer(raw, layout, count, at)
            at += count * layout.itemsize
            table = {f[0]: values[f[0]] for f in fields}
        tables[kind] = table
    vertex, face = tables["vertex"], tables["face"]
    if (face["list_size"] != 3).any():
        fail(f"{name} has faces that are no triangles")
    corners = face["vertex_indices" if "vertex_indices" in face else "vertex_index"]
    data = polydata(np.stack([vertex[c] for c in "xyz"], 1), corners)
    for key in ("label_below", "label_above", "label"):
        if key in face:
            set_cells(data, key, face[key].astype(np.int32))
    return data


def read_cnt(name):
    points, loops, z, loop = [], [], 0.0, None
    for line in pathlib.Path(name).read_text().splitlines():
        words = line.split()
        if len(words) == 4 and words[0] in "vV":
            z = float(words[3])
        elif words[:1] == ["{"]:
            loop = []
        elif words[:1] == ["}"]:
            loops.append(loop + loop[:1])
        elif len(words) == 2 and words[0] not in "sS":
            loop.append(len(points))
            points.append((float(words[0]), float(words[1]), z))
    if not points:
        fail(f"{name} holds no contours")
    return polydata(points, loops, lines=True)


def read(name):
    ending = pathlib.Path(name).suffix.lower()
    readers = {".vtp": vtk.vtkXMLPolyDataReader, ".vtu": vtk.vtkXMLUnstructuredGridReader, ".stl": vtk.vtkSTLReader,
               ".obj": vtk.vtkOBJReader, ".vtk": vtk.vtkDataSetReader}
    if ending in (".ply", ".cnt"):
        data = read_ply(name) if ending == ".ply" else read_cnt(name)
    elif ending in readers:
        data = read_with(readers[ending](), name)
    else:
        fail(f"{name}: cannot draw '{ending}' files; known are .vtp .ply .stl .obj .vtu .vtk .cnt")
    if data is None or data.GetNumberOfPoints() == 0 or data.GetNumberOfCells() == 0:
        fail(f"{name} holds no mesh")
    return data


def keep_cells(data, ids):
    extract = vtk.vtkExtractCells()
    extract.SetInputData(data)
    chosen = vtk.vtkIdList()
    chosen.SetNumberOfIds(len(ids))
    for i, value in enumerate(ids):
        chosen.SetId(i, int(value))
    extract.SetCellList(chosen)
    extract.Update()
    return extract.GetOutput()


def skin(data):
    surface = vtk.vtkGeometryFilter()
    surface.SetInputData(data)
    surface.Update()
    return surface.GetOutput()


# ---- drawing ---------------------------------------------------------------------------------------------------

def direction(view):
    """Unit vectors from the mesh to the camera, and up on the picture."""
    azimuth, elevation = np.radians(VIEWS[view] if view in VIEWS else [float(v) for v in view.split(",")])
    toward = np.array([np.sin(azimuth) * np.cos(elevation), -np.cos(azimuth) * np.cos(elevation), np.sin(elevation)])
    up = np.array([-np.sin(azimuth) * np.sin(elevation), np.cos(azimuth) * np.sin(elevation), np.cos(elevation)])
    return toward, up


def cut_plane(cut, bounds, toward):
    """(origin, normal); what lies on the normal's side goes."""
    axis = int(np.abs(toward[:2]).argmax()) if cut == "auto" else "xyz".index(cut[0])
    origin = np.array([(bounds[0] + bounds[1]) / 2, (bounds[2] + bounds[3]) / 2, (bounds[4] + bounds[5]) / 2])
    if "=" in cut:
        origin[axis] = float(cut[2:])
    normal = np.zeros(3)
    normal[axis] = 1 if toward[axis] >= 0 else -1
    return origin, normal


def centres(data):
    filter_ = vtk.vtkCellCenters()
    filter_.SetInputData(data)
    filter_.Update()
    return vtk_to_numpy(filter_.GetOutput().GetPoints().GetData())


def rgb(hexadecimal):
    return tuple(int(hexadecimal[i:i + 2], 16) / 255 for i in (1, 3, 5))


def palette(labels):
    """A colour per label, by rank among all labels drawn; background is grey."""
    colors = {0: (0.75, 0.75, 0.75)}
    for rank, label in enumerate(sorted(set(labels) - {0, -1})):
        if rank < len(COLORS):
            colors[label] = rgb(COLORS[rank])
        else:
            colors[label] = colorsys.hsv_to_rgb((0.11 + 0.618034 * rank) % 1, 0.45 + 0.15 * (rank % 3), 0.88 - 0.12 * (rank % 2))
    return colors


def colour_bytes(labels, colors):
    values, inverse = np.unique(labels, return_inverse=True)
    table = np.array([[round(255 * c) for c in colors[int(v)]] for v in values], np.uint8)
    return table[inverse]


def actor_of(data, edges, plain, cull=None):
    """An actor of a surface; `plain` colours it where it has no cell colours."""
    mapper = vtk.vtkPolyDataMapper()
    if not edges and data.GetNumberOfPolys():
        normals = vtk.vtkPolyDataNormals()
        normals.SetInputData(data)
        normals.SetFeatureAngle(35)
        normals.ConsistencyOff()  # the winding carries the labels' sides
        normals.SplittingOn()
        normals.NonManifoldTraversalOff()
        mapper.SetInputConnection(normals.GetOutputPort())
    else:
        mapper.SetInputData(data)
    mapper.SetScalarVisibility(data.GetCellData().GetScalars() is not None)
    mapper.SetScalarModeToUseCellData()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(plain)
    look.SetAmbient(0.12)
    look.SetDiffuse(0.85)
    look.SetSpecular(0.08)
    look.SetSpecularPower(18)
    if edges:
        look.SetInterpolationToFlat()
        look.EdgeVisibilityOn()
        look.SetEdgeColor(0.16, 0.16, 0.18)
        look.SetLineWidth(1)
    if cull == "front":
        look.FrontfaceCullingOn()
    elif cull == "back":
        look.BackfaceCullingOn()
    return actor


def coloured(data, values, colors):
    copy = vtk.vtkPolyData()
    copy.ShallowCopy(data)
    array = numpy_to_vtk(colour_bytes(values, colors), deep=1)
    array.SetName("colours")
    copy.GetCellData().SetScalars(array)
    return copy


def labels_in(data):
    found = set()
    for name in ("label", "label_below", "label_above"):
        values = cells_of(data, name)
        if values is not None:
            found |= {int(v) for v in np.unique(values)}
    return found


def actors_of(data, cut, edges, toward, colors):
    """The actors that show one mesh."""
    plain = rgb(args.color) if args.color.startswith("#") else rgb(COLORS[0])
    by_label = args.color == "label"
    plane = cut_plane(cut, data.GetBounds(), toward) if cut else None
    if isinstance(data, vtk.vtkUnstructuredGrid):
        kinds = vtk_to_numpy(data.GetCellTypesArray())
        solid = np.isin(kinds, (vtk.VTK_TETRA, vtk.VTK_QUADRATIC_TETRA))
        keep = solid if solid.any() else np.ones(len(kinds), bool)
        if plane:
            keep = keep & ((centres(data) - plane[0]) @ plane[1] < 0)
        if not keep.any():
            fail("the cut takes everything away; choose another plane")
        data = skin(keep_cells(data, np.flatnonzero(keep)))
    elif plane:
        whole = (centres(data) - plane[0]) @ plane[1] < 0
        if not whole.any():
            fail("the cut takes everything away; choose another plane")
        data = skin(keep_cells(data, np.flatnonzero(whole)))
    if data.GetNumberOfPolys() == 0:  # contours
        actor = actor_of(data, False, (0.15, 0.3, 0.5))
        actor.GetProperty().SetLineWidth(1.6)
        actor.GetProperty().LightingOff()
        return [actor]
    below, above, label = (cells_of(data, n) for n in ("label_below", "label_above", "label"))
    if by_label and below is not None and above is not None and not (label is not None and label.any()):
        # From its front a triangle shows the label below it, from its back the one above; never the background.
        front = coloured(data, np.where(below != 0, below, above), colors)
        back = coloured(data, np.where(above != 0, above, below), colors)
        return [actor_of(front, edges, plain, "back"), actor_of(back, edges, plain, "front")]
    if by_label and label is not None:
        return [actor_of(coloured(data, label, colors), edges, plain)]
    bare = vtk.vtkPolyData()
    bare.CopyStructure(data)
    if bare.GetNumberOfPoints() == 3 * bare.GetNumberOfCells():  # STL: every triangle has its own corners
        clean = vtk.vtkCleanPolyData()
        clean.SetInputData(bare)
        clean.Update()
        bare = clean.GetOutput()
    return [actor_of(bare, edges, plain)]


def renderer_of(data, cut, edges, view, title, colors, size, slot, slots):
    toward, up = direction(view)
    renderer = vtk.vtkRenderer()
    renderer.SetViewport(slot / slots, 0, (slot + 1) / slots, 1)
    renderer.SetBackground(1, 1, 1)
    for actor in actors_of(data, cut, edges, toward, colors):
        renderer.AddActor(actor)
    lights = vtk.vtkLightKit()
    lights.SetKeyLightIntensity(0.9)
    lights.SetKeyLightAngle(40, -25)
    lights.SetKeyToFillRatio(2.2)
    lights.AddLightsToRenderer(renderer)

    # Fits the whole mesh, cut or not, so that panels of one mesh have one scale.
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    across, high = points @ np.cross(up, toward), points @ up
    deep = points @ toward
    room = 0.88 if title else 0.94
    scale = max((high.max() - high.min()) / 2 / room, (across.max() - across.min()) / 2 / 0.94 * size[1] / size[0], 1e-9)
    middle = ((across.max() + across.min()) / 2 * np.cross(up, toward) + (high.max() + high.min()) / 2 * up +
              (deep.max() + deep.min()) / 2 * toward)
    if title:
        middle = middle + 0.05 * scale * up
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(middle)
    camera.SetPosition(middle + toward * (2 * (deep.max() - deep.min()) + scale))
    camera.SetViewUp(up)
    camera.SetParallelScale(scale / args.zoom)
    renderer.ResetCameraClippingRange()
    if title:
        text = vtk.vtkTextActor()
        text.SetInput(title)
        text.GetTextProperty().SetColor(0.1, 0.1, 0.1)
        text.GetTextProperty().SetFontSize(max(12, size[1] // 28))
        text.GetTextProperty().SetJustificationToCentered()
        text.GetTextProperty().SetVerticalJustificationToTop()
        text.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
        text.SetPosition(0.5, 0.985)
        renderer.AddActor2D(text)
    return renderer


def main():
    vtk.vtkObject.GlobalWarningDisplayOff()
    size = tuple(int(v) for v in args.size.split("x"))
    meshes = {name: read(name) for name, *_ in panels}
    colors = palette(set().union(*(labels_in(mesh) for mesh in meshes.values())))
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(size[0] * len(panels), size[1])
    for slot, (name, cut, edges, view) in enumerate(panels):
        title = args.title[slot] if slot < len(args.title) else ""
        window.AddRenderer(renderer_of(meshes[name], cut, edges, view, title, colors, size, slot, len(panels)))
    window.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    image.SetInputBufferTypeToRGB()
    image.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    writer.WriteToMemoryOn()
    writer.Write()
    try:
        args.output.write_bytes(vtk_to_numpy(writer.GetResult()).tobytes())
    except OSError as error:
        fail(f"cannot write {args.output}: {error.strerror}")


main()
