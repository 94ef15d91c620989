// The whole way of a card: from an example over a changed slider and an exact design to a cut that is done.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { armHere, closeBrowser, hold, picture, Server, until, visit } from './harness.mjs';

let server;

before(async () => { server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 100 }] }); });
after(async () => { await closeBrowser(); await server.remove(); });

/** Waits until the exact design is shown. */
const exact = (page) => page.locator('.badge', { hasText: 'exact' }).waitFor({ timeout: 60_000 });

/** Arms and starts each sheet that is to be loaded, until the job is done. */
async function cutAll(page, id) {
  for (let sheet = 1; ; sheet++) {
    await armHere(page);
    if (sheet === 1) await picture(page, 'way-armed');
    await hold(page);
    const { state } = await until(async () => {
      const now = await server.job(id);
      return ['done', 'ready'].includes(now.state) && (now.state === 'done' || now.sheet > sheet) && now;
    }, `sheet ${sheet} is cut`, 60_000);
    if (state === 'done') return sheet;
  }
}

for (const screen of ['desktop', 'tablet']) {
  test(`from an example to a card in Done, on a ${screen}`, async () => {
    const { page, sent, acts, complaints, close } = await visit(server, { screen, motion: 'reduce' });
    await page.getByRole('link', { name: 'Design', exact: true }).click();
    await page.locator('.start-card:not(:disabled)', { hasText: 'unit' }).click();
    await exact(page);

    const slider = page.getByLabel('Steps in a slice (N)');
    await slider.scrollIntoViewIfNeeded();
    const box = await slider.boundingBox();
    const at = (n) => box.x + 11 + (box.width - 22) * ((n - 1) / 13);
    await page.mouse.move(at(Number(await slider.inputValue())), box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(at(3), box.y + box.height / 2, { steps: 8 });
    await page.mouse.up();
    assert.equal(await slider.inputValue(), '3');
    await exact(page);
    await page.getByLabel('Name of the design').fill(`way on a ${screen}`);
    await page.getByLabel('Name of the design').press('Enter');
    await exact(page);
    const spec = await page.evaluate(() => {
      const { steps, at: step } = JSON.parse(sessionStorage.getItem('popcut.design.steps'));
      return JSON.parse(steps[step]);
    });
    assert.equal(spec.units_per_slice, 3);
    assert.ok(sent.every((one) => ['/v1/preview', '/v1/session'].includes(one.path)), 'until here nothing is stored');
    await page.evaluate(() => scrollTo(0, 0));
    await picture(page, `way-design-${screen}`);

    await page.getByRole('button', { name: 'Cut this…' }).click();
    await page.getByRole('dialog').getByRole('combobox', { name: /^Cutter/ }).selectOption('sim:cameo3');
    await picture(page, `way-cut-${screen}`);
    await page.getByRole('button', { name: 'Show the sheets' }).click();
    await page.locator('.plan-canvas[data-strokes]:not([data-strokes=""])').waitFor({ timeout: 60_000 });
    const plan = await server.must('GET', `/v1/plans/${new URL(page.url()).hash.split('/').at(-1)}`);
    assert.equal(Number(await page.locator('.plan-canvas').getAttribute('data-strokes')), plan.sheets[0].paths);
    assert.deepEqual(await server.must('GET', `/v1/designs/${plan.design}/content`), spec, 'what is planned is what was shown');
    await picture(page, `way-sheets-${screen}`);

    await page.getByRole('button', { name: 'Queue it' }).click();
    await page.getByText('It is in the queue.', { exact: false }).waitFor();
    await page.getByRole('link', { name: 'Go to Now' }).click();
    await page.getByRole('link', { name: 'Go to machine' }).click();
    const { items: [{ id }] } = await server.must('GET', '/v1/queue');
    const sheets = await cutAll(page, id);
    await page.getByText(`"way on a ${screen}" is cut`).waitFor();
    await picture(page, `way-cut-done-${screen}`);
    assert.equal(acts('arm').length, sheets);
    assert.equal(acts('start').length, sheets);

    await page.getByRole('link', { name: 'Done', exact: true }).click();
    const row = page.locator('.job-row', { hasText: `way on a ${screen}` });
    await row.getByText('done').waitFor();
    await until(() => row.locator('img').evaluate((img) => img.complete && img.naturalWidth > 0).catch(() => false), 'its picture is there');
    await picture(page, `way-done-${screen}`);
    assert.deepEqual(sent.map((one) => one.path.split('/').at(-1)).filter((name) => name !== 'preview' && name !== 'session'),
      ['designs', 'plan', 'jobs', ...Array.from({ length: sheets }, () => ['arm', 'start']).flat()], 'each act is sent once');
    assert.deepEqual(complaints, []);
    await close();
  });
}
