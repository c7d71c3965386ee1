// SPDX-License-Identifier: GPL-3.0-or-later
/** Somebody's own ways of moving, out of pictures of poses, for a head that was made of one at rest. */
import { PortraitError } from '../../../../web/src/portrait/problem.mjs';
import { partedLips } from '../../../../web/src/portrait/fit.mjs';
import { SourceError } from '../../pictures/sources.mjs';
import { flat } from '../images.mjs';
import { Follower } from './follow.mjs';
import { give } from './give.mjs';
import { learn } from './learn.mjs';
import { LEFT_OUT, POSES } from './poses.mjs';

const PARTED = 0.1; // of the mouth's width

/** @param {string} word @returns {string|null} the pose that it names */
export function nameOf(word) {
  const name = word.toLowerCase().replace(/[ _]/g, '-');
  return Object.hasOwn(POSES, name) || Object.hasOwn(LEFT_OUT, name) ? name : null;
}

export const listOf = () => Object.entries(POSES).map(([name, { ask }]) => `  ${name.padEnd(12)} ${ask}`).join('\n');

/**
 * @param {object} head made of the face at rest @param {object} json its base @param {object} points the base's landmarks @param {{picture: object, landmarks: number[][]}} rest
 * @param {{name: string, label: string, read: Function}[]} photographs of poses (sources.mjs) @param {Function} eye
 * @returns {Promise<{head: object, taken: string[], actions: number, unfit: string[]}>} unfit: photographs that are not taken, and why
 */
export async function withOwnActions(head, json, points, rest, photographs, eye) {
  if (partedLips(rest.landmarks) > PARTED) throw new PortraitError('parted', 'poses are seen against a picture at rest with closed lips');
  const follower = new Follower(json, points, rest);
  const [poses, unfit] = [[], []];
  for (const { name, label, read } of photographs) {
    try {
      if (LEFT_OUT[name]) throw new PortraitError('left_out', LEFT_OUT[name]);
      poses.push({ ...(await follower.follow(name, eye, await flat(read()))), label });
    } catch (error) {
      if (!(error instanceof PortraitError || error instanceof SourceError)) throw error;
      unfit.push(`${label}: ${error.message}`);
    }
  }
  const actions = poses.length ? learn(follower.speaker, poses) : [];
  return { head: give(head, actions), taken: poses.map(({ label }) => label), actions: actions.length, unfit };
}
