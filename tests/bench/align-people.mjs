// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy of alignment of a person's speech: stops between vowels against audible closures, with the chance level.
// Needs Debian's asterisk-core-sounds-it and asterisk-core-sounds-it-wav (18 MB).
// node tests/bench/run.mjs align-people [PROMPTS, all]
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build } from '../lib/daemon.mjs';
import { alignedPhones, closures, loudness, prompts } from '../lib/prompts.mjs';

const all = prompts();
const chosen = all.slice(0, Number(process.argv[2] ?? all.length));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const found = [], chance = [];
let refused = 0;
for (const prompt of chosen) {
  const phones = alignedPhones(path.join(build, 'server/cli/faccia'), prompt, folder);
  if (!phones) {
    refused++;
    continue;
  }
  const levels = loudness(prompt.sound);
  found.push(...closures(phones, levels));
  for (const shift of [-0.3, -0.2, 0.2, 0.3]) chance.push(...closures(phones, levels, shift));
}
fs.rmSync(folder, { recursive: true });
const tell = (name, list) => {
  const heard = list.filter(Boolean);
  const part = (key) => {
    const signed = heard.map((x) => 1000 * x[key]).sort((a, b) => a - b), far = signed.map(Math.abs).sort((a, b) => a - b);
    const at = (values, q) => values[Math.min(values.length - 1, Math.floor(values.length * q))]?.toFixed(0);
    return `${key} ${at(signed, 0.5)} ms in the median, off by ${at(far, 0.5)} (half), ${at(far, 0.9)} (90 %)`;
  };
  console.log(`${name}: ${list.length} stops, ${heard.length} with a closure within 80 ms; ${part('start')}; ${part('end')}`);
};
console.log(`${chosen.length} of ${all.length} prompts, ${refused} refused: the words are not those of the recording`);
tell('aligned', found);
tell('by chance (phones moved by 0.2 and 0.3 s)', chance);
