// SPDX-License-Identifier: MIT
// The landmarks of a face as the detector numbers them: 468 of the canonical face mesh, and five for each iris. Left and right
// are the face's own.

export const COUNT = 478;

const list = (text) => text.split(' ').map(Number);

/** Round the face, from the forehead's middle over the left side. */
export const OVAL = list('10 338 297 332 284 251 389 356 454 323 361 288 397 365 379 378 400 377 152 148 176 149 150 136 172 58 132 93 234 127 162 21 54 103 67 109');

/** Rings of the lips from outside to inside, from the right corner to the left one without the corners. */
export const UPPER_LIP = ['185 40 39 37 0 267 269 270 409', '184 74 73 72 11 302 303 304 408', '183 42 41 38 12 268 271 272 407', '191 80 81 82 13 312 311 310 415'].map(list);
export const LOWER_LIP = ['146 91 181 84 17 314 405 321 375', '77 90 180 85 16 315 404 320 307', '96 89 179 86 15 316 403 319 325', '95 88 178 87 14 317 402 318 324'].map(list);
export const LIP_CORNERS = { right: list('61 76 62 78'), left: list('291 306 292 308') };

/** Margins of the lids, from the outer corner below to the inner one and back above. */
export const EYES = {
  right: { outer: 33, inner: 133, lower: list('7 163 144 145 153 154 155'), upper: list('246 161 160 159 158 157 173'), iris: list('468 469 470 471 472') },
  left: { outer: 263, inner: 362, lower: list('249 390 373 374 380 381 382'), upper: list('466 388 387 386 385 384 398'), iris: list('473 474 475 476 477') },
};

export const BROWS = { right: list('70 63 105 66 107 46 53 52 65 55'), left: list('300 293 334 296 336 276 283 282 295 285') };

/** On even skin: cheeks, and the forehead. */
export const SKIN = list('50 101 118 117 123 187 205 280 330 347 346 352 411 425 151 9 108 337 69 299');

const MOVING = new Set([
  ...UPPER_LIP.flat(), ...LOWER_LIP.flat(), ...Object.values(LIP_CORNERS).flat(), ...Object.values(BROWS).flat(),
  ...Object.values(EYES).flatMap(({ lower, upper, iris }) => [...lower, ...upper, ...iris]),
]);
/** Landmarks that expressions hardly move: they align faces. */
export const STEADY = Array.from({ length: 468 }, (_, i) => i).filter((i) => !MOVING.has(i));

/** Those that a person sees and may move, with the feature point of MPEG-4 that each stands for where there is one. */
export const HANDLES = [
  { name: 'forehead', at: 10, fdp: '11.1' }, { name: 'chin', at: 152, fdp: '2.1' },
  { name: 'cheekRight', at: 234, fdp: '10.8' }, { name: 'cheekLeft', at: 454, fdp: '10.7' },
  { name: 'jawRight', at: 172, fdp: '2.14' }, { name: 'jawLeft', at: 397, fdp: '2.13' },
  { name: 'browOuterRight', at: 70, fdp: '4.6' }, { name: 'browMiddleRight', at: 105, fdp: '4.4' }, { name: 'browInnerRight', at: 107, fdp: '4.2' },
  { name: 'browInnerLeft', at: 336, fdp: '4.1' }, { name: 'browMiddleLeft', at: 334, fdp: '4.3' }, { name: 'browOuterLeft', at: 300, fdp: '4.5' },
  { name: 'eyeOuterRight', at: 33, fdp: '3.12' }, { name: 'lidUpperRight', at: 159, fdp: '3.2' }, { name: 'lidLowerRight', at: 145, fdp: '3.4' }, { name: 'eyeInnerRight', at: 133, fdp: '3.8' },
  { name: 'eyeInnerLeft', at: 362, fdp: '3.11' }, { name: 'lidUpperLeft', at: 386, fdp: '3.1' }, { name: 'lidLowerLeft', at: 374, fdp: '3.3' }, { name: 'eyeOuterLeft', at: 263, fdp: '3.7' },
  { name: 'noseBridge', at: 168, fdp: '9.12' }, { name: 'noseTip', at: 1, fdp: '9.3' }, { name: 'noseBase', at: 2, fdp: '9.15' },
  { name: 'noseRight', at: 129, fdp: '9.2' }, { name: 'noseLeft', at: 358, fdp: '9.1' },
  { name: 'mouthRight', at: 61, fdp: '8.4' }, { name: 'mouthLeft', at: 291, fdp: '8.3' }, { name: 'lipUpper', at: 0, fdp: '8.1' }, { name: 'lipLower', at: 17, fdp: '8.2' },
  { name: 'lipsInnerUpper', at: 13, fdp: '2.2' }, { name: 'lipsInnerLower', at: 14, fdp: '2.3' },
];

/**
 * Moves landmarks by hand; their neighbours follow, less with distance.
 * @param {number[][]} points @param {Map<number, number[]>} moved landmark -> its new position (columns and rows)
 */
export function withMoved(points, moved) {
  const size = Math.hypot(points[10][0] - points[152][0], points[10][1] - points[152][1]);
  const reach = size * 0.14;
  const shifts = [...moved].map(([at, place]) => [at, place[0] - points[at][0], place[1] - points[at][1]]);
  return points.map((point, i) => {
    if (moved.has(i)) return [...moved.get(i).slice(0, 2), point[2]];
    let [x, y, sum] = [0, 0, 0];
    for (const [at, dx, dy] of shifts) {
      const near = Math.max(0, 1 - Math.hypot(point[0] - points[at][0], point[1] - points[at][1]) / reach) ** 2;
      x += near * dx;
      y += near * dy;
      sum += near;
    }
    const share = Math.max(1, sum);
    return [point[0] + x / share, point[1] + y / share, point[2]];
  });
}
