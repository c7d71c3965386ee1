// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Bones for a head: those of the neck, the head and the eyes move it; the others are there because avatars of VRM 1.0 have a body.
 * Places in metres, y up from the floor, z forward, x to its left.
 */

/** Height of the eyes, which are the head model's origin. */
export const EYE_HEIGHT = 1.55;

/** mm from the head's joint down to the neck's, where the neck bends. */
const NECK_MM = 85;

/** name, parent, position; bones of the left are mirrored on the right. */
const BODY = [
  ['hips', null, [0, 0.92, -0.06]],
  ['spine', 'hips', [0, 1.02, -0.06]],
  ['chest', 'spine', [0, 1.16, -0.06]],
  ['leftUpperArm', 'chest', [0.16, 1.32, -0.07]],
  ['leftLowerArm', 'leftUpperArm', [0.42, 1.32, -0.07]],
  ['leftHand', 'leftLowerArm', [0.66, 1.32, -0.07]],
  ['leftUpperLeg', 'hips', [0.09, 0.86, -0.06]],
  ['leftLowerLeg', 'leftUpperLeg', [0.09, 0.47, -0.06]],
  ['leftFoot', 'leftLowerLeg', [0.09, 0.08, -0.06]],
];

/** Converts mm of the head model to metres of the avatar. */
export const placed = ([x, y, z]) => [x / 1000, y / 1000 + EYE_HEIGHT, z / 1000];

/** @returns {{name: string, parent: string|null, at: number[]}[]} parents first */
export function bonesOf(head) {
  const pivot = (fap) => head.turns.find((turn) => turn.fap === fap).pivot;
  const [x, y, z] = pivot(48);
  const right = (name) => name?.replace(/^left/, 'right');
  const body = BODY.flatMap(([name, parent, at]) => [
    { name, parent, at },
    ...(name.startsWith('left') ? [{ name: right(name), parent: right(parent), at: [-at[0], at[1], at[2]] }] : []),
  ]);
  return [
    ...body,
    { name: 'neck', parent: 'chest', at: placed([x, y - NECK_MM, z]) },
    { name: 'head', parent: 'neck', at: placed([x, y, z]) },
    { name: 'leftEye', parent: 'head', at: placed(pivot(23)) },
    { name: 'rightEye', parent: 'head', at: placed(pivot(24)) },
  ];
}

/** The joints that move parts. */
export const JOINTS = ['neck', 'head', 'leftEye', 'rightEye'];

/** @returns {{joints: number[], weights: number[]}} four for each vertex, weights of 255 */
export function skinOf(head, part) {
  const count = part.position.length / 3;
  const eye = { eye_l: 2, eye_r: 3 }[part.name];
  const joints = [],
    weights = [];
  const share = new Float64Array(count);
  const names = head.turns.filter((turn) => turn.fap === 48).map((turn) => turn.name);
  for (const turn of part.turns.filter(({ turn: name }) => names.includes(name))) {
    if (turn.vertices) turn.vertices.forEach((v, i) => (share[v] = turn.weights[i]));
    else share.fill(turn.weight);
  }
  for (let v = 0; v < count; v++) {
    const whole = Math.round(255 * share[v]);
    if (eye) joints.push(eye, 0, 0, 0);
    else joints.push(whole ? 1 : 0, 0, 0, 0);
    weights.push(eye || whole === 0 || whole === 255 ? 255 : whole, eye || whole === 0 ? 0 : 255 - whole, 0, 0);
  }
  return { joints, weights };
}
