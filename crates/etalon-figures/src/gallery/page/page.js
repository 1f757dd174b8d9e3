// What the page can do beyond being read: theme, sliders, search, one figure per screen with comparison and magnifier, copying.
'use strict';
const root = document.documentElement;
const one = (selector, within = document) => within.querySelector(selector);
const all = (selector, within = document) => Array.from(within.querySelectorAll(selector));
const press = (button, pressed) => button.setAttribute('aria-pressed', String(pressed));
const button = (text, act) => Object.assign(document.createElement('button'), { type: 'button', textContent: text, onclick: act });
root.classList.add('js');
all('.script').forEach((element) => { element.hidden = false; });

// Theme: the system's until the button says otherwise. Storage may be forbidden.
const remember = (theme) => { try { localStorage.setItem('etalon-theme', theme); } catch { /* forgotten */ } };
const remembered = () => { try { return localStorage.getItem('etalon-theme'); } catch { return null; } };
if (['dark', 'light'].includes(remembered())) root.dataset.theme = remembered();
one('#theme').onclick = () => {
  const now = root.dataset.theme || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
  root.dataset.theme = now === 'dark' ? 'light' : 'dark';
  remember(root.dataset.theme);
};

// A group shows the figure at which its slider stands, with its further pages.
const articles = all('article');
const firstPages = (article) => all('.figure:not([data-of])', article);
const nameOf = (figure) => figure.dataset.of ?? figure.dataset.id;
const choose = (figure) => {
  const article = figure.closest('article');
  const range = one('.slider input', article);
  if (!range) return;
  all('.figure', article).forEach((other) => { other.hidden = nameOf(other) !== nameOf(figure); });
  range.value = firstPages(article).findIndex((other) => !other.hidden);
  all('.slider span', article).forEach((label, i) => {
    label.classList.toggle('now', i === Number(range.value));
    if (i === Number(range.value)) range.setAttribute('aria-valuetext', label.textContent);
  });
};
all('.slider').forEach((slider) => {
  const [range, figures] = [one('input', slider), firstPages(slider.closest('article'))];
  range.oninput = () => choose(figures[range.value]);
  all('span', slider).forEach((label, i) => { label.onclick = () => choose(figures[i]); });
  range.oninput();
  slider.hidden = false;
});

// Search: all words, in everything that an article says. Of a group the figure that has them is shown, of a table the rows.
const [find, failed, found, tiles] = [one('#find'), one('#failed'), one('#found'), all('nav li')];
const filter = () => {
  const words = find.value.toLowerCase().split(/\s+/);
  const says = (element) => words.every((word) => element.textContent.toLowerCase().includes(word));
  articles.forEach((article, i) => {
    article.hidden = tiles[i].hidden = !says(article) || (failed.checked && article.dataset.failed === '0');
    const figures = all('.figure', article);
    if (find.value.trim() && figures.some(says)) choose(figures.find(says));
    all('.wide', article).forEach((table) => {
      const rows = all('tbody tr', table);
      const matching = rows.filter(says);
      rows.forEach((row) => { row.hidden = matching.length > 0 && !matching.includes(row); });
      if (find.value.trim() && matching.length) table.open = true;
    });
  });
  all('nav div').forEach((part) => { part.hidden = all('li', part).every((tile) => tile.hidden); });
  all('main section').forEach((section) => { section.hidden = all('article', section).every((article) => article.hidden); });
  const filtered = find.value.trim() !== '' || failed.checked;
  found.textContent = filtered ? `${articles.filter((article) => !article.hidden).length} of ${articles.length}` : '';
};
find.oninput = failed.onchange = filter;
find.onkeydown = (event) => { if (event.key === 'Enter') articles.find((article) => !article.hidden)?.scrollIntoView(); };

// An address leads to its figure, with or without "figure-": its group goes there, and the search lets it be seen.
const follow = () => {
  const id = decodeURIComponent(location.hash.slice(1));
  const target = document.getElementById(id) ?? document.getElementById(`figure-${id}`);
  if (!target) return;
  if (target.closest('article')?.hidden) {
    find.value = '';
    failed.checked = false;
    filter();
  }
  const figure = target.closest('.figure');
  if (figure) choose(figure);
  (figure === target ? target.closest('article') : target).scrollIntoView();
};
addEventListener('hashchange', follow);
addEventListener('click', (event) => { if (event.target.closest('a[href^="#"]')) setTimeout(follow); });
follow();

