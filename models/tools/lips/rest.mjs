// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Finds the time of a film in which the mouth rests, for films that begin in mid-speech: the longest stretch of closed lips, seen by the
 * landmarks of single pictures.
 */
import { PortraitError } from '../../../web/portrait/problem.mjs';

const LIPS = [13, 14]; // landmarks of the lips' inner edges in the middle,
const CORNERS = [78, 308]; // and where they meet
const CLOSED = 0.065; // of the width of the mouth: touching lips are measured as up to that far apart
const CLOSED_MOST = 0.085; // of some faces, dark ones among them, measured with touching lips,
const NEARLY = 0.006; // where the closest lips of the film, and what is nearly as close, count as closed
const LOOKS = 250; // pictures looked at, from the beginning: 10 s at 25 a second
const LONGEST = 0.4; // s: enough pictures of a resting face

const apart = (points, [a, b]) => Math.hypot(points[a][0] - points[b][0], points[a][1] - points[b][1]);

/** @returns {Promise<number|null>} how far the lips are apart, as a share of the mouth's width; null: no face, or several */
async function opening(eye, picture) {
  try {
    const points = await eye(picture);
    return apart(points, LIPS) / apart(points, CORNERS);
  } catch (error) {
    if (error instanceof PortraitError) return null;
    throw error;
  }
}

const isClosed = (open, most = CLOSED) => open !== null && open < most;

/** @returns {Promise<boolean>} whether most of the pictures show closed lips */
export async function lipsClosed(eye, pictures) {
  let count = 0;
  for (const picture of pictures) count += isClosed(await opening(eye, picture));
  return 2 * count > pictures.length;
}

/** Returns the longest run of closed lips, of equal ones that with the lips closest together; without any, the picture with the closest lips. */
function longestRun(looks, fps, most) {
  let best = null;
  for (let i = 0; i < looks.length; i++) {
    if (!isClosed(looks[i].open, most)) continue;
    let end = i;
    while (isClosed(looks[end + 1]?.open ?? null, most) && (looks[end + 1].number - looks[i].number) / fps <= LONGEST) end++;
    const length = looks[end].number - looks[i].number;
    const open = looks.slice(i, end + 1).reduce((sum, look) => sum + look.open, 0) / (end + 1 - i);
    if (!best || length > best.length || (length === best.length && open < best.open)) best = { length, open, from: looks[i].number, to: looks[end].number };
  }
  if (best) return best;
  const { number, open } = looks.filter((look) => look.open !== null).reduce((a, b) => (b.open < a.open ? b : a));
  return { open, from: number, to: number };
}

/**
 * @param {AsyncIterable<{picture: object}>} pictures from the first on @param {number} fps
 * @param {(done: number) => void} tell called for each picture
 * @returns {Promise<{from: number, to: number, closed: boolean}|null>} s; closed: false if the lips are apart in every picture; null: no face in any
 */
export async function findRest(eye, pictures, fps, tell) {
  const looks = [];
  const every = Math.max(1, Math.ceil(fps / 25));
  let number = -1;
  for await (const { picture } of pictures) {
    number++;
    if (looks.length === LOOKS) break;
    tell(number + 1);
    if (number % every === 0) looks.push({ number, open: await opening(eye, picture) });
  }
  if (!looks.some(({ open }) => open !== null)) return null;
  const least = Math.min(...looks.filter(({ open }) => open !== null).map(({ open }) => open));
  const most = Math.max(CLOSED, Math.min(CLOSED_MOST, least + NEARLY));
  const { from, to, open } = longestRun(looks, fps, most);
  return { from: Math.max(0, from - 0.25) / fps, to: (to + 0.25) / fps, closed: isClosed(open, most) };
}
