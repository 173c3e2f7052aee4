// The section picture: labels, their outlines, and the cut of each mesh, at every section and mid-gap.
const meshColours = ['#000000', '#b3006b', '#0054c2', '#8a5a00', '#006b54', '#6f00c9'];
const meshDashes = [[], [7, 3], [2, 3], [9, 3, 2, 3], [4, 4], [12, 4]];

class SectionView {
  constructor(shown, marks) {
    this.shown = shown;  // per label place: is it switched on?
    this.marks = marks;  // {at: stack coordinates, name}
    this.base = pictures(0);
    this.labels = labels;
    this.planes = this.base.planes;
    this.canvas = byId('section-canvas');
    this.slider = byId('section-slider');
    this.index = 0;
    this.caches = new Map();
    const o = this.base.orientation;
    this.o = o;
    // Right and down in mm, from stack coordinates.
    this.project = (x, y) => [(o.right.axis === 0 ? x : y) * o.right.sign, (o.down.axis === 0 ? x : y) * o.down.sign];
  }

  async start() {
    if (this.planes.length === 0) return false;
    await this.findBox();
    this.fit();
    this.slider.max = this.planes.length - 1;
    this.listen();
    const first = this.marks.length > 0 && this.marks[0].z !== undefined ? nearestPlane(this.planes, this.marks[0].z) : Math.floor(this.planes.length / 2);
    await this.go(await this.fullestPlane(first));
    return true;
  }

  /** A section with much in it is a better start than an end. */
  async fullestPlane(fallback) {
    const cuts = this.base.cuts;
    if (!cuts) return fallback;
    let best = fallback, most = -1;
    for (let i = 0; i < this.planes.length; i += 2) {
      const size = i % cuts.step === 0 ? cuts.offsets[i + 1] - cuts.offsets[i] : 0;
      if (size > most) { most = size; best = i; }
    }
    return best;
  }

  async findBox() {
    let box = [Infinity, Infinity, -Infinity, -Infinity];
    const add = (x, y) => {
      const [r, d] = this.project(x, y);
      box = [Math.min(box[0], r), Math.min(box[1], d), Math.max(box[2], r), Math.max(box[3], d)];
    };
    const s = this.base.slices, [px, py] = this.base.pixel_mm;
    if (s) {
      add(s.window[0] * px, s.window[1] * py);
      add((s.window[0] + s.window[2]) * px, (s.window[1] + s.window[3]) * py);
    } else {
      for (let i = 0; i < this.planes.length; ++i) {
        const parts = await this.contours(i);
        for (const lines of parts) for (const l of lines.lines) for (let k = 0; k < l.points.length; k += 2) add(l.points[k], l.points[k + 1]);
        for (const l of await this.cut(0, i)) for (let k = 0; k < l.points.length; k += 2) add(l.points[k], l.points[k + 1]);
      }
    }
    this.box = isFinite(box[0]) ? box : [0, 0, 1, 1];
  }

  async cached(key, make) {
    if (!this.caches.has(key)) {
      if (this.caches.size > 60) this.caches.delete(this.caches.keys().next().value);
      this.caches.set(key, await make());
    }
    return this.caches.get(key);
  }

  cut(mesh, plane) {
    const c = pictures(mesh).cuts;
    return c && plane % c.step === 0 ? this.cached('cut' + mesh + '-' + plane, async () => readPolylines(await chunk(mesh, c, plane), c.unit_mm, placesOf[mesh])) : [];
  }

  /** The slices that a plane shows: its own, or the two beside it. */
  slicesOf(plane) {
    const k = this.planes[plane].section;
    return Number.isInteger(k) ? [k] : [Math.floor(k), Math.floor(k) + 1];
  }

  async pixels(section) {
    const s = this.base.slices;
    if (!s || section % s.step !== 0) return null;
    return this.cached('slice' + section, async () => readRuns(await chunk(0, s, section), s.window[2] * s.window[3], placesOf[0]));
  }

  async contours(plane) {
    const c = this.base.contours, out = [];
    if (!c) return out;
    for (const k of this.slicesOf(plane))
      out.push({section: k, lines: await this.cached('contour' + k, async () => readPolylines(await chunk(0, c, k), c.unit_mm, placesOf[0]))});
    return out;
  }

