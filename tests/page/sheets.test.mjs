// Sheets and Glue in a real browser against a real popcutd.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { axeSource, bytesOf, closeBrowser, picture, Server, until, visit, wait } from './harness.mjs';

const popcut = process.env.POPCUT ?? 'popcut';
const card = JSON.parse(readFileSync(new URL('../../docs/words/card.json', import.meta.url), 'utf8'));
let server;

before(async () => { server = await Server.start(); });
after(async () => { await closeBrowser(); await server.remove(); });

/** A plan of `spec`, when it is planned. */
async function planned(spec, body = {}) {
  const { id } = await server.must('POST', '/v1/designs', JSON.stringify(spec));
  const plan = await server.must('POST', `/v1/designs/${id}/plan`, body);
  return until(async () => {
    const now = await server.must('GET', `/v1/plans/${plan.id}`);
    assert.notEqual(now.state, 'failed', now.error);
    return now.state === 'planned' && now;
  }, 'it is planned', 60_000);
}

/** Polylines of strokes, in their order. */
function polylines({ stroke, xy_mm }) {
  let at = 0;
  return stroke.points.map((n) => {
    const line = Array.from({ length: n }, (_, k) => [xy_mm[at + 2 * k], xy_mm[at + 2 * k + 1]]);
    at += 2 * n;
    return line;
  });
}

function away([x, y], line) {
  let least = Infinity;
  for (let i = 1; i < line.length; i++) {
    const [[ax, ay], [bx, by]] = [line[i - 1], line[i]];
    const [dx, dy] = [bx - ax, by - ay];
    const t = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
    least = Math.min(least, Math.hypot(x - ax - t * dx, y - ay - t * dy));
  }
  return least;
}

test('the strokes that are played back are those of the sheet\'s drawing and of the simulated cut', async () => {
  const plan = await planned(card);
  const strokes = await server.must('GET', `/v1/plans/${plan.id}/sheets/1/strokes`);
  const played = polylines(strokes);
  const svg = await server.must('GET', `/v1/plans/${plan.id}/sheets/1.svg`);
  const drawn = new Map([...svg.matchAll(/<path d="M([^"]*)"[^>]*data-order="(\d+)"/g)].map(([, d, order]) => [
    Number(order), d.split(/[L ]/).map((pair) => pair.split(',').map(Number)),
  ]));
  assert.equal(played.length, drawn.size);
  played.forEach((line, i) => {
    const of = drawn.get(i + 1);
    // Rounded to 0.001 mm here, to 0.000001 mm there.
    for (const point of line) assert.ok(away(point, of) < 0.0015, `stroke ${i} at ${point} is on the drawing's line`);
    for (const point of of) assert.ok(away(point, line) < 0.0015, `the drawing's line ${i + 1} at ${point} is played`);
  });
  const folder = mkdtempSync(join(tmpdir(), 'popcut-trace-'));
  try {
    const { token } = await server.token('viewer', 'reader');
    const program = await fetch(`${server.address}/v1/plans/${plan.id}/sheets/1/program`, { headers: { Authorization: `Bearer ${token}` } });
    writeFileSync(join(folder, 'sheet.gpgl'), Buffer.from(await program.arrayBuffer()));
    execFileSync(popcut, ['simulate', join(folder, 'sheet.gpgl'), '-o', join(folder, 'out'), '--machine', plan.machine], { stdio: 'ignore' });
    const trace = JSON.parse(readFileSync(join(folder, 'out', 'trace.json'), 'utf8'));
    assert.equal(trace.strokes.length, played.length);
    trace.strokes.forEach(({ points }, i) => {
      // Half a step of 0.05 mm each way, and the rounding.
      for (const point of points) assert.ok(away(point, played[i]) < 0.037, `stroke ${i} at ${point} was cut, ${away(point, played[i])} mm from ${played[i]}`);
      for (const end of [0, -1]) {
        assert.ok(Math.hypot(points.at(end)[0] - played[i].at(end)[0], points.at(end)[1] - played[i].at(end)[1]) < 0.04);
      }
    });
  } finally {
    rmSync(folder, { recursive: true });
  }
  strokes.stroke.start_s.forEach((start, i) => {
    assert.ok(start <= strokes.stroke.end_s[i] && (i === 0 || start >= strokes.stroke.end_s[i - 1] - 0.002), `stroke ${i} in its time`);
  });
});

