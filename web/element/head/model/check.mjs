// SPDX-License-Identifier: MIT
// Checks a head model against protocol/schema/head-model.json, as far as the page depends on it, and a calibration.
import { pictureTrouble } from './picture-size.mjs';

export class ModelError extends Error {
  /** @param {string} place in the model, such as "parts[0].position.scale" @param {string} what is wrong there */
  constructor(place, what) {
    super(place ? `${place}: ${what}` : what);
    this.place = place;
  }
}

/** The number of feature points in each group of ISO/IEC 14496-2. */
const GROUPS = { 2: 14, 3: 14, 4: 6, 5: 4, 6: 4, 7: 1, 8: 10, 9: 15, 10: 10, 11: 6 };
const FARTHEST = 1000; // mm
const MOST_PIXELS = 1 << 22; // of a texture, as server/rooms/notices.h has it

/** @param {string} name such as "8.4" */
export function isFeaturePoint(name) {
  const match = /^([1-9]\d?)\.([1-9]\d?)$/.exec(name);
  return Boolean(match) && Number(match[2]) <= (GROUPS[match[1]] ?? 0);
}

const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);

function checkPoints(points, at, width, what, fits) {
  if (!isObject(points)) throw new ModelError(at, 'must be an object of feature points');
  for (const [name, value] of Object.entries(points)) {
    if (!isFeaturePoint(name)) throw new ModelError(`${at}.${name}`, 'unknown feature point: 2.1 to 11.6, as numbered by ISO/IEC 14496-2');
    if (!Array.isArray(value) || value.length !== width || !value.every(fits)) throw new ModelError(`${at}.${name}`, `must be ${what}`);
  }
  return Object.keys(points).length;
}

/** @throws {ModelError} with the place of what is wrong */
export function checkCalibration(calibration, prefix = '') {
  if (!isObject(calibration)) throw new ModelError(prefix.replace(/\.$/, ''), 'must be an object');
  const { featurePointsCoord, textureCoord, texture } = calibration;
  const inHead = (value) => Number.isFinite(value) && Math.abs(value) <= FARTHEST;
  const count = checkPoints(featurePointsCoord, `${prefix}featurePointsCoord`, 3, `three numbers of at most ${FARTHEST} mm`, inHead);
  if (!count) throw new ModelError(`${prefix}featurePointsCoord`, 'there are none');
  const inPicture = (value) => Number.isFinite(value) && value >= 0 && value <= 1;
  if (textureCoord !== undefined) {
    checkPoints(textureCoord, `${prefix}textureCoord`, 2, 'two numbers from 0 to 1', inPicture);
    if (texture === undefined) throw new ModelError(`${prefix}texture`, 'is missing: textureCoord gives positions on it');
  }
  if (texture === undefined) return;
  if (!isObject(texture)) throw new ModelError(`${prefix}texture`, 'must be an object');
  if (typeof texture.type !== 'string' || !/^image\/(png|jpeg|webp)$/.test(texture.type))
    throw new ModelError(`${prefix}texture.type`, 'must be image/png, image/jpeg or image/webp');
  const { data } = texture;
  if (typeof data !== 'string' || !data || data.length % 4 || !/^[A-Za-z0-9+/]*={0,2}$/.test(data))
    throw new ModelError(`${prefix}texture.data`, 'must be base64');
  const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  const trouble = pictureTrouble(bytes, MOST_PIXELS, [texture.type.slice('image/'.length)]);
  if (trouble) throw new ModelError(`${prefix}texture.data`, trouble);
}

const FAPU = ['IRISD', 'ES', 'ENS', 'MNS', 'MW'];
const isNumber = (value) => Number.isFinite(value);
const within = (least, most) => (value) => Number.isInteger(value) && value >= least && value <= most;

/** Kinds of values: what they are called, and whether a value is one. */
const KINDS = {
  text: ['a text', (value) => typeof value === 'string'],
  object: ['an object', isObject],
  list: ['a list', Array.isArray],
  number: ['a number', isNumber],
  positive: ['a number above 0', (value) => isNumber(value) && value > 0],
  angle: ['an angle of 0 to 180 degrees', (value) => isNumber(value) && value > 0 && value < 180],
  share: ['a number from 0 to 1', (value) => isNumber(value) && value >= 0 && value <= 1],
  fap: ['the number of a FAP, 3 to 68', within(3, 68)],
  vertices: ['a number of vertices', within(3, 65535)],
  vector: ['three numbers', (value) => Array.isArray(value) && value.length === 3 && value.every(isNumber)],
  base64: ['base64', (value) => typeof value === 'string' && value.length % 4 === 0 && /^[A-Za-z0-9+/]*={0,2}$/.test(value)],
  sign: ['both, positive or negative', (value) => ['both', 'positive', 'negative'].includes(value)],
  alpha: ['opaque, cutout or blend', (value) => ['opaque', 'cutout', 'blend'].includes(value)],
  image: ['the type of an image', (value) => typeof value === 'string' && value.startsWith('image/')],
};

