// The parts of Design that need no browser: what reads a lattice, a spec, a plan; previews that supersede each other.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { setTimeout as wait } from 'node:timers/promises';
import { deflateSync } from 'node:zlib';
import { blob, staircase, staircaseBlob } from './fixtures/staircase.mjs';
import { sources } from './sources.mjs';


const { readLattice, LatticeError, posedPoints, frameAt, onSheet } = await sources('lattice.ts');
const spec = await sources('spec.ts');
const { Previews } = await sources('preview.ts');
const ramps = await sources('ramps.ts');
const glue = await sources('glue_steps.ts');
const guide = await sources('fold_guide.ts');
const parts = await sources('parts_card.ts');
const { nearer } = await sources('zoom.ts');
const { strokesAt, strokeAt, strokeNumber, strokeStarts, endOf } = await sources('strokes.ts');

const near = (a, b, tolerance, what) => assert.ok(Math.abs(a - b) <= tolerance, `${what ?? ''} ${a} is not ${b}`);

test('a spec goes from lattice to facets and back with its shape and its length', () => {
  const lattice = { popcut: 1, name: 'a', surface: { type: 'profile', z: '40 - x' }, units_per_slice: 4, slices: 5, widths_mm: 12, fit: 'nearest', scale_mm: 2 };
  const facets = spec.asPanels(lattice, 'facets');
  assert.deepEqual(facets, { popcut: 1, name: 'a', style: 'facets', surface: lattice.surface, scale_mm: 2, facets: { from_mm: -6, length_mm: 60 } });
  const back = spec.asLattice(facets);
  assert.equal(back.slices * back.widths_mm, 60);
  assert.ok(!('style' in back) && !('facets' in back));
  // What says itself where it ends needs no length.
  assert.equal(spec.asPanels({ popcut: 1, surface: { type: 'mesh', file: 'x' }, slices: 5, units_per_slice: 2, widths_mm: 9 }, 'facets').facets, undefined);
  const layers = spec.asPanels(facets, 'silhouette');
  assert.deepEqual(layers, { popcut: 1, name: 'a', style: 'silhouette', surface: lattice.surface, scale_mm: 2, silhouette: { from_mm: -6, length_mm: 60 } });
  assert.deepEqual(spec.asPanels(layers, 'facets'), facets);
  assert.deepEqual(spec.asLattice(layers), back);
  // Cards of several parts stand in the middle of their pages, and keep the shape and its length.
  const glued = spec.asParts({ ...layers, translate_mm: [1, 2, 3], min_panel_mm: 2 }, 'layers');
  assert.deepEqual(glued, { popcut: 1, name: 'a', style: 'layers', surface: lattice.surface, scale_mm: 2, layers: { from_mm: -6, length_mm: 60 } });
  assert.deepEqual(spec.asPanels(glued, 'facets'), facets);
  const solid = { popcut: 1, style: 'facets', surface: { type: 'mesh', file: 'x' }, facets: { strip_mm: 3 }, translate_mm: [1, 0, 0] };
  assert.deepEqual(spec.asParts(solid, 'slices'), { popcut: 1, style: 'slices', surface: solid.surface });
  assert.ok(spec.isSolid(solid) && !spec.isSolid(lattice));
});

test('a lattice is read as it was written', () => {
  const lattice = readLattice(staircaseBlob({ steps: 3 }));
  assert.equal(lattice.name, 'staircase');
  assert.equal(lattice.faces, 8);
  assert.equal(lattice.triangle_face.length, 24);
  assert.deepEqual([...lattice.face_level], [-1, -1, 0, 1, 1, 2, 2, 3]);
  assert.deepEqual(lattice.error_mm, { max: 0.2 * 3, at: { slice: 0, level: 3 } });
});

