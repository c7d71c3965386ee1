// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Finds the missing feature points of a mesh: draws it from the front and both sides, lets the detector find the landmarks of the face, and fits the
 * points of a mean face (face-template.json) to the landmarks on the surface, or to those given in a file.
 */
import fs from 'node:fs';
import { align } from '../../../../web/portrait/align.mjs';
import { STEADY } from '../../../../web/portrait/landmarks.mjs';
import { rbf } from '../../../../web/element/head/model/rbf.mjs';
import { FileError } from '../limits.mjs';
import { guessParts, joinLips, lipsApart, splitBalls } from './guess-parts.mjs';
import { lidMargins, lipLine } from './margins.mjs';
import { addEyes, cutLips } from './open-face.mjs';
import { BY_SHAPES, landmarksByShapes } from './shape-landmarks.mjs';
import { landmarksOf } from '../formats/points.mjs';
import { layTold } from './told-landmarks.mjs';
import { placeOf } from '../mesh/place.mjs';
import { viewOf } from './views.mjs';

const MEAN_FACE = JSON.parse(fs.readFileSync(new URL('face-template.json', import.meta.url), 'utf8'));
const SIZE = { first: 512, close: 768 }; // pixels
const FRAME = 1.12; // relative to the size of everything
const AROUND = 2.1; // relative to the face's height
const TALL = 1.7; // ratio of height to width of a whole body, whose head is examined first
const SIDE = 25; // degrees
const ASIDE = 15; // mm from the middle beyond which the side view is better
const LIKE = 5; // mm from the mean face: certainly correct
const OUTLIER = 14; // mm from the mean face
const SMOOTH = 0.02;
const GROWN = [45, 85]; // mm between the eyes of adults
const UNSURE = 4; // mm between results of front and sides
const DISAGREE = 15; // mm between them: no face
const ASTRAY = 12; // mm between the lips that were seen and those that the shapes move
const NO_MOUTH = 20; // mm between the mouth and where a mean face has it; laughter moves it by less
const NOSE = { least: 0.12, usual: 0.33 }; // height of its base, of the way from mouth to eyes
const MOUTH = [0, 13, 14, 17, 61, 291, 78, 308]; // landmarks

/** Rotations from the file's axes to those of a head (x to its left, y up, z forward). */
const TURNS = {
  'y up, looking to +z': ([x, y, z]) => [x, y, z],
  'z up, looking to -y': ([x, y, z]) => [x, z, -y],
  'y up, looking to -z': ([x, y, z]) => [-x, y, -z],
  'z up, looking to +y': ([x, y, z]) => [-x, z, y],
  'y up, looking to +x': ([x, y, z]) => [-z, y, x],
  'y up, looking to -x': ([x, y, z]) => [z, y, -x],
  'z up, looking to +x': ([x, y, z]) => [y, z, x],
  'z up, looking to -x': ([x, y, z]) => [-y, z, -x],
  'y down, looking to -z': ([x, y, z]) => [x, -y, -z], // camera convention
  'y down, looking to +z': ([x, y, z]) => [-x, -y, z],
  'x up, looking to +z': ([x, y, z]) => [-y, x, z], // lying on its side
  'x up, looking to -z': ([x, y, z]) => [y, x, -z],
  'x down, looking to +z': ([x, y, z]) => [y, -x, z],
  'x down, looking to -z': ([x, y, z]) => [-y, -x, -z],
};

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

const axesOf = (turn) => Object.keys(TURNS).find((name) => [[1, 2, 3], [3, 1, 2]].every((p) => distance(TURNS[name](p), turn(p)) < 1e-9));

function turnAll(list, turn) {
  const out = new Float64Array(list.length);
  for (let i = 0; i < list.length; i += 3) out.set(turn([list[i], list[i + 1], list[i + 2]]), i);
  return out;
}

