// SPDX-License-Identifier: MIT
// A face from the side (a profile, before a background that is much the same all over): its outline is the face's depth
// along the middle, which no picture
// from the front shows, and which the finder of landmarks guesses. The head's own profile is laid onto the outline and
// what is left over is depth.
import { PortraitError } from './problem.mjs';

/** Landmarks down the middle, from the hairline to under the chin. */
const MIDDLE = [10, 151, 9, 8, 168, 6, 197, 195, 5, 4, 1, 19, 94, 2, 164, 0, 11, 13, 14, 16, 17, 18, 200, 199, 175, 152];
const NOSE = new Set([6, 197, 195, 5, 4, 1, 19, 94, 2]);
const HAIR = [10, 151]; // where it may hang
const HIGH = 400; // rows of the picture that is looked at
const FAR = [13, 45]; // of 255: difference from the background's colour, for an even and an uneven background
const LEAST = 0.06; // least share of the picture that a head covers
const SIZES = [0.22, 0.28, 0.35, 0.43, 0.52, 0.62]; // of the picture's height: forehead to chin
const ROUNDS = 40;
const TRIES = 6;
const TILT = 0.35; // rad: largest tilt of an upright profile
const MATCH = 1.25; // as unlike as a face's outline may be
const ALIKE = 0.6; // as much of the nose and the lips must be in it
const APART = 4; // mm: from one height to the next
const LEAP = 5; // mm from one height to another: as unlike as it can be
const SLOW = 0.1; // as much counts what is slow
const WORST = 12; // mm: as bad as it can be in a place
const MOST = 9; // mm of depth: what says more is hair, a hand, a collar
const WIDE = { nose: 11, other: 30 }; // mm to each side over which a part of the profile has the same depth, standard deviation
const ALONG = 7; // mm up and down

/** The picture, small. */
function shrunk({ width, height, data }) {
  const by = Math.max(1, height / HIGH);
  const [columns, rows] = [Math.floor(width / by), Math.floor(height / by)];
  const out = new Float32Array(3 * columns * rows);
  for (let r = 0; r < rows; r++)
    for (let c = 0; c < columns; c++) {
      const sum = [0, 0, 0];
      let count = 0;
      for (let y = Math.floor(r * by); y < Math.max(Math.floor(r * by) + 1, Math.floor((r + 1) * by)); y++)
        for (let x = Math.floor(c * by); x < Math.max(Math.floor(c * by) + 1, Math.floor((c + 1) * by)); x++) {
          for (let k = 0; k < 3; k++) sum[k] += data[4 * (y * width + x) + k];
          count++;
        }
      for (let k = 0; k < 3; k++) out[3 * (r * columns + c) + k] = sum[k] / count;
    }
  return { by, columns, rows, colours: out };
}

/**
 * 1 where the background is: what hangs together from the upper, left and right borders, and has about the colour that
 *   a plane through those has.
 */
function backgroundOf({ columns, rows, colours }) {
  const border = [];
  for (let c = 0; c < columns; c++) border.push(c);
  for (let r = 0; r < 0.5 * rows; r++) border.push(r * columns, (r + 1) * columns - 1);
  const plane = [0, 1, 2].map((k) =>
    planeOf(border.map((at) => [at % columns, Math.floor(at / columns), colours[3 * at + k]])),
  );
  const apart = (at) =>
    Math.max(
      ...plane.map(([a, b, c], k) => Math.abs(colours[3 * at + k] - a * (at % columns) - b * Math.floor(at / columns) - c)),
    );
  const usual = median(border.map(apart));
  const most = Math.min(FAR[1], Math.max(FAR[0], 5 * usual));
  const out = new Uint8Array(columns * rows);
  const queue = border.filter((at) => apart(at) < most);
  for (const at of queue) out[at] = 1;
  for (let n = 0; n < queue.length; n++)
    for (const next of beside(queue[n], columns, out.length)) {
      if (out[next] || apart(next) > most) continue;
      out[next] = 1;
      queue.push(next);
    }
  return out;
}

const beside = (at, columns, all) =>
  [at % columns ? at - 1 : -1, (at + 1) % columns ? at + 1 : -1, at - columns, at + columns].filter(
    (next) => next >= 0 && next < all,
  );

