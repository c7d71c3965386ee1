// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Feature points for an import. Our JSON: {"frame": "file" | "head", "fdp": {"2.1": [x, y, z] | vertex | {"mesh": name, "vertex": n}}}, a built
 * head's own file (frame head: mm, the origin between the eyes), or Xface's .fdp (XML) with its weights.
 */
import { isFeaturePoint } from '../../../web/src/head/calibration-check.mjs';
import { FAPS } from '../lib/faps.mjs';
import { FileError } from './file-error.mjs';

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
  if (typeof json?.fdp !== 'object' || json.fdp === null) throw new FileError('fdp', 'is missing');
  const frame = json.format === 'faccia-head' ? 'head' : (json.frame ?? 'file');
  if (!['file', 'head'].includes(frame)) throw new FileError('frame', 'must be file or head');
  for (const [name, value] of Object.entries(json.fdp)) {
    if (!isFeaturePoint(name)) throw new FileError(`fdp.${name}`, 'there is no such feature point');
    const vertex = typeof value === 'object' && !Array.isArray(value) ? value?.vertex : value;
    const place = Array.isArray(value) && value.length === 3 && value.every(Number.isFinite);
    if (!place && !(Number.isInteger(vertex) && vertex >= 0)) throw new FileError(`fdp.${name}`, 'must be three numbers, a vertex, or a mesh with a vertex');
  }
  return { frame, fdp: json.fdp, parts: json.parts ?? {}, influences: [] };
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

/** A built head's points as Xface has them, each with the vertices that its FAPs move. @param {object} head unpacked */
export function writeXface(head) {
  const skin = head.parts.find(({ name }) => name === 'skin');
  const escape = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
  const mesh = escape(`${head.name}_skin`);
  const fapu = Object.entries(head.fapu).map(([name, value]) => `${name}0="${value}"`).join(' ');
  const nearest = (p) => {
    let [best, least] = [0, Infinity];
    for (let v = 0; v < skin.position.length / 3; v++) {
      const far = Math.hypot(...p.map((x, k) => x - skin.position[3 * v + k]));
      if (far < least) [best, least] = [v, far];
    }
    return best;
  };
  const points = Object.entries(head.fdp).map(([name, p]) => {
    const faps = Object.entries(FAPS).filter(([, fap]) => fap.point === name && fap.direction).map(([number]) => Number(number));
    const moved = new Set(skin.moves.filter((move) => faps.includes(move.fap)).flatMap((move) => [...move.vertices]));
    const influences = faps.map((fap) => `    <influence fap="${fap - 1}" type="RaisedCosInfluenceSph" weight="0.5"/>`);
    return [`  <fdp affects="${mesh}" index="${nearest(p)}" name="${name}">`, `    <indices>${[...moved].sort((a, b) => a - b).join(' ')}</indices>`, ...influences, '  </fdp>'].join('\n');
  });
  return [
    '<?xml version="1.0"?>', '<xfdp>', '  <head>', '    <file version="0.2"/>', `    <fapu ${fapu}/>`,
    '    <translation x="0" y="0" z="0"/>', '    <rotation axis_x="0" axis_y="0" axis_z="1" axis_angle="0"/>', '  </head>', '  <source/>',
    ...points, '</xfdp>', '',
  ].join('\n');
}
