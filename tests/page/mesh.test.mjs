// Models (STL, OBJ): opened, placed, drawn and cut; and those that are broken or mean harm.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { armHere, closeBrowser, drawn, expectComplaints, hold, machineHash, ofPopcutd, onPopcutd, openModel, picture, refused, startBackend, until, visit } from './harness.mjs';

let server;

before(async () => { server = await startBackend({ devices: [{ id: 'sim:cameo3', time_scale: 100 }] }); });
after(async () => { await closeBrowser(); await server.remove(); });

/** Corners and triangles of a ball with radius `r` mm, somewhere in space. */
function ball(r = 40, rings = 12, around = 24) {
  const corners = [];
  for (let i = 0; i <= rings; i++) {
    for (let k = 0; k < around; k++) {
      const [a, b] = [Math.PI * i / rings, 2 * Math.PI * k / around];
      corners.push([100 + r * Math.sin(a) * Math.cos(b), -7 + r * Math.sin(a) * Math.sin(b), 3 + r * Math.cos(a)]);
    }
  }
  const at = (i, k) => i * around + k % around;
  const triangles = [];
  for (let i = 0; i < rings; i++) {
    for (let k = 0; k < around; k++) {
      if (i > 0) triangles.push([at(i, k), at(i + 1, k), at(i, k + 1)]);
      if (i < rings - 1) triangles.push([at(i, k + 1), at(i + 1, k), at(i + 1, k + 1)]);
    }
  }
  return { corners, triangles };
}

function binaryStl({ corners, triangles }, said = triangles.length) {
  const bytes = Buffer.alloc(84 + 50 * triangles.length);
  bytes.writeUInt32LE(said, 80);
  triangles.forEach((triangle, t) => triangle.forEach((corner, k) => corners[corner].forEach((value, axis) => {
    bytes.writeFloatLE(value, 84 + 50 * t + 12 + 12 * k + 4 * axis);
  })));
  return bytes;
}

function textStl({ corners, triangles }) {
  const facets = triangles.map((triangle) => `facet normal 0 0 0\nouter loop\n${triangle.map((corner) => `vertex ${corners[corner].join(' ')}`).join('\n')}\nendloop\nendfacet`);
  return Buffer.from(`solid ball\n${facets.join('\n')}\nendsolid ball\n`);
}

function obj({ corners, triangles }) {
  return Buffer.from([...corners.map((corner) => `v ${corner.join(' ')}`), ...triangles.map((triangle) => `f ${triangle.map((i) => i + 1).join(' ')}`)].join('\n'));
}

async function desk() {
  const visited = await visit(server, { hash: '#/design', motion: 'reduce' });
  await visited.page.locator('.start-card:not(:disabled)').first().waitFor();
  return visited;
}

const file = (name, buffer) => ({ name, mimeType: 'application/octet-stream', buffer });
const give = (page, name, buffer) => page.locator('.design-drop > input[type=file]').setInputFiles(file(name, buffer));

const specOf = (page) => page.evaluate(() => {
  const { steps, at } = JSON.parse(sessionStorage.getItem('popcut.design.steps'));
  return JSON.parse(steps[at]);
});

for (const [name, bytes] of [['ball.stl', binaryStl(ball())], ['ball in words.stl', textStl(ball())], ['BALL.OBJ', obj(ball())],
  ['in metres.stl', binaryStl(ball(0.03))], ['in inches.obj', obj(ball(1.18))]]) {
  test(`${name} is placed in the corner of a card, drawn and exact`, async () => {
    const { page, sent, complaints, close } = await desk();
    await openModel(page, file(name, bytes));
    await drawn(page);
    const spec = await specOf(page);
    assert.equal(spec.surface.type, 'mesh');
    assert.equal(spec.name, name.replace(/\.[^.]*$/, ''));
    assert.equal(await page.locator('.design-name').inputValue(), spec.name);
    if (onPopcutd) assert.deepEqual(sent.map((one) => one.path).filter((path) => path !== '/v1/session').sort(),
      ['/v1/assets', `/v1/assets/${spec.surface.file}/search`, '/v1/place', '/v1/preview']);
    const height = Number(await page.getByLabel('Height', { exact: true }).inputValue());
    assert.ok(height > 20 && height < 100, `it stands ${height} mm high`);
    assert.match(await page.locator('.stage-canvas').first().getAttribute('aria-label'), /\d{2,} panels, open to 90 degrees/);
    assert.equal(await page.locator('.note-bad').count(), 0);
    await picture(page, `mesh-${name.replace(/\W/g, '-').toLowerCase()}`);
    assert.deepEqual(complaints, []);
    await close();
  });
}

