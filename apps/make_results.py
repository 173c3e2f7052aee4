#!/usr/bin/env python3
"""Meshes every real input of the shared data and writes what came out as docs/results.md.

  make_results.py                                    all of it, some minutes
  make_results.py --only torso                       rows whose name matches, to the terminal
  make_results.py --paper                            the paper's examples alone, into that section of docs/results.md
  make_results.py --program P --data D -o OUT.md

Every label volume and every set of contours below the data folder is an input; further sets mesh several contour
files at once as labels. Inputs run one at a time. The exit code is 1 when a row is short of the guarantee.
"""
import argparse
import collections
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
VOLUMES = (".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".gipl", ".gipl.gz")
NOT_LABELS = ("torso_totalseg/ct_3mm.nii.gz",)  # intensities
LAST = ("lung_lr_cip/lungs_left_right.nrrd",)   # the long ones
STAGES = ("read", "contours", "stitch", "volume", "validate", "write")

# The paper's examples: section 5 and Table I. Triangles and CPU seconds are those of the reconstruction.
PAPER = [
    ("heart", 29, 1222, 3618, "< 1", "heart_totalseg/heart.nii.gz"),
    ("lung", 32, 2629, 9128, "1.2", "lung_lr_cip/lungs_32sections_8p5mm.nii.gz"),
    ("femur, outer and inner wall", 87, 12269, None, "5.5", "femur_proximal/sections/femur_12_50.cnt"),
    ("hip", 78, 3123, 8764, "1.8", "sacrum_vhf/sections/Sacrum_78.cnt"),
    ("skull", 133, 8324, 26411, "4.1", "skull_ct_invesalius/bone_mask.nii.gz"),
    ("foot", 142, 11527, 36772, "5.2", "foot_vhf/sections: 8 bones"),
]
WHAT = {
    "heart_totalseg/heart.nii.gz": "whole heart",
    "lung_lr_cip/lungs_32sections_8p5mm.nii.gz": "both lungs",
    "femur_proximal/sections/femur_12_50.cnt": "upper part of a femur, outer wall",
    "sacrum_vhf/sections/Sacrum_78.cnt": "sacrum, as no hip was at hand",
    "skull_ct_invesalius/bone_mask.nii.gz": "thresholded skull, noise included",
    "foot_vhf/sections: 8 bones": "8 groups of bones as 8 labels",
}

PICTURES = [
    "![heart](heart.png)", "",
    "*The heart with `--edge-length 3`, before sections were faired (as `--band 0 --as-stored` still gives it) and now: `heart_totalseg/heart.nii.gz`.*", "",
    "![skull, enhanced](skull_enhanced.png)", "",
    "*The skull stitched from its pixels' outlines, and with `--edge-length 2.5` before sections were faired and now.*", "",
    "![foot](foot.png)", "",
    "*Eight groups of bones of a foot, from contours: with and without virtual sections (docs/interpolate.md).*", "",
    "![thick ventricle](ventricle.png)", "",
    "*Contours of a left ventricle 8 mm apart, likewise.*", "",
    "![skull](skull.png)", "",
    "*The thresholded skull with the head rest that the threshold caught: `skull_ct_invesalius/bone_mask.nii.gz`.*", "",
    "![torso](torso.png)", "",
    "*61 labels that share their faces: `torso_totalseg/torso_3mm_61labels.nii.gz`.*", "",
    "![left ventricle](heart_sax.png)", "",
    "*Hand-drawn contours of a left ventricle, 8 mm apart: `heart_sax_sunnybrook/SC-HF-I-4`, wall and cavity. Where the wall moves "
    "by more than its thickness from one section to the next (on the far side, near the apex), the cavity reaches the outside "
    "in between: that is the direct stitch, before virtual sections.*",
]
DRAWN = """
mkdir -p build/pictures; cd build/pictures; D=../../../shared/data; S=$D/heart_sax_sunnybrook/SC-HF-I-4
../stackmesh mesh ../../testdata/femur.nii.gz -o femur.vtp -o femur.vtu
s="--no-enhance --interpolate 0 --band 0"
../stackmesh surface $D/skull_ct_invesalius/bone_mask.nii.gz $s -o skull.vtp
../stackmesh surface $D/skull_ct_invesalius/bone_mask.nii.gz --edge-length 2.5 -o skull2.vtp
old="--band 0 --as-stored"
../stackmesh surface $D/heart_totalseg/heart.nii.gz --edge-length 3 $old -o heart0.vtp
../stackmesh surface $D/heart_totalseg/heart.nii.gz --edge-length 3 -o heart3.vtp
../stackmesh surface $D/skull_ct_invesalius/bone_mask.nii.gz --edge-length 2.5 $old -o skull0.vtp
../stackmesh mesh $D/torso_totalseg/torso_3mm_61labels.nii.gz $s -o torso.vtp -o torso.vtu
../stackmesh mesh 1=$S/epi_ED.cnt 2=$S/endo_ED.cnt $s -o sax.vtp -o sax.vtu; cat $S/epi_ED.cnt $S/endo_ED.cnt > sax.cnt
r=../../apps/render.py; o=../../docs; cut="tetrahedra, cut open"
$r femur.vtp@25,8 femur.vtu@cut=y=-69.5@25,8 -o $o/femur.png --size 400x760 --title surface --title "$cut"
$r heart0.vtp heart3.vtp -o $o/heart.png --size 560x560 --title "before fairing" --title now
$r skull.vtp@35,8 skull0.vtp@35,8 skull2.vtp@35,8 -o $o/skull_enhanced.png --size 560x560 --title "stitched from the pixels' outlines" \\
  --title "2.5 mm, before fairing" --title "2.5 mm, now"
$r skull.vtp@35,8 skull.vtp@cut=x@60,8 -o $o/skull.png --size 500x420 --title surface --title "cut open"
$r torso.vtp@20,6 torso.vtu@cut=y@20,6 -o $o/torso.png --size 430x500 --title surface --title "$cut"
$r sax.cnt@200,22 sax.vtp@200,22 sax.vtu@cut=y@200,22 -o $o/heart_sax.png --size 440x450 --title contours --title surface \\
  --title "$cut"
"""

Row = collections.namedtuple("Row", "name code error wall report drawn")


def fail(text):
    sys.exit(f"make_results.py: error: {text}")


# ---- the inputs ------------------------------------------------------------------------------------------------

def inputs_of(data):
    """{name: arguments}, sorted by name."""
    found = {}
    for path in sorted(data.rglob("*")):
        name = path.relative_to(data).as_posix()
        if name.endswith(VOLUMES + (".cnt",)) and name not in NOT_LABELS:
            found[name] = [str(path)]

    def together(name, files):
        if all(file.is_file() for file in files):
            found[name] = [f"{label}={file}" for label, file in enumerate(files, 1)]

    for case in sorted(data.glob("heart_sax_sunnybrook/*/")):
        together(f"{case.relative_to(data).as_posix()}: 1=epi_ED 2=endo_ED", [case / "epi_ED.cnt", case / "endo_ED.cnt"])
    foot = sorted(data.glob("foot_vhf/sections/*.cnt"))
    if foot:
        together(f"foot_vhf/sections: {len(foot)} bones", foot)
    thorax = data / "thorax_rtstruct_dicompyler" / "contours"
    together("thorax_rtstruct_dicompyler/contours: 1=BODY 2=Lt_Lung 3=Heart",
             [thorax / f"{part}.cnt" for part in ("BODY", "Lt_Lung", "Heart")])
    return dict(sorted(found.items()))


STITCHED = ["--no-enhance", "--interpolate", "0"]


def measure(program, data, name, arguments, folder, options=STITCHED):
    """Meshes one input and reads its report."""
    mesh, report = folder / "mesh.vtu", folder / "report.json"
    start = time.monotonic()
    run = subprocess.run([program, "mesh", *arguments, *options, "-o", mesh, "--report", report, "--quiet"],
                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
    wall = time.monotonic() - start
    read = json.loads(report.read_text().replace(f"{data}/", "")) if report.exists() else None
    drawn = None
    if options is STITCHED and any(name == row[-1] for row in PAPER):
        sections = folder / "sections.json"
        subprocess.run([program, "contours", *arguments, "-o", sections, "--quiet"], check=True, capture_output=True)
        drawn = sum(bool(section["points"]) for section in json.loads(sections.read_text())["sections"])
    for file in folder.iterdir():
        file.unlink()
    errors = run.stderr.strip().replace(f"{data}/", "").splitlines()
    return Row(name, run.returncode, errors[-1] if errors else "", wall, read, drawn)


# ---- figures of a row ------------------------------------------------------------------------------------------

def seconds(value):
    return f"{value:.1f}" if value >= 9.95 else f"{value:.2f}"


def stage(row, name, clock="wall_s"):
    return sum(s[clock] for s in row.report["stages"] if s["name"] == name)


def total(row, field):
    """The sum over all labels; none where a label has none."""
    values = [label[field] for label in row.report["labels"]]
    return None if None in values else sum(values)


def volume_error(row):
    voxels, tets = total(row, "input_volume_mm3"), total(row, "tet_volume_mm3")
    return None if not voxels or tets is None else (tets / voxels - 1) * 100


def least_dice(row):
    return min((label["dice"] for label in row.report["labels"] if label["dice"] is not None), default=None)


def unmatched(row):
    """The program's own words about components that are missing or do not match one to one."""
    return [w for w in row.report["warnings"] if "are missing" in w or "do not match the input's components" in w]


def closed(row):
    return all(label["closed"] for label in row.report["labels"])


def is_short(row):
    """Whether a row misses what every input is promised."""
    r = row.report
    return (row.code != 0 or r is None or not r["surface"] or r["volume"]["closure"] != "verified" or not closed(row)
            or r["surface"]["open_edges"] > 0 or r["surface"]["self_intersections"] > 0 or bool(unmatched(row)))


# ---- the page --------------------------------------------------------------------------------------------------

def table(heads, lines):
    """A Markdown table; the first column to the left, the others to the right."""
    return ["| " + " | ".join(heads) + " |", "|---" + "|---:" * (len(heads) - 1) + "|",
            *("| " + " | ".join(line) + " |" for line in lines), ""]


def line_of(row):
    r = row.report
    if r is None or not r["surface"]:
        return [f"`{row.name}`", f"**{row.code}**", row.error.replace("|", "/")]
    surface, volume, stitched = r["surface"], r["volume"], r["stitched"]
    inside, out = total(row, "input_components"), total(row, "components")
    parts = str(out) if inside is None else f"{inside} → {out}" + (" **no match**" if unmatched(row) else "")
    error, dice = volume_error(row), least_dice(row)
    traced, kept = r["contours"]["vertices_traced"], r["contours"]["vertices"]
    bad = lambda count: f"{count:,}" if count == 0 else f"**{count:,}**"
    return [f"`{row.name}`", str(row.code) if row.code == 0 else f"**{row.code}**", volume["closure"],
            str(r["input"]["sections"]) + ("" if r["input"]["axis"] == "z" else f" ({r['input']['axis']})"),
            str(len(r["labels"])),
            f"{kept:,}" if traced == kept else f"{traced:,} → {kept:,}", f"{surface['triangles']:,}",
            f"{stitched['added_points']:,}", bad(surface["open_edges"]), bad(surface["self_intersections"]),
            f"{surface['nonmanifold_edges']:,}", f"{volume.get('tets', 0):,}",
            "" if error is None else "0.00" if abs(error) < 0.005 else f"{error:+.2f}",
            "" if dice is None else f"{math.floor(dice * 1e4) / 1e4:.4f}", parts,
            *(seconds(stage(row, name)) for name in STAGES), seconds(row.wall), f"{r['peak_rss_mb']:,.0f}"]


HEADS = ["input", "exit", "closure", "sections", "labels", "contour vertices", "triangles", "added points", "open edges",
         "self-inter-sections", "non-manifold edges", "tets", "volume error %", "least Dice", "components", *STAGES, "wall s",
         "MB"]


def paper_lines(rows):
    by_name = {row.name: row for row in rows if row.report and row.report["surface"]}
    lines = []
    for example, sections, vertices, triangles, cpu, name in PAPER:
        row = by_name.get(name)
        ours = ["not run", "", "", "", "", ""]
        if row:
            ours = [f"`{name}` ({WHAT[name]})", str(row.drawn), f"{row.report['contours']['vertices']:,}",
                    f"{row.report['surface']['triangles']:,}", f"{stage(row, 'stitch'):.3f}",
                    f"{stage(row, 'stitch', 'cpu_s'):.3f}"]
        lines.append([example, str(sections), f"{vertices:,}", f"{triangles:,}" if triangles else "not given", cpu, *ours])
    return lines


def names(rows, figure=None):
    return ", ".join(f"`{row.name}`" + (f" ({figure(row)})" if figure else "") for row in rows)


def labels_of(row):
    """The labels whose components differ, or the first few of them."""
    numbers = [re.match(r"label (\d+)", w).group(1) for w in unmatched(row)]
    listed = ", ".join(numbers[:8]) + (f" and {len(numbers) - 8} more" if len(numbers) > 8 else "")
    missing = sum(int(m.group(1)) for w in unmatched(row) for m in [re.search(r": (\d+) of \d+ components are missing", w)] if m)
    return (f"{total(row, 'input_components')} → {total(row, 'components')}, label{'s' if len(numbers) > 1 else ''} {listed}"
            + (f"; {missing} missing" if missing else ""))


def what_is_short(rows):
    """Bullets, from the figures alone."""
    done = [row for row in rows if row.report and row.report["surface"]]
    text = []

    def say(chosen, words, figure=None):
        if chosen:
            text.append(f"- {words} ({len(chosen)}): {names(chosen, figure)}.")

    say([r for r in rows if r.code != 0], "Exit code other than 0", lambda r: f"{r.code}: {r.error}")
    say([r for r in done if r.report["volume"]["closure"] != "verified"], "Closure not verified")
    say([r for r in done if not closed(r)], "A label without a closed surface")
    say([r for r in done if r.report["surface"]["open_edges"]], "Open edges", lambda r: r.report["surface"]["open_edges"])
    say([r for r in done if r.report["surface"]["self_intersections"]], "Self-intersections",
        lambda r: r.report["surface"]["self_intersections"])
    say([r for r in done if unmatched(r)], "Components of the surface do not match those of the voxels one to one", labels_of)
    say([r for r in done if (least_dice(r) or 1) < 0.99], "Dice of a label below 0.99", lambda r: f"{least_dice(r):.4f}")
    say([r for r in done if abs(volume_error(r) or 0) > 2],
        "Volume more than 2 % from that of the voxels. The usual causes are round ends, which taper over half a slice gap, and "
        "parts that move by more than their width from one thick slice to the next; at the sections the voxels are met (see "
        "Dice)", lambda r: f"{volume_error(r):+.1f} %")
    say([r for r in done if r.report["surface"]["nonmanifold_edges"]],
        "Closed per label, yet with edges where the surface of a label meets itself",
        lambda r: f"{r.report['surface']['nonmanifold_edges']:,}")
    fallen = lambda r: [w for w in r.report["warnings"] if "mesher fell back" in w]
    say([r for r in done if fallen(r)], "TetGen refused the first try and a later one was verified",
        lambda r: fallen(r)[0].split("fell back: ", 1)[1])
    say([r for r in done if r.wall > 60], "Over a minute",
        lambda r: f"{seconds(r.wall)} s, {seconds(stage(r, 'volume'))} s of it TetGen and the checks of its tets")
    say([r for r in done if r.report["peak_rss_mb"] > 2048], "Over 2 GiB of memory", lambda r: f"{r.report['peak_rss_mb']:,.0f} MB")
    blind = [r for r in done if total(r, "input_volume_mm3") is None]
    if blind:
        text.append(f"- {len(blind)} rows are contour files: without voxels, nothing here judges their components, volumes and "
                    "Dice.")
    flat = [r for r in done if r.report["volume"].get("dihedral_min_deg", 90) < 1]
    if flat:
        text.append(f"- The smallest dihedral angle is below 1 degree in {len(flat)} of {len(done)} rows: this table is of stitched "
                    "surfaces, and their narrow triangles are kept.")
    return text or ["- Nothing of what is measured here."]


def remarks(rows):
    """What the program warned of and no other place says."""
    said = ("not built", "mesher fell back", "do not match", "are missing", "no closed surface")
    lines = []
    for row in rows:
        for warning in row.report["warnings"] if row.report else []:
            if not any(word in warning for word in said) and not warning.startswith("volume mesher: "):
                lines.append(f"- `{row.name}`: {warning[len(row.name) + 2:] if warning.startswith(row.name + ': ') else warning}")
    return lines


def first_line(path, key):
    try:
        for line in pathlib.Path(path).read_text().splitlines():
            if line.startswith(key):
                return re.split(r"[:=]", line, maxsplit=1)[1].strip().strip('"')
    except OSError:
        pass
    return ""


def machine():
    kib = re.match(r"\d+", first_line("/proc/meminfo", "MemTotal") or "0")
    return (f"{first_line('/proc/cpuinfo', 'model name') or 'unknown processor'}, {os.cpu_count()} cores, "
            f"{int(kib.group()) / 2**20:.0f} GiB, {first_line('/etc/os-release', 'PRETTY_NAME') or 'unknown system'}")


def enhanced_line(row):
    if row.report is None or not row.report.get("surface"):
        return [row.name, "", "", "", "", "", "", "", "", "", "", "", seconds(row.wall), str(row.code)]
    s, v, off, dice = row.report["surface"], row.report["volume"], volume_error(row), least_dice(row)
    tets = v.get("tets") is not None
    return [row.name, s["level"], f"{s['triangles']:,}",
            f"{s['angle_min_deg']:.1f} / {s['angle_p1_deg']:.1f} / {s['angle_median_deg']:.1f}", str(s["open_edges"]),
            str(s["self_intersections"]), f"{v['tets']:,}" if tets else "",
            f"{v['dihedral_min_deg']:.1f} / {v['dihedral_max_deg']:.1f}" if tets else "", v["closure"],
            "" if off is None else f"{off:+.2f}", "" if dice is None else f"{dice:.3f}", seconds(stage(row, "enhance")),
            seconds(row.wall), str(row.code)]


def enhanced_short(rows):
    """What the default run leaves short, from its reports."""
    done = [row for row in rows if row.report and row.report.get("surface")]
    text = []
    kept = [row for row in done if row.report["surface"]["level"] != "enhanced"]
    if kept:
        text.append("- Not enhanced by default: " + ", ".join(row.name for row in kept) + ".")
    narrow = [row for row in done if row.report["surface"]["level"] == "enhanced" and row.report["surface"]["angle_min_deg"] < 8]
    if narrow:
        text.append("- Smallest triangle angle below 8 degrees after enhancement: " +
                    ", ".join(f"{row.name} ({row.report['surface']['angle_min_deg']:.1f})" for row in narrow) + ".")
    parts = [row for row in done if unmatched(row)]
    if parts:
        text.append("- After enhancement some small components no longer hold their voxels' centres: " +
                    ", ".join(row.name for row in parts) + ".")
    return text


def paper_section(rows):
    return [
        "## Beside the paper", "",
        "The paper (2005) gives CPU seconds of the reconstruction, on a computer of its day. Ours are those of the stage `stitch`, "
        "contours to closed surface; the inputs are the nearest we have, not the same, so look at the sizes before the seconds. "
        "Sections here are those that hold a contour.", "",
        *table(["paper's example", "sections", "contour vertices", "triangles", "CPU s, then", "ours", "sections", "contour vertices",
                "triangles", "wall s", "CPU s"], paper_lines(rows)),
    ]


def page(rows, enhanced, version):
    done = [row for row in rows if row.report and row.report["surface"]]
    seen = [row for row in done if total(row, "input_volume_mm3") is not None]
    matched = sum(not unmatched(row) for row in seen)
    fine = sum(row.code == 0 and row.report is not None and row.report["volume"]["closure"] == "verified" for row in rows)
    edges = sum(row.report["surface"]["open_edges"] for row in done)
    crossings = sum(row.report["surface"]["self_intersections"] for row in done)
    noted = remarks(rows)
    lines = [
        "# Real data", "",
        "Made by `apps/make_results.py`; do not edit. Every label volume and every set of contours of the shared data goes through "
        "`stackmesh mesh INPUT --no-enhance --interpolate 0 -o OUT.vtu --report R.json` (the stitched surface), and again with "
        "default options: \"Enhanced\" below.", "",
        f"**{fine} of {len(rows)} inputs: exit 0, closure verified. {edges:,} open edges and {crossings:,} self-intersections in "
        f"all. Components match one to one in {matched} of the {len(seen)} inputs that have voxels.**", "",
        f"{version}, on {machine()}; all threads, one input at a time.", "",
        *PICTURES, "",
        "## Every input", "",
        "Sections count empty slices too and lie along z unless another axis stands beside them. Contour vertices: traced on "
        "the pixels' edges → simplified; contour files are taken as they are. Volume error: all tetrahedra against all voxels; "
        "Dice: of the worst label, at voxel centres; both need voxels. "
        "Components: 6-connected parts of the voxels → pieces of the surface, summed over labels. Stages in wall seconds; `wall s` is "
        "the whole command; MB is the largest process of the run (often TetGen's worker).", "",
        *table(HEADS, [line_of(row) for row in rows]),
        *paper_section(rows),
        "## Enhanced", "",
        "The same inputs with default options: virtual sections where slices are far apart, smoothing, remeshing to the curvature. "
        "Angles of triangles: smallest, 1 %, median; of tetrahedra: smallest and largest dihedral. Volume and Dice as above; Dice "
        "falls with the size of the edges, which the default chooses for a deviation of half a pixel.", "",
        *table(["input", "level", "triangles", "angles, deg", "open", "cross", "tets", "dihedrals, deg", "closure", "volume error %",
                "worst Dice", "enhance s", "wall s", "exit"], [enhanced_line(row) for row in enhanced]),
        "## What is short", "", *what_is_short(rows), *enhanced_short(enhanced), "",
    ]
    if noted:
        lines += ["## What the program remarked", "", *noted, ""]
    lines += ["## How the pictures were drawn", "", "```", *DRAWN.strip().splitlines(), "```", ""]
    return "\n".join(lines)


def rewrite_paper(args, inputs):
    with tempfile.TemporaryDirectory() as folder:
        rows = [measure(args.program, args.data, row[-1], inputs[row[-1]], pathlib.Path(folder)) for row in PAPER if row[-1] in inputs]
    output = args.output or ROOT / "docs" / "results.md"
    text = output.read_text()
    head, rest = text.split("## Beside the paper", 1)
    output.write_text(head + "\n".join(paper_section(rows)) + "\n##" + rest.split("\n##", 1)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build" / "stackmesh")
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="OUT.md",
                        help="default docs/results.md, or the terminal with --only")
    parser.add_argument("--paper", action="store_true", help="the paper's examples alone")
    parser.add_argument("--only", metavar="PATTERN", help="a regular expression on the inputs' names")
    args = parser.parse_args()
    if not args.program.is_file():
        fail(f"no program at {args.program}; build it (bash apps/quickstart.sh) or name it with --program")
    if not args.data.is_dir():
        fail(f"no data at {args.data}; name the folder with --data")
    args.program, args.data = args.program.resolve(), args.data.resolve()
    inputs = {name: given for name, given in inputs_of(args.data).items() if re.search(args.only or "", name)}
    if not inputs:
        fail(f"no input matches '{args.only}'" if args.only else f"no inputs below {args.data}")
    if args.paper:
        rewrite_paper(args, inputs)
        return
    version = subprocess.run([args.program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    rows, enhanced = [], []
    with tempfile.TemporaryDirectory() as folder:
        for name in sorted(inputs, key=lambda n: (n in LAST, n)):
            row = measure(args.program, args.data, name, inputs[name], pathlib.Path(folder))
            rows.append(row)
            enhanced.append(measure(args.program, args.data, name, inputs[name], pathlib.Path(folder), []))
            print(f"{len(rows):3d}/{len(inputs)} {seconds(row.wall):>6} s  exit {row.code}"
                  f"{'  SHORT' if is_short(row) else ''}  {name}", file=sys.stderr, flush=True)
    rows.sort(key=lambda row: row.name)
    enhanced.sort(key=lambda row: row.name)
    text = page(rows, enhanced, version)
    if args.output or not args.only:
        (args.output or ROOT / "docs" / "results.md").write_text(text)
    else:
        print(text)
    sys.exit(1 if any(is_short(row) for row in rows) else 0)


main()
