// Odd designs from elsewhere, by link and by file: the page lives, says one sentence, and sends nothing but previews.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { deflateRawSync, deflateSync, gzipSync } from 'node:zlib';
import { closeBrowser, expectComplaints, picture, refused, startBackend, unitSpec, visit } from './harness.mjs';

let server;

before(async () => { server = await startBackend({ limits: { previews_per_s: 1000 } }); });
after(async () => { await closeBrowser(); await server.remove(); });

const packed = (text) => deflateSync(text).toString('base64url');
const link = (spec) => packed(typeof spec === 'string' ? spec : JSON.stringify(spec));

async function desk() {
  const visited = await visit(server, { hash: '#/design', motion: 'reduce' });
  await visited.page.locator('.start-card:not(:disabled)').first().waitFor();
  expectComplaints(visited.page, refused(422), refused(400), refused(413), refused(404));
  return visited;
}

const follow = (page, rest) => page.evaluate((to) => { location.hash = to; }, `#/design/${rest}`);

/** Waits for what came of it, and gives its sentence; '' if the design is shown. */
async function answered(page, what) {
  await page.locator('.note-bad, .impossible, .badge-exact').first().waitFor({ timeout: 60_000 })
    .catch(() => { throw new Error(`nothing comes of ${what}`); });
  const notes = await page.locator('.note-bad, .impossible').allInnerTexts();
  assert.ok(notes.length <= 1, `${what}: ${notes.length} sentences: ${notes.join(' | ')}`);
  return notes[0] ?? '';
}

/** The page still shows another view. */
async function lives(page, what) {
  await page.getByRole('link', { name: 'Settings', exact: true }).click({ timeout: 60_000 }).catch(() => { throw new Error(`dead after ${what}`); });
  await page.locator('.settings').waitFor();
}

test('a link that is no design says so, and sends nothing', async () => {
  const bomb = deflateSync(Buffer.alloc(100_000_000, 32), { level: 9 });
  assert.ok(bomb.length > 90_000, 'what grows a thousand times has a length that no link has');
  const within = deflateSync(Buffer.alloc(4_000_000, 32), { level: 9 });
  const cases = [
    ['', /does not hold|not a design|cannot be read/],
    ['x', /does not hold/],
    ['A'.repeat(8001), /more than a design may have/],
    ['A'.repeat(2_000_000), /more than a design may have/],
    [bomb.toString('base64url'), /more than a design may have/],
    [within.toString('base64url').slice(0, 8000), /more than a design may have|does not hold/],
    [deflateSync(Buffer.alloc(900_000, '{"popcut": 1, "note": "')).toString('base64url'), /more than a design may have/],
    [deflateSync('{"popcut":1}').subarray(0, 9).toString('base64url'), /does not hold/],
    [gzipSync('{"popcut":1}').toString('base64url'), /does not hold/],
    [deflateRawSync('{"popcut":1}').toString('base64url'), /does not hold/],
    [Buffer.from('{"popcut":1}').toString('base64url'), /does not hold/],
    ['not base64 at all!', /does not hold/],
    ['%F0%9F%92%A3', /does not hold/],
    ['%E0%A4%A', /does not hold/],
    ['..%2F..%2Fv1%2Fjobs', /does not hold/],
    [packed(Buffer.from([0xff, 0xfe, 0x00])), /does not hold/],
    [packed('not json'), /cannot be read/],
    [packed('{"popcut": 1'), /cannot be read/],
    [packed('['.repeat(100_000)), /cannot be read/],
    ...['null', '1', '"popcut"', '[]', '{}', '{"popcut": "1"}', '[{"popcut": 1}]'].map((text) => [packed(text), /not a spec/]),
    [packed('{"popcut": 2}'), /newer popcut/],
    [link({ ...unitSpec, surface: { type: 'grid', file: 'sha256-00' } }), /names a file/],
  ];
  const { page, sent, complaints, close } = await desk();
  for (const [text, sentence] of cases) {
    const what = `d=${text.slice(0, 40)}`;
    await follow(page, `d=${text}`);
    const note = await answered(page, what);
    assert.match(note, sentence, what);
    assert.equal(await page.locator('.design-start').isVisible(), true, what);
    await page.locator('.note-bad').getByRole('button', { name: 'Close' }).click();
    await page.evaluate(() => { location.hash = '#/design'; });
  }
  assert.deepEqual(sent.filter((one) => one.path !== '/v1/session'), []);
  await lives(page, 'links');
  assert.deepEqual(complaints, []);
  await close();
});

/** Specs in which one field, at any depth, has another value. */
function* mutants(spec, values) {
  for (const field of Object.keys(spec)) {
    for (const value of values) if (field !== 'popcut') yield [`${field} = ${JSON.stringify(value).slice(0, 40)}`, { ...spec, [field]: value }];
  }
}

const odd = [null, true, -1, 0, 0.5, 1e308, '', 'text', [], [1, null, 'x'], {}, { points: 'x', type: 5 }];
const whole = {
  ...unitSpec, surface: { type: 'revolution', radius: { points: [[-10, 30], [15, 32], [40, 30]] } }, min_panel_mm: 1, lattice: 'levels',
  fit: 'nearest', design_angle_deg: 90, material: 'paper-220', rotate_deg: [0, 0, 0], translate_mm: [0, 0, 0], scale_mm: 1,
};
/** Fields that `whole` does without: alone they are wrong in most specs. */
const others = { regions: [], patches: [], splay: { alpha: 1 }, card: { margin_mm: 10 }, curvature: 1, 'no such field': 1 };

