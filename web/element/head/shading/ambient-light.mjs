// SPDX-License-Identifier: MIT
// How much light reaches the vertices of a head: of the open sky and of each lamp.
import { deform } from '../mesh/deform.mjs';
import { bakeOcclusion } from './occlusion.mjs';
import { opaqueOfPart } from '../mesh/opacity.mjs';
import { LIT_POSE, SHADOW_POSE } from '../mesh/poses.mjs';
import { sliced } from '../mesh/slices.mjs';
import { CLEAR, isAiry } from './surfaces.mjs';

/** @param {import('../head.mjs').Head} head @returns {Promise<Uint8Array[]>} for each part: see bakeOcclusion */
export function reachesOf(head) {
  const posed = (pose) => {
    head.drive.set(pose);
    return head.parts.map(({ part, influences }) => deform(part, influences, head.drive));
  };
  const [standing, lit] = [SHADOW_POSE, LIT_POSE].map(posed);
  const bake = bakeOcclusion(
    head.parts.map(({ part, geometry }, i) => ({
      position: standing[i].position,
      index: part.index,
      uv: geometry.attributes.uv.array,
      opaque: opaqueOfPart(head, part),
      shades: !CLEAR.includes(part.name),
      airy: isAiry(part.name),
      seen: lit[i],
    })),
  );
  return sliced(bake);
}

const BARED = 0.85; // of what reaches the front of the eye, what reaches its underside when that is seen

/**
 * What reaches an eye that looks ahead is dark where the lower lid covers it, and would be so when it looks up and that
 * is seen.
 * @param {Uint8Array} reach four bytes a vertex @param {import('../model/model.mjs').Part} part @param {number[]} center
 */
export function bared(reach, { position }, center) {
  let front = 0;
  for (let v = 0; v < position.length; v += 3) if (position[v + 2] > position[front + 2]) front = v;
  const radius = position[front + 2] - center[2];
  return reach.map((value, i) => {
    const v = 3 * (i >> 2);
    const below = Math.min(1, Math.max(0, (center[1] - position[v + 1]) / radius / 0.35));
    return Math.max(value, below * BARED * reach[4 * (front / 3) + (i & 3)]);
  });
}
