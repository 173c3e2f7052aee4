// Sortable tables: a click on a column's head sorts by it; cells carry the value to sort by in data-v.
function makeSortable(table) {
  const body = table.tBodies[0];
  const valueOf = (row, column) => {
    const cell = row.cells[column], v = cell.dataset.v;
    return v === undefined ? cell.textContent.trim() : v === '' ? NaN : Number(v);
  };
  table.querySelectorAll('th[data-sort]').forEach(head => {
    const column = Number(head.dataset.sort), button = element('button', {type: 'button', text: head.textContent.trim(), title: 'Sort by this column'});
    head.replaceChildren(button);
    button.addEventListener('click', () => {
      const up = head.getAttribute('aria-sort') !== 'ascending';
      table.querySelectorAll('th[aria-sort]').forEach(h => h.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', up ? 'ascending' : 'descending');
      const rows = [...body.rows].map((row, n) => ({row, n, v: valueOf(row, column)}));
      rows.sort((a, b) => {
        const missing = v => typeof v === 'number' && isNaN(v);
        if (missing(a.v) || missing(b.v)) return missing(a.v) - missing(b.v) || a.n - b.n;
        const d = typeof a.v === 'number' && typeof b.v === 'number' ? a.v - b.v : String(a.v).localeCompare(String(b.v), 'en', {numeric: true});
        return (up ? d : -d) || a.n - b.n;
      });
      body.append(...rows.map(r => r.row));
    });
  });
}

// Histograms, each with its counts as a table.
function drawCharts() {
  const box = byId('charts');
  const names = [...new Set(page.meshes.flatMap(m => (m.pictures.histograms || []).map(h => h.name)))];
  for (const name of names) {
    const of = page.meshes.map(m => ({name: m.name, h: (m.pictures.histograms || []).find(h => h.name === name)})).filter(x => x.h && x.h.values > 0);
    if (of.length === 0) continue;
    const first = of[0].h, unit = first.unit === 'degrees' ? '°' : ' ' + first.unit;
    const sentence = of.map(({name: mesh, h}) => (of.length > 1 ? mesh + ': ' : '') + figure(h.values) + ' values from ' + figure(h.smallest) + unit + ' to ' + figure(h.largest) + unit + ', median ' + figure(h.median) + unit).join('; ') + '.';
    const canvas = element('canvas', {role: 'img', 'aria-label': first.title + ': ' + sentence});
    const table = element('table', {}, element('caption', {text: first.title + ', counts per bin; values beyond the ends are in the end bins'}),
        element('thead', {}, element('tr', {}, element('th', {scope: 'col', class: 'text', text: first.unit}), ...of.map(x => element('th', {scope: 'col', text: of.length > 1 ? x.name : 'count'})))));
    const body = element('tbody');
    // Meshes may have bins of their own: each is drawn over its bins' middles, the table has the first's.
    const bin = (h, i) => h.low + (h.high - h.low) * i / h.counts.length;
    first.counts.forEach((c, i) => {
      body.append(element('tr', {}, element('th', {scope: 'row', text: figure(bin(first, i)) + ' to ' + figure(bin(first, i + 1))}),
          ...of.map(x => element('td', {text: x.h.high === first.high ? figure(x.h.counts[i]) : ''}))));
    });
    table.append(body);
    const plot = element('div', {class: 'plot'}, canvas);
    box.append(element('div', {class: 'chart'}, element('h3', {text: first.title}), plot, element('p', {class: 'caption', text: sentence}),
        element('details', {}, element('summary', {text: 'Counts as a table'}), element('div', {class: 'table tall'}, table))));
    const middle = h => h.counts.map((_, i) => bin(h, i + 0.5));
    const many = of.length > 1;
    new Chart(canvas, {
      type: many ? 'line' : 'bar',
      data: {
        labels: many ? undefined : middle(first),
        datasets: of.map(({name: mesh, h}, n) => many
            ? {label: mesh, data: h.counts.map((c, i) => ({x: bin(h, i + 0.5), y: 100 * c / h.values})), borderColor: meshColours[n % 6], borderDash: meshDashes[n % 6], borderWidth: 2, pointRadius: 0, tension: 0}
            : {label: 'count', data: h.counts, backgroundColor: '#3b73af', barPercentage: 1, categoryPercentage: 0.94}),
      },
      options: {
        animation: false, maintainAspectRatio: false, responsive: true,
        plugins: {legend: {display: many}, tooltip: {callbacks: {title: items => items[0].dataset.label === 'count' && !many ? figure(bin(first, items[0].dataIndex)) + ' to ' + figure(bin(first, items[0].dataIndex + 1)) + unit : ''}}},
        scales: {
          x: {type: 'linear', min: first.low, max: Math.max(...of.map(x => x.h.high)), offset: false, title: {display: true, text: first.unit}, grid: {display: false}},
          y: {beginAtZero: true, title: {display: true, text: many ? 'percent' : 'count'}, ticks: {maxTicksLimit: 6}},
        },
      },
    });
  }
}
