// SPDX-License-Identifier: MIT
import {
  AddEquation, BufferAttribute, CustomBlending, DataTexture, DoubleSide, FloatType, FrontSide, Group, Matrix4, Mesh,
  NearestFilter, NoBlending, OneFactor, OneMinusSrcAlphaFactor, RGBAFormat, ShaderMaterial, Vector2, Vector3, Vector4,
} from 'three';
import { faceValues } from '../face-mixer.mjs';
import { deform } from './deform.mjs';
import { Drive, influencesOf, packInfluences } from './influences.mjs';
import { grainTexture } from './grain.mjs';
import { mouthUniforms, openingOf } from './mouth-light.mjs';
import { lean } from './lean.mjs';
import { Shape } from './shape.mjs';
import { alphaOf, shut, sight, within } from './sight.mjs';
import { CLEAR, eyeNormals, kindOf, THIN, volumeNormals } from './surfaces.mjs';
import { bakeOcclusion } from './occlusion.mjs';
import { fragmentGlsl, KINDS, vertexGlsl } from './shader-surface.mjs';
import { foldPlace, foldsOf, wrinklePlace, wrinklesOf } from './wrinkles.mjs';
import { loadTexture, setTextureQuality, whiteTexture } from './textures.mjs';

const WHOLE = /^(eye|brows|lashes|glasses)/; // they turn by themselves, or hide nothing: all of them is drawn
const INSIDE = /^(teeth|tongue)/; // nothing is seen of these when the lips meet
const SLICE_MS = 12; // of work at a time, while the page lives on

/** Where shadows are taken: speaking, so that there is light between the lips. */
const SHADOW_POSE = faceValues({
  3: 350, 4: -150, 5: -450, 8: -150, 9: -150, 10: -400, 11: -400, 51: -150, 52: -450, 55: -150, 56: -150, 57: -400, 58: -400,
});

/** Where the light on them is asked for: the same, with the lids down, since what is folded away would stay dark. */
const LIT_POSE = faceValues({ ...SHADOW_POSE, 19: 800, 20: 800, 21: 150, 22: 150 });

/** Colours come multiplied by alpha. */
function blended(material) {
  material.blending = CustomBlending;
  material.blendEquation = AddEquation;
  material.blendSrc = material.blendSrcAlpha = OneFactor;
  material.blendDst = material.blendDstAlpha = OneMinusSrcAlphaFactor;
}

const breath = () => new Promise((resolve) => setTimeout(resolve));

/**
 * Goes through a generator a slice at a time.
 * @param {() => boolean} [over] whether nobody wants it any more @returns {Promise<any>} what it returns; null: it is over
 */
async function sliced(work, over) {
  for (let result = { done: false }, start = performance.now(); ; result = work.next()) {
    if (result.done) return result.value;
    if (over?.()) return null;
    if (performance.now() - start < SLICE_MS) continue;
    await breath();
    start = performance.now();
  }
}

/** Poses that fewer triangles have to be right in: at rest, open with the lids down, and with all that bends the skin most. */
const LEAN_POSES = [
  faceValues({}),
  LIT_POSE,
  faceValues({
    4: 150, 5: 150, 6: -150, 7: -150, 16: 250, 17: 250, 31: 200, 32: 200, 33: 200, 34: 200, 35: 150, 36: 150, 44: 300,
  }),
  faceValues({ 6: 200, 7: 200, 12: 200, 13: 200, 37: 150, 38: 150, 41: 200, 42: 200, 19: 300, 20: 300, 59: 200, 60: 200 }),
];
const LEAN_MM = [0.3, 0.42]; // what a vertex may be off by,
const LEAN_SHARE = 0.55; // when that is no more of a point of the picture;
/** and how many mm a change of its normal, of the share of light and of the place on the texture are worth. */
const WORTH = { normal: 2.5, reach: 2, texture: 100 };
const WORTH_INSIDE = { normal: 0.8, reach: 0, texture: 30 }; // of the mouth, where all is small and in the shade

/** The head model as things to draw. FAPs go in, and the graphics processor does the rest. */
export class Head {
  #fewer = 0; // which of the shapes is drawn
  #looked = null; // for each number of triangles, a promise: see #look
  #sampled = false; // then it is the whole one: with fewer triangles single samples are dark, here and there

  /**
   * @param {ReturnType<import('./model.mjs').readModel>} model
   * @param {{software?: boolean}} [options] software: there is no graphics processor, so the vertices are moved here
   */
  static async create(model, { software = false } = {}) {
    const head = new Head(model);
    head.software = software;
    await head.#loadTextures();
    await head.#build();
    await head.#shade();
    return head;
  }

