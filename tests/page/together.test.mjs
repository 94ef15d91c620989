// Two things at once in Design: what a hand does while something else is under way.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { closeBrowser, expectComplaints, picture, refused, Server, unreachable, until, visit, wait } from './harness.mjs';

let server;

before(async () => { server = await Server.start(); });
after(async () => { await closeBrowser(); await server.remove(); });

const exact = (page) => page.locator('.badge', { hasText: 'exact' }).waitFor({ timeout: 60_000 });
const isExact = async (page) => await page.locator('.badge').textContent() === 'exact';
const units = (page) => page.getByLabel('Steps in a slice (N)');

const specOf = (page) => page.evaluate(() => {
  const { steps, at } = JSON.parse(sessionStorage.getItem('popcut.design.steps'));
  return JSON.parse(steps[at]);
});

async function designing(example = 'unit', options = {}) {
  const visited = await visit(server, { hash: `#/design/example/${example}`, motion: 'reduce', ...options });
  await exact(visited.page);
  expectComplaints(visited.page, refused(409));
  return visited;
}

async function toUnits(page, n) {
  await units(page).evaluate((input, value) => {
    Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(input, String(value));
    for (const type of ['input', 'change']) input.dispatchEvent(new Event(type, { bubbles: true }));
  }, n);
}

/**
 * Holds back answers to requests for `path`, those that `which` names. `held` resolves when the first has come;
 * release() lets all go, and whatever comes later.
 */
async function holdBack(page, path, which = () => true) {
  let release;
  let came;
  const free = new Promise((done) => { release = done; });
  const held = new Promise((done) => { came = done; });
  await page.route(path, async (route) => {
    if (!which(route.request())) return route.continue();
    const response = await route.fetch().catch(() => null);
    came();
    await free;
    return (response ? route.fulfill({ response }) : route.abort()).catch(() => undefined);   // the page may have let go of it
  });
  return { held, release };
}

const isFor = (quality) => (request) => JSON.parse(request.postData()).quality === quality;
const levelsShown = async (page) => (await page.locator('.places tbody tr').allTextContents()).filter((row) => /level/.test(row)).length;

test('undo while the exact design is made: it is superseded, and the one before is shown and exact', async () => {
  const { page, complaints, close } = await designing();
  const before = await specOf(page);
  const figures = await levelsShown(page);
  const { held, release } = await holdBack(page, '**/v1/preview', (request) => isFor('exact')(request) && JSON.parse(request.postData()).spec.units_per_slice === 6);
  await toUnits(page, 6);
  await held;
  assert.equal(await isExact(page), false);
  await page.locator('.stage-canvas').first().focus();
  await page.keyboard.press('Control+z');
  await exact(page);
  assert.deepEqual(await specOf(page), before);
  release();
  await wait(400);               // the late answer changes nothing
  assert.equal(await isExact(page), true);
  assert.equal(await units(page).inputValue(), '1');
  assert.equal(await levelsShown(page), figures);
  await page.keyboard.press('Control+Shift+z');
  await exact(page);
  assert.equal(await units(page).inputValue(), '6');
  assert.notEqual(await levelsShown(page), figures);
  assert.deepEqual(complaints, []);
  await close();
});