  fit() {
    this.zoom = 1;
    this.centre = [(this.box[0] + this.box[2]) / 2, (this.box[1] + this.box[3]) / 2];
  }

  listen() {
    const canvas = this.canvas;
    this.slider.addEventListener('input', () => this.go(Number(this.slider.value)));
    for (const id of ['show-labels', 'show-outlines', 'show-cut', 'show-marks']) byId(id).addEventListener('change', () => this.draw());
    byId('section-fit').addEventListener('click', () => { this.fit(); this.draw(); });
    byId('section-previous').addEventListener('click', () => this.goMarked(-1));
    byId('section-next').addEventListener('click', () => this.goMarked(1));
    byId('section-previous').disabled = byId('section-next').disabled = this.marks.length === 0;
    byId('section-keep').addEventListener('click', () => this.keep());
    canvas.addEventListener('wheel', e => {
      e.preventDefault();
      this.zoomBy(Math.exp(-e.deltaY * 0.0015), this.at(e));
    }, {passive: false});
    let drag = null;
    canvas.addEventListener('pointerdown', e => { drag = {at: this.at(e), centre: this.centre.slice()}; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener('pointerup', () => { drag = null; });
    canvas.addEventListener('pointercancel', () => { drag = null; });
    canvas.addEventListener('pointermove', e => {
      if (!drag) { this.tell(e); return; }
      const now = [e.offsetX, e.offsetY], s = this.scale();
      const was = drag.screen || (drag.screen = now);
      this.centre = [drag.centre[0] - (now[0] - was[0]) / s, drag.centre[1] - (now[1] - was[1]) / s];
      this.draw();
    });
    canvas.addEventListener('keydown', e => {
      const step = 40 / this.scale();
      const moves = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step]};
      if (moves[e.key]) { this.centre = [this.centre[0] + moves[e.key][0], this.centre[1] + moves[e.key][1]]; this.draw(); }
      else if (e.key === '+' || e.key === '=') this.zoomBy(1.25);
      else if (e.key === '-') this.zoomBy(0.8);
      else if (e.key === '0') { this.fit(); this.draw(); }
      else if (e.key === 'PageUp') this.go(this.index + 1);
      else if (e.key === 'PageDown') this.go(this.index - 1);
      else return;
      e.preventDefault();
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  scale() {
    const w = Math.max(1, this.canvas.clientWidth - 56), h = Math.max(1, this.canvas.clientHeight - 56);
    return this.zoom * Math.min(w / (this.box[2] - this.box[0]), h / (this.box[3] - this.box[1]));
  }

  /** Right and down in mm at a pointer event. */
  at(e) {
    const s = this.scale();
    return [this.centre[0] + (e.offsetX - this.canvas.clientWidth / 2) / s, this.centre[1] + (e.offsetY - this.canvas.clientHeight / 2) / s];
  }

  zoomBy(factor, about) {
    const p = about || this.centre, before = this.scale();
    this.zoom = Math.min(200, Math.max(0.5, this.zoom * factor));
    const ratio = before / this.scale();
    this.centre = [p[0] + (this.centre[0] - p[0]) * ratio, p[1] + (this.centre[1] - p[1]) * ratio];
    this.draw();
  }

  /** Stack coordinates of right and down. */
  unproject(r, d) {
    const q = [0, 0];
    q[this.o.right.axis] = r * this.o.right.sign;
    q[this.o.down.axis] = d * this.o.down.sign;
    return q;
  }

  async tell(e) {
    const [x, y] = this.unproject(...this.at(e)), plane = this.planes[this.index];
    const world = toWorld(this.base.frame, [x, y, plane.z]);
    let text = placeText(world);
    const s = this.base.slices;
    if (s) {
      const i = Math.floor(x / this.base.pixel_mm[0]) - s.window[0], j = Math.floor(y / this.base.pixel_mm[1]) - s.window[1];
      const names = [];
      if (i >= 0 && j >= 0 && i < s.window[2] && j < s.window[3])
        for (const k of this.slicesOf(this.index)) {
          const pixels = await this.pixels(k);
          if (pixels) names.push(labelText(labels[pixels[j * s.window[2] + i]]));
        }
      if (names.length > 0) text += ': ' + [...new Set(names)].join(' below, ') + (new Set(names).size > 1 ? ' above' : '');
    }
    byId('section-pointer').textContent = text;
  }

  marked() {
    return [...new Set(this.marks.map(m => nearestPlane(this.planes, m.z)))].sort((a, b) => a - b);
  }

  goMarked(step) {
    const planes = this.marked();
    if (planes.length === 0) return;
    const next = step > 0 ? planes.find(p => p > this.index) : [...planes].reverse().find(p => p < this.index);
    this.go(next === undefined ? (step > 0 ? planes[0] : planes[planes.length - 1]) : next);
  }

  async go(index) {
    this.index = Math.max(0, Math.min(this.planes.length - 1, index));
    this.slider.value = this.index;
    const plane = this.planes[this.index], count = this.planes.filter(p => Number.isInteger(p.section)).length;
    const name = sectionText(plane.section);
    const here = this.marks.filter(m => nearestPlane(this.planes, m.z) === this.index).map(m => m.name);
    const text = name.charAt(0).toUpperCase() + name.slice(1) + ' of ' + count + ', at ' + figure(plane.z, 5) + ' mm' + (this.base.planes_are === 'planes' ? ' across z' : ' along the stack') +
        (here.length ? '; marked: ' + here.join(', ') : '');
    byId('section-text').textContent = text;
    this.slider.setAttribute('aria-valuetext', text);
    if (this.moved) this.moved(plane.z);
    await this.draw();
  }

  /** Shows a place of stack coordinates in the middle. */
  async show(q, zoom) {
    this.centre = this.project(q[0], q[1]);
    this.zoom = zoom || this.zoom;
    await this.go(nearestPlane(this.planes, q[2]));
  }

  async draw() {
    this.wanted = true;
    if (this.drawing) return this.drawing;
    this.drawing = (async () => {
      while (this.wanted) {
        this.wanted = false;
        const ratio = window.devicePixelRatio || 1, w = this.canvas.clientWidth, h = this.canvas.clientHeight;
        if (w === 0 || h === 0) continue;
        await this.paint(this.canvas, w, h, ratio, this.index, this.scale(), this.centre, false);
      }
    })();
    try { await this.drawing; } finally { this.drawing = null; }
  }

  async paint(canvas, w, h, ratio, index, s, centre, small) {
    const slices = [];
    for (const k of this.slicesOf(index)) slices.push({section: k, pixels: await this.pixels(k)});
    const contours = await this.contours(index), cuts = [];
    for (let m = 0; m < page.meshes.length; ++m) cuts.push(await this.cut(m, index));

    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
      canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio);
    }
    const g = canvas.getContext('2d');
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.fillStyle = '#fff';
    g.fillRect(0, 0, canvas.width, canvas.height);
    // Stack mm to device pixels.
    const o = this.o, kx = s * ratio, cx = ratio * w / 2 - centre[0] * kx, cy = ratio * h / 2 - centre[1] * kx;
    const m = [0, 0, 0, 0, cx, cy];
    m[o.right.axis === 0 ? 0 : 2] = o.right.sign * kx;
    m[o.down.axis === 0 ? 1 : 3] = o.down.sign * kx;
    this.matrix = m;
    const line = ratio * (small ? 0.7 : 1);

    const gap = slices.length === 2;
    slices.forEach((slice, n) => {
      if (!slice.pixels) return;
      if (byId('show-labels').checked && !gap) this.fill(g, slice.pixels, m, 0.36);
      if (byId('show-labels').checked && gap && n === 0 && slices[1].pixels) this.fill(g, this.common(slices), m, 0.16);
    });
    slices.forEach((slice, n) => {
      if (slice.pixels && byId('show-outlines').checked) this.outlines(g, slice.pixels, m, line, gap ? n : -1);
    });
    contours.forEach((c, n) => this.drawContours(g, c.lines, m, line, gap ? n : -1));

    if (byId('show-cut').checked)
      cuts.forEach((lines, n) => {
        const path = new Path2D();
        for (const l of lines) if (this.shown[l.left] || this.shown[l.right]) this.trace(path, l.points, m);
        g.setLineDash([]);
        g.lineJoin = 'round';
        g.strokeStyle = 'rgba(255,255,255,.7)';
        g.lineWidth = 3.2 * line;
        g.stroke(path);
        g.strokeStyle = meshColours[n % meshColours.length];
        g.lineWidth = 1.7 * line;
        g.setLineDash(meshDashes[n % meshDashes.length].map(d => d * line));
        g.stroke(path);
        g.setLineDash([]);
      });
    if (byId('show-marks').checked && !small) this.drawMarks(g, index, m, ratio);
    if (!small) this.decorate(g, w, h, ratio, s);
  }

  trace(path, points, m) {
    for (let k = 0; k < points.length; k += 2) {
      const x = m[0] * points[k] + m[2] * points[k + 1] + m[4], y = m[1] * points[k] + m[3] * points[k + 1] + m[5];
      if (k === 0) path.moveTo(x, y); else path.lineTo(x, y);
    }
  }

  /** Where both slices have the same label. */
  common(slices) {
    const [a, b] = slices.map(s => s.pixels);
    return a.map((label, i) => label === b[i] ? label : 0);
  }

  fill(g, pixels, m, alpha) {
    const [x0, y0, w, h] = this.base.slices.window, [px, py] = this.base.pixel_mm;
    const image = new ImageData(w, h), bytes = new Uint32Array(image.data.buffer);
    const colours = labels.map((l, i) => {
      const [r, gr, b] = rgb(l.colour);
      return i > 0 && this.shown[i] ? (Math.round(alpha * 255) << 24 | b << 16 | gr << 8 | r) >>> 0 : 0;
    });
    for (let i = 0; i < pixels.length; ++i) bytes[i] = colours[pixels[i]];
    const buffer = document.createElement('canvas');
    buffer.width = w; buffer.height = h;
    buffer.getContext('2d').putImageData(image, 0, 0);
    g.save();
    g.imageSmoothingEnabled = false;
    g.transform(...m);
    g.scale(px, py);
    g.drawImage(buffer, x0, y0);
    g.restore();
  }

  /** Pixel cracks between labels; n: -1 a section, 0 the one below a gap, 1 the one above it. */
  outlines(g, pixels, m, line, n) {
    const [x0, y0, w, h] = this.base.slices.window, [px, py] = this.base.pixel_mm;
    const paths = new Map(), on = i => this.shown[i] ? i : 0;
    const add = (a, b, xa, ya, xb, yb) => {
      const key = a === 0 ? b : b === 0 ? a : -1;
      if (!paths.has(key)) paths.set(key, new Path2D());
      const p = paths.get(key);
      p.moveTo(m[0] * xa * px + m[2] * ya * py + m[4], m[1] * xa * px + m[3] * ya * py + m[5]);
      p.lineTo(m[0] * xb * px + m[2] * yb * py + m[4], m[1] * xb * px + m[3] * yb * py + m[5]);
    };
    // A run of cracks between the same two labels is one line.
    const scan = (rows, columns, at, put) => {
      for (let r = 0; r <= rows; ++r) {
        let start = -1, a0 = 0, b0 = 0;
        for (let c = 0; c <= columns; ++c) {
          let a = 0, b = 0;
          if (c < columns) { a = r > 0 ? on(at(r - 1, c)) : 0; b = r < rows ? on(at(r, c)) : 0; }
          if (start >= 0 && (a !== a0 || b !== b0)) { put(a0, b0, r, start, c); start = -1; }
          if (start < 0 && a !== b) { start = c; a0 = a; b0 = b; }
        }
      }
    };
    scan(h, w, (r, c) => pixels[r * w + c], (a, b, r, from, to) => add(a, b, x0 + from, y0 + r, x0 + to, y0 + r));
    scan(w, h, (r, c) => pixels[c * w + r], (a, b, r, from, to) => add(a, b, x0 + r, y0 + from, x0 + r, y0 + to));
    g.lineWidth = 1.2 * line;
    g.setLineDash(n === 1 ? [4 * line, 3 * line] : []);
    for (const [key, path] of paths) {
      g.strokeStyle = key < 0 ? '#555' : this.dark(labels[key].colour);
      g.stroke(path);
    }
    g.setLineDash([]);
  }

  dark(colour) {
    return 'rgb(' + rgb(colour).map(c => Math.round(0.78 * c)).join(',') + ')';
  }

  drawContours(g, lines, m, line, n) {
    if (byId('show-labels').checked && n < 0)
      for (let label = 1; label < labels.length; ++label) {
        if (!this.shown[label]) continue;
        const path = new Path2D();
        for (const loop of this.loops(lines, label)) this.trace(path, loop, m);
        g.fillStyle = 'rgba(' + rgb(labels[label].colour).join(',') + ',0.3)';
        g.fill(path, 'evenodd');
      }
    if (!byId('show-outlines').checked) return;
    g.lineWidth = 2.4 * line;
    g.setLineDash(n === 1 ? [6 * line, 4 * line] : []);
    for (const l of lines) {
      const a = this.shown[l.left] ? l.left : 0, b = this.shown[l.right] ? l.right : 0;
      if (a === b) continue;
      const path = new Path2D();
      this.trace(path, l.points, m);
      g.strokeStyle = this.dark(labels[Math.max(a, b)].colour);
      g.stroke(path);
    }
    g.setLineDash([]);
  }

  /** The outline of a label as loops: lines that meet at junctions, end to end with the label on their left. */
  loops(lines, label) {
    const starts = new Map(), arcs = [];
    for (const l of lines) {
      if (l.left !== label && l.right !== label) continue;
      const points = l.left === label ? Array.from(l.points) : [];
      if (l.left !== label) for (let k = l.points.length - 2; k >= 0; k -= 2) points.push(l.points[k], l.points[k + 1]);
      const arc = {points, used: false}, key = points[0] + ',' + points[1];
      arcs.push(arc);
      if (!starts.has(key)) starts.set(key, []);
      starts.get(key).push(arc);
    }
    const out = [];
    for (const arc of arcs) {
      if (arc.used) continue;
      const loop = [];
      for (let a = arc; a; a = (starts.get(loop[loop.length - 2] + ',' + loop[loop.length - 1]) || []).find(b => !b.used)) {
        a.used = true;
        loop.push(...a.points);
      }
      out.push(loop);
    }
    return out;
  }

  drawMarks(g, index, m, ratio) {
    const here = this.marks.filter(k => nearestPlane(this.planes, k.z) === index);
    g.font = '600 ' + 12 * ratio + 'px system-ui, sans-serif';
    g.textBaseline = 'middle';
    for (const k of here) {
      const x = m[0] * k.x + m[2] * k.y + m[4], y = m[1] * k.x + m[3] * k.y + m[5];
      for (const [colour, width] of [['#fff', 5], ['#c00020', 2]]) {
        g.strokeStyle = colour;
        g.lineWidth = width * ratio;
        g.beginPath();
        g.arc(x, y, 10 * ratio, 0, 2 * Math.PI);
        g.stroke();
      }
      g.lineWidth = 4 * ratio;
      g.strokeStyle = '#fff';
      g.fillStyle = '#a3140f';
      g.strokeText(k.name, x + 14 * ratio, y);
      g.fillText(k.name, x + 14 * ratio, y);
    }
  }

  /** Letters of the body's sides, and a scale. */
  decorate(g, w, h, ratio, s) {
    g.save();
    g.scale(ratio, ratio);
    g.font = '700 14px system-ui, sans-serif';
    g.fillStyle = '#1b1f24';
    g.strokeStyle = '#fff';
    g.lineWidth = 4;
    g.lineJoin = 'round';
    const put = (text, x, y, align) => {
      g.textAlign = align;
      g.textBaseline = 'middle';
      g.strokeText(text, x, y);
      g.fillText(text, x, y);
    };
    const letters = this.o.letters;
    if (letters) {
      put(letters[0], 10, h / 2, 'left');
      put(letters[1], w - 10, h / 2, 'right');
      put(letters[2], w / 2, 14, 'center');
      put(letters[3], w / 2, h - 14, 'center');
    }
    const mm = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500].filter(x => x * s <= w / 3).pop() || 0.1;
    g.lineWidth = 2;
    g.strokeStyle = '#1b1f24';
    g.beginPath();
    g.moveTo(12, h - 18); g.lineTo(12, h - 12); g.lineTo(12 + mm * s, h - 12); g.lineTo(12 + mm * s, h - 18);
    g.stroke();
    g.font = '12px system-ui, sans-serif';
    g.lineWidth = 4;
    g.strokeStyle = '#fff';
    put(mm + ' mm', 12, h - 28, 'left');
    g.restore();
  }