test('a model goes the whole way to a cut; it cannot be shared by a link', ofPopcutd, async () => {
  const { page, complaints, close } = await desk();
  await openModel(page, file('dome.stl', binaryStl(ball(25))));
  await drawn(page);
  await page.getByRole('button', { name: 'Share' }).click();
  await page.getByText('This design uses a file of its own', { exact: false }).waitFor();
  assert.equal(await page.locator('.share-link').count(), 0);
  await page.getByRole('button', { name: 'Close' }).click();
  await page.getByRole('button', { name: 'Cut this…' }).click();
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  await page.getByRole('button', { name: 'Queue it' }).click({ timeout: 60_000 });
  await page.getByText('It is in the queue.', { exact: false }).waitFor();
  const { items: [{ id }] } = await server.must('GET', '/v1/queue');
  await server.state(id, 'ready');
  await page.evaluate((to) => { location.hash = to; }, machineHash());
  await armHere(page);
  await hold(page);
  await server.state(id, 'done', 60_000);
  assert.equal((await server.job(id)).name, 'dome');
  assert.deepEqual(complaints, []);
  await close();
});

const huge = Buffer.alloc(200);
huge.writeUInt32LE(0xffffffff, 80);
const flat = { corners: [[0, 0, 0], [10, 0, 0], [0, 10, 0]], triangles: [[0, 1, 2]] };
const point = { corners: [[5, 5, 5]], triangles: Array.from({ length: 40 }, () => [0, 0, 0]) };
const broken = [
  ['empty.stl', Buffer.alloc(0)],
  ['cut short.stl', binaryStl(ball()).subarray(0, 5000)],
  ['says 4 thousand million.stl', huge],
  ['noise.stl', Buffer.from(Array.from({ length: 5000 }, (_, i) => (i * 7919 + (i >> 3)) & 255))],
  ['not a number.stl', binaryStl({ ...ball(), corners: ball().corners.map(() => [NaN, Infinity, 1]) })],
  ['words only.stl', Buffer.from('solid x\nfacet normal 0 0 0\nouter loop\nvertex a b c\nendloop\nendfacet\nendsolid')],
  ['never ends.stl', Buffer.from('solid x\n' + 'facet normal 0 0 0\nouter loop\n'.repeat(50_000))],
  ['flat.stl', binaryStl(flat)],
  ['a point.stl', binaryStl(point)],
  ['very far.stl', binaryStl({ ...ball(), corners: ball().corners.map((corner) => corner.map((value) => value * 1e36)) })],
  ['very small.stl', binaryStl({ ...ball(), corners: ball().corners.map((corner) => corner.map((value) => value * 1e-36)) })],
  ['out of range.obj', Buffer.from('v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999\n')],
  ['behind the start.obj', Buffer.from('v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9223372036854775808\n')],
  ['many corners.obj', Buffer.from('v 0 0 0\nv 1 0 0\nv 0 1 0\nf ' + '1 2 3 '.repeat(400_000))],
  ['no triangles.obj', Buffer.from('v 0 0 0\n'.repeat(1000))],
  ['bad numbers.obj', Buffer.from('v 1e999 nan --3\nv 0 0 0\nv 1 1 1\nf 1 2 3\n')],
  ['<img src=x onerror=alert(1)>.obj', Buffer.from('mtllib ../../etc/passwd\nusemtl <script>\nf 1 2 3\n')],
];

