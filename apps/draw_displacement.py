#!/usr/bin/python3
"""Draws the displacement that CalculiX computed.

usage: draw_displacement.py RESULT.frd OUT.png [--mesh MODEL.vtu] [--scale F] [--view front|back|left|right] [--size 800x600]

The loaded shape, moved by F times its displacement (default: so much that the largest is a twentieth of the model) and coloured by
the displacement in mm, with the edges of the unloaded shape behind. With the .vtu of the same run, the modulus of its elements, cut
open, stands beside. Needs python3-vtk9; without a display run it under `xvfb-run -a`.
"""
import argparse
import os
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from read_frd import read_frd

VIEWS = {"front": (0, -1, 0), "back": (0, 1, 0), "left": (1, 0, 0), "right": (-1, 0, 0)}  # from the model to the camera, LPS


def fail(text):
    sys.exit(f"draw_displacement.py: error: {text}")


def grid_of(points, tets, values, name):
    grid = vtk.vtkUnstructuredGrid()
    corners = vtk.vtkPoints()
    corners.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=1))
    grid.SetPoints(corners)
    kind = vtk.VTK_TETRA if tets.shape[1] == 4 else vtk.VTK_QUADRATIC_TETRA
    cells = vtk.vtkCellArray()
    for row in tets:
        cells.InsertNextCell(len(row), [int(v) for v in row])
    grid.SetCells(kind, cells)
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
    array.SetName(name)
    grid.GetPointData().SetScalars(array)
    return grid


def surface_of(grid):
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    surface.SetNonlinearSubdivisionLevel(1)
    surface.Update()
    return surface.GetOutput()


def colours(low, high, log=False):
    table = vtk.vtkLookupTable()
    table.SetNumberOfTableValues(256)
    stops = np.array([(0.19, 0.07, 0.23), (0.27, 0.46, 0.89), (0.15, 0.74, 0.66), (0.65, 0.90, 0.26), (0.98, 0.73, 0.22), (0.48, 0.02, 0.01)])
    for i in range(256):
        at = i / 255 * (len(stops) - 1)
        k = min(int(at), len(stops) - 2)
        table.SetTableValue(i, *((1 - at + k) * stops[k] + (at - k) * stops[k + 1]), 1)
    if log:
        table.SetScaleToLog10()
    table.SetRange(low, high)
    return table


def legend(table, title):
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetTitle(title)
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.3g")
    bar.UnconstrainedFontSizeOn()
    bar.SetPosition(0.1, 0.15)
    bar.SetWidth(0.8)
    bar.SetHeight(0.7)
    bar.SetBarRatio(0.25)
    bar.SetMaximumWidthInPixels(110)
    for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        text.SetColor(0.1, 0.1, 0.1)
        text.SetFontSize(18)
        text.ItalicOff()
        text.ShadowOff()
        text.BoldOff()
    return bar


def actor(data, table=None, colour=(0.6, 0.6, 0.6), wire=False, cells=False):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetScalarVisibility(table is not None)
    if table is not None:
        mapper.SetLookupTable(table)
        mapper.UseLookupTableScalarRangeOn()
        (mapper.SetScalarModeToUseCellData if cells else mapper.SetScalarModeToUsePointData)()
    made = vtk.vtkActor()
    made.SetMapper(mapper)
    look = made.GetProperty()
    look.SetColor(colour)
    look.SetAmbient(0.25)
    look.SetDiffuse(0.75)
    if wire:
        look.SetRepresentationToWireframe()
        look.SetOpacity(0.35)
        look.LightingOff()
    return made


def renderers(actors, toward, slot, slots):
    """The model on the left of its panel, the legend on the right."""
    made = []
    for low, high, kind in ((0, 0.8, vtk.vtkActor), (0.8, 1, vtk.vtkScalarBarActor)):
        part = vtk.vtkRenderer()
        part.SetViewport((slot + low) / slots, 0, (slot + high) / slots, 1)
        part.SetBackground(1, 1, 1)
        for a in actors:
            if isinstance(a, kind):
                part.AddActor(a) if kind is vtk.vtkActor else part.AddActor2D(a)
        made.append(part)
    camera = made[0].GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetPosition(*toward)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, 0, 1)
    made[0].ResetCamera()
    box = made[0].ComputeVisiblePropBounds()
    across = box[1] - box[0] if toward[0] == 0 else box[3] - box[2]
    width, height = window_size
    camera.SetParallelScale(0.53 * max(box[5] - box[4], across * height / (0.8 * width)))
    return made


def modulus_of(path, toward):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    modulus = grid.GetCellData().GetArray("modulus_MPa")
    if modulus is None:
        fail(f"{path} has no array modulus_MPa")
    values = vtk_to_numpy(modulus)
    kinds = vtk_to_numpy(grid.GetCellTypesArray())
    centres = vtk.vtkCellCenters()
    centres.SetInputData(grid)
    centres.Update()
    at = vtk_to_numpy(centres.GetOutput().GetPoints().GetData()) @ np.array(toward, float)
    keep = np.flatnonzero(np.isin(kinds, (vtk.VTK_TETRA, vtk.VTK_QUADRATIC_TETRA)) & (at < np.median(at)))
    chosen = vtk.vtkIdList()
    chosen.SetNumberOfIds(len(keep))
    for i, c in enumerate(keep):
        chosen.SetId(i, int(c))
    extract = vtk.vtkExtractCells()
    extract.SetInputData(grid)
    extract.SetCellList(chosen)
    extract.Update()
    half = extract.GetOutput()
    half.GetCellData().SetActiveScalars("modulus_MPa")
    surface = vtk.vtkGeometryFilter()
    surface.SetInputData(half)
    surface.Update()
    table = colours(max(values[values > 0].min(), 1), values.max(), log=True)
    return [actor(surface.GetOutput(), table, cells=True), legend(table, "E, MPa")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    parser.add_argument("output")
    parser.add_argument("--mesh")
    parser.add_argument("--scale", type=float)
    parser.add_argument("--view", choices=VIEWS, default="front")
    parser.add_argument("--size", default="800x600")
    args = parser.parse_args()
    result = read_frd(args.result)
    if "DISP" not in result.fields or not len(result.tets):
        fail(f"{args.result} holds no displacement of tetrahedra")
    u = result.fields["DISP"][:, :3]
    size = np.linalg.norm(u, axis=1)
    extent = np.linalg.norm(result.points.max(axis=0) - result.points.min(axis=0))
    scale = args.scale if args.scale is not None else extent / 20 / max(size.max(), 1e-30)
    toward = VIEWS[args.view]
    table = colours(0, size.max())
    moved = surface_of(grid_of(result.points + scale * u, result.tets, size, "displacement"))
    still = surface_of(grid_of(result.points, result.tets, size, "displacement"))
    edges = vtk.vtkExtractEdges()
    edges.SetInputData(still)
    edges.Update()
    panels = [[actor(moved, table), actor(edges.GetOutput(), colour=(0.35, 0.35, 0.35), wire=True), legend(table, "moved, mm")]]
    if args.mesh:
        panels.insert(0, modulus_of(args.mesh, toward))
    global window_size
    window_size = width, height = tuple(int(v) for v in args.size.split("x"))
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(width * len(panels), height)
    for slot, actors in enumerate(panels):
        for part in renderers(actors, toward, slot, len(panels)):
            window.AddRenderer(part)
    window.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(args.output)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()
    print(f"{args.output}: displacement up to {size.max():.4g} mm, drawn {scale:.4g} times")


main()
