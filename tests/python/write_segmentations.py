#!/usr/bin/env python3
"""Writes small segmentations and images with pydicom, nibabel or as plain text and bytes, for the tests of what stackmesh
reads.

usage: write_segmentations.py FOLDER CASE...

Each CASE becomes a file or folder FOLDER/CASE(.ending), and FOLDER/CASE.json says what must be read from it: labels with
names, colours, voxels, and the corners of the first label's box in LPS mm, where a Python reader puts them.
"""
import itertools
import json
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    import nibabel
    import numpy as np
    import pydicom
    from pydicom.dataset import Dataset
    from pydicom.sequence import Sequence
    from pydicom.uid import ExplicitVRLittleEndian, RLELossless, generate_uid
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-pydicom and python3-nibabel")
    sys.exit(77)
from write_rtstruct import new_file

NX, NY, NZ = 11, 9, 7  # 99 pixels a frame: no whole number of bytes
SPACING = (0.8, 0.7, 2.0)
ORIGIN = np.array([-11.5, 20.25, 33.0])


def rotation(oblique):
    if not oblique:
        return np.eye(3)
    a, b = 0.3, -0.2
    rx = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    rz = np.array([[np.cos(b), -np.sin(b), 0], [np.sin(b), np.cos(b), 0], [0, 0, 1]])
    return rz @ rx  # columns: directions of x, y, z


def box(x0, x1, y0, y1, z0, z1):
    mask = np.zeros((NZ, NY, NX), bool)
    mask[z0:z1, y0:y1, x0:x1] = True
    return mask


LIVER, SPINE = box(1, 6, 2, 5, 1, 6), box(5, 10, 3, 8, 2, 6)  # they share 1 x 2 x 4 voxels


def corners(mask, affine):
    """World positions of the corners of a mask's box; affine takes (x, y, z) indices to LPS."""
    z, y, x = np.nonzero(mask)
    ends = [(v.min() - 0.5, v.max() + 0.5) for v in (x, y, z)]
    return [list((affine @ np.array([*c, 1.0]))[:3]) for c in itertools.product(*ends)]


def affine_of(axes, spacing=SPACING, origin=ORIGIN):
    m = np.eye(4)
    m[:3, :3] = axes * np.array(spacing)
    m[:3, 3] = origin
    return m


def expect(folder, name, path, labels, box_corners):
    with open(f"{folder}/{name}.json", "w") as file:
        json.dump({"path": path, "labels": labels, "corners": box_corners}, file)


def label(number, name, voxels, colour=None):
    return {"label": number, "name": name, "voxels": int(voxels), "colour": colour}


# ---- DICOM SEG ----

def lab_of(rgb):
    """sRGB (0-255) to the integers of RecommendedDisplayCIELabValue, white point D65."""
    c = np.array(rgb) / 255
    c = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    xyz = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]]) @ c
    f = [v ** (1 / 3) if v > 0.008856 else 7.787 * v + 16 / 116 for v in xyz / np.array([0.950456, 1.0, 1.088754])]
    l, a, b = 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])
    return [round(l / 100 * 65535), round((a + 128) / 255 * 65535), round((b + 128) / 255 * 65535)]


def items(*pairs):
    ds = Dataset()
    for name, value in pairs:
        setattr(ds, name, value)
    return Sequence([ds])


