// SPDX-License-Identifier: MIT
// A head out of pictures of a face, in a page and in Node alike: reading and writing images is the caller's.
import { HEAD_FAPS, readModel } from '../element/head/model/model.mjs';
import { ageing, linesOf } from './age.mjs';
import { dress } from './dress.mjs';
import { fitShape, isFront, laid, tooTurned, unlikeness } from './fit.mjs';
import { glasses } from './glasses.mjs';
import { dye, nearness, underHair } from './hair.mjs';
import { luma } from './lab.mjs';
import { morph } from './morph.mjs';
import { packPositions } from './pack.mjs';
import { PortraitError } from './problem.mjs';
import { layProfile, outlinesOf, withProfiles } from './profile.mjs';
import { inWhiteLight } from './light.mjs';
import { sagging } from './sag.mjs';
import { surfaceOf } from './sheen.mjs';
import { coded, linear, paintSkin, tonesOf } from './skin.mjs';
import { toneOfBoth } from './tone.mjs';

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
  const tone = toneOfBoth(tonesOf(picture, landmarks));
  return Object.entries(table)
    .map(([name, base]) => {
      return { name, mm: unlikeness(landmarks, base), tone: distant(tone, toneOfBoth(base)), worn: base.worn.length };
    })
    .sort((a, b) => costOf(a) - costOf(b));
}

/**
 * @param {object} own the base head (protocol/head-model.md) @param {import('./fit.mjs').Points} base its landmarks
 * @param {{picture: {width: number, height: number, data: ArrayLike<number>}, landmarks?: number[][], outlines?:
 *   object}[]} views upright
 *   pictures in RGBA; outlines in place of landmarks: of asProfile
 * @param {{read: (texture: object) => Promise<object>, write: (image: object) => Promise<object>}} images read: a texture of
 *   a head as
 *   RGBA; write: RGBA as a texture
 * @param {{name?: string, title?: string, keep?: string[], eyes?: object|null, hair?: 'none'|number[]|null, brows?:
 *   number[]|null, wear?: Record<string, object>, light?: number, bearded?: boolean, lit?: number, age?: number|null, old?:
 *   object|null, beard?: number[]|null, roots?: boolean, shaved?: boolean, glasses?: string|null}}
 *   [options] keep: of what the base wears (beard, glasses); eyes: the head that they are taken from; hair: none, or its linear
 *   colour (of hairOf; otherwise the base's); brows: their linear colour; wear: heads by what of them it wears instead of the
 *   base's own (hair, beard, glasses); light: stops by which the skin is lighter than in the picture; bearded: the face in
 *   it is known to have a beard or a moustache; lit: of the head whose hair it has, where that is another; beard: its
 *   linear colour; roots: of the beard on the skin; shaved: no more than these; glasses: frames (glasses.mjs); age: in years,
 *   and old: the head whose lines an old skin gets
 * @returns {Promise<{head: object, parted: boolean, sides: number, profiles: number, bearded: boolean}>} parted: the lips
 *   are, so the mouth is less the face's own; bearded: the face is, and its beard is not in the skin
 */
export async function makeHead(own, base, views, images, options = {}) {
  const ordered = inOrder(views.filter(({ landmarks }) => landmarks), base).map(inWhiteLight);
  const fitted = fitShape(ordered, base);
  const profiles = views.filter(({ outlines }) => outlines);
  const target = withProfiles(fitted.target, profiles);
  const worn = Object.entries(options.wear ?? {});
  const dressed = worn.reduce((head, [word, from]) => dress(head, from, word), own);
  const roots = options.roots ? readModel(dressed).parts.filter(({ name }) => name.startsWith('beard')).map(({ position }) => position) : [];
  const json = options.shaved ? { ...dressed, parts: dressed.parts.filter(({ name }) => !name.startsWith('beard')) } : dressed;
  const model = readModel(json);
  const part = model.parts.find(({ name }) => name === 'skin');
  const eyes = model.parts.filter(({ name }) => name.startsWith('eye'));
  const texture = json.textures[model.materials[part.material].texture];
  const { hair = null, light = 0 } = options;
  const kept = [...(options.keep ?? []), ...worn.map(([word]) => word)].filter((word) => !(options.shaved && word === 'beard'));
  const gone = [...WORN.filter((name) => !kept.includes(name)), ...(hair === 'none' ? ['hair'] : [])];
  const before = readModel(own);
  const isLost = (word) => gone.includes(word) || worn.some(([other]) => other === word);
  const lost = (word) => (isLost(word) ? before.parts.filter(({ name }) => name.startsWith(word)) : []);
  const isLid = (turn) => model.turns[turn].name.startsWith('lid');
  const stubble = options.beard ?? (Array.isArray(hair) ? hair : options.brows) ?? STUBBLE;
  const scalp = [...scalpOf(part, own, { hair, lost: lost('hair').map(({ position }) => position), worn: options.wear?.hair ? model.parts.filter(({ name }) => name.startsWith('hair')).map(({ position }) => position) : null }),
    ...(roots.length ? [{ share: stubbled(part, roots), colour: stubble.map((x) => x * ROOTS) }] : [])];
  const age = ageing(options.age);
  const lines = age && options.old ? linesOf(await images.read(skinOf(options.old)), linear) : null;
  const about = { part, surface: json.materials[part.material], age, years: options.age, lines, texture: await images.read(texture), eyes, worn: lost('glasses'), base, isLid, scalp, light, bearded: options.bearded };
  const skin = paintSkin(about, ordered, fitted.views);
  const changed = morph(model, base, target, sagging(base, options.age));
  const head = {
    ...json,
    name: options.name ?? 'portrait',
    title: options.title ?? options.name ?? 'Portrait',
    about: 'Made from a picture',
    licence: 'LicenseRef-portrait',
    credits: [...json.credits, `Shape and skin: made from ${views.length > 1 ? 'pictures' : 'a picture'}, whose rights are those of the person in it and of who took it`],
    fapu: changed.fapu,
    fdp: changed.fdp,
    turns: changed.turns.filter(({ sways }) => !sways), // parts have their own
    textures: { ...json.textures, [model.materials[part.material].texture]: await images.write(skin) },
    materials: { ...json.materials, [part.material]: surfaceOf(json.materials[part.material], skin.tone.face, age) },
    parts: json.parts.map((one, i) => ({ ...one,
      position: packPositions(changed.positions.get(model.parts[i])) })).filter(({ name }) =>
      !gone.some((word) => name.startsWith(word))),
  };
  delete head.rank;
  if (options.glasses) wearGlasses(head, options.glasses, changed.positions.get(part));
  const { brows = null, beard = null, lit = base.lit } = options;
  await dyeHair(head, { hair: Array.isArray(hair) ? hair : null, brows, beard, lit }, images);
  if (options.eyes) swapEyes(head, options.eyes);
  dropUnused(head);
  return { head, parted: fitted.parted, sides: ordered.length - 1, profiles: profiles.length, bearded: skin.bearded };
}

