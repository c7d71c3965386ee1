// SPDX-License-Identifier: MIT
// Finding the landmarks of the one face in a picture. The detector is the package @vladmandic/human with three of its nets
// (face, mesh, iris); it runs in WebAssembly, in a page and in Node alike, and is given where its files lie.
import { COUNT } from './landmarks.mjs';
import { PortraitError } from './problem.mjs';

const FIRST = 640; // pixels of the longer side where the face is looked for
const CLOSE = 960; // pixels of the piece with the face: the detector's places are whole pixels
const AROUND = 0.6; // of the face's box, on each side of it
const LEAST_SCORE = 0.4;
const LEAST_FACE = 80; // pixels
const SECOND_FACE = 0.4; // of the larger face's size: a smaller one is in the background

/** @param {string} models @param {string} wasm addresses that end in "/", of the nets' files and of WebAssembly's */
export function detectorSettings(models, wasm) {
  const off = { enabled: false };
  return {
    backend: 'wasm', wasmPath: wasm, wasmPlatformFetch: true, modelBasePath: models, debug: false, async: false, cacheSensitivity: 0,
    warmup: 'none', filter: off, gesture: off, body: off, hand: off, object: off, segmentation: off,
    face: {
      enabled: true, detector: { rotation: true, maxDetected: 5, minConfidence: 0.3, return: false },
      mesh: { enabled: true }, iris: { enabled: true }, attention: off, description: off, emotion: off, antispoof: off,
        liveness: off,
    },
  };
}

/**
 * Cuts and scales a piece of a picture: each new pixel is the mean of those that it covers, or interpolates its neighbours.
 * @param {{width: number, height: number, data: ArrayLike<number>}} picture RGBA
 * @param {{x: number, y: number, size: number[]}} piece its corner, and columns and rows; pixels outside repeat the border
 * @returns {{data: Int32Array, width: number, height: number, scale: number}} RGB
 */
export function piece({ width, height, data }, { x, y, size }, longest) {
  const scale = longest / Math.max(...size);
  const [w, h] = size.map((n) => Math.max(1, Math.round(n * scale)));
  const out = new Int32Array(w * h * 3);
  const taps = Math.max(1, Math.min(8, Math.round(1 / scale)));
  for (let j = 0; j < h; j++)
    for (let i = 0; i < w; i++) {
      const sum = [0, 0, 0];
      for (let b = 0; b < taps; b++)
        for (let a = 0; a < taps; a++) {
          const u = Math.min(width - 1.001, Math.max(0, x + (i + (a + 0.5) / taps) / scale - 0.5));
          const v = Math.min(height - 1.001, Math.max(0, y + (j + (b + 0.5) / taps) / scale - 0.5));
          const [p, q] = [Math.floor(u), Math.floor(v)];
          const [fx, fy] = [u - p, v - q];
          const at = (q * width + p) * 4;
          for (let k = 0; k < 3; k++)
            sum[k] += (data[at + k] * (1 - fx) + data[at + 4 + k] * fx) * (1 - fy) +
              (data[at + width * 4 + k] * (1 - fx) + data[at + width * 4 + 4 + k] * fx) * fy;
        }
      for (let k = 0; k < 3; k++) out[(j * w + i) * 3 + k] = Math.round(sum[k] / (taps * taps));
    }
  return { data: out, width: w, height: h, scale };
}

async function look(human, { data, width, height }) {
  const tensor = human.tf.tensor3d(data, [height, width, 3], 'int32');
  try {
    const { face, error } = await human.detect(tensor);
    if (error) throw new Error(error);
    return face.filter(({ mesh, score }) => mesh?.length >= COUNT && score >= LEAST_SCORE);
  } finally {
    human.tf.dispose(tensor);
  }
}

/**
 * @param {object} human a loaded detector with detectorSettings
 * @param {{width: number, height: number, data: ArrayLike<number>}} picture RGBA, upright
 * @returns {Promise<number[][]>} of each landmark: column, row, and depth in pixels (smaller is nearer)
 * @throws {PortraitError}
 */
export async function findFace(human, picture) {
  const { width, height } = picture;
  if (Math.min(width, height) < LEAST_FACE) throw new PortraitError('too_small', `the picture has ${width} x ${height} pixels: at least ${LEAST_FACE} each way`);
  const whole = piece(picture, { x: 0, y: 0, size: [width, height] }, Math.min(FIRST, Math.max(width, height)));
  const faces = (await look(human, whole)).sort((a, b) => b.box[2] - a.box[2]);
  if (!faces.length) throw new PortraitError('no_face', 'there is no face to be found in the picture');
  const another = faces.slice(1).some(({ box }) => box[2] > SECOND_FACE * faces[0].box[2] && !within(box, faces[0].box));
  if (another) throw new PortraitError('several_faces', 'there is more than one face in the picture');
  return (await closeUp(human, picture, faces[0].box.map((n) => n / whole.scale))).landmarks;
}

/** Whether the middle of a box lies in another: then both show the same face. */
const within = ([x, y, w, h], box) => [x + w / 2, y + h / 2].every((at, k) => at > box[k] && at < box[k] + box[2 + k]);

/**
 * The same where it is known about where the face is: in a film, whose pictures follow each other.
 * @param {number[]} box column, row, width and height of the face, pixels @param {number} [longest] pixels of the piece with it
 * @returns {Promise<{landmarks: number[][], score: number}>} how sure the detector is that this is a face, 0 to 1
 * @throws {PortraitError}
 */
export async function closeUp(human, picture, [x, y, w, h], longest = CLOSE) {
  if (Math.max(w, h) < LEAST_FACE) throw new PortraitError('too_small', `the face has ${Math.round(Math.max(w, h))} pixels: at least ${LEAST_FACE}`);
  const side = Math.max(w, h) * (1 + 2 * AROUND);
  const corner = { x: x + w / 2 - side / 2, y: y + h / 2 - side / 2, size: [side, side] };
  const close = piece(picture, corner, longest);
  const [face] = (await look(human, close)).sort((a, b) => b.box[2] - a.box[2]);
  if (!face) throw new PortraitError('no_face', 'the face in the picture is not clear enough');
  const landmarks = face.mesh.slice(0, COUNT).map(([u, v, z]) =>
    [u / close.scale + corner.x, v / close.scale + corner.y, z / close.scale]);
  return { landmarks, score: face.score };
}