test('a model that is broken or means harm gives one sentence, and the desk stays as it is', async () => {
  const { page, sent, complaints, close } = await desk();
  expectComplaints(page, refused(400), refused(422));
  page.on('dialog', () => complaints.push('a dialog of the browser'));
  for (const [name, bytes] of broken) {
    await give(page, name, bytes);
    const note = page.locator('.note-bad');
    await note.waitFor({ timeout: 60_000 }).catch(() => { throw new Error(`"${name}" gives no sentence`); });
    assert.equal(await note.count(), 1, name);
    const text = (await note.innerText()).trim();
    assert.ok(text.length > 20 && text.length < 260, `${name}: ${text}`);
    assert.ok(!/sha256|\/surface/.test(text), `it speaks of the file by its name: ${text}`);
    assert.ok(await note.locator('.server-words').count() <= 1, text);
    assert.equal(await page.locator('.design-start').isVisible(), true, name);
    assert.equal(await page.locator('.design-start p[role=status]').count(), 0, 'nothing is said to go on');
    await note.getByRole('button', { name: 'Close' }).click();
    assert.equal(await note.count(), 0);
  }
  assert.ok(sent.every((one) => ['/v1/assets', '/v1/place', '/v1/session'].includes(one.path)), 'nothing is designed, planned or queued');
  // And over a design: that stays.
  await page.locator('.start-card', { hasText: 'unit' }).click();
  await page.locator('.badge', { hasText: 'exact' }).waitFor();
  await give(page, 'cut short.stl', broken[1][1]);
  await page.locator('.note-bad').waitFor();
  await picture(page, 'mesh-broken');
  assert.equal(await page.locator('.design-name').inputValue(), 'unit');
  assert.equal(await page.locator('.badge').textContent(), 'exact');
  assert.deepEqual(complaints, []);
  await close();
});

test('of a model that is being placed and a design that is begun meanwhile, the one begun last stays', ofPopcutd, async () => {
  const { page, complaints, close } = await desk();
  let placed = false;
  await page.route('**/v1/place', async (route) => {
    const response = await route.fetch();
    await page.locator('.start-card', { hasText: 'unit' }).click();
    await page.locator('.badge', { hasText: 'exact' }).waitFor();
    await route.fulfill({ response });
    placed = true;
  });
  await openModel(page, file('ball.stl', binaryStl(ball())));
  await until(() => placed, 'it is sent to be placed');
  await page.getByText('Sending the model', { exact: false }).waitFor({ state: 'detached' });
  assert.equal(await page.locator('.design-name').inputValue(), 'unit');
  assert.equal((await specOf(page)).name, 'unit');
  assert.equal(await page.locator('.note-bad').count(), 0);
  assert.deepEqual(complaints, []);
  await close();
});

/** An OBJ that names its colours, its MTL and the picture of it. */
const cottage = {
  obj: ['mtllib colours/cottage.mtl', ...[[0, 0], [60, 0], [60, 30], [0, 30]].flatMap(([x, z]) => [`v ${x} 0 ${z}`, `v ${x} 25 ${z}`]),
    'vt 0 0', 'vt 1 0', 'vt 1 1', 'vt 0 1', 'usemtl brick', 'f 1/1 3/2 5/3 7/4', 'f 2/1 8/2 6/3 4/4', 'f 1/1 2/2 4/3 3/4', 'f 3/1 4/2 6/3 5/4',
    'f 5/1 6/2 8/3 7/4', 'f 7/1 8/2 2/3 1/4', ''].join('\n'),
  mtl: 'newmtl brick\nKd 1 1 1\nmap_Kd -s 1 1 1 C:\\mine\\Brick.PNG\n',
  png: Buffer.from('iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAE0lEQVR4nGM4oSECRAwiGieACAAcfgQRHLDUewAAAABJRU5ErkJggg==', 'base64'),
};

