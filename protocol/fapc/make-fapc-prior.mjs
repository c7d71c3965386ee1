// SPDX-License-Identifier: MIT
// Writes fapc-prior.json anew: node make-fapc-prior.mjs FILE.fap... > new.json && mv new.json fapc-prior.json
// Learns the prediction weights and the initial probabilities from the .fap files (25 frames a second, speech and silence, with
// expression). Keeps the groups, steps and models of fapc-prior.json. A new table changes the coding: decoders with the old
// one cannot decode it.
import fs from 'node:fs';
import { fapcFrame, putFrame } from './fapc.mjs';
import { CLASSES, CTX_COUNT, CTX_SIGN, CTX_SIZE, GROUPS, SIGNS, State, UNARY, WEIGHTS, ZEROS, habits } from './fapc-model.mjs';
import { FAP_COUNT } from '../fap.mjs';

const QUALITY = 5;
const ROUNDS = 4;
const FRAMES = 250; // then a decoder can begin anew

/** Frames of a .fap file as faccia writes it, with all FAPs from 3 on in it. */
function read(path) {
  const [, ...lines] = fs.readFileSync(path, 'utf8').trim().split('\n');
  return lines.filter((_, i) => i % 2).map((line) => {
    const values = line.split(' ').map(Number);
    if (values.length < 1 + FAP_COUNT - 2) throw new Error(`${path}: FAPs are missing`);
    const frame = fapcFrame();
    frame.mask.fill(1, 3);
    frame.values.set(values.slice(2 - FAP_COUNT), 3);
    return frame;
  });
}

/** Solves a x = b for a symmetric positive matrix. */
function solve(a, b) {
  const rows = a.map((row, i) => [...row, b[i]]);
  rows.forEach((row, i) => {
    for (const below of rows.slice(i + 1)) {
      const k = below[i] / row[i];
      below.forEach((_, c) => (below[c] -= k * row[c]));
    }
  });
  const x = [];
  for (let i = rows.length - 1; i >= 0; i--) {
    const rest = rows[i].slice(i + 1, -1).reduce((sum, value, k) => sum + value * x[i + 1 + k], 0);
    x[i] = (rows[i].at(-1) - rest) / rows[i][i];
  }
  return x;
}

/** Runs the coder over the tracks; reports every prediction to `seen` and every bit to `bit`. */
function run(tracks, quality, seen, bit) {
  const s = new State();
  const put = (at, value) => {
    bit(at, value);
    s.contexts.learn(at, value);
  };
  for (const track of tracks)
    track.forEach((frame, t) => {
      if (t % FRAMES === 0) s.reset(quality);
      const spied = Object.create(s, { guess: { value: (n) => (seen(n, s, frame.values[n]), s.guess(n)) } });
      putFrame(spied, { put, even() {} }, frame);
    });
}

/** Ridge regression of what comes on what is known, towards "as the model does" or "goes on a little". */
function weigh(tracks, quality, name) {
  const stiff = [30, 30, 30, 60, 100, 100, 100];
  const first = (n, i) => (habits[n].models.length ? (i === 2 ? 1 : 0) : i === 0 ? 0.35 : 0);
  const square = () => Array.from({ length: WEIGHTS }, (_, i) => Array.from({ length: WEIGHTS }, (_, k) => (i === k ? stiff[i] : 0)));
  const a = Array.from({ length: FAP_COUNT + 1 }, square);
  const b = a.map((_, n) => stiff.map((value, i) => value * first(n, i)));
  run(tracks, quality, (n, s, value) => {
    const x = s.inputs(n).map((input) => input / s.steps[n]);
    const y = (value - s.value[1][n]) / s.steps[n];
    for (let i = 0; i < WEIGHTS; i++) {
      b[n][i] += x[i] * y;
      for (let k = 0; k < WEIGHTS; k++) a[n][i][k] += x[i] * x[k];
    }
  }, () => {});
  for (let n = 3; n <= FAP_COUNT; n++)
    habits[n][name] = solve(a[n], b[n]).map((w) => Math.max(-32768, Math.min(32767, Math.round(4096 * w))));
}

/** Probabilities of a 0, of 65536, for the contexts of each group. */
function count(tracks) {
  const bits = Array.from({ length: CTX_COUNT }, () => [0, 0]);
  run(tracks, QUALITY, () => {}, (at, value) => bits[at][value]++);
  const table = (width) => Array.from({ length: GROUPS }, () => Array.from({ length: width }, () => [1, 1]));
  const [zero, sign, size] = [table(ZEROS), table(SIGNS), table(CLASSES * UNARY)];
  const add = (row, at, width) => row.forEach((sum, i) => i < width && sum.forEach((_, bit) => (sum[bit] += bits[at + i][bit])));
  for (let n = 3; n <= FAP_COUNT; n++) {
    add(zero[habits[n].group], n * ZEROS, ZEROS);
    add(sign[habits[n].group], CTX_SIGN + n * SIGNS, SIGNS);
  }
  size.forEach((row, group) => add(row, CTX_SIZE + group * CLASSES * UNARY, CLASSES * UNARY));
  const share = ([zeros, ones]) => Math.max(256, Math.min(65280, Math.round((65536 * zeros) / (zeros + ones))));
  return { zero: zero.map((row) => row.map(share)), sign: sign.map((row) => row.map(share)), size: size.map((row) => row.map(share)) };
}

const tracks = process.argv.slice(2).map(read);
for (let round = 0; round < ROUNDS; round++) {
  weigh(tracks, QUALITY, 'weights');
  weigh(tracks, 0, 'exact');
}
const list = (rows) => `[\n  ${rows.map((row) => JSON.stringify(row)).join(',\n  ')}\n ]`;
const { zero, sign, size } = count(tracks);
console.log(`{
 "title": "Prior statistics of FAPs for FAPC (fapc.md); weights (exact: lossless) in 1/4096, probabilities of a 0 in 1/65536; see make-fapc-prior.mjs",
 "licence": "MIT",
 "faps": ${list(habits.slice(3))},
 "zero": ${list(zero)},
 "sign": ${list(sign)},
 "size": ${list(size)}
}`);