def write_seg(path, segments, kind="BINARY", axes=np.eye(3), skip_empty=True, shuffle=True, scale=255, bits=None, odd_groups=False,
              other_spacing=None, no_place=False, syntax=ExplicitVRLittleEndian, first_plane=0, gap=True):
    """segments: (number, name, rgb, mask or fractions)."""
    ds = new_file(path, "1.2.840.10008.5.1.4.1.1.66.4", "SEG")
    ds.SegmentationType = kind
    ds.Rows, ds.Columns = NY, NX
    ds.SamplesPerPixel, ds.PhotometricInterpretation, ds.PixelRepresentation = 1, "MONOCHROME2", 0
    ds.LossyImageCompression = "00"
    bits = bits or (1 if kind == "BINARY" else 8)
    ds.BitsAllocated, ds.BitsStored, ds.HighBit = bits, bits, bits - 1
    if kind == "FRACTIONAL":
        ds.SegmentationFractionalType, ds.MaximumFractionalValue = "PROBABILITY", scale
    described = []
    for number, name, rgb, _ in segments:
        s = Dataset()
        s.SegmentNumber, s.SegmentLabel, s.SegmentAlgorithmType = number, name, "MANUAL"
        s.SegmentDescription = "PLANTED description"
        if rgb:
            s.RecommendedDisplayCIELabValue = lab_of(rgb)
        described.append(s)
    ds.SegmentSequence = Sequence(described)
    measures = [("SliceThickness", SPACING[2]), ("PixelSpacing", [SPACING[1], SPACING[0]])]
    if gap:
        measures.append(("SpacingBetweenSlices", SPACING[2]))
    orientation = [float(v) for v in [*axes[:, 0], *axes[:, 1]]]
    shared = Dataset()
    if other_spacing is None:
        shared.PixelMeasuresSequence = items(*measures)
    shared.PlaneOrientationSequence = items(("ImageOrientationPatient", orientation))
    ds.SharedFunctionalGroupsSequence = Sequence([shared])
    frames, groups = [], []
    if kind == "LABELMAP":
        merged = np.zeros((NZ, NY, NX), np.uint16)
        for number, _, _, mask in segments:
            merged[mask] = number
        planes = [(None, z, merged[z]) for z in range(NZ)]
    else:
        planes = [(number, z, np.asarray(mask)[z]) for number, _, _, mask in segments for z in range(first_plane, NZ)]
    if skip_empty:
        planes = [p for p in planes if np.any(p[2])]
    if shuffle:
        planes = [planes[i] for i in np.random.default_rng(3).permutation(len(planes))]
    for number, z, plane in planes:
        g = Dataset()
        if not no_place:
            g.PlanePositionSequence = items(("ImagePositionPatient", [float(v) for v in ORIGIN + axes[:, 2] * SPACING[2] * z]))
        if number is not None:
            g.SegmentIdentificationSequence = items(("ReferencedSegmentNumber", number))
        if other_spacing is not None:
            size = other_spacing if groups else 1.0
            g.PixelMeasuresSequence = items(("SliceThickness", SPACING[2]), ("PixelSpacing", [SPACING[1] * size, SPACING[0]]))
        if odd_groups:
            g.add_new((0x0041, 0x0010), "LO", "SOMEBODY")
            g.add_new((0x0041, 0x1001), "SQ", Sequence([Dataset()]))
            g.FrameContentSequence = items(("DimensionIndexValues", [1, z + 1]), ("FrameComments", "PLANTED comment"))
        groups.append(g)
        frames.append(plane)
    ds.NumberOfFrames = len(frames)
    ds.PerFrameFunctionalGroupsSequence = Sequence(groups)
    flat = np.concatenate([np.asarray(f).reshape(-1) for f in frames])
    if bits == 1:
        data = np.packbits(flat.astype(np.uint8), bitorder="little").tobytes()
    elif bits == 8:
        data = (np.round(flat * scale) if kind == "FRACTIONAL" else flat).astype(np.uint8).tobytes()
    else:
        data = flat.astype("<u2").tobytes()
    ds.PixelData = data + b"\0" * (len(data) % 2)
    ds["PixelData"].VR = "OW" if bits == 16 else "OB"
    if syntax != ExplicitVRLittleEndian:
        ds.compress(syntax)
    ds.save_as(path, write_like_original=False)


