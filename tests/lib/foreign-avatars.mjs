// SPDX-License-Identifier: GPL-3.0-or-later
// Derives avatars of other conventions from a faccia avatar: fewer shapes, other names, bones instead of shapes.
import { readGlb } from './glb.mjs';

const chunk = (bytes, type) => {
  const head = Buffer.alloc(8);
  head.writeUInt32LE(bytes.length, 0);
  head.writeUInt32LE(type, 4);
  return Buffer.concat([head, bytes]);
};

/** @param {{json: object, binary: Buffer|null}} parts @returns {Buffer} */
export function writeGlb({ json, binary }) {
  const text = Buffer.from(JSON.stringify(json));
  const chunks = [chunk(Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]), 0x4e4f534a), ...(binary ? [chunk(binary, 0x004e4942)] : [])];
  const head = Buffer.alloc(12);
  head.write('glTF');
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + chunks.reduce((sum, { length }) => sum + length, 0), 8);
  return Buffer.concat([head, ...chunks]);
}

/** @param {Buffer} bytes @returns {{json: object, binary: Buffer}} a copy that may be modified */
export function partsOf(bytes) {
  const length = bytes.readUInt32LE(12);
  return { json: readGlb(bytes).json, binary: Buffer.from(bytes.subarray(28 + length)) };
}

/** Renames morph targets by `name`; null removes one. */
function renamed(json, name) {
  for (const mesh of json.meshes) {
    const names = mesh.extras?.targetNames ?? [];
    const kept = names.flatMap((one, i) => (name(one) === null ? [] : [i]));
    for (const primitive of mesh.primitives) {
      primitive.targets = kept.map((i) => primitive.targets[i]);
      if (!kept.length) delete primitive.targets;
    }
    mesh.weights = kept.map(() => 0);
    mesh.extras = { targetNames: kept.map((i) => name(names[i])) };
    if (!kept.length) {
      delete mesh.weights;
      delete mesh.extras;
    }
  }
}

const without = (json, ...nodes) => json.nodes.filter(({ name }) => nodes.includes(name)).forEach((node) => (node.name = 'joint'));

/** Only the 15 visemes and the lids, with Oculus names; no VRM, no known bones. */
export function visemesOnly(bytes) {
  const glb = partsOf(bytes);
  renamed(glb.json, (name) => (/^viseme_|^eyeBlink/.test(name) ? name : null));
  delete glb.json.extensions;
  without(glb.json, 'Head', 'Neck', 'LeftEye', 'RightEye');
  return writeGlb(glb);
}

const VRM0 = { viseme_aa: 'a', viseme_I: 'i', viseme_U: 'u', viseme_E: 'e', viseme_O: 'o', eyeBlinkLeft: 'blink_l', eyeBlinkRight: 'blink_r' };

/** VRM 0: unnamed morph targets, expressions by mesh, facing -z. */
export function vrm0(bytes) {
  const glb = partsOf(bytes);
  const { json } = glb;
  renamed(json, (name) => (name in VRM0 ? name : null));
  const humanBones = Object.entries(json.extensions.VRMC_vrm.humanoid.humanBones).map(([bone, { node }]) => ({ bone, node }));
  const blendShapeGroups = Object.entries(VRM0).map(([name, presetName]) => ({
    name: presetName.toUpperCase(),
    presetName,
    binds: json.meshes.flatMap((mesh, i) => {
      const index = mesh.extras?.targetNames.indexOf(name) ?? -1;
      return index < 0 ? [] : [{ mesh: i, index, weight: 100 }];
    }),
  }));
  for (const mesh of json.meshes) delete mesh.extras;
  json.extensionsUsed = ['VRM'];
  json.extensions = { VRM: { meta: { title: 'Zero', author: 'faccia' }, humanoid: { humanBones }, blendShapeMaster: { blendShapeGroups } } };
  json.nodes.push({ name: 'turned', rotation: [0, 1, 0, 0], children: json.scenes[0].nodes });
  json.scenes[0].nodes = [json.nodes.length - 1];
  return writeGlb(glb);
}

const ODD = { jawOpen: 'Bocca aperta', mouthClose: 'Labbra 1', mouthPucker: 'bacio', mouthSmileLeft: 'su_sx', mouthSmileRight: 'su_dx', mouthUpperUpLeft: 'K1', mouthUpperUpRight: 'K2', eyeBlinkLeft: 'occhio-A', eyeBlinkRight: 'occhio-B', browInnerUp: 'sopr.' };

