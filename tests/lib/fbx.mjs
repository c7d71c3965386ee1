// SPDX-License-Identifier: GPL-3.0-or-later
// Converts a faccia avatar to FBX 7.4, binary or text: meshes, shapes, a colour per mesh; in centimetres, the unit of FBX.
import zlib from 'node:zlib';
import { readGlb } from './glb.mjs';

const MAGIC = Buffer.from('Kaydara FBX Binary  \0\x1a\0', 'latin1');
const long = (value) => ({ long: value });
const properties = (list) => ['Properties70', [], list.map((values) => ['P', values, []])];

/** @param {Buffer} glb @param {{shapes?: boolean, meshes?: string[]|null}} options @returns {Array} nodes: [name, values, nodes] */
function treeOf(glb, { shapes, meshes }) {
  const { json, numbers } = readGlb(glb);
  const [objects, links] = [[], []];
  let last = 1000;
  const add = (kind, name, type, nodes, parent) => {
    const id = ++last;
    objects.push([kind, [long(id), { name, kind: { Deformer: type === 'BlendShape' ? 'Deformer' : 'SubDeformer' }[kind] ?? kind }, type], nodes]);
    links.push(['C', ['OO', long(id), long(parent)], []]);
    return id;
  };
  for (const mesh of json.meshes.filter(({ name }) => !meshes || meshes.includes(name))) {
    const [{ attributes, indices, targets = [] }] = mesh.primitives;
    const scaled = (list) => Float64Array.from(list, (x) => 100 * x);
    const corners = Int32Array.from(numbers(indices), (v, i) => (i % 3 === 2 ? ~v : v));
    const uv = numbers(attributes.TEXCOORD_0);
    const model = add('Model', mesh.name, 'Mesh', [['Version', [232], []], properties([])], 0);
    const geometry = add('Geometry', mesh.name, 'Mesh', [
      ['Vertices', [scaled(numbers(attributes.POSITION))], []],
      ['PolygonVertexIndex', [corners], []],
      ['LayerElementUV', [0], [
        ['MappingInformationType', ['ByPolygonVertex'], []],
        ['ReferenceInformationType', ['Direct'], []],
        ['UV', [Float64Array.from({ length: 2 * corners.length }, (_, i) => {
          const v = corners[i >> 1];
          const x = uv[2 * (v < 0 ? ~v : v) + (i & 1)];
          return i & 1 ? 1 - x : x;
        })], []],
      ]],
    ], model);
    add('Material', mesh.name, '', [['ShadingModel', ['phong'], []], properties([['DiffuseColor', 'Color', '', 'A', 0.8, 0.6, 0.5]])], model);
    if (!shapes || !targets.length) continue;
    const deformer = add('Deformer', mesh.name, 'BlendShape', [], geometry);
    targets.forEach(({ POSITION }, i) => {
      const moved = numbers(POSITION);
      const which = Int32Array.from({ length: moved.length / 3 }, (_, v) => v).filter((v) => moved[3 * v] || moved[3 * v + 1] || moved[3 * v + 2]);
      const name = mesh.extras.targetNames[i];
      const channel = add('Deformer', name, 'BlendShapeChannel', [['DeformPercent', [0.5], []], ['FullWeights', [Float64Array.of(100)], []]], deformer);
      add('Geometry', name, 'Shape', [['Indexes', [which], []], ['Vertices', [scaled([...which].flatMap((v) => [...moved.slice(3 * v, 3 * v + 3)]))], []]], channel);
    });
  }
  return [
    ['FBXHeaderExtension', [], [['FBXVersion', [7400], []]]],
    ['GlobalSettings', [], [['Version', [1000], []], properties([['UnitScaleFactor', 'double', 'Number', '', 1]])]],
    ['Objects', [], objects],
    ['Connections', [], links],
  ];
}

function binaryValue(value) {
  const made = (kind, size, write) => {
    const out = Buffer.alloc(1 + size);
    out.write(kind, 0);
    write(out);
    return out;
  };
  if (ArrayBuffer.isView(value)) {
    const packed = zlib.deflateSync(Buffer.from(value.buffer, value.byteOffset, value.byteLength));
    const head = made(value instanceof Int32Array ? 'i' : 'd', 12, (out) => [value.length, 1, packed.length].forEach((x, i) => out.writeUInt32LE(x, 1 + 4 * i)));
    return Buffer.concat([head, packed]);
  }
  if (value.long !== undefined) return made('L', 8, (out) => out.writeBigInt64LE(BigInt(value.long), 1));
  if (Number.isInteger(value) && value > 1) return made('I', 4, (out) => out.writeInt32LE(value, 1));
  if (typeof value === 'number') return made('D', 8, (out) => out.writeDoubleLE(value, 1));
  const text = Buffer.from(typeof value === 'string' ? value : `${value.name}\0\x01${value.kind}`, 'latin1');
  return Buffer.concat([made('S', 4, (out) => out.writeUInt32LE(text.length, 1)), text]);
}

function binaryNode([name, values, nodes], at) {
  const list = values.map(binaryValue);
  const own = Buffer.concat(list);
  let body = Buffer.concat([Buffer.from([name.length]), Buffer.from(name), own]);
  const parts = [];
  let end = at + 12 + body.length;
  for (const node of nodes) {
    parts.push(binaryNode(node, end));
    end += parts.at(-1).length;
  }
  if (nodes.length) parts.push(Buffer.alloc(13));
  const head = Buffer.alloc(12);
  body = Buffer.concat([body, ...parts]);
  [at + 12 + body.length, values.length, own.length].forEach((x, i) => head.writeUInt32LE(x, 4 * i));
  return Buffer.concat([head, body]);
}

/** @returns {Buffer} */
export function binaryFbx(glb, { shapes = true, meshes = null } = {}) {
  const version = Buffer.alloc(4);
  version.writeUInt32LE(7400);
  const parts = [MAGIC, version];
  let at = 27;
  for (const node of treeOf(glb, { shapes, meshes })) {
    parts.push(binaryNode(node, at));
    at += parts.at(-1).length;
  }
  return Buffer.concat([...parts, Buffer.alloc(13), Buffer.alloc(176 + ((16 - ((at + 13) % 16)) % 16))]);
}

function textNode([name, values, nodes], depth) {
  const [pad, within] = ['\t'.repeat(depth), '\t'.repeat(depth + 1)];
  if (ArrayBuffer.isView(values[0])) return `${pad}${name}: *${values[0].length} {\n${within}a: ${[...values[0]].map((x) => Number(x.toPrecision(8))).join(',')}\n${pad}} \n`;
  const told = values.map((value) => (value.long ?? (typeof value === 'number' ? value : `"${typeof value === 'string' ? value : `${value.kind}::${value.name}`}"`)));
  const block = nodes.length || (values.length === 3 && name !== 'C') || name === 'Properties70' ? ` {\n${nodes.map((node) => textNode(node, depth + 1)).join('')}${pad}}` : '';
  const line = name === 'P' ? told.join(', ').replaceAll(/, (?=[\d.-])/g, ',') : told.join(name === 'C' ? ',' : ', ');
  return `${pad}${name}: ${line}${block}\n`;
}

/** @returns {string} */
export const textFbx = (glb, { shapes = true, meshes = null } = {}) => `; FBX 7.4.0 project file\n\n${treeOf(glb, { shapes, meshes }).map((node) => textNode(node, 0)).join('\n')}`;
