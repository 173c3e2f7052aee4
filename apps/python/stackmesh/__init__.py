"""Label slices of CT and MRI to conforming surfaces and tetrahedral meshes, closed and free of intersections.

    import stackmesh
    mesh = stackmesh.mesh("labels.nii.gz")            # a path, a nibabel image, or an array with affine= or spacing=
    mesh.points, mesh.tets, mesh.tet_labels           # numpy arrays, mm
    mesh.save("body.vtu")

`mesh`, `surface`, `mesh_contours`, `fem`, `validate` and `info` do what the commands of the same names do, with the command line's
options as keyword arguments: --edge-length 3 is edge_length=3, --label 1,4 is label=[1, 4], a flag is True, and a value per label is a
dict: edge_length={5: 2.0, 9: 1.0}. The GIL is released, Ctrl-C ends a run, `progress` tells how far it is.
Licence: AGPL-3.0-or-later.
"""

import json as _json
import os as _os
import tempfile as _tempfile
import warnings as _warnings

from . import _input, _options, _stackmesh
from ._error import Error, MeshWarning
from ._mesh import Mesh
from ._progress import shown as _shown

__version__ = _stackmesh.__version__
__all__ = ["Error", "Mesh", "MeshWarning", "fem", "info", "mesh", "mesh_contours", "surface", "validate"]


def _paths(value):
    return [] if value is None or isinstance(value, bool) else [_os.fspath(v) for v in (value if isinstance(value, (list, tuple)) else [value])]


def _warn(report, level):
    for text in report.get("warnings", []):
        _warnings.warn(text, MeshWarning, stacklevel=level)


def _run(command, source, options, given, report, output, progress):
    """One run of the command `mesh` or `surface`."""
    given = dict(given, report=_paths(report), output=_paths(output), **options)
    arguments = _options.arguments(command, given)
    with _shown(progress) as told:
        data, text = _stackmesh.mesh(source, arguments, command == "surface", report is True, told)
    result = Mesh(data, _json.loads(text))
    _warn(result.report, 4)
    return result


@_options.documented("mesh")
def mesh(labels, affine=None, *, spacing=None, names=None, report=False, output=None, progress=None, **options):
    """Labels to a conforming tetrahedral mesh of all of them and its surface, both checked.

    Parameters
    ----------
    labels : array of shape (ni, nj, nk), path, list of .cnt paths, or image as of nibabel
        Whole numbers from 0, the background, of any dtype (bool too, and floats that hold whole numbers), order and strides.
        A path is whatever the command line takes: a volume, DICOM, a folder or glob of slices or masks, LABEL=FILE.cnt.
    affine : array of shape (4, 4), mm
        Voxel index (i, j, k) to RAS mm, as nibabel has it; at right angles. The mesh is in LPS unless space="ras".
    spacing : three numbers, mm
        Size of a voxel along i, j and k, in place of an affine: no anatomy is known, and voxel (0, 0, 0) has its centre at the
        origin. Of a path: of PNG and TIFF slices. Default: 1, 1, 1.
    names : dict {label number: name}, or path
        A dict names the labels of an array or an image; a path is a table of names (or, ending in .json, is written).
    report : bool, path or list of paths
        True: fidelity and verdicts go to `Mesh.report`, which costs time. Paths (.json, .html) are written too.
    output : path or list of paths
        Files that are written in the same run, as -o; `Mesh.save` writes the same bytes afterwards.
    progress : callable, True or None
        Called as progress(stage, done), 0 to 1, in the calling thread. True: tqdm, or lines on stderr where it is missing.

    Returns
    -------
    Mesh

    Raises
    ------
    Error
        With kind, problem, where and mend. KeyboardInterrupt ends the run within half a second and leaves nothing behind.
    """
    source, more = _input.source_of(labels, affine, spacing, names)
    return _run("mesh", source, more, options, report, output, progress)


@_options.documented("surface")
def surface(labels, affine=None, *, spacing=None, names=None, report=False, output=None, progress=None, **options):
    """Labels to the closed surface of all of them, checked. Parameters, result and errors are those of `mesh`; raw=True is the
    stitched surface before enhancement.
    """
    source, more = _input.source_of(labels, affine, spacing, names)
    return _run("surface", source, more, options, report, output, progress)


