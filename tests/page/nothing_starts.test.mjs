// Whatever happens to a page by itself or by mistake, at any step of a job, no knife starts: only a held START does.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { armHere, closeBrowser, expectComplaints, hold, ladder, machineHash, Server, tickAll, unreachable, visit, wait } from './harness.mjs';

let server;
let one = null;          // the browser of a test
let job = null;

before(async () => {
  server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 10 }] });
});
after(async () => { await closeBrowser(); await server.remove(); });

afterEach(async () => {
  const { complaints } = one;
  await one.context.close();
  await server.act(job.id, 'cancel').catch(() => undefined);
  await server.state(job.id, ['cancelled', 'done', 'failed']);
  assert.deepEqual(complaints, []);
});

/** A job at the cutter and a browser that stands before it. */
async function stand(lines = 8, options = {}) {
  job = await server.queue(ladder(lines), { name: 'left alone' });
  one = await visit(server, { hash: machineHash(), screen: 'tablet', ...options });
  expectComplaints(one.page, unreachable, /ERR_INTERNET_DISCONNECTED/);
  return one;
}

const begin = (page) => page.locator('.hold');
const middle = async (page, selector) => {
  const box = await page.locator(selector).boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
};

/** How a page gets to each step of a job, and what state the job is in there. */
const steps = {
  'three ticks are set': {
    state: 'ready',
    go: async (page) => { await page.locator('.arm').waitFor(); await tickAll(page); },
  },
  'Arm asks whether somebody is beside the cutter': {
    state: 'ready', beside: '',
    go: async (page) => {
      await page.locator('.arm').waitFor();
      await tickAll(page);
      await page.locator('.arm').click();
      await page.locator('dialog[open]').waitFor();
    },
  },
  'it is armed': { state: 'armed', go: (page) => begin(page).and(page.locator(':enabled')).waitFor() },
  'START is held for half its time': {
    state: 'armed',
    go: async (page) => {
      await page.locator('.hold:enabled').waitFor();
      await page.mouse.move(...await middle(page, '.hold'));
      await page.mouse.down();
      await page.locator('.hold-on').waitFor();
      await wait(100);
    },
  },
  'START asks, as it was pressed by a key': {
    state: 'armed',
    go: async (page) => {
      await page.locator('.hold:enabled').waitFor();
      await begin(page).focus();
      await page.keyboard.press('Enter');
      await page.locator('dialog[open]').waitFor();
    },
  },
  'it is paused': { state: 'paused', go: (page) => page.locator('.hold:enabled').waitFor() },
  'GO ON is held for half its time': {
    state: 'paused',
    go: async (page) => {
      await page.locator('.hold:enabled').waitFor();
      await page.mouse.move(...await middle(page, '.hold'));
      await page.mouse.down();
      await page.locator('.hold-on').waitFor();
      await wait(100);
    },
  },
  'GO ON asks, as it was pressed by a key': {
    state: 'paused',
    go: async (page) => {
      await page.locator('.hold:enabled').waitFor();
      await begin(page).focus();
      await page.keyboard.press('Enter');
      await page.locator('dialog[open]').waitFor();
    },
  },
};

const wake = (page) => page.evaluate(() => {
  Object.defineProperty(document, 'visibilityState', { value: 'visible', configurable: true });
  document.dispatchEvent(new Event('visibilitychange'));
});

