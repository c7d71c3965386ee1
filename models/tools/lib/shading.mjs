// SPDX-License-Identifier: GPL-3.0-or-later
/** Colours a point as the client's fine shader does (web/element/head/shading/shader-surface.mjs), for pictures drawn without it. */
import { mirroredRoom, room } from '../../../web/element/head/shading/environment.mjs';
import { FILL, KEY, RIM, WINDOW } from '../../../web/element/head/shading/lights.mjs';
import { LIP, MOIST } from '../../../web/element/head/shading/lips.mjs';
import { GLOSS } from '../../../web/element/head/shading/surfaces.mjs';

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const clamp = (x) => Math.min(1, Math.max(0, x));
const step = (a, b, x) => {
  const t = clamp((x - a) / (b - a));
  return t * t * (3 - 2 * t);
};
const unit = (v) => {
  const l = Math.hypot(v[0], v[1], v[2]) || 1;
  return [v[0] / l, v[1] / l, v[2] / l];
};
const LINEAR = Float32Array.from({ length: 256 }, (_, i) => {
  const c = i / 255;
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
});
export const toLinear = (byte) => LINEAR[Math.round(Math.min(255, Math.max(0, byte)))];
export const toDisplay = (c) => (c <= 0.0031308 ? c * 12.92 : 1.055 * c ** (1 / 2.4) - 0.055);

const WRAP = [1, 0.5, 0.35]; // of the skin's subsurface, by colour
const SKY_SOFT = [0.8, 1, 1.05]; // red goes on into the shadow
const KEY_SOFT = [0.75, 1, 1.05];

function wrapped(kind, subsurface, cosine, k) {
  const wrap = kind === 'skin' ? subsurface * WRAP[k] : subsurface * 0.6;
  const light = Math.max(0, (cosine + wrap) / (1 + wrap));
  return (light * light) / (0.6 + 0.4 * light);
}

/** Light that falls on a point, of each colour. */
export function diffuse(kind, subsurface, n, reach) {
  const fleshy = kind === 'skin' || kind === 'mouth';
  const around = room(n);
  const key = dot(n, KEY.direction),
    fill = dot(n, FILL.direction),
    rim = dot(n, RIM.direction);
  for (let k = 0; k < 3; k++) {
    const ambient = fleshy ? reach[0] ** SKY_SOFT[k] : Math.max(reach[0], kind === 'eye' ? 0.12 : 0.3);
    const keyed = fleshy ? reach[1] ** KEY_SOFT[k] : reach[1];
    around[k] =
      around[k] * ambient +
      KEY.color[k] * wrapped(kind, subsurface, key, k) * keyed +
      FILL.color[k] * wrapped(kind, subsurface, fill, k) * reach[2] +
      RIM.color[k] * wrapped(kind, subsurface, rim, k) * reach[3];
  }
  return around;
}

function highlight(n, v, l, rough) {
  let hx = l[0] + v[0], hy = l[1] + v[1], hz = l[2] + v[2];
  const far = Math.hypot(hx, hy, hz) || 1;
  hx /= far;
  hy /= far;
  hz /= far;
  const nl = Math.max(dot(n, l), 0),
    nh = Math.max(n[0] * hx + n[1] * hy + n[2] * hz, 0),
    lh = l[0] * hx + l[1] * hy + l[2] * hz;
  const a2 = rough ** 4;
  const d = nh * nh * (a2 - 1) + 1;
  return (nl * a2) / (d * d * Math.max(lh * lh, 0.1) * (rough * 4 + 2)); // bounded, or what a lamp behind grazes would be white
}

