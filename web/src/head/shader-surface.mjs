// SPDX-License-Identifier: MIT
// How the surfaces of a head look. KIND says what is drawn (skin, hair, eye, mouth, other), FINE the quality.
import { grainGlsl } from './grain.mjs';
import { deformGlsl } from './shader-deform.mjs';
import { mouthLightGlsl } from './mouth-light.mjs';
import { wrinkleGlsl } from './wrinkles.mjs';
import { FILL, GROUND, KEY, RIM, SKY } from './lights.mjs';

export const KINDS = { other: 0, skin: 1, hair: 2, eye: 3, mouth: 4 };

const vec3 = (v) => `vec3(${v.map((value) => value.toFixed(4)).join(', ')})`;

const lightsGlsl = [
  ...Object.entries({ KEY, FILL, RIM }).flatMap(([name, { direction, color }]) => [
    `const vec3 ${name}_DIRECTION = ${vec3(direction)};`,
    `const vec3 ${name}_COLOR = ${vec3(color)};`,
  ]),
  `const vec3 SKY = ${vec3(SKY)};`,
  `const vec3 GROUND = ${vec3(GROUND)};`,
].join('\n');

const commonGlsl = /* glsl */ `
${lightsGlsl}
uniform vec3 tint;
uniform float subsurface;
// With samples the middle of a point may lie outside a thin triangle, where what is interpolated is anything.
#if FINE
#define WITHIN centroid
#else
#define WITHIN
#endif
WITHIN varying vec2 surfaceUv;
#if FINE || KIND == 3
#define FULL 1
WITHIN varying vec3 surfaceNormal;
WITHIN varying vec3 surfacePosition;
WITHIN varying vec4 surfaceLight; // open sky, key, fill and rim light: how much of each reaches it
#endif
#if KIND == 2 && FINE
WITHIN varying vec3 surfaceFibre;
#elif KIND == 3
uniform vec3 eyeCenter;
uniform float irisRadius; // as a share of the eyeball's radius
WITHIN varying vec3 eyePlace; // on the unit eyeball, looking along z
#endif
#if FINE && KIND == 1
${wrinkleGlsl}
#endif

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
#else
  vec3 ambientReach = vec3(max(reach.x, 0.3)); // hair and cloth let light through: they are not black inside
#endif
  vec3 keyReach = vec3(reach.y);
#endif
#if KIND == 4
  vec3 light = mix(GROUND, SKY, 0.5) * ambientReach; // from all the flesh around
#else
  vec3 light = mix(GROUND, SKY, 0.5 + 0.5 * n.y) * ambientReach;
#endif
  light += KEY_COLOR * wrapped(dot(n, KEY_DIRECTION)) * keyReach;
  light += FILL_COLOR * wrapped(dot(n, FILL_DIRECTION)) * reach.z;
  light += RIM_COLOR * wrapped(dot(n, RIM_DIRECTION)) * reach.w;
  return light;
}
`;

export const vertexGlsl = /* glsl */ `
${deformGlsl}
${commonGlsl}
attribute vec4 reach;
#ifdef SOFTWARE
attribute vec3 rest;
#else
#define rest position
#endif
#if KIND == 2
attribute vec3 fibre;
#endif
#if KIND == 4
${mouthLightGlsl}
#endif
#if !FINE
varying vec3 vertexLight;
#endif

void main() {
  vec3 p = position, n = normal;
  deform(p, n);
  vec4 light = reach;
#if KIND == 4
  light = mouthLight(transpose(mat3(headTurn)) * (p - headTurn[3].xyz)); // as the head stands upright
#elif KIND == 3
  eyePlace = normalize(rest - eyeCenter);
#endif
  surfaceUv = uv;
#ifdef FULL
  surfaceNormal = n;
  surfacePosition = p;
  surfaceLight = light;
#endif
#if FINE && KIND == 1
  restPlace = rest;
#elif FINE && KIND == 2
  surfaceFibre = mat3(headTurn) * fibre;
#endif
#if !FINE
  vertexLight = diffuseLight(n, light);
#if KIND != 3
  vertexLight = sqrt(vertexLight * tint); // see main() of the fragments
  float peak = max(vertexLight.r, max(vertexLight.g, vertexLight.b));
  if (peak > 0.9) vertexLight *= (0.9 + 0.5 * (peak - 0.9)) / peak; // bright skin keeps its colour
#endif
#endif
  gl_Position = projectionMatrix * viewMatrix * vec4(p, 1.0);
}
`;