test('at every opening all edges of faces keep their length, and on the sheet they lie as cut', () => {
  const lattice = readLattice(staircaseBlob({ steps: 4 }));
  const length = (places, a, b) => Math.hypot(...[0, 1, 2].map((k) => places[3 * a + k] - places[3 * b + k]));
  const flat = (a) => onSheet(lattice, a);
  for (const psi of [Math.PI, 2.2, Math.PI / 2, 0.7, 0]) {
    const places = posedPoints(lattice, psi);
    for (let t = 0; t < lattice.triangles.length; t += 3) {
      for (let k = 0; k < 3; k++) {
        const a = lattice.triangles[t + k];
        const b = lattice.triangles[t + ((k + 1) % 3)];
        const sheet = Math.hypot(flat(a)[0] - flat(b)[0], flat(a)[1] - flat(b)[1]);
        near(length(places, a, b), sheet, 1e-4, `psi ${psi}, side ${a}-${b}:`); // float32 of about 100 mm
      }
    }
  }
  const designed = posedPoints(lattice, Math.PI / 2);
  for (let i = 0; i < lattice.points.length; i += 3) {
    near(designed[i], lattice.points[i], 1e-5);
    near(designed[i + 2], lattice.points[i + 1], 1e-5);
  }
});

test('the tip of a V-fold keeps its distance from the apex and leaves the crease as the card opens', () => {
  const lattice = readLattice(staircaseBlob({ tip: true }));
  const tip = 3 * lattice.tips[0];
  for (const psi of [Math.PI, 2.5, 1.2, 0.4]) {
    const places = posedPoints(lattice, psi);
    const apex = [30 * Math.cos(psi), 20, 30 * Math.sin(psi)];
    const away = [places[tip] - apex[0], places[tip + 1] - apex[1], places[tip + 2] - apex[2]];
    near(Math.hypot(...away), 20, 1e-4);
    const splay = 2 * Math.atan(0.5 * Math.cos(psi / 2));
    near(Math.atan2(Math.hypot(away[0], away[2]), away[1]), splay, 1e-5);
  }
});

test('frames are blended between the two poses beside an opening', () => {
  const psi = [Math.PI, 2, 1];
  assert.deepEqual(frameAt(psi, 4), { index: 0, share: 0 });
  assert.deepEqual(frameAt(psi, 1.5), { index: 1, share: 0.5 });
  assert.deepEqual(frameAt(psi, 0.1), { index: 1, share: 1 });
  const { head, arrays } = staircase({ steps: 1 });
  const n = arrays.points[1].length;
  const frames = [...Array(n).fill(0), ...Array(n).fill(2), ...Array(n).fill(6)];
  const lattice = readLattice(blob({ ...head, motion: 'frames', frames: { psi_rad: psi } }, { ...arrays, frames: ['f32', frames] }));
  assert.ok(posedPoints(lattice, 1.5).every((value) => value === 4));
});

test('a lattice that does not agree with itself is refused with a sentence', () => {
  const broken = (change) => {
    const { head, arrays } = staircase();
    change(head, arrays);
    return blob(head, arrays);
  };
  const cases = [
    [new ArrayBuffer(4), /shorter than its head/],
    [new TextEncoder().encode('glTFxxxxxxxxxxxx').buffer, /does not begin with PCLB/],
    [broken((h) => { h.motion = 'magic'; }), /motion must be one of/],
    [broken((h) => { h.faces = 3; }), /"triangle_face"\[\d+\] is \d, but there are only 3/],
    [broken((h) => { h.faces = 1e9; }), /"face_kind" has 8 values where 1000000000 belong/],
    [broken((h, a) => { a.triangles[1][0] = 4e6; }), /"triangles"\[0\] is 4000000/],
    [broken((h, a) => { a.points[1][4] = NaN; }), /"points"\[4\] is not a number/],
    [broken((h, a) => { a.sides[1].pop(); }), /"sides" has \d+ values where \d+ belong/],
    [broken((h, a) => { a.sides[1][2] = 9; }), /"sides"\[2\] is not a role/],
    [broken((h, a) => { a.points[0] = 'u32'; }), /"points" must be f32, not u32/],
    [broken((h, a) => { delete a.face_error; }), /array "face_error" must be an object/],
    [broken((h) => { h.card.wall_mm = 'high'; }), /card.wall_mm must be a number/],
  ];
  for (const [bytes, sentence] of cases) {
    assert.throws(() => readLattice(bytes), (error) => error instanceof LatticeError && sentence.test(error.message), String(sentence));
  }
  const whole = new Uint8Array(staircaseBlob());
  for (let n = 0; n < whole.length; n += 97) assert.throws(() => readLattice(whole.slice(0, n).buffer), LatticeError, `${n} bytes`);
  const version = whole.slice();
  version[4] = 2;
  assert.throws(() => readLattice(version.buffer), /version 2 is not known/);
});

