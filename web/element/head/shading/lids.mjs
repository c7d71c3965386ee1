// SPDX-License-Identifier: MIT
// Locates the margins of the lids, for their effect on the eyeball: the shadow of the upper lid, the wet edge of the lower one.

const BIN_MM = 2.5; // along the margins: there is a vertex on them in each
const HALF_MM = 10; // to either side of the pupil: farther out the lids meet
const OUTSIDE = [0.2, 4]; // mm before the eyeball: what lies deeper is the lids' inside
const OWN = 0.5; // of the greatest weight: what belongs to the lid's margin

const NONE = { upper: [9, 0, 0, 0], lower: [-9, 0, 0, 0] }; // far enough to have no effect

const POWERS = [0, 1, 2, 3];

/** The cubic nearest to points, by least squares: its factors, the constant one first. */
function cubic(points) {
  const mean = (fn) => points.reduce((sum, point) => sum + fn(point), 0) / points.length;
  const rows = POWERS.map((i) => [...POWERS.map((j) => mean(([x]) => x ** (i + j))), mean(([x, y]) => y * x ** i)]);
  for (const i of POWERS)
    for (const j of POWERS) {
      if (i === j) continue;
      const share = rows[j][i] / rows[i][i]; // never by nothing: the points lie at different places
      rows[j] = rows[j].map((value, k) => value - share * rows[i][k]);
    }
  return POWERS.map((i) => rows[i][4] / rows[i][i]);
}

/**
 * The margin of one lid: angles above the horizontal, as a cubic over x.
 * @param {1|-1} up -1: the upper lid, whose margin is its lowest part
 */
function margin(skin, turnNumber, center, radius, up) {
  const turn = skin.turns.find((one) => one.turn === turnNumber && one.vertices);
  if (!turn) return null;
  const least = OWN * Math.max(...turn.weights);
  const bins = new Map();
  turn.vertices.forEach((v, i) => {
    const [x, y, z] = center.map((value, k) => skin.position[3 * v + k] - value);
    const out = Math.hypot(x, y, z) - radius;
    if (turn.weights[i] < least || out < OUTSIDE[0] || out > OUTSIDE[1] || Math.abs(x) > HALF_MM || z <= 0) return;
    const bin = Math.round(x / BIN_MM);
    const angle = Math.atan2(y, z);
    if (!bins.has(bin) || up * (angle - bins.get(bin)[1]) > 0) bins.set(bin, [x, angle]);
  });
  return bins.size > 4 ? cubic([...bins.values()]) : null;
}

/** The line moved so that it goes through a feature point, which is on the margin for certain. */
function through([start, ...rest], point, center) {
  if (!point) return [start, ...rest];
  const [x, y, z] = point.map((value, k) => value - center[k]);
  return [Math.atan2(y, z) - rest.reduce((sum, factor, k) => sum + factor * x ** (k + 1), 0), ...rest];
}

/**
 * @param {object} model @param {number[]} center of the eyeball @param {number} radius of it
 * @returns {{upper: number[], lower: number[], faps: number[]}} the margins at rest, and what closes them
 */
export function lidsOf(model, center, radius) {
  const faps = center[0] > 0 ? [19, 21] : [20, 22];
  const points = center[0] > 0 ? ['3.1', '3.3'] : ['3.2', '3.4'];
  const skin = model.parts.find(({ name }) => name === 'skin');
  const [upper, lower] = faps.map((fap, i) => {
    const number = model.turns.findIndex((turn) => turn.fap === fap);
    const line = skin && number >= 0 ? margin(skin, number, center, radius, i ? 1 : -1) : null;
    return line && through(line, model.fdp[points[i]], center);
  });
  return upper && lower ? { upper, lower, faps } : { ...NONE, faps };
}

/**
 * The margins as they stand: each point of one goes to the other as its lid closes.
 * @param {Float32Array} values by FAP number
 */
export function lidsAt({ upper, lower, faps }, values) {
  const [down, up] = faps.map((fap) => values[fap] / 1024);
  return {
    upper: upper.map((value, k) => value - down * (value - lower[k])),
    lower: lower.map((value, k) => value + up * (upper[k] - value)),
  };
}

export const lidVertexGlsl = /* glsl */ `
uniform vec4 lidUpper; // angles of the margins over x: a cubic
uniform vec4 lidLower;

/** mm below the upper margin, and above the lower one. @param place of the upright head, from the eyeball's middle */
vec2 belowLids(vec3 place) {
  vec4 along = vec4(1.0, place.x, place.x * place.x, place.x * place.x * place.x);
  float angle = atan(place.y, place.z);
  return vec2(dot(lidUpper, along) - angle, angle - dot(lidLower, along)) * length(place.yz);
}
`;

export const lidFragmentGlsl = /* glsl */ `
/** The shadow of the upper lid and its lashes, and the red that the lower one throws back. */
vec3 lidShade(vec2 gap) {
  vec3 under = mix(vec3(0.34, 0.28, 0.28), vec3(1.0), smoothstep(-0.6, 3.6, gap.x));
  return under * mix(vec3(0.86, 0.72, 0.68), vec3(1.0), smoothstep(-0.2, 1.4, gap.y));
}

/** The film of tears that stands on the lower lid's edge. */
float wetEdge(float gap) {
  float away = (gap - 0.3) / 0.22;
  return max(0.0, 1.0 - away * away);
}
`;
