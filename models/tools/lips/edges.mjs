// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Finds the inner edges of the lips in a picture, to a fraction of a pixel: walks columns across the middle of the mouth out of each lip,
 * from its position according to lay.mjs, until the picture changes more than it does on a lip. lay.mjs gives the search area; this gives
 * the position. Each column is relative to where its lips met at rest; values on which the columns disagree are omitted. mm of the base
 * head, in the head's own rotation.
 */
const COLUMNS = [-2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2]; // mm from the middle: farther out the lips' line bends
const STEP = 0.1; // mm along a column
const BLUR = 0.2; // mm, standard deviation: less than the width of the dark line of closed lips
const WITHIN = { upper: 2.2, lower: 4 }; // mm inside the lip where a walk starts: half of the lip
const BEYOND = { upper: 2.5, lower: 5 }; // mm by which the end may differ from its expected position; a sudden opening may exceed it
const FIRST = { guess: 1, beyond: 5 }; // mm: search range for the lips' line on a face fitted with the base head's shape
const STEEP = 0.2; // of the lip's own brightness per mm: more than its shading
const SHADE = 0.7; // of a lower lip's maximum brightness: darker points are near its edge
const SHADOW = 1.5; // mm behind the edge within which it is darkest
const END = 0.4; // of the distance from there to the lip's brightest point
const RISE = 1.4; // times as bright as a dark line is the area behind it,
const SOON = 1.2; // mm after that
const WIDE = 2.2; // mm: a wider one is the inside of the mouth,
const DARK = 1.25; // the dark band extends from its darkest point while it is less than this many times as bright
const PALE = 0.05; // difference in the share of red (of red and green) by which teeth are paler than a lip
const LIP = { from: 0.5, to: 2, light: 1.3, red: 0.05 }; // mm behind its end within which a lower lip looks as at rest, and the tolerances for brightness and share of red
const ALIKE = 0.35; // mm: median deviation of the columns from their common value
const ENOUGH = 5; // columns

const middle = (list) => Float64Array.from(list).sort()[list.length >> 1];
const REACH = Math.ceil((2 * BLUR) / STEP);
const WEIGHTS = Array.from({ length: 2 * REACH + 1 }, (_, i) => Math.exp(-0.5 * (((i - REACH) * STEP) / BLUR) ** 2));
const WHOLE = WEIGHTS.reduce((a, b) => a + b);

function blurred(list) {
  const last = list.length - 1;
  return list.map((_, i) => WEIGHTS.reduce((sum, w, n) => sum + w * list[Math.max(0, Math.min(last, i + n - REACH))], 0) / WHOLE);
}

/** Returns the position of the extreme near i, between the samples, by fitting a parabola. */
function between(list, i) {
  const [a, b, c] = [list[i - 1], list[i], list[i + 1]];
  const bend = a - 2 * b + c;
  return i + (bend ? Math.max(-0.5, Math.min(0.5, (0.5 * (a - c)) / bend)) : 0);
}

/** Finds the first dark line; if teeth follow it, half way to where they begin, because a lip's shade ends there. The line of closed lips lies between both. */
function darkLine({ light, red, slope }) {
  const [near, soon] = [Math.round(0.3 / STEP), Math.round(SOON / STEP)];
  for (let i = near; i < light.length - near; i++) {
    const about = light.slice(i - near, i + near + 1);
    if (light[i] > Math.min(...about)) continue;
    const after = light.slice(i, i + soon + 1);
    if (Math.max(...after) < RISE * light[i]) continue;
    let [from, to] = [i, i];
    while (from > 0 && light[from] < DARK * light[i]) from--;
    while (to < light.length - 1 && light[to] < DARK * light[i]) to++;
    if ((to - from) * STEP > WIDE) return null;
    let steepest = i;
    for (let n = i; n < Math.min(slope.length - 1, i + soon); n++) if (slope[n] > slope[steepest]) steepest = n;
    const teeth = red[Math.max(0, i - soon)] - red[Math.min(red.length - 1, i + soon)] > PALE;
    return teeth ? (between(light, i) + between(slope, steepest)) / 2 : between(light, i);
  }
  return null;
}

/** Returns where teeth begin without a dark line: a steep step to paler and less red. */
function toothAt({ red, slope, own }, i) {
  const steep = slope[i] >= STEEP * own && slope[i] >= slope[i - 1] && slope[i] >= slope[i + 1];
  return steep && red[i - 2] - red[Math.min(red.length - 1, i + 4)] > PALE;
}

/** Returns where a lip has become dark on the way to the darkest point soon after i, whose shade it is in. */
function endInShade(light, i, brightest) {
  const darkest = Math.min(...light.slice(i, i + Math.round(SHADOW / STEP)));
  const end = darkest + END * (brightest - darkest);
  let at = i;
  while (at > 1 && light[at] < end) at--;
  while (light[at] >= end) at++;
  return at - (end - light[at]) / (light[at - 1] - light[at]);
}

/** Finds the edge of the lower lip, which is round and darkens gradually, a thin one from its middle on; a steep step is only shading. */
function lowerEnd(column) {
  const { light, slope } = column;
  let brightest = Math.max(light[0], light[1]);
  for (let i = 2; i < light.length - 2; i++) {
    brightest = Math.max(brightest, light[i]);
    if (light[i] < SHADE * brightest) return endInShade(light, i, brightest);
    if (toothAt(column, i)) return between(slope, i);
  }
  return null;
}

