// SPDX-License-Identifier: MIT

/**
 * Makes the alpha mask of a region: 1 within the inner contour, 0 outside the outer one, graded by the distances to both
 * between them (Costa 2009, section 4.4.3).
 * @param {{width: number, height: number, mask: {inner: number[][], outer: number[][]}}} region
 * @returns {Float32Array} by pixel
 */
export function maskOf({ width, height, mask: { inner, outer } }) {
  const out = new Float32Array(width * height);
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) {
      if (!within(outer, x, y)) continue;
      if (within(inner, x, y)) out[y * width + x] = 1;
      else {
        const [far, near] = [away(outer, x, y), away(inner, x, y)];
        out[y * width + x] = far / (far + near || 1);
      }
    }
  return out;
}

function within(contour, x, y) {
  let inside = false;
  for (let i = 0, j = contour.length - 1; i < contour.length; j = i++) {
    const [[ax, ay], [bx, by]] = [contour[i], contour[j]];
    if (ay > y !== by > y && x < ax + ((y - ay) * (bx - ax)) / (by - ay)) inside = !inside;
  }
  return inside;
}

/** The distance to a contour. */
function away(contour, x, y) {
  let least = Infinity;
  for (let i = 0, j = contour.length - 1; i < contour.length; j = i++) {
    const [[ax, ay], [bx, by]] = [contour[i], contour[j]];
    const [dx, dy] = [bx - ax, by - ay];
    const t = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
    least = Math.min(least, (x - ax - t * dx) ** 2 + (y - ay - t * dy) ** 2);
  }
  return Math.sqrt(least);
}
