#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Writes the poses of a set of pictures: make-poses.mjs FACCIA [OUTPUT.json]. The 34 context visemes as the engine `context` shows them, one
 * context of each, and additional poses for other languages and moods. FACCIA is the built program.
 */
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { readFapFrames } from './lib/fap-frames.mjs';

const here = path.dirname(fileURLToPath(import.meta.url));
const HZ = 16000,
  BYTES = 2,
  HEADER = 44,
  PHONE_S = 0.2;
const FPS = 100;
const VOWELS = { i: 'II', a: 'AA', u: 'UU' };
const MOUTH = [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 43, 44, 45, 46, 47, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60];

const [faccia, out] = process.argv.slice(2);
if (!faccia) {
  console.error('usage: make-poses.mjs FACCIA [OUTPUT.json]');
  process.exit(2);
}
const run = (...args) => execFileSync(faccia, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });
const table = JSON.parse(fs.readFileSync(path.join(here, '../speech/visemes/pt.json'), 'utf8'));
const text = `${JSON.stringify({ poses: [...visemes(), ...others()] }).replaceAll('{"name"', '\n  {"name"').replace(/\]\}$/, '\n]}')}\n`;
if (out) fs.writeFileSync(out, text);
else process.stdout.write(text);

/** The frame at the middle of the phone number `at` of those symbols, which the engine makes the key viseme itself. */
function shown(symbols, at) {
  const file = path.join(fs.mkdtempSync(path.join(os.tmpdir(), 'poses-')), 'phones.txt');
  const offset = (i) => HEADER + Math.round(i * PHONE_S * HZ) * BYTES;
  const lines = symbols.map((symbol, i) => `${i}: ${offset(i)} ${symbol}`);
  fs.writeFileSync(file, [...lines, `${symbols.length}: ${offset(symbols.length)}`, ''].join('\n'));
  const frames = readFapFrames(run('timed', '--fps', String(FPS), file));
  fs.rmSync(path.dirname(file), { recursive: true });
  return mouth(frames[Math.round((at + 0.5) * PHONE_S * FPS)]);
}

function mouth(frame) {
  return Object.fromEntries(MOUTH.filter((n) => frame[n]).map((n) => [n, frame[n]]));
}

function visemes() {
  const symbolOf = (group) => Object.values(table.phones).find((phone) => phone.group === group).symbols[0];
  const found = new Map([['rest', { context: '#', faps: {} }]]);
  const note = (name, symbols, at) => {
    if (!found.has(name)) found.set(name, { context: symbols.join(' '), faps: shown(symbols, at) });
  };
  for (const [group, rows] of Object.entries(table.grid))
    for (const [left, cells] of Object.entries(rows))
      cells.forEach((name, i) => {
        const right = VOWELS[table.classes[i]];
        note(name, [...(left === '#' ? ['##'] : ['##', `'${VOWELS[left]}`]), symbolOf(group), right, '##'], left === '#' ? 1 : 2);
      });
  for (const [group, { kind, viseme }] of Object.entries(table.groups)) {
    if (kind !== 'vowel') continue;
    const stressed = table.visemes[viseme].stress ? "'" : '';
    note(viseme, ['##', 'pp', stressed + symbolOf(group), 'pp', '##'], 2);
  }
  note('i2', ['##', 'tt', "'II", 'tt', '##'], 2);
  const missing = Object.keys(table.visemes).filter((name) => !found.has(name));
  if (missing.length) throw new Error(`no context found for ${missing}`);
  return Object.keys(table.visemes).map((name) => ({ name, ...found.get(name) }));
}

/** Poses that Portuguese lacks: a tongue between the teeth, smiles, a dropped jaw. */
function others() {
  const mood = (what) => mouth(readFapFrames(run('expressions', '--fap', what))[0]);
  return [
    { name: 'joy', context: 'joy=1', faps: mood('joy=1') },
    { name: 'smile', context: 'joy=0.4', faps: mood('joy=0.4') },
    { name: 'surprise', context: 'surprise=1', faps: mood('surprise=1') },
    { name: 'sadness', context: 'sadness=1', faps: mood('sadness=1') },
    { name: 'θ', context: 'en: thought', faps: spoken('en', 'θ', 'A thought, a thing, both.') },
    { name: 'w', context: 'en: would', faps: spoken('en', 'w', 'A wood, a way, away.') },
    { name: 'y', context: 'tr: üzüm', faps: spoken('tr', 'y', 'Üzüm, ütü, düğün.') },
  ];
}

/** Returns the longest instance of a sound in a spoken text. */
function spoken(lang, sound, text) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'poses-'));
  const [fap, json] = ['a.fap', 'a.json'].map((name) => path.join(folder, name));
  run('say', '--lang', lang, '--fps', String(FPS), '--still', '--fap', fap, '--json', json, text);
  const { phones } = JSON.parse(fs.readFileSync(json, 'utf8'));
  const frames = readFapFrames(fs.readFileSync(fap, 'utf8'));
  fs.rmSync(folder, { recursive: true });
  const own = phones.filter(({ ipa }) => ipa.startsWith(sound)).sort((a, b) => b.end - b.start - a.end + a.start)[0];
  if (!own) throw new Error(`no /${sound}/ in ${text}`);
  return mouth(frames[Math.round(((own.start + own.end) / 2) * FPS)]);
}
