// SPDX-License-Identifier: MIT
// Lips: skin with fine furrows across, and wet only along the seam where they meet. The feature points and the red of the
// picture say where they are.

const WET_MM = 1.5; // from the seam, where the wetness has fallen to a third
const WIDER = 1.06; // than the corners of the outer contour

/** How red the picture is where lips begin, and where all is lip: (red - green) / red. */
export const MOIST = [0.5, 0.6];
/** Roughness of the dry lip and of what is wet; how much less the dry one shines than skin; how much the wet one does. */
export const LIP = { rough: 0.4, wet: 0.24, dull: 0.5, gloss: 0.75 };

const NONE = { seam: [1e4, 0], size: [1, 1, 1] }; // too far away to have an effect

/**
 * Locates the closed lips.
 * @param {Record<string, number[]>} fdp
 * @returns {{seam: number[], size: number[]}} the line where they meet, as a parabola: its height in the middle, and how much
 *   it rises with the square of x; half of their width, height of the upper and of the lower one
 */
export function lipsOf(fdp) {
  const [upper, lower, inner, outer, top, bottom] = ['2.2', '2.3', '2.4', '8.3', '8.1', '8.2'].map((point) => fdp[point]);
  if (!upper || !lower || !inner || !outer || !top || !bottom) return NONE;
  const middle = (upper[1] + lower[1]) / 2;
  const rise = inner[0] ? (inner[1] - middle) / inner[0] ** 2 : 0;
  const size = [WIDER * Math.abs(outer[0]), top[1] - middle, middle - bottom[1]];
  return { seam: [middle, rise], size: size.map((mm) => Math.max(1, mm)) };
}

const aboveSeam = ([middle, rise], [x, y]) => y - middle - rise * x * x;

/** How wet a place of the lips is, 0..1. @param {ReturnType<typeof lipsOf>} lips @param {number[]} place at rest */
export const wetness = ({ seam }, place) => Math.exp(-((aboveSeam(seam, place) / WET_MM) ** 2));

/** Where the squares of the distances from the middle, in sizes of the lips, begin and cease to be lip. */
const BORDER = [0.9, 1.25];

/** Whether a place lies on the lips, 0..1. @param {ReturnType<typeof lipsOf>} lips @param {number[]} place at rest */
export function within({ seam, size: [width, upper, lower] }, place) {
  const above = aboveSeam(seam, place);
  const far = (place[0] / width) ** 2 + (above / (above > 0 ? upper : lower)) ** 2;
  const t = Math.min(1, Math.max(0, (far - BORDER[0]) / (BORDER[1] - BORDER[0])));
  return 1 - t * t * (3 - 2 * t);
}

export const lipsGlsl = /* glsl */ `
uniform vec2 moist; // see MOIST
uniform vec2 lipSeam; // see lipsOf
uniform vec3 lipSize;

float aboveSeam(vec3 place) {
  return place.y - lipSeam.x - lipSeam.y * place.x * place.x;
}

/** Whether this is lip, 0..1. */
float lipsOf(vec4 base, vec3 place) {
  float above = aboveSeam(place), side = place.x / lipSize.x, high = above / (above > 0.0 ? lipSize.y : lipSize.z);
  float far = side * side + high * high;
  if (far > ${BORDER[1].toFixed(2)}) return 0.0;
  return (1.0 - smoothstep(${BORDER[0].toFixed(2)}, ${BORDER[1].toFixed(2)}, far)) * smoothstep(moist.x, moist.y, (base.r - base.g) / (base.r + 1e-3));
}

float wetness(vec3 place) {
  float far = aboveSeam(place) / ${WET_MM.toFixed(2)};
  return exp(-far * far);
}

/** Bends the normal as furrows do that fan out from the seam. @returns how deep one is */
float furrowed(inout vec3 n, vec3 place, float lips) {
  float above = aboveSeam(place);
  vec3 found = texture2D(grain, vec2(place.x / (7.0 + 0.25 * abs(above)), above / 60.0)).xyz;
  n.x -= (found.x - 0.502) * 1.3 * lips;
  return found.z * lips;
}
`;
