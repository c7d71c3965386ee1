// SPDX-License-Identifier: MIT
// Typesets a section of the library. Passages and lines keep their ids, so that links and the voice find them.

const make = (name, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
};

/** Whether an element of the text is not spoken. */
const unread = (element) => {
  element.setAttribute('data-unread', '');
  return element;
};

function noteMark(note, number) {
  const link = make('a', { className: 'note-mark', href: `#${note}`, id: `${note}:mark` }, number);
  link.setAttribute('role', 'doc-noteref');
  return link;
}

const pageMark = (n) => {
  const mark = unread(make('span', { className: 'page' }, n));
  mark.ariaHidden = 'true';
  return mark;
};

/** Maximum depth of nested marks that are drawn. */
const MARKS_OPEN_MAX = 16;
/** Elements of marks. A stage direction counts in text positions, although it is not spoken. */
const MARKS = { emphasis: 'em', foreign: 'i' };

/** Returns a range of a block's text with its marks. @param {object} block @param {number} from @param {number} to */
function inline(block, from, to, signs) {
  const parts = document.createDocumentFragment();
  const within = (block.marks ?? []).filter(({ start, end }) => start >= from && end <= to);
  const said = (block.speeches ?? []).filter(({ start, end }) => start >= from && end <= to).map((speech) => ({ ...speech, kind: 'speech' }));
  const marks = [...within, ...said].sort((a, b) => a.start - b.start || b.end - a.end);
  const piece = (start, end, rest, depth) => {
    const here = document.createDocumentFragment();
    let at = start;
    while (rest.length) {
      const mark = rest.shift();
      const point = mark.kind === 'note' || mark.kind === 'page';
      if (mark.start < at || (!point && depth === MARKS_OPEN_MAX)) continue; // crosses another mark, or is nested too deeply
      here.append(block.text.slice(at, mark.start));
      at = Math.min(mark.end, end);
      if (mark.kind === 'note') here.append(noteMark(mark.note, signs.get(mark.note) ?? '*'));
      else if (mark.kind === 'page') here.append(pageMark(mark.n));
      else {
        const inner = [];
        while (rest.length && rest[0].start < at) inner.push(rest.shift());
        const element = make(MARKS[mark.kind] ?? 'span', {}, piece(mark.start, at, inner, depth + 1));
        if (mark.lang) element.lang = mark.lang;
        if (mark.kind === 'speech') element.dataset.who = mark.who;
        if (mark.kind === 'stage') {
          element.className = 'stage';
          element.setAttribute('data-aside', '');
          element.setAttribute('data-speaker', '');
        }
        here.append(element);
      }
    }
    here.append(block.text.slice(at, end));
    return here;
  };
  parts.append(piece(from, to, marks, 0));
  return parts;
}

function verse(block, signs) {
  const lines = block.lines.map((line) => {
    const element = make('span', { className: 'line', id: line.id }, inline(block, line.start, line.end, signs));
    element.setAttribute('data-line', '');
    if (line.n) element.dataset.n = line.n;
    if (Number(line.n) % 5 === 0) element.classList.add('numbered');
    if (line.indent) element.classList.add('set-in');
    return element;
  });
  return make('p', { className: 'verse' }, ...lines);
}

const HEADS = ['h2', 'h3', 'h4', 'h5'];

/** @param {number} above levels of headings above the section: on this page its own headings are the first */
function element(block, signs, above) {
  const { kind } = block;
  if (kind === 'page') return pageMark(block.n);
  if (kind === 'speaker') return unread(make('p', { className: 'speaker' }, block.text));
  if (kind === 'stage') return unread(make('p', { className: 'stage' }, block.text));
  if (kind === 'verse') return verse(block, signs);
  const whole = inline(block, 0, block.text.length, signs);
  if (kind === 'head') return make(HEADS[Math.min(Math.max(1, (block.level ?? 1) - above), HEADS.length) - 1], {}, whole);
  if (kind === 'note') {
    const back = make('a', { href: `#${block.id}:mark`, className: 'note-sign' }, block.n ?? '*');
    const note = make('p', { className: 'note' }, unread(back), ' ', whole);
    note.setAttribute('role', 'note');
    return note;
  }
  return make('p', { className: block.item ? 'item' : 'prose' }, whole);
}

/**
 * Shows the text of a section, unless it is shown already. @param {HTMLElement} passage
 * @param {{id: string, blocks: object[], work: {lang: string}}} section
 */
export function showText(passage, section) {
  if (passage.dataset.section === section.id) return;
  passage.dataset.section = section.id;
  passage.lang = section.work.lang;
  passage.replaceChildren(...setText(section));
}

/** @returns {HTMLElement[]} */
function setText({ blocks, work }) {
  const signs = new Map(blocks.filter(({ kind }) => kind === 'note').map(({ id, n }, i) => [id, n ?? String(i + 1)]));
  const above = (blocks.find(({ kind }) => kind === 'head')?.level ?? 1) - 1;
  return blocks.map((block) => {
    const set = element(block, signs, above);
    if (block.id) set.id = block.id;
    if (block.id && block.kind !== 'note') set.dataset.passage = block.id;
    if (block.lang && block.lang !== work.lang) set.lang = block.lang;
    if (block.who) set.dataset.speaker = block.who;
    if (block.affect) set.dataset.affect = block.affect;
    return set;
  });
}

/** Returns a text with marked ranges. @param {string} text @param {[number, number][]} marks */
export function marked(text, marks) {
  const parts = [];
  let at = 0;
  for (const [start, end] of marks) {
    parts.push(text.slice(at, start), make('mark', {}, text.slice(start, end)));
    at = end;
  }
  return [...parts, text.slice(at)];
}

const said = (node) =>
  node.nodeType === 1 && node.matches('[data-unread], [role="doc-noteref"]') ? NodeFilter.FILTER_REJECT : NodeFilter.FILTER_ACCEPT;

/** Makes the DOM range of characters of a passage. @param {HTMLElement} passage @param {number} start @param {number} end */
export function rangeIn(passage, start, end) {
  const walker = document.createTreeWalker(passage, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT, said);
  const range = document.createRange();
  let done = 0;
  let line = null;
  let last = null; // text of the range so far
  while (walker.nextNode()) {
    const { currentNode: node } = walker;
    if (node.nodeType === 1) {
      if (node.hasAttribute('data-line')) {
        if (line) done++; // the newline between them
        line = node;
      }
      continue;
    }
    const next = done + node.length;
    if (last && end <= done) break; // it ends with the newline
    if (!last && start < next) range.setStart(node, Math.max(0, start - done));
    if (start < next) last = node;
    if (end <= next) {
      range.setEnd(node, end - done);
      return range;
    }
    done = next;
  }
  if (last) range.setEnd(last, last.length);
  return last && range;
}
