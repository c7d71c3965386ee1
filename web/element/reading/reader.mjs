// SPDX-License-Identifier: MIT
import { PlainText } from '../captions/plain-text.mjs';
import { Follow } from './follow.mjs';
import { openMarks } from './marks.mjs';
import { findPlace, languageOf, markedUp, passagesOf, piecesOf, rangeOf } from './text.mjs';

const AHEAD = 2; // requests queued behind the current one
const FAILURES = 3; // consecutive failures that end the reading
const OWN_USE = 'a[href], button, input, select, textarea, label, summary, [contenteditable]'; // what a click is for there
const LOST = 'connection-lost';

let readers = 0;

/** Reads an element of the page aloud, sentence by sentence, and marks what is heard. */
export class Reader {
  #root = null;
  #pieces = [];
  #asked = new Map(); // id of a request -> { index, base, piece, plain }
  #turn = 0; // number of the current run: results of earlier runs are ignored
  #next = 0;
  #heard = null; // { id, index, start }: the word
  #failures = 0;
  #resumedAt = null;
  #marks = null;
  #follow = null;
  #done = null; // resolves the promise of read()
  #name = `reading-${++readers}`;

  /**
   * @param {HTMLElement} head the element
   * @param {object} ports speak(text, options) -> Promise, jump(mark), resume(), stop(); running(id): whether the server still
   *   speaks that; emit(type, detail); fail(name)
   */
  constructor(head, ports) {
    this.head = head;
    this.ports = ports;
    head.addEventListener('word', ({ detail }) => this.#word(detail));
  }

  get reading() {
    return this.#done !== null;
  }

  /**
   * @param {Range|StaticRange|Node|null} [from] where to begin
   * @returns {Promise<{reason: 'done'|'stopped'|'failed', code?: string}>}
   */
  read(from = null) {
    const mode = this.reading ? 'replace' : 'queue';
    this.#finish({ reason: 'stopped' });
    const root = this.#find();
    const pieces = root ? (this.head.voice === 'recording' ? passagesOf : piecesOf)(root) : [];
    if (!pieces.length) {
      this.ports.fail('noText', { selector: this.head.for ?? '' });
      return Promise.resolve({ reason: 'failed', code: 'no-text' });
    }
    this.#open(root);
    this.#pieces = pieces;
    const promise = new Promise((resolve) => (this.#done = resolve));
    this.#begin((from && placeOf(pieces, from)) ?? { index: 0, start: 0 }, mode);
    return promise;
  }

  /** Ends the reading: its text has changed, or the head has gone. */
  close() {
    if (this.reading) this.ports.stop();
    this.#finish({ reason: 'stopped' });
    this.#root?.removeEventListener('click', this.#click);
    this.#root = null;
  }

  #find() {
    const wanted = this.head.for;
    if (!wanted) return null;
    const page = this.head.ownerDocument;
    try {
      return page.getElementById(wanted) ?? page.querySelector(wanted);
    } catch {
      return null; // no selector
    }
  }

  #open(root) {
    if (this.#root !== root) {
      this.#root?.removeEventListener('click', this.#click);
      root.addEventListener('click', this.#click);
      this.#root = root;
    }
    this.#marks = openMarks(root.ownerDocument);
    this.#follow = new Follow(root);
  }

  /** Starts speaking at a position, and drops earlier requests. */
  #begin({ index, start }, mode = 'replace') {
    this.#turn++;
    this.#asked.clear();
    this.#heard = null;
    this.#next = index;
    this.#follow.again();
    this.#ask(start, mode);
    this.#fill();
  }

  #fill() {
    while (this.#next < this.#pieces.length && this.#asked.size <= AHEAD) this.#ask(0, 'queue');
  }

  #ask(base, mode) {
    const index = this.#next++;
    const whole = this.#pieces[index];
    if (whole.passage) {
      const { passage, lang } = whole;
      this.#request(index, 0, whole.text, { passage, from: base || undefined, lang: lang || undefined, mode });
      return;
    }
    const words = whole.words.filter((at) => at >= base).map((at) => at - base);
    const piece = { ...whole, text: whole.text.slice(base), words };
    const near = (name) => whole.at[0]?.node.parentElement?.closest(`[data-${name}]`)?.dataset[name];
    const options = { mode, markup: 'ssml', work: near('passage'), speaker: piece.speaker, affect: near('affect') }; // a work's lexicons hold
    for (const name of ['work', 'speaker', 'affect']) if (!options[name]) delete options[name];
    this.#request(index, base, markedUp(piece, this.#id(index)), { ...options, ...this.#voice(piece.lang) });
  }

