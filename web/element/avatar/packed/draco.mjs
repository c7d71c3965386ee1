// SPDX-License-Identifier: MIT
// Unpacks meshes of Draco (KHR_draco_mesh_compression). A separate script: most avatars need none.
import module from 'three/examples/jsm/libs/draco/gltf/draco_wasm_wrapper.js';
import wasmBinary from 'three/examples/jsm/libs/draco/gltf/draco_decoder.wasm';

const TYPES = {
  Int8Array: [Int8Array, 'DT_INT8'], Uint8Array: [Uint8Array, 'DT_UINT8'], Int16Array: [Int16Array, 'DT_INT16'],
  Uint16Array: [Uint16Array, 'DT_UINT16'], Uint32Array: [Uint32Array, 'DT_UINT32'], Float32Array: [Float32Array, 'DT_FLOAT32'],
};

/** @returns {Promise<Draco>} @throws where the page's policy forbids WebAssembly */
export async function openDraco() {
  return new Draco(await module({ wasmBinary }));
}

class Draco {
  constructor(draco) {
    this.draco = draco;
  }

  /**
   * @param {Uint8Array} bytes
   * @param {Record<string, {id: number, type: string}>} wanted its attributes: their numbers in there, and the kind of array
   * @param {{points: number, corners: number}} most that it may have
   * @returns {{index: Uint32Array, count: number, attributes: Record<string, {array: ArrayLike<number>, width: number}>}}
   *   count: of points
   * @throws {Error} where it is damaged, or has more
   */
  decode(bytes, wanted, most) {
    const { draco } = this;
    const decoder = new draco.Decoder();
    const mesh = new draco.Mesh();
    try {
      if (decoder.GetEncodedGeometryType(bytes) !== draco.TRIANGULAR_MESH) throw new Error('what is packed with Draco is no mesh');
      const status = decoder.DecodeArrayToMesh(bytes, bytes.length, mesh);
      if (!status.ok() || !mesh.ptr) throw new Error(`what is packed with Draco cannot be unpacked: ${status.error_msg()}`);
      const count = mesh.num_points();
      const corners = 3 * mesh.num_faces();
      if (count > most.points || corners > most.corners)
        throw new Error(`what is packed with Draco has ${count} points and ${corners} corners, more than its accessors say`);
      const index = this.#copied(Uint32Array, corners, (size, at) => decoder.GetTrianglesUInt32Array(mesh, size, at));
      const past = index.findIndex((v) => v >= count);
      if (past >= 0) throw new Error(`what is packed with Draco has a corner at point ${index[past]} of ${count}`);
      const attributes = {};
      for (const [name, { id, type }] of Object.entries(wanted)) {
        const attribute = decoder.GetAttributeByUniqueId(mesh, id);
        if (!attribute.ptr) throw new Error(`what is packed with Draco has no attribute ${id}`);
        const width = attribute.num_components();
        const [Type, kind] = TYPES[type] ?? TYPES.Float32Array;
        const fill = (size, at) => decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, draco[kind], size, at);
        attributes[name] = { width, array: this.#copied(Type, count * width, fill) };
      }
      return { index, count, attributes };
    } finally {
      draco.destroy(mesh);
      draco.destroy(decoder);
    }
  }

  #copied(Type, count, fill) {
    const { draco } = this;
    const size = count * Type.BYTES_PER_ELEMENT;
    const at = draco._malloc(size);
    try {
      if (!fill(size, at)) throw new Error('what is packed with Draco has an attribute of another kind');
      return new Type(draco.HEAPU8.buffer, at, count).slice();
    } finally {
      draco._free(at);
    }
  }
}
