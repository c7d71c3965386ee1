// SPDX-License-Identifier: MIT
/** Writes a person's own actions into a head: further moves of the skin and of what is attached to it. */
import { readModel } from '../../element/head/model/model.mjs';
import { packNumbers, packVectors } from '../pack.mjs';

const HANGING = ['brows', 'beard', 'mouth'];
const NEAR = 12; // mm from the skin at which a part is no longer attached; nearer parts follow in proportion
const WORTH = 0.03; // mm for a mm: less is not seen, and costs bytes

/** For each vertex of a part the nearest of the skin, and how far it goes along. */
function hangsOn({ position }, skin) {
  return Array.from({ length: position.length / 3 }, (_, v) => {
    let [best, least] = [-1, NEAR];
    for (let u = 0; u < skin.position.length; u += 3) {
      const far = Math.hypot(position[3 * v] - skin.position[u], position[3 * v + 1] - skin.position[u + 1],
        position[3 * v + 2] - skin.position[u + 2]);
      if (far < least) [least, best] = [far, u / 3];
    }
    return best < 0 ? null : { on: best, share: 1 - (least / NEAR) ** 2 };
  });
}

function moveOf({ fap, sign, own }, from, count) {
  const goes = (v) => [0, 1, 2].map((k) => (from(v) ? sign * from(v).share * own[3 * from(v).on + k] : 0));
  const vertices = Array.from({ length: count }, (_, v) => v).filter((v) => Math.hypot(...goes(v)) > WORTH);
  const deltas = vertices.flatMap(goes);
  const which = sign > 0 ? 'positive' : 'negative';
  return vertices.length ? [{ fap, sign: which, vertices: packNumbers(vertices), deltas: packVectors(deltas) }] : [];
}

/**
 * @param {object} json a head on the base's meshes
 * @param {object[]} actions of learn.mjs
 * @returns {object} the head with them
 */
export function give(json, actions) {
  const { parts } = readModel(json);
  const skin = parts.find(({ name }) => name === 'skin');
  const more = parts.map((part) => {
    if (part === skin) return actions.flatMap((action) => moveOf(action, (v) => ({ on: v, share: 1 }), part.vertices));
    if (!HANGING.some((name) => part.name.startsWith(name))) return [];
    const on = hangsOn(part, skin);
    return actions.flatMap((action) => moveOf(action, (v) => on[v], part.vertices));
  });
  const moved = json.parts.map((part, i) => (more[i].length ? { ...part, moves: [...part.moves, ...more[i]] } : part));
  return { ...json, parts: moved };
}
