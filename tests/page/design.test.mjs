// Design in a real browser against a real popcutd, or on the page of static files.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { bytesOf, closeBrowser, expectComplaints, ladder, ofPopcutd, onPopcutd, openPlan, picture, refused, startBackend, until, visit, wait } from './harness.mjs';
import { bundled, sources } from './sources.mjs';

const popcut = process.env.POPCUT ?? 'popcut';
let server;

before(async () => { server = await startBackend({ devices: [{ id: 'sim:cameo3', time_scale: 20 }] }); });
after(async () => { await closeBrowser(); await server.remove(); });

const link = (text) => deflateSync(text).toString('base64url');

/** Waits until the exact design is shown. */
async function exact(page) {
  await page.locator('.badge', { hasText: 'exact' }).waitFor({ timeout: 60_000 });
}

/** The design view with an example on the desk. */
async function designing(example = 'sphere', options = {}) {
  const visited = await visit(server, { hash: `#/design/example/${example}`, motion: 'reduce', ...options });
  await visited.page.locator('.stage').waitFor();
  await exact(visited.page);
  return visited;
}

/** The spec on the desk, as its last step is kept. */
const specOf = (page) => page.evaluate(() => {
  const { steps, at } = JSON.parse(sessionStorage.getItem('popcut.design.steps'));
  return JSON.parse(steps[at]);
});

/** Counts requests for previews: how many were ever in work at once, and what was asked for. */
function watchPreviews(page) {
  const seen = { most: 0, now: 0, asked: [] };
  const of = (request) => request.url().endsWith('/v1/preview');
  page.on('request', (request) => {
    if (!of(request)) return;
    seen.asked.push(JSON.parse(request.postData()));
    seen.most = Math.max(seen.most, ++seen.now);
  });
  for (const end of ['requestfinished', 'requestfailed']) page.on(end, (request) => { if (of(request)) seen.now--; });
  return seen;
}

test('one press on an example, one drag of its silhouette: a formula becomes points, and undo brings it back', async () => {
  const { page, sent, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card:not(:disabled)').first().waitFor();
  assert.ok(await page.locator('.start-card img').count() >= 10);
  await picture(page, 'design-start');
  await page.locator('.start-card', { hasText: 'sphere' }).click();
  await exact(page);
  const before = await specOf(page);
  assert.equal(typeof before.surface.radius, 'string');
  const handles = page.locator('.handle-radius');
  await until(async () => await handles.count() >= 4, 'radii can be dragged');
  const box = await handles.nth(3).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 5; i++) await page.mouse.move(x, y - 4 * i);
  await page.mouse.up();
  await page.getByText(/The formula became \d+ points/).waitFor();
  const dragged = await specOf(page);
  const points = dragged.surface.radius.points;
  const radius = (at) => Math.sqrt(70 ** 2 - (at - 45) ** 2);
  points.forEach(([at, r], i) => {
    if (at < 0 || at > 90) return; // beyond the last slices the target is not drawn
    if (i === 3) assert.ok(r > radius(at) + 2, 'the dragged one is farther out');
    else assert.ok(Math.abs(r - radius(at)) < 0.2, `${r} at ${at} is the formula's ${radius(at)}`);
  });
  await exact(page);
  await picture(page, 'design-dragged');
  await page.keyboard.press('Control+z');
  assert.deepEqual(await specOf(page), before);
  await exact(page);
  assert.ok(sent.every((one) => ['/v1/preview', '/v1/session'].includes(one.path)), 'nothing is stored while one designs');
  assert.deepEqual(complaints, []);
  await close();
});

test('handles are buttons: arrow keys move a radius by 1 mm, with Shift by 0.1 mm', async () => {
  const { page, complaints, close } = await designing();
  await page.locator('.handle-radius').nth(2).focus();
  await page.keyboard.press('ArrowUp');
  await exact(page);
  const first = (await specOf(page)).surface.radius.points[2][1];
  await page.keyboard.press('ArrowUp');
  await page.keyboard.press('Shift+ArrowDown');
  assert.ok(Math.abs((await specOf(page)).surface.radius.points[2][1] - first - 0.9) < 0.011);
  await exact(page);
  const count = (await specOf(page)).surface.radius.points.length;
  await page.locator('.handle-radius').nth(2).focus();
  await page.keyboard.press('Delete');
  assert.equal((await specOf(page)).surface.radius.points.length, count - 1);
  await page.locator('.handle-open').focus();
  const before = await page.getByRole('slider', { name: 'Opening angle' }).inputValue();
  await page.keyboard.press('ArrowUp');
  assert.equal(Number(await page.getByRole('slider', { name: 'Opening angle' }).inputValue()), Number(before) + 5);
  assert.match(await page.locator('.stage-canvas').first().getAttribute('aria-label'), /^sphere, \d+ panels, open to 95 degrees, largest error [\d.]+ mm$/);
  assert.deepEqual(complaints, []);
  await close();
});

test('while a slider moves, one preview is in work at most, and the last input wins', ofPopcutd, async () => {
  const { page, complaints, close } = await designing();
  expectComplaints(page, refused(409));
  const seen = watchPreviews(page);
  const units = page.getByLabel('Steps in a slice (N)');
  await units.evaluate(async (input) => {
    const set = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set;
    for (let i = 0; i < 40; i++) {
      set.call(input, String(3 + (i % 8)));
      input.dispatchEvent(new Event('input', { bubbles: true }));
      // Four inputs come at once: popcutd answers sooner than a hand moves.
      if (i % 4 === 3) await new Promise((done) => setTimeout(done, 48));
    }
    set.call(input, '4');
    input.dispatchEvent(new Event('input', { bubbles: true }));
    input.dispatchEvent(new Event('change', { bubbles: true }));
  });
  await until(async () => (await page.locator('.badge').textContent()) === 'exact' && seen.now === 0
    && seen.asked.at(-1).quality === 'exact', 'the exact design is shown');
  assert.ok(seen.most <= 1, `${seen.most} previews were in work at once`);
  assert.ok(seen.asked.length < 41, 'some inputs were replaced while they waited');
  assert.equal(seen.asked.at(-1).spec.units_per_slice, 4);
  const levels = await page.locator('.places tbody tr').allTextContents();
  assert.ok(levels.some((row) => /level 4/.test(row)) && !levels.some((row) => /level [6-9]/.test(row)), 'the last input is what is drawn');
  assert.deepEqual(complaints, []);
  await close();
});

