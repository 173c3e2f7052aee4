#!/usr/bin/python3
"""Makes the phantoms of this folder, or checks that the committed ones are what it makes.

  make_testdata.py            writes the files beside this script
  make_testdata.py -o DIR     writes them to DIR
  make_testdata.py --check    compares (decompressed) with the files beside this script; exit 1 on a difference

Needs numpy and nibabel. Nothing is random but noise.nii.gz, which has its own fixed generator. Lengths are mm.
"""
import argparse
import gzip
import pathlib
import struct
import sys
import zlib

import nibabel
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent


# ---- files -------------------------------------------------------------------------------------------------

def nifti(voxels, affine):
    """The bytes of a NIfTI-1 file; voxels are indexed [x, y, z], affine is voxel to RAS mm."""
    image = nibabel.Nifti1Image(voxels, affine)
    image.header.set_xyzt_units("mm")
    image.set_sform(affine, code=1)
    image.set_qform(affine, code=1)
    return gzip.compress(image.to_bytes(), 9, mtime=0)


def png(pixels):
    """The bytes of an 8-bit grey PNG; pixels are indexed [row, column]."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows, columns = pixels.shape
    raw = b"".join(b"\0" + row.astype(np.uint8).tobytes() for row in pixels)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def cnt(sections, header="S"):
    """The bytes of a contour file; sections are (z, [polygon, ...]), a polygon is an n x 2 array."""
    lines = [f"{header} {len(sections)}"]
    for z, polygons in sections:
        lines.append(f"v {sum(len(p) for p in polygons)} z {z:g}")
        for polygon in polygons:
            lines += ["{"] + [f"{x:.4f} {y:.4f}" for x, y in polygon] + ["}"]
    return ("\n".join(lines) + "\n").encode()


def decoded(name, data):
    """What must not change: compressed streams differ between zlib versions, their content does not."""
    if name.endswith(".gz"):
        return gzip.decompress(data)
    if name.endswith(".png"):
        start = data.index(b"IDAT")
        size, = struct.unpack(">I", data[start - 4:start])
        return data[:start - 4] + zlib.decompress(data[start + 4:start + 4 + size])
    return data


# ---- shapes: signed distances (about), negative inside -------------------------------------------------------

def grid(size, spacing, origin):
    """Coordinates of the voxel centres along x, y and z, broadcastable."""
    axes = [o + s * np.arange(n) for n, s, o in zip(size, spacing, origin)]
    return np.meshgrid(*axes, indexing="ij", sparse=True)


def ellipsoid(p, centre, radii):
    q = [(a - c) / r for a, c, r in zip(p, centre, radii)]
    k = np.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2)
    return (k - 1) * min(radii)


def cone(p, a, b, ra, rb):
    """A rounded rod from a to b whose radius goes from ra to rb."""
    a, b = np.array(a, float), np.array(b, float)
    d = b - a
    t = sum((q - o) * e for q, o, e in zip(p, a, d)) / d.dot(d)
    t = np.clip(t, 0, 1)
    return np.sqrt(sum((q - o - t * e) ** 2 for q, o, e in zip(p, a, d))) - (ra + t * (rb - ra))


def rod(p, points, radii):
    """A chain of rounded rods."""
    parts = [cone(p, *ends, *r) for ends, r in zip(zip(points, points[1:]), zip(radii, radii[1:]))]
    return np.minimum.reduce(parts)


def blend(a, b, k):
    """A union with a fillet of about k."""
    h = np.clip(0.5 + 0.5 * (b - a) / k, 0, 1)
    return b + h * (a - b) - k * h * (1 - h)


def affine_of(spacing, origin, axes=np.eye(3)):
    affine = np.eye(4)
    affine[:3, :3] = np.asarray(axes) * np.asarray(spacing)
    affine[:3, 3] = origin
    return affine


# ---- the phantoms --------------------------------------------------------------------------------------------

def femur():
    """1 cortical bone, 2 medullary canal, which forks into the condyles and runs out into the neck."""
    size, spacing, origin = (112, 78, 115), (1, 1, 3), (-42.3, -42.6, -5.1)
    p = grid(size, spacing, origin)
    bow = [(0, 1, 40), (-1, 6, 95), (-2, 9, 150), (-3, 7, 205), (-4, 1, 265)]
    bone = rod(p, bow, [22, 15, 13.5, 14, 16.5])
    bone = blend(bone, cone(p, (-6, 0, 268), (34, 8, 308), 15, 13), 8)             # neck
    bone = blend(bone, ellipsoid(p, (42, 9, 314), (22.5, 22, 22)), 4)              # head
    bone = blend(bone, ellipsoid(p, (-17, -5, 290), (13, 17, 24)), 7)              # greater trochanter
    bone = blend(bone, ellipsoid(p, (11, -15, 256), (8, 8, 11)), 5)                # lesser trochanter
    bone = blend(bone, cone(p, (-13, 6, 44), (14, 6, 44), 18, 18), 8)              # metaphysis
    condyles = np.minimum(ellipsoid(p, (21.5, -9, 18), (14.5, 30, 20)),
                          ellipsoid(p, (-21, -7, 20), (14, 28, 19)))
    bone = blend(bone, condyles, 5)
    bone = np.maximum(bone, -cone(p, (0, -40, 14), (0, -4, 20), 8.5, 6.5))         # notch between the condyles
    canal = rod(p, [(0, 2, 50)] + bow[1:] + [(6, 3, 282), (26, 7, 302)], [10, 7, 5.5, 6.5, 10, 9, 6])
    canal = np.minimum(canal, cone(p, (2, 2, 52), (21, -6, 16), 8, 5))
    canal = np.minimum(canal, cone(p, (-2, 2, 52), (-20, -5, 19), 8, 4.5))
    canal = np.maximum(canal, bone + 3.2)
    labels = np.zeros(size, np.uint8)
    labels[bone < 0] = 1
    labels[canal < 0] = 2
    return labels, affine_of(spacing, (-38.5, 21.75, -410.25))


def heart():
    """1 left ventricle, 2 right ventricle, 3 left atrium, 4 right atrium, 5 myocardium. Apex at the low end."""
    size, spacing, origin = (92, 76, 18), (1.25, 1.25, 8), (-61, -46, -76)
    p = grid(size, spacing, origin)
    x, y, z = p
    ventricles = z < 8                                                             # the valve plane
    left = ellipsoid(p, (14, 0, 4), (24, 23, 70))
    outer = ellipsoid(p, (14, 0, 4), (34, 33, 80))
    right = ellipsoid(p, (-16, 3, 6), (36, 30, 62))
    right_outer = ellipsoid(p, (-16, 3, 6), (39.5, 33.5, 66))
    left_atrium = ellipsoid(p, (15, 6, 30), (27, 24, 27))
    right_atrium = ellipsoid(p, (-24, 4, 31), (26, 25, 28))
    labels = np.zeros(size, np.uint8)
    labels[(right_outer < 0) & ventricles] = 5
    labels[(right < 0) & ventricles] = 2
    labels[(outer < 0) & ventricles] = 5
    labels[(left < 0) & ventricles] = 1
    papillary = np.minimum(cone(p, (24, 10, -38), (26, 9, -14), 4, 3.2), cone(p, (4, -11, -40), (6, -10, -20), 4.2, 3))
    labels[(papillary < 0) & ventricles & (left < 0)] = 5                          # islands in the left ventricle
    above = ~ventricles
    labels[(right_atrium < 0) & above] = 4
    labels[(left_atrium < 0) & above & (left_atrium < right_atrium)] = 3           # the atria touch, no wall
    return labels, affine_of(spacing, (-57.5, -130.0, 80.0))


def vessel():
    """1: a trunk with an arch that comes down again, and two generations of branches down to 1.5 pixels."""
    size, spacing, origin = (88, 72, 46), (0.8, 0.8, 2), (-34.9, -28.7, -1.3)
    p = grid(size, spacing, origin)
    tree = rod(p, [(-8, 0, 2), (-8, 1, 24), (-6, 2, 38)], [5.2, 4.6, 4.2])                             # trunk
    turn = np.linspace(0, np.pi, 9)
    arch = [(-6 + 12 * (1 - np.cos(t)), 2 - 3 * np.sin(t), 38 + 14 * np.sin(t)) for t in turn]
    tree = np.minimum(tree, rod(p, arch, np.linspace(4.2, 3.1, len(arch))))
    tree = np.minimum(tree, rod(p, [arch[-1], (19, 3, 22), (23, 8, 6)], [3.1, 2.4, 1.9]))              # down again
    tree = np.minimum(tree, rod(p, [(19, 3, 24), (12, -9, 14), (9, -16, 4)], [2.0, 1.6, 1.3]))
    tree = np.minimum(tree, rod(p, [(1, -1, 50), (-4, -4, 64), (-14, -9, 76)], [2.6, 2.1, 1.5]))       # up
    tree = np.minimum(tree, rod(p, [(-4, -4, 63), (2, -13, 70), (4, -18, 84)], [1.9, 1.5, 1.2]))
    tree = np.minimum(tree, rod(p, [(9, -1, 51), (15, 5, 66), (14, 14, 82)], [2.3, 1.7, 1.3]))
    tree = np.minimum(tree, rod(p, [(15, 5, 65), (27, 6, 69), (31, 10, 72)], [1.6, 1.4, 1.2]))         # almost flat
    tree = np.minimum(tree, rod(p, [(-8, 1, 20), (-20, 8, 22), (-29, 15, 21)], [2.2, 1.8, 1.3]))       # flat
    return (tree < 0).astype(np.uint8), affine_of(spacing, (12.4, -80.2, 143.0))


def shells():
    """3 > 11 > 200 > 517: each inside the one before; the third is about a voxel thin and has a hole. LIA."""
    size, spacing = (40, 38, 42), (1.1, 1.1, 1.1)
    p = grid(size, spacing, [-0.5 * s * (n - 1) for s, n in zip(spacing, size)])
    labels = np.zeros(size, np.float32)
    labels[ellipsoid(p, (0, 0, 0), (19.5, 18.5, 20)) < 0] = 3
    labels[ellipsoid(p, (1.5, 0.5, -1), (15, 14.5, 15.5)) < 0] = 11
    labels[ellipsoid(p, (2, 0, 0), (10.6, 10.2, 11)) < 0] = 200
    labels[ellipsoid(p, (2, 0, 0), (9.3, 8.9, 9.7)) < 0] = 517
    pore = (p[0] > 2) & (np.hypot(p[1] - 0.4, p[2] + 0.6) < 2.0)
    labels[pore & (labels == 200)] = 11
    axes = np.array([[-1, 0, 0], [0, 0, 1], [0, -1, 0]])                           # L, I, A: mirrored
    return labels, affine_of(spacing, (22.0, -18.5, 31.0), axes)


def noise():
    """0 to 3, each voxel on its own: every kind of diagonal touch."""
    size = (12, 11, 9)
    state, values = 20240229, []
    for _ in range(np.prod(size)):
        state = (state * 6364136223846793005 + 1442695040888963407) % 2 ** 64
        values.append((state >> 33) % 4)
    return np.array(values, np.uint8).reshape(size, order="F"), affine_of((0.9, 1.1, 2.5), (-4, 3, 10))


def border():
    """1, 2 and 3 fill the image up to all six faces, but for a bore along z and a pocket inside."""
    size, spacing = (26, 22, 13), (1.5, 1.5, 4)
    x, y, z = grid(size, spacing, (0, 0, 0))
    labels = np.ones(size, np.uint8)
    labels[x + 0.35 * y + 0.3 * z > 38] = 2
    labels[y + 0.25 * z - 0.4 * x > 16] = 3
    labels[np.broadcast_to(np.hypot(x - 12, y - 10) < 4.2, size)] = 0
    labels[ellipsoid((x, y, z), (28, 22, 24), (5, 5, 9)) < 0] = 0
    return labels, affine_of(spacing, (100, -60, 7.5))


def oblique():
    """100 a body with a hook and no symmetry, 300 a core that reaches its surface; turned about all axes."""
    size, spacing = (46, 34, 24), (0.7, 1.1, 2.5)
    p = grid(size, spacing, (0, 0, 0))
    body = rod(p, [(6, 9, 6), (8, 27, 8), (23, 29, 12)], [4.2, 3.8, 3.2])
    body = blend(body, rod(p, [(7, 13, 8), (13, 12, 44), (24, 15, 50)], [4.6, 4.0, 3.4]), 2)
    core = rod(p, [(8, 12, 4), (12.5, 12, 40)], [2.2, 1.9])
    core = np.minimum(core, ellipsoid(p, (23, 29.5, 12), (2.6, 2.6, 2.6)))
    labels = np.zeros(size, np.int16)
    labels[body < 0] = 100
    labels[(core < 0) & (body < 0)] = 300
    a, b, c = np.radians([20, -35, 15])
    turn = (np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]]) @
            np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]]) @
            np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]]))
    return labels, affine_of(spacing, (-31.0, 47.5, -212.25), turn)


def masks():
    """Structures of one grid, each its own mask; the aorta enters the heart, the hip bone bites the femur."""
    size, spacing, origin = (56, 44, 26), (2, 2, 5), (-55, -43, 0)
    p = grid(size, spacing, origin)
    shapes = {
        "heart": ellipsoid(p, (8, 10, 98), (28, 22, 24)),
        "aorta": rod(p, [(-4, 4, 112), (-6, 0, 122), (-12, -14, 118), (-13, -22, 60), (-12, -22, 4)], [8, 8, 7, 6.5, 6]),
        "femur_left": rod(p, [(36, 6, -4), (36, 6, 26), (22, 8, 44)], [8, 8, 11]),
        "hip_left": np.maximum(ellipsoid(p, (15, 4, 52), (17, 15, 17)), -ellipsoid(p, (22, 8, 44), (9.5, 9.5, 9.5))),
    }
    return {name: (shape < 0).astype(np.uint8) for name, shape in shapes.items()}, affine_of(spacing, (-60, -100, 900))


def loop(centre, radii, count, wobble=0.0, lobes=3, phase=0.0, clockwise=False):
    t = phase + 2 * np.pi * np.arange(count) / count
    r = 1 + wobble * np.cos(lobes * t)
    points = np.stack([centre[0] + radii[0] * r * np.cos(t), centre[1] + radii[1] * r * np.sin(t)], 1)
    return points[::-1] if clockwise else points


def tube():
    """A bent rod: unequal gaps, another number of points and another orientation in every section."""
    heights = [-12, -9, -5, -2.5, 0, 4, 9, 11, 15, 18.5, 21]
    return [(z, [loop((6 * np.sin(0.09 * z), 0.3 * z), (7 - 0.12 * z, 5 + 0.1 * z), 17 + 4 * (i % 4), 0.06, 3, 0.1 * i,
                      clockwise=i % 2 == 1)]) for i, z in enumerate(heights)]


def two_labels():
    """The walls of a ventricle, 8 mm apart; the inner one starts a section later and once nearly touches."""
    outer, inner = [], []
    for i in range(9):
        z, r = 8.0 * i, 30 * np.sqrt(1 - ((i - 7.5) / 8.5) ** 2) + 4
        outer.append((z, [loop((100 + 0.8 * i, 150), (r, 0.92 * r), 60, 0.02, 5)]))
        if i > 0:
            shift = 0.36 * r + 0.98 if i == 5 else 2.0
            inner.append((z, [loop((100 + 0.8 * i + shift, 150), (0.62 * r, 0.58 * r), 44, 0.01, 4, 0.05, clockwise=True)]))
    return outer, inner


def branch():
    """One trunk with a hole divides into two; one of them keeps a hole with an island, the other divides again."""
    sections = []
    for i in range(12):
        z = 3.0 * i
        if i < 4:
            sections.append((z, [loop((0, 0), (16 + i, 9), 40, 0.03, 2), loop((1, 0), (6, 4 - 0.4 * i), 18, clockwise=True)]))
            continue
        gap = 1.5 * (i - 4)
        polygons = [loop((-11 - gap, 0), (8.5, 8), 28, 0.03, 3)]
        if i < 8:
            polygons += [loop((-11 - gap, 0), (5, 4.6), 20, phase=0.2), loop((-11 - gap, 0.4), (1.6, 1.5), 9, clockwise=True)]
            polygons.append(loop((11 + gap, 1), (7.5, 7.5), 26, clockwise=i % 2 == 0))
        else:
            spread = 4.2 + 0.8 * (i - 8)
            polygons += [loop((11 + gap, 1 + s * spread), (4.5, 3.2), 16, phase=0.3 * s) for s in (-1, 1)]
        sections.append((z, polygons))
    return sections


def everything():
    """All files: name to bytes."""
    files = {}
    for make in (femur, vessel, shells, noise, border, oblique):
        files[make.__name__ + ".nii.gz"] = nifti(*make())
    labels, affine = heart()
    files["heart4.nii.gz"] = nifti(labels, affine)
    for i in range(12):
        files[f"slices_png/slice_{i + 1}.png"] = png(labels[:, :, 3 + i].T)
    structures, affine = masks()
    for name, mask in structures.items():
        files[f"masks/{name}.nii.gz"] = nifti(mask, affine)
    files["tube.cnt"] = cnt(tube(), header="s")
    files["branch.cnt"] = cnt(branch())
    outer, inner = two_labels()
    files["two_labels/outer.cnt"] = cnt(outer)
    files["two_labels/inner.cnt"] = cnt(inner)
    return files


def main():
    parser = argparse.ArgumentParser(description="Makes or checks the phantoms of testdata/.")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=HERE, help="folder to write to (default: this one)")
    parser.add_argument("--check", action="store_true", help="compare with the folder instead of writing")
    arguments = parser.parse_args()
    wrong = []
    for name, data in sorted(everything().items()):
        path = arguments.output / name
        if arguments.check:
            if not path.is_file() or decoded(name, path.read_bytes()) != decoded(name, data):
                wrong.append(name)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
    if wrong:
        sys.exit("make_testdata.py: error: not what this script makes: " + ", ".join(wrong) +
                 "; run it without --check and look at the difference")


if __name__ == "__main__":
    main()
