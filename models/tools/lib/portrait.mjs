// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Draws a head without a graphics processor, for posters and previews of recipes. It matches the client's best quality, so that the change from
 * poster to live picture is invisible.
 */
import { framed } from '../../../web/element/head/framing.mjs';
import { bakeOcclusion } from '../../../web/element/head/shading/occlusion.mjs';
import { lidsAt, lidsOf } from '../../../web/element/head/shading/lids.mjs';
import { lipsOf, wetness, within } from '../../../web/element/head/shading/lips.mjs';
import { mouthLight, openingOf } from '../../../web/element/head/shading/mouth-light.mjs';
import { CLEAR, isAiry, eyeNormals, fibres, kindOf, THIN, volumeNormals } from '../../../web/element/head/shading/surfaces.mjs';
import { pose } from './deform.mjs';
import { openTexture } from './image.mjs';
import { normals } from './mesh.mjs';
import { shadePoint, toLinear } from './shading.mjs';
import { narrow } from './span.mjs';

const SAMPLES = 2; // for each pixel, in both directions
const WHITE = [255, 255, 255, 255]; // of what has no texture
const ALPHA = 3; // the channel
const FADE = 0.08; // as in web/element/head/view.mjs

/**
 * @param {object} head unpacked (deform.mjs)
 * @param {{width: number, height: number, faps?: object, yaw?: number, shadows?: boolean|Float32Array[],
 *   view?: {target: number[], distance: number, fov: number}, crop?: {x: number, y: number, width: number, height: number}}} options
 *   yaw in degrees; shadows: or those of another pose (shadowsOf); crop: only that piece of the picture is drawn
 * @returns {Promise<{data: Uint8ClampedArray, width: number, height: number}>} RGBA
 */
export async function drawHead(head, { faps = {}, yaw = 0, shadows = true, view, crop, ...whole }) {
  const textures = await texturesOf(head);
  const scene = head.parts.map((part) => makePart(head, part, faps, textures));
  if (Array.isArray(shadows)) cast(scene, shadows);
  else if (shadows) cast(scene, bake(scene));
  const { width, height } = crop ?? whole;
  const big = { width: width * SAMPLES, height: height * SAMPLES };
  const camera = cameraOf(view ?? portraitOf(head, whole), yaw, { width: whole.width * SAMPLES, height: whole.height * SAMPLES }, crop ?? { x: 0, y: 0 });
  const depth = new Float32Array(big.width * big.height).fill(Infinity);
  const picture = new Float32Array(big.width * big.height * 4);
  for (const thing of scene) thing.screen = project(thing.position, camera);
  const first = scene.filter((t) => t.alpha === 'opaque'),
    loose = scene.filter((t) => t.alpha !== 'opaque');
  const solid = [...first, ...loose.filter((t) => !THIN.includes(t.name))];
  for (const thing of solid) drawPart(thing, camera, big, depth, null, true); // so that only visible points are shaded
  for (const thing of solid) drawPart(thing, camera, big, depth, picture, true);
  for (const thing of [...loose.filter((t) => !THIN.includes(t.name)), ...loose.filter((t) => THIN.includes(t.name))])
    drawPart(thing, camera, big, depth, picture, false);
  if (!crop && !view && head.view.bottom === undefined) fadeOut(picture, big);
  return { data: smaller(picture, width, height), width, height };
}

/** Computes the light on each vertex in a pose, for use in pictures of other poses. @returns {Promise<Float32Array[]>} by part */
export async function shadowsOf(head, faps) {
  const textures = await texturesOf(head);
  return bake(head.parts.map((part) => makePart(head, part, faps, textures)));
}

/**
 * Projects points of the head (mm) into its neutral portrait.
 * @param {object} head @param {{width: number, height: number}} size @param {number[][]} points
 * @returns {number[][]} column, row, and depth in mm
 */
export function seenAt(head, size, points) {
  const flat = project(Float32Array.from(points.flat()), cameraOf(portraitOf(head, size), 0, size, { x: 0, y: 0 }));
  return points.map((_, i) => [flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]]);
}

const decoded = new WeakMap(); // head -> its textures, cached because sets of pictures reuse them

function texturesOf(head) {
  if (!decoded.has(head)) decoded.set(head, readTextures(head));
  return decoded.get(head);
}

async function readTextures(head) {
  const out = {};
  for (const [name, { data }] of Object.entries(head.textures)) {
    const { data: pixels, info } = await openTexture(data).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
    out[name] = { pixels, width: info.width, height: info.height };
  }
  return out;
}