// One figure per screen, alone or with another of its size.
const dialog = one('dialog');
const [stage, pair, lens, share] = ['.stage', '.pair', '.lens', '#share'].map((part) => one(part, dialog));
const [other, own] = ['other', 'own'].map((className) => Object.assign(new Image(), { className, draggable: false }));
pair.prepend(other, own);
const partner = one('#partner');
const view = { figure: null, size: [1, 1], scale: 1, x: 0, y: 0, fitted: true, pointer: { x: 0, y: 0 } };
const linkOf = (figure) => one('.zoom', figure);
const imageOf = (figure) => one('.zoom img', figure);
const sizeOf = (figure) => ['width', 'height'].map((side) => Number(imageOf(figure).getAttribute(side)));
const screens = () => all('article:not([hidden]) .figure').filter(linkOf);
const sameSize = (figure) => all('.figure').filter((it) => it !== figure && linkOf(it) && String(sizeOf(it)) === String(sizeOf(figure)));
// A picture, which is compressed here, may lie beside the page in full.
const load = (shown, figure) => {
  const small = imageOf(figure);
  shown.onerror = () => { shown.onerror = null; shown.src = small.src; };
  shown.src = one('.chart', figure) ? small.src : linkOf(figure).href;
  shown.alt = small.alt;
};
const compare = () => {
  const id = partner.value;
  if (id) load(other, document.getElementById(`figure-${id}`));
  dialog.classList.toggle('two', id !== '');
  place();
};
const mode = (name) => {
  pair.dataset.mode = dialog.dataset.mode = name;
  all('[data-mode]', one('.modes', dialog)).forEach((it) => press(it, it.dataset.mode === name));
};
const divide = () => pair.style.setProperty('--at', `${share.value}%`);
const show = (figure) => {
  const [before, size] = [partner.value, sizeOf(figure)];
  const others = sameSize(figure);
  one('#viewed').textContent = linkOf(figure).dataset.title;
  const first = document.getElementById(`figure-${nameOf(figure)}`);
  one('#caption').replaceChildren(...one('.text', first).cloneNode(true).children);
  const options = others.map((it) => new Option(linkOf(it).dataset.title, it.dataset.id));
  partner.replaceChildren(new Option('no other', ''), ...options);
  partner.disabled = !others.length;
  partner.value = others.some((it) => it.dataset.id === before) ? before : '';
  const same = view.figure && String(view.size) === String(size);
  Object.assign(view, { figure, size });
  load(own, figure);
  compare();
  // Figures of one size keep the place that is seen
  if (!same) ACTIONS.fit();
};
const step = (by) => {
  const list = screens();
  const next = list[list.indexOf(view.figure) + by];
  if (next) show(next);
};
const open = (figure, beside = '') => {
  dialog.showModal();
  view.figure = null;
  show(figure);
  partner.value = beside;
  compare();
  stage.focus();
};
dialog.onclose = () => {
  choose(view.figure);
  view.figure.closest('article').scrollIntoView({ block: 'nearest' });
  linkOf(view.figure).focus({ preventScroll: true });
};

