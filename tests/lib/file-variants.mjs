// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the same surfaces in the various ways of other programs. A part: {name, position, uv, index}.
import fs from 'node:fs';

const triples = (list) => Array.from({ length: list.length / 3 }, (_, i) => [...list.slice(3 * i, 3 * i + 3)]);
const pairs = (list) => Array.from({ length: list.length / 2 }, (_, i) => [...list.slice(2 * i, 2 * i + 2)]);
const line = (list) => list.map((x) => Number(x.toFixed(6))).join(' ');

/** Converts triangles to one strip; degenerate triangles bridge those that share no edge. */
export function strip(index) {
  const out = [];
  triples(index).forEach(([a, b, c]) => {
    const [y, z] = out.slice(-2);
    const odd = out.length % 2;
    const turn = [[a, b, c], [b, c, a], [c, a, b]].find(([p, q]) => (odd ? p === z && q === y : p === y && q === z));
    if (turn) out.push(turn[2]);
    else out.push(...(out.length ? [z, a, ...(odd ? [a] : [])] : []), a, b, c);
  });
  return Uint32Array.from(out);
}

/**
 * @param {string} file .glb, or .gltf with embedded data
 * @param {{index?: 'none'|Function, mode?: number, layout?: 'apart'|'woven'|'short'|'sparse', node?: object, above?: object[], cut?: number, uv?: boolean,
 *   color?: Function, material?: object, cornersOf?: Function}} how above: parent nodes, innermost first; cut: number of primitives; material: further members of the file
 */
export function writeGltf(file, parts, { index = Uint32Array, mode = 4, layout = 'apart', node = {}, above = [], cut = 1, uv = true, color = null, material = null, cornersOf = null } = {}) {
  const json = { asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [], meshes: [], accessors: [], bufferViews: [], buffers: [], ...material };
  const blocks = [];
  let size = 0;
  const store = (array, view = {}) => {
    const bytes = Buffer.from(array.buffer, array.byteOffset, array.byteLength);
    const padded = Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
    json.bufferViews.push({ buffer: 0, byteOffset: size, byteLength: bytes.length, ...view });
    blocks.push(padded);
    size += padded.length;
    return json.bufferViews.length - 1;
  };
  const accessor = (one) => json.accessors.push(one) - 1;
  const placesOf = (list, type, more) => accessor({ bufferView: store(list), componentType: { Float32Array: 5126, Int16Array: 5122, Uint16Array: 5123 }[list.constructor.name], type, count: list.length / { VEC2: 2, VEC3: 3 }[type], ...more });
  const group = [];
  for (const part of parts) {
    const count = part.position.length / 3;
    const attributes = {};
    const own = { mesh: json.meshes.length, name: part.name, ...node };
    const down = Array.from(part.uv, (x, i) => (i % 2 ? 1 - x : x));
    if (layout === 'woven') {
      const woven = Float32Array.from({ length: 5 * count }, (_, i) => (i % 5 < 3 ? part.position[3 * Math.floor(i / 5) + (i % 5)] : down[2 * Math.floor(i / 5) + (i % 5) - 3]));
      const bufferView = store(woven, { byteStride: 20 });
      attributes.POSITION = accessor({ bufferView, componentType: 5126, type: 'VEC3', count });
      attributes.TEXCOORD_0 = accessor({ bufferView, byteOffset: 12, componentType: 5126, type: 'VEC2', count });
    } else if (layout === 'short') {
      const most = part.position.reduce((best, x) => Math.max(best, Math.abs(x)), 0);
      attributes.POSITION = placesOf(Int16Array.from(part.position, (x) => Math.round((32767 * x) / most)), 'VEC3', { normalized: true });
      attributes.TEXCOORD_0 = placesOf(Uint16Array.from(down, (x) => Math.round(65535 * Math.min(1, Math.max(0, x)))), 'VEC2', { normalized: true });
      own.scale = [most, most, most];
    } else if (layout === 'sparse') {
      const [indices, values] = [Uint16Array.from({ length: count }, (_, v) => v), Float32Array.from(part.position)];
      attributes.POSITION = accessor({ componentType: 5126, type: 'VEC3', count, sparse: { count, indices: { bufferView: store(indices), componentType: 5123 }, values: { bufferView: store(values) } } });
    } else {
      attributes.POSITION = placesOf(Float32Array.from(part.position), 'VEC3');
      if (uv) attributes.TEXCOORD_0 = placesOf(Float32Array.from(down), 'VEC2');
    }
    if (color) attributes.COLOR_0 = placesOf(Float32Array.from(triples(part.position).flatMap(color)), 'VEC3');
    const primitives = Array.from({ length: cut }, (_, k) => {
      const [from, to] = [k, k + 1].map((share) => 3 * Math.floor((part.index.length / 3) * (share / cut)));
      const corners = (cornersOf ?? ((list) => list))(part.index.slice(from, to));
      const one = { attributes, mode, ...(material ? { material: 0 } : {}) };
      return index === 'none' ? one : { ...one, indices: accessor({ bufferView: store(index.from(corners)), componentType: { 2: 5123, 4: 5125 }[index.BYTES_PER_ELEMENT], type: 'SCALAR', count: corners.length }) };
    });
    json.meshes.push({ name: part.name, primitives });
    group.push(json.nodes.push(own) - 1);
  }
  json.scenes[0].nodes = above.reduce((children, one) => [json.nodes.push({ ...one, children }) - 1], group);
  const binary = Buffer.concat(blocks);
  json.buffers.push({ byteLength: size });
  if (file.endsWith('.gltf')) {
    json.buffers[0].uri = `data:application/octet-stream;base64,${binary.toString('base64')}`;
    return fs.writeFileSync(file, `\uFEFF${JSON.stringify(json)}`);
  }
  const text = JSON.stringify(json);
  const padded = Buffer.from(text.padEnd(text.length + ((4 - (Buffer.byteLength(text) % 4)) % 4)));
  const words = (...list) => Buffer.from(Uint32Array.from(list).buffer);
  return fs.writeFileSync(file, Buffer.concat([words(0x46546c67, 2, 28 + padded.length + size, padded.length, 0x4e4f534a), padded, words(size, 0x004e4942), binary]));
}

