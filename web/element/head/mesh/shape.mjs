// SPDX-License-Identifier: MIT
import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Matrix4, Vector3 } from 'three';
import { fibres, kindOf, outsideFirst, THIN } from '../shading/surfaces.mjs';
import { SoftwareDeform } from './deform.mjs';
import { neighboursFirst, renumbered } from './simplify.mjs';

/** The values of some vertices, one after the other. */
function gather(values, each, kept) {
  const out = new values.constructor(each * kept.length);
  kept.forEach((v, i) => {
    for (let k = 0; k < each; k++) out[each * i + k] = values[each * v + k];
  });
  return out;
}

const hides = ({ name }) => kindOf(name) === 'hair' && !THIN.includes(name);

/** The drawable form of a part: its geometry, and its deformation on machines without a GPU. */
export class Shape {
  /**
   * @param {import('../model/model.mjs').Part} part @param {ReturnType<import('./influences.mjs').influencesOf>} influences
   * @param {{normals: Float32Array, fibre?: Float32Array, reach?: Uint8Array, lowered?: Float32Array}} look of each vertex:
   *   its normal as drawn, the direction of hair, how much light reaches it; of skin how far it comes down with the lids
   * @param {import('./influences.mjs').Drive|null} drive null: the graphics processor moves it
   * @param {boolean} [whole] of SoftwareDeform
   */
  constructor(part, influences, { normals, fibre, reach, lowered }, drive, whole) {
    Object.assign(this, { part, influences, front: Infinity, fringe: null });
    const hair = kindOf(part.name) === 'hair';
    const soft = (this.soft = drive && new SoftwareDeform(part, influences, normals, drive, whole));
    const geometry = (this.geometry = new BufferGeometry());
    const set = (name, values, each, shares) => geometry.setAttribute(name, new BufferAttribute(values, each, shares));
    set('position', soft ? soft.position : part.position, 3);
    set('normal', soft ? soft.normal : normals, 3);
    set('uv', part.uv ? part.uv.map((value, i) => (i % 2 ? 1 - value : value)) : new Float32Array(2 * part.vertices), 2);
    if (soft && !hair) set('rest', part.position, 3);
    if (lowered) set('lowered', lowered, 1);
    if (hair) set('fibre', fibre ?? fibres(part), 3);
    set('reach', reach ?? new Uint8Array(4 * part.vertices).fill(255), 4, true);
    geometry.setIndex(new BufferAttribute(hides(part) && !drive ? outsideFirst(part, part.index) : part.index, 1));
    if (soft?.acts) for (const name of ['position', 'normal']) geometry.attributes[name].setUsage(DynamicDrawUsage);
  }

  /** Moves it, where no graphics processor does. @param {import('./influences.mjs').Drive} drive with the FAPs set */
  update(drive) {
    if (!this.soft?.acts || !this.soft.update(drive)) return;
    for (const name of ['position', 'normal']) this.geometry.attributes[name].needsUpdate = true;
  }

  /**
   * Computes the positions of its vertices in a pose.
   * @param {import('./influences.mjs').Drive} drive with that set @param {import('three').Matrix4} head how it turns the head
   */
  placed(drive, head) {
    if (!this.soft) return this.part.position;
    this.soft.update(drive);
    const position = this.soft.position.slice();
    if (!this.soft.whole) return position;
    const p = new Vector3();
    for (let i = 0; i < position.length; i += 3) p.fromArray(position, i).applyMatrix4(head).toArray(position, i);
    return position;
  }

  /** @param {Uint8Array} seen not 0 for triangles that can be seen from the front: they come first from now on */
  sort(seen) {
    const { index } = this.part;
    const [front, rest] = [1, 0].map((kind) => index.filter((_, i) => Number(seen[(i - (i % 3)) / 3] > 0) === kind));
    index.set(front);
    index.set(rest, front.length);
    this.front = front.length;
    this.geometry.index.needsUpdate = true;
  }

