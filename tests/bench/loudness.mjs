// SPDX-License-Identifier: GPL-3.0-or-later
// Loudness of every affect (EBU R 128, by ffmpeg's ebur128), with the default voice of each language: integrated level in LUFS and true peak in dBTP, beside
// the same text without an affect. None may be louder than -17 LUFS.
// node tests/bench/run.mjs loudness [LANG...]
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build, root } from '../lib/daemon.mjs';
import { LOUDEST, loudness, TEXTS } from '../lib/loudness.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const affects = Object.keys(JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json'))).affect);
let loud = 0;
const langs = process.argv.slice(2).length ? process.argv.slice(2) : Object.keys(TEXTS);
for (const lang of langs) {
  console.log(`\n${lang}: LUFS (dBTP)\n`);
  for (const affect of [null, ...affects]) {
    const { level, peak } = loudness(path.join(build, 'server/cli/faccia'), path.join(folder, 'x.wav'), lang, affect), much = level > LOUDEST;
    loud += Number(much);
    console.log(`${(affect ?? 'none').padEnd(18)} ${level.toFixed(1)} (${peak.toFixed(1)})${much ? '  too loud' : ''}`);
  }
}
fs.rmSync(folder, { recursive: true });
console.log(`\n${loud} above ${LOUDEST} LUFS`);