/** @param {{before?: string, end?: string, back?: boolean, color?: Function, goesOn?: boolean, library?: string, uv?: boolean}} how back: negative (relative) indices */
export function writeObjAs(file, parts, { before = '', end = '\n', back = false, color = null, goesOn = false, library = '', uv = true } = {}) {
  const rows = library ? [`mtllib ${library}`] : [];
  let all = 0;
  for (const part of parts) {
    const count = part.position.length / 3;
    rows.push(`o ${part.name}`, ...(library ? [`usemtl ${part.name}`] : []));
    rows.push(...triples(part.position).map((p) => `v ${line(p)}${color ? ` ${line(color(p))}` : ''}`));
    if (uv) rows.push(...pairs(part.uv).map((p) => `vt ${line(p)}`));
    const number = (v) => (back ? v - count : all + v + 1);
    for (const face of part.faces ?? triples(part.index)) {
      const words = face.map((v) => (uv ? `${number(v)}/${number(v)}` : `${number(v)}`));
      rows.push(goesOn ? `f ${words[0]} \\${end}  ${words.slice(1).join(' ')}` : `f ${words.join(' ')}`);
    }
    all += count;
  }
  fs.writeFileSync(file, before + rows.join(end) + end);
}

/** @param {{end?: string, color?: Function, wedges?: boolean, strips?: Uint32Array, noNormals?: boolean}} how wedges: texture coordinates per corner */
export function writePlyAs(file, [part], { end = '\n', color = null, wedges = false, strips = null, noNormals = false } = {}) {
  const vertices = triples(part.position).map((p) => [line(p), ...(noNormals ? ['nan nan nan'] : []), ...(color ? [color(p).map((x) => Math.round(255 * x)).join(' ')] : [])].join(' '));
  const faces = strips
    ? [`${strips.length} ${[...strips].join(' ')}`]
    : (part.faces ?? triples(part.index)).map((face) => `${face.length} ${face.join(' ')}${wedges ? ` ${2 * face.length} ${face.map((v) => line([part.uv[2 * v], part.uv[2 * v + 1]])).join(' ')}` : ''}`);
  const head = [
    'ply', 'format ascii 1.0', ...(wedges ? ['comment TextureFile gone.png'] : []), `element vertex ${vertices.length}`, ...['x', 'y', 'z', ...(noNormals ? ['nx', 'ny', 'nz'] : [])].map((name) => `property float ${name}`),
    ...(color ? ['red', 'green', 'blue'].map((name) => `property uchar ${name}`) : []), `element ${strips ? 'tristrips' : 'face'} ${faces.length}`,
    `property list ${strips ? 'int' : 'uchar'} int vertex_indices`, ...(wedges ? ['property list uchar float texcoord'] : []), 'end_header',
  ];
  fs.writeFileSync(file, [...head, ...vertices, ...faces, ''].join(end));
}

/** @param {{end?: string, comma?: string, wrap?: (shape: string, part: object) => string, fields?: string, faceOf?: Function, color?: Function, head?: string, tail?: string}} how */
export function vrmlOf(parts, { end = '\n', comma = ' ', wrap = (shape) => shape, fields = '', faceOf = (face) => face, color = null, head = '', tail = '' } = {}) {
  const shapes = parts.map((part) => {
    const points = triples(part.position).map(line).join(comma);
    const faces = (part.faces ?? triples(part.index)).map((face) => faceOf(face).join(comma)).join(`${comma}-1${comma}`);
    const tints = color ? `color Color { color [ ${triples(part.position).map((p) => line(color(p))).join(comma)} ] }` : '';
    return wrap(`Shape { appearance DEF A_${part.name} Appearance { material Material { diffuseColor .8 0.7 6e-1 } } geometry IndexedFaceSet { ${fields} coord DEF C_${part.name} Coordinate { point [ ${points} ] } ${tints} coordIndex [ ${faces} ] } }`, part);
  });
  return ['#VRML V2.0 utf8', '# a comment { that opens', head, ...shapes, tail].join(end);
}

/** The same as VRML 1.0: nodes that change the state for the face sets that follow. @param {{wrap?: (nodes: string, part: object) => string, header?: string, fields?: string, last?: string}} how */
export function vrml1Of(parts, { wrap = (nodes, { name }) => `DEF ${name} Separator { ${nodes} }`, header = '#VRML V1.0 ascii', fields = '', faceOf = (face) => face, last = '' } = {}) {
  const sets = parts.map((part) => {
    const points = triples(part.position).map(line).join(', ');
    const faces = (part.faces ?? triples(part.index)).map((face) => faceOf(face).join(', ')).join(', -1, ');
    return wrap(`Material { diffuseColor .8 0.7 6e-1 } Coordinate3 { point [ ${points} ] } ${fields} IndexedFaceSet { coordIndex [ ${faces}, -1 ] }`, part);
  });
  return [header, '# a comment { that opens', 'Separator { Info { string "a head" } ShapeHints { creaseAngle 2.0 }', ...sets, '}', last].join('\n');
}
