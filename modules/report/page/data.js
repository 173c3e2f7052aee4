'use strict';
// What the page holds: JSON, and named blobs of zlib chunks in base64.
const page = JSON.parse(document.getElementById('data').textContent);

function decodeBase64(text) {
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

const blobBytes = new Map();
function blob(id) {
  if (!blobBytes.has(id)) blobBytes.set(id, decodeBase64(document.getElementById(id).textContent.trim()));
  return blobBytes.get(id);
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Chunk number i of what {blob, offsets} describes, for mesh number `mesh`. */
function chunk(mesh, where, i) {
  return inflate(blob('blob-' + mesh + '-' + where.blob).subarray(where.offsets[i], where.offsets[i + 1]));
}

/** Reads whole numbers of seven bits a byte, low ones first. */
class Reader {
  constructor(bytes) { this.bytes = bytes; this.at = 0; }
  number() {
    const b = this.bytes;
    let value = b[this.at] & 127, factor = 128;
    while (b[this.at++] & 128) { value += (b[this.at] & 127) * factor; factor *= 128; }
    return value;
  }
  signed() {
    const n = this.number();
    return n % 2 === 0 ? n / 2 : -(n + 1) / 2;
  }
}

/** `places`: of each label of the picture, its place in the list of all labels. */
function readPolylines(bytes, unit, places) {
  const r = new Reader(bytes), lines = [];
  for (let n = r.number(); n > 0; --n) {
    const line = {left: places[r.number()], right: places[r.number()], points: null, closed: false};
    const count = r.number(), points = new Float64Array(2 * count);
    let x = 0, y = 0;
    for (let i = 0; i < count; ++i) {
      x += r.signed(); y += r.signed();
      points[2 * i] = x * unit; points[2 * i + 1] = y * unit;
    }
    line.points = points;
    line.closed = count > 3 && points[0] === points[2 * count - 2] && points[1] === points[2 * count - 1];
    lines.push(line);
  }
  return lines;
}

/** A slice's label places, row by row. */
function readRuns(bytes, count, places) {
  const r = new Reader(bytes), pixels = new Uint16Array(count);
  for (let at = 0; at < count && r.at < bytes.length;) {
    const label = places[r.number()], run = r.number();
    pixels.fill(label, at, at += run);
  }
  return pixels;
}

/** Positions in mm, less `centre`. */
function readPositions(bytes, mesh, centre) {
  const r = new Reader(bytes), out = new Float32Array(3 * mesh.vertices), at = [0, 0, 0];
  for (let i = 0; i < mesh.vertices; ++i)
    for (let k = 0; k < 3; ++k) out[3 * i + k] = mesh.origin_mm[k] - centre[k] + (at[k] += r.signed()) * mesh.unit_mm;
  return out;
}

function readTriangles(bytes, count) {
  const r = new Reader(bytes), out = new Uint32Array(3 * count);
  let first = 0;
  for (let i = 0; i < 3 * count; i += 3) {
    first += r.number();
    out[i] = first; out[i + 1] = first + r.number(); out[i + 2] = first + r.number();
  }
  return out;
}

function readTets(bytes, count) {
  const r = new Reader(bytes), out = new Uint32Array(4 * count);
  let first = 0;
  for (let i = 0; i < 4 * count; i += 4) {
    first += r.number();
    out[i] = first;
    for (let k = 1; k < 4; ++k) out[i + k] = out[i + k - 1] + r.number();
  }
  return out;
}

function readLabels(bytes, count, places) {
  const r = new Reader(bytes), out = new Uint16Array(count);
  for (let i = 0; i < count; ++i) out[i] = places[r.number()];
  return out;
}

/** Arrays of a packed mesh by name. */
async function unpackMesh(number, mesh, centre) {
  const raw = {};
  for (let i = 0; i < mesh.arrays.length; ++i) raw[mesh.arrays[i]] = await chunk(number, mesh, i);
  const out = {positions: readPositions(raw.positions, mesh, centre), angles: raw.angles, distances: raw.distances || null, values: raw.values || null};
  if (raw.triangles) {
    out.triangles = readTriangles(raw.triangles, mesh.elements);
    out.labels = readLabels(raw.labels, 2 * mesh.elements, placesOf[number]);
  } else {
    out.tets = readTets(raw.tets, mesh.elements);
    out.labels = readLabels(raw.labels, mesh.elements, placesOf[number]);
  }
  return out;
}

// Small helpers of the page.
const byId = id => document.getElementById(id);

function element(tag, attributes, ...children) {
  const e = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name === 'text') e.textContent = value;
    else if (name.startsWith('on')) e.addEventListener(name.slice(2), value);
    else if (value !== null && value !== false) e.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children) e.append(child);
  return e;
}

/** A number with about three significant digits, and thousands apart. */
function figure(value, digits = 3) {
  if (value === null || value === undefined || !isFinite(value)) return 'none';
  if (Number.isInteger(value)) return value.toLocaleString('en-US');
  const size = Math.abs(value);
  if (size >= 1000) return Math.round(value).toLocaleString('en-US');
  if (size > 0 && size < 1e-4) return value.toExponential(1);
  return String(Number(value.toPrecision(digits)));
}

const pictures = number => page.meshes[number].pictures;

// The labels of all meshes in one list; those of the first keep their colour.
const allLabels = new Map();
for (const m of page.meshes) for (const l of m.pictures.labels || []) if (!allLabels.has(l.label)) allLabels.set(l.label, l);
const labels = [...allLabels.values()].sort((a, b) => a.label - b.label);
const placesOf = page.meshes.map(m => (m.pictures.labels || []).map(l => labels.findIndex(k => k.label === l.label)));
const labelText = l => l.label === 0 ? 'background' : l.name ? l.label + ' ' + l.name : 'label ' + l.label;

function rgb(hex) {
  return [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16));
}

/** World to stack coordinates, and back. */
const toStack = (frame, p) => frame.axes.map(a => a.reduce((sum, c, k) => sum + c * (p[k] - frame.origin[k]), 0));
const toWorld = (frame, q) => [0, 1, 2].map(k => frame.origin[k] + q[0] * frame.axes[0][k] + q[1] * frame.axes[1][k] + q[2] * frame.axes[2][k]);

function placeText(p) {
  return p.map(x => x.toFixed(1)).join(', ') + ' mm';
}

/** "section 12" or "between sections 12 and 13", counted from 1. */
function sectionText(section) {
  const noun = pictures(0).planes_are === 'planes' ? 'plane' : 'section';
  return Number.isInteger(section) ? noun + ' ' + (section + 1) : 'between ' + noun + 's ' + (Math.floor(section) + 1) + ' and ' + (Math.floor(section) + 2);
}

/** The plane nearest to a height. */
function nearestPlane(planes, z) {
  let best = 0;
  for (let i = 1; i < planes.length; ++i) if (Math.abs(planes[i].z - z) < Math.abs(planes[best].z - z)) best = i;
  return best;
}
