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
  [8.5, 10.5, 6.6, 0, 0.6, 0],
  [6.6, 9.4, 6, 0.75, 0.95, 0.04],
  [7.6, 10, 7.4, 0.2, 1.5, 0.16],
  [7, 8.6, 8.6, 0.6],
  [6.8, 8, 8.6, 0.8],
  [10, 7.2, 10, 1],
];
const LOWER = [
  [5.3, 9, 5.6, 0, 0.3, 0.02],
  [5.8, 9.2, 5.8, 0.1, 0.45, 0.04],
  [6.9, 10.2, 7, 0.35, 1.2, 0.16],
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
const CURVED = 0.76; // of front teeth, whose outer surface is rounder

/** Of teeth that stand as unevenly as they may: shares of the width and of the corner; mm out of line, mm of the edge, degrees of turn and of tilt. */
const UNEVEN = { width: 0.07, corner: 0.5, out: 0.4, edge: 0.35, turn: 9, tilt: 4 };
const GAP = 0.14; // mm between teeth

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

/** A repeatable sequence of numbers of -1..1 that belongs to a name. */
function chance(name) {
  let state = [...name].reduce((sum, letter) => Math.imul(sum ^ letter.codePointAt(0), 16777619), 2166136261);
  return () => {
    state = Math.imul(state ^ (state >>> 15), 2246822519) + 0x9e3779b9;
    return (((state ^ (state >>> 13)) >>> 0) / 2 ** 31) - 1;
  };
}

function upperJaw({ wear, uneven, name }, { edge, scale, front }) {
  const path = archPath({ scale, front, inset: 0 });
  const of = { scale, uneven, wear, next: chance(`${name} upper`) };
  const teeth = row(UPPER, of, (tooth) => edge + tooth[3] * scale * (1 - 0.5 * wear));
  return { path, teeth, up: 1, scale };
}

function lowerJaw({ overbite, overjet, wear, uneven, name }, { edge, scale, front }) {
  const path = archPath({ scale, front, inset: overjet });
  const of = { scale, uneven, wear, next: chance(`${name} lower`) };
  const upper = row(UPPER, { ...of, uneven: 0 }, (tooth) => edge + tooth[3] * scale);
  const teeth = row(LOWER, of, (tooth, i) =>
    // The chewing surfaces meet; only the front teeth bite over each other.
    tooth[3] === null ? upper[i].edge - 0.15 : edge + overbite - tooth[3] * scale,
  );
  return { path, teeth, up: -1, scale };
}

/** @param {{scale: number, uneven: number, wear: number, next: () => number}} of uneven: 0 for a row as even as dentures, 1 for the most */
function row(sizes, { scale, uneven, wear, next }, edgeOf) {
  const widths = sizes.map(([width]) => width * (1 + UNEVEN.width * uneven * next()));
  const fit = sizes.reduce((sum, [width]) => sum + width, 0) / widths.reduce((sum, width) => sum + width, 0);
  let way = 0;
  return sizes.map((size, i) => {
    const [, height, thickness, , corner = 0] = size.map((x) => x * scale);
    const width = widths[i] * fit * scale;
    const middle = way + width / 2;
    way += width;
    const front = i < FRONT_TEETH;
    const sides = [-1, 1].map(() => stance(front ? uneven : 0, next));
    const rounded = corner * (1 - 0.5 * wear) * (1 + UNEVEN.corner * uneven * next());
    return { width: width - GAP, height, thickness, middle, edge: edgeOf(size, i), front, corner: rounded, darker: size[5] ?? 0, sides };
  });
}

/** How one tooth stands out of the row: mm outward, mm of its edge towards the root, radians about its axis and in its own plane. */
function stance(uneven, next) {
  const [out, edge, turn, tilt] = ['out', 'edge', 'turn', 'tilt'].map((name) => UNEVEN[name] * uneven * next());
  return { out, edge, turn: (turn * Math.PI) / 180, tilt: (tilt * Math.PI) / 180 };
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
const LONGER = 0.12; // of the corner: the middle stands out by this, so that as much of a tooth is seen as of a square one
const NEARER = 0.6; // of the corner towards the middle of the arch, as a share of the other one

/** How much a corner is off, from the middle of the edge (0) to its ends (-1 towards the middle of the arch, 1). */
const cornerOf = (x) => (x < 0 ? NEARER : 1) * Math.abs(x) ** 3;

function addTooth(mesh, { path, up }, tooth, side) {
  const at = path(side * tooth.middle);
  const along = [at.out[2], 0, -at.out[0]];
  const rings = tooth.front ? FRONT_RINGS : BACK_RINGS;
  const first = mesh.position.length / 3;
  const stands = tooth.sides[side < 0 ? 0 : 1];
  const middle = -tooth.thickness / 2;
  const [sin, cos] = [Math.sin(stands.turn), Math.cos(stands.turn)];
  const neck = tooth.edge + up * tooth.height; // about which it is tilted
  const place = (along1, out1, y) => {
    const t = along1 * cos - (out1 - middle) * sin + stands.tilt * (y - neck) * up;
    const o = middle + along1 * sin + (out1 - middle) * cos + stands.out;
    return [at.x + along[0] * t + at.out[0] * o, y + up * stands.edge, at.z + along[2] * t + at.out[2] * o];
  };
  for (const [height, width, back, thick] of rings) {
    const half = (tooth.width / 2) * width,
      deep = tooth.thickness * thick;
    for (let i = 0; i < ROUND; i++) {
      const angle = (2 * Math.PI * i) / ROUND;
      const c = Math.cos(angle),
        s = Math.sin(angle);
      const t = half * Math.sign(c) * Math.abs(c) ** SQUARE;
      const o = (deep / 2) * Math.sign(s) * Math.abs(s) ** (tooth.front && s > 0 ? CURVED : SQUARE) - back - deep / 2;
      const off = tooth.corner * (cornerOf((side * t) / half) - LONGER) * Math.max(0, 1 - height / CORNER_HIGH);
      mesh.position.push(...place(t, o, tooth.edge + up * (tooth.height * height + off)));
      mesh.uv.push(...tile('tooth', 0.5 + t / tooth.width, height / 1.12 + tooth.darker));
    }
  }
  // The cap at the edge; on a chewing surface its middle is hollow.
  const cap = mesh.position.length / 3;
  const [, , back, thick] = rings[0];
  mesh.position.push(...place(0, -back - (tooth.thickness * thick) / 2, tooth.edge + up * (tooth.front ? -LONGER * tooth.corner : 0.9)));
  mesh.uv.push(...tile('tooth', 0.5, tooth.front ? 0 : 0.5));
  // Rings turn from the side to the front: seen from outside, clockwise above. The same for all heads, which share these numbers.
  const outside = (a, b, c) => mesh.index.push(...(up > 0 ? [a, c, b] : [a, b, c]));
  for (let i = 0; i < ROUND; i++) {
    const j = (i + 1) % ROUND;
    outside(first + i, cap, first + j);
    for (let r = 0; r + 1 < rings.length; r++) {
      const [a, b, c, d] = [r * ROUND + i, r * ROUND + j, (r + 1) * ROUND + j, (r + 1) * ROUND + i].map((x) => first + x);
      outside(a, b, c);
      outside(a, c, d);
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
