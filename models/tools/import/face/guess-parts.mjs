// SPDX-License-Identifier: GPL-3.0-or-later
/** Identifies meshes without names by their position relative to the feature points. */
import { fromLinear } from '../mesh/paint.mjs';
import { ballOf, partOf, piece } from '../mesh/parts.mjs';

const BALL = { least: 40, most: 20000, off: 0.09, flat: 0.5 }; // vertices; of the radius; of the diameter

/** Finds connected components. @returns {Int32Array} component of each vertex */
function piecesOf({ position, index }) {
  const first = new Map();
  const up = Int32Array.from({ length: position.length / 3 }, (_, v) => {
    const key = `${position[3 * v]},${position[3 * v + 1]},${position[3 * v + 2]}`;
    if (!first.has(key)) first.set(key, v);
    return first.get(key);
  });
  const root = (v) => {
    while (up[v] !== v) v = up[v] = up[up[v]];
    return v;
  };
  for (let i = 0; i < index.length; i += 3)
    for (const k of [1, 2]) {
      const [a, b] = [root(index[i]), root(index[i + k])];
      if (a !== b) up[a] = b;
    }
  return up.map((_, v) => root(v));
}

const spanOf = (position) => {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let i = 0; i < position.length; i++) {
    low[i % 3] = Math.min(low[i % 3], position[i]);
    high[i % 3] = Math.max(high[i % 3], position[i]);
  }
  return { low, high, middle: low.map((x, k) => (x + high[k]) / 2), size: high.map((x, k) => x - low[k]) };
};

function ball(position) {
  const count = position.length / 3;
  if (count < BALL.least || count > BALL.most) return null;
  const { size } = spanOf(position);
  const found = ballOf(position);
  if (!found || !(found.radius > 0) || size.some((x) => x > 2.4 * found.radius) || Math.min(size[0], size[1]) < BALL.flat * 2 * found.radius) return null;
  let off = 0;
  for (let i = 0; i < position.length; i += 3) off += Math.abs(Math.hypot(...found.centre.map((x, k) => position[i + k] - x)) - found.radius) / count;
  return off < BALL.off * found.radius ? found : null;
}

/** Splits meshes that contain balls, such as eyes in one mesh with the skin. */
export function splitBalls(scene) {
  scene.meshes = scene.meshes.flatMap((mesh) => {
    const pieces = piecesOf(mesh);
    const roots = [...new Set(pieces)];
    if (roots.length > 200) return [mesh];
    const of = (root) => piece(mesh, ([v]) => pieces[v] === root);
    const balls = roots.flatMap((root) => {
      const one = of(root);
      const found = one && ball(one.position);
      return found ? [{ ...one, ball: found, root }] : [];
    });
    if (!balls.length || balls.length > 8) return [mesh];
    const rest = piece(mesh, ([v]) => !balls.some(({ root }) => root === pieces[v]));
    return [...(rest ? [rest] : []), ...balls];
  });
}

const LIPS = [61, 40, 37, 0, 267, 270, 291, 91, 84, 17, 314, 321]; // landmarks of the lips' outer edge, and just within
const MOST_LIPS = 7; // of them that are on a mesh of lips

/** @returns {number} the mesh, other than the face's, on which the lips are; -1: none */
export function lipsApart(scene, points, skin) {
  const counts = new Map();
  for (const i of LIPS) if (points[i]) counts.set(points[i].mesh, (counts.get(points[i].mesh) ?? 0) + 1);
  const [mesh, count] = [...counts].sort((a, b) => b[1] - a[1])[0] ?? [skin, 0];
  const part = mesh !== skin && partOf(scene.meshes[mesh], scene);
  return mesh !== skin && count >= MOST_LIPS && [undefined, 'mouth', 'skin'].includes(part) ? mesh : -1;
}