/** Mean brightness and red along a walk before it reached an end. */
function lipBefore({ light, red }, at) {
  const [from, to] = [Math.max(0, Math.round(at - LIP.to / STEP)), Math.round(at - LIP.from / STEP)];
  const mean = (list) => list.slice(from, to + 1).reduce((a, b) => a + b, 0) / (to + 1 - from);
  return to > from ? { light: mean(light), red: mean(red) } : null;
}

const sameLip = (now, rest) => now && now.light < LIP.light * rest.light && rest.light < LIP.light * now.light && Math.abs(now.red - rest.red) < LIP.red;

const ends = (found) => found.map((one) => one?.end ?? null);

export class Edges {
  #rest = null; // for each column: the lips' line, the edge of the lower lip, and the look of that lip

  /** @param {object} skin of speakerOf */
  constructor({ fdp }) {
    this.middle = [0, 1, 2].map((k) => (fdp['2.2'][k] + fdp['2.3'][k]) / 2);
  }

  /** Learns the face at rest. @param {{picture: object, stand: object}[]} pictures @returns {boolean} whether its lips are visible */
  know(pictures) {
    const found = pictures.map(({ picture, stand }) => {
      const nothing = COLUMNS.map(() => null);
      const known = ends(this.#walk(picture, stand, FIRST.guess, -1, darkLine, FIRST.beyond)).filter((y) => y !== null);
      if (known.length < ENOUGH) return { line: nothing, lower: nothing, lip: nothing };
      const about = middle(known);
      const lower = this.#walk(picture, stand, about, 1, lowerEnd);
      return { line: ends(this.#walk(picture, stand, about, -1, darkLine)), lower: ends(lower), lip: lower.map((one) => one?.lip ?? null) };
    });
    const each = (name, typical = middle) => COLUMNS.map((_, c) => {
      const list = found.map((one) => one[name][c]).filter((y) => y !== null);
      return 2 * list.length > found.length ? typical(list) : null;
    });
    const looks = (list) => ({ light: middle(list.map(({ light }) => light)), red: middle(list.map(({ red }) => red)) });
    const rest = { line: each('line'), lower: each('lower'), lip: each('lip', looks) };
    const seen = (list) => list.filter((y) => y !== null).length >= ENOUGH;
    this.#rest = seen(rest.line) && seen(rest.lower) ? rest : null;
    return this.#rest !== null;
  }

  /**
   * @param {object} picture @param {object} stand @param {number} rises expected rise of the upper lip's edge from rest, mm @param {number} falls
   *   expected fall of the lower lip's edge @returns {{rises: number|null, falls: number|null}} null: unknown
   */
  seen(picture, stand, rises, falls) {
    if (!this.#rest) return { rises: null, falls: null };
    const { line, lower, lip } = this.#rest;
    const known = (list) => middle(list.filter((y) => y !== null));
    const up = together(ends(this.#walk(picture, stand, known(line) + rises, -1, darkLine)), line);
    const found = this.#walk(picture, stand, known(lower) - falls, 1, lowerEnd);
    const down = together(ends(found.map((one, c) => (one && lip[c] && sameLip(one.lip, lip[c]) ? one : null))), lower);
    return { rises: up, falls: down === null ? null : -down };
  }

  /** Returns for each column the position of the edge, searching from inside a lip outward. @param {number} way -1: down, 1: up */
  #walk(picture, stand, guess, way, find, beyond) {
    const lip = way < 0 ? 'upper' : 'lower';
    const from = guess - way * WITHIN[lip];
    const steps = Math.round((WITHIN[lip] + (beyond ?? BEYOND[lip])) / STEP);
    return COLUMNS.map((x) => {
      const column = this.#column(picture, stand, x, from, way * STEP, steps);
      const at = column && find(column);
      return at === null ? null : { end: from + way * STEP * at, lip: lipBefore(column, at) };
    });
  }

  #column({ data, width, height }, { turn: [a, b], scale, onto }, x, from, step, steps) {
    const [mx, my, mz] = this.middle;
    const light = [];
    const red = [];
    for (let n = 0; n <= steps; n++) {
      const [px, py] = [mx + x, my + from + step * n];
      const u = onto[0] + scale * (a[0] * px + a[1] * py + a[2] * mz) - 0.5;
      const v = onto[1] - scale * (b[0] * px + b[1] * py + b[2] * mz) - 0.5;
      const [i, j] = [Math.floor(u), Math.floor(v)];
      if (!(i >= 0 && j >= 0 && i < width - 1 && j < height - 1)) return null;
      const at = 4 * (j * width + i);
      const row = (k) => data[k] * (1 - u + i) + data[k + 4] * (u - i);
      const [r, g, bl] = [0, 1, 2].map((k) => row(at + k) * (1 - v + j) + row(at + 4 * width + k) * (v - j));
      light.push(0.3 * r + 0.6 * g + 0.1 * bl);
      red.push(r / (r + g + 1));
    }
    const smooth = blurred(light);
    const last = steps;
    const slope = smooth.map((_, i) => (smooth[Math.min(last, i + 1)] - smooth[Math.max(0, i - 1)]) / (2 * STEP));
    return { light: smooth, red: blurred(red), slope, own: middle(smooth.slice(0, Math.round(1 / STEP))) };
  }
}

/** Returns how far the columns moved from rest, if enough of them agree. */
function together(now, rest) {
  const gone = now.map((y, c) => (y === null || rest[c] === null ? null : y - rest[c])).filter((y) => y !== null);
  if (gone.length < ENOUGH) return null;
  const all = middle(gone);
  return middle(gone.map((y) => Math.abs(y - all))) <= ALIKE ? all : null;
}
