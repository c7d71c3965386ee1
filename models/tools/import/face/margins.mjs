// SPDX-License-Identifier: GPL-3.0-or-later
/** Finds edges between surfaces, seen from the front: the line between the lips, and the margins of the lids. */

const WALK = 0.07; // of the eye distance: points farther apart along the skin are on different lips
const BESIDE = 4; // pixels from the line that are certainly on the lip
const LOOSE = 0.6; // vertices for each corner of a triangle: hardly any is shared
const DEEP = 0.25; // of the eye distance behind the lips: the inside of the head, seen between them
const LOST = 4; // columns without a line that mark the mouth corner
const FORE = 0.25; // of the eyeball's radius in front of its centre, where lids begin
const NEAR = 0.35; // of the eyeball's radius, to each side of its middle

/** Numbers of a mesh's vertices: the file's own, so that touching lips are not welded; by place where triangles share none, as in flat shading. */
function numbered({ position, index }) {
  if (position.length / 3 < LOOSE * index.length) return index;
  const known = new Map();
  return index.map((v) => {
    const key = `${position[3 * v]},${position[3 * v + 1]},${position[3 * v + 2]}`;
    return known.get(key) ?? known.set(key, v).get(key);
  });
}

/** Prepares searches along the edges of a mesh within `reach`. */
function walker(mesh, reach) {
  const { position } = mesh;
  const index = numbered(mesh);
  const near = new Map();
  for (let t = 0; t < index.length; t += 3)
    for (let i = 0; i < 3; i++) {
      const [a, b] = [index[t + i], index[t + ((i + 1) % 3)]];
      for (const [from, to] of [[a, b], [b, a]]) (near.get(from) ?? near.set(from, new Set()).get(from)).add(to);
    }
  return { near, position, index, reach };
}

/** Tells whether two triangles are connected along the skin. */
function joined({ near, position, index, reach }, from, to) {
  const corners = (t) => [index[3 * t], index[3 * t + 1], index[3 * t + 2]];
  const goal = new Set(corners(to));
  const way = new Map(corners(from).map((v) => [v, 0]));
  let front = [...way.keys()];
  while (front.length) {
    const next = [];
    for (const v of front) {
      if (goal.has(v)) return true;
      for (const w of near.get(v) ?? []) {
        const far = way.get(v) + Math.hypot(position[3 * v] - position[3 * w], position[3 * v + 1] - position[3 * w + 1], position[3 * v + 2] - position[3 * w + 2]);
        if (far > reach || far >= (way.get(w) ?? Infinity)) continue;
        way.set(w, far);
        next.push(w);
      }
    }
    front = next;
  }
  return false;
}

/**
 * Finds the lips' line, column by column.
 * @param {object} view of the skin and what is in the mouth @param {number} skin which of its meshes
 * @param {object} mesh that one @param {number[][]} landmarks on the picture @param {number} apart the eyes' distance in the file's units
 * @returns {{column: number, upper: number[], lower: number[], upperEnd: number[], lowerEnd: number[], inUpper: number[], inLower: number[]}[]} on the line, the vertex next to it on each lip, and a little within each lip; from the head's right to its left; none: the lips are one surface
 */
export function lipLine(view, skin, mesh, landmarks, apart) {
  const skinOf = walker(mesh, WALK * apart);
  const [right, left] = [landmarks[61][0], landmarks[291][0]];
  const [high, low] = [landmarks[0][1], landmarks[17][1]];
  const wide = left - right;
  const rowsOf = (column) => {
    const share = Math.abs((column - (left + right) / 2) / (wide / 2));
    const corner = (landmarks[61][1] + landmarks[291][1]) / 2;
    const fade = Math.max(0, 1 - share ** 2);
    return [corner + (high - corner) * fade - 0.06 * wide, corner + (low - corner) * fade + 0.06 * wide];
  };
  const within = (column, row, way) => {
    const there = view.at(column, row + way * BESIDE);
    return there?.mesh === skin ? there.point : view.at(column, row).point;
  };
  const corner = ({ triangle, point }) => {
    const { position, index } = mesh;
    const corners = [0, 1, 2].map((k) => [0, 1, 2].map((i) => position[3 * index[3 * triangle + k] + i]));
    const far = (p) => Math.hypot(...p.map((x, k) => x - point[k]));
    return corners.reduce((best, p) => (far(p) < far(best) ? p : best));
  };
  const expected = (landmarks[13][1] + landmarks[14][1]) / 2;
  const at = (column) => {
    const [from, to] = rowsOf(column).map(Math.round);
    const hits = Array.from({ length: Math.max(0, to - from + 1) }, (_, i) => ({ row: from + i, ...view.at(column, from + i) })).filter((hit) => hit.mesh === skin);
    const deepest = Math.max(...hits.map(({ point }) => point[2])) - DEEP * apart;
    let [best, before] = [null, null];
    for (const here of hits) {
      const { row } = here;
      if (here.point[2] < deepest) continue;
      if (before && before.triangle !== here.triangle && !joined(skinOf, before.triangle, here.triangle)) {
        const off = Math.abs((before.row + row) / 2 - expected) - (row - before.row); // an open mouth counts as much as a line
        if (!best || off < best.off) best = { off, column, upper: before.point, lower: here.point, upperEnd: corner(before), lowerEnd: corner(here), inUpper: within(column, before.row, -1), inLower: within(column, row, 1) };
      }
      before = here;
    }
    return best;
  };
  const middle = Math.round((landmarks[13][0] + landmarks[14][0]) / 2);
  const out = [];
  for (const way of [-1, 1]) {
    let lost = 0;
    for (let column = middle + (way > 0 ? 1 : 0); lost < LOST && Math.abs(column - middle) < 0.7 * wide; column += way) {
      const found = at(column);
      lost = found ? 0 : lost + 1;
      if (found) out[way < 0 ? 'unshift' : 'push'](found);
    }
  }
  return out.length > 0.3 * wide ? out : [];
}

/**
 * Finds the highest point of the upper lid's margin and the lowest of the lower one's.
 * @param {number[]} place the eyeball's middle on the picture @param {{centre: number[], radius: number}} ball in the file's units
 * @returns {{upper: number[], lower: number[]}|null}
 */
export function lidMargins(view, skin, eye, [column, row], { centre, radius }) {
  const deep = centre[2] + FORE * radius;
  const most = Math.round(2 * radius * view.scale);
  const edge = (x, way) => {
    if (view.at(x, row)?.mesh !== eye) return null;
    for (let k = 1; k < most; k++) {
      const here = view.at(x, row + way * k);
      if (here?.mesh === skin && here.point[2] > deep) return here.point; // deeper points belong to the socket
    }
    return null;
  };
  const columns = Array.from({ length: 2 * Math.round(NEAR * radius * view.scale) + 1 }, (_, i) => (i % 2 ? -1 : 1) * ((i + 1) >> 1));
  const farthest = (way) => columns.map((x) => edge(column + x, way)).reduce((best, p) => (p && (!best || way * (p[1] - best[1]) < 0) ? p : best), null);
  const [upper, lower] = [farthest(-1), farthest(1)];
  return upper && lower ? { upper, lower } : null;
}
