#!/usr/bin/env python3
"""Writes small DICOM RTSTRUCT files with pydicom, for the tests of what stackmesh reads.

usage: write_rtstruct.py FOLDER CASE...

Each CASE becomes FOLDER/CASE.dcm. Every identifying field holds a text that begins with PLANTED.
"""
import sys

try:
    import numpy as np
    import pydicom
    from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
    from pydicom.sequence import Sequence
    from pydicom.uid import ExplicitVRLittleEndian, ImplicitVRLittleEndian, generate_uid
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-pydicom")
    sys.exit(77)

HEIGHTS = [2.0 * k for k in range(10)]


def plant(ds):
    ds.PatientName = "PLANTED^NAME"
    ds.PatientID = "PLANTEDID"
    ds.PatientBirthDate = "19010203"
    ds.PatientAddress = "PLANTED street"
    ds.InstitutionName = "PLANTED hospital"
    ds.ReferringPhysicianName = "PLANTED^DOCTOR"
    ds.OperatorsName = "PLANTED^OPERATOR"
    ds.StudyID = "PLANTED1"
    ds.AccessionNumber = "PLANTED2"
    ds.StudyDescription = "PLANTED study"
    ds.SeriesDescription = "PLANTED series"


def new_file(path, sop_class, modality, syntax=ExplicitVRLittleEndian):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = sop_class
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = syntax
    ds = FileDataset(path, {}, file_meta=meta, preamble=b"\0" * 128)
    ds.is_little_endian = True
    ds.is_implicit_VR = syntax == ImplicitVRLittleEndian
    ds.SOPClassUID = sop_class
    ds.SOPInstanceUID = meta.MediaStorageSOPInstanceUID
    ds.StudyInstanceUID = generate_uid()
    ds.SeriesInstanceUID = generate_uid()
    ds.FrameOfReferenceUID = generate_uid()
    ds.Modality = modality
    plant(ds)
    return ds


def square(x, y, size, z, turned=False):
    points = [(x, y, z), (x + size, y, z), (x + size, y + size, z), (x, y + size, z)]
    return points[::-1] if turned else points


def structure(name, contours, number=None, colour=None, kind="CLOSED_PLANAR"):
    """contours: lists of points, or (kind, list of points)."""
    pairs = [c if isinstance(c[0], str) else (kind, c) for c in contours]
    return {"name": name, "contours": pairs, "number": number, "colour": colour}


def write(path, structures, syntax=ExplicitVRLittleEndian, charset=None, preamble=True, order=None):
    ds = new_file(path, "1.2.840.10008.5.1.4.1.1.481.3", "RTSTRUCT", syntax)
    if charset:
        ds.SpecificCharacterSet = charset
    ds.StructureSetLabel = "PLANTED label"
    ds.StructureSetName = "PLANTED set"
    # A reference to images that are nowhere.
    reference = Dataset()
    reference.FrameOfReferenceUID = ds.FrameOfReferenceUID
    ds.ReferencedFrameOfReferenceSequence = Sequence([reference])
    rois, contours = [], []
    for i, s in enumerate(structures):
        number = i + 1 if s["number"] is None else s["number"]
        roi = Dataset()
        roi.ROINumber = number
        roi.ReferencedFrameOfReferenceUID = ds.FrameOfReferenceUID
        roi.ROIName = s["name"]
        roi.ROIDescription = "PLANTED roi"
        roi.ROIGenerationAlgorithm = "MANUAL"
        rois.append(roi)
        drawn = Dataset()
        if s["colour"]:
            drawn.ROIDisplayColor = list(s["colour"])
        drawn.ReferencedROINumber = number
        items = []
        for kind, points in s["contours"]:
            item = Dataset()
            image = Dataset()
            image.ReferencedSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
            image.ReferencedSOPInstanceUID = generate_uid()
            item.ContourImageSequence = Sequence([image])
            item.ContourGeometricType = kind
            item.NumberOfContourPoints = len(points)
            item.ContourData = ["%.6g" % v if abs(v) < 1e4 else str(v) for p in points for v in p]
            items.append(item)
        if items:
            drawn.ContourSequence = Sequence(items)
        contours.append(drawn)
    ds.StructureSetROISequence = Sequence(rois)
    ds.ROIContourSequence = Sequence(contours)
    if preamble:
        ds.save_as(path, write_like_original=False)
    else:
        pydicom.filewriter.dcmwrite(path, strip(ds), write_like_original=True)


