// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Computes the six articulatory parameters in mm from eight markers on a face (Leone, "LUCIA-WebGL", appendix 4.1.2): distances from the plane
 * through the tip of the nose and both ear lobes, so that the head may move. Protrusion is measured forward along that plane, because the
 * distance from the ears would also grow with an opening mouth.
 */

/** In the order of the thesis. */
export const MARKERS = ['nose', 'upperLip', 'leftCorner', 'rightCorner', 'lowerLip', 'chin', 'leftEar', 'rightEar'];
export const PARAMETERS = ['LI', 'LS', 'AR', 'PI', 'PS', 'EM'];

const sub = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => {
  const length = Math.hypot(...a);
  return length > 1e-6 ? a.map((x) => x / length) : null;
};

/**
 * @param {number[][]} places of MARKERS, mm
 * @param {number} [tilt] rad: inclination of that plane towards the nose when the person looks ahead; 0: uses the plane itself, as in the thesis
 *   @returns {number[]|null} values of PARAMETERS in mm, not relative to rest; null: the plane is unknown
 */
export function articulation([nose, upper, left, right, lower, chin, leftEar, rightEar], tilt = 0) {
  const across = unit(sub(leftEar, rightEar));
  const normal = across && unit(cross(sub(nose, rightEar), across));
  if (!normal) return null;
  const forward = unit(sub(sub(nose, rightEar), across.map((x) => x * dot(sub(nose, rightEar), across))));
  const side = Math.sign(dot(sub(chin, nose), normal)) || 1;
  const [c, s] = [Math.cos(tilt), Math.sin(tilt)];
  const place = (p) => [side * dot(sub(p, nose), normal), dot(sub(p, nose), forward)];
  const below = (p) => c * place(p)[0] + s * place(p)[1];
  const ahead = (p) => c * place(p)[1] - s * place(p)[0];
  return [below(lower), -below(upper), Math.hypot(...sub(left, right)), ahead(lower), ahead(upper), below(chin)];
}
