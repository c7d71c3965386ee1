// SPDX-License-Identifier: MIT
// The fragment shader of a head's surfaces. KIND is the surface (skin, hair, eye, mouth, other), FINE the quality.
import { grainGlsl } from './grain.mjs';
import { lidFragmentGlsl, lidVertexGlsl } from './lids.mjs';
import { lightGlsl } from './lights.mjs';
import { mouthLightGlsl } from './mouth-light.mjs';
import { deformGlsl } from './shader-deform.mjs';
import { wrinkleGlsl } from './wrinkles.mjs';

// Reflections of the lamps and the room on skin, hair and eyes.

export const shineGlsl = /* glsl */ `
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
  float lips = lipsOf(base);
  rough = mix(rough, 0.42, lips); // lips are moist
#endif
  float shine = 0.75 * highlight(n, v, KEY_DIRECTION, rough) + 0.25 * highlight(n, v, KEY_DIRECTION, rough * 0.75);
  color = KEY_COLOR * shine * (f0 + rim * 0.4) * reach.y;
  color += FILL_COLOR * highlight(n, v, FILL_DIRECTION, rough) * (f0 + rim * 0.4) * reach.z;
  color += RIM_COLOR * highlight(n, v, RIM_DIRECTION, rough) * (f0 + rim * 0.3) * reach.w;
  vec3 mirror = reflect(-v, n);
  color += mix(GROUND, SKY, 0.5 + 0.5 * mirror.y) * (f0 + rim * 0.25) * reach.x * reach.x * 0.6;
  color *= specular * 2.6;
#if KIND == 1
  color *= 1.0 - 0.35 * lips; // but furrowed: no mirror
  color *= smoothstep(0.004, 0.02, dot(base.rgb, vec3(0.3, 0.6, 0.1))); // roots of hair that are painted on the skin do not shine
#endif
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
`;

export const KINDS = { other: 0, skin: 1, hair: 2, eye: 3, mouth: 4 };

const commonGlsl = /* glsl */ `
${lightGlsl}
uniform vec3 tint;
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
WITHIN varying vec2 lidGap; // mm below the upper margin, above the lower one
uniform float irisRadius; // as a share of the eyeball's radius
WITHIN varying vec3 eyePlace; // on the unit eyeball, looking along z
#endif
#if FINE && KIND == 1
${wrinkleGlsl}
WITHIN varying float grainDown; // see grain.mjs: loweredBy
#endif

`;

export const vertexGlsl = /* glsl */ `
${deformGlsl}
${commonGlsl}
attribute vec4 reach;
#if FINE && KIND == 1
attribute float lowered;
#endif
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
#elif KIND == 3
${lidVertexGlsl}
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
  lidGap = belowLids(transpose(mat3(headTurn)) * (p - headTurn[3].xyz) - eyeCenter); // as the head stands upright
#endif
  surfaceUv = uv;
#ifdef FULL
  surfaceNormal = n;
  surfacePosition = p;
  surfaceLight = light;
#endif
#if FINE && KIND == 1
  restPlace = rest;
  grainDown = lowered;
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
#elif KIND == 3
${lidFragmentGlsl}
#endif
uniform sampler2D map;
uniform float roughness;
uniform float specular;
#if KIND == 1
uniform vec2 moist; // how red it is where that begins, and where it is all moist
#endif
uniform float cutoff;   // discard what is less opaque
uniform float ceiling;  // discard what is not less opaque: it has been drawn
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

/** Keeps colours up to a bright tone, and compresses brighter ones towards white. */
vec3 filmic(vec3 c) {
  float peak = max(c.r, max(c.g, c.b));
  const float start = 0.7;
  if (peak <= start) return c;
  float room = 1.0 - start;
  float pressed = 1.0 - room * room / (peak + room - start);
  c *= pressed / peak;
  return mix(c, vec3(pressed), 1.0 - 1.0 / (0.2 * (peak - pressed) + 1.0));
}

/** The surface's own colour, where the picture says that. */
vec4 albedo(vec4 texel) {
#ifdef HAS_ALPHA
  texel.rgb = toLinear(min(texel.rgb / texel.a, vec3(1.0))); // multiplied by alpha, so that edges have no halo
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

${shineGlsl}
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
vec4 shaded(vec4 base) {
  vec3 n = normalize(surfaceNormal);
#if defined(TWO_SIDES) && KIND != 2
  if (!gl_FrontFacing) n = -n;
#endif
#if FINE && KIND == 1
  float deep = wrinkle(n);
  float pores = grained(n, restPlace - vec3(0.0, grainDown, 0.0), 1.0 - 0.7 * lipsOf(base));
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
#if KIND == 1
  color += shineOf(n, v, base, reach) * (1.0 - 0.7 * min(1.0, deep)); // a crease's sides shade each other
#elif KIND != 3
  color += shineOf(n, v, base, reach);
#endif
#else
  vec3 color = base.rgb * vertexLight;
#endif
#if KIND == 3
  color *= lidShade(lidGap);
  color += catchLight(n, v, min(1.0, 0.15 + reach.x * 1.6)) * smoothstep(-0.4, 1.2, lidGap.x);
  color += 0.16 * wetEdge(lidGap.y) * (SKY + KEY_COLOR * reach.y * max(0.0, dot(n, KEY_DIRECTION)));
#endif
  float alpha = max(base.a, opaque) * smoothstep(0.0, 1.0, gl_FragCoord.y / fade);
  return vec4(toDisplay(clamp(filmic(color), 0.0, 1.0)) * alpha, alpha);
}

void main() {
  vec4 texel = texture2D(map, surfaceUv);
#ifdef HAS_ALPHA
  if (texel.a >= max(cutoff, 0.01) && texel.a < ceiling) gl_FragColor = shaded(albedo(texel));
  else discard;
#else
  gl_FragColor = shaded(albedo(texel));
#endif
}
#endif
`;
