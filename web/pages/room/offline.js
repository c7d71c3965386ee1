// SPDX-License-Identifier: MIT
// Keeps this page where its browser can find it without the network, so that a screen that begins anew shows what it waits for.
const WORKER = 'room-worker.js';

/** Only on HTTPS and on the machine itself: elsewhere browsers keep no worker. */
export async function keepShell() {
  if (globalThis.origin === 'null' || !('serviceWorker' in navigator)) return;
  try {
    const trusted = globalThis.trustedTypes?.createPolicy('faccia-room-worker', { createScriptURL: () => WORKER });
    await navigator.serviceWorker.register(trusted?.createScriptURL('') ?? WORKER, { scope: 'room.html' }); // the library's has the rest
  } catch (error) {
    console.info('faccia: the page is not kept for when there is no network:', error.message);
  }
}
