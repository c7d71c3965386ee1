// SPDX-License-Identifier: GPL-3.0-or-later
/** Converts a scene to a head in the format of protocol/head-model.md. */
import fs from 'node:fs';
import path from 'node:path';
import zlib from 'node:zlib';
import { encodeDeltas, decode } from '../lib/codec.mjs';
import { FAPS } from '../lib/faps.mjs';
import { divide } from './divide.mjs';
import { FileError, MOST } from './file-error.mjs';
import { at, nearestVertex, xfaceField, zoneFields } from './fields.mjs';
import { packModel } from './pack-model.mjs';
import { gatherParts, nameParts } from './parts.mjs';
import { paintColors } from './paint.mjs';
import { placeHead } from './place.mjs';
import { Budget } from './budget.mjs';
import { readFbx } from './read-fbx.mjs';
import { readGltf } from './read-gltf.mjs';
import { readObj } from './read-obj.mjs';
import { readPly } from './read-ply.mjs';
import { readVrml } from './read-vrml.mjs';
import { faceOutward } from './winding.mjs';
import { nameTargets } from './target-names.mjs';
import { actFromTargets, moveOf } from './targets.mjs';
import { jawPivot, jawTurn, lidsAndEyes, neck, some } from './turns.mjs';

const FOLLOWS = ['mouth', 'brows', 'lashes', 'beard']; // parts without targets follow the skin below
const REACH = 14; // mm: vertices farther from the skin do not follow
const TONGUE = [43, 44, 45, 46];
const LOOKS = { skin: { roughness: 0.55, specular: 0.35, subsurface: 0.3 }, eye_l: { roughness: 0.12, specular: 0.6 }, eye_r: { roughness: 0.12, specular: 0.6 } };

const READERS = { glb: readGltf, gltf: readGltf, vrm: readGltf, fbx: readFbx, obj: readObj, ply: readPly, wrl: readVrml, vrml: readVrml, wrz: readVrml };

/** Unpacks gzip, which VRML and PLY files may use without a matching name. */
function unzipped(bytes) {
  try {
    return zlib.gunzipSync(bytes, { maxOutputLength: MOST.bytes });
  } catch (error) {
    throw new FileError('', `cannot be unpacked: ${error.message}`);
  }
}

export async function readScene(file) {
  const kind = path.extname(file).slice(1).toLowerCase();
  if (!READERS[kind]) throw new FileError('', `".${kind}" is not read: ${Object.keys(READERS).join(', ')}; other files save as GLB (Blender does)`);
  const { size } = fs.statSync(file);
  if (size > MOST.bytes) throw new FileError('', `${size} bytes are more than ${MOST.bytes}`);
  try {
    const bytes = fs.readFileSync(file);
    const scene = await READERS[kind](file, bytes[0] === 0x1f && bytes[1] === 0x8b ? unzipped(bytes) : bytes, new Budget());
    nameTargets(scene);
    return scene;
  } catch (error) {
    // values of a wrong type: the JavaScript error names the member
    if (error instanceof TypeError || error instanceof RangeError) throw new FileError('', `is not built as .${kind} files are: ${error.message}`);
    throw error;
  }
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
  const nearest = (part) =>
    Array.from({ length: part.position.length / 3 }, (_, v) => {
      const own = nearestVertex(skin, at(part.position, v));
      const away = Math.hypot(...at(part.position, v).map((x, k) => x - skin.position[3 * own + k]));
      return [own, away < REACH ? 0.5 + 0.5 * Math.cos((Math.PI * away) / REACH) : 0];
    });
  const out = new Map();
  for (const part of parts) {
    const follows = FOLLOWS.includes(part.name) && !Object.keys(part.targets).length ? nearest(part) : null;
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
 * @returns {{head: object, notes: string[], used: string[]}} head: the file; notes: what was left out; used: targets behind its actions
 */
export function makeHead(scene, points, options) {
  nameParts(scene, points.parts ?? {});
  const { fdp, fapu } = placeHead(scene, points, options);
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
  const turns = [jawTurn(fdp, fapu, pivot), ...lids.turns, ...head.turns];
  const made = parts.map((part) => {
    const own = byPart.get(part) ?? (['teeth_lower', 'tongue'].includes(part.name) ? insideMoves(part, face) : { moves: [], turns: [] });
    return { ...part, material: part.name, moves: [...own.moves], turns: [...own.turns, ...lids.shares(part), ...head.shares(part)].filter(({ vertices }) => !vertices || vertices.length) };
  });
  const model = { fapu, fdp, turns, parts: made };
  const { used, notes: more } = actFromTargets(model, parts);
  for (const part of made) for (const move of part.moves) checkScale(part, move);
  const size = Math.max(...skin.position.reduce((most, x, i) => ((most[i % 3] = Math.max(most[i % 3], Math.abs(x))), most), [0, 0, 0]));
  const view = { target: [0, -0.5 * fapu.ENS, 0], distance: Math.max(500, Math.min(620, 5 * size)), fov: 26 };
  const divided = made.flatMap((part, i) => divide(part, scene, part.name === 'skin' ? nearestVertex(skin, fdp['9.3']) : -1, parts[i].material));
  for (const { name, pieces } of made) {
    const own = divided.filter(({ part }) => part.pieces === pieces).map(({ part }) => part.name);
    if (own.length > 1) notes.push(`${name}: its ${own.length} pictures make it ${own.join(', ')}`);
  }
  const about = { name: options.name, title: options.title, licence: options.licence, credits: options.credits };
  return { head: packModel(about, { ...model, parts: divided.map(({ part }) => part), view, ...looksOf(scene, divided.map(({ part, look }) => ({ name: part.name, material: look }))) }), notes: [...notes, ...more], used };
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