@_options.documented("mesh")
def mesh_contours(contours, *, names=None, report=False, output=None, progress=None, **options):
    """Drawn contours to a conforming tetrahedral mesh, checked.

    Parameters
    ----------
    contours : dict {label: {z: polygon or list of polygons}}
        label: a number above 0 or a name (which gets the next free number); z: height, mm; polygon: array of shape (n, 2), x and y in
        mm, closed by itself. Of a label's polygons at one height nesting decides what is inside (even-odd). Where
        labels overlap, the smaller one wins. Coordinates are kept as they are: no anatomy is known.
    names : dict {label number: name}

    The other parameters, result and errors are those of `mesh`.
    """
    return _run("mesh", _input.source_of_contours(contours, names), {}, options, report, output, progress)


def _saved(meshes, folder):
    """Paths of meshes, of which those in memory are written to a folder."""
    out = []
    for n, one in enumerate(meshes if isinstance(meshes, (list, tuple)) else [meshes]):
        if isinstance(one, Mesh):
            path = _os.path.join(folder, f"mesh{n + 1}" + (".vtu" if one.is_volume else ".vtp"))
            one.save(path)
            one = path
        out.append(_os.fspath(one))
    return out


@_options.documented("fem")
def fem(labels, affine=None, *, output, spacing=None, names=None, report=None, progress=None, **options):
    """Labels, or a volume mesh, to a solver model: sets, materials, load case, deck (docs/fem.md).

    Parameters
    ----------
    labels : as of `mesh`; a Mesh with tetrahedra; or the path of a volume mesh (.vtu .msh .inp .vtk .mesh)
    affine, spacing, names : as of `mesh`
    output : path or list of paths
        Decks and meshes: .inp .feb .bdf .cdb .k .exo .med .msh .vtu .vtk.
    report : path or list of paths
        .json, .html
    progress : as of `mesh`

    parts={"A": [1, 3], "B": 2}, skin={5: 0.3} and select=["NAME=CRITERION"] are the command line's repeatable options.

    Returns
    -------
    dict
        The report: report["fem"] has sets, materials and steps.
    """
    with _tempfile.TemporaryDirectory() as folder:
        if isinstance(labels, Mesh):
            if not labels.is_volume:
                raise Error("usage", "a solver model needs tetrahedra", "the mesh", "make it with stackmesh.mesh")
            labels = _saved(labels, folder)[0]
        source, more = _input.source_of(labels, affine, spacing, names)
        arguments = _options.arguments("fem", dict(options, report=_paths(report), output=_paths(output), **more))
        with _shown(progress) as told:
            result = _json.loads(_stackmesh.fem(source, arguments, told))
    _warn(result, 3)
    return result


@_options.documented("validate")
def validate(meshes, against=None, affine=None, *, spacing=None, names=None, report=None, progress=None, **options):
    """Judges meshes of any program, on their own and against the labels that they stand for (docs/validation.md).

    Parameters
    ----------
    meshes : path, Mesh, or a list of them
    against : what `mesh` takes as labels, with `affine`, `spacing` and `names`
    report : path or list of paths
        .json, .html
    progress : as of `mesh`

    Returns
    -------
    dict
        The report: result["verdict"] is "pass", "warn" or "fail", result["verdicts"] says why. Of several meshes a comparison with
        result["meshes"]. A mesh that fails raises nothing.
    """
    with _tempfile.TemporaryDirectory() as folder:
        source, more = (None, {}) if against is None else _input.source_of(against, affine, spacing, names)
        arguments = _options.arguments("validate", dict(options, report=_paths(report), **more))
        with _shown(progress) as told:
            result = _json.loads(_stackmesh.validate(_saved(meshes, folder), source, arguments, told))
    return result


def info(labels, affine=None, *, spacing=None, names=None, series=None, allow_outside=False):
    """What an input holds: dimensions, spacing, direction, labels with their voxels and volumes, as a dict.

    Parameters
    ----------
    labels, affine, spacing, names : as of `mesh`
    series : str
        DICOM: the series instance UID where a folder holds several.
    allow_outside : bool
        A detached header (.nhdr, .mhd) may name data files outside of its own folder.
    """
    source, more = _input.source_of(labels, affine, spacing, names)
    if "names" in more:
        raise Error("usage", "info reads no table of names", str(names), "leave it out")
    return _json.loads(_stackmesh.info(source, more.get("spacing", ""), series or "", allow_outside))
