// SPDX-License-Identifier: MIT
// A base head takes the shape of a face: its landmarks go where the face has them, and the whole head follows. FAPs go on
// working, for their moves are told in FAPU and the units are measured anew; turns get the angle by which their point moves
// as far as its unit says.
import { rbf } from '../element/head/model/rbf.mjs';
import { eyeMoves, lipLine, shapePoints } from './fit.mjs';

const SMOOTH = 0.004; // of the warp: landmarks tremble by half a millimetre
const STILL = 45; // mm from any landmark: from there on the base keeps its place
const EYE = [17, 31]; // mm from an eye's middle: up to where it moves as a whole, and from where no more
const RIGID = ['teeth_upper', 'teeth_lower', 'tongue'];
const WIDER = [0.9, 1.1]; // the arch of the teeth, with the mouth
const FAPU = { ES: ['3.5', '3.6'], MW: ['8.3', '8.4'], MNS: ['9.15', '2.2'] };

const step = (t) => (t <= 0 ? 0 : t >= 1 ? 1 : t * t * (3 - 2 * t));
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** Some points of the skin that no landmark is near, spread over it. */
function farPoints(positions, near) {
  const out = [];
  for (let v = 0; v < positions.length; v += 3) {
    const p = [...positions.subarray(v, v + 3)];
    if (out.some((q) => distance(p, q) < 38) || near.some((q) => distance(p, q) < STILL)) continue;
    out.push(p);
  }
  return out;
}

/**
 * The warp of space from a base head to a face.
 * @param {{positions: Float32Array}} skin of the base @param {import('./fit.mjs').Points} base @param {(number[]|null)[]}
 *   target
 */
export function warpOf(skin, base, target) {
  const numbers = shapePoints(base);
  const from = numbers.map((i) => base.at[i]);
  const to = numbers.map((i) => target[i]);
  lipLine(base.at).forEach((p, i) => {
    from.push(p);
    to.push(lipLine(target)[i]);
  });
  for (const p of farPoints(skin.position, from)) {
    from.push(p);
    to.push(p);
  }
  const apart = from.map((p, i) => from.findIndex((q) => distance(p, q) < 0.4) === i); // no two in one place
  const kept = (points) => points.filter((_, i) => apart[i]).flat();
  const whole = rbf(kept(from), kept(to), { kernel: 'biharmonic', smooth: SMOOTH });
  const eyes = Object.values(eyeMoves(target, base)).map((move) => {
    const depth = whole.at(move.from)[2];
    return { ...move, to: [move.to[0], move.to[1], depth] };
  });
  return { apply: (positions) => withEyes(whole.apply(positions), positions, eyes), eyes };
}

function eyeAt(p, { from, to, roll, scale }) {
  const [c, s] = [Math.cos(roll), Math.sin(roll)];
  const [x, y, z] = from.map((q, k) => (p[k] - q) * scale);
  return [to[0] + c * x - s * y, to[1] + s * x + c * y, to[2] + z];
}

function withEyes(out, positions, eyes) {
  for (const eye of eyes)
    for (let i = 0; i < positions.length; i += 3) {
      const p = positions.subarray(i, i + 3);
      const far = distance(p, [eye.from[0], eye.from[1], eye.from[2] - 8]);
      const share = 1 - step((far - EYE[0]) / (EYE[1] - EYE[0]));
      if (!share) continue;
      eyeAt(p, eye).forEach((x, k) => (out[i + k] += share * (x - out[i + k])));
    }
  return out;
}

/** Teeth and tongue keep their form and their place behind the lips; the arch is as wide as the mouth wants it. */
function behindLips(model, warp) {
  const place = (name) => [model.fdp[name], [...warp.apply(Float32Array.from(model.fdp[name]))]];
  const lips = [place('2.2'), place('2.3')];
  const shift = [0, 1, 2].map((k) => lips.reduce((sum, [was, is]) => sum + (is[k] - was[k]) / 2, 0));
  const [left, right] = [place('8.3'), place('8.4')];
  const wide = Math.max(WIDER[0], Math.min(WIDER[1], (left[1][0] - right[1][0]) / (left[0][0] - right[0][0])));
  return (positions) => Float32Array.from(positions, (x, i) => (i % 3 ? x : x * wide) + shift[i % 3]);
}

/** The vertex of any part at a place. */
function vertexAt(parts, place) {
  let best = null;
  let least = Infinity;
  for (const part of parts)
    for (let v = 0; v < part.position.length; v += 3) {
      const far = Math.hypot(part.position[v] - place[0], part.position[v + 1] - place[1], part.position[v + 2] - place[2]);
      if (far < least) [least, best] = [far, { part, v }];
    }
  return best;
}

