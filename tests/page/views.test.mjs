// Every view on every screen: how it looks, whether all can use it, and that nothing in it acts by itself.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { axeSource, closeBrowser, ladder, machineHash, picture, Server, until, visit,
  wait } from './harness.mjs';

let server;
const hostile = '<img src=x onerror=alert(1)><script>alert(2)</script>"\'&amp;{{7*7}}';

before(async () => {
  server = await Server.start({ devices: [
    { id: 'sim:cameo3', time_scale: 1 }, { id: 'sim:cameo4', time_scale: 20, faults: [{ at_path: 9, kind: 'unplug', seconds: 1 }] },
  ] });
});
after(async () => { await closeBrowser(); await server.remove(); });

/** What axe finds that is serious, as one line each. */
async function serious(page) {
  await page.evaluate(axeSource());
  return page.evaluate(async () => {
    const { violations } = await window.axe.run(document, { resultTypes: ['violations'] });
    return violations.filter((one) => ['serious', 'critical'].includes(one.impact))
      .map((one) => `${one.id}: ${one.nodes.slice(0, 3).map((node) => node.html.slice(0, 120)).join(' | ')}`);
  });
}

/** What is cut off: wider than the page, or than its own box. */
function cutOff(page) {
  return page.evaluate(() => {
    const found = [];
    const wide = document.scrollingElement.scrollWidth - innerWidth;
    if (wide > 1) found.push(`the page is ${wide} px wider than the screen`);
    for (const box of document.querySelectorAll('button, a, h1, h2, h3, p, label, li, td, th, strong, span, select')) {
      const style = getComputedStyle(box);
      const { width, right, left } = box.getBoundingClientRect();
      if (width === 0 || box.closest('.visually-hidden, .skip, .picture, .table-box, [aria-hidden=true]')) continue;
      if (right > innerWidth + 1 || left < -1) found.push(`${box.tagName} outside: ${box.textContent.slice(0, 60)}`);
      if (style.overflow === 'hidden' && box.scrollWidth > box.clientWidth + 1) found.push(`${box.tagName} cut: ${box.textContent.slice(0, 60)}`);
    }
    return found;
  });
}

const steady = async (page) => {
  await page.locator('.live-on').waitFor();
  await wait(300);
};

const looks = [['phone', 'light'], ['phone', 'dark'], ['tablet', 'light'], ['desktop', 'light'], ['desktop', 'dark']];

/** Visits `hash` on every screen; each picture is kept. */
async function everywhere(name, hash, ready, then = async () => undefined) {
  for (const [screen, theme] of looks) {
    const { page, complaints, close } = await visit(server, { hash, screen, theme, name: 'Ana', beside: 'sim:cameo3' });
    await ready(page);
    await steady(page);
    await then(page);
    await picture(page, `${name}-${screen}-${theme}`);
    assert.deepEqual(await serious(page), [], `${name} ${screen} ${theme}`);
    assert.deepEqual(await cutOff(page), [], `${name} ${screen} ${theme}`);
    assert.deepEqual(complaints, [], `${name} ${screen} ${theme}`);
    await close();
  }
}

test('signing in is fit for everybody on every screen', async () => {
  for (const [screen, theme] of looks) {
    const { page, complaints, close } = await visit(server, { signIn: false, screen, theme });
    await page.getByRole('heading', { name: 'Sign in' }).waitFor();
    await picture(page, `sign-in-${screen}-${theme}`);
    assert.deepEqual(await serious(page), []);
    assert.deepEqual(await cutOff(page), []);
    assert.deepEqual(complaints, []);
    await close();
  }
});

test('Now without a job shows the examples, on every screen', async () => {
  await everywhere('now-empty', '', async (page) => {
    await page.getByText('Nothing to cut.').waitFor();
    await until(() => page.evaluate(() => {
      const pictures = [...document.querySelectorAll('.examples img')];
      for (const one of pictures) one.loading = 'eager';
      return pictures.length >= 10 && pictures.every((one) => one.complete && one.naturalWidth > 0);
    }), 'their pictures');
  });
});

