// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Shapes that stand in files of their own: meshes with the vertices and faces of the head at rest, named by what they show (jawOpen.obj, viseme_PP.ply,
 * or the thesis's bpa.obj).
 */
import fs from 'node:fs';
import path from 'node:path';
import { FileError } from '../limits.mjs';
import { KINDS, readScene } from './read-scene.mjs';
import { nameTargets } from './target-names.mjs';

const MOST_FILES = 200;
const MOST_CORNERS = 64; // of a polygon

/** Tells whether two lots of triangles are one polygon with the same corners. */
const isPolygon = (a, b, triangles) => a.size === triangles + 2 && b.size === a.size && [...a].every((v) => b.has(v));

/**
 * Tells whether two meshes have the same faces. A polygon that is bent otherwise may be cut otherwise: its triangles then have the same corners, two more than
 * there are triangles.
 */
function sameFaces(a, b) {
  if (a.length !== b.length) return false;
  for (let t = 0; t < a.length; ) {
    if (a[t] === b[t] && a[t + 1] === b[t + 1] && a[t + 2] === b[t + 2]) {
      t += 3;
      continue;
    }
    const [own, theirs] = [new Set(), new Set()];
    let count = 0;
    do {
      for (const end = t + 3; t < end; t++) [own, theirs].forEach((set, i) => set.add([a, b][i][t]));
      count++;
    } while (t < a.length && count < MOST_CORNERS && !isPolygon(own, theirs, count));
    if (!isPolygon(own, theirs, count)) return false;
  }
  return true;
}

/** Adds the shapes in `folder` to the targets of the scene that was read from `file`. @throws {FileError} with the shape's file */
export async function addShapes(scene, folder, file) {
  const files = fs.readdirSync(folder).filter((name) => KINDS.includes(path.extname(name).slice(1).toLowerCase())).map((name) => path.join(folder, name)).filter((one) => path.resolve(one) !== path.resolve(file));
  if (!files.length) throw Object.assign(new FileError('', `there is no mesh in it (${KINDS.join(', ')})`), { file: folder });
  if (files.length > MOST_FILES) throw Object.assign(new FileError('', `${files.length} meshes are too many: ${MOST_FILES} at most`), { file: folder });
  for (const one of files.sort()) {
    try {
      addShape(scene, path.basename(one, path.extname(one)), (await readScene(one)).meshes);
    } catch (error) {
      throw Object.assign(error, { file: error.file ?? one });
    }
  }
  nameTargets(scene);
}

function addShape({ meshes }, name, others) {
  if (others.length !== meshes.length) throw new FileError('', `has ${others.length} meshes, the head at rest has ${meshes.length}`);
  meshes.forEach((mesh, m) => {
    const { position, index } = others[m];
    if (position.length !== mesh.position.length) throw new FileError(others[m].name, `has ${position.length / 3} vertices, the head at rest has ${mesh.position.length / 3}`);
    if (!sameFaces(index, mesh.index)) throw new FileError(others[m].name, 'its faces are not those of the head at rest');
    mesh.targets[name] = Float64Array.from(position, (x, i) => x - mesh.position[i]);
  });
}
