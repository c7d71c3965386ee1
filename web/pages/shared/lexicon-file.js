// SPDX-License-Identifier: MIT
// Lexicons of pronunciations (W3C PLS) as an editor writes them.

const PLS = 'http://www.w3.org/2005/01/pronunciation-lexicon';
const ESCAPES = { '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' };
const escape = (text) => text.replace(/[&<>"]/g, (sign) => ESCAPES[sign]);
const collapsed = (text) => text.trim().replace(/\s+/g, ' ');
const primary = (tag) => tag.split('-')[0].toLowerCase();

// Trusted Types: the pages parse text only through a policy. This one is for XML, which is inert and never shown.
const inert = globalThis.trustedTypes?.createPolicy('faccia-lexicon', { createHTML: (xml) => xml });

/**
 * Pronunciation of a word. @typedef {object} Entry @property {string} word @property {string} [alias] a text spoken instead
 * @property
 * {string} [ipa]
 */

const saying = ({ alias, ipa }) => (ipa === undefined ? `<alias>${escape(alias)}</alias>` : `<phoneme>${escape(ipa)}</phoneme>`);

/** @param {string} lang @param {Entry[]} entries @returns {string} a whole lexicon */
export function lexiconOf(lang, entries) {
  const lexemes = entries.map((entry) => `  <lexeme><grapheme>${escape(collapsed(entry.word))}</grapheme>${saying(entry)}</lexeme>\n`);
  return `<?xml version="1.0" encoding="UTF-8"?>\n<lexicon version="1.0" xmlns="${PLS}" alphabet="ipa" xml:lang="${escape(lang)}">\n${lexemes.join('')}</lexicon>\n`;
}

/**
 * Adds an entry to a lexicon; what the lexicon says of the same word goes. The rest of the file stays as it is.
 * @param {string} text @param {string} lang of the word @param {Entry} entry @returns {string}
 * @throws {{code: string, lang?: string}} `other-language`, `bad-xml`
 */
export function withEntry(text, lang, entry) {
  const document = new globalThis.DOMParser().parseFromString(inert ? inert.createHTML(text) : text, 'application/xml');
  const root = document.documentElement;
  if (document.querySelector('parsererror') || root.localName !== 'lexicon') throw { code: 'bad-xml' };
  const own = root.getAttribute('xml:lang') ?? '';
  if (primary(own) !== primary(lang)) throw { code: 'other-language', lang: own };
  for (const grapheme of [...root.getElementsByTagNameNS('*', 'grapheme')].filter((each) => collapsed(each.textContent) === collapsed(entry.word))) {
    const lexeme = grapheme.parentNode;
    grapheme.remove();
    if (lexeme.getElementsByTagNameNS('*', 'grapheme').length) continue; // other spellings stay
    if (/^\s*$/.test(lexeme.previousSibling?.data ?? 'x')) lexeme.previousSibling.remove();
    lexeme.remove();
  }
  const make = (name, content) => Object.assign(document.createElementNS(root.namespaceURI, name), { textContent: content });
  const lexeme = make('lexeme', '');
  const said = entry.ipa === undefined ? make('alias', entry.alias) : make('phoneme', entry.ipa);
  if (entry.ipa !== undefined && root.getAttribute('alphabet') !== 'ipa') said.setAttribute('alphabet', 'ipa');
  lexeme.append(make('grapheme', collapsed(entry.word)), said);
  if (/\n\s*$/.test(root.lastChild?.data ?? '')) root.lastChild.remove();
  root.append('\n  ', lexeme, '\n');
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new globalThis.XMLSerializer().serializeToString(root)}\n`;
}