test('a preview that is too much ends by its limits, and the cut beside it never waits', ofPopcutd, async () => {
  const job = await server.queue(ladder(60), { name: 'beside' });
  await server.cut(job.id);
  const heavy = { popcut: 1, surface: { type: 'revolution', radius: 'sqrt(600^2 - (y - 200)^2)' }, lattice: 'conformal', units_per_slice: 100, slices: 1000, widths_mm: 0.4, min_panel_mm: 0.1 };
  const asked = server.ask('POST', '/v1/preview', { spec: heavy, quality: 'exact' }, { headers: { 'Preview-Key': 'a-test-of-limits-1' } });
  await server.state(job.id, 'done', 60_000);
  const answer = await asked;
  assert.ok([422, 503].includes(answer.status), `it is refused: ${answer.status}`);
  const light = await server.ask('POST', '/v1/preview', { spec: { popcut: 1, surface: { type: 'revolution', radius: '30' }, units_per_slice: 1, slices: 1, widths_mm: 30 }, quality: 'draft' }, { headers: { 'Preview-Key': 'a-test-of-limits-1' } });
  assert.equal(light.status, 200, 'the next one is served');
});

test('what cannot be made: the last shape stays, greyed, the field is marked, the sentence is shown, undo mends it', async () => {
  const { page, complaints, close } = await designing();
  expectComplaints(page, refused(422));
  const field = page.getByLabel('Designed opening angle');
  await field.fill('170');
  await field.press('Enter');
  await page.locator('.impossible').waitFor();
  assert.equal(await field.getAttribute('aria-invalid'), 'true');
  assert.match(await page.locator('.impossible').textContent(), /150/);
  assert.equal(await page.locator('.badge').textContent(), 'not possible');
  assert.equal(await page.getByRole('button', { name: 'Share' }).isDisabled(), true);
  await picture(page, 'design-impossible');
  await page.getByRole('button', { name: 'Undo the change' }).click();
  await exact(page);
  assert.equal(await page.locator('.impossible').count(), 0);
  assert.deepEqual(complaints, []);
  await close();
});

