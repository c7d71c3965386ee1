// SPDX-License-Identifier: MIT
// Computes how much light of the open sky and of each lamp reaches the vertices of a head.
import { deform } from '../mesh/deform.mjs';
import { bakeOcclusion } from './occlusion.mjs';
import { opaqueOfPart } from '../mesh/opacity.mjs';
import { LIT_POSE, SHADOW_POSE } from '../mesh/poses.mjs';
import { sliced } from '../mesh/slices.mjs';
import { CLEAR, isAiry } from './surfaces.mjs';

/** @param {import('../head.mjs').Head} head @returns {Promise<Uint8Array[]>} for each part: see bakeOcclusion */
export function ambientLightOf(head) {
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
 * Brightens the underside of an eye. It is baked looking ahead, where the lower lid darkens the part that an upward gaze shows.
 * @param {Uint8Array} reach four bytes a vertex @param {import('../model/model.mjs').Part} part @param {number[]} center
 */
export function uncovered(reach, { position }, center) {
  let front = 0;
  for (let v = 0; v < position.length; v += 3) if (position[v + 2] > position[front + 2]) front = v;
  const radius = position[front + 2] - center[2];
  return reach.map((value, i) => {
    const v = 3 * (i >> 2);
    const below = Math.min(1, Math.max(0, (center[1] - position[v + 1]) / radius / 0.35));
    return Math.max(value, below * BARED * reach[4 * (front / 3) + (i & 3)]);
  });
}
