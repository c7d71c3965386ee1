// SPDX-License-Identifier: MIT
// Finds the controls of an avatar and their meaning: morph targets by name, VRM expressions, a mapping file, bones.
import { ARKIT, boneOf, BONE_NAMES, mirrored, presetOf, rowShapes, shapeOf, shapesAmong, VISEMES, VOWELS } from './names.mjs';
import { AvatarProblem } from './problem.mjs';

/**
 * @typedef {{mesh: import('three').Mesh, index: number, weight: number}} Bind a morph target
 * @typedef {{name: string, binds: Bind[], bone?: import('three').Object3D}} Control binds at weight 1, or the jaw's bone
 */

/** Shapes that open the mouth, the best first. */
export const OPENERS = ['jawOpen', 'mouthOpen', 'viseme_aa', 'vowel_aa', 'viseme_O', 'vowel_oh', 'viseme_E', 'vowel_ee'];
const MOUTH = /^(jaw|mouth)/;
const LEAST_ARKIT = 8; // of the mouth, beside jawOpen
const LEAST_VISEMES = 5;
const STILL = 1e-5; // of a mesh's size

/** Every morph target by its name in the file: `MESH#INDEX` where it has none. @returns {Map<string, Bind[]>} */
function targetsOf(meshes) {
  const out = new Map();
  for (const mesh of meshes) {
    const count = mesh.geometry.morphAttributes.position?.length ?? 0;
    const named = new Map(Object.entries(mesh.morphTargetDictionary ?? {}).map(([name, index]) => [index, name]));
    for (let index = 0; index < count; index++) {
      const name = named.get(index) && named.get(index) !== String(index) ? named.get(index) : `${mesh.name}#${index}`;
      out.set(name, [...(out.get(name) ?? []), { mesh, index, weight: 1 }]);
    }
  }
  return out;
}

/** Whether a morph target moves anything: many exporters write all names, and leave most of them empty. */
function moves({ mesh, index }) {
  const { geometry } = mesh;
  const target = geometry.morphAttributes.position?.[index];
  if (!target) return false;
  if (!geometry.boundingBox) geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox;
  const least = STILL * Math.max(max.x - min.x, max.y - min.y, max.z - min.z);
  for (let v = 0; v < target.count; v++)
    if (Math.abs(target.getX(v)) > least || Math.abs(target.getY(v)) > least || Math.abs(target.getZ(v)) > least) return true;
  return false;
}

/** The targets that move something, each mesh's by themselves. */
function movingOf(targets) {
  const kept = [...targets].map(([name, binds]) => [name, binds.filter(moves)]);
  return new Map(kept.filter(([, binds]) => binds.length));
}

/**
 * Resets the weights that a file sets for shapes of the face (glTF's mesh.weights and node.weights): the neutral face of FAPs
 * has none. Other shapes keep theirs.
 * @param {Map<string, Bind[]>} targets @param {Map<string, Bind[]>} shapes
 */
function toRest(targets, shapes) {
  const rows = rowShapes([...targets.keys()]);
  const named = [...targets].filter(([name]) => rows.has(name) || shapeOf(name)).flatMap(([, binds]) => binds);
  for (const { mesh, index } of [...named, ...[...shapes.values()].flat()]) mesh.morphTargetInfluences[index] = 0;
}

/** The expressions of VRM 1.0 and 0, by the shapes that they stand for. @returns {Map<string, Bind[]>} */
function expressionsOf(json, meshes, associations) {
  const out = new Map();
  const places = meshes.map((mesh) => {
    const own = associations.get(mesh) ?? {};
    return { mesh, meshes: own.meshes, nodes: own.nodes ?? associations.get(mesh.parent)?.nodes };
  });
  const add = (name, binds, kind, percent) => {
    const shape = typeof name === 'string' ? presetOf(name) : null;
    if (!shape || out.has(shape) || !Array.isArray(binds)) return;
    const found = binds.flatMap((bind) =>
      places
        .filter((place) => place[kind] === bind?.[kind === 'meshes' ? 'mesh' : 'node'])
        .filter(({ mesh }) => mesh.morphTargetInfluences?.[bind.index] !== undefined)
        .map(({ mesh }) => ({ mesh, index: bind.index, weight: Number.isFinite(bind.weight) ? bind.weight / percent : 1 }))
        .filter(moves),
    );
    if (found.length) out.set(shape, found);
  };
  const { preset = {}, custom = {} } = json.extensions?.VRMC_vrm?.expressions ?? {};
  for (const [name, one] of Object.entries({ ...custom, ...preset })) add(name, one?.morphTargetBinds, 'nodes', 1);
  const groups = json.extensions?.VRM?.blendShapeMaster?.blendShapeGroups;
  for (const { presetName, name, binds } of Array.isArray(groups) ? groups.filter(Boolean) : [])
    add(presetName && presetName !== 'unknown' ? presetName : name, binds, 'meshes', 100);
  return out;
}

/** Collects the avatar's shapes: from the mapping file first, then from names, then from expressions. */
function shapesOf(all, expressions, map) {
  const out = new Map();
  for (const [shape, weights] of map.shapes) {
    const binds = Object.entries(weights).flatMap(([name, weight]) => {
      if (!all.has(name)) throw new AvatarProblem('bad-map', `avatar-map, shapes.${shape}: the avatar has no morph target "${name}"`);
      return all.get(name).map((bind) => ({ ...bind, weight }));
    });
    out.set(shape, binds);
  }
  if (!map.others) return out;
  const targets = movingOf(all);
  const rows = rowShapes([...targets.keys()]);
  const meshes = new Set([...targets.values()].flat().map(({ mesh }) => mesh));
  for (const mesh of meshes) {
    const of = (binds) => binds.filter((bind) => bind.mesh === mesh);
    const own = [...targets].filter(([, binds]) => of(binds).length).map(([name]) => name);
    for (const [name, shape] of shapesAmong(own, rows))
      if (!map.shapes.has(shape)) out.set(shape, [...(out.get(shape) ?? []), ...of(targets.get(name))]);
  }
  for (const [shape, binds] of expressions) if (!out.has(shape)) out.set(shape, binds);
  return out;
}

