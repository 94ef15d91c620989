// At the machine: a person, three ticks, Arm, START.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { armHere, closeBrowser, expectComplaints, hold, ladder, machineHash, pointAtHold, refused, Server, stopClock, tickAll,
  until, visit, wait } from './harness.mjs';

let server;
let open = [];

before(async () => { server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 20 }] }); });
after(async () => { await closeBrowser(); await server.remove(); });

/** A browser that is closed after the test, where nothing may have gone wrong. */
async function look(options) {
  const one = await visit(server, options);
  open.push(one);
  return one;
}

afterEach(async () => {
  const complaints = open.flatMap((one) => one.complaints);
  for (const one of open) await one.close();
  open = [];
  const { items } = await server.must('GET', '/v1/jobs?state=queued,planning,ready,armed,cutting,paused,interrupted');
  for (const { id } of items) {
    await server.ask('POST', `/v1/jobs/${id}/actions/cancel`, {}, { headers: { 'If-Match': '*', 'Idempotency-Key': crypto.randomUUID() } });
  }
  for (const { id } of items) await server.state(id, ['cancelled', 'done', 'failed']);
  assert.deepEqual(complaints, []);
});

test('a job is cut from Now with three ticks, Arm and a held START, and each is sent once', async () => {
  const job = await server.queue(ladder(8), { name: 'first way' });
  const { page, sent, acts } = await look({});
  await page.getByText('Load sheet 1 of 1').waitFor();
  await page.getByRole('link', { name: 'Go to machine' }).click();
  const arm = page.locator('.arm');
  await arm.waitFor();
  for (const tick of await page.locator('.ticks input').all()) {
    assert.equal(await arm.isDisabled(), true, 'Arm is off before the third tick');
    await tick.check();
  }
  await arm.click();
  await page.locator('.hold:enabled').waitFor();
  assert.equal((await server.job(job.id)).state, 'armed');
  await hold(page);
  await page.getByText('"first way" is cut').waitFor({ timeout: 60_000 });
  assert.equal((await server.job(job.id)).state, 'done');
  assert.equal(acts('arm').length, 1);
  assert.equal(acts('start').length, 1);
  for (const one of [...acts('arm'), ...acts('start')]) {
    assert.match(one.headers['if-match'], /^"\d+"$/);
    assert.ok(one.headers['idempotency-key'].length >= 16);
  }
  assert.deepEqual(sent.filter((one) => one.path.includes('/actions/')).map((one) => one.path.split('/').at(-1)), ['arm', 'start']);
});

test('each sheet of a job is armed and started again, with ticks of its own', async () => {
  const job = await server.queue(ladder(3), { name: 'two copies', copies: 2 });
  const { page } = await look({ hash: machineHash() });
  for (const sheet of [1, 2]) {
    await page.getByText(`Load sheet ${sheet} of 2`).waitFor({ timeout: 60_000 });
    for (const tick of await page.locator('.ticks input').all()) assert.equal(await tick.isChecked(), false);
    await armHere(page);
    await hold(page);
    await page.locator('.hold').waitFor({ state: 'detached' });
  }
  assert.equal((await server.state(job.id, 'done', 60_000)).state, 'done');
});

test('START does nothing without ticks, in its first 0.6 s, when it is held too short, and when the pointer leaves it', async () => {
  const job = await server.queue(ladder(8), { name: 'not yet' });
  const { page, acts } = await look({ hash: machineHash() });
  await page.locator('.arm').waitFor();
  assert.equal(await page.locator('.hold').count(), 0, 'START is not there before Arm');
  await tickAll(page);
  await stopClock(page);
  await page.locator('.arm').click();
  await page.locator('.hold').waitFor();
  await page.clock.runFor(100);
  const { x, y } = await pointAtHold(page);
  await page.mouse.down();             // inert: too early, and it stays off however long it is held
  await page.clock.runFor(1500);
  await page.mouse.up();
  await page.locator('.hold:enabled').waitFor();
  await page.mouse.down();             // too short
  await page.locator('.hold-on').waitFor();
  await page.clock.runFor(700);
  await page.mouse.up();
  await page.locator('.hold-on').waitFor({ state: 'detached' });
  await page.clock.runFor(1000);
  await page.mouse.down();             // leaves
  await page.locator('.hold-on').waitFor();
  await page.clock.runFor(300);
  await page.mouse.move(x - 300, y);
  await page.locator('.hold-on').waitFor({ state: 'detached' });
  await page.clock.runFor(1000);
  await page.mouse.up();
  await page.clock.resume();
  await wait(300);
  assert.equal(acts('start').length, 0);
  assert.equal((await server.job(job.id)).state, 'armed');
});

