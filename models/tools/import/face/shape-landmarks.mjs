// SPDX-License-Identifier: GPL-3.0-or-later
/** Finds landmarks of a mesh from its shapes: where the lips part, how far the chin moves down, where the lids meet. Works without face detection. */
import { facingOf } from '../../../../web/element/avatar/facing.mjs';
import { landmarksOf } from '../../../../web/element/avatar/landmarks.mjs';
import { mirrored } from '../../../../web/element/avatar/names.mjs';

/** Landmark numbers of the face mesh (told-landmarks.mjs). */
const NUMBERS = {
  chin: 152, upper: 13, lower: 14, upperL: 311, upperR: 81, lowerL: 402, lowerR: 178, cornerL: 291, cornerR: 61,
  lidTopL: 386, lidTopR: 159, lidBottomL: 374, lidBottomR: 145,
};
const CHIN = { least: 0.2, most: 0.85 }; // of the distance from mouth to eyes: nearer points below the mouth are a drawn lip, farther ones are under the chin
const PUPILS = [['L', 468], ['R', 473]];

/** Feature points that coincide with these landmarks. */
export const BY_SHAPES = {
  2.1: 152, 2.2: 13, 2.3: 14, 2.4: 291, 2.5: 61, 2.6: 311, 2.7: 81, 2.8: 402, 2.9: 178, 8.3: 291, 8.4: 61, 3.1: 386, 3.2: 159, 3.3: 374, 3.4: 145,
};

/** Joins all meshes, with the displacements of each target. */
function rigOf({ meshes }) {
  const count = meshes.reduce((sum, { position }) => sum + position.length / 3, 0);
  const [position, meshOf, found] = [new Float32Array(3 * count), new Uint16Array(count), new Map()];
  let from = 0;
  meshes.forEach((mesh, m) => {
    position.set(mesh.position, 3 * from);
    meshOf.fill(m, from, from + mesh.position.length / 3);
    for (const [name, deltas] of Object.entries(mesh.targets)) {
      const { vertices, list } = found.get(name) ?? found.set(name, { vertices: [], list: [] }).get(name);
      for (let v = 0; v < deltas.length / 3; v++) {
        const d = [...deltas.slice(3 * v, 3 * v + 3)];
        if (!d.some((x) => x)) continue;
        vertices.push(from + v);
        list.push(...d);
      }
    }
    from += mesh.position.length / 3;
  });
  const fields = new Map([...found].map(([name, { vertices, list }]) => [name, { vertices: Uint32Array.from(vertices), deltas: Float32Array.from(list) }]));
  return { position, meshOf, fields };
}

/** @param {object} scene of a reader @returns {Map<number, number[]>|null} landmark -> where it is, in the file's coordinates; null: the shapes are insufficient */
export function landmarksByShapes(scene) {
  const rig = rigOf(scene);
  const facing = facingOf(rig, {}, { usual: [0, 0, 1], jaw: false });
  if (facing.swapped) rig.fields = new Map([...rig.fields].map(([name, field]) => [mirrored(name), field]));
  const found = landmarksOf(rig, facing, {});
  if (!found) return null;
  const middle = (vertices) => [0, 1, 2].map((k) => vertices.reduce((sum, v) => sum + rig.position[3 * v + k], 0) / vertices.length);
  const out = new Map(Object.entries(NUMBERS).flatMap(([name, i]) => (found.points[name] ? [[i, middle(found.points[name])]] : [])));
  const along = (name, axis) => middle(found.points[name]).reduce((sum, x, k) => sum + x * axis[k], 0);
  const ahead = (name) => along(name, facing.front);
  const high = (name) => along(name, facing.up);
  const lids = found.lids.map((letter) => high(`lidTop${letter}`));
  const below = (high('lower') - high('chin')) / (lids[0] - high('upper'));
  if (below < CHIN.least || below > CHIN.most) out.delete(NUMBERS.chin);
  const [lips, corners] = [['upper', 'lower'], ['cornerL', 'cornerR']].map((names) => Math.min(...names.map(ahead)));
  for (const name of ['upperL', 'upperR', 'lowerL', 'lowerR']) if (found.points[name] && ahead(name) < Math.min(lips, corners)) out.delete(NUMBERS[name]); // it is inside the mouth
  const balls = scene.meshes.flatMap(({ ball }) => (ball ? [ball] : []));
  for (const [side, pupil] of PUPILS) {
    const top = found.points[`lidTop${side}`]?.[0];
    if (top === undefined) continue;
    const lid = middle([top]);
    // a fully closed upper lid ends at the lower one
    if (!out.has(NUMBERS[`lidBottom${side}`])) out.set(NUMBERS[`lidBottom${side}`], lid.map((x, k) => x + shiftOf(rig, side, top)[k]));
    const far = ({ centre }) => Math.hypot(...centre.map((x, k) => x - lid[k]));
    const eye = balls.filter((ball) => far(ball) < 2 * ball.radius).sort((a, b) => a.radius - b.radius)[0];
    if (eye) out.set(pupil, eye.centre.map((x, k) => x + eye.radius * facing.front[k]));
  }
  return out;
}

function shiftOf({ fields }, side, v) {
  const { vertices, deltas } = fields.get(side === 'L' ? 'eyeBlinkLeft' : 'eyeBlinkRight') ?? fields.get('eyeBlink');
  const i = vertices.indexOf(v);
  return [...deltas.slice(3 * i, 3 * i + 3)];
}
