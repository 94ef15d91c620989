// Two popcutd with one queue: what the page of one says of the cutter of the other.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { chmodSync, chownSync, existsSync, mkdtempSync, mkdirSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { closeBrowser, hold, ladder, machineHash, picture, Server, tickAll, visit } from './harness.mjs';

const popcut = process.env.POPCUT ?? 'popcut';

/** The newest PostgreSQL that is installed, or null. */
function programs() {
  const root = '/usr/lib/postgresql';
  const versions = existsSync(root) ? readdirSync(root).sort((a, b) => Number(a) - Number(b)) : [];
  const bin = versions.length > 0 ? join(root, versions.at(-1), 'bin') : null;
  return bin && existsSync(join(bin, 'initdb')) ? bin : null;
}

/** A PostgreSQL in a folder of its own. It refuses to run as root. */
class Postgres {
  constructor(bin) {
    this.bin = bin;
    this.folder = mkdtempSync(join(tmpdir(), 'popcut-page-postgres-'));
    this.data = join(this.folder, 'own', 'data');
    const own = join(this.folder, 'own');
    chmodSync(this.folder, 0o711);
    mkdirSync(own, { mode: 0o700 });
    this.isRoot = process.getuid() === 0;
    if (this.isRoot) chownSync(own, Number(execFileSync('id', ['-u', 'nobody'])), Number(execFileSync('id', ['-g', 'nobody'])));
    this.run('initdb', '-D', this.data, '-U', 'postgres', '-E', 'UTF8', '--locale=C.UTF-8', '-A', 'trust', '--no-sync');
    this.run('pg_ctl', '-D', this.data, '-l', join(own, 'log'), '-w', '-o', `-k ${own} -c listen_addresses='' -c fsync=off`, 'start');
    this.url = `postgresql:///popcut?host=${own}&user=postgres`;
  }

  run(program, ...words) {
    const as = this.isRoot ? ['setpriv', '--reuid', 'nobody', '--regid', 'nogroup', '--clear-groups'] : [];
    const [first, ...rest] = [...as, join(this.bin, program), ...words];
    execFileSync(first, rest, { cwd: '/', stdio: ['ignore', 'ignore', 'inherit'], env: { ...process.env, HOME: this.folder } });
  }

  remove() {
    this.run('pg_ctl', '-D', this.data, '-m', 'immediate', '-w', 'stop');
    rmSync(this.folder, { recursive: true, force: true });
  }
}

const bin = programs();
let postgres, one, two;

before(async () => {
  if (!bin) return;
  postgres = new Postgres(bin);
  const env = { ...process.env, POPCUT_FLEET_DATABASE: postgres.url };
  execFileSync(popcut, ['fleet', 'init'], { env, stdio: 'ignore' });
  const node = async (name, device, port) => {
    const folder = join(postgres.folder, name);
    mkdirSync(folder);
    const section = execFileSync(popcut, ['fleet', 'join', '--node', name, '--write', folder, '-q'], { env, encoding: 'utf8' });
    const config = section.replace('[fleet]\n', `[fleet]\nurl = "http://127.0.0.1:${port}"\n`);
    const server = await Server.start({ devices: [{ id: device, time_scale: 20 }], config, address: `127.0.0.1:${port}` });
    return server;
  };
  const port = 20_000 + process.pid % 20_000;
  one = await node('room-1', 'sim:cameo3', port);
  two = await node('room-2', 'sim:portrait', port + 1);
});

after(async () => {
  await closeBrowser();
  for (const server of [one, two]) await server?.remove();
  postgres?.remove();
});

test('a cutter of another popcutd is armed and started there, and the page leads the way', { skip: bin ? false : 'no PostgreSQL here: apt install postgresql' }, async () => {
  const job = await one.queue(ladder(5), { name: 'far away', device: 'sim:portrait' });
  const here = await visit(one);
  const card = here.page.locator('.cutter', { hasText: 'at room-2' });
  await card.waitFor();
  assert.equal(await here.page.locator('.cutter').count(), 2);
  await here.page.getByRole('link', { name: 'Go to machine' }).click();
  await here.page.getByText('is at room-2, another popcutd').waitFor();
  assert.equal(await here.page.locator('.arm, .hold, .ticks').count(), 0, 'nothing here arms or starts');
  await picture(here.page, 'fleet-elsewhere');
  const way = here.page.getByRole('link', { name: 'Go to room-2' });
  assert.equal(await way.getAttribute('href'), `${two.address}/${machineHash('sim:portrait')}`);
  assert.deepEqual(here.complaints, []);

  // There it is armed and started; the page here sees it cut and done.
  const there = await visit(two, { hash: machineHash('sim:portrait'), beside: 'sim:portrait' });
  await there.page.locator('.arm').waitFor();
  assert.equal(await there.page.getByText('another popcutd').count(), 0);
  await tickAll(there.page);
  await there.page.locator('.arm').click();
  await here.page.getByRole('heading', { name: 'Armed' }).waitFor();
  assert.equal(await here.page.locator('.hold').count(), 0, 'START is there only');
  await there.page.locator('.hold:enabled').waitFor();
  await hold(there.page);
  await two.state(job.id, ['done']);
  await here.page.getByText('Nothing waits for').waitFor();
  assert.deepEqual(here.complaints, []);
  assert.deepEqual(there.complaints, []);
  await here.close();
  await there.close();
});
