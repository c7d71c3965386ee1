// SPDX-License-Identifier: GPL-3.0-or-later
/** Adds a person's individual movements, from pictures of poses, to a head made from a picture at rest. */
import { Follower, restsClosed } from '../../../../web/portrait/actions/follow.mjs';
import { give } from '../../../../web/portrait/actions/give.mjs';
import { learn } from '../../../../web/portrait/actions/learn.mjs';
import { LEFT_OUT, POSES, nameOf } from '../../../../web/portrait/actions/poses.mjs';
import { landmarksOf } from '../../../../web/portrait/look.mjs';
import { PortraitError } from '../../../../web/portrait/problem.mjs';
import { SourceError } from '../../pictures/sources.mjs';
import { flat } from '../images.mjs';

export { nameOf };

export const listOf = () => Object.entries(POSES).map(([name, { ask }]) => `  ${name.padEnd(12)} ${ask}`).join('\n');

/**
 * @param {object} head made from the face at rest @param {object} json its base head @param {object} points the base's landmarks @param
 *   {{picture: object, landmarks: number[][]}} rest
 * @param {{name: string, label: string, read: Function}[]} photographs of poses (sources.mjs) @param {Function} eye
 * @returns {Promise<{head: object, taken: string[], actions: number, unfit: string[]}>} unfit: rejected photographs with the reason
 */
export async function withOwnActions(head, json, points, rest, photographs, eye) {
  restsClosed(rest.landmarks);
  const follower = new Follower(json, points, rest);
  const [poses, unfit] = [[], []];
  for (const { name, label, read } of photographs) {
    try {
      if (LEFT_OUT[name]) throw new PortraitError('left_out', LEFT_OUT[name]);
      const picture = await flat(read());
      poses.push({ ...follower.follow(name, { picture, landmarks: await landmarksOf(eye, picture) }), label });
    } catch (error) {
      if (!(error instanceof PortraitError || error instanceof SourceError)) throw error;
      unfit.push(`${label}: ${error.message}`);
    }
  }
  const actions = poses.length ? learn(follower.speaker, poses) : [];
  return { head: give(head, actions), taken: poses.map(({ label }) => label), actions: actions.length, unfit };
}
