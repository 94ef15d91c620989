// Speed of the page in a real browser against a real popcutd: `./run bench page`. Prints one line for each figure, with
// its budget if it has one; a figure over its budget is marked, and the exit code is still 0: times are looked at by people.
import { readFileSync } from 'node:fs';
import { closeBrowser, ladder, machineHash, openBrowser, Server, until, visit, wait } from './harness.mjs';
import { dragging, median, p95, revolution, say } from './dragging.mjs';
import { staircaseBlob } from './fixtures/staircase.mjs';
import { bundled } from './sources.mjs';

async function deploying(page, strips, steps) {
  return page.evaluate(async ({ base64 }) => {
    const { readLattice, ModelView } = await import('/page/bench-model.js');
    const canvas = document.createElement('canvas');
    Object.assign(canvas.style, { position: 'fixed', inset: '0', width: '1024px', height: '768px', zIndex: '9' });
    document.body.append(canvas);
    const view = new ModelView(canvas);
    view.setLattice(readLattice(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer));
    view.pixels();
    const gl = canvas.getContext('webgl2');
    const times = [];
    for (let i = 0; i < 40; i++) {
      const start = performance.now();
      view.setPsi(Math.PI * (1 - (0.5 * i) / 40));
      view.drawNow();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      times.push(performance.now() - start);
    }
    view.dispose();
    canvas.remove();
    return times;
  }, { base64: Buffer.from(staircaseBlob({ strips, steps, step: 1, strip: 1, margin: 5 })).toString('base64') });
}

/** The histogram of how long a stream waited for its turn: {most_s, count} up to there. */
async function streamWaits(server) {
  const { body } = await server.ask('GET', '/metrics');
  return [...body.matchAll(/^popcut_stream_wait_seconds_bucket\{[^}]*le="([^"]+)"\} (\d+)/gm)]
    .map(([, most, count]) => ({ most_s: most === '+Inf' ? Infinity : Number(most), count: Number(count) }));
}