def strip(ds):
    bare = Dataset()
    bare.update(ds)
    bare.is_little_endian, bare.is_implicit_VR = True, True
    return bare


def box(x, y, size, heights=HEIGHTS):
    return [square(x, y, size, z, k % 2 == 1) for k, z in enumerate(heights)]


def turned(contours, axes):
    """Points (u, v, w) to patient coordinates by three axes."""
    return [[tuple(np.round(sum(c * np.array(a) for c, a in zip(p, axes)), 6)) for p in contour] for contour in contours]


def keyhole(z):
    """A square with a square hole, reached by a bridge that is walked twice."""
    return [(0, 0, z), (20, 0, z), (20, 20, z), (0, 20, z), (0, 10, z), (5, 10, z), (5, 15, z), (15, 15, z), (15, 5, z),
            (5, 5, z), (5, 10, z), (0, 10, z)]


def oblique_axes():
    n = np.array([0.2, -0.3, 1.0])
    n /= np.linalg.norm(n)
    u = np.array([1.0, 0, 0]) - n[0] * n
    u /= np.linalg.norm(u)
    return u, np.cross(n, u), n


def shuffled(contours):
    return [contours[i] for i in np.random.default_rng(7).permutation(len(contours))]


def case(name, path):
    if name == "box":  # sections in any order, an asymmetric place
        write(path, [structure("Lt Lung", shuffled(box(10, -40, 20, [100 + z for z in HEIGHTS])), colour=(10, 200, 30)),
                     structure("Areola", []), structure("Iso", [[(0, 0, 0)]], kind="POINT")])
    elif name == "implicit":
        write(path, [structure("Box", box(10, -40, 20))], syntax=ImplicitVRLittleEndian)
    elif name == "bare":  # without preamble and file meta information
        write(path, [structure("Box", box(10, -40, 20))], syntax=ImplicitVRLittleEndian, preamble=False)
    elif name == "japanese":  # the last character's second byte is a backslash
        write(path, [structure(n, box(30 * i, 0, 10)) for i, n in enumerate(["左肺", "ｼﾝｿﾞｳ heart", "本"])], charset=["ISO 2022 IR 13", "ISO 2022 IR 87"])
    elif name == "korean":
        write(path, [structure(n, box(30 * i, 0, 10)) for i, n in enumerate(["왼쪽 폐", "CTV1"])], charset=["", "ISO 2022 IR 149"])
    elif name == "chinese":
        write(path, [structure(n, box(30 * i, 0, 10)) for i, n in enumerate(["左肺", "CTV1"])], charset=["", "ISO 2022 IR 58"])
    elif name == "latin":
        write(path, [structure("H\u00fcfte", box(0, 0, 20))], charset="ISO_IR 100")
    elif name == "ring":  # inner contours by nesting: a hole, and an island in it
        write(path, [structure("Ring", box(0, 0, 20) + box(5, 5, 10) + box(8, 8, 4))])
    elif name == "keyhole":
        write(path, [structure("Ring", [keyhole(z) for z in HEIGHTS])])
    elif name == "several":
        write(path, [structure("Two", box(0, 0, 10) + box(20, 0, 10))])
    elif name == "missing":  # B lacks heights that A has; both lack 8 and 10
        some = [z for z in HEIGHTS if z not in (8, 10)]
        write(path, [structure("A", box(0, 0, 20, some)), structure("B", box(40, 0, 10, [z for z in some if z not in (4, 14)]))])
    elif name == "heights":  # two pieces at heights that differ by 0.008 mm
        write(path, [structure("Two", box(0, 0, 10) + box(20, 0, 10, [z + 0.008 for z in HEIGHTS]))])
    elif name == "overlap":
        write(path, [structure("Large", box(0, 0, 30)), structure("Small", box(20, 0, 20))])
    elif name == "nested":
        write(path, [structure("Outer", box(0, 0, 30)), structure("Inner", box(5, 5, 10))])
    elif name == "open":
        closed = [c + [c[0]] for c in box(30, 0, 10)]
        write(path, [structure("Open", box(0, 0, 20), kind="OPEN_PLANAR"), structure("Closed", closed)])
    elif name == "odd":  # contours that bound nothing, beside good ones
        write(path, [structure("Box", box(0, 0, 20) + [[(50, 50, 4)], [(60, 60, 6), (61, 61, 6)], [(0, 40, 8), (5, 40, 8), (9, 40, 8)]] +
                               [("POINT", [(1, 1, 4)]), ("OPEN_NONPLANAR", [(0, 0, 0), (1, 1, 1), (2, 1, 2)])])])
    elif name == "drawn_over":  # the pen went a little past its start
        write(path, [structure("Pen", [[(0, 0, z), (20, 0, z), (20, 20, z), (0, 20, z), (0, -1, z), (1, -1, z), (1, 1, z), (0.5, 1, z)]
                                       for z in HEIGHTS])])
    elif name == "crossing":
        bad = box(0, 0, 20)
        write(path, [structure("Good", box(50, 0, 10)), structure("Bad", bad + [square(10, 10, 20, 6)])])
    elif name == "sagittal":  # planes of constant x
        axes = [(0, 1, 0), (0, 0, 1), (1, 0, 0)]
        write(path, [structure("Box", turned(box(10, -40, 20, [100 + z for z in HEIGHTS]), axes))])
    elif name == "oblique":
        write(path, [structure("Box", turned(box(10, -40, 20, [100 + z for z in HEIGHTS]), oblique_axes()))])
    elif name == "oblique_tenths":  # written with one decimal
        contours = turned(box(10, -40, 20, [100 + z for z in HEIGHTS]), oblique_axes())
        write(path, [structure("Box", [[tuple(round(float(x), 1) for x in p) for p in c] for c in contours])])
    elif name == "unparallel":
        tilted = turned([square(40, 0, 10, 9)], [(1, 0, 0), (0, 0.8, 0.6), (0, -0.6, 0.8)])
        write(path, [structure("Box", box(0, 0, 20)), structure("Tilted", tilted)])
    elif name == "numbers":  # ROI numbers that are no labels
        write(path, [structure("Zero", box(0, 0, 10), number=0), structure("Seven", box(20, 0, 10), number=7)])
    elif name == "many":
        write(path, [structure(f"S{i}", box(20 * (i % 10), 20 * (i // 10), 10, [0, 2, 4])) for i in range(90)])
    elif name == "long":  # contours of more than 64 kB, which explicit VRs cannot hold as DS: pydicom stores them as UN
        t = 2 * np.pi * np.arange(4000) / 4000
        write(path, [structure("Body", [[(100 * np.cos(a), 80 * np.sin(a), z) for a in t] for z in HEIGHTS[:4]])])
    elif name == "empty":
        write(path, [structure("Nothing", []), structure("Box", box(0, 0, 20))])
    elif name == "none":
        write(path, [structure("Nothing", [])])
    elif name == "wrong_vr":
        write(path, [structure("Box", box(0, 0, 20))])
        data = open(path, "rb").read()
        with open(path, "wb") as file:  # ContourData as integers
            file.write(data.replace(b"\x06\x30\x50\x00DS", b"\x06\x30\x50\x00US"))
    elif name == "no_number":
        write(path, [structure("Box", box(0, 0, 20))])
        data = open(path, "rb").read()
        with open(path, "wb") as file:
            file.write(data.replace(b"20\\0\\", b"2x\\0\\"))
    else:
        sys.exit(f"no case {name}")


if __name__ == "__main__":
    for wanted in sys.argv[2:]:
        case(wanted, f"{sys.argv[1]}/{wanted}.dcm")