test('fields are changed without touching the rest of the spec', () => {
  const sphere = { popcut: 1, name: 'sphere', surface: { type: 'revolution', radius: 'sqrt(70^2 - (y - 45)^2)' }, units_per_slice: 5, slices: 10, widths_mm: 10 };
  assert.equal(spec.withUnits(sphere, 7.4).units_per_slice, 7);
  assert.deepEqual(spec.withSlices(sphere, 20), { ...sphere, slices: 20, widths_mm: 5 });
  assert.deepEqual(spec.withSliceWidth(sphere, 1, 12).widths_mm, [10, 12, 10, 10, 10, 10, 10, 10, 10, 10]);
  assert.deepEqual(spec.scaled(sphere, 0.5), { ...sphere, widths_mm: 5, scale_mm: 0.5 });
  assert.equal(sphere.units_per_slice, 5);
  const points = spec.withRadiusPoints(sphere, [[90, 40], [0, 50]]);
  assert.deepEqual(points.surface, { type: 'revolution', radius: { points: [[0, 50], [90, 40]] } });
  assert.deepEqual(spec.radiusPoints(spec.withRadius(points, 1, 44.444)), [[0, 50], [90, 44.44]]);
  assert.deepEqual(spec.radiusPoints(spec.stretched(points, 2)), [[0, 50], [180, 40]]);
  assert.deepEqual(spec.radiusPoints(spec.withPointAt(points, 45, 60)), [[0, 50], [45, 60], [90, 40]]);
  assert.equal(spec.withoutPoint(points, 0), points, 'two points stay');
  assert.equal(spec.unitsOf({ ...sphere, regions: [] }), null);
});

test('radii are read off the drawn target', () => {
  const { head, arrays } = staircase();
  head.report.slices = [{ s_mm: 0, v_mm: 17.5, width_mm: 10 }, { s_mm: 40, v_mm: 57.5, width_mm: 10 }];
  const ghost = [];
  for (let v = 17.5; v <= 57.5; v += 10) for (const a of [0, 0.5, 1]) ghost.push((30 + v - 17.5) * Math.cos(a), v, (30 + v - 17.5) * Math.sin(a));
  const lattice = readLattice(blob(head, { ...arrays, ghost_points: ['f32', ghost], ghost_triangles: ['u32', [0, 1, 3]] }));
  const radii = spec.sampledRadii(lattice, 6);
  assert.deepEqual(radii.map(([y]) => y), [-5, 5, 15, 25, 35, 45]);
  radii.forEach(([y, r]) => near(r, 30 + y, 0.011));
});

test('200 steps can be undone, a reload keeps them, and a new change ends what could be redone', () => {
  const kept = new Map();
  const storage = { getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => kept.set(key, value), removeItem: (key) => kept.delete(key) };
  const undo = new spec.Undo(storage, 'steps');
  for (let i = 0; i < 230; i++) undo.push({ popcut: 1, i });
  assert.equal(undo.length, 200);
  for (let i = 228; i >= 30; i--) assert.equal(undo.undo().i, i);
  assert.equal(undo.canUndo, false);
  assert.equal(undo.undo(), null);
  assert.equal(undo.redo().i, 31);
  const again = new spec.Undo(storage, 'steps');
  assert.equal(again.current.i, 31);
  assert.equal(again.canRedo, true);
  again.push({ popcut: 1, i: 'new' });
  assert.equal(again.canRedo, false);
  assert.equal(again.undo().i, 31);
  const full = { ...storage, setItem: (key, value) => { if (value.length > 2000) throw new Error('quota'); kept.set(key, value); } };
  const large = new spec.Undo(full, 'large');
  for (let i = 0; i < 100; i++) large.push({ popcut: 1, i, text: 'x'.repeat(60) });
  assert.equal(new spec.Undo(full, 'large').current.i, 99, 'without room for all, the newest stay');
});

