// A session that ends, a popcutd that asks to wait, and one that was replaced: what a page keeps and what it does alone.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { armHere, closeBrowser, expectComplaints, ladder, machineHash, picture, refused, Server, tickAll, unitSpec, unreachable, until, visit,
  wait } from './harness.mjs';

const kLife_s = 60;      // the shortest that popcutd gives

let server;
let open = [];
let brief;               // a browser whose token expires while the other tests run

/** A browser that is closed after the test, where nothing may have gone wrong. */
async function look(options) {
  const one = await visit(server, { motion: 'reduce', ...options });
  open.push(one);
  return one;
}

before(async () => {
  server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 20 }] });
  const { token } = await server.must('POST', '/v1/tokens', { role: 'operator', name: 'brief', lifetime_s: kLife_s });
  const { one_shot } = await server.must('POST', '/v1/session/one-shot', {}, { token });
  brief = { ...await visit(server, { signIn: false, motion: 'reduce' }), since: Date.now() };
  expectComplaints(brief.page, refused(401));
  await brief.page.goto(`${server.address}/#t=${encodeURIComponent(one_shot)}`);
  await brief.page.locator('.bar-person').waitFor();
  await drafted(brief.page);
});
after(async () => { await brief.close(); await closeBrowser(); await server.remove(); });

