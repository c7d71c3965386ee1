// SPDX-License-Identifier: MIT
// What a picture shows of hair, beard and glasses, as numbers about places on and around the face. Each is relative to the
// face's own skin, so that light and skin tone matter little. What the numbers mean was learnt from photographs
// (traits-learnt.mjs).
import { piece } from './detect.mjs';
import { lab } from './lab.mjs';
import { linear, toneOf } from './skin.mjs';
import { LEARNT } from './traits-learnt.mjs';

const TALL = 200; // pixels of the face's height, to which a picture is brought
const REACH = { up: 1.75, down: -0.75, side: 1.15 }; // of the face's height above its chin; of its width from its middle

/** Places of the eyes' picture: columns from temple to temple, rows from above the brows to below the eyes' shadows. */
const EYES = { columns: 12, rows: 5, wide: 1.5, above: 0.42, below: 0.62 }; // in distances of the eyes' outer corners
const LOWER = {
  lip: [164, 167, 393, 165, 391, 92, 322],
  chin: [200, 199, 175, 152, 201, 421, 208, 428],
  side: [210, 430, 211, 431, 170, 395, 169, 394, 135, 364],
  jaw: [58, 288, 172, 397, 215, 435, 138, 367, 192, 416],
};
const ROWS = [1.05, 0.85, 0.65, 0.45, 0.25, 0.05, -0.15]; // beside the face: of its height above the chin
const ASIDE = [0.56, 0.66, 0.78, 0.92]; // of its width from the middle
const CROWN = [1.03, 1.09, 1.16, 1.24, 1.34, 1.46]; // above it
const ABOVE = [1.12, 1.18]; // where its hair is looked at
const ACROSS = [0, 0.14, 0.28, 0.42];

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];
const middle = (list) => list.reduce((sum, x) => sum + x, 0) / list.length;
const cut = (x) => Math.max(-2, Math.min(2, x));

/** The head in CIELAB, as large for every picture, with places told in the face's own measures. */
function canvas(picture, landmarks) {
  const [top, chin, right, left] = [10, 152, 234, 454].map((i) => landmarks[i]);
  const [up, side] = [[top[0] - chin[0], top[1] - chin[1]], [left[0] - right[0], left[1] - right[1]]];
  const at = (rise, across) => [0, 1].map((k) => chin[k] + rise * up[k] + across * side[k]);
  const corners = [REACH.up, REACH.down].flatMap((rise) => [-REACH.side, REACH.side].map((across) => at(rise, across)));
  const [low, high] = [Math.min, Math.max].map((most) => [0, 1].map((k) => most(...corners.map((p) => p[k]))));
  const size = high.map((x, k) => x - low[k]);
  const longest = Math.round((TALL * Math.max(...size)) / Math.hypot(...up));
  const { data, width, height, scale } = piece(picture, { x: low[0], y: low[1], size }, longest);
  const seen = ([x, y]) => x >= 0 && y >= 0 && x < picture.width && y < picture.height;
  const pixel = ([x, y]) => {
    const [i, j] = [(x - low[0]) * scale, (y - low[1]) * scale].map(Math.round);
    const p = 3 * (Math.min(height - 1, Math.max(0, j)) * width + Math.min(width - 1, Math.max(0, i)));
    return lab([0, 1, 2].map((k) => linear[data[p + k]]));
  };
  return { at, seen, pixel, step: 1 / scale };
}

const around = (view, [x, y], far) =>
  [-far, 0, far].flatMap((dx) => [-far, 0, far].map((dy) => view.pixel([x + dx, y + dy])));
const medians = (colours) => [0, 1, 2].map((k) => median(colours.map((c) => c[k])));
const differs = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

/** Edges about the eyes, by place: frames of glasses are edges where skin has none. */
function eyeEdges(view, landmarks, skin) {
  const [right, left] = [landmarks[33], landmarks[263]];
  const along = [left[0] - right[0], left[1] - right[1]];
  const down = [-along[1], along[0]];
  const centre = [(right[0] + left[0]) / 2, (right[1] + left[1]) / 2];
  const { columns, rows, wide, above, below } = EYES;
  const fine = 4; // samples of a cell, in both directions
  const light = (i, j) => {
    const [u, v] = [wide * ((i + 0.5) / (columns * fine) - 0.5), -above + ((above + below) * (j + 0.5)) / (rows * fine)];
    return view.pixel([0, 1].map((k) => centre[k] + u * along[k] + v * down[k]))[0];
  };
  const grid = Array.from({ length: rows * fine }, (_, j) => Array.from({ length: columns * fine }, (__, i) => light(i, j)));
  const out = [];
  for (let row = 0; row < rows; row++)
    for (let column = 0; column < columns / 2; column++) {
      const edges = [[], []];
      for (const c of [column, columns - 1 - column])
        for (let j = row * fine; j < (row + 1) * fine; j++)
          for (let i = c * fine; i < (c + 1) * fine; i++) {
            const here = grid[j][i];
            if (i + 1 < columns * fine) edges[0].push(Math.abs(grid[j][i + 1] - here));
            if (j + 1 < rows * fine) edges[1].push(Math.abs(grid[j + 1][i] - here));
          }
      out.push(...edges.map((list) => cut((8 * middle(list)) / (20 + skin[0]))));
    }
  return out;
}

