// SPDX-License-Identifier: GPL-3.0-or-later
// Tones of a portrait: of cheeks and of the whole face, of hair in light and shade; furrows of old skin. On painted pictures, whose truth is known.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { drawFurrows } from '../../web/portrait/furrows.mjs';
import { hairOf, sideHairOf } from '../../web/portrait/hair.mjs';
import { lab, unlab } from '../../web/portrait/lab.mjs';
import { COUNT, SKIN } from '../../web/portrait/landmarks.mjs';
import { beforeFilm } from '../../web/portrait/sheen.mjs';
import { coded, linear } from '../../web/portrait/skin.mjs';
import { litShare, ratiosOf, within } from '../../web/portrait/tone.mjs';

const matt = { was: 0, is: 0 };
const far = (a, b) => Math.hypot(...lab(a).map((x, k) => x - lab(b)[k]));

test('cheeks and the rest of a face each come to be as light as in the picture, and not more unlike each other than a face may be', () => {
  const drawn = { cheeks: [0.5, 0.3, 0.2], face: [0.3, 0.17, 0.11] };
  const seen = { cheeks: [0.3, 0.17, 0.11], face: [0.2, 0.11, 0.075] };
  const { all, lit } = ratiosOf(seen, drawn, matt);
  assert.ok(far(drawn.cheeks.map((x, k) => x * all[k] * lit[k]), within(seen.cheeks)) < 0.5);
  assert.ok(far(drawn.face.map((x, k) => x * all[k]), within(seen.face)) < 0.5);
  const lightest = ratiosOf(seen, drawn, matt, 1).all;
  assert.ok(lightest.every((x, k) => x / all[k] > 1.6), `a stop: ${lightest} after ${all}`);

  const hard = ratiosOf({ cheeks: [0.6, 0.4, 0.3], face: [0.06, 0.04, 0.03] }, drawn, matt);
  assert.ok(hard.lit.every((x) => x > 1.2 && x < 1.6), `a face that is lit from one side: ${hard.lit}`);
  // what the film presses is not taken for the skin's own
  const pale = { cheeks: [0.9, 0.7, 0.6], face: [0.5, 0.36, 0.28] };
  const again = ratiosOf(pale, pale, matt);
  assert.ok(again.all.every((x, k) => Math.abs(Math.log(x / beforeFilm(within(pale.face))[k] * beforeFilm(pale.face)[k])) < 0.12), `${again.all}`);
});

test('orange and pink of the light are held back, what skin may be is kept', () => {
  const [orange, pink, skin] = [[60, 35, 34], [70, 27, 6], [62, 14, 20]].map(unlab);
  for (const [tone, what] of [[orange, 'orange'], [pink, 'pink']]) {
    const [l, a, b] = lab(within(tone));
    const [, x, y] = lab(tone);
    assert.ok(far(within(tone), tone) > 2 && Math.abs(l - lab(tone)[0]) < 1, what);
    assert.ok(what === 'pink' ? Math.atan2(b, a) > Math.atan2(y, x) + 0.1 : Math.hypot(a, b) < Math.hypot(x, y) - 4, what);
  }
  assert.ok(far(within(skin), skin) < 0.01);
  const [tan, light] = [[56, 24, 29], [76, 24, 29]].map(unlab);
  assert.ok(far(within(tan), tan) < 0.01, 'tan skin is more colourful than light skin');
  assert.ok(far(within(light), light) > 1, 'light skin that is so colourful is lit so');
  assert.ok(far(within(orange), orange) < far(within(orange), unlab([60, 14, 14])), 'orange is no more than held back');
});

test('what is near cheeks and forehead is lit as they are', () => {
  const share = litShare(Float32Array.from([0, 0, 0, 5, 0, 0, 16, 0, 0, 40, 0, 0]), [[0, 0, 0], [-30, 0, 0]]);
  assert.deepEqual([share[0], share[1], share[3]], [1, 1, 0]);
  assert.ok(share[2] > 0.2 && share[2] < 0.8, `${share[2]}`);
});

