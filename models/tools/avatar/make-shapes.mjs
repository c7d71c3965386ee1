#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Writes shapes/visemes.json and shapes/moods.json: make-shapes.mjs FACCIA, where FACCIA is the program. The fifteen visemes that
 * avatars have are silence and the fourteen of FAP 1, and VRM's moods are expressions of FAP 2. Their looks come from `faccia play` on a
 * recording with only these values: the visemes in FAPs, the moods in ARKit's shapes.
 */
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const VISEMES = ['sil', 'PP', 'FF', 'TH', 'DD', 'kk', 'CH', 'SS', 'nn', 'RR', 'aa', 'E', 'I', 'O', 'U'];

/** Number and intensity (of 63) of FAP 2. A permanent mood is weaker than full joy. */
const MOODS = { happy: [1, 63], relaxed: [1, 20], sad: [2, 63], angry: [3, 63], surprised: [6, 63] };

/** Plays a recording of frames given as mask and values. @returns {object[]} its frames in the format */
function play(program, format, frames) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-shapes-'));
  const file = path.join(folder, 'shapes.fap');
  fs.writeFileSync(file, `2.1 shapes 25 ${frames.length}\n${frames.map(([mask, ...values], k) => `${mask}\n${[k, ...values].join(' ')}`).join('\n')}\n`);
  const { status, stdout, stderr } = spawnSync(program, ['play', file, `--${format}`, '-'], { encoding: 'utf8' });
  fs.rmSync(folder, { recursive: true });
  if (status) throw new Error(stderr);
  const lines = stdout.trim().split('\n').map((line) => JSON.parse(line));
  return lines.filter((line) => line.type === 'frame');
}

const only = (n) => Array.from({ length: 68 }, (_, i) => (i === n - 1 ? 1 : 0)).join(' ');
const named = (names, values) => Object.fromEntries(names.map((name, i) => [name, values[i]]));

/** @returns {Object<string, Object<string, number>>} FAP values by viseme */
export function visemes(program) {
  const frames = play(program, 'ndjson', VISEMES.map((_, n) => [only(1), n, n, 63, 0]));
  return named(VISEMES, frames.map(({ faps }) => faps));
}

/** @returns {Object<string, Object<string, number>>} weights of ARKit's shapes by mood, to hundredths */
export function moods(program) {
  const frames = play(program, 'arkit-ndjson', Object.values(MOODS).map(([n, intensity]) => [only(2), n, intensity, 0, 0, 0, 0]));
  const rounded = ({ arkit }) => Object.entries(arkit).map(([name, weight]) => [name, Math.round(weight * 100) / 100]);
  return named(Object.keys(MOODS), frames.map((frame) => Object.fromEntries(rounded(frame).filter(([, weight]) => weight))));
}

const rows = (object, wrap) => Object.entries(object).map(([name, values]) => `    "${name}": ${wrap(`{${Object.entries(values).map(([key, value]) => `"${key}": ${value}`).join(', ')}}`)}`).join(',\n');

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const program = process.argv[2];
  const write = (name, text) => fs.writeFileSync(new URL(`../../shapes/${name}.json`, import.meta.url), text);
  write('visemes', `{
  "about": "The fifteen visemes that avatars have, as FAPs in FAP units: silence, and the fourteen of FAP 1 as the general speech pack shows them. Made by tools/avatar/make-shapes.mjs. OpenXR (XR_META_face_tracking_visemes) calls I, O and U IH, OH and OU.",
  "visemes": {
${rows(visemes(program), (faps) => `{"faps": ${faps}}`)}
  }
}
`);
  write('moods', `{
  "about": "VRM's moods as weights of ARKit's shapes: expressions of FAP 2, joy (relaxed: a third of it), sadness, anger, surprise. Made by tools/avatar/make-shapes.mjs.",
  "moods": {
${rows(moods(program), (weights) => weights)}
  }
}
`);
}
