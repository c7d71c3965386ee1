// SPDX-License-Identifier: MIT
import { decodePictures } from './set.mjs';

const ROOM = 1.4; // round the mouth, in the view `mouth`
const SWAY = 0.5; // of what a turn of the head would move the face: the shoulders, which stand, move along
const AU = 1e-5; // radians
const SHARP = 0.005; // of the place's width: sides that end so near to it stay as they are
const SIDES = 0.12; // of the picture's width, over which shoulders fade where the place is wider than the picture

/**
 * A canvas with a set of pictures on it, without a graphics processor: the same as View, for a face of photographs. The base
 * is drawn once, and over it the regions that change; the head's turns move the canvas itself, which costs the page nothing.
 */
export class PicturesView {
  name = 'pictures'; // in place of a level of quality
  software = true;
  framing = null;
  soft = null; // shares of its place's width, see #soften

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.head = null;
    this.size = { width: 1, height: 1 };
    canvas.style.objectFit = 'contain';
  }

  /** @param {Pictures} pictures */
  show(pictures) {
    this.head?.dispose();
    this.head = pictures;
    this.shown = null;
  }

  /** In CSS pixels. */
  resize(width, height) {
    this.size = { width, height };
    this.#soften();
  }

  /**
   * Makes the sides of a picture soft that ends in the middle of the shoulders, where the place is wider: `soft` says where in
   * its width they begin, and where they are whole.
   */
  #soften() {
    const { canvas, shown, size } = this;
    if (!shown) return;
    const drawn = Math.min(size.width, (size.height * shown.width) / shown.height);
    const beside = this.head.framed ? 0 : (size.width - drawn) / 2 / size.width;
    this.soft = beside < SHARP ? null : { beside, faded: beside + (SIDES * drawn) / size.width };
    const at = (share) => `${(100 * share).toFixed(2)}%`;
    const { beside: from, faded: to } = this.soft ?? {};
    canvas.style.maskImage = this.soft ? `linear-gradient(90deg, transparent ${at(from)}, #000 ${at(to)} ${at(1 - to)}, transparent ${at(1 - from)})` : '';
  }

  setLevel() {} // there is one

  draw() {
    const { canvas, context, head } = this;
    if (!head) return;
    const mouth = this.framing === 'mouth';
    const shown = mouth ? head.mouthIn(this.size) : head.whole;
    if (this.shown?.x !== shown.x || this.shown.width !== shown.width || this.shown.height !== shown.height) {
      this.shown = shown;
      Object.assign(canvas, { width: shown.width, height: shown.height });
      context.translate(-shown.x, -shown.y);
      head.begin(context);
      this.#soften();
    } else head.draw(context);
    const transform = mouth ? '' : this.#placed();
    if (canvas.style.transform !== transform) canvas.style.transform = transform;
  }

  /**
   * Returns the CSS transform of the canvas: its frame comes to fill the place down to the lower border, what is beyond it is
   * cut off there, and the head turns.
   */
  #placed() {
    const { whole, frame, pivot, turned } = this.head;
    const { width, height } = this.size;
    const shown = Math.min(whole.width, Math.max(frame.width, (frame.height * width) / height)); // columns for this place
    const scale = Math.min(width / shown, height / frame.height);
    const contained = Math.min(width / whole.width, height / whole.height);
    const down = this.head.framed ? height / 2 - scale * (frame.height - whole.height / 2) : 0;
    const [x, y, roll] = turned;
    const [right, under] = [scale * (pivot[0] - whole.width / 2), scale * (pivot[1] - whole.height / 2) + down];
    const px = (value) => `${value.toFixed(2)}px`;
    const turn = x || y || roll ? `translate(${px(x * scale + right)}, ${px(y * scale + under)}) rotate(${(-roll).toFixed(4)}rad) translate(${px(-right)}, ${px(-under)})` : '';
    const place = this.head.framed ? `translate(0, ${px(down)}) scale(${(scale / contained).toFixed(4)})` : '';
    return [turn, place].filter(Boolean).join(' ');
  }

  /** Records that the requested frame was drawn. */
  mark() {
    return () => true;
  }

  dispose() {
    this.head?.dispose();
    Object.assign(this.canvas.style, { objectFit: '', transform: '', maskImage: '' });
  }
}

/** A set of pictures as it stands: what the FAPs have made of it. */
export class Pictures {
  triangles = 0; // as of a head
  slim() {} // as of a head: there is nothing to leave out

  /** @param {object} set as read @returns {Promise<Pictures>} */
  static async create(set) {
    return new Pictures(set, await decodePictures(set));
  }

  /** @param {object} set @param {{base: ImageBitmap, regions: import('./morph.mjs').Region[]}} decoded */
  constructor({ width, height, frame, pivot, reach, regions: places }, { base, regions }) {
    this.whole = { x: 0, y: 0, width, height };
    this.framed = Boolean(frame); // whether the body goes on beyond what is shown
    this.frame = frame ?? this.whole;
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
      const pixels = context.createImageData(region.width, region.height);
      region.output = new Uint32Array(pixels.data.buffer);
      return { region, canvas, context, pixels };
    });
    this.turned = [0, 0, 0]; // to the right and down, in its pixels, and about its pivot
    this.changed = false;
    this.setFaps(new Float32Array(69));
  }

  /** The mouth, and what is beside it as far as its place has room. @param {{width: number, height: number}} place */
  mouthIn({ width, height }) {
    const { mouth, whole } = this;
    const wide = Math.min(whole.width, Math.max(mouth.width, Math.round((mouth.height * width) / height)));
    const x = Math.round(mouth.x + (mouth.width - wide) / 2);
    return { ...mouth, width: wide, x: Math.min(whole.width - wide, Math.max(0, x)) };
  }

  /** @param {ArrayLike<number>} faps by number */
  setFaps(faps) {
    for (const { region, context, pixels } of this.layers) {
      if (!region.update(faps)) continue;
      context.putImageData(pixels, 0, 0);
      this.changed = true;
    }
    const [pitch, yaw, roll] = [48, 49, 50].map((number) => faps[number] * AU);
    this.turned = [SWAY * this.reach * Math.sin(yaw), SWAY * this.reach * Math.sin(pitch), roll];
  }

  /** All of it. @param {CanvasRenderingContext2D} context */
  begin(context) {
    context.drawImage(this.base, 0, 0);
    this.changed = true;
    this.draw(context);
  }

  /** Draws the regions that changed. @param {CanvasRenderingContext2D} context */
  draw(context) {
    if (!this.changed) return;
    this.changed = false;
    for (const { region } of this.layers) {
      const { x, y, width, height } = region;
      context.clearRect(x, y, width, height);
      context.drawImage(this.base, x, y, width, height, x, y, width, height);
    }
    for (const { region, canvas } of this.layers) context.drawImage(canvas, region.x, region.y);
  }

  dispose() {
    this.base.close();
  }
}