def seg_corners(path, number):
    """The corners of a segment's box as pydicom's fields place them."""
    ds = pydicom.dcmread(path)
    shared = ds.SharedFunctionalGroupsSequence[0]
    o = [float(v) for v in shared.PlaneOrientationSequence[0].ImageOrientationPatient]
    m = shared.PixelMeasuresSequence[0]
    row, column = np.array(o[:3]), np.array(o[3:])
    normal = np.cross(row, column)
    sy, sx = (float(v) for v in m.PixelSpacing)
    bits = np.frombuffer(ds.PixelData, np.uint8)
    bits = np.unpackbits(bits, bitorder="little")[: ds.NumberOfFrames * NX * NY].reshape(-1, NY, NX)
    points = []
    for frame, group in zip(bits, ds.PerFrameFunctionalGroupsSequence):
        if group.SegmentIdentificationSequence[0].ReferencedSegmentNumber != number:
            continue
        p = np.array([float(v) for v in group.PlanePositionSequence[0].ImagePositionPatient])
        y, x = np.nonzero(frame)
        for i, j, k in itertools.product((x.min() - 0.5, x.max() + 0.5), (y.min() - 0.5, y.max() + 0.5), (-0.5, 0.5)):
            points.append(p + row * sx * i + column * sy * j + normal * m.SliceThickness * k)
    points = np.array(points)
    ends = [(np.min(points @ d), np.max(points @ d)) for d in (row, column, normal)]
    basis = np.array([row, column, normal]).T
    return [list(np.linalg.solve(basis.T, np.array(c))) for c in itertools.product(*ends)]


RED, BLUE = (200, 40, 30), (20, 60, 210)
BOTH = [(1, "liver", RED, LIVER), (2, "spine", BLUE, SPINE)]
SHARED = int((LIVER & SPINE).sum())


def seg_case(folder, name):
    path = f"{folder}/{name}.dcm"
    smaller_first = [label(1, "liver", LIVER.sum() - (SHARED if SPINE.sum() <= LIVER.sum() else 0), RED),
                     label(2, "spine", SPINE.sum() - (0 if SPINE.sum() <= LIVER.sum() else SHARED), BLUE)]
    if name == "seg":
        write_seg(path, [(1, "liver", RED, LIVER)])
        return expect(folder, name, path, [label(1, "liver", LIVER.sum(), RED)], seg_corners(path, 1))
    if name == "seg_oblique":
        write_seg(path, [(1, "liver", RED, LIVER)], axes=rotation(True))
        return expect(folder, name, path, [label(1, "liver", LIVER.sum(), RED)], seg_corners(path, 1))
    options = {
        "seg_overlap": {}, "seg_all_frames": {"skip_empty": False}, "seg_groups": {"odd_groups": True}, "seg_bytes": {"bits": 8},
        "seg_no_gap": {"gap": False},
        "seg_mixed": {"other_spacing": 1.5}, "seg_no_place": {"no_place": True}}.get(name)
    if options is not None:
        write_seg(path, BOTH, **options)
        return expect(folder, name, path, smaller_first, [])
    if name == "seg_fractional":
        low = LIVER * 0.5 + box(7, 9, 1, 3, 1, 4) * 0.45
        write_seg(path, [(1, "liver", RED, low)], kind="FRACTIONAL", scale=200)
        return expect(folder, name, path, [label(1, "liver", LIVER.sum(), RED)], [])
    if name in ("seg_labelmap", "seg_labelmap8", "seg_rle"):
        only = SPINE & ~LIVER
        write_seg(path, [(3, "liver", RED, LIVER), (200 if name != "seg_labelmap" else 700, "spine", None, only)], kind="LABELMAP",
                  bits=16 if name == "seg_labelmap" else 8, syntax=RLELossless if name == "seg_rle" else ExplicitVRLittleEndian)
        return expect(folder, name, path, [label(3, "liver", LIVER.sum(), RED), label(200 if name != "seg_labelmap" else 700, "spine", only.sum())], [])
    if name == "seg_empty":
        write_seg(path, [(1, "liver", RED, LIVER), (2, "nothing", BLUE, np.zeros_like(LIVER))])
        return expect(folder, name, path, [label(1, "liver", LIVER.sum(), RED)], [])
    sys.exit(f"no case {name}")


# ---- 3D Slicer's .seg.nrrd: a text header and raw bytes ----

