#!/usr/bin/env python3
"""Compares CalculiX results with answers known beforehand.

usage: fem_answers.py uniform FRD E NU STRESS AXIS-LENGTH      a bar along z in uniform tension, from z = 0, corner at the origin
       fem_answers.py series FRD E1 L1 E2 L2 STRESS            two bars end to end along z, no lateral contraction
       fem_answers.py bar FRD E LENGTH STRESS TOLERANCE        held all round at z = 0: end displacement and stress at half length
       fem_answers.py reaction FRD LENGTH FORCE TOLERANCE      nodes at z = 0 together bear FORCE along z
       fem_answers.py contact FRD E NU STRESS INTERFACE K      two bars that touch at z = INTERFACE, pressed together (STRESS < 0)
       fem_answers.py compare LINEAR.frd QUADRATIC.frd FORCE   both in balance; the linear one stiffer, but not by half
       fem_answers.py same FRD OTHER.frd                       nodes at the same place move alike
       fem_answers.py end FRD LENGTH UX UY UZ TOLERANCE        mean displacement of the nodes at z = LENGTH, within a share of its size
       fem_answers.py sphere FRD RADIUS U TOLERANCE            mean displacement outwards of the nodes at RADIUS from the origin
       fem_answers.py frequency DAT F1 TOLERANCE               the first natural frequency, Hz
       fem_answers.py balance FRD FORCE SMALLEST LARGEST       in balance; largest displacement (mm) within the range
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


def need(condition, text):
    if not condition:
        print(f"MISMATCH: {text}")
        sys.exit(1)


def close(a, b, tolerance, what):
    worst = np.abs(np.asarray(a) - np.asarray(b)).max()
    print(f"{what}: worst difference {worst:.3g}, allowed {tolerance:.3g}")
    need(worst <= tolerance, f"{what}: {worst}")


def balance(result, force):
    """Supports bear what the loads press: the sum of forces over the held nodes is the negative of the load's."""
    forces = result.fields["FORC"]
    close(forces.sum(axis=0), 0, 2e-3 * force, "sum of all nodal forces")
    low = result.points[:, 2] < np.median(result.points[:, 2])
    close(abs(forces[low, 2].sum()), force, 2e-3 * force, "force on the lower half")


def main():
    if sys.argv[1] == "frequency":
        meant, tolerance = (float(v) for v in sys.argv[3:])
        with open(sys.argv[2]) as file:
            rows = [line.split() for line in file]
        first_mode = next(row for row in rows if len(row) == 5 and row[0] == "1")
        close(float(first_mode[3]), meant, tolerance * meant, "first natural frequency")
        return
    what, first = sys.argv[1], read_frd(sys.argv[2])
    numbers = [float(v) for v in sys.argv[3:] if not v.endswith(".frd")]
    p, u = first.points, first.fields["DISP"][:, :3]
    stress = first.fields["STRESS"]
    if what == "uniform":
        young, nu, s, length = numbers
        strain = s / young
        need(abs(p[:, 2].max() - length) < 1e-9, "length")
        meant = np.column_stack((-nu * strain * p[:, 0], -nu * strain * p[:, 1], strain * p[:, 2]))
        close(u, meant, 1e-5 * strain * length, "displacement")
        close(stress, np.array([0, 0, s, 0, 0, 0]), 1e-4 * s, "stress")
    elif what == "series":
        e1, l1, e2, l2, s = numbers
        z = p[:, 2]
        meant = np.where(z <= l1, s / e1 * z, s / e1 * l1 + s / e2 * (z - l1))
        at = np.abs(z - l1) < 1e-9
        need(at.any(), "no node on the interface")
        close(u[at, 2], s * l1 / e1, 1e-5 * s * l1 / e1, "displacement of the interface")
        close(u[:, 2], meant, 1e-5 * meant.max(), "displacement")
        close(stress[:, 2], s, 1e-4 * s, "stress")
    elif what == "contact":
        young, nu, s, at, stiffness = numbers
        strain = s / young
        upper = p[:, 2] > at + 1e-9
        touching = np.abs(p[:, 2] - at) < 1e-9
        jump = s / stiffness  # the bodies enter each other by so much
        meant = strain * p[:, 2] + np.where(upper, jump, 0)
        close(u[~touching, 2], meant[~touching], 1e-3 * abs(strain * at), "displacement along the bars")
        z = np.sort(u[touching, 2])
        half = len(z) // 2
        need(len(z) == 2 * half > 0, "each body has its own nodes on the interface")
        close(z[:half].mean() - z[half:].mean(), jump, 0.01 * abs(jump), "penetration")
        close(u[:, 0], -nu * strain * p[:, 0], 1e-3 * abs(strain * at), "displacement across")
        close(stress, np.array([0, 0, s, 0, 0, 0]), 0.005 * abs(s), "stress")
    elif what == "bar":
        young, length, s, tolerance = numbers
        end = p[:, 2] > length - 1e-9
        meant = s * length / young
        close(u[end, 2].mean(), meant, tolerance * meant, "displacement of the end")
        middle = np.abs(p[:, 2] - length / 2) < length / 20
        close(stress[middle, 2], s, tolerance * s, "stress at half length")
    elif what == "reaction":
        length, force, tolerance = numbers
        held = np.abs(p[:, 2]) < 1e-6
        close(abs(first.fields["FORC"][held, 2].sum()), force, tolerance * force if force else tolerance, "reaction")
    elif what == "end":
        length, *meant, tolerance = numbers
        at = np.abs(p[:, 2] - length) < 1e-6
        need(at.any(), "no node at the end")
        close(u[at].mean(axis=0), meant, tolerance * np.linalg.norm(meant), "displacement of the end")
    elif what == "sphere":
        radius, meant, tolerance = numbers
        distance = np.linalg.norm(p, axis=1)
        at = np.abs(distance - radius) < 0.02 * radius
        need(at.sum() > 10, "no nodes at the radius")
        outward = (u[at] * p[at]).sum(axis=1) / distance[at]
        close(outward.mean(), meant, tolerance * abs(meant), "displacement outwards")
    elif what == "compare":
        second = read_frd(sys.argv[3])
        need(first.tets.shape[1] == 4 and second.tets.shape[1] == 10, "orders")
        for result in (first, second):
            balance(result, numbers[0])
        one, two = (np.linalg.norm(r.fields["DISP"][:, :3], axis=1).max() for r in (first, second))
        print(f"largest displacement: linear {one:.4g}, quadratic {two:.4g} mm")
        need(0.5 * two < one < two, "the linear mesh is not the stiffer one, or far too stiff")
    elif what == "same":
        second = read_frd(sys.argv[3])
        at = {tuple(point): i for i, point in enumerate(second.points)}
        twin = [at[tuple(point)] for point in p]
        need(len(p) > len(second.points), "no node is there twice")
        other = second.fields["DISP"][twin, :3]
        close(u, other, 2e-5 * np.abs(other).max(), "displacement")
    elif what == "hung":  # held by its upper end, pressed from inside
        force, smallest, largest = numbers
        held = p[:, 2] > p[:, 2].max() - 1e-6
        close(first.fields["FORC"][held].sum(axis=0)[:3], (0, 0, force), 0.03 * force, "force on the support")
        size = np.linalg.norm(u, axis=1).max()
        print(f"largest displacement {size:.4g} mm")
        need(smallest < size < largest, f"largest displacement {size}")
    elif what == "balance":
        force, smallest, largest = numbers
        balance(first, force)
        size = np.linalg.norm(u, axis=1).max()
        print(f"largest displacement {size:.4g} mm")
        need(smallest < size < largest, f"largest displacement {size}")


main()