test('while a draft is shown nothing is shared, saved, exported or cut; each works as soon as it is exact', async () => {
  const { page, sent, complaints, close } = await designing();
  let downloads = 0;
  page.on('download', () => { downloads++; });
  const { held, release } = await holdBack(page, '**/v1/preview', isFor('exact'));
  await toUnits(page, 3);
  await held;
  assert.equal(await page.locator('.badge').textContent(), 'draft');
  for (const name of ['Share', 'Save']) {
    const button = page.getByRole('button', { name, exact: true });
    assert.equal(await button.isDisabled(), true, name);
    await button.click({ force: true });
  }
  assert.equal(await page.locator('dialog').count(), 0);
  await page.getByRole('button', { name: 'Make it…' }).click();
  await page.getByText('More: other formats').click();
  const files = page.locator('.export');
  assert.equal(await files.first().isDisabled(), true);
  await page.getByText('The exact design is being made.').waitFor();
  await page.getByRole('button', { name: 'Close' }).click();
  await page.getByRole('button', { name: 'Cut this…' }).click();
  const go = page.getByRole('button', { name: 'Show the sheets' });
  assert.equal(await go.isDisabled(), true);
  await go.click({ force: true });
  await page.getByText('The exact design is being made.').waitFor();
  await picture(page, 'together-draft-cut');
  assert.ok(sent.every((one) => ['/v1/session', '/v1/preview'].includes(one.path)));
  assert.equal(downloads, 0);
  release();
  await until(async () => !await go.isDisabled(), 'it can be cut when it is exact');
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Share' }).click();
  await page.locator('.share-link').waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

test('a gesture that ends while popcutd is away is one step, and is drawn when it is back', async () => {
  const { page, context, complaints, close } = await designing('sphere');
  expectComplaints(page, unreachable);
  const handle = page.locator('.handle-radius').nth(2);
  await handle.waitFor();
  const before = await specOf(page);
  const box = await handle.boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y - 8, { steps: 2 });
  await context.setOffline(true);
  await page.mouse.move(x, y - 20, { steps: 3 });
  await page.mouse.up();
  await page.getByText('popcutd does not answer.').waitFor();
  assert.equal(await isExact(page), false);
  const dragged = await specOf(page);
  assert.notDeepEqual(dragged, before);
  await context.setOffline(false);
  await exact(page);
  assert.equal(await page.locator('.note-bad').count(), 0);
  assert.deepEqual(await specOf(page), dragged);
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  assert.deepEqual(await specOf(page), before, 'the whole gesture is one step');
  await exact(page);
  assert.deepEqual(complaints, []);
  await close();
});

test('the theme changes in the middle of a drag: the drag goes on, in the other colours', async () => {
  const { page, complaints, close } = await designing('sphere');
  const handle = page.locator('.handle-radius').nth(2);
  await handle.waitFor();
  const box = await handle.boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const ground = () => page.evaluate(() => getComputedStyle(document.querySelector('.stage')).backgroundColor + getComputedStyle(document.body).backgroundColor);
  const light = await ground();
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y - 6, { steps: 2 });
  await page.emulateMedia({ colorScheme: 'dark' });
  await until(async () => await ground() !== light, 'it is dark');
  await page.mouse.move(x, y - 18, { steps: 3 });
  const moved = await until(() => handle.boundingBox().then((now) => now && now.y < box.y - 10 && now), 'the handle follows the hand');
  assert.ok(Math.abs(moved.x - box.x) < 6);
  await page.mouse.up();
  await exact(page);
  const points = (await specOf(page)).surface.radius.points;
  assert.ok(points.length > 2);
  assert.equal(await page.evaluate(() => JSON.parse(sessionStorage.getItem('popcut.design.steps')).at), 1, 'one step');
  await picture(page, 'together-theme');
  assert.deepEqual(complaints, []);
  await close();
});

test('a second design opened while the first is stored for a cut: what was asked for is cut, and the second stays', async () => {
  const { page, sent, complaints, close } = await designing();
  await toUnits(page, 2);
  await exact(page);
  const first = await specOf(page);
  const { held, release } = await holdBack(page, '**/v1/designs?*', (request) => request.method() === 'POST');
  await page.getByRole('button', { name: 'Cut this…' }).click();
  await page.getByRole('button', { name: 'Show the sheets' }).click();
  await held;
  await page.keyboard.press('Escape');
  await page.evaluate(() => { location.hash = '#/design/example/sphere'; });
  await until(async () => await page.locator('.design-name').inputValue() === 'sphere', 'the second is on the desk');
  await toUnits(page, 4);
  await exact(page);
  release();
  await until(async () => (await server.must('GET', '/v1/designs')).items.length > 0, 'the first is stored');
  await wait(500);
  assert.equal(new URL(page.url()).hash, '#/design', 'who closed the question is not led away');
  assert.equal(await page.locator('.design-name').inputValue(), 'sphere');
  assert.equal(await page.locator('.design-dirty').textContent(), '●', 'the second is still not saved');
  assert.deepEqual(sent.filter((one) => /plan|jobs/.test(one.path)), []);
  const { items: [{ id }] } = await server.must('GET', '/v1/designs');
  assert.deepEqual(await server.must('GET', `/v1/designs/${id}/content`), first);
  assert.deepEqual(complaints, []);
  await close();
});

