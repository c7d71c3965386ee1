// SPDX-License-Identifier: MIT
// Asks for the text that the address names, and shows it, before the page's other scripts have their turn.
import { applyLooks, keptLooks } from './looks.js';
import { showText } from './text.js';
import { forTab } from '../shared/storage.js';

const UNSEEN_MS = 500;
const begun = new Map(); // addresses -> promises of JSON, or of null: it has to be asked for again

/** What the address names: nothing, a work's section, a passage or a line. @returns {string} */
export function named() {
  const hash = location.hash.startsWith('#?') ? '' : location.hash.slice(1); // what WordPress appends is not for us
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

/** What was asked for already, once. @param {string} address @returns {Promise<object|null>} */
export async function take(address) {
  const answer = begun.get(address);
  begun.delete(address);
  return (await answer) ?? null;
}

/** The page's own elements are there, up to the end of the text. DOMContentLoaded waits for the other scripts. */
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
    requestAnimationFrame(() => setTimeout(resolve)); // it is painted
    setTimeout(resolve, UNSEEN_MS); // nothing is, where nobody sees it
  });
}

const query = new URLSearchParams(location.search);
const [work, number] = named().split(':');
if (query.has('embed')) parsed.then(() => document.body.classList.add('embed'));
if (/^\d+$/.test(number) && !query.has('token')) {
  const token = forTab.get('faccia.token');
  const headers = token ? { authorization: `Bearer ${token}` } : {};
  const [about, section] = addressesOf(work, number);
  const ask = (address) => fetch(address, { headers }).then((response) => (response.ok ? response.json() : null), () => null);
  begun.set(section, ask(section)); // first what is read
  begun.set(about, ask(about));
  await show(begun.get(section)).catch(() => {}); // the page itself says what is wrong
}
import('./library.js');
