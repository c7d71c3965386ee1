// SPDX-License-Identifier: MIT
// The server's voices, by language. No page needed: tests/web reads this.
import { primary } from './languages.js';

/**
 * Lists the voices for a language: those of the exact tag first, then those of its other varieties.
 * @param {{id: string, name: string, lang: string}[]} voices @param {string} tag @returns {{lang: string, voices: object[]}[]}
 */
export function voicesOf(voices, tag) {
  const groups = new Map();
  for (const voice of voices.filter(({ lang }) => primary(lang) === primary(tag))) {
    if (!groups.has(voice.lang)) groups.set(voice.lang, []);
    groups.get(voice.lang).push(voice);
  }
  const rank = (lang) => (lang.toLowerCase() === tag.toLowerCase() ? 0 : 1);
  return [...groups].map(([lang, list]) => ({ lang, voices: list })).sort((a, b) => rank(a.lang) - rank(b.lang));
}

/** Fills a list to choose from. @param {object} words automatic, male, female; nameOf(tag) */
export function fillVoices(select, voices, tag, { automatic, male, female, nameOf }) {
  const chosen = select.value;
  const sex = { male, female };
  const option = ({ id, name, gender }) => new Option(sex[gender] ? `${name} (${sex[gender]})` : name, id);
  const groups = voicesOf(voices, tag).map(({ lang, voices: list }) => {
    const group = document.createElement('optgroup');
    group.label = nameOf(lang);
    group.append(...list.map(option));
    return group;
  });
  select.replaceChildren(new Option(automatic, ''), ...groups);
  select.value = chosen;
  if (select.selectedIndex < 0) select.value = '';
}