function makePart(head, part, faps, textures) {
  const kind = kindOf(part.name);
  const look = head.materials[part.material];
  const position = pose(head, part, faps);
  const at = { ...part, position };
  let n = normals(position, part.index, part.smooth);
  const thing = { name: part.name, kind, look, position, index: part.index, uv: part.uv, alpha: look.alpha, texture: textures[look.texture] };
  if (kind === 'hair') {
    thing.fibre = fibres(at);
    if (!THIN.includes(part.name)) n = volumeNormals(at, n);
  }
  if (kind === 'eye') {
    const turn = head.turns.find((t) => t.name === part.turns[0].turn);
    const radius = Math.hypot(...turn.pivot.map((x, k) => part.position[k] - x));
    thing.centre = turn.pivot;
    thing.iris = head.fapu.IRISD / 2 / radius;
    n = eyeNormals(at, turn.pivot, thing.iris);
    thing.gap = lidGaps(head, part, faps, turn.pivot, radius);
  }
  if (kind === 'skin') Object.assign(thing, { rest: part.position, lips: lipsOf(head.fdp) });
  thing.normal = n;
  thing.reach = new Float32Array((position.length / 3) * 4).fill(1);
  if (kind === 'mouth') lightMouth(thing, head, part, faps);
  return thing;
}

/** As the head stands upright. */
const upright = (head, part, faps) => pose(head, part, { ...faps, 48: 0, 49: 0, 50: 0 });

const valuesOf = (faps) => Float32Array.from({ length: 69 }, (_, fap) => faps[fap] ?? 0);

/** For each vertex of an eyeball mm below the upper lid's margin, and above the lower one's. */
function lidGaps(head, part, faps, pivot, radius) {
  const numbered = ({ turns, ...skin }) => ({ ...skin, turns: turns.map((one) => ({ ...one, turn: head.turns.findIndex(({ name }) => name === one.turn) })) });
  const skin = head.parts.filter(({ name }) => name === 'skin').map(numbered);
  const { upper, lower } = lidsAt(lidsOf({ parts: skin, turns: head.turns, fdp: head.fdp }, pivot, radius), valuesOf(faps));
  const line = (factors, x) => factors.reduceRight((sum, factor) => sum * x + factor, 0);
  const position = upright(head, part, faps);
  const out = new Float32Array((position.length / 3) * 2);
  for (let v = 0; v < out.length / 2; v++) {
    const [x, y, z] = pivot.map((value, k) => position[v * 3 + k] - value);
    const [angle, far] = [Math.atan2(y, z), Math.hypot(y, z)];
    out.set([(line(upper, x) - angle) * far, (angle - line(lower, x)) * far], v * 2);
  }
  return out;
}

function lightMouth({ reach }, head, part, faps) {
  const position = upright(head, part, faps);
  const opening = openingOf(head, valuesOf(faps));
  for (let v = 0; v < position.length / 3; v++)
    reach.set(mouthLight(head, opening, [0, 1, 2].map((k) => position[v * 3 + k])), v * 4);
}

function bake(scene) {
  const run = bakeOcclusion(
    scene.map(({ name, position, index, normal, uv, alpha, texture }) => ({
      position: Float32Array.from(position),
      index: Uint16Array.from(index),
      uv,
      opaque: texture && (alpha === 'cutout' || alpha === 'blend') ? opaqueIn(texture) : null,
      shades: !CLEAR.includes(name),
      airy: isAiry(name),
      seen: { position: Float32Array.from(position), normal: Float32Array.from(normal) },
    })),
  );
  let result = run.next();
  while (!result.done) result = run.next();
  return result.value.map((reach) => Float32Array.from(reach, (x) => x / 255));
}

const opaqueIn = ({ pixels, width, height }) => (u, v) => {
  const [x, y] = [[u, width], [1 - v, height]].map(([share, size]) => Math.min(size - 1, Math.max(0, Math.floor(share * size))));
  return pixels[4 * (y * width + x) + 3] >= 128;
};

/** The mouth has its own light. */
function cast(scene, shadows) {
  shadows.forEach((reach, i) => {
    if (scene[i].kind !== 'mouth') scene[i].reach = reach;
  });
}

