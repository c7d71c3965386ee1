// SPDX-License-Identifier: GPL-3.0-or-later
/** From pictures of a person who reads to rows of parameters (curves.mjs): landmarks in each, the head's motion taken out, mm from the iris. */
import fs from 'node:fs';
import { PortraitError } from '../../../web/src/portrait/problem.mjs';
import { FileError } from '../import/file-error.mjs';
import { openEye } from '../portrait/eye.mjs';
import { PARAMETERS } from './articulation.mjs';
import { boxOf, looksAt, mean, median } from './look.mjs';
import { laidFace, plainly, shapeOf, STILL } from './seen.mjs';

const IRIS = 11.7; // mm: the horizontal diameter of an adult's, within half a mm (Hashemi and others 2015)
const MOST_FRAMES = 500000;
const TEMPLATE = 25; // pictures whose mean says what face it is
const SIDEWAYS = 0.35; // rad: beyond it the far half of the mouth is guessed

const habits = JSON.parse(fs.readFileSync(new URL('habits.json', import.meta.url), 'utf8'));

/** What is kept of a look: the still points, and the shape; the landmarks themselves would fill the memory. */
class Watcher {
  rows = [];

  irises = [];

  #waiting = []; // of the first pictures, until the face is known

  #face = habits.face;

  #known = false;

  /** @param {boolean} plain whether the landmarks count as they are */
  constructor(plain) {
    this.plain = plain;
  }

  add(row, looks) {
    this.rows.push(row);
    if (!looks) return;
    if (this.#known) this.#measure(row, looks);
    else if (this.#waiting.push([row, looks]) === TEMPLATE) this.know();
  }

  know() {
    const shapes = this.#waiting.flatMap(([, looks]) => looks.map((look) => laidFace(look, habits.face).points));
    if (shapes.length) this.#face = STILL.map((number) => [0, 1, 2].map((k) => shapes.reduce((sum, points) => sum + points[number][k], 0) / shapes.length));
    for (const [row, looks] of this.#waiting) this.#measure(row, looks);
    this.#known = true;
    this.#waiting = [];
  }

  #measure(row, looks) {
    const laid = looks.map((look) => laidFace(look, this.#face));
    this.irises.push(...laid.map(({ iris }) => iris));
    row.sideways = Math.max(...laid.map(({ yaw }) => Math.abs(yaw)));
    row.values = this.plain ? mean(laid.map(({ points }) => plainly(points))) : told(mean(laid.map(({ points }) => shapeOf(points))));
  }
}

const told = (shape) => PARAMETERS.map((name) => habits.weights[name].reduce((sum, weight, i) => sum + weight * shape[i], 0));

/**
 * @param {AsyncIterable<{picture: object, name: string, count?: number}>} pictures
 * @param {{fps: number, iris?: number, plain?: boolean, tell?: (done: number, count?: number) => void}} options
 * @returns {Promise<{rows: object[], notes: string[]}>} rows without values where there is no face
 */
export async function watchLips(pictures, { fps, iris = IRIS, plain = false, tell = () => {} }) {
  const eye = await openEye();
  const watcher = new Watcher(plain);
  const without = new Map(); // why -> frames
  let before = null;
  for await (const { picture, name, count } of pictures) {
    const row = { time: watcher.rows.length / fps, values: null, confidence: 0 };
    if (watcher.rows.length === MOST_FRAMES) throw new FileError(name, `more than ${MOST_FRAMES} pictures`);
    try {
      const { looks, score } = await looksAt(eye, picture, before).catch((error) => {
        if (before && error instanceof PortraitError) return looksAt(eye, picture, null); // it has moved on
        throw error;
      });
      before = boxOf(looks.at(-1));
      row.confidence = score;
      watcher.add(row, looks);
    } catch (error) {
      if (!(error instanceof PortraitError)) throw error;
      before = null;
      without.set(error.message, [...(without.get(error.message) ?? []), watcher.rows.length + 1]);
      watcher.add(row, null);
    }
    tell(watcher.rows.length, count);
  }
  watcher.know();
  return finished(watcher, iris, without);
}

function finished({ rows, irises }, iris, without) {
  const notes = [...without].map(([why, list]) => `${list.length} frames without (from frame ${list[0]}): ${why}`);
  if (!irises.length) return { rows, notes };
  const scale = iris / median(irises);
  let turned = 0;
  for (const row of rows) {
    if (!row.values) continue;
    row.values = row.values.map((x) => x * scale);
    if (row.sideways > SIDEWAYS) {
      row.confidence /= 2;
      turned++;
    }
  }
  if (turned) notes.push(`${turned} frames from the side: less is to be believed of them, their confidence is halved`);
  return { rows, notes };
}