test('a double tap, a double click and a held key on START start nothing', async () => {
  const job = await server.queue(ladder(8), { name: 'double' });
  const { page, acts } = await look({ hash: machineHash(), screen: 'tablet' });
  await armHere(page);
  await stopClock(page);
  await page.locator('.hold').dblclick();
  await page.locator('.hold').tap();
  await page.locator('.hold').tap();
  assert.equal(await page.locator('dialog').count(), 0, 'a pointer asks nothing');
  await page.clock.resume();
  await page.locator('.hold').focus();
  await page.keyboard.down('Enter');
  await wait(300);
  await page.keyboard.down('Enter');   // the key repeats
  await page.keyboard.up('Enter');
  await wait(300);
  assert.equal(acts('start').length, 0);
  assert.equal((await server.job(job.id)).state, 'armed');
});

test('by keyboard START asks, with the focus on "Cancel", and the second answer starts', async () => {
  const job = await server.queue(ladder(4), { name: 'by keyboard' });
  const { page, acts } = await look({ hash: machineHash() });
  await armHere(page);
  await page.locator('.hold').focus();
  await page.keyboard.press('Enter');
  await page.locator('dialog[open]').waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.textContent), 'Cancel');
  await page.keyboard.press('Enter');
  await page.locator('dialog').waitFor({ state: 'detached' });
  assert.equal(acts('start').length, 0);
  await page.locator('.hold').focus();
  await page.keyboard.press('Space');
  await page.getByRole('button', { name: 'Start the cut' }).focus();
  await page.keyboard.press('Enter');
  await server.state(job.id, ['cutting', 'done']);
  assert.equal(acts('start').length, 1);
});

test('the key or touch that wakes the screen is swallowed, and the next one counts', async () => {
  await server.queue(ladder(8), { name: 'asleep' });
  const { page, acts } = await look({ hash: machineHash() });
  await page.locator('.arm').waitFor();
  await tickAll(page);
  const wake = () => page.evaluate(() => {
    Object.defineProperty(document, 'visibilityState', { value: 'visible', configurable: true });
    document.dispatchEvent(new Event('visibilitychange'));
  });
  await page.locator('.arm').focus();
  await wake();
  await page.keyboard.press('Enter');
  await wake();
  await page.locator('.arm').click();
  await wait(400);
  assert.equal(acts('arm').length, 0, 'what woke the screen does not arm');
  await page.locator('.arm').click();
  await page.locator('.hold:enabled').waitFor();
  assert.equal(acts('arm').length, 1);
  await page.locator('.hold').focus();
  await wake();
  await page.keyboard.press('Enter');
  await wait(300);
  assert.equal(await page.locator('dialog').count(), 0, 'what woke the screen asks nothing');
});

test('Back, reload and closing the tab start and arm nothing, at every step', async () => {
  const job = await server.queue(ladder(8), { name: 'left alone' });
  const here = machineHash();
  const { page, acts, context } = await look({ hash: here });
  const leave = [
    async () => { await page.goBack(); await page.goForward(); },
    async () => { await page.reload(); },
  ];
  for (const away of leave) {
    await page.locator('.arm').waitFor();
    await tickAll(page);
    await away();
    await page.locator('.arm').waitFor();
    assert.equal((await server.job(job.id)).state, 'ready');
  }
  assert.equal(acts('arm').length, 0);
  await armHere(page);
  for (const away of leave) {
    await page.locator('.hold:enabled').waitFor();
    await pointAtHold(page);
    await stopClock(page);
    await page.mouse.down();
    await page.locator('.hold-on').waitFor();
    await page.clock.runFor(200);
    await away();
    await page.mouse.up();
    await page.clock.resume();
    await wait(900);
    assert.equal((await server.job(job.id)).state, 'armed');
  }
  await page.locator('.hold:enabled').waitFor();
  await page.locator('.hold').focus();
  await page.keyboard.press('Enter');
  await page.locator('dialog[open]').waitFor();
  await page.keyboard.press('Escape');
  await page.close();
  await wait(500);
  assert.equal(acts('start').length, 0);
  assert.equal((await server.job(job.id)).state, 'armed');
  await context.close();
});

