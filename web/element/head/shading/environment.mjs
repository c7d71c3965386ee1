// SPDX-License-Identifier: MIT
// The room about the portrait: what its walls, ceiling and floor throw on a surface, as spherical harmonics of irradiance
// (R. Ramamoorthi and P. Hanrahan, "An Efficient Representation for Irradiance Environment Maps", SIGGRAPH 2001).

const unit = (v) => v.map((value) => value / Math.hypot(...v));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

const EVERYWHERE = [0.04, 0.04, 0.044];

/**
 * Lobes of light, linear colours: radiance color * exp(sharp * (cosine - 1)). x is to the right of the picture, z to the
 * viewer.
 */
const LOBES = [
  { to: [-0.2, 1, 0.1], sharp: 1.6, color: [0.36, 0.38, 0.42] }, // ceiling
  { to: [-0.9, 0.25, 0.45], sharp: 2, color: [0.36, 0.36, 0.35] }, // the wall beside the window
  { to: [0.9, 0.05, 0.3], sharp: 2.4, color: [0.14, 0.12, 0.11] }, // the wall opposite
  { to: [0.55, 0.35, -0.8], sharp: 2.6, color: [0.14, 0.16, 0.2] }, // the room behind
  { to: [0, -1, 0.25], sharp: 2, color: [0.2, 0.145, 0.115] }, // floor
].map((lobe) => ({ ...lobe, to: unit(lobe.to) }));

const SAMPLES = 1024; // directions

/**
 * A basis of nine functions of a direction, and for each what makes irradiance of radiance: its norm squared, and the share
 * that a cosine lets through.
 */
const BASIS = [
  [() => 1, 0.282095 ** 2],
  ...[0, 1, 2].map((k) => [(n) => n[k], (2 / 3) * 0.488603 ** 2]),
  ...[[0, 1], [1, 2], [0, 2]].map(([a, b]) => [(n) => n[a] * n[b], 0.25 * 1.092548 ** 2]),
  [(n) => 3 * n[2] * n[2] - 1, 0.25 * 0.315392 ** 2],
  [(n) => n[0] * n[0] - n[1] * n[1], 0.25 * 0.546274 ** 2],
];

function radiance(n) {
  const shares = LOBES.map(({ to, sharp }) => Math.exp(sharp * (dot(n, to) - 1)));
  return EVERYWHERE.map((least, k) => LOBES.reduce((sum, { color }, i) => sum + color[k] * shares[i], least));
}

function harmonics() {
  const sums = BASIS.map(() => [0, 0, 0]);
  for (let i = 0; i < SAMPLES; i++) {
    const y = 1 - (2 * (i + 0.5)) / SAMPLES;
    const [ring, turn] = [Math.sqrt(1 - y * y), i * Math.PI * (3 - Math.sqrt(5))];
    const n = [ring * Math.cos(turn), y, ring * Math.sin(turn)];
    const light = radiance(n);
    BASIS.forEach(([of, share], j) => {
      for (const k of [0, 1, 2]) sums[j][k] += (of(n) * share * light[k] * 4 * Math.PI) / SAMPLES;
    });
  }
  return sums;
}

const HARMONICS = harmonics();

/** The mean of what comes from everywhere. */
export const AROUND = HARMONICS[0];

/** From irradiance back to radiance: what a cosine has let through of each band. */
const SHARP = [1, 1.5, 4];
const bandOf = (j) => (j === 0 ? 0 : j < 4 ? 1 : 2);

function sumOf(n, shares) {
  const out = [0, 0, 0];
  BASIS.forEach(([of], j) => {
    const value = of(n) * shares[bandOf(j)];
    for (let k = 0; k < 3; k++) out[k] += value * HARMONICS[j][k];
  });
  for (let k = 0; k < 3; k++) out[k] = Math.max(0, out[k]);
  return out;
}

/** Light of the room on a white surface. @param {number[]} n unit, outward */
export const room = (n) => sumOf(n, [1, 1, 1]);

/** What a surface of that roughness mirrors of the room: its light, blurred as a GGX lobe of that width blurs each band. */
export function mirroredRoom(way, rough) {
  const blur = Math.exp(-2 * rough ** 4);
  return sumOf(way, [SHARP[0], SHARP[1] * blur, SHARP[2] * blur ** 3]);
}

const vec3 = (v) => `vec3(${v.map((value) => value.toFixed(5)).join(', ')})`;

export const environmentGlsl = /* glsl */ `
const vec3 AROUND = ${vec3(AROUND)};

vec3 broadly(vec3 n) {
  return n.x * ${vec3(HARMONICS[1])} + n.y * ${vec3(HARMONICS[2])} + n.z * ${vec3(HARMONICS[3])};
}

vec3 finely(vec3 n) {
  vec3 light = n.x * n.y * ${vec3(HARMONICS[4])} + n.y * n.z * ${vec3(HARMONICS[5])} + n.x * n.z * ${vec3(HARMONICS[6])};
  return light + (3.0 * n.z * n.z - 1.0) * ${vec3(HARMONICS[7])} + (n.x * n.x - n.y * n.y) * ${vec3(HARMONICS[8])};
}

vec3 room(vec3 n) {
  return max(vec3(0.0), AROUND + broadly(n) + finely(n));
}

vec3 mirroredRoom(vec3 way, float rough) {
  float r2 = rough * rough, blur = exp(-2.0 * r2 * r2);
  return max(vec3(0.0), AROUND + ${SHARP[1].toFixed(1)} * blur * broadly(way) + ${SHARP[2].toFixed(1)} * blur * blur * blur * finely(way));
}
`;
