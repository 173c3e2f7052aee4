// Puts the page together.
async function main() {
  document.querySelectorAll('table.sortable').forEach(makeSortable);
  const status = byId('pictures-status');
  const say = (text, still) => { status.textContent = text; status.hidden = !still; };
  try { drawCharts(); } catch (e) { byId('charts').append(element('p', {class: 'notice', text: 'The histograms cannot be drawn: ' + e.message})); }
  if (typeof DecompressionStream === 'undefined') {
    say('This browser is too old to unpack the pictures (it lacks DecompressionStream: Chrome and Edge 80, Firefox 113, Safari 16.4 have it). The verdict, the tables and the provenance are complete.', true);
    return;
  }
  const shown = labels.map((_, i) => i > 0), frame = pictures(0).frame;
  const worst = (pictures(0).worst || []).map((w, n) => ({...w, number: n + 1}));
  const mark = (at, name) => { const [x, y, z] = toStack(frame, at); return {x, y, z, name}; };
  const marks = page.meshes.flatMap(m => m.defects.map(d => mark(d.at_mm, d.name))).concat(worst.map(w => mark(w.at_mm, String(w.number))));
  byId('controls').hidden = byId('views').hidden = false;
  const sections = new SectionView(shown, marks), solid = new SolidView(shown);
  const hasSections = await sections.start();
  if (hasSections) sections.legend();
  else byId('section-canvas').closest('.view').hidden = true;
  if (hasSections) solid.sectionHeight = sections.planes[sections.index].z;
  const hasSolid = await solid.start();
  if (hasSolid && hasSections) sections.moved = z => solid.sectionMoved(z);
  if (!hasSections) byId('clip-axis').querySelector('[value=section]').remove();

  const changed = () => {
    const on = shown.filter((s, i) => s && i > 0).length;
    byId('labels-count').textContent = on + ' of ' + (labels.length - 1) + ' shown';
    if (hasSections) sections.draw();
    if (hasSolid) solid.recolour();
  };
  labels.forEach((l, i) => {
    if (i === 0) return;
    const box = element('input', {type: 'checkbox', checked: true, 'data-label': l.label, onchange: e => { shown[i] = e.target.checked; changed(); }});
    const swatch = element('span', {class: 'swatch', 'aria-hidden': 'true'});
    swatch.style.background = l.colour;
    byId('label-switches').append(element('li', {}, element('label', {}, box, swatch, labelText(l))));
  });
  const all = on => {
    labels.forEach((_, i) => { shown[i] = i > 0 && on; });
    byId('label-switches').querySelectorAll('input').forEach(b => { b.checked = on; });
    changed();
  };
  byId('labels-all').addEventListener('click', () => all(true));
  byId('labels-none').addEventListener('click', () => all(false));
  byId('labels-count').textContent = labels.length - 1 + ' of ' + (labels.length - 1) + ' shown';

  const show = async (at, corners, {inside = false, size = 0, mesh = 0} = {}) => {
    byId('views').scrollIntoView({block: 'start'});
    if (hasSections) await sections.show(toStack(frame, at), Math.max(sections.zoom, 3));
    if (!hasSolid) return;
    if (solid.current !== mesh && pictures(mesh).surface) {
      byId('solid-mesh').value = mesh;
      await solid.load(mesh);
    }
    solid.focus(at, corners, inside, size);
  };
  listWorst(worst, show);
  for (const button of document.querySelectorAll('button[data-at]'))
    button.addEventListener('click', () => show(JSON.parse(button.dataset.at), [], {size: Number(button.dataset.size), mesh: Number(button.dataset.mesh)}));

  window.addEventListener('beforeprint', () => {
    if (!hasSolid) return;
    solid.renderNow();
    byId('solid-print').src = solid.canvas.toDataURL();
  });
  say('', false);
  if (hasSections) await sections.keepSome();
  window.reportViews = {sections, solid};
  document.documentElement.dataset.ready = 'yes';
}

/** The worst places as a table whose buttons show each in both pictures. */
function listWorst(worst, show) {
  const box = byId('worst-places'), planes = pictures(0).planes, frame = pictures(0).frame;
  if (worst.length === 0) { box.append(element('p', {text: 'There is nothing to list.'})); return; }
  const kinds = {angle: ['narrowest triangle', '°'], dihedral: ['smallest dihedral of a tet', '°'], distance: ['farthest from the labels', ' mm']};
  const body = element('tbody');
  for (const w of worst) {
    const plane = planes.length > 0 ? planes[nearestPlane(planes, toStack(frame, w.at_mm)[2])].section : null;
    const names = w.labels.map(i => labelText(labels[placesOf[0][i]])).join(', ');
    const [name, unit] = kinds[w.kind];
    body.append(element('tr', {},
        element('td', {'data-v': w.number, text: w.number}), element('td', {class: 'text', text: name}),
        element('td', {'data-v': w.figure, text: w.figure.toFixed(w.kind === 'distance' ? 2 : 1) + unit}), element('td', {class: 'text', text: names}),
        element('td', {text: placeText(w.at_mm)}), element('td', {'data-v': plane === null ? '' : plane, text: plane === null ? '' : sectionText(plane)}),
        element('td', {class: 'jump'}, element('button', {type: 'button', text: 'Show', 'aria-label': 'Show place ' + w.number + ' in the pictures', onclick: () => show(w.at_mm, w.corners_mm, {inside: w.kind === 'dihedral'})}))));
  }
  const head = ['No.', 'What', 'Figure', 'Labels', 'At', 'Section'].map((text, i) => element('th', {scope: 'col', class: i === 1 || i === 3 ? 'text' : null, 'data-sort': i, text}));
  const table = element('table', {class: 'sortable'}, element('caption', {text: 'Of the whole mesh' + (page.meshes.length > 1 ? ' ' + page.meshes[0].name : '') + ', worst first of each kind; the numbers are those of the rings in the section picture.'}),
      element('thead', {}, element('tr', {}, ...head, element('th', {scope: 'col', class: 'jump text', text: 'Show'}))), body);
  box.append(element('div', {class: 'table tall'}, table));
  makeSortable(table);
}

main().catch(e => {
  const status = byId('pictures-status');
  status.hidden = false;
  status.textContent = 'The pictures cannot be shown: ' + e.message;
  console.error(e);
});