afterEach(async () => {
  await server.limit({});
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

/** Waits until the exact design is shown. */
const exact = (page) => page.locator('.badge', { hasText: 'exact' }).waitFor({ timeout: 60_000 });

const specOf = (page) => page.evaluate(() => {
  const { steps, at } = JSON.parse(sessionStorage.getItem('popcut.design.steps'));
  return JSON.parse(steps[at]);
});

/** A design on the desk that differs from its example: a draft that is kept nowhere else. */
async function drafted(page) {
  await page.evaluate(() => { location.hash = '#/design/example/unit'; });
  await exact(page);
  await moveUnits(page, 'ArrowRight');
  await exact(page);
}

async function moveUnits(page, key) {
  await page.getByLabel('Steps in a slice (N)').focus();
  await page.keyboard.press(key);
}

const opacityOfMain = (page) => page.evaluate(() => Number(getComputedStyle(document.querySelector('main')).opacity));

/** Somebody who is signed in lets the screen in that shows a code. */
async function allowedAgain(page) {
  await page.getByRole('button', { name: 'Show a code' }).click();
  const code = (await page.locator('.pair-code').textContent()).trim();
  const { token } = await server.token('operator', 'desk');
  await server.must('POST', '/v1/session/pair/allow', { code, role: 'operator' }, { token });
  await page.locator('.sign-again').waitFor({ state: 'detached' });
  await page.locator('.live-on').waitFor();
}

/** What must hold for a design whose session is over, and after it is signed in again. */
async function keptThrough(page, sent) {
  await page.getByText('Your session is over.').waitFor({ timeout: 60_000 });
  await until(async () => await opacityOfMain(page) < 0.7, 'what was there is greyed');
  assert.equal(await page.locator('.design').isVisible(), true);
  const before = await specOf(page);
  const told = sent.length;
  assert.equal(await page.getByRole('button', { name: 'Cut this…' }).isDisabled(), true, 'no way to cut');
  await page.getByRole('button', { name: 'Cut this…' }).click({ force: true });
  assert.equal(await page.locator('dialog').count(), 0);
  await moveUnits(page, 'ArrowRight');       // a hand that goes on: the draft is kept, too
  await until(async () => (await specOf(page)).units_per_slice === before.units_per_slice + 1, 'the draft goes on');
  assert.equal(await page.locator('.badge', { hasText: 'exact' }).count(), 0, 'what is shown is not the exact one of this spec');
  assert.deepEqual(sent.slice(told), [], 'nothing is sent with a token that is good for nothing');
  const drafted_ = await specOf(page);
  await picture(page, 'session-over');
  await allowedAgain(page);
  assert.equal(new URL(page.url()).hash, '#/design');
  await exact(page);
  assert.deepEqual(await specOf(page), drafted_);
  assert.equal(await page.getByLabel('Steps in a slice (N)').inputValue(), String(drafted_.units_per_slice));
  await until(async () => await opacityOfMain(page) === 1, 'it is live again');
  assert.equal(await page.getByRole('button', { name: 'Cut this…' }).isDisabled(), false);
  assert.equal(await page.locator('.design .note-bad').count(), 0, 'no refusal of before stays');
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  assert.deepEqual(await specOf(page), before, 'steps are kept');
}

test('a token revoked while a design is edited: it stays, greyed, and signing in goes on with the draft', async () => {
  const { page, sent } = await look({ name: 'guest' });
  expectComplaints(page, refused(401));
  await drafted(page);
  const { items } = await server.must('GET', '/v1/tokens');
  await server.must('DELETE', `/v1/tokens/${items.find((one) => one.name === 'guest').id}`);
  await keptThrough(page, sent);
});

test('a token revoked while the sheets are looked at: nothing can be queued, then it can', async () => {
  const job = await server.queue(ladder(5), { name: 'looked at' });
  const { page, acts, sent } = await look({ name: 'guest at sheets', hash: `#/sheets/${job.plan}` });
  expectComplaints(page, refused(401));
  await page.getByRole('button', { name: 'Queue it' }).waitFor();
  const { items } = await server.must('GET', '/v1/tokens');
  await server.must('DELETE', `/v1/tokens/${items.find((one) => one.name === 'guest at sheets').id}`);
  await page.getByText('Your session is over.').waitFor({ timeout: 60_000 });
  assert.equal(await page.getByRole('button', { name: 'Queue it' }).isDisabled(), true);
  await page.getByRole('button', { name: 'Queue it' }).click({ force: true });
  assert.deepEqual([...acts('arm'), ...sent.filter((one) => one.path === '/v1/jobs')], []);
  await allowedAgain(page);
  assert.equal(new URL(page.url()).hash, `#/sheets/${job.plan}`);
  await page.getByRole('button', { name: 'Queue it' }).click();
  await page.getByText('It is in the queue.', { exact: false }).waitFor();
});

/** Uses up what popcutd takes from this browser at once. */
async function drain(page) {
  const token = await page.evaluate(() => sessionStorage.getItem('popcut.token'));
  for (let i = 0; i < 20; i++) if ((await server.ask('GET', '/v1/materials?limit=1', undefined, { token })).status === 429) return;
  throw new Error('popcutd refuses nothing');
}

/** Answers to requests of `page`, as they come: {method, path, status}. */
function answersOf(page) {
  const seen = [];
  page.on('response', (response) => seen.push({ method: response.request().method(), path: new URL(response.url()).pathname, status: response.status() }));
  return seen;
}

test('too many reads: the wait is counted down, and they are repeated by themselves', async () => {
  const { page } = await look({});
  expectComplaints(page, refused(429));
  await page.locator('.live-on').waitFor();
  const seen = answersOf(page);
  await server.limit({ rate_per_s: 0.4, rate_burst: 1 });
  await drain(page);
  await page.evaluate(() => { location.hash = '#/done'; });
  const counted = new Set();
  await until(async () => {
    const text = await page.locator('.band', { hasText: 'asks to wait' }).textContent({ timeout: 100 }).catch(() => '');
    const left = /wait (\d+) s; this repeats by itself/.exec(text)?.[1];
    if (left) counted.add(left);
    return counted.size >= 2;
  }, 'it is counted down');
  await picture(page, 'session-wait');
  const statuses = (path) => seen.filter((one) => one.path === path).map((one) => one.status);
  await until(() => statuses('/v1/usage').includes(200) && statuses('/v1/jobs').includes(200), 'both are read', 30_000);
  assert.ok(statuses('/v1/usage').includes(429) || statuses('/v1/jobs').includes(429));
  assert.equal(await page.locator('.note-bad').count(), 0);
  await page.locator('.band', { hasText: 'asks to wait' }).waitFor({ state: 'detached' });
});

test('too many acts: the act is refused with a sentence, is not repeated, and pressing again does it once', async () => {
  const job = await server.queue(ladder(5), { name: 'refused' });
  const { page, acts } = await look({ hash: machineHash() });
  expectComplaints(page, refused(429));
  await page.locator('.arm').waitFor();
  await tickAll(page);
  const seen = answersOf(page);
  await server.limit({ rate_per_s: 0.4, rate_burst: 1 });
  await drain(page);
  await page.locator('.arm').click();
  await page.getByText('Too many requests.').waitFor();
  await server.limit({});
  await wait(3500);        // longer than popcutd asked to wait
  assert.equal(acts('arm').length, 1, 'an act is never repeated by the page');
  assert.deepEqual(seen.filter((one) => one.path.endsWith('/arm')).map((one) => one.status), [429]);
  assert.equal((await server.job(job.id)).state, 'ready');
  for (const tick of await page.locator('.machine-act .ticks input').all()) assert.equal(await tick.isChecked(), true);
  await page.locator('.arm').click();
  await server.state(job.id, 'armed');
  assert.equal(acts('arm').length, 2);
});

test('too many previews: the last input is asked for again by itself', async () => {
  const { page, sent } = await look({});
  expectComplaints(page, refused(429));
  await drafted(page);
  await server.limit({ previews_per_s: 0.5 });
  for (let i = 0; i < 3; i++) {
    await moveUnits(page, 'ArrowRight');
    await wait(200);
  }
  const { units_per_slice: last } = await specOf(page);
  await page.getByText(/asks to wait \d+ s; this repeats by itself/).waitFor();
  assert.equal(await page.locator('.badge', { hasText: 'exact' }).count(), 0);
  await exact(page);
  assert.equal(await page.locator('.design .note-bad').count(), 0);
  const asked = sent.filter((one) => one.path === '/v1/preview').map((one) => JSON.parse(one.body));
  assert.equal(asked.at(-1).spec.units_per_slice, last);
  assert.equal(asked.at(-1).quality, 'exact');
});

test('a gesture that ends while popcutd is away is drawn as soon as it is back', async () => {
  const { page, context } = await look({});
  expectComplaints(page, unreachable);
  await drafted(page);
  await context.setOffline(true);
  await moveUnits(page, 'ArrowRight');
  const spec = await specOf(page);
  await page.getByText('popcutd does not answer.').waitFor();
  assert.equal(await page.locator('.badge', { hasText: 'exact' }).count(), 0);
  for (const name of ['Share', 'Save']) assert.equal(await page.getByRole('button', { name, exact: true }).isDisabled(), true, name);
  await context.setOffline(false);
  await exact(page);
  assert.equal(await page.locator('.design .note-bad').count(), 0);
  assert.deepEqual(await specOf(page), spec);
});

test('a view that is opened while popcutd is away is there as soon as it is back', async () => {
  const job = await server.queue(unitSpec, { name: 'read again' });
  const { page, context } = await look({});
  expectComplaints(page, unreachable);
  // The parts of the page itself come first.
  await page.evaluate((plan) => { location.hash = `#/sheets/${plan}`; }, job.plan);
  await page.getByRole('button', { name: 'Queue it' }).waitFor();
  await page.evaluate((plan) => { location.hash = `#/glue/${plan}`; }, job.plan);
  await page.getByText(/^Step 1 of/).waitFor();
  const views = [
    [`#/sheets/${job.plan}`, page.locator(`.plan-canvas:not([data-strokes=""])`)],
    [`#/glue/${job.plan}`, page.getByText(/^Step 1 of/)],
    ['#/done', page.locator('.done .muted, .done .job-list')],
    ['#/design/example/unit', page.locator('.badge', { hasText: 'exact' })],
  ];
  let missed = 0;
  for (const [hash, there] of views) {
    await page.evaluate(() => { location.hash = '#/settings'; });
    await page.locator('.settings').waitFor();
    await context.setOffline(true);
    await page.evaluate((to) => { location.hash = to; }, hash);
    const note = page.getByText('popcutd does not answer.');
    await note.or(there).first().waitFor();          // what never changes the browser may have kept
    missed += await note.count();
    await context.setOffline(false);
    await there.first().waitFor();
    await page.locator('.note-bad').waitFor({ state: 'detached' });
  }
  assert.ok(missed >= 2, `${missed} reads failed`);
});

/** From now on popcutd seems to carry another page, to `page`; it is told as the connection comes back. */
async function replaced(page, stamp) {
  await page.unroute('**/v1/meta');
  await page.route('**/v1/meta', async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, json: { ...await response.json(), page: stamp, build: stamp } });
  });
  await page.context().setOffline(true);
  await page.context().setOffline(false);
}

