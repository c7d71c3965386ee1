// SPDX-License-Identifier: GPL-3.0-or-later
/** Reads a file of any format that is known, by its name, as a scene: meshes with targets, materials, and what the file says of itself. */
import fs from 'node:fs';
import path from 'node:path';
import zlib from 'node:zlib';
import { Budget, FileError, MOST } from '../limits.mjs';
import { readFbx } from './read-fbx.mjs';
import { readGltf } from './read-gltf.mjs';
import { readObj } from './read-obj.mjs';
import { readPly } from './read-ply.mjs';
import { readVrml } from './read-vrml.mjs';
import { nameTargets } from './target-names.mjs';

const READERS = { glb: readGltf, gltf: readGltf, vrm: readGltf, fbx: readFbx, obj: readObj, ply: readPly, wrl: readVrml, vrml: readVrml, wrz: readVrml, bt: readVrml, xmt: readVrml };
export const KINDS = Object.keys(READERS);

/** Unpacks gzip, which VRML and PLY files may use without a matching name. */
function unzipped(bytes) {
  try {
    return zlib.gunzipSync(bytes, { maxOutputLength: MOST.bytes });
  } catch (error) {
    throw new FileError('', `cannot be unpacked: ${error.message}`);
  }
}

/** What people save instead of a model, by how it begins. */
const INSTEAD = [
  [/^\s*(<!--[^]*?-->\s*)*<(!doctype html|html)\b/i, 'is a web page, not a model: what is wanted is the file that the page offers'],
  [/^version https:\/\/git-lfs\./, 'is a pointer of Git LFS, not the model: "git lfs pull" fetches that'],
  [/^PK\x03\x04/, 'is a ZIP archive: unpack it, and import the model in it'],
  [/^$/, 'is empty'],
];

/** Shells about the eyes that shade or wet them in the programs that they are made for (Reallusion, MetaHuman, ICT-FaceKit), and would cover them here. */
const COVERS = /eye[ _.-]?(occlusion|blend|shell|wet)|tear[ _.-]?(line|duct)|lacrimal/i;

/** MakeHuman's marks of joints and forms that clothes are fitted to: with them, its base mesh has no face to be seen. */
const HELPERS = /^(joint-|helper-(hair|tights|skirt|genital))/;

/** Leaves out meshes that only the programs know what to do with that made them. */
function leaveOut(scene, pattern, what) {
  const of = ({ name, also, material, materialName }) => `${name} ${also ?? ''} ${scene.materials[material]?.name ?? materialName ?? ''}`;
  const kept = scene.meshes.filter((mesh) => !pattern.test(of(mesh)));
  if (!kept.length || kept.length === scene.meshes.length) return;
  scene.notes.push(`${what} are left out: ${scene.meshes.length - kept.length}`);
  scene.meshes = kept;
}

/** Whether a mesh has any extent: some programs want a point on the floor, or leave empty shells. */
const isSeen = ({ position }) => position.some((x, i) => x !== position[i % 3]);

export async function readScene(file) {
  const kind = path.extname(file).slice(1).toLowerCase();
  if (!READERS[kind]) throw new FileError('', `".${kind}" is not read: ${KINDS.join(', ')}; other files save as GLB (Blender does)`);
  const { size } = fs.statSync(file);
  if (size > MOST.bytes) throw new FileError('', `${size} bytes are more than ${MOST.bytes}`);
  try {
    const bytes = fs.readFileSync(file);
    const start = bytes.toString('latin1', 0, 4096);
    for (const [pattern, what] of INSTEAD) if (pattern.test(start)) throw new FileError('', what);
    const scene = await READERS[kind](file, bytes[0] === 0x1f && bytes[1] === 0x8b ? unzipped(bytes) : bytes, new Budget());
    scene.meshes = scene.meshes.filter(isSeen);
    if (!scene.meshes.length) throw new FileError('', 'its meshes are points: there is nothing to see');
    leaveOut(scene, COVERS, 'covers of the eyes, which other programs shade,');
    leaveOut(scene, HELPERS, "MakeHuman's helpers");
    nameTargets(scene);
    return scene;
  } catch (error) {
    // values of a wrong type: the JavaScript error names the member
    if (error instanceof TypeError || error instanceof RangeError) throw new FileError('', `is not built as .${kind} files are: ${error.message}`);
    throw error;
  }
}
