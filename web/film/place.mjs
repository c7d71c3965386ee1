// SPDX-License-Identifier: MIT
// A head that is filmed: a view outside of the page, and its pixels.
import { Breath } from '../element/face/breath.mjs';
import { calibrate } from '../element/head/model/calibrate.mjs';
import { BREATH, readModel } from '../element/head/model/model.mjs';
import { Head } from '../element/head/head.mjs';
import { LEVELS } from '../element/head/quality.mjs';
import { View } from '../element/head/view.mjs';
import { Backdrop } from './backdrop.mjs';
import { layOver, Overlay } from './overlay.mjs';

const POLL_MS = 2;

/**
 * A view of a head as the job wants it, whose picture changes no more by itself.
 * @param {{height: number, level: string|null, view: string|null}} job @param {object} json of the head @param {number} width
 */
async function openView({ height, level, view: framing }, json, width) {
  const model = readModel(json);
  const view = new View(document.createElement('canvas')); // never in the page, which would draw it once more
  const head = await Head.create(model.calibration ? calibrate(model, model.calibration, 'calibration.') : model, { software: view.software });
  view.framing = framing;
  const wanted = level ?? (view.software ? 'fine' : 'high-1x');
  view.level = { ...LEVELS.find(({ name }) => name === wanted), share: 1 }; // all of the picture's pixels, none stretched
  view.show(head);
  view.resize(width, height);
  if (view.software) await head.slim();
  await head.looking;
  return { view, head };
}

/**
 * Reads pictures back while the next ones are drawn: what waits for the drawing of one picture would keep a processor idle.
 */
class Pixels {
  /** @param {WebGL2RenderingContext} gl @param {{width: number, height: number}} size */
  constructor(gl, { width, height }) {
    Object.assign(this, { gl, width, height, free: [] });
    this.bytes = new Uint8Array(4 * width * height);
  }

  /** Asks for what has been drawn. @returns {{buffer: WebGLBuffer, fence: WebGLSync}} for `read` */
  ask() {
    const { gl } = this;
    const used = this.free.pop();
    const buffer = used ?? gl.createBuffer();
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    if (!used) gl.bufferData(gl.PIXEL_PACK_BUFFER, this.bytes.length, gl.STREAM_READ);
    gl.readPixels(0, 0, this.width, this.height, gl.RGBA, gl.UNSIGNED_BYTE, 0);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    return { buffer, fence };
  }

  /** @returns {Promise<Uint8Array>} valid until the next call */
  async read({ buffer, fence }) {
    const { gl } = this;
    const done = () => gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED;
    while (!done()) await new Promise((resolve) => setTimeout(resolve, POLL_MS));
    gl.deleteSync(fence);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, this.bytes);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    this.free.push(buffer);
    return this.bytes;
  }
}

/** A head in its part of the pictures. */
export class Place {
  #drawn = null; // face and hair of the last picture
  #breath = new Breath();

  /**
   * @param {object} job width, height, level, view, still, life and shows of a Job
   * @param {{colour?: number[], image?: TexImageSource}|null} background @param {object} json of the head
   * @param {number} left @param {number} width pixels
   */
  static async open(job, background, json, left, width) {
    const { still, life } = job;
    const place = Object.assign(new Place(), await openView(job, json, width), { left, width, still, life });
    const { renderer } = place.view;
    place.view.fading = !background; // shoulders end at the picture's border
    renderer.domElement.addEventListener('webglcontextlost', () => {
      if (!place.closed) throw new Error('the browser has lost its drawing context');
    });
    const part = [left / job.width, width / job.width];
    const picture = { width: job.width, height: job.height, part, deep: !place.view.target };
    place.backdrop = background && new Backdrop(renderer, { ...picture, ...background });
    place.pixels = new Pixels(renderer.getContext(), { width, height: job.height });
    place.overlay = job.shows ? new Overlay(width, job.height, job.shows) : null;
    return place;
  }

  /** Lives on to a moment: the breath goes into the face, and hair follows the head. @param {object|null} speech for Breath */
  live(seconds, values, speech) {
    if (this.still) return;
    values[BREATH] = this.#breath.at(seconds, speech, this.life, values[48]);
    this.head.sway?.follow(values, seconds);
  }

  /** Draws a face. @param {number|null} [seconds] of the film, for hair; null: it does not sway */
  show(values, seconds = null) {
    this.head.setFaps(values, seconds);
    this.view.draw();
    this.backdrop?.draw();
  }

  close() {
    this.closed = true;
    this.view.dispose();
  }

  /** Begins to draw the face of the last moment. @returns {object|null} for `read`; null: it is drawn already */
  draw(values, seconds) {
    const shown = [...values, ...(this.head.sway?.lag ?? [])];
    if (this.#drawn?.every((value, n) => value === shown[n])) return null;
    this.#drawn = shown;
    this.show(values, this.still ? null : seconds);
    return { asked: this.pixels.ask(), over: this.overlay?.draw(this.view) };
  }

  /** @returns {Promise<Uint8Array>} RGBA with the alpha multiplied in, the lowest line first; valid until the next call */
  async read({ asked, over }) {
    const bytes = await this.pixels.read(asked);
    if (over) layOver(bytes, over);
    return bytes;
  }
}
