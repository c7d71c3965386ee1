// SPDX-License-Identifier: MIT
import {
  AddEquation, BufferAttribute, CustomBlending, DataTexture, DoubleSide, FloatType, FrontSide, Group, Matrix4, Mesh,
  NearestFilter, NoBlending, OneFactor, OneMinusSrcAlphaFactor, RGBAFormat, ShaderMaterial, Vector2, Vector3, Vector4,
} from 'three';
import { faceValues } from '../face/face-mixer.mjs';
import { Drive, influencesOf, packInfluences } from './mesh/influences.mjs';
import { grainTexture, loweredBy } from './shading/grain.mjs';
import { lidsAt, lidsOf } from './shading/lids.mjs';
import { lipsOf, MOIST } from './shading/lips.mjs';
import { mouthUniforms, openingOf } from './shading/mouth-light.mjs';
import { uncovered, ambientLightOf } from './shading/ambient-light.mjs';
import { headTurnOf, Shape } from './mesh/shape.mjs';
import { shut, within } from './mesh/visibility.mjs';
import { breath } from './mesh/slices.mjs';
import { eyeNormals, kindOf, THIN, volumeNormals } from './shading/surfaces.mjs';
import { fragmentGlsl, KINDS, vertexGlsl } from './shading/shader-surface.mjs';
import { prepareOnce } from './model/cache.mjs';
import { Sway } from './mesh/sway.mjs';
import { Triangles } from './mesh/triangles.mjs';
import { agedBy, foldPlace, foldsOf, wrinklePlace, wrinklesOf } from './shading/wrinkles.mjs';
import { loadTexture, setTextureQuality, whiteTexture } from './textures.mjs';

const INSIDE = /^(teeth|tongue)/; // nothing is seen of these when the lips meet
const CUT = 0.5; // of the alpha of hair that is drawn as if it were opaque

/** Brows are drawn as if they stood some 3 mm before the skin: the lid that closes comes out below them. */
const OVER_LIDS = { polygonOffset: true, polygonOffsetFactor: 0, polygonOffsetUnits: -6000 };
/** Lashes, as if half a mm before it: on closed lids the skin would cut their roots into dashes. */
const ON_LIDS = { polygonOffset: true, polygonOffsetFactor: 0, polygonOffsetUnits: -1000 };

/** Colours come multiplied by alpha. */
function blended(material) {
  material.blending = CustomBlending;
  material.blendEquation = AddEquation;
  material.blendSrc = material.blendSrcAlpha = OneFactor;
  material.blendDst = material.blendDstAlpha = OneMinusSrcAlphaFactor;
}

/** The head model as things to draw. FAPs go in, and the graphics processor does the rest. */
export class Head {
  #triangles = new Triangles(this);

  /**
   * @param {ReturnType<import('./model/model.mjs').readModel>} model
   * @param {{software?: boolean}} [options] software: no GPU, so the CPU moves the vertices
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
    this.sway = this.drive.swaying.length ? new Sway() : null;
    this.group = new Group();
    this.parts = []; // {part, influences, geometry, shapes: the whole one, then with fewer triangles; shape: the one drawn}
    this.eyes = []; // {lids, lidUpper, lidLower: as they stand}
    this.faps = faceValues({});
    this.materials = [];
    const creases = wrinklePlace(model.fdp, model.fapu);
    this.creased = Boolean(creases);
    this.aged = agedBy(model.materials[model.parts.find(({ name }) => name === 'skin')?.material]?.relief);
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
    this.grain = grainTexture(this.software);
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
      const look = { normals: this.#normals(part, influences.normals), lowered: loweredBy(part, this.model.turns) };
      const shape = new Shape(part, influences, look, this.software ? this.drive : null);
      const { geometry, soft } = shape;
      this.parts.push({ part, influences, geometry, shape, shapes: [shape] });
      const packed = soft ? { texture: this.white, needs: { SOFTWARE: soft.whole ? 2 : 1 } } : this.#pack(influences, geometry);
      this.#addMeshes(part, geometry, packed);
    }
  }

  /** Makes shapes of fewer triangles; then, in the background, finds out what of them can be seen. */
  slim() {
    return this.#triangles.slim();
  }

  /** @param {number} mm how large a point of the picture is where the face is */
  set point(mm) {
    this.#triangles.point = mm;
  }

  /** Settles when hidden triangles are left out; undefined before that has begun. */
  get looking() {
    return this.#triangles.looking;
  }

  #normals(part, normals) {
    const kind = kindOf(part.name);
    if (kind === 'hair' && !THIN.includes(part.name)) return volumeNormals(part, normals);
    return kind === 'eye' ? eyeNormals(part, ...this.#eye(part)) : normals;
  }

