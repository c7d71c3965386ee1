// SPDX-License-Identifier: GPL-3.0-or-later
/** Resolves entries of a points file to positions on a mesh. */
import { FileError } from './file-error.mjs';
import { partOf } from './parts.mjs';

/** The mesh to which vertex numbers without a mesh name refer. */
function skinOf(scene) {
  const { meshes } = scene;
  const named = (mesh) => partOf(mesh, scene) === 'skin';
  const largest = (list) => [...list].sort((a, b) => b.index.length - a.index.length)[0];
  return meshes.find(({ part }) => part === 'skin') ?? largest(meshes.filter(named)) ?? largest(meshes);
}

/**
 * @param {string} where used in errors @param {number[]|number|{mesh?: string, vertex: number}} value @returns {number[]} in the file's
 * coordinates
 */
export function placeOf(scene, where, value) {
  if (Array.isArray(value)) return value;
  const [name, vertex] = typeof value === 'number' ? [null, value] : [value.mesh, value.vertex];
  const skin = skinOf(scene);
  const numbered = scene.meshes[Number(/_(\d+)$/.exec(name ?? '')?.[1]) - 1];
  const named = scene.meshes.filter((mesh) => mesh.name === (name ?? skin.name)); // a split mesh has several pieces of one name
  const asked = !name && scene.counted === 'whole' ? scene.meshes : named.length ? named : [numbered ?? skin];
  for (const { from, position } of asked) {
    const own = from ? from.indexOf(vertex) : vertex;
    if (own >= 0 && own < position.length / 3) return [...position.slice(3 * own, 3 * own + 3)];
  }
  throw new FileError(where, `there is no vertex ${vertex} in ${name ?? (scene.counted === 'whole' ? 'the file' : skin.name)}`);
}
