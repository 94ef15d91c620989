// Now: what a person does with a job that waits.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { closeBrowser, ladder, picture, Server, until, visit } from './harness.mjs';

let server;

before(async () => { server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 2 }, { id: 'sim:cameo4', time_scale: 20 }] }); });
after(async () => { await closeBrowser(); await server.remove(); });

test('a job that nothing is cut of is planned for another cutter, and starts nowhere', async () => {
  const job = await server.queue(ladder(12), { name: 'moves' });
  const { page, complaints, sent, close } = await visit(server, {});
  const row = page.locator('.job-row', { hasText: 'moves' });
  await row.getByRole('button', { name: /moves/ }).click();
  await row.getByRole('button', { name: 'Another cutter' }).click();
  const dialog = page.getByRole('dialog');
  await dialog.getByRole('combobox', { name: /^Cutter/ }).selectOption('sim:cameo4');
  await picture(page, 'now-other-cutter');
  await dialog.getByRole('button', { name: 'Plan it for this one' }).click();
  await dialog.waitFor({ state: 'detached' });
  const planned = await server.state(job.id, 'ready');
  assert.equal(planned.device, 'sim:cameo4');
  assert.notEqual(planned.plan, job.plan);
  await row.getByText(/Cameo 4/).waitFor();
  await until(async () => (await row.getByRole('link').getAttribute('href')).includes('cameo4'), 'the row leads to the other cutter');
  assert.deepEqual(sent.map(({ method, path }) => `${method} ${path}`).filter((one) => /start|arm/.test(one)), []);
  assert.deepEqual(complaints, []);
  await close();
});

test('a job that is being cut offers no other cutter', async () => {
  const job = await server.queue(ladder(40), { name: 'stays' });
  await server.cut(job.id);
  const { page, close } = await visit(server, {});
  const row = page.locator('.job-row', { hasText: 'stays' });
  await row.waitFor();
  assert.equal(await row.getByRole('button', { name: /stays/ }).count(), 0);
  await close();
});
