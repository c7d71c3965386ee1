// SPDX-License-Identifier: GPL-3.0-or-later
// A learner of the pronunciation coach, as Chromium's microphone and camera: a voice other than the model's, and a film of a head that says the same.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { faccia } from './command.mjs';
import { microphoneFlags } from './microphone.mjs';
import { wavOf } from './wav.mjs';

const RATE = 48000, BEFORE = 3, AFTER = 8; // Hz; seconds of silence around the text

/**
 * @param {string} folder for files @param {{text: string, lang: string, voice: string, model?: string}} says model: head that is filmed; otherwise the
 *   camera is Chromium's own pattern
 * @returns {{flags: string[], seconds: number}} flags of Chromium; seconds until the text is said
 */
export function learner(folder, { text, lang, voice, model }) {
  const file = (name) => path.join(folder, name);
  const run = (...args) => {
    const { status, stderr } = faccia(args);
    assert.equal(status, 0, stderr);
  };
  run('say', '-l', lang, '-v', voice, '--wav', file('said.wav'), text);
  const data = fs.readFileSync(file('said.wav')), rate = data.readUInt32LE(24);
  const said = new Int16Array(data.buffer.slice(data.byteOffset + 44, data.byteOffset + data.length - (data.length % 2)));
  const length = Math.floor((said.length / rate) * RATE), samples = new Int16Array(length + (BEFORE + AFTER) * RATE);
  for (let i = 0; i < length; i++) {
    const at = (i / RATE) * rate, k = Math.floor(at), share = at - k;
    samples[BEFORE * RATE + i] = said[k] * (1 - share) + (said[k + 1] ?? 0) * share;
  }
  fs.writeFileSync(file('microphone.wav'), wavOf(samples, RATE));
  const flags = microphoneFlags(file('microphone.wav'));
  if (model) {
    run('film', '-l', lang, '-v', voice, '--model', model, '--view', 'mouth', '--size', '640x480', '--fps', '30', '-o', file('said.mp4'), text);
    const still = `tpad=start_mode=clone:start_duration=${BEFORE}:stop_mode=clone:stop_duration=${AFTER}`;
    execFileSync('ffmpeg', ['-v', 'error', '-y', '-i', file('said.mp4'), '-an', '-r', '30', '-vf', still, '-c:v', 'mjpeg', '-q:v', '4', file('camera.mjpeg')]);
    flags.push(`--use-file-for-fake-video-capture=${file('camera.mjpeg')}`);
  }
  return { flags, seconds: BEFORE + length / RATE };
}
