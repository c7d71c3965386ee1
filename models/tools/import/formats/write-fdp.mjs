// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Writes a head as a Face node of MPEG-4: an FDP with its feature points, its meshes, and an animation table that says what each FAP does to them; as VRML or
 * BIFS text, or as XMT-A. See protocol/mpeg4.md.
 */
import { pose, unitLength } from '../../lib/deform.mjs';
import { FAPS } from '../../lib/faps.mjs';
import { POINTS } from './fdp-node.mjs';

const NOWHERE = 3.4028235e38; // for feature points that the head does not have
const LEAST = 0.01; // mm at the end of an interval: vertices that no FAP moves farther are left out
/** Ends of the intervals in which a rotation is replaced by straight lines; others bend at 0 at most. */
const BENDS = { 3: [0, 150, 300, 500, 800, 1100, 1600], lid: [-600, -300, 0, 200, 400, 600, 800, 1000, 1100] };
const HINT = 0.001; // of transparency, where the texture's own is to be blended
const END = 1000;
const AU_END = 50000;

const node = (type, fields, def) => ({ type, def, fields: Object.entries(fields).filter(([, value]) => value !== undefined) });
const use = (def) => ({ use: def });
const short = (x) => String(Number(x.toFixed(5)) + 0);

/** Nodes as text in braces. */
function braces(value, level = 0) {
  const pad = ' '.repeat(level);
  if (Array.isArray(value)) return typeof value[0] === 'number' || ArrayBuffer.isView(value) ? `[${value.join(' ')}]` : `[\n${value.map((one) => ` ${pad}${braces(one, level + 1)}`).join('\n')}\n${pad}]`;
  if (value.list) return `[${value.list}]`;
  if (value.use) return `USE ${value.use}`;
  if (typeof value === 'boolean') return value ? 'TRUE' : 'FALSE';
  if (typeof value !== 'object') return typeof value === 'string' ? JSON.stringify(value) : String(value);
  if (value.single) return value.single.map(short).join(' ');
  const fields = value.fields.map(([name, one]) => `${pad} ${name} ${braces(one, level + 1)}`);
  return `${value.def ? `DEF ${value.def} ` : ''}${value.type} {\n${fields.join('\n')}\n${pad}}`;
}

/** Nodes as elements; `of`: the type where a node is only named. */
function elements({ type, def, fields }, level = 0) {
  const pad = ' '.repeat(level);
  const isNode = (value) => Boolean(value.type || value.use || (Array.isArray(value) && value[0]?.type));
  const escape = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
  const plain = (value) => (value.list ? value.list : value.single ? value.single.map(short).join(' ') : typeof value === 'boolean' ? String(value) : typeof value === 'string' ? `&quot;${escape(value)}&quot;` : String(value));
  const attributes = fields.filter(([, value]) => !isNode(value)).map(([name, value]) => ` ${name}="${plain(value)}"`);
  const inner = fields.filter(([, value]) => isNode(value)).map(([name, value]) => {
    const list = Array.isArray(value) ? value : [value];
    const nodes = list.map((one) => (one.use ? `${pad}  <${one.of} USE="${one.use}"/>` : elements(one, level + 2)));
    return `${pad} <${name}>\n${nodes.join('\n')}\n${pad} </${name}>`;
  });
  const head = `${pad}<${type}${def ? ` DEF="${def}"` : ''}${attributes.join('')}`;
  return inner.length ? `${head}>\n${inner.join('\n')}\n${pad}</${type}>` : `${head}/>`;
}

const list = (numbers) => ({ list: Array.from(numbers, short).join(' ') });

/** The rigid turns of a part that are no head turns, outermost first. */
const rigidTurns = (head, part) => part.turns.filter(({ vertices, weight, turn }) => !vertices && weight === 1 && !FAPS[turnOf(head, turn).fap].headTurn);
const turnOf = (head, name) => head.turns.find((turn) => turn.name === name);

/** Ends of intervals for a FAP on a part. */
function bordersOf(head, part, fap) {
  const turned = part.turns.some(({ turn }) => turnOf(head, turn).fap === fap);
  if (turned) return fap === 3 ? BENDS[3] : BENDS.lid;
  const end = FAPS[fap].unit === 'AU' ? AU_END : END;
  return part.moves.every((move) => move.fap !== fap || move.sign === 'both') ? [0, end] : [-end, 0, end];
}

