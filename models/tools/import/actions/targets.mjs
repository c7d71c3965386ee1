// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Converts morph targets to actions of FAPs. ../../shapes defines ARKit's shapes and the visemes in FAPs; with the zones' actions that predicts each target on
 * this mesh. The residual of each target is distributed over its FAPs with minimum norm, so that all targets are reproduced exactly: with A the FAPs
 * of the targets and R the residuals, the moves are A+ R (the pseudoinverse, damped for similar targets).
 */
import { pose, unitLength } from '../../lib/deform.mjs';
import { FAPS } from '../../lib/faps.mjs';
import { ARKIT, LETTERS, VISEMES } from '../../avatar/shapes.mjs';
import { nearestVertex } from '../../lib/mesh.mjs';
import { at } from './fields.mjs';

const DAMPING = 1e-3; // of the mean square: too much misses the targets, too little splits shared movements arbitrarily
const SIZES = [0.25, 4]; // accepted size of a shape relative to its definition
const WHOLE = new Set(['viseme_PP', 'viseme_FF', ...Object.keys(LETTERS)]); // whatever their size: half a contact leaves the lips apart, and letters are spoken as they are
const LEAST = 0.012; // mm per mm of the FAP: smaller moves are dropped

const KNOWN = new Map(Object.entries({ ...ARKIT, ...VISEMES, ...LETTERS }).map(([name, faps]) => [name, { name, faps }])); // by the names of target-names.mjs

/** Solves a x = b in place for symmetric positive definite a; b, with `width` columns, becomes x. */
function solve(a, b) {
  const n = a.length;
  for (let i = 0; i < n; i++) {
    for (let r = 0; r < n; r++) {
      if (r === i) continue;
      const factor = a[r][i] / a[i][i];
      if (!factor) continue;
      for (let k = i; k < n; k++) a[r][k] -= factor * a[i][k];
      for (let k = 0; k < b[0].length; k++) b[r][k] -= factor * b[i][k];
    }
  }
  return b.map((row, i) => row.map((x) => x / a[i][i]));
}

/** Size of a target relative to its definition on this face, by the movement of feature points. */
function sizeOf(head, skin, faps, deltas, fdp) {
  let [both, own, there] = [0, 0, 0];
  for (const [number, value] of Object.entries(faps)) {
    const { direction, point } = FAPS[number];
    if (!direction || !fdp[point] || point[0] === '6' || (number >= 19 && number <= 22)) continue;
    const want = value * unitLength(head, number);
    const d = at(deltas, nearestVertex(skin, fdp[point]));
    const is = d.reduce((sum, x, k) => sum + x * direction[k], 0);
    both += want * is;
    own += want * want;
    there += is * is;
  }
  if (own < 0.25) return 1; // it moves no feature point
  return both > 0.15 * Math.sqrt(own * there) ? both / own : 0;
}

/**
 * Adds moves to the parts of `head` (unpacked form), so that its FAPs reproduce the targets.
 * @returns {{used: string[], notes: string[]}}
 */
export function actFromTargets(head, parts) {
  const skin = parts.find(({ name }) => name === 'skin');
  const all = [...new Set(parts.flatMap(({ targets }) => Object.keys(targets)))];
  const notes = [];
  const rows = [];
  for (const name of all) {
    const shape = KNOWN.get(name);
    if (!shape || !Object.keys(shape.faps).length || rows.some((row) => row.shape.name === shape.name)) continue;
    const size = skin.targets[name] ? sizeOf(head, skin, shape.faps, skin.targets[name], head.fdp) : 1;
    if (size < SIZES[0] || size > SIZES[1]) notes.push(`target ${name} does not do what its name says: left out`);
    else {
      const exact = Math.abs(size - 1) < 0.1 || WHOLE.has(shape.name) ? 1 : size;
      rows.push({ name, shape, faps: Object.fromEntries(Object.entries(shape.faps).map(([fap, value]) => [fap, FAPS[fap].unit === 'AU' || (fap >= 19 && fap <= 22) ? value : value * exact])) });
    }
  }
  if (!rows.length) return { used: [], notes };
  const columns = [...new Set(rows.flatMap(({ faps }) => Object.entries(faps).map(([fap, value]) => `${fap} ${value > 0 ? 'positive' : 'negative'}`)))];
  const scale = (fap) => unitLength(head, fap) * (FAPS[fap].unit === 'AU' ? 60 : 1); // a radian is about 60 mm on a face
  const matrix = rows.map(({ faps }) => columns.map((column) => {
    const [fap, sign] = column.split(' ');
    const value = faps[fap] ?? 0;
    return value > 0 === (sign === 'positive') ? value * scale(fap) : 0;
  }));
  const square = matrix.map((a) => matrix.map((b) => a.reduce((sum, x, k) => sum + x * b[k], 0)));
  const mean = square.reduce((sum, row, i) => sum + row[i], 0) / rows.length;
  square.forEach((row, i) => (row[i] += DAMPING * mean));
  const inverse = solve(square, rows.map((_, i) => rows.map((__, k) => Number(i === k))));
  const shares = columns.map((_, c) => rows.map((__, k) => matrix.reduce((sum, row, i) => sum + row[c] * inverse[i][k], 0)));
  for (const part of parts) {
    const posed = head.parts.find(({ name }) => name === part.name);
    const left = rows.map(({ name, faps }) => {
      const own = part.targets[name];
      const zone = pose(head, posed, faps);
      return own || part.name === 'skin' ? zone.map((x, i) => (own?.[i] ?? 0) - (x - part.position[i])) : null;
    });
    if (left.every((one) => !one)) continue;
    const added = columns.map((column, c) => {
      const [fap, sign] = column.split(' ');
      if (part.name.startsWith('eye_') && FAPS[fap].unit === 'AU') return null;
      const field = new Float64Array(part.position.length);
      left.forEach((one, k) => {
        const share = shares[c][k] * (scale(fap) / unitLength(head, fap));
        if (one && Math.abs(share) > 1e-9) for (let i = 0; i < field.length; i++) field[i] += share * one[i];
      });
      return moveOf(Number(fap), sign, field);
    });
    posed.moves.push(...added.filter(Boolean));
  }
  return { used: rows.map(({ shape }) => shape.name), notes };
}

/** Converts a field to a move with the affected vertices; null: none. Angles: mm per radian. */
export function moveOf(fap, sign, field) {
  const vertices = [];
  const deltas = [];
  const least = FAPS[fap].unit === 'AU' ? 60 * LEAST : LEAST;
  for (let v = 0; v < field.length / 3; v++) {
    const d = at(field, v);
    if (Math.hypot(...d) < least) continue;
    vertices.push(v);
    deltas.push(...d);
  }
  return vertices.length ? { fap, sign, vertices, deltas } : null;
}
