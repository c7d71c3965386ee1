// SPDX-License-Identifier: MIT
// Engines that draw a face: our heads, and photographs. An avatar's engine is in a script that is loaded on demand.
import { Head } from '../head/head.mjs';
import { View } from '../head/view.mjs';
import { wantsPictures } from '../pictures/choice.mjs';
import { Pictures, PicturesView } from '../pictures/pictures-view.mjs';
import { isPictures } from '../pictures/set.mjs';

/**
 * @typedef {object} Engine
 * @property {boolean} turns whether the face can be seen from the side
 * @property {(canvas: HTMLCanvasElement) => View} view
 * @property {(model: object, options: {software: boolean}) => Promise<Head>} head
 */

/** @type {Engine} */
const HEADS = { turns: true, view: (canvas) => new View(canvas), head: (model, options) => Head.create(model, options) };

/** @type {Engine} */
const PICTURES = { turns: false, view: (canvas) => new PicturesView(canvas), head: (model) => Pictures.create(model) };

/**
 * @param {object|null} model null: not loaded yet
 * @param {string|null} wish the attribute `quality` @returns {Engine}
 */
export function engineOf(model, wish) {
  if (!model) return wantsPictures(wish) ? PICTURES : HEADS;
  return model.engine ?? (isPictures(model) ? PICTURES : HEADS);
}
