// What the page can do beyond being read: theme, search, comparison, magnification, copying.
'use strict';
const root = document.documentElement;
const all = (selector, within = document) => Array.from(within.querySelectorAll(selector));
const make = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};
const button = (text, name, act) => {
  const element = make('button', { type: 'button', textContent: text, onclick: act });
  if (name) element.setAttribute('aria-label', name);
  return element;
};

// Theme: the system's until the button says otherwise. Storage may be forbidden.
const remember = (theme) => { try { localStorage.setItem('etalon-theme', theme); } catch { /* forgotten */ } };
const remembered = () => { try { return localStorage.getItem('etalon-theme'); } catch { return null; } };
const dark = matchMedia('(prefers-color-scheme: dark)');
if (['dark', 'light'].includes(remembered())) root.dataset.theme = remembered();
document.getElementById('theme').onclick = () => {
  const now = root.dataset.theme || (dark.matches ? 'dark' : 'light');
  root.dataset.theme = now === 'dark' ? 'light' : 'dark';
  remember(root.dataset.theme);
};
document.querySelector('.tools').hidden = false;

// The contents take a phone's whole screen: closed there.
const nav = document.querySelector('nav');
const contents = nav.querySelector('details');
const wide = matchMedia('(min-width: 62rem)');
contents.open = wide.matches;
wide.onchange = () => { contents.open = wide.matches; };

// Search: all words, in everything that a figure or a row of the reports' tables says. What is empty then, goes too.
const find = document.getElementById('find');
const failed = document.getElementById('failed');
const found = document.getElementById('found');
const articles = all('article');
const rows = all('section > .panel tbody tr');
const texts = new Map([...articles, ...rows].map((element) => [element, element.textContent.toLowerCase()]));
const first = () => articles.find((article) => !article.hidden) ?? rows.find((row) => !row.hidden);
const filter = () => {
  const words = find.value.toLowerCase().split(/\s+/);
  const says = (element) => words.every((word) => texts.get(element).includes(word));
  articles.forEach((article) => { article.hidden = !says(article) || (failed.checked && article.dataset.failed === '0'); });
  rows.forEach((row) => { row.hidden = !says(row) || failed.checked; });
  const hidden = new Set(articles.filter((article) => article.hidden).map((article) => article.dataset.id));
  all('li[data-id]').forEach((item) => { item.hidden = hidden.has(item.dataset.id); });
  all('.part').forEach((part) => { part.hidden = all('li', part).every((item) => item.hidden); });
  all('main > section').forEach((section) => {
    section.hidden = all('article, .part, .panel tbody tr', section).every((element) => element.hidden);
  });
  all('nav a').forEach((link) => {
    if (!link.closest('.part')) link.hidden = document.querySelector(link.hash).closest('section').hidden;
  });
  const shown = articles.length - hidden.size;
  const filtered = find.value.trim() !== '' || failed.checked;
  const inRows = rows.filter((row) => !row.hidden).length;
  found.textContent = filtered ? `${shown} of ${articles.length} figures, ${inRows} of ${rows.length} errors and claims` : '';
};
const toFirst = () => {
  const target = first();
  const closed = target?.closest('details');
  if (closed) closed.open = true;
  target?.scrollIntoView({ block: 'start' });
};
find.oninput = () => {
  filter();
  // Beside the contents there is room to follow at once; on a phone, Enter does.
  if (wide.matches && find.value.trim()) toFirst();
};
find.onkeydown = (event) => { if (event.key === 'Enter') toFirst(); };
failed.onchange = filter;
// A link leads to its figure even when the search has hidden that.
addEventListener('hashchange', () => {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (target?.closest('[hidden]')) {
    find.value = '';
    failed.checked = false;
    filter();
    target.scrollIntoView();
  }
});

// The contents mark the figure that is read, and scroll to it.
const linkTo = new Map(all('nav li a').map((link) => [link.hash.slice(1), link]));
const spy = new IntersectionObserver((entries) => {
  entries.filter((entry) => entry.isIntersecting).forEach((entry) => {
    all('nav [aria-current]').forEach((link) => link.removeAttribute('aria-current'));
    const link = linkTo.get(entry.target.id);
    link.setAttribute('aria-current', 'true');
    if (wide.matches && !nav.contains(document.activeElement)) nav.scrollTop = link.offsetTop - nav.clientHeight / 2;
  });
}, { rootMargin: '-20% 0px -75% 0px' });
articles.forEach((article) => spy.observe(article));

