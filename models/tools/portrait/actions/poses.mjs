// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Poses by which somebody's own ways of moving are told: those of Leone's thesis ("LUCIA-WebGL", 3.3) that say something, and some more. Of each what
 * moves in it, of the unknowns in model.mjs; what it is in FAPs, up to how strong it is, as the program asks for it (models/expressions.json, ../../../pictures/poses.json);
 * and what the person is asked to do.
 */
import fs from 'node:fs';

const { poses } = JSON.parse(fs.readFileSync(new URL('../../../pictures/poses.json', import.meta.url), 'utf8'));
const viseme = (wanted) => poses.find(({ name }) => name === wanted).faps;
const all = (list, value) => Object.fromEntries(list.map((fap) => [fap, value]));
const [UPPER, LOWER, WIDE, UP] = [[4, 8, 9, 51, 55, 56], [5, 10, 11, 52, 57, 58], [6, 7, 53, 54], [12, 13, 59, 60]];

const BROWS = ['browInnerLeft', 'browInnerRight', 'browMiddleLeft', 'browMiddleRight', 'browOuterLeft', 'browOuterRight'];
const SQUEEZE = ['squeezeLeft', 'squeezeRight'];
const CORNERS = ['cornerLeft', 'cornerRight', 'aside'];
const CHEEKS = ['cheekLeft', 'cheekRight'];
const NOSE = ['nostrilLeft', 'nostrilRight', 'noseUp'];
const LIPS = ['LI', 'LS', 'AR', 'PI', 'PS', 'thinUpper', 'thinLower'];
const OPEN = [...LIPS, 'EM', ...CORNERS];

export const POSES = {
  'brows-up': { moves: [...BROWS, ...SQUEEZE], faps: { ...all([31, 32], 110), ...all([33, 34], 130), ...all([35, 36], 90) }, ask: 'brows as high as they go' },
  'brows-down': { moves: [...BROWS, ...SQUEEZE], faps: { ...all([31, 32], -95), ...all([33, 34], -70), ...all([35, 36], -25), ...all([37, 38], 45) }, ask: 'brows down and together' },
  sneer: { moves: [...BROWS, ...SQUEEZE, ...NOSE, ...CHEEKS, ...CORNERS, ...LIPS], faps: { ...all(UPPER, -150), ...all([61, 62], 40), 63: 60, ...all([41, 42], 150), ...all([31, 32], -60) }, ask: 'nose wrinkled, upper lip up' },
  smile: { moves: [...CORNERS, ...CHEEKS, ...LIPS], faps: { ...all(UP, 360), ...all(WIDE, 150), ...all([41, 42], 230) }, ask: 'a broad smile, lips closed' },
  laugh: { moves: [...OPEN, ...CHEEKS], faps: { ...viseme('joy'), ...all([41, 42], 230) }, ask: 'a broad smile that shows the teeth' },
  sad: { moves: [...CORNERS, ...BROWS, ...SQUEEZE, ...LIPS], faps: { ...all(UP, -210), ...all([31, 32], 300), ...all([33, 34], 60), ...all([35, 36], -110), ...all([37, 38], 40) }, ask: 'corners of the mouth down, inner ends of the brows up' },
  'mouth-left': { moves: [...CORNERS, ...LIPS], faps: { ...all([6, 53], 150), ...all([7, 54], -150) }, ask: 'the closed mouth to your left' },
  'mouth-right': { moves: [...CORNERS, ...LIPS], faps: { ...all([6, 53], -150), ...all([7, 54], 150) }, ask: 'the closed mouth to your right' },
  open: { moves: OPEN, faps: viseme('surprise'), ask: 'the mouth wide open' },
  funnel: { moves: OPEN, faps: viseme('o'), ask: 'a long O' },
  kiss: { moves: [...LIPS, ...CORNERS], faps: { ...all(WIDE, -140), 16: 170, 17: 220 }, ask: 'a kiss' },
  teeth: { moves: [...LIPS, ...CORNERS, ...CHEEKS], faps: { ...all(UPPER, -200), ...all(LOWER, -180), ...all(WIDE, 90) }, ask: 'teeth together and bared' },
  dimple: { moves: [...LIPS, ...CORNERS], faps: all(WIDE, 150), ask: 'lips closed and drawn aside' },
  m: { moves: [...LIPS, ...CORNERS], faps: viseme('p1'), ask: 'lips pressed, as for M' },
  a: { moves: OPEN, faps: viseme('a'), ask: 'a long A' },
  e: { moves: OPEN, faps: viseme('e'), ask: 'a long E' },
  i: { moves: OPEN, faps: viseme('i1'), ask: 'a long I' },
  u: { moves: OPEN, faps: viseme('u'), ask: 'a long U' },
  f: { moves: OPEN, faps: viseme('f1'), ask: 'a long F' },
};
const KEPT = "jaw and the middle of the lips keep the base's way";
/** Of the thesis, too, and why they are not taken. */
export const LEFT_OUT = {
  puff: 'the front does not show cheeks that come forward', 'jaw-front': 'the front does not show a jaw that comes forward', 'lip-down': KEPT, 'jaw-left': KEPT, 'jaw-right': KEPT, chew: KEPT,
};
