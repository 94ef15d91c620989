// The page of static files in a browser: the maker's whole way, from a plain server and without one.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, renameSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { chromium } from 'playwright-core';
import { serve } from '../../../daemon/web/serve.mjs';
import { bytesOf, closeBrowser, drawn, launchOptions, openBrowser, openModel, picture, screens, Server, until, visit, wait } from '../harness.mjs';
import { begin, exact, house, keptWhole, open as openAt, start } from './visit.mjs';

const folder = process.env.POPCUT_SITE ?? 'build/site/page';
let server;
let address;

before(async () => {
  server = await serve(folder);
  address = `http://127.0.0.1:${server.address().port}/`;
});
after(async () => {
  await closeBrowser();
  server.closeAllConnections();
  server.close();
});

const open = ({ base = address, ...how } = {}) => openAt(base, how);

function ended(of, around) {
  of.closeAllConnections();
  of.close();
  rmSync(around, { recursive: true });
}

async function saved(page, press) {
  const [download] = await Promise.all([page.waitForEvent('download'), press()]);
  return { name: download.suggestedFilename(), bytes: await bytesOf(download) };
}

test('an example is designed, made in every way, planned and folded', async () => {
  const { page, complaints, close } = await open();
  await begin(page, 'heart');
  await picture(page, 'site-design');
  await page.getByRole('button', { name: 'Make it…' }).click();
  await picture(page, 'site-make');
  const wanted = [['By hand', /sheets\.pdf$/, '%PDF-'], ['Cricut', /cricut\.svg$/, '<?xml'], ['Silhouette Studio', /\.dxf$/, ''], ['LightBurn', /\.svg$/, '<?xml']];
  for (const [way, name, head] of wanted) {
    await page.locator('.make-choice', { hasText: way }).click();
    const file = await saved(page, () => page.locator('.made-files button').first().click());
    assert.match(file.name, name);
    assert.ok(file.bytes.length > 500 && file.bytes.toString('latin1', 0, 9).startsWith(head), `${way}: ${file.name}`);
    if (way === 'By hand') await picture(page, 'site-by-hand');
    await page.getByRole('button', { name: 'Other ways' }).click();
  }
  await page.locator('.make-more summary').click();
  for (const [label, name] of [['(FOLD)', /fold$/], ['(GLB)', /glb$/], ['for CAD (DXF)', /dxf$/], ['step by step', /json$/]]) {
    const file = await saved(page, () => page.locator('.export', { hasText: label }).click());
    assert.match(file.name, name);
  }
  await page.getByRole('button', { name: 'Close' }).click();
  await page.getByRole('button', { name: 'Plan the sheets…' }).click();
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  await page.locator('.sheets .facts').waitFor();
  assert.match(await page.locator('.sheets .facts').innerText(), /Paper, 220 gsm/);
  assert.equal(await page.getByRole('button', { name: 'Queue it' }).count(), 0);
  await picture(page, 'site-sheets');
  await page.getByRole('link', { name: /fold/i }).first().click();
  await page.locator('.fold-acts').waitFor();
  await page.getByRole('button', { name: 'Next' }).click();
  await picture(page, 'site-fold');
  assert.deepEqual(complaints, []);
  await close();
});

test('a word stands up; a link with it opens at popcutd, and one of popcutd here', async () => {
  const { page, context, complaints, close } = await open();
  await start(page);
  await page.locator('.start-word input').fill('ANNA');
  await page.locator('.start-word button').click();
  await exact(page);
  await page.getByRole('button', { name: 'Share' }).click();
  const link = await page.getByRole('dialog').locator('input, textarea').first().inputValue();
  assert.ok(link.startsWith(`${address}#/design/d=`), link);
  const daemon = await Server.start();
  try {
    const there = await visit(daemon, { hash: link.slice(link.indexOf('#')), beside: '' });
    await there.page.locator('.badge-exact').waitFor();
    assert.match(await there.page.locator('.design-name').inputValue(), /ANNA/);
    await there.close();
  } finally {
    await daemon.remove();
  }
  const back = await open({ context, hash: link.slice(link.indexOf('#')) });
  await exact(back.page);
  assert.deepEqual([...complaints, ...back.complaints], []);
  await close();
});

