// SPDX-License-Identifier: MIT
// A FAP's curve as keys with monotone splines between them. No page needed: tests/web reads this.

/** Frames at which a curve turns or bends: lines from one to the next are within `near` of it. @returns {number[]} */
export function keysOf(values, near) {
  const keys = [0];
  const split = (from, to) => {
    let [worst, at] = [near, -1];
    for (let k = from + 1; k < to; k++) {
      const straight = values[from] + ((values[to] - values[from]) * (k - from)) / (to - from);
      const away = Math.abs(values[k] - straight);
      if (away > worst) [worst, at] = [away, k];
    }
    if (at < 0) keys.push(to);
    else {
      split(from, at);
      split(at, to);
    }
  };
  if (values.length > 1) split(0, values.length - 1);
  return keys;
}

/** Slopes at the keys that keep each piece monotone (F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17, 1980). */
function slopes(x, y) {
  const secant = x.slice(1).map((end, i) => (y[i + 1] - y[i]) / (end - x[i]));
  const slope = x.map((_, i) => {
    if (i === 0 || i === x.length - 1) return secant[Math.min(i, secant.length - 1)] ?? 0;
    return secant[i - 1] * secant[i] <= 0 ? 0 : (secant[i - 1] + secant[i]) / 2;
  });
  secant.forEach((s, i) => {
    if (s === 0) {
      slope[i] = slope[i + 1] = 0;
      return;
    }
    const [a, b] = [slope[i] / s, slope[i + 1] / s];
    const size = Math.hypot(a, b);
    if (size > 3) [slope[i], slope[i + 1]] = [(3 * a * s) / size, (3 * b * s) / size];
  });
  return slope;
}

/**
 * @param {number[]} x frames of the keys, ascending @param {number[]} y values there
 * @returns {number[]} values at all frames from the first key to the last
 */
export function spline(x, y) {
  if (x.length === 1) return [y[0]];
  const slope = slopes(x, y);
  const out = [];
  for (let i = 0; i + 1 < x.length; i++) {
    const width = x[i + 1] - x[i];
    for (let k = x[i]; k < x[i + 1]; k++) {
      const t = (k - x[i]) / width;
      const [t2, t3] = [t * t, t * t * t];
      const [here, there] = [(2 * t3 - 3 * t2 + 1) * y[i], (3 * t2 - 2 * t3) * y[i + 1]];
      out.push(here + there + width * ((t3 - 2 * t2 + t) * slope[i] + (t3 - t2) * slope[i + 1]));
    }
  }
  out.push(y.at(-1));
  return out;
}

/** Computes a moving average over `reach` frames on either side. @returns {number[]} */
export function smooth(values, reach = 2) {
  return values.map((_, k) => {
    const near = values.slice(Math.max(0, k - reach), k + reach + 1);
    return near.reduce((sum, value) => sum + value, 0) / near.length;
  });
}

/** Replaces a part of a curve by a drawn line. @param {Map<number, number>} drawn values at frames @returns {number[]} */
export function drawnOver(values, drawn) {
  const frames = [...drawn.keys()].sort((a, b) => a - b);
  return values.map((value, k) => {
    const next = frames.findIndex((frame) => frame >= k);
    if (next < 0 || k < frames[0]) return value;
    if (frames[next] === k) return drawn.get(k);
    const [a, b] = [frames[next - 1], frames[next]];
    return drawn.get(a) + ((drawn.get(b) - drawn.get(a)) * (k - a)) / (b - a);
  });
}

const SIDES = { l: 'r', r: 'l', lm: 'rm', rm: 'lm' };

/** Returns the name of a FAP on the other side of the face, or its own name if it has no side. @param {string} name */
export const mirrored = (name) => name.split('_').map((part) => SIDES[part] ?? part).join('_');

/** Changes that can be undone and redone. */
export class History {
  #done = [];
  #undone = [];

  /** @param {{number: number, before: number[], after: number[]}[]} change of FAPs' curves */
  add(change) {
    this.#done.push(change);
    this.#undone = [];
  }

  /** @returns {object[]|undefined} the changes to restore */
  undo() {
    const change = this.#done.pop();
    if (change) this.#undone.push(change);
    return change?.map(({ number, before, after }) => ({ number, before: after, after: before }));
  }

  redo() {
    const change = this.#undone.pop();
    if (change) this.#done.push(change);
    return change;
  }

  get can() {
    return { undo: this.#done.length > 0, redo: this.#undone.length > 0 };
  }
}