/** The texture of a head's skin. */
function skinOf({ parts, materials, textures }) {
  return textures[materials[parts.find(({ name }) => name === 'skin').material].texture];
}

const ROOTS = 0.35; // the scalp beneath it
const [LIGHT, LIGHT_ROOTS] = [0.4, 0.7]; // and that of light hair
const BROWS = 0.55; // of the hair's colour: brows are mostly darker

const STUBBLE = [0.03, 0.024, 0.02]; // linear, of no known colour
const SHADE = 0.5; // of the skin that stubble covers
const STUBBLED = [3, 9]; // mm from a beard that is close to the skin

const stubbled = ({ position }, lists) => {
  const near = nearness(lists, STUBBLED);
  const at = (v) => near(position.subarray(3 * v, 3 * v + 3));
  return Float32Array.from({ length: position.length / 3 }, (_, v) => SHADE * Math.min(1, Math.max(0, at(v))));
};

/** Frames on the new face. @param {Float32Array} skin positions */
function wearGlasses(head, kind, skin) {
  const whole = head.turns.filter(({ fap }) => HEAD_FAPS.includes(fap));
  const { part, name, material } = glasses(kind, head.fdp, skin, whole);
  head.parts.push(part);
  head.materials[name] = material;
}

const EARS = [['10.1', '10.5'], ['10.2', '10.6']]; // top and lobe
const earsOf = (fdp) => EARS.filter((ear) => ear.every((name) => fdp[name]))
  .map(([top, lobe]) => fdp[top].map((x, k) => (x + fdp[lobe][k]) / 2));

const BARE = 0.85; // of the face's tone: a scalp is lit from above
const UNDER_CARDS = [5, 12]; // mm from hair that is another head's, where its roots are: a parting is narrower than that
const FOREHEAD = 14; // mm that another head's hair may begin lower

/**
 * What is painted on the scalp: roots of hair that is lost give way to skin, and hair of a known colour has roots of it; those
 * of another hair in its own colour stay.
 */
function scalpOf({ position }, { fdp }, { hair, lost, worn }) {
  const bare = lost.length && hair ? [{ share: underHair(position, earsOf(fdp), lost), colour: null, bright: BARE }] : [];
  if (!Array.isArray(hair)) return bare;
  const near = worn && nearness(worn, UNDER_CARDS);
  const zone = underHair(position, earsOf(fdp), [], near ? FOREHEAD : 0);
  const share = near ? zone.map((x, v) => Math.min(x, Math.max(0, near(position.subarray(3 * v, 3 * v + 3))))) : zone;
  const roots = ROOTS + (LIGHT_ROOTS - ROOTS) * Math.min(1, luma(hair) / LIGHT);
  return [...bare, { share, colour: hair.map((x) => x * roots) }];
}

/**
 * Hair, beard and brows in other colours; brows of no known colour are as dark as that hair's mostly are; a bald head's beard
 * is as its brows are.
 */
async function dyeHair(head, { hair, brows, beard, lit }, images) {
  const colours = { hair, beard: beard ?? hair ?? brows, brows: brows ?? hair?.map((x) => x * BROWS) ?? null };
  const done = new Set();
  for (const { name, material } of head.parts) {
    const { texture } = head.materials[material];
    const colour = colours[/^(hair|beard|brows)/.exec(name)?.[1]];
    if (!colour || !texture || done.has(texture)) continue;
    done.add(texture);
    const image = await images.read(head.textures[texture]);
    dye(image, colour.map((x) => x * lit), { linear, coded });
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
