// A cut that breaks off, and the ways on.
import assert from 'node:assert/strict';
import { after, afterEach, test } from 'node:test';
import { armHere, closeBrowser, hold, ladder, machineHash, picture, Server, visit, wait } from './harness.mjs';

let server = null;
let open = [];

after(closeBrowser);

/**
 * A job whose cut broke off, as the cable was out at stroke `at_path`, on a popcutd of its own; and a browser at its
 * cutter. `drawing` is an SVG, or how many lines a ladder has.
 */
async function broken(name, drawing = 40, at_path = 12, options = {}) {
  server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 20,
    faults: [{ at_path, kind: 'unplug', seconds: 2 }] }] });
  const job = await server.queue(typeof drawing === 'string' ? drawing : ladder(drawing), { name });
  const one = await visit(server, { hash: machineHash(), ...options });
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

test('what was done is played again, and nothing is sent', async () => {
  const { page, ledger, sent } = await broken('replay');
  const canvas = page.locator('.machine-sheet canvas');
  // Strokes that were sent are dark or amber: far from the grey of the rest and from white.
  const marked = () => canvas.evaluate((one) => {
    const copy = new OffscreenCanvas(one.width, one.height).getContext('2d', { willReadFrequently: true });
    copy.drawImage(one, 0, 0);
    const { data } = copy.getImageData(0, 0, one.width, one.height);
    let n = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 200 && Math.min(data[i], data[i + 1], data[i + 2]) < 90) n++;
    return n;
  });
  const at = page.getByLabel('Time of the cut');
  const move = (value) => at.evaluate((one, to) => {
    Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(one, String(to));
    one.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
  const [all, before] = [Number(await at.getAttribute('max')), sent.length];
  assert.ok(all > 0);
  const seen = [];
  for (const share of [0.02, 0.5, 0.98]) {
    await move(all * share);
    await wait(150);
    seen.push(await marked());
  }
  assert.ok(seen[0] < seen[1] && seen[1] < seen[2], `more and more is cut: ${seen}`);
  await page.getByRole('button', { name: 'Play what was done' }).click();
  await page.getByRole('button', { name: 'Stop' }).click();
  await move(all);
  assert.match(await page.locator('.lens-line strong').textContent(), new RegExp(`\\b${ledger.in_doubt[0][0] + 1} of 40$`));
  await page.getByRole('button', { name: 'Play what was done' }).waitFor();
  assert.equal(sent.length, before, 'looking sends nothing');
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

/** Lines that lie so far apart that the thickest of their pictures do not touch, as SVG. */
function shelf(lines) {
  const each = Array.from({ length: lines }, (_, i) => `M${12 + 95 * (i % 3)} ${12 + 12 * Math.floor(i / 3)}h82`).join('');
  return `<svg xmlns="http://www.w3.org/2000/svg" width="290mm" height="270mm" viewBox="0 0 290 270"><path fill="none" stroke="#000" d="${each}"/></svg>`;
}

/**
 * How each stroke looks on the sheet: 'certain', 'doubt', 'rest', or null where the lens or the arrow hides it. `strokes`
 * are those of the plan; the sheet fills the canvas but for 18 px.
 */
async function looksOf(page, strokes, marked) {
  const lines = [];
  let from = 0;
  for (const n of strokes.stroke.points) {
    lines.push(strokes.xy_mm.slice(from, from + 2 * n));
    from += 2 * n;
  }
  return page.evaluate(({ all, width_mm, length_mm, hidden }) => {
    const canvas = document.querySelector('.sheet-canvas');
    const { clientWidth: w, clientHeight: h } = canvas;
    const ratio = canvas.width / w;
    const scale = Math.min((w - 36) / width_mm, (h - 36) / length_mm);
    const [left, top] = [(w - width_mm * scale) / 2, (h - length_mm * scale) / 2];
    const place = (line, share) => {
      const last = line.length - 2;
      return [line[0] + share * (line[last] - line[0]), line[1] + share * (line[last + 1] - line[1])].map((mm, k) => mm * scale + (k ? top : left));
    };
    // The lens stands beside the middle of its stroke, and not over its start; a thin line leads there.
    const [px, py] = place(all[hidden], 0.5);
    const r = Math.min(96, w * 0.3, h * 0.3);
    const cy = Math.min(h - r - 6, Math.max(r + 6, py));
    const beside = (side) => Math.min(w - r - 6, Math.max(r + 6, px + side * (r + 28)));
    const [sx, sy] = place(all[hidden], 0);
    const clears = (x) => Math.hypot(sx - x, sy - cy) > r + 34;
    const side = px < w / 2 ? 1 : -1;
    const cx = beside(clears(beside(side)) || !clears(beside(-side)) ? side : -side);
    const covered = (x, y) => {
      if (Math.hypot(x - cx, y - cy) < r + 22) return true;
      const along = Math.max(0, Math.min(1, ((x - px) * (cx - px) + (y - py) * (cy - py)) / Math.hypot(cx - px, cy - py) ** 2));
      return Math.hypot(x - px - along * (cx - px), y - py - along * (cy - py)) < 6;
    };
    const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const rgb = (name) => {
      const probe = document.createElement('span');
      probe.style.color = `var(${name})`;
      canvas.parentElement.append(probe);
      const value = getComputedStyle(probe).color.match(/[\d.]+/g).slice(0, 3).map(Number);
      probe.remove();
      return value;
    };
    const inks = { ink: rgb('--ink'), amber: rgb('--amber'), sheet: rgb('--sheet') };
    const at = (x, y) => {
      const i = 4 * (Math.round(y * ratio) * canvas.width + Math.round(x * ratio));
      return [pixels.data[i], pixels.data[i + 1], pixels.data[i + 2]];
    };
    const far = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    canvas.dataset.arrow = at(sx + (sx > 60 ? -8 : 8), sy).join();
    const share = (pixel, to) => 1 - far(pixel, to) / far(inks.sheet, to);
    return all.map((line, i) => {
      if (i === hidden) return null;
      let [ink, amber, wide, n] = [0, 0, 0, 0];
      for (let k = 0; k <= 60; k++) {
        const [x, y] = place(line, 0.12 + 0.76 * k / 60);
        if (covered(x, y)) continue;
        n++;
        const here = [-1, 0, 1].map((dy) => at(x, y + dy));
        ink += Math.max(...here.map((pixel) => share(pixel, inks.ink)));
        amber += Math.max(...here.map((pixel) => (pixel[0] - pixel[2]) / (inks.amber[0] - inks.amber[2])));
        wide += [-3, 3].every((dy) => far(at(x, y + dy), inks.sheet) > 25) ? 1 : 0;
      }
      if (n < 12) return null;
      if (amber / n > 0.3 && wide / n > 0.9) return 'doubt';
      if (ink / n > 0.65 && wide / n < 0.3) return 'certain';
      return ink / n > 0.05 && ink / n < 0.5 && wide / n < 0.3 ? 'rest' : `ink ${ink / n}, amber ${amber / n}, wide ${wide / n}`;
    });
  }, { all: lines, width_mm: strokes.width_mm, length_mm: strokes.length_mm, hidden: marked });
}

/** What the ledger says of stroke `i`, in the words of looksOf(). */
function fateIn(ledger, i) {
  const holds = (ranges) => ranges.some(([first, last]) => first <= i && i <= last);
  return holds(ledger.certain) ? 'certain' : holds(ledger.in_doubt) ? 'doubt' : holds(ledger.not_sent) ? 'rest' : 'nothing';
}

const kShelf = 42;

/** A cable that is pulled somewhere; every stroke is drawn as the ledger has it. */
async function brokenSomewhere(t, name, options) {
  const at_path = 2 + Math.floor(Math.random() * (kShelf - 6));
  t.diagnostic(`the cable is out at stroke ${at_path}`);
  const one = await broken(name, shelf(kShelf), at_path, options);
  const { plan } = await server.job(one.id);
  const strokes = await server.must('GET', `/v1/plans/${plan}/sheets/1/strokes`);
  assert.equal(strokes.stroke.points.length, kShelf);
  const first = one.ledger.in_doubt[0]?.[0] ?? one.ledger.not_sent[0][0];
  await one.page.locator('.sheet-canvas').scrollIntoViewIfNeeded();
  await one.page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); }));
  const looks = await looksOf(one.page, strokes, first);
  const seen = looks.flatMap((look, i) => (look === null ? [] : [[i, look]]));
  const [accent, arrow] = await one.page.locator('.sheet-canvas').evaluate((canvas) => {
    const probe = document.createElement('span');
    probe.style.color = 'var(--accent)';
    canvas.parentElement.append(probe);
    const colour = getComputedStyle(probe).color.match(/\d+/g).slice(0, 3).join();
    probe.remove();
    return [colour, canvas.dataset.arrow];
  });
  assert.equal(arrow, accent, 'an arrow points at the start of the first stroke in doubt');
  assert.ok(seen.length > kShelf * 0.3, `${seen.length} strokes are seen`);
  assert.deepEqual(seen, seen.map(([i]) => [i, fateIn(one.ledger, i)]), `first in doubt ${first}: ${JSON.stringify(one.ledger)}`);
  return { ...one, first, strokes };
}

