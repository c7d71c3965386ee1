// SPDX-License-Identifier: MIT
import { decodePictures } from './set.mjs';

const ROOM = 1.4; // round the mouth, in the view `mouth`
const SWAY = 0.5; // of what a turn of the head would move the face: the shoulders, which stand, move along
const AU = 1e-5; // radians

/**
 * A canvas with a set of pictures on it, without a graphics processor: the same as View, for a face of photographs. The base is drawn whole,
 * and over it the regions that have something else to show; the head's turns move it all a little.
 */
export class PicturesView {
  name = 'pictures'; // in place of a level of quality
  software = true;
  framing = null;

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.head = null;
    canvas.style.objectFit = 'contain';
  }

  /** @param {Pictures} pictures */
  show(pictures) {
    this.head?.dispose();
    this.head = pictures;
  }

  resize() {} // the page's own layout does it

  setLevel() {} // there is one

  draw() {
    const { canvas, context, head, framing } = this;
    if (!head) return;
    const { x, y, width, height } = framing === 'mouth' ? head.mouth : head.whole;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    context.setTransform(1, 0, 0, 1, -x, -y);
    context.clearRect(x, y, width, height);
    head.draw(context);
  }

  /** What is asked for is drawn. */
  mark() {
    return () => true;
  }

  dispose() {
    this.head?.dispose();
    this.canvas.style.objectFit = '';
  }
}

/** A set of pictures as it stands: what the FAPs have made of it. */
export class Pictures {
  triangles = 0; // as of a head

  /** @param {object} set as read @returns {Promise<Pictures>} */
  static async create(set) {
    return new Pictures(set, await decodePictures(set));
  }

  /** @param {object} set @param {{base: ImageBitmap, regions: import('./morph.mjs').Region[]}} decoded */
  constructor({ width, height, pivot, reach, regions: places }, { base, regions }) {
    this.whole = { x: 0, y: 0, width, height };
    const mouth = places.find(({ name }) => name === 'mouth') ?? this.whole;
    const [w, h] = [Math.min(width, Math.round(mouth.width * ROOM)), Math.min(height, Math.round(mouth.height * ROOM))];
    this.mouth = {
      x: Math.round(Math.min(width - w, Math.max(0, mouth.x + (mouth.width - w) / 2))),
      y: Math.round(Math.min(height - h, Math.max(0, mouth.y + (mouth.height - h) / 2))),
      width: w,
      height: h,
    };
    this.pivot = pivot;
    this.reach = reach;
    this.base = base;
    this.layers = regions.map((region) => {
      const canvas = document.createElement('canvas');
      Object.assign(canvas, { width: region.width, height: region.height });
      const context = canvas.getContext('2d');
      return { region, canvas, context, pixels: new ImageData(new Uint8ClampedArray(region.output.buffer), region.width) };
    });
    this.turns = [0, 0, 0];
    this.setFaps(new Float32Array(69));
  }

  /** @param {ArrayLike<number>} faps by number */
  setFaps(faps) {
    for (const { region, context, pixels } of this.layers) if (region.update(faps)) context.putImageData(pixels, 0, 0);
    this.turns = [48, 49, 50].map((number) => faps[number] * AU);
  }

  /** @param {CanvasRenderingContext2D} context */
  draw(context) {
    const [pitch, yaw, roll] = this.turns;
    const [x, y] = this.pivot;
    if (pitch || yaw || roll) {
      context.translate(x + SWAY * this.reach * Math.sin(yaw), y + SWAY * this.reach * Math.sin(pitch));
      context.rotate(-roll);
      context.translate(-x, -y);
    }
    context.drawImage(this.base, 0, 0);
    for (const { region, canvas } of this.layers) context.drawImage(canvas, region.x, region.y);
  }

  dispose() {
    this.base.close();
  }
}