const looks = (scene) => scene.meshes.map((mesh) => {
  const look = scene.materials[mesh.material];
  return { position: mesh.position, index: mesh.index, ball: mesh.ball ?? null, color: mesh.ball || look?.picture ? null : (plain(look?.color) ? null : look?.color) ?? null };
});
/** Tells whether a colour is white or grey, which gives no hint about the part. */
const plain = (color) => !color || Math.max(...color) - Math.min(...color) < 0.05;

function boxOf(meshes) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { position } of meshes)
    for (let i = 0; i < position.length; i++) {
      low[i % 3] = Math.min(low[i % 3], position[i]);
      high[i % 3] = Math.max(high[i % 3], position[i]);
    }
  return { low, high };
}

/** Regions that may contain the face: everything, and the upper end of tall scenes. */
function framesOf(meshes) {
  const { low, high } = boxOf(meshes);
  const size = high.map((x, k) => x - low[k]);
  const middle = low.map((x, k) => (x + high[k]) / 2);
  const whole = { middle, width: FRAME * Math.max(...size) };
  if (size[1] < TALL * size[2]) return [whole];
  const head = 0.22 * size[1];
  return [{ middle: [middle[0], high[1] - head / 2, middle[2]], width: 1.6 * head }, whole];
}

async function see(eye, picture) {
  try {
    return await eye(picture);
  } catch (error) {
    if (error.name !== 'PortraitError' && !error.code) throw error;
    return null;
  }
}

/** Distance of a view's landmarks from the mean face, in its mm: the median. */
function unlike(points, template) {
  const which = STEADY.filter((i) => points[i] && template.at[i]);
  if (which.length < STEADY.length / 2) return Infinity;
  const onto = align(template.at.map((p) => p ?? [0, 0, 0]), points.map((p) => p ?? [0, 0, 0]), which);
  const off = which.map((i) => distance(onto.apply(template.at[i]), points[i]) / onto.scale).sort((a, b) => a - b);
  return off[off.length >> 1];
}

/** Finds orientation and position of the face. The detector may also accept an upside-down face, but its landmarks fit worse. */
async function findFace(scene, eye, { up, template }) {
  const meshes = looks(scene);
  let best = null;
  for (const [name, turn] of Object.entries(TURNS)) {
    if (up && !name.startsWith(up)) continue;
    const turned = meshes.map((mesh) => ({ ...mesh, position: turnAll(mesh.position, turn), ball: mesh.ball && { ...mesh.ball, centre: turn(mesh.ball.centre) } }));
    for (const frame of framesOf(turned)) {
      const view = viewOf(turned, { ...frame, yaw: 0 }, SIZE.first);
      const marks = await see(eye, view.picture);
      if (!marks || marks[10][1] > marks[152][1] || Math.abs(marks[10][0] - marks[152][0]) > 0.5 * (marks[152][1] - marks[10][1])) continue;
      const nose = view.at(marks[168][0], marks[168][1])?.point;
      if (!nose) continue;
      const off = unlike(marks.map(([u, v]) => view.at(u, v)?.point), template);
      if (!best || off < best.off) best = { name, turn, middle: nose, height: (marks[152][1] - marks[10][1]) / view.scale, off };
      if (off < LIKE) return best;
    }
  }
  return best;
}

/** Finds the landmarks on the surface from the front and both sides. */
async function look(meshes, { middle, height }, eye) {
  const at = [0, -0.05 * height, 0].map((x, k) => middle[k] + x);
  const views = [];
  for (const yaw of [0, SIDE, -SIDE]) {
    const view = viewOf(meshes, { middle: at, width: AROUND * height, yaw }, SIZE.close);
    const marks = await see(eye, view.picture);
    views.push(marks && { yaw, view, marks, points: marks.map(([u, v]) => view.at(u, v)) });
  }
  return { views, at };
}