  legend() {
    const line = (colour, dash, width) => '<svg width="34" height="10" aria-hidden="true"><line x1="1" y1="5" x2="33" y2="5" stroke="' + colour + '" stroke-width="' + width +
        '" stroke-dasharray="' + dash + '"/></svg>';
    const box = byId('section-legend'), one = page.meshes.length === 1;
    const add = (picture, text) => {
      const key = element('span', {class: 'key'});
      key.innerHTML = picture;
      key.append(text);
      box.append(key);
    };
    page.meshes.forEach((mesh, n) => {
      if (mesh.pictures.cuts) add(line(meshColours[n % 6], meshDashes[n % 6].join(' '), 2.2), one ? 'the mesh’s own cut in this plane' : 'cut of ' + mesh.name);
    });
    if (this.base.slices || this.base.contours) {
      const what = this.base.slices ? 'label outline (pixels)' : 'contour as drawn';
      add(line('#2f6db3', '', 1.6), what + '; between sections: of the section below');
      add(line('#2f6db3', '4 3', 1.6), 'of the section above');
    }
    const c = this.base.cuts;
    if (c) box.append(element('span', {class: 'dim', text: 'Cuts are of the whole mesh, drawn true to ' + figure(c.tolerance_mm, 2) + ' mm.' +
        (this.base.slices && this.base.slices.step > 1 ? ' To keep the file small, one slice of labels in ' + this.base.slices.step + ' is shown.' : '') +
        (c.step > 1 ? ' To keep the file small, the cut is shown in one of ' + c.step + ' planes.' : '')}));
  }