/** A face before a backdrop: hair begins above the forehead as dark as `root` and is `tip` farther on; beside the face it is `tip`. */
function painted(skin, root, tip, backdrop = [30, 0, -20]) {
  const [width, height] = [400, 500];
  const data = new Uint8ClampedArray(4 * width * height);
  const [x0, top, chin, half] = [200, 200, 380, 70];
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) {
      const inFace = Math.hypot((x - x0) / half, (y - (top + chin) / 2) / ((chin - top) / 2 + 12)) < 1;
      const inHair = Math.hypot((x - x0) / (half + 50), (y - 260) / 160) < 1 && y < 330;
      const above = top - 12 - y;
      const colour = inFace ? skin : !inHair ? backdrop : above > 0 && above < 18 ? root : tip;
      data.set([...unlab(colour).map((c) => coded(Math.min(1, c))), 255], 4 * (y * width + x));
    }
  const landmarks = Array.from({ length: COUNT }, () => [x0, (top + chin) / 2, 0]);
  for (const [i, p] of [[10, [x0, top, 0]], [152, [x0, chin, 0]], [234, [x0 - half, 290, 0]], [454, [x0 + half, 290, 0]]]) landmarks[i] = p;
  SKIN.forEach((i, n) => (landmarks[i] = [x0 - 30 + 3 * n, 300, 0]));
  return [{ width, height, data }, landmarks];
}

test('blond hair with dark roots is blond, grey hair is grey, and black hair stays black under its gloss', () => {
  const skin = [74, 14, 18];
  const blond = hairOf(...painted(skin, [38, 7, 20], [62, 8, 28]));
  assert.equal(blond.kind, 'hair');
  const [l, a, b] = lab(blond.colour);
  assert.ok(l > 54 && b > 22, `blond: ${[l, a, b]}`);
  const white = lab(hairOf(...painted(skin, [70, 0, 4], [86, 0, 5])).colour);
  assert.ok(white[0] > 74 && Math.hypot(white[1], white[2]) < 10, `white: ${white}`);
  const black = lab(hairOf(...painted(skin, [8, 1, 2], [13, 1, 2])).colour);
  assert.ok(black[0] < 14, `black: ${black}`);
  const beside = sideHairOf(...painted([86, 12, 8], [86, 12, 8], [66, 8, 27]));
  assert.ok(beside && far(beside, unlab([66, 8, 27])) < 6, `blond beside pale skin: ${beside && lab(beside)}`);
});

test('furrows come with age, where faces have them', () => {
  const size = 256; // texels, two a mm
  const position = Float32Array.from([-64, 0, 4, 64, 0, 4, -64, 128, 4, 64, 128, 4]);
  const mesh = { position, uv: Float32Array.from([0, 0, 1, 0, 0, 1, 1, 1]), index: Uint16Array.from([0, 1, 2, 1, 3, 2]) };
  const places = Array.from({ length: COUNT }, () => null);
  [104, 69, 108, 151, 337, 299, 333].forEach((i, n) => (places[i] = [-36 + 12 * n, 90, 4]));
  const drawn = (years) => {
    const data = new Uint8ClampedArray(4 * size * size).fill(150);
    drawFurrows({ width: size, height: size, data }, mesh, places, years, { linear, coded });
    return data;
  };
  const darkest = (data, from, to) => {
    let least = 255;
    for (let y = from; y < to; y++) for (let x = 90; x < 166; x++) least = Math.min(least, data[4 * (y * size + x)]);
    return least;
  };
  const [none, some, deep] = [50, 66, 82].map(drawn);
  assert.ok(none.every((x) => x === 150), 'none at 50');
  const row = 2 * (128 - 90); // of the furrow
  assert.ok(darkest(deep, row - 8, row + 8) < darkest(some, row - 8, row + 8) - 5, 'deeper at 82 than at 66');
  assert.ok(darkest(some, row - 8, row + 8) < 146);
  assert.ok(darkest(some, 150, 250) > 146, 'and nowhere else: spots come later');
  assert.ok(deep.some((x, i) => i % 4 === 2 && Math.floor(i / 4 / size) > 150 && x < 140), 'spots at 82');
});
