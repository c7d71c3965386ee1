// SPDX-License-Identifier: MIT
import { faceValues } from '../face-mixer.mjs';
import { maskOf } from './mask.mjs';
import { multiquadric } from './multiquadric.mjs';
import { nearest } from './nearest.mjs';
import { displacements, openingOf, spaceOf } from './space.mjs';

const CELL = 8; // pixels: the warp is computed at the corners of such cells, and goes straight between
const ONE = 256; // of the fractions that colours are mixed by
const LOW = 0x00ff00ff; // two of a pixel's four bytes, with room for products

/**
 * A region of the face: its two nearest pictures, warped so that their anchors lie where the FAPs want them, and dissolved into each other.
 * What it makes has the mask as its alpha.
 */
export class Region {
  #shown = null; // the place that `output` shows, as text

  /**
   * @param {object} region of a set, as read (set.mjs)
   * @param {Uint32Array[]} sources the pixels of its pictures
   * @param {Record<string, number>} fapu in pixels
   */
  constructor(region, sources, fapu) {
    const { name, width, height, pictures } = region;
    Object.assign(this, { name, x: region.x, y: region.y, width, height, sources, fapu });
    this.space = spaceOf(name);
    const opens = name === 'mouth';
    this.opens = opens;
    this.pictures = pictures.map(({ name: title, faps, anchors }) => {
      const values = faceValues(faps);
      const moved = displacements(values, fapu);
      return {
        name: title,
        at: this.space(values),
        opening: opens ? openingOf(values) : null,
        anchors: anchors ?? null,
        // Where the anchors would be at rest, by their FAPs: what is measured need not go where FAPs say.
        rest: anchors?.map((point, i) => point.map((value, k) => value - moved[i][k])),
      };
    });
    this.mask = maskOf(region);
    this.rows = rowsOf(this.mask, width, height);
    this.output = new Uint32Array(width * height);
    this.columns = Math.ceil((width - 1) / CELL) + 1;
    this.grid = new Float32Array(4 * this.columns * (Math.ceil((height - 1) / CELL) + 1));
    this.chosen = [];
  }

  /** @param {ArrayLike<number>} faps by number @returns {boolean} whether `output` has changed */
  update(faps) {
    const at = this.space(faps);
    const moved = this.opens ? displacements(faps, this.fapu) : [];
    const place = `${at.map(Math.round)} ${moved.map((d) => d.map((x) => Math.round(10 * x)))}`;
    if (place === this.#shown) return false;
    this.#shown = place;
    this.chosen = nearest(at, this.pictures, this.opens ? openingOf(faps) : null);
    const [a, b = a] = this.chosen;
    const warped = this.#warp(moved, a, b);
    this.#dissolve(this.sources[a.index], this.sources[b.index], b === a ? 0 : Math.round(ONE * b.weight), warped);
    return true;
  }

  /** Fills the grid with how far, from each of its corners, the two pictures are fetched. @returns {boolean} whether they are at all */
  #warp(moved, a, b) {
    const [one, other] = [this.pictures[a.index], this.pictures[b.index]];
    if (!one.anchors || !other.anchors) return false;
    const share = a === b ? 0 : b.weight;
    const wanted = moved.map((by, i) => by.map((d, k) => d + one.rest[i][k] * (1 - share) + other.rest[i][k] * share));
    const warp = multiquadric(wanted, [one.anchors, other.anchors]);
    const { columns, grid, width, height, mask } = this;
    const out = new Float64Array(4);
    for (let i = 0, node = 0; i < grid.length; i += 4, node++) {
      const x = (node % columns) * CELL;
      const y = Math.floor(node / columns) * CELL;
      const stays = 1 - mask[Math.min(height - 1, y) * width + Math.min(width - 1, x)]; // the seam with the base
      warp(x, y, out);
      for (let k = 0; k < 4; k++) grid[i + k] = (1 - stays) * (out[k] - (k % 2 ? y : x));
    }
    return true;
  }

  #dissolve(first, second, share, warped) {
    const { output, rows, mask, width, height, grid, columns } = this;
    const two = share > 0;
    for (let y = 0; y < height; y++) {
      const [begin, end] = [rows[2 * y], rows[2 * y + 1]];
      const line = Math.floor(y / CELL) * columns;
      const down = (y % CELL) / CELL;
      for (let x = begin; x < end; ) {
        const cell = Math.floor(x / CELL);
        const last = Math.min(end, (cell + 1) * CELL);
        const i = 4 * (line + cell);
        const below = i + (y + CELL > height - 1 && (y % CELL) === 0 ? 0 : 4 * columns);
        const right = cell + 1 < columns ? 4 : 0;
        const across = (x - cell * CELL) / CELL;
        let [ax, ay, bx, by, dax, day, dbx, dby] = [0, 0, 0, 0, 0, 0, 0, 0];
        if (warped) {
          const edge = (k) => grid[i + k] + down * (grid[below + k] - grid[i + k]);
          const far = (k) => grid[i + right + k] + down * (grid[below + right + k] - grid[i + right + k]);
          dax = (far(0) - edge(0)) / CELL;
          day = (far(1) - edge(1)) / CELL;
          ax = edge(0) + across * CELL * dax;
          ay = edge(1) + across * CELL * day;
          if (two) {
            dbx = (far(2) - edge(2)) / CELL;
            dby = (far(3) - edge(3)) / CELL;
            bx = edge(2) + across * CELL * dbx;
            by = edge(3) + across * CELL * dby;
          }
        }
        for (; x < last; x++) {
          const at = y * width + x;
          let colour = warped ? fetch(first, x + ax, y + ay, width, height) : first[at];
          if (two) colour = mixed(colour, warped ? fetch(second, x + bx, y + by, width, height) : second[at], share);
          output[at] = (colour & 0xffffff) | ((255 * mask[at] + 0.5) << 24);
          ax += dax;
          ay += day;
          bx += dbx;
          by += dby;
        }
      }
    }
  }
}

/** Two pixels of four bytes, all at once. */
function mixed(a, b, share) {
  const rest = ONE - share;
  const even = Math.imul(a & LOW, rest) + Math.imul(b & LOW, share);
  const odd = Math.imul((a >>> 8) & LOW, rest) + Math.imul((b >>> 8) & LOW, share);
  return ((even >>> 8) & LOW) | (odd & ~LOW);
}

/** A pixel between four; beyond the border, that of the border. */
function fetch(source, x, y, width, height) {
  x = x < 0 ? 0 : x > width - 1.01 ? width - 1.01 : x;
  y = y < 0 ? 0 : y > height - 1.01 ? height - 1.01 : y;
  const column = x | 0;
  const row = y | 0;
  const across = ((x - column) * ONE) | 0;
  const at = row * width + column;
  const upper = mixed(source[at], source[at + 1], across);
  return mixed(upper, mixed(source[at + width], source[at + width + 1], across), ((y - row) * ONE) | 0);
}

/** Where each row of a mask begins and ends. */
function rowsOf(mask, width, height) {
  const rows = new Int32Array(2 * height);
  for (let y = 0; y < height; y++) {
    const line = mask.subarray(y * width, (y + 1) * width);
    const begin = line.findIndex((value) => value > 0);
    rows.set(begin < 0 ? [0, 0] : [begin, line.findLastIndex((value) => value > 0) + 1], 2 * y);
  }
  return rows;
}