/** What happens to a page. Each gives the page that is looked at afterwards. */
const happenings = {
  'Back, then forward': async (page) => { await page.goBack(); await page.goForward(); return page; },
  reload: async (page) => { await page.reload(); return page; },
  'the tab is closed, and opened again': async (page) => {
    const { context } = one;
    const token = await page.evaluate(() => sessionStorage.getItem('popcut.token'));
    const address = page.url();
    await page.close();
    const next = await context.newPage();
    await next.addInitScript((kept) => { if (location.protocol === 'http:') sessionStorage.setItem('popcut.token', kept); }, token);
    next.on('request', (request) => { if (request.method() !== 'GET') one.sent.push({ path: new URL(request.url()).pathname }); });
    await next.goto(address);
    one.page = next;
    return next;
  },
  'the screen wakes by Enter, by space and by a touch': async (page) => {
    for (const key of ['Enter', ' ']) {
      await wake(page);
      await page.keyboard.press(key);
    }
    await wake(page);
    const [x, y] = await middle(page, await begin(page).count() ? '.hold' : '.arm');
    await page.touchscreen.tap(x, y);
    return page;
  },
  'the page is hidden and seen again, and loses and gets the focus': async (page) => {
    await page.evaluate(() => {
      for (const value of ['hidden', 'visible']) {
        Object.defineProperty(document, 'visibilityState', { value, configurable: true });
        document.dispatchEvent(new Event('visibilitychange'));
        dispatchEvent(new Event(value === 'hidden' ? 'blur' : 'focus'));
      }
    });
    return page;
  },
  'the connection is lost and comes back': async (page) => {
    await one.context.setOffline(true);
    await wait(200);
    await one.context.setOffline(false);
    return page;
  },
  'another view by its key, and Escape': async (page) => {
    await page.keyboard.press('Escape');
    await page.keyboard.press('4');
    await page.keyboard.press('Enter');
    await page.goBack();
    return page;
  },
  'the window becomes small and large': async (page) => {
    const size = page.viewportSize();
    await page.setViewportSize({ width: 400, height: 700 });
    await page.setViewportSize(size);
    return page;
  },
};

/** The steps of `state`s, one after another on one job; each happening at each step. */
async function leftAlone(names) {
  const started = await server.attempts(job.id);
  for (const name of names) {
    const step = steps[name];
    if (step.beside !== undefined) await one.page.evaluate(() => localStorage.removeItem('popcut.beside'));
    await one.page.reload();
    for (const [what, happens] of Object.entries(happenings)) {
      // Who holds on through a gap of the network still means it.
      if (/held/.test(name) && /connection/.test(what)) continue;
      const where = `${name}; ${what}`;
      await step.go(one.page).catch((error) => { throw new Error(`${where}: ${error.message}`); });
      const page = await happens(one.page);
      if (/held/.test(name)) {
        await wait(700);             // longer than the rest of the hold
        await page.mouse.up();
      }
      await page.locator('.machine').waitFor();
      await page.keyboard.press('Escape');
      assert.deepEqual(one.sent.filter((request) => /actions\/(start|resume|resume-from|retry-sheet)$/.test(request.path)), [], where);
      assert.equal((await server.job(job.id)).state, step.state, where);
      assert.equal(await server.attempts(job.id), started, where);
      await page.reload();
    }
  }
}

test('at a sheet that is to be loaded nothing that happens by itself arms or starts', async () => {
  await stand();
  await leftAlone(['three ticks are set']);
  await leftAlone(['Arm asks whether somebody is beside the cutter']);
  assert.equal(one.acts('arm').length, 0);
});

test('while armed nothing that happens by itself starts', async () => {
  const { page } = await stand();
  await armHere(page);
  await leftAlone(['it is armed', 'START is held for half its time', 'START asks, as it was pressed by a key']);
});

test('while paused nothing that happens by itself goes on', async () => {
  await stand(300);
  await server.cut(job.id);
  await server.act(job.id, 'pause');
  await server.state(job.id, 'paused');
  await leftAlone(['it is paused', 'GO ON is held for half its time', 'GO ON asks, as it was pressed by a key']);
});

