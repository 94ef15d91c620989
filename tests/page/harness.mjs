// popcutd with simulated cutters, or the page of static files, and a browser that looks at its page.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { request as httpRequest } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout as wait } from 'node:timers/promises';
import { chromium } from 'playwright-core';
import { serve } from '../../daemon/web/serve.mjs';

export { wait };

const popcutdProgram = process.env.POPCUTD ?? 'popcutd';
const pictures = process.env.POPCUT_PAGE_SCREENSHOTS ?? join(tmpdir(), 'popcut-page');
const chromiumProgram = process.env.CHROMIUM ?? '/usr/bin/chromium';
// As browsers are where there is no graphics card: WebGL by software, and all else by the processor. Debian's flags say
// otherwise, which makes each picture of the whole page go through the software's WebGL, too.
const chromiumFlags = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--use-gl=angle', '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader', '--disable-gpu-compositing', '--disable-gpu-rasterization',
  '--disable-accelerated-2d-canvas'];

/** How a browser is started. */
export const launchOptions = { executablePath: chromiumProgram, args: chromiumFlags };

/** With these flags the browser itself reads each picture of WebGL to put it on the screen, and warns of it. */
const ofTheBrowser = /^\[\.WebGL-\w+\]GL Driver Message .* GPU stall due to ReadPixels/;

/** Waits until `what()` is true or gives a value; fails after `limit_ms` with `sentence`. */
export async function until(what, sentence, limit_ms = 60_000) {
  const end = Date.now() + limit_ms;
  for (;;) {
    const value = await what();
    if (value) return value;
    if (Date.now() > end) throw new Error(`not within ${limit_ms} ms: ${sentence}`);
    await wait(40);
  }
}

/** A drawing of `lines` strokes, as SVG: enough to cut for a while. More than 68 reach beyond its A6 page, as is meant. */
export function ladder(lines = 40) {
  const rungs = Array.from({ length: lines }, (_, i) => `M10 ${10 + i * 2}H90`).join('');
  return `<svg xmlns="http://www.w3.org/2000/svg" width="105mm" height="148mm" viewBox="0 0 105 148" overflow="visible">`
    + `<path fill="none" stroke="#000" d="${rungs}"/></svg>`;
}

/** A spec of one strip, the smallest card. */
export const unitSpec = {
  popcut: 1, name: 'unit', surface: { type: 'revolution', radius: '30' }, units_per_slice: 1, slices: 1, widths_mm: 30,
};

/** A popcutd of its own: state, socket and port are new. */
export class Server {
  static async start({ devices = [{ id: 'sim:cameo3', time_scale: 20 }], config = '', limits = {}, address = '127.0.0.1:0' } = {}) {
    const server = new Server();
    server.folder = mkdtempSync(join(tmpdir(), 'popcut-page-'));
    server.config = join(server.folder, 'popcutd.toml');
    const tables = devices.map((device) => {
      const { faults, ...rest } = device;
      if (faults) {
        rest.faults = join(server.folder, `faults-${rest.id.replace(/\W/g, '-')}.json`);
        writeFileSync(rest.faults, JSON.stringify({ popcut: 1, faults }));
      }
      return '[[device]]\n' + Object.entries(rest).map(([key, value]) => `${key} = ${JSON.stringify(value)}`).join('\n');
    });
    server.settings = `${config}\n${tables.join('\n')}\n`;
    server.limits = { rate_per_s: 1000, rate_burst: 1000, failed_logins_per_minute: 1000, ...limits };
    server.configure({});
    await server.run(address);
    return server;
  }

  /** Writes the configuration, with these limits instead of those that it began with. */
  configure(limits) {
    const all = { ...this.limits, ...limits };
    writeFileSync(this.config, `${this.settings}[limits]\n${Object.entries(all).map(([key, value]) => `${key} = ${value}\n`).join('')}`);
  }

  /** Changes limits while popcutd runs. */
  async limit(limits) {
    const before = this.log.length;
    this.configure(limits);
    this.program.kill('SIGHUP');
    await until(() => /configuration/i.test(this.log.slice(before)), 'popcutd read its configuration again');
  }

