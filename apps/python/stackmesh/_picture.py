"""A mesh as a notebook shows it: a picture drawn by numpy alone, its labels and verdicts as tables."""

import base64
import html
import struct
import zlib

import numpy as np

#: Okabe and Ito's colours, which colour-blind people tell apart.
_COLOURS = [(230, 159, 0), (86, 180, 233), (0, 158, 115), (240, 228, 66), (0, 114, 178), (213, 94, 0), (204, 121, 167)]


def _png(pixels):
    """The bytes of a PNG file of pixels of shape (height, width, 3), uint8."""
    height, width, _ = pixels.shape
    rows = np.zeros((height, 1 + 3 * width), np.uint8)
    rows[:, 1:] = pixels.reshape(height, -1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b"")


def _view(direction):
    """Rows: right, up, towards the eye."""
    eye = np.asarray(direction, float) / np.linalg.norm(direction)
    up = np.array([0.0, 0.0, 1.0]) if abs(eye[2]) < 0.99 else np.array([0.0, 1.0, 0.0])
    right = np.cross(up, eye)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(eye, right), eye])


def colour_of(mesh, label):
    """Red, green and blue, 0 to 255: the input's, or one of seven."""
    return mesh.colours.get(label, _COLOURS[sorted(mesh.names).index(label) % len(_COLOURS)] if label in mesh.names else (190, 190, 190))


def _samples(corners, size):
    """Points all over projected triangles (n, 3, 3), closer than a pixel: which triangle each is of, and where it is."""
    edges = np.linalg.norm(corners[:, :, :2] - np.roll(corners, 1, axis=1)[:, :, :2], axis=2).max(axis=1)
    steps = np.clip(np.ceil(1.5 * edges), 1, 2 * size).astype(int)
    for n in np.unique(steps):
        which = np.flatnonzero(steps == n)
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
        inside = i + j <= n
        a, b = i[inside] / n, j[inside] / n
        weights = np.stack([1 - a - b, a, b])
        for part in np.array_split(which, max(1, len(which) * weights.shape[1] // 2000000)):
            yield part, np.einsum("kw,tkd->twd", weights, corners[part])


def png_of(surface, width, direction):
    """The surface as the bytes of a PNG file: nearest triangles, shaded by how they face the eye."""
    points, triangles, labels = surface.points, surface.triangles, surface.triangle_labels
    seen = (labels == 0).any(axis=1)  # what bounds the background hides all else
    triangles, labels = triangles[seen], labels[seen].max(axis=1)
    view = _view(direction)
    projected = points @ view.T
    low, high = projected[triangles].min(axis=(0, 1)), projected[triangles].max(axis=(0, 1))
    scale = (width - 20) / max((high - low)[:2].max(), 1e-12)
    projected = (projected - (low + high) / 2) * scale * [1, -1, 1] + [width / 2, width / 2, 0]
    corners = projected[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = np.abs(normals[:, 2]) / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    numbers, of_number = np.unique(labels, return_inverse=True)
    shade = np.array([colour_of(surface, int(n)) for n in numbers])[of_number] * (0.3 + 0.7 * facing)[:, None]
    depth = np.full(width * width, -np.inf)
    pixels = np.full((width * width, 3), 255, np.uint8)
    for which, where in _samples(corners, width):
        x, y = (np.clip(where[..., d].astype(int), 0, width - 1) for d in (0, 1))
        at, z = (y * width + x).ravel(), where[..., 2].ravel()
        owner = np.repeat(which, where.shape[1])
        nearest = np.lexsort((z, at))  # of each pixel the nearest comes last
        last = np.flatnonzero(np.append(np.diff(at[nearest]) != 0, True))
        at, z, owner = at[nearest][last], z[nearest][last], owner[nearest][last]
        before = z > depth[at]
        depth[at[before]], pixels[at[before]] = z[before], shade[owner[before]].astype(np.uint8)
    return _png(pixels.reshape(width, width, 3))


def _table(head, rows):
    cells = "".join(f"<th>{html.escape(str(h))}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td>{html.escape('' if c is None else str(c))}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><tr>{cells}</tr>{body}</table>"


def _number(value, form="{:.4g}"):
    return None if value is None else form.format(value)


def html_of(mesh):
    """Picture, labels and verdicts for a notebook."""
    picture = base64.b64encode(png_of(mesh.surface, 360, (0.5, -0.75, 0.4))).decode()
    rows = [(r["label"], r["name"], "yes" if r["closed"] else "no", r["components"], _number(r["surface_volume_mm3"]), r.get("tets"), _number(r.get("dice"), "{:.4f}"))
            for r in mesh.report.get("labels", [])]
    text = _table(("label", "name", "closed", "pieces", "mm3", "tetrahedra", "Dice"), rows)
    verdicts = mesh.report.get("verdicts") or []
    if verdicts:
        text += _table(("verdict", "", "limit"), [(v.get("title"), f"{v.get('status')}: {v.get('figure')}", v.get("limit")) for v in verdicts])
    notes = "".join(f"<li>{html.escape(w)}</li>" for w in mesh.report.get("warnings", []))
    return (f'<div><p>{html.escape(repr(mesh))}</p><img alt="the surface" width="360" height="360" src="data:image/png;base64,{picture}">'
            f"{text}{'<ul>' + notes + '</ul>' if notes else ''}</div>")
