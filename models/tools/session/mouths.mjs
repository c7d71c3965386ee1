// SPDX-License-Identifier: GPL-3.0-or-later
/** Finds the context visemes of P. D. P. Costa's thesis (tables 3.3 and 3.4) in the phones of a logatome. Names are those of make-set.mjs. */
const GROUPS = { p: 'pbm', f: 'fv', t: 'tdn', s: 'sz', l: 'l', sh: 'ʃʒ', lh: 'ʎɲ', k: 'kgɡ', r: 'ɾrɣʁhxχ' };
const VOWELS = { i: 'i', e: 'e', eh: 'ɛ', a: 'a', oh: 'ɔ', o: 'o', u: 'u', ih: 'ɪ', ah: 'ɐəæ', uh: 'ʊ' };
const REDUCED = { i: 'ih', a: 'ah', u: 'uh' }; // of the unstressed last vowel
const CLASSES = 'iau';
/* for each consonant: the number of its viseme as a word begins, and after i, a, u; each before i, a, u */
const GRID = {
  p: ['112', '111', '111', '212'], f: ['112', '111', '112', '222'], t: ['121', '111', '121', '111'], s: ['112', '112', '112', '222'],
  l: ['123', '124', '221', '114'], sh: ['112', '111', '111', '112'], lh: ['112', '113', '113', '223'], k: ['123', '113', '123', '113'], r: ['112', '112', '112', '212'],
};

const memberOf = (table, phone) => Object.keys(table).find((name) => [...table[name]].includes([...phone.normalize('NFD')][0])) ?? null;
const classOf = (vowel) => CLASSES.indexOf({ ih: 'i', ah: 'a', uh: 'u' }[vowel] ?? vowel);

/** The viseme of phone i. kinds: a vowel or consonant group each. */
function visemeOf(kinds, i) {
  const { vowel, consonant } = kinds[i];
  const [before, after] = [kinds[i - 1], kinds[i + 1]];
  if (vowel === 'i') return before?.consonant === 'sh' || (before?.consonant === 't' && after?.consonant === 't') ? 'i2' : 'i1';
  if (vowel) return vowel;
  const next = classOf(after?.vowel);
  if (!consonant || next < 0) return null;
  const row = i === 0 ? 0 : 1 + classOf(before?.vowel);
  return i === 0 || row > 0 ? `${consonant}${GRID[consonant][row][next]}` : null;
}

/**
 * @param {{ipa: string, start: number, end: number}[]} phones of one word, with its pauses
 * @returns {{viseme: string, seconds: number}[]} at the middle of each phone, where the thesis puts the key viseme; and at rest before it
 */
export function mouthsIn(phones) {
  const said = phones.filter(({ ipa }) => ipa);
  const kinds = said.map(({ ipa }) => ({ vowel: memberOf(VOWELS, ipa), consonant: memberOf(GROUPS, ipa) }));
  const last = kinds.at(-1);
  if (kinds.length > 1 && REDUCED[last.vowel]) last.vowel = REDUCED[last.vowel];
  const found = said.map(({ start, end }, i) => ({ viseme: visemeOf(kinds, i), seconds: (start + end) / 2 })).filter(({ viseme }) => viseme);
  const pause = phones[0];
  if (pause && !pause.ipa && pause.end - pause.start > 0.1) found.push({ viseme: 'rest', seconds: (pause.start + pause.end) / 2 });
  return found;
}