/** value = a x + b y + c, by least squares over what is within the usual. */
function planeOf(points) {
  let q = [0, 0, median(points.map(([, , value]) => value))];
  for (let round = 0; round < 6; round++) {
    const off = points.map(([x, y, value]) => Math.abs(value - q[0] * x - q[1] * y - q[2]));
    const usual = 2 * median(off) + 1;
    const m = [
      [1e-6, 0, 0, 0],
      [0, 1e-6, 0, 0],
      [0, 0, 1e-6, 0],
    ];
    points.forEach(([x, y, value], i) => {
      const w = 1 / (1 + (off[i] / usual) ** 2) ** 2;
      const row = [x, y, 1];
      for (let k = 0; k < 3; k++) for (let l = 0; l < 4; l++) m[k][l] += w * row[k] * (l < 3 ? row[l] : value);
    });
    const det = ([a, b, c]) =>
      a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    const whole = det(m);
    q = [0, 1, 2].map((k) => det(m.map((row) => row.slice(0, 3).map((x, l) => (l === k ? row[3] : x)))) / whole);
  }
  return q;
}

/** The largest thing before the background. */
function thingOf(background, columns) {
  const piece = new Int32Array(background.length);
  let [best, most, pieces] = [0, 0, 0];
  for (let start = 0; start < piece.length; start++) {
    if (background[start] || piece[start]) continue;
    piece[start] = ++pieces;
    const queue = [start];
    for (let n = 0; n < queue.length; n++) {
      const at = queue[n];
      for (const next of beside(at, columns, piece.length))
        if (!background[next] && !piece[next]) {
          piece[next] = pieces;
          queue.push(next);
        }
    }
    if (queue.length > most) [best, most] = [pieces, queue.length];
  }
  return { inside: (at) => piece[at] === best, share: most / piece.length };
}

/**
 * The outlines of what stands before the background, to the left and to the right, from the top down; pixels of the picture.
 * @param {{width: number, height: number, data: ArrayLike<number>}} picture
 * @returns {{left: number[][], right: number[][]}} @throws {PortraitError}
 */
export function outlinesOf(picture) {
  const small = shrunk(picture);
  const { by, columns, rows, colours } = small;
  const background = backgroundOf(small);
  const { inside, share } = thingOf(background, columns);
  if (share < LEAST || share > 0.95) throw new PortraitError('no_face', 'there is no face to be found in the picture');
  const between = (at, next) => {
    // where the colour is half way from the one to the other
    const far = (one, other) => Math.hypot(...[0, 1, 2].map((k) => colours[3 * one + k] - colours[3 * other + k]));
    const [within, without] = [2 * at - next, 2 * next - at];
    if (within < 0 || without < 0 || Math.max(within, without) >= columns * rows) return 0.5;
    const [whole, there] = [far(within, without), far(next, without)];
    return whole > 1 ? Math.min(1, there / whole) : 0.5;
  };
  const out = { left: [], right: [] };
  for (let r = 1; r < rows - 1; r++) {
    let [first, last] = [-1, -1];
    for (let c = 0; c < columns; c++) if (inside(r * columns + c)) [first, last] = [first < 0 ? c : first, c];
    if (first > 1)
      out.left.push([(first - between(r * columns + first, r * columns + first - 1)) * by + by / 2, (r + 0.5) * by]);
    if (last >= 0 && last < columns - 2)
      out.right.push([(last + between(r * columns + last, r * columns + last + 1)) * by + by / 2, (r + 0.5) * by]);
  }
  return out;
}

/** Converts an outline in pixels (forward, up) to mm on a head in that position, from bottom to top. */
function asHead(outline, { scale, tilt, u, v }) {
  const [c, s] = [Math.cos(tilt) / scale, Math.sin(tilt) / scale];
  return outline.map(([x, y]) => [c * (x - u) + s * (y - v), c * (y - v) - s * (x - u)]);
}

const asSeen = ({ scale, tilt, u, v }, [x, y]) => [
  u + scale * (Math.cos(tilt) * x - Math.sin(tilt) * y),
  v + scale * (Math.sin(tilt) * x + Math.cos(tilt) * y),
];

/**
 * Returns the most forward point of an outline at each height, mm; null: the outline does not reach it.
 * @param {number[]} heights from the top down
 */
