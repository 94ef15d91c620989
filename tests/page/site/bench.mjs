// Figures of the page of static files, in one run beside popcutd's page: POPCUT_SITE=FOLDER POPCUTD=PROGRAM node
// bench.mjs. Prints one line for each, with its budget if it has one.
import { createHash } from 'node:crypto';
import { readdirSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { serve } from '../../../daemon/web/serve.mjs';
import { dragging, median, p95, revolution, say } from '../dragging.mjs';
import { closeBrowser, openBrowser, openModel, screens, Server, visit } from '../harness.mjs';
import { exact, house, open, start } from './visit.mjs';

const folder = process.env.POPCUT_SITE ?? 'build/site/page';
/** How long a person looks at the page before anything moves. */
const kLook_ms = 6000;
const server = await serve(folder);
const address = `http://127.0.0.1:${server.address().port}/`;

/** Keeps how long the engine works at each draft and exact preview, in `engineTimes`. */
function timeTheEngine() {
  const times = { draft: [], exact: [] };
  window.engineTimes = times;
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function timed(data, ...more) {
    const about = data.task ? new TextDecoder('latin1').decode(data.task.subarray(0, 600)) : '';
    const quality = about.includes('"name":"bench"') ? /"quality":"(draft|exact)"/.exec(about)?.[1] : undefined;   // not a rehearsal
    const begin = performance.now();
    if (quality) this.addEventListener('message', function done({ data: from }) {
      if (!from.done) return;
      this.removeEventListener('message', done);
      times[quality].push(performance.now() - begin);
    });
    return post.call(this, data, ...more);
  };
}

/** A search of a house with so many workers: how long it takes, s, and the sum of all that it found. */
async function search(workers) {
  const context = await (await openBrowser()).newContext({ viewport: screens.desktop, reducedMotion: 'reduce' });
  await context.addInitScript((count) => Object.defineProperty(Navigator.prototype, 'hardwareConcurrency', { get: () => count }), workers);
  const { page, close } = await open(address, { context });
  await start(page);
  await openModel(page, { name: 'house.obj', mimeType: 'application/octet-stream', buffer: house }, 'x');
  const begin = performance.now();
  await page.locator('.found-card').first().waitFor({ timeout: 600_000 });
  const seconds = (performance.now() - begin) / 1000;
  const files = await page.evaluate(() => new Promise((done) => {
    indexedDB.open('popcut').onsuccess = ({ target: { result } }) => {
      result.transaction('searches').objectStore('searches').getAll().onsuccess = ({ target }) => done(
        target.result.flatMap((one) => [...one.files].map(([name, bytes]) => [name, [...bytes].join()])));
    };
  }));
  await close();
  return { seconds, sum: createHash('sha256').update(JSON.stringify(files)).digest('hex'), files: files.length };
}

try {
  const brotli = (name) => { try { return statSync(join(folder, `${name}.br`)).size; } catch { return statSync(join(folder, name)).size; } };
  const files = readdirSync(join(folder, 'page')).filter((name) => !/\.(br|gz)$/.test(name) && !name.startsWith('licences-')).map((name) => `page/${name}`);
  say('all that is loaded, brotli', ['index.html', 'service_worker.js', 'manifest.webmanifest', ...files].reduce((sum, name) => sum + brotli(name), 0) / 1e6, 'MB', 3);

  const firsts = [];
  for (let round = 0; round < 5; round++) {
    const { page, close } = await open(address);
    const card = page.locator('.start-card:not(:disabled)', { hasText: /^heart$/ });
    await card.waitFor();
    const begin = performance.now();
    await card.click();
    await exact(page);
    firsts.push((performance.now() - begin) / 1000);
    await close();
  }
  say('first figures after the click, new browser, median of 5', median(firsts), 's', 2);

  const daemon = await Server.start();
  try {
    const spec = revolution(10, 50, 2);
    for (const where of ['popcutd', 'site']) {
      const visited = where === 'popcutd' ? await visit(daemon, {}) : await open(address, { hash: '#/settings', beforehand: timeTheEngine });
      const engine = { draft: [], exact: [] };
      const close = async () => {
        if (where === 'site') Object.assign(engine, await visited.page.evaluate(() => window.engineTimes));
        await visited.close();
      };
      if (where === 'popcutd') visited.page.on('requestfinished', (request) => {
        const quality = /"quality":"(draft|exact)"/.exec(request.postData() ?? '')?.[1];
        if (quality) engine[quality].push(request.timing().responseEnd);
      });
      const { times, exact: rest } = await dragging({ page: visited.page, close }, spec, 8, kLook_ms);
      const what = `500 units, ${where}: `;
      say(`${what}draft, asked and answered, median`, median(engine.draft), 'ms', 60);
      say(`${what}exact, asked and answered, the first`, engine.exact[0], 'ms', null);
      say(`${what}exact, asked and answered, median of ${engine.exact.length}`, median(engine.exact), 'ms', 400);
      say(`${what}input to picture, ${times.length} of 60, median`, median(times), 'ms', null);
      say(`${what}input to picture, p95`, p95(times), 'ms', null);
      say(`${what}exact after rest`, rest, 'ms', null);
    }
  } finally {
    await daemon.remove();
  }

  const found = [];
  for (const workers of [1, 2]) {
    found.push(await search(workers));
    say(`search of a house, ${workers} worker${workers > 1 ? 's' : ''}`, found.at(-1).seconds, 's', null);
  }
  const [one, two] = found;
  console.log(`${one.files} files of the cards: ${one.sum === two.sum ? 'the same' : 'DIFFERENT'}; with two workers ${(one.seconds / two.seconds).toFixed(2)} times as fast`);
} finally {
  await closeBrowser();
  server.closeAllConnections();
  server.close();
}
