// SPDX-License-Identifier: MIT
// The fragment shader of a head's surfaces. KIND is the surface (skin, hair, eye, mouth, other), FINE the quality.
import { grainGlsl } from './grain.mjs';
import { lidFragmentGlsl, lidVertexGlsl } from './lids.mjs';
import { lightGlsl, windowGlsl } from './lights.mjs';
import { LIP, lipsGlsl } from './lips.mjs';
import { mouthLightGlsl } from './mouth-light.mjs';
import { deformGlsl } from './shader-deform.mjs';
import { GLOSS } from './surfaces.mjs';
import { wrinkleGlsl } from './wrinkles.mjs';

// Reflections of the lamps and the room on skin, hair and eyes.


export const shineGlsl = /* glsl */ `
/** Highlights of a rough surface under one light (GGX with a simple visibility term). */
float highlight(vec3 n, vec3 v, vec3 l, float rough) {
  vec3 h = normalize(l + v);
  float nl = max(dot(n, l), 0.0), nh = max(dot(n, h), 0.0), lh = dot(l, h);
  float a2 = rough * rough * rough * rough;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  return nl * a2 / (d * d * max(lh * lh, 0.1) * (rough * 4.0 + 2.0)); // bounded, or what a lamp behind grazes would be white
}

float fresnel(float cosine) {
  float x = 1.0 - cosine, x2 = x * x;
  return x2 * x2 * x;
}

#if KIND != 2
const float F0 = ${GLOSS.f0.toFixed(4)};
const float GLOSS = ${GLOSS.strength.toFixed(2)};

/** What a rough surface throws back of the lamps and the room: most of it broadly, and a part narrowly, as the oil on skin does. */
vec3 glossOf(vec3 n, vec3 v, vec4 reach, float rough) {
  float rim = fresnel(max(dot(n, v), 0.0));
  float shine = mix(highlight(n, v, KEY_DIRECTION, rough), highlight(n, v, KEY_DIRECTION, rough * ${GLOSS.oily.toFixed(2)}), ${GLOSS.narrow.toFixed(2)});
  vec3 color = KEY_COLOR * shine * (F0 + rim * 0.4) * reach.y;
  color += FILL_COLOR * highlight(n, v, FILL_DIRECTION, rough) * (F0 + rim * 0.4) * reach.z;
  color += RIM_COLOR * highlight(n, v, RIM_DIRECTION, rough) * (F0 + rim * 0.1) * reach.w;
  return color + mirroredRoom(reflect(-v, n), rough) * (F0 + rim * 0.25) * reach.x * reach.x * 0.6;
}
#endif

#if KIND == 2 && FINE
/**
 * A band of light across the fibres (Kajiya and Kay 1989), and a wider one in the colour of the hair.
 * @returns what the colour of the hair is multiplied by, and what of KEY_COLOR is added
 */
vec4 hairShine(vec3 n, vec3 v, vec3 along, vec4 reach) {
  vec3 fibre = normalize(along + 0.25 * n);
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
  vec3 own = KEY_COLOR * wide * 0.7 * facingKey + RIM_COLOR * eight_edge * eight_edge * four_edge * max(0.0, dot(n, RIM_DIRECTION)) * reach.w;
  return vec4(own, narrow * 0.02 * facingKey) * specular * 2.5;
}
#elif FINE && KIND != 3
vec3 shineOf(vec3 n, vec3 v, vec4 base, vec4 reach, float lips) {
  float rough = roughness;
#if KIND == 1
  rough = mix(rough, ${LIP.rough.toFixed(2)}, lips);
#endif
  vec3 color = glossOf(n, v, reach, rough) * specular * GLOSS;
#if KIND == 1
  if (lips > 0.0) {
    color *= 1.0 - ${LIP.dull.toFixed(2)} * lips; // furrowed: no mirror
    vec3 wet = KEY_COLOR * highlight(n, v, KEY_DIRECTION, ${LIP.wet.toFixed(2)}) * reach.y + mirroredRoom(reflect(-v, n), ${LIP.wet.toFixed(2)}) * reach.x;
    color += ${LIP.gloss.toFixed(2)} * F0 * lips * wetness(restPlace) * wet;
  }
  color *= smoothstep(0.004, 0.02, dot(base.rgb, vec3(0.3, 0.6, 0.1))); // roots of hair that are painted on the skin do not shine
#endif
  return color;
}
#elif KIND == 3
${windowGlsl}
/** The iris lies behind a lens: it glows opposite the lamp, and darkens at its border. */
vec3 iris(vec3 color) {
  float distance = length(eyePlace.xy) / irisRadius;
  float inside = 1.0 - smoothstep(0.85, 1.0, distance);
  float glow = inside * smoothstep(0.25, 0.7, distance) * max(0.0, dot(eyePlace.xy / irisRadius, -normalize(KEY_DIRECTION.xy)));
  float border = smoothstep(0.72, 0.95, distance) * (1.0 - smoothstep(0.95, 1.18, distance));
  return color * (1.0 + 1.3 * glow) * (1.0 - 0.45 * border);
}

/** The window mirrored in the cornea, a little of the other lamp, and of the room, most where the wet ball curves away. */
vec3 catchLight(vec3 n, vec3 v, float reach) {
  vec3 mirror = reflect(-v, n);
  float ahead = dot(mirror, WINDOW);
  vec2 at = abs(vec2(dot(mirror, WINDOW_RIGHT), dot(mirror, WINDOW_UP))) / max(ahead, 0.1);
  vec2 inside = 1.0 - smoothstep(vec2(0.17, 0.23), vec2(0.26, 0.33), at);
  float fill = smoothstep(0.95, 0.99, dot(mirror, normalize(FILL_DIRECTION + vec3(-0.1, -0.2, 0.3))));
  float wet = 0.04 + 0.3 * fresnel(max(dot(n, v), 0.0));
  return (inside.x * inside.y * vec3(1.6) + fill * vec3(0.06) + mirroredRoom(mirror, 0.1) * wet) * reach;
}
#endif
`;