/** A mark that a reload takes away. */
const mark = (page) => page.evaluate(() => { window.same = true; });
const isSame = (page) => page.evaluate(() => window.same === true).catch(() => false);
const notice = (page) => page.getByText('popcutd was updated.');

test('after an update the page loads again by itself, once, where nothing can be lost', async () => {
  const { page } = await look({ hash: '#/done' });
  expectComplaints(page, unreachable, /ERR_INTERNET_DISCONNECTED/);
  await page.locator('.live-on').waitFor();
  await mark(page);
  await replaced(page, 'another-page');
  await until(async () => !await isSame(page), 'it loads again');
  await page.locator('.live-on').waitFor();
  await mark(page);
  assert.equal(new URL(page.url()).hash, '#/done');
  assert.equal(await notice(page).count(), 0);
  await wait(700);
  assert.equal(await isSame(page), true, 'once is enough');
});

test('after an update the page is not loaded again while something is armed, but then', async () => {
  const job = await server.queue(ladder(5), { name: 'armed meanwhile' });
  const { page } = await look({ hash: machineHash() });
  expectComplaints(page, unreachable);
  await armHere(page);
  await mark(page);
  await replaced(page, 'a-third-page');
  await notice(page).waitFor();
  await picture(page, 'session-updated');
  await wait(500);
  assert.equal(await isSame(page), true);
  await page.locator('.hold:enabled').waitFor();
  assert.equal((await server.job(job.id)).state, 'armed');
  await page.getByRole('button', { name: 'Disarm' }).click();
  await until(async () => !await isSame(page), 'it loads again');
  assert.equal((await server.job(job.id)).state, 'ready');
});

