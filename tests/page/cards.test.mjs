// The best cards of a model: searched, shown as pictures, picked, printed and cut.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { inflateSync } from 'node:zlib';
import { axeSource, bytesOf, closeBrowser, drawn, expectComplaints, openModel, picture, refused, Server, until, visit } from './harness.mjs';

let server;

before(async () => { server = await Server.start({ devices: [{ id: 'sim:cameo3', time_scale: 100 }] }); });
after(async () => { await closeBrowser(); await server.remove(); });

/** A house with a gable, `high` mm to the eaves. */
const house = (high = 40) => Buffer.from([
  ...[[0, 0], [60, 0], [60, 40], [0, 40]].map(([x, y]) => `v ${x} ${y} 0`),
  ...[[0, 0], [60, 0], [60, 40], [0, 40]].map(([x, y]) => `v ${x} ${y} ${high}`),
  `v 0 20 ${high + 25}`, `v 60 20 ${high + 25}`,
  'f 4 3 2 1', 'f 1 2 6 5', 'f 3 4 8 7', 'f 2 3 7 10 6', 'f 4 1 5 9 8', 'f 5 6 10 9', 'f 7 8 9 10', '',
].join('\n'));

/** A box: of it even books are quickly found. */
const hall = () => Buffer.from([
  ...[[0, 0], [60, 0], [60, 30], [0, 30]].flatMap(([x, z]) => [`v ${x} 0 ${z}`, `v ${x} 25 ${z}`]),
  'f 1 3 5 7', 'f 2 8 6 4', 'f 1 2 4 3', 'f 3 4 6 5', 'f 5 6 8 7', 'f 7 8 2 1', '',
].join('\n'));

/** A page at Design whose searches do little work, or what `change` says; `asked`: what the page wanted of them. */
async function desk(change = {}) {
  const visited = await visit(server, { hash: '#/design', motion: 'reduce' });
  const asked = [];
  await visited.page.route('**/v1/assets/*/search', (route) => {
    asked.push(JSON.parse(route.request().postData()));
    return route.continue({ postData: JSON.stringify({ ...asked.at(-1), effort: 0.01, style: 'facets', ...change }) });
  });
  await visited.page.locator('.start-card:not(:disabled)').first().waitFor();
  return { ...visited, asked };
}

const file = (name, buffer) => ({ name, mimeType: 'application/octet-stream', buffer: Buffer.from(buffer) });
const give = (page, name, buffer) => openModel(page, file(name, buffer), 'x');   // cards of its gable are quickly found
const exact = (page) => page.locator('.badge', { hasText: 'exact' }).waitFor({ timeout: 60_000 });
const found = (page) => page.locator('.found-card').first().waitFor({ timeout: 120_000 });
/** Presses a found card, and waits until it is on the desk. */
async function pick(card) {
  await card.click();
  await until(async () => await card.getAttribute('aria-pressed') === 'true', 'it is on the desk');
}
const specOf = (page) => page.evaluate(() => {
  const { steps, at } = JSON.parse(sessionStorage.getItem('popcut.design.steps'));
  return JSON.parse(steps[at]);
});

