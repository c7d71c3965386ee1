// SPDX-License-Identifier: GPL-3.0-or-later
/** Maps file names of photographs to the visemes of models/pictures/poses.json, including their plain-keyboard spelling. */
import fs from 'node:fs';

export const { poses } = JSON.parse(fs.readFileSync(new URL('../../pictures/poses.json', import.meta.url), 'utf8'));
export const BLINK = 'blink';

const PLAIN = { ʃ1: 'sh1', ʃ2: 'sh2', ʎ1: 'lh1', ʎ2: 'lh2', ʎ3: 'lh3', ɛ: 'eh', ɔ: 'oh', ɪ: 'ih', ɐ: 'ah', ʊ: 'uh', θ: 'th' };
const BY_PLAIN = new Map(Object.entries(PLAIN).map(([name, plain]) => [plain, name]));
const known = new Set([...poses.map(({ name }) => name), BLINK]);
const WANTED = 34; // the context visemes come first

export const visemes = poses.slice(0, WANTED).map(({ name }) => name);
export const posed = new Map(poses.map((one) => [one.name, one]));

/** @param {string} word @returns {string|null} the viseme that it names */
export function nameOf(word) {
  const name = BY_PLAIN.get(word.normalize('NFC').toLowerCase()) ?? word.normalize('NFC').toLowerCase();
  return known.has(name) ? name : null;
}

/** Returns a line for each viseme, with an example word. */
export function listOf() {
  const lines = poses.map(({ name, context }) => `  ${(PLAIN[name] ? `${name}, ${PLAIN[name]}` : name).padEnd(10)} ${told(context)}`);
  return [...lines, `  ${BLINK.padEnd(10)} both eyes closed, for blinks`].join('\n');
}

const SOUNDS = { pp: 'p', ff: 'f', tt: 't', ss: 's', ll: 'l', SS: 'ʃ', 'l^': 'ʎ', kk: 'k', 'r^': 'r', II: 'i', AA: 'a', UU: 'u', ii: 'ɪ', aa: 'ɐ', uu: 'ʊ', ee: 'e', EE: 'ɛ', OO: 'ɔ', oo: 'o', '##': '' };

/** Returns the sounds of a context in the pack's symbols, or its name. */
function told(context) {
  if (context === '#') return 'silence: lips closed, at rest';
  if (!context.includes('##')) return context;
  return `in [${context.split(' ').map((symbol) => (symbol.startsWith("'") ? `ˈ${SOUNDS[symbol.slice(1)]}` : SOUNDS[symbol])).join('')}]`;
}