// Comparison of pictures of one size: by a slider, by turns, or by their difference. Of a chart with a render, the render.
const picture = (article) => {
  const shown = article.querySelector('figure img');
  if (!article.querySelector('figure.chart')) return { source: shown.src, width: shown.width, size: `${shown.getAttribute('width')}×${shown.getAttribute('height')}` };
  if (article.dataset.render !== 'true') return null;
  const svg = decodeURIComponent(shown.getAttribute('src').replace(/^[^,]*,/, ''));
  const image = new DOMParser().parseFromString(svg, 'image/svg+xml').querySelector('image');
  return image && { source: image.getAttribute('href'), size: `chart ${image.getAttribute('width')}×${image.getAttribute('height')}` };
};
const pictures = new Map(articles.map((article) => [article.dataset.id, picture(article)]));
const titleOf = (id) => document.querySelector(`#figure-${CSS.escape(id)} .zoom`).dataset.title;
const MODES = { slider: 'Slider', difference: 'Difference, 4 times as bright', blink: 'Blink' };
const comparison = (id, others, preferred) => {
  const over = make('img', { className: 'over', src: pictures.get(id).source, alt: '' });
  const under = make('img');
  const pair = make('div', { className: 'pair' }, under, over, make('span', { className: 'edge' }));
  const range = make('input', { type: 'range', min: 0, max: 100, value: 50, step: 1 });
  range.setAttribute('aria-label', `Share of ${id} that covers the other, in percent`);
  const move = () => pair.style.setProperty('--at', `${range.value}%`);
  range.oninput = move;
  over.onload = () => { pair.style.width = range.style.width = `${over.naturalWidth}px`; };
  const drag = (event) => {
    const box = pair.getBoundingClientRect();
    range.value = 100 * (event.clientX - box.left) / box.width;
    move();
  };
  pair.onpointerdown = (event) => { if (pair.dataset.mode === 'slider') { pair.setPointerCapture(event.pointerId); drag(event); } };
  pair.onpointermove = (event) => { if (pair.hasPointerCapture(event.pointerId)) drag(event); };
  const partner = make('select', {}, ...others.map((other) => make('option', { value: other, textContent: titleOf(other) })));
  partner.setAttribute('aria-label', 'Compare with');
  partner.onchange = () => {
    under.src = pictures.get(partner.value).source;
    under.alt = `${id} over ${partner.value}`;
  };
  partner.value = others.includes(preferred) ? preferred : others[0];
  partner.onchange();
  const modes = Object.entries(MODES).map(([mode, text]) => button(text, null, () => choose(mode)));
  const choose = (mode) => {
    pair.dataset.mode = mode;
    modes.forEach((one, i) => one.setAttribute('aria-pressed', String(Object.keys(MODES)[i] === mode)));
  };
  choose('slider');
  move();
  return [make('div', { className: 'bar' }, partner, ...modes), pair, range];
};
articles.forEach((article) => {
  const { id, beside } = article.dataset;
  const own = pictures.get(id);
  const others = own ? [...pictures].filter(([other, its]) => other !== id && its?.size === own.size).map(([other]) => other) : [];
  if (!others.length) return;
  const details = make('details', { className: 'compare' }, make('summary', { textContent: 'Compare with another image' }));
  details.addEventListener('toggle', () => { if (details.open) details.append(...comparison(id, others, beside)); }, { once: true });
  article.querySelector('.again').before(details);
});

