// What can be seen without a browser: the sources, their sizes, and small pure functions.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const web = fileURLToPath(new URL('../../daemon/web/', import.meta.url));
const sources = readdirSync(join(web, 'src')).filter((name) => /\.tsx?$/.test(name) && name !== 'api.d.ts')
  .map((name) => ({ name, text: readFileSync(join(web, 'src', name), 'utf8') }));

/** The source without its comments. */
const code = (text) => text.replace(/\/\*[\s\S]*?\*\//g, '').replace(/(^|[^:])\/\/.*$/gm, '$1');

test('no source turns text into HTML or code', () => {
  const banned = /\b(innerHTML|outerHTML|insertAdjacentHTML|dangerouslySetInnerHTML|DOMParser|document\.write|eval|new Function|srcdoc|createContextualFragment)\b/;
  for (const { name, text } of sources) assert.doesNotMatch(code(text), banned, name);
});

test('a token is never put into localStorage or an address', () => {
  for (const { name, text } of sources) {
    if (/localStorage/.test(code(text))) assert.doesNotMatch(code(text), /token/i, name);
    assert.doesNotMatch(code(text), /[?&](access_)?token=/, name);
  }
});

test('no source styles an element by an attribute: the policy forbids it', () => {
  for (const { name, text } of sources) assert.doesNotMatch(code(text), /\sstyle=|setAttribute\(['"]style/, name);
});

test('the lockfiles name no host, and nothing runs when packages are installed', () => {
  for (const folder of [web, fileURLToPath(new URL('.', import.meta.url))]) {
    assert.doesNotMatch(readFileSync(join(folder, 'package-lock.json'), 'utf8'), /https?:\/\/(?!.*"url")[^"]*\.tgz|"resolved"/);
    assert.match(readFileSync(join(folder, '.npmrc'), 'utf8'), /^ignore-scripts=true$/m);
    const { dependencies = {}, devDependencies = {} } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
    for (const version of Object.values({ ...dependencies, ...devDependencies })) assert.match(version, /^\d+\.\d+\.\d+$/);
  }
});

test('the built page keeps its budgets: 50 kB for the shell, 160 kB for the chunk with three, 300 kB in all', (context) => {
  let sizes;
  try {
    sizes = JSON.parse(readFileSync(join(web, 'dist/sizes.json'), 'utf8'));
  } catch {
    context.skip('the page is not built here: npm run build in daemon/web');
    return;
  }
  const sum = (files) => files.reduce((all, one) => all + one.gzip, 0);
  assert.ok(sum(sizes.shell) <= 50_000, `shell ${sum(sizes.shell)}`);
  for (const file of sizes.all) {
    const three = file.inputs.some((input) => input.includes('node_modules/three/'));
    if (three) assert.ok(file.gzip <= 160_000, `${file.path} ${file.gzip}`);
    if (three) assert.ok(!sizes.shell.some((one) => one.path === file.path), 'three is not in the shell');
  }
  assert.ok(sum(sizes.all.filter((one) => one.path.endsWith('.js'))) <= 300_000, `all ${sum(sizes.all)}`);
});

/** A module of the page, as it is. */
async function load(name) {
  const { build } = await import(new URL('node_modules/esbuild/lib/main.js', `file://${web}`).href);
  const { outputFiles } = await build({ entryPoints: [join(web, 'src', name)], bundle: true, format: 'esm', write: false, logLevel: 'error', define: { LOCAL: 'false' } });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString('base64')}`);
}

const ledger = { certain: [[0, 9]], in_doubt: [[10, 14]], not_sent: [[15, 39]] };

test('going on from a stroke says how many are cut, cut twice and left in doubt', async () => {
  const { consequence } = await load('choices.ts');
  assert.deepEqual(consequence(ledger, 10), { from: 10, cuts: 30, twice: 5, uncut: 0 });
  assert.deepEqual(consequence(ledger, 15), { from: 15, cuts: 25, twice: 0, uncut: 5 });
  assert.deepEqual(consequence(ledger, 0), { from: 0, cuts: 40, twice: 15, uncut: 0 });
});

test('a stroke in doubt is gone on from the first of its run, and no unsent stroke is left out', async () => {
  const { startNear } = await load('choices.ts');
  assert.equal(startNear(ledger, 12), 10);
  assert.equal(startNear(ledger, 4), 4);
  assert.equal(startNear(ledger, 30), 15);
  assert.equal(startNear({ certain: [[0, 3]], in_doubt: [], not_sent: [] }, 2), 2);
});

test('the ledger is drawn with ranges that end behind their last stroke', async () => {
  const { fatesOf } = await load('ledger.ts');
  assert.deepEqual(fatesOf(ledger), { certain: [[0, 10]], doubt: [[10, 15]], done: 0 });
});

test('a stream of events is read in any pieces, with comments, both line ends and the last id', async () => {
  globalThis.sessionStorage ??= { getItem: () => null };
  const { StreamText } = await load('events.ts');
  const text = ': hello\r\n\r\nevent: job\r\nid: 7\r\ndata: {"job":"a",\r\ndata: "state":"ready"}\r\n\r\nevent: progress\ndata: {"job":"b"}\n\ndata: broken {\n\n';
  for (const size of [1, 2, 3, 7, text.length]) {
    const stream = new StreamText();
    const events = [];
    for (let at = 0; at < text.length; at += size) events.push(...stream.push(text.slice(at, at + size)));
    assert.deepEqual(events, [{ kind: 'job', data: { job: 'a', state: 'ready' } }, { kind: 'progress', data: { job: 'b' } },
      { kind: 'message', data: {} }], `pieces of ${size}`);
    assert.equal(stream.lastId, '7');
  }
});

/** `zip` with `text` in place of `name` in its list and before its content: names of one length. */
const renamed = (zip, name, text) => Buffer.from(Buffer.from(zip).toString('latin1').replaceAll(name, text), 'latin1');

test('a zip gives its model and what belongs to it, and nothing of one that means harm', async () => {
  const { fileFor, sorted, withZipsOpened } = await load('model_files.ts');
  const { zipSync } = await import(new URL('node_modules/fflate/esm/browser.js', `file://${web}`).href);
  const zip = zipSync({ 'cat/cat.obj': Buffer.from('v 0 0 0'), 'cat/skin/Fur.png': Buffer.from('x'), 'cat/readme.txt': Buffer.from('x'), 'cat/cat.mtl': Buffer.from('') });
  const open = (bytes) => withZipsOpened([{ path: 'cat.zip', file: new File([bytes], 'cat.zip') }]);
  const { models, beside } = sorted(await open(zip));
  assert.deepEqual(models.map((one) => one.path), ['cat/cat.obj']);
  assert.equal(await models[0].file.text(), 'v 0 0 0');
  assert.deepEqual(beside.map((one) => one.path), ['cat/skin/Fur.png', 'cat/cat.mtl']);
  assert.equal(fileFor('..\\textures\\fur.PNG', beside).path, 'cat/skin/Fur.png');
  assert.equal(fileFor('paw.png', beside), null);
  await assert.rejects(open(renamed(zip, 'cat/cat.obj', '../../c.obj')), { kind: 'outside', at: '../../c.obj' });
  await assert.rejects(open(renamed(zip, 'cat/cat.obj', '/tmp/ct.obj')), { kind: 'outside' });
  await assert.rejects(open(zip.subarray(0, 40)), { kind: 'broken-zip' });
  const bomb = Buffer.from(zip);
  bomb.writeUInt32LE(0x7fffffff, bomb.indexOf('PK\x01\x02', 0, 'latin1') + 24);   // so large it says to be
  await assert.rejects(open(bomb), { kind: 'too-much' });
});
