// SPDX-License-Identifier: MIT
// Controls reading aloud: start, next section, repeated line; by the head, or offline from stored speech.
import { canKeep } from './offline.js';

const LINES = '.line, [data-passage]:not(.verse)';
const $ = (id) => document.getElementById(id);
const range = (element) => {
  const all = document.createRange();
  all.selectNodeContents(element);
  return all;
};

export const lineOf = (node) => (node.nodeType === 1 ? node : node.parentElement).closest(LINES);

export class Listening {
  line = null; // where she is, or begins
  reading = false;
  #paused = false;
  #pinned = null; // the repeated line
  #turn = null;

  /**
   * @param {import('../shared/frame.js').Frame} frame @param {HTMLElement} passage
   * @param {object} ports spoken: plays stored speech; next(): opens the next section and resolves to whether there was one;
   *   stopped(): called when the head has stopped
   */
  constructor(frame, passage, ports) {
    Object.assign(this, { frame, head: frame.head, passage, ports });
    this.head.addEventListener('reading', ({ detail }) => this.#heard(lineOf(detail.range.startContainer)));
    for (const type of ['paused', 'resumed'])
      this.head.addEventListener(type, () => {
        this.#paused = type === 'paused';
        this.showPlay();
      });
    passage.addEventListener('click', (event) => this.#clicked(event));
  }

  get #lines() {
    return [...this.passage.querySelectorAll(LINES)];
  }

  showPlay() {
    $('play').textContent = this.frame.say(!this.reading ? 'read' : this.#paused ? 'resume' : 'pause');
  }

  stop() {
    if (this.reading) this.head.stop();
    this.ports.spoken.stop();
    this.#ended();
  }

  #ended() {
    this.reading = this.#paused = false;
    this.showPlay();
    this.ports.stopped();
  }

  /** @param {Element|Range|null} where to start reading */
  async read(from = this.line) {
    if (!this.passage.firstChild) return;
    if (canKeep() && (!navigator.onLine || ['waiting', 'closed'].includes($('connection').dataset.state))) {
      await this.#hearKept();
      return;
    }
    this.reading = true;
    this.#paused = false;
    this.showPlay();
    const turn = (this.#turn = Symbol('reading'));
    const { reason } = await this.head.read(from instanceof Element ? range(from) : (from ?? undefined));
    if (turn !== this.#turn) return;
    if (reason === 'done' && this.#pinned) {
      this.read(this.#pinned);
      return;
    }
    this.#ended();
    if (reason === 'done' && $('sleep').value !== 'section' && (await this.ports.next())) this.read(null);
  }

  /** Plays stored speech when offline. */
  async #hearKept() {
    const from = this.line;
    this.frame.tell('noNetwork');
    const all = [...this.passage.querySelectorAll('[data-passage]')];
    const first = from ? all.findIndex((element) => element.contains(from)) : 0;
    this.reading = true;
    this.showPlay();
    await this.ports.spoken.play(all.slice(Math.max(0, first)), (element) => element.scrollIntoView({ block: 'nearest' }));
    this.#ended();
  }

  toggle() {
    if (!this.reading) this.read();
    else if (this.ports.spoken.playing) this.ports.spoken.stop();
    else if (this.#paused) this.head.resume();
    else this.head.pause();
  }

  /** Lines on, or back. */
  step(by) {
    const all = this.#lines;
    const to = all[Math.min(all.length - 1, Math.max(0, all.indexOf(this.line) + by))];
    if (!to) return;
    this.line = to;
    if (this.#pinned) this.#pinned = to;
    if (this.reading) this.read(to);
    else to.scrollIntoView({ block: 'nearest' });
  }

  repeat() {
    this.#pinned = this.#pinned ? null : (this.line ?? this.#lines[0] ?? null);
    $('repeat').setAttribute('aria-pressed', String(this.#pinned !== null));
  }

  #heard(line) {
    if (this.#pinned && line !== this.#pinned) {
      const all = this.#lines;
      if (all.indexOf(line) === all.indexOf(this.#pinned) + 1) this.read(this.#pinned);
      else this.#pinned = line; // she was sent elsewhere
    }
    this.line = this.#pinned ?? line;
  }

  /** During reading, the element itself continues from there. */
  #clicked({ target, clientX, clientY }) {
    if (this.reading || target.closest('a, button') || !getSelection().isCollapsed) return;
    const caret = document.caretPositionFromPoint?.(clientX, clientY);
    const old = caret ? null : document.caretRangeFromPoint?.(clientX, clientY);
    const place = caret?.offsetNode ?? old?.startContainer;
    if (!place || !this.passage.contains(place)) return;
    const from = document.createRange();
    from.setStart(place, caret?.offset ?? old.startOffset);
    this.line = lineOf(place);
    this.read(from);
  }
}