test('Settings and Done are fit for everybody on every screen', async () => {
  await everywhere('settings', '#/settings', (page) => page.getByRole('heading', { name: 'Settings' }).waitFor());
  await everywhere('done-empty', '#/done', (page) => page.getByRole('heading', { name: 'Done' }).waitFor());
});

test('At the machine, ready, armed, cutting, paused and interrupted are fit for everybody on every screen', async () => {
  const job = await server.queue(ladder(300), { name: 'Facade for the model', copies: 2 });
  await everywhere('machine-ready', machineHash(), (page) => page.locator('.arm').waitFor());
  await server.act(job.id, 'arm', { sheet: 1 });
  await everywhere('machine-armed', machineHash(), (page) => page.locator('.hold:enabled').waitFor());
  await server.act(job.id, 'start');
  await server.state(job.id, 'cutting');
  await wait(12_000);
  await everywhere('machine-cutting', machineHash(), (page) => page.locator('.pause-big').waitFor());
  await everywhere('now-cutting', '', (page) => page.getByText('Being cut').waitFor());
  await server.ask('POST', `/v1/jobs/${job.id}/actions/pause`, {}, { headers: { 'If-Match': '*', 'Idempotency-Key': crypto.randomUUID() } });
  await server.state(job.id, 'paused');
  await everywhere('machine-paused', machineHash(), (page) => page.locator('.hold:enabled').waitFor());

  const broken = await server.queue(ladder(40), { name: 'Cable out', device: 'sim:cameo4' });
  await server.cut(broken.id);
  await server.state(broken.id, 'interrupted', 60_000);
  await everywhere('machine-interrupted', machineHash('sim:cameo4'), (page) => page.getByText('Look at the sheet.').waitFor(),
    (page) => page.getByText('Go on from a stroke', { exact: true }).click());
  await server.queue(ladder(5), { name: 'Card for Ben', device: 'sim:cameo4' });
  await everywhere('now-full', '', (page) => page.getByText('Waiting for you').waitFor());
  await everywhere('machine-free-question', machineHash(), (page) => page.getByRole('button', { name: 'End the job' }).waitFor(),
    (page) => page.getByRole('button', { name: 'End the job' }).click());
});

test('in the pseudo language nothing is cut off, and no text of the page is missing from words.ts', async () => {
  for (const screen of ['phone', 'tablet', 'desktop']) {
    for (const [name, hash] of [['now', ''], ['machine', machineHash()], ['interrupted', machineHash('sim:cameo4')],
      ['settings', '#/settings'], ['done', '#/done']]) {
      const { page, complaints, close } = await visit(server, { hash, screen, language: 'pseudo', name: 'Ana' });
      await page.locator('.live-on').waitFor();
      await wait(700);
      await picture(page, `pseudo-${name}-${screen}`);
      assert.deepEqual(await cutOff(page), [], `${name} ${screen}`);
      const plain = await page.evaluate(() => [...document.querySelectorAll('button, h2, h3, legend, dt')]
        .map((one) => one.textContent.trim()).filter((text) => /[A-Za-z]{3}/.test(text) && !text.includes('[')));
      assert.deepEqual(plain, [], `${name} ${screen}`);
      assert.deepEqual(complaints, []);
      await close();
    }
  }
});

test('at 200 % zoom and at 320 px nothing is cut off', async () => {
  for (const screen of [{ width: 720, height: 450, touch: false }, { width: 320, height: 640, touch: true }]) {
    for (const hash of ['', machineHash(), machineHash('sim:cameo4'), '#/settings', '#/done']) {
      const { page, complaints, close } = await visit(server, { hash, screen });
      await page.locator('.live-on').waitFor();
      await wait(500);
      assert.deepEqual(await cutOff(page), [], `${hash} ${screen.width}`);
      assert.deepEqual(complaints, []);
      await close();
    }
  }
});

