// SPDX-License-Identifier: GPL-3.0-or-later
/** Reads Stanford PLY, text and binary: one mesh, whose optional texture is named by a comment "TextureFile". */
import { pictureBeside } from './beside.mjs';
import { cutFace, cutStrip } from '../mesh/triangles.mjs';
import { FileError, MOST } from '../limits.mjs';

const READ = {
  char: ['Int8', 1], int8: ['Int8', 1], uchar: ['Uint8', 1], uint8: ['Uint8', 1], short: ['Int16', 2], int16: ['Int16', 2], ushort: ['Uint16', 2],
  uint16: ['Uint16', 2], int: ['Int32', 4], int32: ['Int32', 4], uint: ['Uint32', 4], uint32: ['Uint32', 4], float: ['Float32', 4], float32: ['Float32', 4],
  double: ['Float64', 8], float64: ['Float64', 8],
};

const MOST_ELEMENTS = 64;
const COLORS = [['red', 'diffuse_red'], ['green', 'diffuse_green'], ['blue', 'diffuse_blue']];
const IDLE = /^(n[xyz]|quality|alpha|confidence|intensity|radius|curvature)$/; // an unused value may be invalid

function readHead(bytes) {
  const end = bytes.indexOf('end_header');
  if (bytes.toString('latin1', 0, 3) !== 'ply' || end < 0 || end > 65536) throw new FileError('line 1', 'this is no PLY: it must begin with "ply" and have an end_header');
  const lines = bytes.toString('latin1', 0, end).split(/\r\n|\r|\n/);
  const after = end + 'end_header'.length;
  const head = { elements: [], texture: null, lines: lines.length, data: after + (/^ *(\r\n|\r|\n)/.exec(bytes.toString('latin1', after, after + 80))?.[0].length ?? 0) };
  lines.forEach((line, i) => {
    const words = line.trim().split(/\s+/);
    const at = `line ${i + 1}`;
    if (words[0] === 'format') head.format = words[1];
    if (words[0] === 'comment' && words[1] === 'TextureFile') head.texture = { name: words.slice(2).join(' '), at };
    if (words[0] === 'element') {
      const count = Number(words[2]);
      if (head.elements.length === MOST_ELEMENTS) throw new FileError(at, `a head has no more than ${MOST_ELEMENTS} kinds of elements`);
      if (!Number.isInteger(count) || count < 0 || count > MOST.numbers / 3) throw new FileError(at, `a head has no ${words[2]} elements`);
      head.elements.push({ name: words[1], count, properties: [] });
    }
    if (words[0] === 'property') {
      const list = words[1] === 'list';
      const types = list ? words.slice(2, 4) : [words[1]];
      if (!head.elements.length || !types.every((type) => READ[type])) throw new FileError(at, `"${line.slice(0, 60)}" is not known`);
      head.elements.at(-1).properties.push({ name: words.at(-1), list, types });
    }
  });
  if (!['ascii', 'binary_little_endian', 'binary_big_endian'].includes(head.format)) throw new FileError('line 2', 'the format must be ascii, binary_little_endian or binary_big_endian');
  return head;
}

/** Checks that the file has the bytes that its header announces: one for each number, or two in text form. Elements without properties have none. */
function checkSizes(bytes, head) {
  const least = (property) => (head.format === 'ascii' ? 2 : READ[property.types[0]][1]);
  const wanted = head.elements.reduce((sum, { count, properties }) => sum + count * properties.reduce((all, one) => all + least(one), 0), 0);
  const there = bytes.length - head.data + 1; // the last number may have no blank behind it
  if (wanted > there) throw new FileError(`byte ${bytes.length}`, `the elements need ${wanted} bytes, and ${there} are there`);
}

/** Reads numbers one after the other, and reports the position. */
function source(bytes, head) {
  let at = head.data;
  if (head.format === 'ascii') {
    const text = bytes.toString('latin1', at);
    const words = /\S+|\r\n|\r|\n/g;
    let line = head.lines + 1;
    const next = () => {
      for (let word; (word = words.exec(text)); ) {
        if (!/[\r\n]/.test(word[0])) return Number(word[0]);
        line++;
      }
      return NaN;
    };
    return { next, place: () => `line ${line}` };
  }
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const little = head.format === 'binary_little_endian';
  const next = (type) => {
    const [kind, size] = READ[type];
    if (at + size > bytes.length) return NaN;
    at += size;
    return view[`get${kind}`](at - size, little);
  };
  return { next, place: () => `byte ${at}` };
}

