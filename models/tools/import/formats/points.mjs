// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Feature points for an import. Our JSON: {"frame": "file" | "head", "fdp": {"2.1": [x, y, z] | vertex | {"mesh": name, "vertex": n} |
 * {"landmark": n}}, "landmarks": {"scheme": "mediapipe" | "ibug", "vertices": [...]}, "find": true}, a built head's own file (frame head: mm, the
 * origin between the eyes), or Xface's .fdp (XML) with its weights.
 */
import { isFeaturePoint } from '../../../../web/element/head/model/check.mjs';
import { FAPS } from '../../lib/faps.mjs';
import { nearestVertex } from '../../lib/mesh.mjs';
import { COUNT } from '../../../../web/portrait/landmarks.mjs';
import { FileError } from '../limits.mjs';

/**
 * Landmarks given as vertices of the mesh, in one of two schemes: the 468 points (478 with irises) of the canonical face mesh, and the 68 points of iBUG's 300-W
 * (51 without the jaw).
 */
const list = (text) => text.split(' ').map(Number);
const JAW = 17;
/** The 68 points as face mesh landmarks: from the right ear over the chin to the left, brows, nose, eyes, lips. The jaw's points follow the outline in the picture, so they are spread along the oval. */
const IBUG = [
  ...list('127 234 93 132 58 136 150 176 152 400 379 365 288 361 323 454 356'), ...list('70 63 105 66 107'), ...list('336 296 334 293 300'),
  ...list('168 197 5 4'), ...list('75 97 2 326 305'), ...list('33 160 158 133 153 144'), ...list('362 385 387 263 373 380'),
  ...list('61 39 37 0 267 269 291 405 314 17 84 181'), ...list('78 82 13 312 308 317 14 87'),
];
export const SCHEMES = { mediapipe: Array.from({ length: COUNT }, (_, i) => i), ibug: IBUG };

/** @returns {number[]} for each entry of the list the landmark */
export function landmarksOf({ scheme, vertices }) {
  const numbers = SCHEMES[scheme];
  return scheme === 'ibug' && vertices?.length === numbers.length - JAW ? numbers.slice(JAW) : numbers;
}

const lineAt = (text, at) => text.slice(0, at).split('\n').length;

export function readPoints(text) {
  if (/^\s*</.test(text)) return readXface(text);
  let json;
  try {
    json = JSON.parse(text);
  } catch (error) {
    const at = /position (\d+)/.exec(error.message);
    throw new FileError(at ? `line ${lineAt(text, Number(at[1]))}` : '', error.message);
  }
  const isMap = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);
  if (!isMap(json) || !isMap(json.landmarks ? (json.fdp ?? {}) : json.fdp)) throw new FileError('fdp', 'is missing');
  if (json.landmarks !== undefined && !isMap(json.landmarks)) throw new FileError('landmarks', 'must have a scheme and vertices');
  const frame = json.format === 'faccia-head' ? 'head' : (json.frame ?? 'file');
  if (!['file', 'head'].includes(frame)) throw new FileError('frame', 'must be file or head');
  const landmarks = json.landmarks === undefined ? null : readLandmarks(json.landmarks);
  const most = landmarks ? landmarksOf(landmarks).length : COUNT;
  for (const [name, value] of Object.entries(json.fdp ?? {})) {
    if (!isFeaturePoint(name)) throw new FileError(`fdp.${name}`, 'there is no such feature point');
    const isLandmark = Number.isInteger(value?.landmark) && value.landmark >= 0 && value.landmark < most;
    if (!isLandmark && !isPlace(value)) throw new FileError(`fdp.${name}`, `must be three numbers, a vertex, a mesh with a vertex, or a landmark (0 to ${most - 1})`);
  }
  const find = json.find === true || Boolean(landmarks) || Object.values(json.fdp ?? {}).some((value) => value?.landmark !== undefined);
  if (find && frame === 'head') throw new FileError('frame', 'must be file where landmarks are told or points are to be found');
  return { frame, fdp: json.fdp ?? {}, parts: json.parts ?? {}, influences: [], landmarks, find };
}

function isPlace(value) {
  const vertex = typeof value === 'object' && !Array.isArray(value) ? value?.vertex : value;
  return (Array.isArray(value) && value.length === 3 && value.every(Number.isFinite)) || (Number.isInteger(vertex) && vertex >= 0);
}

/** A list of landmarks; without one, the mesh's vertices are counted as the landmarks are. */
function readLandmarks({ scheme, vertices } = {}) {
  const known = SCHEMES[scheme];
  if (!known) throw new FileError('landmarks.scheme', `must be one of ${Object.keys(SCHEMES).join(', ')}`);
  if (vertices === undefined && scheme === 'mediapipe') return { scheme, vertices: Array.from({ length: 468 }, (_, i) => i) };
  const lengths = scheme === 'ibug' ? [51, 68] : [468, 478];
  if (!Array.isArray(vertices) || !lengths.includes(vertices.length)) throw new FileError('landmarks.vertices', `must be a list of ${lengths.join(' or ')}`);
  vertices.forEach((value, i) => {
    if (value !== null && !isPlace(value)) throw new FileError(`landmarks.vertices[${i}]`, 'must be a vertex, three numbers, a mesh with a vertex, or null');
  });
  return { scheme, vertices };
}

