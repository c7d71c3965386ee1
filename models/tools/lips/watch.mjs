// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Converts pictures of a person reading to rows of parameters (curves.mjs). The face at rest becomes a mesh of points (speaker.mjs), which is
 * fitted to each picture (lay.mjs), estimating the motion of head and lips together. LI and LS then come from the lips' edges (edges.mjs), and
 * the scale in mm from the iris.
 */
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { laid } from '../../../web/portrait/fit.mjs';
import { PortraitError } from '../../../web/portrait/problem.mjs';
import { FileError } from '../import/limits.mjs';
import { openEye } from '../portrait/eye.mjs';
import { PARAMETERS } from './articulation.mjs';
import { Edges } from './edges.mjs';
import { findRest, lipsClosed } from './rest.mjs';
import { AR, drawOf, hangOf, heldCorners, heldJaw, parted } from './parting.mjs';
import { UNKNOWNS } from '../../../web/portrait/fap-moves.mjs';
import { Layer } from '../../../web/portrait/lay.mjs';
import { landmarksOf } from '../../../web/portrait/look.mjs';
import { pictured, speakerOf } from '../../../web/portrait/speaker.mjs';

const IRIS = 11.7; // mm: the horizontal diameter of an adult's iris, within half a mm (Hashemi and others 2015)
const DRAWN_IRIS = 10.9; // mm: iris diameter of our heads, which cancels the detector's bias
const IRISES = [[469, 471], [474, 476]]; // landmarks across
const PUPILS = [[468, 473]];
const UPPER_LIP = [[0, 13]]; // landmarks that give its height at rest,
const MOUTH = [[61, 291]]; // and how wide the mouth
const MOST_FRAMES = 500000;
const REST_PICTURES = 6; // whose mean gives the look of the face
const REST = [0, 0.2]; // s: where a film rests, if its lips are closed there
const SIDEWAYS = 0.35; // rad: beyond it the detector guesses the far half of the mouth
const LOST = 0.6; // of the picture's contrast: a lower similarity is not the face

const built = fileURLToPath(new URL('../../../build/', import.meta.url));
const read = (file) => JSON.parse(fs.readFileSync(path.join(built, file), 'utf8'));
const UNSEEN = PARAMETERS.map(() => false);
const STILL = new Float64Array(UNKNOWNS.length);
const turnOf = ({ turn }) => Math.asin(Math.max(-1, Math.min(1, turn[0][2])));

function baseHead(name) {
  try {
    return { json: read(`models/heads/${name}.json`), points: read('web/face-points.json')[name] };
  } catch (error) {
    throw new FileError('', `${name}: there is no such head built (${error.message})`);
  }
}

/** Returns the mean distance of pairs of landmarks. */
const apart = (points, pairs) => pairs.reduce((sum, [a, b]) => sum + Math.hypot(points[a][0] - points[b][0], points[a][1] - points[b][1]), 0) / pairs.length;

/** Returns pictures with the mouth at rest. */
async function restPictures(pictures, fps, [from, to]) {
  const found = [];
  let number = 0;
  for await (const { picture } of pictures) {
    const time = number++ / fps;
    if (time > to) break;
    if (time >= from && found.length < REST_PICTURES) found.push(picture);
  }
  return found;
}

/** @returns {Promise<object|null>} null: no person in the picture, or several */
async function landmarksIn(eye, picture, tell) {
  try {
    return await landmarksOf(eye, picture);
  } catch (error) {
    if (!(error instanceof PortraitError)) throw error;
    tell(error.message);
    return null;
  }
}

class Watcher {
  #now = null; // position of the face in the previous picture

  constructor(eye, base) {
    Object.assign(this, { eye, base });
  }