export const fragmentGlsl = /* glsl */ `
${commonGlsl}
#if FINE && KIND == 1
${grainGlsl}
#endif
uniform sampler2D map;
uniform float roughness;
uniform float specular;
#if KIND == 1
uniform vec2 moist; // how red it is where that begins, and where it is all moist
#endif
uniform float cutoff;   // discard what is less opaque
uniform float opaque;   // 1: what is left is opaque
uniform float fade;     // pixels from the lower border on, over which all vanishes
#if !FINE
varying vec3 vertexLight;
#endif

vec3 toLinear(vec3 c) {
#if FINE
  return c * (c * (c * 0.305306 + 0.682171) + 0.012523); // sRGB within 0.002, without powers
#else
  return c * c;
#endif
}

vec3 toDisplay(vec3 c) {
#if FINE
  vec3 root = sqrt(c), fourth = sqrt(root), eighth = sqrt(fourth); // sRGB within 0.003, without powers
  return max(vec3(0.0), 0.662003 * root + 0.684123 * fourth - 0.323583 * eighth - 0.022541 * c);
#else
  return sqrt(c);
#endif
}

/** Keeps colours as they are up to a bright tone, and bends what is brighter towards white. */
vec3 filmic(vec3 c) {
  float peak = max(c.r, max(c.g, c.b));
  const float start = 0.7;
  if (peak <= start) return c;
  float room = 1.0 - start;
  float pressed = 1.0 - room * room / (peak + room - start);
  c *= pressed / peak;
  return mix(c, vec3(pressed), 1.0 - 1.0 / (0.2 * (peak - pressed) + 1.0));
}

/** Highlights of a rough surface under one light (GGX with a simple visibility term). */
float highlight(vec3 n, vec3 v, vec3 l, float rough) {
  vec3 h = normalize(l + v);
  float nl = max(dot(n, l), 0.0), nh = max(dot(n, h), 0.0), lh = max(dot(l, h), 0.1);
  float a2 = rough * rough * rough * rough;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  return nl * a2 / (d * d * lh * lh * (rough * 4.0 + 2.0));
}

float fresnel(float cosine) {
  float x = 1.0 - cosine, x2 = x * x;
  return x2 * x2 * x;
}

vec4 albedo() {
  vec4 texel = texture2D(map, surfaceUv);
#ifdef HAS_ALPHA
  if (texel.a < max(cutoff, 0.01)) discard; // colours come multiplied by alpha, so that edges have no halo
  texel.rgb = toLinear(min(texel.rgb / texel.a, vec3(1.0)));
#elif !FINE || defined(STORED)
  texel.rgb = toLinear(texel.rgb);
#endif
  return vec4(texel.rgb * tint, texel.a);
}

#if KIND == 1
/** Lips: the red of the picture says where they are. */
float lipsOf(vec4 base) {
  return smoothstep(moist.x, moist.y, (base.r - base.g) / (base.r + 1e-3));
}
#endif

#if FINE && KIND != 3
vec3 shineOf(vec3 n, vec3 v, vec4 base, vec4 reach) {
  vec3 color;
#if KIND == 2
  // A band of light across the fibres (Kajiya and Kay 1989), and a wider one in the colour of the hair.
  vec3 fibre = normalize(surfaceFibre + 0.25 * n);
  vec3 h = normalize(KEY_DIRECTION + v), k = normalize(RIM_DIRECTION + v);
  float th = dot(fibre, h), tk = dot(fibre, k);
  float across = max(0.0, 1.0 - th * th), edge = max(0.0, 1.0 - tk * tk);
  // To the powers of 80, 14 and 20, without pow.
  float two = across * across, four = two * two, eight = four * four, sixteen = eight * eight;
  float narrow = sixteen * sixteen;
  narrow *= narrow * sixteen;
  float wide = eight * four * two;
  float four_edge = edge * edge * edge * edge, eight_edge = four_edge * four_edge;
  float facingKey = max(0.0, 0.25 + dot(n, KEY_DIRECTION)) * reach.y;
  color = KEY_COLOR * (narrow * 0.02 + wide * base.rgb * 0.7) * facingKey;
  color += RIM_COLOR * eight_edge * eight_edge * four_edge * max(0.0, dot(n, RIM_DIRECTION)) * base.rgb * reach.w;
  color *= specular * 2.5;
#else
  float f0 = 0.028, rim = fresnel(max(dot(n, v), 0.0)), rough = roughness;
#if KIND == 1
  rough = mix(rough, 0.34, lipsOf(base)); // lips are moist
#endif
  float shine = 0.75 * highlight(n, v, KEY_DIRECTION, rough) + 0.25 * highlight(n, v, KEY_DIRECTION, rough * 0.75);
  color = KEY_COLOR * shine * (f0 + rim * 0.4) * reach.y;
  color += FILL_COLOR * highlight(n, v, FILL_DIRECTION, rough) * (f0 + rim * 0.4) * reach.z;
  color += RIM_COLOR * highlight(n, v, RIM_DIRECTION, rough) * (f0 + rim * 0.3) * reach.w;
  vec3 mirror = reflect(-v, n);
  color += mix(GROUND, SKY, 0.5 + 0.5 * mirror.y) * (f0 + rim * 0.25) * reach.x * reach.x * 0.6;
  color *= specular * 2.6;
#endif
  return color;
}
#elif KIND == 3
/** The iris lies behind a lens: it glows opposite the lamp, and darkens at its border. */
vec3 iris(vec3 color) {
  float distance = length(eyePlace.xy) / irisRadius;
  float inside = 1.0 - smoothstep(0.85, 1.0, distance);
  float glow = inside * smoothstep(0.25, 0.7, distance) * max(0.0, dot(eyePlace.xy / irisRadius, -normalize(KEY_DIRECTION.xy)));
  float border = smoothstep(0.72, 0.95, distance) * (1.0 - smoothstep(0.95, 1.18, distance));
  return color * (1.0 + 1.3 * glow) * (1.0 - 0.45 * border);
}

/** The lamps mirrored in the cornea, and a little of the room. */
vec3 catchLight(vec3 n, vec3 v, float reach) {
  vec3 mirror = reflect(-v, n);
  float key = smoothstep(0.955, 0.975, dot(mirror, normalize(KEY_DIRECTION + vec3(0.0, 0.05, 0.3))));
  float fill = smoothstep(0.97, 0.985, dot(mirror, normalize(FILL_DIRECTION + vec3(-0.1, -0.2, 0.3))));
  return (key * vec3(1.6) + fill * vec3(0.12)) * reach + mix(GROUND, SKY, 0.5 + 0.5 * mirror.y) * 0.04 * reach;
}
#endif

#if !FINE && KIND != 3
/**
 * Colours are stored as about the root of what they are, and shown so: the root of (colour^2 * light) is colour * root of light.
 * Bright tones are bent towards white.
 */
void main() {
  vec4 texel = texture2D(map, surfaceUv);
#ifdef HAS_ALPHA
  if (texel.a < max(cutoff, 0.01)) discard;
  texel.rgb /= texel.a;
#endif
  vec3 color = texel.rgb * vertexLight;
  vec3 over = clamp(color - 0.8, 0.0, 0.5);
  color = min(color, 0.8) + over * (1.0 - over);
  float shown = min(1.0, gl_FragCoord.y / fade);
  float alpha = max(texel.a, opaque) * shown * shown * (3.0 - 2.0 * shown);
  gl_FragColor = vec4(min(color, 1.0) * alpha, alpha);
}
#else
void main() {
  vec4 base = albedo();
  vec3 n = normalize(surfaceNormal);
#if defined(TWO_SIDES) && KIND != 2
  if (!gl_FrontFacing) n = -n;
#endif
#if FINE && KIND == 1
  float deep = wrinkle(n);
  float pores = grained(n, restPlace, 1.0 - 0.7 * lipsOf(base));
  n = normalize(n);
  base.rgb *= (1.0 - vec3(0.26, 0.36, 0.38) * min(1.0, deep)) * (1.0 - vec3(0.1, 0.16, 0.18) * pores);
#endif
  vec3 v = normalize(cameraPosition - surfacePosition);
  vec4 reach = surfaceLight;
#if KIND == 3
  base.rgb = iris(base.rgb);
#endif
#if FINE
  vec3 color = base.rgb * diffuseLight(n, reach);
#if KIND != 3
  color += shineOf(n, v, base, reach);
#endif
#else
  vec3 color = base.rgb * vertexLight;
#endif
#if KIND == 3
  color += catchLight(n, v, min(1.0, 0.15 + reach.x * 1.6));
#endif
  float alpha = max(base.a, opaque) * smoothstep(0.0, 1.0, gl_FragCoord.y / fade);
  gl_FragColor = vec4(toDisplay(clamp(filmic(color), 0.0, 1.0)) * alpha, alpha);
}
#endif
`;