  /** Starts the program at `address`; a port 0 is any free one. */
  async run(address) {
    this.log = '';
    this.program = spawn(popcutdProgram, ['--config', this.config, '--state', join(this.folder, 'state'), '--socket',
      join(this.folder, 'socket'), '--listen', address], { stdio: ['ignore', 'pipe', 'pipe'] });
    this.ended = once(this.program, 'exit');
    for (const pipe of [this.program.stdout, this.program.stderr]) pipe.on('data', (text) => { this.log += text; });
    let failure = null;
    this.program.on('error', (error) => { failure = error; });
    const port = await until(() => {
      if (failure || this.program.exitCode !== null) throw new Error(`${popcutdProgram}: ${failure?.message ?? this.log}`);
      return /serving at 127\.0\.0\.1:(\d+)/.exec(this.log)?.[1];
    }, 'popcutd serves');
    this.port = Number(port);
    this.address = `http://127.0.0.1:${this.port}`;
  }

  async stop() {
    if (this.program.exitCode === null && this.program.signalCode === null) {
      this.program.kill('SIGCONT');
      this.program.kill('SIGTERM');
    }
    await this.ended;
  }

  /** Ends popcutd at once, as a crash does; run() starts it again. */
  async kill() {
    this.program.kill('SIGKILL');
    await this.ended;
  }

  async remove() {
    await this.stop();
    rmSync(this.folder, { recursive: true, force: true });
  }

  /** A request as an admin over the unix socket, or with `token` over TCP. Answers {status, body, headers}. */
  ask(method, path, body, { token, headers = {} } = {}) {
    const text = body === undefined ? undefined : typeof body === 'string' ? body : JSON.stringify(body);
    const where = token ? { host: '127.0.0.1', port: this.port } : { socketPath: join(this.folder, 'socket') };
    return new Promise((done, failed) => {
      const one = httpRequest({ ...where, method, path, headers: {
        Host: `127.0.0.1:${this.port}`,
        ...(text === undefined ? {} : { 'Content-Type': 'application/json', 'Content-Length': Buffer.byteLength(text) }),
        ...(token ? { Authorization: `Bearer ${token}` } : {}), ...headers,
      } }, (answer) => {
        let all = '';
        answer.setEncoding('utf8');
        answer.on('data', (part) => { all += part; });
        answer.on('end', () => {
          let parsed = all;
          try { parsed = JSON.parse(all); } catch { /* not JSON */ }
          done({ status: answer.statusCode, body: parsed, headers: answer.headers });
        });
      });
      one.on('error', failed);
      one.end(text);
    });
  }

  /** As ask(), for what must work: fails with the answer if it does not. */
  async must(method, path, body, more) {
    const answer = await this.ask(method, path, body, more);
    if (answer.status >= 300) throw new Error(`${method} ${path}: ${answer.status} ${JSON.stringify(answer.body)}`);
    return answer.body;
  }

  /** A new token with `role`: {id, token}. */
  token(role, name = role) {
    return this.must('POST', '/v1/tokens', { role, name });
  }

  /** The address that signs a browser in, once. */
  async link(role, name) {
    const { token } = await this.token(role, name);
    const { one_shot } = await this.must('POST', '/v1/session/one-shot', {}, { token });
    return `${this.address}/#t=${encodeURIComponent(one_shot)}`;
  }

  /** Uploads a design (a spec as an object, or an SVG) and queues it. Answers the job when it is ready. */
  async queue(design, { name, device = 'sim:cameo3', ...more } = {}) {
    const { id } = await this.must('POST', '/v1/designs', typeof design === 'string' ? design : JSON.stringify(design),
      typeof design === 'string' ? { headers: { 'Content-Type': 'image/svg+xml' } } : {});
    const job = await this.must('POST', '/v1/jobs', { design: id, name: name ?? 'ladder', device, ...more },
      { headers: { 'Idempotency-Key': crypto.randomUUID() } });
    return await this.state(job.id, 'ready', 60_000);
  }

  job(id) { return this.must('GET', `/v1/jobs/${id}`); }

  /** Waits until the job is in one of the `states`. */
  state(id, states, limit_ms = 60_000) {
    return until(async () => {
      const job = await this.job(id);
      return [states].flat().includes(job.state) && job;
    }, `job is ${states}`, limit_ms);
  }

