// SPDX-License-Identifier: GPL-3.0-or-later
/** Looks at closed lids from the front: coarse ones may leave a slit, through which the eye is seen. Turns them further then. */
import { pose, unpack } from '../../lib/deform.mjs';
import { viewOf } from '../face/views.mjs';

const SIDES = [{ side: 'left', eye: 'eye_l', pupil: '3.5', upper: 19, lower: 21 }, { side: 'right', eye: 'eye_r', pupil: '3.6', upper: 20, lower: 22 }];
const SHUT = { upper: 940, lower: 84 }; // of a blink
const WIDE = 44; // mm around an eye
const SIZE = 132; // pixels: 3 for a mm
const OPEN = 0.03; // of the eye that is seen at rest: more is a slit
const FURTHER = [1.1, 1.2, 1.3, 1.45]; // of the angle
const COVER = /^(skin|mouth|eye_)/; // lashes and hair are not dense

/** Triangles with a corner near a place. */
function near({ position, index }, [x, y]) {
  const isNear = (v) => Math.abs(position[3 * v] - x) < WIDE && Math.abs(position[3 * v + 1] - y) < WIDE;
  const kept = [];
  for (let t = 0; t < index.length; t += 3) if (isNear(index[t]) || isNear(index[t + 1]) || isNear(index[t + 2])) kept.push(index[t], index[t + 1], index[t + 2]);
  return kept;
}

/** A measure of an eye: how many pixels of it are seen with the lids open or shut; null without an eye, or with one that is seen through. */
function eyeSeen(head, { eye, pupil, upper, lower }) {
  const middle = head.fdp[pupil];
  const parts = head.parts.filter(({ name }) => COVER.test(name)).map((part) => ({ ...part, index: near(part, middle) })).filter(({ index }) => index.length);
  const which = parts.findIndex(({ name }) => name === eye);
  if (which < 0 || head.materials[parts[which].material].alpha !== 'opaque') return null;
  return (turns, faps) => {
    const meshes = parts.map((part) => ({ position: pose({ ...head, turns }, part, faps), index: part.index, color: null, ball: null }));
    const view = viewOf(meshes, { middle, width: WIDE, yaw: 0 }, SIZE);
    let count = 0;
    for (let v = 0; v < SIZE; v++) for (let u = 0; u < SIZE; u++) count += view.at(u, v)?.mesh === which;
    return count;
  };
}

/**
 * Turns lids further whose eyes are seen when they are closed.
 * @param {object} json a head (protocol/head-model.md) @returns {{head: object, notes: string[]}}
 */
export function closeLids(json) {
  const head = unpack(json);
  const notes = [];
  let { turns } = json;
  for (const one of SIDES) {
    const seen = eyeSeen(head, one);
    const atRest = seen?.(head.turns, {});
    if (!atRest) continue;
    const turned = (list, by) => list.map((turn) => ([one.upper, one.lower].includes(turn.fap) ? { ...turn, radians: Number((turn.radians * by).toPrecision(9)) } : turn));
    const left = (by) => seen(turned(head.turns, by), { [one.upper]: SHUT.upper, [one.lower]: SHUT.lower }) / atRest;
    const before = left(1);
    let best = { by: 1, left: before };
    for (const by of FURTHER) {
      if (best.left <= OPEN) break;
      const now = left(by);
      if (now < best.left) best = { by, left: now };
    }
    const share = (x) => `${Math.round(100 * x)} %`;
    if (best.by > 1) notes.push(`the closed ${one.side} lids left ${share(before)} of the eye open: they turn ${share(best.by - 1)} further`);
    if (best.left > OPEN) notes.push(`the closed ${one.side} lids leave ${share(best.left)} of the eye open`);
    turns = turned(turns, best.by);
  }
  return { head: notes.length ? { ...json, turns } : json, notes };
}