function shineOfHair(look, n, v, base, reach, fibre) {
  const specular = look.specular ?? 0.3;
  const f = unit([fibre[0] + 0.25 * n[0], fibre[1] + 0.25 * n[1], fibre[2] + 0.25 * n[2]]);
  const half = ({ direction: l }) => unit([l[0] + v[0], l[1] + v[1], l[2] + v[2]]);
  const th = dot(f, half(KEY));
  const tk = dot(f, half(RIM));
  const across = Math.max(0, 1 - th * th);
  const white = across ** 80 * 0.02,
    tinted = across ** 14;
  const facing = Math.max(0, 0.25 + dot(n, KEY.direction)) * reach[1];
  const edge = Math.max(0, 1 - tk * tk) ** 20 * Math.max(0, dot(n, RIM.direction)) * reach[3];
  for (let k = 0; k < 3; k++) f[k] = (KEY.color[k] * (white + tinted * base[k] * 0.7) * facing + RIM.color[k] * edge * base[k]) * specular * 2.5;
  return f;
}

const DARK = [0, 0, 0];

function shine(kind, look, n, v, base, reach, { fibre, lips }) {
  if (kind === 'hair') return shineOfHair(look, n, v, base, reach, fibre);
  const specular = look.specular ?? 0.3;
  const [from, to] = look.moist ?? MOIST;
  const lip = kind === 'skin' ? lips.share && lips.share * step(from, to, (base[0] - base[1]) / (base[0] + 1e-3)) : 0;
  const rough = (look.roughness ?? 0.6) * (1 - lip) + LIP.rough * lip;
  const wet = LIP.gloss * GLOSS.f0 * lip * lips.wet;
  const wetKey = wet ? highlight(n, v, KEY.direction, LIP.wet) : 0;
  const wetRoom = wet ? mirroredRoom(mirrored(n, v), LIP.wet) : DARK;
  const bare = kind === 'skin' ? step(0.004, 0.02, 0.3 * base[0] + 0.6 * base[1] + 0.1 * base[2]) : 1; // roots of hair are painted on skin, and do not shine
  const out = gloss(n, v, reach, rough);
  for (let k = 0; k < 3; k++) {
    const film = wet * (KEY.color[k] * wetKey * reach[1] + wetRoom[k] * reach[0]);
    out[k] = (out[k] * specular * GLOSS.strength * (1 - LIP.dull * lip) + film) * bare;
  }
  return out;
}

/** The light of the lamps and the room that a rough surface throws back. */
function gloss(n, v, reach, rough) {
  const rim = (1 - Math.max(dot(n, v), 0)) ** 5;
  const { f0, narrow, oily } = GLOSS;
  const key = (1 - narrow) * highlight(n, v, KEY.direction, rough) + narrow * highlight(n, v, KEY.direction, rough * oily);
  const fill = highlight(n, v, FILL.direction, rough),
    back = highlight(n, v, RIM.direction, rough);
  const around = mirroredRoom(mirrored(n, v), rough);
  for (let k = 0; k < 3; k++)
    around[k] =
      KEY.color[k] * key * (f0 + rim * 0.4) * reach[1] +
      FILL.color[k] * fill * (f0 + rim * 0.4) * reach[2] +
      RIM.color[k] * back * (f0 + rim * 0.1) * reach[3] +
      around[k] * (f0 + rim * 0.25) * reach[0] * reach[0] * 0.6;
  return around;
}

function mirrored(n, v) {
  const twice = 2 * dot(n, v);
  return [twice * n[0] - v[0], twice * n[1] - v[1], twice * n[2] - v[2]];
}

function eyeGlow(color, place, irisRadius) {
  const distance = Math.hypot(place[0], place[1]) / irisRadius;
  const l = Math.hypot(KEY.direction[0], KEY.direction[1]);
  const against = -(place[0] * KEY.direction[0] + place[1] * KEY.direction[1]) / l / irisRadius;
  const glow = (1 - step(0.85, 1, distance)) * step(0.25, 0.7, distance) * Math.max(0, against);
  const border = step(0.72, 0.95, distance) * (1 - step(0.95, 1.18, distance));
  return color.map((c) => c * (1 + 1.3 * glow) * (1 - 0.45 * border));
}

