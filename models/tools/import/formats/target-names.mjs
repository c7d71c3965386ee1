// SPDX-License-Identifier: GPL-3.0-or-later
/** Maps the morph target names of a file to those of ARKit and the visemes, as `<talking-head avatar>` does. */
import { LETTERS } from '../../avatar/shapes.mjs';
import { HALVES, presetOf, rowShapes, shapeOf, shapesAmong } from '../../../../web/element/avatar/names.mjs';

/** Names that differ: VRM's vowels are visemes. */
const ALSO = { vowel_aa: 'viseme_aa', vowel_ih: 'viseme_I', vowel_ou: 'viseme_U', vowel_ee: 'viseme_E', vowel_oh: 'viseme_O', mouthOpen: 'jawOpen' };

/** Turkish letters' shapes. Those of more than two letters mean nothing else, and tell whether a file has them. */
const LETTER_NAMES = Object.keys(LETTERS).map((name) => name.slice('letter_'.length));
const TELLING = LETTER_NAMES.filter((name) => name.length > 2 && name !== 'neutral');
const ENOUGH = 8;

const moves = (deltas) => deltas.some((x) => Math.abs(x) > 1e-9);

/** Renames the targets of a scene's meshes; unknown ones keep their names. One that moves no mesh is left out, so that another of its kind counts. */
export function nameTargets({ meshes }) {
  const alive = new Set(meshes.flatMap(({ targets }) => Object.keys(targets).filter((name) => moves(targets[name]))));
  for (const mesh of meshes) mesh.targets = Object.fromEntries(Object.entries(mesh.targets).filter(([name]) => alive.has(name)));
  if (TELLING.filter((name) => alive.has(name)).length >= ENOUGH)
    for (const mesh of meshes) mesh.targets = Object.fromEntries(Object.entries(mesh.targets).map(([name, deltas]) => [LETTER_NAMES.includes(name) ? `letter_${name}` : name, deltas]));
  const rows = rowShapes([...new Set(meshes.flatMap(({ targets }) => Object.keys(targets)))]);
  for (const mesh of meshes) {
    const known = shapesAmong(Object.keys(mesh.targets), rows);
    const plain = Object.entries(mesh.targets).sort(([a], [b]) => Number(known.get(a) in ALSO) - Number(known.get(b) in ALSO)); // an exact name takes precedence
    const named = {};
    for (const [name, deltas] of plain) {
      const shape = known.get(name);
      const own = ALSO[shape] ?? shape ?? name;
      if (!(own in named)) named[own] = deltas;
      else if (HALVES.includes(shape)) named[own] = named[own].map((x, i) => x + deltas[i]);
      else named[name] ??= deltas;
    }
    mesh.targets = named;
  }
}

/** Whether a target is a movement of the face, and not a form of it. */
export const isExpression = (name) => Boolean(shapeOf(name) ?? presetOf(name));

const list = (value) => (Array.isArray(value) ? value : []);

/**
 * Target names of VRM 0 and 1.0: an expression that consists of one target names it.
 * @param {object} json of a glTF @returns {(mesh: number, target: number, name?: string) => string} its name; `name` where that says what it is
 */
export function targetNamer(json) {
  const told = new Map();
  const add = (name, binds) => {
    const shape = typeof name === 'string' ? presetOf(name) : null;
    for (const [mesh, index] of shape ? binds : []) if (!told.has(`${mesh} ${index}`)) told.set(`${mesh} ${index}`, shape);
  };
  const { preset = {}, custom = {} } = json.extensions?.VRMC_vrm?.expressions ?? {};
  for (const [name, one] of Object.entries({ ...custom, ...preset })) add(name, list(one?.morphTargetBinds).map((bind) => [json.nodes?.[bind?.node]?.mesh, bind?.index]));
  for (const group of list(json.extensions?.VRM?.blendShapeMaster?.blendShapeGroups))
    add(group?.presetName && group.presetName !== 'unknown' ? group.presetName : group?.name, list(group?.binds).map((bind) => [bind?.mesh, bind?.index]));
  return (mesh, target, name) => (name !== undefined && shapeOf(name) ? name : (told.get(`${mesh} ${target}`) ?? name ?? String(target)));
}