function forwardAt(own, heights) {
  const out = heights.map(() => null);
  const [top, step] = [heights[0], heights[0] - heights[1]];
  for (let n = 1; n < own.length; n++) {
    const [p, q] = [own[n - 1], own[n]];
    const [high, low] = p[1] > q[1] ? [p, q] : [q, p];
    for (let i = Math.max(0, Math.ceil((top - high[1]) / step)); i < heights.length && heights[i] >= low[1]; i++) {
      const forward = high[0] + ((low[0] - high[0]) * (high[1] - heights[i])) / (high[1] - low[1] || 1);
      if (out[i] === null || forward > out[i]) out[i] = forward;
    }
  }
  return out;
}

/**
 * Returns the mean difference of an outline from a profile, mm, without its slow part: faces differ in that, but each has a
 * nose and lips.
 */
function unlike(profile, outline, stand) {
  const seen = forwardAt(asHead(outline, stand), profile.heights);
  const off = profile.forward.map((z, i) => (seen[i] === null ? null : Math.max(-WORST, Math.min(WORST, seen[i] - z))));
  let sum = 0;
  off.forEach((mm, i) => {
    const before = off[i - APART];
    sum +=
      mm === null
        ? LEAP
        : (before === undefined || before === null ? 0 : Math.min(LEAP, Math.abs(mm - before))) + SLOW * Math.abs(mm);
  });
  return sum / off.length;
}

/** Returns how much of the profile's nose and lips the outline has, 0 to 1: a ball has nothing of them. */
function likeness(profile, outline, stand) {
  const seen = forwardAt(asHead(outline, stand), profile.heights);
  const pairs = profile.forward.flatMap((z, i) => {
    const known = i >= APART && seen[i] !== null && seen[i - APART] !== null;
    return known ? [[z - profile.forward[i - APART], seen[i] - seen[i - APART]]] : [];
  });
  const mean = [0, 1].map((k) => pairs.reduce((sum, p) => sum + p[k], 0) / pairs.length);
  const [both, own, other] = pairs.reduce(
    ([ab, aa, bb], [a, b]) => [ab + (a - mean[0]) * (b - mean[1]), aa + (a - mean[0]) ** 2, bb + (b - mean[1]) ** 2],
    [0, 1e-9, 1e-9],
  );
  return both / Math.sqrt(own * other);
}

/** Steps downhill, each way by itself, ever smaller. */
function downhill(profile, outline, stand) {
  let [best, cost] = [stand, unlike(profile, outline, stand)];
  let steps = { scale: 0.06 * stand.scale, tilt: 0.06, u: 4 * stand.scale, v: 4 * stand.scale };
  for (let round = 0; round < ROUNDS; round++) {
    let better = false;
    for (const name of Object.keys(steps))
      for (const sign of [1, -1]) {
        const one = { ...best, [name]: best[name] + sign * steps[name] };
        if (Math.abs(one.tilt) > TILT || !(one.scale > 0)) continue;
        // the tip of the nose stays where it is while the size and the tilt change
        if (name === 'scale' || name === 'tilt') {
          const [was, is] = [asSeen(best, profile.tip), asSeen(one, profile.tip)];
          one.u += was[0] - is[0];
          one.v += was[1] - is[1];
        }
        const now = unlike(profile, outline, one);
        if (now < cost) [best, cost, better] = [one, now, true];
      }
    if (!better) steps = Object.fromEntries(Object.entries(steps).map(([name, x]) => [name, x / 2]));
  }
  return { stand: best, cost };
}

/** A profile out of the landmarks of the middle: how far forward it is at heights, every mm from the top down. */
function profileOf(at) {
  const points = MIDDLE.filter((i) => at[i]).map((i) => [at[i][2], at[i][1]]);
  const heights = [];
  for (let y = at[10][1]; y > at[152][1]; y -= 1) heights.push(y);
  return {
    heights,
    forward: forwardAt(points, heights).map((z, i, all) => z ?? all.find((other) => other !== null)),
    tip: [at[1][2], at[1][1]],
    points,
  };
}

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

