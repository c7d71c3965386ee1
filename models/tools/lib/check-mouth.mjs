// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Checks that teeth and tongue of a built head lie in their anatomical positions, measured on the meshes in the poses to which the figures apply.
 */
import { pose, unitLength } from './deform.mjs';
import { partedLips } from './anatomy.mjs';

const named = (head, name) => head.parts.find((part) => part.name === name);

/** Lips parted at rest, as FAPs. */
export function partedFaps(head, figures) {
  const { up, down, jaw } = partedLips(figures);
  const mm = unitLength(head, 4);
  const both = (faps, value) => faps.map((f) => [f, value / mm]);
  return Object.fromEntries([
    [3, jaw / mm],
    ...both([4, 8, 9, 51, 55, 56], -up),
    ...both([5, 10, 11, 52, 57, 58], -down),
  ]);
}

/** y of the edge and z of the front of the two middle incisors. */
function incisors(head, name, faps = {}) {
  const part = named(head, name);
  const p = pose(head, part, faps);
  const sign = name === 'teeth_upper' ? -1 : 1;
  let edge = -Infinity;
  for (let i = 0; i < p.length; i += 3)
    if (Math.abs(p[i]) < 4 && part.position[i + 2] > head.fdp['2.2'][2] - 14) edge = Math.max(edge, sign * p[i + 1]);
  let front = -Infinity;
  for (let i = 0; i < p.length; i += 3)
    if (Math.abs(p[i]) < 4 && Math.abs(sign * p[i + 1] - edge) < 1.2) front = Math.max(front, p[i + 2]);
  return { edge: sign * edge, front };
}

/** Overbite and overjet of the closed jaws, 2 mm each in a usual bite; up to 4 are called normal. */
export function checkBite(head) {
  const upper = incisors(head, 'teeth_upper'),
    lower = incisors(head, 'teeth_lower');
  const out = [];
  for (const [name, mm] of [
    ['overbite', lower.edge - upper.edge],
    ['overjet', upper.front - lower.front],
  ])
    if (mm < 1 || mm > 4) out.push(`the ${name} is ${mm.toFixed(1)} mm, not about 2`);
  return out;
}

/**
 * With the lips parted at rest people show 0 to 5 mm of their upper incisors and 0 to 3.5 of the lower ones, a youth more of
 * the upper, an old person more of the lower. `figures`: values of the recipe, which then replace these ranges.
 */
export function checkTeethShown(head, figures = head.mouth) {
  if (!figures) return [];
  const faps = partedFaps(head, figures);
  const line = (head.fdp['2.2'][1] + head.fdp['2.3'][1]) / 2;
  const { up, down } = partedLips(figures);
  const shown = {
    upper: line + up - incisors(head, 'teeth_upper', faps).edge,
    lower: incisors(head, 'teeth_lower', faps).edge - (line - down),
  };
  return ['upper', 'lower']
    .filter((jaw) => Math.abs(shown[jaw] - figures[`${jaw}Shown`]) > 0.6)
    .map((jaw) => `${shown[jaw].toFixed(1)} mm of the ${jaw} incisors show at rest, not ${figures[`${jaw}Shown`].toFixed(1)}`);
}

/** The arch fills the mouth, but leaves room beside it: the front teeth take 60 to 80 % of the mouth's width. */
export function checkArch(head) {
  const out = [];
  for (const name of ['teeth_upper', 'teeth_lower']) {
    const { position: p } = named(head, name);
    const { front } = incisors(head, name);
    let side = 0;
    // The canines end some 10 mm behind the front.
    for (let i = 0; i < p.length; i += 3) if (p[i + 2] > front - 10) side = Math.max(side, Math.abs(p[i]));
    const share = (2 * side) / head.fapu.MW;
    if (share < 0.6 || share > 0.95) out.push(`${name}: the front teeth are ${(100 * share).toFixed(0)} % of the mouth's width`);
  }
  return out;
}

/** The tongue's tip rests behind the upper incisors, neither in front of them nor deep in the mouth. */
export function checkTongue(head) {
  const { edge, front } = incisors(head, 'teeth_upper');
  const [, y, z] = head.fdp['6.1'];
  const out = [];
  if (front - z < 3 || front - z > 12) out.push(`the tip of the tongue rests ${(front - z).toFixed(1)} mm behind the upper incisors`);
  if (Math.abs(y - edge) > 6) out.push(`the tip of the tongue rests ${(y - edge).toFixed(1)} mm above the upper incisors' edge`);
  return out;
}
