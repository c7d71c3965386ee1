// SPDX-License-Identifier: GPL-3.0-or-later
// Speaks on the command line and checks the output: sound, phones, words.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { faccia } from './command.mjs';
import { build } from './daemon.mjs';

/** Runs `faccia say`. Returns {status, stderr, json, pcm, rate}; the last three only on success. */
export function say(args, text, env = {}, from = build) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  const file = (name) => path.join(folder, name);
  try {
    const { status, stderr } = faccia(['say', '--still', '--wav', file('wav'), '--json', file('json'), ...args, '-'], { input: text, env, from });
    const result = { status, stderr };
    if (status !== 0) return result;
    const wav = fs.readFileSync(file('wav'));
    return {
      ...result,
      json: JSON.parse(fs.readFileSync(file('json'))),
      rate: wav.readUInt32LE(24),
      pcm: new Int16Array(wav.buffer.slice(wav.byteOffset + 44, wav.byteOffset + wav.length)),
    };
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
}

/** Checks that phones are adjacent and cover the sound, and that words are in order and do not overlap. */
export function checkOrder({ json }) {
  let at = 0;
  for (const phone of json.phones) {
    assert.ok(Math.abs(phone.start - at) < 1e-5 && phone.end > phone.start, JSON.stringify(phone));
    at = phone.end;
  }
  assert.ok(Math.abs(at - json.duration) < 1e-3, `phones end at ${at}, the sound at ${json.duration}`);
  json.words.forEach((word, i) => assert.ok(word.end >= word.start && (!i || word.start >= json.words[i - 1].end - 1e-6), word.text));
}

/** Largest step between consecutive samples; an overflow makes one of almost 65536. */
export function largestStep({ pcm }) {
  let most = 0;
  for (let i = 1; i < pcm.length; i++) most = Math.max(most, Math.abs(pcm[i] - pcm[i - 1]));
  return most;
}

/** Largest absolute sample between two times, s. */
export function loudest({ pcm, rate }, from = 0, to = Infinity) {
  let most = 0;
  for (let i = Math.round(from * rate); i < Math.min(pcm.length, to * rate); i++) most = Math.max(most, Math.abs(pcm[i]));
  return most;
}

export const words = ({ json }) => json.words.map((w) => w.text);
export const phones = ({ json }) => json.phones.map((p) => p.ipa || '_').join(' ');
