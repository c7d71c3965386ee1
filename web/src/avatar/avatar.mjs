// SPDX-License-Identifier: MIT
// Heads of others: a GLB or VRM becomes something that FAPs move. This is a script of its own, fetched when an element has an
// avatar: with it comes three.js as GLTFLoader needs it.
import { Vector3 } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { AvatarHead } from './avatar-head.mjs';
import { AvatarView } from './avatar-view.mjs';
import { controlsOf } from './controls.mjs';
import { fetched } from './fetched.mjs';
import { checkGlb, joinGlb, splitGlb } from './glb.mjs';
import { images } from './images.mjs';
import { landmarksOf } from './landmarks.mjs';
import { readMap } from './map.mjs';
import { AvatarProblem } from './problem.mjs';
import { rigOf } from './rig.mjs';
import { Solver } from './solver.mjs';
import { dracoOf, unpacker } from './unpackers.mjs';

const MOST_BYTES = 64 << 20;
const MOST_MAP_BYTES = 1 << 20;

const engine = {
  turns: true,
  view: (canvas) => new AvatarView(canvas),
  head: async (model) => model.head,
};

/**
 * Fetches an avatar and measures it.
 * @param {string} address
 * @param {{map?: string|null, signal: AbortSignal, progress?: (loaded: number, total: number|null) => void}} options map:
 *   address of a mapping file
 * @returns {Promise<object>} a model that brings its own engine: see Stage
 * @throws {AvatarProblem}
 */
export async function openAvatar(address, { map = null, signal, progress }) {
  const [bytes, mapping] = await Promise.all([
    fetched(address, MOST_BYTES, signal, progress),
    map ? fetched(map, MOST_MAP_BYTES, signal) : null,
  ]);
  return modelOf(bytes, readMap(mapping), new URL(address).pathname.split('/').at(-1));
}

/** @param {Uint8Array} bytes of a GLB @param {ReturnType<typeof readMap>} map @param {string} file its name */
export async function modelOf(bytes, map, file = 'avatar') {
  const glb = splitGlb(bytes);
  const json = checkGlb(glb);
  const loader = new GLTFLoader().register(images);
  const packed = (name) => json.extensionsUsed?.includes(name);
  if (packed('EXT_meshopt_compression')) loader.setMeshoptDecoder(await unpacker('meshopt'));
  if (packed('KHR_draco_mesh_compression')) loader.setDRACOLoader(dracoOf(await unpacker('draco'), json));
  let gltf;
  try {
    gltf = await loader.parseAsync(joinGlb({ json, binary: glb.binary }), '');
  } catch (error) {
    if (error instanceof AvatarProblem) throw error;
    throw new AvatarProblem('damaged', `it cannot be read: ${error.message}`);
  }
  const head = headOf(gltf, map);
  const meta = json.extensions?.VRMC_vrm?.meta ?? json.extensions?.VRM?.meta ?? {};
  const text = (value) => (typeof value === 'string' && value ? value : null);
  const name = file.replace(/\.[^.]*$/, '');
  return {
    engine,
    head,
    name,
    title: text(meta.name) ?? text(meta.title) ?? text(json.scenes?.[json.scene ?? 0]?.name) ?? name,
    credits: [json.asset?.copyright, ...(Array.isArray(meta.authors) ? meta.authors : [meta.author])].map(text).filter(Boolean),
  };
}

/** @returns {AvatarHead} */
function headOf(gltf, map) {
  const controls = controlsOf(gltf, map);
  if (!controls.face.length) throw new AvatarProblem('no-face', 'it has no shapes that are known here, and no jaw: see avatar-map');
  const { scene } = gltf;
  scene.updateMatrixWorld(true);
  const eyes = Object.fromEntries(
    ['leftEye', 'rightEye']
      .filter((name) => controls.bones[name])
      .map((name) => [name, controls.bones[name].getWorldPosition(new Vector3()).toArray()]),
  );
  const yaw = yawOf(gltf.parser.json, eyes);
  const left = new Vector3(Math.cos(yaw), 0, Math.sin(yaw));
  const found = landmarksOf(rigOf(scene, controls, left), yaw, eyes);
  if (!found) throw new AvatarProblem('no-face', 'nothing of what it has opens a mouth: no lips part');
  return new AvatarHead(gltf, controls, found, new Solver(controls.face, found));
}

/** What brings its front to +z: glTF has it there, VRM 0 at -z; eyes know better. A quarter of a turn at a time. */
function yawOf(json, { leftEye, rightEye }) {
  if (!leftEye || !rightEye) return json.extensions?.VRM ? Math.PI : 0;
  const angle = Math.atan2(leftEye[2] - rightEye[2], leftEye[0] - rightEye[0]);
  return Math.round(angle / (Math.PI / 2)) * (Math.PI / 2);
}
