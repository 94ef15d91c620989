// A cut that breaks off, and the ways on.
import assert from 'node:assert/strict';
import { after, afterEach, test } from 'node:test';
import { armHere, closeBrowser, hold, ladder, machineHash, picture, Server, visit, wait } from './harness.mjs';

let server = null;
let open = [];

after(closeBrowser);

/** A job whose cut broke off, as the cable was out at stroke `at_path`, on a popcutd of its own; and a browser at its cutter. */
async function broken(name, lines = 40, at_path = 12) {
  server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 20,
    faults: [{ at_path, kind: 'unplug', seconds: 2 }] }] });
  const job = await server.queue(ladder(lines), { name });
  const one = await visit(server, { hash: machineHash() });
  open.push(one);
  await armHere(one.page);
  await hold(one.page);
  await server.state(job.id, 'interrupted', 60_000);
  await one.page.getByText('Look at the sheet.').waitFor();
  const ledger = await server.must('GET', `/v1/jobs/${job.id}/sheets/1/ledger`);
  return { ...one, id: job.id, ledger };
}

const strokesIn = (ranges) => ranges.reduce((sum, [first, last]) => sum + last - first + 1, 0);

afterEach(async () => {
  const complaints = open.flatMap((one) => one.complaints);
  for (const one of open) await one.close();
  open = [];
  await server?.remove();
  server = null;
  assert.deepEqual(complaints, []);
});

test('the ledger shown is the ledger of popcutd, and the first stroke in doubt is named', async () => {
  const { page, ledger } = await broken('ledger');
  const counts = (await page.locator('.fates li').allTextContents()).map((text) => Number(/\d+/.exec(text)[0]));
  assert.deepEqual(counts, [strokesIn(ledger.certain), strokesIn(ledger.in_doubt), strokesIn(ledger.not_sent)]);
  assert.ok(counts[1] > 0, 'something is in doubt');
  const first = ledger.in_doubt[0][0];
  assert.match(await page.locator('.lens-line strong').textContent(), new RegExp(`\\b${first + 1} of 40$`));
  await page.getByText('The connection to the cutter broke.').waitFor();
  await picture(page, 'interrupted-desktop-light');
});

test('New sheet takes a new blank and starts nothing', async () => {
  const { page, id, acts } = await broken('new sheet');
  assert.equal(await page.getByRole('button', { name: 'That is what I want' }).isDisabled(), true);
  await page.getByText('New sheet', { exact: true }).click();
  await page.getByRole('button', { name: 'That is what I want' }).click();
  const job = await server.state(id, 'ready');
  assert.equal(job.blank, 2);
  await page.getByText('Blank 2: take a new sheet.').waitFor();
  await wait(500);
  assert.equal((await server.job(id)).state, 'ready');
  assert.equal(acts('start').length, 1, 'only the first start');
});

test('Go on from a stroke spells out what is cut twice, wants it ticked, and starts nothing', async () => {
  const { page, id, ledger, acts } = await broken('go on');
  await page.getByText('Go on from a stroke', { exact: true }).click();
  const go = page.getByRole('button', { name: 'That is what I want' });
  assert.equal(await go.isDisabled(), true);
  await page.getByText('I load it again, in the same place').click();
  const twice = strokesIn(ledger.in_doubt);
  const tick = page.getByText(`I accept that ${twice} ${twice === 1 ? 'stroke' : 'strokes'} may be cut twice.`);
  await tick.waitFor();
  assert.equal(await go.isDisabled(), true, 'the risk is not ticked yet');
  await tick.click();
  await go.click();
  await server.state(id, 'ready');
  const body = JSON.parse(acts('resume-from')[0].body);
  assert.equal(body.from_path, ledger.in_doubt[0][0]);
  assert.equal(body.i_accept_double_cut, true);
  assert.equal(body.registration, 're-registered');
  await wait(500);
  assert.equal((await server.job(id)).state, 'ready');
  assert.equal(acts('start').length, 1);
});

test('going on behind the strokes in doubt spells out how many may stay uncut', async () => {
  const { page, id, ledger, acts } = await broken('leave out');
  await page.getByText('Go on from a stroke', { exact: true }).click();
  const next = page.getByRole('button', { name: 'One stroke on' });
  const doubt = strokesIn(ledger.in_doubt);
  for (let i = 0; i < doubt; ++i) await next.click();
  await page.getByText('I load it again, in the same place').click();
  await page.getByText(`I accept that ${doubt} ${doubt === 1 ? 'stroke' : 'strokes'} may stay uncut.`).click();
  await page.getByRole('button', { name: 'That is what I want' }).click();
  await server.state(id, 'ready');
  const body = JSON.parse(acts('resume-from')[0].body);
  assert.equal(body.from_path, ledger.in_doubt.at(-1)[1] + 1);
  assert.equal(body.skip_in_doubt, true);
  assert.equal(body.i_accept_double_cut, undefined);
});

test('It is whole is not offered while strokes were never sent', async () => {
  const { page, ledger } = await broken('not whole');
  await page.getByText(`It cannot be: ${strokesIn(ledger.not_sent)} strokes were never sent.`).waitFor();
  assert.equal(await page.locator('.option', { hasText: 'It is whole' }).locator('input').isDisabled(), true);
});

test('It is whole completes the sheet without cutting', async () => {
  const { page, id, acts, ledger } = await broken('whole', 6, 6);
  assert.deepEqual(ledger.not_sent, []);
  await page.getByText('It is whole', { exact: true }).click();
  await page.getByRole('button', { name: 'That is what I want' }).click();
  await server.state(id, 'done');
  assert.equal(JSON.parse(acts('confirm-result')[0].body).good, true);
  assert.equal(acts('start').length, 1);
});

test('Give up ends the job', async () => {
  const { page, id, acts } = await broken('give up');
  await page.getByText('Give up', { exact: true }).click();
  await page.getByRole('button', { name: 'That is what I want' }).click();
  await server.state(id, 'cancelled');
  assert.equal(acts('start').length, 1);
});
