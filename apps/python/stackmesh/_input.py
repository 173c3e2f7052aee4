"""What is given to be meshed, as the compiled half takes it."""

import os

import numpy as np

from . import _stackmesh
from ._error import Error
from ._options import is_path

_UNITS = {"micron": 1e-3, "meter": 1e3}
_RAS_TO_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def _fail(problem, where, mend):
    raise Error("input", problem, where, mend)


def is_image(labels):
    """Whether it is an image as nibabel has them."""
    return hasattr(labels, "dataobj") and hasattr(labels, "affine")


def _native(array, where):
    """The array in Fortran order and native byte order; a copy only where it has to be one."""
    kind = array.dtype.kind
    if kind == "b":
        array = array.astype(np.uint8)
    elif kind == "f" and array.dtype.itemsize not in (4, 8):
        array = array.astype(np.float64 if array.dtype.itemsize > 8 else np.float32)
    elif kind not in "iuf":
        _fail(f"numbers of type {array.dtype} are no labels", where, "give whole numbers from 0")
    return np.asarray(array, dtype=array.dtype.newbyteorder("="), order="F")


def _affine(affine, where):
    matrix = np.asarray(affine, dtype=np.float64)
    if matrix.shape != (4, 4):
        _fail(f"the affine has the shape {matrix.shape}", where, "give one of shape (4, 4): voxel index to RAS mm")
    if not np.isfinite(matrix).all() or (matrix[3] != [0, 0, 0, 1]).any():
        _fail("the affine is no affine map", where, "give finite numbers and the last row 0, 0, 0, 1")
    return _RAS_TO_LPS @ matrix


def _spacing(spacing, where):
    if spacing is None:
        return None
    if isinstance(spacing, str):
        spacing = [float(s) for s in spacing.split(",")]
    numbers = np.asarray(spacing, dtype=np.float64)
    if numbers.ndim == 0:
        numbers = np.repeat(numbers, 3)
    if numbers.shape != (3,) or not np.isfinite(numbers).all() or (numbers <= 0).any():
        _fail(f"the spacing {spacing!r} is no size of a voxel", where, "give three numbers above 0, mm along i, j and k")
    return numbers


def _image_grid(image):
    """Affine (LPS, mm) and spacing (mm, or None) of an image: the spacing is that of its header, which stores it apart, where both agree."""
    affine, where = image.affine, "the image"
    if affine is None:
        return None, None
    matrix = _affine(affine, where)
    header = getattr(image, "header", None)
    scale = 1.0
    if hasattr(header, "get_xyzt_units"):
        scale = _UNITS.get(header.get_xyzt_units()[0], 1.0)
    matrix[:3] *= scale
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    if hasattr(header, "get_zooms"):
        zooms = np.asarray(header.get_zooms()[:3], dtype=np.float64) * scale
        if zooms.shape == (3,) and np.allclose(zooms, spacing, rtol=1e-4, atol=0):
            spacing = zooms
    return matrix, spacing


def _of_image(image, names):
    array = np.asanyarray(image.dataobj)
    while array.ndim > 3 and array.shape[-1] == 1:
        array = array[..., 0]
    matrix, spacing = _image_grid(image)
    return _stackmesh.Source.of_array(_native(array, "the image"), matrix, spacing, names, "the image")


def _of_array(labels, affine, spacing, names):
    where = "the array"
    if affine is not None and spacing is not None:
        raise Error("usage", "affine and spacing both say how large a voxel is", where, "give one of them")
    array = np.asanyarray(labels)
    matrix = None if affine is None else _affine(affine, where)
    return _stackmesh.Source.of_array(_native(array, where), matrix, _spacing(spacing, where), names, where)


def _is_paths(labels):
    return is_path(labels) or (isinstance(labels, (list, tuple)) and len(labels) > 0 and all(is_path(p) for p in labels))


def source_of(labels, affine, spacing, names):
    """
    The source, and the options that go with it: a path's spacing and table of names are the command line's.

    labels is a path, a list of paths (.cnt), an image or an array; names a dict {number: name} or the path of a table.
    """
    options = {}
    table = names if names is None or isinstance(names, dict) else [os.fspath(n) for n in (names if isinstance(names, (list, tuple)) else [names])]
    if isinstance(table, list):
        options["names"] = table
    named = {int(number): str(name) for number, name in table.items()} if isinstance(table, dict) else {}
    if _is_paths(labels):
        if affine is not None:
            raise Error("usage", "affine is for an array; a file has its own", str(labels), "leave it out")
        if named:
            raise Error("usage", "names as a dict are for an array or an image", str(labels), "give the path of a table of names")
        if spacing is not None:
            options["spacing"] = ",".join(repr(float(s)) for s in _spacing(spacing, str(labels)))
        paths = [labels] if is_path(labels) else labels
        return _stackmesh.Source.of_paths([os.fspath(p) for p in paths]), options
    if is_image(labels):
        if affine is not None or spacing is not None:
            raise Error("usage", "affine and spacing are for an array; an image has its own", "the image", "leave them out")
        return _of_image(labels, named), options
    return _of_array(labels, affine, spacing, named), options


def _polygon(points, where):
    polygon = np.asarray(points, dtype=np.float64)
    if polygon.ndim != 2 or polygon.shape[1] not in (2, 3):
        _fail(f"a contour has the shape {polygon.shape}", where, "give points of shape (n, 2): x and y in mm")
    return np.ascontiguousarray(polygon[:, :2])


def source_of_contours(contours, names):
    """The source of {label: {z: polygon or [polygon, ...]}}."""
    if not isinstance(contours, dict):
        raise TypeError("contours is a dict {label number or name: {z: polygon or list of polygons}}")
    taken = {key for key in contours if isinstance(key, (int, np.integer))}
    free = (number for number in range(1, 65536) if number not in taken)
    labels = []
    for key, sections in contours.items():
        number, name = (int(key), str((names or {}).get(key, ""))) if isinstance(key, (int, np.integer)) else (next(free), str(key))
        where = f"the contours of {key!r}"
        if number <= 0:
            _fail("0 is the background, and labels are above it", where, "number it from 1")
        if not isinstance(sections, dict) or not sections:
            _fail("there are no sections", where, "give a dict {z: polygon or list of polygons}, z in mm")
        made = []
        for z in sorted(sections):
            polygons = sections[z]
            one = isinstance(polygons, np.ndarray) and polygons.ndim == 2 or (len(polygons) > 0 and np.ndim(polygons[0]) == 1)
            made.append((float(z), [_polygon(p, f"{where} at z = {z}") for p in ([polygons] if one else polygons)]))
        labels.append((number, name, made))
    labels.sort(key=lambda label: label[0])
    return _stackmesh.Source.of_contours(labels, "the contours")
