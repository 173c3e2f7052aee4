// The 3-D view: surface, a cut that shows the tets inside, colours by label, distance and quality.
const edgeInk = 0x20262d;

/** White-grey to dark red: red is bad. */
function rampColour(t) {
  const stops = [[0, [224, 228, 232]], [0.35, [247, 205, 140]], [0.65, [226, 105, 66]], [1, [122, 6, 32]]];
  t = Math.max(0, Math.min(1, t));
  for (let i = 1; i < stops.length; ++i)
    if (t <= stops[i][0]) {
      const [t0, a] = stops[i - 1], [t1, b] = stops[i], s = (t - t0) / (t1 - t0);
      return a.map((x, k) => Math.round(x + s * (b[k] - x)));
    }
  return stops[stops.length - 1][1];
}
const ramp = Array.from({length: 256}, (_, i) => rampColour(i / 255));
const goodAngle = 30;  // degrees; anything above is shown as good

// What a solver model says of triangles: four bytes each (surface_values.h).
const byModel = {set: {place: 0}, acts: {place: 1}, modulus: {place: 2}, mises: {place: 3}};
const neutral = [200, 205, 210], actColours = [neutral, [52, 101, 164], [204, 62, 45], [135, 70, 150]];

/** Hues a golden angle apart. */
function setColour(number) {
  const h = (number * 137.508) % 360 / 60, c = 0.55, x = c * (1 - Math.abs(h % 2 - 1)), m = 0.82 - c;
  return [[c, x, 0], [x, c, 0], [0, c, x], [0, x, c], [x, 0, c], [c, 0, x]][Math.floor(h) % 6].map(v => Math.round(255 * (v + m)));
}

class SolidView {
  constructor(shown) {
    this.shown = shown;
    this.canvas = byId('solid-canvas');
    this.meshes = [];
    this.colour = 'label';
    this.cut = {axis: 'none', share: 0.5, flip: false, whole: false};
    this.current = 0;
  }

