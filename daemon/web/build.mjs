// Builds the page into dist/: index.html, page/* with hashed names, licences of all that is bundled, and a stamp of
// the sources. `node build.mjs` builds, `--types` only writes src/api.d.ts from the description of the HTTP interface,
// `--stamp` only prints the stamp.
import * as esbuild from 'esbuild';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join, relative, sep } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const here = dirname(fileURLToPath(import.meta.url));
const dist = join(here, 'dist');
const root = join(here, '../..');
const gallery = join(root, 'docs/gallery');
const openapi = join(here, '../http/api/openapi.json');

/** The examples of `popcut design --list`, in two groups, in the order in which the page shows them. */
export const groups = {
  cards: ['cat', 'house', 'heart', 'letters', 'village', 'cottage', 'lantern'],
  paper: ['sphere', 'saddle', 'cylinder', 'composite', 'airfoil', 'facade', 'packaging', 'multistate', 'fig2a', 'unit'],
};
const examples = Object.values(groups).flat();

/** What a change of the page begins with: all files of this folder, without what a build or CMake makes and needs. */
function sources() {
  const skipped = ['node_modules', 'dist', 'plain', 'CMakeLists.txt', 'page_files.cmake', 'src/api.d.ts'];
  const found = [];
  const walk = (at) => {
    for (const name of readdirSync(at)) {
      const path = join(at, name);
      if (skipped.includes(inFolder(here, path))) continue;
      if (statSync(path).isDirectory()) walk(path);
      else found.push(path);
    }
  };
  walk(here);
  const pictures = readdirSync(gallery).filter((name) => name.endsWith('-deployed.svg')).map((name) => join(gallery, name));
  return [...found, ...pictures];
}

export const inFolder = (folder, path) => relative(folder, path).split(sep).join('/');

/** sha256 over the lines 'SHA256  NAME' of every source, by name, in hex. page_files.cmake computes the same. */
function stamp() {
  const hex = (bytes) => createHash('sha256').update(bytes).digest('hex');
  const named = sources().map((path) => ({ name: inFolder(root, path), path }));
  named.sort((a, b) => Buffer.compare(Buffer.from(a.name), Buffer.from(b.name)));
  return hex(named.map(({ name, path }) => `${hex(readFileSync(path))}  ${name}\n`).join(''));
}

/** Writes the gzip of each text beside it, where that is smaller. */
function compress() {
  const files = ['index.html', ...readdirSync(join(dist, 'page')).map((name) => `page/${name}`)];
  for (const file of files.filter((name) => /\.(html|js|css|svg|txt|json)$/.test(name))) {
    const bytes = readFileSync(join(dist, file));
    const small = gzipSync(bytes, { level: 9 });
    if (small.length < bytes.length) writeFileSync(join(dist, `${file}.gz`), small);
  }
}

/** The first eight hex digits of the contents, for names that may be kept for ever. */
export function shortHash(bytes) {
  return createHash('sha256').update(bytes).digest('hex').slice(0, 8).toUpperCase();
}

/**
 * A small picture of a deployed example: the gallery's without its legend and the target, in whole numbers, cropped. It
 * keeps the order of drawing, since what is behind is drawn first.
 */
