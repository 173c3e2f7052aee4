#!/usr/bin/env python3
"""Compares CalculiX's results on meshes with layers of wedges with exact ones.

usage: layer_answers.py sphere FRD INNER OUTER     hollow sphere 20/30 mm, 1 MPa inside, E = 1000 MPa, nu = 0.3: largest relative L2 error of the
                                                   stress at the inner and at the outer surface
       layer_answers.py strip FRD TIP STRESS       strip of 60 x 10 x 4 mm held at x = 0, 1 N across at its end, E = 1000 MPa, nu = 0: largest
                                                   relative errors of the end's displacement and of the stress above half length
       layer_answers.py patch FRD DISP STRESS      bar along z in uniform tension of 10 MPa, E = 1000 MPa, nu = 0.3: largest errors, mm and MPa
Exits 1 with what differs, 77 without numpy.
"""
import os
import sys

try:
    import numpy as np
except ImportError as error:
    print(f"SKIPPED: {error}")
    sys.exit(77)
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "apps"))
from read_frd import read_frd


def check(what, found, allowed):
    print(f"{what}: {found:.4g}, allowed {allowed:.4g}")
    if not found <= allowed:
        sys.exit(f"MISMATCH: {what}")


def sphere(p, u, s, inner, outer):
    a, b, pressure, young, nu = 20.0, 30.0, 1.0, 1000.0, 0.3
    r = np.linalg.norm(p, axis=1)
    n = p / r[:, None]
    t = np.zeros((len(p), 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))):
        t[:, i, j] = t[:, j, i] = s[:, k]
    radial = np.einsum("ni,nij,nj->n", n, t, n)
    hoop = (np.trace(t, axis1=1, axis2=2) - radial) / 2
    k = a ** 3 * pressure / (b ** 3 - a ** 3)
    held = np.min([np.linalg.norm(p - q, axis=1) for q in np.vstack([30 * np.eye(3), -30 * np.eye(3)])], axis=0) < 9
    for what, at, allowed in (("inner surface", (r > 19.2) & (r < 20.4), inner), ("outer surface", (r > 29.6) & (r < 31) & ~held, outer)):
        exact_radial, exact_hoop = k * (1 - b ** 3 / r[at] ** 3), k * (1 + b ** 3 / (2 * r[at] ** 3))
        error = ((radial[at] - exact_radial) ** 2 + 2 * (hoop[at] - exact_hoop) ** 2).mean() / (exact_radial ** 2 + 2 * exact_hoop ** 2).mean()
        check(f"stress at the {what}, {at.sum()} nodes", error ** 0.5, allowed)
    at = r < 20.4
    exact = k / young * ((1 - 2 * nu) * r[at] + (1 + nu) * b ** 3 / (2 * r[at] ** 2))
    check("displacement of the inner surface", abs(((u[at] * n[at]).sum(axis=1) / exact).mean() - 1), 0.05)


def strip(p, u, s, tip, stress):
    length, width, height, young, force = 60.0, 10.0, 4.0, 1000.0, 1.0
    inertia = width * height ** 3 / 12
    exact = force * length ** 3 / (3 * young * inertia) + 1.2 * force * length / (width * height * young / 2)
    check("displacement of the end", abs(u[np.abs(p[:, 0] - length) < 1e-6, 2].mean() / exact - 1), tip)
    at = (np.abs(p[:, 0] - length / 2) < 6) & (np.abs(p[:, 2] - height) < 1e-6)
    exact = -force * (length - p[at, 0]) * height / 2 / inertia
    check(f"bending stress, {at.sum()} nodes", np.sqrt(((s[at, 0] - exact) ** 2).sum() / (exact ** 2).sum()), stress)


def patch(p, u, s, displacement, stress):
    exact = 0.01 * p * [-0.3, -0.3, 1]
    check("displacement", np.abs(u - exact).max(), displacement)
    check("stress", np.abs(s - [0, 0, 10, 0, 0, 0]).max(), stress)


result = read_frd(sys.argv[2])
{"sphere": sphere, "strip": strip, "patch": patch}[sys.argv[1]](result.points, result.fields["DISP"][:, :3], result.fields["STRESS"], float(sys.argv[3]), float(sys.argv[4]))
