// A plain server for the page of static files: node serve.mjs FOLDER [PORT]. What it sends beside the files is what
// docs/site.md asks of any server.
import { createReadStream, existsSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, resolve, sep } from 'node:path';
import { fileURLToPath } from 'node:url';

/** What the page may do, and nothing else: its own files, one engine of WebAssembly, workers from its own files. */
export const policy = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; style-src 'self'; img-src 'self' blob:; "
  + "connect-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
  + "require-trusted-types-for 'script'; trusted-types popcut";

const kTypes = {
  '.html': 'text/html; charset=utf-8', '.js': 'text/javascript; charset=utf-8', '.css': 'text/css; charset=utf-8', '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm', '.json': 'application/json', '.txt': 'text/plain; charset=utf-8', '.webmanifest': 'application/manifest+json',
};

/** Serves `folder` at `port` of this computer, 0: any; `plain`: without headers, as the plainest server does. Returns the server. */
export function serve(folder, port = 0, { plain = false } = {}) {
  const root = resolve(folder);
  const server = createServer((request, response) => {
    let file = '';
    try {
      file = join(root, decodeURIComponent(new URL(request.url, 'http://here').pathname));
    } catch {
      // an address that cannot be read names no file
    }
    if (file.endsWith(sep)) file = join(file, 'index.html');
    if (!file.startsWith(root + sep) || !existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    const hashed = /-[0-9A-Z]{8}\.[a-z]+$/.test(file);
    const headers = { 'Content-Type': kTypes[extname(file)] ?? 'application/octet-stream' };
    if (!plain) {
      Object.assign(headers, {
        'Cache-Control': hashed ? 'public, max-age=31536000, immutable' : 'no-cache', 'Content-Security-Policy': policy, 'Cross-Origin-Opener-Policy': 'same-origin-allow-popups',
        'Permissions-Policy': 'usb=(), serial=(), camera=(), microphone=(), geolocation=()', 'Referrer-Policy': 'no-referrer', 'X-Content-Type-Options': 'nosniff',
      });
      const takes = request.headers['accept-encoding'] ?? '';
      for (const [coding, ending] of [['br', '.br'], ['gzip', '.gz']]) {
        if (!takes.includes(coding) || !existsSync(file + ending)) continue;
        headers['Content-Encoding'] = coding;
        headers.Vary = 'Accept-Encoding';
        file += ending;
        break;
      }
    }
    response.writeHead(200, headers);
    createReadStream(file).pipe(response);
  });
  return new Promise((done, failed) => server.once('error', failed).listen(port, '127.0.0.1', () => done(server)));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const server = await serve(process.argv[2], Number(process.argv[3] ?? 8632));
  console.log(`http://localhost:${server.address().port}/`);
}
