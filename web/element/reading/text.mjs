// SPDX-License-Identifier: MIT
// Extracts the text to read from an element of the page, with its language and the position of each character.

const BLOCKS = new Set(`ADDRESS ARTICLE ASIDE BLOCKQUOTE BODY CAPTION DD DETAILS DIV DL DT FIELDSET FIGCAPTION FIGURE FOOTER FORM H1 H2 H3 H4 H5 H6
  HEADER HGROUP HR LI MAIN NAV OL P PRE SEARCH SECTION SUMMARY TABLE TBODY TD TFOOT TH THEAD TR UL`.split(/\s+/));
const SILENT = `script, style, template, noscript, iframe, object, audio, video, canvas, svg, math, input, select, textarea, button, rt, rp,
  talking-head, [hidden], [aria-hidden="true"], [data-unread], [role~="doc-noteref"], [role~="doc-footnote"], [role~="doc-endnote"],
  [role~="doc-endnotes"], [role~="note"], [role~="doc-pagebreak"]`;
const LONGEST = 600; // characters of one request

/** An aside in a speech, such as a stage direction: it counts in the places of a passage, but is not read. */
const ASIDE = '[data-aside]';

/**
 * @typedef {Object} Stretch text of one language and one speaker that no block interrupts
 * @property {string} text white space as single spaces
 * @property {string} lang of the nearest `lang` attribute; empty: of none
 * @property {string} [speaker] of the nearest `data-speaker` attribute; empty: the narrator
 * @property {{node: Text, offset: number}[]} at where each character stands
 */

/** @param {Element} element @returns {string} */
export const languageOf = (element) => element.closest('[lang]')?.getAttribute('lang') ?? '';

/** Whether it is left out: what is not text, not for the ear, not shown, or a note's number. */
const unread = (element) =>
  element.matches(SILENT) ||
  element.checkVisibility?.() === false ||
  (element.tagName === 'SUP' && element.firstElementChild?.matches('a[href^="#"]'));

/**
 * @param {Element} root @param {{asides?: boolean}} [options] asides: they are kept
 * @returns {Stretch[]} in the order of the text
 */
export function stretchesOf(root, { asides = true } = {}) {
  const found = [];
  let open = null;
  const close = () => {
    if (open?.text.trim()) found.push(open);
    open = null;
  };
  const add = (node, lang, speaker) => {
    if (open && (open.lang !== lang || open.speaker !== speaker) && /\S/.test(node.data)) close();
    open ??= { text: '', lang, speaker, at: [] };
    for (let offset = 0; offset < node.data.length; offset++) {
      const sign = node.data[offset];
      const blank = /\s/.test(sign);
      if (/[\u00AD\u200B]/.test(sign) || (blank && /(^|\s)$/.test(open.text))) continue; // a place to break is not said
      open.text += blank ? ' ' : sign;
      open.at.push({ node, offset });
    }
  };
  const walk = (element, lang, speaker) => {
    const block = BLOCKS.has(element.tagName);
    if (block) close();
    for (const child of element.childNodes) {
      if (child.nodeType === 3) add(child, lang, speaker);
      else if (child.nodeType !== 1 || unread(child)) continue;
      else if (child.tagName === 'BR') space();
      else if (!asides && child.matches(ASIDE)) space();
      else walk(child, child.getAttribute('lang') ?? lang, child.getAttribute('data-speaker') ?? speaker);
    }
    if (block) close();
    else if (element.hasAttribute('data-line')) space();
  };
  /** A line ends, the sentence does not. */
  const space = () => {
    if (!open || /(^|\s)$/.test(open.text)) return;
    open.text += ' ';
    open.at.push(open.at.at(-1));
  };
  walk(root, languageOf(root), root.closest('[data-speaker]')?.getAttribute('data-speaker') ?? undefined);
  close();
  return found;
}