test('a model is searched for cards, called off, searched again, and the card that is taken is printed', async () => {
  const { page, complaints, close } = await open();
  await start(page);
  await openModel(page, { name: 'house.obj', mimeType: 'application/octet-stream', buffer: house }, 'x');
  await page.getByRole('progressbar', { name: 'Searching for the best cards' }).waitFor();
  await picture(page, 'site-search');
  await page.getByRole('button', { name: 'Cancel' }).click();
  assert.equal(await page.getByRole('progressbar').count(), 0);
  await page.getByRole('button', { name: 'Find the best cards' }).click();
  await page.locator('.found-card').first().waitFor({ timeout: 300_000 });
  assert.ok(await page.locator('.found-card:has(.found-make)').count() === 1);
  await until(() => page.locator('.found-card img').count(), 'the cards have pictures');
  await exact(page);
  await picture(page, 'site-cards');
  await page.getByRole('button', { name: 'Make it…' }).click();
  await page.locator('.make-choice', { hasText: 'Print a picture on it' }).click();
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  const file = await saved(page, () => page.getByRole('button', { name: 'Page to print (PDF)' }).click());
  assert.equal(file.bytes.toString('latin1', 0, 5), '%PDF-');
  assert.deepEqual(complaints, []);
  await close();
});

test('what was made is kept over a restart, carried elsewhere as one file, and deleted', async () => {
  const first = await open();
  await begin(first.page, 'unit');
  await first.page.getByRole('button', { name: 'Make it…' }).click();
  await first.page.locator('.make-choice', { hasText: 'By hand' }).click();
  await first.page.locator('.made-files button').first().waitFor();
  const again = await open({ context: first.context, hash: '#/settings' });   // another tab
  await again.page.locator('.settings .plain-list a').first().waitFor();
  const all = await saved(again.page, () => again.page.getByRole('button', { name: 'Save everything' }).click());
  await picture(again.page, 'site-kept');
  await first.close();

  const other = await open({ hash: '#/settings' });
  await other.page.getByText('Nothing yet').waitFor();
  await other.page.locator('.settings input[type=file]').setInputFiles({ name: 'x.zip', mimeType: 'application/zip', buffer: Buffer.from('nothing') });
  await other.page.locator('.note-bad', { hasText: 'no file that popcut keeps' }).waitFor();
  await other.page.locator('.settings input[type=file]').setInputFiles({ name: all.name, mimeType: 'application/zip', buffer: all.bytes });
  await other.page.locator('.settings .plain-list a').first().click();
  await exact(other.page);
  await other.page.goto(`${address}#/settings`);
  await other.page.getByRole('button', { name: 'Delete everything' }).click();
  await other.page.getByRole('dialog').getByRole('button', { name: 'Delete everything' }).click();
  await other.page.getByText('Nothing yet').waitFor();
  assert.deepEqual([...first.complaints, ...again.complaints, ...other.complaints], []);
  await other.close();
});

