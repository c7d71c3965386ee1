// SPDX-License-Identifier: GPL-3.0-or-later
// The statistics of tests/bench/people.mjs, on curves whose answers are known.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { curveTable, drawing, figures, interval, ridgeOfOthers, solve } from '../lib/people-statistics.mjs';

test('computes correlation, error without the offset, and movement', () => {
  const measured = [0, 1, 2, 3], close = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a}, ${b}`);
  close(figures({ measured, predicted: [5, 6, 7, 8] }).r, 1);
  close(figures({ measured, predicted: [5, 6, 7, 8] }).rms, 0);
  close(figures({ measured, predicted: [6, 4, 2, 0] }).r, -1);
  close(figures({ measured, predicted: [6, 4, 2, 0] }).rms, Math.sqrt((9 * 1.25)));
  assert.equal(figures({ measured, predicted: [1, 1, 1, 1] }).r, 0);
  close(figures({ measured, predicted: measured }).moved, Math.sqrt(1.25));
});

test('the interval contains the mean, narrows with agreement, and is reproducible', () => {
  const wide = interval([-1, 0, 1, 4]), narrow = interval([1, 1.1, 0.9, 1]);
  assert.equal(wide.value, 1);
  assert.ok(wide.low < 0 && wide.high > 2 && narrow.low > 0.9 && narrow.high < 1.1);
  assert.deepEqual(wide, interval([-1, 0, 1, 4]));
});

test('solves linear equations', () => {
  const [x] = solve([[4, 1], [1, 3]], [[1, 2]]);
  assert.ok(Math.abs(x[0] - 1 / 11) < 1e-12 && Math.abs(x[1] - 7 / 11) < 1e-12);
});

test('a regression on the others predicts a person who moves like them with a delay, without seeing that person', () => {
  const HZ = 100, LATE = 0.06;
  const said = (seed) => Array.from({ length: 20 }, (_, i) => ({ start: i / 10, end: (i + 1) / 10, T: Math.sin(seed + 7 * i) * 5 }));
  const person = (name, seed, sign) => {
    const phones = said(seed), at = (t) => phones[Math.min(Math.max(Math.floor(t * 10), 0), 19)].T;
    const times = Array.from({ length: 200 }, (_, k) => k / HZ);
    const curve = { times, measured: times.map((t) => sign * at(t - LATE)), predicted: times.map(at) };
    return { person: name, phones, shift: 0, curves: { 'table off': { LI: curve } } };
  };
  const all = [person('a', 1, 1), person('b', 2, 1), person('c', 3, 1), person('odd', 4, -1)];
  ridgeOfOthers(all, ['a', 'b', 'c', 'odd'], ['LI']);
  assert.ok(figures(all[3].curves.ridge.LI).r < -0.9, 'whose lips go the other way cannot have been learnt from');
  const same = all.slice(0, 3);
  ridgeOfOthers(same, ['a', 'b', 'c'], ['LI']);
  for (const one of same) assert.ok(figures(one.curves.ridge.LI).r > 0.99 && figures(one.curves['table off'].LI).r < 0.9);
});

test('writes the table of frames', () => {
  const curves = curveTable('recording,engine,contacts,parameter,time,measured,predicted\n1,table,off,LI,0.1000,1.5,2\n1,table,off,LI,0.1100,1.6,2.5\n1,another person,,EM,0.1,3,4\n');
  assert.deepEqual(curves['table off'].LI, { times: [0.1, 0.11], measured: [1.5, 1.6], predicted: [2, 2.5] });
  assert.deepEqual(curves['another person '].EM.predicted, [4]);
});

test('draws a recording with the person next to the engines', () => {
  const times = [0, 0.1, 0.2], curve = { times, measured: [0, 2, 4], predicted: [1, 1, 4] };
  const one = { shift: 0, phones: [{ start: 0, end: 0.1 }, { start: 0.1, end: 0.2 }], curves: { 'dominance on': { LI: curve, AR: { ...curve, measured: null } }, 'table off': { LI: curve } } };
  const svg = drawing('her', one, ['LI', 'AR']);
  assert.deepEqual([...svg.matchAll(/<polyline [^>]*stroke="(#\w+)"/g)].map((m) => m[1]), ['#000', '#c2185b', '#1976d2'], 'what was not recorded is not drawn');
  const [person] = svg.match(/points="[^"]*"/);
  assert.match(person, /"60\.0,148\.0 475\.0,89\.0 890\.0,30\.0"/, 'from -2 to 2 mm, which fill the row');
  assert.equal(svg.match(/stroke="#eee"/g).length, 1, 'one boundary inside');
});
