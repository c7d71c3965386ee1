// SPDX-License-Identifier: GPL-3.0-or-later
/** Makes blinks from a picture with open eyes and one with closed eyes: the closed lid slides down over the eye. */
import { EYES } from '../../../web/portrait/landmarks.mjs';
import { even } from './light.mjs';
import { placed } from './frame.mjs';
import { COLUMNS, maskOf, sheetOf } from './sheet.mjs';

const SHUT = [0, 0.25, 0.5, 0.75, 1];
const [UPPER, LOWER] = [940, 84]; // FAP units of closed lids
const MEET = 0.8; // share of the way down at which the lids meet
const SOFT = 1.5; // pixels of the lid's rim
const REGIONS = [['eye_l', 'left', 19, 21], ['eye_r', 'right', 20, 22]];

/** Rows of a margin by columns, straight between its points. */
function rowsOf(points, box) {
  const line = points.map(([x, y]) => [x - box.x, y - box.y]).sort((a, b) => a[0] - b[0]);
  return Float32Array.from({ length: box.width }, (_, x) => {
    const after = line.findIndex(([u]) => u > x);
    if (after <= 0) return after < 0 ? line.at(-1)[1] : line[0][1];
    const [[ax, ay], [bx, by]] = [line[after - 1], line[after]];
    return ay + ((x - ax) / (bx - ax || 1)) * (by - ay);
  });
}

function mixedInto(out, at, open, shut, row, x, share, { width, height }) {
  const y = Math.min(height - 1.001, Math.max(0, row));
  const [p, f] = [Math.floor(y), y - Math.floor(y)];
  for (let k = 0; k < 3; k++) {
    const lid = shut[4 * (p * width + x) + k] * (1 - f) + shut[4 * ((p + 1) * width + x) + k] * f;
    out[at + k] = lid * share + open[at + k] * (1 - share);
  }
}

/** Draws the lid partly closed: above its rim is the closed eye's skin, at the same distance from the rim as when closed. */
function lidAt(shut, open, closed, upper, lower, box) {
  if (shut === 0) return open;
  if (shut === 1) return closed;
  const data = new Uint8ClampedArray(open.data);
  for (let x = 0; x < box.width; x++) {
    const meet = upper[x] + MEET * (lower[x] - upper[x]);
    const rim = upper[x] + shut * (meet - upper[x]);
    for (let y = 0; y < box.height; y++) {
      const share = Math.min(1, Math.max(0, (rim - y) / SOFT + 0.5));
      if (share) mixedInto(data, 4 * (y * box.width + x), open.data, closed.data, y + (meet - rim) * Math.min(1, y / (rim || 1)), x, share, box);
    }
  }
  return { ...open, data };
}

/** @param {object} rest as seen @param {object} blink as seen @param {object} fapu pixels @returns {object[]} regions, with `sheet` as pixels */
export function eyeRegions(rest, blink, fapu) {
  return REGIONS.map(([name, side, up, down]) => {
    const { outer, inner, upper, lower } = EYES[side];
    const [x, y] = [0, 1].map((k) => (rest.points[outer][k] + rest.points[inner][k]) / 2);
    const box = { x: Math.round(x - 0.36 * fapu.ES), y: Math.round(y - 0.3 * fapu.ES), width: Math.round(0.72 * fapu.ES), height: Math.round(0.6 * fapu.ES) };
    const [open, closed] = [rest, blink].map(({ picture, onto }) => placed(picture, onto, box));
    const [top, bottom] = [upper, lower].map((list) => rowsOf([outer, ...list, inner].map((i) => rest.points[i]), box));
    const skin = Float32Array.from({ length: box.width * box.height }, (_, i) => {
      const [column, row] = [i % box.width, Math.floor(i / box.width)];
      return Number(row > bottom[column] + 0.06 * fapu.ES || row < top[column] - 0.14 * fapu.ES);
    });
    even(closed, open, skin);
    const frames = SHUT.map((shut) => lidAt(shut, open, closed, top, bottom, box));
    return {
      name, ...box, mask: maskOf(box, () => true), columns: COLUMNS, pixels: sheetOf(frames, box),
      pictures: SHUT.map((shut) => ({ name: `closed ${shut}`, faps: shut ? { [up]: Math.round(shut * UPPER), [down]: Math.round(shut * LOWER) } : {} })),
    };
  });
}
