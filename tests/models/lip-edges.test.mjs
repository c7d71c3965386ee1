// SPDX-License-Identifier: GPL-3.0-or-later
// The inner edges of lips in synthetic pictures: lips of different colours, light and sizes, over teeth, darkness or a tongue; and
// features that are not edges.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Edges } from '../../models/tools/lips/edges.mjs';
import { hangOf, heldCorners, parted } from '../../models/tools/lips/parting.mjs';

const STILL = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const SKIN = { fdp: { '2.2': [0, -60, 20], '2.3': [0, -60, 20] } };
const FAIR = { skin: [205, 165, 145], upper: [165, 95, 90], lower: [185, 105, 100] };
const DARK = { skin: [110, 72, 55], upper: [84, 46, 38], lower: [130, 74, 68] };
const TEETH = [225, 212, 200];
const CAVE = [38, 18, 16];
const TONGUE = [150, 80, 75];

/** Draws a mouth from the front: edges `up` and `down` mm from where the lips meet; contents from above: [colour, end as a share of the opening]. */
function mouth({ colours, up = 0, down = 0, inside = [], perMm = 4, light = 1, onto = [40, -140], ridge = 0 }) {
  const [width, height] = [80 * perMm / 4, 200 * perMm / 4];
  const data = new Uint8Array(4 * width * height);
  const FINE = 8;
  const at = (y) => { // mm above the line
    const shade = (d) => 0.45 + 0.55 * Math.min(1, d / 1.5); // a lip is darker towards its end
    // of a lip that turns: its own shading, as steep as an end
    const ridged = (d) => shade(d) * (d < 1.4 * ridge ? 0.8 : d < 2 * ridge ? 0.8 + 0.2 * (d / ridge - 1.4) / 0.6 : 1);
    if (y >= up) return y > up + 6 ? colours.skin : colours.upper.map((c) => c * shade(y - up));
    if (y <= -down) return y < -down - 8 ? colours.skin : colours.lower.map((c) => c * ridged(-down - y));
    return inside.find(([, share]) => (up - y) / (up + down) <= share)?.[0] ?? CAVE;
  };
  for (let j = 0; j < height; j++) {
    const sum = [0, 0, 0];
    for (let n = 0; n < FINE; n++) {
      const row = j + (n + 0.5) / FINE;
      at(-((row - onto[1] * (perMm / 4)) / perMm) + 60).forEach((c, k) => (sum[k] += (light * c) / FINE));
    }
    for (let i = 0; i < width; i++) for (let k = 0; k < 4; k++) data[4 * (j * width + i) + k] = k < 3 ? Math.min(255, sum[k]) : 255;
  }
  return { picture: { data, width, height }, stand: { turn: STILL, scale: perMm, onto: onto.map((x) => x * (perMm / 4)) } };
}

const near = (value, wanted, mm, what) => assert.ok(value !== null && Math.abs(value - wanted) <= mm, `${what}: ${value} instead of ${wanted}`);

const INSIDE = {
  'teeth and the dark': [[TEETH, 0.4], [CAVE, 1]],
  'teeth above and below': [[TEETH, 0.4], [CAVE, 0.6], [TEETH, 0.9], [CAVE, 1]],
  'teeth and a tongue': [[TEETH, 0.3], [CAVE, 0.4], [TONGUE, 0.8], [CAVE, 1]],
};
for (const [name, colours] of Object.entries({ fair: FAIR, dark: DARK }))
  for (const [what, inside] of Object.entries(INSIDE))
    test(`finds the edges of ${name} lips over ${what}, at 2 to 6 pixels a mm, in half and full light`, () => {
      for (const perMm of [2, 4, 6])
        for (const light of [0.6, 1]) {
          const edges = new Edges(SKIN);
          const rest = mouth({ colours, perMm, light });
          assert.ok(edges.know([rest]));
          // at rest the shade of both lips is one line, which the lower one leaves late
          for (const [up, down] of [[1, 4], [2, 8], [0.5, 12]]) {
            const { picture, stand } = mouth({ colours, up, down, inside, perMm, light });
            const { rises, falls } = edges.seen(picture, stand, up + 1, down - 1.5); // looked for elsewhere than they are
            near(rises, up, 0.35, `upper, ${perMm} pixels, light ${light}`);
            near(falls, down, 0.8, `lower, ${perMm} pixels, light ${light}`);
          }
        }
    });

