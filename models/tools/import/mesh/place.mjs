// SPDX-License-Identifier: GPL-3.0-or-later
/** Places of a file: of a vertex, and of the whole in a head's units and axes: mm, x to its left, y up, z forward, origin between the eyeballs. */
import { measureUnits } from '../../../../web/element/head/model/calibrate.mjs';
import { FileError } from '../limits.mjs';
import { ballOf, partOf } from './parts.mjs';

const USUAL_ES = 62; // mm between an adult's pupils
const UNITS = { mm: 1, cm: 10, m: 1000, in: 25.4, dm: 100 };
const USUAL_UNITS = [1, 10, 100, 1000];
const PUPIL_DEPTH = 12; // mm in front of the eyeball's centre, when there is no eyeball to measure
const NEEDED = ['2.1', '2.2', '2.3', '3.1', '3.2', '3.3', '3.4', '8.3', '8.4', '9.15'];

const swap = (p) => p.map((_, i) => (i % 3 === 0 ? p[i] : i % 3 === 1 ? p[i + 1] : -p[i - 1])); // z up, the face to -y

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

/**
 * Changes the scene's meshes in place. @param {object} points see points.mjs
 * @returns {{fdp: Record<string, number[]>, fapu: Record<string, number>, scale: number, origin: number[], place: (p: number[]) => number[]}} place: of a point of the file
 */
export function placeHead(scene, points, { unit, up = 'y' }) {
  const turn = up === 'z' ? swap : (p) => p;
  const eyeOf = (part) => {
    const list = scene.meshes.filter((mesh) => mesh.part === part).flatMap(({ position }) => [...position]);
    return list.length > 30 ? ballOf(turn(list)) : null;
  };
  const balls = ['eye_l', 'eye_r'].map(eyeOf);
  const inFile = {};
  if (points.frame === 'file') for (const [name, value] of Object.entries(points.fdp)) inFile[name] = turn(placeOf(scene, `fdp.${name}`, value));
  const scale = UNITS[unit] ?? scene.unit ?? guessUnit(balls, inFile);
  const middle = (list) => list[0].map((_, k) => (list[0][k] + list[1][k]) / 2);
  let origin;
  if (points.origin) origin = points.origin;
  else if (balls.every(Boolean)) origin = middle(balls.map(({ centre }) => centre));
  else if (inFile['3.5'] && inFile['3.6']) origin = middle([inFile['3.5'], inFile['3.6']]).map((x, k) => x - (k === 2 ? PUPIL_DEPTH / scale : 0));
  else throw new FileError('fdp', 'without meshes of the eyes 3.5 and 3.6 (the pupils) are needed, in the frame of the file');
  const shift = (p) => Float64Array.from(p, (x, i) => (x - origin[i % 3]) * scale);
  for (const mesh of scene.meshes) {
    mesh.position = shift(turn(mesh.position));
    for (const [name, deltas] of Object.entries(mesh.targets)) mesh.targets[name] = Float64Array.from(turn(deltas), (x) => x * scale);
  }
  const fdp = points.frame === 'file' ? Object.fromEntries(Object.entries(inFile).map(([name, p]) => [name, [...shift(p)]])) : { ...points.fdp };
  ['3.5', '3.6'].forEach((name, i) => {
    if (fdp[name]) return;
    const front = balls[i] && shift(balls[i].centre);
    fdp[name] = front ? [front[0], front[1], front[2] + balls[i].radius * scale] : fdp[name];
  });
  const missing = [...NEEDED, '3.5', '3.6'].filter((name) => !fdp[name]);
  if (missing.length) throw new FileError('fdp', `${missing.join(', ')} are missing: the face's units are measured from them ("find": true has what is not told found)`);
  const fapu = measureUnits(fdp);
  for (const [name, value] of Object.entries(fapu))
    if (!(value > 1 && value < 250)) throw new FileError('fdp', `${name} would be ${value.toFixed(1)} mm: points, unit (${scale} mm) or axes (--up) are wrong`);
  return { fdp, fapu, scale, origin, place: (p) => [...shift(turn(p))] };
}

/** Guesses the unit that gives a human eye distance. */
function guessUnit(balls, fdp) {
  const pair = balls.every(Boolean) ? balls.map(({ centre }) => centre) : [fdp['3.5'], fdp['3.6']];
  if (!pair.every(Boolean)) throw new FileError('', 'the file does not say its unit: --unit mm, cm, m or in');
  const apart = Math.hypot(...pair[0].map((x, k) => x - pair[1][k]));
  return USUAL_UNITS.reduce((best, one) => (Math.abs(Math.log((one * apart) / USUAL_ES)) < Math.abs(Math.log((best * apart) / USUAL_ES)) ? one : best));
}
