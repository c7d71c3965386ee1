#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Learns to see glasses, beards, baldness and long hair from photographs: learn-traits.mjs FOLDER LABELS.json OUT.mjs. LABELS has of
 * each trait the files that show it: {"glasses": ["a.jpg"]...}; all others in FOLDER do not. Half of the photographs, by a hash of
 * the file's name, are learnt from; the other half tells how well that went, and is printed. Faces that are turned are left out.
 */
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { isFront, laid } from '../../../web/portrait/fit.mjs';
import { measure } from '../../../web/portrait/traits.mjs';
import { openEye } from './eye.mjs';
import { flat } from './images.mjs';
import { PortraitError } from '../../../web/portrait/problem.mjs';

const FROM = { glasses: 'eyes', beard: 'lower', moustache: 'lower', bald: 'crown', long: 'beside' };
const DAMPING = 0.01;
const RARE = 3; // weight of a photograph that shows the trait, for few do
const FOLDS = 10;
const RIGHT = 0.9; // of those that are said to show it, at least so many do
const LIKELY = 0.75; // the same of those of which it is proposed, though unsure
const MISSED = 0.01; // of those that are said not to, at most so many do
const ROUNDS = 25;

const [folder, labelled, out] = process.argv.slice(2);
if (!out) {
  console.error('usage: learn-traits.mjs FOLDER LABELS.json OUT.mjs');
  process.exit(2);
}

/** FNV-1a. */
const hash = (text) => [...text].reduce((h, c) => Math.imul(h ^ c.charCodeAt(0), 16777619), 2166136261) >>> 0;

/** Logistic regression by Newton's method. @returns {Float64Array} weights, and the bias at the end */
function learn(rows) {
  const size = rows[0].x.length + 1;
  const weights = new Float64Array(size);
  for (let round = 0; round < ROUNDS; round++) {
    const matrix = Array.from({ length: size }, () => new Float64Array(size));
    const slope = new Float64Array(size);
    for (const { x, shows } of rows) {
      const v = [...x, 1];
      const p = 1 / (1 + Math.exp(-score(weights, x)));
      const share = shows ? RARE : 1;
      for (let a = 0; a < size; a++) {
        slope[a] += share * (p - Number(shows)) * v[a];
        for (let b = 0; b < size; b++) matrix[a][b] += share * Math.max(1e-6, p * (1 - p)) * v[a] * v[b];
      }
    }
    for (let a = 0; a < size; a++) {
      const damping = a < size - 1 ? DAMPING * rows.length : 1e-6;
      matrix[a][a] += damping;
      slope[a] += damping * weights[a];
    }
    const step = solve(matrix, slope);
    step.forEach((x, i) => (weights[i] -= x));
    if (step.every((x) => Math.abs(x) < 1e-6)) break;
  }
  return weights;
}

/** Gauss and Jordan's; the matrix is positive definite. */
function solve(a, b) {
  for (let i = 0; i < b.length; i++)
    for (let r = 0; r < b.length; r++) {
      const factor = r === i ? 0 : a[r][i] / a[i][i];
      if (!factor) continue;
      for (let k = i; k < b.length; k++) a[r][k] -= factor * a[i][k];
      b[r] -= factor * b[i];
    }
  return b.map((x, i) => x / a[i][i]);
}

const score = (weights, x) => x.reduce((sum, value, i) => sum + value * weights[i], weights[x.length]);

/** The bounds beyond which an answer is given, by what each photograph scores while it is not learnt from. */
function bounds(rows) {
  const scored = rows.map((row, i) => ({ ...row, score: score(learn(rows.filter((_, j) => j % FOLDS !== i % FOLDS)), row.x) }))
    .sort((a, b) => a.score - b.score);
  const share = (list) => list.filter(({ shows }) => shows).length / (list.length || 1);
  const from = (right) => scored.findIndex((_, i) => share(scored.slice(i)) >= right);
  const scoreAt = (i) => scored[i]?.score ?? scored.at(-1).score;
  const no = scored.findLastIndex((_, i) => share(scored.slice(0, i + 1)) <= MISSED);
  const [high, likely] = [RIGHT, LIKELY].map((right) => scoreAt(from(right)));
  const low = scored[no]?.score ?? scored[0].score;
  const [yes, least] = low < high ? [high, low] : [(high + low) / 2, (high + low) / 2];
  return { yes, likely: Math.min(yes, Math.max(likely, least)), no: least };
}

const labels = JSON.parse(fs.readFileSync(labelled, 'utf8'));
const table = JSON.parse(fs.readFileSync(fileURLToPath(new URL('../../../build/web/face-points.json', import.meta.url)), 'utf8'));
const eye = await openEye();
const seen = [];
for (const name of fs.readdirSync(folder).sort()) {
  try {
    const picture = await flat(path.join(folder, name));
    const landmarks = await eye(picture);
    if (isFront(laid(landmarks, Object.values(table)[0]))) seen.push({ name, measured: measure(picture, landmarks) });
  } catch (error) {
    if (!(error instanceof PortraitError)) throw error;
  }
}
const learnt = {};
for (const [trait, from] of Object.entries(FROM)) {
  const rows = seen.map(({ name, measured }) => ({ half: hash(name) % 2, x: measured[from], shows: labels[trait].includes(name) }));
  const [own, other] = [0, 1].map((half) => rows.filter((row) => row.half === half));
  const weights = learn(own);
  const { yes, likely, no } = bounds(own);
  const short = (x) => Number(x.toFixed(3));
  learnt[trait] = { from, bias: short(weights.at(-1)), yes: short(yes), likely: short(likely), no: short(no), weights: [...weights.slice(0, -1)].map(short) };
  const count = (shows) => [(s) => s >= yes, (s) => s < yes && s > no, (s) => s <= no].map((is) =>
    other.filter((row) => row.shows === shows && is(score(weights, row.x))).length).join(', ');
  const proposed = [true, false].map((shows) => other.filter((row) => row.shows === shows && score(weights, row.x) >= likely).length);
  console.log(`${trait}: learnt from ${own.length} (${own.filter(({ shows }) => shows).length}); in the other ${other.length}, yes, unsure, no: of those with it ${count(true)}; without ${count(false)}; proposed with it ${proposed[0]}, without ${proposed[1]}`);
}
const text = Object.entries(learnt).map(([trait, { from, bias, yes, likely, no, weights }]) => {
  const lines = Array.from({ length: Math.ceil(weights.length / 16) }, (_, i) => `      ${weights.slice(16 * i, 16 * i + 16).join(', ')},`);
  return `  ${trait}: {\n    from: '${from}', bias: ${bias}, yes: ${yes}, likely: ${likely}, no: ${no},\n    weights: [\n${lines.join('\n')}\n    ],\n  },`;
});
fs.writeFileSync(out, `// SPDX-License-Identifier: MIT
// What the numbers of traits.mjs mean, by logistic regression. Written by models/tools/portrait/learn-traits.mjs;
// models/README.md says from which photographs, and how often it is right.
export const LEARNT = {
${text.join('\n')}
};
`);
