// SPDX-License-Identifier: MIT
// The relief of skin, pores and fine lines, as a picture that repeats: made here, so that nothing has to be loaded. Only fine
// quality draws it.
import { DataTexture, LinearFilter, LinearMipmapLinearFilter, LinearMipmapNearestFilter, RepeatWrapping } from 'three';
import { turned } from '../mesh/influences.mjs';
import { kindOf } from './surfaces.mjs';

const SIZE = 128;
const TILE_MM = 15;
const BUMPS = 11; // along a side: how uneven skin is,
const UNEVEN = 0.22; // and how high
const PLATES = [[22, 0.18], [43, 0.09]]; // between the fine lines, along a side, and how deep the lines are
const LINE = 0.35; // of a plate's size: how wide a line is
const PORES = 17; // along a side
const STEEP = 260; // slopes to bytes
const LIDS_DOWN = [19, 20]; // FAPs that bring the upper lids down, at CLOSED
const CLOSED = 1024;

/** 0..1, the same everywhere. */
function hash(x, y, seed) {
  let h = Math.imul(x, 374761393) ^ Math.imul(y, 668265263) ^ Math.imul(seed, 974634777);
  h = Math.imul(h ^ (h >>> 13), 1274126177);
  return ((h ^ (h >>> 16)) >>> 0) / 4294967296;
}

const smooth = (t) => t * t * (3 - 2 * t);

/** Noise of 0..1 that repeats after `cells`. */
function bumps(u, v, cells) {
  const [x, y] = [u * cells, v * cells];
  const [i, j] = [Math.floor(x), Math.floor(y)];
  const at = (a, b) => hash((i + a) % cells, (j + b) % cells, cells);
  const [s, t] = [smooth(x - i), smooth(y - j)];
  return (at(0, 0) * (1 - s) + at(1, 0) * s) * (1 - t) + (at(0, 1) * (1 - s) + at(1, 1) * s) * t;
}

/** A point anywhere in each cell of the tile: its x and y in cells, row by row. */
function scattered(cells, seed) {
  const places = new Float32Array(2 * cells * cells);
  for (let j = 0; j < cells; j++)
    for (let i = 0; i < cells; i++)
      for (const k of [0, 1]) places[2 * (j * cells + i) + k] = 0.02 + 0.96 * hash(i, j, seed + k);
  return places;
}

/**
 * Visits the points of the cells about a place of the tile: what is nearest is among them.
 * @param {(square: number, a: number, b: number) => void} visit square of the distance, in cells; number of the cell
 */
function near(places, cells, u, v, visit) {
  const left = Math.floor(u * cells) - 1, low = Math.floor(v * cells) - 1;
  for (let j = low; j < low + 3; j++)
    for (let i = left; i < left + 3; i++) {
      const a = (i + cells) % cells, b = (j + cells) % cells;
      const at = 2 * (b * cells + a);
      const dx = u * cells - i - places[at], dy = v * cells - j - places[at + 1];
      visit(dx * dx + dy * dy, a, b);
    }
}

/** How deep a line between plates is at each texel, 0..1: where the nearest point is hardly nearer than the next. */
function lines(cells) {
  const places = scattered(cells, 5);
  return texels((u, v) => {
    let first = 9, second = 9;
    near(places, cells, u, v, (square) => {
      second = Math.min(second, Math.max(first, square));
      first = Math.min(first, square);
    });
    return smooth(1 - Math.min(1, (Math.sqrt(second) - Math.sqrt(first)) / LINE));
  });
}

/** Returns the depth of a pore at each texel, 0..1. */
function pores() {
  const places = scattered(PORES, 1);
  return texels((u, v) => {
    let deep = 0;
    near(places, PORES, u, v, (square, a, b) => {
      const wide = 0.2 + 0.16 * hash(a, b, 3);
      if (square < wide * wide) deep = Math.max(deep, smooth(1 - Math.sqrt(square) / wide));
    });
    return deep;
  });
}

function texels(of) {
  const out = new Float32Array(SIZE * SIZE);
  for (let j = 0; j < SIZE; j++) for (let i = 0; i < SIZE; i++) out[j * SIZE + i] = of(i / SIZE, j / SIZE);
  return out;
}

/**
 * Slopes along both sides (128: flat), and how deep the pores are.
 * @param {boolean} plain whether it is to go from one size to the next in a step, which is cheaper to draw
 */
export function grainTexture(plain) {
  const holes = pores();
  const height = texels((u, v) => UNEVEN * bumps(u, v, BUMPS));
  for (const [cells, deep] of PLATES) lines(cells).forEach((line, k) => (height[k] -= deep * line));
  holes.forEach((deep, k) => (height[k] -= 0.35 * deep));
  const data = new Uint8Array(4 * SIZE * SIZE);
  const at = (i, j) => height[((j + SIZE) % SIZE) * SIZE + ((i + SIZE) % SIZE)];
  for (let j = 0; j < SIZE; j++)
    for (let i = 0; i < SIZE; i++) {
      const byte = (slope) => Math.min(255, Math.max(0, Math.round(128 + STEEP * slope)));
      const k = j * SIZE + i;
      data.set([byte(at(i + 1, j) - at(i - 1, j)), byte(at(i, j + 1) - at(i, j - 1)), Math.round(255 * holes[k]), 255], 4 * k);
    }
  const texture = new DataTexture(data, SIZE, SIZE);
  Object.assign(texture, {
    wrapS: RepeatWrapping, wrapT: RepeatWrapping, magFilter: LinearFilter, generateMipmaps: true, needsUpdate: true,
    minFilter: plain ? LinearMipmapNearestFilter : LinearMipmapLinearFilter,
  });
  return texture;
}

/**
 * By how many mm each vertex of the skin stands lower with the lids down. Pores are laid on it as it stands then: at rest the
 * lids are folded away, and what is laid on them from the front would come out as streaks.
 * @param {import('../model/model.mjs').Part} part @param {object[]} axes the model's turns
 * @returns {Float32Array|undefined} of other parts nothing
 */
export function loweredBy(part, axes) {
  if (kindOf(part.name) !== 'skin') return undefined;
  const out = new Float32Array(part.vertices);
  for (const { turn, vertices, weights } of part.turns) {
    const { fap, radians } = axes[turn];
    if (!LIDS_DOWN.includes(fap) || !vertices) continue;
    vertices.forEach((v, i) => {
      const rest = part.position.subarray(3 * v, 3 * v + 3);
      out[v] += rest[1] - turned(rest, axes[turn], CLOSED * radians * weights[i])[1];
    });
  }
  return out;
}

export const grainGlsl = /* glsl */ `
uniform sampler2D grain;
uniform float relief; // 1: that of a grown person

/** Bends the normal as pores and fine lines do: seen from the front and from the side. @returns how deep a pore is */
float grained(inout vec3 n, vec3 place, float amount) {
  float aside = smoothstep(0.55, 0.8, abs(n.x));
  vec3 front = texture2D(grain, place.xy / ${TILE_MM.toFixed(1)}).xyz, side = texture2D(grain, place.zy / ${TILE_MM.toFixed(1)} + 0.4).xyz;
  vec3 found = mix(front, side, aside);
  vec2 slope = (found.xy - 0.502) * relief * amount;
  n -= vec3(slope.x * (1.0 - aside), slope.y, slope.x * aside);
  return found.z * relief * amount;
}
`;
