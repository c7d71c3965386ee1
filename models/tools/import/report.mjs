// SPDX-License-Identifier: GPL-3.0-or-later
/** Reports missing parts of a head and FAPs without effect. */
import { pose, unitLength } from '../lib/deform.mjs';
import { FAPS } from '../lib/faps.mjs';

const PARTS = {
  hair: 'no hair but that of the texture', eye_l: 'no gaze of the left eye', eye_r: 'no gaze of the right eye', teeth_upper: 'no teeth are seen', teeth_lower: 'no teeth are seen', tongue: 'no tongue is seen', mouth: 'the open mouth is hollow', lashes: 'no lashes', brows: 'no brows but those of the texture',
};
const TRIAL = { MNS: 300, MW: 150, ENS: 200, ES: 100, IRISD: 300, AU: 20000 };
const NEAR = 0.25; // mm

/** @param {object} head unpacked @returns {{lacks: string[], faps: string[]}} sentences */
export function reportHead(head) {
  const has = (name) => head.parts.some((part) => part.name === name);
  const lacks = Object.entries(PARTS).filter(([name]) => !has(name)).map(([name, why]) => `part ${name} is missing: ${why}`);
  const points = [...new Set(Object.values(FAPS).map(({ point }) => point))].filter((name) => name && !head.fdp[name]);
  if (points.length) lacks.push(`feature points ${points.join(', ')} are missing`);
  return { lacks, faps: Object.keys(FAPS).map(Number).flatMap((fap) => fapReport(head, fap)) };
}

function fapReport(head, fap) {
  const { name, point, direction, unit } = FAPS[fap];
  const turns = head.turns.filter((turn) => turn.fap === fap).map((turn) => turn.name);
  const acts = head.parts.some((part) => part.moves.some((move) => move.fap === fap) || part.turns.some(({ turn }) => turns.includes(turn)));
  if (!acts) return [`FAP ${fap} ${name} does nothing`];
  if (!direction || !head.fdp[point]) return [];
  for (const part of head.parts) {
    let [v, least] = [-1, NEAR];
    for (let i = 0; i < part.position.length / 3; i++) {
      const away = Math.hypot(...head.fdp[point].map((x, k) => x - part.position[3 * i + k]));
      if (away < least) [v, least] = [i, away];
    }
    if (v < 0) continue;
    const value = TRIAL[unit];
    const moved = pose(head, part, { [fap]: value });
    const along = [0, 1, 2].reduce((sum, k) => sum + (moved[3 * v + k] - part.position[3 * v + k]) * direction[k], 0);
    const share = along / (value * unitLength(head, fap));
    return Math.abs(share - 1) < 0.1 ? [] : [`FAP ${fap} ${name} moves ${point} by ${(100 * share).toFixed(0)} % of what it should`];
  }
  return [`FAP ${fap} ${name}: there is no vertex at ${point}, so how far it goes is not known`];
}