export function readPly(file, bytes, budget) {
  const head = readHead(bytes);
  checkSizes(bytes, head);
  const { next, place } = source(bytes, head);
  const [position, uv, colors, index, notes] = [[], [], [], [], []];
  const wedges = new Map(); // a corner with its own texture coordinates becomes a separate vertex
  const from = [];
  const wedge = (v, s, t) => {
    const key = `${v}/${s}/${t}`;
    if (!wedges.has(key)) {
      wedges.set(key, from.push(v) - 1);
      uv.push(s, t);
    }
    return wedges.get(key);
  };
  const add = (...three) => {
    budget.keep(3, place);
    index.push(...three);
  };
  const work = (steps) => budget.work(steps, place);
  const cut = (corners, at) => cutFace(corners, at, add, work);
  const number = (type, name) => {
    const value = next(type);
    if (!Number.isFinite(value) && !IDLE.test(name)) throw new FileError(place(), 'a number is missing, or is none');
    return value;
  };
  for (const { name, count, properties } of head.elements) {
    if (!properties.length && name !== 'vertex') continue;
    for (let i = 0; i < count; i++) {
      work(1 + properties.length);
      const values = {};
      for (const property of properties) {
        if (!property.list) values[property.name] = number(property.types[0], property.name);
        else {
          const length = number(property.types[0]);
          if (length > (name === 'tristrips' ? MOST.numbers : 256) || length < 0) throw new FileError(place(), `a list of ${length} numbers is no face`);
          work(length);
          values[property.name] = Array.from({ length }, () => number(property.types[1]));
        }
      }
      if (name === 'vertex') {
        if (![values.x, values.y, values.z].every(Number.isFinite)) throw new FileError(place(), 'a vertex must have x, y and z');
        budget.keep(8, place); // counts colours and texture coordinates, too
        position.push(values.x, values.y, values.z);
        const [s, t] = [values.s ?? values.u ?? values.texture_u, values.t ?? values.v ?? values.texture_v];
        if (s !== undefined) uv.push(s, t);
        const color = COLORS.map(([one, other]) => values[one] ?? values[other]);
        if (color.every(Number.isFinite)) colors.push(...color);
      }
      const corners = ['face', 'tristrips'].includes(name) && (values.vertex_indices ?? values.vertex_index);
      if (!corners) continue;
      const past = corners.find((v) => !Number.isInteger(v) || (v < 0 && name === 'face') || v >= position.length / 3);
      if (past !== undefined) throw new FileError(place(), `there is no vertex ${past}`);
      if (name === 'tristrips') cutStrip(corners, add);
      else if (values.texcoord && values.texcoord.length === 2 * corners.length && (from.length || !index.length)) {
        const own = corners.map((v, k) => wedge(v, values.texcoord[2 * k], values.texcoord[2 * k + 1]));
        cut(own, (v) => position.slice(3 * from[v], 3 * from[v] + 3));
      } else if (from.length) cut(corners.map((v) => wedge(v, 0, 0)), (v) => position.slice(3 * from[v], 3 * from[v] + 3));
      else cut(corners, (v) => position.slice(3 * v, 3 * v + 3));
    }
  }
  if (!index.length) throw new FileError('', 'there are no faces in it');
  const picture = head.texture ? pictureBeside(file, head.texture.name, head.texture.at, notes, budget) : null;
  const asFaces = (list) => (from.length ? Float64Array.from({ length: 3 * from.length }, (_, i) => list[3 * from[Math.floor(i / 3)] + (i % 3)]) : Float64Array.from(list));
  const full = head.elements.some(({ properties }) => properties.some(({ name, types }) => COLORS.flat().includes(name) && /char|int8/.test(types[0]))) ? 255 : 1;
  return {
    meshes: [{
      name: 'mesh', material: 0, position: asFaces(position), uv: uv.length ? Float64Array.from(uv) : null, index: Uint32Array.from(index), targets: {},
      colors: colors.length === position.length ? asFaces(colors).map((x) => x / full) : null, ...(from.length ? { from } : {}),
    }],
    materials: [{ name: 'mesh', color: picture ? [1, 1, 1] : [0.8, 0.62, 0.54], roughness: 0.6, alpha: 'opaque', double_sided: false, picture }],
    notes,
    unit: null,
  };
}
