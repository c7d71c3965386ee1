// SPDX-License-Identifier: MIT
/**
 * Registers a speaker's face (speaker.mjs) with a picture: finds the pose of the head and the movement of lips and jaw for
 * which every point of the skin looks as at rest. Gauss-Newton steps with robust weights, so that outliers (teeth, shadows, a
 * blinking eye) do not count.
 */
import { SPEECH } from './fap-moves.mjs';
import { lookAt, planesOf } from './planes.mjs';
import { solve } from './solve.mjs';

const WIDTHS = [2.4, 1.2, 0.6]; // mm of blur, from coarse to fine
const STEPS = [5, 5, 6];
const CLOSE = [0.1, 0.05, 0.02]; // mm: steps that are smaller are the last
const EACH = [4, 2, 1]; // at each level, one in this many sample points
const POSE = 6;
const JAW = 5;
const NOISE = 0.3; // of 255: noise of pictures
// what is unexpected by a standard deviation costs an opening that is tried as much as so many places that look otherwise
const SURPRISE = 4;
// as much counts what is expected: places beside each other say the same thing, and what is left over is no noise
const TRUST = 30;
const SIGHT = [0, 0, 0]; // what lookAt tells, again and again
const AROUND = 12; // mm beside the face: lips and jaw go there
const APART = 2.5; // mm of the lower lip: other openings
const UNLIKE = 8; // of 255: what differs more is something else
const NUDGE = 0.02; // mm, for derivatives
/** mm from where lips and jaw were, and at rest: closures come and go within a picture. */
const TRIALS = { EM: [-6, -4, -2, 0, 2, 4, 6], LI: [-3, -1.5, 0, 1.5, 3, 5, 8, 11], LS: [-2, 0, 2] };
const MOST = { EM: 20, LI: 20, LS: 7, below: 7 }; // mm; below: of the lower lip from the jaw

