// SPDX-License-Identifier: GPL-3.0-or-later
// FAP interpolation tables (FIT of MPEG-4) through `faccia fap`: filling in absent FAPs against a second reading of the tables
// (tests/lib/fapfit.mjs), tables found in speech, and bitstreams that leave FAPs out.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { readFba } from '../../../protocol/fba/fba.mjs';
import { faps } from '../../../protocol/fap.mjs';
import { faccia } from '../../lib/command.mjs';
import { fitOf } from '../../lib/fapfit.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-fit-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const save = (name, text) => (fs.writeFileSync(file(name), text), file(name));

function well(result) {
  assert.equal(result.status, 0, result.stderr);
  return result;
}


/** A .fap with those FAPs in each frame; 69 to 75 are the fields of FAP 1 and 2. */
function fapText(frames) {
  const lines = frames.flatMap((frame, k) => {
    const has = (n) => (n === 1 ? frame.has(69) : n === 2 ? frame.has(72) : frame.has(n));
    const flags = Array.from({ length: 68 }, (_, i) => Number(has(i + 1)));
    const values = [k];
    if (has(1)) values.push(...[69, 70, 71].map((n) => frame.get(n)), 0);
    if (has(2)) values.push(...[72, 73, 74, 75].map((n) => frame.get(n)), 0, 0);
    for (let n = 3; n <= 68; n++) if (has(n)) values.push(frame.get(n));
    return [flags.join(' '), values.join(' ')];
  });
  return ['2.1 test 25 ' + frames.length, ...lines, ''].join('\n');
}

/** Frames of a .fap as maps, FAP 1 and 2 by their fields. */
function framesOf(text) {
  const [, ...lines] = text.trim().split('\n');
  const frames = [];
  for (let i = 0; i < lines.length; i += 2) {
    const values = lines[i + 1].split(' ').slice(1).map(Number);
    const frame = new Map();
    lines[i].split(' ').forEach((flag, k) => {
      if (flag === '0') return;
      if (k === 0) values.splice(0, 4).slice(0, 3).forEach((value, j) => frame.set(69 + j, value));
      else if (k === 1) values.splice(0, 6).slice(0, 4).forEach((value, j) => frame.set(72 + j, value));
      else frame.set(k + 1, values.shift());
    });
    frames.push(frame);
  }
  return frames;
}

function dice(seed) {
  let state = seed;
  return (below) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
}

/** Fills in frames with C and with the second reading, and compares. Returns the frames. */
function filled(table, frames) {
  const name = save('table.fit', table);
  const got = framesOf(well(faccia(['fap', 'convert', '--fit', name, '-'], { input: fapText(frames) })).stdout);
  const apply = fitOf(table);
  frames.forEach((frame, k) => {
    const want = [...apply(frame)].map(([n, value]) => [n, frame.has(n) || n >= 69 ? value : Math.min(faps[n].max, Math.max(faps[n].min, value))]).sort(([a], [b]) => a - b);
    assert.deepEqual([...got[k]].sort(([a], [b]) => a - b), want.map(([n, value]) => [n, value === 0 ? 0 : value]), `frame ${k}`);
  });
  return got;
}

// Two links: polynomials of three FAPs, and what an expression (surprise) does to the lips.
const RATIONAL = `#VRML V2.0 utf8
Group { children [ # a scene of MPEG-4
  Face { fit DEF T FIT {
    FAPs [3 4 5 -1, 6 7 -1, 72 73 74 75 -1, 12 17 -1]
    graph [1 2 3 4]
    numeratorTerms [4 1 2 2] denominatorTerms [2 1 1 1]
    numeratorExp [1 0 0  0 1 0  0 0 1  1 2 0,  0 1 0,  0 1 0 0  0 0 0 1,  0 1 0 0  0 0 0 1]
    denominatorExp [0 0 1  1 1 1,  0 0 0,  0 0 0 0,  0 0 0 0]
    numeratorImpulse [72 6 74 6 72 6 74 6]
    numeratorCoefs [1 2 3 4  1  .6 .6  -1.5 -1.5] denominatorCoefs [5 6  1  1  1]
  } }
] }`;

test('fills in FAPs by rational polynomials, and by the expression', () => {
  const [, , plain] = filled(RATIONAL, [
    new Map([[3, 100], [4, -20], [5, 30]]),
    new Map([[3, 100], [4, -20], [5, 0], [72, 6], [73, 40], [74, 1], [75, 20]]), // a denominator of 0: FAP 6 stays absent
    new Map([[72, 1], [73, 40], [74, 6], [75, 20]]),
    new Map([[4, 12], [6, 77]]), // the parent is not complete
  ]);
  assert.deepEqual([...plain].slice(4), [[12, 12], [17, -30]]);
});