test('a model gives cards as pictures, and the one that is picked by key is the design until Undo', async () => {
  const { page, sent, asked, complaints, close } = await desk();
  await give(page, 'house.obj', house());
  await drawn(page);
  const placed = await specOf(page);
  await found(page);
  const { path } = sent.find((one) => one.path.endsWith('/search'));
  const asset = path.split('/')[3];
  assert.equal(placed.surface.file, asset);
  const search = await server.must('POST', path, { ...asked[0], effort: 0.01, style: 'facets' });
  assert.equal(search.state, 'found');
  const cards = page.locator('.found-card');
  assert.equal(await cards.count(), search.cards.length);
  assert.match(await cards.last().innerText(), /most like the model\s+\d+ folds, shortest [\d.]+ mm, (about \d+ minutes?|under a minute) to fold, (\d+ minutes?|under a minute) to cut; looks: (good|fair|poor)/);
  assert.match(await cards.last().getAttribute('title'), /error 0\.\d+/);
  assert.deepEqual(await page.locator('.found-card:has(.found-make)').evaluateAll((all) => all.length), 1);
  assert.match(await cards.nth(search.recommended - 1).innerText(), /^make this one/);
  assert.ok(await page.locator('.found-on').evaluate((one) => {
    const [card, row] = [one.getBoundingClientRect(), one.closest('.found-cards').getBoundingClientRect()];
    return card.left >= row.left && card.right <= row.right;
  }), 'the card that is on the desk is in sight');
  for (const card of await cards.all()) await card.scrollIntoViewIfNeeded();
  await until(async () => await page.locator('.found-card img').count() === search.cards.length, 'all pictures are there');
  for (const image of await page.locator('.found-card img').all()) {
    assert.deepEqual(await image.evaluate((one) => [one.naturalWidth, one.naturalHeight]), [800, 400]);
  }
  await picture(page, 'cards');
  await page.evaluate(axeSource());
  const { violations } = await page.evaluate(() => window.axe.run('.search'));
  assert.deepEqual(violations.map((one) => one.id), []);

  // The one that popcut would make is on the desk already, as the search designed it.
  const recommended = search.cards[search.recommended - 1].spec;
  await until(async () => JSON.stringify(await specOf(page)) === JSON.stringify(recommended), 'it is on the desk');
  assert.equal(sent.filter((one) => one.path === '/v1/preview').length, 1, 'only the first draft was designed for the page');
  await cards.first().focus();
  for (let k = 1; k < search.cards.length; k++) await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Enter');
  const best = search.cards.at(-1).spec;
  await until(async () => JSON.stringify(await specOf(page)) === JSON.stringify(best), 'it is on the desk');
  await exact(page);
  assert.equal(sent.filter((one) => one.path === '/v1/preview').length, 1, 'nothing is designed again');
  assert.equal(await cards.last().getAttribute('aria-pressed'), 'true');
  assert.equal(await page.locator('.found-card[aria-pressed=true]').count(), 1);
  await picture(page, 'cards-picked');
  for (let k = 0; k < (search.cards.length === search.recommended ? 1 : 2); k++) await page.getByRole('button', { name: 'Undo' }).click();
  await exact(page);
  assert.deepEqual(await specOf(page), placed);
  assert.equal(await page.locator('.found-card[aria-pressed=true]').count(), 0);
  assert.equal(await page.locator('.note-bad').count(), 0);

  // Other wishes and another way to stand are another search.
  await page.getByRole('button', { name: 'Search for others' }).click();
  await page.getByLabel('How easy to fold').selectOption('easy');
  await page.getByLabel('Paper or mat').selectOption('letter');
  await page.getByLabel('Print a picture on the card').check();
  await page.getByRole('button', { name: 'Let it stand or look another way' }).click();
  await page.getByRole('button', { name: 'Standing with z up' }).click();
  await page.getByRole('button', { name: 'Facing you: -x' }).click();
  await until(() => asked.length === 2, 'it searches again');
  const wishes = { max_minutes: 15, cards: 1, effort: 0.1 };
  assert.deepEqual(asked[0], { ...wishes, up: 'y', front: 'x', label: 'any', mat: 'A4', marks: false });
  assert.deepEqual(asked[1], { ...wishes, up: 'z', front: '-x', label: 'easy', mat: 'letter', marks: true });
  await found(page);
  // What was chosen is remembered.
  await page.reload();
  await page.getByRole('button', { name: 'Go on with your last design' }).click();
  await page.getByRole('button', { name: 'Cut this…' }).click();
  const dialog = page.getByRole('dialog');
  assert.equal(await dialog.getByLabel('Paper or mat').inputValue(), 'letter');
  assert.equal(await dialog.getByLabel('Print a picture on the card').isChecked(), true);
  assert.equal(await dialog.getByLabel('Cutter').locator('option').count(), 2, 'the one cutter, and by hand');
  // That picture is of this model: the next design is not printed because this one was.
  await dialog.getByRole('button', { name: 'Cancel' }).click();
  await page.getByRole('button', { name: 'New', exact: true }).click();
  await page.locator('.start-card:enabled', { hasText: 'unit' }).click();
  await exact(page);
  await page.getByRole('button', { name: 'Cut this…' }).click();
  assert.equal(await dialog.getByLabel('Paper or mat').inputValue(), 'letter');
  assert.equal(await dialog.getByLabel('Print a picture on the card').isChecked(), false);
  assert.deepEqual(complaints, []);
  await close();
});