test('a key that is held on Arm, and taps that go on where Arm was, start nothing', async () => {
  const { page, acts } = await stand();
  for (const key of ['Enter', 'Space']) {
    await page.locator('.arm').waitFor();
    await tickAll(page);
    await page.locator('.arm').focus();
    for (let i = 0; i < 15; i++) {
      await page.keyboard.down(key);          // the second and later ones repeat; space acts as it is let go
      if (key === 'Space' && i === 0) await page.keyboard.up(key);
      await wait(60);
    }
    await page.locator('.hold:enabled').waitFor();
    for (let i = 0; i < 5; i++) await page.keyboard.down(key);
    await page.keyboard.up(key);
    assert.equal(await page.locator('dialog').count(), 0, `${key}: nothing is asked`);
    assert.equal(await page.evaluate(() => document.activeElement.closest('.hold') !== null), false, 'START is not focused by the page');
    await server.act(job.id, 'disarm');
  }
  await page.locator('.arm').waitFor();
  await tickAll(page);
  const [x, y] = await middle(page, '.arm');
  for (let i = 0; i < 12; i++) {
    await page.touchscreen.tap(x, y);
    await wait(80);
  }
  await page.locator('.hold').waitFor({ timeout: 2000 }).catch(() => undefined);
  assert.equal(acts('start').length, 0);
  assert.ok(['armed', 'ready'].includes((await server.job(job.id)).state));
  assert.equal(await server.attempts(job.id), 0);
});

test('a finger that lies where START will be, and double taps on START and GO ON, start nothing', async () => {
  const { page, acts } = await stand(300);
  await armHere(page);
  const [x, y] = await middle(page, '.hold');
  await server.act(job.id, 'disarm');
  await page.locator('.arm').waitFor();
  await tickAll(page);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.locator('.arm').focus();
  await page.keyboard.press('Enter');
  await page.locator('.hold:enabled').waitFor();
  await wait(1200);
  await page.mouse.up();
  const doubles = async () => {
    await page.touchscreen.tap(x, y);
    await page.touchscreen.tap(x, y);
    await page.mouse.dblclick(x, y);
    for (let i = 0; i < 6; i++) await page.mouse.click(x, y, { delay: 120 });
    await wait(300);
    assert.equal(await page.locator('dialog').count(), 0);
  };
  await doubles();
  assert.equal(acts('start').length, 0);
  assert.equal((await server.job(job.id)).state, 'armed');
  await server.act(job.id, 'start');
  await server.act(job.id, 'pause');
  await server.state(job.id, 'paused');
  await page.locator('.hold:enabled').waitFor();
  await doubles();
  assert.equal(acts('resume').length, 0);
  assert.equal((await server.job(job.id)).state, 'paused');
});

test('START pressed by two fingers, by the second button of a mouse, or dragged away and back starts nothing', async () => {
  const { page, acts } = await stand();
  await armHere(page);
  const [x, y] = await middle(page, '.hold');
  const touch = await one.context.newCDPSession(page);
  const points = (...all) => all.map(([px, py], id) => ({ x: px, y: py, id }));
  await touch.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: points([x, y]) });
  await wait(200);
  await touch.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: points([x, y], [x + 30, y + 10]) });
  await wait(1200);
  await touch.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
  await page.mouse.move(x, y);
  await page.mouse.down({ button: 'right' });
  await wait(1000);
  await page.mouse.up({ button: 'right' });
  await page.mouse.down();
  await wait(300);
  await page.mouse.move(x - 400, y);
  await page.mouse.move(x, y);
  await wait(1000);
  await page.mouse.up();
  assert.equal(acts('start').length, 0);
  assert.equal((await server.job(job.id)).state, 'armed');
});

test('START held to its end while popcutd cannot be reached is said to have failed, and is not made up for later', async () => {
  const { page, acts } = await stand();
  await armHere(page);
  await one.context.setOffline(true);
  await hold(page);
  await page.getByText('popcutd does not answer.').waitFor();
  await one.context.setOffline(false);
  await page.locator('.live-on').waitFor();
  await wait(2500);
  assert.equal(acts('start').length, 1, 'it is not sent again');
  assert.equal((await server.job(job.id)).state, 'armed');
  assert.equal(await server.attempts(job.id), 0);
  await hold(page);                          // and now it is asked for again
  await server.state(job.id, ['cutting', 'done']);
  const [first, second] = acts('start').map((act) => act.headers['idempotency-key']);
  assert.equal(first, second, 'it is the same act, so that it can be done once only');
});
