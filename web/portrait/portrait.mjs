// SPDX-License-Identifier: MIT
// A head out of pictures of a face, in a page and in Node alike: reading and writing images is the caller's.
import { readModel } from '../element/head/model/model.mjs';
import { fitShape, isFront, laid, tooTurned, unlikeness } from './fit.mjs';
import { dye, underHair } from './hair.mjs';
import { morph } from './morph.mjs';
import { packPositions } from './pack.mjs';
import { PortraitError } from './problem.mjs';
import { layProfile, outlinesOf, withProfiles } from './profile.mjs';
import { coded, linear, paintSkin, toneOf } from './skin.mjs';

const WORN_MM = 2; // what a beard or glasses cost there: their roots and shadows stay on the skin
const TONE_MM = 5; // how many mm of shape a doubling of the skin's brightness is worth in the choice of a base
export const WORN = ['beard', 'glasses']; // what a base has that the face may not

const costOf = ({ mm, tone, worn }) => mm + TONE_MM * tone + WORN_MM * worn;
const distant = (a, b) => Math.hypot(...a.map((x, k) => Math.log2((x + 0.01) / (b[k] + 0.01))));

/** The front first, then the sides. @throws {PortraitError} @param {import('./fit.mjs').Points} base any */
export function inOrder(views, base) {
  const looks = views.map((view) => ({ view, ...laid(view.landmarks, base) }));
  const fronts = looks.filter(isFront).sort((a, b) => Math.abs(a.yaw) - Math.abs(b.yaw));
  const first = fronts[0] ?? looks.reduce((a, b) => (Math.abs(b.yaw) < Math.abs(a.yaw) ? b : a));
  if (tooTurned(first)) throw new PortraitError('turned', 'one picture must show the face from the front');
  return [first.view, ...looks.filter((look) => look !== first && !isFront(look)).map(({ view }) => view)];
}

/**
 * Reads a picture without landmarks as one from the side; its outline must resemble one of the base heads.
 * @param {object} picture @param {Record<string, import('./fit.mjs').Points>} table of base heads
 * @returns {{picture: object, outlines: object, points: number[][]}} points: of the line that was found, in the picture
 * @throws {PortraitError}
 */
export function asProfile(picture, table) {
  const outlines = outlinesOf(picture);
  let best = null;
  for (const { at } of Object.values(table)) {
    try {
      const laid = layProfile(picture, outlines, at);
      if (!best || laid.cost < best.cost) best = laid;
    } catch (error) {
      if (!(error instanceof PortraitError)) throw error;
    }
  }
  if (!best) throw new PortraitError('no_face', 'there is no face to be found in the picture');
  return { picture, outlines, points: best.points };
}

/**
 * Heads by how near they are to a face, the nearest first. @returns {{name: string, mm: number, tone: number, worn:
 * number}[]}
 */
export function nearest({ picture, landmarks }, table) {
  const tone = toneOf(picture, landmarks);
  return Object.entries(table)
    .map(([name, base]) => ({ name, mm: unlikeness(landmarks, base), tone: distant(tone, base.tone), worn: base.worn.length }))
    .sort((a, b) => costOf(a) - costOf(b));
}

/**
 * @param {object} json the base head (protocol/head-model.md) @param {import('./fit.mjs').Points} base its landmarks
 * @param {{picture: {width: number, height: number, data: ArrayLike<number>}, landmarks?: number[][], outlines?:
 *   object}[]} views upright
 *   pictures in RGBA; outlines in place of landmarks: of asProfile
 * @param {{read: (texture: object) => Promise<object>, write: (image: object) => Promise<object>}} images read: a texture of
 *   a head as
 *   RGBA; write: RGBA as a texture
 * @param {{name?: string, title?: string, keep?: string[], eyes?: object|null, hair?: 'none'|number[]|null, light?: number}}
 *   [options] keep: of what the base wears (beard, glasses); eyes: the head that they are taken from; hair: none, or its linear
 *   colour (of hairOf; otherwise the base's); light: stops by which the skin is lighter than in the picture
 * @returns {Promise<{head: object, parted: boolean, sides: number, profiles: number, bearded: boolean}>} parted: the lips
 *   are, so the mouth is less the face's own; bearded: the face is, and its beard is not in the skin
 */