// Wheel, pinch, double click or + and − enlarge (0 fits, 1 shows true pixels); dragging or arrows move.
const place = () => {
  const { size: [width, height], scale, x, y } = view;
  Object.assign(pair.style, { width: `${width * scale}px`, height: `${height * scale}px`, transform: `translate(${x}px, ${y}px)` });
  pair.style.imageRendering = scale >= 3 ? 'pixelated' : 'auto';
  one('#scale').textContent = `${Math.round(100 * scale)} %`;
  if (!lens.hidden) magnify();
};
// The point under (x, y) of the stage, its middle unless told, stays where it is.
const zoom = (factor, x = stage.clientWidth / 2, y = stage.clientHeight / 2) => {
  const scale = Math.min(32, Math.max(0.05, view.scale * factor));
  view.x = x - (x - view.x) * scale / view.scale;
  view.y = y - (y - view.y) * scale / view.scale;
  Object.assign(view, { scale, fitted: false });
  place();
};
const pan = (x, y) => {
  view.x += x;
  view.y += y;
  view.fitted = false;
  place();
};
const ACTIONS = {
  previous: () => step(-1),
  next: () => step(1),
  smaller: () => zoom(0.8),
  larger: () => zoom(1.25),
  fit: () => {
    const [width, height] = view.size;
    const scale = Math.min(stage.clientWidth / width, stage.clientHeight / height);
    Object.assign(view, { scale, x: (stage.clientWidth - width * scale) / 2, y: (stage.clientHeight - height * scale) / 2, fitted: true });
    place();
  },
  pixels: () => zoom(1 / view.scale),
  lens: () => {
    lens.hidden = !lens.hidden;
    press(one('[data-do="lens"]'), !lens.hidden);
    view.pointer = { x: stage.clientWidth / 2, y: stage.clientHeight / 2 };
    magnify();
  },
  close: () => dialog.close(),
  left: () => (view.fitted ? step(-1) : pan(60, 0)),
  right: () => (view.fitted ? step(1) : pan(-60, 0)),
  up: () => (view.fitted ? step(-1) : pan(0, 60)),
  down: () => (view.fitted ? step(1) : pan(0, -60)),
};
const KEYS = {
  '+': 'larger', '=': 'larger', '-': 'smaller', '−': 'smaller', 0: 'fit', 1: 'pixels', m: 'lens',
  PageUp: 'previous', PageDown: 'next', ArrowLeft: 'left', ArrowRight: 'right', ArrowUp: 'up', ArrowDown: 'down',
};
dialog.onkeydown = (event) => {
  const action = ACTIONS[KEYS[event.key]];
  if (!action || event.ctrlKey || event.metaKey || event.altKey || event.target.matches('select, input')) return;
  event.preventDefault();
  action();
  // No button stays marked while keys go through the figures
  if (dialog.open) stage.focus();
};
// The magnifier shows what is under the pointer four times as large: of two figures, both.
const magnify = () => {
  const { size: [width, height], scale, pointer: { x, y } } = view;
  lens.style.transform = `translate(${x}px, ${y}px)`;
  [own, other].forEach((image, i) => {
    const glass = lens.children[i];
    glass.style.backgroundImage = `url("${image.src}")`;
    glass.style.backgroundSize = `${4 * scale * width}px ${4 * scale * height}px`;
    const at = [4 * (view.x - x) + glass.clientWidth / 2, 4 * (view.y - y) + glass.clientHeight / 2];
    glass.style.backgroundPosition = at.map((v) => `${v}px`).join(' ');
  });
};
const at = (event) => {
  const box = stage.getBoundingClientRect();
  return { x: event.clientX - box.left, y: event.clientY - box.top };
};
const fingers = new Map();
const spread = () => {
  const [a, b] = [...fingers.values()];
  return b && { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, distance: Math.hypot(a.x - b.x, a.y - b.y) };
};
stage.onpointerdown = (event) => {
  stage.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, at(event));
  stage.classList.toggle('dividing', event.target.matches('.edge'));
};
stage.onpointerup = stage.onpointercancel = (event) => fingers.delete(event.pointerId);
stage.onpointermove = (event) => {
  const { x, y } = view.pointer = at(event);
  if (!lens.hidden) magnify();
  const [last, before] = [fingers.get(event.pointerId), spread()];
  if (!last) return;
  fingers.set(event.pointerId, { x, y });
  if (stage.classList.contains('dividing')) {
    share.value = 100 * (x - view.x) / pair.clientWidth;
    divide();
  } else if (before) {
    const after = spread();
    pan(after.x - before.x, after.y - before.y);
    zoom(after.distance / Math.max(before.distance, 1), after.x, after.y);
  } else {
    pan(x - last.x, y - last.y);
  }
};
stage.onwheel = (event) => {
  event.preventDefault();
  const { x, y } = at(event);
  zoom(Math.exp(-(event.deltaMode ? 30 : 1) * event.deltaY / 400), x, y);
};
stage.ondblclick = (event) => { const { x, y } = at(event); zoom(event.shiftKey ? 0.5 : 2, x, y); };
all('[data-do]').forEach((it) => { it.onclick = () => ACTIONS[it.dataset.do](); });
all('button[data-mode]').forEach((it) => { it.onclick = () => mode(it.dataset.mode); });
partner.onchange = compare;
share.oninput = divide;
new ResizeObserver(() => { if (dialog.open && view.fitted) ACTIONS.fit(); }).observe(stage);
mode('edge');
divide();
one('#screens').onclick = () => open(screens().find((figure) => figure.getBoundingClientRect().bottom > 0) ?? screens()[0]);
all('.zoom').forEach((link) => {
  link.setAttribute('aria-haspopup', 'dialog');
  link.onclick = (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    open(link.closest('.figure'));
  };
});
all('.figure').filter(linkOf).forEach((figure) => {
  const group = all('.figure', figure.closest('article')).map((it) => it.dataset.id);
  const others = sameSize(figure).map((it) => it.dataset.id);
  const beside = [figure.dataset.beside, ...group].find((id) => others.includes(id));
  if (!beside) return;
  const start = button('Compare', () => open(figure, beside));
  start.className = 'start';
  one('figure', figure).append(start);
});

// A long text opens by a click, and a chart that moves sideways says whether there is more of it.
all('.text').forEach((text) => { text.onclick = () => { if (!String(getSelection())) text.classList.toggle('whole'); }; });
const edges = new ResizeObserver((entries) => entries.forEach(({ target }) => more(target)));
const more = (chart) => chart.classList.toggle('more', chart.scrollWidth - chart.clientWidth - chart.scrollLeft > 2);
all('figure.chart').forEach((chart) => {
  chart.onscroll = () => more(chart);
  edges.observe(chart);
});

// Copying: the command, without a trailing line break.
all('.about pre').forEach((block) => {
  const copy = button('Copy', async () => {
    try {
      await navigator.clipboard.writeText(block.textContent);
      copy.textContent = 'Copied';
    } catch {
      getSelection().selectAllChildren(block);
      copy.textContent = 'Selected';
    }
    setTimeout(() => { copy.textContent = 'Copy'; }, 2000);
  });
  copy.setAttribute('aria-label', `Copy: ${block.textContent}`);
  const row = Object.assign(document.createElement('div'), { className: 'command' });
  block.replaceWith(row);
  row.append(block, copy);
});
