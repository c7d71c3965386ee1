// SPDX-License-Identifier: MIT

const NAMED = { amp: '&', lt: '<', gt: '>', quot: '"', apos: "'" };
const SILENT = /^(?:desc|metadata|lexicon|info)$/i; // elements whose content is not said
/** Markdown's marks, and emoji: they are not spoken. */
const MARKS = /^[#>]+ *|^[-*+] +|\*+|`+|~~|\p{Extended_Pictographic}[\u200D\uFE0F\p{Emoji_Modifier}]*/gmu;
const TOKEN = new RegExp(
  [
    /<!--[^]*?-->/,
    /<!\[CDATA\[([^]*?)\]\]>/,
    /<\?[^]*?\?>/,
    /<!DOCTYPE(?:[^[>]|\[[^]*?\])*>/,
    /<(\/?)([\w.:-]+)((?:[^<>"']|"[^"]*"|'[^']*')*)>/,
    /&(#?\w+);/,
    /\s+/,
  ]
    .map(({ source }) => source)
    .join('|'),
  'gi',
);

function reference(name) {
  if (name[0] !== '#') return NAMED[name] ?? '';
  const code = /^#x/i.test(name) ? parseInt(name.slice(2), 16) : parseInt(name.slice(1), 10);
  return code > 0 && code <= 0x10ffff ? String.fromCodePoint(code) : '';
}

/**
 * A marked-up text for reading: without tags, with references resolved and white space collapsed. It keeps the source
 * position of each character, so that positions can be mapped both ways.
 */
export class PlainText {
  /**
   * @param {string} source
   * @param {string} [markup] what the source is; of 'plain' nothing is changed; 'markdown': plain as models write it
   */
  constructor(source, markup = 'plain') {
    this.text = '';
    this.from = []; // of each character, its place in the source; null: the same place
    if (markup === 'plain') {
      this.text = source;
      this.from = null;
    } else if (markup === 'markdown') {
      this.#readMarkdown(source);
    } else {
      this.#read(source);
    }
  }

  /** @param {number} place in the source @returns {number} the first character that does not lie before it */
  at(place) {
    if (!this.from) return place;
    let [low, high] = [0, this.from.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.from[middle] < place) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Leaves out the same Markdown as the server does. */
  #readMarkdown(source) {
    let done = 0;
    for (const { 0: mark, index } of source.matchAll(MARKS)) {
      this.#add(source.slice(done, index), done);
      done = index + mark.length;
    }
    this.#add(source.slice(done), done);
  }

  #read(source) {
    let done = 0;
    let silent = null; // the element that is passed over, and how deep it lies in itself
    for (const match of source.matchAll(TOKEN)) {
      const [all, cdata, closes, name, attributes, entity] = match;
      if (!silent) this.#add(source.slice(done, match.index), done);
      done = match.index + all.length;
      if (name !== undefined) {
        const local = name.replace(/^.*:/, '');
        if (silent && silent.name === local) silent.depth += closes ? -1 : attributes.endsWith('/') ? 0 : 1;
        else if (!silent && !closes && !attributes.endsWith('/') && SILENT.test(local)) silent = { name: local, depth: 1 };
        if (silent?.depth === 0) silent = null;
      } else if (silent) {
        continue;
      } else if (cdata !== undefined) {
        this.#add(cdata, match.index + '<![CDATA['.length);
      } else if (entity !== undefined) {
        this.#add(reference(entity), match.index, 0);
      } else if (/^\s/.test(all) && !/(^|\s)$/.test(this.text)) {
        this.#add(' ', match.index);
      }
    }
    if (!silent) this.#add(source.slice(done), done);
  }

  #add(text, from, step = 1) {
    for (let i = 0; i < text.length; i++) this.from.push(from + i * step);
    this.text += text;
  }
}
