// SPDX-License-Identifier: GPL-3.0-or-later
/** The face detector for imports: a separate file in the build, with the networks of the pages. */
import fs from 'node:fs';
import { fileURLToPath } from 'node:url';
import human from '../../../web/node_modules/@vladmandic/human/dist/human.node-wasm.js';
import { detectorSettings, findFace } from '../../../web/portrait/detect.mjs';

const pages = new URL('../../../web/', import.meta.url);
const built = fs.existsSync(new URL('blazeface.json', pages));
const folder = (name) => (built ? pages : new URL(`node_modules/${name}/`, pages)).href;

/** Replaces fetch, with which the package loads its networks, by reading files. */
async function fetchFile(address) {
  const url = String(address.url ?? address);
  if (!url.startsWith('file:')) throw new Error(`${url}: a detector of faces asks for files only`);
  const type = url.endsWith('.json') ? 'application/json' : url.endsWith('.wasm') ? 'application/wasm' : 'application/octet-stream';
  return new Response(await fs.promises.readFile(fileURLToPath(url)), { headers: { 'content-type': type } });
}

/** @returns {Promise<(picture: object) => Promise<number[][]>>} finds the landmarks in a picture (web/portrait/detect.mjs) */
export async function openEye() {
  globalThis.fetch = fetchFile;
  const one = new human.Human(detectorSettings(folder('@vladmandic/human/models'), folder('@tensorflow/tfjs-backend-wasm/dist')));
  await one.load();
  return (picture) => findFace(one, picture);
}