function smallPicture(svg) {
  const scale = 0.7;
  let [left, top, right, bottom] = [Infinity, Infinity, 0, 0];
  const rounded = (d) => {
    let from = [0, 0];
    return [...d.matchAll(/([MLZ])([-\d.]+)?[ ,]?([-\d.]+)?/g)].map(([, letter, x, y]) => {
      if (letter === 'Z') return 'z';
      const to = [Math.round(Number(x) * scale), Math.round(Number(y) * scale)];
      [left, top] = [Math.min(left, to[0]), Math.min(top, to[1])];
      [right, bottom] = [Math.max(right, to[0]), Math.max(bottom, to[1])];
      const step = letter === 'M' ? `M${to[0]} ${to[1]}` : `l${to[0] - from[0]} ${to[1] - from[1]}`;
      const nothing = letter === 'L' && to[0] === from[0] && to[1] === from[1];
      from = to;
      return nothing ? '' : step.replace(/ -/g, '-');
    }).join('');
  };
  const paths = [];
  for (const [, d, rest] of svg.slice(0, svg.indexOf('</g>')).matchAll(/<path d="([^"]*)"([^>]*)\/>/g)) {
    if (rest.includes('fill-opacity')) continue;
    const fill = /fill="([^"]*)"/.exec(rest)?.[1] ?? 'none';
    const stroke = fill === 'none' ? /stroke="([^"]*)"/.exec(rest)?.[1] : undefined;
    const paint = stroke ? `fill="none" stroke="${stroke}"` : `fill="${fill}"`;
    const last = paths.at(-1);
    if (last && last.paint === paint) last.d += rounded(d);
    else paths.push({ paint, d: rounded(d) });
  }
  const size = [right - left + 2, bottom - top + 2];
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${size[0]}" height="${size[1]}"`
    + ` viewBox="${left - 1} ${top - 1} ${size[0]} ${size[1]}"><g stroke-width=".7" stroke-linejoin="round">`
    + paths.map(({ paint, d }) => `<path ${paint} d="${d}"/>`).join('') + '</g></svg>\n';
}

/** Writes the pictures of the examples into `folder`/page; returns the address of each, below `base`, by its name. */
function writePictures(folder, base) {
  const addresses = {};
  for (const name of examples) {
    const picture = smallPicture(readFileSync(join(gallery, `${name}-deployed.svg`), 'utf8'));
    const file = `example-${name}-${shortHash(picture)}.svg`;
    writeFileSync(join(folder, 'page', file), picture);
    addresses[name] = `${base}page/${file}`;
  }
  return addresses;
}

/** The licences of every package that is in the bundle, as one text. Fails if a package has no licence file. */
function licences(metafile) {
  const packages = new Map();
  for (const input of Object.keys(metafile.inputs)) {
    const folder = /^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//.exec(input)?.[1];
    if (!folder || packages.has(folder)) continue;
    const about = JSON.parse(readFileSync(join(here, folder, 'package.json'), 'utf8'));
    const file = readdirSync(join(here, folder)).find((name) => /^(licen[cs]e|copying)(\.|$)/i.test(name));
    if (!file) throw new Error(`${folder}: no licence file; the page cannot say under which terms it is used`);
    packages.set(folder, `${about.name} ${about.version} (${about.license})\n\n`
      + readFileSync(join(here, folder, file), 'utf8').trim());
  }
  return [...packages.values()].sort().join(`\n\n${'-'.repeat(76)}\n\n`) + '\n';
}

/** The files that `output` imports at once, without those that it loads later. */
function importedAtOnce(outputs, output, found = new Set()) {
  for (const { path, kind } of outputs[output].imports) {
    if (kind !== 'import-statement' || found.has(path)) continue;
    found.add(path);
    importedAtOnce(outputs, path, found);
  }
  return [...found];
}

function kilobytes(bytes) {
  return `${(bytes / 1000).toFixed(1)} kB`;
}

/** Writes what popcutd answers as TypeScript: the schemas of openapi.json, to which popcutd adds those of requests. */
async function writeTypes() {
  const { default: openapiTS, astToString } = await import('openapi-typescript');
  const description = JSON.parse(readFileSync(openapi, 'utf8'));
  writeFileSync(join(here, 'src/api.d.ts'), astToString(await openapiTS(description, { arrayLength: true })));
}

/** Bundles the page into `folder`/page; `constants` are added to what its sources are told. Returns what is to be written into index.html. */
export async function bundle(folder, { pictures, constants }) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(join(folder, 'page'), { recursive: true });
  const styles = ['page.css', 'design.css'].filter((name) => existsSync(join(here, name)));
  const { metafile } = await esbuild.build({
    absWorkingDir: here,
    entryPoints: ['src/one_shot.ts', 'src/main.tsx', ...styles],
    outdir: join(folder, 'page'),
    entryNames: '[name]-[hash]',
    chunkNames: '[name]-[hash]',
    bundle: true,
    splitting: true,
    format: 'esm',
    target: 'es2022',
    minify: true,
    legalComments: 'none',
    jsx: 'automatic',
    jsxImportSource: 'preact',
    define: { EXAMPLE_PICTURES: JSON.stringify(writePictures(folder, pictures)), EXAMPLE_GROUPS: JSON.stringify(groups), ...constants },
    metafile: true,
    logLevel: 'warning',
  });

  const outputs = metafile.outputs;
  const byEntry = (entry) => Object.keys(outputs).find((path) => outputs[path].entryPoint === entry);
  const main = byEntry('src/main.tsx');
  const first = byEntry('src/one_shot.ts');
  const early = [...new Set([...importedAtOnce(outputs, first), ...importedAtOnce(outputs, main)])]
    .filter((path) => path !== first && path !== main);
  return { metafile, main, first, early, style: byEntry('page.css'), laterStyles: styles.slice(1).map(byEntry), licences: licences(metafile) };
}