/** Colour and texture of the lower face, by region. */
function lowerFace(view, landmarks, skin) {
  return Object.values(LOWER).flatMap((numbers) => {
    const colours = numbers.map((i) => around(view, landmarks[i], 2 * view.step));
    const tone = medians(colours.flat()).map((x, k) => (x - skin[k]) / 20);
    const rough = median(colours.map((list) => Math.max(...list.map(([l]) => l)) - Math.min(...list.map(([l]) => l)))) / 20;
    return [...tone, rough].map(cut);
  });
}

/** Above and beside the face: how unlike the skin, the hair and the picture's border it is. */
function aroundFace(view, skin, hair, picture) {
  const border = (y) => [0.02, 0.98].map((x) => view.pixel([x * picture.width, y]));
  const cell = (places) => {
    const all = places.filter(view.seen).map((place) => {
      const c = medians(around(view, place, 2 * view.step));
      return [(c[0] - skin[0]) / 30, Math.hypot(c[1] - skin[1], c[2] - skin[2]) / 20, differs(c, hair) / 25,
        Math.min(...border(place[1]).map((b) => differs(c, b))) / 25];
    });
    return (all.length ? [0, 1, 2, 3].map((k) => middle(all.map((one) => one[k]))) : [0, 0.5, 1, 0.5]).map(cut);
  };
  const both = (rise, across) => cell([view.at(rise, across), view.at(rise, -across)]);
  return {
    crown: CROWN.flatMap((rise) => ACROSS.flatMap((across) => both(rise, across))),
    beside: ROWS.flatMap((rise) => ASIDE.flatMap((across) => both(rise, across))),
  };
}

/**
 * @param {{width: number, height: number, data: ArrayLike<number>}} picture RGBA, upright @param {number[][]} landmarks
 * @returns {Record<'eyes'|'lower'|'crown'|'beside', number[]>} about -2 to 2 each
 */
export function measure(picture, landmarks) {
  const view = canvas(picture, landmarks);
  const skin = lab(toneOf(picture, landmarks));
  const above = ABOVE.flatMap((rise) => [-0.2, -0.1, 0, 0.1, 0.2].map((across) => view.at(rise, across))).filter(view.seen);
  // or a bald head's skin
  const hair = above.length ? medians(above.flatMap((place) => around(view, place, 2 * view.step))) : skin;
  const face = { eyes: eyeEdges(view, landmarks, skin), lower: lowerFace(view, landmarks, skin) };
  return { ...face, ...aroundFace(view, skin, hair, picture) };
}

/**
 * What is seen of a person: 'yes', 'no', or 'unsure' where it was wrong too often with the photographs that it was learnt from.
 * @typedef {Record<'glasses'|'beard'|'moustache'|'bald'|'long', 'yes'|'no'|'unsure'>} Traits long: hair beside jaw and neck
 */

const scoreOf = (measured, { from, weights, bias }) => measured[from].reduce((sum, x, i) => sum + x * weights[i], bias);

/** @param {object} measured of `measure` @returns {Traits} */
export const traitsOf = (measured) => Object.fromEntries(Object.entries(LEARNT).map(([name, trait]) => {
  const score = scoreOf(measured, trait);
  return [name, score >= trait.yes ? 'yes' : score <= trait.no ? 'no' : 'unsure'];
}));

/** What is proposed, though it may be unsure. @param {object} measured of `measure` @param {keyof Traits} name */
export const isLikely = (measured, name) => scoreOf(measured, LEARNT[name]) >= LEARNT[name].likely;

const LENGTH = 2; // how much more the length of hair counts than its height or width

/** How much of the places of some rows is hair: neither skin nor what stands behind. */
function share(list, rows, across) {
  const cells = rows.flatMap((row) => Array.from({ length: across }, (_, i) => 4 * (row * across + i)));
  const within = (x) => Math.min(1, Math.max(0, x));
  return middle(cells.map((at) => within(1 - list[at + 2]) * within(2 * list[at + 3])));
}

/**
 * The form of hair, 0 to 1 each: how likely it is long, how high it is above the forehead, how wide beside the temples,
 * beside the cheeks and below the chin.
 * @param {object} measured of `measure` @returns {number[]}
 */
export function hairForm(measured) {
  const long = 1 / (1 + Math.exp(-scoreOf(measured, LEARNT.long)));
  const high = share(measured.crown, [2, 3, 4, 5], ACROSS.length);
  const [wide, chin, neck] = [[0, 1], [2, 3, 4], [5, 6]].map((rows) => share(measured.beside, rows, ASIDE.length));
  return [long, high, wide, chin, neck].map((x) => Math.round(100 * x) / 100);
}

/**
 * Names of heads by how much their hair's form is a picture's, the most similar first.
 * @param {Record<string, {hair: number[]}>} table
 */
export function similarHair(measured, table) {
  const seen = hairForm(measured);
  const far = ({ hair }) => hair.reduce((sum, x, i) => sum + (i ? 1 : LENGTH) * (x - seen[i]) ** 2, 0);
  return Object.keys(table).sort((a, b) => far(table[a]) - far(table[b]));
}
