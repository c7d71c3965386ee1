// SPDX-License-Identifier: MIT
// The light inside of the mouth: what comes in between the lips, less with the distance behind them and in their own shadow.

/** The lips as they stand, in mm: height of the opening's upper and lower border, half of its width, how far it is forward. */
export const mouthUniforms = (model) => ({
  opening: { value: [0, 0, 1, 0] },
  lipFront: { value: model.fdp['2.2']?.[2] ?? 0 },
  lipBack: { value: Math.max(0, (model.fdp['2.2']?.[2] ?? 0) - (model.fdp['2.4']?.[2] ?? 0)) },
  lipLine: { value: ((model.fdp['2.2']?.[1] ?? 0) + (model.fdp['2.3']?.[1] ?? 0)) / 2 },
});

/** mm by which the opening of round lips is lower than their FAPs say. */
const ROLLED = 2.5;
/** Share of the light that reaches what lies behind the corners. */
const CORNER = 0.35;
/** mm by which they are longer than they are pushed. */
const TUBE = 5;

/** The lips of a model as `opening` has them. @param {Float32Array} values by FAP number */
export function openingOf({ fapu, fdp }, values) {
  const mns = fapu.MNS / 1024;
  const up = -mns * Math.min(values[4], (values[8] + values[9]) / 2);
  const low = -mns * Math.min(values[5], (values[10] + values[11]) / 2);
  const sides = -(mns * (values[8] + values[9] + values[10] + values[11])) / 2;
  // A round hole is narrower than the distance between the corners, for the lips touch at their sides, and they roll into it.
  const open = Math.min(1, Math.max(0, sides / (0.6 * Math.max(0.1, up + low))));
  const down = low - ROLLED * (1 - open) * Math.max(0, Math.min(1, low));
  const width = (0.3 + 0.7 * open) * ((fdp['2.4']?.[0] ?? fapu.MW * 0.43) + ((values[6] + values[7]) / 2) * (fapu.MW / 1024));
  // and they are a tube before the teeth
  const forward = mns * Math.max(0, (values[16] + values[17]) / 2) + TUBE * (1 - open) * Math.max(0, Math.min(1, low));
  return [up, down, width, forward];
}

/**
 * Computes mouthLightGlsl on the CPU, for pictures that are drawn without a shader.
 * @param {object} model @param {number[]} opening from openingOf @param {number[]} place of the upright head
 * @returns {number[]} the share of the light that reaches it: ambient, key, fill, rim
 */
export function mouthLight(model, [up, down, width, forward], [x, y, z]) {
  const { lipFront, lipBack, lipLine } = mouthUniforms(model);
  const part = 1 - Math.min(1, Math.abs(x / width)) ** 2;
  const gap = Math.max(0, up + down);
  const depth = Math.max(1, lipFront.value + forward * part - lipBack.value * (1 - part) - z);
  const window = 1.4 * gap * width;
  const reach = window / (window + 1.6 * depth * depth);
  const under = lipLine.value + part * up - y;
  const above = y - lipLine.value + part * down;
  const shadow = step(-3, 1 + 0.16 * depth, under) * (0.35 + 0.65 * step(0, 0.6, part));
  const lamps = 0.8 * reach * reach * (0.3 + 0.7 * shadow) * (0.45 + 0.55 * step(-4, 1.5, above));
  const aside = sideLight(part);
  const flesh = 0.12 * step(0, 0.3, reach) + 1.0 * reach * (0.55 + 0.45 * shadow);
  return [0.1 + aside * flesh, aside * lamps, 0.9 * aside * lamps, 0];
}

/** Cheeks shade the teeth behind the corners. */
const sideLight = (part) => CORNER + (1 - CORNER) * step(0, 0.55, part);

function step(from, to, x) {
  const t = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return t * t * (3 - 2 * t);
}

export const mouthLightGlsl = /* glsl */ `
uniform vec4 opening;
uniform float lipFront; // z of the lips in the middle,
uniform float lipBack;  // and how much farther back they are at the corners
uniform float lipLine;  // height of the line where they meet

/** The share of the light that reaches a place behind the lips. */
vec4 mouthLight(vec3 place) {
  // The opening at this place: nothing at the corners.
  float along = clamp(place.x / opening.z, -1.0, 1.0);
  float part = 1.0 - along * along;
  float gap = max(0.0, opening.x + opening.y);
  float depth = max(1.0, lipFront + opening.w * part - lipBack * along * along - place.z);
  // As through a window of that size, seen from that far behind it.
  float window = 1.4 * gap * opening.z;
  float reach = window / (window + 1.6 * depth * depth);
  // The light comes from above: under the upper lip there is its shadow, longer where the lip stands far off.
  float under = lipLine + part * opening.x - place.y, above = place.y - lipLine + part * opening.y;
  float shadow = smoothstep(-3.0, 1.0 + 0.16 * depth, under) * (0.35 + 0.65 * smoothstep(0.0, 0.6, part));
  float rim = smoothstep(-4.0, 1.5, above);
  // Flesh gives light back: what is left of it is never nothing, and no place is as bright as the skin outside.
  float lamps = 0.8 * reach * reach * (0.3 + 0.7 * shadow) * (0.45 + 0.55 * rim);
  float flesh = 0.12 * smoothstep(0.0, 0.3, reach) + 1.0 * reach * (0.55 + 0.45 * shadow);
  float aside = ${CORNER} + ${1 - CORNER} * smoothstep(0.0, 0.55, part); // cheeks shade the teeth behind the corners
  return vec4(0.1 + aside * flesh, aside * lamps, 0.9 * aside * lamps, 0.0);
}
`;