test('a shared spec comes back as it was; bombs, strangers and files of others are refused', async () => {
  const shared = { popcut: 1, name: 'Grüße <b>', surface: { type: 'revolution', radius: '30' }, units_per_slice: 1, slices: 1, widths_mm: 30 };
  const text = await spec.shareText(shared);
  assert.match(text, /^[A-Za-z0-9_-]+$/);
  assert.deepEqual(await spec.fromShare(text), shared);
  const link = (content) => deflateSync(content).toString('base64url');
  const refusedBy = async (content, why) => assert.rejects(spec.fromShare(content), (error) => error instanceof spec.SpecError && error.message === why, why);
  await refusedBy(link(JSON.stringify({ popcut: 1, note: ' '.repeat(1 << 20) })), 'too-large');
  await refusedBy('x'.repeat(10_000), 'too-large');
  await refusedBy(text.slice(0, -6), 'not-a-link');
  await refusedBy('<script>', 'not-a-link');
  await refusedBy('', 'not-a-link');
  await refusedBy(link('[1, 2]'), 'not-a-spec');
  await refusedBy(link('not json'), 'not-json');
  await refusedBy(link(Buffer.from([0xff, 0xfe])), 'not-a-link');
  await refusedBy(link(JSON.stringify({ popcut: 1, surface: { type: 'mesh', file: '/etc/passwd' } })), 'has-files');
  await assert.rejects(spec.shareText({ popcut: 1, surface: { type: 'mesh', file: 'sha256-00' } }), /has-files/);
});

test('previews: one in work, one waits, the last input wins, and an exact one ends for a draft', async () => {
  const log = [];
  let inWork = 0;
  let most = 0;
  const shown = [];
  const previews = new Previews({
    rest_ms: 20,
    run: async (input, quality, signal) => {
      most = Math.max(most, ++inWork);
      log.push(`${quality} ${input}`);
      try {
        for (let i = 0; i < 4; i++) {
          await wait(4);
          signal.throwIfAborted();
        }
      } finally {
        inWork--;
      }
      return `${quality} ${input}`;
    },
    onResult: (result) => shown.push(result),
    onFailure: (error) => assert.fail(error),
  });
  for (let i = 1; i <= 10; i++) {
    previews.input(i);
    await wait(3);
  }
  const rests = async () => { for (let i = 0; i < 400 && previews.busy; i++) await wait(5); };
  await rests();
  assert.equal(most, 1);
  assert.equal(shown.at(-1), 'exact 10');
  assert.ok(log.length < 10, 'most inputs were replaced while they waited');
  previews.input(11, true);
  await wait(2);
  previews.input(12);
  await rests();
  assert.ok(!shown.includes('exact 11'));
  assert.deepEqual(shown.slice(-2), ['draft 12', 'exact 12']);
  assert.equal(previews.busy, false);
});

test('a failed preview is told only for an input that is still wanted', async () => {
  const failures = [];
  const previews = new Previews({
    rest_ms: 5,
    run: async (input) => { await wait(2); throw new Error(input); },
    onResult: () => assert.fail('nothing can be shown'),
    onFailure: (error, asked) => failures.push(`${asked.quality} ${error.message}`),
  });
  previews.input('a');
  for (let i = 0; i < 400 && failures.length < 2; i++) await wait(5);
  assert.deepEqual(failures, ['draft a', 'exact a']);
  previews.input('b');
  previews.end();
  await wait(30);
  assert.deepEqual(failures.length, 2);
});

