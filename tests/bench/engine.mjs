// SPDX-License-Identifier: GPL-3.0-or-later
// Engine plus sampling on ten minutes of text: seconds of speech per second of CPU, beside the espeak-ng program synthesising the same
// text. Usage: node tests/bench/run.mjs engine
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build, root } from '../lib/daemon.mjs';
import { median } from './figures.mjs';
import { needProgram } from './need.mjs';
import { prose } from './text.mjs';

const program = needProgram('engine');
const file = path.join(fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-')), 'text');
fs.writeFileSync(file, prose(600));
const env = { ...process.env, FACCIA_MODELS: path.join(build, 'models'), FACCIA_PLUGINS: path.join(build, 'server/plugins'), FACCIA_WORKER: path.join(build, 'server/voice/faccia-voice') };
const out = execFileSync('bash', ['-c', `espeak-ng -v it -w /dev/null -f "$1" && times`, '-', file]).toString().trim().split('\n').at(-1);
const alone = out.split(' ').reduce((sum, t) => sum + Number(t.match(/m([\d.]+)s/)[1]) + 60 * parseInt(t), 0);
for (const fps of [25, 60]) {
  const result = JSON.parse(execFileSync(program, [file, 'it', String(fps)], { env, cwd: root }));
  const cpu = median(result.cpu);
  console.log(`${result.seconds.toFixed(0)} s of speech at ${fps} fps: ${cpu.toFixed(3)} s of CPU, ${(result.seconds / cpu).toFixed(0)} x real time; ` +
    `espeak-ng on the same text ${alone.toFixed(3)} s, ratio ${(cpu / alone).toFixed(2)}`);
}
fs.rmSync(path.dirname(file), { recursive: true });
