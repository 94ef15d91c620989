// What the page shows when popcutd is away, the session ends or time passes.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { armHere, closeBrowser, expectComplaints, ladder, machineHash, refused, Server, tickAll, unreachable, until, visit,
  wait } from './harness.mjs';

let server;

before(async () => { server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 2 }] }); });
after(async () => { await closeBrowser(); await server.remove(); });

test('after a crash of popcutd the page is right again by itself, and a cut that it broke is shown as interrupted', async () => {
  const job = await server.queue(ladder(300), { name: 'restarted' });
  await server.cut(job.id);
  const { page, sent, complaints, close } = await visit(server, { hash: machineHash() });
  expectComplaints(page, unreachable, /ERR_INCOMPLETE_CHUNKED_ENCODING/);
  await page.locator('.pause-big').waitFor();
  const stopped = server.port;
  await server.kill();
  await page.getByText(/popcutd does not answer/).waitFor({ timeout: 60_000 });
  await page.getByText('restarted').first().waitFor();
  assert.ok(Number(await page.evaluate(() => getComputedStyle(document.querySelector('main')).opacity)) < 0.7, 'old looks old');
  await server.run(`127.0.0.1:${stopped}`);
  await page.getByText('Interrupted', { exact: true }).waitFor({ timeout: 60_000 });
  await until(() => page.locator('.live-on').count(), 'live again');
  assert.equal(await page.getByText(/popcutd does not answer/).count(), 0);
  assert.deepEqual(sent.filter((one) => one.path.includes('/actions/')), [], 'nothing is done by itself');
  assert.deepEqual(complaints, []);
  await close();
  await server.act(job.id, 'cancel');
});

test('a page that slept for an hour says how old it is, and is right as soon as it wakes', async () => {
  const { page, complaints, close } = await visit(server, {});
  await page.clock.install();
  await page.reload();
  await page.locator('.live-on').waitFor();
  await page.clock.pauseAt(new Date(Date.now() + 1000));
  const job = await server.queue(ladder(5), { name: 'while asleep' });
  await page.clock.fastForward('01:00:00');
  await page.clock.resume();
  await page.getByText('while asleep').waitFor();
  await page.locator('.live-on').waitFor({ timeout: 60_000 });
  assert.equal(await page.getByText(/popcutd does not answer/).count(), 0);
  assert.deepEqual(complaints, []);
  await close();
  await server.act(job.id, 'cancel');
});

test('a stream that is cut comes back with what was missed', async () => {
  const { page, complaints, close } = await visit(server, {});
  expectComplaints(page, unreachable);
  await page.locator('.live-on').waitFor();
  await page.context().setOffline(true);
  const job = await server.queue(ladder(5), { name: 'missed' });
  await wait(600);
  await page.context().setOffline(false);
  await page.getByText('missed').waitFor();
  await page.locator('.live-on').waitFor();
  assert.deepEqual(complaints, []);
  await close();
  await server.act(job.id, 'cancel');
});

test('when the token is revoked the page says so, keeps what it showed, and can do nothing', async () => {
  const job = await server.queue(ladder(5), { name: 'revoked' });
  const { page, sent, complaints, close } = await visit(server, { hash: machineHash(), name: 'guest' });
  expectComplaints(page, refused(401));
  await page.locator('.arm').waitFor();
  await tickAll(page);
  const { items } = await server.must('GET', '/v1/tokens');
  const guest = items.find((one) => one.name === 'guest');
  await server.must('DELETE', `/v1/tokens/${guest.id}`);
  await page.getByText('Your session is over.').waitFor({ timeout: 60_000 });
  await page.getByText('revoked').first().waitFor();
  assert.equal(await page.locator('.arm').isDisabled(), true);
  assert.equal(await page.locator('.machine-head').isVisible(), true);
  await page.locator('.arm').click({ force: true });
  await wait(300);
  assert.deepEqual(sent.filter((one) => one.path.includes('/actions/')), []);
  assert.deepEqual(complaints, []);
  await close();
  await server.act(job.id, 'cancel');
});

test('a one-shot word is out of the address before the page shows, and is good once', async () => {
  const link = await server.link('viewer');
  const { page, complaints, close } = await visit(server, { signIn: false });
  expectComplaints(page, refused(401));
  await page.getByText('Sign in', { exact: true }).waitFor();
  await page.goto(link);
  await page.locator('.bar-person').waitFor();
  assert.equal(new URL(page.url()).hash, '#/');
  assert.equal(await page.evaluate(() => Object.keys(localStorage).some((name) => name.includes('token'))), false);
  const again = await visit(server, { signIn: false });
  expectComplaints(again.page, refused(401));
  await again.page.goto('about:blank');
  await again.page.goto(link);
  await again.page.getByText(/This link was used already/).waitFor();
  assert.equal(new URL(again.page.url()).hash, '#/');
  assert.deepEqual([...complaints, ...again.complaints], []);
  await again.close();
  await close();
});

test('a job that is planned says in its row what popcutd is doing', async () => {
  const slow = { popcut: 1, surface: { type: 'revolution', radius: 'sqrt(70^2 - (y - 45)^2)' }, lattice: 'conformal',
    units_per_slice: 30, slices: 60, widths_mm: 1.5, min_panel_mm: 0.2 };
  const { id } = await server.must('POST', '/v1/designs', slow);
  const { page, complaints, close } = await visit(server, {});
  await page.locator('.live-on').waitFor();
  const job = await server.must('POST', '/v1/jobs', { design: id, name: 'many units' },
    { headers: { 'Idempotency-Key': crypto.randomUUID() } });
  const row = page.locator('.job-row').filter({ hasText: 'many units' });
  await row.getByText(/^(laying the lattice|checking the pattern)/).waitFor();
  await server.act(job.id, 'cancel');
  await row.waitFor({ state: 'detached' });
  assert.deepEqual(complaints, []);
  await close();
});

test('a tablet is let in by a code that somebody allows, with a role at most theirs', async () => {
  const tablet = await visit(server, { signIn: false, screen: 'tablet' });
  await tablet.page.getByLabel('Name of this screen').fill('by the window');
  await tablet.page.getByRole('button', { name: 'Show a code' }).click();
  const code = (await tablet.page.locator('.pair-code').textContent()).trim();
  assert.match(code, /^[A-HJ-NP-Z2-9]{6}$/);
  const desk = await visit(server, { role: 'operator', hash: '#/settings' });
  expectComplaints(desk.page, refused(404));
  await desk.page.getByLabel('May act as').waitFor();
  const roles = await desk.page.getByLabel('May act as').locator('option').allTextContents();
  assert.deepEqual(roles, ['viewer', 'submitter', 'operator'], 'no role above the own one');
  await desk.page.getByLabel('Code').fill('AAAAAA');
  await desk.page.getByRole('button', { name: 'Allow' }).click();
  await desk.page.locator('.note-bad').waitFor();
  await desk.page.getByLabel('Code').fill(code.toLowerCase());
  await desk.page.getByLabel('May act as').selectOption('submitter');
  await desk.page.getByRole('button', { name: 'Allow' }).click();
  await desk.page.getByText('"by the window" is signed in as submitter.').waitFor();
  await tablet.page.locator('.bar-person').waitFor();
  assert.match(await tablet.page.locator('.bar-person').textContent(), /submitter/);
  assert.deepEqual([...tablet.complaints, ...desk.complaints], []);
  await tablet.close();
  await desk.close();
});