  /** False when the browser has no WebGL. */
  async start() {
    const first = page.meshes.findIndex(m => m.pictures.surface);
    if (first < 0) return this.missing('There is no surface to show.');
    const trial = document.createElement('canvas');
    try {
      if (!trial.getContext('webgl2') && !trial.getContext('webgl')) throw new Error('no WebGL');
      this.renderer = new THREE.WebGLRenderer({canvas: this.canvas, antialias: true, preserveDrawingBuffer: true});
    } catch (e) {
      return this.missing('This browser offers no WebGL, so the mesh cannot be turned in 3-D here. Everything else on this page works.');
    }
    this.current = first;
    const r = this.renderer;
    r.setClearColor(0xffffff, 1);
    r.localClippingEnabled = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 1, 1000);
    this.camera.up.set(0, 0, 1);
    this.scene.add(this.camera);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9aa2aa, 0.72));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.5);
    lamp.position.set(-0.6, 0.8, 1);
    this.camera.add(lamp);
    this.plane = new THREE.Plane(new THREE.Vector3(0, 0, -1), 0);
    await this.load(first);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.enableKeys = false;
    this.controls.screenSpacePanning = true;
    this.controls.addEventListener('change', () => { if (this.cut.axis === 'view') this.updateCut(); this.render(); });
    this.listen();
    this.turn('start');
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    this.resize();
    return true;
  }

  missing(text) {
    byId('solid-missing').textContent = text;
    byId('solid-missing').hidden = false;
    byId('solid-controls').hidden = true;
    byId('solid-help').hidden = true;
    this.canvas.parentElement.hidden = true;
    return false;
  }

  async load(number) {
    if (!this.meshes[number]) {
      const p = pictures(number), s = p.surface, centre = [0, 1, 2].map(k => s.origin_mm[k] + 32767.5 * s.unit_mm);
      const mesh = {centre, surface: await unpackMesh(number, s, centre), tets: p.tets ? await unpackMesh(number, p.tets, centre) : null, p};
      this.measure(mesh);
      this.meshes[number] = mesh;
    }
    if (this.group) this.scene.remove(this.group);
    this.current = number;
    this.mesh = this.meshes[number];
    this.build();
    this.describe();
  }

  measure(mesh) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], q = mesh.surface.positions;
    for (let i = 0; i < q.length; ++i) {
      low[i % 3] = Math.min(low[i % 3], q[i]);
      high[i % 3] = Math.max(high[i % 3], q[i]);
    }
    mesh.low = low;
    mesh.high = high;
    mesh.middle = low.map((x, k) => (x + high[k]) / 2);
    mesh.radius = Math.max(1e-6, Math.hypot(...low.map((x, k) => high[k] - x)) / 2);
  }

  /** Geometry of the current mesh; each triangle has its own corners, so that it can have its own colour. */
  build() {
    const s = this.mesh.surface, n = s.triangles.length;
    const corners = new Float32Array(3 * n);
    for (let i = 0; i < n; ++i) corners.set(s.positions.subarray(3 * s.triangles[i], 3 * s.triangles[i] + 3), 3 * i);
    this.group = new THREE.Group();
    const position = new THREE.BufferAttribute(corners, 3);
    const make = side => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', position);
      geometry.setAttribute('color', new THREE.BufferAttribute(new Uint8Array(3 * n), 3, true));
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(0), 1));
      const material = new THREE.MeshPhongMaterial({vertexColors: THREE.VertexColors, flatShading: true, side, shininess: 12, specular: 0x181818,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
      const m = new THREE.Mesh(geometry, material);
      m.frustumCulled = false;
      this.group.add(m);
      return m;
    };
    this.front = make(THREE.FrontSide);
    this.back = make(THREE.BackSide);
    const line = (colour, opacity) => {
      const l = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({color: colour, transparent: opacity < 1, opacity}));
      l.frustumCulled = false;
      this.group.add(l);
      return l;
    };
    this.edges = line(edgeInk, 0.45);
    this.capEdges = line(edgeInk, 0.8);
    this.cap = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshPhongMaterial({vertexColors: THREE.VertexColors, flatShading: true, side: THREE.DoubleSide, shininess: 0,
      specular: 0x000000, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
    this.cap.frustumCulled = false;
    this.capLit = this.cap.material;
    this.capFlat = new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
    this.group.add(this.cap);
    const glow = new THREE.MeshBasicMaterial({color: 0xe00030, transparent: true, opacity: 0.5, side: THREE.DoubleSide, depthTest: false});
    this.mark = new THREE.Mesh(new THREE.BufferGeometry(), glow);
    this.mark.renderOrder = 5;
    this.mark.frustumCulled = false;
    this.markLines = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({color: 0x60000f, depthTest: false}));
    this.markLines.renderOrder = 6;
    this.markLines.frustumCulled = false;
    this.ring = new THREE.Sprite(new THREE.SpriteMaterial({map: this.ringTexture(), depthTest: false, sizeAttenuation: false}));
    this.ring.renderOrder = 7;
    this.ring.scale.set(0.055, 0.055, 1);
    this.ring.visible = false;
    this.group.add(this.mark, this.markLines, this.ring);
    this.scene.add(this.group);
    this.edgesFor = null;
    this.recolour();
  }

  ringTexture() {
    if (this.ringMap) return this.ringMap;
    const c = document.createElement('canvas');
    c.width = c.height = 64;
    const g = c.getContext('2d');
    for (const [colour, width] of [['#fff', 12], ['#d0002a', 7]]) {
      g.strokeStyle = colour;
      g.lineWidth = width;
      g.beginPath();
      g.arc(32, 32, 24, 0, 2 * Math.PI);
      g.stroke();
    }
    return this.ringMap = new THREE.CanvasTexture(c);
  }

  /** Colour of a triangle by what the solver model says of it. */
  modelColour(values, t) {
    const v = values[4 * t + byModel[this.colour].place];
    if (this.colour === 'set') return v ? setColour(v) : neutral;
    if (this.colour === 'acts') return actColours[v];
    return v ? ramp[v] : neutral;
  }

  /** Names and colours of what is shown by the model: sets, or supports and loads. */
  modelKey() {
    const m = this.mesh.p.surface.model;
    return this.colour === 'set' ? m.sets.map((name, i) => [name, setColour(i + 1)]) : [['free', actColours[0]], ['held or moved', actColours[1]], ['loaded', actColours[2]], ['both', actColours[3]]];
  }

  distanceTop() {
    const h = (this.mesh.p.histograms || []).find(x => x.name === 'distances');
    return h ? h.high : 1;
  }

  /** Which triangles are shown, and their colours on either side. */
  recolour() {
    const s = this.mesh.surface, n = s.triangles.length / 3;
    const front = this.front.geometry.attributes.color, back = this.back.geometry.attributes.color;
    const colours = labels.map(l => rgb(l.colour)), index = new Uint32Array(3 * n);
    const unit = this.mesh.p.surface.distance_unit_mm, top = this.distanceTop();
    let shown = 0;
    for (let t = 0; t < n; ++t) {
      const below = s.labels[2 * t], above = s.labels[2 * t + 1], a = below > 0 && this.shown[below], b = above > 0 && this.shown[above];
      if (!a && !b) continue;
      for (let k = 0; k < 3; ++k) {
        const c = 3 * t + k;
        let f, r;
        if (this.colour === 'distance' && s.distances) f = r = ramp[Math.round(255 * Math.min(1, s.distances[s.triangles[c]] * unit / top))];
        else if (byModel[this.colour]) f = r = this.modelColour(s.values, t);
        else if (this.colour === 'quality') f = r = ramp[Math.round(255 * Math.max(0, 1 - s.angles[t] / 4 / goodAngle))];
        else { f = colours[a ? below : above]; r = colours[b ? above : below]; }
        front.array.set(f, 3 * c);
        back.array.set(r, 3 * c);
        index[shown++] = c;
      }
    }
    front.needsUpdate = back.needsUpdate = true;
    for (const m of [this.front, this.back]) m.geometry.setIndex(new THREE.BufferAttribute(index.subarray(0, shown), 1));
    this.shownIndex = index.subarray(0, shown);
    this.edgesFor = null;
    this.updateEdges();
    this.updateCut();
    this.legend();
    this.render();
  }

  updateEdges() {
    this.edges.visible = byId('solid-edges').checked;
    if (!this.edges.visible || this.edgesFor === this.shownIndex) return;
    const s = this.mesh.surface, out = new Uint32Array(2 * this.shownIndex.length);
    let at = 0;
    for (let i = 0; i < this.shownIndex.length; i += 3)
      for (let k = 0; k < 3; ++k) {
        const a = s.triangles[this.shownIndex[i + k]], b = s.triangles[this.shownIndex[i + (k + 1) % 3]];
        out[at++] = a; out[at++] = b;
      }
    this.edges.geometry.setAttribute('position', new THREE.BufferAttribute(s.positions, 3));
    this.edges.geometry.setIndex(new THREE.BufferAttribute(out, 1));
    this.edgesFor = this.shownIndex;
  }

  /** The cutting plane in the mesh's own coordinates; what lies on its normal's side is kept. */
  placePlane() {
    const m = this.mesh, n = new THREE.Vector3(), axis = this.cut.axis;
    let low, high;
    if (axis === 'view') {
      this.camera.getWorldDirection(n);
      const c = n.dot(new THREE.Vector3(...m.middle));
      low = c - m.radius; high = c + m.radius;
    } else if (axis === 'section') {
      const {axes, origin} = m.p.frame;
      n.set(...axes[2]);
      low = high = n.dot(new THREE.Vector3(...origin.map((x, k) => x - m.centre[k]))) + this.sectionHeight;
    } else {
      const k = 'xyz'.indexOf(axis);
      n.setComponent(k, 1);
      low = m.low[k]; high = m.high[k];
    }
    this.cut.at = low + (high - low) * this.cut.share;
    const sign = this.cut.flip ? -1 : 1;
    this.plane.normal.copy(n).multiplyScalar(sign);
    this.plane.constant = -sign * this.cut.at;
  }

  /** Keeps the side away from the camera, so that the cut is seen. */
  faceCut() {
    if (this.cut.axis === 'none') return;
    this.cut.flip = false;
    this.placePlane();
    this.cut.flip = this.plane.normal.dot(this.offset()) > 0;
  }

  updateCut() {
    const on = this.cut.axis !== 'none';
    byId('clip-flip').disabled = byId('clip-whole').disabled = !on;
    byId('clip-slider').disabled = !on || this.cut.axis === 'section';
    this.cap.visible = this.capEdges.visible = on;
    const planes = on ? [this.plane] : [];
    if (on) this.placePlane();
    for (const o of [this.front, this.back, this.edges]) {
      if (o.material.clippingPlanes === null || o.material.clippingPlanes.length !== planes.length) o.material.needsUpdate = true;
      o.material.clippingPlanes = planes;
    }
    if (on) this.fillCap();
    this.tellCut();
  }

  tellCut() {
    const text = byId('clip-text'), p = this.mesh.p;
    if (this.cut.axis === 'none') { text.textContent = ''; return; }
    const where = this.cut.axis === 'view' ? 'The cut faces you' : this.cut.axis === 'section' ? 'The cut is at the section shown' : 'The cut is at ' + this.cut.axis + ' = ' + (this.cut.at + this.mesh.centre['xyz'.indexOf(this.cut.axis)]).toFixed(1) + ' mm';
    text.textContent = where + (!this.mesh.tets ? '; this mesh has no tetrahedra, so its surface is seen from inside.'
        : '; it meets ' + figure(this.cutTets) + ' tetrahedra' + (p.tets.one_of > 1 ? ' of those shown (one in ' + p.tets.one_of + ')' : '') + '.');
  }

  fillCap() {
    this.cap.material = this.cut.whole ? this.capLit : this.capFlat;
    const {normal, constant} = this.plane, t = this.mesh.tets, points = [], colours = [], lines = [];
    this.cutTets = 0;
    if (t) {
      const q = t.positions, n = q.length / 3, side = new Float32Array(n);
      for (let i = 0; i < n; ++i) side[i] = normal.x * q[3 * i] + normal.y * q[3 * i + 1] + normal.z * q[3 * i + 2] + constant;
      const palette = labels.map(l => rgb(l.colour)), at = new Float32Array(12);
      const pale = [214, 219, 224];
      for (let e = 0, k = 0; e < t.labels.length; ++e, k += 4) {
        if (!this.shown[t.labels[e]]) continue;
        const v = t.tets, s0 = side[v[k]] >= 0, s1 = side[v[k + 1]] >= 0, s2 = side[v[k + 2]] >= 0, s3 = side[v[k + 3]] >= 0;
        const kept = s0 + s1 + s2 + s3;
        if (kept === 0 || kept === 4) continue;
        ++this.cutTets;
        const c = this.colour === 'label' ? palette[t.labels[e]]
            : this.colour === 'quality' ? ramp[Math.round(255 * Math.max(0, 1 - t.angles[e] / 4 / goodAngle))] : pale;
        if (this.cut.whole) {
          for (const [a, b, d] of [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
            for (const i of [a, b, d]) { const o = 3 * v[k + i]; points.push(q[o], q[o + 1], q[o + 2]); colours.push(c[0], c[1], c[2]); }
          for (const [a, b] of [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
            for (const i of [a, b]) { const o = 3 * v[k + i]; lines.push(q[o], q[o + 1], q[o + 2]); }
          continue;
        }
        const sides = [s0, s1, s2, s3];
        let count = 0;
        const cross = (a, b) => {
          const i = v[k + a], j = v[k + b], f = side[i] / (side[i] - side[j]);
          for (let x = 0; x < 3; ++x) at[3 * count + x] = q[3 * i + x] + f * (q[3 * j + x] - q[3 * i + x]);
          ++count;
        };
        if (kept !== 2) {
          const alone = sides.indexOf(kept === 1);
          for (let b = 0; b < 4; ++b) if (b !== alone) cross(alone, b);
        } else {  // round the quadrilateral: neighbours share a corner
          const a = sides.indexOf(true), b = sides.lastIndexOf(true), others = [0, 1, 2, 3].filter(i => !sides[i]);
          cross(a, others[0]); cross(a, others[1]); cross(b, others[1]); cross(b, others[0]);
        }
        for (let i = 1; i + 1 < count; ++i)
          for (const p of [0, i, i + 1]) { points.push(at[3 * p], at[3 * p + 1], at[3 * p + 2]); colours.push(c[0], c[1], c[2]); }
        for (let i = 0; i < count; ++i)
          for (const p of [i, (i + 1) % count]) lines.push(at[3 * p], at[3 * p + 1], at[3 * p + 2]);
      }
    } else {
      this.surfaceLines(lines);
    }
    const set = (object, name, array, size, normalized) => object.geometry.setAttribute(name, new THREE.BufferAttribute(array, size, normalized));
    for (const o of [this.cap, this.capEdges]) { o.geometry.dispose(); o.geometry = new THREE.BufferGeometry(); }
    set(this.cap, 'position', new Float32Array(points), 3);
    set(this.cap, 'color', new Uint8Array(colours), 3, true);
    set(this.capEdges, 'position', new Float32Array(lines), 3);
  }

  /** Where the plane meets the shown surface. */
  surfaceLines(lines) {
    const {normal, constant} = this.plane, s = this.mesh.surface, q = s.positions;
    const side = i => normal.x * q[3 * i] + normal.y * q[3 * i + 1] + normal.z * q[3 * i + 2] + constant;
    for (let i = 0; i < this.shownIndex.length; i += 3) {
      const v = [0, 1, 2].map(k => s.triangles[this.shownIndex[i + k]]), d = v.map(side);
      for (let k = 0; k < 3; ++k) {
        const l = (k + 1) % 3;
        if ((d[k] >= 0) === (d[l] >= 0)) continue;
        const f = d[k] / (d[k] - d[l]);
        for (let x = 0; x < 3; ++x) lines.push(q[3 * v[k] + x] + f * (q[3 * v[l] + x] - q[3 * v[k] + x]));
      }
    }
  }

  legend() {
    const box = byId('solid-scale');
    box.hidden = this.colour === 'label';
    if (box.hidden) return;
    if (this.colour === 'set' || this.colour === 'acts') {
      const used = new Set();
      const values = this.mesh.surface.values, place = byModel[this.colour].place;
      for (let t = place; t < values.length; t += 4) used.add(values[t]);
      box.replaceChildren(...this.modelKey().filter((x, i) => used.has(this.colour === 'set' ? i + 1 : i)).map(([name, c]) => {
        const swatch = element('span', {class: 'swatch'});
        swatch.style.background = 'rgb(' + c.join(',') + ')';
        return element('div', {class: 'key'}, swatch, element('span', {text: ' ' + name}));
      }));
      return;
    }
    const distance = this.colour === 'distance', top = this.distanceTop();
    const colours = [0, 0.2, 0.35, 0.5, 0.65, 0.8, 1].map(t => 'rgb(' + rampColour(t).join(',') + ')').join(',');
    const m = this.mesh.p.surface.model;
    const scale = this.colour === 'modulus' ? ['Young’s modulus of the tetrahedra behind, by ratio', figure(m.modulus_low_mpa) + ' MPa', figure(m.modulus_high_mpa) + ' MPa']
        : this.colour === 'mises' ? ['von Mises stress', '0 MPa', figure(m.mises_high_mpa) + ' MPa and more'] : null;
    if (scale) box.replaceChildren(element('div', {text: scale[0]}), element('div', {class: 'ramp', style: ''}), element('div', {class: 'ends'}, element('span', {text: scale[1]}), element('span', {text: scale[2]})));
    else box.replaceChildren(
        element('div', {text: distance ? 'distance to the labels’ boundary' : 'smallest angle; inside: dihedral'}),
        element('div', {class: 'ramp', style: ''}),
        element('div', {class: 'ends'}, element('span', {text: distance ? '0 mm' : goodAngle + '° and more'}), element('span', {text: distance ? figure(top) + ' mm and more' : '0°'})));
    box.querySelector('.ramp').style.background = 'linear-gradient(to right,' + colours + ')';
  }

  describe() {
    const p = this.mesh.p, s = p.surface, parts = [];
    parts.push(s.elements < s.of ? figure(s.elements) + ' triangles drawn for ' + figure(s.of) + ': the surface is simplified for this picture' + (s.cell_mm > 0 ? ' (vertices within ' + figure(s.cell_mm, 2) + ' mm joined)' : '') + '; all figures are of the whole mesh'
        : figure(s.elements) + ' triangles, as they are');
    if (p.tets) parts.push(p.tets.one_of > 1 ? figure(p.tets.elements) + ' of ' + figure(p.tets.of) + ' tetrahedra (one in ' + p.tets.one_of + ')' : figure(p.tets.elements) + ' tetrahedra, all');
    else parts.push('no tetrahedra');
    parts.push('coordinates rounded to ' + figure(s.unit_mm, 2) + ' mm');
    byId('solid-text').textContent = parts.join('; ') + '.';
    const distance = byId('solid-colour').querySelector('[value=distance]');
    distance.disabled = !this.mesh.surface.distances;
    distance.textContent = 'distance to the labels' + (distance.disabled ? ' (none: there are no voxels)' : '');
    const m = s.model, has = {set: m, acts: m, modulus: m && m.modulus_high_mpa > 0, mises: m && m.mises_high_mpa > 0};
    for (const [name, there] of Object.entries(has)) {
      const option = byId('solid-colour').querySelector('[value=' + name + ']');
      option.hidden = option.disabled = !there;
    }
    const chosen = byId('solid-colour').querySelector('[value=' + this.colour + ']');
    if (chosen.disabled) byId('solid-colour').value = this.colour = 'label';
  }

  /** The section picture shows another height. */
  sectionMoved(height) {
    this.sectionHeight = height;
    if (this.cut.axis !== 'section') return;
    this.updateCut();
    this.render();
  }

  listen() {
    const c = this.canvas;
    byId('solid-colour').addEventListener('change', e => { this.colour = e.target.value; this.recolour(); });
    byId('solid-edges').addEventListener('change', () => { this.updateEdges(); this.render(); });
    byId('solid-ghost').addEventListener('change', e => {
      for (const m of [this.front, this.back]) {
        m.material.transparent = e.target.checked;
        m.material.opacity = e.target.checked ? 0.28 : 1;
        m.material.depthWrite = !e.target.checked;
      }
      this.render();
    });
    byId('clip-axis').addEventListener('change', e => { this.cut.axis = e.target.value; this.faceCut(); this.updateCut(); this.render(); });
    byId('clip-slider').addEventListener('input', e => { this.cut.share = e.target.value / 1000; this.updateCut(); this.render(); });
    byId('clip-flip').addEventListener('click', () => { this.cut.flip = !this.cut.flip; this.updateCut(); this.render(); });
    byId('clip-whole').addEventListener('change', e => { this.cut.whole = e.target.checked; this.updateCut(); this.render(); });
    byId('solid-fit').addEventListener('click', () => this.turn('start'));
    for (const b of document.querySelectorAll('[data-turn]')) b.addEventListener('click', () => this.turn(b.dataset.turn));
    if (page.meshes.length > 1) {
      byId('solid-mesh-row').hidden = false;
      page.meshes.forEach((m, n) => { if (m.pictures.surface) byId('solid-mesh').append(element('option', {value: n, text: m.name})); });
      byId('solid-mesh').value = this.current;
      byId('solid-mesh').addEventListener('change', async e => { await this.load(Number(e.target.value)); this.render(); });
    }
    c.addEventListener('keydown', e => {
      const turns = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
      if (turns[e.key] && e.shiftKey) this.pan(...turns[e.key]);
      else if (turns[e.key]) this.rotate(turns[e.key][0] * 0.15, turns[e.key][1] * 0.15);
      else if (e.key === '+' || e.key === '=') this.dolly(0.85);
      else if (e.key === '-') this.dolly(1 / 0.85);
      else if (e.key === '0') this.turn('start');
      else if (e.key === 'PageUp' || e.key === 'PageDown') this.stepCut(e.key === 'PageUp' ? 20 : -20);
      else return;
      e.preventDefault();
    });
  }

  stepCut(step) {
    const slider = byId('clip-slider');
    if (this.cut.axis === 'none' || this.cut.axis === 'section') { byId('clip-axis').value = this.cut.axis = 'z'; this.faceCut(); }
    slider.value = Number(slider.value) + step;
    this.cut.share = slider.value / 1000;
    this.updateCut();
    this.render();
  }

  offset() { return this.camera.position.clone().sub(this.controls.target); }

  rotate(round, up) {
    const s = new THREE.Spherical().setFromVector3(this.offset().applyAxisAngle(new THREE.Vector3(1, 0, 0), -Math.PI / 2));
    s.theta += round;
    s.phi = Math.max(0.02, Math.min(Math.PI - 0.02, s.phi - up));
    const o = new THREE.Vector3().setFromSpherical(s).applyAxisAngle(new THREE.Vector3(1, 0, 0), Math.PI / 2);
    this.camera.position.copy(this.controls.target).add(o);
    this.controls.update();
  }

  dolly(factor) {
    this.camera.position.copy(this.controls.target).add(this.offset().multiplyScalar(factor));
    this.controls.update();
  }

  pan(right, up) {
    const step = this.offset().length() * 0.05, e = this.camera.matrix.elements;
    const move = new THREE.Vector3(e[0], e[1], e[2]).multiplyScalar(right * step).add(new THREE.Vector3(e[4], e[5], e[6]).multiplyScalar(up * step));
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.controls.update();
  }

  /** How far to stand off so that the mesh's box fills the picture, seen along -direction. */
  fitDistance(direction) {
    const m = this.mesh, tall = Math.tan(this.camera.fov * Math.PI / 360) * 0.93, wide = tall * (this.camera.aspect || 1);
    const back = direction, right = new THREE.Vector3(0, 0, 1).cross(back).normalize(), up = back.clone().cross(right);
    let distance = 1e-6;
    for (let corner = 0; corner < 8; ++corner) {
      const p = new THREE.Vector3(...[0, 1, 2].map(k => ((corner >> k & 1) ? m.high[k] : m.low[k]) - m.middle[k]));
      distance = Math.max(distance, p.dot(back) + Math.abs(p.dot(right)) / wide, p.dot(back) + Math.abs(p.dot(up)) / tall);
    }
    return distance;
  }

  /** Looks from a side of the body; the patient's front is -y in LPS and +y in RAS. */
  turn(side) {
    const ras = this.mesh.p.space === 'ras', f = ras ? 1 : -1;
    const from = {start: [0.45 * -f, f, 0.5], front: [0, f, 0], back: [0, -f, 0], left: [-f, 0, 0], right: [f, 0, 0], top: [0, 0.001 * f, 1], bottom: [0, 0.001 * f, -1]}[side];
    const m = this.mesh, direction = new THREE.Vector3(...from).normalize(), distance = this.fitDistance(direction);
    this.controls.target.set(...m.middle);
    this.camera.position.set(...m.middle).addScaledVector(direction, distance);
    this.camera.near = distance / 200;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    if (this.cut.axis === 'view') this.updateCut();
    this.render();
  }

  /** Shows a place (world mm) with its element; cuts the mesh open there when `inside`. */
  focus(at, corners, inside, extent = 0) {
    const m = this.mesh, local = p => p.map((x, k) => x - m.centre[k]), p = local(at);
    const points = corners.map(local), faces = [], lines = [];
    const push = (list, ...which) => { for (const i of which) list.push(...points[i]); };
    if (points.length === 3) { push(faces, 0, 1, 2); push(lines, 0, 1, 1, 2, 2, 0); }
    if (points.length === 4) { push(faces, 0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3); push(lines, 0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3); }
    for (const [object, list] of [[this.mark, faces], [this.markLines, lines]]) {
      object.geometry.dispose();
      object.geometry = new THREE.BufferGeometry();
      object.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(list), 3));
    }
    this.ring.position.set(...p);
    this.ring.visible = true;
    let size = extent / 2;
    for (const c of points) size = Math.max(size, Math.hypot(...c.map((x, k) => x - p[k])));
    const distance = Math.min(2 * m.radius, Math.max(14 * size, 0.35 * m.radius));
    if (inside) {
      const axis = 'xyz'.includes(this.cut.axis) ? this.cut.axis : 'y', k = 'xyz'.indexOf(axis);
      byId('clip-axis').value = this.cut.axis = axis;
      this.cut.share = Math.max(0, Math.min(1, (p[k] - m.low[k]) / Math.max(1e-9, m.high[k] - m.low[k])));
      byId('clip-slider').value = Math.round(1000 * this.cut.share);
      this.faceCut();
      this.updateCut();
    }
    const direction = inside || p.every((x, k) => Math.abs(x - m.middle[k]) < 1e-9) ? this.offset() : new THREE.Vector3(...p.map((x, k) => x - m.middle[k])).normalize().add(this.offset().normalize().multiplyScalar(0.8));
    this.controls.target.set(...p);
    this.camera.position.set(...p).addScaledVector(direction.normalize(), distance);
    this.camera.near = distance / 200;
    this.camera.far = distance + 8 * m.radius;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.render();
  }

  resize() {
    const w = this.canvas.clientWidth, h = this.canvas.clientHeight;
    if (w === 0 || h === 0) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(w, h, false);
    const before = this.camera.aspect;
    this.camera.aspect = w / h;
    this.camera.updateProjectionMatrix();
    if (!this.sized || Math.abs(before - this.camera.aspect) > 0.2) { this.sized = true; this.turn('start'); }
    this.render();
  }

  render() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => { this.frame = 0; this.renderNow(); });
  }

  renderNow() {
    this.renderer.render(this.scene, this.camera);
    this.drawAxes();
  }

  /** The directions of the world, as the camera sees them. */
  drawAxes() {
    const c = byId('solid-axes'), g = c.getContext('2d'), space = this.mesh.p.space;
    const names = space === 'lps' ? ['L', 'P', 'S'] : space === 'ras' ? ['R', 'A', 'S'] : ['x', 'y', 'z'], inks = ['#b3261e', '#1b7a34', '#1a56c4'];
    g.clearRect(0, 0, c.width, c.height);
    g.font = '700 17px system-ui, sans-serif';
    g.textAlign = 'center';
    g.textBaseline = 'middle';
    const q = this.camera.quaternion.clone().inverse();
    const arms = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((a, k) => ({k, v: new THREE.Vector3(...a).applyQuaternion(q)})).sort((a, b) => a.v.z - b.v.z);
    for (const {k, v} of arms) {
      const x = 56 + 36 * v.x, y = 56 - 36 * v.y;
      g.strokeStyle = inks[k];
      g.lineWidth = 4;
      g.beginPath();
      g.moveTo(56, 56);
      g.lineTo(x, y);
      g.stroke();
      g.lineWidth = 5;
      g.strokeStyle = '#fff';
      g.strokeText(names[k], 56 + 47 * v.x, 56 - 47 * v.y);
      g.fillStyle = inks[k];
      g.fillText(names[k], 56 + 47 * v.x, 56 - 47 * v.y);
    }
  }
}
