// SPDX-License-Identifier: GPL-3.0-or-later
/** Runs the client's face detector (web/portrait/detect.mjs) in Node, with its files from the npm package. */
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';
import { closeUp, detectorSettings, findFace } from '../../../web/portrait/detect.mjs';

const web = new URL('../../../web/', import.meta.url);
const packages = new URL('node_modules/', web); // the pages have the same files
const folder = (name) => new URL(name, packages).href;

/** The package calls fetch, which cannot read files. Other requests are rejected, so nothing uses the network. */
async function fetchFile(address) {
  const url = String(address.url ?? address);
  if (!url.startsWith('file:')) throw new Error(`${url}: a detector of faces asks for files only`);
  const type = url.endsWith('.json') ? 'application/json' : url.endsWith('.wasm') ? 'application/wasm' : 'application/octet-stream';
  return new Response(await readFile(fileURLToPath(url)), { headers: { 'content-type': type } });
}

/** @returns {Promise<(picture: object) => Promise<number[][]>>} finds the landmarks in a picture (web/portrait/detect.mjs);
 * its member closeUp(picture, box) is for a known position of the face */
export async function openEye() {
  globalThis.fetch = fetchFile;
  const { Human } = createRequire(web)(fileURLToPath(folder('@vladmandic/human/dist/human.node-wasm.js')));
  const human = new Human(detectorSettings(folder('@vladmandic/human/models/'), folder('@tensorflow/tfjs-backend-wasm/dist/')));
  await human.load();
  return Object.assign((picture) => findFace(human, picture), { closeUp: (picture, box) => closeUp(human, picture, box) });
}
