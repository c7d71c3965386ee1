// SPDX-License-Identifier: MIT
// Third-party avatars: makes a GLB or VRM that FAPs can move. A separate script, fetched when an element has an avatar,
// because it contains three.js with GLTFLoader.
import { Vector3 } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { AvatarHead, AvatarView } from './avatar-head.mjs';
import { controlsOf, meshesIn, namesIn, swapSides } from './controls.mjs';
import { MESHOPT } from './extensions.mjs';
import { facingOf } from './facing.mjs';
import { fetched } from './fetched.mjs';
import { checkGlb, joinGlb, splitGlb } from './glb.mjs';
import { images } from './images.mjs';
import { landmarksOf } from './landmarks.mjs';
import { readMap } from './map.mjs';
import { AvatarProblem } from './problem.mjs';
import { rigOf } from './rig.mjs';
import { Solver } from './solver.mjs';
import { sanitise } from './sanitise.mjs';
import { dracoOf, setUnpackers, unpacker } from './unpackers.mjs';

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
 * @param {{map?: string|null, signal: AbortSignal, progress?: (loaded: number, total: number|null) => void,
 *   unpackers: {draco: string, basis: string}}} options map: address of a mapping file; unpackers: see setUnpackers
 * @returns {Promise<object>} a model that brings its own engine: see Stage
 * @throws {AvatarProblem}
 */
export async function openAvatar(address, { map = null, signal, progress, unpackers }) {
  setUnpackers(unpackers);
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
  if (packed(MESHOPT)) loader.setMeshoptDecoder(await unpacker('meshopt'));
  if (packed('KHR_draco_mesh_compression')) loader.setDRACOLoader(dracoOf(await unpacker('draco'), json));
  let gltf;
  try {
    gltf = await loader.parseAsync(joinGlb({ json, binary: glb.binary }), '');
  } catch (error) {
    if (error instanceof AvatarProblem) throw error;
    throw new AvatarProblem('damaged', `it cannot be read: ${error.message}`);
  }
  sanitise(meshesIn(gltf.scene));
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
  if (!controls.face.length) throw new AvatarProblem('no-face', `it has no shapes that are known here, and no jaw: see avatar-map. ${listed(namesIn(gltf.scene))}`);
  const { scene } = gltf;
  scene.updateMatrixWorld(true);
  const placeOf = (name) => controls.bones[name]?.getWorldPosition(new Vector3()).toArray();
  const eyes = { leftEye: placeOf('leftEye'), rightEye: placeOf('rightEye') };
  const jaw = controls.face.some(({ bone }) => bone);
  const usual = [0, 0, gltf.parser.json.extensions?.VRM ? -1 : 1];
  const rig = rigOf(scene, controls, new Vector3(usual[2], 0, 0));
  const facing = facingOf(rig, eyes, { usual, jaw });
  if (facing.swapped) {
    swapSides(controls, rig);
    [eyes.leftEye, eyes.rightEye] = [eyes.rightEye, eyes.leftEye];
  }
  const found = landmarksOf(jaw ? rigOf(scene, controls, new Vector3(...facing.left)) : rig, facing, eyes);
  if (!found) throw new AvatarProblem('no-face', `nothing of what it has opens a mouth: no lips part. ${listed(namesIn(gltf.scene))}`);
  return new AvatarHead(gltf, controls, found, new Solver(controls.face, found));
}

const SHOWN = 8;

/** Lists the names in the avatar, for authors of a mapping file. */
function listed(names) {
  if (!names.length) return 'It has no morph targets';
  const more = names.length > SHOWN ? ` and ${names.length - SHOWN} more` : '';
  return `Its morph targets: ${names.slice(0, SHOWN).map((name) => `"${name.slice(0, 40)}"`).join(', ')}${more}`;
}
