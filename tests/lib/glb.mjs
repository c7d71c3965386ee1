// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the parts of a GLB that the tests need.

const ARRAYS = { 5121: Uint8Array, 5123: Uint16Array, 5126: Float32Array };
const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };

/** @param {Buffer} bytes @returns {{json: object, numbers: (accessor: number) => ArrayLike<number>}} */
export function readGlb(bytes) {
  const length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + length));
  const binary = bytes.subarray(28 + length);
  const view = (index, type, count) => {
    const { byteOffset = 0 } = json.bufferViews[index];
    const start = binary.byteOffset + byteOffset;
    return new ARRAYS[type](binary.buffer.slice(start, start + count * ARRAYS[type].BYTES_PER_ELEMENT));
  };
  const numbers = (index) => {
    const { bufferView, componentType, count, type, sparse } = json.accessors[index];
    const width = WIDTHS[type];
    const out = bufferView === undefined ? new ARRAYS[componentType](count * width) : view(bufferView, componentType, count * width);
    if (sparse) {
      const places = view(sparse.indices.bufferView, sparse.indices.componentType, sparse.count);
      const values = view(sparse.values.bufferView, componentType, sparse.count * width);
      places.forEach((place, i) => out.set(values.subarray(i * width, (i + 1) * width), place * width));
    }
    return out;
  };
  return { json, numbers };
}
