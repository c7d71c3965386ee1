// SPDX-License-Identifier: MIT
// Names of shapes in avatars. A name identifies a shape; its effect is measured.

// Names of shapes and bones as words: `Head_blendShape.mouthSmile_L` is head, blend, shape, mouth, smile, l.

export const SIDES = { l: 'Left', r: 'Right' };

/** Letters and digits alone, small. @param {string} name */
export const keyOf = (name) => name.toLowerCase().replace(/[^a-z0-9]/g, '');

/** @param {string} name @returns {string[]} small; numbers are words of their own */
export const wordsOf = (name) => (name.match(/[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+/g) ?? []).map((word) => word.toLowerCase());

/** @param {string} word @returns {'Left'|'Right'|null} */
export const sideOf = (word) => SIDES[word] ?? { left: 'Left', right: 'Right' }[word] ?? null;

const SIDED = `browDown browOuterUp cheekSquint eyeBlink eyeLookDown eyeLookIn eyeLookOut eyeLookUp eyeSquint eyeWide mouthDimple
  mouthFrown mouthLowerDown mouthPress mouthSmile mouthStretch mouthUpperUp noseSneer`.split(/\s+/);
const MIDDLE = `browInnerUp cheekPuff jawForward jawLeft jawOpen jawRight mouthClose mouthFunnel mouthLeft mouthPucker mouthRight
  mouthRollLower mouthRollUpper mouthShrugLower mouthShrugUpper tongueOut`.split(/\s+/);
/** Some have one of these for each side. */
export const HALVES = ['browInnerUp', 'cheekPuff'];

/** Apple's 52 (ARFaceAnchor.BlendShapeLocation). */
export const ARKIT = [...MIDDLE, ...SIDED.flatMap((stem) => [`${stem}Left`, `${stem}Right`])];

const CONSONANTS = ['PP', 'FF', 'TH', 'DD', 'kk', 'CH', 'SS', 'nn', 'RR'];
/** The 15 visemes of Oculus; OpenXR says IH, OH, OU for I, O, U. */
export const VISEMES = ['sil', ...CONSONANTS, 'aa', 'E', 'I', 'O', 'U'].map((name) => `viseme_${name}`);

/** The vowels of VRM, whose mouth is shut when none of them is there. */
export const VOWELS = ['aa', 'ih', 'ou', 'ee', 'oh'].map((name) => `vowel_${name}`);

/** Both lids at once; and what some avatars have beside, or instead of, the visemes. */
const MORE = ['eyeBlink', 'mouthOpen', 'mouthSmile'];

/** All that a mapping file may name. */
export const SHAPES = [...ARKIT, ...VISEMES, ...VOWELS, ...MORE];

/** Other names of the shapes, without their side. */
const ALSO = {
  eyeBlink: ['eyesClosed', 'eyesClose', 'eyeClosed', 'eyeClose', 'closeEyes', 'closeEye', 'eyesBlink', 'blink', 'eyelidClose', 'lidClose', 'wink'],
  mouthSmile: ['smile'],
  jawOpen: ['openJaw', 'jawDown', 'jawDrop'],
  mouthOpen: ['openMouth'],
};
const KANA = { あ: 'vowel_aa', い: 'vowel_ih', う: 'vowel_ou', え: 'vowel_ee', お: 'vowel_oh', まばたき: 'eyeBlink' };

const OPEN = [['ih', 'I'], ['oh', 'O'], ['ou', 'U']]; // what OpenXR says, and what we do
const PREFIXES = ['viseme', 'v', 'vis'];
const WHOLE = new Map([
  ...[...MIDDLE, ...MORE].map((name) => [keyOf(name), name]),
  ...VISEMES.flatMap((name) => PREFIXES.map((prefix) => [prefix + keyOf(name.slice(7)), name])),
  ...OPEN.flatMap(([open, own]) => PREFIXES.map((prefix) => [prefix + open, `viseme_${own}`])),
  ...Object.entries(ALSO).flatMap(([name, others]) => others.map((other) => [keyOf(other), name])),
]);
const HALVED = new Map([
  ...SIDED.map((stem) => [keyOf(stem), (side) => stem + side]),
  ...HALVES.map((name) => [keyOf(name), () => name]),
  ...['eyeBlink', 'mouthSmile'].flatMap((stem) => ALSO[stem].map((other) => [keyOf(other), (side) => stem + side])),
]);
for (const stem of ['jaw', 'mouth']) for (const [letter, side] of Object.entries(SIDES)) WHOLE.set(stem + letter, stem + side);
for (const stem of HALVED.keys())
  for (const [letter, side] of Object.entries(SIDES))
    for (const end of [letter, side.toLowerCase()]) WHOLE.set(stem + end, HALVED.get(stem)(side));

/** Words that say what a face does: what is beside a name and has one of them is another shape, or several at once. */
const TELLING = new Set([...WHOLE.values()].flatMap(wordsOf).filter((word) => !['viseme', 'v', 'e', 'i', 'o', 'u', 'aa'].includes(word)));
const PARTS = new Set(['mouth', 'jaw', 'eye', 'brow', 'cheek', 'nose', 'tongue']); // of a mesh, before the name
/** Allowed suffixes of a name: any other marks one of a series, a correction, or a mix. */
const BEHIND =
  /^(\d+|h|m|mesh|geo|geometry|shape|blendshape|bs|morph|target|key|ctrl|head|face|body|teeth|lashes|eyelashes|obj|object)$/;

/** The meaning of a name, and the number of meaningless words in it. @typedef {{shape: string, extra: number}} Read */

/** @param {string} name @returns {Read|null} */
function read(name) {
  const last = name.replace(/^.*[.:|]/, '');
  for (const [one, extra] of [[last, 0], [name, 0]]) {
    const shape = WHOLE.get(keyOf(one)) ?? KANA[one.trim()];
    if (shape) return { shape, extra };
  }
  const words = wordsOf(name);
  let best = null;
  const look = (list, side) => {
    for (let from = 0; from < list.length; from++)
      for (let to = list.length; to > from; to--) {
        const key = list.slice(from, to).join('');
        const shape = side ? HALVED.get(key)?.(side) : WHOLE.get(key);
        const extra = list.length - (to - from);
        if (!shape || (best && best.extra <= extra)) continue;
        const [before, behind] = [list.slice(0, from), list.slice(to)];
        const own = before.length === 1 && PARTS.has(before[0]);
        if ((!own && before.some((word) => TELLING.has(word))) || !behind.every((word) => BEHIND.test(word))) continue;
        best = { shape, extra };
      }
  };
  look(words, null);
  words.forEach((word, i) => sideOf(word) && look([...words.slice(0, i), ...words.slice(i + 1)], sideOf(word)));
  return best;
}

/** @param {string} name of a morph target in the file @returns {string|null} */
export const shapeOf = (name) => read(name)?.shape ?? null;

const LETTERS = { a: 'aa', i: 'ih', u: 'ou', e: 'ee', o: 'oh' };
const PLAIN = new Map([...VISEMES.map((name) => [keyOf(name.slice(7)), name]), ...OPEN.map(([open, own]) => [open, `viseme_${own}`])]);
const ENOUGH = 6; // consonants, so that names which end like visemes are taken for some

/**
 * Names that are alike but for their last word, numbers apart.
 * @returns {Map<string, Map<string, string>>} by what is alike: name by last word
 */
function rowsOf(names) {
  const rows = new Map();
  for (const name of names) {
    const words = wordsOf(name).filter((word, i, all) => i === all.length - 1 || !/^\d+$/.test(word));
    const row = words.slice(0, -1).join(' ');
    if (words.length) rows.set(row, (rows.get(row) ?? new Map()).set(words.at(-1), name));
  }
  return rows;
}

/** Names that only as a row say what they are: 15 visemes, or five vowels. @returns {Map<string, string>} shape by name */
export function rowShapes(names) {
  const out = new Map();
  const rows = [...rowsOf(names).values()];
  for (const row of rows) {
    const found = [...row].filter(([word]) => PLAIN.has(word)).map(([word, name]) => [name, PLAIN.get(word)]);
    const consonants = found.filter(([, shape]) => CONSONANTS.includes(shape.slice(7)));
    if (consonants.length >= ENOUGH) for (const [name, shape] of found) out.set(name, shape);
  }
  for (const row of rows)
    for (const vowels of [Object.entries(LETTERS), Object.values(LETTERS).map((word) => [word, word])]) {
      const fresh = vowels.filter(([word]) => row.has(word) && !out.has(row.get(word)));
      if (fresh.length === vowels.length) for (const [word, vowel] of fresh) out.set(row.get(word), `vowel_${vowel}`);
    }
  return out;
}

/**
 * Maps the names in one mesh to shapes; of several names for one shape the plainest counts.
 * @param {string[]} names @param {Map<string, string>} rows see rowShapes @returns {Map<string, string>} shape by name
 */
export function shapesAmong(names, rows) {
  const plainest = new Map();
  const understood = names.flatMap((name) => {
    const one = read(name) ?? (rows.has(name) ? { shape: rows.get(name), extra: 0 } : null);
    if (one) plainest.set(one.shape, Math.min(one.extra, plainest.get(one.shape) ?? Infinity));
    return one ? [[name, one]] : [];
  });
  const kept = understood.filter(([, { shape, extra }]) => extra === plainest.get(shape));
  return new Map(kept.map(([name, { shape }]) => [name, shape]));
}

/** Names of VRM's expressions, in 1.0 and in 0. */
const PRESETS = new Map([
  ...VOWELS.map((name) => [name.slice(6), name]),
  ...Object.entries(LETTERS).map(([old, name]) => [old, `vowel_${name}`]),
]);

/** @param {string} name of an expression of VRM @returns {string|null} */
export const presetOf = (name) => PRESETS.get(keyOf(name)) ?? shapeOf(name);

/** The shape of the other side; of those in the middle, itself. @param {string} name */
export function mirrored(name) {
  const other = name.replace(/(Left|Right)$/, (side) => (side === 'Left' ? 'Right' : 'Left'));
  return SHAPES.includes(other) ? other : name;
}

const EMPTY = /^(\d+|jnt|joint|bone|bn|def|org|root|facial|face|c|m|center|middle|s|x)$/; // in a bone's name
const BONES = { head: /^head$/, neck: /^neck$/, jaw: /^(jaw|mandible)$/, Eye: /^eye(ball)?$/ };
const OTHER = ['upper', 'end', 'top', 'nub']; // no bone with such a word is one of these
export const BONE_NAMES = ['head', 'neck', 'jaw', 'leftEye', 'rightEye'];

/** The bone of that name, if a face has use for it. @param {string} name @returns {string|null} */
export function boneOf(name) {
  const words = wordsOf(name);
  const last = words.findLast((word) => !EMPTY.test(word) && !sideOf(word)) ?? '';
  if (words.some((word) => OTHER.includes(word))) return null;
  const bone = Object.keys(BONES).find((one) => BONES[one].test(last) || (one === 'jaw' && keyOf(name) === 'chinbone'));
  const side = words.map(sideOf).findLast(Boolean);
  if (bone !== 'Eye') return bone && !side ? bone : null;
  return side ? `${side.toLowerCase()}Eye` : null;
}
