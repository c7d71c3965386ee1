// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Reads FBX 7 (Autodesk, binary or text) with the reader of three.js: meshes placed by their nodes, shapes, plain colours, one picture each. That
 * reader is made for pages, so this provides what it needs to load pictures.
 */
import { isUsable, NO_PICTURE, pictureOf, readBeside } from './beside.mjs';
import { turnedOver } from '../mesh/triangles.mjs';
import { fromLinear } from '../mesh/paint.mjs';
import { BINARY, checkFbx } from './check-fbx.mjs';
import { FileError, MOST } from '../limits.mjs';

const CENTIMETRE = 10; // mm: the unit of FBX, unless it says otherwise

/** Runs `work` in a simulated page that names pictures instead of fetching them. */
function onPage(work, warnings, blobs) {
  const image = () => ({
    addEventListener(type, heard) {
      if (type === 'load') this.loaded = heard;
    },
    removeEventListener() {},
    set src(address) {
      this.address = address;
      this.loaded();
    },
  });
  const page = {
    window: { innerWidth: 1, innerHeight: 1, URL: { createObjectURL: (blob) => `blob:${blobs.push(blob) - 1}` } },
    document: { createElementNS: image },
  };
  const { warn, error } = console;
  const before = Object.keys(page).map((name) => [name, Object.getOwnPropertyDescriptor(globalThis, name)]);
  console.warn = console.error = (text) => warnings.add(String(text).replace(/^(THREE\.)?FBXLoader: /, ''));
  try {
    for (const [name, value] of Object.entries(page)) Object.defineProperty(globalThis, name, { value, configurable: true });
    return work();
  } finally {
    for (const [name, had] of before) had ? Object.defineProperty(globalThis, name, had) : delete globalThis[name];
    Object.assign(console, { warn, error });
  }
}

async function pictureFor(address, file, blobs, name, notes) {
  try {
    const data = address.startsWith('blob:') ? Buffer.from(await blobs[Number(address.slice(5))].arrayBuffer()) : readBeside(file, address, name);
    const seen = pictureOf(data);
    if (isUsable(seen, data)) return { ...seen, data };
    notes.push(`the picture of ${name}: ${NO_PICTURE}`);
  } catch (error) {
    if (!(error instanceof FileError)) throw error;
    notes.push(`${error.message}: left out`); // a picture's path is often that on its author's machine
  }
  return null;
}

/** Merges corners that agree in all attributes, because the reader returns separate ones for each triangle. */
function welded({ position, uv, color, shapes }, from, to) {
  const [places, index, first] = [new Map(), [], []];
  for (let v = from; v < to; v++) {
    const at = (list, width) => Array.from({ length: width }, (_, k) => list[width * v + k]);
    const key = [...at(position, 3), ...(uv ? at(uv, 2) : []), ...(color ? at(color, 3) : []), ...shapes.flatMap((one) => at(one, 3))].join();
    if (!places.has(key)) places.set(key, first.push(v) - 1);
    index.push(places.get(key));
  }
  const pick = (list, width) => Float64Array.from({ length: width * first.length }, (_, i) => list[width * first[Math.floor(i / width)] + (i % width)]);
  return { index: Uint32Array.from(index), pick };
}

