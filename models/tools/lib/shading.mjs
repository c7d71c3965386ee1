// SPDX-License-Identifier: GPL-3.0-or-later
/** Colours a point as the client's fine shader does (web/element/head/shading/shader-surface.mjs), for pictures drawn without it. */
import { FILL, GROUND, KEY, RIM, SKY } from '../../../web/element/head/shading/lights.mjs';

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

function wrapped(kind, subsurface, cosine, k) {
  const wrap = kind === 'skin' ? subsurface * [1, 0.5, 0.35][k] : subsurface * 0.6;
  const light = Math.max(0, (cosine + wrap) / (1 + wrap));
  return (light * light) / (0.6 + 0.4 * light);
}

/** Light that falls on a point, of each colour. */
export function diffuse(kind, subsurface, n, reach) {
  const fleshy = kind === 'skin' || kind === 'mouth';
  const up = 0.5 + 0.5 * n[1];
  const [key, fill, rim] = [KEY, FILL, RIM].map(({ direction }) => dot(n, direction));
  return [0, 1, 2].map((k) => {
    const ambient = fleshy ? reach[0] ** [0.8, 1, 1.05][k] : Math.max(reach[0], kind === 'eye' ? 0.12 : 0.3);
    const keyed = fleshy ? reach[1] ** [0.75, 1, 1.05][k] : reach[1];
    return (
      (GROUND[k] + (SKY[k] - GROUND[k]) * up) * ambient +
      KEY.color[k] * wrapped(kind, subsurface, key, k) * keyed +
      FILL.color[k] * wrapped(kind, subsurface, fill, k) * reach[2] +
      RIM.color[k] * wrapped(kind, subsurface, rim, k) * reach[3]
    );
  });
}

function highlight(n, v, l, rough) {
  const h = unit([l[0] + v[0], l[1] + v[1], l[2] + v[2]]);
  const nl = Math.max(dot(n, l), 0),
    nh = Math.max(dot(n, h), 0),
    lh = Math.max(dot(l, h), 0.1);
  const a2 = rough ** 4;
  const d = nh * nh * (a2 - 1) + 1;
  return (nl * a2) / (d * d * lh * lh * (rough * 4 + 2));
}

function shine(kind, look, n, v, base, reach, fibre) {
  const specular = look.specular ?? 0.3;
  if (kind === 'hair') {
    const f = unit(fibre.map((x, k) => x + 0.25 * n[k]));
    const th = dot(f, unit(KEY.direction.map((x, k) => x + v[k])));
    const tk = dot(f, unit(RIM.direction.map((x, k) => x + v[k])));
    const across = Math.max(0, 1 - th * th);
    const facing = Math.max(0, 0.25 + dot(n, KEY.direction)) * reach[1];
    const edge = Math.max(0, 1 - tk * tk) ** 20 * Math.max(0, dot(n, RIM.direction)) * reach[3];
    return [0, 1, 2].map(
      (k) =>
        (KEY.color[k] * (across ** 80 * 0.02 + across ** 14 * base[k] * 0.7) * facing + RIM.color[k] * edge * base[k]) *
        specular *
        2.5,
    );
  }
  const rim = (1 - Math.max(dot(n, v), 0)) ** 5;
  let rough = look.roughness ?? 0.6;
  if (kind === 'skin') rough += (0.34 - rough) * step(...(look.moist ?? [0.58, 0.72]), (base[0] - base[1]) / (base[0] + 1e-3));
  const key = 0.75 * highlight(n, v, KEY.direction, rough) + 0.25 * highlight(n, v, KEY.direction, rough * 0.75);
  const fill = highlight(n, v, FILL.direction, rough),
    back = highlight(n, v, RIM.direction, rough);
  const up = 0.5 + 0.5 * (2 * dot(n, v) * n[1] - v[1]);
  const bare = kind === 'skin' ? step(0.004, 0.02, 0.3 * base[0] + 0.6 * base[1] + 0.1 * base[2]) : 1; // roots of hair are painted on skin, and do not shine
  return [0, 1, 2].map(
    (k) =>
      (KEY.color[k] * key * (0.028 + rim * 0.4) * reach[1] +
        FILL.color[k] * fill * (0.028 + rim * 0.4) * reach[2] +
        RIM.color[k] * back * (0.028 + rim * 0.3) * reach[3] +
        (GROUND[k] + (SKY[k] - GROUND[k]) * up) * (0.028 + rim * 0.25) * reach[0] * reach[0] * 0.6) *
      specular *
      2.6 *
      bare,
  );
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
  const d = 2 * dot(n, v);
  const mirror = n.map((x, k) => d * x - v[k]);
  const near = (light, shift, a, b) => step(a, b, dot(mirror, unit(light.direction.map((x, k) => x + shift[k]))));
  const key = near(KEY, [0, 0.05, 0.3], 0.955, 0.975),
    fill = near(FILL, [-0.1, -0.2, 0.3], 0.97, 0.985);
  return [1.6, 1.6, 1.6].map(
    (x, k) => (key * x + fill * 0.12) * reach + (GROUND[k] + (SKY[k] - GROUND[k]) * (0.5 + 0.5 * mirror[1])) * 0.04 * reach,
  );
}

/** The shadow of the upper lid and its lashes, and the red reflected by the lower lid. @param {number[]} gap mm below the upper margin, above the lower one */
function lidShade([below, above]) {
  const [under, over] = [step(-0.6, 3.2, below), step(-0.2, 1.4, above)];
  return [0, 1, 2].map((k) => mixed([0.42, 0.36, 0.36][k], under) * mixed([0.86, 0.72, 0.68][k], over));
}

const mixed = (least, share) => least + (1 - least) * share;

/** The tear film on the edge of the lower lid. */
function wetEdge(n, above, reach) {
  const film = 0.16 * Math.max(0, 1 - ((above - 0.3) / 0.22) ** 2);
  return [0, 1, 2].map((k) => film * (SKY[k] + KEY.color[k] * reach[1] * Math.max(0, dot(n, KEY.direction))));
}

/** Returns the visible colour of an eye: its own colour in this light, with the lids' shadow and wetness. */
function eyeColour(b, light, n, v, reach, gap) {
  const shade = lidShade(gap),
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

/**
 * @param {string} kind skin, hair, eye, mouth or other @param {object} look the material
 * @param {{base: number[], n: number[], v: number[], reach: number[], fibre?: number[], place?: number[], iris?: number, gap?: number[]}} at for
 *   an eye: `place` on the unit sphere, `iris` radius of the iris, `gap` mm to the margins of the upper and lower lid @returns {number[]} the
 *   colour on the display, 0..1
 */
export function shadePoint(kind, look, { base, n, v, reach, fibre, place, iris, gap }) {
  let b = kind === 'eye' ? eyeGlow(base, place, iris) : base;
  b = b.map((x, k) => x * (look.color?.[k] ?? 1));
  const light = diffuse(kind, look.subsurface ?? 0, n, reach);
  const colour = () => {
    const more = shine(kind, look, n, v, b, reach, fibre);
    return b.map((x, k) => x * light[k] + more[k]);
  };
  return filmic(kind === 'eye' ? eyeColour(b, light, n, v, reach, gap) : colour()).map((x) => toDisplay(clamp(x)));
}