/** Combines the views: each landmark on the surface, and the agreement of the sides with the front, in the file's units. */
function gather(views, template) {
  const [front] = views;
  const apart = [];
  const points = front.points.map((seen, i) => {
    const mean = template.at[i];
    if (!seen || !mean) return null;
    // turned by +yaw, a head shows its right side
    const side = Math.abs(mean[0]) > ASIDE ? views[mean[0] < 0 ? 1 : 2] : null;
    const other = side?.points[i]?.mesh === seen.mesh && STEADY.includes(i) ? side.points[i].point : null;
    if (!other) return seen.point;
    apart.push(distance(other, seen.point));
    return seen.point.map((x, k) => (x + other[k]) / 2);
  });
  apart.sort((a, b) => a - b);
  return { points, apart: apart[apart.length >> 1] ?? 0, count: views.filter(Boolean).length };
}

/** Selects landmarks in plausible places. */
function trusted(points, template) {
  let which = STEADY.filter((i) => points[i] && template.at[i]);
  let onto = null;
  for (let round = 0; round < 3; round++) {
    onto = align(template.at.map((p) => p ?? [0, 0, 0]), points.map((p) => p ?? [0, 0, 0]), which);
    const off = (i) => distance(onto.apply(template.at[i]), points[i]) / onto.scale;
    which = points.flatMap((p, i) => (p && template.at[i] && off(i) < OUTLIER ? [i] : []));
    if (which.length < 150) return null;
  }
  return { which, onto };
}

/** Rotates the whole scene to a head's axes; scene.turn does so with the file's places. */
function turnScene(scene, turn) {
  const before = scene.turn ?? ((p) => p);
  scene.turn = (p) => turn(before(p));
  for (const mesh of scene.meshes) {
    mesh.position = turnAll(mesh.position, turn);
    for (const [name, deltas] of Object.entries(mesh.targets)) mesh.targets[name] = turnAll(deltas, turn);
    if (mesh.ball) mesh.ball = { ...mesh.ball, centre: turn(mesh.ball.centre) };
  }
}

/** How far the mouth lies from where a mean face has it, in its mm: by medians, for the inside is seen through an open one. */
function mouthOff(points, onto, template) {
  const there = MOUTH.filter((i) => points[i] && template.at[i]).map((i) => onto.apply(template.at[i]).map((x, k) => points[i][k] - x));
  if (!there.length) return Infinity;
  return Math.hypot(...[0, 1, 2].map((k) => there.map((d) => d[k]).sort((x, y) => x - y)[there.length >> 1])) / onto.scale;
}

/** Finds the face with the detector. */
async function seeFace(scene, eye, { up, template }) {
  const found = await findFace(scene, eye, { up: up && `${up} up`, template });
  if (!found) throw new FileError('', 'no face was found in its views: --points FILE says where it is');
  turnScene(scene, found.turn);
  const { views, at } = await look(looks(scene), found, eye);
  if (!views[0]) throw new FileError('', 'no face was found in its views: --points FILE says where it is');
  const { points, apart, count } = gather(views, template);
  const sure = trusted(points, template);
  if (!sure) throw new FileError('', 'what was found in its views is no face: --points FILE says where it is');
  const { which, onto } = sure;
  if (apart / onto.scale > DISAGREE) throw new FileError('', `what was found in its views is no face, for they disagree by ${(apart / onto.scale).toFixed(0)} mm: --points FILE says where it is`);
  if (mouthOff(points, onto, template) > NO_MOUTH) throw new FileError('', 'the mouth was found where a face has none: --points FILE says where it is');
  const text = apart / onto.scale > UNSURE || which.length < 300 ? 'not sure: look at it, or give --points' : 'sure';
  const note = `feature points found by themselves: ${which.length} of ${points.filter(Boolean).length} landmarks in ${count} views, which agree within ${(apart / onto.scale).toFixed(1)} mm (${text})`;
  return { ...found, front: views[0], at, points, which, onto, note };
}

