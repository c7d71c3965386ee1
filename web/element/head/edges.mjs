// SPDX-License-Identifier: MIT
// Edges made soft after drawing, where no graphics processor draws: four samples for each point double what a picture takes
// there. Edges are found in the depth, so that nothing within a surface (pores, strands, the iris) is blurred. Along an edge,
// colours are mixed as in FXAA (Lottes, NVIDIA 2009): in the direction in which they change least.
import { DepthTexture, NoBlending, ShaderMaterial, UnsignedIntType, WebGLRenderTarget } from 'three';

const LEAP_MM = 0.8; // from one point to the next, beyond the slope of the surface: an edge

const fragment = /* glsl */ `
uniform sampler2D picture;
uniform highp sampler2D depth;
uniform float leap;
const vec4 TONE = vec4(0.25, 0.5, 0.1, 0.4); // colours come multiplied by alpha

float depthAt(ivec2 at) { return texelFetch(depth, at, 0).r; }
float toneAt(ivec2 at) { return dot(texelFetch(picture, at, 0), TONE); }

vec4 mixed(ivec2 at, ivec2 before, ivec2 after, ivec2 most, vec4 own) {
  float a = toneAt(before), b = toneAt(ivec2(after.x, before.y)), c = toneAt(ivec2(before.x, after.y)), d = toneAt(after);
  vec2 along = vec2(c + d - a - b, a + c - b - d);
  float least = min(abs(along.x), abs(along.y)) + max(0.03 * (a + b + c + d), 0.008);
  vec2 size = vec2(most + 1);
  along = clamp(along / least, -6.0, 6.0) / size;
  vec2 place = gl_FragCoord.xy / size;
  vec4 near = 0.5 * (texture2D(picture, place - along / 6.0) + texture2D(picture, place + along / 6.0));
  vec4 far = 0.5 * near + 0.25 * (texture2D(picture, place - 0.5 * along) + texture2D(picture, place + 0.5 * along));
  float tone = dot(far, TONE), mine = dot(own, TONE);
  bool beyond = tone < min(mine, min(min(a, b), min(c, d))) || tone > max(mine, max(max(a, b), max(c, d)));
  return beyond ? near : far;
}

bool leaps(float one, float other) { return one * other > 0.0 && min(abs(one), abs(other)) > leap; }

/** Halves and joins shapes and gaps that are one pixel wide, which would appear as dots. */
vec4 softened(vec4 sides, ivec2 at, ivec2 before, ivec2 after, ivec2 most, vec4 own) {
  bool thin = leaps(sides.x, sides.y);
  if (!thin && !leaps(sides.z, sides.w)) return mixed(at, before, after, most, own);
  ivec2 one = thin ? ivec2(before.x, at.y) : ivec2(at.x, before.y), other = thin ? ivec2(after.x, at.y) : ivec2(at.x, after.y);
  return 0.5 * own + 0.25 * (texelFetch(picture, one, 0) + texelFetch(picture, other, 0));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), most = textureSize(picture, 0) - 1;
  ivec2 before = max(at - 1, ivec2(0)), after = min(at + 1, most);
  vec4 sides = vec4(depthAt(ivec2(before.x, at.y)), depthAt(ivec2(after.x, at.y)),
    depthAt(ivec2(at.x, before.y)), depthAt(ivec2(at.x, after.y))) - depthAt(at);
  gl_FragColor = texelFetch(picture, at, 0);
  bool edge = max(abs(sides.x + sides.y), abs(sides.z + sides.w)) >= leap;
  if (edge) gl_FragColor = softened(sides, at, before, after, most, gl_FragColor);
}`;

/** Makes the material that draws a picture with soft edges. */
export function edgesMaterial() {
  return new ShaderMaterial({
    uniforms: { picture: { value: null }, depth: { value: null }, leap: { value: 1 } },
    vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: fragment,
    blending: NoBlending,
    depthTest: false,
    depthWrite: false,
  });
}

/** Makes the render target for the picture and its depth. */
export const edgesTarget = (width, height) =>
  new WebGLRenderTarget(width, height, { depthTexture: new DepthTexture(width, height, UnsignedIntType) });

/** LEAP_MM in the depths of a picture. @param {{near: number, far: number}} camera @param {number} distance of the face, mm */
export const leapOf = ({ near, far }, distance) => LEAP_MM / (distance * distance * (1 / near - 1 / far));
