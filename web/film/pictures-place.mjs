// SPDX-License-Identifier: MIT
// A set of pictures that is filmed: what the element shows on weak devices, on the film's clock.
import { Pictures, PicturesView } from '../element/pictures/pictures-view.mjs';
import { readPictures } from '../element/pictures/set.mjs';
import { covering } from './backdrop.mjs';

const OPAQUE = 255;

/** Makes a canvas of this size. @returns {CanvasRenderingContext2D} of it, to be read often if `read` */
const contextOf = (width, height, read = false) =>
  Object.assign(document.createElement('canvas'), { width, height }).getContext('2d', { willReadFrequently: read });

/** A set in its part of the pictures: the same as Place. Its body stands still, so it neither breathes nor sways. */
export class PicturesPlace {
  #drawn = null; // face of the last picture

  /**
   * @param {object} job width, height, view and colour of a Job
   * @param {{image?: CanvasImageSource}|null} background without an image it is the job's colour
   * @param {object} json of the set
   * @param {number} left @param {number} width pixels
   */
  static async open(job, background, json, left, width) {
    const view = new PicturesView(document.createElement('canvas'));
    view.framing = job.view;
    view.resize(width, job.height);
    view.show(await Pictures.create(readPictures(json)));
    const place = Object.assign(new PicturesPlace(), { view, left, width, height: job.height });
    place.behind = background && place.#paint(job, background);
    place.placed = contextOf(width, job.height);
    place.out = contextOf(width, job.height, true);
    return place;
  }

  /** The background, or its part behind this place. */
  #paint({ width, height, colour }, { image }) {
    const context = contextOf(this.width, height);
    if (image) {
      const [across, down] = covering(image, width, height);
      const [w, h] = [image.width * across, image.height * down];
      context.drawImage(image, (image.width - w) / 2, (image.height - h) / 2, w, h, -this.left, 0, width, height);
    } else {
      context.fillStyle = colour;
      context.fillRect(0, 0, this.width, height);
    }
    return context.canvas;
  }

  live() {}

  /** The set as the page places it: contained, its sides soft where they end within the place. */
  #place() {
    const { placed, width, height, view } = this;
    const { canvas, soft } = view;
    const scale = Math.min(width / canvas.width, height / canvas.height);
    const [w, h] = [scale * canvas.width, scale * canvas.height];
    placed.globalCompositeOperation = 'copy';
    placed.drawImage(canvas, (width - w) / 2, (height - h) / 2, w, h);
    if (!soft) return;
    const sides = placed.createLinearGradient(0, 0, width, 0);
    [[soft.beside, 0], [soft.faded, 1], [1 - soft.faded, 1], [1 - soft.beside, 0]].forEach(([at, alpha]) => sides.addColorStop(at, `rgb(0 0 0 / ${alpha})`));
    placed.globalCompositeOperation = 'destination-in';
    placed.fillStyle = sides;
    placed.fillRect(0, 0, width, height);
  }

  /** Draws a face. @returns {Uint8Array|null} for `read`; null: it is drawn already */
  draw(values) {
    if (this.#drawn?.every((value, n) => value === values[n])) return null;
    this.#drawn = [...values];
    const { out, width, height, view } = this;
    view.head.setFaps(values);
    view.draw();
    this.#place();
    const upright = new DOMMatrix([1, 0, 0, -1, 0, height]); // the lowest line comes first
    out.setTransform(upright);
    out.globalCompositeOperation = 'copy';
    if (this.behind) {
      out.drawImage(this.behind, 0, 0);
      out.globalCompositeOperation = 'source-over';
    }
    const turned = new DOMMatrix(view.canvas.style.transform); // about its middle
    out.setTransform(upright.translate(width / 2, height / 2).multiply(turned).translate(-width / 2, -height / 2));
    out.drawImage(this.placed.canvas, 0, 0);
    const { data } = out.getImageData(0, 0, width, height);
    if (!this.behind) multiplyIn(data);
    return new Uint8Array(data.buffer);
  }

  /** @returns {Promise<Uint8Array>} as Place.read */
  async read(bytes) {
    return bytes;
  }
}

/** Multiplies the alpha into the colours. @param {Uint8ClampedArray} data RGBA */
function multiplyIn(data) {
  for (let i = 0; i < data.length; i += 4) {
    const alpha = data[i + 3] / OPAQUE;
    if (alpha < 1) for (let k = i; k < i + 3; k++) data[k] *= alpha;
  }
}
