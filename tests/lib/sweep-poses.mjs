// SPDX-License-Identifier: GPL-3.0-or-later
// Poses of every sound of every language in every expression, in which no two meshes may intersect.
import { unitLength } from '../../models/tools/lib/deform.mjs';
import { expressionPose, LANGUAGES, said } from './mouth-poses.mjs';
import { sentences } from './sentences.mjs';

export const BASIC = ['joy', 'sadness', 'anger', 'fear', 'disgust', 'surprise'];

const EYEBALL_MM = 12; // radius: converts gaze to the pupil's displacement, mm

/** Consonants and vowels of each language as spelled, combined to syllables. Not for English, whose spelling is irregular. */
const SYLLABLES = {
  it: ['p b m f v t d s z c ch sc g gh gl gn l n r qu', 'a e i o u'],
  'pt-BR': ['p b m f v t d s z ç ch j l lh n nh r rr c g qu', 'a e i o u é ó ã'],
  tr: ['p b m f v t d s z c ç g ğ h j k l n r ş y', 'a e ı i o ö u ü'],
  en: ['p b m f v t d s z th sh ch j w l n r k g ng h y', 'a ee oo o er ow'],
};
const MORE = { en: ' The thin father thinks this thing there. A vision of pleasure. Bird, boat, boy, now, near, fair, tour.' };

/** The engines of each language. */
const ENGINES = { it: ['dominance'], 'pt-BR': ['dominance', 'context'], tr: ['dominance', 'syllable'], en: ['dominance'] };

const AT_ONCE = 5; // words per piece: an expression is at its strongest for about a second

/** Pieces of text of about a second each, in both orders, because expressions take time to rise and some settle soon. */
function pieces(lang, once) {
  const [consonants, vowels] = SYLLABLES[lang].map((list) => list.split(' '));
  const words = consonants.flatMap((c) => vowels.map((v) => `${v}${c}${v}`));
  const groups = (once ? [words] : [words, [...words].reverse()]).flatMap((list) =>
    Array.from({ length: Math.ceil(list.length / AT_ONCE) }, (_, i) => `${list.slice(i * AT_ONCE, (i + 1) * AT_ONCE).join(' ')}.`),
  );
  return [...groups, LANGUAGES[lang][0] + (MORE[lang] ?? '')];
}

/**
 * Poses in the middle of each sound, and every 0.1 s for blinks and glances, which are independent of sounds.
 * @param {(string|null)[]} expressions affects; null: none
 * @param {{blends?: string[], prose?: boolean, once?: boolean}} [options] prose: also sentences of the language; once: each syllable in one order only
 * @returns {{mouths: Pose[], eyes: Pose[]}} Pose: {what, faps}
 */
export function sweepPoses(expressions, { blends = ['auto'], prose = false, once = false } = {}) {
  const [mouths, eyes] = [[], []];
  for (const lang of Object.keys(ENGINES)) {
    const texts = [...pieces(lang, once), ...(prose ? sentences[lang] : [])];
    for (const engine of ENGINES[lang])
      for (const expression of expressions)
        for (const blend of expression ? blends : blends.slice(0, 1)) {
          const felt = expression ? texts.map((text) => `<emotion><category name="${expression}"/>${text}</emotion>`) : texts;
          const { phones, fps, frames } = said(`<speak xml:lang="${lang}">${felt.join(' ')}</speak>`, ['--lang', lang, '--engine', engine, '--blend', blend]);
          const name = `${lang}, ${engine}${blend === 'auto' ? '' : `, ${blend}`}${expression ? `, ${expression}` : ''}`;
          for (const { ipa, start, end } of phones)
            if (ipa) mouths.push({ what: `/${ipa}/ ${name}`, faps: frames[Math.min(frames.length - 1, Math.round(((start + end) / 2) * fps))] });
          for (let i = 0; i < frames.length; i += fps / 10) eyes.push({ what: `${(i / fps).toFixed(1)} s ${name}`, faps: frames[i] });
        }
  }
  for (const expression of expressions)
    if (expression) {
      const faps = expressionPose(`${expression}=1`);
      const closed = faps.map((value, n) => (n === 19 || n === 20 ? 1024 - faps[n + 2] : value)); // faccia lets lids meet but not overlap
      mouths.push({ what: `${expression} alone`, faps });
      eyes.push({ what: `${expression} alone`, faps }, { what: `${expression}, eyes closed`, faps: closed });
    }
  return { mouths, eyes };
}

/**
 * Selects poses that differ from each other by more than `mm` in at least one FAP; each dropped pose is close to a selected one.
 * @param {Pose[]} poses @param {number[]} faps to compare @param head on which the mm are measured
 */
export function apart(poses, faps, mm, head) {
  const unit = faps.map((n) => (unitLength(head, n) * (unitLength(head, n) < 1e-4 ? EYEBALL_MM : 1)) / mm);
  const places = poses.map((pose) => Float64Array.from(faps, (n, i) => pose.faps[n] * unit[i]));
  const coarse = widest(places, 4); // compares only poses in neighbouring cells of these coordinates
  const cells = new Map();
  const same = new Set(); // a pose in the same cell of all FAPs as a selected one is surely close to it
  const kept = [];
  const key = (cell) => cell.reduce((sum, x) => sum * 4096 + x + 2048, 0);
  const around = neighbours(coarse.length);
  places.forEach((place, number) => {
    const whole = place.map(Math.floor).join();
    if (same.has(whole)) return;
    const cell = coarse.map((i) => Math.floor(place[i]));
    if (around.some((step) => near(place, cells.get(key(cell.map((x, i) => x + step[i])))))) return;
    kept.push(poses[number]);
    same.add(whole);
    (cells.get(key(cell)) ?? cells.set(key(cell), []).get(key(cell))).push(place);
  });
  return kept;
}

/** Tells whether a member of the list is within 1 in all coordinates, and moves it to the front, because poses repeat. */
function near(place, list = []) {
  for (let k = 0; k < list.length; k++) {
    const other = list[k];
    let i = 0;
    while (i < place.length && Math.abs(other[i] - place[i]) <= 1) i++;
    if (i < place.length) continue;
    [list[0], list[k]] = [list[k], list[0]];
    return true;
  }
  return false;
}

const SAMPLE = 4000; // number of poses used to choose coordinates

/** Chooses the coordinates with the largest variance not explained by those before (pivoted Cholesky decomposition). */
function widest(places, count) {
  const some = places.filter((_, i) => i % Math.ceil(places.length / SAMPLE) === 0);
  const mean = Array.from(places[0] ?? [], (_, i) => some.reduce((sum, place) => sum + place[i], 0) / some.length);
  const rest = mean.map((_, i) => mean.map((_, j) => some.reduce((sum, place) => sum + (place[i] - mean[i]) * (place[j] - mean[j]), 0)));
  return Array.from({ length: Math.min(count, mean.length) }, () => {
    const pick = rest.reduce((best, row, i) => (row[i] > rest[best][best] ? i : best), 0);
    const row = [...rest[pick]];
    if (row[pick] > 0) for (const [i, other] of rest.entries()) rest[i] = other.map((x, j) => x - (row[i] * row[j]) / row[pick]);
    return pick;
  });
}

/** All offsets of -1, 0 or 1 in `count` dimensions, zero first. */
function neighbours(count) {
  const all = Array.from({ length: 3 ** count }, (_, n) => Array.from({ length: count }, (_, i) => (Math.floor(n / 3 ** i) % 3) - 1));
  return all.sort((a, b) => Math.hypot(...a) - Math.hypot(...b));
}