  /** Learns the face. @returns {Promise<boolean>} whether there is one */
  async know(pictures, tell) {
    let landmarks = null;
    let first = 0;
    for (; first < pictures.length && !landmarks; first++) landmarks = await landmarksIn(this.eye, pictures[first], tell);
    if (!landmarks) return false;
    const speaker = speakerOf(this.base.json, this.base.points, landmarks);
    this.layer = new Layer(speaker);
    this.#now = { stand: speaker, q: STILL };
    this.face = laid(landmarks, this.base.points).points;
    this.look = this.layer.seen(pictures[first - 1], speaker, STILL);
    const looks = [this.look];
    const stands = [{ picture: pictures[first - 1], stand: speaker }];
    for (const picture of pictures.slice(first)) {
      const { stand } = this.layer.lay(picture, this.look, this.#now);
      looks.push(this.layer.seen(picture, stand, STILL));
      stands.push({ picture, stand });
    }
    this.edges = new Edges(speaker.skin);
    this.edges.know(stands);
    this.ends = { hang: hangOf(apart(this.face, UPPER_LIP) / apart(this.face, MOUTH)), draw: drawOf(speaker.skin) };
    this.look = this.look.map((planes, l) => planes.map((plane, k) => plane.map((_, i) => looks.reduce((sum, look) => sum + look[l][k][i], 0) / looks.length)));
    this.contrast = Math.sqrt(this.look.at(-1)[0].reduce((sum, x) => sum + (x * x || 0), 0) / speaker.count);
    return true;
  }

  /** mm per mm of the base head. @param {number} [pupils] the person's pupil distance in mm, if known, which is measured more accurately than an iris */
  scale(iris, pupils) {
    const { points: { seen }, json } = this.base;
    const [pairs, own, drawn] = pupils ? [PUPILS, pupils, json.fapu.ES] : [IRISES, iris, DRAWN_IRIS];
    return (own / drawn) * (apart(seen, pairs) / apart(this.face, pairs));
  }

  /** @returns {Promise<{values: number[], seen: boolean[], doubt: number, confidence: number, sideways: number}|null>} */
  async watch(picture, tell) {
    let found = this.#now && this.layer.lay(picture, this.look, this.#now);
    if (!found || found.unlike > LOST * this.contrast) {
      const landmarks = await landmarksIn(this.eye, picture, tell);
      found = landmarks && this.layer.lay(picture, this.look, { stand: pictured(landmarks, this.base.points), q: STILL });
      if (found?.unlike > LOST * this.contrast) {
        tell('it does not look like the face at rest');
        found = null;
      }
    }
    this.#now = found;
    if (!found) return null;
    const { q, seen } = parted(found.q, this.ends, (rises, falls) => this.edges.seen(picture, found.stand, rises, falls));
    return { values: q.slice(0, PARAMETERS.length), seen, doubt: found.doubt(AR), confidence: 1 - found.unlike / this.contrast, sideways: Math.abs(turnOf(found.stand)) };
  }
}

/**
 * Returns pictures of the face at rest: those of the given time; otherwise the first ones if their lips are closed; otherwise those where a
 * search finds closed lips.
 * @returns {Promise<{rest: number[], still: object[], notes: string[]}>} rest: from, to (s)
 */
async function restOf(eye, pictures, fps, given, tell) {
  const first = await restPictures(pictures(), fps, given ?? REST);
  if (given || (await lipsClosed(eye, first))) return { rest: given ?? REST, still: first, notes: [] };
  const found = await findRest(eye, pictures(), fps, (done) => tell('looking for the mouth at rest', done));
  if (!found) return { rest: REST, still: first, notes: [] };
  const rest = [found.from, found.to];
  const where = `${rest.map((t) => t.toFixed(2)).join(' to ')} s`;
  const notes = [found.closed
    ? `the mouth does not rest at the beginning: ${where}, where the lips are closed, is taken for rest; --rest says another time`
    : `the lips are closed in no picture: ${where}, where they are least open, is taken for rest, and openings are too small; --rest says another time`];
  return { rest, still: await restPictures(pictures(), fps, rest), notes };
}

/**
 * @param {() => AsyncIterable<{picture: object, name: string, count?: number}>} yields the pictures from the first on, each time it is called
 * @param {{fps: number, rest?: number[], iris?: number, pupils?: number, like?: string, tell?: (what: string, done: number, count?: number) => void}} options
 *   rest: from, to (s), found when left out; like: the head whose lip movements serve as the model
 * @returns {Promise<{rows: object[], rest: number[], notes: string[]}>} rows without values where there is no face; seen: of each parameter whether
 *   the picture shows it (parting.mjs)
 */
export async function watchLips(pictures, { fps, rest: given, iris = IRIS, pupils, like = 'mara', tell = () => {} }) {
  const eye = await openEye();
  const watcher = new Watcher(eye, baseHead(like));
  const reasons = [];
  const { rest, still, notes } = await restOf(eye, pictures, fps, given, tell);
  if (!(await watcher.know(still, (why) => reasons.push(why))))
    throw new FileError('', `there is no face from ${rest.join(' to ')} s, while the mouth rests (${reasons[0] ?? 'no pictures'}): --rest says another time`);
  const scale = watcher.scale(iris, pupils);
  const rows = [];
  const without = new Map(); // why -> frames
  let turned = 0;
  for await (const { picture, name, count } of pictures()) {
    if (rows.length === MOST_FRAMES) throw new FileError(name, `more than ${MOST_FRAMES} pictures`);
    let why = '';
    const seen = await watcher.watch(picture, (told) => (why = told));
    const aside = seen?.sideways > SIDEWAYS;
    if (aside) turned++;
    if (!seen) without.set(why, [...(without.get(why) ?? []), rows.length + 1]);
    rows.push({ time: rows.length / fps, values: seen && seen.values.map((x) => x * scale), confidence: seen ? Math.max(0, seen.confidence) / (aside ? 2 : 1) : 0, seen: seen?.seen ?? UNSEEN, doubt: seen?.doubt });
    tell('following the lips', rows.length, count);
  }
  notes.push(...[...without].map(([why, list]) => `${list.length} frames without (from frame ${list[0]}): ${why}`));
  if (turned) notes.push(`${turned} frames from the side: less is to be believed of them, their confidence is halved`);
  const corners = heldCorners(rows);
  if (!corners.held) notes.push('the skin is too even for the corners of the mouth to be followed: AR is not seen');
  const jaw = heldJaw(corners.rows);
  if (!jaw.held) notes.push('the jaw leaps wherever the lips touch or part, as the skin of the chin is too even to show it: EM is not seen');
  return { rows: jaw.rows, rest, notes };
}