const server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 5 }] });
try {
  const sizes = (() => {
    try { return JSON.parse(readFileSync(new URL('../../daemon/web/dist/sizes.json', import.meta.url), 'utf8')); } catch { return null; }
  })();
  if (sizes) {
    const sum = (list) => list.reduce((all, one) => all + one.gzip, 0) / 1000;
    say('shell, gzip', sum(sizes.shell), 'kB', 50);
    say('three and the model, gzip', sum(sizes.all.filter((one) => one.inputs.some((name) => name.includes('node_modules/three/')))), 'kB', 160);
    say('all scripts, gzip', sum(sizes.all.filter((one) => one.path.endsWith('.js'))), 'kB', 300);
  }
  const browser = await openBrowser();
  const paints = [];
  for (let i = 0; i < 9; i++) {
    const context = await browser.newContext();
    const page = await context.newPage();
    await page.goto(server.address);
    paints.push(await page.evaluate(() => new Promise((done) => {
      new PerformanceObserver((list) => {
        for (const one of list.getEntriesByName('first-contentful-paint')) done(one.startTime);
      }).observe({ type: 'paint', buffered: true });
    })));
    await context.close();
  }
  say('first view, 9 cold contexts, median', median(paints), 'ms', 1000);

  for (const [units, slices, width] of [[10, 50, 2], [20, 100, 1]]) {
    const exacts = [];
    const times = [];
    const tasks = [];
    for (let round = 0; round < 3; round++) {
      const one = await dragging(await visit(server, {}), revolution(units, slices, width));
      exacts.push(one.exact);
      times.push(...one.times);
      tasks.push(...one.tasks);
    }
    const what = `${units * slices} units: `;
    say(`${what}input to picture, ${times.length} of 180, median`, median(times), 'ms', 100);
    say(`${what}input to picture, p95`, p95(times), 'ms', 100);
    say(`${what}exact after rest, worst of 3`, Math.max(...exacts), 'ms', units * slices === 500 ? 500 : null);
    say(`${what}longest task while dragging`, Math.max(0, ...tasks), 'ms', 50);
  }

  const { page, close } = await visit(server, { screen: { width: 1024, height: 768 } });
  await page.route('**/page/bench-model.js', async (route) => route.fulfill({ contentType: 'text/javascript', body: await bundled('lattice.ts', 'model_view.ts') }));
  say('deploying 10 000 panels, 40 poses', 1000 / median(await deploying(page, 50, 100)), 'fps', 30, true);
  say('deploying 100 000 panels, 40 poses', 1000 / median(await deploying(page, 200, 250)), 'fps', 10, true);
  await close();

  const watch = await visit(server, {});
  await watch.page.locator('.live-on').waitFor();
  const seen = [];
  for (let i = 0; i < 12; i++) {
    const name = `seen-${i}`;
    const shown = watch.page.evaluate((text) => new Promise((done) => {
      const look = () => {
        if (document.body.textContent.includes(text)) requestAnimationFrame(() => done(Date.now()));
        else setTimeout(look, 4);
      };
      look();
    }), name);
    const { id } = await server.must('POST', '/v1/designs', ladder(3), { headers: { 'Content-Type': 'image/svg+xml' } });
    await server.must('POST', '/v1/jobs', { design: id, name, device: 'sim:cameo3' }, { headers: { 'Idempotency-Key': crypto.randomUUID() } });
    const told = Date.now();
    seen.push(Math.max(0, (await shown) - told));
  }
  say('event to picture, p95', p95(seen), 'ms', 150);
  await watch.close();

  for (const job of (await server.must('GET', '/v1/queue')).items) {
    await until(async () => (await server.job(job.id)).state === 'ready', 'planned');
    await server.act(job.id, 'cancel');
  }
  const job = await server.queue(ladder(60), { name: 'pause' });
  const machine = await visit(server, { hash: machineHash() });
  await server.cut(job.id);
  await machine.page.locator('.pause-big').waitFor();
  const tap = await machine.page.evaluate(() => new Promise((done) => {
    const send = window.fetch;
    let pressed = 0;
    addEventListener('pointerdown', () => { pressed = performance.now(); }, { capture: true, once: true });
    window.fetch = (...asked) => {
      if (String(asked[0]).includes('/actions/pause')) done(performance.now() - pressed);
      return send(...asked);
    };
    setTimeout(() => document.querySelector('.pause-big').dispatchEvent(new PointerEvent('pointerdown', { bubbles: true, isPrimary: true, button: 0, pointerId: 1 })), 100);
  }));
  say('tap on Pause to request', tap, 'ms', 50);
  await machine.close();
  await server.state(job.id, ['paused', 'done'], 60_000);
  if ((await server.job(job.id)).state === 'paused') await server.act(job.id, 'resume');
  await server.state(job.id, 'done', 120_000);

  // What is recorded before each path waits for the disk: so the same cut without a page comes first.
  for (const pages of [0, 20]) {
    const open = [];
    for (let i = 0; i < pages; i++) open.push(await visit(server, { role: 'viewer', name: `page-${i}`, hash: i % 2 === 0 ? '' : machineHash() }));
    const one = await server.queue(ladder(60), { name: 'beside' });
    const before = await streamWaits(server);
    await server.cut(one.id);
    await server.state(one.id, 'done', 120_000);
    const waits = (await streamWaits(server)).map(({ most_s, count }, i) => ({ most_s, count: count - before[i].count }));
    const longest = waits.find(({ count }) => count === waits.at(-1).count).most_s;
    say(`a stream's longest wait of ${waits.at(-1).count} beside ${pages} pages, at most`, 1000 * longest, 'ms', pages === 0 ? null : 50);
    for (const page of open) await page.close();
  }
} finally {
  await closeBrowser();
  await server.remove();
}
