// SPDX-License-Identifier: MIT
// The deformation, in the vertex shader: see protocol/head-model.md and influences.mjs. A part without moves, turns of its own
// or vertices that turn with the head in part goes without their loops (MOVES, OWN_TURNS, PARTIAL_HEAD).

import { WHOLE_HEAD } from '../mesh/influences.mjs';

export const deformGlsl = /* glsl */ `
#ifdef SOFTWARE
// SOFTWARE 1: the CPU has moved the vertices (SoftwareDeform). 2: except for the turns of the head.
uniform mat4 headTurn;
void deform(inout vec3 p, inout vec3 n) {
#if SOFTWARE == 2
  p = (headTurn * vec4(p, 1.0)).xyz;
  n = mat3(headTurn) * n;
#endif
  n = normalize(n);
}
#else
attribute vec4 influence;
uniform highp sampler2D influences;
uniform float slots[SLOTS];
uniform vec3 turnPivot[TURNS];
uniform vec3 turnAxis[TURNS];
uniform float turnAngle[TURNS];
uniform mat4 headTurn;

vec4 influenceTexel(int i) {
  return texelFetch(influences, ivec2(i & 1023, i >> 10), 0);
}

vec3 turnBy(vec3 p, vec3 axis, float c, float s) {
  return p * c + cross(axis, p) * s + axis * (dot(axis, p) * (1.0 - c));
}

void deform(inout vec3 p, inout vec3 n) {
  vec3 shift = vec3(0.0), bend = vec3(0.0);
#if MOVES
  int first = int(influence.x), end = first + 2 * int(influence.y);
  for (int i = first; i < end; i += 2) {
    vec4 move = influenceTexel(i);
    float value = slots[int(move.x)];
    if (value != 0.0) {
      shift += value * move.yzw;
      bend += value * influenceTexel(i + 1).yzw;
    }
  }
#endif
  int counts = int(influence.w), turns = int(influence.z);
  int head = turns + (counts & 63), headTurns = counts >> 6;
#if OWN_TURNS
  for (int i = turns; i < head; i++) {
    vec2 turn = influenceTexel(i).xy;
    float angle = turnAngle[int(turn.x)] * turn.y;
    if (angle != 0.0) {
      float c = cos(angle), s = sin(angle);
      vec3 axis = turnAxis[int(turn.x)], arm = p - turnPivot[int(turn.x)];
      shift += turnBy(arm, axis, c, s) - arm;
      bend += turnBy(n, axis, c, s) - n;
    }
  }
#endif
  p += shift;
  n += bend;
  if (headTurns == ${WHOLE_HEAD}) {
    p = (headTurn * vec4(p, 1.0)).xyz;
    n = mat3(headTurn) * n;
    headTurns = 0;
  }
#if PARTIAL_HEAD
  for (int i = head; i < head + headTurns; i++) {
    vec2 turn = influenceTexel(i).xy;
    float angle = turnAngle[int(turn.x)] * turn.y;
    if (angle != 0.0) {
      float c = cos(angle), s = sin(angle);
      vec3 axis = turnAxis[int(turn.x)], pivot = turnPivot[int(turn.x)];
      p = pivot + turnBy(p - pivot, axis, c, s);
      n = turnBy(n, axis, c, s);
    }
  }
#endif
  n = normalize(n);
}
#endif
`;
