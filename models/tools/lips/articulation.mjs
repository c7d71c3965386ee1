// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Computes the articulatory parameters in mm from eight markers on a face (Leone, "LUCIA-WebGL", 4.1.2): distances from the plane
 * through the tip of the nose and both ear lobes, so that the head may move. Protrusion is measured forward along that plane, because the
 * distance from the ears would also grow with an opening mouth.
 */

/** In the order of the thesis. */
export const MARKERS = ['nose', 'upperLip', 'leftCorner', 'rightCorner', 'lowerLip', 'chin', 'leftEar', 'rightEar'];
export const PARAMETERS = ['LI', 'LS', 'AR', 'PI', 'PS', 'EM'];
/** The other four of the thesis: opening of lips and jaw, half widths to the left and right. */
export const FURTHER = ['AL', 'AM', 'EAS', 'EAD'];

const sub = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => {
  const length = Math.hypot(...a);
  return length > 1e-6 ? a.map((x) => x / length) : null;
};

/**
 * @param {(number[]|null)[]} places of MARKERS, mm; null: not seen
 * @param {number} [tilt] rad: inclination of that plane towards the nose when the person looks ahead; 0: uses the plane itself, as in the thesis
 * @returns {number[]|null} values of PARAMETERS and FURTHER in mm, not relative to rest; NaN where a marker is not seen; null: the plane is unknown
 */
export function articulation([nose, upper, left, right, lower, chin, leftEar, rightEar], tilt = 0) {
  if (!nose || !leftEar || !rightEar) return null;
  const across = unit(sub(leftEar, rightEar));
  const normal = across && unit(cross(sub(nose, rightEar), across));
  if (!normal) return null;
  const forward = unit(sub(sub(nose, rightEar), across.map((x) => x * dot(sub(nose, rightEar), across))));
  const lowest = chin ?? lower ?? upper ?? left ?? right;
  const side = (lowest && Math.sign(dot(sub(lowest, nose), normal))) || 1;
  const [c, s] = [Math.cos(tilt), Math.sin(tilt)];
  const place = (p) => [side * dot(sub(p, nose), normal), dot(sub(p, nose), forward)];
  const below = (p) => (p ? c * place(p)[0] + s * place(p)[1] : NaN);
  const ahead = (p) => (p ? c * place(p)[1] - s * place(p)[0] : NaN);
  const apart = (p, q) => (p && q ? Math.hypot(...sub(p, q)) : NaN);
  const aside = (p) => (p ? Math.abs(dot(sub(p, nose), across)) : NaN);
  return [below(lower), -below(upper), apart(left, right), ahead(lower), ahead(upper), below(chin), apart(upper, lower), apart(nose, chin), aside(left), aside(right)];
}
