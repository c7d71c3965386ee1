// SPDX-License-Identifier: GPL-3.0-or-later
/** Nodes of a scene as text, by its first line and its file's name: VRML, BIFS text (.bt), or XMT-A (.xmt). */
import { FileError, MOST } from '../limits.mjs';
import { textOf } from './text.mjs';
import { VrmlText } from './vrml-text.mjs';

const OLD = /^#VRML V[12]\.0 ascii/; // LUCIA's files of VRML 1.0 say 2.0
const NEW = /^#VRML V2\.0 utf8/;
const XML = /^\s*</;

// XMT-A, the XML form: the same nodes as from VRML's text. Elements with a capital are nodes, others fields.
const TAG = /<!--[\s\S]*?-->|<\?[\s\S]*?\?>|<!\[CDATA\[[\s\S]*?\]\]>|<![^>]*>|<(\/?)([\w:.-]+)((?:\s+[\w:.-]+\s*=\s*(?:"[^"<]*"|'[^'<]*'))*)\s*(\/?)>|</g;
const ATTRIBUTE = /([\w:.-]+)\s*=\s*(?:"([^"]*)"|'([^']*)')/g;
const ENTITIES = { '&quot;': '"', '&apos;': "'", '&lt;': '<', '&gt;': '>', '&amp;': '&' };
const SCENE = ['XMT-A', 'Header', 'Body', 'Replace', 'Scene', 'par', 'Command']; // hold nodes, but are none

const unescaped = (text) => text.replace(/&(?:quot|apos|lt|gt|amp);/g, (one) => ENTITIES[one]);

/** A value of an attribute: numbers, a truth value, or strings. */
function valueOf(text, budget, at) {
  const plain = unescaped(text).trim();
  if (/^(true|false)$/i.test(plain)) return /^t/i.test(plain);
  if (/^[-+.\d]/.test(plain)) {
    const list = plain.split(/[\s,]+/).filter(Boolean);
    budget.keep(list.length, at);
    const numbers = list.map(Number);
    if (numbers.every(Number.isFinite)) return numbers;
  }
  const quoted = [...plain.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map(([, one]) => one);
  return quoted.length ? quoted : [plain.replace(/^'(.*)'$/, '$1')];
}

/** @param {string} text @param {import('../limits.mjs').Budget} budget */
function readXmt(text, budget) {
  const [roots, defined] = [[], new Map()];
  const open = []; // {name, node?, field?}
  let [line, counted] = [1, 0];
  const place = () => `line ${line}`;
  const fail = (what) => {
    throw new FileError(place(), what);
  };
  const put = (node) => {
    const around = open.findLast((one) => one.node || one.field);
    if (!around) return roots.push(node);
    if (around.node) return undefined; // it belongs to a prototype, or to a command that changes the scene later
    const own = open[open.indexOf(around) - 1]?.node;
    const before = own?.fields[around.field];
    if (own) own.fields[around.field] = before === undefined ? node : [...(Array.isArray(before) ? before : [before]), node];
    return undefined;
  };
  for (const match of text.matchAll(TAG)) {
    for (; counted < match.index; counted++) if (text.charCodeAt(counted) === 10) line++;
    const [whole, closing, name, attributes, empty] = match;
    if (whole === '<') fail('a tag is not well formed');
    if (!name) continue;
    budget.keep(1, place);
    if (closing) {
      if (open.pop()?.name !== name) fail(`</${name.slice(0, 40)}> closes nothing`);
      continue;
    }
    if (open.length > 2 * MOST.depth) fail('nodes within nodes within nodes: too deep');
    const entry = { name };
    const given = Object.fromEntries([...attributes.matchAll(ATTRIBUTE)].map(([, key, a, b]) => [key, a ?? b]));
    if (open.at(-1)?.field === 'faceSceneGraphNode' && given.USE !== undefined) {
      open.at(-2).node.fields.faceSceneGraphNode = { use: given.USE, line };
    } else if (given.USE !== undefined) {
      const used = defined.get(given.USE);
      if (!used) fail(`USE ${given.USE.slice(0, 40)}: there is no such node`);
      put(used);
    } else if (/^[A-Z]/.test(name) && (!SCENE.includes(name) || given.atNode !== undefined)) {
      const { DEF, ...fields } = given;
      const node = { type: name, name: DEF ?? null, fields: {}, nodes: [], line };
      for (const [key, value] of Object.entries(fields)) node.fields[key] = valueOf(value, budget, place);
      put(node);
      if (DEF) defined.set(DEF, node);
      entry.node = node;
    } else if (open.at(-1)?.node) entry.field = name;
    if (!empty) open.push(entry);
  }
  if (open.length) throw new FileError(place(), `<${open.at(-1).name}> is not closed`);
  return { roots, defined };
}

/** Whether it may be such a scene; BIFS text has no mark, but nodes in braces. @param {string} text */
export const isSceneText = (text) => OLD.test(text) || NEW.test(text) || /^\s*<(\?xml[^>]*>\s*)?(<!--[\s\S]*?-->\s*)*<?XMT-A\b/.test(text) || /^(?:\s|#[^\n]*\n)*[A-Z]\w*(?:\s+\w+)?\s*\{/.test(text);

/**
 * @param {string} extension of the file, such as ".bt" @param {Buffer} bytes @param {import('../limits.mjs').Budget} budget
 * @returns {{roots: import('./vrml-text.mjs').Node[], defined: Map<string, object>, old: boolean}}
 */
export function sceneText(extension, bytes, budget) {
  const text = textOf(bytes);
  if (XML.test(text)) return { ...readXmt(text, budget), old: false };
  const old = OLD.test(text);
  const bifs = extension.toLowerCase() === '.bt';
  if (!old && !bifs && !NEW.test(text)) throw new FileError('line 1', 'this is no VRML: it must begin with "#VRML V2.0 utf8" or "#VRML V1.0 ascii"');
  const reader = new VrmlText(text, budget, { old, bifs });
  return { roots: reader.roots(), defined: reader.defined, old };
}
