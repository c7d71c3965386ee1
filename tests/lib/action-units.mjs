// SPDX-License-Identifier: GPL-3.0-or-later
// What an expression does to a face, in mm by feature points, as the action units of FACS describe it (P. Ekman, W. V. Friesen, J. C. Hager, 2002).
import { pose } from '../../models/tools/lib/deform.mjs';

const LEFT = { '4.1': '4.2', '4.5': '4.6', '3.1': '3.2', '3.3': '3.4', '5.3': '5.4', '9.1': '9.2', '8.3': '8.4', '8.5': '8.6' };

/** The vertex of the skin at each of some feature points of the head (as unpacked). */
function vertices(skin, fdp, names) {
  return Object.fromEntries(names.map((name) => {
    let [best, least] = [0, Infinity];
    for (let v = 0; v < skin.position.length / 3; v++) {
      const far = Math.hypot(...fdp[name].map((x, k) => x - skin.position[3 * v + k]));
      if (far < least) [best, least] = [v, far];
    }
    return [name, best];
  }));
}

/**
 * @param {object} head as unpacked (models/tools/lib/deform.mjs)
 * @returns {(faps: ArrayLike<number>) => Record<string, number>} the movements of a face at rest in mm, both sides' mean, by the names of MOVES
 */
export function measuring(head) {
  const skin = head.parts.find(({ name }) => name === 'skin');
  const at = vertices(skin, head.fdp, [...Object.entries(LEFT).flat(), '2.1', '2.10', '2.2', '2.3', '8.1', '8.2']);
  const rest = skin.position;
  return (faps) => {
    const posed = pose(head, skin, faps);
    const by = (name, k) => posed[3 * at[name] + k] - rest[3 * at[name] + k];
    const up = (name) => (LEFT[name] ? (by(name, 1) + by(LEFT[name], 1)) / 2 : by(name, 1));
    const out = (name) => (by(name, 0) - by(LEFT[name], 0)) / 2;
    return {
      'inner brow up': up('4.1'), 'outer brow up': up('4.5'), 'brows together': -out('4.1'),
      'upper lid up': up('3.1'), 'lower lid up': up('3.3'), 'cheek up': up('5.3'),
      'nostril up': up('9.1'), 'upper lip up': up('8.5'), 'corner up': up('8.3'), 'corner out': out('8.3'),
      'chin up': up('2.10') - up('2.1'), 'lips narrower': up('8.2') - up('8.1') + up('2.2') - up('2.3'), 'jaw down': -up('2.1'),
    };
  };
}