const placeOf = (positions, { part, v }) => [...positions.get(part).subarray(v, v + 3)];

/** Returns the displacement of a point by one unit of a turn. */
function moved({ axis, pivot, radians }, p) {
  const [x, y, z] = p.map((value, k) => value - pivot[k]);
  return [axis[1] * z - axis[2] * y, axis[2] * x - axis[0] * z, axis[0] * y - axis[1] * x].map((value) => value * radians);
}

/**
 * @param {object} model the base, read (web/element/head/model/model.mjs) @param {import('./fit.mjs').Points} base @param
 *   {(number[]|null)[]} target @param {((positions: Float32Array) => Float32Array)|null} [sag] by which age moves places
 * @returns {{positions: Map<object, Float32Array>, fdp: object, fapu: object, turns: object[], warp: object}} of the new
 *   head: positions by part
 *   of the model, the rest as in protocol/head-model.md
 */
export function morph(model, base, target, sag = null) {
  const skin = model.parts.find(({ name }) => name === 'skin');
  const warp = warpOf(skin, base, target);
  const placesOf = ({ position }) => {
    const by = sag?.(position);
    return warp.apply(position).map((x, i) => (by ? x + by[i] : x));
  };
  const positions = new Map(model.parts.map((part) => [part, placesOf(part)]));
  const centre = (side) => model.turns.find(({ name }) => name === `eye_${side}_yaw`).pivot;
  const eyes = { l: warp.eyes.find(({ from }) => from[0] > 0), r: warp.eyes.find(({ from }) => from[0] < 0) };
  const within = behindLips(model, warp);
  for (const part of model.parts) if (RIGID.includes(part.name)) positions.set(part, within(part.position));
  for (const part of model.parts) {
    const eye = /^eye_([lr])/.exec(part.name)?.[1];
    if (eye) positions.set(part, Float32Array.from(part.position, (_, i) =>
      eyeAt(part.position.subarray(i - (i % 3), i - (i % 3) + 3),
      { ...eyes[eye], roll: 0, ...ball(centre(eye), eyes[eye]) })[i % 3]));
  }
  const fdp = Object.fromEntries(Object.entries(model.fdp).map(([name, place]) =>
    [name, rounded(placeOf(positions, vertexAt(model.parts, place)))]));
  const fapu = unitsOf(model, fdp, eyes.l.scale);
  return { positions, fdp, fapu, turns: turnsOf(model, { warp, eyes, fdp, fapu }), warp };
}

const rounded = (p) => p.map((x) => Math.round(x * 1000) / 1000);

/** A ball goes where its middle goes, and is not rolled: its iris is round. */
const ball = (middle, eye) => ({ from: middle, to: eyeAt(middle, eye) });

function unitsOf({ fapu, fdp: was }, is, scale) {
  const out = { ...fapu, IRISD: fapu.IRISD * scale };
  for (const [unit, [a, b]] of Object.entries(FAPU)) if (was[a] && was[b]) out[unit] = (fapu[unit] *
    distance(is[a], is[b])) / distance(was[a], was[b]);
  if (was['9.15'] && was['3.5']) {
    const height = (fdp) => (fdp['3.5'][1] + fdp['3.6'][1]) / 2 - fdp['9.15'][1];
    out.ENS = (fapu.ENS * height(is)) / height(was);
  }
  return Object.fromEntries(Object.entries(out).map(([name, mm]) => [name, Math.round(mm * 1e4) / 1e4]));
}

function turnsOf(model, { warp, eyes, fdp, fapu }) {
  return model.turns.map((turn) => {
    const side = /^(?:lid|eye)_([lr])/.exec(turn.name)?.[1];
    if (side) {
      const { roll } = eyes[side];
      const axis = turn.name.startsWith('lid') ? [Math.cos(roll) * turn.axis[0] - Math.sin(roll) * turn.axis[1], Math.sin(roll) * turn.axis[0] + Math.cos(roll) * turn.axis[1], turn.axis[2]] : turn.axis;
      return { ...turn, axis, pivot: rounded(eyeAt(turn.pivot, eyes[side])) };
    }
    if (turn.name !== 'jaw' || !model.fdp['2.1']) return turn;
    const pivot = rounded([...warp.apply(Float32Array.from(turn.pivot))]);
    const was = moved(turn, model.fdp['2.1'])[1] / model.fapu.MNS;
    const is = moved({ ...turn, pivot }, fdp['2.1'])[1] / fapu.MNS;
    return { ...turn, pivot, radians: Number(((turn.radians * was) / is).toPrecision(9)) };
  });
}