function cameraOf({ target, distance, fov }, yaw, { width, height }, { x, y }) {
  const turn = (yaw * Math.PI) / 180;
  const focal = height / 2 / Math.tan((fov * Math.PI) / 360);
  return {
    focal, target, cos: Math.cos(turn), sin: Math.sin(turn), far: distance,
    middle: [width / 2 - x * SAMPLES, height / 2 - y * SAMPLES],
    eye: [target[0] - Math.sin(turn) * distance, target[1], target[2] + Math.cos(turn) * distance],
  };
}

/** The camera of the element's default view. */
const portraitOf = (head, { width, height }) => framed(head, null, width / height);

/** Column, row, depth for each vertex. */
function project(position, { focal, target, cos, sin, far, middle }) {
  const out = new Float32Array(position.length);
  for (let i = 0; i < position.length; i += 3) {
    const x = position[i] - target[0],
      z = position[i + 2] - target[2];
    const depth = far - (z * cos - x * sin);
    out[i] = middle[0] + ((x * cos + z * sin) * focal) / depth;
    out[i + 1] = middle[1] - ((position[i + 1] - target[1]) * focal) / depth;
    out[i + 2] = depth;
  }
  return out;
}

/** Reads a texture's channels at a place, from the channel `from` on, as 0..255. @returns {number[]} out */
function sample({ pixels, width, height }, u, v, out, from = 0) {
  const x = Math.min(width - 1.001, Math.max(0, u * width - 0.5)),
    y = Math.min(height - 1.001, Math.max(0, (1 - v) * height - 0.5));
  const i = Math.floor(x),
    j = Math.floor(y),
    fx = x - i,
    fy = y - j;
  const at = (j * width + i) * 4,
    below = at + width * 4;
  for (let k = from; k < 4; k++)
    out[k] = (pixels[at + k] * (1 - fx) + pixels[at + 4 + k] * fx) * (1 - fy) + (pixels[below + k] * (1 - fx) + pixels[below + 4 + k] * fx) * fy;
  return out;
}

/** `solid`: draws opaque parts with depth; otherwise blends translucent parts over them. Without a picture draws only the depth. */
function drawPart(thing, camera, { width, height }, depth, picture, solid) {
  const { screen: s, index, look, texture, uv } = thing;
  const opaque = thing.alpha === 'opaque';
  const point = makePoint(thing);
  const texel = [...WHITE];
  const row = { from: 0, to: 0 };
  const slack = solid ? 0 : 0.01;
  for (let t = 0; t < index.length; t += 3) {
    const a = index[t], b = index[t + 1], c = index[t + 2];
    const ax = s[a * 3], ay = s[a * 3 + 1], az = s[a * 3 + 2];
    const bx = s[b * 3], by = s[b * 3 + 1], bz = s[b * 3 + 2];
    const cx = s[c * 3], cy = s[c * 3 + 1], cz = s[c * 3 + 2];
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (!area || (area > 0 && !look.double_sided)) continue;
    const x0 = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5)),
      x1 = Math.min(width - 1, Math.floor(Math.max(ax, bx, cx) - 0.5));
    const y0 = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5)),
      y1 = Math.min(height - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
    const stepB = (cy - ay) / area,
      stepC = (ay - by) / area;
    for (let y = y0; y <= y1; y++) {
      row.from = x0;
      row.to = x1;
      const right = ((x0 + 0.5 - ax) * (cy - ay) - (y + 0.5 - ay) * (cx - ax)) / area,
        top = ((bx - ax) * (y + 0.5 - ay) - (by - ay) * (x0 + 0.5 - ax)) / area;
      narrow(row, 1 - right - top, -stepB - stepC, right, stepB, top, stepC);
      for (let x = row.from; x <= row.to; x++) {
        const wb = ((x + 0.5 - ax) * (cy - ay) - (y + 0.5 - ay) * (cx - ax)) / area;
        if (wb < 0) continue;
        const wc = ((bx - ax) * (y + 0.5 - ay) - (by - ay) * (x + 0.5 - ax)) / area;
        const wa = 1 - wb - wc;
        if (wa < 0 || wc < 0) continue;
        const z = Math.fround(wa * az + wb * bz + wc * cz); // as `depth` keeps it
        const i = y * width + x;
        if (z > depth[i] + slack) continue;
        if (opaque && !picture) {
          depth[i] = z;
          continue;
        }
        if (texture) {
          const u = wa * uv[a * 2] + wb * uv[b * 2] + wc * uv[c * 2],
            v = wa * uv[a * 2 + 1] + wb * uv[b * 2 + 1] + wc * uv[c * 2 + 1];
          sample(texture, u, v, texel, picture ? 0 : ALPHA);
        }
        const alpha = opaque ? 1 : texel[ALPHA] / 255;
        if (solid ? alpha < 0.5 : alpha < 0.02) continue;
        if (solid) depth[i] = z;
        if (picture) put(picture, i * 4, shade(thing, camera, point, a, b, c, wa, wb, wc, texel, area > 0), solid ? 1 : alpha);
      }
    }
  }
}

