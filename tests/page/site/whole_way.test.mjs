// The maker's whole way on the page of static files, in Chromium and in Firefox, from a server that sends no headers and is
// gone after the first load.
import assert from 'node:assert/strict';
import { after, test } from 'node:test';
import { serve } from '../../../daemon/web/serve.mjs';
import { closeBrowser, openModel } from '../harness.mjs';
import { begin, closeFirefox, exact, keptWhole, noFirefox, open, start } from './visit.mjs';

const folder = process.env.POPCUT_SITE ?? 'build/site/page';
after(async () => {
  await closeBrowser();
  await closeFirefox();
});

/** A hall in bricks: an OBJ, its MTL and the picture that it names. */
const hall = Object.entries({
  'hall.obj': ['mtllib hall.mtl', ...[[0, 0], [60, 0], [60, 30], [0, 30]].flatMap(([x, z]) => [`v ${x} 0 ${z}`, `v ${x} 25 ${z}`]),
    'vt 0 0', 'vt 1 0', 'vt 1 1', 'vt 0 1', 'usemtl brick', 'f 1/1 3/2 5/3 7/4', 'f 2/1 8/2 6/3 4/4', 'f 1/1 2/2 4/3 3/4', 'f 3/1 4/2 6/3 5/4',
    'f 5/1 6/2 8/3 7/4', 'f 7/1 8/2 2/3 1/4', ''].join('\n'),
  'hall.mtl': 'newmtl brick\nKd 1 1 1\nmap_Kd brick.png\n',
  'brick.png': Buffer.from('iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAE0lEQVR4nGM4oSECRAwiGieACAAcfgQRHLDUewAAAABJRU5ErkJggg==', 'base64'),
}).map(([name, content]) => ({ name, mimeType: 'application/octet-stream', buffer: Buffer.from(content) }));

for (const inFirefox of [false, true]) {
  test(`from a model to every file, without a network, in ${inFirefox ? 'Firefox' : 'Chromium'}`, { skip: inFirefox && noFirefox }, async () => {
    const server = await serve(folder, 0, { plain: true });
    const { page, complaints, saved, close } = await open(`http://127.0.0.1:${server.address().port}/`, { inFirefox });
    const press = (name) => page.getByRole('button', { name }).click();
    await start(page);
    await keptWhole(page);
    await page.reload();   // only then does what is kept answer
    await start(page);
    server.closeAllConnections();
    await new Promise((done) => server.close(done));
    await page.reload();
    await start(page);

    await openModel(page, hall, 'x');
    const progress = page.getByRole('progressbar', { name: 'Searching for the best cards' });
    await progress.waitFor();
    await press('Cancel');
    await progress.waitFor({ state: 'detached' });
    await press('Find the best cards');
    await progress.waitFor();
    await page.locator('.found-card:has(.found-make)').click({ timeout: 300_000 });
    await exact(page);
    assert.ok((await page.locator('.found-card img').count()) > 0, 'the cards are seen printed');
    assert.match(await page.locator('[aria-labelledby=figures]').innerText(), /folds\s+\d/);

    await press('Make it…');
    for (const [way, head] of [['By hand', '%PDF-'], ['Cricut', '<?xml'], ['Silhouette Studio', '0\nSECTION'], ['LightBurn', '<?xml']]) {
      await page.locator('.make-choice', { hasText: way }).click();
      const file = await saved(() => page.locator('.made-files button').first().click());
      assert.equal(file.toString('latin1', 0, head.length), head, way);
      await press('Other ways');
    }
    await page.locator('.make-more summary').click();
    for (const [format, head] of [['(FOLD)', '{'], ['(STL)', 'popcut, mm'], ['(GLB)', 'glTF']]) {
      const file = await saved(() => page.locator('.export', { hasText: format }).click());
      assert.equal(file.toString('latin1', 0, head.length), head, format);
    }
    await page.locator('.make-choice', { hasText: 'Print a picture on it' }).click();
    for (const [paper, title] of [['letter', 'Letter, 8.5 x 11 in'], ['12x12', '12 x 12 in'], ['A4', 'A4, 210 x 297 mm']]) {
      await page.getByRole('dialog').getByLabel('Paper or mat').selectOption(paper);
      await press('Show the sheets');
      await page.locator('.sheets .facts', { hasText: title }).waitFor();
      if (paper === 'A4') break;
      await page.evaluate(() => { location.hash = '#/design'; });
      await exact(page);
      await press('Plan the sheets…');
    }
    const printed = await saved(() => press('Page to print (PDF)'));
    assert.equal(printed.toString('latin1', 0, 5), '%PDF-');
    assert.match(printed.toString('latin1'), /\/Subtype *\/Image/, 'its texture is on the page');
    await page.getByRole('link', { name: 'How to fold it' }).click();
    await page.locator('.fold-acts').waitFor();
    await press('Next');

    await page.getByRole('link', { name: 'Design', exact: true }).click();
    await press('New');
    await begin(page, 'unit');
    await press('Share');
    const link = await page.getByRole('dialog').locator('input').first().inputValue();
    await press('Close');
    await press('New');
    await start(page);
    await page.evaluate((to) => { location.hash = to; }, new URL(link).hash);
    await exact(page);
    assert.equal(await page.locator('.design-name').inputValue(), 'unit');
    assert.deepEqual(complaints, []);
    await close();
  });
}
