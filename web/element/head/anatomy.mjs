// SPDX-License-Identifier: MIT
// Draws over a face what is behind it: its mesh, the feature points of MPEG-4, and the vertices that one FAP moves.
import { deform } from './mesh/deform.mjs';

const SURFACES = /^(skin|eye)/; // of the head's parts
const LABEL_PX = 10;

const apart = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);

/** The vertex of a part nearest to a point. */
function nearest(parts, point) {
  let best = null;
  for (const one of parts) {
    const { position, vertices } = one.part;
    for (let v = 0; v < vertices; v++) {
      const far = apart(position.subarray(3 * v, 3 * v + 3), point);
      if (!best || far < best.far) best = { one, v, far };
    }
  }
  return best;
}

/** How far a FAP moves each vertex, as a share of the most. @returns {Float32Array|null} */
function zoneOf({ part, influences }, drive, fap) {
  const shares = new Float32Array(part.vertices);
  let most = 0;
  for (let v = 0; v < part.vertices; v++) {
    const moves = influences.moves[v].filter(({ slot }) => drive.slots[slot].fap === fap);
    const turns = influences.turns[v].filter(({ turn }) => drive.turns[turn].fap === fap);
    shares[v] = Math.max(0, ...moves.map(({ delta }) => Math.hypot(...delta)), ...turns.map(({ weight }) => weight));
    most = Math.max(most, shares[v]);
  }
  return most ? shares.map((share) => share / most) : null;
}

/** Maps places to the picture. @param {object} view of the head @param {{width: number, height: number}} size */
function projection({ camera }, { width, height }) {
  const [p, m] = [camera.projectionMatrix.elements, camera.matrixWorldInverse.elements];
  const row = (a, i, x, y, z, w) => a[i] * x + a[4 + i] * y + a[8 + i] * z + a[12 + i] * w;
  return (x, y, z) => {
    const seen = [0, 1, 2].map((i) => row(m, i, x, y, z, 1));
    const w = row(p, 3, ...seen, 1);
    return [((row(p, 0, ...seen, 1) / w + 1) / 2) * width, ((1 - row(p, 1, ...seen, 1) / w) / 2) * height];
  };
}

export class AnatomyPainter {
  #marks = { head: null, points: [] };
  #zone = { head: null, fap: 0, shares: null };

  /**
   * Draws over the face as it stands; not over pictures and avatars, which have other parts.
   * @param {CanvasRenderingContext2D} context @param {object} view of the head
   * @param {{width: number, height: number}} size of the picture
   * @param {{mesh: boolean, points: boolean, zone: number}} shows zone: a FAP, 0: none
   */
  paint(context, view, size, shows) {
    const { head } = view;
    if (!head?.drive || !head.parts?.[0]?.influences) return;
    const project = projection(view, size), eye = view.camera.position;
    const surfaces = head.parts.filter(({ part }) => SURFACES.test(part.name));
    const standing = new Map(surfaces.map((one) => [one, deform(one.part, one.influences, head.drive)]));
    const places = ({ part }, { position }) =>
      Array.from({ length: part.vertices }, (_, v) => project(...position.subarray(3 * v, 3 * v + 3)));
    const seen = new Map([...standing].map(([one, shape]) => [one, places(one, shape)]));
    for (const [one, pixels] of seen) {
      if (shows.mesh && one.part.name === 'skin') this.#paintMesh(context, one.part, pixels);
      if (shows.zone) this.#paintZone(context, this.#zoneIn(head, one, shows.zone), pixels, standing.get(one), eye);
    }
    if (shows.points) this.#paintPoints(context, head, surfaces, standing, project);
  }

  /** Triangles that face the viewer. */
  #paintMesh(context, { index }, places) {
    context.beginPath();
    for (let i = 0; i < index.length; i += 3) {
      const [a, b, c] = [places[index[i]], places[index[i + 1]], places[index[i + 2]]];
      if ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) >= 0) continue; // y is down
      context.moveTo(...a);
      context.lineTo(...b);
      context.lineTo(...c);
      context.closePath();
    }
    context.lineWidth = 0.6;
    context.strokeStyle = '#0072b2';
    context.stroke();
  }

  #zoneIn(head, one, zone) {
    if (this.#zone.head !== head || this.#zone.fap !== zone)
      this.#zone = { head, fap: zone, shares: new Map(head.parts.map((each) => [each, zoneOf(each, head.drive, zone)])) };
    return this.#zone.shares.get(one);
  }

  #paintZone(context, shares, places, { position, normal }, eye) {
    if (!shares) return;
    context.fillStyle = '#d55e00';
    for (const [v, share] of shares.entries()) {
      const facing = eye.toArray().reduce((sum, e, k) => sum + (e - position[3 * v + k]) * normal[3 * v + k], 0);
      if (!share || facing <= 0) continue;
      context.globalAlpha = 0.15 + 0.85 * share;
      context.beginPath();
      context.arc(...places[v], 1 + 1.5 * share, 0, 2 * Math.PI);
      context.fill();
    }
    context.globalAlpha = 1;
  }

  /** Each point goes with the vertex nearest to it. */
  #paintPoints(context, head, surfaces, standing, project) {
    if (this.#marks.head !== head) {
      const mark = ([name, point]) => ({ name, point, ...nearest(surfaces, point) });
      this.#marks = { head, points: Object.entries(head.model.fdp).map(mark) };
    }
    context.font = `${LABEL_PX}px system-ui, sans-serif`;
    for (const { name, point, one, v } of this.#marks.points) {
      const rest = one.part.position.subarray(3 * v, 3 * v + 3);
      const now = standing.get(one).position.subarray(3 * v, 3 * v + 3);
      const [x, y] = project(...point.map((value, k) => value + now[k] - rest[k]));
      context.beginPath();
      context.arc(x, y, 3, 0, 2 * Math.PI);
      context.fillStyle = '#009e73';
      context.strokeStyle = '#ffffff';
      context.lineWidth = 1;
      context.fill();
      context.stroke();
      context.lineWidth = 2.5;
      context.strokeText(name, x + 5, y + 3);
      context.fillStyle = '#003d2d';
      context.fillText(name, x + 5, y + 3);
    }
  }
}
