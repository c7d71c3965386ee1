// SPDX-License-Identifier: MIT
// What a picture proposes for a head, for a person to confirm: hairstyles, hair's colour, beard, glasses. Nothing is proposed
// that depends on who the person is, and what was not recognised for certain is named.
import { beardOfKind } from './dress.mjs';
import { framesOf } from './frames.mjs';
import { FRAMES } from './glasses.mjs';
import { beardColourOf, browsOf, hairOf, isNatural, sideHairOf } from './hair.mjs';
import { similarEyes } from './iris.mjs';
import { inWhiteLight } from './light.mjs';
import { isLikely, measure, similarHair, traitsOf } from './traits.mjs';

const STYLES = 3; // hairstyles that are offered first
const LONG = 0.5; // of a form: from there on hair is long
const SKIN = 0.4; // share of brows' colour that is the skin between their hairs

const dulled = (c) => c.map((x) => x + SKIN * (0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2] - x));

/** Whether a head's hair is long. */
export const isLong = ({ hair }) => hair[0] > LONG;

const BY_HAND = ['bun', 'cornrows', 'locs']; // seen from the front they have the form of short or of long hair

/** The most similar hair; where its length is unsure, there is long and short. */
function stylesOf(measured, long, table) {
  const all = similarHair(measured, table).filter((name) => !BY_HAND.includes(name));
  const best = all.slice(0, STYLES);
  const kinds = new Set(best.map((name) => isLong(table[name])));
  const other = long === 'unsure' && kinds.size === 1 ? all.find((name) => !kinds.has(isLong(table[name]))) : null;
  return other ? [...best.slice(0, -1), other] : best;
}

/** Heads with the lines of old skin, by the voice of the head that gets them. */
export const OLDEST = { female: 'rosa', male: 'ettore' };
export const BEARDS = ['none', 'stubble', 'moustache', 'goatee', 'short', 'full'];
export const GLASSES = ['none', ...FRAMES, 'some'];

/**
 * @typedef {'none'|'stubble'|'moustache'|'goatee'|'short'|'full'} Beard stubble: roots on the skin
 * @typedef {'none'|'dark'|'metal'|'round'|'half'|'some'} Glasses some: those of a head
 * @typedef {object} Offer
 * @property {import('./traits.mjs').Traits} traits
 * @property {string[]} styles heads with the most similar hair, the best first; without "none", which is always possible
 * @property {string} eyes the head whose irises are the most similar
 * @property {'hair'|'none'|'unsure'} kind of the hair above the forehead
 * @property {number[]|null} colour of the hair, linear: where it is not recognised, that of the brows
 * @property {number[]|null} brows their colour
 * @property {number[]|null} beard its colour
 * @property {{hair: string|null, beard: Beard, glasses: Glasses}} first the proposal; hair: of which
 *   head, or 'none'; null: whether it is bald, or long, must be asked
 * @property {string[]} unsure names of traits, 'colour', and 'covered': what is above the forehead has no colour of hair
 */

/**
 * @param {{picture: object, landmarks: number[][]}} front
 * @param {Record<string, import('./fit.mjs').Points>} table of heads, and of hairstyles alone
 * @returns {Offer}
 */
export function offerOf(front, table) {
  const { picture, landmarks } = inWhiteLight(front);
  const measured = measure(picture, landmarks);
  const traits = traitsOf(measured);
  const { kind, colour: above } = hairOf(picture, landmarks);
  const found = above ?? sideHairOf(picture, landmarks);
  const isCovered = Boolean(found) && !isNatural(found);
  const colour = isCovered ? null : found;
  const styles = stylesOf(measured, traits.long, table);
  const brows = browsOf(picture, landmarks);
  const style = traits.long === 'unsure' || isCovered ? null : styles[0];
  const hair = { yes: 'none', unsure: kind === 'none' ? 'none' : null, no: style }[traits.bald];
  const hasMoustache = isLikely(measured, 'moustache');
  const isFull = isLikely(measured, 'beard') || (hasMoustache && traits.beard !== 'no');
  const beard = isFull ? 'full' : hasMoustache ? 'moustache' : 'none';
  return {
    traits, styles, kind, brows, eyes: similarEyes({ picture, landmarks }, table)[0], beard: beard === 'none' ? null : beardColourOf(picture, landmarks), colour: colour ?? (brows && dulled(brows)), first: { hair, beard, glasses: isLikely(measured, 'glasses') ? framesOf(picture, landmarks) : 'none' },
    unsure: [...(isCovered ? ['covered'] : []), ...Object.keys(traits).filter((name) => traits[name] === 'unsure'), ...((colour && traits.bald === 'no') || hair === 'none' ? [] : ['colour'])],
  };
}

/** The heads that wear something. @param {Record<string, import('./fit.mjs').Points>} table @param {'beard'|'glasses'} what */
export const wearersOf = (table, what) => Object.keys(table).filter((name) => table[name].worn?.includes(what));

/**
 * What makeHead is told of a choice.
 * @param {{hair: string, beard: Beard, glasses: Glasses}} choice hair: a head's name, or 'none'
 * @param {string} like the base head @param {Record<string, import('./fit.mjs').Points>} table
 * @param {(name: string) => Promise<object>} load loads a head
 * @returns {Promise<object>} options of makeHead
 */
export async function wornOf({ hair, beard, glasses }, like, table, load) {
  const wearer = (what) => (table[like].worn?.includes(what) ? like : wearersOf(table, what)[0]);
  const from = { hair: hair === 'none' ? null : hair, beard: beard === 'none' ? null : wearer('beard'), glasses: glasses === 'some' ? wearer('glasses') : null };
  const [wear, keep] = [{}, []];
  for (const [what, name] of Object.entries(from)) {
    if (!name) continue;
    const isCut = what === 'beard' && beard !== 'full';
    if (isCut) wear.beard = beardOfKind(await load(name), beard === 'stubble' ? 'short' : beard);
    else if (name === like) keep.push(what);
    else wear[what] = await load(name);
  }
  return { wear, keep, bearded: beard !== 'none' && beard !== 'stubble', roots: beard === 'stubble' || beard === 'short',
    shaved: beard === 'stubble', glasses: FRAMES.includes(glasses) ? glasses : null, lit: table[from.hair ?? like].lit };
}