test('a share link brings the same design and stores nothing; steps survive a reload', async () => {
  const { page, complaints, close } = await designing('saddle');
  for (let n = 6; n <= 9; n++) {
    await page.getByLabel('Steps in a slice (N)').focus();
    await page.keyboard.press('ArrowRight');
  }
  await exact(page);
  const made = await specOf(page);
  assert.equal(made.units_per_slice, 9);
  await page.getByRole('button', { name: 'Share' }).click();
  const address = await page.locator('.share-link').inputValue();
  assert.match(address, /#\/design\/d=[A-Za-z0-9_-]+$/);
  await page.getByRole('button', { name: 'Close' }).click();
  await page.reload();
  await page.getByRole('button', { name: 'Go on with your last design' }).click();
  await exact(page);
  assert.deepEqual(await specOf(page), made);
  for (let n = 8; n >= 5; n--) {
    await page.getByRole('button', { name: 'Undo', exact: true }).click();
    assert.equal((await specOf(page)).units_per_slice, n);
  }
  for (let n = 6; n <= 9; n++) await page.getByRole('button', { name: 'Redo' }).click();
  assert.deepEqual(await specOf(page), made);
  assert.deepEqual(complaints, []);
  await close();

  const stored = async () => (onPopcutd ? (await server.must('GET', '/v1/designs')).items.length : 0);
  const before = await stored();
  const other = await visit(server, { hash: new URL(address).hash, motion: 'reduce' });
  await exact(other.page);
  assert.deepEqual(await specOf(other.page), made);
  assert.ok(other.sent.every((one) => ['/v1/preview', '/v1/session'].includes(one.path)));
  assert.equal(await stored(), before);
  assert.deepEqual(other.complaints, []);
  await other.close();
});

test('hostile links and names are text: nothing runs, nothing is sent, the page lives', async () => {
  const evil = '<img src=x onerror="window.hurt=1"><script>window.hurt=1</script>';
  const spec = { popcut: 1, name: evil, surface: { type: 'revolution', radius: '30' }, units_per_slice: 2, slices: 3, widths_mm: 10 };
  const cases = [
    ['d=' + 'A'.repeat(10_000), /more than a design may have/],
    ['d=' + link(JSON.stringify({ ...spec, note: ' '.repeat(50_000_000) })).slice(0, 7000), /does not hold a design|more than a design may have/],
    ['d=' + link(JSON.stringify({ ...spec, x: ' '.repeat(2_000_000) })), /more than a design may have/],
    ['d=%00%ff<svg/onload=alert(1)>', /does not hold a design/],
    ['d=' + link('{"popcut": 1, "surface": {"type": "mesh", "file": "../../etc/passwd"}}'), /names a file/],
    ['d=' + link('[]'), /not a spec/],
  ];
  const { page, sent, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  expectComplaints(page, refused(422), refused(404));
  for (const [rest, sentence] of cases) {
    await page.evaluate((to) => { location.hash = to; }, `#/design/${rest}`);
    await page.getByText(sentence).waitFor();
    await page.getByRole('button', { name: 'Close' }).click();
  }
  assert.deepEqual(sent.filter((one) => one.path !== '/v1/session'), [], 'no link sends anything');
  await page.evaluate((to) => { location.hash = to; }, `#/design/d=${link(JSON.stringify(spec))}`);
  await exact(page);
  assert.equal(await page.locator('.design-name').inputValue(), evil);
  assert.match(await page.locator('.stage-canvas').first().getAttribute('aria-label'), /^<img src=x/);
  await page.evaluate((to) => { location.hash = to; }, `#/design/d=${link(JSON.stringify({ ...spec, units_per_slice: 1_000_000, slices: 1_000_000 }))}`);
  await page.locator('.impossible').waitFor();
  assert.equal(await page.evaluate(() => window.hurt), undefined);
  assert.deepEqual(sent.filter((one) => !['/v1/session', '/v1/preview'].includes(one.path)), []);
  await page.getByRole('link', { name: 'Settings', exact: true }).click();
  await page.locator('.settings').waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

test('a drawn line is enough to begin', async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  const pad = page.getByRole('group', { name: 'Seen from above' });
  await pad.scrollIntoViewIfNeeded();
  const box = await pad.boundingBox();
  await page.mouse.move(box.x + box.width * 0.1, box.y + box.height * 0.3);
  await page.mouse.down();
  for (let i = 0; i <= 20; i++) await page.mouse.move(box.x + box.width * (0.1 + 0.04 * i), box.y + box.height * (0.3 + 0.015 * i));
  await page.mouse.up();
  await page.locator('.pad', { hasText: 'Seen from above' }).getByRole('button', { name: 'Use this shape' }).click();
  await exact(page);
  const radii = (await specOf(page)).surface.radius.points.map(([, r]) => r);
  for (let i = 1; i < radii.length; i++) assert.ok(radii[i] > radii[i - 1], 'the line that was drawn rises');
  await page.getByRole('button', { name: 'New', exact: true }).click();
  await page.locator('.pad', { hasText: 'Seen from the side' }).getByRole('button', { name: 'Use this shape' }).click();
  await exact(page);
  assert.equal((await specOf(page)).surface.type, 'profile');
  await page.getByRole('button', { name: 'New', exact: true }).click();
  await page.locator('.pad', { hasText: 'As a landscape' }).getByRole('button', { name: 'Use this shape' }).click();
  await exact(page);
  assert.equal((await specOf(page)).surface.type, 'grid');
  assert.deepEqual(complaints, []);
  await close();
});

test('a word that is written stands up, and its text and style change', async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.getByLabel('Write a word').fill('  Ana ');
  await page.getByLabel('Write a word').press('Enter');
  await exact(page);
  assert.deepEqual((await specOf(page)).surface, { type: 'text', text: 'Ana', height: 36, depth: 18 });
  assert.equal((await specOf(page)).scale_mm, undefined, 'it fits as it is');
  await page.getByLabel('Text', { exact: true }).fill('Bo');
  await page.getByLabel('Text', { exact: true }).press('Enter');
  await until(async () => (await specOf(page)).surface.text === 'Bo', 'the text is taken');
  await exact(page);
  // A letter that no font has is said beside the field, and the last card stays.
  await page.getByLabel('Text', { exact: true }).fill('\u3042');
  expectComplaints(page, refused(422));
  await page.getByLabel('Text', { exact: true }).press('Enter');
  await page.locator('.field-refused', { hasText: 'the font has no' }).waitFor();
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  await exact(page);
  await page.getByLabel('Style').selectOption('lattice');
  await until(async () => (await specOf(page)).units_per_slice === 6, 'it is a lattice');
  await exact(page);
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  await exact(page);
  assert.equal((await specOf(page)).style, 'facets');
  await page.getByLabel('Style').selectOption('silhouette');
  await until(async () => (await specOf(page)).style === 'silhouette', 'it is a silhouette');
  await exact(page);
  await page.getByRole('slider', { name: 'Layers' }).fill('1');
  await until(async () => (await specOf(page)).silhouette?.layers === 1, 'it has one layer');
  await exact(page);
  await picture(page, 'design-silhouette');
  assert.deepEqual(complaints, []);
  await close();
});

test('a word that is longer than the paper comes smaller, in one piece that a hand can fold', async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.getByLabel('Write a word').fill('Grüße Jörg');
  await page.getByLabel('Write a word').press('Enter');
  await until(async () => (await specOf(page))?.scale_mm < 1, 'it is made smaller');
  await exact(page);
  const hands = await page.locator('[aria-labelledby=by-hand]').innerText();
  const [, folds, shortest, minutes] = /(\d+) folds, the shortest ([\d.]+) mm; about (\d+) minutes to fold/.exec(hands);
  assert.ok(Number(shortest) >= 4 && Number(minutes) <= 30, hands);
  assert.match(await page.locator('[aria-labelledby=figures]').innerText(), new RegExp(`\\nfolds\\s+${folds}\\n`), 'it is one number everywhere');
  await openPlan(page);
  await page.getByRole('dialog').getByText(/^The card is 2\d\d(\.\d)? × 1\d\d(\.\d)? mm: it fits\.$/).waitFor();
  assert.equal(await page.getByRole('dialog').getByLabel('Material').locator('option:checked').innerText(), 'Paper, 220 gsm');
  assert.equal(await page.getByRole('button', { name: 'Undo', exact: true }).isDisabled(), true, 'that is where it began');
  assert.deepEqual(complaints, []);
  await close();
});

test('every vertex that is drawn lies where the FOLD file has it, at three openings', ofPopcutd, async () => {
  const folder = mkdtempSync(join(tmpdir(), 'popcut-fold-'));
  try {
    const { readLattice } = await sources('lattice.ts');
    const { page, complaints, close } = await visit(server, {});
    await page.route('**/page/test-model.js', async (route) => route.fulfill({ contentType: 'text/javascript', body: await bundled('lattice.ts', 'model_shaders.ts', 'model_view.ts') }));
    await page.route('**/page/test-places.js', (route) => route.fulfill({ contentType: 'text/javascript', path: new URL('fixtures/drawn_places.mjs', import.meta.url).pathname }));
    for (const example of ['sphere', 'facade', 'composite']) {
      const file = join(folder, `${example}.json`);
      writeFileSync(file, execFileSync(popcut, ['design', '--example', example]));
      execFileSync(popcut, ['design', file, '-o', join(folder, example), '--formats', 'fold']);
      const fold = JSON.parse(readFileSync(join(folder, example, 'pattern.fold'), 'utf8'));
      const poses = fold.file_frames.filter((frame) => /deployed to psi/.test(frame.frame_title))
        .map((frame) => ({ psi: Number(/psi = ([\d.]+)/.exec(frame.frame_title)[1]), places: frame.vertices_coords }));
      assert.ok(poses.length >= 3);
      const { id } = await server.must('POST', '/v1/designs', readFileSync(file, 'utf8'));
      const { token } = await server.token('viewer', `${example}-reader`);
      const bytes = Buffer.from(await (await fetch(`${server.address}/v1/designs/${id}/lattice`, { headers: { Authorization: `Bearer ${token}` } })).arrayBuffer());
      const drawn = await page.evaluate(async ({ base64, psis }) => {
        const { readLattice: reader, ModelView, modelVertexShader } = await import('/page/test-model.js');
        const { drawnPlaces } = await import('/page/test-places.js');
        const lattice = reader(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer);
        const canvas = document.createElement('canvas');
        document.body.append(canvas);
        const view = new ModelView(canvas);
        view.setLattice(lattice);
        const all = psis.map((psi) => {
          view.setPsi(psi);
          return drawnPlaces(view, modelVertexShader);
        });
        view.dispose();
        canvas.remove();
        return all;
      }, { base64: bytes.toString('base64'), psis: poses.slice(0, 3).map((pose) => pose.psi) });
      const lattice = readLattice(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
      const key = (place) => place.map((value) => Math.round(value / 0.004)).join();
      const at = (fold_vertex) => poses.slice(0, 3).map((pose) => pose.places[fold_vertex]);
      const near = new Map();
      fold.vertices_coords.forEach((_, i) => {
        const k = key(at(i)[1].map((value) => value));
        near.set(k, [...(near.get(k) ?? []), i]);
      });
      const seen = new Set();
      const corners = lattice.triangles.length;
      assert.equal(drawn[0].length, 3 * corners);
      for (let c = 0; c < corners; c++) {
        const here = drawn.map((places) => places.slice(3 * c, 3 * c + 3));
        // Float32 of some 100 mm: 2e-5; the grid of `key` is looked at with its neighbours.
        const found = neighbours(key(here[1])).flatMap((k) => near.get(k) ?? [])
          .filter((i) => at(i).every((place, pose) => place.every((value, axis) => Math.abs(value - here[pose][axis]) < 1e-3)));
        assert.ok(found.length > 0, `${example}: corner ${c} at ${here[1]} is no vertex of the FOLD file`);
        for (const i of found) seen.add(i);
      }
      assert.equal(seen.size, fold.vertices_coords.length, `${example}: every vertex of the file is drawn`);
    }
    assert.deepEqual(complaints, []);
    await close();
  } finally {
    rmSync(folder, { recursive: true });
  }
});

function neighbours(key) {
  const [x, y, z] = key.split(',').map(Number);
  const out = [];
  for (const dx of [-1, 0, 1]) for (const dy of [-1, 0, 1]) for (const dz of [-1, 0, 1]) out.push([x + dx, y + dy, z + dz].join());
  return out;
}

/** How many different colours a canvas shows. */
const colours = (page, selector) => page.locator(selector).screenshot().then(async (png) => page.evaluate(async (base64) => {
  const image = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: 'image/png' }));
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext('2d');
  context.drawImage(image, 0, 0);
  return new Set(new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer)).size;
}, png.toString('base64')));

