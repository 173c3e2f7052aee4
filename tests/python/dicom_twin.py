#!/usr/bin/env python3
"""Writes the NIfTI twin of a folder of DICOM slices: dicom_twin.py FOLDER OUT.nii.gz"""
import os
import sys

try:
    import nibabel
    import numpy as np
    import pydicom
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-pydicom and python3-nibabel")
    sys.exit(77)

slices = [pydicom.dcmread(os.path.join(sys.argv[1], f)) for f in sorted(os.listdir(sys.argv[1]))]
o = np.array([float(v) for v in slices[0].ImageOrientationPatient])
normal = np.cross(o[:3], o[3:])
slices.sort(key=lambda s: float(np.dot([float(v) for v in s.ImagePositionPatient], normal)))
place = [np.array([float(v) for v in s.ImagePositionPatient]) for s in slices]
values = np.stack([s.pixel_array.astype(np.float64) * float(s.RescaleSlope) + float(s.RescaleIntercept) for s in slices])
affine = np.eye(4)
sy, sx = (float(v) for v in slices[0].PixelSpacing)
affine[:3, 0], affine[:3, 1] = o[:3] * sx, o[3:] * sy
affine[:3, 2] = (place[-1] - place[0]) / (len(slices) - 1)
affine[:3, 3] = place[0]
nibabel.save(nibabel.Nifti1Image(values.T.astype(np.float32), np.diag([-1.0, -1, 1, 1]) @ affine), sys.argv[2])
