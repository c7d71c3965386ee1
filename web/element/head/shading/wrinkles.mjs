// SPDX-License-Identifier: MIT
// Creases that come and go with the face: over the brows, between them, beside the eyes, on the nose, from there to the mouth.
// They are drawn by the shader where the feature points say, on any head, so that no picture of them has to be loaded.

const share = (value, whole) => Math.min(1, Math.max(0, value / whole));
const mean = (values, numbers) => numbers.reduce((sum, n) => sum + values[n], 0) / numbers.length;

/** Values at which a crease is as deep as it gets. */
const RAISED = 260; // brows, FAPs 31 to 36
const SQUEEZED = 150; // brows, FAPs 37 and 38
const LIFTED = 190; // cheeks, FAPs 41 and 42
const DRAWN = 240; // cheeks and lips together, see foldsOf
const STILL = 50; // of that: what speech does to the lips folds nothing
const WRINKLED = 60; // nose, FAP 63

/** Relief of the skin (see the materials of a head) of the young, who have no crow's feet, and of the old. */
const RELIEF = [0.95, 1.6];
/** Depth of a young person's creases on the forehead and between the brows, as a share of an old one's. */
const YOUNG = 0.6;

/** @param {number} [relief] of the skin's material @returns {number} how creased a skin is by age, 0..1 */
export const agedBy = (relief = 1) => share(relief - RELIEF[0], RELIEF[1] - RELIEF[0]);

/**
 * Computes the depth of creases, 0..1.
 * @param {ArrayLike<number>} values by FAP number
 * @param {number} [aged] see agedBy
 * @returns {number[]} forehead, between the brows, beside the left eye, beside the right eye
 */
export function wrinklesOf(values, aged = 1) {
  const raised = Math.max(mean(values, [31, 33, 35]), mean(values, [32, 34, 36]), 0.8 * mean(values, [31, 32]));
  const forehead = share(raised, RAISED);
  const frown = share(mean(values, [37, 38]) - 0.4 * Math.min(0, mean(values, [31, 32])), SQUEEZED);
  const brows = YOUNG + (1 - YOUNG) * aged;
  const feet = (cheek, lid) => aged * share(values[cheek] + 0.3 * values[lid], LIFTED);
  return [forehead * brows, frown * brows, feet(41, 21), feet(42, 22)];
}

/**
 * Computes the depth of the folds of cheeks and nose, 0..1, from FAPs that draw the corners of the mouth up and out, or the
 * upper lip towards the nose.
 * @param {ArrayLike<number>} values by FAP number
 * @returns {number[]} from nose to mouth on the left, on the right, across the nose
 */
export function foldsOf(values) {
  const over = (fap) => Math.max(0, values[fap]);
  const up = over(63);
  const lips = (corner, stretch, upper) => 0.5 * over(corner) + 0.3 * over(stretch) + 0.3 * Math.max(0, -values[upper]);
  const side = (cheek, ...of) => share(0.6 * values[cheek] + lips(...of) + up - STILL, DRAWN);
  return [side(41, 12, 6, 8), side(42, 13, 7, 9), share(up, WRINKLED)];
}

/**
 * Locates the folds.
 * @param {Record<string, number[]>} fdp
 * @returns {number[]|null} x and y of the upper and the lower end, on the left; null: the head has no such points
 */
export function foldPlace(fdp) {
  const [wing, corner] = [fdp['9.1'], fdp['8.3']];
  return wing && corner ? [Math.abs(wing[0]) + 3.5, wing[1] + 6, Math.abs(corner[0]) + 7, corner[1] + 1] : null;
}

/**
 * Locates the creases.
 * @param {Record<string, number[]>} fdp @param {{ES: number, IRISD: number}} fapu
 * @returns {number[]|null} y of the brows, half the distance of their inner ends, x and y of the eyes' outer corners (of the
 *   left one; the right is its mirror); null: the head has no such points
 */
export function wrinklePlace(fdp, fapu) {
  const [inner, outer, eye] = [fdp['4.1'], fdp['4.5'], fdp['3.5']];
  if (!inner || !outer || !eye) return null;
  return [inner[1], Math.abs(inner[0]), eye[0] + 0.27 * fapu.ES, eye[1]];
}

