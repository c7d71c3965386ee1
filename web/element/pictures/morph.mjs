// SPDX-License-Identifier: MIT
import { faceValues } from '../face/face-mixer.mjs';
import { maskOf } from './mask.mjs';
import { multiquadric } from './multiquadric.mjs';
import { nearest } from './nearest.mjs';
import { displacements, openingOf, spaceOf } from './space.mjs';

const CELL = 8; // pixels: the warp is computed at the corners of such cells, and goes straight between
const ONE = 256; // of the fractions that colours are mixed by
const LOW = 0x00ff00ff; // two of a pixel's four bytes, with room for products
const COLOUR = 0x00ffffff; // without alpha
const FINE_BITS = 14; // of a column's and row's fraction
const FINE = 1 << FINE_BITS;
const STILL = 1 / 16; // pixels: less is not seen

/**
 * A region of the face: warps its two nearest pictures so that their anchors lie where the FAPs put them, and cross-fades them.
 * The mask is the alpha of the result.
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
        // Anchors at rest according to their FAPs: measured anchors may lie elsewhere.
        rest: anchors?.map((point, i) => point.map((value, k) => value - moved[i][k])),
      };
    });
    this.mask = maskOf(region);
    this.alpha = Uint32Array.from(this.mask, (share) => (Math.round(255 * share) << 24) >>> 0);
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

  /** Fills the grid with how far from its corners the two pictures are fetched. @returns {boolean} whether they are at all */
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
    const { output, rows, alpha, width, height } = this;
    const run = new Int32Array(8);
    for (let y = 0; y < height; y++) {
      const end = rows[2 * y + 1];
      for (let x = rows[2 * y]; x < end; ) {
        const last = Math.min(end, (Math.floor(x / CELL) + 1) * CELL);
        const at = y * width + x;
        const count = last - x;
        if (!warped || !this.#run(x, y, run)) plain(output, alpha, first, second, at, count, share);
        else {
          fetched(output, first, run, 0, at, count, width, height);
          if (share) fetched(output, second, run, 4, at, count, width, height, share);
          for (let i = at; i < at + count; i++) output[i] = (output[i] & COLOUR) | alpha[i];
        }
        x = last;
      }
    }
  }

  /**
   * Computes the source of a run of pixels within a cell, in fractions of FINE: column, row and their steps, for both
   * pictures.
   * @returns {boolean} whether the source differs from the target
   */
  #run(x, y, run) {
    const { grid, columns } = this;
    const column = Math.floor(x / CELL);
    const down = (y % CELL) / CELL;
    const i = 4 * (Math.floor(y / CELL) * columns + column);
    const below = y % CELL ? i + 4 * columns : i; // the last row may have no successor
    const right = column + 1 < columns ? 4 : 0;
    const across = x - column * CELL;
    let moved = false;
    for (let k = 0; k < 4; k++) {
      const begin = grid[i + k] + down * (grid[below + k] - grid[i + k]);
      const end = grid[i + right + k] + down * (grid[below + right + k] - grid[i + right + k]);
      const step = (end - begin) / CELL;
      const place = 4 * (k >> 1) + (k & 1);
      run[place] = ((k & 1 ? y : x) + begin + across * step) * FINE;
      run[place + 2] = (step + (k & 1 ? 0 : 1)) * FINE;
      moved ||= Math.abs(begin) > STILL || Math.abs(end) > STILL;
    }
    return moved;
  }
}

/** Two pixels of four bytes, all at once. */
function mixed(a, b, share) {
  const rest = ONE - share;
  const even = Math.imul(a & LOW, rest) + Math.imul(b & LOW, share);
  const odd = Math.imul((a >>> 8) & LOW, rest) + Math.imul((b >>> 8) & LOW, share);
  return ((even >>> 8) & LOW) | (odd & ~LOW);
}

/** Pixels where they are. */
function plain(output, alpha, first, second, at, count, share) {
  for (let i = at; i < at + count; i++)
    output[i] = ((share ? mixed(first[i], second[i], share) : first[i]) & COLOUR) | alpha[i];
}

/** A run of pixels, each between four; beyond the border, those of the border. With a share, into what stands there. */
function fetched(output, source, run, k, at, count, width, height, share = 0) {
  let [x, y] = [run[k], run[k + 1]];
  const [stepX, stepY] = [run[k + 2], run[k + 3]];
  const [mostX, mostY] = [(width - 1) * FINE - 1, (height - 1) * FINE - 1];
  for (let i = at; i < at + count; i++, x += stepX, y += stepY) {
    const u = x < 0 ? 0 : x > mostX ? mostX : x;
    const v = y < 0 ? 0 : y > mostY ? mostY : y;
    const place = Math.imul(v >> FINE_BITS, width) + (u >> FINE_BITS);
    const across = (u & (FINE - 1)) >> (FINE_BITS - 8);
    const down = (v & (FINE - 1)) >> (FINE_BITS - 8);
    const upper = mixed(source[place], source[place + 1], across);
    const colour = mixed(upper, mixed(source[place + width], source[place + width + 1], across), down);
    output[i] = share ? mixed(output[i], colour, share) : colour;
  }
}

/** Returns the first and last column of each row of a mask. */
function rowsOf(mask, width, height) {
  const rows = new Int32Array(2 * height);
  for (let y = 0; y < height; y++) {
    const line = mask.subarray(y * width, (y + 1) * width);
    const begin = line.findIndex((value) => value > 0);
    rows.set(begin < 0 ? [0, 0] : [begin, line.findLastIndex((value) => value > 0) + 1], 2 * y);
  }
  return rows;
}
