// PAUSE when popcutd does not answer.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { closeBrowser, expectComplaints, ladder, machineHash, refused, Server, unreachable, until, visit, wait } from './harness.mjs';

// What popcutd held while it was stopped it may refuse when it goes on: 'popcutd is not answering'.
const stopped = [unreachable, refused(503)];

let server;

before(async () => { server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 2 }] }); });
after(async () => { await closeBrowser(); await server.remove(); });

test('a PAUSE that does not arrive says NOT SENT, repeats, arrives once, and says so', async () => {
  const job = await server.queue(ladder(300), { name: 'stopped server' });
  await server.cut(job.id);
  const { page, acts, complaints, close } = await visit(server, { hash: machineHash() });
  expectComplaints(page, ...stopped);
  await page.locator('.pause-bar .pause-button').waitFor();
  const before = await server.attempts(job.id);
  server.program.kill('SIGSTOP');
  try {
    await page.locator('.pause-bar .pause-button').click();
    await page.locator('.pause-bar').getByText('PAUSING').waitFor();
    await page.locator('.pause-bar').getByText('NOT SENT').waitFor();
    await page.locator('.pause-bar').getByText('Use the switch of the machine.').waitFor();
    assert.equal(await page.locator('.not-sent').first().getAttribute('role'), 'alert');
    await until(() => acts('pause').length >= 3, 'it repeats');
  } finally {
    server.program.kill('SIGCONT');
  }
  await page.locator('.pause-bar').getByText(/It got through after \d/).waitFor();
  await server.state(job.id, 'paused');
  assert.equal(new Set(acts('pause').map((one) => one.headers['idempotency-key'])).size, 1, 'one key for all repetitions');
  const many = acts('pause').length;
  await wait(1500);
  assert.equal(acts('pause').length, many, 'it stops repeating');
  assert.equal(await server.attempts(job.id), before);
  const events = await server.must('GET', `/v1/jobs/${job.id}/events`);
  assert.equal(events.items.filter((one) => one.kind === 'job' && one.state === 'paused').length, 1, 'paused once');
  assert.deepEqual(complaints, []);
  await close();
  await server.act(job.id, 'cancel');
  await server.state(job.id, 'cancelled');
});

test('a PAUSE gives up after ten seconds, still says NOT SENT, and can be pressed again', async () => {
  const job = await server.queue(ladder(300), { name: 'no server' });
  await server.cut(job.id);
  const { page, acts, complaints, close } = await visit(server, {});
  expectComplaints(page, ...stopped);
  await page.locator('.pause-bar .pause-button').waitFor();
  server.program.kill('SIGSTOP');
  try {
    await page.keyboard.press('p');
    await page.locator('.pause-bar').getByText('NOT SENT').waitFor();
    await wait(10_500);
    const many = acts('pause').length;
    await wait(1200);
    assert.equal(acts('pause').length, many, 'it gave up');
    await page.locator('.pause-bar').getByText('NOT SENT').waitFor();
    await page.locator('.pause-bar .pause-button').click();
    await until(() => acts('pause').length > many, 'it is sent again');
  } finally {
    server.program.kill('SIGCONT');
  }
  await server.state(job.id, 'paused');
  assert.deepEqual(complaints, []);
  await close();
});

test('PAUSE works while what is shown is old, and all other acts are off', async () => {
  const { items: [job] } = await server.must('GET', '/v1/jobs?state=paused');
  await server.act(job.id, 'resume');
  const { page, acts, complaints, close } = await visit(server, { hash: machineHash() });
  expectComplaints(page, ...stopped);
  await page.locator('.pause-bar .pause-button').waitFor();
  await page.route('**/v1/events', (route) => route.abort());
  server.program.kill('SIGSTOP');
  try {
    await page.getByText(/popcutd does not answer/).waitFor({ timeout: 60_000 });
    assert.equal(await page.getByRole('button', { name: 'End the job' }).isDisabled(), true);
  } finally {
    server.program.kill('SIGCONT');
  }
  await page.locator('.pause-bar .pause-button').click();
  await server.state(job.id, 'paused');
  assert.equal(acts('pause').length, 1);
  assert.deepEqual(complaints, []);
  await close();
});