  async thumbnail(index) {
    const canvas = document.createElement('canvas'), w = 300, h = Math.max(150, Math.min(420, Math.round(w * (this.box[3] - this.box[1]) / (this.box[2] - this.box[0]))));
    const s = Math.min((w - 16) / (this.box[2] - this.box[0]), (h - 16) / (this.box[3] - this.box[1]));
    await this.paint(canvas, w, h, 1.5, index, s, [(this.box[0] + this.box[2]) / 2, (this.box[1] + this.box[3]) / 2], true);
    return canvas.toDataURL();
  }

  /** Adds this section to those that are printed. */
  async keep(index = this.index) {
    if (document.querySelector('[data-kept="' + index + '"]')) return;
    const text = sectionText(this.planes[index].section), source = await this.thumbnail(index);
    const name = text.charAt(0).toUpperCase() + text.slice(1);
    const figureElement = element('figure', {'data-kept': index},
        element('button', {type: 'button', title: 'Show it above', onclick: () => this.go(index)},
            element('img', {src: source, alt: name + ': labels and the mesh’s cut'}), element('figcaption', {text: name})));
    byId('kept-sections').hidden = byId('kept-title').hidden = false;
    const box = byId('kept-sections');
    const after = [...box.children].find(f => Number(f.dataset.kept) > index);
    box.insertBefore(figureElement, after || null);
  }

  /** A few sections spread over the stack, and those with the worst places, to begin with. */
  async keepSome() {
    const sections = this.planes.map((p, i) => i).filter(i => Number.isInteger(this.planes[i].section) && this.base.cuts && this.base.cuts.offsets[i + 1] - this.base.cuts.offsets[i] > 12);
    const wanted = new Set();
    for (let i = 1; i <= 4; ++i) if (sections.length > 0) wanted.add(sections[Math.floor(i * sections.length / 5)]);
    for (const p of this.marks.slice(0, 2)) wanted.add(nearestPlane(this.planes, p.z));
    for (const i of [...wanted].sort((a, b) => a - b)) await this.keep(i);
  }
}