  /** An action of a job as it is now. */
  async act(id, action, body = {}) {
    const { rev } = await this.job(id);
    return this.must('POST', `/v1/jobs/${id}/actions/${action}`, body,
      { headers: { 'Idempotency-Key': crypto.randomUUID(), 'If-Match': `"${rev}"` } });
  }

  /** Arms and starts the current sheet. */
  async cut(id) {
    const job = await this.job(id);
    await this.act(id, 'arm', { sheet: job.sheet, ...(job.unaccepted_warnings.length > 0
      ? { accept_warnings: job.unaccepted_warnings } : {}) });
    await this.act(id, 'start');
    return this.state(id, ['cutting', 'paused', 'interrupted', 'done']);
  }

  /** How often the knife was started: attempts of all sheets of a job. */
  async attempts(id) {
    const { sheet } = await this.job(id);
    const ledger = await this.ask('GET', `/v1/jobs/${id}/sheets/${sheet ?? 1}/ledger`);
    return ledger.status === 200 ? ledger.body.attempts.length : 0;
  }
}

/** The folder of static files that the tests of the page run on in place of popcutd ('./run test --site'). */
const folder = process.env.POPCUT_PAGE_FOLDER;
export const onPopcutd = folder === undefined;
/** Of a test of what only popcutd does: it does not run on static files. */
export const ofPopcutd = { skip: !onPopcutd && 'needs popcutd' };

/** The page of static files on a plain server. */
class StaticPage {
  static async start() {
    const of = new StaticPage();
    of.server = await serve(folder);
    of.address = `http://127.0.0.1:${of.server.address().port}`;
    return of;
  }

  async remove() {
    this.server.closeAllConnections();
    this.server.close();
  }
}

/** What answers the page in tests of both: static files where they are to be tested, else popcutd as `options` say. */
export const startBackend = (options) => (onPopcutd ? Server.start(options) : StaticPage.start());

let browser = null;

/** The browser that the tests of a run share, or one of this test file alone. */
export async function openBrowser() {
  const shared = process.env.POPCUT_PAGE_BROWSER;
  browser ??= shared && existsSync(shared) ? await chromium.connect(readFileSync(shared, 'utf8')) : await chromium.launch(launchOptions);
  return browser;
}

/** Ends this file's contexts, and the browser if it is not shared. */
export async function closeBrowser() {
  await browser?.close();
  browser = null;
}

/** What was saved, also by a browser that other tests share. */
export async function bytesOf(download) {
  const parts = [];
  for await (const part of await download.createReadStream()) parts.push(part);
  return Buffer.concat(parts);
}

export const screens = {
  phone: { width: 390, height: 844, touch: true },
  tablet: { width: 1024, height: 768, touch: true },
  desktop: { width: 1440, height: 900, touch: false },
};

/**
 * A browser of its own, signed in with `role` and at `hash`. Everything that went wrong in it is in `complaints`:
 * what the console said, errors, refused content. `sent` lists its requests that change something. Static files know no
 * one, so nobody signs in there.
 */
export async function visit(server, { role = 'operator', name, hash = '', screen = 'desktop', theme = 'light', beside = 'sim:cameo3',
  language, signIn = true, motion = 'no-preference' } = {}) {
  const { width, height, touch } = screens[screen] ?? screen;
  const context = await (await openBrowser()).newContext({
    viewport: { width, height }, hasTouch: touch, colorScheme: theme, reducedMotion: motion, locale: 'en-GB',
    baseURL: pageAddress(server),
  });
  context.setDefaultTimeout(60_000);  // other tests run beside this one
  const page = await context.newPage();
  const complaints = [];
  const sent = [];
  page.on('console', (message) => {
    const text = message.text();
    if (ofTheBrowser.test(text)) return;
    if (!expectedOf(page).some((pattern) => pattern.test(text))) complaints.push(`console: ${text} ${message.location().url}`);
  });
  page.on('pageerror', (error) => complaints.push(`error: ${error.stack ?? error.message}`));
  page.on('request', (request) => {
    if (request.method() !== 'GET') sent.push({ method: request.method(), path: new URL(request.url()).pathname,
      headers: request.headers(), body: request.postData() });
  });
  await page.addInitScript(({ beside: stands, language: words }) => {
    document.addEventListener('securitypolicyviolation', (event) => {
      console.error(`policy: ${event.violatedDirective} ${event.blockedURI} ${event.sample}`);
    });
    if (location.protocol !== 'http:' || localStorage.getItem('test.set')) return;
    localStorage.setItem('test.set', '1');
    if (stands) localStorage.setItem('popcut.beside', stands);
    if (words) localStorage.setItem('popcut.language', words);
  }, { beside, language });
  if (signIn && server instanceof Server) {
    const link = await server.link(role, name);
    await page.goto(link.replace(server.address, pageAddress(server)));
    await page.locator('.bar-person').waitFor();
    if (hash) await page.evaluate((to) => { location.hash = to; }, hash);
  } else {
    await page.goto(`${pageAddress(server)}/${hash}`);
  }
  return { page, context, complaints, sent, acts: (action) => sent.filter((one) => one.path.endsWith(`/actions/${action}`)),
    close: () => context.close() };
}

