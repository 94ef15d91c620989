// What cutters get: the engine of the site and popcut itself plan the same strokes, also of models.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { assertNear, contentOf, Engine, examples, materialOf, native, root, specOf } from './engine.mjs';

let engine;
let rows;
before(async () => {
  engine = await Engine.start();
  ({ rows } = engine.tables());
});

/** The strokes of a sheet, in whatever order and direction they are cut, each as text. */
function strokesOf(file) {
  const { stroke: { kind, piece, points }, xy_mm } = JSON.parse(String(file));
  let at = 0;
  return points.map((count, k) => {
    const path = Array.from({ length: count }, (_, i) => `${xy_mm[at + 2 * i]},${xy_mm[at + 2 * i + 1]}`);
    at += 2 * count;
    return [kind[k], piece[k], ...[path.join(' '), path.reverse().join(' ')].sort()[0].split(' ')].join(' ');
  }).sort();
}

/** Both plan it, and make the same sheets of the same strokes. Returns their files. */
function assertSameStrokes(design, assets) {
  const task = { kind: 'plan', design, designKind: 'spec', machine: JSON.stringify(rows.machines.cameo3), material: materialOf(rows, design), assets };
  const [here, there] = [engine.perform(task), native(task)];
  assert.deepEqual(here.error, null);
  assert.deepEqual([...here.files.keys()], [...there.files.keys()]);
  here.figures.sheets.forEach((sheet, k) => {
    for (const key of ['cut_mm', 'fold_mm']) assert.ok(Math.abs(sheet[key] - there.figures.sheets[k][key]) < 1e-6, key);
  });
  for (const [name, bytes] of here.files) {
    if (name.endsWith('.strokes.json')) assert.deepEqual(strokesOf(bytes), strokesOf(there.files.get(name)), name);
  }
  return [here.files, there.files];
}

for (const name of examples) test(`${name}: a plan has the same sheets, with the same strokes`, () => { assertSameStrokes(specOf(name)); });

const models = mkdtempSync(join(tmpdir(), 'popcut-models-'));
after(() => rmSync(models, { recursive: true }));
for (const name of ['house', 'car', 'boat', 'city', 'lighthouse', 'tree', 'letters']) {
  test(`the model ${name}: drawings are the same bytes, its structure the same numbers, its strokes the same`, () => {
    const spec = JSON.parse(contentOf(`docs/gallery/models/${name}.json`));
    const assets = {};
    if (spec.surface.file) {
      execFileSync(process.execPath, [fileURLToPath(new URL('docs/gallery/models/models.mjs', root)), models, '.', name]);
      const bytes = readFileSync(join(models, spec.surface.file));
      spec.surface.file = `sha256-${createHash('sha256').update(bytes).digest('hex')}`;
      assets[spec.surface.file] = bytes;
    }
    const design = Buffer.from(JSON.stringify(spec));
    const [here, there] = assertSameStrokes(design, assets);
    for (const [file, bytes] of here) {
      if (file.endsWith('pattern.svg')) assert.ok(bytes.equals(there.get(file)), `${file} differs`);
      if (file.endsWith('.fold')) assertNear(String(bytes), String(there.get(file)), 1e-9, file);
    }
    const dxf = { kind: 'export', design, designKind: 'spec', material: materialOf(rows, design), assets, options: { file: 'pattern.dxf', part: '1' } };
    assert.ok(engine.perform(dxf).files.get('pattern.dxf').equals(native(dxf).files.get('pattern.dxf')), 'pattern.dxf differs');
  });
}
