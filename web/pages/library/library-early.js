// SPDX-License-Identifier: MIT
// Requests and shows the text named in the address before the page's other scripts run.
import { applyLooks, keptLooks } from './looks.js';
import { showText } from './text.js';
import { bearer } from '../shared/bearer.js';
import { forTab } from '../shared/storage.js';

const UNSEEN_MS = 500;
const begun = new Map(); // addresses -> promises of JSON; null: request it again

/** Returns the target of the address: nothing, a work's section, a passage or a line. @returns {string} */
export function named() {
  const hash = location.hash.startsWith('#?') ? '' : location.hash.slice(1); // ignores the fragment that WordPress appends
  try {
    return decodeURIComponent(hash || (new URLSearchParams(location.search).get('at') ?? ''));
  } catch {
    return '';
  }
}

/** @param {string} work @param {string|number} number @returns {string[]} the addresses of the work and of the section */
export function addressesOf(work, number) {
  const address = `v1/library/works/${encodeURIComponent(work)}`;
  return [address, `${address}/sections/${number}`];
}

/** Returns an earlier request for the address, once. @param {string} address @returns {Promise<object|null>} */
export async function take(address) {
  const answer = begun.get(address);
  begun.delete(address);
  return (await answer) ?? null;
}

/** The page's elements exist up to the end of the text. DOMContentLoaded would wait for the other scripts. */
const parsed = new Promise((resolve) => {
  const watch = new MutationObserver(look);
  function look() {
    if (!document.getElementById('next')) return;
    watch.disconnect();
    resolve();
  }
  watch.observe(document, { childList: true, subtree: true });
  look();
});

async function show(answer) {
  const section = await answer;
  await parsed;
  if (!section || document.body.classList.contains('open')) return;
  const passage = document.getElementById('passage');
  applyLooks(passage, keptLooks());
  showText(passage, section);
  document.getElementById('book').hidden = false;
  document.body.classList.add('open');
  document.getElementById(named())?.scrollIntoView({ block: 'center' });
  await new Promise((resolve) => {
    requestAnimationFrame(() => setTimeout(resolve)); // after the first paint
    setTimeout(resolve, UNSEEN_MS); // a hidden page is never painted
  });
}

const query = new URLSearchParams(location.search);
const [work, number] = named().split(':');
if (query.has('embed')) parsed.then(() => document.body.classList.add('embed'));
if (/^\d+$/.test(number) && !query.has('token')) {
  const token = forTab.get('faccia.token');
  const [about, section] = addressesOf(work, number);
  const headers = bearer(token);
  const ask = (address) => fetch(address, { headers }).then((response) => (response.ok ? response.json() : null), () => null);
  begun.set(section, ask(section)); // first what is read
  begun.set(about, ask(about));
  await show(begun.get(section)).catch(() => {}); // the page itself reports the error
}
import('./library.js');
