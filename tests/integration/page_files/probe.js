// Runs in the page: uses everything, and tells the page around it what is wrong.
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
  const key = (name) => one('dialog').dispatchEvent(new KeyboardEvent('keydown', { key: name, bubbles: true }));
  try {
    // Nothing is wider than the window, all is loaded, every link leads somewhere
    every('details').forEach((details) => { details.open = true; });
    await pause();
    must(document.documentElement.scrollWidth <= innerWidth, `wider than ${innerWidth}: ${document.documentElement.scrollWidth}`);
    for (const table of every('table')) must(table.scrollWidth <= table.parentElement.clientWidth, `a table wider than its frame of ${table.parentElement.clientWidth}`);
    for (const image of document.images) {
      await loaded(image);
      must(image.naturalWidth > 0 && image.clientWidth > 0, `no picture: ${image.alt}`);
    }
    // An image is complete before its load event, which gives the comparison its width
    await pause();
    for (const link of every('a[href^="#"]')) must(document.getElementById(link.hash.slice(1)), `leads nowhere: ${link.hash}`);
    for (const field of every('input, select, button')) {
      must(field.textContent.trim() || field.labels?.length || field.getAttribute('aria-label'), `no name: ${field.outerHTML}`);
    }
    // Comparison
    const compare = every('details.compare');
    must(compare.length === 2, `${compare.length} comparisons`);
    const range = one('.compare input');
    range.value = 25;
    range.dispatchEvent(new Event('input'));
    must(one('.pair').style.getPropertyValue('--at') === '25%', 'the slider does not move the edge');
    must(Math.abs(range.clientWidth - one('.pair').clientWidth) < 2, 'the slider is not as wide as the image');
    const modes = [...compare[0].querySelectorAll('button')];
    modes[1].click();
    must(one('.pair').dataset.mode === 'difference' && getComputedStyle(one('.pair .over')).mixBlendMode === 'difference', 'no difference');
    modes[0].click();
    must(modes.map((mode) => mode.getAttribute('aria-pressed')).join() === 'true,false,false', 'the mode is not marked');
    // Magnification: keys, wheel and double click
    for (const link of every('a.zoom')) {
      link.click();
      const [dialog, large, stage] = [one('dialog'), one('dialog img'), one('.stage')];
      must(dialog.open && document.activeElement === stage, 'does not enlarge');
      await loaded(large);
      await pause();
      must(large.naturalWidth > 0, `not enlarged: ${large.alt}`);
      const before = large.clientWidth;
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
      dialog.close();
    }
    // Search
    const shown = (selector) => every(selector).filter((element) => element.clientHeight > 0).length;
    const count = shown('article');
    const find = document.getElementById('find');
    find.value = 'CRITICAL  exit';
    find.dispatchEvent(new Event('input'));
    must(shown('article') === 1, `search shows ${shown('article')}`);
    must(shown('.tiles li') === 1 && shown('nav li') <= 1, 'thumbnails that do not match stay');
    must(shown('section > .panel tbody tr') === 0, 'rows that do not match stay');
    must(shown('h2') === 2, `${shown('h2')} headings stay`);
    find.value = '';
    find.dispatchEvent(new Event('input'));
    document.getElementById('failed').click();
    must(shown('article') === 0, 'nothing has failed');
    document.getElementById('failed').click();
    must(shown('article') === count, 'not all are back');
    // What axe-core finds, light and dark
    const accessible = async () => {
      const found = window.axe ? await axe.run(document) : { violations: [] };
      for (const { id, nodes } of found.violations) wrong.push(`axe: ${id}, ${nodes.length} times, first ${nodes[0].html.slice(0, 150)}`);
    };
    await accessible();
    // Theme
    const colour = () => getComputedStyle(document.body).backgroundColor;
    const first = colour();
    document.getElementById('theme').click();
    must(colour() !== first, 'the theme stays');
    await accessible();
  } catch (error) {
    wrong.push(String(error));
  }
  parent.postMessage(`PROBED[${wrong.join('; ')}]`, '*');
});
