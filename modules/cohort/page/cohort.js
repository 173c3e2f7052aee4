'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const at = id => document.getElementById(id);
  const figure = x => x === null ? '' : Math.abs(x) >= 1000 ? Math.round(x).toLocaleString('en') : String(Number(x.toPrecision(4)));

  // ---- the table of cases: filter and order ----
  const body = at('case-table').tBodies[0], rows = [...body.rows];
  function filter() {
    const part = at('filter').value.toLowerCase(), kind = at('show').value;
    let shown = 0;
    for (const row of rows) {
      const fits = row.cells[1].textContent.toLowerCase().includes(part) && (kind === 'all' || row.dataset.state === kind);
      row.hidden = !fits;
      shown += fits ? 1 : 0;
    }
    at('shown').textContent = shown + ' of ' + rows.length;
  }
  at('filter').addEventListener('input', filter);
  at('show').addEventListener('change', filter);
  const heads = [...at('case-table').tHead.rows[0].cells];
  function sortBy(head) {
    const column = heads.indexOf(head), down = head.getAttribute('aria-sort') !== 'descending', sign = down ? -1 : 1;
    for (const h of heads) h.removeAttribute('aria-sort');
    head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
    const text = row => row.cells[column].textContent;
    const compare = head.dataset.sort === 'text' ? (a, b) => text(a).localeCompare(text(b), 'en', {numeric: true})
        : (a, b) => (text(a) === '' ? -Infinity : Number(text(a))) - (text(b) === '' ? -Infinity : Number(text(b)));
    body.append(...[...rows].sort((a, b) => sign * compare(a, b) || 0));
  }
  for (const head of heads)
    if (head.dataset.sort) head.querySelector('button').addEventListener('click', () => sortBy(head));
  function point(place) {
    const row = at('case-' + place);
    if (!row) return;
    at('filter').value = '';
    at('show').value = 'all';
    filter();
    for (const other of rows) other.classList.remove('pointed');
    row.classList.add('pointed');
    row.scrollIntoView({block: 'center'});
  }

  // ---- distributions ----
  const labelName = d => {
    const known = data.labels.find(l => l.label === d.label);
    return !known ? 'cohort' : known.name ? d.label + ' ' + known.name : String(d.label);
  };
  /** A box with whiskers behind each strip. */
  const boxes = {
    id: 'boxes',
    beforeDatasetsDraw(chart) {
      const {ctx, scales: {x, y}} = chart;
      ctx.save();
      ctx.lineWidth = 1.5;
      chart.$strips.forEach((d, i) => {
        const [low, q1, median, q3, high] = d.box.map(v => y.getPixelForValue(v));
        const left = x.getPixelForValue(i - 0.36), right = x.getPixelForValue(i + 0.36), middle = x.getPixelForValue(i);
        ctx.fillStyle = '#eef2f6';
        ctx.strokeStyle = '#57606a';
        ctx.fillRect(left, q3, right - left, q1 - q3);
        ctx.strokeRect(left, q3, right - left, q1 - q3);
        ctx.beginPath();
        ctx.moveTo(left, median); ctx.lineTo(right, median);
        ctx.moveTo(middle, q3); ctx.lineTo(middle, high);
        ctx.moveTo(middle, q1); ctx.lineTo(middle, low);
        ctx.stroke();
      });
      ctx.restore();
    },
  };
  /** The same place for a case each time: between -0.3 and 0.3. */
  const beside = place => ((place * 0.6180339887) % 1 - 0.5) * 0.6;
  let chart = null;
  function draw() {
    const m = Number(at('metric').value), metric = data.metrics[m], strips = data.distributions.filter(d => d.metric === m);
    const log = at('logarithmic').checked && strips.every(d => d.points.every(p => p[1] > 0) && d.box.every(v => v > 0));
    const set = outlier => strips.flatMap((d, i) => d.points.filter(p => p[2] === outlier).map(p => ({x: i + beside(p[0]), y: p[1], place: p[0]})));
    if (chart) chart.destroy();
    chart = new Chart(at('strip'), {
      type: 'scatter',
      data: {datasets: [
        {label: 'outliers', data: set(1), backgroundColor: '#a3140f', pointStyle: 'triangle', pointRadius: 6, pointHoverRadius: 8},
        {label: 'cases', data: set(0), backgroundColor: 'rgba(59,115,175,.55)', pointRadius: 3, pointHoverRadius: 6},
      ]},
      options: {
        animation: false, maintainAspectRatio: false, responsive: true, normalized: true,
        onClick: (event, found) => { if (found.length) point(chart.data.datasets[found[0].datasetIndex].data[found[0].index].place); },
        plugins: {legend: {display: true, labels: {usePointStyle: true}}, tooltip: {callbacks: {label: item => data.ids[item.raw.place] + ': ' + figure(item.raw.y) + (metric.unit ? ' ' + metric.unit : '')}}},
        scales: {
          x: {type: 'linear', min: -0.5, max: Math.max(0.5, strips.length - 0.5), grid: {display: false}, afterBuildTicks: axis => { axis.ticks = strips.map((d, i) => ({value: i})); },
            ticks: {autoSkip: strips.length > 40, callback: v => strips[v] ? labelName(strips[v]) : ''}},
          y: {type: log ? 'logarithmic' : 'linear', title: {display: true, text: metric.title + (metric.unit ? ', ' + metric.unit : '')}},
        },
      },
      plugins: [{id: 'strips', beforeInit: c => { c.$strips = strips; }}, boxes],
    });
    const outliers = strips.reduce((n, d) => n + d.points.filter(p => p[2]).length, 0);
    const drawn = strips.reduce((n, d) => n + d.points.length, 0), all = strips.reduce((n, d) => n + d.n, 0);
    at('strip-text').textContent = metric.title + ': ' + all + ' values, ' + outliers + ' outliers' + (drawn < all ? '; ' + drawn + ' of them are drawn, the boxes are of all' : '') +
        '. Boxes reach from the first to the third quartile, whiskers 1.5 times as far. A click on a point leads to its case.';
    at('strip-table').tBodies[0].replaceChildren(...strips.map(d => {
      const row = document.createElement('tr');
      for (const [i, text] of [labelName(d), d.n, figure(d.box[1]), figure(d.box[2]), figure(d.box[3]), d.points.filter(p => p[2]).length].entries()) {
        const cell = document.createElement(i ? 'td' : 'th');
        cell.textContent = text;
        if (!i) cell.className = 'text';
        row.append(cell);
      }
      return row;
    }));
  }
  data.metrics.forEach((metric, m) => {
    if (!data.distributions.some(d => d.metric === m)) return;
    at('metric').append(new Option(metric.title + (metric.per_label ? ', label by label' : ''), m));
  });
  function choose() {
    at('logarithmic').checked = data.metrics[Number(at('metric').value)].logarithmic;
    draw();
  }
  filter();
  if (at('metric').options.length) {
    at('metric').addEventListener('change', choose);
    at('logarithmic').addEventListener('change', draw);
    choose();
  } else {
    at('distributions').hidden = true;
  }
  document.documentElement.dataset.ready = 'yes';
})();
