#!/usr/bin/env python3
"""Times the command line and the module on one input, in turns: measure_overhead.py INPUT [ROUNDS]. Prints medians and their ratio to the command line's; asserts nothing."""

import os
import statistics
import sys
import tempfile
import time

import stackmesh
from support import command_line

try:
    import nibabel
except ImportError:
    nibabel = None


def main():
    path, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "o.vtu")
        ways = {
            "command line, -o o.vtu": lambda: command_line("mesh", path, "-o", out),
            "mesh(path)": lambda: stackmesh.mesh(path),
            "mesh(path).save('o.vtu')": lambda: stackmesh.mesh(path).save(out),
        }
        if nibabel is not None:
            image = nibabel.load(path)
            labels = image.dataobj.get_unscaled() if hasattr(image.dataobj, "get_unscaled") else image.get_fdata()
            ways["mesh(array, affine)"] = lambda: stackmesh.mesh(labels, image.affine)
        took = {name: [] for name in ways}
        for _ in range(rounds):
            for name, way in ways.items():
                start = time.perf_counter()
                way()
                took[name].append(time.perf_counter() - start)
    base = statistics.median(took["command line, -o o.vtu"])
    for name, times in took.items():
        print(f"| {name} | {statistics.median(times):.2f} | {min(times):.2f} | {statistics.median(times) / base:.3f} | {min(times) / min(took['command line, -o o.vtu']):.3f} |")


if __name__ == "__main__":
    main()