test('Disarm takes the arming back, and the ticks are gone', async () => {
  const job = await server.queue(ladder(8), { name: 'disarmed' });
  const { page } = await look({ hash: machineHash() });
  await armHere(page);
  await page.getByRole('button', { name: 'Disarm' }).click();
  await page.locator('.arm').waitFor();
  assert.equal((await server.job(job.id)).state, 'ready');
  for (const tick of await page.locator('.ticks input').all()) assert.equal(await tick.isChecked(), false);
});

test('away from the cutter, Arm asks first', async () => {
  const job = await server.queue(ladder(8), { name: 'from the desk' });
  const { page } = await look({ hash: machineHash(), beside: '' });
  await page.locator('.arm').waitFor();
  await tickAll(page);
  await page.locator('.arm').click();
  await page.getByText(/Are you at the/).waitFor();
  await page.keyboard.press('Escape');
  assert.equal((await server.job(job.id)).state, 'ready');
  await page.locator('.arm').click();
  await page.getByRole('button', { name: 'I see the cutter: arm' }).click();
  await server.state(job.id, 'armed');
});

test('of two people who arm, one wins and the other is told who', async () => {
  const job = await server.queue(ladder(8), { name: 'race' });
  const ana = await look({ hash: machineHash(), name: 'Ana' });
  const ben = await look({ hash: machineHash(), name: 'Ben' });
  expectComplaints(ana.page, refused(412));
  for (const { page } of [ana, ben]) {
    await page.locator('.arm').waitFor();
    await tickAll(page);
  }
  await ana.page.route('**/actions/arm', async (route) => {     // Ana's request is under way for a while
    await server.state(job.id, 'armed');
    await route.continue();
  });
  await ana.page.locator('.arm').click();
  await ben.page.locator('.arm').click();
  await ana.page.getByText('Nothing was done.').waitFor();
  await ana.page.getByText(/armed it \d+ s ago/).waitFor();
  await ana.page.locator('.hold').waitFor();
  assert.equal((await server.job(job.id)).state, 'armed');
});

test('of two people who start, one wins, and the knife starts once', async () => {
  const job = await server.queue(ladder(40), { name: 'race to start' });
  const ana = await look({ hash: machineHash(), name: 'Ana' });
  const ben = await look({ hash: machineHash(), name: 'Ben' });
  expectComplaints(ana.page, refused(412));
  await armHere(ana.page);
  await ben.page.locator('.hold:enabled').waitFor();
  await ana.page.route('**/actions/start', async (route) => {
    await server.state(job.id, ['cutting', 'done']);
    await route.continue();
  });
  await Promise.all([hold(ana.page), hold(ben.page)]);
  await ana.page.getByText('Nothing was done.').waitFor();
  assert.equal(await server.attempts(job.id), 1);
});

test('a job that somebody cancelled elsewhere is told, and its START is gone', async () => {
  const job = await server.queue(ladder(8), { name: 'cancelled elsewhere' });
  const { page, acts } = await look({ hash: machineHash() });
  await armHere(page);
  await server.ask('POST', `/v1/jobs/${job.id}/actions/cancel`, {}, { headers: { 'If-Match': '*', 'Idempotency-Key': crypto.randomUUID() } });
  await page.locator('.hold').waitFor({ state: 'detached' });
  await page.getByText('"cancelled elsewhere": cancelled.').waitFor();
  assert.equal(acts('start').length, 0);
});

test('Arm is below its ticks on a phone and beside them on a desktop, and there is one PAUSE', async () => {
  const job = await server.queue(ladder(200), { name: 'places' });
  for (const screen of ['phone', 'desktop']) {
    const { page, close } = await look({ hash: machineHash(), screen });
    await page.locator('.arm').waitFor();
    const [arm, ticks] = await page.evaluate(() =>  // at one time: the view may still move
      ['.arm', '.ticks'].map((name) => document.querySelector(name).getBoundingClientRect().toJSON()));
    if (screen === 'phone') assert.ok(arm.y >= ticks.y + ticks.height, 'below');
    else assert.ok(arm.x + arm.width <= ticks.x && arm.y < ticks.y + ticks.height, 'beside, at the left');
    if (screen === 'phone') {
      await close();
      continue;
    }
    await server.cut(job.id);
    await page.locator('.pause-button').waitFor();
    assert.equal(await page.locator('.pause-button').count(), 1);
    await server.act(job.id, 'cancel');
    await close();
  }
});