test('a sheet is played back, looked at and queued', async () => {
  const plan = await planned(card);
  const { page, sent, complaints, close } = await visit(server, { hash: `#/sheets/${plan.id}` });
  await page.locator(`.plan-canvas[data-strokes="${plan.paths}"]`).waitFor();
  assert.match(await page.locator('.plan-canvas').getAttribute('aria-label'), /strokes on 304.8 × 304.8 mm/);
  await picture(page, 'sheets');
  const time = page.getByRole('slider', { name: 'Time' });
  await time.fill('20');
  assert.match(await time.getAttribute('aria-valuetext'), /^0:20 of \d:\d\d, (mountain|valley) fold \d+ of \d+$/);
  await page.getByText('Way of the tool').click();
  await page.getByText('Colour by time').click();
  await picture(page, 'sheets-played');
  const before = Number(await time.inputValue());
  await page.locator('#speed').selectOption('50');
  await page.getByRole('button', { name: 'Play' }).click();
  await until(async () => Number(await time.inputValue()) > before + 10, 'time goes on');
  await page.getByRole('button', { name: 'Stop' }).click();
  await page.getByLabel('Copies').fill('2');
  await page.getByLabel('Copies').press('Tab');
  assert.deepEqual(sent.filter((one) => one.path !== '/v1/session'), [], 'looking sends nothing');
  await page.getByRole('button', { name: 'Queue it' }).click();
  await page.getByText('It is in the queue.', { exact: false }).waitFor();
  const { items } = await server.must('GET', '/v1/queue');
  assert.deepEqual(items.map((job) => [job.plan, job.copies]), [[plan.id, 2]]);
  assert.ok(items.every((job) => ['ready', 'queued', 'planning'].includes(job.state)), 'nothing is armed or cut');
  assert.deepEqual(complaints, []);
  await close();
});

test('glue: step by step with arrow keys and space, kept for the next time, both sides of a seam lit', async () => {
  const plan = await planned(card, { options: { mat: '80x110' } });
  assert.equal(plan.sheets_total, 2);
  const { page, complaints, close } = await visit(server, { hash: `#/glue/${plan.id}`, motion: 'reduce' });
  await page.getByText('Step 1 of 6').waitFor();
  await page.getByRole('heading', { name: 'Take off the scraps' }).waitFor();
  await page.keyboard.press('ArrowRight');
  await page.getByRole('heading', { name: 'Crease the mountain folds' }).waitFor();
  await page.keyboard.press(' ');
  await page.getByRole('heading', { name: 'Crease the valley folds' }).waitFor();
  await picture(page, 'glue-creases');
  await page.getByRole('button', { name: 'Next' }).click();
  await page.getByRole('heading', { name: 'Glue seam A' }).waitFor();
  await page.locator('.glue-text').getByText(/on piece 1 and on piece 2/).waitFor();
  await until(async () => await page.locator('.glue-canvas').count() === 3, 'two sheets and the card');
  await wait(1500);
  await picture(page, 'glue-seam');
  await page.reload();
  await page.getByText('Step 4 of 6').waitFor();
  await page.keyboard.press('ArrowLeft');
  await page.getByText('Step 3 of 6').waitFor();
  for (let i = 0; i < 9; i++) await page.keyboard.press('ArrowRight');
  await page.getByRole('heading', { name: 'Open it once' }).waitFor();
  await page.getByRole('button', { name: 'Start again' }).click();
  await page.getByText('Step 1 of 6').waitFor();
  const shift = await page.evaluate(() => new Promise((done) => {
    let sum = 0;
    new PerformanceObserver((list) => { for (const one of list.getEntries()) if (!one.hadRecentInput) sum += one.value; })
      .observe({ type: 'layout-shift', buffered: true });
    setTimeout(() => done(sum), 200);
  }));
  assert.ok(shift < 0.1, `layout shifts by ${shift}`);
  assert.deepEqual(complaints, []);
  await close();
});

test('glue is printed with all its steps and the pictures of the sheets', async () => {
  const plan = await planned(card, { options: { mat: '80x110' } });
  const { page, complaints, close } = await visit(server, { hash: `#/glue/${plan.id}`, motion: 'reduce' });
  await page.getByText('Step 1 of 6').waitFor();
  await page.evaluate(() => { window.print = () => { window.printed = true; }; });
  await page.getByRole('button', { name: 'Print' }).click();
  await until(() => page.evaluate(() => window.printed), 'it asks to print');
  await page.emulateMedia({ media: 'print' });
  assert.equal(await page.locator('.glue-screen').isVisible(), false);
  for (const title of ['Take off the scraps', 'Crease the mountain folds', 'Glue seam A', 'Open it once']) {
    assert.equal(await page.locator('.glue-print').getByText(title, { exact: true }).isVisible(), true, title);
  }
  assert.deepEqual(await page.locator('.glue-print img').evaluateAll((all) => all.map((one) => one.complete && one.naturalWidth > 0)), [true, true]);
  const pdf = await page.pdf({ format: 'A4' });
  assert.equal(pdf.subarray(0, 5).toString(), '%PDF-');
  const pages = pdf.toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  assert.ok(pages >= 1 && pages <= 6, `${pages} pages`);
  assert.deepEqual(complaints, []);
  await close();
});