test('a spec with a wrong type or value in any field: one sentence or a design, and every part of the page lives', async () => {
  const { page, sent, complaints, close } = await desk();
  let shown = 0;
  let said = 0;
  const all = [['nothing', whole], ...mutants(whole, odd), ...Object.keys(others).flatMap((field) => odd.slice(-5).map((value) => [`${field} = ${JSON.stringify(value)}`, { ...whole, [field]: value }]))];
  for (const [what, spec] of all) {
    await follow(page, `d=${link(spec)}`);
    await page.waitForFunction(() => location.hash === '#/design' && document.querySelector('.design') !== null
      && document.querySelector('.note-bad, .impossible, .badge-exact') !== null, undefined, { timeout: 60_000 })
      .catch(() => { throw new Error(`nothing comes of ${what}: ${complaints.join('; ')}`); });
    const note = await answered(page, what);
    if (note) said++;
    else shown++;
    assert.ok(note.length < 600, `${what}: ${note}`);
    if (complaints.length > 0) throw new Error(`${what}: ${complaints.join('; ')}`);
  }
  assert.ok(said > 100 && shown > 5, `${said} are refused, ${shown} are shown`);
  assert.deepEqual(sent.filter((one) => !['/v1/session', '/v1/preview'].includes(one.path)), []);
  await lives(page, 'mutants');
  assert.deepEqual(complaints, []);
  await close();
});

test('specs of a size that nobody can make are refused soon, and the page lives', async () => {
  const deep = (n) => { let text = '{"popcut":1,"name":"deep","surface":'; for (let i = 0; i < n; i++) text += '{"a":'; return `${text}1${'}'.repeat(n + 1)}`; };
  const cases = [
    ['10^6 units', { ...unitSpec, units_per_slice: 1_000_000 }],
    ['10^6 slices', { ...unitSpec, slices: 1_000_000 }],
    ['4 thousand million slices', { ...unitSpec, slices: 4_294_967_296 }],
    ['10^308 slices', { ...unitSpec, slices: 1e308 }],
    ['half a slice', { ...unitSpec, slices: 0.5 }],
    ['10^6 of both', { ...unitSpec, units_per_slice: 1_000_000, slices: 1_000_000, widths_mm: 0.001 }],
    ['40 000 widths', { ...unitSpec, slices: 40_000, widths_mm: Array.from({ length: 40_000 }, () => 1) }],
    ['a formula without end', { ...unitSpec, surface: { type: 'revolution', radius: '('.repeat(50_000) } }],
    ['a formula of many powers', { ...unitSpec, surface: { type: 'revolution', radius: '9^9^9^9^9^9' } }],
    ['30 000 points', { ...unitSpec, surface: { type: 'revolution', radius: { points: Array.from({ length: 30_000 }, (_, i) => [i / 1000, 30]) } } }],
    ['deep', deep(5000)],
    ['a long name', { ...unitSpec, name: 'x'.repeat(200_000) }],
    ['a name of controls', { ...unitSpec, name: '\u0000\u202e\ud800\n<b>' }],
  ];
  const { page, sent, complaints, close } = await desk();
  for (const [what, spec] of cases) {
    const text = link(spec);
    if (text.length > 8000) {
      // Too long for a link; as a file it is read.
      await page.locator('input[type=file]').setInputFiles({ name: 'odd.json', mimeType: 'application/json', buffer: Buffer.from(typeof spec === 'string' ? spec : JSON.stringify(spec)) });
    } else {
      await follow(page, `d=${text}`);
    }
    await page.waitForFunction(() => document.querySelector('.note-bad, .impossible') !== null || document.querySelector('.design-name')?.value !== 'unit', undefined, { timeout: 60_000 })
      .catch(() => { throw new Error(`nothing comes of ${what}`); });
    await answered(page, what);
    if (complaints.length > 0) throw new Error(`${what}: ${complaints.join('; ')}`);
    if (what === '10^6 units') await picture(page, 'links-too-much');
    for (const button of await page.locator('.note-bad button').all()) await button.click();
    await follow(page, `d=${link(unitSpec)}`);
    await page.waitForFunction(() => location.hash === '#/design' && document.querySelector('.badge-exact') !== null);
  }
  await lives(page, 'specs of any size');
  assert.deepEqual(sent.filter((one) => !['/v1/session', '/v1/preview'].includes(one.path)), []);
  assert.deepEqual(complaints, []);
  await close();
});

test('the same link opened again after changes brings its design again', async () => {
  const { page, complaints, close } = await desk();
  const address = `d=${link({ ...unitSpec, name: 'shared' })}`;
  const units = page.getByLabel('Steps in a slice (N)');
  for (let i = 0; i < 2; i++) {
    await follow(page, address);
    await page.locator('.badge', { hasText: 'exact' }).waitFor();
    assert.equal(await units.inputValue(), '1');
    assert.equal(new URL(page.url()).hash, '#/design');
    await units.focus();
    await page.keyboard.press('ArrowRight');
    assert.equal(await units.inputValue(), '2');
  }
  assert.deepEqual(complaints, []);
  await close();
});
