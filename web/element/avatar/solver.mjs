// SPDX-License-Identifier: MIT
// FAPs to weights: what each control moves at the feature points, measured on the avatar itself, and from there the weights
// within 0..1 that come nearest to what the FAPs ask for, in mm. Lips and lids that touch there touch here.
import { BoxSquares } from './box-squares.mjs';
import { mirrored } from './names.mjs';

const FEW = 0.2; // mm that a control must explain, so that few of several similar ones are used
const FEW_RARE = 2.5;
const RARE = /^(mouth(Left|Right|RollLower|RollUpper|ShrugLower|ShrugUpper|Dimple|Press)|cheekPuff|noseSneer)/;
const RIDGE = 0.02; // mm^2 for a whole weight: where several answers are as good, the smallest
const GAP_WEIGHT = 5; // of a mm between lips or lids, beside a mm of anything else
const MIDDLE_WEIGHT = 14; // the same in the middle of the lips: of round ones the sides are shut, the middle is read
const PRESSED = -0.5; // mm: farther than that lips are not pressed into each other
const TOUCH = 0.02; // mm
const TOUCHING = 0.018; // of the mouth's width: largest distance at rest of points of the lips that can touch
const LIDS_MEET = 1024;
const NEARLY_SHUT = 0.85;
const PAIRS = [['', 4, 5], ['L', 8, 10], ['R', 9, 11]];
const LIDS = [['L', 19, 21, 'eyeBlinkLeft'], ['R', 20, 22, 'eyeBlinkRight']];
const [X, Y, Z] = [0, 1, 2];

/** FAP, point, axis, sense, unit, how much it counts, the FAP of the other side and whether that goes against it. */
const ROWS = [
  [3, 'chin', Y, -1, 'MNS', 0.6, 3], [14, 'chin', Z, 1, 'MNS', 0.4, 14],
  [15, 'chin', X, -1, 'MW', 0.6, 15, -1], [4, 'upper', Y, -1, 'MNS', 1, 4],
  [5, 'lower', Y, 1, 'MNS', 1, 5], [8, 'upperL', Y, -1, 'MNS', 1, 9],
  [9, 'upperR', Y, -1, 'MNS', 1, 8], [10, 'lowerL', Y, 1, 'MNS', 1, 11],
  [11, 'lowerR', Y, 1, 'MNS', 1, 10], [6, 'cornerL', X, 1, 'MW', 1, 7],
  [7, 'cornerR', X, -1, 'MW', 1, 6], [12, 'cornerL', Y, 1, 'MNS', 1, 13],
  [13, 'cornerR', Y, 1, 'MNS', 1, 12], [16, 'lower', Z, 1, 'MNS', 0.3, 16],
  [17, 'upper', Z, 1, 'MNS', 0.3, 17], [19, 'lidTopL', Y, -1, 'IRISD', 1, 20],
  [20, 'lidTopR', Y, -1, 'IRISD', 1, 19], [21, 'lidBottomL', Y, 1, 'IRISD', 1, 22],
  [22, 'lidBottomR', Y, 1, 'IRISD', 1, 21], [31, 'browInL', Y, 1, 'ENS', 1, 32],
  [32, 'browInR', Y, 1, 'ENS', 1, 31], [33, 'browMidL', Y, 1, 'ENS', 1, 34],
  [34, 'browMidR', Y, 1, 'ENS', 1, 33], [35, 'browOutL', Y, 1, 'ENS', 1, 36],
  [36, 'browOutR', Y, 1, 'ENS', 1, 35], [37, 'browInL', X, -1, 'ES', 1, 38],
  [38, 'browInR', X, 1, 'ES', 1, 37], [39, 'puffL', X, 1, 'ES', 0.4, 40],
  [40, 'puffR', X, -1, 'ES', 0.4, 39], [41, 'cheekL', Y, 1, 'ENS', 0.4, 42],
  [42, 'cheekR', Y, 1, 'ENS', 0.4, 41],
];

/**
 * Computes the effect of a control at each row, mm.
 * @param {{rig: object, points: Record<string, number[]>}} found @returns {Float64Array}
 */
function effect({ vertices, deltas }, points, rows) {
  const at = new Map(Array.from(vertices, (v, i) => [v, i]));
  const shift = (v, axis) => (at.has(v) ? deltas[3 * at.get(v) + axis] : 0);
  const mean = (list, axis) => list.reduce((sum, v) => sum + shift(v, axis), 0) / list.length;
  return Float64Array.from(rows, ([, point, axis, sense]) => sense * mean(points[point], axis));
}

