// SPDX-License-Identifier: MIT

const POLL_MS = 4; // as often as browsers let a timer come back
const SURE_MS = 24; // a picture whose end is known less well teaches nothing: the page was busy, or hidden
const KEPT = 5; // pictures that the next one is judged by
const SMOOTHING = 0.05;

/**
 * When a picture will be seen that is begun now. Pictures are drawn one at a time: browsers take up to three at once, and
 * where drawing is slow (no graphics processor) the last of them is seen three times as late, a time that nobody can
 * foresee. A picture that waits for no other takes as long as those before it; it is on the display when drawing ends,
 * and with the next beat of the display at the earliest.
 */
export class Pace {
  /**
   * @param {() => () => boolean} mark notes what has been asked to be drawn; what it returns says whether that is done
   * @param {(call: () => void, milliseconds: number) => void} setTimeout of tests
   */
  constructor(mark, setTimeout = (call, milliseconds) => globalThis.setTimeout(call, milliseconds)) {
    this.mark = mark;
    this.setTimeout = setTimeout;
    this.beat = 1000 / 60; // milliseconds from one beat of the display to the next
    this.last = -Infinity; // beat
    this.taken = []; // milliseconds that the last pictures took
    this.picture = null; // the one that is being drawn
  }

  /** The display's beat, on which a picture may be begun. @param {number} now the time of the animation frame */
  tick(now) {
    const since = now - this.last;
    if (since > 0 && since < 1.5 * this.beat) this.beat += SMOOTHING * (since - this.beat);
    this.last = now;
  }

  /** Whether a picture that is begun now would have to wait for another. */
  get busy() {
    return this.picture !== null && this.span > this.beat;
  }

  /** How long a picture takes, in milliseconds: the median of the last ones. */
  get span() {
    return [...this.taken].sort((a, b) => a - b)[this.taken.length >> 1] ?? this.beat;
  }

  /** Milliseconds until a picture is seen that is begun now. */
  ahead(now) {
    return Math.max(this.span, this.last + this.beat - now);
  }

  /** A picture has been asked for. @param {number} begun when @param {() => number} clock */
  drawn(begun, clock = () => performance.now()) {
    const picture = { done: this.mark() };
    this.picture = picture;
    let asked = begun;
    const ask = () => {
      const now = clock();
      if (picture.done()) {
        if (now - asked <= SURE_MS) this.taken = [...this.taken, (asked + now) / 2 - begun].slice(-KEPT);
        if (this.picture === picture) this.picture = null;
        return;
      }
      asked = now;
      this.setTimeout(ask, POLL_MS);
    };
    this.setTimeout(ask, POLL_MS);
  }
}