test('a design says what it is to fold, and shows how, step by step, also on a phone', async () => {
  const stored = await server.must('POST', '/v1/designs', JSON.stringify(card));
  const { page, complaints, close } = await visit(server, { hash: `#/design/${stored.id}`, motion: 'reduce' });
  await page.locator('.badge', { hasText: 'exact' }).waitFor();
  assert.match(await page.locator('.by-hand').innerText(), /\d+ folds, the shortest [\d.]+ mm; about \d+ minutes to fold \((easy|medium|hard)\)\s+In paper its panels move [\d.]+ mm on average/);
  await picture(page, 'design-by-hand');
  await page.getByRole('button', { name: 'How to fold it' }).click();
  await page.locator('.fold-sheet').waitFor();
  const id = await page.evaluate(() => location.hash.replace('#/fold/', ''));
  const { cards: [guide] } = await server.must('GET', `/v1/designs/${id}/files/fold-guide.json`);
  const drawn = (of) => page.locator(`.fold-${of}`).first().getAttribute('d').then((d) => d.match(/M/g)?.length ?? 0);
  const seen = new Set();
  for (const [k, step] of guide.steps.entries()) {
    await page.getByText(`Step ${k + 1} of ${guide.steps.length}`, { exact: true }).waitFor();
    assert.equal(await page.locator('.glue-text .server-words').innerText(), step.words);
    const folds = step.folds.map((fold) => guide.folds[fold].sense);
    assert.equal(await drawn('mountain'), folds.filter((sense) => sense === 'mountain').length);
    assert.equal(await drawn('valley'), folds.filter((sense) => sense === 'valley').length);
    assert.equal(await drawn('lit') > 0, step.panels.length > 0);
    if (!seen.has(step.kind)) {
      await wait(800);
      await picture(page, `fold-${step.kind}-desktop`);
    }
    seen.add(step.kind);
    if (k % 2 === 0) await page.keyboard.press(k % 4 === 0 ? 'ArrowRight' : ' ');
    else if (k + 1 < guide.steps.length) await page.getByRole('button', { name: 'Next' }).click();
  }
  assert.ok(seen.has('crease') && seen.has('push'));
  await page.keyboard.press('ArrowLeft');
  await page.getByText(`Step ${guide.steps.length - 1} of ${guide.steps.length}`, { exact: true }).waitFor();
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save all steps (JSON)' }).click()]);
  assert.deepEqual(JSON.parse(await bytesOf(download)).cards, [guide]);
  await page.getByRole('link', { name: 'Back to the design' }).click();
  await page.locator('.badge', { hasText: 'exact' }).waitFor();
  assert.deepEqual(complaints, []);
  await close();

  for (const [screen, theme] of [['phone', 'light'], ['desktop', 'dark']]) {
    const other = await visit(server, { hash: `#/fold/${id}`, role: 'viewer', motion: 'reduce', screen, theme });
    await other.page.locator('.fold-sheet').waitFor();
    await other.page.getByRole('button', { name: 'Next' }).click();
    await wait(800);
    await picture(other.page, `fold-${screen}-${theme}`);
    await other.page.getByRole('button', { name: screen === 'phone' ? 'Show the whole sheet' : 'Show it larger' }).click();
    await picture(other.page, `fold-other-${screen}-${theme}`);
    assert.ok(await other.page.evaluate(() => document.scrollingElement.scrollWidth <= innerWidth + 1), 'nothing is cut off');
    await other.page.evaluate(axeSource());
    const { violations } = await other.page.evaluate(() => window.axe.run('main', { resultTypes: ['violations'] }));
    assert.deepEqual(violations.filter((one) => ['serious', 'critical'].includes(one.impact)).map((one) => one.id), []);
    assert.deepEqual(other.complaints, []);
    await other.close();
  }
  const plan = await planned(card);
  assert.ok(plan.handwork.folds > 0);
  const last = await visit(server, { hash: `#/sheets/${plan.id}`, motion: 'reduce' });
  await last.page.getByText(/folds, the shortest [\d.]+ mm; about \d+ minutes to fold/).waitFor();
  await picture(last.page, 'sheets-by-hand');
  await last.close();
});
