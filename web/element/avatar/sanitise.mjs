// SPDX-License-Identifier: MIT
// Checks an avatar's numbers that are known only after unpacking.
import { AvatarProblem } from './problem.mjs';

const damaged = (mesh, what) => new AvatarProblem('damaged', `mesh "${mesh.name}": ${what}`);

/** The largest of an attribute's numbers. */
function largest(attribute) {
  let most = -1;
  for (let i = 0; i < attribute.count; i++)
    for (let k = 0; k < attribute.itemSize; k++) most = Math.max(most, attribute.getComponent(i, k));
  return most;
}

/** Replaces NaN and infinity with 0. @returns {Set<number>} the elements that had some */
function finite(attribute) {
  const bad = new Set();
  const { array } = attribute.isInterleavedBufferAttribute ? attribute.data : attribute;
  if (!(array instanceof Float32Array) || array.every(Number.isFinite)) return bad;
  for (let i = 0; i < attribute.count; i++)
    for (let k = 0; k < attribute.itemSize; k++)
      if (!Number.isFinite(attribute.getComponent(i, k))) {
        attribute.setComponent(i, k, 0);
        bad.add(i);
      }
  return bad;
}

/**
 * Refuses triangles and bones that are not there; takes what is not a number for nothing: shifts of a target, and triangles
 * of such places.
 * @param {import('three').Mesh[]} meshes @throws {AvatarProblem}
 */
export function sanitise(meshes) {
  for (const mesh of meshes) {
    const { geometry } = mesh;
    const { position, skinIndex } = geometry.attributes;
    if (geometry.index && geometry.index.count && largest(geometry.index) >= position.count)
      throw damaged(mesh, `a triangle has vertex ${largest(geometry.index)}, and there are ${position.count}`);
    if (mesh.isSkinnedMesh && skinIndex && largest(skinIndex) >= mesh.skeleton.bones.length)
      throw damaged(mesh, `a vertex hangs on joint ${largest(skinIndex)}, and there are ${mesh.skeleton.bones.length}`);
    for (const list of Object.values(geometry.morphAttributes)) list.forEach(finite);
    const bad = finite(position);
    if (!bad.size) continue;
    const corners = geometry.index ? Array.from(geometry.index.array) : Array.from({ length: position.count }, (_, v) => v);
    const kept = [];
    for (let i = 0; i + 2 < corners.length; i += 3)
      if (![0, 1, 2].some((k) => bad.has(corners[i + k]))) kept.push(...corners.slice(i, i + 3));
    geometry.setIndex(kept);
  }
}