test('after the first load it works without a network', async () => {
  const { page, context, complaints, close } = await open();
  await start(page);
  await keptWhole(page);
  await page.reload();
  await context.setOffline(true);
  await page.reload();
  await begin(page, 'village');
  await page.getByRole('button', { name: 'Plan the sheets…' }).click();
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  await page.locator('.sheets .facts').waitFor();
  await page.goto(`${address}#/settings`);
  await page.getByText('What this browser keeps').waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

/** Makes the pages of a design, and waits for what is said of the store. */
async function makesAnyway(page, words) {
  await page.getByRole('button', { name: 'Make it…' }).click();
  await page.locator('.make-choice', { hasText: 'By hand' }).click();
  const file = await saved(page, () => page.locator('.made-files button').first().click());
  assert.equal(file.bytes.toString('latin1', 0, 5), '%PDF-');
  await page.locator('.band', { hasText: words }).waitFor();
}

test('a browser whose disk is full says so, and what is open stays', async () => {
  const { page, context, complaints, close } = await open();
  await begin(page, 'unit');
  const devtools = await context.newCDPSession(page);
  await devtools.send('Storage.overrideQuotaForOrigin', { origin: new URL(address).origin, quotaSize: 1 });
  await makesAnyway(page, 'no room left');
  await page.reload();
  await page.getByRole('button', { name: 'Go on with your last design' }).click();
  await exact(page);
  assert.equal(await page.locator('.design-name').inputValue(), 'unit');
  assert.deepEqual(complaints, []);
  await close();
});

test('a browser that may keep no data of sites says so, and what is open stays', async (t) => {
  const profile = mkdtempSync(join(tmpdir(), 'popcut-profile-'));
  t.after(() => rmSync(profile, { recursive: true, force: true }));
  mkdirSync(join(profile, 'Default'));
  const kBlock = 2;
  writeFileSync(join(profile, 'Default/Preferences'), JSON.stringify({ profile: { default_content_setting_values: { cookies: kBlock } } }));
  const context = await chromium.launchPersistentContext(profile, { ...launchOptions, viewport: screens.desktop, reducedMotion: 'reduce' });
  const { page, complaints, close } = await open({ context });
  await begin(page, 'unit');
  await makesAnyway(page, 'keeps nothing');
  assert.deepEqual(complaints, []);
  await close();
});

test('a browser that has no store for designs says so, and what is open stays', async () => {
  const context = await (await openBrowser()).newContext({ viewport: screens.desktop, reducedMotion: 'reduce' });
  await context.addInitScript(() => { IDBFactory.prototype.open = () => { throw new DOMException('no', 'SecurityError'); }; });
  const { page, complaints, close } = await open({ context });
  await begin(page, 'unit');
  await makesAnyway(page, 'keeps nothing');
  assert.deepEqual(complaints, []);
  await close();
});

test('a model that is too large for this computer is refused with what fits', async () => {
  const context = await (await openBrowser()).newContext({ viewport: screens.phone, reducedMotion: 'reduce' });
  await context.addInitScript(() => Object.defineProperty(Navigator.prototype, 'deviceMemory', { get: () => 0.25 }));
  const { page, complaints, close } = await open({ context });
  await begin(page, 'unit');
  await page.locator('.design-drop > input[type=file]').setInputFiles({ name: 'large.stl', mimeType: 'model/stl', buffer: Buffer.alloc(5 << 20) });
  await page.locator('.note-bad', { hasText: '"large.stl" is larger than 4 MiB, which is what fits here' }).waitFor();
  const dense = Buffer.from(`v 0 0 0\nv 9 0 0\nv 0 9 9\n${'f 1 2 3\n'.repeat(90_000)}`);
  await page.locator('.design-drop > input[type=file]').setInputFiles({ name: 'dense.obj', mimeType: 'model/obj', buffer: dense });
  await page.locator('.note-bad', { hasText: /"dense.obj" has 90.000 triangles, and 83.886 fit here: make it simpler/ }).waitFor();
  assert.equal(await page.locator('.design-name').inputValue(), 'unit');
  assert.deepEqual(complaints, []);
  await close();
});

/** A wavy sheet of 2 * `side`^2 triangles, as a GLB. */
function denseGlb(side) {
  const corners = side + 1;
  const place = new Float32Array(3 * corners ** 2);
  const index = new Uint32Array(6 * side ** 2);
  for (let i = 0; i < corners; i++) for (let j = 0; j < corners; j++) place.set([i / 10, j / 10, Math.sin(i / 50) * Math.cos(j / 50)], 3 * (i * corners + j));
  for (let i = 0; i < side; i++) {
    for (let j = 0; j < side; j++) {
      const at = i * corners + j;
      index.set([at, at + corners, at + corners + 1, at, at + corners + 1, at + 1], 6 * (i * side + j));
    }
  }
  const chunk = (kind, bytes) => {
    const head = Buffer.alloc(8);
    head.writeUInt32LE(bytes.length, 0);
    head.write(kind, 4, 'latin1');
    return Buffer.concat([head, bytes]);
  };
  const bin = Buffer.concat([Buffer.from(place.buffer), Buffer.from(index.buffer)]);
  const json = JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    buffers: [{ byteLength: bin.length }], bufferViews: [{ buffer: 0, byteLength: place.byteLength }, { buffer: 0, byteOffset: place.byteLength, byteLength: index.byteLength }],
    accessors: [{ bufferView: 0, componentType: 5126, count: corners ** 2, type: 'VEC3', min: [0, 0, -1], max: [side / 10, side / 10, 1] },
      { bufferView: 1, componentType: 5125, count: index.length, type: 'SCALAR' }],
  });
  const body = Buffer.concat([chunk('JSON', Buffer.from(json.padEnd(4 * Math.ceil(json.length / 4)))), chunk('BIN\0', bin)]);
  const head = Buffer.from('glTF\x02\0\0\0\0\0\0\0', 'latin1');
  head.writeUInt32LE(head.length + body.length, 8);
  return Buffer.concat([head, body]);
}