export async function makeHead(json, base, views, images, options = {}) {
  const ordered = inOrder(views.filter(({ landmarks }) => landmarks), base);
  const fitted = fitShape(ordered, base);
  const profiles = views.filter(({ outlines }) => outlines);
  const target = withProfiles(fitted.target, profiles);
  const model = readModel(json);
  const part = model.parts.find(({ name }) => name === 'skin');
  const eyes = model.parts.filter(({ name }) => name.startsWith('eye'));
  const texture = json.textures[model.materials[part.material].texture];
  const { hair = null, light = 0 } = options;
  const gone = [...WORN.filter((name) => !(options.keep ?? []).includes(name)), ...(hair === 'none' ? ['hair'] : [])];
  const worn = gone.includes('glasses') ? model.parts.filter(({ name }) => name.startsWith('glasses')) : [];
  const isLid = (turn) => model.turns[turn].name.startsWith('lid');
  const hairs = model.parts.filter(({ name }) => name.startsWith('hair')).map(({ position }) => position);
  const scalp = hair && {
    share: underHair(part.position, earsOf(json.fdp), hair === 'none' ? hairs : []),
    colour: hair === 'none' ? null : hair.map((x) => x * ROOTS),
  };
  const about = { part, texture: await images.read(texture), eyes, worn, base, isLid, scalp, light };
  const skin = paintSkin(about, ordered, fitted.views);
  const changed = morph(model, base, target);
  const head = {
    ...json,
    name: options.name ?? 'portrait',
    title: options.title ?? options.name ?? 'Portrait',
    about: 'Made from a picture',
    licence: 'LicenseRef-portrait',
    credits: [...json.credits, `Shape and skin: made from ${views.length > 1 ? 'pictures' : 'a picture'}, whose rights are those of the person in it and of who took it`],
    fapu: changed.fapu,
    fdp: changed.fdp,
    turns: changed.turns,
    textures: { ...json.textures, [model.materials[part.material].texture]: await images.write(skin) },
    materials: { ...json.materials },
    parts: json.parts.map((one, i) => ({ ...one,
      position: packPositions(changed.positions.get(model.parts[i])) })).filter(({ name }) =>
      !gone.some((word) => name.startsWith(word))),
  };
  delete head.rank;
  if (Array.isArray(hair)) await dyeHair(head, hair, images);
  if (options.eyes) swapEyes(head, options.eyes);
  dropUnused(head);
  return { head, parted: fitted.parted, sides: ordered.length - 1, profiles: profiles.length, bearded: skin.bearded };
}

const LIT = 0.55; // of a colour as it is seen: hair is drawn in a brighter light
const ROOTS = 0.35; // the scalp beneath it
const BROWS = 0.3; // and brows, which are mostly darker

const EARS = [['10.1', '10.5'], ['10.2', '10.6']]; // top and lobe
const earsOf = (fdp) => EARS.filter((ear) => ear.every((name) => fdp[name]))
  .map(([top, lobe]) => fdp[top].map((x, k) => (x + fdp[lobe][k]) / 2));

/** Hair, beard and brows in another colour. */
async function dyeHair(head, colour, images) {
  const done = new Set();
  for (const { name, material } of head.parts) {
    const { texture } = head.materials[material];
    if (!/^(hair|beard|brows)/.test(name) || !texture || done.has(texture)) continue;
    done.add(texture);
    const image = await images.read(head.textures[texture]);
    dye(image, colour.map((x) => x * (name.startsWith('brows') ? BROWS : LIT)), { linear, coded });
    head.textures = { ...head.textures, [texture]: await images.write(image, { alpha: true }) };
  }
}

/** Another head's irises: all eyes are painted alike. */
function swapEyes(head, from) {
  const nameIn = (json) => json.materials[json.parts.find(({ name }) => name === 'eye_l').material].texture;
  head.textures = { ...head.textures, [nameIn(head)]: from.textures[nameIn(from)] };
}

function dropUnused(head) {
  const materials = new Set(head.parts.map(({ material }) => material));
  head.materials = Object.fromEntries(Object.entries(head.materials).filter(([name]) => materials.has(name)));
  const textures = new Set(Object.values(head.materials).map(({ texture }) => texture));
  head.textures = Object.fromEntries(Object.entries(head.textures).filter(([name]) => textures.has(name)));
}