/** Adds a small rotation, in rad about x, y and z, to the pose of the head: turn (3 x 3), scale, shift. */
export const turned = ({ turn, scale, onto }, [rx, ry, rz, size, u, v]) => {
  const angle = Math.hypot(rx, ry, rz);
  const [x, y, z] = angle ? [rx / angle, ry / angle, rz / angle] : [0, 0, 1];
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const more = [
    [c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
    [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
    [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)],
  ];
  const both = more.map((row) => turn[0].map((_, k) => row.reduce((sum, value, l) => sum + value * turn[l][k], 0)));
  return { turn: both, scale: scale * Math.exp(size), onto: [onto[0] + u, onto[1] + v] };
};

export class Layer {
  #move;

  #mouth;

  #fields;

  /**
   * @param {object} speaker of speakerOf
   * @param {object} model what is looked for (fap-moves.mjs); the first six are those of speech
   */
  constructor(speaker, model = SPEECH) {
    Object.assign(this, { speaker, model, still: new Float64Array(model.unknowns.length) });
    if (speaker.mouth) this.#mouth = new Layer(some(speaker, speaker.mouth), model);
    this.#move = new Float64Array(3 * speaker.count);
    this.#fields = model.unknowns.map(() => new Float64Array(3 * speaker.count));
  }

  /** Returns the deviation of an unknown from its expectation, given the others. */
  #unexpected(q, p) {
    const link = this.model.links[p];
    return q[p] - (link ? link.share * q[link.to] : 0);
  }

  /** Computes the displacements of the sample points by the unknowns, and their derivatives. */
  #moves(q, slopes) {
    const { fields } = this.speaker;
    const { unknowns, moved, fapsOf } = this.model;
    const faps = fapsOf(q);
    const sum = (out, amounts, signs) => {
      out.fill(0);
      moved.forEach((_, f) => {
        const amount = amounts[f];
        if (Math.abs(amount) < 1e-9) return;
        const { at, mm } = signs[f] >= 0 ? fields[f].positive : fields[f].negative;
        const share = signs[f] >= 0 ? amount : -amount;
        for (let i = 0; i < at.length; i++) out[at[i]] += share * mm[i];
      });
    };
    sum(this.#move, faps, faps);
    if (!slopes) return;
    unknowns.forEach((_, p) => {
      const more = Float64Array.from(q);
      more[p] += NUDGE;
      const slope = fapsOf(more).map((x, f) => (x - faps[f]) / NUDGE);
      sum(this.#fields[p], slope, faps.map((x, f) => (Math.abs(x) > 1e-9 ? x : slope[f])));
    });
  }

  /** Columns and rows of the places. */
  places(stand, q, slopes = false, out = new Float64Array(2 * this.speaker.count)) {
    this.#moves(q, slopes);
    const { place, count } = this.speaker;
    const { turn: [a, b], scale, onto } = stand;
    const move = this.#move;
    for (let i = 0; i < count; i++) {
      const x = place[3 * i] + move[3 * i];
      const y = place[3 * i + 1] + move[3 * i + 1];
      const z = place[3 * i + 2] + move[3 * i + 2];
      out[2 * i] = onto[0] + scale * (a[0] * x + a[1] * y + a[2] * z);
      out[2 * i + 1] = onto[1] - scale * (b[0] * x + b[1] * y + b[2] * z);
    }
    return out;
  }

  /** The piece of the picture with the face. */
  planes(picture, stand) {
    const [x, y] = [this.places(stand, this.still), AROUND * stand.scale];
    let [u0, v0, u1, v1] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let i = 0; i < x.length; i += 2) {
      u0 = Math.min(u0, x[i]); u1 = Math.max(u1, x[i]);
      v0 = Math.min(v0, x[i + 1]); v1 = Math.max(v1, x[i + 1]);
    }
    return planesOf(picture, [u0 - y, v0 - y, u1 - u0 + 2 * y, v1 - v0 + 2 * y], stand.scale, WIDTHS);
  }

  /** Samples the picture at the points: two lists for each width. */
  seen(picture, stand, q) {
    const at = this.places(stand, q);
    const look = (level, plane, i) => (lookAt(level, plane, at[2 * i], at[2 * i + 1], SIGHT) ? SIGHT[0] : NaN);
    return this.planes(picture, stand).map((level) =>
      level.planes.map((plane) => Float64Array.from({ length: this.speaker.count }, (_, i) => look(level, plane, i))));
  }

  /**
   * @param {object} picture @param {number[][][]} rest of seen @param {{stand: object, q: Float64Array}} start
   * @returns {{stand: object, q: Float64Array, unlike: number, doubt: (p: number) => number}} doubt: the standard deviation of
   *   an unknown, mm, by what the picture has to hold on to
   */
  lay(picture, rest, { stand, q }) {
    const levels = this.planes(picture, stand);
    const first = this.#settled(levels, rest, 0, { stand, q: Float64Array.from(q) }); // tells how the head stands
    const ends = this.#starts(levels[1], rest[1], first).map((start) => {
      const end = [1, 2].reduce((now, l) => this.#settled(levels, rest, l, now), { stand: first.stand, q: start });
      return { ...end, cost: this.#cost(levels[2], rest[2], end.stand, end.q) };
    });
    const best = ends.reduce((least, end) => (end.cost < least.cost ? end : least));
    return { ...best, doubt: (p) => this.#doubt(levels[2], rest[2], best, p) };
  }

  /** The root of what the equations' inverse has of it, how the head stands being unknown, too. */
  #doubt(level, rest, end, p) {
    const { a } = this.#normal(level, rest, end, EACH[2]);
    return Math.sqrt(TRUST * solve(a, Float64Array.from(a, (_, k) => Number(k === POSE + p)))[POSE + p]);
  }

  /** Steps until they are small. */
  #settled(levels, rest, l, from) {
    let now = from;
    let unlike = 0;
    for (let step = 0; step < STEPS[l]; step++) {
      const { a, b, spread } = this.#normal(levels[l], rest[l], now, EACH[l]);
      unlike = spread;
      const d = solve(a, b);
      now = { stand: turned(now.stand, d), q: now.q.map((x, p) => x + d[POSE + p]) };
      if (d.every((x, k) => Math.abs(x) < (k < 4 ? 1e-4 : CLOSE[l]))) break;
    }
    return { ...now, unlike };
  }

  /**
   * Chooses starting points, since lips and jaw move too far between two pictures for the steps: of several openings the most
   * similar one, and the next best that is no neighbour of it.
   */
  #starts(level, rest, { stand, q }) {
    const tried = [];
    const trial = (from, changes) => {
      const now = Float64Array.from(from);
      for (const [name, mm] of Object.entries(changes)) now[this.model.unknowns.indexOf(name)] += mm;
      const [low, high] = [now[0], now[1]];
      if (changes.EM === undefined) now[JAW] = Math.max(now[JAW], low - MOST.below); // a mouth that flies open takes it along
      if (low + high < -0.5 || low > MOST.LI || low > now[JAW] + MOST.below || high > MOST.LS) return;
      if (now[JAW] > MOST.EM || now[JAW] < -1) return;
      tried.push({ q: now, cost: this.#cost(level, rest, stand, now) });
    };
    for (const from of [q, this.still])
      for (const LI of TRIALS.LI)
        for (const LS of TRIALS.LS) trial(Float64Array.from(q, (x, p) => (p < 2 ? from[p] : x)), { LI, LS });
    const best = (list) => list.reduce((a, b) => (a && a.cost <= b.cost ? a : b), null);
    const lips = best(tried);
    if (!lips) return [this.still];
    const other = best(tried.filter((one) => Math.abs(one.q[0] - lips.q[0]) >= APART));
    for (const EM of TRIALS.EM) trial(lips.q, { EM });
    return [best(tried.filter((one) => Math.abs(one.q[0] - lips.q[0]) < APART)), other].flatMap((one) => (one ? [one.q] : []));
  }

  /** Counts the points of the mouth that look different from rest. */
  #cost(level, rest, stand, q) {
    const at = this.#mouth.places(stand, q);
    let sum = q.reduce((all, _, p) => all + SURPRISE * (this.#unexpected(q, p) / this.model.expected[p]) ** 2, 0);
    this.speaker.mouth.forEach((place, i) => {
      level.planes.forEach((plane, k) => {
        if (!lookAt(level, plane, at[2 * i], at[2 * i + 1], SIGHT)) return;
        const s = ((SIGHT[0] - rest[k][place]) / UNLIKE) ** 2;
        sum += s / (1 + s);
      });
    });
    return sum;
  }

  /**
   * The normal equations of a step: what a little more of each unknown would do to each place, against how much that looks
   * otherwise.
   */
  #normal(level, rest, { stand, q }, each) {
    const { count, place } = this.speaker;
    const { turn: [ra, rb, rc], scale } = stand;
    const at = this.places(stand, q, true);
    const looks = level.planes.map((plane, k) => {
      const out = new Float64Array(3 * count).fill(NaN);
      for (let i = 0; i < count; i += each)
        if (lookAt(level, plane, at[2 * i], at[2 * i + 1], SIGHT)) {
          out[3 * i] = SIGHT[0] - rest[k][i];
          out[3 * i + 1] = SIGHT[1] * scale;
          out[3 * i + 2] = SIGHT[2] * scale;
        }
      return out;
    });
    const spreads = looks.map((list) => 1.5 * middle(list, 3 * each) + NOISE);
    const { expected, links } = this.model;
    const all = POSE + q.length;
    const a = Array.from({ length: all }, () => new Float64Array(all));
    const b = new Float64Array(all);
    const j = new Float64Array(all);
    const move = this.#move;
    for (let i = 0; i < 3 * count; i += 3 * each) {
      const x = place[i] + move[i];
      const y = place[i + 1] + move[i + 1];
      const z = place[i + 2] + move[i + 2];
      const X = ra[0] * x + ra[1] * y + ra[2] * z;
      const Y = rb[0] * x + rb[1] * y + rb[2] * z;
      const Z = rc[0] * x + rc[1] * y + rc[2] * z;
      for (let k = 0; k < 2; k++) {
        const r = looks[k][i];
        const gu = looks[k][i + 1];
        const gv = looks[k][i + 2];
        if (!(Math.abs(r) + gu * gu + gv * gv > 0)) continue;
        const s = r / (3 * spreads[k]);
        const w = 1 / ((1 + s * s) ** 2 * spreads[k] * spreads[k]);
        j[0] = gv * Z; // a small turn moves (X, Y) by (ry Z - rz Y, rz X - rx Z)
        j[1] = gu * Z;
        j[2] = -gu * Y - gv * X;
        j[3] = gu * X - gv * Y;
        j[4] = gu / scale;
        j[5] = gv / scale;
        for (let p = 0; p < q.length; p++) {
          const f = this.#fields[p];
          const dx = f[i];
          const dy = f[i + 1];
          const dz = f[i + 2];
          j[POSE + p] = gu * (ra[0] * dx + ra[1] * dy + ra[2] * dz) - gv * (rb[0] * dx + rb[1] * dy + rb[2] * dz);
        }
        for (let m = 0; m < all; m++) {
          const wm = w * j[m];
          if (!wm) continue;
          b[m] -= wm * r;
          const row = a[m];
          for (let n = m; n < all; n++) row[n] += wm * j[n];
        }
      }
    }
    for (let m = 0; m < all; m++) for (let n = 0; n < m; n++) a[m][n] = a[n][m];
    q.forEach((_, p) => {
      const weight = TRUST / expected[p] ** 2;
      const off = this.#unexpected(q, p);
      const row = [[POSE + p, 1], ...(links[p] ? [[POSE + links[p].to, -links[p].share]] : [])];
      for (const [m, x] of row) {
        b[m] -= weight * x * off;
        for (const [n, y] of row) a[m][n] += weight * x * y;
      }
    });
    return { a, b, spread: spreads[0] };
  }
}

function middle(list, each) {
  const known = [];
  for (let i = 0; i < list.length; i += each) if (list[i] === list[i]) known.push(Math.abs(list[i]));
  return Float64Array.from(known).sort()[known.length >> 1] ?? 0;
}

/** Makes a copy of a speaker with a subset of its sample points. */
function some({ place, fields }, which) {
  const number = new Map(which.map((i, n) => [i, n]));
  const few = ({ at, mm }) => {
    const kept = [...at.keys()].filter((i) => number.has(Math.floor(at[i] / 3)));
    const numbers = Uint32Array.from(kept, (i) => 3 * number.get(Math.floor(at[i] / 3)) + (at[i] % 3));
    return { at: numbers, mm: Float64Array.from(kept, (i) => mm[i]) };
  };
  return {
    count: which.length, place: Float64Array.from(which.flatMap((i) => [...place.subarray(3 * i, 3 * i + 3)])),
    fields: fields.map(({ positive, negative }) => ({ positive: few(positive), negative: few(negative) })),
  };
}
