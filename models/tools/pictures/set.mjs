// SPDX-License-Identifier: GPL-3.0-or-later
/** Makes a set of pictures (protocol/pictures.md) from suitable photographs. */
import zlib from 'node:zlib';
import { LOWER_LIP, OVAL, UPPER_LIP } from '../../../web/portrait/landmarks.mjs';
import { eyeRegions } from './eyes.mjs';
import { placed } from './frame.mjs';
import { even } from './light.mjs';
import { SIZE } from './look.mjs';
import { COLUMNS, maskOf, round, sheetOf, within, written } from './sheet.mjs';

export const MOST_BYTES = 765000; // in the transmitted size
const LIPS = [61, ...UPPER_LIP[0], 291, ...[...LOWER_LIP[0]].reverse()];
const FRAME = 36; // pixels over which the outer border fades, because the picture sways with the head
const FACE = 0.97; // of the oval: the area that may change
const BELOW = 14; // pixels below the lowest chin over which the picture fades out
const STEPS = [0.25, 0.5, 0.75, 1];
const ABOUT = 1.3; // the lips and the area that moves with them
const QUALITIES = [86, 80, 72, 62, 50, 38];
const REACH = 1.265; // of the eyes' distance: distance of the face in front of its axis of rotation
const PIVOT = 0.5; // of it, below the eyes

const scaled = (contour, by) => {
  const middle = [0, 1].map((k) => contour.reduce((sum, p) => sum + p[k], 0) / contour.length);
  return contour.map((p) => p.map((x, k) => middle[k] + by * (x - middle[k])));
};
const contourOf = (points, which) => which.map((i) => points[i].slice(0, 2));

/** Mouth and chin, as in sets of built heads. */
function mouthBox(rest, all, fapu) {
  const [right, left] = rest.anchors;
  const chin = Math.max(...all.map(({ anchors }) => anchors[4][1]));
  const half = 0.95 * (left[0] - right[0]);
  const [x, y] = [Math.floor((left[0] + right[0]) / 2 - half), Math.floor(rest.points[2][1] - 0.9 * fapu.MNS)];
  const bottom = Math.min(SIZE.height, Math.ceil(Math.max(rest.anchors[4][1] + 1.15 * fapu.MNS, chin + 0.5 * fapu.MNS)));
  return { x, y, width: Math.ceil(2 * half), height: bottom - y };
}

/** Mask of the picture: the face, and the area that the jaw reaches as the mouth opens. */
function shownIn(rest, all, box) {
  const face = contourOf(rest.points, OVAL);
  const [, , , , [, chin]] = rest.anchors;
  const drop = Math.max(...all.map(({ anchors }) => anchors[4][1])) - chin + BELOW;
  const still = scaled(face, FACE);
  const jaws = STEPS.map((step) => face.map(([x, y]) => [x, y + step * drop]));
  return (x, y) => within(still, x + box.x, y + box.y) || (y + box.y > rest.anchors[3][1] && jaws.some((jaw) => within(jaw, x + box.x, y + box.y)));
}

/** Share of a pixel that is even skin in both pictures. */
function skinOf(rest, seen, box) {
  const face = scaled(contourOf(rest.points, OVAL), FACE);
  const lips = [rest, seen].map(({ points }) => scaled(contourOf(points, LIPS), ABOUT));
  return Float32Array.from({ length: box.width * box.height }, (_, i) => {
    const [x, y] = [box.x + (i % box.width), box.y + Math.floor(i / box.width)];
    return Number(within(face, x, y) && !lips.some((contour) => within(contour, x, y)));
  });
}

/** Fades the picture out towards its border. */
function framed(image) {
  const { width, height, data } = image;
  const clear = Float32Array.from({ length: width * height }, (_, i) => data[4 * i + 3] / 255);
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) {
      const t = Math.min(1, Math.min(x + 1, y + 1, width - x, height - y) / FRAME);
      data[4 * (y * width + x) + 3] = 255 * clear[y * width + x] * t * t * (3 - 2 * t);
    }
  return image;
}

/**
 * @param {object} rest measurements (look.mjs) @param {{pose: {name: string, faps: object}, seen: object}[]} fit photographs in the order of
 *   poses, starting with `rest` @param {object|null} blink @param {object} fapu pixels @param {{name: string, title: string, licence: string,
 *   credits: string[]}} said
 * @returns {Promise<{set: object, bytes: number, cut: string[]}>} bytes: compressed size; cut: poses whose mouth is cut by the border @throws
 *   {Error} if the set cannot be made small enough
 */
export async function makeSet(rest, fit, blink, fapu, said) {
  const box = mouthBox(rest, fit.map(({ seen }) => seen), fapu);
  const ground = placed(rest.picture, rest.onto, box);
  const mask = maskOf(box, shownIn(rest, fit.map(({ seen }) => seen), box));
  const whole = ({ data }) => !data.some((value, i) => i % 4 === 3 && value < 255 && within(mask.outer, (i >> 2) % box.width, Math.floor((i >> 2) / box.width)));
  const drawn = [];
  const cut = [];
  for (const { pose, seen } of fit) {
    const picture = placed(seen.picture, seen.onto, box);
    if (!whole(picture)) {
      cut.push(pose.name);
      continue;
    }
    if (seen !== rest) even(picture, ground, skinOf(rest, seen, box));
    drawn.push({ picture, name: pose.name, faps: pose.faps, anchors: seen.anchors.map(([x, y]) => [round(x - box.x), round(y - box.y)]) });
  }
  const mouth = { name: 'mouth', ...box, mask, columns: COLUMNS, pixels: sheetOf(drawn.map(({ picture }) => picture), box), pictures: drawn.map(({ picture, ...one }) => one) };
  const regions = [mouth, ...(blink ? eyeRegions(rest, blink, fapu) : [])];
  const base = framed(placed(rest.picture, rest.onto, { x: 0, y: 0, ...SIZE }));
  const measured = Object.fromEntries(Object.entries(fapu).map(([name, value]) => [name, round(value)]));
  const [[rx, ry], [lx, ly]] = [rest.points[33], rest.points[263]];
  const pivot = [round((rx + lx) / 2), round((ry + ly) / 2 + PIVOT * fapu.ES)];
  for (const quality of QUALITIES) {
    const sheets = [];
    for (const { pixels, ...region } of regions) sheets.push({ ...region, sheet: await written(pixels, quality) });
    const set = { format: 'faccia-pictures', version: 1, ...said, ...SIZE, fapu: measured, pivot, reach: round(REACH * fapu.ES), base: await written(base, quality, true), regions: sheets };
    const bytes = zlib.gzipSync(JSON.stringify(set), { level: 9 }).length;
    if (bytes <= MOST_BYTES) return { set, bytes, cut };
  }
  throw new Error(`the pictures do not go into ${MOST_BYTES} bytes`);
}
