// SPDX-License-Identifier: GPL-3.0-or-later
/** Reads Wavefront OBJ with MTL. Errors name the line. */
import path from 'node:path';
import { pictureBeside, readIfBeside } from './beside.mjs';
import { cutFace } from '../mesh/triangles.mjs';
import { FileError, MOST } from '../limits.mjs';
import { rowsOf } from './text.mjs';

function numbers(words, count, line) {
  const values = words.slice(0, count).map(Number);
  if (values.length < count || !values.every(Number.isFinite)) throw new FileError(`line ${line}`, `must have ${count} numbers`);
  return values;
}

/** Minimum and maximum number of arguments of each map option. */
const OPTIONS = { '-o': 3, '-s': 3, '-t': 3, '-mm': 2 };

/** Returns a map's file name: everything after its options, including blanks. */
function mapName(words) {
  let i = 0;
  while (/^-[a-z]/.test(words[i] ?? '') && i < words.length - 1) {
    const most = OPTIONS[words[i]];
    if (!most) i += 2;
    else for (const last = ++i + most; i < last && i < words.length - 1 && Number.isFinite(Number(words[i])); i++);
  }
  return words.slice(i).join(' ');
}

function readMtl(file, name, line, notes, budget) {
  const materials = [];
  const bytes = readIfBeside(file, name, `line ${line}`, notes);
  if (!bytes) return [];
  budget.keep(bytes.length, `line ${line}`); // counted for each reference
  rowsOf(bytes).forEach((row, i) => {
    const [word, ...rest] = row.trim().split(/\s+/);
    const at = `${path.basename(name)}, line ${i + 1}`;
    const one = materials.at(-1);
    if (word === 'newmtl') materials.push({ name: rest.join(' '), color: [1, 1, 1], roughness: 0.6, alpha: 'opaque', double_sided: false, picture: null });
    else if (!one) return;
    else if (word === 'Kd') {
      const color = rest.slice(0, 3).map(Number);
      if (color.length < 3 || !color.every(Number.isFinite)) throw new FileError(at, 'Kd must have 3 numbers');
      one.color = color.map((x) => Math.min(1, Math.max(0, x)));
    } else if (word === 'd' && Number(rest[0]) < 1) one.alpha = 'blend';
    else if (word === 'map_Kd') {
      const picture = pictureBeside(file, mapName(rest), at, notes, budget);
      if (picture) Object.assign(one, { picture, color: [1, 1, 1] });
    }
  });
  return materials;
}

/** Scales colours to 0..1: some programs write them up to 255. */
function asShares(list) {
  const full = list.some((x) => x > 1.5) ? 255 : 1;
  return Float64Array.from(list, (x) => x / full);
}

/** Triangulates polygons; corners with equal position and texture coordinate become one vertex. */
export function readObj(file, bytes, budget) {
  const notes = [];
  const [places, uvs, tints] = [[], [], []];
  let materials = [];
  const meshes = new Map();
  let [object, material] = ['mesh', ''];
  const meshOf = (line) => {
    const key = `${object}\n${material}`;
    if (!meshes.has(key) && meshes.size === MOST.meshes) throw new FileError(`line ${line}`, `more than ${MOST.meshes} meshes are no head`);
    if (!meshes.has(key)) meshes.set(key, { name: object, materialName: material, position: [], uv: [], colors: [], index: [], corners: new Map(), places: [], textured: false });
    return meshes.get(key);
  };
  const pick = (text, list, width, line, what) => {
    const n = Number(text);
    const i = n < 0 ? list.length / width + n : n - 1;
    if (!Number.isInteger(n) || i < 0 || i >= list.length / width) throw new FileError(`line ${line}`, `there is no ${what} ${text.slice(0, 20)}`);
    return i;
  };
  rowsOf(bytes, '\\').forEach((row, i) => {
    const line = i + 1;
    const [word, ...rest] = row.trim().split(/\s+/);
    if (word === 'v') {
      budget.keep(3, () => `line ${line}`);
      places.push(...numbers(rest, 3, line));
      if (rest.length >= 6) tints[places.length / 3 - 1] = numbers(rest.slice(3), 3, line); // an extension by many programs
    } else if (word === 'vt') {
      budget.keep(2, () => `line ${line}`);
      uvs.push(...numbers(rest, 2, line));
    } else if (word === 'o' || word === 'g') object = rest.join(' ') || 'mesh';
    else if (word === 'usemtl') material = rest.join(' ');
    else if (word === 'mtllib') materials = materials.concat(readMtl(file, rest.join(' '), line, notes, budget));
    else if (word === 'f') {
      const mesh = meshOf(line);
      if (rest.length < 3) throw new FileError(`line ${line}`, 'a face must have three corners or more');
      const corners = rest.map((corner) => {
        const [a, b] = corner.split('/');
        const p = pick(a, places, 3, line, 'vertex');
        const t = b ? pick(b, uvs, 2, line, 'texture vertex') : -1;
        const key = `${p}/${t}`;
        if (!mesh.corners.has(key)) {
          budget.keep(8, () => `line ${line}`); // counts colours and texture coordinates, too
          mesh.corners.set(key, mesh.position.length / 3);
          mesh.position.push(...places.slice(3 * p, 3 * p + 3));
          if (tints.length) mesh.colors.push(...(tints[p] ?? [1, 1, 1]));
          mesh.uv.push(...(t < 0 ? [0, 0] : uvs.slice(2 * t, 2 * t + 2)));
          mesh.textured ||= t >= 0;
          mesh.places.push(p);
        }
        return mesh.corners.get(key);
      });
      budget.keep(3 * (corners.length - 2), () => `line ${line}`);
      cutFace(corners, (v) => mesh.position.slice(3 * v, 3 * v + 3), (...three) => mesh.index.push(...three), (steps) => budget.work(steps, () => `line ${line}`));
    }
  });
  if (!meshes.size) throw new FileError('', 'there are no faces in it');
  return {
    meshes: [...meshes.values()].map(({ name, materialName, position, uv, colors, index, textured, places: from }) => ({
      name,
      material: materials.findIndex((one) => one.name === materialName),
      materialName,
      position: Float64Array.from(position),
      uv: textured ? Float64Array.from(uv) : null,
      colors: colors.length ? asShares(colors) : null,
      index: Uint32Array.from(index),
      targets: {},
      from,
    })),
    materials,
    notes,
    unit: null,
    counted: 'whole', // vertices: indices across all meshes
  };
}
