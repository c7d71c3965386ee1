// SPDX-License-Identifier: GPL-3.0-or-later
/** Value noise that is the same on every machine. */

function hash(x, y, z) {
  let h = Math.imul(x, 0x27d4eb2d) ^ Math.imul(y, 0x165667b1) ^ Math.imul(z, 0x9e3779b1);
  h = Math.imul(h ^ (h >>> 15), 0x85ebca6b);
  h = Math.imul(h ^ (h >>> 13), 0xc2b2ae35);
  return ((h ^ (h >>> 16)) >>> 0) / 4294967296;
}

/** Smooth noise of -1..1 with one feature per unit. */
export function noise(x, y, z = 0) {
  const ix = Math.floor(x),
    iy = Math.floor(y),
    iz = Math.floor(z);
  const u = fade(x - ix),
    v = fade(y - iy),
    w = fade(z - iz);
  const a = 1 - u,
    b = 1 - v,
    c = 1 - w;
  // Unrolled, because it is called about ten times per texel of a skin.
  let sum = hash(ix, iy, iz) * a * b * c;
  sum += hash(ix + 1, iy, iz) * u * b * c;
  sum += hash(ix, iy + 1, iz) * a * v * c;
  sum += hash(ix + 1, iy + 1, iz) * u * v * c;
  sum += hash(ix, iy, iz + 1) * a * b * w;
  sum += hash(ix + 1, iy, iz + 1) * u * b * w;
  sum += hash(ix, iy + 1, iz + 1) * a * v * w;
  sum += hash(ix + 1, iy + 1, iz + 1) * u * v * w;
  return sum * 2 - 1;
}

function fade(t) {
  return t * t * (3 - 2 * t);
}

/** Several octaves, each half as large and half as strong. */
export function fractal(x, y, z, octaves) {
  let sum = 0,
    strength = 0.5,
    scale = 1;
  for (let i = 0; i < octaves; i++) {
    sum += strength * noise(x * scale, y * scale, z * scale + i * 17);
    strength /= 2;
    scale *= 2;
  }
  return sum;
}
