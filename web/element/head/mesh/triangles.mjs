// SPDX-License-Identifier: MIT
// Chooses the triangles to draw: fewer when the picture is small; only visible ones without a GPU.
import { Vector3 } from 'three';
import { deform } from './deform.mjs';
import { simplify } from './simplify.mjs';
import { alphaOfPart } from './opacity.mjs';
import { SIMPLIFY_POSES } from './poses.mjs';
import { headTurnOf } from './shape.mjs';
import { visibleTriangles } from './visibility.mjs';
import { breath, sliced } from './slices.mjs';
import { strands } from './strands.mjs';
import { CLEAR, kindOf, THIN } from '../shading/surfaces.mjs';
import { prepareOnce } from '../model/cache.mjs';
import { BREATH } from '../model/model.mjs';

const WHOLE = /^(eye|brows|lashes|glasses|tongue)/; // they turn by themselves, or hide nothing: all of them is drawn
const TONGUE = /^tongue/; // hides nothing for good: where it lies in the poses looked at, the mouth is open behind a raised one
const SIMPLIFY_MM = [0.3, 0.42]; // error of a vertex at each level
const SIMPLIFY_SHARE = 0.55; // largest such error, in pixels
/** Weights, in mm, of a change of the normal, of the share of light, and of the texture coordinates. */
const WORTH = { normal: 2.5, reach: 2, texture: 100 };
const WORTH_INSIDE = { normal: 0.8, reach: 0, texture: 30 }; // of the mouth, where all is small and in the shade

const STRAND = 6; // times that error: narrower hair is left out

/** Selects the shape of each part that is drawn. */
export class Triangles {
  #fewer = 0; // which of the shapes is drawn
  #looked = null; // for each number of triangles, a promise: see #look
  #sampled = false; // then it is the whole one: with fewer triangles single samples are dark, here and there

  /** @param {import('../head.mjs').Head} head whose parts are chosen from */
  constructor(head) {
    this.head = head;
  }

  /**
   * Makes shapes with fewer triangles, for small pictures in which the difference is invisible. Without a GPU the number of
   * triangles decides the frame rate.
   */
  async slim() {
    for (const [i, one] of this.head.parts.entries()) {
      if (this.head.gone) return;
      const [whole] = one.shapes;
      const fewer = await prepareOnce(this.head.model, `fewer ${i}`, async () =>
        this.#lines(one.part, await sliced(simplify(one.part, await this.#features(one), SIMPLIFY_MM))));
      one.shapes = [one.part.index, ...fewer].map((triangles) => whole.with(triangles, this.head.drive));
      this.choose();
      whole.dispose();
    }
    this.#looked = [];
    this.choose();
  }

  /** Drops strands of hair that are narrower than a pixel. @param {Uint16Array[]} fewer */
  #lines(part, fewer) {
    if (kindOf(part.name) !== 'hair' || THIN.includes(part.name)) return fewer;
    return fewer.map((triangles, level) => {
      const loose = strands(part, STRAND * SIMPLIFY_MM[level]);
      return triangles.filter((_, i) => !loose[triangles[i - (i % 3)]]);
    });
  }

  /** Finds out which triangles of the shapes that are drawn can be seen from the front. */
  async #look() {
    const level = this.#level;
    const shapes = this.head.parts.map((one) => one.shapes[level]);
    const parts = shapes.map((shape) => this.#asked(shape));
    const posed = (pose) => {
      this.head.drive.set(pose);
      const head = headTurnOf(this.head.drive);
      const positions = shapes.map((shape) => shape.placed(this.head.drive, head));
      this.head.drive.set(this.head.faps);
      for (const shape of shapes) shape.soft.update(this.head.drive);
      return { positions, turn: (direction) => new Vector3(...direction).transformDirection(head).toArray() };
    };
    const seen = await sliced(visibleTriangles(parts, posed), () => this.head.gone);
    shapes.forEach((shape, i) => seen && parts[i].asked && shape.sort(seen[i]));
    shapes.forEach((shape, i) => seen && parts[i].alpha && !THIN.includes(shape.part.name) && shape.divide(parts[i].alpha));
    this.choose();
    return true;
  }

  /** Makes the query of a part: see visibility.mjs. @param {Shape} shape */
  #asked({ part, geometry, influences }) {
    const { double_sided } = this.head.model.materials[part.material] ?? {};
    const asked = !WHOLE.test(part.name);
    const { firstHeadTurn, slots } = this.head.drive;
    const moves = ({ slot }) => slots[slot].fap !== BREATH;
    const free = (v) => influences.moves[v].some(moves) || influences.turns[v].some(({ turn }) => turn < firstHeadTurn);
    return {
      asked,
      index: part.index,
      vertices: part.vertices,
      uv: geometry.attributes.uv.array,
      double: Boolean(double_sided),
      hides: !CLEAR.includes(part.name) && !TONGUE.test(part.name),
      alpha: asked ? alphaOfPart(this.head, part) : null,
      free: kindOf(part.name) === 'skin' ? Uint8Array.from({ length: part.vertices }, (_, v) => (free(v) ? 1 : 0)) : null,
    };
  }

  /** Collects the features that simplification must keep: see simplify.mjs. */
  async #features({ part, influences, geometry }) {
    const places = [];
    for (const pose of SIMPLIFY_POSES) {
      places.push(deform(part, influences, this.head.drive.set(pose)).position);
      this.head.drive.set(this.head.faps);
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
    this.#fewer = SIMPLIFY_MM.filter((one) => one <= SIMPLIFY_SHARE * mm).length;
    this.choose();
  }

  /** @param {boolean} on whether there are several samples for each pixel */
  set sampled(on) {
    this.#sampled = on;
    this.choose();
  }

  get #level() {
    return this.#sampled ? 0 : this.#fewer;
  }

  /** Settles when hidden triangles are left out; undefined before that has begun. */
  get looking() {
    return this.#looked?.[this.#level];
  }

  /** Switches to the shapes that fit the current view. */
  choose() {
    if (this.#looked) this.#looked[this.#level] ??= this.#look();
    for (const one of this.head.parts) {
      const shape = one.shapes[Math.min(this.#level, one.shapes.length - 1)];
      if (shape !== one.shape) shape.update(this.head.drive);
      one.shape = shape;
      const fringe = shape.fringe?.geometry ?? shape.geometry;
      for (const mesh of this.head.group.children)
        if (mesh.userData.of === one) mesh.geometry = mesh.userData.fineOnly ? fringe : shape.geometry;
    }
  }
}
