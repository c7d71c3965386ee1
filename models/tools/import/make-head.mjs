// SPDX-License-Identifier: GPL-3.0-or-later
/** Converts a scene to a head in the format of protocol/head-model.md. */
import { encodeDeltas, decode } from '../lib/codec.mjs';
import { FAPS } from '../lib/faps.mjs';
import { nearestVertex } from '../lib/mesh.mjs';
import { at, xfaceField, zoneFields } from './actions/fields.mjs';
import { actFromTable } from './actions/tables.mjs';
import { actFromTargets, moveOf } from './actions/targets.mjs';
import { jawPivot, jawTurn, lidsAndEyes, neck, some } from './actions/turns.mjs';
import { FileError } from './limits.mjs';
import { divide } from './mesh/divide.mjs';
import { paintColors } from './mesh/paint.mjs';
import { gatherParts, nameParts } from './mesh/parts.mjs';
import { placeHead } from './mesh/place.mjs';
import { faceOutward } from './mesh/triangles.mjs';
import { packModel } from './pack-model.mjs';

const FOLLOWS = ['mouth', 'brows', 'lashes', 'beard']; // parts without targets follow the skin below
const REACH = 14; // mm: vertices farther from the skin do not follow
const FOV = 26; // degrees
const CHIN = 1.25; // of the way from the picture's middle to the chin: its lower edge
const TOP = 0.96; // of the way from the middle to the upper edge: the hair
const FAR = 720; // mm: the farthest that hair moves the camera
const TONGUE = [43, 44, 45, 46];
const LOOKS = { skin: { roughness: 0.55, specular: 0.35, subsurface: 0.3 }, eye_l: { roughness: 0.12, specular: 0.6 }, eye_r: { roughness: 0.12, specular: 0.6 } };

/** For each vertex of a part that follows the skin under it: the skin's vertex, and the share; null: the part does not follow. */
function followed(part, skin) {
  if (!FOLLOWS.includes(part.name) || Object.keys(part.targets).length) return null;
  return Array.from({ length: part.position.length / 3 }, (_, v) => {
    const own = nearestVertex(skin, at(part.position, v));
    const away = Math.hypot(...at(part.position, v).map((x, k) => x - skin.position[3 * own + k]));
    return [own, away < REACH ? 0.5 + 0.5 * Math.cos((Math.PI * away) / REACH) : 0];
  });
}

/** Adds moves of zones (or Xface's weights) to the skin and the parts that follow it. */
function zoneMoves(parts, face, influences, notes) {
  const skin = face.skin;
  const { fields, jaw } = zoneFields(face);
  for (const one of influences) {
    const piece = skin.pieces.find(({ mesh }) => mesh.name === one.mesh) ?? skin.pieces[0];
    const field = xfaceField(skin, piece, face.fdp, one);
    if (field) fields.set(one.fap, field);
    else notes.push(`line ${one.line}: the weights of ${one.name} move nothing: zones take their place`);
  }
  const direct = (fap) => {
    const { point, direction } = FAPS[fap];
    const field = fields.get(fap);
    const d = at(field, nearestVertex(skin, face.fdp[point])).reduce((sum, x, k) => sum + x * direction[k], 0);
    return d > 0.2 ? field.map((x) => x / d) : field;
  };
  for (const fap of fields.keys()) fields.set(fap, direct(fap));
  const out = new Map();
  for (const part of parts) {
    const follows = followed(part, skin);
    if (part !== skin && !follows) continue;
    const of = (field) => (follows ? Float64Array.from(part.position, (_, i) => field[3 * follows[Math.floor(i / 3)][0] + (i % 3)] * follows[Math.floor(i / 3)][1]) : field);
    const moves = [...fields].filter(([fap]) => fap !== 3).map(([fap, field]) => moveOf(fap, 'both', of(field))).filter(Boolean);
    const shares = follows ? follows.map(([v, share]) => jaw[v] * share) : jaw;
    out.set(part, { moves, turns: [{ turn: 'jaw', ...some(shares) }] });
  }
  return out;
}

/** Moves of lower teeth and tongue with the jaw. */
function insideMoves(part, { fdp, pivot }) {
  const count = part.position.length / 3;
  const all = (direction) => Float64Array.from(part.position, (_, i) => direction[i % 3]);
  const chin = fdp['2.1'][2] - pivot[2];
  const front = part.position.reduce((most, x, i) => (i % 3 === 2 ? Math.max(most, x) : most), -Infinity);
  const back = part.position.reduce((least, x, i) => (i % 3 === 2 ? Math.min(least, x) : least), Infinity);
  const moves = [14, 15].map((fap) => moveOf(fap, 'both', all(FAPS[fap].direction)));
  const share = Math.min(1, chin / Math.max(1, front - pivot[2]));
  if (part.name === 'tongue')
    for (const fap of TONGUE) {
      const tip = (v) => Math.min(1, Math.max(0, (part.position[3 * v + 2] - back) / (front - back || 1)));
      const weight = (v) => (fap === 46 ? Math.sin(Math.PI * tip(v)) : tip(v) ** 1.5);
      moves.push(moveOf(fap, 'both', Float64Array.from({ length: 3 * count }, (_, i) => weight(Math.floor(i / 3)) * FAPS[fap].direction[i % 3])));
    }
  return { moves: moves.filter(Boolean), turns: [{ turn: 'jaw', weight: part.name === 'tongue' ? 0.82 * share : share }] };
}

