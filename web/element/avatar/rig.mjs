// SPDX-License-Identifier: MIT
// An avatar as numbers: where its vertices are, and where each control takes them.
import { Quaternion, Vector3 } from 'three';

export const JAW_RADIANS = 0.38; // what a jaw that is a bone does at weight 1
const LEAST = 1e-7; // of a shift, in the mesh's own units

/**
 * @typedef {{vertices: Uint32Array, deltas: Float32Array}} Field where a control takes what at weight 1: three numbers for each
 * @typedef {{position: Float32Array, meshOf: Uint16Array, fields: Map<string, Field>}} Rig
 */

/** A bone's turn about an axis of the world, from how it stands at rest. */
export class BoneTurn {
  constructor(bone) {
    this.bone = bone;
    this.rest = bone.quaternion.clone();
    this.parent = (bone.parent ?? bone).getWorldQuaternion(new Quaternion());
    this.back = this.parent.clone().invert();
  }

  /** @param {Quaternion} turn in the world's axes */
  set(turn) {
    this.bone.quaternion.copy(this.back).multiply(turn).multiply(this.parent).multiply(this.rest);
  }
}

/**
 * The vertices in the world, as the avatar stands.
 * @param {import('three').Mesh[]} meshes whose matrices are right
 */
function placed(meshes, into) {
  const at = new Vector3();
  let offset = 0;
  for (const mesh of meshes) {
    const { count } = mesh.geometry.attributes.position;
    for (let v = 0; v < count; v++) {
      mesh.getVertexPosition(v, at).applyMatrix4(mesh.matrixWorld);
      at.toArray(into, 3 * (offset + v));
    }
    offset += count;
  }
  return into;
}

/** Applies a control's morph targets to vertices. */
function morphed({ binds }, offsets) {
  const sums = new Map(); // vertex -> shift in the world
  const [from, to, shift] = [new Vector3(), new Vector3(), new Vector3()];
  for (const { mesh, index, weight } of binds) {
    const { position } = mesh.geometry.attributes;
    const target = mesh.geometry.morphAttributes.position[index];
    for (let v = 0; v < position.count; v++) {
      shift.fromBufferAttribute(target, v).multiplyScalar(weight);
      if (!(Math.abs(shift.x) + Math.abs(shift.y) + Math.abs(shift.z) > LEAST)) continue;
      from.fromBufferAttribute(position, v);
      to.copy(from).add(shift);
      for (const one of [from, to]) {
        if (mesh.isSkinnedMesh) mesh.applyBoneTransform(v, one);
        one.applyMatrix4(mesh.matrixWorld);
      }
      to.sub(from);
      const key = offsets.get(mesh) + v;
      const before = sums.get(key) ?? [0, 0, 0];
      sums.set(key, [before[0] + to.x, before[1] + to.y, before[2] + to.z]);
    }
  }
  return { vertices: Uint32Array.from(sums.keys()), deltas: Float32Array.from([...sums.values()].flat()) };
}

/** Applies the jaw's bone to vertices. @param {Vector3} axis to the head's left */
function jawed({ bone }, axis, scene, meshes, rest) {
  const turn = new BoneTurn(bone);
  turn.set(new Quaternion().setFromAxisAngle(axis, JAW_RADIANS));
  scene.updateMatrixWorld(true);
  const open = placed(meshes, new Float32Array(rest.length));
  turn.set(new Quaternion());
  scene.updateMatrixWorld(true);
  const vertices = [];
  const far = (v) => Math.hypot(...[0, 1, 2].map((k) => open[3 * v + k] - rest[3 * v + k]));
  for (let v = 0; v < rest.length / 3; v++) if (far(v) > LEAST) vertices.push(v);
  const deltas = new Float32Array(3 * vertices.length);
  vertices.forEach((v, i) => [0, 1, 2].forEach((k) => (deltas[3 * i + k] = open[3 * v + k] - rest[3 * v + k])));
  return { vertices: Uint32Array.from(vertices), deltas };
}

/**
 * @param {import('three').Object3D} scene @param {ReturnType<import('./controls.mjs').controlsOf>} controls
 * @param {Vector3} left to the head's left, in the world
 * @returns {Rig} in the world's axes and metres
 */
export function rigOf(scene, { meshes, face, gaze }, left) {
  scene.updateMatrixWorld(true);
  const offsets = new Map();
  let count = 0;
  for (const mesh of meshes) {
    offsets.set(mesh, count);
    count += mesh.geometry.attributes.position.count;
  }
  const meshOf = new Uint16Array(count);
  meshes.forEach((mesh, i) => meshOf.fill(i, offsets.get(mesh), offsets.get(mesh) + mesh.geometry.attributes.position.count));
  const position = placed(meshes, new Float32Array(3 * count));
  const fields = new Map();
  for (const control of [...face, ...gaze.values()])
    fields.set(control.name, control.bone ? jawed(control, left, scene, meshes, position) : morphed(control, offsets));
  return { position, meshOf, fields };
}
