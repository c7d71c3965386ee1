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

/** Of each landmark but the irises' its like on the other side, or itself in the middle (the detector's mesh is symmetric). */
export const OPPOSITE = list(`
  0 1 2 248 4 5 6 249 8 9 10 11 12 13 14 15 16 17 18 19 250 251 252 253 254 255 256 257 258 259 260 261 262 263 264 265 266
  267 268 269 270 271 272 273 274 275 276 277 278 279 280 281 282 283 284 285 286 287 288 289 290 291 292 293 294 295 296
  297 298 299 300 301 302 303 304 305 306 307 308 309 310 311 312 313 314 315 316 317 318 319 320 321 322 323 94 324 325
  326 327 328 329 330 331 332 333 334 335 336 337 338 339 340 341 342 343 344 345 346 347 348 349 350 351 352 353 354 355
  356 357 358 359 360 361 362 363 364 365 366 367 368 369 370 371 372 373 374 375 376 377 378 379 151 152 380 381 382 383
  384 385 386 387 388 389 390 164 391 392 393 168 394 395 396 397 398 399 175 400 401 402 403 404 405 406 407 408 409 410
  411 412 413 414 415 416 417 418 195 419 197 420 199 200 421 422 423 424 425 426 427 428 429 430 431 432 433 434 435 436
  437 438 439 440 441 442 443 444 445 446 447 448 449 450 451 452 453 454 455 456 457 458 459 460 461 462 463 464 465 466
  467 3 7 20 21 22 23 24 25 26 27 28 29 30 31 32 33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57
  58 59 60 61 62 63 64 65 66 67 68 69 70 71 72 73 74 75 76 77 78 79 80 81 82 83 84 85 86 87 88 89 90 91 92 93 95 96 97 98
  99 100 101 102 103 104 105 106 107 108 109 110 111 112 113 114 115 116 117 118 119 120 121 122 123 124 125 126 127 128
  129 130 131 132 133 134 135 136 137 138 139 140 141 142 143 144 145 146 147 148 149 150 153 154 155 156 157 158 159 160
  161 162 163 165 166 167 169 170 171 172 173 174 176 177 178 179 180 181 182 183 184 185 186 187 188 189 190 191 192 193
  194 196 198 201 202 203 204 205 206 207 208 209 210 211 212 213 214 215 216 217 218 219 220 221 222 223 224 225 226 227
  228 229 230 231 232 233 234 235 236 237 238 239 240 241 242 243 244 245 246 247`.trim().replaceAll(/\s+/g, ' '));

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
