#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Small NIfTI files and what nibabel says of them (nifti.json). Needs python3-nibabel; the tests read only what it
wrote. Run again in this folder when a case is added."""
import json

import nibabel as nib
import numpy as np

random = np.random.default_rng(20240131)
cases = {}


def turned(degrees_xyz, spacing, shear=0.0, flip=False):
    a = np.eye(3)
    for axis, angle in enumerate(np.deg2rad(degrees_xyz)):
        c, s = np.cos(angle), np.sin(angle)
        r = np.eye(3)
        i, j = [(1, 2), (2, 0), (0, 1)][axis]
        r[i, i], r[i, j], r[j, i], r[j, j] = c, -s, s, c
        a = r @ a
    m = np.eye(4)
    m[:3, :3] = a @ np.diag(spacing)
    m[:3, 2] += shear * m[:3, 1]
    if flip:
        m[:3, 0] *= -1
    m[:3, 3] = [-12.25, 30.5, -7.125]
    return m


def add(name, kind, data, *, sform=None, qform=None, codes=(0, 0), slope=None, inter=None, units="mm", zooms=None,
        big=False):
    image = kind(data, None, kind.header_class(endianness=">" if big else "<"), dtype=data.dtype)
    h = image.header
    if zooms is not None:
        h.set_zooms(zooms)
    if sform is not None:
        image.set_sform(sform, code=codes[1])
    if qform is not None:
        image.set_qform(qform, code=codes[0], strip_shears=True)
    h.set_xyzt_units(units)
    if slope is not None:
        h.set_slope_inter(slope, inter)
    nib.save(image, name)
    back = nib.load(name)
    raw = np.asanyarray(back.dataobj.get_unscaled() if hasattr(back.dataobj, "get_unscaled") else back.dataobj)
    scale = {"mm": 1, "micron": 0.001, "meter": 1000, "unknown": 1}[back.header.get_xyzt_units()[0]]
    lps = np.diag([-scale, -scale, scale, 1]) @ back.affine
    known = int(back.header["qform_code"]) > 0 or int(back.header["sform_code"]) > 0
    cases[name] = {
        "dims": list(raw.shape[:3]),
        "type": str(back.get_data_dtype().newbyteorder("=")),
        "affine_lps": lps.tolist() if known else None,
        "zooms_mm": [float(z) * scale for z in back.header.get_zooms()[:3]],
        "stored": [float(x) for x in raw.reshape(raw.shape[:3] + (-1,)).reshape(-1, order="F")],
        "value": [float(x) for x in back.get_fdata().reshape(-1, order="F")],
    }


def values(dtype, shape=(4, 3, 2)):
    if np.issubdtype(dtype, np.floating):
        return random.normal(0, 100, shape).astype(dtype)
    info = np.iinfo(dtype)
    low, high = max(info.min, -(2**31)), min(info.max, 2**31 - 1)
    v = random.integers(low, high, shape, endpoint=True).astype(dtype)
    v.flat[0], v.flat[-1] = low, high
    return v


oblique = turned((20, -35, 50), (0.7, 1.3, 2.5))
for t in ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"]:
    add(f"{t}.nii", nib.Nifti1Image, values(np.dtype(t)), sform=oblique, codes=(0, 1))
    add(f"{t}-big.nii", nib.Nifti1Image if t != "float64" else nib.Nifti2Image,
        values(np.dtype(t)), sform=oblique, codes=(0, 1), big=True)
short = values(np.int16)
add("sheared.nii.gz", nib.Nifti1Image, short, sform=turned((5, 10, -170), (1, 2, 3), shear=0.4), codes=(0, 4))
add("left-handed.nii", nib.Nifti1Image, short, sform=turned((90, 0, 12), (1, 2, 3), flip=True), codes=(0, 2))
add("qform.nii", nib.Nifti1Image, short, qform=turned((20, -35, 50), (0.7, 1.3, 2.5)), codes=(1, 0))
add("qform-half-turn.nii", nib.Nifti1Image, short, qform=turned((180, 0, 0), (0.7, 1.3, 2.5)), codes=(1, 0))
add("qform-left.nii", nib.Nifti1Image, short, qform=turned((20, -35, 50), (0.7, 1.3, 2.5), flip=True), codes=(3, 0))
add("both-differ.nii", nib.Nifti1Image, short, sform=oblique, qform=turned((0, 0, 0), (0.7, 1.3, 2.5)), codes=(1, 2))
add("neither.nii", nib.Nifti1Image, short, zooms=(0.5, 0.75, 3))
add("scaled.nii.gz", nib.Nifti1Image, values(np.uint8), sform=oblique, codes=(0, 1), slope=2.208627462387085, inter=-1024)
add("micron.nii", nib.Nifti1Image, short, sform=turned((0, 0, 30), (700, 1300, 2500)), codes=(0, 1), units="micron")
add("no-unit.nii", nib.Nifti1Image, short, sform=oblique, codes=(0, 1), units="unknown")
add("pair.hdr", nib.Nifti1Pair, short, sform=oblique, codes=(0, 1))
add("second.nii.gz", nib.Nifti2Image, values(np.float32), qform=turned((1, 2, 3), (0.1, 0.2, 0.3)), codes=(1, 0))
add("flat.nii", nib.Nifti1Image, values(np.int16, (5, 4)), sform=oblique, codes=(0, 1))
add("one-voxel.nii", nib.Nifti1Image, values(np.int16, (1, 1, 1)), sform=oblique, codes=(0, 1))
add("one-slice.nii", nib.Nifti1Image, values(np.int16, (4, 3, 1)), sform=oblique, codes=(0, 1))
add("time.nii.gz", nib.Nifti1Image, values(np.int16, (4, 3, 2, 3)), sform=oblique, codes=(0, 1))

with open("nifti.json", "w") as f:
    json.dump(cases, f, indent=None, separators=(",", ":"))
    f.write("\n")
