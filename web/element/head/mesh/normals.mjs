// SPDX-License-Identifier: MIT

/**
 * The normals of a part, and how they change when some of its vertices move. Vertices at the same place (seams of the
 * texture) share one normal.
 */
export class Normals {
  /** @param {import('../model/model.mjs').Part} part */
  constructor({ position, index, smooth, vertices }) {
    this.position = position;
    this.index = index;
    this.shared = smooth ?? Uint16Array.from({ length: vertices }, (_, i) => i);
    this.#collect(vertices);
    this.rest = new Float32Array(3 * vertices);
    for (let v = 0; v < vertices; v++) this.#write(this.rest, v, this.#at(position, this.shared[v]));
  }

  /** Lists the triangles that touch each position, and the vertices at it, as flat lists. */
  #collect(vertices) {
    const flat = (count, keys) => {
      const start = new Uint32Array(vertices + 1);
      for (let i = 0; i < count; i++) start[keys(i) + 1]++;
      for (let v = 0; v < vertices; v++) start[v + 1] += start[v];
      const fill = start.slice();
      const items = new Uint32Array(count);
      for (let i = 0; i < count; i++) items[fill[keys(i)]++] = i;
      return { start, items };
    };
    this.corners = flat(this.index.length, (i) => this.shared[this.index[i]]);
    this.places = flat(vertices, (v) => this.shared[v]);
  }

  /** The sum of the triangles' normals, each as long as its triangle is large, at length 1. */
  #at(p, place) {
    const { shared, index } = this;
    let [x, y, z] = [0, 0, 0];
    for (let i = this.corners.start[place]; i < this.corners.start[place + 1]; i++) {
      const first = this.corners.items[i] - (this.corners.items[i] % 3);
      const a = 3 * shared[index[first]];
      const b = 3 * shared[index[first + 1]];
      const c = 3 * shared[index[first + 2]];
      const ux = p[b] - p[a];
      const uy = p[b + 1] - p[a + 1];
      const uz = p[b + 2] - p[a + 2];
      const wx = p[c] - p[a];
      const wy = p[c + 1] - p[a + 1];
      const wz = p[c + 2] - p[a + 2];
      x += uy * wz - uz * wy;
      y += uz * wx - ux * wz;
      z += ux * wy - uy * wx;
    }
    const length = Math.hypot(x, y, z) || 1;
    return [x / length, y / length, z / length];
  }

  #write(out, vertex, value) {
    for (let k = 0; k < 3; k++) out[3 * vertex + k] = value[k];
  }

  /**
   * Computes the normals near `vertices` when the part is at `position`.
   * @param {Iterable<number>} vertices that have moved
   * @param {Float32Array} position of all vertices
   * @returns {Map<number, number[]>} vertex -> normal, for every vertex whose triangles have moved
   */
  displaced(vertices, position) {
    const places = new Set();
    for (const v of vertices) {
      const place = this.shared[v];
      for (let i = this.corners.start[place]; i < this.corners.start[place + 1]; i++) {
        const corner = this.corners.items[i];
        for (let k = 0; k < 3; k++) places.add(this.shared[this.index[corner - (corner % 3) + k]]);
      }
    }
    const out = new Map();
    for (const place of places) {
      const normal = this.#at(position, place);
      for (let i = this.places.start[place]; i < this.places.start[place + 1]; i++) out.set(this.places.items[i], normal);
    }
    return out;
  }
}
