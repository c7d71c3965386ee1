// SPDX-License-Identifier: MIT
// What can draw a face: heads of ours, and photographs. An avatar, whose script comes only where there is one, brings its own.
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
 * @param {object|null} model what has come; null: nothing yet
 * @param {string|null} wish the quality that is asked for @returns {Engine}
 */
export function engineOf(model, wish) {
  if (!model) return wantsPictures(wish) ? PICTURES : HEADS;
  return model.engine ?? (isPictures(model) ? PICTURES : HEADS);
}