test('after an update the page is not loaded again while a design is not saved, but then', async () => {
  const { page } = await look({});
  expectComplaints(page, unreachable);
  await drafted(page);
  await mark(page);
  await replaced(page, 'a-fourth-page');
  await notice(page).waitFor();
  await wait(500);
  assert.equal(await isSame(page), true);
  const spec = await specOf(page);
  const download = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save' }).click();
  await download;
  await until(async () => !await isSame(page), 'it loads again');
  await page.getByRole('button', { name: 'Go on with your last design' }).click();
  await exact(page);
  assert.deepEqual(await specOf(page), spec);
});

test('a token that expires while a design is edited: it stays, greyed, and signing in goes on with the draft', async () => {
  await brief.page.getByText('Your session is over.').waitFor({ timeout: Math.max(1000, brief.since + kLife_s * 1000 + 30_000 - Date.now()) });
  await keptThrough(brief.page, brief.sent);
  assert.deepEqual(brief.complaints, []);
});

test('an address with a broken word, or with a view that there is not, shows the page', async () => {
  const { page } = await look({ name: 'odd addresses' });
  for (const hash of ['#/__proto__/x', '#/constructor', '#/toString/1']) {
    await page.evaluate((to) => { location.hash = to; }, hash);
    await page.locator('main .note').waitFor();
  }
  const { page: other } = await look({ hash: '#t=%', signIn: false });
  expectComplaints(other, refused(401), refused(422), refused(404), refused(403));
  await other.getByRole('button', { name: 'Show a code' }).waitFor();
});

test('a link with the word of somebody else asks before it ends the session of the tab', async () => {
  const { page } = await look({ name: 'keeps their session' });
  const before = await page.evaluate(() => ({ ...sessionStorage }));
  const { one_shot } = await server.must('POST', '/v1/session/one-shot', {});
  const follow = () => page.evaluate((to) => { location.hash = to; }, `#t=${encodeURIComponent(one_shot)}`);
  await follow();
  await page.getByRole('button', { name: 'Stay signed in' }).click();
  assert.deepEqual(await page.evaluate(() => ({ ...sessionStorage })), before);
  await follow();
  await page.getByRole('button', { name: 'Use the link' }).click();
  await until(async () => JSON.stringify(await page.evaluate(() => ({ ...sessionStorage })).catch(() => before))
    !== JSON.stringify(before), 'another session is open');
});