/** Writes `bytes` as page/NAME-HASH.ENDING; returns its name below `folder`. */
export function writeHashed(folder, name, ending, bytes) {
  const file = `page/${name}-${shortHash(bytes)}.${ending}`;
  writeFileSync(join(folder, file), bytes);
  return file;
}

/** Writes index.html; `base` is before all addresses, `more` are lines of its head. */
export function writeIndex(folder, made, base, more = []) {
  const address = (path) => base + inFolder(folder, join(here, path));
  const licenceFile = writeHashed(folder, 'licences', 'txt', made.licences);
  const iconFile = writeHashed(folder, 'icon', 'svg', readFileSync(join(here, 'icon.svg')));
  const index = readFileSync(join(here, 'index.html'), 'utf8').replace('<!-- files -->', [
    ...more,
    `<link rel="stylesheet" href="${address(made.style)}">`,
    ...made.laterStyles.map((path) => `<meta name="later-style" content="${address(path)}">`),
    ...made.early.map((path) => `<link rel="modulepreload" href="${address(path)}">`),
    `<link rel="icon" type="image/svg+xml" href="${base}${iconFile}">`,
    `<link rel="license" href="${base}${licenceFile}">`,
    `<script type="module" src="${address(made.first)}"></script>`,
    `<script type="module" src="${address(made.main)}"></script>`,
  ].join('\n'));
  writeFileSync(join(folder, 'index.html'), index);
}

async function build() {
  const made = await bundle(dist, { pictures: '/', constants: { LOCAL: 'false' } });
  const { metafile: { outputs }, main, first, early } = made;
  writeIndex(dist, made, '/');
  compress();
  writeFileSync(join(dist, 'stamp'), stamp() + '\n');

  const shell = [first, main, ...early, made.style];
  const size = (path) => gzipSync(readFileSync(join(here, path)), { level: 9 }).length;
  const all = Object.keys(outputs).filter((path) => /\.(js|css)$/.test(path));
  for (const path of all) {
    console.log(`${kilobytes(size(path)).padStart(9)}  ${path}${shell.includes(path) ? '  (shell)' : ''}`);
  }
  console.log(`${kilobytes(shell.reduce((sum, path) => sum + size(path), 0)).padStart(9)}  shell, gzip`);
  console.log(`${kilobytes(all.reduce((sum, path) => sum + size(path), 0)).padStart(9)}  all JS and CSS, gzip`);
  const pictures = readdirSync(join(dist, 'page')).filter((name) => name.startsWith('example-') && name.endsWith('.svg'))
    .reduce((sum, name) => sum + size(join('dist/page', name)), 0);
  console.log(`${kilobytes(pictures).padStart(9)}  pictures of the examples, gzip`);
  writeFileSync(join(dist, 'sizes.json'), JSON.stringify({
    shell: shell.map((path) => ({ path: '/' + inFolder(dist, join(here, path)), gzip: size(path) })),
    all: all.map((path) => ({ path: '/' + inFolder(dist, join(here, path)), gzip: size(path), inputs: Object.keys(outputs[path].inputs) })),
  }, null, 1) + '\n');
}

if (process.argv[1] !== fileURLToPath(import.meta.url)) { /* another script takes parts of this one */ }
else if (process.argv.includes('--stamp')) console.log(stamp());
else if (process.argv.includes('--types')) await writeTypes();
else await build();
