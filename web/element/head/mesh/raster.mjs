// SPDX-License-Identifier: MIT

/**
 * The points of a picture whose middle lies in a triangle.
 * @param {Float32Array} points (column, row, height), flat
 * @param {number} a @param {number} b @param {number} c where its corners begin in them
 * @param {number} width @param {number} height of the picture
 * @param {(at: number, depth: number, wb: number, wc: number) => boolean|void} visit each point, with its height and the
 *   shares of the second and third corner; true: no more of them
 */
export function scan(points, a, b, c, width, height, visit) {
  const [ax, ay, bx, by, cx, cy] = [points[a], points[a + 1], points[b], points[b + 1], points[c], points[c + 1]];
  const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  if (!area) return;
  const left = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5));
  const right = Math.min(width - 1, Math.floor(Math.max(ax, bx, cx) - 0.5));
  const low = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
  const high = Math.min(height - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
  for (let y = low; y <= high; y++)
    for (let x = left; x <= right; x++) {
      const [px, py] = [x + 0.5, y + 0.5];
      const wb = ((px - ax) * (cy - ay) - (py - ay) * (cx - ax)) / area;
      const wc = ((bx - ax) * (py - ay) - (by - ay) * (px - ax)) / area;
      if (wb < 0 || wc < 0 || wb + wc > 1) continue;
      const depth = points[a + 2] + wb * (points[b + 2] - points[a + 2]) + wc * (points[c + 2] - points[a + 2]);
      if (visit(y * width + x, depth, wb, wc)) return;
    }
}
