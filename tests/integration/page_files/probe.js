// Runs in the page: measures it, uses everything, and tells the page around it what is wrong.
const wrong = [];
addEventListener('error', (event) => wrong.push(`error: ${event.message || event.target.src || event.target.href}`.slice(0, 300)), true);
addEventListener('unhandledrejection', (event) => wrong.push(`rejected: ${event.reason}`));
addEventListener('load', async () => {
  const must = (good, what) => { if (!good) wrong.push(what); };
  const one = (selector) => document.querySelector(selector);
  const every = (selector) => [...document.querySelectorAll(selector)];
  // Not decode(), which a browser without a screen does not wait for before it reports.
  const loaded = (image) => image.complete || new Promise((done) => ['load', 'error'].forEach((e) => image.addEventListener(e, done)));
  const pause = () => new Promise((done) => setTimeout(done, 50));
  const key = (name) => one('.stage').dispatchEvent(new KeyboardEvent('keydown', { key: name, bubbles: true }));
  const input = (field, value) => {
    field.value = value;
    field.dispatchEvent(new Event('input'));
  };
  const shown = (selector) => every(selector).filter((element) => element.checkVisibility()).length;
  let [height, stops] = [0, 0];
  try {
    // As it opens: its height, and the places where the tab key stops
    for (const image of document.images) await loaded(image);
    await pause();
    height = document.documentElement.scrollHeight;
    stops = shown('a[href], button:enabled, input:enabled, select:enabled, summary, [tabindex="0"]');
    must(height <= 12000 || innerWidth < 1000, `${height} pixels tall`);
    must(stops <= 200, `${stops} tab stops`);
    // Nothing is wider than the window, all is loaded, every link leads somewhere
    every('details').forEach((details) => { details.open = true; });
    await pause();
    must(document.documentElement.scrollWidth <= innerWidth, `wider than ${innerWidth}: ${document.documentElement.scrollWidth}`);
    for (const table of every('table')) must(table.scrollWidth <= table.parentElement.clientWidth + 1, `a table wider than its frame of ${table.parentElement.clientWidth}`);
    for (const image of every('nav img, article img')) must(image.naturalWidth > 0, `no picture: ${image.alt}`);
    for (const link of every('a[href^="#"]')) must(document.getElementById(link.hash.slice(1)), `leads nowhere: ${link.hash}`);
    for (const field of every('input, select, button')) {
      must(field.textContent.trim() || field.labels?.length || field.getAttribute('aria-label'), `no name: ${field.outerHTML}`);
    }
    // Groups: one figure is seen, which the slider chooses, or an address
    for (const slider of every('.slider')) {
      const [range, figures] = [slider.querySelector('input'), [...slider.parentElement.querySelectorAll('.figure')]];
      for (const [i, figure] of figures.entries()) {
        input(range, i);
        must(figures.every((other) => other.checkVisibility() === (other === figure)), `the slider does not show ${figure.id}`);
      }
      for (const id of [figures[0].id, figures[1].dataset.id]) {
        location.hash = id;
        await pause();
        must(figures.find((figure) => figure.id.endsWith(id)).checkVisibility(), `#${id} does not lead to its figure`);
      }
    }
    // One figure per screen
    document.getElementById('screens').click();
    const title = () => one('#viewed').textContent;
    const first = title();
    must(one('dialog').open && document.activeElement === one('.stage'), 'no screen opens');
    key('ArrowRight');
    must(title() !== first, 'the next figure does not follow');
    key('PageUp');
    must(title() === first, 'the figure before does not come back');
    must(one('#caption').textContent.length > 40, 'a screen without caption');
    one('dialog').close();
    // Comparison
    const start = one('.start');
    start.click();
    await pause();
    must(one('.other').naturalWidth > 0, 'nothing is compared');
    input(document.getElementById('share'), 25);
    must(one('.pair').style.getPropertyValue('--at') === '25%', 'the slider does not move the edge');
    const modes = every('button[data-mode]');
    modes[1].click();
    must(getComputedStyle(one('.own')).mixBlendMode === 'difference', 'no difference');
    modes[0].click();
    must(modes.map((mode) => mode.getAttribute('aria-pressed')).join() === 'true,false,false', 'the mode is not marked');
    one('[data-do="lens"]').click();
    must(shown('.lens span') === 2, 'the magnifier does not show both');
    one('[data-do="lens"]').click();
    one('dialog').close();
    // Magnification: keys, wheel and double click
    for (const link of every('.figure:not([hidden]) .zoom')) {
      link.click();
      const [large, stage] = [one('.own'), one('.stage')];
      must(one('dialog').open && document.activeElement === stage, 'does not enlarge');
      await loaded(large);
      await pause();
      must(large.naturalWidth > 0, `not enlarged: ${large.alt}`);
      const before = large.clientWidth;
      must(Math.abs(before - stage.clientWidth) < 2 || Math.abs(large.clientHeight - stage.clientHeight) < 2, `does not fill the window: ${large.alt}`);
      key('+');
      must(large.clientWidth > before, `+ does not enlarge ${large.alt}`);
      key('0');
      must(Math.abs(large.clientWidth - before) < 2, '0 does not fit');
      stage.dispatchEvent(new WheelEvent('wheel', { deltaY: -100, clientX: 100, clientY: 200, cancelable: true }));
      must(large.clientWidth > before, 'the wheel does not enlarge');
      key('0');
      stage.dispatchEvent(new MouseEvent('dblclick', { clientX: 100, clientY: 200 }));
      must(Math.abs(large.clientWidth - 2 * before) < 4, 'a double click does not enlarge');
      const left = large.getBoundingClientRect().left;
      key('ArrowLeft');
      must(large.getBoundingClientRect().left > left, 'arrows do not move');
      one('dialog').close();
    }
    // Search
    const find = document.getElementById('find');
    const count = shown('article');
    input(find, 'CRITICAL  total internal');
    must(shown('article') === 1 && shown('#figure-fresnel-exit') === 1, `search shows ${shown('article')}`);
    must(shown('nav li') === 1, 'thumbnails that do not match stay');
    must(shown('section > h2') === 1, `${shown('section > h2')} headings stay`);
    input(find, 'Λ');
    must(shown('.wide tbody tr') === 1, `${shown('.wide tbody tr')} rows match`);
    input(find, '');
    document.getElementById('failed').click();
    must(shown('article') === 0, 'nothing has failed');
    document.getElementById('failed').click();
    must(shown('article') === count, 'not all are back');
    // What axe-core finds, light and dark, in the page and in the dialog
    const accessible = async (where) => {
      const found = window.axe ? await axe.run(document) : { violations: [] };
      for (const { id, nodes } of found.violations) wrong.push(`axe: ${id} (${where}), ${nodes.length} times, first ${nodes[0].html.slice(0, 150)}`);
    };
    await accessible('light');
    const colour = () => getComputedStyle(document.body).backgroundColor;
    const before = colour();
    document.getElementById('theme').click();
    must(colour() !== before, 'the theme stays');
    await accessible('dark');
    start.click();
    await pause();
    await accessible('dialog');
  } catch (error) {
    wrong.push(String(error));
  }
  parent.postMessage(`PROBED ${height} pixels, ${stops} stops [${wrong.join('; ')}]`, '*');
});
