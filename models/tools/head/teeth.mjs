// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Teeth, gums and palate, made from the figures of `anatomy.mjs`: every tooth a loft of rings along its
 * height, the gum a band with a scallop round each neck, the palate a vault between the gums. One part for
 * each jaw. Sizes in mm are those of an average adult (Wheeler's dental anatomy, rounded).
 */
import { archPath } from '../lib/anatomy.mjs';

/**
 * Width, height of the crown, thickness at the neck, how far the edge stays behind the line of the edges; of front teeth by how
 * much the edge's corners are rounded off, and how much darker they are (share of the crown from edge to neck).
 */
const UPPER = [
  [8.5, 10.5, 6.6, 0, 0.3, 0],
  [6.6, 9.4, 6, 0.6, 0.7, 0.04],
  [7.6, 10, 7.4, 0.15, 1.5, 0.14],
  [7, 8.6, 8.6, 0.6],
  [6.8, 8, 8.6, 0.8],
  [10, 7.2, 10, 1],
];
const LOWER = [
  [5.3, 9, 5.6, 0, 0.2, 0.02],
  [5.8, 9.2, 5.8, 0.05, 0.35, 0.04],
  [6.9, 10.2, 7, 0.35, 1.2, 0.14],
  [7, 8.6, 7.4, null],
  [7.1, 8, 7.8, null],
  [11, 7.2, 9.6, null],
];
const FRONT_TEETH = 3; // incisors and canine have an edge, the others a chewing surface

/** Height as a share of the crown; width; how far the outer surface lies behind the arch; thickness. */
const FRONT_RINGS = [
  [0, 0.78, 0.85, 0.09],
  [0.03, 0.91, 0.55, 0.15],
  [0.09, 0.97, 0.38, 0.17],
  [0.25, 1, 0.18, 0.23],
  [0.5, 0.99, 0, 0.5],
  [0.8, 0.9, 0.15, 0.9],
  [1.12, 0.76, 0.55, 1],
];
const BACK_RINGS = [
  [0, 0.66, 2, 0.55],
  [0.1, 0.9, 0.7, 0.85],
  [0.35, 1, 0.1, 1],
  [0.7, 0.96, 0.1, 0.98],
  [1.12, 0.84, 0.6, 0.86],
];
const ROUND = 14; // points of a ring
const SQUARE = 2 / 3; // exponent of its superellipse

/** Tiles of the texture: u, v, width, height. */
export const TILES = {
  tooth: [0.01, 0.01, 0.48, 0.98],
  gum: [0.52, 0.02, 0.46, 0.46],
  palate: [0.52, 0.52, 0.46, 0.46],
};

/** @returns {object[]} the parts `teeth_upper` and `teeth_lower` */
export function makeTeeth(ctx, figures, place) {
  const anchor = (group) => [[ctx.inGroup(group).indexOf(1), 1]];
  return [
    jawPart('teeth_upper', anchor('helper-upper-teeth'), upperJaw(figures, place)),
    jawPart('teeth_lower', anchor('helper-lower-teeth'), lowerJaw(figures, place)),
  ];
}

function upperJaw({ wear }, { edge, scale, front }) {
  const path = archPath({ scale, front, inset: 0 });
  const teeth = row(UPPER, scale, (tooth) => edge + tooth[3] * scale * (1 - 0.5 * wear));
  return { path, teeth, up: 1, scale };
}

function lowerJaw({ overbite, overjet }, { edge, scale, front }) {
  const path = archPath({ scale, front, inset: overjet });
  const upper = row(UPPER, scale, (tooth) => edge + tooth[3] * scale);
  const teeth = row(LOWER, scale, (tooth, i) =>
    // The chewing surfaces meet; only the front teeth bite over each other.
    tooth[3] === null ? upper[i].edge - 0.15 : edge + overbite - tooth[3] * scale,
  );
  return { path, teeth, up: -1, scale };
}

function row(sizes, scale, edgeOf) {
  let way = 0;
  return sizes.map((size, i) => {
    const [width, height, thickness, , corner = 0] = size.map((x) => x * scale);
    const middle = way + width / 2;
    way += width;
    return { width: width - 0.12, height, thickness, middle, edge: edgeOf(size, i), front: i < FRONT_TEETH, corner, darker: size[5] ?? 0 };
  });
}

function jawPart(name, anchor, jaw) {
  const mesh = { position: [], uv: [], index: [] };
  for (const side of [-1, 1]) for (const tooth of jaw.teeth) addTooth(mesh, jaw, tooth, side);
  const columns = gumColumns(jaw);
  addGum(mesh, jaw, columns);
  if (jaw.up > 0) addPalate(mesh, jaw, columns);
  else addFloor(mesh, jaw, columns);
  return {
    name,
    refs: Array.from({ length: mesh.position.length / 3 }, () => anchor),
    position: Float64Array.from(mesh.position),
    uv: mesh.uv,
    index: mesh.index,
    smooth: null,
    moves: [],
    turns: [],
  };
}

function tile(name, u, v) {
  const [x, y, w, h] = TILES[name];
  return [x + w * Math.min(1, Math.max(0, u)), y + h * Math.min(1, Math.max(0, v))];
}

/** Adds a triangle that faces along `towards`. */
function face(mesh, a, b, c, towards) {
  const p = mesh.position;
  const u = [0, 1, 2].map((k) => p[b * 3 + k] - p[a * 3 + k]),
    w = [0, 1, 2].map((k) => p[c * 3 + k] - p[a * 3 + k]);
  const n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
  if (Math.hypot(...n) < 1e-9) return;
  const facing = n.reduce((sum, x, k) => sum + x * towards[k], 0);
  mesh.index.push(...(facing >= 0 ? [a, b, c] : [a, c, b]));
}

const CORNER_HIGH = 0.35; // of the crown, up to which corners are rounded
const NEARER = 0.6; // of the corner towards the middle of the arch, as a share of the other one

/** How much a corner is off, from the middle of the edge (0) to its ends (-1 towards the middle of the arch, 1). */
const cornerOf = (x) => (x < 0 ? NEARER : 1) * Math.abs(x) ** 3;

function addTooth(mesh, { path, up }, tooth, side) {
  const at = path(side * tooth.middle);
  const along = [at.out[2], 0, -at.out[0]];
  const rings = tooth.front ? FRONT_RINGS : BACK_RINGS;
  const first = mesh.position.length / 3;
  const place = (t, o, y) => [at.x + along[0] * t + at.out[0] * o, y, at.z + along[2] * t + at.out[2] * o];
  for (const [height, width, back, thick] of rings) {
    const half = (tooth.width / 2) * width,
      deep = tooth.thickness * thick;
    for (let i = 0; i < ROUND; i++) {
      const angle = (2 * Math.PI * i) / ROUND;
      const c = Math.cos(angle),
        s = Math.sin(angle);
      const t = half * Math.sign(c) * Math.abs(c) ** SQUARE;
      const o = (deep / 2) * Math.sign(s) * Math.abs(s) ** SQUARE - back - deep / 2;
      const off = tooth.corner * cornerOf((side * t) / half) * Math.max(0, 1 - height / CORNER_HIGH);
      mesh.position.push(...place(t, o, tooth.edge + up * (tooth.height * height + off)));
      mesh.uv.push(...tile('tooth', 0.5 + t / tooth.width, height / 1.12 + tooth.darker));
    }
  }
  const centre = rings.map(([height, , back, thick]) =>
    place(0, -back - (tooth.thickness * thick) / 2, tooth.edge + up * tooth.height * height),
  );
  // The cap at the edge; on a chewing surface its middle is hollow.
  const cap = mesh.position.length / 3;
  const [, , back, thick] = rings[0];
  mesh.position.push(...place(0, -back - (tooth.thickness * thick) / 2, tooth.edge + up * (tooth.front ? 0 : 0.9)));
  mesh.uv.push(...tile('tooth', 0.5, tooth.front ? 0 : 0.5));
  for (let i = 0; i < ROUND; i++) {
    const j = (i + 1) % ROUND;
    face(mesh, first + i, first + j, cap, [0, -up, 0]);
    for (let r = 0; r + 1 < rings.length; r++) {
      const [a, b, c, d] = [r * ROUND + i, r * ROUND + j, (r + 1) * ROUND + j, (r + 1) * ROUND + i].map((x) => first + x);
      const out = [0, 1, 2].map((k) => mesh.position[a * 3 + k] + mesh.position[b * 3 + k] - 2 * centre[r][k]);
      face(mesh, a, b, c, out);
      face(mesh, a, c, d, out);
    }
  }
}

/** Places along the gum: at the middle of each tooth, at its quarters and between the teeth. */
function gumColumns({ teeth }) {
  const half = [];
  teeth.forEach((tooth, i) => {
    const next = teeth[i + 1];
    for (const [share, papilla] of [
      [-0.5, 1],
      [-0.27, 0.12],
      [0, 0],
      [0.27, 0.12],
    ])
      half.push({ s: tooth.middle + share * tooth.width, papilla, tooth });
    if (!next) half.push({ s: tooth.middle + tooth.width / 2, papilla: 0.6, tooth });
  });
  // Between two teeth the gum belongs to both.
  half.forEach((column, i) => {
    const before = half[i - 1]?.tooth;
    const mean = (of) => (column.papilla === 1 && before ? (of(before) + of(column.tooth)) / 2 : of(column.tooth));
    column.height = mean((t) => t.height);
    column.edge = mean((t) => t.edge);
    column.thickness = mean((t) => t.thickness);
  });
  half[0].s = 0;
  const left = half.slice(1).map((column) => ({ ...column, s: -column.s })).reverse();
  return [...left, half[0], ...half.slice(1)];
}

/** Adds rows of a band over the columns: `rows(column)` gives [s, offset outward, y]. */
function addBand(mesh, path, columns, rows, name, towards) {
  const first = mesh.position.length / 3;
  const across = rows(columns[0]).length;
  columns.forEach((column, i) => {
    rows(column).forEach(([offset, y, pinch = 1], r) => {
      const at = path(column.s);
      mesh.position.push((at.x + at.out[0] * offset) * pinch, y, at.z + at.out[2] * offset);
      mesh.uv.push(...tile(name, i / (columns.length - 1), r / (across - 1)));
    });
  });
  for (let i = 0; i + 1 < columns.length; i++) {
    const at = path((columns[i].s + columns[i + 1].s) / 2);
    for (let r = 0; r + 1 < across; r++) {
      const [a, b, c, d] = [i * across + r, (i + 1) * across + r, (i + 1) * across + r + 1, i * across + r + 1].map((x) => first + x);
      const out = towards(at, r);
      face(mesh, a, b, c, out);
      face(mesh, a, c, d, out);
    }
  }
}

const margin = (column) => column.height * (0.95 - 0.26 * column.papilla);

function addGum(mesh, { path, up, scale }, columns) {
  // Below, the fold between lip and gum is near.
  const [high, deep] = up > 0 ? [5.5, 1] : [2, 4.4];
  const rows = (column) => {
    const y = (mm) => column.edge + up * mm;
    const neck = column.height * 0.94;
    const between = column.papilla;
    return [
      [-1 - 1.1 * between, y(margin(column))],
      [0.15 - 0.9 * between, y(margin(column) + 0.25 + 0.3 * between)],
      [(up > 0 ? 0.3 : -0.5) - 0.25 * between, y(neck + Math.min(1.4, 0.4 * high))],
      [up > 0 ? -0.1 : -2.2, y(neck + high * 0.6 * scale)],
      [-deep, y(neck + high * scale)],
    ];
  };
  addBand(mesh, path, columns, rows, 'gum', (at) => at.out);
}

/** The vault: from the gum behind the teeth up to the middle, higher towards the back. */
function addPalate(mesh, { path, scale }, columns) {
  const front = path(0).z;
  const rows = (column) => {
    const back = front - path(column.s).z;
    const inner = -column.thickness;
    const neck = column.edge + column.height * 0.78;
    const top = neck + 13 * scale * Math.min(1, back / (18 * scale)) ** 0.7;
    const vault = [0, 0.12, 0.3, 0.55, 0.8, 1];
    return [
      [inner + 2.2, neck - 0.4],
      ...vault.map((t) => [inner - 0.3, neck + 0.6 + (top - neck) * Math.sin((Math.PI / 2) * t) ** 0.9, 1 - t]),
    ];
  };
  addBand(mesh, path, columns, rows, 'palate', (at, r) => [-at.out[0] * (r < 3 ? 0.6 : 0.1), -1, -at.out[2] * 0.6]);
}

/** The gum behind the lower teeth, down to the floor, which the tongue covers. */
function addFloor(mesh, { path }, columns) {
  const rows = (column) => {
    const neck = column.edge - column.height * 0.8;
    const inner = -column.thickness;
    return [
      [inner + 2, neck + 0.4],
      [inner - 0.3, neck - 0.5],
      [inner - 0.8, neck - 3],
      [inner - 0.6, neck - 6],
    ];
  };
  addBand(mesh, path, columns, rows, 'gum', (at) => at.out.map((x) => -x));
}
