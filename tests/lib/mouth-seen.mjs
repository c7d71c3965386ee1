// SPDX-License-Identifier: GPL-3.0-or-later
// Measures what is visible in a mouth, in pictures with flat colours per part, and what must be visible in each sound.
import fs from 'node:fs';
import path from 'node:path';
import { artefacts } from './daemon.mjs';

export const COLOURS = { skin: [0, 0, 255], teeth_upper: [255, 255, 0], teeth_lower: [0, 255, 0], tongue: [255, 0, 0], mouth: [0, 0, 0] };
const [WIDTH, HEIGHT] = [360, 260];
export const SPAN = 65; // width of the picture, mm

/** Colours of the parts, for load() of a head page. */
export const paint = Object.entries(COLOURS).map(([name, colour]) => [name, ...colour]);

export const mouthCamera = (head, yaw = 0, [width, height] = [WIDTH, HEIGHT]) => ({
  yaw, target: [0, head.fdp['2.2'][1] - 4, head.fdp['2.2'][2]], distance: 600, fov: (2 * Math.atan((SPAN * height) / width / 2 / 600) * 180) / Math.PI,
  width, height, level: 'fine',
});

/**
 * Area of the opening in mm², its shares of upper teeth, lower teeth, tongue and darkness, and its width and height in mm.
 * @param {{counts: Function}} page a head page @param {string} loaded the flat head's name there @param {number[][]} frames FAPs
 */
export async function seenIn(page, loaded, head, frames, yaw) {
  const mm = SPAN / WIDTH;
  const found = await page.counts(loaded, frames, mouthCamera(head, yaw), Object.values(COLOURS), 0);
  return found.map(({ areas: [, ...areas], box }) => {
    const all = areas.reduce((sum, n) => sum + n, 0);
    const [upper, lower, tongue, dark] = areas.map((n) => (all ? n / all : 0));
    return { area: all * mm * mm, width: Math.max(0, box.right - box.left + 1) * mm, height: Math.max(0, box.bottom - box.top + 1) * mm, upper, lower, tongue, dark };
  });
}

/** The same for one face; saves the picture. @param {string} name of the picture */
export async function seen(page, loaded, head, name, faps, yaw) {
  fs.mkdirSync(artefacts, { recursive: true });
  fs.writeFileSync(path.join(artefacts, `mouth-${name}.png`), await page.shot(loaded, faps, mouthCamera(head, yaw)));
  return (await seenIn(page, loaded, head, [faps], yaw))[0];
}

/** [what, min, max]: shares of the opening; area and white in mm²; height and width in mm; flat: width / height. */
export const MUST = [
  { of: ['p', 'b', 'm'], why: 'the lips are closed: nothing is seen between them', must: [['area', 0, 2]] },
  { of: ['f', 'v'], why: 'the lower lip is at the edge of the upper incisors, which show above it (a moustache may hide some), and nothing else does',
    must: [['area', 5, 70], ['upper', 0.7, 1], ['lower', 0, 0.02]] },
  { of: ['s', 'ʃ', 'tʃ'], why: 'air goes between edges that are near each other: teeth, and hardly anything behind them',
    must: [['area', 5, 200], ['upper', 0.4, 1], ['dark', 0, 0.25]] },
  { of: ['i'], why: 'spread lips with the jaw high: mostly upper teeth', must: [['area', 40, 300], ['upper', 0.42, 1], ['dark', 0, 0.2]] },
  { of: ['e', 'ɛ', 'ɯ'], why: 'as /i/, wider open: upper teeth over the tongue', must: [['upper', 0.3, 0.9], ['tongue', 0.05, 0.6]] },
  { of: ['a', 'æ'], why: 'the edge of the upper teeth under the upper lip, the tongue flat in the floor, the lower teeth behind the lip or just seen',
    must: [['area', 120, 700], ['upper', 0.2, 0.75], ['tongue', 0.15, 0.75], ['lower', 0, 0.12]] },
  { of: ['u', 'w', 'o', 'y', 'ø'], why: 'a small round hole, of which teeth are a small part, and dim: people\'s is 0.2 to 0.45 of the lips wide',
    must: [['area', 8, 110], ['flat', 1, 5], ['white', 0, 40]] },
  { of: ['l', 'n', 't', 'ɾ', 'r'], why: 'the tip of the tongue is behind the upper incisors: seen under them as far as the lips are open',
    must: [['upper', 0.25, 1], ['dark', 0, 0.25]] },
  { of: ['k'], why: 'the back of the tongue does the work, out of sight: teeth, and no hole', must: [['upper', 0.2, 1], ['dark', 0, 0.35]] },
  { of: ['θ'], why: 'the tip of the tongue is between the teeth', must: [['tongue', 0.04, 0.6], ['upper', 0.3, 0.95]] },
  { of: ['joy'], why: 'a full smile shows the upper incisors as good as whole, the lower ones hardly', must: [['upper', 0.6, 1], ['lower', 0, 0.12], ['area', 120, 900]] },
  { of: ['fear'], why: 'the mouth is drawn wide: a slit in which both edges may be seen', must: [['flat', 2.5, 20], ['teeth', 0.4, 1]] },
  { of: ['surprise'], why: 'the jaw falls: an opening as high as it can be, the upper edge under the lip, no fangs at the sides',
    must: [['height', 9, 40], ['upper', 0, 0.6], ['lower', 0, 0.15]] },
];

/**
 * With age the upper teeth show less and the lower ones more (Vig and Brundo 1978), until the lower ones appear where the upper ones were. For
 * such heads both count together.
 * @param {string} name of a sound or an emotion @param {{upperShown: number, lowerShown: number}} figures of the head, mm at rest
 * @returns {string[]} violations
 */
export function misses(name, found, { upperShown, lowerShown }) {
  const { width, height, area, upper, lower } = found;
  const older = lowerShown > upperShown;
  const all = { ...found, flat: width / height, teeth: upper + lower, white: area * (upper + lower), ...(older ? { upper: upper + lower, lower: 0 } : {}) };
  return MUST.filter(({ of }) => of.includes(name)).flatMap(({ why, must }) =>
    must
      .filter(([what, least, most]) => !(all[what] >= least && all[what] <= most))
      .map(([what, least, most]) => `/${name}/: ${what} ${all[what].toFixed(2)}, not ${least} to ${most}: ${why}`),
  );
}

const percent = (x) => `${Math.round(100 * x)} %`;

/** A row of a Markdown table. */
export const row = (name, m) =>
  `| ${name} | ${m.area.toFixed(0)} | ${m.width.toFixed(0)} x ${m.height.toFixed(0)} | ${percent(m.upper)} | ${percent(m.lower)} | ${percent(m.tongue)} | ${percent(m.dark)} |`;
export const heading = '| | mm² | mm | upper teeth | lower teeth | tongue | dark |\n|---|---|---|---|---|---|---|';
