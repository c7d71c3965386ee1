// SPDX-License-Identifier: GPL-3.0-or-later
// Chromium's microphone as a file, which it plays again and again.
import fs from 'node:fs';
import { samplesOf, spoken } from './heard-speech.mjs';
import { wavOf } from './wav.mjs';

const RATE = 48000;

/** Writes a file of flite's English for the microphone: words between the noise of a room, a second before them and two after. @param {string} file */
export function sayInto(file, text) {
  const bytes = samplesOf(spoken(text), RATE), samples = new Int16Array(bytes.buffer, bytes.byteOffset, bytes.length / 2);
  const padded = Int16Array.from({ length: samples.length + 3 * RATE }, () => Math.round(6 * (Math.random() - 0.5)));
  padded.set(samples, RATE);
  fs.writeFileSync(file, wavOf(padded, RATE));
}

/** @param {string} file WAV @returns {string[]} flags of Chromium: that file is its microphone, and pages may use it */
export const microphoneFlags = (file) => ['--use-fake-device-for-media-stream', '--use-fake-ui-for-media-stream', `--use-file-for-fake-audio-capture=${file}`];
