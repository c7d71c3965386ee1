// SPDX-License-Identifier: MIT
// The lamps of the portrait, linear colours. Directions point to the light; x is to the right of the picture. What the room
// adds: environment.mjs.
import { environmentGlsl } from './environment.mjs';

const unit = (v) => v.map((value) => value / Math.hypot(...v));

export const KEY = { direction: unit([-0.62, 0.55, 0.66]), color: [2.06, 1.92, 1.74] };
export const FILL = { direction: unit([0.85, 0.1, 0.55]), color: [0.3, 0.34, 0.41] };
export const RIM = { direction: unit([0.6, 0.45, -0.75]), color: [1.3, 1.35, 1.45] };

/**
 * The window as it is mirrored in an eye, with its right and its up: a little towards the viewer from the lamp, so that its
 * picture lies on the iris.
 */
export const WINDOW = windowOf(unit(KEY.direction.map((value, k) => value + [0, 0.05, 0.3][k])));

function windowOf(direction) {
  const right = unit([direction[2], 0, -direction[0]]);
  const [[x, y, z], [a, b, c]] = [direction, right];
  return { direction, right, up: [y * c - z * b, z * a - x * c, x * b - y * a] };
}

// The light that falls on a surface. KIND and FINE: see shader-surface.mjs.

const vec3 = (v) => `vec3(${v.map((value) => value.toFixed(4)).join(', ')})`;

export const windowGlsl = `
const vec3 WINDOW = ${vec3(WINDOW.direction)};
const vec3 WINDOW_RIGHT = ${vec3(WINDOW.right)};
const vec3 WINDOW_UP = ${vec3(WINDOW.up)};
`;

const lampsGlsl = Object.entries({ KEY, FILL, RIM })
  .map(([name, { direction, color }]) => `const vec3 ${name}_DIRECTION = ${vec3(direction)};\nconst vec3 ${name}_COLOR = ${vec3(color)};`)
  .join('\n');

export const lightGlsl = /* glsl */ `
${lampsGlsl}
${environmentGlsl}
uniform float subsurface;

/** Light that goes round the edge of what it falls on, the red of it farthest when there is flesh below. */
vec3 wrapped(float cosine) {
#if KIND == 1
  vec3 wrap = subsurface * vec3(1.0, 0.5, 0.35);
#else
  vec3 wrap = vec3(subsurface * 0.6);
#endif
  vec3 light = max(vec3(0.0), (cosine + wrap) / (1.0 + wrap));
  return light * light / (0.6 + 0.4 * light) ;
}

vec3 diffuseLight(vec3 n, vec4 reach) {
#if KIND == 1 || KIND == 4
#if FINE
  vec2 root = sqrt(reach.xy), fourth = sqrt(root); // powers without pow, which is dear: 0.8, 0.75, and 1.05 of blue
  vec2 blue = reach.xy * (0.86 + 0.14 * root);
  vec3 ambientReach = vec3(mix(root.x * fourth.x, reach.x, 0.2), reach.x, blue.x); // what is lost in a crease comes back reddish
  vec3 keyReach = vec3(root.y * fourth.y, reach.y, blue.y);
#else
  vec3 ambientReach = vec3(mix(reach.x, sqrt(reach.x), 0.4), reach.x, reach.x); // much the same, and cheaper
  vec3 keyReach = vec3(mix(reach.y, sqrt(reach.y), 0.5), reach.y, reach.y);
#endif
#else
#if KIND == 3
  vec3 ambientReach = vec3(max(reach.x, 0.12));
#elif KIND == 2
  vec3 ambientReach = vec3(max(reach.x, 0.3)); // hair lets light through: it is not black inside
#else
  vec3 ambientReach = vec3(max(reach.x, 0.55)); // nor is a collar, whose cloth lets more through
#endif
  vec3 keyReach = vec3(reach.y);
#endif
#if KIND == 4
  vec3 light = AROUND * ambientReach; // from all the flesh around
#else
  vec3 light = room(n) * ambientReach;
#endif
  light += KEY_COLOR * wrapped(dot(n, KEY_DIRECTION)) * keyReach;
  light += FILL_COLOR * wrapped(dot(n, FILL_DIRECTION)) * reach.z;
  light += RIM_COLOR * wrapped(dot(n, RIM_DIRECTION)) * reach.w;
  return light;
}
`;
