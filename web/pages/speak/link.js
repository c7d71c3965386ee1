// SPDX-License-Identifier: MIT
// A link to the first page with what it is to say. No page needed: tests/web reads this.

export const RATE = { least: 80, most: 240, usual: 150 };
const MARKUPS = ['auto', 'plain', 'ssml', 'apml', 'jsml', 'emotionml'];

/** @param {string} search of an address @returns {object} what it asks for; what it does not is left out */
export function readLink(search) {
  const query = new URLSearchParams(search);
  const wish = {};
  for (const name of ['text', 'lang', 'voice', 'room']) if (query.get(name)) wish[name] = query.get(name);
  const rate = Number(query.get('rate'));
  if (rate > 0) wish.rate = Math.min(RATE.most, Math.max(RATE.least, rate));
  if (MARKUPS.includes(query.get('markup'))) wish.markup = query.get('markup');
  if (query.has('captions')) wish.captions = query.get('captions') !== 'off';
  return wish;
}

/** @param {string} page its address @param {object} state as readLink gives it @returns {string} never with a token */
export function makeLink(page, { text, lang, voice, rate, markup, room, captions }) {
  const address = new URL(page);
  address.search = address.hash = '';
  const set = (name, value) => value && address.searchParams.set(name, value);
  set('text', text);
  set('lang', lang);
  set('voice', voice);
  set('rate', rate === RATE.usual ? '' : rate);
  set('markup', markup === 'auto' ? '' : markup);
  set('room', room);
  set('captions', captions === false ? 'off' : '');
  return address.href;
}