/** What a FAP does to a part, as a FaceDefMesh; null: nothing. */
function tableOf(head, part, fap) {
  const borders = bordersOf(head, part, fap);
  const at = borders.map((value) => (value ? pose(head, part, { [fap]: value }) : part.position));
  const unit = unitLength(head, fap);
  const vertices = [];
  const displacements = [];
  for (let v = 0; v < part.position.length / 3; v++) {
    const far = Math.max(...at.map((p) => Math.hypot(...[0, 1, 2].map((k) => p[3 * v + k] - part.position[3 * v + k]))));
    if (far < LEAST) continue;
    vertices.push(v);
    for (let j = 0; j + 1 < borders.length; j++) {
      const away = borders[j] < 0 ? -1 : 1; // below 0: whither it goes as the FAP falls
      for (let k = 0; k < 3; k++) displacements.push((away * (at[j + 1][3 * v + k] - at[j][3 * v + k])) / ((borders[j + 1] - borders[j]) * unit));
    }
  }
  if (!vertices.length) return null;
  return node('FaceDefMesh', { faceSceneGraphNode: { ...use(`${part.name}_set`), of: 'IndexedFaceSet' }, intervalBorders: list(borders), coordIndex: list(vertices), displacements: list(displacements) });
}

function shapeOf(head, part, pictures) {
  const { material } = part;
  const look = head.materials[material] ?? {};
  const picture = pictures[look.texture];
  const corners = [];
  for (let t = 0; t < part.index.length; t += 3) corners.push(part.index[t], part.index[t + 1], part.index[t + 2], -1);
  return node('Shape', {
    appearance: node('Appearance', {
      material: node('Material', { diffuseColor: { single: look.color ?? [0.8, 0.8, 0.8] }, transparency: look.alpha === 'blend' ? HINT : undefined }),
      texture: picture ? node('ImageTexture', { url: picture }) : undefined,
    }),
    geometry: node('IndexedFaceSet', {
      solid: !look.double_sided,
      coord: node('Coordinate', { point: list(part.position) }),
      texCoord: node('TextureCoordinate', { point: list(part.uv) }),
      coordIndex: list(corners),
    }, `${part.name}_set`),
  });
}

/**
 * @param {object} head unpacked @param {Record<string, string>} pictures texture -> the file in which it lies @param {'wrl'|'bt'|'xmt'} form
 * @returns {string}
 */
export function writeFdp(head, pictures, form) {
  const transforms = []; // {fap, def, turn}
  const around = (turn, def, children) => {
    transforms.push({ fap: turn.fap, def, turn });
    return node('Transform', { center: { single: turn.pivot }, children }, def);
  };
  const meshes = head.parts.map((part) => {
    const turns = rigidTurns(head, part).map(({ turn }) => turnOf(head, turn));
    const shape = node('Transform', { children: [shapeOf(head, part, pictures)] }, part.name);
    return turns.reduce((inner, turn) => around(turn, `${part.name}_${turn.fap}`, [inner]), shape);
  });
  const headTurns = head.turns.filter(({ fap }) => FAPS[fap].headTurn).sort((a, b) => a.fap - b.fap);
  const graph = headTurns.reduce((inner, turn) => [around(turn, turn.name, inner)], meshes);
  const rigid = (part, fap) => rigidTurns(head, part).some(({ turn }) => turnOf(head, turn).fap === fap);
  const tables = Object.keys(FAPS).map(Number).flatMap((fap) => {
    const soft = FAPS[fap].headTurn ? [] : head.parts.filter((part) => !rigid(part, fap)).flatMap((part) => tableOf(head, part, fap) ?? []);
    const turned = transforms.filter((one) => one.fap === fap).map(({ def, turn }) =>
      node('FaceDefTransform', { faceSceneGraphNode: { ...use(def), of: 'Transform' }, fieldId: 1, rotationDef: { single: [...turn.axis, turn.radians / 1e-5] } }));
    if (!soft.length && !turned.length) return [];
    return [node('FaceDefTables', { fapID: fap, faceDefMesh: soft.length ? soft : undefined, faceDefTransform: turned.length ? turned : undefined })];
  });
  const face = node('Face', {
    fdp: node('FDP', {
      faceSceneGraph: graph, // first, since the tables name its nodes
      featurePointsCoord: node('Coordinate', { point: { list: POINTS.flatMap((name) => head.fdp[name]?.map(short) ?? [NOWHERE, NOWHERE, NOWHERE]).join(' ') } }),
      faceDefTables: tables,
    }),
  });
  const top = node('Group', { children: [face] });
  const about = `${head.title}, by faccia: millimetres, x to the head's left, y up, z forward. ${head.licence}. ${(head.credits ?? []).join('; ')}`.replace(/\s+/g, ' ');
  if (form === 'xmt') return `<?xml version="1.0" encoding="UTF-8"?>\n<!-- ${about.replaceAll('--', '- -')} -->\n<XMT-A><Body><Replace><Scene>\n${elements(top)}\n</Scene></Replace></Body></XMT-A>\n`;
  return `${form === 'bt' ? '' : '#VRML V2.0 utf8\n'}# ${about}\n${braces(top)}\n`;
}