/** Three numbers of a list, between the corners of a triangle. */
function three(list, a, b, c, wa, wb, wc, out) {
  for (let k = 0; k < 3; k++) out[k] = wa * list[a * 3 + k] + wb * list[b * 3 + k] + wc * list[c * 3 + k];
  return out;
}

function unit(q) {
  const l = Math.hypot(q[0], q[1], q[2]) || 1;
  for (let k = 0; k < 3; k++) q[k] /= l;
  return q;
}

/** What shadePoint takes, and the point's place: filled in for each point of a part in turn. */
function makePoint({ fibre, lips, centre, iris, gap }) {
  return {
    base: [0, 0, 0], n: [0, 0, 0], v: [0, 0, 0], at: [0, 0, 0], reach: [0, 0, 0, 0], iris,
    fibre: fibre && [0, 0, 0], lips: lips && { share: 0, wet: 0 }, place: centre && [0, 0, 0], gap: gap && [0, 0],
  };
}

function shade(thing, { eye }, point, a, b, c, wa, wb, wc, texel, back) {
  const { base, n, v, at, reach, fibre, lips, place, gap } = point;
  for (let k = 0; k < 3; k++) base[k] = toLinear(texel[k]);
  unit(three(thing.normal, a, b, c, wa, wb, wc, n));
  if (back && thing.kind !== 'hair') for (let k = 0; k < 3; k++) n[k] = -n[k];
  three(thing.position, a, b, c, wa, wb, wc, at);
  for (let k = 0; k < 3; k++) v[k] = eye[k] - at[k];
  unit(v);
  for (let k = 0; k < 4; k++) reach[k] = wa * thing.reach[a * 4 + k] + wb * thing.reach[b * 4 + k] + wc * thing.reach[c * 4 + k];
  if (fibre) unit(three(thing.fibre, a, b, c, wa, wb, wc, fibre));
  if (place) {
    for (let k = 0; k < 3; k++) place[k] = at[k] - thing.centre[k];
    unit(place);
  }
  if (gap) for (let k = 0; k < 2; k++) gap[k] = wa * thing.gap[a * 2 + k] + wb * thing.gap[b * 2 + k] + wc * thing.gap[c * 2 + k];
  if (lips) {
    // Whether a point of the skin is lip, and how wet it is, is told by its place at rest.
    three(thing.rest, a, b, c, wa, wb, wc, at);
    lips.share = within(thing.lips, at);
    lips.wet = lips.share && wetness(thing.lips, at);
  }
  return shadePoint(thing.kind, thing.look, point);
}

function put(picture, at, colour, alpha) {
  for (let k = 0; k < 3; k++) picture[at + k] = colour[k] * alpha + picture[at + k] * (1 - alpha);
  picture[at + 3] = alpha + picture[at + 3] * (1 - alpha);
}

/** The shoulders vanish towards the lower border. */
function fadeOut(picture, { width, height }) {
  const rows = Math.round(height * FADE);
  for (let y = height - rows; y < height; y++) {
    const t = (height - y - 0.5) / rows;
    for (let i = y * width * 4; i < (y + 1) * width * 4; i++) picture[i] *= t * t * (3 - 2 * t);
  }
}

function smaller(picture, width, height) {
  const out = new Uint8ClampedArray(width * height * 4);
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) {
      const sum = [0, 0, 0, 0];
      for (let j = 0; j < SAMPLES; j++)
        for (let i = 0; i < SAMPLES; i++) {
          const at = ((y * SAMPLES + j) * width * SAMPLES + x * SAMPLES + i) * 4;
          for (let k = 0; k < 4; k++) sum[k] += picture[at + k];
        }
      const at = (y * width + x) * 4;
      for (let k = 0; k < 3; k++) out[at + k] = (255 * sum[k]) / (sum[3] || 1);
      out[at + 3] = (255 * sum[3]) / SAMPLES / SAMPLES;
    }
  return out;
}
