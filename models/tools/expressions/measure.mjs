// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * What an expression does to a face, in mm at feature points: the movements that the action units of FACS describe (P. Ekman, W. V. Friesen,
 * J. C. Hager, Facial Action Coding System, 2002).
 */
import { pose } from '../lib/deform.mjs';
import { nearestVertex } from '../lib/mesh.mjs';

const LEFT = { '4.1': '4.2', '4.5': '4.6', '3.1': '3.2', '3.3': '3.4', '5.3': '5.4', '9.1': '9.2', '8.3': '8.4', '8.5': '8.6' };
const TURNS = [48, 49, 50]; // FAPs of the head, which move everything alike
const DEGREE = 1745; // FAP values

/**
 * @param {object} head as unpacked (lib/deform.mjs)
 * @returns {(faps: ArrayLike<number>) => Record<string, number>} the movements of a face at rest: mm, both sides' mean; of head and eyes degrees
 */
export function measuring(head) {
  const skin = head.parts.find(({ name }) => name === 'skin');
  const points = [...Object.entries(LEFT).flat(), '2.1', '2.10', '2.2', '2.3', '8.1', '8.2'];
  const at = Object.fromEntries(points.map((name) => [name, nearestVertex(skin, head.fdp[name])])); // vertices of the skin
  const rest = skin.position;
  return (faps) => {
    const still = Array.from(faps, (value, fap) => (TURNS.includes(fap) ? 0 : value));
    const posed = pose(head, skin, still);
    const by = (name, k) => posed[3 * at[name] + k] - rest[3 * at[name] + k];
    const up = (name) => (LEFT[name] ? (by(name, 1) + by(LEFT[name], 1)) / 2 : by(name, 1));
    const out = (name) => (by(name, 0) - by(LEFT[name], 0)) / 2;
    const turned = (...numbers) => numbers.reduce((sum, fap) => sum + (faps[fap] ?? 0), 0) / numbers.length / DEGREE;
    return {
      'inner brow up': up('4.1'), 'outer brow up': up('4.5'), 'brows together': -out('4.1'),
      'upper lid up': up('3.1'), 'lower lid up': up('3.3'), 'cheek up': up('5.3'),
      'nostril up': up('9.1'), 'upper lip up': up('8.5'), 'corner up': up('8.3'), 'corner out': out('8.3'),
      'chin up': up('2.10') - up('2.1'), 'lips narrower': up('8.2') - up('8.1') + up('2.2') - up('2.3'),
      'lips apart': up('2.2') - up('2.3'), 'jaw down': -up('2.1'),
      'head down': turned(48), 'head turned': Math.abs(turned(49)), 'head tilted': Math.abs(turned(50)),
      'gaze down': turned(25, 26) + turned(48), // the FAPs count from the head
    };
  };
}