/** Tags of an XML file with their attributes and lines; what they close is checked. */
function* tagsOf(text) {
  const open = [];
  for (const match of text.matchAll(/<!--[\s\S]*?-->|<[?!][^>]*>|<(\/?)([\w:.-]+)((?:\s+[\w:.-]+\s*=\s*"[^"]*")*)\s*(\/?)>|<|([^<]+)/g)) {
    const [whole, closing, name, list, empty, inside] = match;
    const line = lineAt(text, match.index);
    if (inside !== undefined) {
      if (inside.trim()) yield { text: inside, line, within: open.at(-1) };
    } else if (name) {
      if (closing) {
        if (open.pop() !== name) throw new FileError(`line ${line}`, `</${name}> closes nothing`);
        yield { end: name, line };
        continue;
      }
      const attributes = Object.fromEntries([...list.matchAll(/([\w:.-]+)\s*=\s*"([^"]*)"/g)].map(([, key, value]) => [key, value]));
      yield { name, attributes, line };
      if (empty) yield { end: name, line };
      else open.push(name);
    } else if (whole === '<') throw new FileError(`line ${line}`, 'a tag is not well formed');
  }
  if (open.length) throw new FileError(`line ${lineAt(text, text.length)}`, `<${open.at(-1)}> is not closed`);
}

const ITEMS = { Hair: 'hair', LeftEye: 'eye_l', RightEye: 'eye_r', LowerTeeth: 'teeth_lower', UpperTeeth: 'teeth_upper', Tongue: 'tongue' };

function readXface(text) {
  const out = { frame: 'file', fdp: {}, parts: {}, influences: [] };
  let point = null;
  let seen = false;
  for (const tag of tagsOf(text)) {
    const { name, attributes, line } = tag;
    const whole = (value, what) => {
      if (!/^\d+$/.test(value ?? '')) throw new FileError(`line ${line}`, `${what} must be a whole number`);
      return Number(value);
    };
    if (name === 'xfdp') seen = true;
    if (name === 'bind' && ITEMS[attributes.item]) out.parts[attributes.submesh] = ITEMS[attributes.item];
    if (name === 'fdp') {
      if (!isFeaturePoint(attributes.name ?? '')) throw new FileError(`line ${line}`, `there is no feature point "${attributes.name}"`);
      point = { name: attributes.name, mesh: attributes.affects, vertex: whole(attributes.index, 'index'), vertices: [], line };
      out.fdp[point.name] = { mesh: point.mesh, vertex: point.vertex };
    }
    if (tag.text && tag.within === 'indices' && point)
      point.vertices = tag.text.trim().split(/\s+/).map((word) => whole(word, 'each of indices'));
    if (name === 'influence' && point) {
      const weight = Number(attributes.weight);
      if (!Number.isFinite(weight)) throw new FileError(`line ${line}`, 'weight must be a number');
      const fap = whole(attributes.fap, 'fap') + 1; // Xface counts from 0
      if (FAPS[fap]?.direction) out.influences.push({ ...point, fap, weight, axis: 'XYZ'.indexOf(/Wave([XYZ])$/.exec(attributes.type)?.[1] ?? '-') });
    }
    if (tag.end === 'fdp') point = null;
  }
  if (!seen) throw new FileError('line 1', 'this is no .fdp of Xface: there is no <xfdp>');
  return out;
}

/** Converts a built head's points to Xface's form, each with the vertices that its FAPs move. @param {object} head unpacked */
export function writeXface(head) {
  const skin = head.parts.find(({ name }) => name === 'skin');
  const escape = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
  const mesh = escape(`${head.name}_skin`);
  const fapu = Object.entries(head.fapu).map(([name, value]) => `${name}0="${value}"`).join(' ');
  const points = Object.entries(head.fdp).map(([name, p]) => {
    const faps = Object.entries(FAPS).filter(([, fap]) => fap.point === name && fap.direction).map(([number]) => Number(number));
    const moved = new Set(skin.moves.filter((move) => faps.includes(move.fap)).flatMap((move) => [...move.vertices]));
    const influences = faps.map((fap) => `    <influence fap="${fap - 1}" type="RaisedCosInfluenceSph" weight="0.5"/>`);
    return [`  <fdp affects="${mesh}" index="${nearestVertex(skin, p)}" name="${name}">`, `    <indices>${[...moved].sort((a, b) => a - b).join(' ')}</indices>`, ...influences, '  </fdp>'].join('\n');
  });
  return [
    '<?xml version="1.0"?>', '<xfdp>', '  <head>', '    <file version="0.2"/>', `    <fapu ${fapu}/>`,
    '    <translation x="0" y="0" z="0"/>', '    <rotation axis_x="0" axis_y="0" axis_z="1" axis_angle="0"/>', '  </head>', '  <source/>',
    ...points, '</xfdp>', '',
  ].join('\n');
}