/**
 * Locates a face in a picture from the side.
 * @param {{width: number, height: number}} picture @param {{left: number[][], right: number[][]}} outlines @param
 *   {(number[]|null)[]} at places of landmarks, mm
 * @returns {{way: 'left'|'right', outline: number[][], stand: object, cost: number, points: number[][]}} way: the
 *   direction in which it looks; outline: forward and up;
 *   points: where the landmarks of the middle are in the picture @throws {PortraitError}
 */
export function layProfile(picture, outlines, at) {
  const profile = profileOf(at);
  const tall = at[10][1] - at[152][1];
  const tries = [];
  for (const way of ['left', 'right']) {
    const sign = way === 'left' ? -1 : 1;
    const outline = outlines[way].map(([u, v]) => [sign * u, -v]);
    if (outline.length < 40) continue;
    const near = outline.length / 24;
    const tips = outline.filter(([x], i) =>
      outline.slice(Math.max(0, Math.round(i - near)), Math.round(i + near)).every(([other]) => other <= x),
    );
    for (const nose of tips)
      for (const size of SIZES) {
        const stand = { scale: (size * picture.height) / tall, tilt: 0, u: 0, v: 0 };
        const tip = asSeen(stand, profile.tip);
        Object.assign(stand, { u: nose[0] - tip[0], v: nose[1] - tip[1] });
        tries.push({ way, sign, outline, stand, cost: unlike(profile, outline, stand) });
      }
  }
  tries.sort((a, b) => a.cost - b.cost);
  let best = null;
  for (const one of tries.slice(0, TRIES)) {
    const found = downhill(profile, one.outline, one.stand);
    if (!best || found.cost < best.cost) best = { ...one, ...found };
  }
  if (!best || !(best.cost < MATCH) || !(likeness(profile, best.outline, best.stand) > ALIKE)) throw new PortraitError('no_face', 'there is no face to be found in the picture');
  return { ...best, points: profile.points.map((p) => asSeen(best.stand, p)).map(([x, y]) => [best.sign * x, -y]) };
}

/** Returns for each landmark of the middle how far the outline is in front of it, mm; the root of the nose is fixed. */
function depthsOf(picture, outlines, target) {
  const { outline, stand } = layProfile(picture, outlines, target);
  const { heights, forward } = profileOf(target);
  const seen = forwardAt(asHead(outline, stand), heights);
  const off = (y) => {
    const near = heights.flatMap((h, i) => (Math.abs(h - y) < 1.6 && seen[i] !== null ? [seen[i] - forward[i]] : []));
    return near.length ? near.reduce((a, b) => a + b) / near.length : null;
  };
  const root = median([8, 168, 6].filter((i) => target[i]).map((i) => off(target[i][1]) ?? 0));
  return new Map(
    MIDDLE.filter((i) => target[i])
      .map((i) => [i, off(target[i][1])])
      .filter(([i, mm]) => mm !== null && Math.abs(mm - root) < (HAIR.includes(i) ? MOST / 3 : MOST))
      .map(([i, mm]) => [i, mm - root]),
  );
}

/**
 * A face's shape, its depth as its profiles have it. @param {(number[]|null)[]} target places of landmarks as the front
 *   has them, mm
 * @param {{picture: object, outlines: object}[]} profiles @returns {(number[]|null)[]}
 */
export function withProfiles(target, profiles) {
  const told = profiles.flatMap(({ picture, outlines }) => {
    try {
      return [depthsOf(picture, outlines, target)];
    } catch (error) {
      if (error instanceof PortraitError) return []; // it was like another head
      throw error;
    }
  });
  const depths = MIDDLE.flatMap((i) => {
    const list = told.flatMap((one) => (one.has(i) ? [one.get(i)] : []));
    return list.length ? [{ i, mm: list.reduce((a, b) => a + b) / list.length }] : [];
  });
  return target.map((p) => {
    if (!p) return null;
    let [sum, total, most] = [0, 1e-9, 0];
    for (const { i, mm } of depths) {
      const [x, y] = [target[i][0] - p[0], target[i][1] - p[1]];
      const w = Math.exp(-0.5 * (y / ALONG) ** 2);
      const share = Math.exp(-0.5 * (x / (NOSE.has(i) ? WIDE.nose : WIDE.other)) ** 2);
      sum += w * share * mm;
      total += w;
      most = Math.max(most, w);
    }
    return [p[0], p[1], p[2] + (Math.min(1, 2 * most) * sum) / total];
  });
}