test('on a phone a model of two million triangles is refused with the number that fits', async (t) => {
  const models = mkdtempSync(join(tmpdir(), 'popcut-dense-'));
  t.after(() => rmSync(models, { recursive: true }));
  const { width, height, touch } = screens.phone;
  const context = await (await openBrowser()).newContext({ viewport: { width, height }, hasTouch: touch, reducedMotion: 'reduce' });
  await context.addInitScript(() => Object.defineProperty(Navigator.prototype, 'deviceMemory', { get: () => 4 }));
  const { page, complaints, close } = await open({ context });
  await begin(page, 'unit');
  const whole = await page.evaluate(() => sessionStorage.getItem('popcut.design.steps'));
  for (const [name, bytes, words] of [
    ['dense.stl', Buffer.alloc(84 + 50 * 2_000_000), '"dense.stl" is larger than 64 MiB, which is what fits here'],
    ['dense.glb', denseGlb(1000), /"dense.glb" has 2.000.000 triangles, and 1.342.177 fit here: make it simpler/],
  ]) {
    writeFileSync(join(models, name), bytes);
    await page.locator('.design-drop > input[type=file]').setInputFiles(join(models, name));
    await page.locator('.note-bad', { hasText: words }).waitFor();
    assert.equal(await page.locator('.note-bad').count(), 1);
  }
  assert.equal(await page.locator('.design-name').inputValue(), 'unit');
  assert.equal(await page.evaluate(() => sessionStorage.getItem('popcut.design.steps')), whole);
  assert.deepEqual(complaints, []);
  await close();
});

test('without WebGL a model is asked about in words, and the card is painted', async () => {
  const context = await (await openBrowser()).newContext({ viewport: screens.desktop, reducedMotion: 'reduce' });
  await context.addInitScript(() => {
    const usual = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function none(kind, ...how) { return /webgl/.test(kind) ? null : usual.call(this, kind, ...how); };
  });
  const { page, complaints, close } = await open({ context });
  await start(page);
  await openModel(page, { name: 'house.obj', mimeType: 'application/octet-stream', buffer: house }, 'x');
  await drawn(page);
  assert.deepEqual(complaints, []);
  await close();
});

/** Each worker that begins from now on runs `spoil` before its own script. */
async function spoilWorkers(context, spoil) {
  await context.route(/engine-worker-/, async (route) => {
    const answer = await route.fetch();
    await route.fulfill({ response: answer, body: `(${spoil})();${await answer.text()}` });
  });
}