test('without WebGL the opened card is painted, and again when the slider stops', async () => {
  const visited = await visit(server, { motion: 'reduce' });
  const { page, complaints, close } = visited;
  await page.addInitScript(() => {
    const get = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return /webgl/.test(kind) ? null : get.call(this, kind, ...more); };
  });
  await page.reload();
  await page.getByRole('link', { name: 'Settings', exact: true }).waitFor();
  await page.evaluate(() => { location.hash = '#/design/example/sphere'; });
  await exact(page);
  await page.getByText('This browser cannot draw in three dimensions.', { exact: false }).waitFor();
  await until(() => page.locator('.stage-paper[data-drawn="90"]').count(), 'it is painted');
  assert.ok(await colours(page, '.stage-paper') > 20);
  await page.getByRole('slider', { name: 'Opening angle' }).fill('140');
  await until(() => page.locator('.stage-paper[data-drawn="140"]').count(), 'it is painted again');
  await picture(page, 'design-no-webgl');
  assert.deepEqual(complaints, []);
  await close();
});

test('after a lost context the picture comes again by itself', async () => {
  const { page, complaints, close } = await designing();
  expectComplaints(page, /Context Lost|Context Restored|WebGL/i);
  await page.evaluate(() => {
    const gl = document.querySelector('.stage-canvas').getContext('webgl2');
    window.lose = gl.getExtension('WEBGL_lose_context');
    window.lose.loseContext();
  });
  await page.locator('.stage-paper').waitFor();
  await until(() => page.locator('.stage-paper[data-drawn]').count(), 'the card is painted meanwhile');
  await page.evaluate(() => window.lose.restoreContext());
  await until(async () => await page.locator('.stage-paper').count() === 0, 'the model is back');
  await wait(500);
  assert.ok(await colours(page, '.stage-canvas') > 20);
  await page.getByRole('slider', { name: 'Opening angle' }).fill('120');
  await exact(page);
  assert.deepEqual(complaints, []);
  await close();
});

test('files of the exact design and a picture of it are saved', async () => {
  const { page, complaints, close } = await designing('unit');
  const saved = async (name) => {
    const download = page.waitForEvent('download');
    await page.getByRole('button', { name, exact: true }).click();
    const one = await download;
    return [one.suggestedFilename(), await bytesOf(one)];
  };
  await page.getByRole('button', { name: 'Make it…' }).click();
  await page.getByText('More: other formats').click();
  const [svgName, svg] = await saved('Pattern to look at (SVG)');
  assert.equal(svgName, 'unit-pattern.svg');
  assert.match(svg.toString(), /^<\?xml[^]*<svg /);
  const [, fold] = await saved('Pattern, flat and in poses (FOLD)');
  assert.equal(JSON.parse(fold).file_title, 'unit');
  const [pngName, png] = await saved('Picture as you see it (PNG)');
  assert.equal(pngName, 'unit.png');
  assert.deepEqual([...png.subarray(1, 4)], [...Buffer.from('PNG')]);
  await page.getByRole('button', { name: 'Close' }).click();
  const download = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save' }).click();
  assert.deepEqual(JSON.parse(await bytesOf(await download)), await specOf(page));
  assert.deepEqual(complaints, []);
  await close();
});