  #id(index) {
    return `${this.#name}-${this.#turn}-${index}`;
  }

  #request(index, base, source, options) {
    const turn = this.#turn;
    const id = this.#id(index);
    this.#asked.set(id, { index, base, plain: new PlainText(source, options.markup) });
    this.ports.speak(source, { ...options, id }).then((end) => turn === this.#turn && this.#ended(id, end));
  }

  /** Returns the element's voice for its own language; passages in another language get their own voice. */
  #voice(lang) {
    const base = languageOf(this.#root) || this.head.getAttribute('lang') || '';
    const primary = (tag) => tag.split('-')[0].toLowerCase();
    if (!lang || primary(lang) === primary(base)) return lang ? { lang } : {};
    return { lang, voice: undefined };
  }

  #ended(id, end) {
    const { index } = this.#asked.get(id);
    this.#asked.delete(id);
    if (end.reason === 'stopped') return this.#finish({ reason: 'stopped' });
    if (end.reason === 'failed') {
      const place = this.#heard ?? { index, start: 0 };
      const again = `${place.index} ${place.start}`;
      if (end.code === LOST && this.#resumedAt !== again) {
        this.#resumedAt = again; // once the connection is back; twice at the same word is enough
        return this.#begin(place);
      }
      if (++this.#failures >= FAILURES || end.code === LOST || end.code === 'no-connection') {
        this.ports.stop();
        return this.#finish({ reason: 'failed', code: end.code });
      }
    } else this.#failures = 0;
    if (index === this.#pieces.length - 1) return this.#finish({ reason: 'done' });
    return this.#fill();
  }

  #finish(result) {
    const done = this.#done;
    if (!done) return;
    this.#done = null;
    this.#turn++;
    this.#asked.clear();
    this.#marks.close();
    this.#follow.close();
    this.ports.emit('read', result);
    done(result);
  }

  #word({ id, utf16_start, utf16_end }) {
    const asked = this.#asked.get(id);
    if (!asked) return;
    const piece = this.#pieces[asked.index];
    const [start, end] = [utf16_start, utf16_end].map((place) => asked.base + asked.plain.at(place));
    if (start >= piece.text.length || !piece.at[start].node.isConnected) return;
    const range = rangeOf(piece, start, end);
    if (this.#heard?.id !== id) this.#marks.show('sentence', rangeOf(piece, 0, piece.text.length));
    this.#heard = { id, index: asked.index, start };
    this.#marks.show('word', range);
    this.#follow.to(range);
    const text = piece.text.slice(start, end);
    this.ports.emit('reading', { range, text, lang: piece.lang, sentence: asked.index, sentences: this.#pieces.length });
  }

  /** She goes on from the word that is clicked; what is spoken already is played again from there. */
  #click = (event) => {
    if (!this.reading || event.defaultPrevented || event.target.closest(OWN_USE)) return;
    if (!this.#root.ownerDocument.getSelection().isCollapsed) return;
    const place = this.#pointed(event);
    if (place) this.#goOn(place);
  };

  #pointed({ clientX, clientY }) {
    const page = this.#root.ownerDocument;
    const caret = page.caretPositionFromPoint?.(clientX, clientY);
    const range = caret ? null : page.caretRangeFromPoint?.(clientX, clientY);
    const [node, offset] = caret ? [caret.offsetNode, caret.offset] : [range?.startContainer, range?.startOffset];
    return node && this.#root.contains(node) ? findPlace(this.#pieces, node, offset) : null;
  }

  #goOn(place) {
    const asked = this.#heard && this.#asked.get(this.#heard.id);
    const marked = !this.#pieces[place.index].passage && asked?.base <= place.start;
    const here = marked && this.#heard.index === place.index && this.ports.running(this.#heard.id);
    if (here) {
      this.#follow.again();
      this.ports.jump(`${this.#heard.id}-${place.start - asked.base}`);
    } else this.#begin(place);
    this.ports.resume();
  }
}

/** @param {object[]} pieces @param {Range|StaticRange|Node} from */
function placeOf(pieces, from) {
  return 'startContainer' in from ? findPlace(pieces, from.startContainer, from.startOffset) : findPlace(pieces, from, 0);
}
