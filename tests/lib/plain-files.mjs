// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a head as a file with only vertices and triangles.
import fs from 'node:fs';

/** @param {(p: number[]) => number[]} place maps a point of the head to the file's coordinates */
export function writeObj(file, head, place) {
  let from = 1;
  const text = head.parts.map((part, i) => {
    const lines = [`o thing${i}`];
    for (let v = 0; v < part.position.length; v += 3) lines.push(`v ${place([...part.position.slice(v, v + 3)]).map((x) => x.toFixed(6)).join(' ')}`);
    for (let t = 0; t < part.index.length; t += 3) lines.push(`f ${[0, 1, 2].map((k) => from + part.index[t + k]).join(' ')}`);
    from += part.position.length / 3;
    return lines.join('\n');
  });
  fs.writeFileSync(file, `${text.join('\n')}\n`);
}

/** As GLB. */
export function writeGlb(file, head, place) {
  const [blocks, json] = [[], { asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [] }], nodes: [], meshes: [], accessors: [], bufferViews: [], buffers: [] }];
  let size = 0;
  const add = (array, accessor) => {
    json.bufferViews.push({ buffer: 0, byteOffset: size, byteLength: array.byteLength });
    json.accessors.push({ bufferView: json.bufferViews.length - 1, ...accessor });
    blocks.push(Buffer.from(array.buffer));
    size += array.byteLength;
    return json.accessors.length - 1;
  };
  for (const part of head.parts) {
    const position = new Float32Array(part.position.length);
    for (let v = 0; v < position.length; v += 3) position.set(place([...part.position.slice(v, v + 3)]), v);
    const [low, high] = [Math.min, Math.max].map((pick) => [0, 1, 2].map((k) => position.reduce((best, x, i) => (i % 3 === k ? pick(best, x) : best), position[k])));
    const POSITION = add(position, { componentType: 5126, type: 'VEC3', count: position.length / 3, min: low, max: high });
    json.meshes.push({ primitives: [{ attributes: { POSITION }, indices: add(Uint32Array.from(part.index), { componentType: 5125, type: 'SCALAR', count: part.index.length }) }] });
    json.scenes[0].nodes.push(json.nodes.push({ mesh: json.meshes.length - 1 }) - 1);
  }
  json.buffers.push({ byteLength: size });
  const text = JSON.stringify(json);
  const padded = Buffer.from(text.padEnd(4 * Math.ceil(text.length / 4)));
  const words = (...list) => Buffer.from(Uint32Array.from(list).buffer);
  fs.writeFileSync(file, Buffer.concat([words(0x46546c67, 2, 28 + padded.length + size, padded.length, 0x4e4f534a), padded, words(size, 0x004e4942), ...blocks]));
}
