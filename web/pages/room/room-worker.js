// SPDX-License-Identifier: MIT
// The service worker of a room's page. It fetches the page, and answers from its cache only when the network fails. Each
// version has a cache of its own, filled when this file (which contains the version) changes: versions are never mixed.
const SHELL = 'faccia-room-';
const VERSION = '@version@'; // build.mjs puts it here, and the page's files
const FILES = ['@files@'];

self.addEventListener('install', (event) => {
  const fresh = FILES.map((file) => new self.Request(file, { cache: 'reload' }));
  event.waitUntil(
    caches
      .open(SHELL + VERSION)
      .then((cache) => cache.addAll(fresh))
      .then(() => self.skipWaiting()),
  );
});

self.addEventListener('activate', (event) => {
  const old = (name) => name.startsWith(SHELL) && name !== SHELL + VERSION;
  const clear = async () => {
    for (const name of await caches.keys()) if (old(name)) await caches.delete(name);
    await self.clients.claim();
  };
  event.waitUntil(clear());
});

async function answer(request) {
  try {
    return await fetch(request);
  } catch (error) {
    const cache = await caches.open(SHELL + VERSION);
    const kept = await cache.match(request, { ignoreSearch: true });
    if (kept) return kept;
    throw error;
  }
}

self.addEventListener('fetch', (event) => {
  const { request } = event;
  const { origin, pathname } = new URL(request.url);
  if (request.method !== 'GET' || origin !== self.location.origin) return;
  if (FILES.includes(pathname.slice(new URL('./', self.location).pathname.length))) event.respondWith(answer(request));
});
