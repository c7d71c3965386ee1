// SPDX-License-Identifier: MIT
// The service worker of the library: caches its page, the texts that were read, and speech saved by the user, for use offline.
const PAGE = 'faccia-page';
const WORKS = 'faccia-works';
const SPEECH = 'faccia-speech';
const FILES = 'library.html library.js library-early.js library.css page.css icon.svg talking-head.js talking-head-worklet.js opus-decoder.js'.split(' ');

self.addEventListener('install', (event) => {
  event.waitUntil(
    caches
      .open(PAGE)
      .then((cache) => cache.addAll(FILES))
      .then(() => self.skipWaiting()),
  );
});

self.addEventListener('activate', (event) => event.waitUntil(self.clients.claim()));

/** Returns the name of the cache for a request; null: not cached. */
function placeOf({ pathname, searchParams }) {
  const path = pathname.slice(new URL(self.registration.scope).pathname.length);
  if (path.startsWith('v1/library') && !path.endsWith('/search')) return WORKS;
  if (path === 'v1/speech' && searchParams.has('passage')) return SPEECH;
  if (path === 'v1/voices') return WORKS;
  return FILES.includes(path) ? PAGE : null;
}

async function answer(request, place) {
  const cache = await caches.open(place);
  if (place === SPEECH) return (await cache.match(request)) ?? fetch(request); // it does not change
  try {
    const fresh = await fetch(request);
    if (fresh.ok) await cache.put(request, fresh.clone());
    return fresh;
  } catch (error) {
    const kept = await cache.match(request, { ignoreSearch: place === PAGE });
    if (kept) return kept;
    throw error;
  }
}

self.addEventListener('fetch', (event) => {
  const { request } = event;
  const url = new URL(request.url);
  if (request.method !== 'GET' || url.origin !== self.location.origin) return;
  const place = placeOf(url);
  if (place) event.respondWith(answer(request, place));
});
