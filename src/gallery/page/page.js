// What the page can do beyond being read: theme, search, comparison, magnification, copying.
'use strict';
const root = document.documentElement;
root.classList.add('js');
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
const contents = document.querySelector('nav details');
const wide = matchMedia('(min-width: 62rem)');
contents.open = wide.matches;
wide.onchange = () => { contents.open = wide.matches; };

// Search: all words, in everything that a figure says.
const find = document.getElementById('find');
const failed = document.getElementById('failed');
const articles = all('article');
const texts = articles.map((article) => article.textContent.toLowerCase());
const filter = () => {
  const words = find.value.toLowerCase().split(/\s+/);
  let shown = 0;
  articles.forEach((article, i) => {
    const wanted = words.every((word) => texts[i].includes(word)) && !(failed.checked && article.dataset.failed === '0');
    article.hidden = !wanted;
    shown += wanted ? 1 : 0;
  });
  const hidden = new Set(articles.filter((article) => article.hidden).map((article) => article.dataset.id));
  all('nav li').forEach((item) => { item.hidden = hidden.has(item.dataset.id); });
  all('main section').forEach((section) => {
    const inside = all('article', section);
    section.hidden = inside.length > 0 && inside.every((article) => article.hidden);
  });
  const filtered = find.value.trim() !== '' || failed.checked;
  document.getElementById('found').textContent = filtered ? `${shown} of ${articles.length} figures` : '';
};
find.oninput = filter;
failed.onchange = filter;
// A link leads to its figure even when the search has hidden that.
addEventListener('hashchange', () => {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (target?.hidden) {
    find.value = '';
    failed.checked = false;
    filter();
    target.scrollIntoView();
  }
});

// Comparison: a figure over its counterpart, cut at the slider. The pictures are those of the two figures.
const pictureOf = (id) => document.getElementById(`figure-${id}`).querySelector('figure img');
const slider = (left, right) => {
  const over = make('img', { className: 'over', src: pictureOf(left).src, alt: '' });
  const under = make('img', { src: pictureOf(right).src, alt: `${left} to the left of ${right}` });
  const pair = make('div', { className: 'pair' }, under, over, make('span', { className: 'edge' }));
  pair.style.maxWidth = `${pictureOf(right).width}px`;
  const range = make('input', { type: 'range', min: 0, max: 100, value: 50, step: 1 });
  range.setAttribute('aria-label', `Share of ${left} that covers ${right}, in percent`);
  const move = () => pair.style.setProperty('--at', `${range.value}%`);
  range.oninput = move;
  move();
  const drag = (event) => {
    const box = pair.getBoundingClientRect();
    range.value = 100 * (event.clientX - box.left) / box.width;
    move();
  };
  pair.onpointerdown = (event) => { pair.setPointerCapture(event.pointerId); drag(event); };
  pair.onpointermove = (event) => { if (pair.hasPointerCapture(event.pointerId)) drag(event); };
  const names = [left, right].map((id) => make('span', { className: 'fine', textContent: id }));
  return [pair, make('div', { className: 'slide' }, names[0], range, names[1])];
};
articles.filter((article) => article.dataset.beside).forEach((article) => {
  const { id, beside } = article.dataset;
  const summary = make('summary', { textContent: `Compare with ${beside}` });
  const details = make('details', { className: 'compare' }, summary);
  details.addEventListener('toggle', () => { if (details.open) details.append(...slider(id, beside)); }, { once: true });
  article.querySelector('.beside').replaceWith(details);
});

// Magnification: + and − about the middle, 0 to fit, arrows and dragging to move, Escape to close.
const dialog = document.querySelector('dialog');
let view = null;
const resize = (factor) => {
  const { stage, picture } = view;
  const middle = [(stage.scrollLeft + stage.clientWidth / 2) / stage.scrollWidth,
    (stage.scrollTop + stage.clientHeight / 2) / stage.scrollHeight];
  view.scale = factor === 0 ? 1 : Math.min(16, Math.max(0.25, view.scale * factor));
  picture.style.width = `${view.fit * view.scale}px`;
  stage.scrollLeft = middle[0] * stage.scrollWidth - stage.clientWidth / 2;
  stage.scrollTop = middle[1] * stage.scrollHeight - stage.clientHeight / 2;
  view.state.textContent = `${Math.round(100 * view.scale)} %`;
};
const magnify = (link) => {
  const shown = link.querySelector('img');
  const picture = make('img', { alt: shown.alt, draggable: false });
  // What is compressed here may lie beside the page in full.
  picture.onerror = () => { picture.onerror = null; picture.src = shown.src; };
  picture.src = shown.dataset.vector === 'true' ? shown.src : link.href;
  const stage = make('div', { className: 'stage', tabIndex: 0 }, picture);
  stage.setAttribute('aria-label', 'Enlarged figure: arrow keys move it');
  stage.setAttribute('role', 'group');
  stage.onpointermove = (event) => {
    if (event.buttons === 1 && event.pointerType === 'mouse') stage.scrollBy(-event.movementX, -event.movementY);
  };
  const state = make('span', { className: 'fine' });
  state.setAttribute('role', 'status');
  const bar = make('div', { className: 'bar' }, make('strong', { textContent: link.dataset.title }), state,
    button('−', 'Smaller', () => resize(0.8)), button('0', 'Fit', () => resize(0)),
    button('+', 'Larger', () => resize(1.25)), button('Close', null, () => dialog.close()));
  dialog.replaceChildren(bar, stage);
  dialog.showModal();
  const [w, h] = ['width', 'height'].map((side) => Number(shown.getAttribute(side)));
  view = { stage, picture, state, scale: 1, fit: Math.min(stage.clientWidth - 10, (stage.clientHeight - 10) * w / h) };
  resize(0);
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
dialog.onkeydown = (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const factor = { '+': 1.25, '=': 1.25, '-': 0.8, '−': 0.8, 0: 0 }[event.key];
  if (factor === undefined) return;
  event.preventDefault();
  resize(factor);
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
