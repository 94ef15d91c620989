// The pictures of docs/page.md and README.md: `node pictures.mjs FOLDER`, with POPCUTD set (./run pictures does it).
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { closeBrowser, ladder, machineHash, openModel, Server, until, visit, wait } from './harness.mjs';

const folder = process.argv[2];
if (!folder) throw new Error('usage: node pictures.mjs FOLDER');
mkdirSync(folder, { recursive: true });
const screen = { width: 1200, height: 750, touch: false };
const server = await Server.start({ devices: [
  { id: 'sim:cameo3', time_scale: 4 }, { id: 'sim:cameo4', time_scale: 20, faults: [{ at_path: 19, kind: 'unplug', seconds: 1 }] },
] });

/** A church: a nave with a gable, and a tower with a pointed roof. */
function church() {
  const corners = [];
  const faces = [];
  const add = (points, sides) => {
    faces.push(...sides.map((side) => `f ${side.map((i) => i + corners.length).join(' ')}`));
    corners.push(...points.map((point) => `v ${point.join(' ')}`));
  };
  const box = (x0, x1, z0, z1, y) => [0, y].flatMap((h) => [[x0, h, z1], [x1, h, z1], [x1, h, z0], [x0, h, z0]]);
  const walls = [[4, 3, 2, 1], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];
  add([...box(0, 60, 0, 34, 30), [0, 48, 17], [60, 48, 17]], [...walls, [5, 6, 10, 9], [7, 8, 9, 10], [8, 5, 9], [6, 7, 10]]);
  add([...box(60, 80, 7, 27, 52), [70, 80, 17]], [...walls, [5, 6, 9], [6, 7, 9], [7, 8, 9], [8, 5, 9]]);
  return Buffer.from([...corners, ...faces, ''].join('\n'));
}

/** Visits `hash`, waits until it is ready, and keeps what it looks like. */
async function draw(name, hash, ready, device = 'sim:cameo3') {
  const { page, close } = await visit(server, { hash, screen, name: 'Ana', beside: device });
  await page.locator('.live-on').waitFor();
  await ready(page);
  await wait(2500);  // pictures come, shadows settle
  await page.screenshot({ path: join(folder, `${name}.png`) });
  await close();
}

try {
  const { items } = await server.must('GET', '/v1/examples');
  const spec = (name) => items.find((one) => one.name === name).spec;
  await draw('design', '#/design/example/sphere', (page) => page.locator('.badge', { hasText: 'exact' }).waitFor());
  await draw('cards', '#/design', async (page) => {
    await page.locator('.start-card:not(:disabled)').first().waitFor();
    await page.route('**/search', (route) => route.continue({ postData: JSON.stringify({ up: 'y', effort: 0.1 }) }));
    await openModel(page, { name: 'church.obj', mimeType: 'model/obj', buffer: church() });
    await page.locator('.found-card').last().click({ timeout: 300_000 });
    await page.locator('.badge', { hasText: 'exact' }).waitFor();
  });
  const card = await server.queue(spec('sphere'), { name: 'Sphere for Ben' });
  await draw('machine', machineHash(), (page) => page.locator('.arm').waitFor());
  const broken = await server.queue(ladder(40), { name: 'Cable out', device: 'sim:cameo4' });
  await server.cut(broken.id);
  await server.state(broken.id, 'interrupted', 60_000);
  await draw('interrupted', machineHash('sim:cameo4'), (page) => page.getByText('Look at the sheet.').waitFor(), 'sim:cameo4');
  await server.queue(spec('facade'), { name: 'Facade' });
  await server.cut(card.id);
  await until(async () => (await server.job(card.id)).progress.paths_done > 120, 'a third is cut', 120_000);
  await draw('now', '', (page) => page.getByText('Being cut').waitFor());
  await draw('sheets', `#/sheets/${card.plan}`, (page) => page.getByText('Queue it').waitFor());
} finally {
  await closeBrowser();
  await server.remove();
}