test('a book of cards is searched, picked and planned', async () => {
  const { page, asked, complaints, close } = await desk({ style: 'levels' });
  await give(page, 'hall.obj', hall());
  await found(page);
  await page.getByRole('button', { name: 'Search for others' }).click();
  await page.getByLabel('One card or a book').selectOption('4');
  await page.getByRole('button', { name: 'Search again' }).click();
  await until(() => asked.length === 2, 'it searches again');
  assert.deepEqual(asked[1], { max_minutes: 15, cards: 4, up: 'y', effort: 0.1, label: 'any', mat: 'A4', marks: false, material: 'paper-220' });
  await page.getByRole('progressbar', { name: 'Searching for the best cards' }).waitFor({ state: 'detached', timeout: 120_000 });
  await found(page);
  await pick(page.locator('.found-card').last());
  await exact(page);
  assert.equal((await specOf(page)).book.cards, 4);
  await picture(page, 'cards-found-book');
  await page.getByRole('button', { name: 'Cut this…' }).click();
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  await page.getByRole('button', { name: 'Queue it' }).waitFor({ timeout: 120_000 });
  assert.deepEqual(complaints, []);
  await close();
});

test('a search that runs can be cancelled, and is begun again', async () => {
  const { page, sent, complaints, close } = await desk({ effort: 4 });
  await give(page, 'tall house.obj', house(60));
  // What is drawn meanwhile is not taken for the result.
  await page.locator('.badge', { hasText: 'first draft' }).waitFor({ timeout: 60_000 });
  assert.match(await page.locator('.stage-first').innerText(), /^First draft: better cards are being searched/);
  await page.getByRole('button', { name: 'Cut this…' }).click();
  await page.getByRole('dialog').getByText(/^This is the first draft\./).waitFor();
  await page.getByRole('dialog').getByRole('button', { name: 'Cancel' }).click();
  await page.getByText('Searching for the best cards', { exact: false }).waitFor();
  await page.getByRole('progressbar', { name: 'Searching for the best cards' }).waitFor();
  await picture(page, 'cards-searching');
  await page.getByRole('button', { name: 'Cancel' }).click();
  const gone = await until(() => sent.find((one) => one.method === 'DELETE'), 'the search is removed');
  assert.match(gone.path, /^\/v1\/searches\/[0-9A-Z]{26}$/);
  await until(async () => (await server.ask('GET', gone.path)).status === 404, 'popcutd has none any more');
  assert.equal(await page.getByRole('progressbar').count(), 0);
  await exact(page);
  assert.equal(await page.locator('.stage-first').count(), 0);
  // Cancelled while popcutd still begins it.
  const begun = page.waitForResponse((answer) => answer.request().method() === 'POST' && answer.url().endsWith('/search'));
  await page.getByRole('button', { name: 'Find the best cards' }).click();
  await page.getByRole('button', { name: 'Cancel' }).click();
  const second = await (await begun).json();
  await until(async () => (await server.ask('GET', `/v1/searches/${second.id}`)).status === 404, 'popcutd has none any more');
  assert.equal(await page.locator('.note-bad').count(), 0);
  assert.deepEqual(complaints, []);
  await close();
});

test('where no card is found the page says why, and a design without a model has no search', async () => {
  const { page, complaints, close } = await desk({ max_minutes: 0.1 });
  await page.locator('.start-card', { hasText: 'unit' }).click();
  await exact(page);
  assert.equal(await page.locator('.search').count(), 0);
  await give(page, 'wide house.obj', house(30));
  await page.getByText('No card was found.').waitFor({ timeout: 120_000 });
  assert.match(await page.locator('.search [role=alert]').innerText(), /no card of it is cut within 0\.1 minutes/);
  assert.ok(await page.getByRole('button', { name: 'Search again' }).isVisible());
  await picture(page, 'cards-none');
  assert.deepEqual(complaints, []);
  await close();
});

