// SPDX-License-Identifier: GPL-3.0-or-later
// Mouth shapes as faccia produces them, in the middle of each sound of a language, with or without an expression.
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build } from './daemon.mjs';
import { parseFap } from './fapfile.mjs';

const faccia = (...args) => execFileSync(path.join(build, 'server/cli/faccia'), args, { stdio: ['ignore', 'pipe', 'ignore'] }).toString();

/** For each language a text and the sounds examined: one of each visually distinct group. */
export const LANGUAGES = {
  it: ['Apa, afa, sasso, ata, acqua. Vino, ufo, aula, bocca, piedi, cena, sciame, lana. Ara.', ['p', 'f', 'v', 's', 't', 'u', 'o', 'i', 'e', 'tʃ', 'ʃ', 'a', 'l', 'n', 'k', 'ɾ', 'w']],
  'pt-BR': ['A pata fala. O sapo come uva. Chuva, dia, lua, gente. Pé, cara, avó, Ana.', ['p', 'f', 'v', 's', 't', 'u', 'o', 'i', 'e', 'ʃ', 'a', 'l', 'n', 'k', 'ɾ']],
  tr: ['Baba fakat susuyor. İki şişe kapı açık, üzüm var, lale, çocuk. Ara, öğle, ekmek, kız, o, ana.', ['b', 'f', 's', 't', 'u', 'o', 'y', 'ø', 'ɯ', 'i', 'ɛ', 'tʃ', 'ʃ', 'a', 'l', 'n', 'k', 'ɾ']],
  en: ['The path of my father. She saw two boats, a cake, and a lazy fish in the pool. Cheese. Wait away.', ['p', 'f', 's', 't', 'ʃ', 'tʃ', 'θ', 'l', 'm', 'n', 'k', 'i', 'u', 'o', 'æ', 'w']],
};

const ROUND = /^[uoɔʊyøœwɯ]/;

/** Runs `faccia say`. Returns phones, fps and frames. */
export function spoken(text, ...args) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'mouth-'));
  try {
    const [fap, json] = ['a.fap', 'a.json'].map((name) => path.join(folder, name));
    faccia('say', ...args.map(String), '--fap', fap, '--json', json, text);
    return { phones: JSON.parse(fs.readFileSync(json)).phones, ...parseFap(fs.readFileSync(fap, 'utf8')) };
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
}

/** The same at 100 fps, without head rotation. */
export function said(text, options) {
  const { phones, fps, frames } = spoken(text, '--fps', 100, ...options);
  return { phones, fps, frames: frames.map(withoutHead) };
}

/** SSML of a text, in an emotion if given. */
export const voiced = (text, emotion) => `<speak>${emotion ? `<emotion><category name="${emotion}"/>${text}</emotion>` : text}</speak>`;

/** @returns {Object<string, number[]>} FAPs by sound, taken from the longest phone of each, which is the clearest */
export function soundPoses(lang, emotion) {
  const [text, wanted] = LANGUAGES[lang];
  const { phones, fps, frames } = said(emotion ? voiced(text, emotion) : text, ['--lang', lang, ...(emotion ? [] : ['--still'])]);
  const out = {};
  for (const ipa of wanted) {
    const named = phones.filter((p) => p.ipa.startsWith(ipa) && !(ipa === 't' && p.ipa.startsWith('tʃ')));
    // Skips consonants beside rounded vowels, which round the lips.
    const plain = named.filter((p) => ![-1, 1].some((d) => ROUND.test(phones[phones.indexOf(p) + d]?.ipa)));
    const own = plain.length ? plain : named;
    const phone = own.sort((a, b) => b.end - b.start - a.end + a.start)[0];
    if (!phone) throw new Error(`${lang}: no /${ipa}/ among ${phones.map((p) => p.ipa).join(' ')}`);
    out[ipa] = frames[Math.round(((phone.start + phone.end) / 2) * fps)];
  }
  return out;
}

/** FAPs of an expression at full intensity. */
export const expressionPose = (what) => withoutHead(parseFap(faccia('expressions', '--fap', what)).frames[0]);

/** Removes head rotation, which moves everything equally. */
export function withoutHead(frame) {
  const out = Array.from(frame);
  for (const n of [48, 49, 50]) out[n] = 0;
  return out;
}

/** Twelve mouths that a lip reader tells apart. @returns {[string, number[]][]} sounds and FAPs */
export function twelveMouths() {
  const [it, en] = [soundPoses('it'), soundPoses('en')];
  return [
    ['p b m', it.p], ['f v', it.f], ['th', en['θ']], ['t d n', it.n], ['l', it.l], ['s z', it.s],
    ['sh', it['ʃ']], ['i', it.i], ['e', it.e], ['a', it.a], ['o', it.o], ['u', it.u],
  ];
}

/** The camera of pictures of a mouth with the nose's tip and the chin, 3 to 2. */
export const closeUp = (head, width) => ({
  target: [0, head.fdp['2.2'][1] - 4, head.fdp['2.2'][2] - 8], distance: 520, fov: 5.6, width, height: Math.round((width * 2) / 3), level: 'high',
});