test('an OBJ goes with its MTL and pictures as one file, and what is missing is asked for', ofPopcutd, async () => {
  const { page, sent, complaints, close } = await desk();
  await page.route('**/v1/assets/*/search', (route) => route.continue({ postData: JSON.stringify({ ...JSON.parse(route.request().postData()), effort: 0.01, style: 'facets' }) }));
  const note = page.getByRole('dialog').getByRole('alert');
  const add = (...files) => page.locator('input[data-more]').setInputFiles(files);
  await page.locator('.design-drop > input[type=file]').setInputFiles([file('cottage.obj', Buffer.from(cottage.obj)), file('boat.mtl', Buffer.from('newmtl sail\n'))]);
  await note.getByText('boat.mtl belongs to another model: cottage.obj uses none of its materials.').waitFor({ timeout: 60_000 });
  assert.ok(await note.getByRole('button', { name: 'Print in clay' }).isVisible());
  await add(file('Cottage.MTL', Buffer.from(cottage.mtl)));
  await note.getByText('The colours of cottage.obj are partly in Brick.PNG, which is not here.').waitFor();
  const huge = Buffer.from(cottage.png);
  huge.writeUInt32BE(30_000, 16);
  huge.writeUInt32BE(30_000, 20);
  await add(file('brick.png', huge));
  await note.getByText('brick.png is too large to read (30000 x 30000 pixels).').waitFor();
  await add(file('brick.png', cottage.png));
  await note.waitFor({ state: 'detached' });
  assert.equal(await page.locator('.side img').count(), 9, 'it is drawn from all sides');
  await picture(page, 'mesh-standing');
  assert.equal(await page.getByRole('dialog').getByLabel('Print a picture on the card').isChecked(), true);
  await page.locator('.side-guess').click();
  await page.locator('.badge', { hasText: 'exact' }).waitFor({ timeout: 400_000 });   // the search has ended
  const asset = sent.find((one) => one.path === '/v1/assets');
  assert.equal(asset.headers['content-type'], 'model/gltf-binary');
  const { id } = await server.must('POST', '/v1/designs', JSON.stringify(await specOf(page)));
  const plan = await server.must('POST', `/v1/designs/${id}/plan`, { device: 'sim:cameo3', options: { mat: 'A4', marks: true } });
  await until(async () => (await server.must('GET', `/v1/plans/${plan.id}`)).state === 'planned', 'it is planned', 60_000);
  assert.equal((await server.ask('GET', `/v1/plans/${plan.id}/sheets/1/artwork.pdf?dpi=50`)).status, 200, 'its colours can be printed');
  assert.deepEqual(complaints, []);
  await close();
});

test('what cannot be opened is said in a sentence with the button that helps, and one of several models is chosen', async () => {
  const { page, complaints, close } = await desk();
  await page.locator('.start-card', { hasText: 'unit' }).click();
  await page.locator('.badge', { hasText: 'exact' }).waitFor();
  const input = page.locator('.design-drop > input[type=file]');
  const note = page.locator('.note-bad');
  for (const [files, sentence] of [
    [[file('cat.png', cottage.png)], /"cat\.png" is a picture, which has no lines to cut\. Trace it first/],
    [Array.from({ length: 200 }, (_, k) => file(`${k}.txt`, Buffer.from('x'))), /None of these 200 files is a model/],
    [[file('cut short.zip', Buffer.from('PK'))], /"cut short\.zip" cannot be unpacked/],
  ]) {
    await input.setInputFiles(files);
    await note.waitFor();
    assert.match(await note.innerText(), sentence);
    assert.ok(await note.getByRole('button', { name: 'Choose another file' }).isVisible());
    await note.getByRole('button', { name: 'Close' }).click();
  }
  await input.setInputFiles([file('a.stl', binaryStl(ball())), file('b.stl', binaryStl(ball(20)))]);
  await page.getByRole('dialog', { name: 'There are 2 models. Which one?' }).getByRole('button', { name: 'b.stl' }).click();
  await page.getByRole('dialog', { name: 'How should it stand?' }).getByRole('button', { name: 'Cancel' }).click();
  assert.equal(await page.locator('.design-name').inputValue(), 'unit', 'what was open stays');
  assert.deepEqual(complaints, []);
  await close();
});