/** Returns the distance of the lips at rest, mm; the same on both sides. */
function apart(rest, letter, least) {
  const letters = letter ? ['L', 'R'] : [''];
  const gap = letters.reduce((sum, one) => sum + rest[`upper${one}`][Y] - rest[`lower${one}`][Y], 0) / letters.length;
  return gap > least ? gap : 0;
}

export class Solver {
  /**
   * @param {import('./controls.mjs').Control[]} controls
   * @param {NonNullable<ReturnType<import('./landmarks.mjs').landmarksOf>>} found
   */
  constructor(controls, found) {
    const { points, fapu, rig, rest } = found;
    this.rows = ROWS.filter(([, point]) => points[point]);
    this.scales = this.rows.map(([, , , , unit]) => fapu[unit] / 1024);
    this.lids = LIDS.filter(([letter]) => points[`lidTop${letter}`]);
    const own = new Map(controls.map(({ name }) => [name, effect(rig.fields.get(name), points, this.rows)]));
    this.names = controls.map(({ name }) => name);
    const evened = this.#evened(own);
    this.#uncouple(evened, this.names.indexOf(found.opener));
    // Instead of jawOpen and mouthClose: how far the jaw is open with the lips open, and how far with the lips closed.
    [this.jaw, this.close] = ['jawOpen', 'mouthClose'].map((name) => this.names.indexOf(name));
    if (this.jaw < 0) this.close = -1;
    const closed = (column) => column.map((value, r) => value + evened[this.jaw][r]);
    this.columns = evened.map((column, i) => (i === this.close ? closed(column) : column));
    this.gaps = PAIRS.map(([letter, upper, lower]) => ({
      upper,
      lower,
      weight: letter ? GAP_WEIGHT : MIDDLE_WEIGHT,
      rest: apart(rest, letter, TOUCHING * fapu.MW),
      of: this.columns.map((column) => -this.#row(column, upper) - this.#row(column, lower)),
    }));
    this.parted = this.#shutAtRest(evened[this.close]);
    this.unit = fapu.MNS / 1024;
    this.blinks = this.lids.map(([, upper, lower, name]) => {
      const control = this.names.includes(name) ? name : 'eyeBlink';
      const of = this.columns.map((column) => this.#row(column, upper) + this.#row(column, lower));
      return { upper, lower, control: this.names.indexOf(control), of, weight: GAP_WEIGHT };
    });
    for (const blink of this.blinks) blink.travel = blink.of[blink.control];
    this.#prepare();
    this.weights = new Float64Array(controls.length);
  }

  #row(column, fap) {
    const at = this.rows.findIndex(([number]) => number === fap);
    return at < 0 ? 0 : column[at];
  }

  /** The two sides of a face do the same: the mean of each control with the mirror image of its like. */
  #evened(own) {
    const mirror = this.rows.map(([fap, , , , , , other]) => this.rows.findIndex(([number]) => number === (other ?? fap)));
    return this.names.map((name) => {
      const [column, like] = [own.get(name), own.get(mirrored(name))];
      if (!like || mirror.includes(-1)) return column;
      return column.map((value, r) => (value + (this.rows[r][7] ?? 1) * like[mirror[r]]) / 2);
    });
  }

