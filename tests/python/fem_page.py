#!/usr/bin/env python3
"""Runs what docs/fem.md tells a reader to run, and compares its figures with what comes out.

usage: fem_page.py SOURCE PROGRAM DATA    in an empty folder; DATA holds the torso and its CT
Exits 1 with what differs; 77 without numpy, CalculiX or the data.
"""
import json
import os
import re
import shutil
import subprocess
import sys

try:
    import numpy as np
except ImportError as error:
    print(f"SKIPPED: {error}")
    sys.exit(77)
SOURCE, PROGRAM, DATA = sys.argv[1:]
if shutil.which("ccx") is None or not os.path.exists(f"{DATA}/ct_3mm.nii.gz"):
    print("SKIPPED: no CalculiX, or no data")
    sys.exit(77)
sys.path.insert(0, f"{SOURCE}/apps")
from read_frd import read_frd

with open(f"{SOURCE}/docs/fem.md") as file:
    page = file.read()
blocks = re.findall(r"^```\n(.*?)^```$", page, re.M | re.S)
prepare, load_case, commands = blocks[:3]


def run(text):
    text = text.replace("build/stackmesh", f"'{PROGRAM}'").replace("testdata/", f"'{SOURCE}'/testdata/")
    text = re.sub(r"\b(torso_3mm_61labels|ct_3mm)\.nii\.gz", lambda m: f"'{DATA}/{m.group(0)}'", text)
    done = subprocess.run(["bash", "-e", "-c", text], capture_output=True, text=True)
    if done.returncode != 0:
        print(f"MISMATCH: exit {done.returncode} of\n{text}\n{done.stdout}{done.stderr}")
        sys.exit(1)


run(prepare)
with open("law.json") as file:  # behind the mapping, as the page says: the last entry
    text = file.read().rstrip()
if not text.endswith("}"):
    sys.exit("MISMATCH: law.json does not end in }")
with open("law.json", "w") as file:
    file.write(text[:-1] + load_case + "}\n")
json.load(open("law.json"))
run("\n".join(line for line in commands.split("\n") if "draw_displacement" not in line))

tets, low, high, mean, moved = (float(v.replace(",", "")) for v in re.search(
    r"([\d,]+) second-order tetrahedra, modulus ([\d,.]+) to ([\d,.]+) MPa \(mean ([\d,.]+)\).*?moves by ([\d.]+) mm", page, re.S).groups())
report = json.load(open("femur.json"))
material = report["fem"]["materials"][0]
bins = re.search(r"(\d+) bins, off by at most ([\d.]+) %", page)
displacement = np.linalg.norm(read_frd("femur.frd").fields["DISP"][:, :3], axis=1).max()
wrong = []
for what, said, found, tolerance in (("tetrahedra", tets, report["fem"]["elements"], 0.3), ("largest modulus", high, material["modulus_max_mpa"], 0.1),
                                     ("mean modulus", mean, material["modulus_mean_mpa"], 0.03), ("displacement", moved, displacement, 0.05),
                                     ("error of the bins, %", float(bins.group(2)), 100 * material["bin_error_max_rel"], 0.5)):
    print(f"{what}: the page says {said:g}, found {found:.5g}")
    if not abs(found - said) <= tolerance * said:
        wrong.append(what)
if report["fem"]["load_case"]["force_n"][2] > -999.9 or material["clamped_low"] + material["clamped_high"] != 0:
    wrong.append("load, or what was set to floor and ceiling")
if wrong:
    print(f"MISMATCH: {', '.join(wrong)}: write docs/fem.md anew")
sys.exit(1 if wrong else 0)
