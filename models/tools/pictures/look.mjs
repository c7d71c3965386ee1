// SPDX-License-Identifier: GPL-3.0-or-later
/** Measures a face in a photograph, in the frame of the set. */
import { align, upright } from '../../../web/portrait/align.mjs';
import { EYES } from '../../../web/portrait/landmarks.mjs';
import { evened, mapped, placed, refined, similarity } from './frame.mjs';

export const SIZE = { width: 480, height: 624 }; // of the whole face: the shape of the page's other faces
const EYES_AT = [SIZE.width / 2, 262]; // the middle between the eyes
const APART = 120; // from eye to eye
/** Landmarks that turn with the head but not with the mouth: eyes, nose, forehead. */
const UPPER = [33, 133, 362, 263, 168, 6, 197, 195, 4, 10, 9, 8, 151, 127, 356, 234, 454, 21, 251, 54, 284];
const ANCHORS = [61, 291, 0, 17, 152]; // 8.4, 8.3, 8.1, 8.2, 2.1
const PAIRS = [[33, 263], [133, 362], [234, 454], [127, 356]];

const middle = (points, which) => [0, 1].map((k) => which.reduce((sum, i) => sum + points[i][k], 0) / which.length);
const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const eyeMiddles = (points) => ['right', 'left'].map((side) => middle(points, [EYES[side].outer, EYES[side].inner]));

/** Maps the picture at rest to the frame: upright, with the eyes in the standard position. @param {number[][]} landmarks */
export function frameOf(landmarks) {
  const [right, left] = eyeMiddles(landmarks);
  const [x, y] = EYES_AT;
  return similarity([right, left], [[x - APART / 2, y], [x + APART / 2, y]], [0, 1]);
}

/** The part of the frame that speech does not move: from the brows to the middle of the nose. */
export const STILL = { x: EYES_AT[0] - APART, y: EYES_AT[1] - APART / 3, width: 2 * APART, height: Math.round(0.8 * APART) };

/** Returns how far the face is turned aside, from the depth of its left and right halves. */
function yawOf(landmarks) {
  const turns = PAIRS.map(([a, b]) => Math.atan2(landmarks[b][2] - landmarks[a][2], landmarks[b][0] - landmarks[a][0]));
  return turns.sort((a, b) => a - b)[turns.length >> 1];
}

/** Returns the lids' distance relative to the eye's width, averaged over both eyes. */
function lidsOf(points) {
  const one = ({ outer, inner, lower, upper }) => {
    const rows = lower.map((i, n) => apart(points[i], points[upper[n]]));
    return Math.max(...rows) / apart(points[outer], points[inner]);
  };
  return (one(EYES.right) + one(EYES.left)) / 2;
}

/** Returns the sharpness of the fixed part: differences between neighbouring pixels relative to its contrast. */
function sharpnessOf(still) {
  let sum = 0;
  const { width, height } = STILL;
  for (let y = 1; y < height - 1; y++)
    for (let x = 1; x < width - 1; x++) {
      const i = y * width + x;
      sum += (4 * still[i] - still[i - 1] - still[i + 1] - still[i - width] - still[i + width]) ** 2;
    }
  return Math.sqrt(sum / still.length);
}

/**
 * @param {{picture: object, landmarks: number[][]}} view
 * @param {object|null} rest measurements of the picture at rest; null: this is that picture
 */
export function seenIn({ picture, landmarks }, rest) {
  const first = frameOf(rest ? rest.found : landmarks);
  let onto = first;
  if (rest) onto = refined(picture, similarity(landmarks, rest.points), STILL, rest.still);
  const points = landmarks.map((point) => mapped(onto, point));
  const still = evened(placed(picture, onto, STILL));
  const turn = rest ? align(upright(landmarks), upright(rest.found), UPPER).turn : null;
  return {
    picture, onto, points, still, found: landmarks,
    enlarged: Math.hypot(onto.a, onto.b),
    turned: turn ? Math.hypot(turn[0][2], turn[1][2]) : Math.abs(yawOf(landmarks)),
    sharp: sharpnessOf(still),
    anchors: ANCHORS.map((i) => points[i]),
    gap: apart(points[13], points[14]),
    wide: apart(points[61], points[291]),
    lids: lidsOf(points),
  };
}

/** The face's measures in the frame, pixels. @param {object} rest */
export function measures({ points }) {
  const eyes = eyeMiddles(points);
  const [, nose] = points[2];
  const [, mouth] = middle(points, [13, 14]);
  const across = (side) => apart(points[EYES[side].iris[1]], points[EYES[side].iris[3]]);
  return {
    IRISD: (across('left') + across('right')) / 2,
    ES: apart(...eyes),
    ENS: nose - (eyes[0][1] + eyes[1][1]) / 2,
    MNS: mouth - nose,
    MW: apart(points[61], points[291]),
  };
}