// Magnification: wheel, pinch, double click or + and − (0 fits, 1 shows true pixels); dragging or arrows move; Escape closes.
const dialog = document.querySelector('dialog');
let view = null;
const place = () => {
  const { shown, scale, x, y, state, size } = view;
  Object.assign(shown.style, { width: `${size[0] * scale}px`, height: `${size[1] * scale}px`, transform: `translate(${x}px, ${y}px)` });
  shown.style.imageRendering = scale >= 3 ? 'pixelated' : 'auto';
  state.textContent = `${Math.round(100 * scale)} %`;
};
const fit = () => {
  const { stage, size } = view;
  view.scale = Math.min(stage.clientWidth / size[0], stage.clientHeight / size[1], 4);
  [view.x, view.y] = [(stage.clientWidth - size[0] * view.scale) / 2, (stage.clientHeight - size[1] * view.scale) / 2];
  place();
};
// The point under (x, y) of the stage, its middle unless told, stays where it is.
const zoom = (factor, x = view.stage.clientWidth / 2, y = view.stage.clientHeight / 2) => {
  const scale = Math.min(32, Math.max(0.05, view.scale * factor));
  view.x = x - (x - view.x) * scale / view.scale;
  view.y = y - (y - view.y) * scale / view.scale;
  view.scale = scale;
  place();
};
const pan = (x, y) => {
  view.x += x;
  view.y += y;
  place();
};
const gestures = (stage) => {
  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return b && { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, distance: Math.hypot(a.x - b.x, a.y - b.y) };
  };
  const at = (event) => {
    const box = stage.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  stage.onpointerdown = (event) => { stage.setPointerCapture(event.pointerId); fingers.set(event.pointerId, at(event)); };
  stage.onpointerup = stage.onpointercancel = (event) => fingers.delete(event.pointerId);
  stage.onpointermove = (event) => {
    const [last, before] = [fingers.get(event.pointerId), spread()];
    if (!last) return;
    fingers.set(event.pointerId, at(event));
    const [now, after] = [fingers.get(event.pointerId), spread()];
    if (!before) return pan(now.x - last.x, now.y - last.y);
    pan(after.x - before.x, after.y - before.y);
    zoom(after.distance / Math.max(before.distance, 1), after.x, after.y);
  };
  stage.onwheel = (event) => {
    event.preventDefault();
    const { x, y } = at(event);
    zoom(Math.exp(-(event.deltaMode ? 30 : 1) * event.deltaY / 400), x, y);
  };
  stage.ondblclick = (event) => { const { x, y } = at(event); zoom(event.shiftKey ? 0.5 : 2, x, y); };
};
const magnify = (link) => {
  const small = link.querySelector('img');
  const chart = link.closest('.chart');
  const shown = make('img', { alt: small.alt, draggable: false });
  // What is compressed here may lie beside the page in full.
  shown.onerror = () => { shown.onerror = null; shown.src = small.src; };
  shown.src = chart ? small.src : link.href;
  const stage = make('div', { className: 'stage', tabIndex: 0 }, shown);
  stage.setAttribute('aria-label', 'Enlarged figure: wheel, pinch or double click enlarge it, arrow keys move it');
  stage.setAttribute('role', 'group');
  gestures(stage);
  const state = make('span', { className: 'fine' });
  state.setAttribute('role', 'status');
  const bar = make('div', { className: 'bar' }, make('strong', { textContent: link.dataset.title }), state,
    button('−', 'Smaller', () => zoom(0.8)), button('+', 'Larger', () => zoom(1.25)), button('Fit', null, fit),
    button('1:1', 'True pixels', () => zoom(1 / view.scale)), button('Close', null, () => dialog.close()));
  dialog.replaceChildren(bar, stage);
  dialog.showModal();
  view = { stage, shown, state, size: ['width', 'height'].map((side) => Number(small.getAttribute(side))) };
  fit();
  stage.focus();
};
all('a.zoom').forEach((link) => {
  link.setAttribute('aria-haspopup', 'dialog');
  link.onclick = (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    magnify(link);
  };
});
const KEYS = {
  '+': () => zoom(1.25), '=': () => zoom(1.25), '-': () => zoom(0.8), '−': () => zoom(0.8), 0: fit, 1: () => zoom(1 / view.scale),
  ArrowLeft: () => pan(60, 0), ArrowRight: () => pan(-60, 0), ArrowUp: () => pan(0, 60), ArrowDown: () => pan(0, -60),
};
dialog.onkeydown = (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || !KEYS[event.key]) return;
  event.preventDefault();
  KEYS[event.key]();
};

// Copying: the command, without a trailing line break.
all('.again pre').forEach((block) => {
  const copy = button('Copy', `Copy: ${block.textContent}`, async () => {
    try {
      await navigator.clipboard.writeText(block.textContent);
      copy.textContent = 'Copied';
    } catch {
      getSelection().selectAllChildren(block);
      copy.textContent = 'Selected';
    }
    setTimeout(() => { copy.textContent = 'Copy'; }, 2000);
  });
  const row = make('div', { className: 'command' });
  block.replaceWith(row);
  row.append(block, copy);
});
