// SPDX-License-Identifier: MIT
// The relief of skin, pores and fine lines, as a picture that repeats: made here, so that nothing has to be loaded. Only fine
// quality draws it.
import { DataTexture, LinearFilter, LinearMipmapLinearFilter, LinearMipmapNearestFilter, RepeatWrapping } from 'three';
import { turned } from '../mesh/influences.mjs';
import { kindOf } from './surfaces.mjs';

const SIZE = 128;
const TILE_MM = 15;
const CELLS = [[9, 0.3], [19, 0.3], [37, 0.22]]; // bumps along a side, and how high they are
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

/** Returns the depth of a pore, 0..1. */
function pore(u, v) {
  const [x, y] = [u * PORES, v * PORES];
  let deep = 0;
  for (let j = Math.floor(y) - 1; j <= Math.floor(y) + 1; j++)
    for (let i = Math.floor(x) - 1; i <= Math.floor(x) + 1; i++) {
      const [a, b] = [(i + PORES) % PORES, (j + PORES) % PORES];
      const far = Math.hypot(x - i - 0.2 - 0.6 * hash(a, b, 1), y - j - 0.2 - 0.6 * hash(a, b, 2));
      const wide = 0.2 + 0.16 * hash(a, b, 3);
      if (far < wide) deep = Math.max(deep, smooth(1 - far / wide));
    }
  return deep;
}

/**
 * Slopes along both sides (128: flat), and how deep the pores are.
 * @param {boolean} plain whether it is to go from one size to the next in a step, which is cheaper to draw
 */
export function grainTexture(plain) {
  const height = new Float32Array(SIZE * SIZE);
  const pores = new Float32Array(SIZE * SIZE);
  for (let j = 0; j < SIZE; j++)
    for (let i = 0; i < SIZE; i++) {
      const [u, v] = [i / SIZE, j / SIZE];
      pores[j * SIZE + i] = pore(u, v);
      height[j * SIZE + i] = CELLS.reduce((sum, [cells, high]) => sum + high * bumps(u, v, cells), -0.35 * pores[j * SIZE + i]);
    }
  const data = new Uint8Array(4 * SIZE * SIZE);
  const at = (i, j) => height[((j + SIZE) % SIZE) * SIZE + ((i + SIZE) % SIZE)];
  for (let j = 0; j < SIZE; j++)
    for (let i = 0; i < SIZE; i++) {
      const byte = (slope) => Math.min(255, Math.max(0, Math.round(128 + STEEP * slope)));
      const k = j * SIZE + i;
      data.set([byte(at(i + 1, j) - at(i - 1, j)), byte(at(i, j + 1) - at(i, j - 1)), Math.round(255 * pores[k]), 255], 4 * k);
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
