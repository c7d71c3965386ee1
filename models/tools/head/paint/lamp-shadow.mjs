// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Paints the shadows of nose, lips, chin, brows, hair, collar and glasses on the skin at rest. Clients compute light per vertex, which is too
 * coarse for these shadows; this computes them per texel, and paints what the client will miss.
 */
import { bakeOcclusion, throughHair } from '../../../../web/element/head/shading/occlusion.mjs';
import { KEY } from '../../../../web/element/head/shading/lights.mjs';
import { CLEAR, isAiry } from '../../../../web/element/head/shading/surfaces.mjs';
import { dilate, eachTexel } from './bake.mjs';
import { DepthMap } from './depth.mjs';
import { normals } from '../../lib/mesh.mjs';
import { diffuse } from '../../lib/shading.mjs';

const PLACE = { resolution: 1024, reach: 175, centre: [0, -35, 30] }; // head and neck
const RAYS = 20;
const LAMP_RADIUS = 0.16; // radians; the client's lamp is wider, so its shadows are softer still
const LIFT = 0.8; // mm along the normal,
const SLACK = 0.5; // and along the ray: surfaces do not shade themselves
const SOFT = [0.75, 1, 1.05]; // red goes on into the shadow, as in the client's diffuseLight
const LEAST = 0.05; // of light: darker areas stay as painted
const INSIDE = /^(eye|teeth|tongue|mouth|lashes|brows)/;

/** Directions to the lamp, spread over its disc. */
function rays() {
  const [x, y, z] = KEY.direction;
  const l = Math.hypot(x, z);
  const right = [z / l, 0, -x / l],
    top = [(-x * y) / l, l, (-z * y) / l];
  return Array.from({ length: RAYS }, (_, i) => {
    const r = LAMP_RADIUS * Math.sqrt((i + 0.5) / RAYS),
      turn = i * Math.PI * (3 - Math.sqrt(5));
    const d = KEY.direction.map((v, k) => v + r * (Math.cos(turn) * right[k] + Math.sin(turn) * top[k]));
    return d.map((v) => v / Math.hypot(...d));
  });
}

/**
 * @param {{part: object, opaque?: (u: number, v: number) => boolean}[]} casters
 * @returns {(x: number, y: number, z: number) => number} share of the lamp that reaches a place a little above the surface
 */
function lampReach(casters) {
  const mapOf = (dir, some) => {
    const map = new DepthMap(dir, PLACE);
    for (const { part, opaque } of some) map.draw(part, opaque);
    return map;
  };
  const maps = rays().map((dir) => ({
    solid: mapOf(dir, casters.filter(({ part }) => !isAiry(part.name))),
    airy: mapOf(dir, casters.filter(({ part }) => isAiry(part.name))),
  }));
  return (x, y, z) => {
    let sum = 0;
    for (const { solid, airy } of maps) sum += solid.reaches(x, y, z, SLACK) * airy.reaches(x, y, z, SLACK, throughHair);
    return sum / RAYS;
  };
}

/** Light that the client will compute for each vertex of the skin: open sky, key, fill, rim, 0..1. */
function clientReach(parts, skin, seen, seenNormals, opaqueOf) {
  const run = bakeOcclusion(
    parts.map((part) => {
      const own = part === skin;
      const position = Float32Array.from(part.position);
      const normal = own ? seenNormals : normals(part.position, part.index, part.smooth);
      return {
        position, index: Uint16Array.from(part.index), shades: !CLEAR.includes(part.name), airy: isAiry(part.name),
        uv: part.uv, opaque: opaqueOf(part),
        seen: { position: own ? Float32Array.from(seen) : position, normal: Float32Array.from(normal) },
      };
    }),
  );
  let result = run.next();
  while (!result.done) result = run.next();
  return result.value[parts.indexOf(skin)];
}

/**
 * @param {object[]} parts the first is the skin @param {Float64Array} seen positions of its vertices with closed lids, which are used for
 *   lighting @param {Float64Array} seenNormals @param {(part: object) => ((u: number, v: number) => boolean)|undefined} opaqueOf
 * @param {object} material of the skin @param {number} size of the picture
 * @returns {Float32Array} size x size x 3: factors for the linear colour
 */
export function paintedShadow(parts, seen, seenNormals, opaqueOf, { subsurface }, size) {
  const [skin] = parts;
  const reaches = lampReach(parts.filter(({ name }) => !INSIDE.test(name)).map((part) => ({ part, opaque: opaqueOf(part) })));
  const client = clientReach(parts, skin, seen, seenNormals, opaqueOf);
  // Light on each vertex without the lamp, and from the unoccluded lamp.
  const other = new Float32Array(seen.length),
    lamp = new Float32Array(seen.length);
  for (let v = 0; v < seen.length; v += 3) {
    const n = seenNormals.subarray(v, v + 3);
    const [sky, , fill, rim] = client.subarray((v / 3) * 4, (v / 3) * 4 + 4);
    other.set(diffuse('skin', subsurface, n, [sky / 255, 0, fill / 255, rim / 255]), v);
    lamp.set(diffuse('skin', subsurface, n, [0, 1, 0, 0]), v);
  }
  const out = new Float32Array(size * size * 3).fill(1);
  const done = eachTexel(skin, size, (texel, a, b, c, wa, wb, wc) => {
    const at = (list, stride, k) => wa * list[a * stride + k] + wb * list[b * stride + k] + wc * list[c * stride + k];
    if (at(lamp, 3, 0) < 0.02) return;
    const known = Math.max(0, at(client, 4, 1) / 255); // beside a triangle, where the picture begins, it goes on below nothing
    const above = (k) => at(seen, 3, k) + LIFT * at(seenNormals, 3, k);
    const key = reaches(above(0), above(1), above(2));
    for (let k = 0; k < 3; k++) {
      const rest = Math.max(0, at(other, 3, k)),
        light = Math.max(0, at(lamp, 3, k));
      out[texel * 3 + k] = (LEAST + rest + light * key ** SOFT[k]) / (LEAST + rest + light * known ** SOFT[k]);
    }
  });
  dilate(out, done, size, 4);
  return out;
}