/** Joins a mesh of lips to the face's. @returns {boolean} false: they have different pictures, which one mesh cannot have */
export function joinLips(scene, skin, lips) {
  const pair = [scene.meshes[skin], scene.meshes[lips]];
  const looks = pair.map(({ material }) => scene.materials[material]);
  if (looks[0]?.picture !== looks[1]?.picture && looks.some((look) => look?.picture)) return false;
  const counts = pair.map(({ position }) => position.length / 3);
  const all = (of, width) => Float64Array.from(pair.flatMap((mesh, i) => [...(of(mesh, i) ?? new Float64Array(width * counts[i]))]));
  const tinted = !looks.some((look) => look?.picture) && (pair.some(({ colors }) => colors) || pair[0].material !== pair[1].material);
  const tint = ({ colors }, i) => colors ?? Float64Array.from({ length: 3 * counts[i] }, (_, k) => fromLinear(looks[i]?.color[k % 3] ?? 1));
  const targets = new Set(pair.flatMap((mesh) => Object.keys(mesh.targets)));
  const { from } = pair[0];
  scene.meshes[skin] = {
    ...pair[0],
    position: all(({ position }) => position, 3),
    uv: pair.some(({ uv }) => uv) ? all(({ uv }) => uv, 2) : null,
    colors: tinted ? all(tint, 3) : null,
    index: Uint32Array.from([...pair[0].index, ...pair[1].index.map((v) => v + counts[0])]),
    targets: Object.fromEntries([...targets].map((name) => [name, all((mesh) => mesh.targets[name], 3)])),
    ...(from && pair[1].from ? { from: [...from, ...pair[1].from] } : {}),
  };
  scene.meshes.splice(lips, 1);
  return true;
}

/**
 * Names meshes after parts if their own names are meaningless. @param {object} scene in a head's axes @param {object} fdp in the file's units
 * @param {object} skin the mesh of the face @returns {string[]} what was guessed
 */
export function guessParts(scene, fdp, skin) {
  const guessed = [];
  const named = (mesh) => partOf(mesh, scene);
  const call = (mesh, part) => {
    if (mesh.name !== part) guessed.push(part);
    mesh.name = part;
  };
  const apart = Math.hypot(...fdp['3.5'].map((x, k) => x - fdp['3.6'][k]));
  for (const [part, pupil] of [['eye_l', '3.5'], ['eye_r', '3.6']]) {
    if (scene.meshes.some((mesh) => named(mesh) === part || named(mesh) === 'eyes')) continue;
    const near = ({ ball }) => (ball ? Math.hypot(ball.centre[0] - fdp[pupil][0], ball.centre[1] - fdp[pupil][1]) : Infinity);
    const [best] = scene.meshes.filter((mesh) => near(mesh) < 0.15 * apart).sort((a, b) => near(a) - near(b));
    if (best) call(best, part);
  }
  if (named(skin) !== 'skin') call(skin, 'skin');
  const free = scene.meshes.filter((mesh) => mesh !== skin && !named(mesh)).map((mesh) => ({ mesh, ...spanOf(mesh.position) }));
  const lips = (fdp['2.2'][1] + fdp['2.3'][1]) / 2;
  const wide = fdp['8.3'][0] - fdp['8.4'][0];
  const eyes = (fdp['3.5'][1] + fdp['3.6'][1]) / 2;
  const inMouth = ({ low, high }) => high[1] < fdp['9.15'][1] + 0.5 * wide && low[1] > fdp['2.1'][1] - 0.3 * wide && high[0] - low[0] < 2 * wide && high[2] < fdp['8.1'][2] + 0.05 * wide;
  const isBeard = ({ low, high }) => low[1] < fdp['2.1'][1] && high[1] > lips && high[1] < eyes + 0.25 * apart && high[2] > fdp['2.1'][2] - 0.1 * apart;
  const inside = free.filter(inMouth).sort((a, b) => b.middle[1] - a.middle[1]);
  const upper = inside.find(({ middle }) => middle[1] > lips);
  const under = inside.filter((one) => one !== upper && one.middle[1] <= lips + 0.1 * wide).sort((a, b) => b.size[0] - a.size[0]);
  if (upper && under.length) {
    call(upper.mesh, 'teeth_upper');
    under.slice(0, 2).forEach(({ mesh }, i) => call(mesh, ['teeth_lower', 'tongue'][i]));
  }
  for (const one of free) {
    if (inMouth(one)) {
      if (!['teeth_upper', 'teeth_lower', 'tongue'].includes(one.mesh.name)) call(one.mesh, 'mouth');
    } else if (one.middle[2] > fdp['3.5'][2] - 0.7 * apart && one.size[1] < 0.5 * apart && Math.abs(one.middle[1] - eyes) < 0.6 * apart)
      call(one.mesh, one.middle[1] > eyes + 0.07 * apart ? 'brows' : 'lashes');
    else if (isBeard(one)) call(one.mesh, 'beard');
    else call(one.mesh, one.middle[1] > lips ? 'hair' : 'clothes');
  }
  return guessed;
}
