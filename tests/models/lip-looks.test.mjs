// SPDX-License-Identifier: GPL-3.0-or-later
// Decides on a lower lip's edge by the lip's look at rest (edges.mjs; see also lip-edges.test.mjs), and reports narrow lips and jumping
// jaws (parting.mjs): bands of one colour as a mouth, two pixels per mm.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Edges } from '../../models/tools/lips/edges.mjs';
import { drawOf, heldJaw, parted } from '../../models/tools/lips/parting.mjs';

const [SIZE, SCALE] = [120, 2];
const stand = { turn: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], scale: SCALE, onto: [SIZE / 2, SIZE / 2] };
const [SKIN, UPPER, LINE, LOWER, DARK, TONGUE, TEETH] = [[200, 150, 125], [170, 90, 90], [50, 25, 25], [185, 98, 98], [30, 15, 15], [110, 50, 50], [225, 220, 205]];

/** @param {[number, number[]][]} bands from above: down to which mm each goes, and its colour */
function mouth(bands) {
  const data = new Uint8ClampedArray(4 * SIZE * SIZE).fill(255);
  for (let j = 0; j < SIZE; j++) {
    const y = (SIZE / 2 - j - 0.5) / SCALE;
    const [, colour] = bands.find(([end]) => y > end) ?? bands.at(-1);
    for (let i = 0; i < SIZE; i++) data.set(colour, 4 * (j * SIZE + i));
  }
  return { data, width: SIZE, height: SIZE };
}

const rest = mouth([[7, SKIN], [0.5, UPPER], [-0.5, LINE], [-9, LOWER], [-99, SKIN]]);
/** An open mouth: how far the lower lip has fallen; the upper teeth end at -6. */
const open = (falls, lower = LOWER) => mouth([[7, SKIN], [0.5, UPPER], [-0.5, LINE], [-6, TEETH], [-8, TONGUE], [-falls - 0.5, DARK], [-falls - 9, lower], [-99, SKIN]]);

function knowing() {
  const edges = new Edges({ fdp: { 2.2: [0, 0, 0], 2.3: [0, 0, 0] } });
  assert.ok(edges.know([{ picture: rest, stand }]), 'its lips are seen at rest');
  return edges;
}

test('finds the edge of a lower lip from a start 1 mm away', () => {
  const edges = knowing();
  for (const falls of [10, 12]) {
    const seen = edges.seen(open(falls), stand, 0, falls - 1);
    assert.ok(Math.abs(seen.falls - falls) < 0.4, `${seen.falls}, not ${falls}`);
    assert.ok(Math.abs(seen.rises) < 0.4, `${seen.rises}`);
  }
});

test('does not take a tooth for the edge when the walk starts behind it, on the tongue', () => {
  assert.equal(knowing().seen(open(14), stand, 0, 3).falls, null);
});

test('rejects a lip of a different colour than at rest: too dark or too pale', () => {
  const edges = knowing();
  assert.equal(edges.seen(open(10, LOWER.map((x) => x * 0.6)), stand, 0, 9).falls, null);
  assert.equal(edges.seen(open(10, [150, 130, 125]), stand, 0, 9).falls, null);
  const lit = edges.seen(open(10, LOWER.map((x) => x * 1.15)), stand, 0, 9).falls;
  assert.ok(Math.abs(lit - 10) < 0.4, `a little more light: ${lit}`);
});

test('corrects a lower lip that sinks when the corners draw together', () => {
  const ends = { hang: 0, draw: 0.12 };
  const q = (LI, AR) => Float64Array.from([LI, 1, AR, 0, 0, LI, 0, 0]);
  const LI = 0;
  const told = (net, ar, falls) => {
    let asked;
    const out = parted(q(net, ar), ends, (rises, down) => {
      asked = down;
      return { rises: 1, falls };
    });
    return { ...out, asked };
  };
  const wide = told(6, 2, 7);
  assert.deepEqual([wide.q[LI], wide.seen[LI], wide.asked], [7, true, 6]);
  const narrow = told(6, -3, 6.36);
  assert.ok(Math.abs(narrow.q[LI] - 6) < 1e-9 && narrow.seen[LI] && Math.abs(narrow.asked - 6.36) < 1e-9, JSON.stringify(narrow));
  const seen = (ar) => told(6, ar, 6).seen.slice(0, 3);
  assert.deepEqual([seen(-3.9), seen(-4.5), seen(-6.5)], [[true, true, true], [true, false, true], [false, false, true]], 'LI, LS and AR of rounded lips');
  const skin = { position: [0, 50, 0, 0, -40, 0], fdp: { 2.3: [0, -41, 0] }, moved: () => [0, -0.9, 0, 0, -0.12, 0] };
  assert.ok(Math.abs(drawOf(skin) - 0.12) < 1e-9, 'of the vertex at the middle of the lower lip');
});

test('rejects a jaw that jumps whenever the lips touch or part, but not in widely spaced pictures', () => {
  const rows = (times, jaw) => times.map((time, i) => ({ time, values: [0, 0, 0, 0, 0, jaw[i]], seen: [true, true, true, false, false, jaw[i] > 1] }));
  const times = [0, 0.04, 0.08, 0.12, 0.16, 0.2];
  const leaping = rows(times, [0, 5, 9, 0.5, 6, 7]);
  const { held, rows: told } = heldJaw(leaping);
  assert.deepEqual([held, told.some(({ seen }) => seen[5]), told.every(({ seen }) => seen[0])], [false, false, true]);
  assert.equal(heldJaw(rows(times, [0, 2, 5, 9, 6, 3])).held, true, 'one that opens as fast beyond');
  assert.equal(heldJaw(rows(times.map((t) => 2.5 * t), [0, 9, 9, 0.5, 9, 9])).held, true, 'ten pictures a second');
  assert.equal(heldJaw([leaping[0], { time: 0.04, values: null, seen: leaping[0].seen }, leaping[1]]).held, true, 'nobody in between');
});