def write_nrrd(path, layers, segments, axes=np.eye(3), offset=None, reference=None, origin=ORIGIN, extra=""):
    """layers: arrays (z, y, x); segments: (name, colour 0-1, layer, value)."""
    many = len(layers) > 1
    nz, ny, nx = layers[0].shape
    vectors = " ".join("(%.17g,%.17g,%.17g)" % tuple(axes[:, d] * SPACING[d]) for d in range(3))
    lines = ["NRRD0004", "# Complete NRRD file format specification at:", "type: unsigned char", f"dimension: {4 if many else 3}",
             "space: left-posterior-superior", f"sizes: {str(len(layers)) + ' ' if many else ''}{nx} {ny} {nz}",
             f"space directions: {'none ' if many else ''}{vectors}", f"kinds: {'list ' if many else ''}domain domain domain",
             "encoding: raw", "space origin: (%.17g,%.17g,%.17g)" % tuple(origin)]
    for i, (name, colour, layer, value) in enumerate(segments):
        lines += [f"Segment{i}_Color:=" + " ".join(str(c) for c in colour), f"Segment{i}_ID:=Segment_{i + 1}", f"Segment{i}_Name:={name}",
                  f"Segment{i}_Extent:=0 {nx - 1} 0 {ny - 1} 0 {nz - 1}", f"Segment{i}_Tags:=TerminologyEntry:x|"]
        if layer is not None:
            lines += [f"Segment{i}_LabelValue:={value}", f"Segment{i}_Layer:={layer}"]
    lines += ["Segmentation_ContainedRepresentationNames:=Binary labelmap|", "Segmentation_MasterRepresentation:=Binary labelmap"]
    if offset is not None:
        lines.append("Segmentation_ReferenceImageExtentOffset:=%d %d %d" % offset)
    if reference is not None:
        matrix = ";".join("1" if i % 5 == 0 else "0" for i in range(16))
        geometry = matrix + ";" + ";".join(str(v) for v in reference) + ";"
        lines.append("Segmentation_ConversionParameters:=Collapse labelmaps|1|Merge the labelmaps into as few shared labelmaps as possible&"
                     f"Reference image geometry|{geometry}|Image geometry description string&Oversampling factor|1|Determines&")
    stack = np.stack(layers, axis=-1) if many else layers[0]
    with open(path, "wb") as file:
        file.write(("\n".join(lines) + extra + "\n\n").encode())
        file.write(np.ascontiguousarray(stack.astype(np.uint8)).tobytes())


def nrrd_case(folder, name):
    path = f"{folder}/{name}.seg.nrrd"
    red, blue = (0.8, 0.2, 0.1), (0.1, 0.25, 0.85)
    rgb = [[204, 51, 26], [26, 64, 217]]
    small = int(SPINE.sum() <= LIVER.sum())
    joined = [label(1, "liver", LIVER.sum() - SHARED * small, rgb[0]), label(2, "spine", SPINE.sum() - SHARED * (1 - small), rgb[1])]
    if name in ("nrrd", "nrrd_oblique"):
        axes = rotation(name == "nrrd_oblique")
        write_nrrd(path, [LIVER * 4], [("liver", red, 0, 4)], axes=axes)
        return expect(folder, name, path, [label(4, "liver", LIVER.sum(), rgb[0])], corners(LIVER, affine_of(axes)))
    if name == "nrrd_layers":  # one label value a segment, two layers
        write_nrrd(path, [LIVER * 1, SPINE * 2], [("liver", red, 0, 1), ("spine", blue, 1, 2)])
        return expect(folder, name, path, joined, [])
    if name == "nrrd_same_value":
        write_nrrd(path, [LIVER * 1, SPINE * 1], [("liver", red, 0, 1), ("spine", blue, 1, 1)])
        return expect(folder, name, path, joined, [])
    if name == "nrrd_old":  # Slicer 4.10: a layer for each segment, no label values
        write_nrrd(path, [LIVER * 1, SPINE * 1], [("liver", red, None, None), ("spine", blue, None, None)])
        return expect(folder, name, path, joined, [])
    if name in ("nrrd_cropped", "nrrd_whole", "nrrd_shifted"):
        # A cone that ends on the file's last slice; whether that is the image's border decides its end.
        cone = np.zeros((6, 21, 21), np.uint8)
        y, x = np.mgrid[-10:11, -10:11]
        for z in range(6):
            cone[z] = x * x + y * y <= (9.5 - 1.7 * z) ** 2
        reference = {"nrrd_cropped": (0, 20, 0, 20, 0, 30), "nrrd_whole": (0, 20, 0, 20, 0, 5)}.get(name)
        write_nrrd(path, [cone], [("cone", red, 0, 1)], offset=(0, 0, 7) if name != "nrrd_whole" else (0, 0, 0), reference=reference)
        return expect(folder, name, path, [label(1, "cone", cone.sum(), rgb[0])], [])
    if name == "nrrd_bad_layer":
        write_nrrd(path, [LIVER * 1, SPINE * 2], [("liver", red, 0, 1), ("spine", blue, 5, 2)])
        return expect(folder, name, path, [], [])
    sys.exit(f"no case {name}")


