#!/usr/bin/python3
"""Makes a cohort of 200 small cases for tests/robustness/cohort.sh: label volumes of testdata/ and ../shared/data, cropped, scaled and
turned, and some that are broken on purpose.

usage: make_cohort.py FOLDER [--cases N] [--source FOLDER_OF_TESTDATA] [--shared FOLDER_OF_SHARED_DATA]

Writes FOLDER/in/*.nii.gz, FOLDER/cases.csv (the manifest) and FOLDER/expected.tsv (id, good or the kind of fault, and a part of the
reason that must be told). The same call makes the same files.
"""
import argparse
import gzip
import os
import random
import sys

import nibabel
import numpy

arguments = argparse.ArgumentParser()
arguments.add_argument("folder")
arguments.add_argument("--cases", type=int, default=200)
here = os.path.dirname(os.path.abspath(__file__))
arguments.add_argument("--source", default=os.path.join(here, "../../testdata"))
arguments.add_argument("--shared", default=os.path.join(here, "../../../shared/data"))
options = arguments.parse_args()

# name, file, largest extent of a crop in voxels
SOURCES = [("vessel", options.source + "/vessel.nii.gz", (44, 40, 24)), ("border", options.source + "/border.nii.gz", (18, 16, 9)),
           ("shells", options.source + "/shells.nii.gz", (20, 20, 20)), ("oblique", options.source + "/oblique.nii.gz", (30, 26, 18)),
           ("heart", options.source + "/heart4.nii.gz", (30, 26, 7)), ("femur", options.source + "/femur.nii.gz", (26, 26, 14)),
           ("liver", options.shared + "/liver_cgal/liver.nii.gz", (24, 24, 14)), ("cord", options.shared + "/spinal_cord_thick_sct/t1w_seg-manual.nii.gz", (30, 30, 16)),
           ("lung", options.shared + "/lung_lr_cip/lungs_32sections_8p5mm.nii.gz", (28, 28, 8)), ("ventricle", options.shared + "/ventricles_mri_itksnap/MRIcrop-seg.nii.gz", (26, 26, 16))]
# Kinds of fault: how many of 200, and what the reason holds.
FAULTS = {"truncated": (6, ""), "empty": (4, "background"), "wrong_type": (4, ""), "too_large": (3, "memory"), "hangs": (2, "--timeout"), "bad_option": (2, "")}

large = []  # the bytes of the large volume, once it is made
random.seed(17)
os.makedirs(options.folder + "/in", exist_ok=True)


def crop(labels, size):
    """A part of the volume around a voxel that is not background."""
    filled = numpy.argwhere(labels > 0)
    middle = filled[random.randrange(len(filled))]
    low = [max(0, min(int(m) - s // 2, n - s)) for m, s, n in zip(middle, size, labels.shape)]
    return labels[tuple(slice(a, a + s) for a, s in zip(low, size))]


def turned(labels):
    """One of the 24 turns of a box, without mirroring."""
    order = random.choice([(0, 1, 2), (1, 2, 0), (2, 0, 1)])
    labels = labels.transpose(order)
    for _ in range(2):
        axis = random.randrange(3)
        labels = numpy.flip(labels, tuple(a for a in range(3) if a != axis))
    return labels, order


def save(path, labels, spacing, kind=numpy.uint16):
    image = nibabel.Nifti1Image(numpy.ascontiguousarray(labels).astype(kind), numpy.diag([-spacing[0], -spacing[1], spacing[2], 1]))
    data = image.to_bytes()
    with open(path, "wb") as file, gzip.GzipFile("", "wb", 2, file, mtime=0) as packed:
        packed.write(data)


def make_good(path, volumes):
    while True:
        name, labels, spacing, largest = random.choice(volumes)
        part, order = turned(crop(labels, [min(s, n) for s, n in zip(largest, labels.shape)]))
        if (part > 0).sum() > 300:
            break
    scale = random.uniform(0.8, 1.25)
    save(path, part, [scale * spacing[a] for a in order])
    return name


def make_faulty(kind, path, good):
    if kind == "truncated":
        data = open(good, "rb").read()
        open(path, "wb").write(data[:len(data) * random.randrange(20, 90) // 100])
    elif kind == "empty":
        save(path, numpy.zeros((20, 20, 10)), (1, 1, 2))
    elif kind == "wrong_type":
        if random.random() < 0.5:
            open(path, "w").write("this is no volume\n")
        else:
            save(path, numpy.random.default_rng(17).normal(size=(20, 20, 10)), (1, 1, 2), numpy.float32)
    elif kind == "too_large":  # 245 MB of voxels, more than --case-memory leaves for what is made of them
        if not large:
            labels = numpy.zeros((700, 700, 500), numpy.uint8)
            labels[100:600, 100:600, 100:400] = 1
            save(path, labels, (0.5, 0.5, 0.5), numpy.uint8)
            large.append(open(path, "rb").read())
        open(path, "wb").write(large[0])
    elif kind == "hangs":  # far too fine: minutes for its more than a million tetrahedra
        image = nibabel.load(options.source + "/border.nii.gz")
        save(path, numpy.asarray(image.dataobj), (1.5, 1.5, 4))


def main():
    volumes = []
    for name, path, largest in SOURCES:
        if not os.path.exists(path):
            print(f"make_cohort.py: left out: {path} is not there", file=sys.stderr)
            continue
        image = nibabel.load(path)
        volumes.append((name, numpy.asarray(image.dataobj).astype(numpy.int32), [float(z) for z in image.header.get_zooms()[:3]], largest))
    kinds = [k for k, (n, _) in FAULTS.items() for _ in range(max(1, round(n * options.cases / 200)))]
    kinds += ["good"] * (options.cases - len(kinds))
    random.shuffle(kinds)
    if kinds[0] != "good":  # a truncated one needs one that is whole
        first = kinds.index("good")
        kinds[0], kinds[first] = kinds[first], kinds[0]
    good = None
    with open(options.folder + "/cases.csv", "w") as manifest, open(options.folder + "/expected.tsv", "w") as expected:
        manifest.write("id,input,edge-length,merge\n")
        for i, kind in enumerate(kinds):
            ident, own = f"case-{i + 1:03d}", ","
            path = f"{options.folder}/in/{ident}.nii.gz"
            if os.path.lexists(path):
                os.remove(path)
            if kind in ("good", "bad_option"):
                name = make_good(path, volumes)
                good = path
                own = random.choice([",", ",", ",yes"]) if kind == "good" else "5=,"
                if kind == "bad_option":
                    own = "77=2.0,"  # a label that is not there
            else:
                make_faulty(kind, path, good)
                name = kind
                own = "0.3," if kind == "hangs" else own
            manifest.write(f"{ident},in/{ident}.nii.gz,{own}\n")
            expected.write(f"{ident}\t{kind}\t{FAULTS.get(kind, (0, ''))[1]}\t{name}\n")
    print(f"{len(kinds)} cases, {kinds.count('good')} good, in {options.folder}")


main()
