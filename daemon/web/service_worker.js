// Keeps the whole page, so that it opens without a network. VERSION and FILES are written by site.mjs. Each version of
// the page has a cache of its own, so a page never gets an engine of another one.
const kCache = 'popcut-VERSION';
const kFiles = FILES;

self.addEventListener('install', (event) => {
  const fill = async () => {
    const cache = await caches.open(kCache);
    await Promise.all(kFiles.map((file) => cache.add(new Request(file, { cache: file.startsWith('./') ? 'reload' : 'default' }))
      .catch(() => cache.add(new Request(file, { cache: 'reload' })))));
  };
  event.waitUntil(fill());
});

// A waiting version begins once no page of the old one is open; then nobody needs the old cache.
self.addEventListener('activate', (event) => {
  const clean = async () => {
    for (const name of await caches.keys()) {
      if (name.startsWith('popcut-') && name !== kCache) await caches.delete(name);
    }
    await self.clients.claim();
  };
  event.waitUntil(clean());
});

// A reload is what a person presses where a newer page is ready.
self.addEventListener('message', (event) => {
  if (event.data === 'take-over') void self.skipWaiting();
});

self.addEventListener('fetch', (event) => {
  const { request } = event;
  const url = new URL(request.url);
  if (request.method !== 'GET' || url.origin !== self.location.origin) return;
  const find = async () => {
    const cache = await caches.open(kCache);
    const kept = await cache.match(request.mode === 'navigate' ? './' : request, { ignoreSearch: request.mode === 'navigate' });
    return kept ?? fetch(request);
  };
  event.respondWith(find());
});