test('a design is handed to Origami Simulator once that is ready, and to no other site', async () => {
  const { page, context, complaints, close } = await designing('unit');
  const site = (ready) => `<!doctype html><script>
    window.heard = [];
    addEventListener('message', (event) => heard.push({ data: event.data, origin: event.origin }));
    ${ready ? "opener.postMessage({ from: 'OrigamiSimulator', status: 'ready' }, '*');" : ''}
  </script>`;
  await context.route('https://origamisimulator.org/**', (route) => route.fulfill({ contentType: 'text/html', body: site(true) }));
  await page.getByRole('button', { name: 'Make it…' }).click();
  await page.getByText('More: other formats').click();
  const opened = context.waitForEvent('page');
  await page.getByRole('button', { name: /Origami Simulator/ }).click();
  const other = await opened;
  await other.waitForFunction(() => window.heard?.length > 0);
  const [heard] = await other.evaluate(() => window.heard);
  assert.equal(heard.origin, server.address);
  assert.equal(heard.data.op, 'importFold');
  assert.equal(heard.data.fold.edges_foldAngle.length, heard.data.fold.edges_vertices.length);
  assert.ok(heard.data.fold.faces_vertices.length > 0);
  await other.close();
  // A window that went elsewhere gets nothing, whatever it says.
  await context.unroute('https://origamisimulator.org/**');
  await context.route('https://elsewhere.test/**', (route) => route.fulfill({ contentType: 'text/html', body: site(true) }));
  await context.route('https://origamisimulator.org/**', (route) => route.fulfill({ status: 302, headers: { Location: 'https://elsewhere.test/' } }));
  const astray = context.waitForEvent('page');
  await page.getByRole('button', { name: /Origami Simulator/ }).click();
  const stranger = await astray;
  await stranger.waitForFunction(() => window.heard !== undefined);
  await wait(1000);
  assert.deepEqual(await stranger.evaluate(() => window.heard), []);
  assert.deepEqual(complaints, []);
  await close();
});

test('a height that is typed is the height of the exact card, also where its steps fall elsewhere; one undo brings it back', async () => {
  const { page, complaints, close } = await designing();
  const before = await specOf(page);
  for (const mm of [90, 41]) {
    await page.getByLabel('Height').fill(String(mm));
    await page.getByLabel('Height').press('Enter');
    await until(async () => Math.abs(Number(await page.getByLabel('Height').inputValue()) - mm) <= 0.003 * mm
      && (await page.locator('.badge').textContent()) === 'exact', `the card is ${mm} mm high`, 20_000);
    await wait(600);
    assert.ok(Math.abs(Number(await page.getByLabel('Height').inputValue()) - mm) <= 0.003 * mm, 'it stays');
  }
  for (let i = 0; i < 2; i++) await page.getByRole('button', { name: 'Undo' }).click();
  assert.deepEqual(await specOf(page), before);
  assert.deepEqual(complaints, []);
  await close();
});

test('what is lit in one place is lit everywhere', async () => {
  const { page, complaints, close } = await designing();
  await page.locator('.places summary').click();
  await page.getByRole('button', { name: 'slice 3', exact: true }).focus();
  assert.match(await page.locator('.stage-lit').textContent(), /^slice 3/);
  assert.equal(await page.locator('.places .row-lit').count(), 1);
  await page.getByRole('button', { name: 'slice 3', exact: true }).click();
  assert.equal(await page.getByLabel('Width of slice 3').inputValue(), '10');
  await page.getByLabel('Width of slice 3').fill('12');
  await page.getByLabel('Width of slice 3').press('Enter');
  assert.deepEqual((await specOf(page)).widths_mm, [10, 10, 12, 10, 10, 10, 10, 10, 10, 10]);
  await exact(page);
  // The edge of the slice that is pressed is a handle, for hands and for keys.
  const edge = page.getByRole('button', { name: /^Edge of slice 3/ });
  await edge.press('ArrowRight');
  assert.equal((await specOf(page)).widths_mm[2], 13);
  await exact(page);
  const from = await edge.boundingBox();
  await page.mouse.move(from.x + from.width / 2, from.y + from.height / 2);
  await page.mouse.down();
  await page.mouse.move(from.x + from.width / 2 + 25, from.y + from.height / 2 - 10, { steps: 4 });
  await page.mouse.up();
  const widths = (await specOf(page)).widths_mm;
  assert.ok(widths[2] > 14, `dragged to ${widths[2]} mm`);
  assert.deepEqual(widths.filter((_, i) => i !== 2), Array(9).fill(10));
  await exact(page);
  await picture(page, 'design-slice-edge');
  const canvas = await page.locator('.stage-canvas').first().boundingBox();
  for (let i = 0; i < 12; i++) {
    await page.mouse.move(canvas.x + canvas.width * (0.3 + 0.03 * i), canvas.y + canvas.height * 0.55);
    await wait(60);
    if (/slice \d+, level \d+/.test(await page.locator('.stage-lit').textContent())) break;
  }
  assert.match(await page.locator('.stage-lit').textContent(), /slice \d+, level \d+/, 'what is under the pointer is said');
  assert.deepEqual(complaints, []);
  await close();
});

