// SPDX-License-Identifier: MIT
// Shows how far a recording is aligned to its text, and where they differ: words missing from the recording, and words
// missing from the text.
import { rangeIn } from './text.js';

const AGAIN_MS = 4000; // polling interval while alignment runs; the browser sends the ETag
const LISTED = 40;
const SNIPPET = 60; // characters
const $ = (id) => document.getElementById(id);

const make = (name, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
};

/** For screen readers; the head does not read it. */
function aside(text) {
  const words = make('span', { className: 'hidden' }, text);
  words.setAttribute('data-unread', '');
  return words;
}

/** Wraps the text of a range in elements. @param {Range} range @returns {HTMLElement[]} */
function wrapped(range, className) {
  const { commonAncestorContainer: root } = range;
  const nodes = root.nodeType === 3 ? [root] : [];
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) if (range.intersectsNode(walker.currentNode)) nodes.push(walker.currentNode);
  const { startContainer, startOffset, endContainer, endOffset } = range;
  return nodes.flatMap((node) => {
    const end = node === endContainer ? endOffset : node.length;
    const start = node === startContainer ? startOffset : 0;
    if (start >= end || node.parentElement.closest('[data-unread]')) return [];
    const piece = node.splitText(start);
    piece.splitText(end - start);
    const element = make('span', { className });
    piece.replaceWith(element);
    element.append(piece);
    return [element];
  });
}

export class Recording {
  #timer = 0;
  #address = '';
  #section = null;
  #late = null; // marks to add when reading has ended

  /**
   * @param {HTMLElement} passage
   * @param {object} ports say(name, values); load(address) -> Promise of JSON; busy(): whether the text is being read;
   *   recorded(): whether she
   *   would read by the recording; hear(text, lang) -> Promise: by another voice
   */
  constructor(passage, ports) {
    Object.assign(this, { passage, ports });
    passage.addEventListener('click', (event) => this.#clicked(event), { capture: true });
  }

  /** @param {object} section section whose text was just set @param {string} address its address */
  show(section, address) {
    clearTimeout(this.#timer);
    this.#address = address;
    this.#section = section;
    this.#late = null;
    $('recording-lacks').replaceChildren();
    this.#tell(section.recording);
  }

  /** Reading has ended, so the text may be changed. */
  settle() {
    if (this.#late) this.#mark(this.#late);
  }

  /** Updates the texts when the page's language changes. */
  translate() {
    if (this.#section) this.#state(this.#section.recording);
  }

  #tell(recording) {
    this.#section.recording = recording;
    this.#state(recording);
    if (recording?.state === 'aligned') {
      if (this.ports.busy()) this.#late = recording;
      else this.#mark(recording);
    } else if (recording && recording.state !== 'failed') this.#timer = setTimeout(() => this.#look(), AGAIN_MS);
  }

  async #look() {
    const section = this.#section;
    const now = document.hidden ? section : await this.ports.load(this.#address).catch(() => section);
    if (section === this.#section) this.#tell(now.recording);
  }

  #state(recording) {
    const { say } = this.ports;
    const { state, share = 0, why = '' } = recording ?? {};
    const name = { waiting: 'alignWaits', stale: 'alignWaits', aligning: 'aligning', failed: 'alignFailed' }[state];
    const text = name ? say(name, { why }) : '';
    if ($('recording-state').textContent !== text) $('recording-state').textContent = text;
    $('recording-share').hidden = state !== 'aligning';
    $('recording-share').value = share;
    $('recording-differs').hidden = state !== 'aligned' || !(recording.unread?.length || recording.unwritten?.length);
    $('recording').hidden = !text && $('recording-differs').hidden;
  }

  #mark({ unread = [], unwritten = [] }) {
    this.#late = null;
    const items = [...unread.map((one) => this.#unread(one)), ...unwritten.map((one) => this.#unwritten(one))].filter(Boolean);
    items.sort((a, b) => (a.place.compareDocumentPosition(b.place) & 4 ? -1 : 1));
    $('recording-lacks').replaceChildren(...items.slice(0, LISTED).map(({ item }) => item));
    if (items.length > LISTED) $('recording-lacks').append(make('li', {}, '…'));
  }

  #link(id, text) {
    return make('a', { href: `#${id}` }, text);
  }

  #unread({ passage: id, start, end, confidence }) {
    const block = document.getElementById(id);
    const range = block && rangeIn(block, start, end);
    if (!range) return null;
    const { say } = this.ports;
    const text = this.#section.blocks.find((one) => one.id === id).text.slice(start, end).replace(/\s+/g, ' ').trim();
    const parts = wrapped(range, confidence ? 'unheard doubtful' : 'unheard');
    if (!parts.length) return null;
    const words = say(confidence ? 'perhapsUnheard' : 'unheard');
    parts[0].prepend(aside(`[${words}] `));
    const line = parts[0].closest('.line')?.id ?? id;
    const button = make('button', { type: 'button', textContent: say('hearIt'), ariaLabel: `${say('hearIt')}: ${text}` });
    const lang = parts[0].closest('[lang]').lang;
    const heard = async () => {
      parts.forEach((part) => part.classList.add('now'));
      await this.ports.hear(text, lang);
      parts.forEach((part) => part.classList.remove('now'));
    };
    button.addEventListener('click', heard);
    parts.forEach((part) => (part.heard = heard));
    const snippet = text.length > SNIPPET ? `${text.slice(0, SNIPPET)}…` : text;
    return { place: parts[0], item: make('li', {}, make('span', {}, this.#link(line, snippet), ` (${words})`), button) };
  }

  #unwritten({ passage: id, at, seconds }) {
    const block = document.getElementById(id);
    const range = block && (rangeIn(block, at, at + 1) ?? rangeIn(block, Math.max(0, at - 1), at));
    if (!range) return null;
    const text = this.ports.say('unwritten', { n: Math.round(seconds) });
    const mark = make('span', { className: 'unwritten', title: text }, aside(`[${text}] `));
    mark.setAttribute('data-unread', '');
    range.insertNode(mark);
    const line = mark.closest('.line')?.id ?? id;
    return { place: mark, item: make('li', {}, this.#link(line, text)) };
  }

  /** Speaks text missing from the recording by another voice when it is clicked. */
  #clicked(event) {
    const part = event.target.closest('.unheard');
    if (!part || this.ports.busy() || !this.ports.recorded() || !getSelection().isCollapsed) return;
    event.stopPropagation();
    part.heard();
  }
}
