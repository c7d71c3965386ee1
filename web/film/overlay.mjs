// SPDX-License-Identifier: MIT
// What is behind a face, drawn over it in a film: its mesh, feature points, or the zone of a FAP.
import { AnatomyPainter } from '../element/head/anatomy.mjs';

const OPAQUE = 255;

export class Overlay {
  #painter = new AnatomyPainter();

  /** @param {number} width @param {number} height pixels @param {{mesh: boolean, points: boolean, zone: number}} shows */
  constructor(width, height, shows) {
    const canvas = Object.assign(document.createElement('canvas'), { width, height });
    this.context = canvas.getContext('2d', { willReadFrequently: true });
    this.shows = shows;
  }

  /** @param {object} view as it is drawn @returns {Uint8ClampedArray} RGBA, the lowest line first */
  draw(view) {
    const { context, shows } = this;
    const { width, height } = context.canvas;
    context.setTransform(1, 0, 0, -1, 0, height);
    context.clearRect(0, 0, width, height);
    this.#painter.paint(context, view, { width, height }, shows);
    return context.getImageData(0, 0, width, height).data;
  }
}

/**
 * Lays one picture over another.
 * @param {Uint8Array} bytes its alpha is multiplied in @param {Uint8ClampedArray} over its is not
 */
export function layOver(bytes, over) {
  for (let i = 0; i < bytes.length; i += 4) {
    const alpha = over[i + 3] / OPAQUE;
    if (!alpha) continue;
    for (let k = i; k < i + 3; k++) bytes[k] = over[k] * alpha + bytes[k] * (1 - alpha);
    bytes[i + 3] = over[i + 3] + bytes[i + 3] * (1 - alpha);
  }
}
