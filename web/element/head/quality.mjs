// SPDX-License-Identifier: MIT

/**
 * From the best to the cheapest: fine shading; samples for each pixel; whether edges are made soft where no graphics processor
 * draws; share of the display's pixels, and how many pixels there are to a CSS pixel at most.
 */
export const LEVELS = [
  { name: 'high', fine: true, samples: 4, soft: true, share: 1, ratio: 2, anisotropy: 8 },
  { name: 'high-1x', fine: true, samples: 4, soft: true, share: 1, ratio: 1, anisotropy: 4 },
  { name: 'fine', fine: true, samples: 0, soft: false, share: 1, ratio: 1, anisotropy: 2 },
  { name: 'low', fine: false, samples: 0, soft: true, share: 0.75, ratio: 1, anisotropy: 1 },
  { name: 'lowest', fine: false, samples: 0, soft: true, share: 0.5, ratio: 0.75, anisotropy: 1 },
];

const FIXED = { high: 0, low: 3 };

const WINDOW = 20; // frames per decision;
const WINDOW_LEAST = 5; // fewer, down to this many, when they take
const WINDOW_MS = 1200; // this long in total
const SLOW_MS = 1000 / 28; // median above: one step down
const VERY_SLOW_MS = 1000 / 14; // two steps
const QUICK_MS = 1000 / 50; // below, for a while: one step up
const QUICK_WINDOWS = 15;
const PATIENCE_FACTOR = 4; // after a step up that had to be taken back
const GAIN = 0.85; // of the time between pictures: a blurred picture that does not come sooner than this is for nothing

/** Chooses the level by itself from the times between frames, measured while frames follow each other. */
export class Governor {
  /** @param {'auto'|'high'|'low'} wish @param {boolean} software whether the graphics are drawn by the processor */
  constructor(wish = 'auto', software = false) {
    this.software = software;
    this.wish(wish);
  }

  wish(wish) {
    this.auto = !(wish in FIXED);
    this.index = FIXED[wish] ?? (this.software ? FIXED.low : 0);
    this.intervals = [];
    this.spent = 0; // milliseconds that the intervals take together
    this.quick = 0;
    this.patience = QUICK_WINDOWS;
    this.raised = false;
    this.last = LEVELS.length - 1; // the lowest that is worth it
    this.slow = 0; // median at `low`, before it was left for less
    this.skip = 3; // frames that pay for the change of the level itself
  }

  get level() {
    return LEVELS[this.index];
  }

  /** Frames do not follow the one before: the next interval says nothing. */
  pause() {
    this.skip = 3;
  }

  /**
   * @param {number} interval milliseconds since the frame before
   * @returns {boolean} whether the level has changed
   */
  frame(interval) {
    if (!this.auto) return false;
    if (this.skip > 0) {
      this.skip--;
      return false;
    }
    this.intervals.push(interval);
    this.spent += interval;
    const { length } = this.intervals;
    if (length < WINDOW && (length < WINDOW_LEAST || this.spent < WINDOW_MS)) return false;
    const median = this.intervals.sort((a, b) => a - b)[length >> 1];
    this.spent = 0;
    this.intervals = [];
    return this.#judge(median);
  }

  #judge(median) {
    const before = this.slow;
    this.slow = 0;
    if (before && median > GAIN * before) {
      this.last = FIXED.low; // points are not what takes the time
      return this.#step(-1);
    }
    if (median > SLOW_MS) {
      if (this.raised) this.patience *= PATIENCE_FACTOR;
      this.raised = false;
      this.quick = 0;
      const low = this.index === FIXED.low;
      const changed = this.#step(median > VERY_SLOW_MS ? 2 : 1);
      if (low && changed) this.slow = median;
      return changed;
    }
    this.quick = median < QUICK_MS ? this.quick + 1 : 0;
    if (this.quick < this.patience || this.index === 0) return false;
    this.quick = 0;
    this.raised = true;
    return this.#step(-1);
  }

  #step(by) {
    const most = this.index < FIXED.low ? FIXED.low : this.last; // what `low` takes is seen before it is left
    const index = Math.min(most, Math.max(0, this.index + by));
    if (index === this.index) return false;
    this.index = index;
    this.skip = 3;
    return true;
  }
}