  /** Returns the eyeball's pivot, and the radius of the iris in radii of the ball. */
  #eye({ turns, position }) {
    const { pivot } = this.model.turns[turns[0]?.turn] ?? { pivot: [0, 0, 0] };
    const radius = Math.hypot(...pivot.map((value, k) => position[k] - value));
    return [pivot, this.model.fapu.IRISD / 2 / radius];
  }

  #eyeUniforms(part) {
    const [center, iris] = this.#eye(part);
    const radius = Math.hypot(...center.map((value, k) => part.position[k] - value));
    const [lidUpper, lidLower] = [new Vector4(), new Vector4()].map((value) => ({ value }));
    const eye = { lids: lidsOf(this.model, center, radius), lidUpper, lidLower };
    this.eyes.push(eye);
    return { eyeCenter: { value: new Vector3(...center) }, irisRadius: { value: iris }, lidUpper, lidLower };
  }

  #skinUniforms({ moist = MOIST, relief = 1 }) {
    const { seam, size } = lipsOf(this.model.fdp);
    return {
      moist: { value: new Vector2(...moist) },
      lipSeam: { value: new Vector2(...seam) }, lipSize: { value: new Vector3(...size) },
      grain: { value: this.grain }, relief: { value: relief },
    };
  }

  /** Computes how much light reaches each vertex. */
  async #shade() {
    const reaches = await prepareOnce(this.model, 'reach', () => ambientLightOf(this));
    reaches.forEach((reach, i) => {
      const { part, geometry } = this.parts[i];
      geometry.attributes.reach.array.set(kindOf(part.name) === 'eye' ? uncovered(reach, part, this.#eye(part)[0]) : reach);
    });
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
      Object.assign(mesh.userData, { of: this.parts.at(-1), fineOnly: options.fineOnly ?? false });
      this.group.add(mesh);
    };
    if (look.alpha === 'blend' && THIN.includes(part.name)) add(3, { cutoff: 0.02, opaque: 0 });
    else if (look.alpha === 'blend' || look.alpha === 'cutout') {
      add(1, { cutoff: CUT, opaque: 1, soft: true });
      add(2, { cutoff: 0.05, ceiling: CUT, opaque: 0, fineOnly: true }); // the soft edges of what the first pass has drawn
    } else add(0, { cutoff: 0, opaque: 1 });
  }

  #material(part, look, kind, influences, { cutoff, ceiling = 2, opaque, soft }) {
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
        ceiling: { value: ceiling },
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
    if (part.name.startsWith('brows')) Object.assign(material, OVER_LIDS);
    if (part.name.startsWith('lashes')) Object.assign(material, ON_LIDS);
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
    this.#triangles.sampled = sampled;
    for (const material of this.materials) {
      if (material.userData.soft) this.#soften(material, sampled);
      if (material.defines.FINE !== Number(fine)) material.needsUpdate = true;
      material.defines.FINE = Number(fine);
    }
    // Without samples hair is drawn before what it hides; with them its edges mix with what stands.
    for (const mesh of this.group.children) if (mesh.material.userData.soft) mesh.renderOrder = sampled ? 1 : -1;
    for (const mesh of this.group.children) mesh.visible = (fine && !sampled) || !mesh.userData.fineOnly;
    const best = fine && !this.software; // there a point of a texture is what takes the time
    for (const texture of this.textures.values())
      if (!texture.isDataTexture) setTextureQuality(texture, best, best, anisotropy);
  }

  /** Chooses how hair is blended: with multisampling alpha sets its coverage, so that one pass suffices. */
  #soften(material, sampled) {
    if (material.alphaToCoverage !== sampled) material.needsUpdate = true;
    material.alphaToCoverage = sampled;
    material.uniforms.cutoff.value = sampled ? 0.15 : CUT;
    material.uniforms.opaque.value = sampled ? 0 : 1;
    if (sampled) blended(material);
    else material.blending = NoBlending;
  }

  /**
   * @param {Float32Array} values by FAP number, the breath at 0
   * @param {number|null} [seconds] on any clock, for what sways; null: nothing does
   */
  setFaps(values, seconds = null) {
    this.faps = values;
    this.drive.set(values, this.sway?.follow(values, seconds));
    for (const i of this.drive.swaying) this.uniforms.turnAxis.value[i].set(...this.drive.turns[i].axis);
    this.uniforms.headTurn.value.copy(headTurnOf(this.drive));
    for (const { shape } of this.parts) shape.update(this.drive);
    if (this.creased) {
      this.uniforms.wrinkles.value.set(...wrinklesOf(values, this.aged));
      this.uniforms.folds.value.set(...foldsOf(values));
    }
    this.uniforms.opening.value = openingOf(this.model, values);
    for (const { lids, lidUpper, lidLower } of this.eyes) {
      const { upper, lower } = lidsAt(lids, values);
      lidUpper.value.set(...upper);
      lidLower.value.set(...lower);
    }
  }

  /** Whether hair sways, also when the face does not change any more. */
  get sways() {
    return Boolean(this.sway?.moves);
  }

  /** How fast the ends of hair swing, in mm a second. */
  get swing() {
    return this.sway?.pace ?? 0;
  }

  /** It is about to be drawn. @param {Vector3} eye from where, a direction */
  seenFrom(eye) {
    const turned = eye.clone().transformDirection(this.uniforms.headTurn.value.clone().invert());
    const front = within(this.faps, turned.toArray());
    const inside = front && !shut(this.faps);
    for (const { shape } of this.parts) shape.show(front, inside || !INSIDE.test(shape.part.name));
  }

  /** The number of triangles drawn. */
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
