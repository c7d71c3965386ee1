// SPDX-License-Identifier: MIT
// What a surface mirrors of the lamps and the room: skin, hair, eyes. KIND and FINE: see shader-surface.mjs.

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
  rough = mix(rough, 0.34, lipsOf(base)); // lips are moist
#endif
  float shine = 0.75 * highlight(n, v, KEY_DIRECTION, rough) + 0.25 * highlight(n, v, KEY_DIRECTION, rough * 0.75);
  color = KEY_COLOR * shine * (f0 + rim * 0.4) * reach.y;
  color += FILL_COLOR * highlight(n, v, FILL_DIRECTION, rough) * (f0 + rim * 0.4) * reach.z;
  color += RIM_COLOR * highlight(n, v, RIM_DIRECTION, rough) * (f0 + rim * 0.3) * reach.w;
  vec3 mirror = reflect(-v, n);
  color += mix(GROUND, SKY, 0.5 + 0.5 * mirror.y) * (f0 + rim * 0.25) * reach.x * reach.x * 0.6;
  color *= specular * 2.6;
#if KIND == 1
  color *= smoothstep(0.004, 0.02, dot(base.rgb, vec3(0.3, 0.6, 0.1))); // roots of hair are painted on skin, and are no skin
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