function meshesOf(mesh, materialOf, budget) {
  const { geometry } = mesh;
  const { position, uv, color: tints } = geometry.attributes;
  const color = tints?.itemSize === 3 && tints.array.some((x, i) => Math.abs(x - tints.array[i % 3]) > 0.01) ? tints : null;
  if (!position?.count || geometry.index) return [];
  budget.keep(position.count * (8 + 3 * (geometry.morphAttributes.position?.length ?? 0)), `mesh ${mesh.name}`); // counted once, even if several nodes share it
  for (const list of [position.array, ...(uv ? [uv.array] : []), ...(color ? [color.array] : []), ...(geometry.morphAttributes.position ?? []).map(({ array }) => array)]) {
    const bad = list.findIndex((x) => !Number.isFinite(x));
    if (bad >= 0) throw new FileError(`mesh ${mesh.name}`, `corner ${Math.floor((bad * position.count) / list.length)} is at no place`);
  }
  const placed = position.clone().applyMatrix4(mesh.matrixWorld).array;
  const turned = mesh.matrixWorld.determinant() < 0;
  const linear = mesh.matrixWorld.clone().setPosition(0, 0, 0);
  const names = Object.entries(mesh.morphTargetDictionary ?? {});
  const shapes = (geometry.morphAttributes.position ?? []).map((one) => one.clone().applyMatrix4(linear).array);
  const groups = Array.isArray(mesh.material) && geometry.groups.length ? geometry.groups : [{ start: 0, count: position.count, materialIndex: 0 }];
  return groups.map(({ start, count, materialIndex }) => {
    const to = Math.min(position.count, start + count);
    const { index, pick } = welded({ position: placed, uv: uv?.array, color: color?.array, shapes }, start, to - ((to - start) % 3));
    const targets = Object.fromEntries(names.filter(([, i]) => shapes[i]).map(([name, i]) => [name, pick(shapes[i], 3)]));
    return { name: mesh.name || 'mesh', material: materialOf(mesh.material, materialIndex), position: pick(placed, 3), uv: uv ? pick(uv.array, 2) : null, colors: color ? pick(color.array, color.itemSize).map(fromLinear) : null, index: turned ? turnedOver(index) : index, targets };
  }).filter(({ index }) => index.length);
}

const colourOf = ({ color }) => {
  const found = color?.toArray() ?? [];
  return found.length && found.every(Number.isFinite) ? found : [0.8, 0.62, 0.54];
};

/** @param {string} file @param {Buffer} bytes */
export async function readFbx(file, bytes, budget) {
  const binary = bytes.toString('latin1', 0, BINARY.length) === BINARY;
  if (binary) checkFbx(bytes, budget);
  else if (!/^FBXHeaderExtension:/m.test(bytes.toString('latin1', 0, 4096))) throw new FileError('byte 0', 'this is no FBX file');
  const { FBXLoader } = await import('../../../../web/node_modules/three/examples/jsm/loaders/FBXLoader.js');
  const [warnings, blobs] = [new Set(), []];
  let scene;
  try {
    scene = onPage(() => new FBXLoader().parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), ''), warnings, blobs);
    scene.updateMatrixWorld(true);
  } catch (error) {
    throw new FileError('', `cannot be read as FBX: ${error.message}`);
  }
  const notes = [...warnings].filter((text) => !/placeholder|curve|animation|skinning/.test(text));
  const [materials, known] = [[], new Map()];
  const materialOf = (own, i) => {
    const material = Array.isArray(own) ? own[i] : own;
    if (!material) return -1;
    if (!known.has(material)) known.set(material, materials.push(material) - 1);
    return known.get(material);
  };
  const meshes = [];
  scene.traverse((mesh) => mesh.isMesh && meshes.push(...meshesOf(mesh, materialOf, budget)));
  if (!meshes.length) throw new FileError('', 'there is no mesh in it');
  if (meshes.length > MOST.meshes || meshes.reduce((sum, { position }) => sum + position.length, 0) > MOST.numbers) throw new FileError('', 'there is more in it than a head has');
  const unit = Number(scene.userData.unitScaleFactor) || 1;
  return {
    meshes,
    materials: await Promise.all(materials.map(async (material) => ({
      name: String(material.name || 'material'),
      color: material.map?.image?.address ? [1, 1, 1] : colourOf(material),
      roughness: 0.6,
      alpha: material.transparent || material.opacity < 1 ? 'blend' : 'opaque',
      double_sided: true,
      picture: material.map?.image?.address ? await pictureFor(material.map.image.address, file, blobs, material.name, notes) : null,
    }))),
    notes,
    unit: CENTIMETRE * unit,
  };
}