/** Opens a model; this side of it looks at a person, or the one that the page guesses. `files`: as Playwright takes them. */
export async function openModel(page, files, front) {
  await page.locator('.design-drop > input[type=file]').setInputFiles(files);
  await page.locator(front ? `.side[aria-label^="Facing you: ${front}"]` : '.side-guess').click({ timeout: 60_000 });
}

/** Waits until a model is drawn: its first draft, or a card that was found in place of it. */
export const drawn = (page) => page.locator('.badge-first, .badge-exact').waitFor({ timeout: 60_000 });

const expected = new WeakMap();
const expectedOf = (page) => expected.get(page) ?? [];

/** What the console of `page` may say from now on: a refused request is logged by the browser itself. */
export function expectComplaints(page, ...patterns) {
  expected.set(page, [...expectedOf(page), ...patterns]);
}

export const refused = (status) => new RegExp(`Failed to load resource: the server responded with a status of ${status}`);
export const unreachable = /Failed to load resource: net::ERR_/;

function pageAddress(server) {
  return server.pageAddress ?? server.address;
}

/** Opens the dialog that plans the design. */
export const openPlan = (page) => page.getByRole('button', { name: onPopcutd ? 'Cut this…' : 'Plan the sheets…' }).click();

/** The three ticks. */
export async function tickAll(page) {
  for (const tick of await page.locator('.machine-act .ticks input[type=checkbox]').all()) await tick.check();
}

/** Stops the page's own clock, however busy the machine is: `page.clock.runFor` moves it, `page.clock.resume` lets it go on. */
export async function stopClock(page) {
  await page.clock.install();
  await page.clock.pauseAt(new Date(Date.now() + 1000));
}

/** Moves the pointer to the middle of START (or GO ON). Answers where that is. */
export async function pointAtHold(page) {
  const box = await page.locator('.hold').boundingBox();
  const at = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  await page.mouse.move(at.x, at.y);
  return at;
}

/** Holds the pointer on START (or GO ON) until the ring is full. */
export async function hold(page) {
  await pointAtHold(page);
  await page.mouse.down();
  await page.locator('.hold-on').waitFor();
  await page.locator('.hold-on').waitFor({ state: 'detached' });
  await page.mouse.up();
}

/** Three ticks, Arm; waits until START can be held. */
export async function armHere(page) {
  await page.locator('.arm').waitFor();
  for (const accept of await page.locator('.warning input').all()) await accept.check();
  await tickAll(page);
  await page.locator('.arm').click();
  await page.locator('.hold:enabled').waitFor();
}

export function machineHash(device = 'sim:cameo3') {
  return `#/at/${encodeURIComponent(device)}`;
}

/** Keeps what a view looks like, for people. */
export async function picture(page, name) {
  mkdirSync(pictures, { recursive: true });
  await page.screenshot({ path: join(pictures, `${name}.png`) });
}

/** The text of axe-core, to be run in a page. */
export function axeSource() {
  const path = new URL('node_modules/axe-core/axe.min.js', import.meta.url);
  if (!existsSync(path)) throw new Error('axe-core is not installed: run npm ci in tests/page');
  return readFileSync(path, 'utf8');
}
