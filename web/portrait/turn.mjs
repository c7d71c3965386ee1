// SPDX-License-Identifier: MIT
// Selects the best pictures of a face turning before a camera: from the front and from each side.
import { piece } from './detect.mjs';
import { laid } from './fit.mjs';
import { OVAL } from './landmarks.mjs';
import { boxOf } from './look.mjs';

const SMALL = 160; // size in pixels of the area where sharpness is measured
const ENOUGH = 2; // pictures of each: the sharper one is kept
/**
 * Radians to the side: bounds, and the best angle. The detector reports six tenths of the true angle; a smaller turn is no side
 * view (fit.mjs).
 */
const SIDES = {
  front: { from: -0.14, to: 0.14, best: 0 },
  left: { from: 0.31, to: 0.8, best: 0.45 },
  right: { from: -0.8, to: -0.31, best: -0.45 },
};
const ASIDE = 0.6; // of the worth of a picture at the border of its side

/** Differences between neighbours in the face, against its contrast. */
export function sharpness({ picture, landmarks }) {
  const [x, y, ...size] = boxOf(OVAL.map((i) => landmarks[i]));
  const { data, width, height } = piece(picture, { x, y, size }, SMALL);
  const grey = Float32Array.from({ length: width * height }, (_, i) => data[3 * i] + 2 * data[3 * i + 1] + data[3 * i + 2]);
  const mean = grey.reduce((sum, one) => sum + one, 0) / grey.length;
  const spread = grey.reduce((sum, one) => sum + (one - mean) ** 2, 0) || 1;
  let sum = 0;
  for (let j = 1; j < height - 1; j++)
    for (let i = 1; i < width - 1; i++) {
      const at = j * width + i;
      sum += (4 * grey[at] - grey[at - 1] - grey[at + 1] - grey[at - width] - grey[at + width]) ** 2;
    }
  return Math.sqrt(sum / spread);
}

/** Chooses while the face turns. */
export class TurnPicker {
  #base;
  #kept = new Map(); // side -> {view, worth, count}

  /** @param {import('./fit.mjs').Points} base any */
  constructor(base) {
    this.#base = base;
  }

  /** @param {{picture: object, landmarks: number[][]}} view @returns {string|null} the side that it is of */
  take(view) {
    const { yaw } = laid(view.landmarks, this.#base);
    const side = Object.keys(SIDES).find((name) => yaw >= SIDES[name].from && yaw <= SIDES[name].to);
    if (!side) return null;
    const { from, to, best } = SIDES[side];
    const worth = sharpness(view) * (1 - (1 - ASIDE) * Math.min(1, Math.abs(yaw - best) / Math.max(best - from, to - best)));
    const before = this.#kept.get(side);
    const count = (before?.count ?? 0) + 1;
    this.#kept.set(side, before && before.worth >= worth ? { ...before, count } : { view, worth, count });
    return side;
  }

  /** Sides without a picture yet, the front first. */
  get missing() {
    return Object.keys(SIDES).filter((name) => !this.#kept.has(name));
  }

  get done() {
    return Object.keys(SIDES).every((name) => this.#kept.get(name)?.count >= ENOUGH);
  }

  /** The best, the front first. */
  get views() {
    return Object.keys(SIDES).flatMap((name) => this.#kept.get(name)?.view ?? []);
  }
}