test('follows the graph: chains, cycles, the order of parents, and FAPs that are there', () => {
  const link = (sets, graph, coefs) => `FIT { FAPs [${sets}] Graph [${graph}] numeratorTerms [${coefs.map(() => 1)}] denominatorTerms [${coefs.map(() => 0)}] numeratorExp [${coefs.map(() => 1)}] numeratorCoefs [${coefs}] }`;
  const cycle = link('4 -1 51 -1 55 -1 3 -1', '1 2 2 1 2 3 4 1', [1, 1, 2, 3]);
  const frames = [new Map([[4, 10]]), new Map([[51, 10]]), new Map([[3, 10]]), new Map([[3, 10], [51, 7]]), new Map([[55, 4]])];
  const got = filled(cycle, frames);
  assert.deepEqual(got.map((frame) => frame.get(55)), [20, 20, 60, 14, 4]);
  assert.equal(got[3].get(4), 7, 'the first parent in the order of the graph counts');
  const random = dice(3);
  for (let i = 0; i < 20; i++) {
    const sets = Array.from({ length: 3 + random(6) }, () => 3 + random(66));
    const edges = Array.from({ length: 1 + random(8) }, () => [1 + random(sets.length), 1 + random(sets.length)]);
    const table = link(sets.map((n) => `${n} -1`).join(' '), edges.flat(), edges.map(() => random(9) - 4));
    filled(table, Array.from({ length: 4 }, () => new Map(Array.from({ length: 1 + random(4) }, () => [3 + random(66), random(60) - 30]))));
  }
});

test('reads XMT-A', () => {
  const table = save('table.xmt', '<XMT-A><Body><Face><fit><FIT DEF="t" FAPs="4 -1 51 -1" Graph="1 2" numeratorTerms=\'1\' denominatorTerms="0" numeratorExp="1" numeratorCoefs="2"/></fit></Face></Body></XMT-A>');
  const out = well(faccia(['fap', 'convert', '--fit', table, '-'], { input: fapText([new Map([[4, 21]])]) })).stdout;
  assert.equal(framesOf(out)[0].get(51), 42);
});

test('reports what is wrong with a table at its place', () => {
  const cases = [
    ['Group {}', /:1:1: there is no FIT in it/],
    ['FIT {\n FAPs [3 -1 4]\n}', /:1:5: the last set of FAPs is not closed by -1/],
    ['FIT {\n FAPs [3 -1 1 -1]\n}', /FAP 1 and 2 stand in a set by their fields/],
    ['FIT {\n  FAPs [3 x]\n}', /:2:11: a number is expected/],
    ['FIT {\n  colour 3\n}', /:2:3: this is no field of a FIT/],
    ['FIT { FAPs [3 -1 69 -1] Graph [1 2] }', /they do not follow from others/],
    ['FIT { FAPs [3 -1 4 -1] Graph [1 3] }', /Graph must have pairs/],
    ['FIT { FAPs [3 -1 4 -1] Graph [1 2] numeratorTerms [2] denominatorTerms [0] numeratorCoefs [1] }', /a number for each term/],
    ['FIT { FAPs [3 -1 4 -1] Graph [1 2] numeratorTerms [1] denominatorTerms [0] numeratorCoefs [1] numeratorExp [16] }', /exponents must be whole numbers from 0 to 15/],
    ['FIT { FAPs [3 -1', /the text ends within a list/],
  ];
  for (const [text, message] of cases) {
    const { status, stderr } = faccia(['fap', 'convert', '--fit', save('bad.fit', text), '-'], { input: fapText([new Map([[3, 1]])]) });
    assert.equal(status, 1, text);
    assert.match(stderr, message);
  }
});

test('a table found in speech: a bitstream leaves its FAPs out, and a receiver gives them back', (t) => {
  well(faccia(['say', '--lang', 'it', '--seed', '1', '--fap', file('said.fap'), '--wav', file('said.wav'), 'La mamma ama il mare. Il papà legge un libro nuovo.']));
  const table = well(faccia(['fap', 'fit', '--quant', '4', file('said.fap')])).stdout;
  fs.writeFileSync(file('said.fit'), table);
  well(faccia(['fap', 'encode', '--quant', '4', file('said.fap'), file('all.fba')]));
  well(faccia(['fap', 'encode', '--quant', '4', '--fit', file('said.fit'), file('said.fap'), file('left.fba')]));
  const [all, left] = ['all.fba', 'left.fba'].map((name) => fs.readFileSync(file(name)));
  const sent = readFba(left, 1 << 16); // a decoder of its own
  const absent = Array.from({ length: 66 }, (_, i) => i + 3).filter((n) => !sent.masks[0][n]);
  t.diagnostic(`${absent.length} of 66 FAPs follow from others: ${left.length} bytes instead of ${all.length}`);
  assert.ok(absent.length > 10 && left.length < all.length, `${absent}`);
  const alone = framesOf(well(faccia(['fap', 'decode', file('left.fba')])).stdout);
  assert.ok(!alone[0].has(absent[0]), 'without a table they are absent');
  const back = parseFap(well(faccia(['fap', 'decode', '--fit', file('said.fit'), file('left.fba')])).stdout);
  const said = parseFap(fs.readFileSync(file('said.fap'), 'utf8'));
  assert.equal(back.frames.length, said.frames.length);
  for (const number of absent) {
    const most = 4 * faps[number].quant_step; // half a step by the table, half by the stream, of both FAPs
    said.frames.forEach((frame, k) => assert.ok(Math.abs(frame[number] - back.frames[k][number]) <= 2 * most, `FAP ${number} of frame ${k}`));
  }
  filled(table, sent.frames.slice(0, 20).map((values, k) => new Map([...values].flatMap((value, n) => (n > 2 && sent.masks[k][n] ? [[n, value]] : [])))));
  const { status, stderr } = faccia(['fap', 'fit', '-'], { input: fapText([new Map([[3, 100], [4, 50]]), new Map([[3, -100], [4, 900]])]) });
  assert.equal(status, 1);
  assert.match(stderr, /no FAP is a multiple of another/);
});
