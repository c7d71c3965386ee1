// SPDX-License-Identifier: MIT
// What avatars call their shapes. A name says which shape is meant, never what it does: that is measured.

const SIDED = `browDown browOuterUp cheekSquint eyeBlink eyeLookDown eyeLookIn eyeLookOut eyeLookUp eyeSquint eyeWide mouthDimple
  mouthFrown mouthLowerDown mouthPress mouthSmile mouthStretch mouthUpperUp noseSneer`.split(/\s+/);
const MIDDLE = `browInnerUp cheekPuff jawForward jawLeft jawOpen jawRight mouthClose mouthFunnel mouthLeft mouthPucker mouthRight
  mouthRollLower mouthRollUpper mouthShrugLower mouthShrugUpper tongueOut`.split(/\s+/);

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

const key = (name) => name.toLowerCase().replace(/[^a-z0-9]/g, '');

const KNOWN = new Map([
  ...ARKIT.map((name) => [key(name), name]),
  ...SIDED.flatMap((stem) => [['l', 'Left'], ['r', 'Right']].map(([letter, side]) => [key(stem) + letter, stem + side])),
  ...VISEMES.flatMap((name) => ['viseme', 'v', 'vis'].map((prefix) => [prefix + key(name.slice(7)), name])),
  ...[['ih', 'I'], ['oh', 'O'], ['ou', 'U']].flatMap(([open, own]) => ['viseme', 'v', 'vis'].map((prefix) => [prefix + open, `viseme_${own}`])),
  ['eyesclosed', 'eyeBlink'],
  ...MORE.map((name) => [key(name), name]),
]);

/** What VRM's expressions are called, in 1.0 and in 0. */
const PRESETS = new Map([
  ...VOWELS.map((name) => [name.slice(6), name]),
  ...Object.entries({ a: 'aa', i: 'ih', u: 'ou', e: 'ee', o: 'oh' }).map(([old, name]) => [old, `vowel_${name}`]),
  ['blink', 'eyeBlink'],
  ...['Left', 'Right'].flatMap((side) => [`blink${side}`, `blink_${side[0]}`].map((name) => [key(name), `eyeBlink${side}`])),
]);

const PLAIN = new Map([
  ...VISEMES.map((name) => [key(name.slice(7)), name]),
  ...[['ih', 'I'], ['oh', 'O'], ['ou', 'U']].map(([open, own]) => [open, `viseme_${own}`]),
]);
const ENOUGH = 6; // consonants, so that bare names are taken for visemes

/** @param {string} name of a morph target, as it is in the file @returns {string|null} */
export const shapeOf = (name) => KNOWN.get(key(name.replace(/^.*[.:|]/, ''))) ?? KNOWN.get(key(name)) ?? null;

/** @param {string} name of an expression of VRM @returns {string|null} */
export const presetOf = (name) => PRESETS.get(key(name)) ?? shapeOf(name);

/** Visemes without anything before them: only where there are so many that they are meant. @returns {Map<string, string>} */
export function plainVisemes(names) {
  const found = new Map(names.flatMap((name) => (PLAIN.has(key(name)) ? [[name, PLAIN.get(key(name))]] : [])));
  const consonants = [...found.values()].filter((name) => CONSONANTS.includes(name.slice(7)));
  return consonants.length >= ENOUGH ? found : new Map();
}

/** The shape of the other side; of those in the middle, itself. @param {string} name */
export function mirrored(name) {
  const other = name.replace(/(Left|Right)$/, (side) => (side === 'Left' ? 'Right' : 'Left'));
  return SHAPES.includes(other) ? other : name;
}

const BONES = {
  head: /^(.*[:_. ])?head$/i,
  neck: /^(.*[:_. ])?neck(_?0?1)?$/i,
  jaw: /^(.*[:_. ])?(jaw|jawroot|lowerjaw|chin_bone|mandible)(_?0?1)?$/i,
  leftEye: /^(.*[:_. ])?((left|l)[_ ]?eye|eye[_. ]?(left|l)|faceeye_?l)$/i,
  rightEye: /^(.*[:_. ])?((right|r)[_ ]?eye|eye[_. ]?(right|r)|faceeye_?r)$/i,
};

/** The bone of that name, if a face has use for it. @param {string} name @returns {string|null} */
export const boneOf = (name) => Object.keys(BONES).find((bone) => BONES[bone].test(name)) ?? null;
export const BONE_NAMES = Object.keys(BONES);