for (const [what, spoil, words] of [
  ['crashes', () => { addEventListener('message', (event) => { if (event.data.task) { event.stopImmediatePropagation(); throw new Error('crash'); } }); }, /too much for this browser/],
  ['gets no more memory', () => {   // for its first task
    let tasks = 0;
    addEventListener('message', (event) => { if (event.data.task) tasks++; });
    const { grow } = WebAssembly.Memory.prototype;
    WebAssembly.Memory.prototype.grow = function grown(pages) {
      if (tasks === 1) throw new RangeError('no memory');
      return grow.call(this, pages);
    };
  }, /needs more memory than a design may use|too much for this browser/],
]) {
  test(`an engine that ${what} costs the one design, in a sentence`, async () => {
    // What a service worker answers cannot be changed on its way.
    const context = await (await openBrowser()).newContext({ viewport: screens.desktop, reducedMotion: 'reduce', serviceWorkers: 'block' });
    const { page, complaints, close } = await open({ context });
    await begin(page, 'village');
    const whole = await page.evaluate(() => sessionStorage.getItem('popcut.design.steps'));
    await spoilWorkers(context, spoil);
    await page.getByRole('button', { name: 'Make it…' }).click();
    await page.locator('.make-choice', { hasText: 'By hand' }).click();
    await page.locator('.note-bad, .impossible').first().waitFor();
    assert.match(await page.locator('.note-bad, .impossible').first().innerText(), words);
    assert.equal(await page.evaluate(() => sessionStorage.getItem('popcut.design.steps')), whole);
    await context.unroute(/engine-worker-/);
    await page.getByRole('button', { name: 'Other ways' }).click();
    await page.locator('.make-choice', { hasText: 'Cricut' }).click();
    await page.locator('.made-files button').first().waitFor();   // the next one works
    assert.deepEqual(complaints.filter((one) => !/blocked by Playwright|crash/.test(one)), []);
    await close();
  });
}

test('an engine whose loading breaks off is loaded once more', async () => {
  const context = await (await openBrowser()).newContext({ viewport: screens.desktop, reducedMotion: 'reduce', serviceWorkers: 'block' });
  let loads = 0;
  await context.route(/engine-[0-9A-Z]+\.wasm$/, (route) => (loads++ === 0 ? route.abort() : route.continue()));
  const { page, complaints, close } = await open({ context });
  await begin(page, 'unit');
  assert.equal(loads, 2);
  assert.deepEqual(complaints.filter((one) => !/blocked by Playwright|ERR_FAILED/.test(one)), []);
  await close();
});

/** Counts tasks of workers and workers that are ended, in `window.seen`. */
function watchWorkers() {
  window.seen = { tasks: 0, ended: 0 };
  const { postMessage, terminate } = Worker.prototype;
  Worker.prototype.postMessage = function counted(data, ...more) {
    if (data.task) window.seen.tasks++;
    return postMessage.call(this, data, ...more);
  };
  Worker.prototype.terminate = function ended() {
    window.seen.ended++;
    return terminate.call(this);
  };
}

test('while nobody asks for anything the engine is tried out, and whatever is asked for comes first', async () => {
  const { page, complaints, close } = await open({ beforehand: watchWorkers });
  const seen = () => page.evaluate(() => window.seen);
  await until(async () => (await seen()).tasks > 0, 'it begins');
  await begin(page, 'unit');
  assert.ok((await seen()).ended > 0, 'what is tried out ends for the card');
  await until(async () => (await seen()).tasks >= 6, 'when the card is there, all four are tried out');
  assert.deepEqual(complaints, []);
  await close();
});

test('on a phone nothing is tried out', async () => {
  const { width, height } = screens.phone;
  const userAgent = 'Mozilla/5.0 (Linux; Android 14; Pixel 7) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/150.0.0.0 Mobile Safari/537.36';
  const context = await (await openBrowser()).newContext({ viewport: { width, height }, isMobile: true, hasTouch: true, userAgent, reducedMotion: 'reduce' });
  const { page, complaints, close } = await open({ context, beforehand: watchWorkers });
  await start(page);
  assert.equal(await page.evaluate(() => navigator.userAgentData.mobile), true);
  await wait(2000);
  assert.equal((await page.evaluate(() => window.seen)).tasks, 0);
  await begin(page, 'unit');
  assert.deepEqual(complaints, []);
  await close();
});