function looksOf(scene, parts) {
  const [materials, textures] = [{}, {}];
  for (const part of parts) {
    const look = scene.materials[part.material] ?? { color: part.name === 'skin' ? [0.8, 0.62, 0.54] : [0.7, 0.7, 0.7], roughness: 0.6, alpha: 'opaque', double_sided: true, picture: null };
    const { picture } = look;
    if (picture) textures[part.name] = { type: picture.type, width: picture.width, height: picture.height, data: picture.data.toString('base64') };
    materials[part.name] = {
      ...(picture ? { texture: part.name } : {}),
      color: look.color.map((x) => Math.min(1, Math.max(0, x))),
      roughness: Math.min(1, Math.max(0.05, look.roughness)),
      specular: 0.3, alpha: look.alpha, double_sided: look.double_sided, subsurface: 0,
      ...(LOOKS[part.name.replace(/_\d+$/, '')] ?? {}),
    };
  }
  return { materials, textures };
}

/**
 * @param {object} scene of a reader @param {object} points see points.mjs
 * @param {{name: string, title: string, licence: string, credits: string[], unit?: string, up?: string}} options
 * @returns {{head: object, notes: string[], used: string[], tabled: number}} head: the file; notes: what was left out; used: targets behind its actions; tabled: FAPs of an animation table
 */
export function makeHead(scene, points, options) {
  nameParts(scene, points.parts ?? {});
  const placed = placeHead(scene, points, options);
  const { fdp, fapu } = placed;
  scene.notes.push(...faceOutward(scene), ...paintColors(scene, fapu));
  const parts = gatherParts(scene);
  const notes = [...scene.notes];
  const skin = parts.find(({ name }) => name === 'skin');
  const pivot = jawPivot(fdp, fapu);
  const face = { skin, fdp, fapu, pivot };
  for (const name of Object.keys(fdp)) if (!/^(3\.[56]|6|7|9\.([89]|1[01]))/.test(name)) settle(fdp, name, skin, notes);
  const byPart = zoneMoves(parts, face, points.influences ?? [], notes);
  const lids = lidsAndEyes(parts, fdp);
  const head = neck(parts, fdp, fapu);
  const table = scene.animation && actFromTable(scene.animation, parts, placed, (part) => followed(part, skin));
  const turns = [jawTurn(fdp, fapu, pivot), ...lids.turns, ...(table?.turns ?? []), ...head.turns];
  const made = parts.map((part) => {
    const own = byPart.get(part) ?? (['teeth_lower', 'tongue'].includes(part.name) ? insideMoves(part, face) : { moves: [], turns: [] });
    const made = { moves: [...own.moves], turns: [...own.turns, ...lids.shares(part), ...head.shares(part)].filter(({ vertices }) => !vertices || vertices.length) };
    return { ...part, material: part.name, ...(table ? table.replace(part, made, turns) : made) };
  });
  const model = { fapu, fdp, turns, parts: made };
  const { used, notes: more } = actFromTargets(model, parts);
  for (const part of made) for (const move of part.moves) checkScale(part, move);
  const view = viewOf(parts, fdp, fapu);
  const divided = made.flatMap((part, i) => divide(part, scene, part.name === 'skin' ? nearestVertex(skin, fdp['9.3']) : -1, parts[i].material));
  for (const { name, pieces } of made) {
    const own = divided.filter(({ part }) => part.pieces === pieces).map(({ part }) => part.name);
    if (own.length > 1) notes.push(`${name}: its ${own.length} pictures make it ${own.join(', ')}`);
  }
  const about = { name: options.name, title: options.title, licence: options.licence, credits: options.credits };
  return { head: packModel(about, { ...model, parts: divided.map(({ part }) => part), view, ...looksOf(scene, divided.map(({ part, look }) => ({ name: part.name, material: look }))) }), notes: [...notes, ...(table?.notes ?? []), ...more], used, tabled: table?.faps.length ?? 0 };
}

/** The portrait: the whole head where it is small enough, the chin in any case, and high hair as far as there is room. */
function viewOf(parts, fdp, fapu) {
  const { position } = parts.find(({ name }) => name === 'skin');
  const size = position.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
  const top = Math.max(...parts.filter(({ name }) => ['skin', 'hair'].includes(name)).map((part) => part.position.reduce((most, y, i) => (i % 3 === 1 ? Math.max(most, y) : most), -Infinity)));
  const [, chin, front] = fdp['2.1'];
  const half = Math.tan((FOV * Math.PI) / 360); // of the picture's height, at a distance of 1
  let middle = -0.5 * fapu.ENS;
  let distance = Math.max(500, Math.min(620, 5 * size), front + (CHIN * (middle - chin)) / half);
  const highest = () => chin + (half * (distance - front)) / CHIN; // middle, for the chin
  if (top > middle + TOP * half * distance) {
    distance = Math.max(distance, Math.min(FAR, (top - chin + (half * front) / CHIN) / (half * (TOP + 1 / CHIN))));
    middle = Math.max(middle, Math.min(top - TOP * half * distance, highest()));
  }
  return { target: [0, middle, 0], distance, fov: FOV };
}

/** Snaps a feature point to the nearest vertex of the skin. */
function settle(fdp, name, skin, notes) {
  const p = at(skin.position, nearestVertex(skin, fdp[name]));
  const away = Math.hypot(...p.map((x, k) => x - fdp[name][k]));
  if (away > 8) notes.push(`feature point ${name} is ${away.toFixed(1)} mm from the skin`);
  else fdp[name] = p;
}

function checkScale(part, move) {
  const packed = encodeDeltas(move.deltas);
  if (!Number.isFinite(packed.scale) || decode('int16', packed.data).some((x) => !Number.isFinite(x))) throw new FileError(part.name, `FAP ${move.fap} moves it to nowhere`);
}
