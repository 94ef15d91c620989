// The engine of the site in node, and popcutd's worker beside it: both do the same task.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';

const folder = resolve(process.env.POPCUT_ENGINE ?? 'build/site/engine');
const popcutd = process.env.POPCUTD ?? 'popcutd';
const kinds = ['check', 'plan', 'testCut', 'preview', 'lattice', 'picture', 'export', 'place', 'artwork', 'svg', 'make', 'search'];
export const Kind = { task: 1, design: 2, asset: 3, go: 4, file: 5, outcome: 6, failure: 7, phase: 8 };

function frame(kind, name, content) {
  const word = Buffer.from(name);
  const bytes = Buffer.from(content);
  const head = Buffer.alloc(20);
  head.write('PCW1', 'latin1');
  head.writeUInt32LE(kind, 4);
  head.writeUInt32LE(word.length, 8);
  head.writeBigUInt64LE(BigInt(bytes.length), 12);
  return Buffer.concat([head, word, bytes]);
}

/** The frames of a task. `assets`: bytes by id. */
export function taskBytes({ kind, design, designKind = '', machine = '', material = '', options = {}, assets = {} }) {
  const about = { kind: kinds.indexOf(kind), design_kind: designKind, machine, material, profile: '', options };
  return Buffer.concat([frame(Kind.task, '', JSON.stringify(about)), frame(Kind.design, '', design),
    ...Object.entries(assets).map(([id, bytes]) => frame(Kind.asset, id, bytes)), frame(Kind.go, '', '')]);
}

/** What comes of a task, whichever did it: files by name, figures or an error. */
function outcomeOf(frames) {
  const one = (kind) => frames.find((each) => each.kind === kind);
  const text = (kind) => (one(kind) ? JSON.parse(one(kind).bytes.toString()) : null);
  return { files: new Map(frames.filter(({ kind }) => kind === Kind.file).map(({ name, bytes }) => [name, bytes])), figures: text(Kind.outcome), error: text(Kind.failure) };
}

export class Engine {
  static async start() {
    const engine = new Engine();
    engine.of = await createRequire(import.meta.url)(join(folder, 'engine.js'))({ wasmBinary: readFileSync(join(folder, 'engine.wasm')) });
    return engine;
  }

  /** Does a task; `ms` is the processor's time. */
  perform(task) {
    const bytes = taskBytes(task);
    const frames = [];
    this.of.onFrame = (kind, name, content) => frames.push({ kind, name, bytes: Buffer.from(content) });
    const begin = process.cpuUsage();
    const at = this.of._malloc(bytes.length);
    this.of.HEAPU8.set(bytes, at);
    this.of._popcut_answer(at, bytes.length);
    this.of._free(at);
    const { user } = process.cpuUsage(begin);
    return { ...outcomeOf(frames), ms: user / 1000 };
  }

  tables() {
    let text = '';
    this.of.onFrame = (kind, name, bytes) => { text = Buffer.from(bytes).toString(); };
    this.of._popcut_tables();
    return JSON.parse(text);
  }
}

/** The same by popcutd's worker, in a process of its own. */
export function native(task) {
  const { stdout, status, stderr } = spawnSync(popcutd, ['--worker'], { input: taskBytes(task), maxBuffer: 1 << 30 });
  if (status !== 0) throw new Error(`popcutd --worker ends with ${status}: ${stderr}`);
  const frames = [];
  for (let at = 0; at < stdout.length;) {
    const name = stdout.readUInt32LE(at + 8);
    const size = Number(stdout.readBigUInt64LE(at + 12));
    const begin = at + 20 + name;
    frames.push({ kind: stdout.readUInt32LE(at + 4), name: stdout.toString('utf8', at + 20, begin), bytes: stdout.subarray(begin, begin + size) });
    at = begin + size;
  }
  return outcomeOf(frames);
}

export const root = new URL('../../../', import.meta.url);
export const contentOf = (path) => readFileSync(new URL(path, root));
export const examples = readdirSync(new URL('examples/', root)).filter((name) => name.endsWith('.json')).map((name) => name.slice(0, -5));
export const specOf = (name) => contentOf(`examples/${name}.json`);
/** The row of the material of a spec. */
export const materialOf = (rows, spec) => JSON.stringify(rows.materials[JSON.parse(spec).material ?? 'paper-220']);

/** Both are the same but for numbers, which differ by no more than `most`. */
export function assertNear(a, b, most, what) {
  const number = /-?\d+(?:\.\d+)?(?:e[-+]?\d+)?/g;
  assert.equal(a.replace(number, '#'), b.replace(number, '#'), what);
  const [first, second] = [a, b].map((text) => text.match(number) ?? []);
  first.forEach((text, k) => {
    const [x, y] = [Number(text), Number(second[k])];
    assert.ok(Math.abs(x - y) <= most * Math.max(1, Math.abs(x)), `${what}: ${x} and ${y}`);
  });
}