test('a picked card is planned with marks, and its page to print comes as a PDF', async () => {
  const { page, complaints, close } = await desk();
  await give(page, 'house.obj', house());
  await found(page);
  await page.locator('.found-card').last().click();
  await exact(page);
  await page.getByRole('button', { name: 'Cut this…' }).click();
  await page.getByRole('dialog').getByLabel('Print a picture on the card').check();
  await page.getByRole('dialog').getByRole('combobox', { name: /^Cutter/ }).selectOption('sim:cameo3');
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  const button = page.getByRole('button', { name: 'Page to print (PDF)' });
  await button.waitFor({ timeout: 60_000 });
  await picture(page, 'cards-print');
  const [download] = await Promise.all([page.waitForEvent('download', { timeout: 120_000 }), button.click()]);
  assert.equal(download.suggestedFilename(), 'print-1.pdf');
  const pdf = (await bytesOf(download)).toString('latin1');
  assert.equal(pdf.slice(0, 5), '%PDF-');
  const box = /\/MediaBox \[ *0 0 ([\d.]+) ([\d.]+) *\]/.exec(pdf).slice(1).map((points) => Number(points) * 25.4 / 72);
  const mm = (points) => Number(points) * 25.4 / 72;
  assert.ok(Math.abs(box[0] - 210) < 0.05 && Math.abs(box[1] - 297) < 0.05, `the page is A4, as the paper that is chosen: ${box}`);
  // The marks, which are filled and black, lie where the program of this sheet looks for them.
  const streams = [...pdf.matchAll(/stream\r?\n([^]*?)endstream/g)].map(([, bytes]) => {
    try { return inflateSync(Buffer.from(bytes, 'latin1')).toString('latin1'); } catch { return ''; }
  });
  const [, marks] = streams.map((one) => /0 0 0 rg([^]*?\bf\b)/.exec(one)).find((one) => one !== null);
  const corners = [...marks.matchAll(/([\d.]+) ([\d.]+) [ml]\b/g)].map(([, x, y]) => [mm(x), mm(y)]);
  const plan = /#\/sheets\/(\w+)/.exec(page.url())[1];
  const { body: program } = await server.ask('GET', `/v1/plans/${plan}/sheets/1/program`);
  const unit_mm = 0.05;
  const [height, width, top, left] = /TB12[34],(\d+),(\d+),(\d+),(\d+)/.exec(program).slice(1).map((units) => Number(units) * unit_mm);
  const start_mm = 10;   // of the search of a Cameo 3, before the first mark
  for (const [axis, at, size] of [[0, left, width], [1, top, height]]) {
    const along = corners.map((corner) => corner[axis]);
    for (const [seen, wanted] of [[Math.min(...along), at + start_mm], [Math.max(...along), at + start_mm + size]]) {
      assert.ok(Math.abs(seen - wanted) < 0.05, `a mark at ${seen} mm is searched at ${wanted} mm`);
    }
  }
  assert.deepEqual(complaints, []);
  await close();
});

test('a sheet that is not planned with marks, or not of a design, has nothing to print', async () => {
  const svg = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100"><path fill="none" stroke="#000" d="M10 10H60"/></svg>';
  const { page, complaints, close } = await visit(server, { hash: '#/design' });
  for (const [bytes, type, options] of [[svg, 'image/svg+xml', { marks: true }], [JSON.stringify({
    popcut: 1, name: 'unit', surface: { type: 'revolution', radius: '30' }, units_per_slice: 1, slices: 1, widths_mm: 30,
  }), 'application/json', {}]]) {
    const { id } = await server.must('POST', '/v1/designs?name=nothing%20to%20print', bytes, { headers: { 'Content-Type': type } });
    const plan = await server.must('POST', `/v1/designs/${id}/plan`, { device: 'sim:cameo3', options });
    await until(async () => (await server.must('GET', `/v1/plans/${plan.id}`)).state === 'planned', 'it is planned', 60_000);
    await page.evaluate((to) => { location.hash = to; }, `#/sheets/${plan.id}`);
    await page.getByRole('button', { name: 'Queue it' }).waitFor({ timeout: 60_000 });
    await page.locator('h1', { hasText: 'nothing to print' }).waitFor();   // it knows the design, then
    assert.equal(await page.getByRole('button', { name: 'Page to print (PDF)' }).count(), 0);
  }
  assert.deepEqual(complaints, []);
  await close();
});

