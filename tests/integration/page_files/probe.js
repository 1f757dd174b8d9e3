// Runs in the page: uses everything, and leaves what is wrong in the document's title.
const wrong = [];
addEventListener('error', (event) => wrong.push(`error: ${event.message || event.target.src || event.target.href}`.slice(0, 300)), true);
addEventListener('unhandledrejection', (event) => wrong.push(`rejected: ${event.reason}`));
addEventListener('load', async () => {
  const must = (good, what) => { if (!good) wrong.push(what); };
  // Not decode(), which a browser without a screen does not wait for before it reports.
  const loaded = (image) => image.complete || new Promise((done) => ['load', 'error'].forEach((e) => image.addEventListener(e, done)));
  const pause = () => new Promise((done) => setTimeout(done, 50));
  const key = (name) => document.querySelector('dialog').dispatchEvent(new KeyboardEvent('keydown', { key: name, bubbles: true }));
  try {
    const compare = document.querySelectorAll('details.compare');
    must(compare.length === 2, `${compare.length} comparisons`);
    compare.forEach((details) => { details.open = true; });
    await pause();
    const range = document.querySelector('.slide input');
    range.value = 25;
    range.dispatchEvent(new Event('input'));
    must(document.querySelector('.pair').style.getPropertyValue('--at') === '25%', 'the slider does not move the edge');
    for (const image of document.images) {
      await loaded(image);
      must(image.naturalWidth > 0 && image.clientWidth > 0, `no picture: ${image.alt}`);
    }
    for (const link of document.querySelectorAll('a[href^="#"]')) {
      must(document.getElementById(link.hash.slice(1)), `leads nowhere: ${link.hash}`);
    }
    must(document.documentElement.scrollWidth <= innerWidth, `wider than ${innerWidth}: ${document.documentElement.scrollWidth}`);
    for (const zoom of document.querySelectorAll('a.zoom')) {
      zoom.click();
      const [dialog, large] = [document.querySelector('dialog'), document.querySelector('dialog img')];
      must(dialog.open, 'does not enlarge');
      await loaded(large);
      await pause();
      must(large.naturalWidth > 0, `not enlarged: ${large.alt}`);
      const before = large.clientWidth;
      key('+');
      must(large.clientWidth > before, `+ does not enlarge ${large.alt}`);
      key('0');
      must(Math.abs(large.clientWidth - before) < 2, '0 does not fit');
      dialog.close();
    }
    const shown = () => [...document.querySelectorAll('article')].filter((article) => article.clientHeight > 0).length;
    const find = document.getElementById('find');
    find.value = 'CRITICAL  exit';
    find.dispatchEvent(new Event('input'));
    must(shown() === 1, `search shows ${shown()}`);
    find.value = '';
    document.getElementById('failed').click();
    must(shown() === 0, 'nothing has failed');
    document.getElementById('failed').click();
    must(shown() === 4, 'not all are back');
    const colour = () => getComputedStyle(document.body).backgroundColor;
    const first = colour();
    document.getElementById('theme').click();
    must(colour() !== first, 'the theme stays');
  } catch (error) {
    wrong.push(String(error));
  }
  document.title = `PROBED[${wrong.join('; ')}]`;
});
