// SPDX-License-Identifier: GPL-3.0-or-later
/** Writes a GLB (glTF 2.0, Khronos 2021): numbers and pictures in one binary chunk, the rest as JSON. */

const FLOAT = 5126,
  USHORT = 5123,
  UBYTE = 5121;
const VERTICES = 34962,
  INDICES = 34963;

export class Glb {
  constructor() {
    this.json = { asset: { version: '2.0' }, accessors: [], bufferViews: [], buffers: [] };
    this.chunks = [];
    this.size = 0;
    this.empty = new Map(); // accessors of zeros by their count
  }

  /** @param {ArrayBufferView} data @returns {number} its buffer view */
  view(data, target) {
    const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
    this.json.bufferViews.push({ buffer: 0, byteOffset: this.size, byteLength: bytes.length, ...(target ? { target } : {}) });
    this.add(bytes);
    return this.json.bufferViews.length - 1;
  }

  add(bytes) {
    const rest = (4 - (bytes.length % 4)) % 4;
    this.chunks.push(bytes, Buffer.alloc(rest));
    this.size += bytes.length + rest;
  }

  accessor(fields) {
    this.json.accessors.push(fields);
    return this.json.accessors.length - 1;
  }

  indices(numbers) {
    return this.accessor({ bufferView: this.view(Uint16Array.from(numbers), INDICES), componentType: USHORT, count: numbers.length, type: 'SCALAR' });
  }

  /** @param {Float32Array} numbers */
  floats(numbers, type, width, bounds = false) {
    return this.accessor({
      bufferView: this.view(numbers, type === 'MAT4' ? undefined : VERTICES),
      componentType: FLOAT,
      count: numbers.length / width,
      type,
      ...(bounds ? boundsOf(numbers, width) : {}),
    });
  }

  /** Four bytes per vertex; shares: 255 means 1. */
  bytes4(numbers, shares) {
    return this.accessor({
      bufferView: this.view(Uint8Array.from(numbers), VERTICES),
      componentType: UBYTE,
      count: numbers.length / 4,
      type: 'VEC4',
      ...(shares ? { normalized: true } : {}),
    });
  }

  /**
   * Stores mostly zero vectors sparsely: only those longer than `least`, with their indices.
   * @param {Float64Array} numbers three for each vertex
   */
  sparse(numbers, least, bounds) {
    const places = [];
    for (let v = 0; v < numbers.length / 3; v++) if (Math.hypot(...numbers.subarray(3 * v, 3 * v + 3)) > least) places.push(v);
    const count = numbers.length / 3;
    if (!places.length) return this.zeros(count, bounds);
    const kept = new Float32Array(3 * places.length);
    places.forEach((v, i) => kept.set(numbers.subarray(3 * v, 3 * v + 3), 3 * i));
    const all = places.length < count ? Float32Array.of(...[0, 0, 0], ...kept) : kept;
    return this.accessor({
      componentType: FLOAT,
      count,
      type: 'VEC3',
      ...(bounds ? boundsOf(all, 3) : {}),
      sparse: {
        count: places.length,
        indices: { bufferView: this.view(Uint16Array.from(places)), componentType: USHORT },
        values: { bufferView: this.view(kept) },
      },
    });
  }

  /** Data without a buffer view is 0. */
  zeros(count, bounds) {
    const key = `${count} ${bounds}`;
    if (!this.empty.has(key))
      this.empty.set(key, this.accessor({ componentType: FLOAT, count, type: 'VEC3', ...(bounds ? { min: [0, 0, 0], max: [0, 0, 0] } : {}) }));
    return this.empty.get(key);
  }

  /** @returns {Buffer} */
  finish() {
    this.json.buffers = [{ byteLength: this.size }];
    const text = Buffer.from(JSON.stringify(this.json));
    const json = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
    const binary = Buffer.concat(this.chunks);
    const head = Buffer.alloc(12);
    head.write('glTF');
    head.writeUInt32LE(2, 4);
    head.writeUInt32LE(12 + 8 + json.length + 8 + binary.length, 8);
    return Buffer.concat([head, chunkHead(json, 'JSON'), json, chunkHead(binary, 'BIN\0'), binary]);
  }
}

function chunkHead(bytes, type) {
  const head = Buffer.alloc(8);
  head.writeUInt32LE(bytes.length, 0);
  head.write(type, 4, 'latin1');
  return head;
}

function boundsOf(numbers, width) {
  const min = Array(width).fill(Infinity),
    max = Array(width).fill(-Infinity);
  numbers.forEach((x, i) => {
    min[i % width] = Math.min(min[i % width], x);
    max[i % width] = Math.max(max[i % width], x);
  });
  return { min, max };
}
