#!/usr/bin/env python3
"""Draws docs/modules.svg: which module uses which, from the USES lines that the build enforces (modules/*/module.cmake).

usage: apps/draw_modules.py [-o docs/modules.svg]      run it after a module's USES changed; a test compares
"""
import argparse
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parent.parent


def read_uses():
    uses = {}
    for file in sorted((ROOT / "modules").glob("*/module.cmake")):
        text = re.sub(r"#.*", "", file.read_text())
        for name, body in re.findall(r"stackmesh_module\((\w+)(.*?)\)", text, re.S):
            found = re.search(r"\bUSES\s+([\w\s]*?)(?:\bPRIVATE\b|$)", body, re.S)
            uses[name] = found.group(1).split() if found else []
    return uses


def rows_of(uses):
    """Modules in rows: each one above all that it uses."""
    row = {}

    def depth(name):
        if name not in row:
            row[name] = 1 + max((depth(u) for u in uses[name]), default=-1)
        return row[name]

    for name in uses:
        depth(name)
    return [[n for n in sorted(uses) if row[n] == r] for r in range(max(row.values()) + 1)]


def direct(uses):
    """Without what follows from other uses, so that the picture stays readable."""

    def reach(name):
        out = set()
        for u in uses[name]:
            out |= {u} | reach(u)
        return out

    return {n: [u for u in used if not any(u in reach(v) for v in used if v != u)] for n, used in uses.items()}


def draw(uses):
    rows, width, step, box = rows_of(uses), 800, 70, (78, 28)
    place = {}
    for r, names in enumerate(rows):
        for i, name in enumerate(names):
            shift = width * (0.1 if r % 2 else -0.1) if len(names) == 1 and 1 < r < len(rows) - 1 else 0  # so that lines pass beside
            place[name] = (width * (i + 1) / (len(names) + 1) + shift, step * (len(rows) - r) - step / 2)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {step * len(rows)}" font-family="sans-serif" font-size="14">']
    for name, used in sorted(direct(uses).items()):
        for u in used:
            (x, y), (a, b) = place[name], place[u]
            out.append(f'<line x1="{x:.0f}" y1="{y + box[1] / 2:.0f}" x2="{a:.0f}" y2="{b - box[1] / 2:.0f}" stroke="#7a8794"/>')
    for name, (x, y) in sorted(place.items()):
        out.append(f'<rect x="{x - box[0] / 2:.0f}" y="{y - box[1] / 2:.0f}" width="{box[0]}" height="{box[1]}" rx="5" fill="#eaf1f8" stroke="#35506b"/>')
        out.append(f'<text x="{x:.0f}" y="{y + 5:.0f}" text-anchor="middle" fill="#16283a">{name}</text>')
    return "\n".join(out + ["</svg>", ""])


if __name__ == "__main__":
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("-o", "--output", default=str(ROOT / "docs/modules.svg"))
    pathlib.Path(options.parse_args().output).write_text(draw(read_uses()))
