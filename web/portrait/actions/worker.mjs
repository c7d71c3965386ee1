// SPDX-License-Identifier: MIT
/**
 * The web worker of the page of portraits, for work that takes seconds a picture. It gets the face at rest (`rest`), then
 * pictures of poses (`follow`), and writes what it learnt from them into a head (`give`). It makes no requests.
 */
import { PortraitError } from '../problem.mjs';
import { Follower, restsClosed } from './follow.mjs';
import { give } from './give.mjs';
import { learn } from './learn.mjs';

let follower = null;
let poses = new Map(); // number -> what follow.mjs tells

const acts = {
  rest({ json, points, view }) {
    restsClosed(view.landmarks);
    follower = new Follower(json, points, view);
    poses = new Map();
  },
  follow({ number, name, view }) {
    const pose = follower.follow(name, view);
    poses.set(number, pose);
    return { strength: pose.strength };
  },
  give({ head, numbers }) {
    const actions = learn(follower.speaker, numbers.map((number) => poses.get(number)));
    return { head: give(head, actions), actions: actions.length };
  },
};

/** @param {{id: number, act: string}} message the page's request @returns {object} the reply */
export function answer({ id, act, ...rest }) {
  try {
    return { id, answer: acts[act](rest) };
  } catch (error) {
    return { id, error: { code: error instanceof PortraitError ? error.code : null, message: error.message } };
  }
}

globalThis.self?.addEventListener?.('message', ({ data }) => self.postMessage(answer(data)));