/** The shapes of the mouth: of one kind, since those of two kinds would do the same twice. */
function mouthOf(shapes) {
  const having = (names) => names.filter((name) => shapes.has(name));
  const arkit = having(ARKIT.filter((name) => MOUTH.test(name)));
  const visemes = having(VISEMES).filter((name) => name !== 'viseme_sil');
  if (shapes.has('jawOpen') && arkit.length > LEAST_ARKIT) return arkit;
  if (visemes.length >= LEAST_VISEMES) return visemes;
  const vowels = having(VOWELS);
  if (vowels.length) return [...vowels, ...arkit];
  return arkit.length || visemes.length ? [...arkit, ...visemes] : having(['mouthOpen', 'mouthSmile']);
}

/** Identifies bones by the mapping file, VRM, or their names. @returns {Record<string, import('three').Object3D>} */
function bonesOf(gltf, map) {
  const { json, associations } = gltf.parser;
  const bones = {};
  const byNode = new Map();
  gltf.scene.traverse((object) => {
    const { nodes } = associations.get(object) ?? {};
    if (nodes !== undefined) byNode.set(nodes, object);
  });
  for (const [name, wanted] of Object.entries(map.bones)) {
    const node = (json.nodes ?? []).findIndex((one) => one.name === wanted);
    if (!byNode.has(node)) throw new AvatarProblem('bad-map', `avatar-map, bones.${name}: the avatar has no node "${wanted}"`);
    bones[name] = byNode.get(node);
  }
  const { humanBones } = json.extensions?.VRMC_vrm?.humanoid ?? {};
  const old = json.extensions?.VRM?.humanoid?.humanBones;
  const named = Array.isArray(old) ? old.filter(Boolean).map(({ bone, node }) => [bone, { node }]) : null;
  const listed = named ? Object.fromEntries(named) : (humanBones ?? {});
  for (const name of BONE_NAMES) bones[name] ??= byNode.get(listed[name]?.node);
  const joints = new Set((json.skins ?? []).flatMap((skin) => skin.joints ?? []));
  for (const [node, object] of byNode) {
    const name = boneOf(json.nodes[node].name ?? '');
    if (name && !bones[name] && (joints.has(node) || (!object.isMesh && object.children.length))) bones[name] = object;
  }
  return Object.fromEntries(Object.entries(bones).filter(([, bone]) => bone));
}

/** Swaps left and right, for avatars that are named from the viewer's side. */
export function swapSides(controls, rig) {
  for (const control of [...controls.face, ...controls.gaze.values()]) control.name = mirrored(control.name);
  controls.gaze = new Map([...controls.gaze.values()].map((control) => [control.name, control]));
  rig.fields = new Map([...rig.fields].map(([name, field]) => [mirrored(name), field]));
  const { leftEye, rightEye, ...others } = controls.bones;
  controls.bones = { ...others, ...(rightEye ? { leftEye: rightEye } : {}), ...(leftEye ? { rightEye: leftEye } : {}) };
}

/** @param {import('three').Object3D} scene @returns {import('three').Mesh[]} */
export function meshesIn(scene) {
  const meshes = [];
  scene.traverse((object) => object.isMesh && meshes.push(object));
  return meshes;
}

/** Its targets by name, for who writes a mapping file. @param {import('three').Object3D} scene @returns {string[]} */
export const namesIn = (scene) => [...targetsOf(meshesIn(scene)).keys()];

/**
 * @param {object} gltf as GLTFLoader gives it @param {ReturnType<import('./map.mjs').readMap>} map
 * @returns {{meshes: import('three').Mesh[], face: Control[], tongue: Control|null, gaze: Map<string, Control>,
 *   bones: Record<string, import('three').Object3D>}} face: what is solved for; gaze: `eyeLook...`
 */
export function controlsOf(gltf, map) {
  const meshes = meshesIn(gltf.scene);
  const { json, associations } = gltf.parser;
  const targets = targetsOf(meshes);
  const shapes = shapesOf(targets, expressionsOf(json, meshes, associations), map);
  toRest(targets, shapes);
  const bones = bonesOf(gltf, map);
  const control = (name) => ({ name, binds: shapes.get(name) });
  const lids = shapes.has('eyeBlinkLeft') && shapes.has('eyeBlinkRight') ? [] : ['eyeBlink'];
  const upper = ARKIT.filter((name) => !MOUTH.test(name) && !/^(eyeLook|tongue)/.test(name));
  const names = [...mouthOf(shapes), ...[...upper, ...lids].filter((name) => shapes.has(name))];
  const face = names.map(control);
  if (bones.jaw && !OPENERS.some((name) => names.includes(name))) face.push({ name: 'jawOpen', binds: [], bone: bones.jaw });
  const gaze = new Map([...shapes.keys()].filter((name) => name.startsWith('eyeLook')).map((name) => [name, control(name)]));
  return { meshes, face, tongue: shapes.has('tongueOut') ? control('tongueOut') : null, gaze, bones };
}