const chosen = (page) => page.getByRole('button', { name: 'That is what I want' });

test('a cable pulled somewhere: the drawn ledger is that of popcutd; a new sheet begins with nothing cut', async (t) => {
  const { page, id, acts } = await brokenSomewhere(t, 'somewhere, new sheet', { motion: 'reduce' });
  await picture(page, 'interrupted-somewhere');
  await page.getByText('New sheet', { exact: true }).click();
  await chosen(page).click();
  const job = await server.state(id, 'ready');
  assert.deepEqual([job.blank, acts('start').length], [2, 1]);
});

test('a cable pulled somewhere, in the dark: going on from a stroke that is tapped on the picture', async (t) => {
  const { page, id, ledger, acts, first, strokes } = await brokenSomewhere(t, 'somewhere, go on', { motion: 'reduce', theme: 'dark' });
  await picture(page, 'interrupted-somewhere-dark');
  await page.getByText('Go on from a stroke', { exact: true }).click();
  const last = ledger.in_doubt.at(-1)?.[1] ?? ledger.not_sent[0][0];
  await page.getByText(`From cut ${first + 1} of ${kShelf}.`, { exact: false }).waitFor();
  const [x, y] = await page.locator('.sheet-canvas').evaluate((canvas, { strokes: of, i }) => {
    const { clientWidth: w, clientHeight: h } = canvas;
    const scale = Math.min((w - 36) / of.width_mm, (h - 36) / of.length_mm);
    const from = of.stroke.points.slice(0, i).reduce((sum, n) => sum + 2 * n, 0);
    const to = from + 2 * of.stroke.points[i] - 2;
    // Near the end that the lens beside the middle does not hide.
    const mm = [of.xy_mm[from] + 0.1 * (of.xy_mm[to] - of.xy_mm[from]), of.xy_mm[from + 1]];
    return [mm[0] * scale + (w - of.width_mm * scale) / 2, mm[1] * scale + (h - of.length_mm * scale) / 2];
  }, { strokes, i: last });
  await page.locator('.sheet-canvas').click({ position: { x, y } });
  await page.locator('.lens-line strong', { hasText: new RegExp(`\\b${last + 1} of ${kShelf}$`) }).waitFor();
  await page.getByText(`From cut ${first + 1} of ${kShelf}.`, { exact: false }).waitFor();   // strokes in doubt go together
  await page.getByText('I load it again, in the same place').click();
  for (const tick of await page.locator('.go-on input[type=checkbox]').all()) await tick.check();
  await chosen(page).click();
  await server.state(id, 'ready');
  assert.equal(JSON.parse(acts('resume-from')[0].body).from_path, first);
  assert.equal(acts('start').length, 1);
});

test('a cable pulled somewhere: it is whole only if every stroke was sent, else it is given up', async (t) => {
  const { page, id, ledger, acts } = await brokenSomewhere(t, 'somewhere, whole?', { motion: 'reduce', screen: 'tablet' });
  const whole = page.locator('.option', { hasText: 'It is whole' }).locator('input');
  assert.equal(await whole.isDisabled(), strokesIn(ledger.not_sent) > 0);
  if (await whole.isDisabled()) {
    await page.getByText('Give up', { exact: true }).click();
    await chosen(page).click();
    await server.state(id, 'cancelled');
  } else {
    await whole.check();
    await chosen(page).click();
    await server.state(id, 'done');
  }
  assert.equal(acts('start').length, 1);
});
