// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Places teeth and tongue in a face, from anatomical figures. Visible incisors at rest with parted lips: Vig and Brundo 1978 (women 3.4 mm
 * of the upper and 0.5 of the lower ones, men 1.9 and 1.2) and, for age, da Motta and others (the upper ones show less with age, the lower
 * ones more).
 */
import { MOUTH_CONTACT } from './hm08.mjs';
import { clamp, piecewise, smoothstep } from './zones.mjs';

/** Years, mm of the upper incisors, mm of the lower ones. */
const SHOWN = {
  female: [
    [13, 4.5, 0.5],
    [30, 3.4, 0.5],
    [55, 1.3, 2.2],
  ],
  male: [
    [13, 3.4, 0.6],
    [30, 1.9, 1.2],
    [55, 0.6, 3.1],
  ],
};
const AGES = { baby: 2, child: 9, young: 25, old: 70 };

/** Share of the opening by which the upper lip rises, as in server/face/engines/fapmap.c. */
export const UPPER_SHARE = 0.3;
/** Between the edges of the teeth when the jaw hangs at rest, mm. */
export const EDGES_APART = 0.3;
/** The jaw's mouth of this width has teeth of average size. */
const AVERAGE_WIDTH = 50;

/**
 * Completes the recipe's `mouth`: sex and age from the macro targets of `shape`, the rest from these two.
 */
export function mouthFigures(recipe) {
  const given = recipe.mouth ?? {};
  const guess = fromShape(recipe.shape);
  const male = given.sex ? Number(given.sex === 'male') : guess.male;
  const age = given.age ?? guess.age;
  const shown = (k) => {
    const [female, man] = ['female', 'male'].map((sex) =>
      piecewise(
        SHOWN[sex].map((row) => row[0]),
        SHOWN[sex].map((row) => row[k]),
        age,
      ),
    );
    return female + (man - female) * male;
  };
  return {
    upperShown: shown(1),
    lowerShown: shown(2),
    overbite: 2,
    overjet: 2,
    clearance: 1.2,
    archScale: null,
    wear: clamp((age - 30) / 45, 0, 1),
    uneven: clamp(0.3 + (age - 20) / 70, 0.2, 1), // 0: teeth in a perfect row
    name: recipe.name ?? '',
    ...given,
    male,
    age,
  };
}

function fromShape(shape) {
  let weight = 0,
    male = 0,
    age = 0;
  for (const [name, w] of Object.entries(shape)) {
    const match = /^macrodetails\/[a-z]+-(female|male)-(baby|child|young|old)/.exec(name);
    if (!match) continue;
    weight += w;
    male += w * Number(match[1] === 'male');
    age += w * AGES[match[2]];
  }
  return weight ? { male: male / weight, age: age / weight } : { male: 0.5, age: AGES.young };
}

/** FAP-like lengths of the face with its lips parted at rest, mm: upper lip up, lower lip and jaw down. */
export function partedLips({ upperShown, lowerShown, overbite }) {
  const gap = upperShown + EDGES_APART + lowerShown;
  return { up: UPPER_SHARE * gap, down: (1 - UPPER_SHARE) * gap, jaw: overbite + EDGES_APART };
}

/**
 * The outer surface of the upper arch: mm behind its front by mm beside the middle, for teeth of average size
 * (17 mm beside the middle, where the canine is, 7 mm; 27 mm at the second molar 28 mm).
 */
const behind = (x) => 0.01138 * x * x + 3.75e-5 * x ** 4;

/** A path along an arch: place and direction by the length of the way from the middle, negative to the right. */
export function archPath({ scale, front, inset }) {
  const step = 0.05;
  const line = [];
  for (let x = 0; x <= 34; x += step) {
    const slope = 0.02276 * x + 15e-5 * x ** 3;
    const l = Math.hypot(1, slope);
    // Outward from the arch: (slope, 1), for z forward.
    const out = [slope / l, 1 / l];
    line.push([x * scale - inset * out[0], front - behind(x) * scale - inset * out[1], ...out]);
  }
  const way = [0];
  for (let i = 1; i < line.length; i++)
    way.push(way[i - 1] + Math.hypot(line[i][0] - line[i - 1][0], line[i][1] - line[i - 1][1]));
  return (s) => {
    const [x, z, ox, oz] = [0, 1, 2, 3].map((k) =>
      piecewise(
        way,
        line.map((q) => q[k]),
        Math.abs(s),
      ),
    );
    const side = s < 0 ? -1 : 1;
    return { x: side * x, z, out: [side * ox, 0, oz] };
  };
}

/**
 * The place of the teeth in this face: height of the upper incisors' edge, z of the arch's front, scale.
 * The front is as far forward as the inside of the lips allows.
 */
export function placeTeeth(ctx, figures) {
  const { fdp, fapu, p, grid } = ctx;
  const line = (fdp['2.2'][1] + fdp['2.3'][1]) / 2;
  const edge = line + partedLips(figures).up - figures.upperShown;
  const scale = figures.archScale ?? clamp(fapu.MW / AVERAGE_WIDTH, 0.85, 1.12);
  let room = Infinity;
  for (const loops of [ctx.topology.mouth.l, ctx.topology.mouth.r]) {
    for (const v of loops.slice(MOUTH_CONTACT, 13).flat()) {
      const [x, y, z] = [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]];
      if (Math.abs(x) > 16 || y < edge - 1 || y > edge + 9 * scale) continue;
      const lower = grid.lower[v] > 0.5;
      room = Math.min(room, z + behind(Math.abs(x) / scale) * scale * (lower ? 0.9 : 1));
    }
  }
  return { line, edge, scale, front: room - figures.clearance };
}

/** Rest position of the tongue's tip: above the upper edge and behind the arch's front; mm for average teeth. */
const TIP = { above: 1.5, behind: 6.8 };
const TONGUE = { width: 0.72, length: 0.95, tip: 0.5, body: 0.85, taper: 16 };

/**
 * Moves the base mesh's tongue between the arches: narrower, to fit between the molars, with a thin tip behind the upper incisors.
 */
export function placeTongue(ctx, tipVertex, place) {
  const { p } = ctx;
  const mine = ctx.inGroup('helper-tongue');
  const tip = [0, 1, 2].map((k) => p[tipVertex * 3 + k]);
  const y = place.edge + TIP.above * place.scale,
    z = place.front - TIP.behind * place.scale;
  // The middle of its thickness, so that the tip thins from both sides.
  const middle = tip[1] - 1;
  for (let v = 0; v < mine.length; v++) {
    if (!mine[v]) continue;
    const back = Math.max(0, tip[2] - p[v * 3 + 2]);
    const high = TONGUE.tip + (TONGUE.body - TONGUE.tip) * smoothstep(0, TONGUE.taper, back);
    p[v * 3] *= TONGUE.width * place.scale;
    p[v * 3 + 1] = y + (p[v * 3 + 1] - middle) * high * place.scale;
    p[v * 3 + 2] = z + (p[v * 3 + 2] - tip[2]) * TONGUE.length * place.scale;
  }
}