  /** A jaw that opens goes back as well, and the lip with it: FAPs 14 and 16 are what comes on top of that. */
  #uncouple(columns, opener) {
    const row = (fap) => this.rows.findIndex(([number]) => number === fap);
    const down = row(3);
    for (const back of [row(14), row(16)]) {
      const share = columns[opener][back] / columns[opener][down];
      for (const column of columns) column[back] -= share * column[down];
    }
  }

  /** Lips that are parted at rest are shut by mouthClose, which is then on always: how far. */
  #shutAtRest(column) {
    if (this.close < 0) return 0;
    const shuts = ({ upper, lower }) => this.#row(column, upper) + this.#row(column, lower);
    const weight = Math.min(1, Math.max(...this.gaps.map((gap) => (shuts(gap) > 0 ? gap.rest / shuts(gap) : 0))));
    for (const gap of this.gaps) gap.rest = Math.max(0, gap.rest - weight * shuts(gap));
    return weight;
  }

  /** The normal equations; what does not depend on a frame. */
  #prepare() {
    const { columns, rows } = this;
    const scaled = columns.map((column) => column.map((value, r) => value * rows[r][5] ** 2));
    const dot = (i, k) => {
      let sum = i === k ? RIDGE : 0;
      for (let r = 0; r < rows.length; r++) sum += scaled[i][r] * columns[k][r];
      for (const { of, weight } of [...this.gaps, ...this.blinks]) sum += weight ** 2 * of[i] * of[k];
      return sum;
    };
    const gram = columns.map((_, i) => Float64Array.from(columns, (_column, k) => dot(i, k)));
    this.scaled = scaled;
    this.few = this.names.map((name, i) => (RARE.test(name) ? FEW_RARE : FEW) * Math.sqrt(gram[i][i]));
    this.squares = new BoxSquares(gram);
    this.right = new Float64Array(columns.length);
  }

  /** Limits the lids to where they meet: beyond it they would drag along other controls. */
  #met(faps) {
    const met = Float64Array.from(faps);
    for (const { upper, lower } of this.blinks) {
      const share = Math.min(1, LIDS_MEET / Math.max(1, faps[upper] + faps[lower]));
      met[upper] *= share;
      met[lower] *= share;
    }
    return met;
  }

  /** @param {ArrayLike<number>} all FAPs by number @returns {Float64Array} of the controls, 0..1, the solver's own */
  solve(all) {
    const { rows, scales, right, weights } = this;
    const faps = this.#met(all);
    const targets = rows.map(([fap], r) => faps[fap] * scales[r]);
    const gaps = this.gaps.map(({ upper, lower, rest }) => Math.max(PRESSED, -(faps[upper] + faps[lower]) * this.unit) - rest);
    const shut = this.blinks.map(({ upper, lower, travel }) => ((faps[upper] + faps[lower]) / LIDS_MEET) * travel);
    for (let i = 0; i < right.length; i++) {
      let sum = -this.few[i];
      for (let r = 0; r < rows.length; r++) sum += this.scaled[i][r] * targets[r];
      this.gaps.forEach(({ of, weight }, p) => (sum += weight ** 2 * of[i] * gaps[p]));
      this.blinks.forEach(({ of, weight }, p) => (sum += weight ** 2 * of[i] * shut[p]));
      right[i] = sum;
    }
    const unknowns = this.squares.solve(right);
    weights.set(unknowns);
    this.#closeLips(faps, weights);
    this.#closeLids(faps, weights);
    if (this.close >= 0) {
      weights[this.close] = Math.min(weights[this.close], 1 - weights[this.jaw]);
      weights[this.jaw] += weights[this.close];
      weights[this.close] = Math.min(1, weights[this.close] + this.parted);
    }
    return weights;
  }

  /** Closes lips that touch according to the FAPs: controls that open them give way, the jaw last. */
  #closeLips(faps, w) {
    const { gaps, jaw, close } = this;
    const touching = gaps.filter(({ upper, lower }) => faps[upper] + faps[lower] >= 0);
    if (!touching.includes(gaps[0])) return;
    const sum = (of) => of.reduce((total, value, i) => total + w[i] * value, 0);
    const open = () => touching.some(({ of, rest }) => rest + sum(of) > TOUCH);
    if (close >= 0 && open()) {
      const part = this.#least((share) => {
        const closer = touching.map(({ of, rest }) => rest + sum(of) + share * w[jaw] * (of[close] - of[jaw]));
        return Math.max(...closer) <= TOUCH;
      });
      const way = Math.min(part * w[jaw], 1 - w[close]);
      w[close] += way;
      w[jaw] -= way;
    }
    for (const { of, rest } of touching) {
      const over = rest + sum(of);
      const opened = of.reduce((total, value, i) => total + (value > 0 ? w[i] * value : 0), 0);
      if (over <= TOUCH || !opened) continue;
      const keep = Math.max(0, 1 - over / opened);
      of.forEach((value, i) => (w[i] *= value > 0 ? keep : 1));
    }
  }

  /** The smallest share that does; 1: none does. */
  #least(does) {
    let [low, high] = [0, 1];
    for (let i = 0; i < 12; i++) {
      const at = (low + high) / 2;
      if (does(at)) high = at;
      else low = at;
    }
    return high;
  }

  /** From nearly shut on a blink is drawn to 1, which it is when the lids meet; and nothing else holds them apart then. */
  #closeLids(faps, w) {
    for (const { upper, lower, control, of } of this.blinks) {
      const shut = (faps[upper] + faps[lower]) / LIDS_MEET;
      if (control < 0 || shut <= NEARLY_SHUT) continue;
      w[control] = Math.min(1, Math.max(w[control], (shut - NEARLY_SHUT) / (1 - NEARLY_SHUT)));
      if (shut >= 1) of.forEach((value, i) => i !== control && value < 0 && this.names[i].startsWith('eye') && (w[i] = 0));
    }
  }

  /** The remaining distance of the lips, mm: middle, left, right. */
  get opened() {
    const { weights, jaw, close } = this;
    const unknown = (i) => {
      if (i === close) return weights[i] - this.parted;
      return i === jaw && close >= 0 ? weights[i] - weights[close] + this.parted : weights[i];
    };
    return this.gaps.map(({ of, rest }) => rest + of.reduce((sum, value, i) => sum + value * unknown(i), 0));
  }
}
