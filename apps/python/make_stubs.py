#!/usr/bin/env python3
"""Writes the stubs of the built package: make_stubs.py OUT.pyi. Names and defaults come from the module itself, so that they cannot differ from it."""

import inspect
import sys

sys.path.pop(0)  # the folder of this script holds the package's text without its compiled half
import stackmesh
from stackmesh import _options

HEAD = '''# Made by make_stubs.py out of the module itself.
import os
from typing import Any, Callable, Dict, List, Literal, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

__version__: str
Path = Union[str, "os.PathLike[str]"]
Paths = Union[Path, Sequence[Path]]
Progress = Union[bool, None, Callable[[str, float], object]]
Polygon = npt.ArrayLike
Value = Union[str, int, float, Sequence[Union[str, int]], Mapping[Any, Any], None]

class MeshWarning(UserWarning): ...

class Error(Exception):
    kind: Literal["usage", "input", "no_result", "output", "outside_limits", "cancelled", "internal"]
    problem: str
    where: str
    mend: str

'''
MESH_TYPES = {
    "is_volume": "bool", "space": 'Literal["lps", "ras", "none"]', "names": "Dict[int, str]", "colours": "Dict[int, Tuple[int, int, int]]",
    "points": "npt.NDArray[np.float64]", "triangles": "npt.NDArray[np.int32]", "triangle_labels": "npt.NDArray[np.int32]", "tets": "npt.NDArray[np.int32]",
    "tet_mids": "npt.NDArray[np.int32]", "tet_labels": "npt.NDArray[np.int32]",
    "wedges": "npt.NDArray[np.int32]", "wedge_mids": "npt.NDArray[np.int32]", "wedge_labels": "npt.NDArray[np.int32]", "surface": '"Mesh"',
}
METHODS = '''    report: Dict[str, Any]
    def save(self, path: Path, *, per_label: Optional[bool] = None, msh2: Optional[bool] = None) -> None: ...
    def to_meshio(self) -> Any: ...
    def to_vtk(self) -> Any: ...
    def to_pyvista(self) -> Any: ...
    def picture(self, width: int = 480, direction: Sequence[float] = (0.5, -0.75, 0.4)) -> bytes: ...
'''
OWN = {"labels": "Any", "against": "Any", "contours": "Mapping[Union[int, str], Mapping[float, Union[Polygon, Sequence[Polygon]]]]", "affine": "Optional[npt.ArrayLike]",
       "spacing": "Union[float, str, Sequence[float], None]", "names": "Union[Mapping[int, str], Paths, None]", "report": "Union[bool, Paths, None]", "output": "Optional[Paths]",
       "progress": "Progress", "meshes": 'Union[Path, Mesh, Sequence[Union[Path, Mesh]]]', "series": "Optional[str]", "allow_outside": "bool"}
RESULTS = {"mesh": "Mesh", "surface": "Mesh", "mesh_contours": "Mesh"}


def stub_of(function):
    command = {"mesh_contours": "mesh"}.get(function.__name__, function.__name__)
    kinds = {} if command == "info" else _options.keywords(command)
    parts, star = [], False
    for p in inspect.signature(function).parameters.values():
        if p.kind is inspect.Parameter.KEYWORD_ONLY and not star:
            parts.append("*")
            star = True
        kind = kinds.get(p.name, ("",))[0]
        type_name = OWN.get(p.name) or {"flag": "bool", "number": "Optional[float]", "optional": "Union[bool, int, None]"}.get(kind, "Value")
        parts.append(f"{p.name}: {type_name}" + ("" if p.default is p.empty else f" = {p.default!r}"))
    return f"def {function.__name__}({', '.join(parts)}) -> {RESULTS.get(function.__name__, 'Dict[str, Any]')}: ...\n"


def main():
    lines = [HEAD, "class Mesh:\n"]
    properties = [name for name, value in vars(stackmesh.Mesh).items() if isinstance(value, property)]
    missing = set(properties) ^ set(MESH_TYPES)
    if missing:
        sys.exit(f"make_stubs.py: error: the types of {sorted(missing)} of Mesh are not the module's")
    for name in properties:
        lines.append(f"    @property\n    def {name}(self) -> {MESH_TYPES[name]}: ...\n")
    lines += [METHODS, "\n"]
    lines += [stub_of(getattr(stackmesh, name)) for name in stackmesh.__all__ if inspect.isfunction(getattr(stackmesh, name))]
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write("".join(lines))


if __name__ == "__main__":
    main()
