// The page of static files in Chromium or Firefox, and what a person does there.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, readFileSync } from 'node:fs';
import { firefox } from 'playwright-core';
import { bytesOf, openBrowser, screens, until } from '../harness.mjs';

const firefoxProgram = process.env.FIREFOX ?? '/usr/bin/firefox-esr';
/** Why the tests in Firefox do not run; false: they do. */
export const noFirefox = ![firefoxProgram, '/usr/bin/Xvfb'].every((program) => existsSync(program))
  && 'Firefox or Xvfb is not here; type: ./run deps --site';

let fox = null;
let display = null;
/** A screen that nobody sees: without one Firefox has no WebGL. */
async function hiddenScreen() {
  display = spawn('/usr/bin/Xvfb', ['-displayfd', '1', '-screen', '0', '1600x1200x24', '-nolisten', 'tcp'], { stdio: ['ignore', 'pipe', 'ignore'] });
  const [number] = await once(display.stdout, 'data');
  return `:${String(number).trim()}`;
}

/** What playwright-core keeps of a browser or page on its own side, where it speaks WebDriver BiDi with Firefox. */
const inside = (of) => of._connection.toImpl(of);

async function openFirefox() {
  if (fox) return fox;
  const env = { ...process.env, DISPLAY: await hiddenScreen() };
  fox = await firefox.launch({ channel: 'moz-firefox', executablePath: firefoxProgram, headless: false, env });
  // playwright-core asks for dark or light; Firefox ESR has no word for that.
  const session = inside(fox)._browserSession;
  const send = session.send.bind(session);
  session.send = (method, params) => (method === 'emulation.setMediaFeaturesOverride' ? Promise.resolve({}) : send(method, params));
  return fox;
}

export async function closeFirefox() {
  await fox?.close();
  display?.kill();
  fox = display = null;
}

/** What Firefox alone tells of a page: everything in its console, and files that are saved. */
function listen(page, complaints) {
  const session = inside(page).delegate._session;
  session.on('log.entryAdded', ({ level, text, stackTrace }) => complaints.push(`${level}: ${text} ${JSON.stringify(stackTrace ?? '')}`));
  const files = [];
  session.on('browsingContext.downloadEnd', ({ filepath }) => files.push(filepath));
  return async () => readFileSync(await until(() => files.shift(), 'a file is saved'));
}

/**
 * The page at `base` in a browser profile of its own, or in `context`. `complaints`: what its console said, and requests
 * elsewhere; `saved(press)`: the bytes of the file that `press` has saved. `beforehand` runs in the page before its scripts.
 */
export async function open(base, { hash = '#/design', screen = 'desktop', context: given, inFirefox = false, beforehand } = {}) {
  const { width, height, touch } = screens[screen];
  const browser = await (inFirefox ? openFirefox() : openBrowser());
  const context = given ?? await browser.newContext({ viewport: { width, height }, hasTouch: touch, locale: 'en-GB', reducedMotion: 'reduce' });
  context.setDefaultTimeout(60_000);
  const page = await context.newPage();
  const complaints = [];
  if (!inFirefox) {
    page.on('console', (message) => { if (!/GL Driver Message/.test(message.text())) complaints.push(`console: ${message.text()} ${message.location().url}`); });
    page.on('pageerror', (error) => complaints.push(`error: ${error.stack ?? error.message}`));
  }
  page.on('request', (request) => { if (!/^(blob|data):/.test(request.url()) && !request.url().startsWith(base)) complaints.push(`request: ${request.url()}`); });
  await page.addInitScript(() => document.addEventListener('securitypolicyviolation', (event) => console.error(`policy: ${event.violatedDirective} ${event.blockedURI} ${event.sample}`)));
  if (beforehand) await page.addInitScript(beforehand);
  const nextFile = inFirefox ? listen(page, complaints) : async (waits) => bytesOf(await waits);
  const saved = async (press) => {
    const named = page.waitForEvent('download');
    if (inFirefox) named.catch(() => undefined);
    await press();
    return nextFile(named);
  };
  await page.goto(base + hash);
  return { page, context, complaints, saved, close: () => context.close() };
}

export const start = (page) => page.locator('.start-card:not(:disabled)').first().waitFor();
export const exact = (page) => page.locator('.badge-exact', { hasText: 'exact' }).waitFor();
export const begin = async (page, name) => {
  await start(page);
  await page.locator('.start-card', { hasText: new RegExp(`^${name}$`) }).click();
  await exact(page);
};

/** Waits until this browser has the whole page, for when there is no network. */
export async function keptWhole(page) {
  await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
  await until(() => page.evaluate(async () => (await caches.keys()).length === 1 && (await (await caches.open((await caches.keys())[0])).keys()).length > 20), 'the page is kept');
}

/** A house with a gable, as an OBJ file. */
export const house = Buffer.from([
  ...[[0, 0], [60, 0], [60, 30], [30, 50], [0, 30]].flatMap(([x, z]) => [`v ${x} 0 ${z}`, `v ${x} 25 ${z}`]),
  'f 1 3 5 7 9', 'f 2 10 8 6 4', 'f 1 2 4 3', 'f 3 4 6 5', 'f 5 6 8 7', 'f 7 8 10 9', 'f 9 10 2 1', '',
].join('\n'));
