// The engine of the site and popcut itself: the same bytes, and the same numbers.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { assertNear, Engine, examples, materialOf, native, specOf } from './engine.mjs';

let engine;
let rows;
before(async () => {
  engine = await Engine.start();
  ({ rows } = engine.tables());
});

for (const name of examples) {
  test(`${name}: drawings are the same bytes, structures the same numbers`, () => {
    const design = specOf(name);
    const task = (file) => ({ kind: 'export', design, designKind: 'spec', material: materialOf(rows, design), options: { file, part: '1' } });
    for (const file of ['pattern.svg', 'cut.svg', 'pattern.dxf', 'poster.svg', 'deployed.svg']) {
      const [here, there] = [engine.perform(task(file)), native(task(file))];
      assert.deepEqual(here.error, there.error, `${name}: ${file}`);
      if (there.error) continue;
      assert.ok(here.files.get(file).equals(there.files.get(file)), `${name}: ${file} differs`);
    }
    const [here, there] = [engine.perform(task('pattern.fold')), native(task('pattern.fold'))];
    if (!there.error) assertNear(String(here.files.get('pattern.fold')), String(there.files.get('pattern.fold')), 1e-9, name);
    const [mine, theirs] = [engine, { perform: native }].map((of) => JSON.parse(String(of.perform(task('report.json')).files.get('report.json'))));
    for (const key of ['faces', 'panels', 'folds', 'cuts', 'cut_length_mm', 'fold_length_mm']) {
      if (typeof theirs[key] === 'number') assert.ok(Math.abs(mine[key] - theirs[key]) <= 1e-9 * Math.max(1, theirs[key]), `${name}: ${key}`);
    }
  });
}

test('what cannot be made is refused in the same words', () => {
  for (const text of ['{', '{"popcut":1}', '{"popcut":1,"surface":{"type":"revolution","radius":"0"},"units_per_slice":2,"slices":2,"widths_mm":9}']) {
    const task = { kind: 'preview', design: Buffer.from(text), designKind: 'spec', options: { quality: 'exact' } };
    const [here, there] = [engine.perform(task), native(task)];
    assert.ok(there.error);
    assert.deepEqual(here.error, there.error);
  }
});

/** A house of seven corners, as an OBJ file. */
const house = Buffer.from([
  ...[[0, 0], [60, 0], [60, 30], [30, 50], [0, 30]].flatMap(([x, z]) => [`v ${x} 0 ${z}`, `v ${x} 25 ${z}`]),
  'f 1 3 5 7 9', 'f 2 10 8 6 4', 'f 1 2 4 3', 'f 3 4 6 5', 'f 5 6 8 7', 'f 7 8 10 9', 'f 9 10 2 1', '',
].join('\n'));

/** A search in steps, as the page does it with so many workers; `perform` does a task. */
function inSteps(perform, task, workers) {
  const memory = { ways: null, cards: [], finished: [], drawn: [] };
  const pictures = {};
  const json = (value) => Buffer.from(JSON.stringify(value));
  for (;;) {
    const made = perform({ ...task, assets: { 'memory.json': json(memory), ...pictures } });
    if (made.error || !made.files.has('wanted.json')) return made;
    const wanted = JSON.parse(String(made.files.get('wanted.json')));
    memory.ways = wanted.ways;
    const all = wanted.finals.length > 0 ? wanted.finals : wanted.candidates;
    const each = Math.ceil(all.length / workers);
    for (let at = 0; at < all.length; at += each) {
      const some = all.slice(at, at + each);
      const judge = json({ ...wanted, ...(wanted.finals.length > 0 ? { finals: some } : { candidates: some }) });
      const { files } = perform({ ...task, assets: { 'judge.json': judge } });
      const listed = (file) => (files.has(file) ? JSON.parse(String(files.get(file))) : []);
      memory.cards.push(...listed('judged.json'));
      memory[wanted.drawn ? 'drawn' : 'finished'].push(...listed('finished.json'));
      for (const [name, bytes] of files) if (/^card-/.test(name)) pictures[name.replace(/\d+/, (n) => String(at + Number(n)).padStart(2, '0'))] = bytes;
    }
  }
}

test('a search finds the same cards in one go and in steps, whoever judges', () => {
  const words = { model: `sha256-${'0'.repeat(64)}`, name: 'house', mat: 'A4', style: 'silhouette', up: 'z', front: 'x', cards: 1, marks: false, seed: 1, max_minutes: 15, effort: 0.02 };
  const task = { kind: 'search', design: house, machine: JSON.stringify(rows.machines.cameo3), material: JSON.stringify(rows.materials['paper-220']), options: { search: JSON.stringify(words) } };
  for (const perform of [native, (one) => engine.perform(one)]) {
    const whole = perform(task);
    assert.equal(whole.error, null);
    for (const workers of [1, 3]) {
      const steps = inSteps(perform, task, workers);
      assert.equal(steps.error, null);
      assert.deepEqual([...steps.files.keys()], [...whole.files.keys()]);
      for (const [name, bytes] of whole.files) assert.ok(bytes.equals(steps.files.get(name)), `${name} with ${workers} workers`);
    }
  }
});
