#!/usr/bin/python3
"""Measures the fidelity of surfaces to TRUE shapes, not to their voxels, and writes docs/fidelity.md.

  make_fidelity.py --cache FOLDER                                  all shapes and modes; some minutes
  make_fidelity.py --cache FOLDER --only sphere,bone --modes iso1  those cells, to the terminal
  make_fidelity.py --cache FOLDER --columns old/stackmesh          an older build beside the one at hand
  make_fidelity.py --cache FOLDER --scanned --thick                scanned bones (closed STL) as truths, and thick slices, too

Each cell: a known shape is voxelised, `stackmesh surface` runs on the voxels with an edge length of one and a half
voxels and again with no option, and the surface is judged against the shape: mean distance, mean angle between the
normals, share of its area that is more than 20 degrees off, volume. Beside it stand what users pick instead: flying
edges with windowed sinc (0.15 and 0.5) in VTK and, with --mesh3 PROGRAM, CGAL's Mesh_3.

Labels, figures of the peers and figures of each program (told apart by its bytes) stay in the cache, so that a second
run only judges what is new. The shapes and the judge are truth.py of the folder --tools, which is not part of this
project. Needs Debian's python3-vtk9 python3-nibabel python3-scipy. The exit code is 1 when a cell has no result.
"""
import argparse
import contextlib
import hashlib
import importlib.util
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHAPES = ("sphere", "torus", "capsule", "bone", "shell", "vessel", "halves", "tilted")
PLANES = ("halves", "tilted")         # two labels that share an oblique plane: written as .vtp, which carries the labels
MANY = ("shell", *PLANES)
SCANNED = ("sacrum_vhf/VHF_Left_Sacrum.stl", "foot_vhf/VHF_Left_*.stl")
# Organs of which every so many slices are kept: (name, file, label or -1 for all, every).
THICK = (("heart", "heart_totalseg/heart.nii.gz", -1, 5), ("liver", "liver_cgal/liver.nii.gz", -1, 6),
         ("lungs", "lung_lr_cip/lungs_left_right.nrrd", -1, 17), ("vertebra", "vertebrae_itksnap/vb-seg.mha", 3, 5))
SINC = ("0.15", "0.5")
MESH3 = "Mesh_3"

# mode: (edge length in mm, smallest spacing in mm, how the labels came about, options of the run with an edge length)
MODES = {
    "iso1": (1.5, 1.0, "voxels of 1 mm", ()),
    "iso2": (3.0, 2.0, "voxels of 2 mm", ()),
    "up2,2": (2.0, 1.0, "voxels of 2 mm, stored as 1 mm (2 x 2 x 2 blocks, as segmentation networks leave them)", ()),
    "aniso0.8,3": (1.2, 0.8, "pixels of 0.8 mm, slices 3 mm apart", ()),
    "jitter1,1": (1.5, 1.0, "voxels of 1 mm, each slice moved by up to 1 mm, as labels drawn slice by slice are", ("--band", "1.5")),
}
SCANNED_MODES = {
    "iso1": MODES["iso1"], "iso2": MODES["iso2"], "aniso1,4": (1.5, 1.0, "pixels of 1 mm, slices 4 mm apart", ()),
}

# Limits with an edge length. (shape, mode): (mean distance mm, mean angle deg).
ROUND = ("sphere", "torus", "capsule", "bone", "shell")
LIMITS = {
    **{(s, "iso1"): (0.055, 3.2) for s in ROUND}, **{(s, "iso2"): (0.13, 5.8) for s in ROUND},
    **{(s, "up2,2"): (0.13, 5.8) for s in ROUND}, **{(s, "aniso0.8,3"): (0.125, 4.0) for s in ROUND},
    ("vessel", "iso1"): (0.065, 7.0), ("vessel", "iso2"): (0.25, 14.0), ("vessel", "up2,2"): (0.25, 14.0),
    ("vessel", "aniso0.8,3"): (0.13, 8.0), ("bone", "jitter1,1"): (0.18, 5.0),
}
ABOVE20 = 0.005                       # of the area of round shapes, wherever distance and angle have limits, but not for jitter
VOLUME = 0.03                         # of the vessel, but for jitter
PLANE_DEG, PLANE_AREA = 2.0, 0.01     # of the shared plane, but for jitter
# Limits with no option, but for jitter: distance no worse than windowed sinc 0.5, and
NO_OPTION_DEG, NO_OPTION_TRIANGLES = 5.5, 0.25


