// Runs one file of tests of the page: `node run.mjs machine.test.mjs`, or the browser that they share:
// `node run.mjs browser.mjs FILE`. Exit code 77 and a sentence where there is no browser or no npm to install what the
// tests need.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, rmSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const here = fileURLToPath(new URL('.', import.meta.url));
const web = fileURLToPath(new URL('../../daemon/web/', import.meta.url));

function skip(sentence) {
  console.log(`skipped: ${sentence}`);
  process.exit(77);
}

/** Installs what `folder` needs, once, also if several tests begin at the same time. */
function install(folder) {
  const lock = `${folder}/node_modules.lock`;
  const end = Date.now() + 120_000;
  while (!existsSync(`${folder}/node_modules/.package-lock.json`)) {
    try {
      mkdirSync(lock);
    } catch {
      if (Date.now() > end) rmSync(lock, { recursive: true, force: true });
      Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, 200);
      continue;
    }
    const { status } = spawnSync('npm', ['ci', '--no-audit', '--no-fund', '--loglevel', 'error'], { cwd: folder, stdio: 'inherit' });
    rmSync(lock, { recursive: true, force: true });
    if (status !== 0) skip('npm is not here or cannot install what the tests of the page need');
  }
}

if (!existsSync(process.env.CHROMIUM ?? '/usr/bin/chromium')) skip('no Chromium here: apt install chromium');
install(web);
install(here);
if (process.argv[2] === 'browser.mjs') {
  await import('./browser.mjs');
  process.exit(0);
}
const { status } = spawnSync(process.execPath, ['--test', '--test-concurrency=1', '--test-reporter=spec', ...process.argv.slice(2)],
  { cwd: here, stdio: 'inherit' });
process.exit(status ?? 1);