test('a book lies on the desk with all its cards and is planned as one', async () => {
  const { items } = await server.must('GET', '/v1/examples');
  const book = items.find((one) => one.name === 'lantern').spec;
  const { page, complaints, close } = await visit(server, { hash: '#/design', motion: 'reduce' });
  await page.locator('.start-card:not(:disabled)').first().waitFor();
  await page.locator('.design-drop > input[type=file]').setInputFiles(file('lantern.json', JSON.stringify(book)));
  await exact(page);
  assert.match(await page.locator('[aria-labelledby=figures]').innerText(), /opens in one movement\s+yes/);
  assert.match(await page.locator('[aria-labelledby=figures]').innerText(), /sheet\s+\d{3}/);
  await picture(page, 'cards-book');
  await page.getByRole('button', { name: 'Cut this…' }).click();
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  await page.getByRole('button', { name: 'Queue it' }).waitFor({ timeout: 60_000 });
  assert.deepEqual(complaints, []);
  await close();
});

test('a person who may only look sees no search', async () => {
  const { page, close } = await visit(server, { role: 'viewer', hash: '#/design', motion: 'reduce' });
  expectComplaints(page, refused(403));
  await page.locator('.start-card:not(:disabled)').first().waitFor();
  await page.locator('.design-drop > input[type=file]').setInputFiles(file('house.obj', house()));
  await page.locator('.note-bad').waitFor();
  assert.equal(await page.locator('.search').count(), 0);
  await close();
});

