#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Learns what the detector makes of mouths: learn.mjs FACCIA -o habits.json HEAD... Draws the built heads in poses of speech, each parameter by
 * itself more or less of what was spoken, the head turned or not; looks; and gives by damped least squares how much of each parameter every number of
 * a shape is. Takes long. FACCIA is the built program; heads and face-points.json are those in build/.
 */
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { unpack } from '../lib/deform.mjs';
import { readFapFrames } from '../lib/fap-frames.mjs';
import { drawHead, shadowsOf } from '../lib/portrait.mjs';
import { openEye } from '../portrait/eye.mjs';
import { PARAMETERS } from './articulation.mjs';
import { looksAt, mean, median } from './look.mjs';
import { COUNT, laidFace, shapeOf, STILL } from './seen.mjs';

const built = fileURLToPath(new URL('../../../build/', import.meta.url));
const TEXTS = {
  it: 'Buongiorno a tutti, oggi parliamo della pioggia, del vento e delle barche sul mare. Uova fresche, pane bianco e vino rosso.',
  pt: 'Bom dia a todos, hoje vamos falar da chuva e dos barcos que voltam do mar.',
  en: 'Good morning everybody, five brown foxes jumped over the moon while we watched the shore.',
  tr: 'Herkese günaydın, bugün yağmurdan ve denizden dönen gemilerden söz edeceğiz.',
};
const POSES = 40; // of each head, the first two at rest
const DAMPING = 50; // mm^2
const IRIS = 11.7;
const GROUPS = [[5, 10, 11, 52, 57, 58], [4, 8, 9, 51, 55, 56], [6, 7, 53, 54], [16], [17], [3, 44, 45, 46]];
const LIPS = [[4, 5, 51, 52], [8, 10, 55, 57], [9, 11, 56, 58]]; // that face each other, with their outer contours
const PRESS = 10; // FAP units
const TURNS = { 48: 10000, 49: 17000, 50: 8000 };

/** Numbers from 0 to 1 that are the same every time. */
function dice(seed) {
  let state = seed * 7919 + 1;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
}