test('scales: log for errors, both ways for curvature, card stays paper, lightness orders the ramp', () => {
  const lattice = readLattice(staircaseBlob());
  const scale = ramps.scaleOf(lattice, 'error');
  near(scale.high, 0.6, 1e-6);
  near(ramps.logShare(scale.high, scale.low, scale.high), 1, 1e-12);
  assert.equal(ramps.logShare(0, scale.low, scale.high), 0);
  near(ramps.bothShare(-1, 0.01, 1), 0, 1e-12);
  near(ramps.bothShare(0, 0.01, 1), 0.5, 1e-12);
  assert.ok(scale.ticks.length >= 2 && scale.ticks.every((tick) => tick.at >= 0 && tick.at <= 1));
  const values = new Float32Array(lattice.triangles.length);
  ramps.cornerValues(lattice, scale, values);
  lattice.triangle_face.forEach((face, t) => {
    assert.equal(values[3 * t] < 0, lattice.face_kind[face] !== 0, 'only panels are coloured');
  });
  const light = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
  for (let i = 1; i < ramps.sequential.length; i++) assert.ok(light(ramps.sequential[i]) < light(ramps.sequential[i - 1]) - 0.1);
  assert.ok(light(ramps.diverging[0]) < light(ramps.diverging[1]) && light(ramps.diverging[1]) < light(ramps.diverging[2]));
});

const strokes = {
  sheet: 1, width_mm: 100, length_mm: 100, mat: null, drawing_mm: [0, 0, 50, 50], kinds: ['cut', 'valley'],
  stroke: { kind: [0, 1, 0], piece: [1, 1, 1], pass: [1, 1, 1], start_s: [1, 4, 8], end_s: [3, 6, 10], points: [2, 3, 2] },
  xy_mm: [0, 0, 10, 0, 0, 5, 5, 5, 10, 5, 0, 10, 10, 10],
};

test('strokes are found by place, time and number', () => {
  assert.deepEqual([...strokeStarts(strokes)], [0, 4, 10, 14]);
  assert.equal(strokeAt(strokes, 7, 5.4, 2), 1);
  assert.equal(strokeAt(strokes, 7, 30, 2), null);
  assert.deepEqual(strokesAt(strokes, 0), { begun: 0, share: 1 });
  assert.deepEqual(strokesAt(strokes, 5), { begun: 2, share: 0.5 });
  assert.deepEqual(strokesAt(strokes, 7), { begun: 2, share: 1 });
  assert.deepEqual(strokesAt(strokes, 99), { begun: 3, share: 1 });
  assert.equal(endOf(strokes), 10);
  assert.deepEqual(strokeNumber(strokes, 2), { kind: 'cut', nth: 2, of: 2 });
});

test('the steps of gluing: both sides of a seam, and the tab where it comes to lie', () => {
  const turned = [[0, -1, 90], [1, 0, 5]];
  const plan = {
    sheets: [
      { pieces: [{ piece: 1, transform: [[1, 0, 4], [0, 1, 8]] }], tabs: [{ seam: 'A', piece: 1, under: 2, points: [[14, 28], [24, 28], [20, 34]] }],
        seams: [{ seam: 'A', piece: 1, other: 2, points: [[4, 28], [44, 28]] }] },
      { pieces: [{ piece: 2, transform: turned }], seams: [{ seam: 'A', piece: 2, other: 1, points: [[70, 5], [70, 45]], glued: [[[70, 5], [70, 25]]] }] },
    ],
    layout: { steps: [['A']] },
  };
  const steps = glue.glueSteps(plan, { mountains: 3, valleys: 4 });
  assert.deepEqual(steps.map((step) => step.kind), ['waste', 'mountains', 'valleys', 'seam', 'weight', 'open']);
  const [one, two] = steps[3].sides;
  assert.deepEqual([one.sheet, one.piece, one.tabs.length, one.shadows.length], [1, 1, 1, 0]);
  assert.deepEqual([two.sheet, two.piece, two.tabs.length], [2, 2, 0]);
  assert.deepEqual(two.edges, [[[70, 5], [70, 25]]]);
  // The tab's corner (14, 28) is (10, 20) on the pattern, and (-20 + 90, 10 + 5) on the second sheet.
  assert.deepEqual(two.shadows[0][0], [70, 15]);
  assert.deepEqual(glue.glueSteps({ sheets: [{}] }, { mountains: 0, valleys: 0 }), [{ kind: 'waste', sheets: 1 }]);
  // Nothing shuts that is no card: the net of a box is folded up.
  assert.deepEqual(glue.glueSteps({ sheets: [{}] }, { mountains: 0, valleys: 5 }, false).map((step) => step.kind), ['waste', 'valleys', 'shape']);
  assert.equal(glue.inverse([[1, 2, 0], [2, 4, 0]]), null);
  assert.equal(glue.bands([[[0, 0], [10, 0]]], 2).length, 12);
  assert.equal(glue.fans([[[0, 0], [1, 0], [1, 1], [0, 1]]]).length, 12);
});

