// SPDX-License-Identifier: GPL-3.0-or-later
// Compresses a faccia avatar like other exporters: meshes with Draco, a picture with Basis Universal in KTX2.
import fs from 'node:fs';
import { createRequire } from 'node:module';
import { readGlb } from './glb.mjs';
import { partsOf, writeGlb } from './foreign-avatars.mjs';

const ENCODER = new URL('../../web/node_modules/three/examples/jsm/libs/draco/gltf/draco_encoder.js', import.meta.url);
const BITS = { POSITION: 16, NORMAL: 12, TEXCOORD_0: 14 };
const KINDS = { POSITION: 'POSITION', NORMAL: 'NORMAL', TEXCOORD_0: 'TEX_COORD' };
const WIDTHS = { POSITION: 3, NORMAL: 3, TEXCOORD_0: 2 };
const DRACO = 'KHR_draco_mesh_compression';
const BASIS = 'KHR_texture_basisu';
const WEBP = 'EXT_texture_webp';

/** A picture of 16 x 16 pixels with red, blue, green and yellow quarters, encoded with Basis Universal 2.5. */
export const KTX2 = {
  etc1s: 'q0tUWCAyMLsNChoKAAAAAAEAAAAQAAAAEAAAAAAAAAAAAAAAAQAAAAEAAAABAAAAaAAAACwAAACUAAAAJAAAALgAAAAAAAAAlgAAAAAAAABOAQAAAAAAAAgAAAAAAAAAAAAAAAAAAAAsAAAAAAAAAAIAKACjAQIAAwMAAAgAAAAAAAAAAAA/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIuNTAAAAQAAwAyAAAADQAAAC8AAAAAAAAAAAAAAAAAAAAIAAAAAAAAAAAAAAAeQNwAAAAAQEjdwCoDmAgAAAAAAEACDPAA4gYIAAAAQHbFBw6AKQACAAAAIEgaQVzPmQQAAACoqqqqUlVVVQUUwEQAAAAAAAASgQCYAQAAAAAAQEIJEEdgAAAgGBiOGDr2CRoATAAAAAAAACCAAAD1YNHh1hoA',
  uastc: 'q0tUWCAyMLsNChoKAAAAAAEAAAAQAAAAEAAAAAAAAAAAAAAAAQAAAAEAAAACAAAAaAAAACwAAACUAAAAJAAAAAAAAAAAAAAAAAAAAAAAAAC4AAAAAAAAADsAAAAAAAAAAAEAAAAAAAAsAAAAAAAAAAIAKACmAQIAAwMAABAAAAAAAAAAAAB/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIuNTAAACi1L/1gAACNAQDoFxkF5T/IxgAFBfk/MCYDBRnlPzDZAJebm+d/1PoHAAUSAIuZAa0DlgBYbOYEL+AC',
};

async function encoderOf() {
  const module = { exports: {} };
  new Function('module', 'exports', 'require', '__dirname', fs.readFileSync(ENCODER, 'utf8'))(module, module.exports, createRequire(import.meta.url), '');
  return new Promise((resolve) => {
    module.exports({ onModuleLoaded: (draco) => resolve({ draco }) });
  });
}

/** Encodes sequentially, so that vertices keep their order and morph targets still fit. @returns {{bytes: Uint8Array, ids: object, points: number}} */
function encode(draco, index, attributes) {
  const [encoder, builder, mesh, out] = [new draco.Encoder(), new draco.MeshBuilder(), new draco.Mesh(), new draco.DracoInt8Array()];
  builder.AddFacesToMesh(mesh, index.length / 3, Uint32Array.from(index));
  const ids = {};
  encoder.SetEncodingMethod(draco.MESH_SEQUENTIAL_ENCODING);
  for (const [name, array] of Object.entries(attributes)) {
    ids[name] = builder.AddFloatAttributeToMesh(mesh, draco[KINDS[name]], array.length / WIDTHS[name], WIDTHS[name], array);
    encoder.SetAttributeQuantization(draco[KINDS[name]], BITS[name]);
  }
  const length = encoder.EncodeMeshToDracoBuffer(mesh, out);
  const bytes = Uint8Array.from({ length }, (_, i) => out.GetValue(i) & 255);
  const points = mesh.num_points();
  for (const one of [out, mesh, builder, encoder]) draco.destroy(one);
  return { bytes, ids, points };
}

/**
 * @param {Buffer} bytes of a GLB exported by faccia
 * @param {{picture?: string, kind?: 'etc1s'|'uastc', webp?: Buffer|null, spoil?: (draco: Uint8Array) => Uint8Array}} options picture: the one to convert to KTX2;
 *   webp: replaces the picture of the clothes
 * @returns {Promise<Buffer>} the GLB with compressed meshes, except those that Draco would change; the original accessor data is removed
 */
export async function packed(bytes, { picture = 'hair', kind = 'etc1s', webp = null, spoil = (draco) => draco } = {}) {
  const { draco } = await encoderOf();
  const { numbers } = readGlb(bytes);
  const glb = partsOf(bytes);
  const { json } = glb;
  const append = (data) => {
    json.bufferViews.push({ buffer: 0, byteOffset: glb.binary.length, byteLength: data.length });
    glb.binary = Buffer.concat([glb.binary, data, Buffer.alloc((4 - (data.length % 4)) % 4)]);
    return json.bufferViews.length - 1;
  };
  for (const { primitives: [primitive] } of json.meshes.filter(({ name }) => name !== 'stand')) {
    const own = Object.keys(BITS).filter((name) => name in primitive.attributes);
    const attributes = Object.fromEntries(own.map((name) => [name, Float32Array.from(numbers(primitive.attributes[name]))]));
    const { bytes: data, ids, points } = encode(draco, numbers(primitive.indices), attributes);
    if (primitive.targets && points !== json.accessors[primitive.attributes.POSITION].count) continue; // Draco merged vertices, so morph targets would not fit
    for (const name of [primitive.indices, ...own.map((one) => primitive.attributes[one])]) delete json.accessors[name].bufferView;
    primitive.extensions = { [DRACO]: { bufferView: append(Buffer.from(spoil(data))), attributes: ids } };
  }
  const image = json.images.findIndex(({ name }) => name === picture);
  json.images[image] = { name: picture, mimeType: 'image/ktx2', bufferView: append(Buffer.from(KTX2[kind], 'base64')) };
  for (const texture of json.textures)
    if (texture.source === image) {
      delete texture.source;
      texture.extensions = { [BASIS]: { source: image } };
    }
  if (webp) {
    const texture = json.textures[json.materials.find(({ name }) => name === 'clothes').pbrMetallicRoughness.baseColorTexture.index];
    json.images[texture.source] = { name: 'clothes', mimeType: 'image/webp', bufferView: append(webp) };
    texture.extensions = { [WEBP]: { source: texture.source } };
    delete texture.source;
  }
  const extensions = [DRACO, BASIS, ...(webp ? [WEBP] : [])];
  json.extensionsUsed = [...(json.extensionsUsed ?? []), ...extensions];
  json.extensionsRequired = extensions;
  json.buffers[0].byteLength = glb.binary.length;
  return writeGlb(glb);
}