test('does not mistake the shading of a lower lip for its edge', () => {
  const edges = new Edges(SKIN);
  assert.ok(edges.know([mouth({ colours: FAIR })]));
  for (const ridge of [1, 1.5, 2]) {
    const { picture, stand } = mouth({ colours: FAIR, up: 2, down: 10, ridge });
    near(edges.seen(picture, stand, 2, 10).falls, 10, 0.5, `ridge ${ridge}`);
  }
});

test('follows closed lips that move up and down together', () => {
  const edges = new Edges(SKIN);
  assert.ok(edges.know([mouth({ colours: DARK })]));
  for (const mm of [-2, -0.5, 1]) {
    const { picture, stand } = mouth({ colours: DARK, up: mm, down: -mm });
    near(edges.seen(picture, stand, mm / 2, -mm / 2).rises, mm, 0.1, 'the line');
  }
});

test('without contrast finds no edge, and keeps the values of lay.mjs', () => {
  const edges = new Edges(SKIN);
  const even = mouth({ colours: { skin: [90, 60, 50], upper: [90, 60, 50], lower: [90, 60, 50] }, up: 20, down: -20 });
  assert.equal(edges.know([even]), false);
  assert.deepEqual(edges.seen(even.picture, even.stand, 0, 0), { rises: null, falls: null });
  assert.ok(edges.know([mouth({ colours: FAIR })]));
  assert.deepEqual(edges.seen(even.picture, even.stand, 0, 0), { rises: null, falls: null });
  const outside = { ...even.stand, onto: [4000, 4000] };
  assert.deepEqual(edges.seen(even.picture, outside, 0, 0), { rises: null, falls: null });
  const q = [3, 1, 0, 0, 0, 2, 0, 0];
  assert.deepEqual(parted(q, { hang: 1, draw: 0 }, () => ({ rises: null, falls: null })), { q, seen: [false, false, true, false, false, true] });
  assert.deepEqual(parted(q, { hang: 1, draw: 0 }, () => ({ rises: null, falls: 5 })), { q: [5, ...q.slice(1)], seen: [true, false, true, false, false, true] }, 'the lower end counts by itself');
});

test('a protruded upper lip hangs lower: LS adds its hang to its visible rise', () => {
  const hang = hangOf(0.1);
  const { q: told, seen } = parted([4, 2, -8, 1, 2, 3, 0, 0], { hang, draw: 0 }, (rises) => {
    near(rises, 2 - 2 * hang, 1e-9, 'where it is looked for');
    return { rises: -0.5, falls: 4 };
  });
  near(told[1], 2 * hang - 0.5, 1e-9, 'LS');
  assert.deepEqual(seen, [false, false, true, false, false, true], 'where round lips end a front does not show');
});

test('the front view hides the jaw behind closed lips, and never shows protrusion', () => {
  const seenAt = (LI, LS, rises, falls) => parted([LI, LS, 0, 0, 0, 3, 0, 0], { hang: 1, draw: 0 }, () => ({ rises, falls })).seen;
  assert.deepEqual(seenAt(4, 1, 1, 4), [true, true, true, false, false, true]);
  assert.deepEqual(seenAt(0.1, 0, 0.1, 0.2), [true, true, true, false, false, false]);
  assert.deepEqual(seenAt(0.1, 0, null, null), [true, false, true, false, false, false]);
  const narrow = (AR) => parted([2, 2, AR, 0, 0, 3, 0, 0], { hang: 1, draw: 0 }, () => ({ rises: 2, falls: 2 })).seen;
  assert.deepEqual(narrow(-4.5), [true, false, true, false, false, true], 'narrow lips have come forward: the upper one first');
  assert.deepEqual(narrow(-6.5), [false, false, true, false, false, true], 'and both');
});

test('marks the mouth width as unseen in the whole film when the corners are doubtful in any frame', () => {
  const rows = (doubts) => doubts.map((doubt) => ({ values: [0, 0, 1, 0, 0, 0], seen: [true, true, true, false, false, true], doubt }));
  const marked = (doubts) => heldCorners(rows(doubts)).rows.map(({ seen }) => seen);
  for (const seen of marked([0.05, 0.09, 0.2])) assert.deepEqual(seen, [true, true, true, false, false, true]);
  for (const seen of marked([0.05, 0.24, 0.2])) assert.deepEqual(seen, [true, true, false, false, false, true]);
  assert.equal(heldCorners(rows([0.05])).held, true);
  const nobody = [{ values: null, seen: Array(6).fill(false) }];
  assert.deepEqual(heldCorners(nobody).rows, nobody);
});
