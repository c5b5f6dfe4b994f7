#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Small .vti files as VTK writes them, and where VTK says that their points lie (vti.json). Needs python3-vtk9; the tests
read only what it wrote."""
import json

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

random = np.random.default_rng(7)
cases = {}
modes = {"ascii": 0, "binary": 1, "appended": 2}


def add(name, dtype, mode, *, compress=False, base64=True, big=False, wide=False, extent=(0, 4, 0, 3, 0, 2), cell=False,
        block=None):
    image = vtkImageData()
    image.SetExtent(*extent)
    image.SetOrigin(10.5, -20.25, 3)
    image.SetSpacing(0.5, 0.75, 2)
    image.SetDirectionMatrix(0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1)
    size = [extent[2 * a + 1] - extent[2 * a] + (0 if cell else 1) for a in range(3)]
    dtype = np.dtype(dtype)
    if np.issubdtype(dtype, np.floating):
        data = random.normal(0, 50, size).astype(dtype)
    else:
        info = np.iinfo(dtype)
        data = random.integers(max(info.min, -(2**31)), min(info.max, 2**31 - 1), size, endpoint=True).astype(dtype)
    flat = data.reshape(-1, order="F")
    array = numpy_to_vtk(flat, deep=True)
    array.SetName("values")
    other = numpy_to_vtk(np.zeros(flat.size, np.uint8), deep=True)
    other.SetName("another")
    attributes = image.GetCellData() if cell else image.GetPointData()
    attributes.AddArray(other)
    attributes.SetScalars(array)
    w = vtkXMLImageDataWriter()
    w.SetFileName(name)
    w.SetInputData(image)
    w.SetDataMode(modes[mode])
    if compress:
        w.SetCompressorTypeToZLib()
        if block:
            w.SetBlockSize(block)
    else:
        w.SetCompressorTypeToNone()
    w.SetEncodeAppendedData(base64)
    w.SetByteOrder(0 if big else 1)
    (w.SetHeaderTypeToUInt64 if wide else w.SetHeaderTypeToUInt32)()
    assert w.Write() == 1
    places = []
    for ijk in [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (3, 2, 1)]:
        index = [extent[2 * a] + ijk[a] + (0.5 if cell else 0) for a in range(3)]
        world = [0.0, 0.0, 0.0]
        image.TransformContinuousIndexToPhysicalPoint(index, world)
        places.append({"ijk": ijk, "at": world})
    cases[name] = {"dims": size, "type": str(dtype), "stored": [float(x) for x in flat], "places": places}


for t in ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "float32", "float64"]:
    add(f"{t}.vti", t, "appended", base64=False)
add("ascii.vti", "int16", "ascii")
add("ascii-float.vti", "float32", "ascii")
add("inline.vti", "int16", "binary")
add("inline-zlib.vti", "int16", "binary", compress=True)
add("inline-zlib-blocks.vti", "int32", "binary", compress=True, block=64)
add("appended-base64.vti", "int16", "appended")
add("appended-base64-zlib.vti", "int16", "appended", compress=True)
add("appended-zlib-blocks.vti", "float32", "appended", compress=True, base64=False, block=64)
add("big.vti", "int16", "appended", base64=False, big=True)
add("big-zlib-wide.vti", "float64", "binary", compress=True, big=True, wide=True)
add("wide.vti", "uint16", "appended", base64=False, wide=True)
add("extent.vti", "int16", "binary", extent=(3, 6, -2, 1, 5, 7))
add("cells.vti", "int16", "binary", extent=(3, 7, -2, 1, 5, 7), cell=True)

with open("vti.json", "w") as f:
    json.dump(cases, f, separators=(",", ":"))
    f.write("\n")
