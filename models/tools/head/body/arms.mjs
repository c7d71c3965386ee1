// SPDX-License-Identifier: GPL-3.0-or-later
/** Lowers the arms, which the base mesh holds out, so that shoulders fall as those of a person who sits for a portrait. */
import { smoothstep } from '../../lib/zones.mjs';

const ARMPIT = [2, -65]; // mm from the joint of the shoulder
const [BLEND, APART] = [56, 14]; // mm to either side of the line between arm and trunk: above the armpit, and some way below
const FAR = 60; // mm, that way
const DROP = 0.12; // of the turn, which the end of the collar bone makes about its root

/**
 * @param {{point: (spec: object) => number[]}} ctx @param {number} degrees by which each arm turns down
 * @returns {(q: number[]) => number[]} where a point of the body, or of what is worn on it, comes to lie
 */
export function lowered({ point }, degrees) {
  const [shoulder, elbow, root] = ['shoulder', 'elbow', 'clavicle'].map((joint) => point({ group: `joint-l-${joint}` }));
  const length = Math.hypot(elbow[0] - shoulder[0], elbow[1] - shoulder[1]);
  const arm = [(elbow[0] - shoulder[0]) / length, (elbow[1] - shoulder[1]) / length];
  const half = Math.hypot(arm[0], arm[1] - 1);
  const down = [arm[0] / half, (arm[1] - 1) / half]; // between arm and trunk
  const angle = (degrees * Math.PI) / 180;
  return ([x, y, z]) => {
    const side = x < 0 ? -1 : 1;
    const [dx, dy] = [Math.abs(x) - shoulder[0] - ARMPIT[0], y - shoulder[1] - ARMPIT[1]];
    const [out, below] = [dy * down[0] - dx * down[1], dx * down[0] + dy * down[1]];
    const wide = BLEND + (APART - BLEND) * smoothstep(0, FAR, below);
    const stays = smoothstep(shoulder[1] + 90, shoulder[1] + 40, y); // hair and neck
    const whole = smoothstep(-wide, wide, out) * stays;
    if (!whole) return [x, y, z];
    const turned = turn([Math.abs(x), y], shoulder, -angle * whole);
    const dropped = smoothstep(root[0] + 20, shoulder[0], Math.abs(x)) * smoothstep(-wide, 0, out) * stays;
    const [u, v] = turn(turned, root, -angle * DROP * dropped);
    return [side * u, v, z];
  };
}

function turn([x, y], [px, py], angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [px + c * (x - px) - s * (y - py), py + s * (x - px) + c * (y - py)];
}

/** @param {object[]} parts @param {(q: number[]) => number[]} warp moves the vertices of all of them */
export function warpParts(parts, warp) {
  for (const part of parts)
    for (let i = 0; i < part.position.length; i += 3) part.position.set(warp([...part.position.subarray(i, i + 3)]), i);
}
