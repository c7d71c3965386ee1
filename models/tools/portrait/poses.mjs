// SPDX-License-Identifier: GPL-3.0-or-later
/** The 19 poses of a person (poses.json) in a folder of pictures, NAME.jpg or so, and what becomes of a head by them. */
import fs from 'node:fs';
import path from 'node:path';
import { PortraitError } from '../../../web/src/portrait/problem.mjs';
import { unpack } from '../lib/deform.mjs';
import { drawHead, shadowsOf } from '../lib/portrait.mjs';
import { withOwnActions } from './own-actions.mjs';
import { mirrorOf, movesOf, restsOf } from './pose-moves.mjs';

export const POSES = JSON.parse(fs.readFileSync(new URL('poses.json', import.meta.url), 'utf8')).poses;
const PICTURES = /\.(jpe?g|png|webp|tiff?|gif|avif)$/i;
const DRAWN = { width: 320, height: 374, crop: { x: 51, y: 60, width: 218, height: 247 } }; // the face of the head in a pose
const GROUND = [200, 204, 208];

/** @returns {Map<string, string>} pose -> file @throws {PortraitError} when a picture is of no pose, or there are none */
export function posesIn(folder) {
  const out = new Map();
  for (const name of fs.readdirSync(folder).filter((file) => PICTURES.test(file)).sort()) {
    const pose = path.parse(name).name.toLowerCase().replace(/[ _]+/g, '-');
    if (!Object.hasOwn(POSES, pose)) throw new PortraitError('no_pose', `${path.join(folder, name)}: no pose is called ${pose}: ${Object.keys(POSES).join(', ')}`);
    if (out.has(pose)) throw new PortraitError('no_pose', `${path.join(folder, name)}: ${pose} is there twice`);
    out.set(pose, path.join(folder, name));
  }
  if (![...out.keys()].some((pose) => pose !== 'neutral')) throw new PortraitError('no_pose', `${folder}: there are no pictures of poses (${Object.keys(POSES).slice(1).join('.jpg, ')}.jpg)`);
  return out;
}

/** The landmarks of the head itself in a pose. */
async function drawn(head, faps, shadows, eye) {
  const { data, width, height } = await drawHead(head, { ...DRAWN, faps, shadows });
  for (let i = 0; i < data.length; i += 4) {
    const alpha = data[i + 3] / 255;
    for (let k = 0; k < 3; k++) data[i + k] = data[i + k] * alpha + GROUND[k] * (1 - alpha);
    data[i + 3] = 255;
  }
  return eye({ data, width, height });
}

/**
 * @param {object} json the head that was made of the person's neutral picture @param {import('../../../web/src/portrait/fit.mjs').Points} base
 * @param {(number[]|null)[]} places of each landmark on that head @param {Map<string, number[][]>} landmarks of the person in each pose, neutral too
 * @param {(picture: object) => Promise<number[][]>} eye
 * @returns {Promise<{head: object, amounts: Map<string, number>}>} amounts: how many times the pose of poses.json each is
 */
export async function takePoses(json, base, places, landmarks, eye) {
  const head = unpack(json);
  const shadows = await shadowsOf(head, {});
  const rest = await drawn(head, {}, shadows, eye);
  const seen = new Map();
  for (const [pose, face] of landmarks) {
    if (pose === 'neutral') continue;
    const own = await drawn(head, POSES[pose].faps, shadows, eye);
    seen.set(pose, { face: movesOf(landmarks.get('neutral'), face, base), head: movesOf(rest, own, base) });
  }
  const poses = restsOf(seen, POSES, mirrorOf(base.at));
  const made = withOwnActions(json, places, poses, POSES);
  return { head: { ...made, about: `${json.about}, with the person's own movements` }, amounts: new Map([...poses].map(([pose, { amount }]) => [pose, amount])) };
}
