// SPDX-License-Identifier: MIT
// Keeps this page for when there is no network (service_worker.js), and says when a newer one is there.
import { newer } from '../backend';
import { module, scriptAt } from './engine';

export async function install(): Promise<void> {
  if (!('serviceWorker' in navigator)) return;
  try {
    // It loads all files once more. Chromium's cache fails where a large one is loaded twice at a time.
    await module().catch(() => undefined);
    // A newer service worker has a newer engine. An open page keeps its own engine, and says that a newer page is ready.
    const first = navigator.serviceWorker.controller === null;
    const registration = await navigator.serviceWorker.register(scriptAt(new URL('service_worker.js', document.baseURI).href), { updateViaCache: 'none' });
    if (registration.waiting && !first) newer.value = true;
    registration.addEventListener('updatefound', () => {
      const fresh = registration.installing;
      fresh?.addEventListener('statechange', () => {
        if (fresh.state === 'installed' && navigator.serviceWorker.controller) newer.value = true;
      });
    });
  } catch {
    // a server without https, or a browser that keeps nothing: the page works while there is a network
  }
}

/** Has the newer page answer from now on. */
export async function takeOver(): Promise<void> {
  const { waiting } = await navigator.serviceWorker.ready;
  if (!waiting) return;
  const taken = new Promise((done) => navigator.serviceWorker.addEventListener('controllerchange', done, { once: true }));
  waiting.postMessage('take-over');
  await taken;
}