# ---- DICOM series and the plain formats ----

def write_series(folder, values, slope=1, intercept=0, axes=np.eye(3), positions=None, uid=None, prefix="s", dtype="<i2"):
    """values: stored integers (z, y, x)."""
    os.makedirs(folder, exist_ok=True)
    uid = uid or generate_uid()
    order = np.random.default_rng(5).permutation(len(values))
    for number, z in enumerate(order):
        path = f"{folder}/{prefix}{number}.dcm"
        ds = new_file(path, "1.2.840.10008.5.1.4.1.1.2", "CT")
        ds.SeriesInstanceUID = uid
        ds.InstanceNumber = number + 1
        ds.Rows, ds.Columns = values.shape[1:]
        ds.SamplesPerPixel, ds.PhotometricInterpretation = 1, "MONOCHROME2"
        ds.BitsAllocated, ds.BitsStored, ds.HighBit, ds.PixelRepresentation = 16, 16, 15, 1 if dtype == "<i2" else 0
        ds.RescaleSlope, ds.RescaleIntercept = slope, intercept
        ds.PixelSpacing = [SPACING[1], SPACING[0]]
        ds.SliceThickness = SPACING[2]
        height = z * SPACING[2] if positions is None else positions[z]
        ds.ImagePositionPatient = [float(v) for v in ORIGIN + axes[:, 2] * height]
        ds.ImageOrientationPatient = [float(v) for v in [*axes[:, 0], *axes[:, 1]]]
        ds.PixelData = values[z].astype(dtype).tobytes()
        ds.save_as(path, write_like_original=False)
    return uid


def series_corners(folder, wanted):
    points, axes = [], None
    for file in sorted(os.listdir(folder)):
        ds = pydicom.dcmread(f"{folder}/{file}")
        o = [float(v) for v in ds.ImageOrientationPatient]
        axes = np.array([o[:3], o[3:], np.cross(o[:3], o[3:])]).T
        p = np.array([float(v) for v in ds.ImagePositionPatient])
        y, x = np.nonzero(ds.pixel_array == wanted)
        if len(x) == 0:
            continue
        sy, sx = (float(v) for v in ds.PixelSpacing)
        for i, j, k in itertools.product((x.min() - 0.5, x.max() + 0.5), (y.min() - 0.5, y.max() + 0.5), (-0.5, 0.5)):
            points.append(p + axes @ np.array([sx * i, sy * j, float(ds.SliceThickness) * k]))
    ends = [(np.min(np.array(points) @ axes[:, d]), np.max(np.array(points) @ axes[:, d])) for d in range(3)]
    return [list(np.linalg.solve(axes.T, np.array(c))) for c in itertools.product(*ends)]


def labels_array():
    values = np.zeros((NZ, NY, NX), np.int16)
    values[LIVER] = 5
    values[SPINE & ~LIVER] = 9
    return values


