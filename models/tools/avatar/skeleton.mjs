// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Bones for a head, with Mixamo's names: those of the spine, the head and the eyes move it; the others, down to the fingers, are
 * there because avatars of VRM 1.0 have a body, and because programs for talking heads ask for all of them.
 * Places in metres, y up from the floor, z forward, x to its left.
 */

/** Height of the eyes, which are the head model's origin. */
export const EYE_HEIGHT = 1.55;

/** mm from the head's joint down to the neck's, where the neck bends. */
const NECK_MM = 85;

/** How limbs are turned in the world, as quaternions: along their y, as Mixamo has them. Other bones are not. */
const TURNS = [
  [/UpLeg$|Leg$/, [0, 0, 1, 0]],
  [/Foot$/, [0, Math.sin(0.55), Math.cos(0.55), 0]],
  [/ToeBase$/, [0, Math.sin(0.75), Math.cos(0.75), 0]],
  [/^Left(Shoulder|Arm|ForeArm|Hand)/, [0.5, 0.5, -0.5, 0.5]],
  [/^Right(Shoulder|Arm|ForeArm|Hand)/, [0.5, -0.5, 0.5, 0.5]],
];
export const turnOf = (name) => TURNS.find(([which]) => which.test(name ?? ''))?.[1] ?? [0, 0, 0, 1];

/** name, parent, position; bones of the left are mirrored on the right. */
const BODY = [
  ['Hips', null, [0, 0.98, -0.06]],
  ['Spine', 'Hips', [0, 1.08, -0.06]],
  ['Spine1', 'Spine', [0, 1.18, -0.06]],
  ['Spine2', 'Spine1', [0, 1.28, -0.06]],
  ['LeftShoulder', 'Spine2', [0.05, 1.34, -0.07]],
  ['LeftArm', 'LeftShoulder', [0.16, 1.32, -0.07]],
  ['LeftForeArm', 'LeftArm', [0.42, 1.32, -0.07]],
  ['LeftHand', 'LeftForeArm', [0.66, 1.32, -0.07]],
  ...['Thumb', 'Index', 'Middle', 'Ring', 'Pinky'].flatMap((finger, i) => [1, 2, 3].map((joint) => [
    `LeftHand${finger}${joint}`, joint === 1 ? 'LeftHand' : `LeftHand${finger}${joint - 1}`,
    [finger === 'Thumb' ? 0.67 + 0.03 * joint : 0.72 + 0.03 * joint, 1.32, -0.03 - 0.02 * i],
  ])),
  ['LeftUpLeg', 'Hips', [0.09, 0.92, -0.06]],
  ['LeftLeg', 'LeftUpLeg', [0.09, 0.5, -0.06]],
  ['LeftFoot', 'LeftLeg', [0.09, 0.08, -0.06]],
  ['LeftToeBase', 'LeftFoot', [0.09, 0.02, 0.06]],
];

/** VRM's names of these bones; those of the left stand for both sides. */
const HUMAN = {
  hips: 'Hips', spine: 'Spine', chest: 'Spine1', upperChest: 'Spine2', neck: 'Neck', head: 'Head', leftEye: 'LeftEye',
  leftShoulder: 'LeftShoulder', leftUpperArm: 'LeftArm', leftLowerArm: 'LeftForeArm', leftHand: 'LeftHand',
  leftUpperLeg: 'LeftUpLeg', leftLowerLeg: 'LeftLeg', leftFoot: 'LeftFoot', leftToes: 'LeftToeBase',
};

const right = (name) => name?.replace(/^left/, 'right').replace(/^Left/, 'Right');

/** @param {Record<string, number>} nodes by the bones' names @returns {Record<string, number>} by VRM's */
export const humanBones = (nodes) => Object.fromEntries(Object.entries(HUMAN).flatMap(([human, bone]) => [
  [human, nodes[bone]], ...(human.startsWith('left') ? [[right(human), nodes[right(bone)]]] : []),
]));

/** Converts mm of the head model to metres of the avatar. */
export const placed = ([x, y, z]) => [x / 1000, y / 1000 + EYE_HEIGHT, z / 1000];

/** @returns {{name: string, parent: string|null, at: number[]}[]} parents first */
export function bonesOf(head) {
  const pivot = (fap) => head.turns.find((turn) => turn.fap === fap).pivot;
  const [x, y, z] = pivot(48);
  const body = BODY.flatMap(([name, parent, at]) => [
    { name, parent, at },
    ...(name.startsWith('Left') ? [{ name: right(name), parent: right(parent), at: [-at[0], at[1], at[2]] }] : []),
  ]);
  return [
    ...body,
    { name: 'Neck', parent: 'Spine2', at: placed([x, y - NECK_MM, z]) },
    { name: 'Head', parent: 'Neck', at: placed([x, y, z]) },
    { name: 'LeftEye', parent: 'Head', at: placed(pivot(23)) },
    { name: 'RightEye', parent: 'Head', at: placed(pivot(24)) },
  ];
}

/** The joints that move parts: shoulders stay when the neck bends. */
export const JOINTS = ['Spine2', 'Head', 'LeftEye', 'RightEye'];

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