test('hostile names, notes and drawings are text and pictures, and nothing more', async () => {
  const drawing = ladder(4).replace('<path', `<script>fetch('/v1/jobs')</script><image href="http://127.0.0.1:9/x.png" onload="alert(3)"/><path`);
  const { body } = await server.ask('POST', `/v1/designs?name=${encodeURIComponent('<b>bold</b>')}`, drawing, { headers: { 'Content-Type': 'image/svg+xml' } });
  await server.must('POST', '/v1/jobs', { design: body.id, name: hostile.slice(0, 120), note: hostile, tags: ['<i>'], device: 'sim:cameo4' },
    { headers: { 'Idempotency-Key': crypto.randomUUID() } });
  const { page, complaints, sent, close } = await visit(server, { name: '<u>Eve</u>' });
  let asked = 0;
  page.on('dialog', (dialog) => { ++asked; void dialog.dismiss(); });
  await page.getByText('<img src=x onerror=alert(1)>').first().waitFor();
  await wait(1000);
  assert.equal(await page.locator('main img[src=x], main script, main b, main i, header u').count(), 0);
  for (const hash of ['#/at/%ZZ', `#/at/${'x'.repeat(10_000)}`, `#/design/d=${'A'.repeat(10_000)}`, '#/sheets/..%2F..%2Fv1', '#/glue/<b>', '#/nowhere',
    '#/%F0%28%8C', '#t']) {
    await page.evaluate((to) => { location.hash = to; }, hash);
    await wait(250);
    assert.ok(await page.locator('.bar').isVisible(), `${hash.slice(0, 20)}: the page lives`);
  }
  assert.equal(asked, 0);
  assert.deepEqual(sent.filter((one) => !one.path.startsWith('/v1/session') && one.path !== '/v1/preview'), [], 'nothing is sent');
  assert.deepEqual(complaints.filter((one) => !/status of (400|404|422)/.test(one)), []);
  await close();
});

test('the whole flow goes by keyboard alone', async () => {
  const own = await Server.start({});
  const job = await own.queue(ladder(4), { name: 'Keys only' });
  const { page, complaints, close } = await visit(own, { hash: machineHash(), beside: '' });
  await page.locator('.arm').waitFor();
  const press = async (what, key = 'Space') => {
    for (let i = 0; i < 60; ++i) {
      await page.keyboard.press('Tab');
      if (await page.evaluate((selector) => document.activeElement?.matches(selector), what)) {
        const ring = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
        assert.notEqual(ring, 'none', `${what} shows its focus`);
        await page.keyboard.press(key);
        return;
      }
    }
    throw new Error(`Tab never reaches ${what}`);
  };
  for (let tick = 0; tick < 3; ++tick) await press('.ticks input:not(:checked)');
  await press('.arm', 'Enter');
  await press('.dialog .button-primary', 'Enter');
  await page.locator('.hold:enabled').waitFor();
  await press('.hold', 'Enter');
  await press('.dialog .button-primary', 'Enter');
  await own.state(job.id, ['cutting', 'done']);
  await page.keyboard.press('?');
  await page.getByText('pauses what is being cut').waitFor();
  assert.deepEqual(complaints, []);
  await close();
  await own.remove();
});

test('the page as it comes has no style or script of its own in it, and does not move while it loads', async () => {
  const { page, complaints, close } = await visit(server, {});
  const shift = await page.evaluate(() => new Promise((done) => {
    let sum = 0;
    new PerformanceObserver((list) => { for (const one of list.getEntries()) if (!one.hadRecentInput) sum += one.value; })
      .observe({ type: 'layout-shift', buffered: true });
    setTimeout(() => done(sum), 800);
  }));
  assert.ok(shift < 0.02, `layout shift ${shift}`);
  const answer = await page.request.get(`${server.address}/`);
  const text = await answer.text();
  assert.equal(/<style|style=|<script(?![^>]*src=)| on\w+=/.test(text), false);
  assert.match(answer.headers()['content-security-policy'], /require-trusted-types-for 'script'/);
  assert.deepEqual(complaints, []);
  await close();
});