test('of two designs that are opened at once the later one stays, whichever comes first', async () => {
  const { page, complaints, close } = await designing();
  const a = await server.must('POST', '/v1/designs?name=A', JSON.stringify({ ...await specOf(page), name: 'A' }));
  const b = await server.must('POST', '/v1/designs?name=B', JSON.stringify({ ...await specOf(page), name: 'B' }));
  const { held, release } = await holdBack(page, `**/v1/designs/${a.id}/content`);
  await page.evaluate((id) => { location.hash = `#/design/${id}`; }, a.id);
  await held;
  await page.evaluate((id) => { location.hash = `#/design/${id}`; }, b.id);
  await until(async () => await page.locator('.design-name').inputValue() === 'B', 'B is shown');
  release();
  await wait(400);
  assert.equal(await page.locator('.design-name').inputValue(), 'B');
  assert.equal((await specOf(page)).name, 'B');
  assert.deepEqual(complaints, []);
  await close();
});

test('Design visited twenty times gives back what it took of the graphics card', async () => {
  const { page, complaints, close } = await designing();
  for (let i = 0; i < 20; i++) {
    await page.getByRole('link', { name: 'Settings', exact: true }).click();
    await page.locator('.settings').waitFor();
    await page.getByRole('link', { name: 'Design', exact: true }).click();
    await page.locator('.handle-open').waitFor();
  }
  assert.equal(await page.locator('.stage-paper').count(), 0, 'the model is still drawn by the graphics card');
  assert.deepEqual(complaints, []);
  await close();
});

test('Cut this… and what follows, each pressed twice: one design, one plan, one job', async () => {
  const { page, sent, complaints, close } = await designing();
  await page.getByRole('button', { name: 'Cut this…' }).dblclick();
  assert.equal(await page.locator('dialog').count(), 1);
  const twice = (name) => page.getByRole('button', { name }).evaluate((button) => { button.click(); button.click(); });
  await twice('Show the sheets');
  await page.getByRole('button', { name: 'Queue it' }).waitFor({ timeout: 60_000 });
  await twice('Queue it');
  await page.getByText('It is in the queue.', { exact: false }).waitFor();
  await wait(300);
  assert.deepEqual(sent.map((one) => one.path.split('/').at(-1)).filter((name) => !['session', 'preview'].includes(name)), ['designs', 'plan', 'jobs']);
  const { items } = await server.must('GET', '/v1/queue');
  assert.equal(items.length, 1);
  assert.deepEqual(complaints, []);
  await close();
});

test('a phone that is turned, and Undo, while the card opens and shuts by itself', async () => {
  const { page, complaints, close } = await designing('unit', { screen: 'phone', motion: 'no-preference' });
  await toUnits(page, 4);
  await exact(page);
  await page.getByRole('button', { name: 'Open and shut' }).click();
  const angle = page.locator('.deploy input[type=range]');
  const first = await angle.inputValue();
  await until(async () => await angle.inputValue() !== first, 'it moves');
  await page.setViewportSize({ width: 844, height: 390 });
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  await exact(page);
  const now = await angle.inputValue();
  await until(async () => await angle.inputValue() !== now, 'it moves on');
  assert.equal(await units(page).inputValue(), '1');
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the screen');
  await picture(page, 'together-phone-turned');
  await page.getByRole('button', { name: 'Stop' }).click();
  assert.deepEqual(complaints, []);
  await close();
});