def image_case(folder, name):
    path = f"{folder}/{name}"
    values = labels_array()
    both = [label(5, "", (values == 5).sum()), label(9, "", (values == 9).sum())]
    if name in ("series", "series_oblique"):
        write_series(path, values, axes=rotation(name == "series_oblique"))
        return expect(folder, name, path, both, series_corners(path, 5))
    if name == "series_rescaled":  # stored - 3 and halved
        write_series(path, values * 2 + 6, slope=0.5, intercept=-3)
        return expect(folder, name, path, both, [])
    if name == "series_missing":  # the fourth slice is not there
        write_series(path, np.delete(values, 3, axis=0), positions=[2.0 * z for z in range(NZ) if z != 3])
        return expect(folder, name, path, both, [])
    if name == "series_twice":
        write_series(path, values[[0, 1, 2, 3, 3, 4, 5, 6]], positions=[0, 2, 4, 6, 6, 8, 10, 12])
        return expect(folder, name, path, both, [])
    if name == "series_uneven":
        write_series(path, np.full((5, NY, NX), 7) * np.arange(1, 6)[:, None, None], positions=[0, 1, 3.3, 4, 9])
        return expect(folder, name, path, [], [])
    if name == "series_two":
        uids = [write_series(path, values, prefix="a"), write_series(path, values, prefix="b")]
        return expect(folder, name, path, [{"uid": u} for u in uids], [])
    if name == "series_mpeg":
        write_series(path, values)
        for file in os.listdir(path):
            ds = pydicom.dcmread(f"{path}/{file}")
            ds.file_meta.TransferSyntaxUID = "1.2.840.10008.1.2.4.100"
            ds.PixelData = pydicom.encaps.encapsulate([b"\0\0\1\xb3" + b"\7" * 60])
            ds["PixelData"].is_undefined_length = True
            ds.save_as(f"{path}/{file}")
        return expect(folder, name, path, [], [])
    if name == "series_ct":
        write_series(path, values * 100, intercept=-1024)
        return expect(folder, name, path, [], [])
    if name == "series_sheared":
        write_series(path, values)
        for file in os.listdir(path):
            ds = pydicom.dcmread(f"{path}/{file}")
            ds.ImagePositionPatient = [ds.ImagePositionPatient[0], float(ds.ImagePositionPatient[1]) + 0.2 * float(ds.ImagePositionPatient[2]),
                                       ds.ImagePositionPatient[2]]
            ds.save_as(f"{path}/{file}")
        return expect(folder, name, path, [], [])
    if name in ("nifti", "nifti_oblique", "nifti_left"):
        axes = rotation(name == "nifti_oblique")
        if name == "nifti_left":
            axes = axes @ np.diag([-1.0, 1, 1])  # a left-handed grid
        ras = np.diag([-1.0, -1, 1, 1]) @ affine_of(axes)
        nibabel.save(nibabel.Nifti1Image(values.T.astype(np.uint8), ras), path + ".nii.gz")
        read = np.diag([-1.0, -1, 1, 1]) @ nibabel.load(path + ".nii.gz").affine
        return expect(folder, name, path + ".nii.gz", both, corners(LIVER, read))
    if name == "meta":
        with open(path + ".mha", "wb") as file:
            file.write(("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                        "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = %.17g %.17g %.17g\nElementSpacing = %.17g %.17g %.17g\n"
                        "DimSize = %d %d %d\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" % (*ORIGIN, *SPACING, NX, NY, NZ)).encode())
            file.write(values.astype(np.uint8).tobytes())
        import vtk
        reader = vtk.vtkMetaImageReader()
        reader.SetFileName(path + ".mha")
        reader.Update()
        image = reader.GetOutput()
        return expect(folder, name, path + ".mha", both, corners(LIVER, affine_of(np.eye(3), image.GetSpacing(), np.array(image.GetOrigin()))))
    sys.exit(f"no case {name}")


for wanted in sys.argv[2:]:
    write_case = {"seg": seg_case, "nrrd": nrrd_case}.get(wanted.split("_")[0], image_case)
    write_case(sys.argv[1], wanted)