/** Takes the face from a points file or the mesh's shapes, without the detector. @param {Map<number, number[]>} landmarks in the file's coordinates */
function toldFace(scene, landmarks, { up, template, by = 'by', limits }) {
  const turns = Object.entries(TURNS).filter(([name]) => !up || name.startsWith(`${up} up`));
  const { name, turn, onto, which, points, all, off } = layTold(landmarks, template, Object.fromEntries(turns), limits);
  turnScene(scene, turn);
  const height = onto.scale * distance(template.at[10], template.at[152]);
  const at = [0, -0.05 * height, 0].map((x, k) => all[168][k] + x);
  const view = viewOf(looks(scene), { middle: at, width: AROUND * height, yaw: 0 }, SIZE.close);
  const mean = template.at.map((p) => onto.apply(p ?? template.at[168]));
  const marks = all.map((p, i) => [SIZE.close / 2 + ((p ?? mean[i])[0] - at[0]) * view.scale, SIZE.close / 2 - ((p ?? mean[i])[1] - at[1]) * view.scale]);
  const front = { yaw: 0, view, marks, points: marks.map(([u, v]) => view.at(u, v)) };
  return { name, turn, height, front, at, points, which, onto, told: true, note: `feature points ${by} ${which.length} landmarks, ${off.toFixed(1)} mm from a mean face's` };
}

/** Distance between the lips that were seen and those that the shapes move, in mm of the mean face. */
function lipsAway({ points, onto }, landmarks) {
  const seen = [13, 14].filter((i) => points[i] && landmarks.has(i));
  return Math.max(0, ...seen.map((i) => distance(points[i], landmarks.get(i)) / onto.scale));
}

/**
 * Finds the face with the detector, or from the shapes if it fails (an animal's face) or takes something else for the mouth (a drawn one). From the
 * shapes, sets known.byLandmark.
 */
async function findFaceOf(scene, eye, known, options) {
  let [face, failure] = [null, null];
  try {
    face = await seeFace(scene, eye, options);
  } catch (error) {
    if (!(error instanceof FileError)) throw error;
    failure = error;
  }
  const landmarks = landmarksByShapes(scene);
  const away = face && landmarks ? lipsAway(face, landmarks) : 0;
  if (face && away < ASTRAY) return face;
  if (!landmarks) throw failure;
  for (const [name, i] of Object.entries(BY_SHAPES)) if (landmarks.has(i) && !known.fdp[name]) known.byLandmark[name] ??= i;
  const why = face ? `for the mouth was seen ${away.toFixed(0)} mm beside it` : 'for no face was seen';
  return { ...toldFace(scene, landmarks, { ...options, by: `by what its shapes move, ${why}:`, limits: { fewest: 8, most: Infinity } }), parted: true };
}

/** Lifts a nose that the small mouth of a drawn face has drawn down to the lips: to where a face has it between mouth and eyes. */
export function liftNose(fdp) {
  const mouth = fdp['2.2'][1];
  const apart = ['3.1', '3.2', '3.3', '3.4'].reduce((sum, name) => sum + fdp[name][1] / 4, 0) - mouth;
  const high = (fdp['9.15'][1] - mouth) / apart;
  if (high > NOSE.least) return;
  for (const name of Object.keys(fdp)) if (name.startsWith('9.')) fdp[name] = fdp[name].map((x, k) => x + (k === 1 ? (NOSE.usual - high) * apart : 0));
}

/** @returns {number} the mesh that most landmarks are on */
function skinOf({ front }) {
  const hits = new Map();
  for (const i of STEADY) if (front.points[i]) hits.set(front.points[i].mesh, (hits.get(front.points[i].mesh) ?? 0) + 1);
  if (!hits.size) throw new FileError('landmarks', 'no mesh is where they are');
  return [...hits].sort((a, b) => b[1] - a[1])[0][0];
}