test('a viewer sees everything and can do nothing', async () => {
  const job = await server.queue(ladder(200), { name: 'only look' });
  const { page, sent } = await look({ role: 'viewer', hash: machineHash() });
  await page.getByText('Load sheet 1 of 1').waitFor();
  assert.equal(await page.locator('.arm, .ticks input, .danger-acts button').count(), 0);
  await server.cut(job.id);
  await page.getByText('An operator may pause it.').waitFor();
  assert.equal(await page.locator('.pause-button').count(), 0);
  await page.keyboard.press('p');
  await wait(300);
  assert.deepEqual(sent.filter((one) => one.path.includes('/jobs/')), []);
});

test('the paused job goes on after a hold, and ends after two taps in two places', async () => {
  const job = await server.queue(ladder(300), { name: 'paused' });
  await server.cut(job.id);
  const { page, acts } = await look({ hash: machineHash() });
  await page.locator('.pause-big').click();
  await server.state(job.id, 'paused');
  await page.locator('.hold:enabled').waitFor();
  await page.locator('.hold').click();
  await wait(400);
  assert.equal(acts('resume').length, 0, 'a tap does not go on');
  await hold(page);
  await server.state(job.id, 'cutting');
  await page.locator('.pause-bar .pause-button').click();
  await server.state(job.id, 'paused');
  const end = page.getByRole('button', { name: 'End the job' });
  const first = await end.boundingBox();
  await end.click();
  const second = await page.getByRole('button', { name: 'End it' }).boundingBox();
  const apart = first.x + first.width < second.x || second.x + second.width < first.x
    || first.y + first.height < second.y || second.y + second.height < first.y;
  assert.ok(apart, 'the second tap is elsewhere');
  assert.equal((await server.job(job.id)).state, 'paused');
  await page.getByRole('button', { name: 'End it' }).click();
  await server.state(job.id, 'cancelled');
});

test('a pause is shown in under 300 ms and paused by the key p on any view', async () => {
  const job = await server.queue(ladder(300), { name: 'by key' });
  await server.cut(job.id);
  const { page, acts } = await look({ hash: '#/settings' });
  await page.locator('.pause-bar .pause-button').waitFor();
  // Whatever popcutd answers, and when.
  let answer;
  const held = new Promise((done) => { answer = done; });
  await page.route('**/actions/pause', async (route) => { await held; await route.continue(); });
  const shown_ms = await page.evaluate(() => new Promise((done) => {
    const since = performance.now();
    dispatchEvent(new KeyboardEvent('keydown', { key: 'p' }));
    const look = () => (/PAUSING|PAUSED/.test(document.querySelector('.pause-bar').textContent)
      ? done(performance.now() - since) : requestAnimationFrame(look));
    look();
  }));
  answer();
  if (process.env.POPCUT_JUDGE_TIME) assert.ok(shown_ms < 300, `${shown_ms} ms`);
  await server.state(job.id, 'paused');
  // Repeated until it is answered, always with one key.
  assert.ok(acts('pause').length >= 1);
  assert.equal(new Set(acts('pause').map((one) => one.headers['idempotency-key'])).size, 1);
  assert.equal(acts('pause')[0].headers['if-match'], '*');
});

test('a warning that the cut may be spoiled is read and accepted before Arm', async () => {
  const tight = `<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="0 0 60 60"><path fill="none" stroke="#000" d="M10 10H50V50"/></svg>`;
  const job = await server.queue(tight.replace(' width="60mm" height="60mm"', ' width="60" height="60"'), { name: 'no unit' });
  if (job.unaccepted_warnings.length === 0) throw new Error(`no warning: ${JSON.stringify(job.warnings)}`);
  const { page, acts } = await look({ hash: machineHash() });
  await page.locator('.arm').waitFor();
  await tickAll(page);
  assert.equal(await page.locator('.arm').isDisabled(), true, 'Arm is off until the warning is accepted');
  for (const warning of job.warnings) {
    assert.ok((await page.locator('.machine-act').textContent()).includes(warning.message.replace(/`/g, '')));
  }
  for (const accept of await page.locator('.warning input').all()) await accept.check();
  await page.locator('.arm').click();
  await until(() => acts('arm').length === 1, 'arm is sent');
  assert.deepEqual(JSON.parse(acts('arm')[0].body).accept_warnings, [...new Set(job.unaccepted_warnings)]);
  await server.state(job.id, 'armed');
});