/**
 * Members of an object by their kinds; a name that ends in "?" may be missing.
 * @param {string} place of the object
 */
function members(object, place, kinds) {
  if (!isObject(object)) throw new ModelError(place, 'must be an object');
  for (const [key, kind] of Object.entries(kinds)) {
    const name = key.replace('?', '');
    const at = place ? `${place}.${name}` : name;
    const value = object[name];
    if (value === undefined && name !== key) continue;
    if (value === undefined) throw new ModelError(at, 'is missing');
    const [what, fits] = KINDS[kind];
    if (!fits(value)) throw new ModelError(at, `must be ${what}`);
  }
}

const each = (list, place, check) => list?.forEach((one, i) => check(one, `${place}[${i}]`));
const every = (object, place, check) => Object.entries(object ?? {}).forEach(([name, one]) => check(one, `${place}.${name}`, name));

function checkPart(part, place) {
  members(part, place, {
    name: 'text', material: 'text', vertices: 'vertices', position: 'object', 'uv?': 'object', index: 'object', 'smooth?': 'object',
    'moves?': 'list', 'turns?': 'list', 'breath?': 'object', 'sway?': 'object',
  });
  if (part.breath) members(part.breath, `${place}.breath`, { vertices: 'base64', weights: 'base64' });
  if (part.sway) members(part.sway, `${place}.sway`, { pivot: 'vector', weights: 'base64' });
  members(part.position, `${place}.position`, { data: 'base64', scale: 'positive', offset: 'vector' });
  for (const name of ['uv', 'index', 'smooth']) if (part[name]) members(part[name], `${place}.${name}`, { data: 'base64' });
  each(part.moves, `${place}.moves`, (move, at) => {
    members(move, at, { fap: 'fap', 'sign?': 'sign', 'from?': 'positive', vertices: 'base64', deltas: 'object' });
    if (move.from && (move.sign ?? 'both') === 'both') throw new ModelError(`${at}.from`, 'needs the sign positive or negative');
    members(move.deltas, `${at}.deltas`, { data: 'base64', scale: 'positive' });
  });
  each(part.turns, `${place}.turns`, (turn, at) => {
    members(turn, at, { turn: 'text', 'vertices?': 'base64', 'weights?': 'base64', 'weight?': 'share' });
    if ((turn.vertices === undefined) !== (turn.weights === undefined)) throw new ModelError(at, 'vertices and their weights belong together');
    if (turn.weights !== undefined && turn.weight !== undefined) throw new ModelError(at, 'there must be weights or a weight');
  });
}

/** @throws {ModelError} with the place of what is wrong */
export function checkModel(json) {
  members(json, '', {
    format: 'text', version: 'number', name: 'text', 'title?': 'text', 'credits?': 'list', fapu: 'object', 'fdp?': 'object',
    'view?': 'object', 'breath?': 'object', 'calibration?': 'object', 'turns?': 'list', 'textures?': 'object', 'materials?': 'object', parts: 'list',
  });
  if (json.format !== 'faccia-head') throw new ModelError('format', 'this is not a head model');
  if (json.version !== 1) throw new ModelError('version', 'only version 1 is known');
  if (!json.parts.length) throw new ModelError('parts', 'there are none');
  members(json.fapu, 'fapu', Object.fromEntries(FAPU.map((name) => [name, 'positive'])));
  every(json.fdp, 'fdp', (_, at, name) => {
    if (!/^\d+\.\d+$/.test(name)) throw new ModelError(at, 'must be named by a feature point');
    members(json.fdp, 'fdp', { [name]: 'vector' });
  });
  if (json.view) members(json.view, 'view', { 'target?': 'vector', 'distance?': 'positive', 'fov?': 'angle', 'bottom?': 'number' });
  if (json.breath) members(json.breath, 'breath', { shift: 'vector' });
  each(json.turns, 'turns', (turn, at) =>
    members(turn, at, { name: 'text', fap: 'fap', pivot: 'vector', axis: 'vector', radians: 'number' }),
  );
  if (json.calibration) checkCalibration(json.calibration, 'calibration.');
  every(json.textures, 'textures', (texture, at) => members(texture, at, { type: 'image', data: 'base64' }));
  every(json.materials, 'materials', (material, at) =>
    members(material, at, {
      'texture?': 'text', 'color?': 'vector', 'roughness?': 'share', 'specular?': 'share', 'alpha?': 'alpha', 'subsurface?': 'share',
    }),
  );
  each(json.parts, 'parts', checkPart);
}
