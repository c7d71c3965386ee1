// SPDX-License-Identifier: MIT
// The mapping file of an avatar with unknown names of shapes: protocol/schema/avatar-map.json.
import { BONE_NAMES, SHAPES } from './names.mjs';
import { AvatarProblem } from './problem.mjs';

const isObject = (value) => value !== null && typeof value === 'object' && !Array.isArray(value);

/**
 * @param {Uint8Array|null} bytes of the file
 * @returns {{shapes: Map<string, Record<string, number>>, bones: Record<string, string>, others: boolean}} of each shape the
 *   morph targets by name, with their weights; others: whether targets that are not named are known by their own names
 */
export function readMap(bytes) {
  const out = { shapes: new Map(), bones: {}, others: true };
  if (!bytes) return out;
  const wrong = (place, what) => new AvatarProblem('bad-map', `avatar-map, ${place}: ${what}`);
  let json;
  try {
    json = JSON.parse(new TextDecoder().decode(bytes));
  } catch (error) {
    throw wrong('the file', error.message);
  }
  if (json?.format !== 'faccia-avatar-map' || json.version !== 1) throw wrong('format', 'it is no faccia-avatar-map of version 1');
  const { shapes = {}, bones = {}, others = true } = json;
  if (!isObject(shapes)) throw wrong('shapes', 'must be an object');
  if (!isObject(bones)) throw wrong('bones', 'must be an object');
  for (const [name, targets] of Object.entries(shapes)) {
    const place = `shapes.${name}`;
    if (!SHAPES.includes(name)) throw wrong(place, 'there is no such shape');
    const weights = typeof targets === 'string' ? { [targets]: 1 } : targets;
    if (!isObject(weights) || !Object.values(weights).every(Number.isFinite)) throw wrong(place, 'must name a morph target, or several with their weights');
    out.shapes.set(name, weights);
  }
  for (const [name, bone] of Object.entries(bones)) {
    if (!BONE_NAMES.includes(name)) throw wrong(`bones.${name}`, 'there is no such bone');
    if (typeof bone !== 'string') throw wrong(`bones.${name}`, 'must be the name of a node');
  }
  return { ...out, bones, others: others !== false };
}
