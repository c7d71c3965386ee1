// SPDX-License-Identifier: GPL-3.0-or-later
/** Feature points (FDP) from the recipe, and the face's units (FAPU) from the feature points. */
import { groupVertices } from './mesh.mjs';

/**
 * A recipe names a point by a base vertex, by `{"group": name}` (mean of a group's vertices) or by
 * `{"vertex": n, "shift": [x, y, z]}` in mm. Keys of the form "2.4/2.5" give a left point; the right one is
 * its mirror vertex.
 * @returns {{fdp: Object<string, number[]>, fdpVertex: Object<string, number>}}
 */
export function readLandmarks(base, topology, p, recipe) {
  const fdp = {},
    fdpVertex = {};
  for (const [key, spec] of Object.entries(recipe.fdp)) {
    const [left, right] = key.split('/');
    fdp[left] = pointOf(base, p, spec);
    if (typeof spec === 'number') fdpVertex[left] = spec;
    if (!right) continue;
    if (typeof spec !== 'number') throw new Error(`feature points ${key} need a vertex number`);
    fdpVertex[right] = topology.mirror[spec];
    fdp[right] = pointOf(base, p, fdpVertex[right]);
  }
  return { fdp, fdpVertex };
}

export function pointOf(base, p, spec) {
  const at = (v) => [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]];
  if (typeof spec === 'number') return at(spec);
  if (spec.group) {
    const vertices = groupVertices(base, spec.group);
    return [0, 1, 2].map((k) => vertices.reduce((sum, v) => sum + p[v * 3 + k], 0) / vertices.length);
  }
  return at(spec.vertex).map((x, k) => x + spec.shift[k]);
}

/** ISO/IEC 14496-2, table "Facial animation parameter units", in mm and not divided by 1024. */
export function measureUnits(fdp) {
  const mean = (a, b) => (a + b) / 2;
  return {
    IRISD: mean(fdp['3.1'][1] - fdp['3.3'][1], fdp['3.2'][1] - fdp['3.4'][1]),
    ES: fdp['3.5'][0] - fdp['3.6'][0],
    ENS: mean(fdp['3.5'][1], fdp['3.6'][1]) - fdp['9.15'][1],
    MNS: fdp['9.15'][1] - fdp['2.2'][1],
    MW: fdp['8.3'][0] - fdp['8.4'][0],
  };
}
