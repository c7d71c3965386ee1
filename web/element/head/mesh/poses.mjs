// SPDX-License-Identifier: MIT
// Poses in which light, visibility and simplification are computed before a head is drawn.
import { faceValues } from '../../face/face-mixer.mjs';

/** The pose that casts shadows: speaking, so that light falls between the lips. */
export const SHADOW_POSE = faceValues({
  3: 350, 4: -150, 5: -450, 8: -150, 9: -150, 10: -400, 11: -400, 51: -150, 52: -450, 55: -150, 56: -150, 57: -400, 58: -400,
});

/** The pose that receives light: the same with closed lids, whose folded skin would stay dark otherwise. */
export const LIT_POSE = faceValues({ ...SHADOW_POSE, 19: 800, 20: 800, 21: 150, 22: 150 });

/** Poses that fewer triangles have to be right in: at rest, open with the lids down, and with all that bends the skin most. */
export const SIMPLIFY_POSES = [
  faceValues({}),
  LIT_POSE,
  faceValues({
    4: 150, 5: 150, 6: -150, 7: -150, 16: 250, 17: 250, 31: 200, 32: 200, 33: 200, 34: 200, 35: 150, 36: 150, 44: 300,
  }),
  faceValues({ 6: 200, 7: 200, 12: 200, 13: 200, 37: 150, 38: 150, 41: 200, 42: 200, 19: 300, 20: 300, 59: 200, 60: 200 }),
];