/** Finds the bounds of sentences. @param {string} text @param {string} lang @returns {[number, number][]} */
export function sentencesIn(text, lang) {
  const cuts = [];
  try {
    const segmenter = new Intl.Segmenter(lang || undefined, { granularity: 'sentence' });
    for (const { index, segment } of segmenter.segment(text)) cuts.push([index, index + segment.length]);
  } catch {
    const plain = /[^.!?…]+(?:[.!?…]+["'»”’)\]]*\s*|$)|[.!?…]+\s*/g;
    for (const { 0: all, index } of text.matchAll(plain)) cuts.push([index, index + all.length]);
  }
  return cuts.flatMap((cut) => shorter(text, cut));
}

/** Splits a long sentence into pieces. */
function shorter(text, [start, end]) {
  const pieces = [];
  while (end - start > LONGEST) {
    const window = text.slice(start, start + LONGEST);
    const clause = /^[^]*[,;:](?=\s)/.exec(window)?.[0].length ?? 0;
    const word = window.search(/\s\S*$/);
    const size = clause > LONGEST / 2 ? clause : word > 0 ? word : LONGEST;
    pieces.push([start, start + size]);
    start += size;
  }
  return [...pieces, [start, end]];
}

const ESCAPES = { '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' };
const escape = (text) => text.replace(/[&<>"]/g, (sign) => ESCAPES[sign]);

/**
 * @typedef {Object} Piece what one request says
 * @property {string} text @property {string} lang @property {{node: Text, offset: number}[]} at
 * @property {number[]} words where in the text one can begin
 * @property {string} [speaker] who says it
 * @property {string} [passage] of the library, instead of the text
 */

/**
 * Returns the passages with an id of the server's library (`data-passage`), which may have a recording.
 * @param {Element} root @returns {Piece[]}
 */
export function passagesOf(root) {
  return [...root.querySelectorAll('[data-passage]')].flatMap((element) => {
    const stretches = stretchesOf(element);
    const text = stretches.map((stretch) => stretch.text).join('').trimEnd();
    const words = [...text.matchAll(/\S+/g)].map(({ index }) => index);
    if (!words.length) return [];
    const at = stretches.flatMap((stretch) => stretch.at).slice(0, text.length);
    return [{ text, lang: languageOf(element), at, words, passage: element.dataset.passage }];
  });
}

/** @param {Element} root @returns {Piece[]} */
export function piecesOf(root) {
  return stretchesOf(root, { asides: false }).flatMap(({ text, lang, speaker, at }) =>
    sentencesIn(text, lang).flatMap(([start, end]) => {
      const said = text.slice(start, end).trimEnd();
      if (!/[\p{L}\p{N}]/u.test(said)) return [];
      return [{ text: said, lang, speaker, at: at.slice(start, start + said.length), words: wordsIn(said) }];
    }),
  );
}

/** Finds the starts of words, except beside figures, which may belong together (dates, sums). */
function wordsIn(text) {
  const words = [];
  let figure = false;
  for (const match of text.matchAll(/\S+/g)) {
    const now = /\p{N}/u.test(match[0]);
    if (!words.length || (!now && !figure)) words.push(match.index);
    figure = now;
  }
  return words;
}

/**
 * The text as SSML with a mark, called by its place, where one can begin.
 * @param {Piece} piece @param {string} name what the marks' names begin with @returns {string}
 */
export function markedUp({ text, words }, name) {
  const parts = words.map((start, i) => {
    const to = words[i + 1] ?? text.length;
    return `<mark name="${name}-${start}"/>${escape(text.slice(start, to))}`;
  });
  return `<speak>${escape(text.slice(0, words[0] ?? text.length))}${parts.join('')}</speak>`;
}

/** From one character to another (exclusive), on the page. @param {Piece} piece @param {number} start @param {number} end */
export function rangeOf({ at }, start, end) {
  const [first, last] = [at[Math.min(start, at.length - 1)], at[Math.min(Math.max(end, start + 1), at.length) - 1]];
  const range = first.node.ownerDocument.createRange();
  range.setStart(first.node, Math.min(first.offset, first.node.length));
  range.setEnd(last.node, Math.min(last.offset + 1, last.node.length));
  return range;
}

/**
 * Finds the word at a position of the page, or the next one at which reading can start.
 * @param {Piece[]} pieces @param {Node} node @param {number} offset
 * @returns {{index: number, start: number}|null} the piece, and the offset in it
 */
export function findPlace(pieces, node, offset) {
  for (const [index, piece] of pieces.entries()) {
    const last = piece.at.at(-1);
    if (before(last.node, last.offset, node, offset)) continue;
    let start = piece.words[0] ?? 0;
    for (const word of piece.words) if (!before(node, offset, piece.at[word].node, piece.at[word].offset)) start = word;
    return { index, start };
  }
  return null;
}

/** Whether the first place lies before the other. */
function before(a, i, b, j) {
  if (a === b) return i < j;
  if (b.contains?.(a) || a.contains?.(b)) {
    const place = (node, offset) => (node.nodeType === 3 ? [node, offset] : [node.childNodes[offset] ?? node, 0]);
    [[a, i], [b, j]] = [place(a, i), place(b, j)];
    if (a === b) return i < j;
  }
  return Boolean(a.compareDocumentPosition(b) & 4);
}