/** Ten shapes and bones with unknown names. @returns {{glb: Buffer, map: object}} */
export function oddNames(bytes) {
  const glb = partsOf(bytes);
  renamed(glb.json, (name) => ODD[name] ?? null);
  delete glb.json.extensions;
  for (const node of glb.json.nodes) if (['Head', 'LeftEye', 'RightEye'].includes(node.name)) node.name = `osso ${node.name}`;
  const bones = Object.fromEntries(['Head', 'LeftEye', 'RightEye'].map((name) => [name[0].toLowerCase() + name.slice(1), `osso ${name}`]));
  return { glb: writeGlb(glb), map: { format: 'faccia-avatar-map', version: 1, shapes: ODD, bones } };
}

/** No morph targets: a jaw bone moves the vertices of jawOpen. */
export function bonesOnly(bytes) {
  const { numbers } = readGlb(bytes);
  const glb = partsOf(bytes);
  const { json } = glb;
  const head = json.nodes.findIndex(({ name }) => name === 'Head');
  const world = (node) => {
    const parent = json.nodes.find(({ children }) => children?.includes(node));
    const own = json.nodes[node].translation ?? [0, 0, 0];
    return parent ? world(json.nodes.indexOf(parent)).map((value, k) => value + own[k]) : own;
  };
  const at = world(head).map((value, k) => value + [0, 0.0025, 0.023][k]);
  json.nodes.push({ name: 'Jaw', translation: at.map((value, k) => value - world(head)[k]) });
  json.nodes[head].children.push(json.nodes.length - 1);
  const { skins: [skin] } = json;
  const add = (array, fields) => {
    const data = Buffer.from(array.buffer, array.byteOffset, array.byteLength);
    json.bufferViews.push({ buffer: 0, byteOffset: glb.binary.length, byteLength: data.length });
    json.accessors.push({ bufferView: json.bufferViews.length - 1, ...fields });
    glb.binary = Buffer.concat([glb.binary, data, Buffer.alloc((4 - (data.length % 4)) % 4)]);
    return json.accessors.length - 1;
  };
  const jaw = skin.joints.push(json.nodes.length - 1) - 1;
  const matrices = [...numbers(skin.inverseBindMatrices), 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -at[0], -at[1], -at[2], 1];
  skin.inverseBindMatrices = add(Float32Array.from(matrices), { componentType: 5126, count: jaw + 1, type: 'MAT4' });
  for (const mesh of json.meshes.filter(({ name }) => name !== 'stand')) {
    const [primitive] = mesh.primitives;
    const open = mesh.extras?.targetNames.indexOf('jawOpen') ?? -1;
    const shift = open < 0 ? null : numbers(primitive.targets[open].POSITION);
    const { POSITION, JOINTS_0, WEIGHTS_0 } = primitive.attributes;
    const [place, joints, weights] = [POSITION, JOINTS_0, WEIGHTS_0].map((accessor) => Uint8Array.from(numbers(accessor)).length && numbers(accessor));
    const count = joints.length / 4;
    for (let v = 0; shift && v < count; v++) {
      const far = Math.hypot(place[3 * v + 1] - at[1], place[3 * v + 2] - at[2]) * 0.38; // displacement by the bone
      const share = Math.min(1, Math.hypot(...shift.subarray(3 * v, 3 * v + 3)) / far) || 0;
      if (joints[4 * v] > 1) continue; // belongs to an eye
      for (let k = 0; k < 2; k++) weights[4 * v + k] = Math.round(weights[4 * v + k] * (1 - share));
      joints[4 * v + 2] = jaw;
      weights[4 * v + 2] = 255 - weights[4 * v] - weights[4 * v + 1];
    }
    primitive.attributes.JOINTS_0 = add(Uint8Array.from(joints), { componentType: 5121, count, type: 'VEC4' });
    primitive.attributes.WEIGHTS_0 = add(Uint8Array.from(weights), { componentType: 5121, count, type: 'VEC4', normalized: true });
  }
  json.buffers[0].byteLength = glb.binary.length;
  renamed(json, () => null);
  delete json.extensions;
  return writeGlb(glb);
}
