// A picture and a film of the opening, made of what the canvas shows.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { bytesOf, closeBrowser, picture, startBackend, visit } from './harness.mjs';

let server;

before(async () => { server = await startBackend(); });
after(async () => { await closeBrowser(); await server.remove(); });

/** The export dialog of the design `unit`. */
async function exporting(options = {}) {
  const visited = await visit(server, { hash: '#/design/example/unit', ...options });
  await visited.page.locator('.badge', { hasText: 'exact' }).waitFor({ timeout: 60_000 });
  await visited.page.getByRole('button', { name: 'Make it…' }).click();
  await visited.page.getByText('More: other formats').click();
  return visited;
}

async function saved(page, name) {
  const download = page.waitForEvent('download', { timeout: 60_000 });
  await page.getByRole('button', { name, exact: true }).click();
  const one = await download;
  return [one.suggestedFilename(), await bytesOf(one)];
}

/** What an empty page, without our policy, sees in a file: {width, height, colours} of each different frame. */
async function framesOf(context, bytes, type) {
  const page = await context.newPage();
  await page.goto('about:blank');
  const frames = await page.evaluate(async ({ base64, type: kind }) => {
    const blob = new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: kind });
    const seen = new Map();
    const look = (source, width, height) => {
      const canvas = new OffscreenCanvas(width, height);
      const to = canvas.getContext('2d');
      to.drawImage(source, 0, 0);
      const pixels = new Uint32Array(to.getImageData(0, 0, width, height).data.buffer);
      let sum = 0;
      for (const pixel of pixels) sum = (Math.imul(sum, 31) + pixel) | 0;
      seen.set(sum, { width, height, colours: new Set(pixels).size });
    };
    if (kind === 'image/png') {
      const image = await createImageBitmap(blob);
      look(image, image.width, image.height);
    } else {
      const video = document.createElement('video');
      video.muted = true;
      video.src = URL.createObjectURL(blob);
      document.body.append(video);
      const event = (name) => new Promise((done, failed) => {
        video.addEventListener(name, done, { once: true });
        video.addEventListener('error', () => failed(new Error(`the film cannot be played: ${video.error?.message}`)), { once: true });
      });
      await event('loadeddata');
      for (let at_s = 0; at_s <= 4; at_s += 0.5) {
        const there = event('seeked');
        video.currentTime = at_s;
        await there;
        look(video, video.videoWidth, video.videoHeight);
      }
    }
    return [...seen.values()];
  }, { base64: bytes.toString('base64'), type });
  await page.close();
  return frames;
}

test('the picture is a PNG of the canvas, with the card in it', async () => {
  const { page, context, complaints, close } = await exporting({ motion: 'reduce' });
  const [name, bytes] = await saved(page, 'Picture as you see it (PNG)');
  assert.equal(name, 'unit.png');
  assert.deepEqual([...bytes.subarray(0, 8)], [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  const [frame] = await framesOf(context, bytes, 'image/png');
  const shown = await page.locator('.stage-canvas').first().evaluate((canvas) => [canvas.width, canvas.height]);
  assert.deepEqual([frame.width, frame.height], shown);
  assert.ok(frame.colours > 20, `${frame.colours} colours`);
  assert.deepEqual(complaints, []);
  await close();
});

test('the film is a WebM in which the card opens, and the card stands as before', async () => {
  for (const motion of ['no-preference', 'reduce']) {
    const { page, context, complaints, close } = await exporting({ motion });
    const angle = page.locator('.deploy input[type=range]');
    const before = await angle.inputValue();
    const [name, bytes] = await saved(page, 'Film of the opening (WebM)');
    assert.equal(name, 'unit.webm');
    assert.deepEqual([...bytes.subarray(0, 4)], [0x1a, 0x45, 0xdf, 0xa3], 'EBML');
    assert.ok(bytes.subarray(0, 64).includes('webm'));
    assert.ok(bytes.length > 5_000, `${bytes.length} bytes`);
    const frames = await framesOf(context, bytes, 'video/webm');
    assert.ok(frames.length >= 3, `${frames.length} frames differ`);
    for (const frame of frames) assert.ok(frame.colours > 20 && frame.width >= 300);
    assert.equal(await angle.inputValue(), before);
    await page.getByRole('button', { name: 'Film of the opening (WebM)', exact: true }).waitFor();
    if (motion === 'reduce') await picture(page, 'film-dialog');
    assert.deepEqual(complaints, []);
    await close();
  }
});

test('who leaves while the film is made gets none, and the page works on', async () => {
  const { page, complaints, close } = await exporting();
  let downloads = 0;
  page.on('download', () => { downloads++; });
  await page.getByRole('button', { name: 'Film of the opening (WebM)', exact: true }).click();
  await page.getByRole('button', { name: 'Filming…' }).waitFor();
  assert.equal(await page.getByRole('button', { name: 'Filming…' }).isDisabled(), true);
  await page.keyboard.press('Escape');
  await page.getByRole('link', { name: 'Settings', exact: true }).click();
  await page.locator('.settings').waitFor();
  await page.evaluate(() => new Promise((done) => { setTimeout(done, 5500); }));      // a film takes 4.3 s
  assert.equal(downloads, 0);
  await page.getByRole('link', { name: 'Design', exact: true }).click();
  await page.locator('.badge', { hasText: 'exact' }).waitFor();
  assert.equal(await page.locator('.deploy input[type=range]').inputValue(), '90', 'the card stands as designed');
  assert.deepEqual(complaints, []);
  await close();
});
