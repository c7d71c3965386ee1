// SPDX-License-Identifier: MIT

const POLL_MS = 4; // as often as browsers let a timer come back
const SURE_MS = 24; // a picture whose end is known less well teaches nothing: the page was busy, or hidden
const GIVEN_UP_MS = 3000; // timeout of a frame whose end is never reported: a context was lost and restored
const KEPT = 5; // pictures that the next one is judged by
const SMOOTHING = 0.05;

/**
 * Predicts when a frame that is begun now will be displayed. Frames are drawn one at a time: browsers queue up to three, and
 * with slow drawing (no GPU) the last one is late by an unpredictable time. A frame that waits for no other takes as long as
 * those before it; it is displayed when drawing ends, at the next refresh at the earliest.
 */
export class FramePacer {
  /**
   * @param {() => () => boolean} mark notes what has been asked to be drawn; what it returns says whether that is done
   * @param {(call: () => void, milliseconds: number) => void} setTimeout of tests
   */
  constructor(mark, setTimeout = (call, milliseconds) => globalThis.setTimeout(call, milliseconds)) {
    this.mark = mark;
    this.setTimeout = setTimeout;
    this.beat = 1000 / 60; // milliseconds from one beat of the display to the next
    this.last = -Infinity; // beat
    this.taken = { alone: [], beside: [] }; // milliseconds that the last pictures took: alone, and beside a changed page
    this.picture = null; // frame in progress
  }

  /** Marks a refresh of the display, on which a frame may begin. @param {number} now the time of the animation frame */
  tick(now) {
    const since = now - this.last;
    if (since > 0 && since < 1.5 * this.beat) this.beat += SMOOTHING * (since - this.beat);
    this.last = now;
  }

  /** Whether a picture that is begun now would have to wait for another. */
  get busy() {
    return this.picture !== null && this.#span('alone') > this.beat;
  }

  /** Milliseconds that a picture takes, the page beside it unchanged, and at least a beat. */
  get usual() {
    return Math.max(this.beat, this.#span('alone'));
  }

  /** Returns the time that a frame takes, in ms: the median of the last ones. */
  #span(kind) {
    const taken = this.taken[kind].length ? this.taken[kind] : this.taken.alone;
    return [...taken].sort((a, b) => a - b)[taken.length >> 1] ?? this.beat;
  }

  /**
   * Milliseconds until a picture is seen that is begun now.
   * @param {number} now @param {boolean} [beside] whether more of the page has changed: it is drawn with the picture
   */
  ahead(now, beside = false) {
    return Math.max(this.#span(beside ? 'beside' : 'alone'), this.last + this.beat - now);
  }

  /** A picture has been asked for. @param {number} begun when @param {boolean} [beside] as above @param {() => number} clock */
  drawn(begun, beside = false, clock = () => performance.now()) {
    const kind = beside ? 'beside' : 'alone';
    const picture = { done: this.mark() };
    this.picture = picture;
    let asked = begun;
    const ask = () => {
      const now = clock();
      const done = picture.done();
      if (done && now - asked <= SURE_MS) this.taken[kind] = [...this.taken[kind], (asked + now) / 2 - begun].slice(-KEPT);
      if (done || now - begun > GIVEN_UP_MS) {
        if (this.picture === picture) this.picture = null;
        return;
      }
      asked = now;
      this.setTimeout(ask, POLL_MS);
    };
    this.setTimeout(ask, POLL_MS);
  }
}