test('a model becomes a card of layers: searched, shown, pulled apart, glued step by step, cut in pieces, and slices after it', async () => {
  const { page, sent, complaints, close } = await desk({ style: 'any' });
  await give(page, 'house.obj', house());
  await found(page);
  const [layers, boxes] = [page.locator('.found-card').nth(-2), page.locator('.found-card').last()];
  for (const glued of [layers, boxes]) assert.match(await glued.innerText(), /^\d+ folds, \d+ glued tabs, shortest [\d.]+ mm, (about \d+ minutes?|under a minute) to fold and glue, .* to cut; looks: (good|fair|poor)$/);
  await page.locator('.found-card[aria-pressed=true]').waitFor();   // the recommended one is on the desk by itself
  const before = await specOf(page);
  const previews = () => sent.filter((one) => one.path === '/v1/preview').length;
  const asked = previews();
  await layers.scrollIntoViewIfNeeded();
  await until(async () => (await layers.locator('img').count()) === 1, 'its picture is there');
  assert.deepEqual(await layers.locator('img').evaluate((one) => [one.naturalWidth, one.naturalHeight]), [800, 400]);
  await pick(boxes);
  await exact(page);
  assert.equal((await specOf(page)).style, 'boxes');
  await pick(layers);
  await exact(page);
  const spec = await specOf(page);
  assert.equal(spec.style, 'layers');
  assert.equal(previews(), asked, 'it is shown as the search designed it');

  // Its pieces: one is looked at alone, and all of them apart.
  const rows = page.locator('[aria-labelledby=pieces] tbody tr');
  const names = await rows.locator('th').allInnerTexts();
  assert.equal(names[0], 'card');
  assert.ok(names.length >= 3 && names.slice(1).every((name, k) => name === `layer-${k + 1}`), names.join());
  const folds = (await rows.locator('td:nth-child(3)').allInnerTexts()).reduce((sum, text) => sum + Number(text), 0);
  assert.match(await page.locator('.by-hand').innerText(), new RegExp(`${names.length} pieces, ${folds} folds, ${2 * (names.length - 1)} tabs to glue; .* looks (good|fair|poor) when printed`));
  assert.equal(await page.locator('.flat-sheet figcaption').innerText(), `all ${names.length} pieces`);
  await picture(page, 'parts-design');
  await rows.getByRole('button', { name: 'layer-1' }).click();
  assert.match(await page.locator('.flat-sheet figcaption').innerText(), /^layer-1 \d+/);
  await page.locator('.segment', { hasText: 'Apart' }).click();
  await page.getByLabel(/^Opening/).first().fill('120');
  await picture(page, 'parts-apart');
  await page.evaluate(axeSource());
  const { violations } = await page.evaluate(() => window.axe.run('[aria-labelledby=pieces]'));
  assert.deepEqual(violations.map((one) => one.id), []);

  // All sheets to cut by hand.
  await page.getByRole('button', { name: 'Make it…' }).click();
  assert.equal(await page.locator('.export', { hasText: /\((STL|GLB)\)/ }).count(), 0, 'what only cards of one sheet have is not offered');
  await page.locator('.make-choice', { hasText: 'By hand' }).click();
  await page.getByRole('button', { name: /sheets\.pdf/ }).waitFor({ timeout: 120_000 });
  await picture(page, 'parts-by-hand');
  await page.getByRole('dialog').getByRole('button', { name: 'Close' }).click();

  // Each part is folded, then glued with its tabs by their letters.
  await page.getByRole('button', { name: 'How to fold it' }).click();
  const letters = new Set();
  let glued = 0;
  for (let k = 0; ; k++) {
    await page.locator('.fold-sheet').waitFor({ timeout: 60_000 });
    const title = await page.locator('.fold-text h2').innerText();
    assert.ok(['Crease', 'Glue'].includes(title), title);
    if (title === 'Glue') {
      if (glued++ === 0) await picture(page, 'parts-glue-first');
      for (const letter of await page.locator('.fold-tab text').allTextContents()) letters.add(letter);
      assert.ok(await page.locator('.fold-place').count() > 0, 'it shows where they go');
    } else if (k === 1) await picture(page, 'parts-fold');
    const next = page.getByRole('button', { name: 'Next' });
    if (await next.count() === 0) break;
    await next.click();
  }
  assert.equal(letters.size, 2 * (names.length - 1), 'every tab is glued');
  assert.match(await page.locator('.fold-text').innerText(), /The card is done\./);
  await picture(page, 'parts-glue-last');
  await page.getByRole('link', { name: 'Done', exact: true }).last().click();

  // Printed, then cut: all parts are on the sheets.
  await page.getByRole('button', { name: 'Cut this…' }).click();
  await page.getByRole('dialog').getByLabel('Print a picture on the card').check();
  await page.getByRole('dialog').getByRole('combobox', { name: /^Cutter/ }).selectOption('sim:cameo3');
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  const print = page.getByRole('button', { name: 'Page to print (PDF)' });
  await print.waitFor({ timeout: 120_000 });
  await picture(page, 'parts-sheets');
  const plan = /#\/sheets\/(\w+)/.exec(page.url())[1];
  const { body: drawn_ } = await server.ask('GET', `/v1/plans/${plan}/plan.json`);
  assert.deepEqual([...new Set(drawn_.sheets.flatMap((one) => one.parts.map((part) => part.name)))].sort(), [...names].sort());
  const [download] = await Promise.all([page.waitForEvent('download', { timeout: 120_000 }), print.click()]);
  assert.equal((await bytesOf(download)).toString('latin1', 0, 5), '%PDF-');
  assert.ok(await page.getByRole('link', { name: 'How to fold it' }).isVisible());

  // The same model as slices, and back as it stood in its corner.
  await page.getByRole('link', { name: 'Design', exact: true }).click();
  await page.getByLabel('Style').selectOption('slices');
  await exact(page);
  await until(async () => (await rows.locator('th').allInnerTexts()).includes('x0'), 'slices are shown');
  await picture(page, 'parts-slices');
  await page.getByLabel('Name of the design').waitFor();
  for (let step = 0; step < 3; step++) {   // to the layers, the boxes, the recommended card
    await page.getByRole('button', { name: 'Undo' }).click();
    await exact(page);
  }
  assert.deepEqual(await specOf(page), before);
  await page.getByLabel('Style').selectOption('layers');
  await exact(page);
  await page.getByLabel('Style').selectOption('facets');
  await exact(page);
  assert.deepEqual((await specOf(page)).translate_mm, before.translate_mm);
  assert.deepEqual(complaints, []);
  await close();
});