export const wrinkleGlsl = /* glsl */ `
uniform vec4 wrinkles;      // how deep: wrinklesOf
uniform vec4 wrinklePlace;  // where: wrinklePlace
uniform vec3 folds;         // how deep: foldsOf
uniform vec4 foldPlace;     // where: foldPlace
WITHIN varying vec3 restPlace; // see shader-surface.mjs

/** A crease each unit of x, and where it slopes: depth, slope. */
vec2 crease(float x) {
  float c = 0.5 + 0.5 * cos(6.2832 * x);
  float c2 = c * c;
  return vec2(c2 * c2, -12.566 * c2 * c * sin(6.2832 * x));
}

/** Bends the normal where the skin is folded. @returns how deep a crease is here */
float wrinkle(inout vec3 n) {
  vec3 q = restPlace;
  float side = abs(q.x);
  float above = q.y - wrinklePlace.x;
  float front = smoothstep(-5.0, 10.0, q.z);
  // Most of the skin has no crease, and a branch costs less than its sines.
  float deep = 0.0;
  float at = wrinkles.x * front * (0.55 + 0.45 * smoothstep(2.0, 14.0, side)) * smoothstep(7.0, 15.0, above) * (1.0 - smoothstep(26.0, 40.0, above)) * (1.0 - smoothstep(20.0, 40.0, side));
  if (at > 0.0) {
    vec2 fold = crease(above / 7.0 + 0.3 * sin(q.x * 0.08 + 1.3) + 0.08 * sin(q.x * 0.31)) * at;
    n.y += 0.2 * fold.y / 7.0;
    deep = 0.8 * fold.x;
  }
  float gap = wrinklePlace.y;
  at = wrinkles.y * front * smoothstep(-9.0, -1.0, above) * (1.0 - smoothstep(7.0, 16.0, above)) * (1.0 - smoothstep(0.45 * gap, 0.95 * gap, side));
  if (at > 0.0) {
    vec2 fold = crease((side - 0.42 * gap) / (1.5 * gap)) * at;
    n.x += 0.5 * sign(q.x) * fold.y / (1.5 * gap);
    deep += 1.2 * fold.x;
  }
  vec2 corner = vec2(side - wrinklePlace.z, q.y - wrinklePlace.w);
  float far = length(corner);
  at = (q.x > 0.0 ? wrinkles.z : wrinkles.w) * smoothstep(2.0, 5.0, far) * (1.0 - smoothstep(10.0, 18.0, far));
  if (at > 0.0) {
    float turn = atan(corner.y, corner.x);
    vec2 fold = crease(turn / 0.38 + 0.12 * sin(far * 0.6)) * at * (1.0 - smoothstep(0.5, 0.85, abs(turn)));
    n.y += 0.1 * fold.y / max(far * 0.38, 2.0);
    deep += fold.x;
  }
  // From the nose to the mouth: a broad dip under a cheek that stands out beside it. A narrow one would shine like a scar.
  float down = (foldPlace.y - q.y) / (foldPlace.y - foldPlace.w);
  at = (q.x > 0.0 ? folds.x : folds.y) * front * smoothstep(-0.1, 0.3, down) * (1.0 - smoothstep(0.6, 1.1, down));
  if (at > 0.0) {
    float beside = side - mix(foldPlace.x, foldPlace.z, down) - 7.0 * down * (1.0 - down);
    float valley = exp(-beside * beside / 14.0), cheek = exp(-(beside - 8.0) * (beside - 8.0) / 60.0);
    n.x += sign(q.x) * at * (0.016 * (beside - 8.0) * cheek - 0.04 * beside * valley);
    deep += at * 0.5 * valley;
  }
  // Across the nose, beside its bridge and up to the corner of the eye.
  at = folds.z * front * smoothstep(2.0, 5.0, side) * (1.0 - smoothstep(9.0, 15.0, side)) * smoothstep(foldPlace.y + 4.0, foldPlace.y + 12.0, q.y)
    * (1.0 - smoothstep(-4.0, 3.0, q.y));
  if (at > 0.0) {
    vec2 fold = crease((q.y - 0.7 * side) / 6.5 + 0.1 * sin(side * 0.9)) * at;
    n.y += 0.05 * fold.y / 6.5;
    deep += 0.45 * fold.x;
  }
  return deep;
}
`;