test('a pattern from a file is shown as it lies, and what was judged of it', async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card').first().waitFor();
  await page.locator('input[type=file]').setInputFiles({ name: 'ladder.svg', mimeType: 'image/svg+xml', buffer: Buffer.from(ladder(6)) });
  await page.getByText('This is a pattern from a file.', { exact: false }).waitFor();
  await picture(page, 'design-foreign');
  await page.locator('input[type=file]').setInputFiles({ name: 'virus.exe', mimeType: 'application/octet-stream', buffer: Buffer.from('MZ') });
  await page.getByText(/"virus.exe" is none of them/).waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

const twoColours = `<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80" fill="none"><path d="M5 5H95V75H5Z"
  stroke="#000"/><path d="M30 30V50M70 30V50" stroke="#000"/><path d="M5 40H30M70 40H95" stroke="red"/><path d="M30 30H70M30 50H70" stroke="blue"/></svg>`;

test('a drawing asks in place what its colours are for; the answer is kept, and goes along with what is made of it', async () => {
  const { page, complaints, sent, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card').first().waitFor();
  const openIt = () => page.locator('input[type=file]').setInputFiles({ name: 'two.svg', mimeType: 'image/svg+xml', buffer: Buffer.from(twoColours) });
  await openIt();
  await page.getByText('What are these lines for?').waitFor();
  assert.deepEqual(await page.locator('.look-name').allTextContents(), ['black, 360 mm', 'red, 50 mm', 'blue, 80 mm']);
  await page.getByText('The drawing is 90 × 70 mm.').waitFor();
  await openPlan(page);
  assert.equal(await page.getByRole('button', { name: 'Show the sheets' }).isDisabled(), true, 'nothing is planned before the answer');
  await page.locator('dialog').getByRole('button', { name: 'Cancel' }).click();
  // It is not judged before, and keeps no other design from being cut.
  assert.equal(await page.locator('[aria-labelledby=judged], .warnings').count(), 0);
  await page.getByRole('button', { name: 'New', exact: true }).click();
  await page.locator('.start-card:enabled', { hasText: 'unit' }).click();
  await exact(page);
  await openPlan(page);
  await page.locator('dialog').getByText(/it fits/).waitFor();
  assert.equal(await page.getByRole('button', { name: 'Show the sheets' }).isEnabled(), true);
  await page.locator('dialog').getByRole('button', { name: 'Cancel' }).click();
  await openIt();
  await page.getByText('What are these lines for?').waitFor();
  // What is shown is the guess; one press takes it.
  assert.deepEqual(await page.locator('.look select').evaluateAll((all) => all.map((one) => one.value)), ['cut', 'fold-mountain', 'fold-valley']);
  await picture(page, 'design-drawing-asks');
  await page.locator('.look select').nth(1).selectOption('fold-valley');
  await page.getByRole('button', { name: 'Yes, use these' }).click();
  await page.getByText('Size and lines of the drawing').waitFor();
  await page.locator('.look select').nth(2).selectOption('fold-mountain');   // an answer can be changed
  await page.getByText('On the command line').click();
  await page.getByText('--colors "#ff0000=fold-valley; #000000=cut; #0000ff=fold-mountain"').waitFor();
  await page.reload();
  await page.getByRole('button', { name: 'Open a file' }).waitFor();
  await openIt();
  await page.getByText('Size and lines of the drawing').waitFor();
  await page.getByRole('button', { name: 'Make it…' }).click();
  await page.getByRole('button', { name: /^By hand/ }).click();
  await page.getByText('The pages are 210 × 297 mm.').waitFor();
  const download = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save sheets.pdf' }).click();
  assert.match((await bytesOf(await download)).toString('latin1'), /^%PDF[^]*MediaBox \[ ?0 0 595.2\d* 841.8\d* ?\]/, 'A4');
  await page.getByRole('button', { name: 'Other ways' }).click();
  await page.getByRole('button', { name: /^Silhouette Studio/ }).click();
  const dxf = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save sheet-01.dxf' }).click();
  assert.match((await bytesOf(await dxf)).toString(), /AC1009[^]*LINE\n8\nFOLD\n[^]*POLYLINE\n8\nCUT\n/);
  assert.equal(sent.filter((one) => one.path.endsWith('/plan')).length, 0);
  assert.deepEqual(complaints, []);
  await close();
});

test('of two colours one is cut and one folded, and what is dashed may be a fold', async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card').first().waitFor();
  const openIt = (name, dashes) => page.locator('input[type=file]').setInputFiles({ name, mimeType: 'image/svg+xml', buffer: Buffer.from(`<svg
    xmlns="http://www.w3.org/2000/svg" width="210mm" height="297mm" viewBox="0 0 210 297" fill="none"><path d="M5 5H205V285H5ZM60 80V200M140 80V200"
    stroke="#ed1c24"/><path d="M5 140H60M140 140H205M60 80H140M60 200H140" stroke="#0071bc" ${dashes}/></svg>`) });
  const uses = () => page.locator('.look select').evaluateAll((all) => all.map((one) => one.value));
  await openIt('solid.svg', '');
  await page.getByText('What are these lines for?').waitFor();
  assert.deepEqual(await uses(), ['cut', 'fold'], 'a red outline is no mountain fold');
  assert.equal((await page.locator('.flat-sheet figcaption').innerText()).trim(), '', 'no card of 0 × 0 mm');
  await page.getByRole('button', { name: 'Yes, use these' }).click();
  await page.getByText('Size and lines of the drawing').waitFor();
  // A line that is scored is on the sheet, as it will be there.
  const answer = page.waitForResponse((one) => /lattice.*score/.test(one.url()) && one.ok());
  await page.locator('.look select').nth(1).selectOption('score');
  const blob = await (await answer).body();
  const head = JSON.parse(blob.subarray(12, 12 + blob.readUInt32LE(8)));
  assert.equal(head.arrays.lines.length, 4 * (4 + 2 + 4));
  // A file that is opened is shown, also where the answer before is still in work.
  await page.route('**/make', async (route) => { await wait(500); await route.continue().catch(() => {}); }, { times: 1 });
  await page.locator('.look select').nth(1).selectOption('draw');
  await openIt('dashed.svg', 'stroke-dasharray="4 2"');
  await page.getByText('Dashed lines are cut as dashes.', { exact: false }).waitFor();
  assert.deepEqual(await uses(), ['', ''], 'nobody must answer');
  assert.equal(await page.getByRole('button', { name: 'Yes, use these' }).count(), 0);
  await page.locator('.look select').nth(1).selectOption('fold');
  await page.getByText('On the command line').click();
  await page.getByText('--colors "#0071bc=fold"').waitFor();
  // It fits the sheet in a cutter, and not within the margins of a page to cut by hand.
  await openPlan(page);
  const dialog = page.getByRole('dialog');
  await dialog.getByLabel('Paper or mat').selectOption('A4');
  await dialog.getByText('The card is 200 × 280 mm: it fits.').waitFor();
  await dialog.getByLabel('Cutter').selectOption({ label: 'by hand, with a knife' });
  await dialog.getByText('The card is 200 × 280 mm, too large for A4', { exact: false }).waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

test('examples are in two groups, each with its picture, in one order everywhere; what is begun far down is in view', ofPopcutd, async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/', screen: 'phone', motion: 'reduce' });
  const names = async (pictures) => {
    await page.locator(pictures).first().waitFor();
    return page.locator(pictures).evaluateAll((all) => all.map((one) => /example-(\w+)-/.exec(one.src)[1]));
  };
  const now = await names('.examples img');
  assert.equal(now[0], 'cat');
  assert.ok(now.includes('lantern') && now.indexOf('lantern') < now.indexOf('sphere'));
  await page.evaluate(() => { location.hash = '#/design'; });
  await page.locator('.start-card:enabled').first().waitFor();
  assert.deepEqual(await names('.start-picture img'), now);
  assert.equal(await page.locator('.start-card').count(), now.length, 'no card without its picture');
  await page.getByRole('heading', { name: 'From the paper' }).waitFor();
  await page.locator('.start-word input').fill('HI');
  await page.getByRole('button', { name: 'Make it stand up' }).click();
  await page.locator('.badge').waitFor();
  assert.equal(await page.evaluate(() => scrollY), 0);
  await page.getByRole('button', { name: 'Cut this…' }).waitFor();
  await page.evaluate(() => { location.hash = '#/settings'; });
  await page.getByText('Language').waitFor();
  assert.equal(await page.getByText('Pseudo').count(), 0);
  assert.deepEqual(complaints, []);
  await close();
});

test('a file without a unit asks how large it is, and the view follows the file that is open', async () => {
  const { page, sent, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card').first().waitFor();
  const line = (...at) => on('0', ...at);
  const on = (layer, ...at) => `0\nLINE\n8\n${layer}\n${[10, 20, 11, 21].map((code, i) => `${code}\n${at[i]}\n`).join('')}`;
  const dxf = `0\nSECTION\n2\nENTITIES\n${line(0, 0, 4, 0)}${line(4, 0, 4, 3)}${line(4, 3, 0, 3)}${line(0, 3, 0, 0)}${on('BEND', 1, 1, 3, 1)}0\nENDSEC\n0\nEOF\n`;
  await page.locator('input[type=file]').setInputFiles({ name: 'box.dxf', mimeType: 'image/vnd.dxf', buffer: Buffer.from(dxf) });
  for (const size of ['in mm: 4 × 3 mm', 'in cm: 40 × 30 mm', 'in inches: 101.6 × 76.2 mm']) await page.getByText(size).waitFor();
  // Nothing is planned or made before somebody has said it.
  await openPlan(page);
  assert.equal(await page.getByRole('button', { name: 'Show the sheets' }).isDisabled(), true);
  await page.locator('dialog').getByRole('button', { name: 'Cancel' }).click();
  await page.getByRole('button', { name: 'Make it…' }).click();
  await page.getByRole('button', { name: /^By hand/ }).click();
  await page.locator('dialog').getByText('in cm: 40 × 30 mm').waitFor();
  assert.equal(await page.locator('.made-files').count(), 0);
  await page.getByRole('button', { name: 'Close' }).click();
  await picture(page, 'design-unit');
  assert.deepEqual(await page.locator('.look-name').allTextContents(), ['BEND, 2 mm']);
  await page.getByText('in inches').click();
  await page.getByText('BEND, 50.8 mm').waitFor();
  assert.equal(await page.getByText('does not say its unit').count(), 0, 'it is said now');
  await page.getByText('On the command line').click();
  await page.getByText('--units "in"').waitFor();
  assert.deepEqual(sent.filter((one) => one.path.endsWith('/plan')), []);
  await openPlan(page);
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  await page.locator('.sheets .facts').getByText('101.6 × 76.2 mm').waitFor();
  await page.evaluate(() => { location.hash = '#/design'; });
  await page.locator('.design-bar').waitFor();
  await page.locator('.flat-sheet', { hasText: 'card 101.6 × 76.2 mm' }).waitFor();
  // A flat pattern leaves no flat view behind.
  await page.locator('input[type=file]').setInputFiles(new URL('../../docs/making/heart.svg', import.meta.url).pathname);
  await page.getByText('The drawing is 120 × 150 mm.').waitFor();
  const handle = page.locator('.handle-open');
  await handle.waitFor();
  const [stage, box] = [await page.locator('.stage-canvas').boundingBox(), await handle.boundingBox()];
  assert.ok(box.y >= stage.y && box.x >= stage.x && box.x + box.width <= stage.x + stage.width, 'the free edge is in the picture: the card is open');
  assert.deepEqual(complaints, []);
  await close();
});

test('a PDF is a drawing as others are, and of several drawings one is chosen', ofPopcutd, async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card').first().waitFor();
  // A card of 90 x 70 mm: dark grey, a red of its own and a light blue.
  const lines = '0.13 0.13 0.13 RG 14 14 255 198 re S 85 85 m 85 142 l S 198 85 m 198 142 l S '
    + '0.8 0.1 0.1 RG 14 113 m 85 113 l S 198 113 m 269 113 l S 85 85 m 198 85 l S 85 142 m 198 142 l S 0 0.5 1 RG 85 113 m 198 113 l S';
  const parts = ['<</Type/Catalog/Pages 2 0 R>>', '<</Type/Pages/Kids[3 0 R]/Count 1>>',
    '<</Type/Page/Parent 2 0 R/MediaBox[0 0 283 226]/Contents 4 0 R/Resources<<>>>>', `<</Length ${lines.length}>>stream\n${lines}\nendstream`];
  const pdf = Buffer.from(`%PDF-1.4\n${parts.map((one, i) => `${i + 1} 0 obj${one}endobj\n`).join('')}trailer<</Root 1 0 R/Size 5>>\n%%EOF\n`);
  const svg = Buffer.from(twoColours);
  await page.locator('input[type=file]').setInputFiles([{ name: 'two.svg', mimeType: 'image/svg+xml', buffer: svg }, { name: 'card.ai', mimeType: 'application/pdf', buffer: pdf }]);
  await page.getByRole('dialog', { name: 'There are 2 drawings. Which one?' }).getByRole('button', { name: 'card.ai' }).click();
  await page.getByText('What are these lines for?').waitFor();
  assert.deepEqual(await page.locator('.look select').evaluateAll((all) => all.map((one) => one.value)), ['cut', 'fold-mountain', 'fold-valley']);
  await page.getByText(/^The drawing is 90 × 69\.\d mm\.$/).waitFor();
  await page.getByRole('button', { name: 'Yes, use these' }).click();
  await page.getByText('opens in one movement').waitFor();
  await picture(page, 'design-pdf');
  await openPlan(page);
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  await page.getByRole('button', { name: 'Queue it' }).waitFor();
  assert.match(await page.locator('.sheets .facts').innerText(), /Paper, 220 gsm\s+for\s+Silhouette Cameo 3/);
  assert.deepEqual(complaints, []);
  await close();
});

test('folds whose side the drawing does not say can be set to mountain or valley', async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card').first().waitFor();
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80" fill="none" stroke="#000"><g id="Cut"><path d="M5 5H95V75H5Z"/><path d="M30 30V50M70 30V50"/></g><g id="Spine fold"><path d="M5 40H30M70 40H95"/></g><g id="Box fold"><path d="M30 30H70M30 50H70"/></g></svg>`;
  await page.locator('input[type=file]').setInputFiles({ name: 'sides.svg', mimeType: 'image/svg+xml', buffer: Buffer.from(svg) });
  await page.getByText('does not say to which side').waitFor();
  assert.deepEqual(await page.locator('.look-name').allTextContents(), ['Spine fold, 50 mm', 'Box fold, 80 mm']);
  assert.equal(await page.getByRole('button', { name: 'Yes, use these' }).count(), 0, 'nobody must answer');
  await page.locator('.look select').nth(1).selectOption('fold-mountain');
  await page.getByText('On the command line').click();
  await page.getByText('--layers "Box fold=fold-mountain"').waitFor();
  await picture(page, 'design-sides');
  assert.deepEqual(complaints, []);
  await close();
});

test('a file that is dropped anywhere is opened, also beside the column and from another view', ofPopcutd, async () => {
  const { page, complaints, close } = await visit(server, { hash: '', motion: 'reduce', screen: { width: 2200, height: 900, touch: false } });
  const drop = (text) => page.evaluate((content) => {
    const data = new DataTransfer();
    data.items.add(new File([content], 'dropped.svg', { type: 'image/svg+xml' }));
    const at = document.elementFromPoint(5, innerHeight - 5);   // in the margin
    for (const type of ['dragover', 'drop']) at.dispatchEvent(new DragEvent(type, { dataTransfer: data, bubbles: true, cancelable: true }));
  }, text);
  await page.locator('.now').waitFor();
  await drop(ladder(6));
  await page.getByText('This is a pattern from a file.', { exact: false }).waitFor();
  await page.getByRole('button', { name: 'New', exact: true }).click();
  await page.locator('.start-card:enabled').first().waitFor();
  await drop(ladder(7));
  await page.getByText('This is a pattern from a file.', { exact: false }).waitFor();
  assert.equal(await page.locator('.drop-over').count(), 0);
  assert.deepEqual(complaints, []);
  await close();
});

test('on a phone a file can be opened from the first screen', async () => {
  for (const hash of ['', '#/design']) {
    const { page, complaints, close } = await visit(server, { hash, screen: 'phone', motion: 'reduce' });
    const button = page.getByRole('button', { name: 'Open a file' });
    await button.waitFor();
    const { y, height } = await button.boundingBox();
    assert.ok(y + height < 700, `it is ${y} px down`);
    await picture(page, `first-screen-${hash === '' ? 'now' : 'design'}`);
    assert.deepEqual(complaints, []);
    await close();
  }
});

test('a card that is not drawn in time is not called impossible, and can be tried again', ofPopcutd, async () => {
  const { page, complaints, close } = await designing();
  expectComplaints(page, refused(422));
  const late = JSON.stringify({ type: '/problems/validation', status: 422, detail: 'took more than the 10 s', errors: [{ pointer: '', code: 'too-long', detail: 'took more than the 10 s' }] });
  await page.route('**/v1/preview', (route) => route.fulfill({ status: 422, contentType: 'application/problem+json', body: late }));
  await page.getByLabel('Designed opening angle').fill('80');
  await page.getByLabel('Designed opening angle').press('Enter');
  await page.getByText('This card takes long to draw.').waitFor();
  await picture(page, 'design-late');
  assert.equal(await page.getByText('This cannot be made.').count(), 0);
  assert.notEqual(await page.locator('.badge').textContent(), 'not possible');
  await page.unroute('**/v1/preview');
  await page.getByRole('button', { name: 'Try again' }).click();
  await exact(page);
  assert.equal(await page.locator('.impossible').count(), 0);
  assert.deepEqual(complaints, []);
  await close();
});

test('curvatures and figures of the engine are shown only where somebody opens them', async () => {
  const { page, complaints, close } = await designing();
  assert.deepEqual(await page.locator('.segments label').allTextContents(), ['paper', 'error', 'panel']);
  assert.equal(await page.getByText('fold vertices off').isVisible(), false);
  await page.getByText('Engine figures').click();
  assert.ok(await page.getByText('fold vertices off').isVisible());
  await page.locator('.segment', { hasText: 'domes and saddles' }).click();
  await page.getByText('Gaussian curvature', { exact: false }).waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

test('of cuts alone nothing is said to be checked that was not, and nothing is wrong with them', async () => {
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card').first().waitFor();
  await page.locator('input[type=file]').setInputFiles({ name: 'cuts.svg', mimeType: 'image/svg+xml', buffer: Buffer.from(ladder(6)) });
  await page.getByRole('heading', { name: 'Checked as a flat sheet' }).waitFor();
  await page.getByText('There are no folds here, so nothing opens.', { exact: false }).waitFor();
  assert.deepEqual(await page.locator('[aria-labelledby=judged] dt').allTextContents(), ['sheet']);
  assert.equal(await page.locator('.warnings').count(), 0);
  assert.deepEqual(complaints, []);
  await close();
});

test('pictures of the design in both themes and on a phone; nothing shifts', async () => {
  for (const [name, options] of [['light', {}], ['dark', { theme: 'dark' }], ['phone', { screen: 'phone' }]]) {
    const { page, complaints, close } = await designing('sphere', options);
    await page.locator('.segment', { hasText: 'error' }).click();
    await wait(1500);
    await picture(page, `design-${name}`);
    const shift = await page.evaluate(() => new Promise((done) => {
      let sum = 0;
      new PerformanceObserver((list) => { for (const one of list.getEntries()) if (!one.hadRecentInput) sum += one.value; })
        .observe({ type: 'layout-shift', buffered: true });
      setTimeout(() => done(sum), 200);
    }));
    assert.ok(shift < 0.1, `${name}: layout shifts by ${shift}`);
    const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(overflow <= 0, `${name}: ${overflow} px too wide`);
    assert.deepEqual(complaints, []);
    await close();
  }
});
