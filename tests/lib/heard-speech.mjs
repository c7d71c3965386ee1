// SPDX-License-Identifier: GPL-3.0-or-later
// English speech of flite for the recogniser pocketsphinx, as samples and as Opus packets.
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

/** The recogniser of the tests: Debian's, with its English model. */
export const POCKETSPHINX = 'pocketsphinx_continuous -infile /dev/stdin -logfn /dev/null';

function run(program, args, input) {
  const { status, stdout, stderr } = spawnSync(program, args, { input, maxBuffer: 1 << 26 });
  if (status !== 0) throw new Error(`${program}: ${stderr}`);
  return stdout;
}

/** @param {string} text @param {string} [voice] of flite @returns {Buffer} a WAV file at 16 kHz */
export function spoken(text, voice = 'rms') {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-spoken-')), file = path.join(folder, 'x.wav');
  run('flite', ['-voice', voice, '-o', file, '-t', text]);
  const wav = fs.readFileSync(file);
  fs.rmSync(folder, { recursive: true });
  return wav;
}

/** @returns {Buffer} 16-bit samples of the WAV file @param {Buffer} wav @param {number} [rate] @param {number} [channels] */
export const samplesOf = (wav, rate = 16000, channels = 1) =>
  run('ffmpeg', ['-loglevel', 'error', '-i', '-', '-ar', String(rate), '-ac', String(channels), '-f', 's16le', '-'], wav);

/** @returns {Buffer[]} Opus packets of 20 ms (RFC 7845: the first two packets of the file are its headers) @param {Buffer} wav */
export function opusOf(wav) {
  const ogg = run('ffmpeg', ['-loglevel', 'error', '-i', '-', '-c:a', 'libopus', '-b:a', '32k', '-frame_duration', '20', '-f', 'ogg', '-'], wav);
  const packets = [];
  let open = Buffer.alloc(0);
  for (let at = 0; at < ogg.length;) {
    const count = ogg[at + 26];
    let data = at + 27 + count;
    for (let i = 0; i < count; i++) {
      const size = ogg[at + 27 + i];
      open = Buffer.concat([open, ogg.subarray(data, data + size)]);
      data += size;
      if (size === 255) continue;
      packets.push(open);
      open = Buffer.alloc(0);
    }
    at = data;
  }
  return packets.slice(2);
}
