// SPDX-License-Identifier: GPL-3.0-or-later
/** Long hair: it falls from a parting to both sides, hangs, and lies on what it meets. */
import { cross, dot, plus, unit } from '../../lib/vector.mjs';
import { smoothstep } from '../../lib/zones.mjs';
import { noise } from '../paint/noise.mjs';
import { along, azimuth } from './skull.mjs';

const STEP = 8; // mm
const SUNK = 0.8; // mm that a root lies below the skin
const RISES = 38; // mm from the root on, over which hair comes to its height above the skin
const FALLS = 70; // mm from the root on, over which its weight comes to count
const LOOSE = [70, 10]; // mm above the eyes, between which the comb ceases to
const FACE = -50; // mm: in front of it, hair leaves the face free
const SIDES = [-60, -120]; // mm above the eyes, between which it goes before or behind the shoulders
const NEAR = 3; // mm from what it lies on
const SMOOTHED = 14; // times
const CLEARED = 3; // times that it is lifted over what it goes through, and smoothed
const STRETCHED = 0.6; // of its length that a hair reaches from its root at least
const LEAST = 1.9; // mm above the skin, so that cards, which are flat, stay outside of it
const OVER = 8; // mm above clothes, more than above the skin
const ABOVE = 0.7; // of its height above the skin, that it keeps when it has been smoothed
const STRAIGHT = [25, 130]; // mm from the root on, over which waves begin
const SWAYS = [45, 190]; // mm from the root on, between which it comes to lag behind the head
const HIGH = [70, -30]; // mm above the eyes, between which it comes to do so, too
const FREE = [1, 14]; // mm from the body, between which it is free to

/** mm to the left of the parting. @param {{x: number, behind: number}} parting */
export const beside = ({ x, behind }, q) => q[0] - x * smoothstep(behind - 25, behind + 10, q[2]);

/**
 * @param {number[]} root @param {object} layer of growHair @param {{skull: object, style: object, roll: () => number, combed: Function}} scene
 * @returns {{spine: number[][], sway: number[]}|null} sway: how much of each point lags behind the head
 */
export function hangingHair(root, layer, { skull, style, roll, combed }) {
  const { parting, clear: face, front, curl = [0, 1], waves = [0, 1], split = 80 } = style.hangs;
  const side = beside(parting, root) < 0 ? -1 : 1;
  const top = smoothstep(40, 85, root[1]);
  const here = ([sides, crown = sides]) => sides + top * (crown - sides);
  const length = layer.length[0] + (layer.length[1] - layer.length[0]) * roll();
  const lift = here(layer.lift) * (0.6 + 0.8 * roll());
  const stray = [0, 1, 2].map(() => (roll() - 0.5) * 2 * (layer.wild ?? 0.2));
  const before = azimuth(root) + 24 * (roll() - 0.5) < split ? 1 : -1;
  const wider = 6 * roll();
  const end = (q) => along(style.cut, azimuth(q)) + (style.ragged ?? 8) * (stray[0] + stray[1]);
  let q = skull.lifted(root, -SUNK);
  let way = unit(plus(plus(combed(style.comb, q, skull.normal(q), side), stray), skull.normal(q), here(layer.rise) * (0.7 + 0.6 * roll())));
  const spine = [q];
  for (let gone = STEP; gone < length; gone += STEP) {
    q = plus(q, way, STEP);
    const short = heightAt(lift, gone) - skull.height(q);
    if (short > 0) q = skull.lifted(q, short);
    if (q[2] > FACE) {
      const half = along(face, q[1]) + wider;
      const back = q[2] - along(front, q[1]);
      if (gone > RISES / 2 && back > 0) q[2] -= Math.min(back, 0.5 * STEP);
      if (gone > RISES / 2 && q[1] < face.at(-1)[0] && side * q[0] < half) q[0] += side * Math.min(half - side * q[0], STEP);
    }
    if (q[1] < end(q)) break;
    spine.push(q);
    const n = skull.normal(q);
    const loose = smoothstep(LOOSE[0], LOOSE[1], q[1]);
    let wanted = plus(plus([0, 0, 0], combed(style.comb, q, n, side), 1 - loose), [0, -1, 0], (layer.fall ?? 1) * smoothstep(0, FALLS, gone) + loose);
    wanted = plus(wanted, stray, 0.4);
    wanted = plus(wanted, [0.25 * side * before, 0, 0.9 * before], 0.7 * smoothstep(SIDES[0], SIDES[1], q[1]));
    if (q[1] < SIDES[0] && short > -NEAR) wanted = plus(wanted, [-0.6 * side, 0, 1.4 * before]); // it slides off the shoulder
    wanted = plus(wanted, n, -curl[0] * smoothstep(curl[1], 0, q[1] - end(q)));
    way = unit(plus(way.map((x) => (1 - layer.lay) * x), unit(wanted), layer.lay));
    const leaves = dot(way, n);
    if (leaves > 0 && gone > RISES && n[1] > 0.15) way = unit(plus(way, n, -leaves * layer.lay));
  }
  if (spine.length < 3 || stuck(spine)) return null;
  const clear = (p, i) => {
    const low = heightAt(ABOVE * lift, i * STEP) + OVER * smoothstep(SIDES[0], SIDES[1], p[1]) - skull.height(p);
    return i && low > 0 ? skull.lifted(p, low) : p;
  };
  let smooth = waved(smoothed(spine, SMOOTHED), skull, waves, roll).map(clear);
  for (let pass = 0; pass < CLEARED; pass++) smooth = smoothed(smooth, 2).map(clear); // what was lifted in one place has no kink
  return { spine: smooth, sway: smooth.map((p, i) => smoothstep(SWAYS[0], SWAYS[1], i * STEP) * smoothstep(HIGH[0], HIGH[1], p[1]) * smoothstep(FREE[0], FREE[1], skull.height(p))) };
}

/** Whether a hair has come to lie on a shoulder, where it would end in a tuft. */
const stuck = (spine) => Math.hypot(...spine[0].map((x, k) => x - spine.at(-1)[k])) < STRETCHED * STEP * (spine.length - 1);

/** mm above the skin that hair has at least, so many mm from its root. */
const heightAt = (lift, gone) => Math.max(LEAST * smoothstep(0, 2 * STEP, gone), lift * (0.4 + 0.6 * smoothstep(0, RISES, gone)));

function smoothed(spine, times) {
  let out = spine;
  for (let pass = 0; pass < times; pass++)
    out = out.map((q, i) => (i && i < out.length - 1 ? q.map((x, k) => (2 * x + out[i - 1][k] + out[i + 1][k]) / 4) : q));
  return out;
}

/** Waves that neighbours share, so that they lie in each other. */
function waved(spine, skull, [wide, long], roll) {
  if (!wide) return spine;
  const [x, y, z] = spine[0];
  const phase = 2.4 * noise(x / 30, y / 30, z / 30) + 0.5 * (roll() - 0.5);
  return spine.map((q, i) => {
    const way = unit(plus(spine[Math.min(spine.length - 1, i + 1)], spine[Math.max(0, i - 1)], -1));
    const n = skull.normal(q);
    const angle = (2 * Math.PI * i * STEP) / long + phase;
    const mm = wide * smoothstep(STRAIGHT[0], STRAIGHT[1], i * STEP);
    return plus(plus(q, unit(cross(way, n)), mm * Math.sin(angle)), n, 0.5 * mm * (1 + Math.cos(angle)));
  });
}
