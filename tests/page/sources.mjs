// The page's sources as modules for Node and for the browser: bundled as they are, nothing replaced.
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { build } from '../../daemon/web/node_modules/esbuild/lib/main.js';

const web = new URL('../../daemon/web/', import.meta.url).pathname;

/** One module that exports all that the named sources export, as text. */
export async function bundled(...names) {
  const { outputFiles } = await build({
    stdin: { contents: names.map((name) => `export * from './src/${name}';`).join('\n'), resolveDir: web, loader: 'ts' },
    bundle: true, format: 'esm', target: 'es2022', write: false, logLevel: 'error', jsx: 'automatic', jsxImportSource: 'preact',
    define: { LOCAL: 'false', EXAMPLE_PICTURES: '{}', EXAMPLE_GROUPS: '{"cards": [], "paper": []}' },
  });
  return outputFiles[0].text;
}

/** The exports of the named sources, in Node. */
export async function sources(...names) {
  const folder = mkdtempSync(join(tmpdir(), 'popcut-sources-'));
  try {
    const file = join(folder, 'module.mjs');
    writeFileSync(file, await bundled(...names));
    return await import(pathToFileURL(file).href);
  } finally {
    rmSync(folder, { recursive: true });
  }
}
