// SPDX-License-Identifier: MIT
// Languages: which one a page is in, which one is spoken first, what they are called. No page needed: tests/web reads this.

/** Languages with lip movements of their own, in the order of the list. */
export const FIRST = ['it', 'pt-BR', 'tr', 'en'];

export const primary = (tag) => tag.split('-')[0].toLowerCase();

/**
 * Chooses the language of a page's texts. @param {readonly string[]} wanted the browser's, best first
 * @param {string[]} known languages of the texts @returns {string}
 */
export function pageLanguage(wanted, known) {
  return wanted.map(primary).find((tag) => known.includes(tag)) ?? 'en';
}

/**
 * Chooses the language to speak first: the first wanted one that is offered, if need be without its last subtags.
 * @param {readonly string[]} wanted the browser's, best first @param {string[]} offered tags
 * @param {string} [usual] default
 */
export function spokenLanguage(wanted, offered, usual = FIRST[0]) {
  const same = (a, b) => a.toLowerCase() === b.toLowerCase();
  for (const tag of wanted) {
    const akin = offered.filter((other) => primary(other) === primary(tag));
    const plain = !tag.includes('-') && akin.find((other) => FIRST.includes(other));
    if (plain) return plain;
    for (let parts = tag.split('-'); parts.length; parts = parts.slice(0, -1)) {
      const found = akin.find((other) => same(other, parts.join('-')));
      if (found) return found;
    }
    const any = akin.find((other) => FIRST.includes(other)) ?? akin[0];
    if (any) return any;
  }
  return offered.find((tag) => same(tag, usual)) ?? offered[0];
}

/** A language in its own words; where the browser does not know them, in those of the page, or its tag. */
export function ownName(tag, page = 'en') {
  for (const names of [tag, page]) {
    try {
      const name = new Intl.DisplayNames([names, page], { type: 'language', languageDisplay: 'standard', fallback: 'none' }).of(tag);
      if (name) return name.replace(/^\p{Ll}/u, (letter) => letter.toLocaleUpperCase(tag));
    } catch {
      // not of BCP 47
    }
  }
  return tag;
}

/** Sorts the languages for a list. @returns {{first: {tag, name}[], others: {tag, name}[]}} the others by name */
export function listed(tags, page = 'en') {
  const all = [...new Set(tags)].map((tag) => ({ tag, name: ownName(tag, page) }));
  const place = ({ tag }) => FIRST.findIndex((other) => other === tag || (!tags.includes(other) && primary(other) === tag));
  const { compare } = new Intl.Collator(page);
  return {
    first: all.filter((l) => place(l) >= 0).sort((a, b) => place(a) - place(b)),
    others: all.filter((l) => place(l) < 0).sort((a, b) => compare(a.name, b.name)),
  };
}

const option = ({ tag, name }) => {
  const element = new Option(name, tag);
  if (name !== tag) element.lang = tag; // a tag that the browser knows
  return element;
};

/** Fills a list to choose from. @param {string} others what the second part of it is called */
export function fill(select, tags, { page, others, chosen }) {
  const { first, others: rest } = listed(tags, page);
  const group = document.createElement('optgroup');
  group.label = others;
  group.append(...rest.map(option));
  select.replaceChildren(...first.map(option), ...(rest.length ? [group] : []));
  if (chosen && tags.includes(chosen)) select.value = chosen;
}