function catchLight(n, v, reach) {
  const mirror = mirrored(n, v);
  const [x, y] = [WINDOW.right, WINDOW.up].map((way) => Math.abs(dot(mirror, way)) / Math.max(dot(mirror, WINDOW.direction), 0.1));
  const key = (1 - step(0.17, 0.26, x)) * (1 - step(0.23, 0.33, y));
  const fill = step(0.95, 0.99, dot(mirror, unit(FILL.direction.map((value, k) => value + [-0.1, -0.2, 0.3][k]))));
  const wet = 0.04 + 0.3 * (1 - Math.max(dot(n, v), 0)) ** 5;
  return mirroredRoom(mirror, 0.1).map((around) => (key * 1.6 + fill * 0.06 + around * wet) * reach);
}

/** The shadow of the upper lid and its lashes, and the red reflected by the lower lid. @param {number[]} gap mm below the upper margin, above the lower one */
function lidShade([below, above]) {
  const [under, over] = [step(-0.6, 3.6, below), step(-0.2, 1.4, above)];
  return [0, 1, 2].map((k) => mixed([0.34, 0.28, 0.28][k], under) * mixed([0.86, 0.72, 0.68][k], over));
}

const mixed = (least, share) => least + (1 - least) * share;

const UPWARD = room([0, 1, 0]);

/** The tear film on the edge of the lower lid. */
function wetEdge(n, above, reach) {
  const film = 0.16 * Math.max(0, 1 - ((above - 0.3) / 0.22) ** 2);
  return [0, 1, 2].map((k) => film * (UPWARD[k] + KEY.color[k] * reach[1] * Math.max(0, dot(n, KEY.direction))));
}

/** Returns the visible colour of an eye: its own colour in this light, with the lids' shadow and wetness. */
function eyeColour(b, light, n, v, reach, gap, ahead) {
  const socket = step(0.3, 0.85, ahead); // the ball goes back into its shade
  const shade = lidShade(gap).map((x, k) => x * mixed([0.7, 0.64, 0.62][k], socket)),
    wet = wetEdge(n, gap[1], reach);
  const bright = catchLight(n, v, Math.min(1, 0.15 + reach[0] * 1.6));
  return b.map((x, k) => x * light[k] * shade[k] + bright[k] * step(-0.4, 1.2, gap[0]) + wet[k]);
}

function filmic(c) {
  const peak = Math.max(c[0], c[1], c[2]);
  if (peak <= 0.7) return c;
  const pressed = 1 - 0.09 / (peak + 0.3 - 0.7);
  const white = 1 - 1 / (0.2 * (peak - pressed) + 1);
  return c.map((x) => (x * pressed) / peak + (pressed - (x * pressed) / peak) * white);
}

const NO_LIPS = { share: 0, wet: 0 };

/**
 * @param {string} kind skin, hair, eye, mouth or other @param {object} look the material
 * @param {{base: number[], n: number[], v: number[], reach: number[], fibre?: number[], place?: number[], iris?: number, gap?: number[],
 *   lips?: {share: number, wet: number}}} at for
 *   an eye: `place` on the unit sphere, `iris` radius of the iris, `gap` mm to the margins of the upper and lower lid @returns {number[]} the
 *   colour on the display, 0..1
 */
export function shadePoint(kind, look, { base, n, v, reach, fibre, place, iris, gap, lips = NO_LIPS }) {
  const b = kind === 'eye' ? eyeGlow(base, place, iris) : [base[0], base[1], base[2]];
  for (let k = 0; k < 3; k++) b[k] *= look.color?.[k] ?? 1;
  const light = diffuse(kind, look.subsurface ?? 0, n, reach);
  let colour;
  if (kind === 'eye') colour = eyeColour(b, light, n, v, reach, gap, place[2]);
  else {
    colour = shine(kind, look, n, v, b, reach, { fibre, lips });
    for (let k = 0; k < 3; k++) colour[k] = b[k] * light[k] + colour[k];
  }
  colour = filmic(colour);
  for (let k = 0; k < 3; k++) colour[k] = toDisplay(clamp(colour[k]));
  return colour;
}