export const KINDS = { other: 0, skin: 1, hair: 2, eye: 3, mouth: 4 };

const commonGlsl = /* glsl */ `
${lightGlsl}
uniform vec3 tint;
// With samples the middle of a point may lie outside a thin triangle, where what is interpolated is anything.
const float SHOWN = 0.4545; // the power by which light is shown: nearer to sRGB than the root
#if FINE
#define WITHIN centroid
#else
#define WITHIN
#endif
WITHIN varying vec2 surfaceUv;
#if FINE && KIND == 2 && defined(STORED)
// Layers of hair lie on each other, each no wider than some points: without a graphics processor they are lit at their vertices.
#define HAIR_LIT 1
WITHIN varying vec3 hairLight;
WITHIN varying float hairGloss;
#elif FINE || KIND == 3
#define FULL 1
WITHIN varying vec3 surfaceNormal;
WITHIN varying vec3 surfacePosition;
WITHIN varying vec4 surfaceLight; // open sky, key, fill and rim light: how much of each reaches it
#endif
#if KIND == 2 && FINE && !defined(HAIR_LIT)
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
#if !FINE && KIND == 1
uniform float roughness;
uniform float specular;
varying vec3 vertexGloss;
${shineGlsl}
#elif defined(HAIR_LIT)
uniform float specular;
${shineGlsl}
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
#elif defined(HAIR_LIT)
  vec4 shine = hairShine(n, normalize(cameraPosition - p), mat3(headTurn) * fibre, light);
  hairLight = diffuseLight(n, light) + shine.rgb;
  hairGloss = shine.a;
#elif FINE && KIND == 2
  surfaceFibre = mat3(headTurn) * fibre;
#endif
#if !FINE
  vertexLight = diffuseLight(n, light);
#if KIND == 1
  vertexGloss = pow(glossOf(n, normalize(cameraPosition - p), light, roughness) * specular * GLOSS, vec3(2.0 * SHOWN));
#endif
#if KIND != 3
  vertexLight = pow(vertexLight * tint, vec3(SHOWN)); // see main() of the fragments
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
#if FINE && KIND == 1
${lipsGlsl}
#endif
uniform float cutoff;   // discard what is less opaque
uniform float ceiling;  // discard what is not less opaque: it has been drawn
uniform float opaque;   // 1: what is left is opaque
uniform float fade;     // pixels from the lower border on, over which all vanishes
#if !FINE
varying vec3 vertexLight;
#endif
#if !FINE && KIND == 1
varying vec3 vertexGloss;
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

${shineGlsl}
#if !FINE && KIND != 3
/**
 * Colours are stored as about the root of what they are, and shown so: the root of (colour^2 * light) is colour * root of light
 * (see SHOWN). Bright tones are bent towards white.
 */
void main() {
  vec4 texel = texture2D(map, surfaceUv);
#ifdef HAS_ALPHA
  if (texel.a < max(cutoff, 0.01)) discard;
  texel.rgb /= texel.a;
#endif
  vec3 color = texel.rgb * vertexLight;
#if KIND == 1
  color = sqrt(color * color + vertexGloss * min(1.0, 16.0 * texel.g * texel.g)); // roots of hair do not shine, as in shineOf
#endif
  float peak = max(max(color.r, color.g), max(color.b, 0.855)); // as filmic() does, in shown tones
  float pressed = 1.0 - 0.021 / (peak - 0.71);
  color = mix(color * (pressed / peak), vec3(pressed), 0.4 * (peak - pressed));
  float shown = min(1.0, gl_FragCoord.y / fade);
  float alpha = max(texel.a, opaque) * shown * shown * (3.0 - 2.0 * shown);
  gl_FragColor = vec4(min(color, 1.0) * alpha, alpha);
}
#else
vec4 shaded(vec4 base) {
#ifdef HAIR_LIT
  vec3 color = base.rgb * hairLight + KEY_COLOR * hairGloss;
#else
  vec3 n = normalize(surfaceNormal);
#if defined(TWO_SIDES) && KIND != 2
  if (!gl_FrontFacing) n = -n;
#endif
  float lips = 0.0;
#if FINE && KIND == 1
  float deep = wrinkle(n);
  lips = lipsOf(base, restPlace);
  float pores = grained(n, restPlace - vec3(0.0, grainDown, 0.0), 1.0 - 0.7 * lips);
  if (lips > 0.0) base.rgb *= 1.0 - vec3(0.16, 0.22, 0.22) * furrowed(n, restPlace, lips);
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
  color += shineOf(n, v, base, reach, lips) * (1.0 - 0.7 * min(1.0, deep)); // a crease's sides shade each other
#elif KIND == 2
  vec4 shine = hairShine(n, v, surfaceFibre, reach);
  color += base.rgb * shine.rgb + KEY_COLOR * shine.a;
#elif KIND != 3
  color += shineOf(n, v, base, reach, lips);
#endif
#else
  vec3 color = base.rgb * vertexLight;
#endif
#if KIND == 3
  color *= lidShade(lidGap) * mix(vec3(0.7, 0.64, 0.62), vec3(1.0), smoothstep(0.3, 0.85, eyePlace.z)); // the ball goes back into the shade of the socket
  color += catchLight(n, v, min(1.0, 0.15 + reach.x * 1.6)) * smoothstep(-0.4, 1.2, lidGap.x);
  color += 0.16 * wetEdge(lidGap.y) * (room(vec3(0.0, 1.0, 0.0)) + KEY_COLOR * reach.y * max(0.0, dot(n, KEY_DIRECTION)));
#endif
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
