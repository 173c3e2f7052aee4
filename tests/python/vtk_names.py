#!/usr/bin/env python3
"""Prints `number R G B name` of the labels in the field data of a .vtu or .vtp, as VTK reads them."""
import sys

try:
    import vtk
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-vtk9")
    sys.exit(77)

reader = vtk.vtkXMLPolyDataReader() if sys.argv[1].endswith(".vtp") else vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName(sys.argv[1])
reader.Update()
data = reader.GetOutput().GetFieldData()
numbers, names, colours = (data.GetAbstractArray(n) for n in ("label_number", "label_name", "label_colour"))
if names.IsA("vtkStringArray"):
    texts = [names.GetValue(i) for i in range(names.GetNumberOfValues())]
else:
    texts = bytes(int(names.GetValue(i)) for i in range(names.GetNumberOfValues())).decode().split("\n")
for i, text in enumerate(texts):
    print(numbers.GetValue(i), *(int(c) for c in colours.GetTuple3(i)), text)
