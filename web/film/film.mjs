// SPDX-License-Identifier: MIT
/**
 * The page that `faccia film` opens: draws the pictures of a film one after the other, on the film's own clock, as fast as it
 * can. The job, the heads and the faces lie beside it. Pictures leave by a WebSocket as pixels (RGBA with the alpha multiplied
 * in, the lowest line first); an empty message is a picture like the one before. The answer is the number of pictures taken.
 */
import { FAP_VALUES, FaceTrack } from '../element/face/face-track.mjs';
import { isPictures } from '../element/pictures/set.mjs';
import { roomImage } from './backdrop.mjs';
import { Duet, readWords } from './duet.mjs';
import { moments } from './moments.mjs';
import { PicturesPlace } from './pictures-place.mjs';
import { Place } from './place.mjs';

const ROOM = 'room'; // a background
const DRAWING = 2; // pictures that are drawn while others are read back

/**
 * @typedef {object} Job
 * @property {number} width @property {number} height pixels
 * @property {string} level of quality, as in LEVELS @property {string|null} view
 * @property {string|null} colour of the background, as in CSS, or `room`
 * @property {boolean} image whether the background is an image
 * @property {number} rate faces per second of their track @property {number} fps pictures per second
 * @property {number} start time of the first picture, seconds @property {number} count pictures
 * @property {number} ahead pictures that may be on their way
 * @property {boolean} pair whether there are two heads, side by side @property {boolean} still only their lips move
 * @property {number} life how deeply they breathe, 0 to 1
 * @property {{mesh: boolean, points: boolean, zone: number}|null} shows what is drawn over the face: see AnatomyPainter
 */

const fetched = async (name) => {
  const answer = await fetch(name);
  if (!answer.ok) throw new Error(`${name}: ${answer.status}`);
  return answer;
};

const json = async (name) => (await fetched(name)).json();

/** @param {string} colour as in CSS @returns {number[]} red, green, blue, 0 to 1 */
function readColour(colour) {
  if (!CSS.supports('color', colour)) throw new Error(`the background '${colour}' is neither a file, nor a colour, nor 'room'`);
  const canvas = Object.assign(document.createElement('canvas'), { width: 1, height: 1 });
  const context = canvas.getContext('2d');
  context.fillStyle = colour;
  context.fillRect(0, 0, 1, 1);
  const [red, green, blue, alpha] = context.getImageData(0, 0, 1, 1).data;
  if (alpha < 255) throw new Error(`the background '${colour}' lets light through: 'transparent', or a colour that hides all`);
  return [red, green, blue].map((value) => value / 255);
}

/** @param {Job} job @returns {Promise<{colour?: number[], image?: TexImageSource}|null>} null: there is none */
async function backgroundOf({ colour, image, width, height }) {
  if (colour === ROOM) return { image: roomImage(width, height) };
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

/** A head, or a set of pictures, in its part of the width. @param {string} name of its file */
async function openPlace(job, background, name, left, width) {
  const model = await json(name);
  return (isPictures(model) ? PicturesPlace : Place).open(job, background, model, left, width);
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
    const background = await backgroundOf(job);
    const middle = job.width >> 1;
    this.places = job.pair
      ? [await openPlace(job, background, 'model.json', 0, middle), await openPlace(job, background, 'partner.json', middle, job.width - middle)]
      : [await openPlace(job, background, 'model.json', 0, job.width)];
    this.whole = job.pair ? new Uint8Array(4 * job.width * job.height) : null;
    const facesAt = await this.#faces(job);
    const pending = []; // pictures that are being drawn, by place
    for (const { time, shown } of moments(job)) {
      const faces = facesAt(time);
      this.places.forEach((place, i) => place.live(time, faces[i].values, faces[i].speech));
      if (!shown) continue;
      await this.#room(job.ahead);
      pending.push(this.places.map((place, i) => place.draw(faces[i].values, time)));
      this.begun++;
      if (pending.length > DRAWING) await this.#deliver(pending.shift());
    }
    for (const one of pending) await this.#deliver(one);
  }

  /**
   * @param {Job} job
   * @returns {Promise<(time: number) => {values: Float32Array, speech: object|null}[]>} the face of each place at a moment, one
   *   moment after the other; speech: what it says, for Breath
   */
  async #faces(job) {
    const track = trackOf(await (await fetched('faces.bin')).arrayBuffer(), job.rate);
    const end = track.last / job.rate;
    if (!job.pair) {
      const values = new Float32Array(FAP_VALUES);
      return (time) => {
        track.sample(Math.min(end, time), values);
        return [{ values, speech: { track, seconds: time } }];
      };
    }
    const duet = new Duet(track, readWords(await (await fetched('words.vtt')).text()), job.still);
    return (time) => {
      const faces = duet.at(Math.min(end, time));
      return faces.map((values, i) => ({ values, speech: i === duet.speaker ? { track, seconds: time } : null }));
    };
  }

  /** @param {(object|null)[]} pictures by place */
  async #deliver(pictures) {
    let changed = null;
    for (const [i, picture] of pictures.entries()) {
      if (!picture) continue;
      const { left, width } = this.places[i];
      changed = await this.places[i].read(picture);
      if (this.whole) this.#put(changed, left, width);
    }
    this.socket.send(changed ? (this.whole ?? changed) : new Uint8Array(0));
  }

  /** Puts the pixels of a place into the picture. */
  #put(bytes, left, width) {
    const { whole, places } = this;
    const row = 4 * places.reduce((sum, place) => sum + place.width, 0);
    for (let from = 0, to = 4 * left; from < bytes.length; from += 4 * width, to += row)
      whole.set(bytes.subarray(from, from + 4 * width), to);
  }
}

const socket = new WebSocket(new URL('pictures', location.href.replace('http', 'ws')));
const fail = (error) => socket.send(JSON.stringify({ error: error?.message ?? String(error) }));
addEventListener('error', ({ error, message }) => fail(error ?? message));
addEventListener('unhandledrejection', ({ reason }) => fail(reason));
socket.addEventListener('open', async () => new Film(socket).run(await json('job.json')));
