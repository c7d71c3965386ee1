// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * VRML97 (ISO/IEC 14772-1), as modelling programs write it, VRML 1.0, and scenes of MPEG-4 (BIFS text, XMT-A): the scene's IndexedFaceSets with transforms, materials and
 * textures; feature points and animation table of an FDP node.
 */
import path from 'node:path';
import { hasAlpha, pictureBeside } from './beside.mjs';
import { cutFace, turnedOver } from '../mesh/triangles.mjs';
import { FileError, MOST } from '../limits.mjs';
import { apply, matrixOf, mirrors, product, vrmlTransform } from './matrix.mjs';
import { readFdp } from './fdp-node.mjs';
import { sceneText } from './scene-text.mjs';
import { walkVrml1 } from './vrml1.mjs';

const listOf = (value) => (Array.isArray(value) ? value : value ? [value] : []);

function facesOf({ fields, line }, matrix, name, material, meshes, budget) {
  const fail = (what) => {
    throw new FileError(`line ${line}`, what);
  };
  const points = listOf(fields.coord?.fields?.point);
  if (!points.length || points.length % 3) fail('an IndexedFaceSet without the points of its corners');
  const texture = listOf(fields.texCoord?.fields?.point);
  const tints = listOf(fields.color?.fields?.color);
  const tintIndex = listOf(fields.colorIndex);
  const coordIndex = listOf(fields.coordIndex);
  const texIndex = listOf(fields.texCoordIndex);
  // a node repeated by USE is created, and counted, each time
  budget.work(4 * coordIndex.length, `line ${line}`);
  const mesh = { name, material, position: [], uv: [], colors: [], index: [], targets: {}, from: [] };
  let ofFace = 0;
  const known = new Map();
  let face = [];
  const close = () => {
    if (face.length && face.length < 3) fail('a face must have three corners or more');
    const corners = fields.ccw === false ? face.reverse() : face;
    if (corners.length) cutFace(corners, (v) => mesh.position.slice(3 * v, 3 * v + 3), (...three) => mesh.index.push(...three), (steps) => budget.work(steps, `line ${line}`));
    budget.keep(3 * Math.max(0, corners.length - 2), `line ${line}`);
    face = [];
    ofFace++;
  };
  coordIndex.forEach((p, i) => {
    if (p === -1) return close();
    if (!Number.isInteger(p) || p < 0 || p >= points.length / 3) fail(`coordIndex ${i} is ${p}, but there are ${points.length / 3} points`);
    const t = texture.length ? (texIndex[i] ?? p) : -1;
    if (t >= texture.length / 2) fail(`texCoordIndex ${i} is ${t}, but there are ${texture.length / 2} points`);
    const c = !tints.length ? -1 : fields.colorPerVertex === false ? (tintIndex[ofFace] ?? ofFace) : (tintIndex[i] ?? p);
    if (c >= tints.length / 3) fail(`the colour of coordIndex ${i} is ${c}, but there are ${tints.length / 3}`);
    const key = `${p}/${t}/${c}`;
    if (!known.has(key)) {
      budget.keep(8, `line ${line}`); // counts colours and texture coordinates, too
      known.set(key, mesh.position.length / 3);
      mesh.position.push(points[3 * p], points[3 * p + 1], points[3 * p + 2]);
      mesh.uv.push(...(t < 0 ? [0, 0] : [texture[2 * t], texture[2 * t + 1]]));
      if (c >= 0) mesh.colors.push(...tints.slice(3 * c, 3 * c + 3));
      mesh.from.push(p);
    }
    face.push(known.get(key));
    return undefined;
  });
  close();
  if (!mesh.index.length) return;
  const index = Uint32Array.from(mesh.index);
  meshes.push({ ...mesh, position: apply(matrix, mesh.position), uv: texture.length ? Float64Array.from(mesh.uv) : null, index: mirrors(matrix) ? turnedOver(index) : index, colors: tints.length ? Float64Array.from(mesh.colors) : null });
}

export function readVrml(file, bytes, budget) {
  const { roots, defined, old } = sceneText(path.extname(file), bytes, budget);
  const fdp = readFdp(roots, defined, budget);
  let placed = null; // the matrix of the FDP's points
  const [meshes, materials, notes] = [[], [], []];
  const known = new Map();
  const materialOf = (appearance, solid) => {
    if (!appearance?.fields) return -1;
    const sides = known.get(appearance) ?? {};
    known.set(appearance, sides);
    if (sides[solid] === undefined) {
      sides[solid] = materials.length;
      const { diffuseColor, transparency } = appearance.fields.material?.fields ?? {};
      const look = { name: appearance.fields.material?.name ?? appearance.name ?? `material ${materials.length}`, color: diffuseColor ?? [0.8, 0.8, 0.8], roughness: 0.6, alpha: listOf(transparency)[0] > 0 ? 'blend' : 'opaque', double_sided: !solid, picture: null };
      const url = listOf(appearance.fields.texture?.fields?.url)[0];
      if (typeof url === 'string') {
        const picture = pictureBeside(file, url, `line ${appearance.fields.texture.line}`, notes, budget);
        if (picture) Object.assign(look, { picture, color: [1, 1, 1], alpha: look.alpha === 'opaque' && hasAlpha(picture.data) ? 'cutout' : look.alpha });
      }
      materials.push(look);
    }
    return sides[solid];
  };
  const draw = (set, matrix, name, appearance, solid, above = []) => {
    const before = meshes.length;
    facesOf(set, matrix, name ?? `mesh ${meshes.length}`, materialOf(appearance, solid), meshes, budget);
    if (fdp && meshes.length > before) fdp.act(meshes.at(-1), set, matrix, above);
    if (meshes.length > MOST.meshes) throw new FileError(`line ${set.line}`, `more than ${MOST.meshes} meshes are no head`);
  };
  let visited = 0;
  const walk = (node, matrix, name, above) => {
    if (!node?.type) return;
    if (++visited > 1e5) throw new FileError(`line ${node.line}`, 'more nodes than a head has');
    budget.work(100, `line ${node.line}`);
    const own = node.name ?? name;
    if (node.type === 'Shape') {
      const { geometry, appearance } = node.fields;
      if (geometry?.type === 'IndexedFaceSet') draw(geometry, matrix, geometry.name ?? own, appearance, geometry.fields.solid !== false, above);
      return;
    }
    if (node === fdp?.node) placed = matrix;
    const inner = node.type === 'Transform' ? product(matrix, vrmlTransform(node.fields, `line ${node.line}`)) : matrix;
    const { children, choice, whichChoice = -1, level } = node.fields;
    const around = node.type === 'Transform' && fdp ? [...above, { node, matrix: inner, parent: matrix }] : above;
    // of alternatives, reads the chosen one of a Switch and the nearest level of an LOD
    const shown = node.type === 'Switch' ? listOf(choice).slice(whichChoice, whichChoice < 0 ? 0 : whichChoice + 1) : node.type === 'LOD' ? listOf(level).slice(0, 1)
      : node.type === 'Face' ? listOf(node.fields.fdp) : node.type === 'FDP' ? listOf(node.fields.faceSceneGraph) : listOf(children);
    for (const child of shown) walk(child, inner, own, around);
  };
  if (old) walkVrml1(roots, { draw, work: (steps, at) => budget.work(steps, at) });
  else for (const root of roots) walk(root, matrixOf({}, ''), null, []);
  if (!meshes.length) throw new FileError('', 'there is no IndexedFaceSet in it');
  return { meshes, materials, notes, unit: null, ...(fdp && placed ? fdp.found(placed) : {}) };
}
