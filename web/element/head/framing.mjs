// SPDX-License-Identifier: MIT

const FACE_ASPECT = 0.78; // of the portrait: narrower places see it from farther away
const MOUTH_WIDTHS = 2.1; // in the picture, of the view `mouth`
const FACE_MORE = 1.22; // room round what lies between hair line and chin, in the view `face`
const BUST_FARTHER = 1.3; // than the portrait, of a head without a body
const BODY = { // of the views that show the body of a head which has one
  portrait: { farther: 1.03, aspect: FACE_ASPECT },
  bust: { farther: 1.62, aspect: 0.6 }, // both shoulders, but for phones
};
const EYES = 0.36; // of the picture's height: from its upper border to the eyes, where there is room
const HEADROOM = 0.08; // of what a picture is higher than the portrait, added above the hair
const BEHIND = 205; // mm from the eyes to the farther arm of a head that is turned: there the picture reaches farther down,
const ABOVE = Math.PI / 18; // and when the head is seen from above, at most at this angle (orbit.mjs)
const HALF_TURN = Math.PI / 180 / 2;

const middle = (a, b) => a.map((value, k) => (value + b[k]) / 2);

/**
 * Places the camera: its target and distance.
 * @param {{view: {target: number[], distance: number, fov: number, bottom?: number}, fdp: Record<string, number[]>,
 *   fapu: Record<string, number>}} model
 * @param {string|null} name `mouth` for lip readers, `face`, `bust`; else the portrait that the model asks for
 * @param {number} aspect width by height of the place
 * @returns {{target: number[], distance: number, fov: number}}
 */
export function framed({ view, fdp, fapu }, name, aspect) {
  const { target, distance, fov } = view;
  const tangent = Math.tan(fov * HALF_TURN);
  const fit = Math.max(1, FACE_ASPECT / aspect);
  const [upper, lower, chin] = [fdp['2.2'], fdp['2.3'], fdp['2.1']];
  if (name === 'mouth' && upper && lower && fapu.MW) {
    const at = middle(upper, lower);
    const height = MOUTH_WIDTHS * fapu.MW;
    return { target: [0, at[1] - height * 0.06, at[2]], distance: (height / 2 / tangent) * Math.max(1, 1 / aspect), fov };
  }
  if (name === 'face' && chin) {
    const height = -chin[1] * 2 * FACE_MORE;
    return { target: [0, chin[1] * 0.06, 0], distance: chin[2] + (height / 2 / tangent) * Math.max(1, 0.72 / aspect), fov };
  }
  if (view.bottom !== undefined) return withBody(view, name === 'bust' ? BODY.bust : BODY.portrait, aspect);
  if (name === 'bust') return { target: [target[0], target[1] - distance * 0.055, target[2]], distance: distance * BUST_FARTHER * fit, fov };
  return { target, distance: distance * fit, fov };
}

/**
 * As in a portrait photograph: the eyes in the upper third or as high as the hair lets them be, and the body goes out of the
 * picture.
 */
function withBody({ target, distance, fov, bottom }, { farther, aspect: least }, aspect) {
  const tangent = Math.tan(fov * HALF_TURN);
  const away = distance * farther * Math.max(1, least / aspect);
  const [portrait, height] = [distance, away].map((far) => 2 * far * tangent);
  const hair = portrait / 2 + target[1];
  const above = Math.max(hair + HEADROOM * (height - portrait), EYES * height);
  // How far below the middle the lower border of the picture meets the body there.
  const [cos, sin] = [Math.cos(ABOVE), Math.sin(ABOVE)];
  const reach = (tangent * (away + BEHIND * cos) + BEHIND * sin) / (cos - tangent * sin);
  return { target: [target[0], Math.max(above - height / 2, bottom + reach), target[2]], distance: away, fov };
}
