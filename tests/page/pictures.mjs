// The pictures of docs/page.md and README.md: `node pictures.mjs FOLDER`, with POPCUTD set (./run pictures does it).
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { closeBrowser, ladder, machineHash, openModel, Server, until, visit, wait } from './harness.mjs';

const folder = process.argv[2];
if (!folder) throw new Error('usage: node pictures.mjs FOLDER');
mkdirSync(folder, { recursive: true });
const screen = { width: 1200, height: 750, touch: false };
const server = await Server.start({ devices: [
  { id: 'sim:cameo3', time_scale: 4 }, { id: 'sim:cameo4', time_scale: 20, faults: [{ at_path: 19, kind: 'unplug', seconds: 1 }] },
] });

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
    // As the README searches.
    await page.route('**/search', (route) => route.continue({ postData: JSON.stringify({ ...JSON.parse(route.request().postData()), effort: 0.02 }) }));
    await openModel(page, fileURLToPath(new URL('../../examples/house.glb', import.meta.url)));
    await page.locator('.found-card[aria-pressed=true]').waitFor({ timeout: 600_000 });
    await page.locator('.badge-exact').waitFor();
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