test('a link of a newer popcut, and one that was cut off, are refused in a sentence, and what is open stays', async () => {
  const newer = deflateSync(JSON.stringify({ popcut: 2, name: 'tomorrow' })).toString('base64url');
  const { page, complaints, close } = await open();
  await begin(page, 'unit');
  for (const [link, words] of [[newer, 'is of a newer popcut than this page'], ['9AAAA', 'cut short or changed'], ['1', 'cut short or changed']]) {
    await page.evaluate((to) => { location.hash = to; }, `#/design/d=${link}`);
    await page.locator('.note-bad', { hasText: words }).waitFor();
    assert.equal(await page.locator('.design-name').inputValue(), 'unit');
  }
  assert.deepEqual(complaints, []);
  await close();
});

test('an open page goes on with its own engine where the folder was replaced, and says that a newer page is ready', async (t) => {
  const around = mkdtempSync(join(tmpdir(), 'popcut-site-'));
  cpSync(folder, around, { recursive: true, filter: (path) => !/\.(br|gz)$/.test(path) });
  const other = await serve(around);
  t.after(() => ended(other, around));
  const { page, complaints, close } = await open({ base: `http://127.0.0.1:${other.address().port}/` });
  await begin(page, 'unit');
  await keptWhole(page);
  await page.reload();   // the worker of the page answers from now on
  // The newer folder has another engine, and the old one no more.
  const engine = readdirSync(join(around, 'page')).find((name) => /^engine-[0-9A-Z]+\.wasm$/.test(name));
  renameSync(join(around, 'page', engine), join(around, 'page/engine-NEWER000.wasm'));
  for (const name of ['index.html', 'service_worker.js']) {
    const file = join(around, name);
    writeFileSync(file, readFileSync(file, 'utf8').replaceAll(engine, 'engine-NEWER000.wasm').replace(/popcut-[0-9a-f]{12}/, 'popcut-newer'));
  }
  await page.evaluate(async () => { await (await navigator.serviceWorker.ready).update(); });
  await page.locator('.band', { hasText: 'A newer version of this page is ready' }).waitFor();
  const engineOf = () => page.locator('meta[name=engine]').getAttribute('content');
  await page.getByRole('button', { name: 'Go on with your last design' }).click();
  await exact(page);
  assert.match(await engineOf(), new RegExp(engine));
  await page.getByRole('button', { name: 'Reload the page' }).click();
  await until(async () => /NEWER000/.test(await engineOf()), 'the newer page is there');
  await page.getByRole('button', { name: 'Go on with your last design' }).click();
  await exact(page);
  assert.equal(await page.locator('.design-name').inputValue(), 'unit');
  assert.deepEqual(complaints, []);
  await close();
});

test('below another path of a server that sends no headers', async (t) => {
  const around = mkdtempSync(join(tmpdir(), 'popcut-site-'));
  symlinkSync(resolve(folder), join(around, 'cards'));
  const plain = await serve(around, 0, { plain: true });
  t.after(() => ended(plain, around));
  const base = `http://127.0.0.1:${plain.address().port}/cards/`;
  const { page, complaints, close } = await open({ base, hash: '#/design' });
  await begin(page, 'unit');
  await page.getByRole('button', { name: 'Share' }).click();
  const link = await page.getByRole('dialog').locator('input').first().inputValue();
  assert.ok(link.startsWith(`${base}#/design/d=`), link);
  assert.deepEqual(complaints, []);
  await close();
});

for (const screen of ['phone', 'tablet']) {
  test(`on a ${screen}`, async () => {
    const { page, complaints, close } = await open({ screen });
    await start(page);
    await picture(page, `site-${screen}-start`);
    await begin(page, 'house');
    await picture(page, `site-${screen}-design`);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the screen');
    await page.getByRole('button', { name: 'Make it…' }).click();
    await page.locator('.make-choice', { hasText: 'Cricut' }).click();
    const over = await page.locator('dialog select').evaluateAll((all) => all.filter((one) => one.getBoundingClientRect().right > one.closest('.field').getBoundingClientRect().right + 0.5).length);
    assert.equal(over, 0, 'choices stay in their boxes');
    assert.deepEqual(complaints, []);
    await close();
  });
}