  /** Makes a geometry of what ends softly. @param {(u: number, v: number) => number} alpha of its texture */
  divide(alpha) {
    const { index, before } = fringeOf(this.part.index, this.geometry.attributes.uv.array, alpha);
    const geometry = new BufferGeometry();
    for (const [name, attribute] of Object.entries(this.geometry.attributes)) geometry.setAttribute(name, attribute);
    geometry.setIndex(new BufferAttribute(index, 1));
    this.fringe = { geometry, front: before(this.front) };
  }

  /** @param {boolean} front whether it is seen from there @param {boolean} any whether anything of it is seen, then */
  show(front, any) {
    const sorted = this.front < Infinity;
    const of = (count) => (front && sorted ? Number(any) * count : Infinity);
    this.geometry.setDrawRange(0, of(this.front));
    this.fringe?.geometry.setDrawRange(0, of(this.fringe.front));
  }

  /**
   * Makes a copy with these triangles only, in the order that draws fastest.
   * @param {Uint16Array} triangles of its vertices @param {import('./influences.mjs').Drive} drive @returns {Shape}
   */
  with(triangles, drive) {
    const { part, influences, geometry } = this;
    const ordered = neighboursFirst(triangles, part.vertices);
    const { index, kept } = renumbered(hides(part) ? outsideFirst(part, ordered) : ordered);
    const pick = (list) => Array.from(kept, (v) => list[v]);
    const fewer = {
      ...part, index, vertices: kept.length, smooth: null,
      position: gather(part.position, 3, kept),
      uv: part.uv && gather(part.uv, 2, kept),
    };
    const { rest } = this.soft;
    return new Shape(
      fewer,
      { normals: gather(influences.normals, 3, kept), moves: pick(influences.moves), turns: pick(influences.turns) },
      {
        normals: gather(rest.normal, 3, kept),
        fibre: geometry.attributes.fibre && gather(geometry.attributes.fibre.array, 3, kept),
        reach: gather(geometry.attributes.reach.array, 4, kept),
        lowered: geometry.attributes.lowered && gather(geometry.attributes.lowered.array, 1, kept),
      },
      drive,
      this.soft.whole,
    );
  }

  dispose() {
    this.geometry.dispose();
    this.fringe?.geometry.dispose();
  }
}

/** Returns the head's rotation. @param {import('./influences.mjs').Drive} drive @returns {Matrix4} */
export function headTurnOf(drive) {
  const origin = new Vector3(...drive.withHead([0, 0, 0]));
  const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => new Vector3(...drive.withHead(axis)).sub(origin));
  return new Matrix4().makeBasis(...axes).setPosition(origin);
}

const STEPS = 6; // along each side of a triangle, at which its alpha is looked at
const [CLEAR, FULL] = [10, 240]; // of 255: what is all below or all above has no soft end

/**
 * Finds the triangles with soft ends: hair is drawn as opaque first, then its ends are blended over it.
 * @param {Uint16Array} index @param {Float32Array} uv of each vertex @param {(u: number, v: number) => number} alpha 0 to 255
 * @returns {{index: Uint16Array, before: (count: number) => number}} these triangles in order; before: the number of their
 *   indices among the first `count` of all
 */
export function fringeOf(index, uv, alpha) {
  const kept = [];
  const places = [];
  for (let i = 0; i < index.length; i += 3) {
    const corners = [0, 1, 2].map((k) => [uv[2 * index[i + k]], uv[2 * index[i + k] + 1]]);
    if (!soft(corners, alpha)) continue;
    kept.push(index[i], index[i + 1], index[i + 2]);
    places.push(i);
  }
  return { index: Uint16Array.from(kept), before: (count) => 3 * places.filter((place) => place < count).length };
}

function soft([a, b, c], alpha) {
  let [clear, full] = [true, true];
  for (let i = 0; i <= STEPS; i++)
    for (let j = 0; i + j <= STEPS; j++) {
      const [s, t] = [i / STEPS, j / STEPS];
      const [u, v] = [0, 1].map((k) => a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
      const found = alpha(u, v);
      clear &&= found < CLEAR;
      full &&= found > FULL;
      if (!clear && !full) return true;
    }
  return false;
}