test('a fold guide is its steps card by card, and lines and triangles become paths', () => {
  const step = (kind, folds) => ({ kind, words: kind, folds, panels: [] });
  const cards = [{ name: 'a', folds: [], steps: [step('waste', []), step('crease', [0])] }, { name: 'b', folds: [], steps: [step('push', [])] }];
  assert.deepEqual(guide.stepsOf({ cards }).map(({ card, step: one }) => [card, one.kind]), [[0, 'waste'], [0, 'crease'], [1, 'push']]);
  assert.equal(guide.boxAround([], 0.1), null);
  assert.deepEqual(guide.boxAround([[10, 0], [30, 100]], 0.1), [-10, 0, 120, 40]);
  assert.equal(guide.pathOf([[[10, 0], [10.00049, 5]]]), 'M0 10L5 10');
  assert.equal(guide.trianglesPath([0, 0, 4, 0, 4, 3]), 'M0 0L4 0L4 3Z');
});

/** Two pages of 40 x 20 mm, and a triangle on the right one that lies flat when they are shut; two poses. */
function smallCard(change = {}) {
  const points = [[0, 0], [0, 40], [20, 40], [20, 0], [0, 50], [0, 60], [10, 50]].flatMap(([u, v]) => [u, 0, v]);
  const open = [[0, 0, 0], [0, 40, 0], [20, 40, 0], [20, 0, 0], [10, 25, 0], [10, 35, 0], [10, 25, 10]];
  const shut = open.map(([x, v, z]) => [x, v, z / 10]);
  const one = (name, box_mm, shift_mm) => ({ name, folds: 1, tabs: 0, box_mm, shift_mm });
  return readLattice(blob({
    quality: 'exact', name: 'small', card: { wall_mm: 0, ground_mm: 0, width_mm: 0, card: false }, design_psi_rad: 3, faces: 2, motion: 'frames',
    frames: { psi_rad: [3, 1] }, parts: [one('card', [0, 0, 40, 20], [20, 0]), one('layer', [50, 0, 10, 10], [10, 50])], ...change,
  }, {
    points: ['f32', points], triangles: ['u32', [0, 1, 2, 0, 2, 3, 4, 5, 6]], triangle_face: ['u32', [0, 0, 1]], sides: ['u8', [1, 1, 0, 0, 1, 1, 1, 1, 1]],
    face_kind: ['u8', [0, 0]], face_slice: ['i32', [-1, -1]], face_level: ['i32', [-1, -1]], face_error: ['f32', [0, 0]], face_merged: ['u8', [0, 0]],
    face_part: ['i32', [0, 1]], lines: ['f32', [0, 0, 20, 0, 0, 50, 0, 60]], line_role: ['u8', [1, 1]], frames: ['f32', [...open, ...shut].flat()],
  }));
}

