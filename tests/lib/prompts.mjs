// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of people reading: prompts of Debian's asterisk-core-sounds-LANG and -wav or -g722 (CC-BY-SA 3.0), and audible stop closures in them.
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import zlib from 'node:zlib';
import { wavOf } from './wav.mjs';

const READERS = { it: ['it_IT_m_Carlo', 'male'], en: ['en_US_f_Allison', 'female'], es: ['es_MX_f_Allison', 'female'], fr: ['fr_CA_f_June', 'female'], ru: ['ru_RU_f_IvrvoiceRU', 'female'] };

/** [{name, text, sound}] of prompts whose text is only words. Skips lines with damaged letters, remarks in brackets or several entries. */
export function prompts(lang = 'it', suffix = 'wav') {
  const lines = zlib.gunzipSync(fs.readFileSync(`/usr/share/doc/asterisk-core-sounds-${lang}/core-sounds-${lang}.txt.gz`)).toString('utf8').split(/\r?\n/);
  return lines.flatMap((line) => {
    const [, name, text] = line.match(/^([\w/-]+):\s+(.*\S)\s*$/) ?? [];
    const sound = path.join('/usr/share/asterisk/sounds', READERS[lang][0], `${name}.${suffix}`);
    const plain = text && !/\w\?|[[\](){}<>*#/]|: /.test(text) && text.split(/\s+/).length >= 3;
    return plain && fs.existsSync(sound) ? [{ name, text: text.replace(/…|\.\.+/g, ' '), sound, lang }] : [];
  });
}

/** Phones of a recording by `faccia align`; null if it reports that the text does not match. */
export function alignedPhones(program, { text, sound, lang }, folder) {
  const [script, out] = ['prompt.txt', 'prompt.json'].map((file) => path.join(folder, file));
  fs.writeFileSync(script, text);
  try {
    execFileSync(program, ['align', '-q', sound, '--text', script, '-l', lang, '--gender', READERS[lang][1], '--json', out], { stdio: 'pipe' });
  } catch ({ status }) {
    if (status !== 1) throw new Error(`faccia align ${sound}: ${status}`);
    return null;
  }
  return JSON.parse(fs.readFileSync(out)).phones;
}

const HOP = 0.002, WINDOW = 0.008, REACH = 0.08, VOWEL = /^[aeiouɛɔ]/, STOP = /^[ptk](?!͡)ː?$/;

/** Loudness in dB every 2 ms. */
export function loudness(file) {
  const data = fs.readFileSync(file), rate = data.readUInt32LE(24);
  const pcm = new Int16Array(data.buffer.slice(data.byteOffset + 44, data.byteOffset + data.length - (data.length % 2)));
  const length = Math.round(WINDOW * rate);
  return Array.from({ length: Math.floor((pcm.length - length) / (HOP * rate)) }, (_, k) => {
    let sum = 1;
    const from = Math.round(k * HOP * rate);
    for (let i = from; i < from + length; i++) sum += pcm[i] ** 2;
    return 10 * Math.log10(sum / length);
  });
}

/**
 * Voiceless stops between vowels: [{start, end}], distances of the phone's start and end from the audible closure in s; null if there is none within 80 ms.
 * A closure is at least 12 dB below the sounds on both sides; its edges are half-way down. `shift` moves the phones, which gives the chance level.
 */
export function closures(phones, levels, shift = 0) {
  const at = (seconds) => Math.max(0, Math.min(levels.length - 1, Math.round((seconds - WINDOW / 2) / HOP)));
  const highest = (from, to) => Math.max(...levels.slice(at(from), at(to) + 1));
  return phones.flatMap((phone, i) => {
    const [before, after] = [phones[i - 1], phones[i + 1]];
    if (!STOP.test(phone.ipa) || !VOWEL.test(before?.ipa ?? '') || !VOWEL.test(after?.ipa ?? '')) return [];
    const [start, end] = [phone.start + shift, phone.end + shift];
    if (start < REACH || end + REACH > levels.length * HOP) return [];
    let low = at(start);
    for (let k = at(start - REACH); k <= at(end + REACH); k++) if (levels[k] < levels[low]) low = k;
    const middle = low * HOP + WINDOW / 2, left = highest(middle - 0.15, middle), right = highest(middle, middle + 0.15);
    if (Math.min(left, right) - levels[low] < 12) return [null];
    let [first, last] = [low, low];
    while (first > 0 && levels[first] < (left + levels[low]) / 2) first--;
    while (last < levels.length - 1 && levels[last] < (right + levels[low]) / 2) last++;
    return [{ start: start - (first * HOP + WINDOW / 2), end: end - (last * HOP + WINDOW / 2) }];
  });
}

const samplesOf = (file) => {
  const data = fs.readFileSync(file);
  return { rate: data.readUInt32LE(24), pcm: new Int16Array(data.buffer.slice(data.byteOffset + 44, data.byteOffset + data.length - (data.length % 2))) };
};

/** Chords that change every half second. */
const music = (rate, seconds) =>
  Int16Array.from({ length: rate * seconds }, (_, k) => {
    const t = k / rate, root = 110 * 2 ** ([0, 5, 7, 3, 8, 10][Math.floor(2 * t) % 6] / 12);
    return [1, 1.26, 1.5, 2, 3].reduce((sum, n) => sum + 1200 * Math.sin(2 * Math.PI * root * n * t), 0) * Math.exp(-3 * (t % 0.5));
  });

/**
 * Joins prompts to one recording with half a second after each: {wav, seconds, places: [{name, start, end}]}; a place is the audible part, s.
 * `between(i)`: inserted before prompt i, {silence, music} in s.
 */
export function madeOf(list, { between = () => 0 } = {}) {
  const parts = [], places = [];
  let at = 0, rate = 8000;
  const add = (pcm) => {
    parts.push(pcm);
    at += pcm.length;
  };
  list.forEach(({ name, sound }, i) => {
    const read = samplesOf(sound), more = between(i);
    ({ rate } = read);
    if (more.silence) add(new Int16Array(rate * more.silence));
    if (more.music) add(music(rate, more.music));
    const loud = (k) => Math.abs(read.pcm[k]) > 400;
    let [first, last] = [0, read.pcm.length - 1];
    while (first < last && !loud(first)) first++;
    while (last > first && !loud(last)) last--;
    places.push({ name, start: (at + first) / rate, end: (at + last) / rate });
    add(read.pcm);
    add(new Int16Array(rate / 2));
  });
  const all = new Int16Array(at);
  let to = 0;
  for (const part of parts) {
    all.set(part, to);
    to += part.length;
  }
  return { wav: wavOf(all, rate), pcm: all, rate, seconds: at / rate, places };
}
