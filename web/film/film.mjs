// SPDX-License-Identifier: MIT
/**
 * The page that `faccia film` opens: draws the pictures of a film one after the other, on the film's own clock, as fast as it
 * can. The job, the head and the faces lie beside it. Pictures leave by a WebSocket as pixels (RGBA with the alpha multiplied
 * in, the lowest line first); an empty message is a picture like the one before. The answer is the number of pictures taken.
 */
import { FAP_VALUES, FaceTrack } from '../element/face/face-track.mjs';
import { calibrate } from '../element/head/model/calibrate.mjs';
import { readModel } from '../element/head/model/model.mjs';
import { Head } from '../element/head/head.mjs';
import { LEVELS } from '../element/head/quality.mjs';
import { View } from '../element/head/view.mjs';
import { Backdrop } from './backdrop.mjs';

const DRAWING = 2; // pictures that are drawn while others are read back
const POLL_MS = 2;

/**
 * @typedef {object} Job
 * @property {number} width @property {number} height pixels
 * @property {string} level of quality, as in LEVELS @property {string|null} view
 * @property {string|null} colour of the background, as in CSS @property {boolean} image whether the background is an image
 * @property {number} rate faces per second of their track @property {number} fps pictures per second
 * @property {number} start time of the first picture, seconds @property {number} count pictures
 * @property {number} ahead pictures that may be on their way
 */

const fetched = async (name) => {
  const answer = await fetch(name);
  if (!answer.ok) throw new Error(`${name}: ${answer.status}`);
  return answer;
};

/** @param {string} colour as in CSS @returns {number[]} red, green, blue, 0 to 1 */
function readColour(colour) {
  if (!CSS.supports('color', colour)) throw new Error(`the background '${colour}' is neither a file nor a colour`);
  const canvas = Object.assign(document.createElement('canvas'), { width: 1, height: 1 });
  const context = canvas.getContext('2d');
  context.fillStyle = colour;
  context.fillRect(0, 0, 1, 1);
  const [red, green, blue, alpha] = context.getImageData(0, 0, 1, 1).data;
  if (alpha < 255) throw new Error(`the background '${colour}' lets light through: 'transparent', or a colour that hides all`);
  return [red, green, blue].map((value) => value / 255);
}

/** @param {Job} job @returns {Promise<{colour?: number[], image?: ImageBitmap}|null>} null: there is none */
async function backgroundOf({ colour, image }) {
  if (!image) return colour ? { colour: readColour(colour) } : null;
  const bytes = await (await fetched('background.bin')).blob();
  return { image: await createImageBitmap(bytes).catch(() => {
    throw new Error('the background is no image that the browser reads');
  }) };
}

/** @param {ArrayBuffer} bytes 32-bit integers, FAP_VALUES for each face */
function trackOf(bytes, rate) {
  const all = new Int32Array(bytes);
  const track = new FaceTrack(rate);
  track.put(0, Array.from({ length: all.length / FAP_VALUES }, (_, k) => all.subarray(k * FAP_VALUES, (k + 1) * FAP_VALUES)));
  return track;
}

/** A view of the head as the job wants it, whose picture changes no more by itself. @param {Job} job */
async function open({ width, height, level, view: framing }) {
  const model = readModel(await (await fetched('model.json')).json());
  const view = new View(document.querySelector('canvas'));
  view.renderer.domElement.addEventListener('webglcontextlost', () => {
    throw new Error('the browser has lost its drawing context');
  });
  const head = await Head.create(model.calibration ? calibrate(model, model.calibration, 'calibration.') : model, { software: view.software });
  view.framing = framing;
  view.level = LEVELS.find(({ name }) => name === level);
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
    const buffer = this.free.pop() ?? gl.createBuffer();
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.bufferData(gl.PIXEL_PACK_BUFFER, this.bytes.length, gl.STREAM_READ);
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

/** Draws the pictures of a film, and hands them on. */
class Film {
  /** @param {WebSocket} socket */
  constructor(socket) {
    this.socket = socket;
    this.begun = 0;
    this.taken = 0;
    this.waiting = () => {};
    socket.addEventListener('message', ({ data }) => {
      this.taken = Number(data);
      this.waiting();
    });
  }

  async #room(ahead) {
    while (this.begun - this.taken >= ahead) await new Promise((resolve) => (this.waiting = resolve));
  }

  /** @param {Job} job */
  async run(job) {
    const faces = await (await fetched('faces.bin')).arrayBuffer();
    const background = await backgroundOf(job);
    const { view, head } = await open(job);
    const backdrop = background && new Backdrop(view.renderer, { ...job, colour: undefined, image: undefined, ...background });
    const track = trackOf(faces, job.rate);
    const values = new Float32Array(FAP_VALUES);
    const pixels = new Pixels(view.renderer.getContext(), job);
    const pending = []; // pictures that are being drawn; null: one like the one before
    for (let k = 0; k < job.count; k++) {
      await this.#room(job.ahead);
      const before = values.slice();
      track.sample(Math.min(track.last / job.rate, job.start + k / job.fps), values);
      const same = k > 0 && values.every((value, n) => value === before[n]);
      if (!same) {
        head.setFaps(values);
        view.draw();
        backdrop?.draw();
      }
      pending.push(same ? null : pixels.ask());
      this.begun++;
      if (pending.length > DRAWING) await this.#deliver(pixels, pending.shift());
    }
    for (const one of pending) await this.#deliver(pixels, one);
  }

  async #deliver(pixels, picture) {
    this.socket.send(picture ? await pixels.read(picture) : new Uint8Array(0));
  }
}

const socket = new WebSocket(new URL('pictures', location.href.replace('http', 'ws')));
const fail = (error) => socket.send(JSON.stringify({ error: error?.message ?? String(error) }));
addEventListener('error', ({ error, message }) => fail(error ?? message));
addEventListener('unhandledrejection', ({ reason }) => fail(reason));
socket.addEventListener('open', async () => new Film(socket).run(await (await fetched('job.json')).json()));