/**
 * Rotates the scene to a head's axes, separates eyes from the skin, and names meshes without meaningful names.
 * @param {object} scene from a reader @param {(picture: object) => Promise<number[][]>} eye not needed if landmarks are given
 * @param {{up?: string, template?: object, points?: object|null}} options template: the mean face; points: given ones (points.mjs)
 * @returns {Promise<{points: object, notes: string[]}>} points as in points.mjs, in the file's units
 */
export async function findPoints(scene, eye, { up, template = MEAN_FACE, points: given = null } = {}) {
  const known = placesOf(scene, given); // by the file's vertex numbers, before cutting renumbers them
  splitBalls(scene);
  let face = known.landmarks ? toldFace(scene, known.landmarks, { up, template }) : await findFaceOf(scene, eye, known, { up, template });
  let skin = skinOf(face);
  const lips = face.told ? -1 : lipsApart(scene, face.front.points, skin);
  const whole = lips >= 0 && joinLips(scene, skin, lips);
  if (whole) {
    face = await seeFace(scene, eye, { up: 'y', template });
    skin = skinOf(face);
  }
  const { front, at, points, which, onto, height } = face;

  const asTold = Object.fromEntries([...Object.entries(known.fdp).map(([name, p]) => [name, scene.turn(p)]), ...Object.entries(known.byLandmark).map(([name, i]) => {
    if (!points[i]) throw new FileError(`fdp.${name}`, `landmark ${i} is ${face.told ? 'not told' : 'nowhere seen on the mesh'}`);
    return [name, points[i]];
  })]);
  const leads = Object.entries(asTold).filter(([name]) => template.fdp[name] && !INNER.includes(name)).map(([name, p]) => [template.fdp[name], p]);
  const pairs = which.filter((i) => face.told || front.points[i]?.mesh === skin).map((i) => [template.at[i], points[i]]);
  const warp = (more) => {
    // drops points that coincide in the mean face, because they would conflict
    const all = [...more, ...pairs].filter(([p], i, list) => list.findIndex(([q]) => distance(p, q) < 0.05) === i);
    return rbf(all.flatMap(([from]) => from), all.flatMap(([, to]) => to), { smooth: SMOOTH });
  };
  const lay = (one) => Object.fromEntries(Object.entries(template.fdp).map(([name, p]) => [name, one.at(p)]));
  let fdp = { ...lay(warp(leads)), ...asTold };
  const eyesApart = distance(fdp['3.5'], fdp['3.6']);
  const made = addEyes(scene, front, { template, onto });
  const seen = { fdp, eyesApart, marks: front.marks, camera: { middle: at, width: AROUND * height, yaw: 0 } };
  let { own, notes } = margins(scene, looks(scene), skin, seen);
  if (!own['2.2'] && !face.parted && cutLips(scene.meshes[skin], front, onto.scale)) {
    ({ own, notes } = margins(scene, looks(scene), skin, seen));
    notes.push('the lips are one surface: they were cut apart where they meet');
  }
  if (whole) notes.push('the lips are a mesh of their own: they were joined to the face');
  if (made.length) notes.push(`there are holes for eyes, and none in them: ${made.join(', ')} were made`);
  const told = Object.entries(own).filter(([name]) => template.fdp[name] && !INNER.includes(name) && !asTold[name]).map(([name, p]) => [template.fdp[name], p]);
  fdp = { ...lay(warp([...leads, ...told])), ...own, ...asTold };
  if (face.parted) liftNose(fdp);
  const guessed = guessParts(scene, fdp, scene.meshes[skin]);
  for (const [name, part] of [['3.5', 'eye_l'], ['3.6', 'eye_r']]) if (!asTold[name] && scene.meshes.some((mesh) => mesh.name === part)) delete fdp[name];
  const unit = chooseUnit(scene, eyesApart, onto, notes);
  notes.unshift(`${face.note}; ${axesOf(scene.turn) ?? face.name}, ${unit} mm a unit`);
  if (Object.keys(asTold).length) notes.push(`feature points as they were told: ${Object.keys(asTold).join(', ')}`);
  if (guessed.length) notes.push(`parts by where they lie: ${[...new Set(guessed)].join(', ')}`);
  return { points: { frame: 'file', fdp, parts: given?.parts ?? {}, influences: [] }, notes };
}