function spoken(faccia) {
  const file = path.join(fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-learn-')), 'said.fap');
  return Object.entries(TEXTS).flatMap(([lang, text]) => {
    execFileSync(faccia, ['say', '--still', '--lang', lang, '--fps', '10', '--fap', file, text], { stdio: ['ignore', 'ignore', 'inherit'] });
    return readFapFrames(fs.readFileSync(file, 'utf8'));
  });
}

function poseOf(frames, random) {
  const faps = {};
  const [one, other] = [0, 0].map(() => frames[Math.floor(random() * frames.length)]);
  for (const group of GROUPS) {
    const [from, share] = [random() < 0.2 ? other : one, 0.5 + random()];
    for (const fap of group) faps[fap] = Math.round(from[fap] * share);
  }
  for (const [up, low, upOuter, lowOuter] of LIPS) {
    const excess = Math.max(0, faps[up] + faps[low] - PRESS) / 2;
    for (const fap of [up, low, upOuter, lowOuter]) faps[fap] -= excess;
  }
  if (random() < 0.7) for (const [fap, most] of Object.entries(TURNS)) faps[fap] = Math.round((2 * random() - 1) * most);
  return faps;
}

async function picture(head, faps, shadows, height) {
  const width = Math.round((height * 480) / 560);
  const crop = { x: Math.round(width * 0.16), y: Math.round(height * 0.16), width: Math.round(width * 0.68), height: Math.round(height * 0.66) };
  const drawn = await drawHead(head, { width, height, faps, shadows, crop });
  for (let i = 0; i < drawn.data.length; i += 4) {
    const alpha = drawn.data[i + 3] / 255;
    for (let k = 0; k < 3; k++) drawn.data[i + k] = drawn.data[i + k] * alpha + 200 * (1 - alpha);
    drawn.data[i + 3] = 255;
  }
  return drawn;
}

const told = ({ MNS, MW }, f) => [-f[5] * MNS, -f[4] * MNS, (f[6] + f[7]) * MW, f[16] * MNS, f[17] * MNS, f[3] * MNS].map((x) => x / 1024 || 0);

/** Of a head the shapes from rest in mm, with what was told. */
async function samplesOf(file, frames, eye, face, random) {
  const head = unpack(JSON.parse(fs.readFileSync(file, 'utf8')));
  const shadows = await shadowsOf(head, {});
  const seen = [];
  for (let i = 0; i < POSES; i++) {
    const faps = i < 2 ? {} : poseOf(frames, random);
    const { looks } = await looksAt(eye, await picture(head, faps, shadows, Math.round(360 + 100 * random())), null);
    seen.push({ laid: looks.map((look) => laidFace(look, face)), told: i < 2 ? PARAMETERS.map(() => 0) : told(head.fapu, faps) });
    if (i % 10 === 9) console.error(`${head.name} ${i + 1} of ${POSES}`);
  }
  const scale = IRIS / median(seen.flatMap(({ laid }) => laid.map(({ iris }) => iris)));
  const shapes = seen.map(({ laid }) => mean(laid.map(({ points }) => shapeOf(points))));
  const rest = mean(shapes.slice(0, 2));
  return seen.map((row, i) => ({ shape: shapes[i].map((x, k) => (x - rest[k]) * scale), told: row.told }));
}

/** Damped least squares: the normal equations by elimination. @returns {number[][]} of each parameter its weights */
function learned(samples) {
  const a = Array.from({ length: COUNT }, (_, i) => Array.from({ length: COUNT }, (__, k) => (i === k ? DAMPING : 0) + samples.reduce((sum, { shape }) => sum + shape[i] * shape[k], 0)));
  const b = Array.from({ length: COUNT }, (_, i) => PARAMETERS.map((__, p) => samples.reduce((sum, { shape, told: y }) => sum + shape[i] * y[p], 0)));
  for (let c = 0; c < COUNT; c++) // positive and symmetric: no pivots are sought
    for (let r = c + 1; r < COUNT; r++) {
      const factor = a[r][c] / a[c][c];
      for (let k = c; k < COUNT; k++) a[r][k] -= factor * a[c][k];
      PARAMETERS.forEach((_, p) => (b[r][p] -= factor * b[c][p]));
    }
  for (let r = COUNT - 1; r >= 0; r--)
    PARAMETERS.forEach((_, p) => {
      for (let c = r + 1; c < COUNT; c++) b[r][p] -= a[r][c] * b[c][p];
      b[r][p] /= a[r][r];
    });
  return PARAMETERS.map((_, p) => b.map((row) => row[p]));
}

const { values, positionals: [faccia, ...names] } = parseArgs({ allowPositionals: true, options: { output: { type: 'string', short: 'o' } } });
if (!names.length || !values.output) {
  console.error('usage: learn.mjs FACCIA -o habits.json HEAD...');
  process.exit(2);
}
const table = Object.values(JSON.parse(fs.readFileSync(path.join(built, 'web/face-points.json'), 'utf8')));
const face = STILL.map((i) => mean(table.map(({ seen }) => seen[i])));
const frames = spoken(faccia);
const eye = await openEye();
const samples = [];
for (const [n, name] of names.entries()) samples.push(...(await samplesOf(path.join(built, 'models/heads', `${name}.json`), frames, eye, face, dice(n + 1))));
const round = (x, steps) => Math.round(x * steps) / steps;
const weights = Object.fromEntries(learned(samples).map((list, p) => [PARAMETERS[p], list.map((x) => round(x, 1e4))]));
const out = { title: 'What the detector of landmarks makes of the mouths of our heads', licence: 'GPL-3.0-or-later', heads: names, pictures: samples.length, damping: DAMPING, face: face.map((p) => p.map((x) => round(x, 100))), weights };
fs.writeFileSync(values.output, `${JSON.stringify(out).replaceAll('],"', '],\n"').replace('{"title', '{\n"title')}\n`);