  constructor(model) {
    this.model = model;
    this.drive = new Drive(model);
    this.group = new Group();
    this.parts = []; // {part, influences, geometry, shapes: the whole one, then with fewer triangles; shape: the one drawn}
    this.faps = faceValues({});
    this.materials = [];
    const creases = wrinklePlace(model.fdp, model.fapu);
    this.creased = Boolean(creases);
    this.textures = new Map();
    this.uniforms = {
      slots: { value: this.drive.slotValues },
      turnAngle: { value: this.drive.angles },
      turnPivot: { value: model.turns.map(({ pivot }) => new Vector3(...pivot)) },
      turnAxis: { value: model.turns.map(({ axis }) => new Vector3(...axis).normalize()) },
      headTurn: { value: new Matrix4() },
      fade: { value: 1e-3 },
      wrinkles: { value: new Vector4() },
      wrinklePlace: { value: new Vector4(...(creases ?? [])) },
      folds: { value: new Vector3() },
      foldPlace: { value: new Vector4(...(foldPlace(model.fdp) ?? [0, 0, 0, 1])) },
      ...mouthUniforms(model),
    };
  }

  async #loadTextures() {
    const { materials, textures } = this.model;
    await Promise.all(
      Object.values(materials).map(async ({ texture, alpha }) => {
        if (!texture || this.textures.has(texture)) return;
        this.textures.set(texture, null);
        this.textures.set(texture, await loadTexture(textures[texture], alpha === 'blend' || alpha === 'cutout'));
      }),
    );
    this.white = whiteTexture();
    this.grain = grainTexture();
  }

  async #build() {
    const built = [];
    for (const part of this.model.parts) {
      built.push({ part, influences: influencesOf(part, this.drive) });
      await breath();
    }
    // Reading the influences may have made new slots.
    this.drive.slotValues = this.uniforms.slots.value = new Float32Array(Math.max(1, this.drive.slots.length));
    for (const { part, influences } of built) {
      const look = { normals: this.#normals(part, influences.normals) };
      const shape = new Shape(part, influences, look, this.software ? this.drive : null);
      const { geometry, soft } = shape;
      this.parts.push({ part, influences, geometry, shape, shapes: [shape] });
      const packed = soft ? { texture: this.white, needs: { SOFTWARE: soft.whole ? 2 : 1 } } : this.#pack(influences, geometry);
      this.#addMeshes(part, geometry, packed);
    }
  }

  /**
   * Makes shapes of fewer triangles, for pictures whose points are so large that nobody sees which are missing.
   * Where there is no graphics processor, triangles are what takes the time.
   */
  async slim() {
    for (const one of this.parts) {
      if (this.gone) return;
      const [whole] = one.shapes;
      const fewer = await sliced(lean(one.part, await this.#features(one), LEAN_MM));
      one.shapes = [one.part.index, ...fewer].map((triangles) => whole.with(triangles, this.drive));
      this.#choose();
      whole.dispose();
    }
    this.#looked = [];
    this.#choose();
  }

  /** Finds out which triangles of the shapes that are drawn can be seen from the front. */
  async #look() {
    const level = this.#level;
    const shapes = this.parts.map((one) => one.shapes[level]);
    const parts = shapes.map((shape) => this.#asked(shape));
    const posed = (pose) => {
      this.drive.set(pose);
      const head = this.#headTurn();
      const positions = shapes.map((shape) => shape.placed(this.drive, head));
      this.drive.set(this.faps);
      for (const shape of shapes) shape.soft.update(this.drive);
      return { positions, turn: (direction) => new Vector3(...direction).transformDirection(head).toArray() };
    };
    const seen = await sliced(sight(parts, posed), () => this.gone);
    shapes.forEach((shape, i) => seen && parts[i].asked && shape.sort(seen[i]));
    return true;
  }

  /** What is asked of a part: see sight.mjs. @param {Shape} shape */
  #asked({ part, geometry, influences }) {
    const { texture, alpha, double_sided } = this.model.materials[part.material] ?? {};
    const asked = !WHOLE.test(part.name);
    const clear = asked && texture && (alpha === 'blend' || alpha === 'cutout');
    const free = (v) => influences.moves[v].length || influences.turns[v].some(({ turn }) => turn < this.drive.firstHeadTurn);
    return {
      asked,
      index: part.index,
      vertices: part.vertices,
      uv: geometry.attributes.uv.array,
      double: Boolean(double_sided),
      hides: !CLEAR.includes(part.name),
      alpha: clear ? alphaOf(this.textures.get(texture).image) : null,
      free: kindOf(part.name) === 'skin' ? Uint8Array.from({ length: part.vertices }, (_, v) => (free(v) ? 1 : 0)) : null,
    };
  }

  /** What may not change when triangles go: see lean.mjs. */
  async #features({ part, influences, geometry }) {
    const places = [];
    for (const pose of LEAN_POSES) {
      places.push(deform(part, influences, this.drive.set(pose)).position);
      this.drive.set(this.faps);
      await breath();
    }
    const { normal, uv, reach } = geometry.attributes;
    const block = ({ array, itemSize }, from, count, scale) => {
      const out = new Float32Array(3 * part.vertices);
      for (let v = 0; v < part.vertices; v++)
        for (let k = 0; k < count; k++) out[3 * v + k] = scale * array[itemSize * v + from + k];
      return out;
    };
    const worth = kindOf(part.name) === 'mouth' ? WORTH_INSIDE : WORTH;
    const light = [[0, 2], [2, 2]].map(([from, count]) => block(reach, from, count, worth.reach / 255));
    const blocks = [...places, block(normal, 0, 3, worth.normal), ...light, block(uv, 0, 2, worth.texture)];
    return { blocks, places: places.length };
  }

  /** @param {number} mm how large a point of the picture is where the face is */
  set point(mm) {
    this.#fewer = LEAN_MM.filter((one) => one <= LEAN_SHARE * mm).length;
    this.#choose();
  }

  get #level() {
    return this.#sampled ? 0 : this.#fewer;
  }

  /** Until only what can be seen is drawn; undefined before it is asked. */
  get looking() {
    return this.#looked?.[this.#level];
  }

  #choose() {
    if (this.#looked) this.#looked[this.#level] ??= this.#look();
    for (const one of this.parts) {
      const shape = one.shapes[Math.min(this.#level, one.shapes.length - 1)];
      if (shape === one.shape) continue;
      for (const mesh of this.group.children) if (mesh.geometry === one.shape.geometry) mesh.geometry = shape.geometry;
      one.shape = shape;
      shape.update(this.drive);
    }
  }

  #normals(part, normals) {
    const kind = kindOf(part.name);
    if (kind === 'hair' && !THIN.includes(part.name)) return volumeNormals(part, normals);
    return kind === 'eye' ? eyeNormals(part, ...this.#eye(part)) : normals;
  }

  /** What the eyeball turns about, and the radius of its iris in those of the ball. */
  #eye({ turns, position }) {
    const { pivot } = this.model.turns[turns[0]?.turn] ?? { pivot: [0, 0, 0] };
    const radius = Math.hypot(...pivot.map((value, k) => position[k] - value));
    return [pivot, this.model.fapu.IRISD / 2 / radius];
  }

  #eyeUniforms(part) {
    const [center, iris] = this.#eye(part);
    return { eyeCenter: { value: new Vector3(...center) }, irisRadius: { value: iris } };
  }

  #skinUniforms({ moist = [0.58, 0.72], relief = 1 }) {
    return { moist: { value: new Vector2(...moist) }, grain: { value: this.grain }, relief: { value: relief } };
  }

  /** How much light reaches each vertex. */
  async #shade() {
    const posed = (pose) => {
      this.drive.set(pose);
      return this.parts.map(({ part, influences }) => deform(part, influences, this.drive));
    };
    const [standing, lit] = [SHADOW_POSE, LIT_POSE].map(posed);
    const bake = bakeOcclusion(
      this.parts.map(({ part }, i) => ({
        position: standing[i].position,
        index: part.index,
        shades: !CLEAR.includes(part.name),
        seen: lit[i],
      })),
    );
    const reaches = await sliced(bake);
    reaches.forEach((reach, i) => this.parts[i].geometry.attributes.reach.array.set(reach));
  }

  #pack(influences, geometry) {
    const packed = packInfluences(influences, this.drive);
    geometry.setAttribute('influence', new BufferAttribute(packed.vertices, 4));
    return { texture: this.#influenceTexture(packed), needs: packed.needs };
  }

  #influenceTexture({ data, width, height }) {
    const texture = new DataTexture(data, width, height, RGBAFormat, FloatType);
    texture.minFilter = texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    this.textures.set(texture, texture);
    return texture;
  }

  #addMeshes(part, geometry, influences) {
    const look = this.model.materials[part.material] ?? {};
    const kind = kindOf(part.name);
    const add = (order, options) => {
      const mesh = new Mesh(geometry, this.#material(part, look, kind, influences, options));
      mesh.frustumCulled = false;
      mesh.renderOrder = order;
      mesh.userData.fineOnly = options.fineOnly ?? false;
      this.group.add(mesh);
    };
    if (look.alpha === 'blend' && THIN.includes(part.name)) add(3, { cutoff: 0.02, opaque: 0 });
    else if (look.alpha === 'blend' || look.alpha === 'cutout') {
      add(1, { cutoff: 0.5, opaque: 1, soft: true });
      add(2, { cutoff: 0.05, opaque: 0, fineOnly: true }); // the soft edges of what the first pass has drawn
    } else add(0, { cutoff: 0, opaque: 1 });
  }

  #material(part, look, kind, influences, { cutoff, opaque, soft }) {
    const material = new ShaderMaterial({
      vertexShader: vertexGlsl,
      fragmentShader: fragmentGlsl,
      side: look.double_sided ? DoubleSide : FrontSide,
      depthWrite: opaque === 1,
      uniforms: {
        ...this.uniforms,
        influences: { value: influences.texture },
        map: { value: this.textures.get(look.texture) ?? this.white },
        tint: { value: new Vector3(...(look.color ?? [1, 1, 1])) },
        roughness: { value: look.roughness ?? 0.6 },
        specular: { value: look.specular ?? 0.3 },
        subsurface: { value: look.subsurface ?? 0 },
        ...(kind === 'skin' ? this.#skinUniforms(look) : {}),
        ...(kind === 'eye' ? this.#eyeUniforms(part) : {}),
        cutoff: { value: cutoff },
        opaque: { value: opaque },
      },
      defines: {
        KIND: KINDS[kind],
        FINE: 1,
        ...influences.needs,
        SLOTS: this.uniforms.slots.value.length,
        TURNS: Math.max(1, this.model.turns.length),
        ...(look.alpha === 'blend' || look.alpha === 'cutout' ? { HAS_ALPHA: 1 } : {}),
        ...(look.double_sided ? { TWO_SIDES: 1 } : {}),
        ...(this.software ? { STORED: 1 } : {}),
      },
    });
    if (!opaque) {
      material.transparent = true;
      blended(material);
    }
    material.userData.soft = soft;
    this.materials.push(material);
    return material;
  }

  /**
   * @param {boolean} fine @param {number} anisotropy of the textures
   * @param {boolean} sampled whether there are several samples for each pixel: then they make the edges of hair soft
   */
  setQuality(fine, anisotropy, sampled) {
    this.#sampled = sampled;
    this.#choose();
    for (const material of this.materials) {
      if (material.userData.soft) this.#soften(material, sampled);
      if (material.defines.FINE !== Number(fine)) material.needsUpdate = true;
      material.defines.FINE = Number(fine);
    }
    // Without samples hair is drawn before what it hides; with them its edges mix with what stands.
    for (const mesh of this.group.children) if (mesh.material.userData.soft) mesh.renderOrder = sampled ? 1 : -1;
    for (const mesh of this.group.children) mesh.visible = (fine && !sampled) || !mesh.userData.fineOnly;
    const linear = fine && !this.software;
    for (const texture of this.textures.values())
      if (!texture.isDataTexture) setTextureQuality(texture, linear, fine, anisotropy);
  }

  /** Hair: with several samples alpha says how many of them it covers, so that one pass does. */
  #soften(material, sampled) {
    if (material.alphaToCoverage !== sampled) material.needsUpdate = true;
    material.alphaToCoverage = sampled;
    material.uniforms.cutoff.value = sampled ? 0.15 : 0.5;
    material.uniforms.opaque.value = sampled ? 0 : 1;
    if (sampled) blended(material);
    else material.blending = NoBlending;
  }

  /** @param {Float32Array} values by FAP number */
  setFaps(values) {
    this.faps = values;
    this.drive.set(values);
    this.uniforms.headTurn.value.copy(this.#headTurn());
    for (const { shape } of this.parts) shape.update(this.drive);
    if (this.creased) {
      this.uniforms.wrinkles.value.set(...wrinklesOf(values));
      this.uniforms.folds.value.set(...foldsOf(values));
    }
    this.uniforms.opening.value = openingOf(this.model, values);
  }

  /** How the head is turned. */
  #headTurn() {
    const origin = new Vector3(...this.drive.withHead([0, 0, 0]));
    const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => new Vector3(...this.drive.withHead(axis)).sub(origin));
    return new Matrix4().makeBasis(...axes).setPosition(origin);
  }

  /** It is about to be drawn. @param {Vector3} eye from where, a direction */
  seenFrom(eye) {
    const turned = eye.clone().transformDirection(this.uniforms.headTurn.value.clone().invert());
    const front = within(this.faps, turned.toArray());
    const inside = front && !shut(this.faps);
    for (const { shape } of this.parts) shape.show(front, inside || !INSIDE.test(shape.part.name));
  }

  /** How many are drawn. */
  get triangles() {
    const drawn = ({ shape: { part, geometry } }) => Math.min(part.index.length, geometry.drawRange.count) / 3;
    return this.parts.reduce((sum, one) => sum + drawn(one), 0);
  }

  dispose() {
    this.gone = true;
    for (const { shapes } of this.parts) for (const shape of shapes) shape.dispose();
    for (const material of this.materials) material.dispose();
    for (const texture of this.textures.values()) texture.dispose();
    this.white.dispose();
    this.grain.dispose();
  }
}
