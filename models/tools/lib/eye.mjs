// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * A generated eyeball: a sphere about the z axis with a low corneal bulge, its texture is a front view.
 */
import { piecewise, raisedCosine } from './zones.mjs';

/** The iris takes this much of the texture's half width; the white the rest. */
const IRIS_SHARE = 0.21;

/** Distance from the middle of the texture for an angle from the optical axis, and back. */
function eyeRadius(spec, angle) {
  return piecewise([0, spec.irisAngle, spec.span], [0, IRIS_SHARE, 0.5], angle);
}

export function eyeAngle(spec, radius) {
  return piecewise([0, IRIS_SHARE, 0.5], [0, spec.irisAngle, spec.span], radius);
}

/**
 * @param {{radius: number, bulge: number, bulgeAngle: number, span: number}} spec radius and bulge in mm,
 *   angles in radians
 */
export function eyePart(name, centre, spec, faps) {
  const position = [],
    uv = [],
    index = [],
    angles = [];
  const add = (angle, turn) => {
    const r = spec.radius + spec.bulge * raisedCosine(angle / spec.bulgeAngle);
    const s = Math.sin(angle) * r;
    position.push(
      centre[0] + s * Math.cos(turn),
      centre[1] + s * Math.sin(turn),
      centre[2] + Math.cos(angle) * r,
    );
    const t = eyeRadius(spec, angle);
    uv.push(0.5 + t * Math.cos(turn), 0.5 + t * Math.sin(turn));
    angles.push([angle, turn]);
  };
  add(0, 0);
  const rings = spec.rings.length,
    n = spec.columns;
  for (const angle of spec.rings) for (let c = 0; c < n; c++) add(angle, (2 * Math.PI * c) / n);
  const at = (r, c) => 1 + r * n + (c % n);
  for (let c = 0; c < n; c++) {
    index.push(0, at(0, c), at(0, c + 1));
    for (let r = 1; r < rings; r++) {
      index.push(at(r - 1, c), at(r, c), at(r, c + 1), at(r - 1, c), at(r, c + 1), at(r - 1, c + 1));
    }
  }
  const part = {
    name,
    refs: angles.map(() => []),
    uv,
    index,
    smooth: null,
    position: Float64Array.from(position),
    moves: [],
    turns: [],
  };
  const all = angles.map((_, v) => v);
  part.moves.push({ fap: faps.thrust, sign: 'both', vertices: all, deltas: all.flatMap(() => [0, 0, 1]) });
  part.moves.push(pupilMove(faps.dilate, angles, spec));
  return part;
}

/**
 * A wider pupil: the texture goes outward with the mesh, fully at the pupil's border, not at all at the
 * iris's. A unit of diameter is half a unit of radius.
 */
function pupilMove(fap, angles, spec) {
  const vertices = [],
    deltas = [];
  angles.forEach(([angle, turn], v) => {
    const pupil = spec.pupilAngle;
    const w = angle <= pupil ? angle / pupil : raisedCosine((angle - pupil) / (spec.irisAngle - pupil));
    if (w < 1e-3) return;
    vertices.push(v);
    deltas.push(0.5 * w * Math.cos(turn), 0.5 * w * Math.sin(turn), 0);
  });
  return { fap, sign: 'both', vertices, deltas };
}
