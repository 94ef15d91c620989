// Builds the page of static files, which needs no popcutd: node site.mjs ENGINE SOURCES FOLDER [--version V]
// ENGINE holds engine.js and engine.wasm (daemon/site), SOURCES the source packages that they were made of.
import * as esbuild from 'esbuild';
import { createHash } from 'node:crypto';
import { copyFileSync, mkdirSync, readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';
import { bundle, groups, writeHashed, writeIndex } from './build.mjs';
import { policy } from './serve.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, '../..');
const [engineFolder, sourcesFolder, folder] = process.argv.slice(2, 5).map((path) => resolve(path));

/** popcut's tables, by the engine itself. */
async function tables() {
  const engine = await createRequire(import.meta.url)(join(engineFolder, 'engine.js'))({ wasmBinary: readFileSync(join(engineFolder, 'engine.wasm')) });
  let text = '';
  engine.onFrame = (kind, name, bytes) => { text = Buffer.from(bytes).toString(); };
  engine._popcut_tables();
  return text;
}

/** As popcutd lists them. */
function examples() {
  return JSON.stringify(Object.values(groups).flat().map((name) => {
    const spec = JSON.parse(readFileSync(join(root, 'examples', `${name}.json`), 'utf8'));
    return { name, title: spec.name ?? name, spec };
  }));
}

async function worker() {
  const { outputFiles } = await esbuild.build({
    absWorkingDir: here,
    entryPoints: ['src/local/worker.ts'],
    alias: { engine: join(engineFolder, 'engine.js') },
    external: ['fs', 'path', 'url', 'worker_threads', 'perf_hooks', 'crypto'],   // for other places than a browser
    bundle: true, write: false, format: 'iife', target: 'es2022', minify: true, legalComments: 'none', logLevel: 'warning',
  });
  return outputFiles[0].contents;
}

/** The terms of what is in the engine: what Debian says of each source package, and of the headers. */
function engineLicences() {
  const parts = [];
  for (const name of readdirSync(sourcesFolder).sort()) {
    const file = join(sourcesFolder, name, 'debian/copyright');
    if (statSync(join(sourcesFolder, name)).isDirectory() && readdirSync(join(sourcesFolder, name)).includes('debian')) {
      parts.push(`${name}\n\n${readFileSync(file, 'utf8').trim()}`);
    }
  }
  for (const name of ['libboost1.74-dev', 'libeigen3-dev', 'libexpected-dev', 'libfast-float-dev', 'libtinygltf-dev', 'nlohmann-json3-dev', 'fonts-dejavu-core', 'emscripten']) {
    try {
      parts.push(`${name}\n\n${readFileSync(`/usr/share/doc/${name}/copyright`, 'utf8').trim()}`);
    } catch {
      throw new Error(`/usr/share/doc/${name}/copyright: is missing, so the site cannot say under which terms it is used`);
    }
  }
  return parts;
}

const relink = (version) => `popcut ${version} in a browser: the parts under the LGPL
============================================================

page/engine-*.wasm holds NLopt, parts of which (src/algs/luksan) are under the GNU Lesser General Public License. Its
sources as they were compiled lie here. To link the engine with a changed NLopt:

1. Get the sources of popcut ${version} (MIT), and Debian 12.
2. Run "./run site FOLDER" once. It unpacks the sources of NLopt in build/site/sources.
3. Change them, and run "./run site FOLDER" again: it compiles and links what is different.
`;

const version = process.argv[process.argv.indexOf('--version') + 1] ?? '0';
const made = await bundle(folder, { pictures: '', constants: { LOCAL: 'true', LOCAL_BUILD: JSON.stringify(version) } });
const own = {
  engine: writeHashed(folder, 'engine', 'wasm', readFileSync(join(engineFolder, 'engine.wasm'))),
  'engine-worker': writeHashed(folder, 'engine-worker', 'js', await worker()),
  tables: writeHashed(folder, 'tables', 'json', await tables()),
  examples: writeHashed(folder, 'examples', 'json', examples()),
};
made.licences = [made.licences.trim(), ...engineLicences()].join(`\n\n${'-'.repeat(76)}\n\n`) + '\n';
writeIndex(folder, made, '', [
  // For servers that send no such header; what a page cannot say about itself is left out.
  `<meta http-equiv="Content-Security-Policy" content="${policy.replace(/ frame-ancestors [^;]*;/, '')}">`,
  '<link rel="manifest" href="manifest.webmanifest">',
  ...Object.entries(own).map(([name, file]) => `<meta name="${name}" content="${file}">`),
]);
const icon = readdirSync(join(folder, 'page')).find((name) => /^icon-.*\.svg$/.test(name));
writeFileSync(join(folder, 'manifest.webmanifest'), JSON.stringify({
  name: 'popcut', short_name: 'popcut', description: 'Design pop-up cards, and cut them', start_url: './', scope: './', display: 'standalone',
  background_color: '#ffffff', theme_color: '#ffffff', icons: [{ src: `page/${icon}`, sizes: 'any', type: 'image/svg+xml' }],
}, null, 1) + '\n');

// What the LGPL asks for.
mkdirSync(join(folder, 'sources'));
for (const name of readdirSync(sourcesFolder).filter((one) => one.startsWith('nlopt_'))) copyFileSync(join(sourcesFolder, name), join(folder, 'sources', name));
writeFileSync(join(folder, 'sources/README.txt'), relink(version));

const files = readdirSync(join(folder, 'page')).map((name) => `page/${name}`).filter((name) => !/licences-/.test(name));
const kept = ['./', 'manifest.webmanifest', ...files];
const hash = createHash('sha256');
for (const file of ['index.html', ...kept.slice(1)]) hash.update(readFileSync(join(folder, file)));
writeFileSync(join(folder, 'service_worker.js'), readFileSync(join(here, 'service_worker.js'), 'utf8')
  .replace('popcut-VERSION', `popcut-${hash.digest('hex').slice(0, 12)}`).replace('= FILES', `= ${JSON.stringify(kept)}`));

// Beside each file its smaller forms, for servers that can send them.
const sizes = [];
const walk = (at) => readdirSync(join(folder, at), { withFileTypes: true }).flatMap((one) => (one.isDirectory() ? walk(join(at, one.name)) : [join(at, one.name)]));
for (const file of walk('.').filter((name) => /\.(html|js|css|svg|txt|json|wasm|webmanifest)$/.test(name))) {
  const bytes = readFileSync(join(folder, file));
  const gzip = gzipSync(bytes, { level: 9 });
  const brotli = brotliCompressSync(bytes, { params: { [constants.BROTLI_PARAM_QUALITY]: 11, [constants.BROTLI_PARAM_LGWIN]: 24 } });
  if (gzip.length < bytes.length) writeFileSync(join(folder, `${file}.gz`), gzip);
  if (brotli.length < bytes.length) writeFileSync(join(folder, `${file}.br`), brotli);
  sizes.push({ file, bytes: bytes.length, gzip: gzip.length, brotli: Math.min(brotli.length, bytes.length) });
}
const sum = (key, of = sizes) => `${(of.reduce((all, one) => all + one[key], 0) / 1e6).toFixed(2)} MB`;
const engineSizes = sizes.filter(({ file }) => file === own.engine);
const loaded = sizes.filter(({ file }) => !/^(sources|page\/licences)/.test(file));
for (const [what, of] of [['engine.wasm', engineSizes], ['all that is loaded', loaded]]) {
  console.log(`${what}: ${sum('bytes', of)}, gzip ${sum('gzip', of)}, brotli ${sum('brotli', of)}`);
}
