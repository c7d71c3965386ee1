// SPDX-License-Identifier: GPL-3.0-or-later
/** The shapes that avatars have, as FAPs: ../../shapes. */
import fs from 'node:fs';

const arkit = JSON.parse(fs.readFileSync(new URL('../../shapes/arkit.json', import.meta.url), 'utf8'));
const visemes = JSON.parse(fs.readFileSync(new URL('../../shapes/visemes.json', import.meta.url), 'utf8'));
const letters = JSON.parse(fs.readFileSync(new URL('../../shapes/letters.json', import.meta.url), 'utf8'));
const moods = JSON.parse(fs.readFileSync(new URL('../../shapes/moods.json', import.meta.url), 'utf8'));

/** @type {Object<string, Object<number, number>>} ARKit's 52: FAP values at weight 1, in their order */
export const ARKIT = Object.fromEntries(Object.entries(arkit.shapes).map(([name, { faps }]) => [name, faps]));

/** @type {Object<string, Object<number, number>>} the 15 visemes, as `viseme_PP` */
export const VISEMES = Object.fromEntries(Object.entries(visemes.visemes).map(([name, { faps }]) => [`viseme_${name}`, faps]));

/** @type {Object<string, Object<number, number>>} the shapes of Turkish letters, each beside a class of vowels, as `letter_bpa` */
export const LETTERS = Object.fromEntries(Object.entries(letters.shapes).map(([name, { faps }]) => [`letter_${name}`, faps]));

/** @type {Object<string, Object<string, number>>} VRM's moods: weights of ARKit's shapes */
export const MOODS = moods.moods;