def fail(text):
    sys.exit(f"make_fidelity.py: error: {text}")


def note(text):
    print(text, file=sys.stderr, flush=True)


# ---- truth, labels, figures ------------------------------------------------------------------------------------

class Bench:
    """Makes labels and figures, and keeps them in the cache."""

    def __init__(self, args):
        self.args, self.cache = args, args.cache
        script = args.tools / "truth.py"
        if not script.is_file():
            fail(f"no truth.py in {args.tools}, the folder of the judge; name it with --tools")
        try:
            spec = importlib.util.spec_from_file_location("truth", script)
            self.truth = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(self.truth)
            import vtk  # noqa: F401
            import nibabel  # noqa: F401
        except ImportError as e:
            fail(f"{e}, at loading {script}; install python3-vtk9 python3-nibabel python3-scipy")
        self.stamp = hashlib.sha256(script.read_bytes()).hexdigest()[:8]
        (self.cache / f"labels-{self.stamp}").mkdir(parents=True, exist_ok=True)
        (self.cache / f"figures-{self.stamp}").mkdir(parents=True, exist_ok=True)
        self.programs, self.failed = {}, []

    def run_truth(self, do, **given):
        """A command of truth.py, as if it were started anew: its random numbers begin again."""
        self.truth.rng = self.truth.np.random.default_rng(7)
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            do(argparse.Namespace(**given))
        return json.loads(said.getvalue())

    def labels(self, shape, mode):
        path = self.cache / f"labels-{self.stamp}" / f"{slug(shape)}_{mode}.nii.gz"
        if not path.is_file():
            part = path.with_name("part_" + path.name)
            self.run_truth(self.truth.make, shape=shape, mode=mode, out=str(part))
            part.replace(path)
        return path

    def kept(self, name, make):
        """Figures of the cache, or made and put there; a failure is not kept."""
        path = self.cache / f"figures-{self.stamp}" / f"{name}.json"
        if path.is_file():
            return json.loads(path.read_text())
        start = time.monotonic()
        figures = make()
        note(f"{time.monotonic() - start:6.1f} s  {name}: " + (figures.get("error") or brief(figures)))
        if "error" in figures:
            self.failed.append(f"{name}: {figures['error']}")
        else:
            part = path.with_name("part_" + path.name)
            part.write_text(json.dumps(figures))
            part.replace(path)
        return figures

    def judge(self, shape, mesh):
        figures = self.run_truth(self.truth.judge, shape=shape, mesh=str(mesh), label=None)
        if shape == "bone":
            figures["volume_error"] = self.volume(mesh) / self.bone_volume() - 1
        elif shape not in SHAPES:
            figures["volume_error"] = self.volume(mesh) / self.volume(shape) - 1
        return figures

    def volume(self, mesh):
        np = self.truth.np
        points, triangles = self.truth.load(str(mesh))
        a, b, c = (points[triangles[:, k]] for k in range(3))
        return abs((a * np.cross(b, c)).sum() / 6)

    def bone_volume(self):
        """Of the true bone, which has no formula: by counting points 0.5 mm apart."""
        def count():
            np, bone, h = self.truth.np, self.truth.shape("bone"), 0.5
            line = np.arange(-60, 60, h) + h / 2
            flat = np.stack(np.meshgrid(line, line, indexing="ij"), -1).reshape(-1, 2)
            inside = sum(int((bone.f(np.column_stack([flat, np.full(len(flat), z)])) < 0).sum()) for z in line)
            return {"volume_mm3": inside * h ** 3}
        return self.kept("bone_volume", count)["volume_mm3"]

    # -- ours

    def identity(self, program):
        """(first bytes of its hash, whether it has --band)."""
        if program not in self.programs:
            text = subprocess.run([program, "surface", "--help"], capture_output=True, text=True, errors="replace").stdout
            self.programs[program] = (hashlib.sha256(program.read_bytes()).hexdigest()[:12], "--band" in text)
        return self.programs[program]

    def ours(self, program, shape, mode, options, name):
        sha, band = self.identity(program)
        if "--band" in options and not band:
            options = [o for k, o in enumerate(options) if o != "--band" and (k == 0 or options[k - 1] != "--band")]

        def make():
            with tempfile.TemporaryDirectory() as folder:
                mesh = pathlib.Path(folder) / ("mesh.vtp" if shape in MANY else "mesh.ply")
                run = subprocess.run([program, "surface", self.labels(shape, mode), *options, "--space", "ras", "-o", mesh, "--quiet"],
                                     stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
                if run.returncode != 0 or not mesh.is_file():
                    return {"error": f"exit {run.returncode}: {(run.stderr.strip().splitlines() or [''])[-1]}"}
                return self.judge(shape, mesh)
        given = hashlib.sha256(" ".join(options).encode()).hexdigest()[:6]
        return self.kept(f"{slug(shape)}_{mode}_{name}_{sha}_{given}", make)

    # -- peers

    def sinc(self, shape, mode, factor):
        """Each label's own closed surface, as viewers make it; together, where there are several labels."""
        def make():
            import nibabel
            import vtk
            source = (self.args.tools / "run_peers.py").read_text().rsplit("main()", 1)[0]
            peers = {}
            exec(compile(source, "run_peers.py", "exec"), peers)
            np, image = self.truth.np, nibabel.load(self.labels(shape, mode))
            values = np.asarray(image.dataobj).astype(np.int32)
            zooms = np.linalg.norm(image.affine[:3, :3], axis=0)
            together = vtk.vtkAppendPolyData()
            for label in np.unique(values[values > 0]):
                together.AddInputData(peers["to_world"](peers["vtk_surface"](values == label, zooms, float(factor)), image.affine, zooms))
            together.Update()
            with tempfile.TemporaryDirectory() as folder:
                mesh = pathlib.Path(folder) / "mesh.ply"
                peers["write"](together.GetOutput(), str(mesh))
                return self.judge(shape, mesh)
        return self.kept(f"{slug(shape)}_{mode}_sinc{factor}", make)

    def mesh3(self, shape, mode, edge, spacing):
        name = f"{slug(shape)}_{mode}_mesh3_{edge:g}"
        if self.args.mesh3 is None:
            path = self.cache / f"figures-{self.stamp}" / f"{name}.json"
            return json.loads(path.read_text()) if path.is_file() else None

        def make():
            import nibabel
            np, labels = self.truth.np, self.labels(shape, mode)
            with tempfile.TemporaryDirectory() as folder:
                folder = pathlib.Path(folder)
                inr, out, mesh = folder / "labels.inr", folder / "out.mesh", folder / "mesh.obj"
                subprocess.run([sys.executable, self.args.tools / "labels_to_inr.py", labels, inr, "all"], check=True, capture_output=True)
                run = subprocess.run([self.args.mesh3, inr, out, f"{edge:g}", f"{spacing / 2:g}"], capture_output=True, text=True)
                if run.returncode != 0 or not out.is_file():
                    return {"error": f"exit {run.returncode}"}
                points, triangles = read_medit(np, out)
                affine = nibabel.load(labels).affine
                zooms = np.linalg.norm(affine[:3, :3], axis=0)
                points = (points / zooms - 1) @ affine[:3, :3].T + affine[:3, 3]  # padded by a voxel
                with open(mesh, "w") as file:
                    np.savetxt(file, points, "v %.9g %.9g %.9g")
                    np.savetxt(file, triangles + 1, "f %d %d %d")
                figures = self.judge(shape, mesh)
                figures.pop("volume_error", None)  # its facets are not turned alike
                return figures
        return self.kept(name, make)


class Thick:
    """An organ of which every so many slices are kept, rebuilt and judged against all of them (thick_slices.py of the tools)."""

    def __init__(self, bench, name, file, label, every):
        self.name, self.every, self.bench = name, every, bench
        self.script = bench.args.tools / "thick_slices.py"
        self.all_slices = bench.args.data / file
        self.common = [str(self.all_slices), "--label", str(label), "--every", str(every)]
        self.stack = bench.cache / f"labels-{bench.stamp}" / f"thick_{name}_{every}.nii.gz"
        if not self.stack.is_file():
            part = self.stack.with_name("part_" + self.stack.name)
            self.run("--write-thick", str(part))
            part.replace(self.stack)
        self.peers = {p: bench.kept(f"thick_{name}_{every}_{p}", lambda p=p: self.results("--peers", p)) for p in ("vtk", "sdf", "sdfcubic")}
        self.ours = [self.rebuild(p) for p in bench.args.programs]
        self.of_all = self.rebuild(bench.args.programs[0], self.all_slices, *(("--label", str(label)) if label >= 0 else ()))

    def run(self, *more):
        run = subprocess.run([sys.executable, self.script, *self.common, *more], capture_output=True, text=True)
        if run.returncode != 0:
            fail(f"{(run.stderr.strip().splitlines() or ['no word'])[-1]}, at {self.script} for {self.name}; check --tools and --data")
        return json.loads(run.stdout)

    def results(self, *more):
        return next(iter(self.run(*more)["results"].values()))

    def rebuild(self, program, stack=None, *options):
        """What a program makes of the thick stack, or of another one of the same organ."""
        def make():
            with tempfile.TemporaryDirectory() as folder:
                mesh = pathlib.Path(folder) / "mesh.ply"
                run = subprocess.run([program, "surface", stack or self.stack, *options, "-o", mesh, "--quiet"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                     text=True, errors="replace")
                if run.returncode != 0 or not mesh.is_file():
                    return {"error": f"exit {run.returncode}: {(run.stderr.strip().splitlines() or [''])[-1]}"}
                return self.results("--peers", "none", "--mesh", str(mesh))
        every = self.every if stack is None else "all"
        return self.bench.kept(f"thick_{self.name}_{every}_{self.bench.identity(program)[0]}", make)

    def bar(self):
        """The better of linear and cubic shape interpolation: (Dice, mean mm)."""
        both = (self.peers["sdf"], self.peers["sdfcubic"])
        return max(p["dice"] for p in both), min(p["mean"] for p in both)

    def line(self):
        def pair(f, bar=None):
            if "error" in f:
                return f"**{f['error'].split(':')[0]}**"
            return (f"{bold(format(f['dice'], '.4f'), bar is not None and f['dice'] < bar[0])} / "
                    f"{bold(format(f['mean'], '.3f'), bar is not None and f['mean'] > bar[1])}")
        ours = self.ours[0]
        return [self.name, str(self.every), pair(ours, self.bar()), *((f"{ours['p95']:.2f}", f"{ours['max']:.1f}", f"{ours['vol_err'] * 100:+.2f}",
                f"{ours['triangles']:,}") if "error" not in ours else ("", "", "", "")), *(pair(f) for f in self.ours[1:]),
                *(pair(self.peers[p]) for p in ("sdf", "sdfcubic", "vtk")), pair(self.of_all)]


def read_medit(np, path):
    """Points, and the triangles of a .mesh file, each once."""
    words = path.read_text().split()
    n = words.index("Vertices")
    count = int(words[n + 1])
    points = np.array(words[n + 2:n + 2 + 4 * count], float).reshape(-1, 4)[:, :3]
    n = words.index("Triangles")
    count = int(words[n + 1])
    triangles = np.array(words[n + 2:n + 2 + 4 * count], int).reshape(-1, 4)[:, :3] - 1
    _, first = np.unique(np.sort(triangles, 1), axis=0, return_index=True)
    return points, triangles[np.sort(first)]


def slug(shape):
    return pathlib.Path(shape).stem


# ---- cells -----------------------------------------------------------------------------------------------------

def brief(f):
    if "dice" in f:
        return f"{f['dice']:.4f} / {f['mean']:.3f}"
    return f"{f['mean_mm']:.3f} / {f['normal_mean_deg']:.1f}" if "mean_mm" in f else ", ".join(f"{k} {v:g}" for k, v in f.items())


def bold(text, missed):
    return f"**{text}**" if missed else text


class Cell:
    """Figures of one shape in one mode; what misses its limit is known by name."""

    def __init__(self, bench, shape, mode, modes):
        self.shape, self.mode, self.name = shape, mode, slug(shape).replace("VHF_Left_", "")
        self.edge, spacing, _, more = modes[mode]
        options = ["--edge-length", f"{self.edge:g}", *more]
        self.edged = [bench.ours(p, shape, mode, options, "edge") for p in bench.args.programs]
        self.bare = [bench.ours(p, shape, mode, [], "bare") for p in bench.args.programs]
        self.sinc = [bench.sinc(shape, mode, s) for s in SINC]
        self.mesh3 = bench.mesh3(shape, mode, self.edge, spacing)

    def peers(self):
        return [p for p in (*self.sinc, self.mesh3) if p and "error" not in p]

    def best(self):
        """Whether both figures with an edge length are better than the best of all peers."""
        ours = self.edged[0]
        return "error" not in ours and all(ours[k] < min(p[k] for p in self.peers()) for k in ("mean_mm", "normal_mean_deg"))

    def misses(self):
        """(set of figures with an edge length, set of figures with no option) that miss their limit."""
        ours, bare, edged, none = self.edged[0], self.bare[0], set(), set()
        limit, jitter = LIMITS.get((self.shape, self.mode)), self.mode.startswith("jitter")
        if "error" in ours or "error" in bare:
            return ({"no result"} if "error" in ours else set()), ({"no result"} if "error" in bare else set())
        if limit:
            edged |= {"distance"} if ours["mean_mm"] > limit[0] else set()
            edged |= {"normals"} if ours["normal_mean_deg"] > limit[1] else set()
            edged |= {"above 20"} if self.shape in ROUND and not jitter and ours["normal_above20"] > ABOVE20 else set()
        if self.shape == "vessel" and not jitter and abs(ours["volume_error"]) > VOLUME:
            edged.add("volume")
        if self.shape in PLANES and not jitter:
            edged |= {"plane"} if ours["plane_normal_deg"] > PLANE_DEG else set()
            edged |= {"plane's area"} if abs(ours["plane_area_rel"] - 1) > PLANE_AREA else set()
        if not jitter:
            known = self.shape in SHAPES
            none |= {"distance"} if bare["mean_mm"] > self.sinc[-1]["mean_mm"] else set()
            none |= {"normals"} if known and bare["normal_mean_deg"] > NO_OPTION_DEG else set()
            none |= {"triangles"} if bare["triangles"] > NO_OPTION_TRIANGLES * self.sinc[-1]["triangles"] else set()
        return edged, none


def pair(f, missed=()):
    if f is None or "error" in f:
        return "" if f is None else "none"
    return f"{bold(format(f['mean_mm'], '.3f'), 'distance' in missed)} / {bold(format(f['normal_mean_deg'], '.1f'), 'normals' in missed)}"


def percent(f):
    """The error of the volume, where it is known."""
    return f"{f['volume_error'] * 100:+.2f}" if "volume_error" in f else ""


def rest(f, missed):
    if "error" in f:
        return [f"**{f['error'].split(':')[0]}**", "", ""]
    return [bold(f"{f['normal_above20'] * 100:.2f}", "above 20" in missed), bold(percent(f), "volume" in missed),
            bold(f"{f['triangles']:,.0f}", "triangles" in missed)]


def edged_line(cell):
    missed, _ = cell.misses()
    limit = LIMITS.get((cell.shape, cell.mode))
    return [cell.name, f"{limit[0]:g} / {limit[1]:g}" if limit else "", pair(cell.edged[0], missed) + (" ✓" if cell.best() else ""),
            *rest(cell.edged[0], missed), *(pair(f) for f in cell.edged[1:]), *(pair(f) for f in cell.sinc), pair(cell.mesh3)]


def bare_line(cell):
    _, missed = cell.misses()
    ours, sinc = cell.bare[0], cell.sinc[-1]
    share = "" if "error" in ours else f"{ours['triangles'] / sinc['triangles']:.2f}"
    return [cell.name, pair(ours, missed), *rest(ours, missed), share, *(pair(f) for f in cell.bare[1:]), pair(sinc), percent(sinc), f"{sinc['triangles']:,.0f}"]


def plane_line(cell):
    missed, _ = cell.misses()

    def figures(f, missed=()):
        if "error" in f:
            return ["none", "", ""]
        return [bold(f"{f['plane_normal_deg']:.2f}", "plane" in missed), bold(f"{(f['plane_area_rel'] - 1) * 100:+.2f}", "plane's area" in missed),
                f"{f['plane_mean_mm']:.3f}"]
    return [cell.name, cell.mode, *figures(cell.edged[0], missed), *figures(cell.bare[0]), *(x for f in cell.edged[1:] for x in figures(f))]


def table(heads, lines):
    """A Markdown table; the first column to the left, the others to the right."""
    return ["| " + " | ".join(heads) + " |", "|---" + "|---:" * (len(heads) - 1) + "|",
            *("| " + " | ".join(line) + " |" for line in lines), ""]


def mode_tables(mode, modes, cells, names, band):
    edge, _, what, more = modes[mode]
    options = " ".join(["--edge-length", f"{edge:g}", *more])
    lines = [f"### {mode}: {what}", "", f"`{options}`" + (" (a program without `--band` runs without it)" if more and not band else "") + ":", "",
             *table(["shape", "limits", "**ours**, mm / deg", "above 20°, %", "volume, %", "triangles", *(f"{n}, mm / deg" for n in names),
                     *(f"sinc {s}" for s in SINC), MESH3], [edged_line(c) for c in cells]),
             "No option:", "",
             *table(["shape", "**ours**, mm / deg", "above 20°, %", "volume, %", "triangles", "of sinc's", *(f"{n}, mm / deg" for n in names),
                     f"sinc {SINC[-1]}", "its volume, %", "its triangles"], [bare_line(c) for c in cells])]
    return lines


def missed_lines(cells):
    lines = []
    for which, words in ((0, "with an edge length"), (1, "with no option")):
        missed = [(c, sorted(c.misses()[which])) for c in cells if c.misses()[which]]
        lines.append(f"- {words}: " + (f"{len(missed)} of {len(cells)} cells miss a limit: " if missed else f"none of {len(cells)} cells misses a limit")
                     + "; ".join(f"{c.name} {c.mode} ({', '.join(m)})" for c, m in missed) + ".")
    better = [c for c in cells if c.best()]
    lines.append(f"- better than the best of all peers in distance and normals at once (✓): {len(better)} of {len(cells)} cells.")
    return lines


def page(shapes, scanned, thick, args, version, band):
    """The Markdown text; `band`: whether all programs know --band."""
    names = [str(n) for n in args.names]
    lines = [
        "# Fidelity to the true shape", "",
        "Made by `apps/make_fidelity.py`; do not edit. Known shapes are voxelised, the voxels are meshed, and the surface is judged "
        "against the *shape*, by area: mean distance in mm / mean angle between the normals in degrees, the share of area whose normal "
        "is more than 20 degrees off, the error of the volume. Beside it stand what users pick instead: VTK's flying edges with windowed "
        f"sinc of 0.15 and 0.5 (the \"closed surface\" of the viewers; each label's own surface), and CGAL's {MESH3} with the same edge "
        "length. **Bold** misses a limit; ✓ is better than the best of all peers in distance and normals at once.", "",
        "Shapes: sphere of radius 20 mm; torus 20 and 7; capsule of radius 9; `bone`, a shaft with four blended heads; `shell`, two nested "
        "spheres 3 mm apart, as two labels; `vessel`, a capsule of radius 3; `halves` and `tilted`, a ball cut into two labels by an oblique "
        "plane, whose trace in the slices runs along x in `tilted`. All are turned by a fixed oblique rotation and lie off the grid.", "",
        f"{version}.", ""]
    if shapes:
        lines += ["## Limits", "", *missed_lines(shapes), "",
                  f"Limits stand in the script. With an edge length: distance and normals as in the tables, at most {ABOVE20 * 100:g} % of the area "
                  f"of the round shapes above 20 degrees, the vessel's volume within {VOLUME * 100:g} %. With no option: no further from the truth "
                  f"than windowed sinc 0.5, normals below {NO_OPTION_DEG:g} degrees, at most {NO_OPTION_TRIANGLES:g} of its triangles. Labels that "
                  "jitter have limits for the bone alone.", "", "## Known shapes", ""]
        for mode in MODES:
            cells = [c for c in shapes if c.mode == mode]
            if cells:
                lines += mode_tables(mode, MODES, cells, names, band)
        planes = [c for c in shapes if c.shape in PLANES and "error" not in c.edged[0] and "error" not in c.bare[0]]
        if planes:
            lines += ["### The plane between two labels", "",
                      f"Angle and area of the shared plane, away from its rim: at most {PLANE_DEG:g} degrees and {PLANE_AREA * 100:g} % off.", "",
                      *table(["shape", "mode", "**ours** with an edge length, deg", "area, %", "mm", "no option, deg", "area, %", "mm",
                              *(h for n in names for h in (f"{n}, deg", "area, %", "mm"))], [plane_line(c) for c in planes])]
    if scanned:
        lines += ["## Scanned bones", "",
                  "Closed surfaces of the Visible Human Female (CC BY 4.0) are the truth here; they carry their own roughness, so normals have no "
                  "limit of their own.", "", *missed_lines(scanned), ""]
        for mode in SCANNED_MODES:
            cells = [c for c in scanned if c.mode == mode]
            if cells:
                lines += mode_tables(mode, SCANNED_MODES, cells, names, band)
    if thick:
        lines += ["## Thick slices", "",
                  "Every so many slices of an organ are kept, its surface is made of them with no option, and judged against all slices between the first "
                  "and the last one kept: Dice of the voxel centres / mean distance in mm of the voxel faces to the surface. Beside it: shape "
                  "interpolation (signed distances in each slice) linear and cubic, and windowed sinc of the thick stack. **Bold** is short of the better "
                  "of linear and cubic. The last column is our surface of *all* slices, judged alike: what a smooth surface can reach at all where the voxel "
                  "faces are coarse steps themselves (the heart's labels are 3 mm blocks).", "",
                  *table(["organ", "every", "**ours**, Dice / mm", "95 %, mm", "largest, mm", "volume, %", "triangles", *(f"{n}, Dice / mm" for n in names),
                          "linear", "cubic", "sinc 0.5", "ours, of all slices"], [t.line() for t in thick])]
    return "\n".join(lines)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cache", type=pathlib.Path, required=True, metavar="FOLDER", help="keeps labels and figures")
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build" / "stackmesh")
    parser.add_argument("--columns", type=pathlib.Path, nargs="+", default=[], metavar="PROGRAM", help="further programs, a column each; NAME=PROGRAM names it")
    parser.add_argument("--tools", type=pathlib.Path, default=ROOT.parent / "shared" / "tools", help="folder of truth.py and run_peers.py")
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data", help="folder of the scanned bones")
    parser.add_argument("--mesh3", type=pathlib.Path, metavar="PROGRAM", help="mesh3_peer, built; without it only cached figures of it are shown")
    parser.add_argument("--only", metavar="SHAPES", help="for example sphere,bone; parts of file names for scanned bones")
    parser.add_argument("--modes", nargs="+", metavar="MODE", help="for example iso1 up2,2")
    parser.add_argument("--scanned", action="store_true", help="scanned bones, too; with --only or --modes only they, where nothing else fits")
    parser.add_argument("--thick", action="store_true", help="thick slices, too; --only chooses heart, liver, lungs, vertebra")
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="OUT.md", help="default docs/fidelity.md, or the terminal with --only or --modes")
    args = parser.parse_args()
    given = [str(c).split("=", 1) if "=" in str(c) else [pathlib.Path(c).name, str(c)] for c in args.columns]
    args.names = [name for name, _ in given]
    args.programs = [args.program.resolve(), *(pathlib.Path(path).resolve() for _, path in given)]
    for program in args.programs:
        if not os.access(program, os.X_OK) or not program.is_file():
            fail(f"no program at {program}; build it (bash apps/quickstart.sh) or name it with --program")
    args.tools, args.cache = args.tools.resolve(), args.cache.resolve()
    if args.mesh3 is not None:
        args.mesh3 = args.mesh3.resolve()
        if not args.mesh3.is_file():
            fail(f"no program at {args.mesh3}; build it as {args.tools}/mesh3_peer.cpp says, or leave --mesh3 away")
    return args


def main():
    args = arguments()
    modes = args.modes or [*MODES, *SCANNED_MODES]
    for mode in modes:
        if mode not in MODES and mode not in SCANNED_MODES:
            fail(f"unknown mode '{mode}', at --modes; known are {' '.join({**MODES, **SCANNED_MODES})}")
    only = args.only.split(",") if args.only else None
    shapes = [s for s in SHAPES if only is None or s in only]
    scans = sorted(str(p) for pattern in SCANNED for p in args.data.glob(pattern)) if args.scanned else []
    scans = [s for s in scans if only is None or any(o.lower() in slug(s).lower() for o in only)]
    if args.scanned and not scans and only is None:
        fail(f"no scanned bones below {args.data}; name the folder with --data")
    organs = [t for t in THICK if args.thick and (only is None or t[0] in only)]
    for _, file, _, _ in organs:
        if not (args.data / file).is_file():
            fail(f"no {file} below {args.data}; name the folder with --data")
    if not shapes and not scans and not organs:
        fail(f"no shape matches '{args.only}', at --only; known are {' '.join(SHAPES)}")
    bench = Bench(args)
    known = [Cell(bench, s, m, MODES) for m in MODES if m in modes for s in shapes]
    found = [Cell(bench, s, m, SCANNED_MODES) for m in SCANNED_MODES if m in modes for s in scans]
    thick = [Thick(bench, *t) for t in organs]
    version = subprocess.run([args.programs[0], "--version"], capture_output=True, text=True, check=True).stdout.strip()
    text = page(known, found, thick, args, version, all(bench.identity(p)[1] for p in args.programs))
    if args.output or not (args.only or args.modes):
        (args.output or ROOT / "docs" / "fidelity.md").write_text(text.rstrip("\n") + "\n")
    else:
        print(text)
    for line in bench.failed:
        note(f"make_fidelity.py: no result: {line}")
    sys.exit(1 if bench.failed else 0)


if __name__ == "__main__":
    main()