/** Points given in a points file, in the model file's coordinates. */
function placesOf(scene, given) {
  const [fdp, byLandmark] = [{}, {}];
  for (const [name, value] of Object.entries(given?.fdp ?? {}))
    if (Number.isInteger(value?.landmark)) byLandmark[name] = given.landmarks ? landmarksOf(given.landmarks)[value.landmark] : value.landmark;
    else fdp[name] = placeOf(scene, `fdp.${name}`, value);
  if (!given?.landmarks) return { fdp, byLandmark, landmarks: null };
  const numbers = landmarksOf(given.landmarks);
  const { vertices } = given.landmarks;
  const landmarks = new Map();
  vertices.forEach((value, i) => value !== null && landmarks.set(numbers[i], placeOf(scene, `landmarks.vertices[${i}]`, value)));
  return { fdp, byLandmark, landmarks };
}

const INNER = ['2.2', '2.3', '2.6', '2.7', '2.8', '2.9']; // inner lip points, pairwise coincident; the warp uses one of each pair

/** Refines lip and lid points to the actual edges of the surface. */
function margins(scene, meshes, skin, { fdp, eyesApart, marks, camera }) {
  const [own, notes] = [{}, []];
  const eyes = meshes.flatMap((mesh, m) => (mesh.ball ? [m] : []));
  const kept = [skin, ...eyes];
  const view = viewOf(kept.map((m) => meshes[m]), camera, SIZE.close);
  const line = lipLine(view, 0, scene.meshes[skin], marks, eyesApart);
  if (line.length) {
    const share = (x) => line[Math.round(x * (line.length - 1))];
    [own['2.2'], own['2.3']] = [share(0.5).upperEnd, share(0.5).lowerEnd];
    for (const [x, upper, lower] of [[0.75, '2.6', '2.8'], [0.25, '2.7', '2.9']]) [own[upper], own[lower]] = [share(x).inUpper, share(x).inLower];
    for (const [x, name] of [[1, '2.4'], [0, '2.5']]) own[name] = share(x).upper.map((value, k) => (value + share(x).lower[k]) / 2);
  } else notes.push('the lips are one surface: the mouth will not open there');
  for (const [upper, lower, pupil] of [['3.1', '3.3', '3.5'], ['3.2', '3.4', '3.6']]) {
    const e = eyes.findIndex((m) => Math.hypot(meshes[m].ball.centre[0] - fdp[pupil][0], meshes[m].ball.centre[1] - fdp[pupil][1]) < 0.25 * eyesApart);
    if (e < 0) continue;
    const { centre, radius } = meshes[eyes[e]].ball;
    const place = [SIZE.close / 2 + (centre[0] - camera.middle[0]) * view.scale, SIZE.close / 2 - (centre[1] - camera.middle[1]) * view.scale].map(Math.round);
    const found = lidMargins(view, 0, e + 1, place, { centre, radius });
    if (found) Object.assign(own, { [upper]: found.upper, [lower]: found.lower });
  }
  return { own, notes };
}

/** Chooses the unit: the file's if it gives a human eye distance, else by the size of the mean face. */
function chooseUnit(scene, eyesApart, onto, notes) {
  const fits = (unit) => unit && unit * eyesApart > GROWN[0] && unit * eyesApart < GROWN[1];
  const known = [scene.unit, 1, 10, 100, 1000, 25.4].find(fits);
  if (!known && scene.unit) notes.push(`its eyes would be ${(scene.unit * eyesApart).toFixed(0)} mm apart: it is made as large as a grown person's`);
  scene.unit = known ?? 1 / onto.scale;
  return Number(scene.unit.toPrecision(4));
}
