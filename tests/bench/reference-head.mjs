// SPDX-License-Identifier: GPL-3.0-or-later
// A typical head of other software as a reference: three.js's physically based material (MeshStandardMaterial with a prefiltered environment, three
// lamps, 4x multisampling), all triangles of a faccia head at any distance, and 52 morph targets with normals in the vertex shader. Runs in a page:
// `reference(canvas, model)` returns a drawing function.
import {
  AmbientLight, BufferAttribute, BufferGeometry, DirectionalLight, DoubleSide, FrontSide, Group, Mesh, MeshStandardMaterial,
  PerspectiveCamera, PMREMGenerator, Scene, SpotLight, SRGBColorSpace, Texture, WebGLRenderer, ACESFilmicToneMapping, Color,
} from 'three';
import { RoomEnvironment } from 'three/examples/jsm/environments/RoomEnvironment.js';

const TARGETS = 52;
const ACTIVE = 14; // targets moved at a time by a speaking face
const MOST_MM = 4; // largest displacement of a target

/** The parts that get targets: those with the most vertices. */
const targetsOf = (parts) => {
  const sizes = new Map();
  for (const { moves } of parts)
    for (const { fap, sign, vertices } of moves) sizes.set(`${fap} ${sign}`, (sizes.get(`${fap} ${sign}`) ?? 0) + vertices.length);
  return [...sizes.keys()].sort((a, b) => sizes.get(b) - sizes.get(a)).slice(0, TARGETS);
};

function geometryOf(part, targets) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(part.position, 3));
  geometry.setAttribute('uv', new BufferAttribute(part.uv?.map((value, i) => (i % 2 ? 1 - value : value)) ?? new Float32Array(2 * part.vertices), 2));
  geometry.setIndex(new BufferAttribute(part.index, 1));
  geometry.computeVertexNormals();
  if (!part.moves.length) return geometry;
  const positions = [];
  const normals = [];
  for (const name of targets) {
    const position = new Float32Array(part.position.length);
    const move = part.moves.find(({ fap, sign }) => `${fap} ${sign}` === name);
    if (move) {
      const most = move.deltas.reduce((max, value) => Math.max(max, Math.abs(value)), 1e-6);
      move.vertices.forEach((v, i) => position.set(move.deltas.subarray(3 * i, 3 * i + 3).map((value) => (value * MOST_MM) / most), 3 * v));
    }
    const moved = geometry.clone();
    moved.setAttribute('position', new BufferAttribute(part.position.map((value, i) => value + position[i]), 3));
    moved.computeVertexNormals();
    const rest = geometry.attributes.normal.array;
    positions.push(new BufferAttribute(position, 3));
    normals.push(new BufferAttribute(moved.attributes.normal.array.map((value, i) => value - rest[i]), 3));
  }
  geometry.morphAttributes = { position: positions, normal: normals };
  geometry.morphTargetsRelative = true;
  return geometry;
}

/**
 * @param {HTMLCanvasElement} canvas @param {object} model as returned by readModel
 * @param {(texture: object) => Promise<ImageBitmap>} decode its textures
 * @returns {Promise<{draw: (seconds: number) => void, triangles: number, gl: WebGL2RenderingContext}>}
 */
export async function reference(canvas, model, decode, width = 640, height = 480) {
  const renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height, false);
  renderer.toneMapping = ACESFilmicToneMapping;
  const scene = new Scene();
  const room = new PMREMGenerator(renderer);
  scene.environment = room.fromScene(new RoomEnvironment(), 0.04).texture;
  const key = new DirectionalLight(0xfff4e8, 3);
  key.position.set(-300, 300, 400);
  const spot = new SpotLight(0xc8d8ff, 1e6);
  spot.position.set(350, 50, 300);
  scene.add(new AmbientLight(0xffffff, 0.6), key, spot);
  const { view } = model;
  const camera = new PerspectiveCamera(view.fov, width / height, 50, 3000);
  camera.position.set(view.target[0], view.target[1], view.target[2] + view.distance);
  const textures = new Map();
  for (const [name, json] of Object.entries(model.textures)) {
    const texture = new Texture(await decode(json));
    Object.assign(texture, { flipY: false, colorSpace: SRGBColorSpace, needsUpdate: true });
    textures.set(name, texture);
  }
  const head = new Group();
  scene.add(head);
  const targets = targetsOf(model.parts);
  let triangles = 0;
  const moving = [];
  for (const part of model.parts) {
    const look = model.materials[part.material] ?? {};
    const material = new MeshStandardMaterial({
      map: textures.get(look.texture) ?? null,
      color: new Color(...(look.color ?? [1, 1, 1])),
      roughness: look.roughness ?? 0.6,
      side: look.double_sided ? DoubleSide : FrontSide,
      transparent: look.alpha === 'blend',
      depthWrite: look.alpha !== 'blend',
      alphaTest: look.alpha === 'cutout' ? 0.5 : 0,
    });
    const mesh = new Mesh(geometryOf(part, targets), material);
    mesh.frustumCulled = false;
    head.add(mesh);
    triangles += part.index.length / 3;
    if (mesh.morphTargetInfluences) moving.push(mesh.morphTargetInfluences);
  }
  return {
    triangles,
    gl: renderer.getContext(),
    draw(seconds) {
      head.rotation.y = 0.06 * Math.sin(seconds);
      for (const influences of moving)
        for (let i = 0; i < ACTIVE; i++) influences[i] = 0.5 + 0.5 * Math.sin(seconds * (3 + 0.4 * i) + i);
      renderer.render(scene, camera);
    },
  };
}