test('of a card of several parts some are shown alone, and all are pulled apart at every opening', () => {
  const card = smallCard();
  assert.deepEqual(card.parts.map(({ name }) => name), ['card', 'layer']);
  assert.throws(() => smallCard({ parts: [{ name: 'card', folds: 1, tabs: 0, box_mm: [0, 0, 40], shift_mm: [0, 0] }] }), /box_mm must have 4 numbers/);
  assert.throws(() => smallCard({ parts: smallCard().parts.slice(1) }), /names a part that is not there/);
  const alone = parts.onlyParts(card, new Set([1]));
  assert.deepEqual([...alone.triangles], [0, 1, 2]);
  assert.deepEqual([...alone.triangle_face], [1]);
  assert.deepEqual([...alone.frames], [10, 25, 0, 10, 35, 0, 10, 25, 10, 10, 25, 0, 10, 35, 0, 10, 25, 1]);
  assert.deepEqual([...posedPoints(alone, 1)].slice(6), [10, 25, 1]);
  const apart = parts.apart(card);
  assert.deepEqual([...apart.frames.subarray(0, 12)], [...card.frames.subarray(0, 12)], 'the pages stay');
  const away = (i) => [0, 1, 2].map((k) => apart.frames[3 * i + k] - card.frames[3 * i + k]);
  assert.ok(away(4)[2] > 3 && away(4)[1] > 3, 'up, and to its side');
  for (const i of [5, 6, 11, 12, 13]) assert.deepEqual(away(i).map((mm) => mm.toFixed(3)), away(4).map((mm) => mm.toFixed(3)));
  assert.ok(parts.isOn(card.parts[1], 0, 60) && !parts.isOn(card.parts[1], 0, 40));
});

test('the guide of a card of several parts has its places on the page of all parts', () => {
  const { guide: { cards }, steps } = guide.cardsOfParts({
    name: 'small', parts: [{ name: 'card', waste: 0, folds: [{ from: [5, 0], to: [5, 20], sense: 'valley' }] }, { name: 'layer', waste: 0, folds: [] }],
    tabs: [{ letter: 'A', part: 'layer', on: 'card', outline_mm: [[0, 0], [10, 0], [0, 10]], place_mm: [[20, 1], [30, 1], [20, 11]] }],
    steps: [{ kind: 'fold', part: 'card', with: [], words: 'crease', folds: [0], tabs: [] }, { kind: 'glue', part: 'layer', with: ['strut'], words: 'glue', folds: [], tabs: ['A'] }],
  }, smallCard().parts);
  assert.deepEqual(cards[0].folds, [{ from: [20, 5], to: [0, 5], sense: 'valley' }]);
  assert.deepEqual(steps.map(({ card, step: { kind, standing, added } }) => [card, kind, standing, added]), [[0, 'fold', [], []], [1, 'glue', ['card', 'layer', 'strut'], ['layer', 'strut']]]);
  assert.deepEqual(steps[1].step.tabs, [
    { letter: 'A', outline: [[10, 50], [10, 60], [0, 50]], isPlace: false }, { letter: 'A', outline: [[19, 20], [19, 30], [9, 20]], isPlace: true }]);
});

test('a drawing comes nearer about a place, and stays within its edges', () => {
  const whole = [10, 20, 100, 50];
  assert.deepEqual(nearer(whole, whole, 2, 60, 45), [35, 32.5, 50, 25], 'about its middle');
  assert.deepEqual(nearer(whole, whole, 2, 10, 20), [10, 20, 50, 25], 'about a corner');
  assert.deepEqual(nearer(whole, [60, 45, 50, 25], 0.1, 110, 70), whole, 'no farther than whole');
  assert.deepEqual(nearer(whole, [10, 20, 50, 25], 0.9, 60, 45)[0], 10, 'not over its edge');
  assert.ok(nearer(whole, whole, 1e9, 60, 45)[2] > 5, 'not without end');
});

test('previews that are dropped show nothing, and a later one does', async () => {
  const shown = [];
  let end;
  const previews = new Previews({
    run: (input) => new Promise((done) => { end = () => done(input); }),
    onResult: (result) => shown.push(result), onFailure: () => assert.fail('nothing failed'), rest_ms: 1,
  });
  previews.input('draft', true);
  const first = end;
  previews.drop();
  first();
  await new Promise((done) => setTimeout(done));
  assert.deepEqual(shown, []);
  assert.equal(previews.busy, false);
  previews.input('next', true);
  end();
  await new Promise((done) => setTimeout(done));
  assert.deepEqual(shown, ['next']);
});
