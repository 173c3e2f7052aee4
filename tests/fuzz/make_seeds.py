"""Seeds of the fuzzers that no file of the tests holds: NIfTI-1 and -2 of every type and byte order, PNG of every kind.
    python3 tests/fuzz/make_seeds.py CORPUS
The first byte of a seed chooses the ending (readers.cpp); 128 more asks for right check sums of a PNG."""
import gzip
import os
import struct
import sys
import zlib

TYPES = {2: "B", 256: "b", 512: "H", 4: "h", 768: "I", 8: "i", 1280: "Q", 1024: "q", 16: "f", 64: "d"}
SIZE = (4, 3, 2)


def nifti(version, order, datatype, qform=1, sform=1, slope=1, intercept=0, units=2, quaternion=(0, 0, 0)):
    """A volume of 4 x 3 x 2 voxels with labels 0, 1 and 2."""
    size, offset = (348, 352) if version == 1 else (540, 544)
    header = bytearray(offset)
    real = "f" if version == 1 else "d"

    def put(at, kinds, *values):
        struct.pack_into(order + kinds, header, at, *values)

    put(0, "i", size)
    bits = 8 * struct.calcsize(order + TYPES[datatype])
    rows = (-1, 0, 0, 5, 0, -1, 0, 6, 0, 0, 2, 7)
    if version == 1:
        put(40, "8h", 3, *SIZE, 1, 1, 1, 1)
        put(70, "hh", datatype, bits)
        put(76, "8f", 1, 1, 1, 2, 0, 0, 0, 0)
        put(108, "fff", offset, slope, intercept)
        put(123, "B", units)
        put(252, "hh", qform, sform)
        at = 256
        header[344:348] = b"n+1\0"
    else:
        header[4:12] = b"n+2\0\r\n\x1a\n"
        put(12, "hh", datatype, bits)
        put(16, "8q", 3, *SIZE, 1, 1, 1, 1)
        put(104, "8d", 1, 1, 1, 2, 0, 0, 0, 0)
        put(168, "q", offset)
        put(176, "dd", slope, intercept)
        put(344, "ii", qform, sform)
        at = 352
        put(500, "i", units)
    put(at, "6" + real, *quaternion, 5, 6, 7)
    put(at + 6 * struct.calcsize(real), "12" + real, *rows)
    count = SIZE[0] * SIZE[1] * SIZE[2]
    return bytes(header) + struct.pack(order + str(count) + TYPES[datatype], *[i % 3 for i in range(count)])


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(colour, channels, depth, interlaced, split=0, more=False, level=9, width=9, height=7):
    """A picture of one grey value."""
    passes = [(0, 0, 1, 1)]
    if interlaced:
        passes = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
    rows = b""
    for x, y, dx, dy in passes:
        columns = (width - x + dx - 1) // dx
        for k in range((height - y + dy - 1) // dy if columns > 0 else 0):
            filtered = 0 if interlaced else k % 5
            rows += bytes([filtered]) + b"\5" * ((columns * channels * depth + 7) // 8)
    before = chunk(b"PLTE", bytes(range(48))) if colour == 3 else b""
    after = b""
    if more:
        before += chunk(b"gAMA", struct.pack(">I", 45455)) + chunk(b"sBIT", bytes([min(depth, 8)] * channels))
        before += chunk(b"tRNS", b"\0\1" * (3 if colour == 2 else 1)) + chunk(b"zTXt", b"a\0\0" + zlib.compress(b"text"))
        after = chunk(b"tEXt", b"a\0b")
    pixels = zlib.compress(rows, level)
    step = split or len(pixels)
    data = b"".join(chunk(b"IDAT", pixels[i : i + step]) for i in range(0, len(pixels), step))
    header = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlaced)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + before + data + after + chunk(b"IEND", b"")


def main():
    def write(reader, name, data):
        folder = os.path.join(sys.argv[1], reader)
        os.makedirs(folder, exist_ok=True)
        with open(os.path.join(folder, name), "wb") as file:
            file.write(data)

    kinds = ({}, {"sform": 0, "quaternion": (0.1, 0.2, 0.3)}, {"slope": 0.5, "intercept": 1, "units": 1}, {"qform": 0, "sform": 2})
    for version in (1, 2):
        for order, end in (("<", "little"), (">", "big")):
            for datatype in TYPES:
                for k, kind in enumerate(kinds if datatype in (2, 16) else kinds[:1]):
                    volume, name = nifti(version, order, datatype, **kind), f"nifti{version}_{end}_{datatype}_{k}"
                    write("volumes", name, b"\0" + volume)
                    write("volumes", name + "_gz", b"\1" + gzip.compress(volume, mtime=0))
    for colour, channels in ((0, 1), (2, 3), (3, 1), (4, 2), (6, 4)):
        for depth in (1, 2, 4, 8, 16):
            if (colour in (2, 4, 6) and depth < 8) or (colour == 3 and depth > 8):
                continue
            for interlaced in (0, 1):
                for k, kind in enumerate(({}, {"split": 5}, {"more": True}, {"level": 0})):
                    picture = png(colour, channels, depth, interlaced, **kind)
                    write("slices", f"png{colour}_{depth}_{interlaced}_{k}", b"\0" + picture)
                    write("slices", f"png{colour}_{depth}_{interlaced}_{k}_sums", b"\x80" + picture)


main()
