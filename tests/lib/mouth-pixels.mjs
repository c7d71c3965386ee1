// SPDX-License-Identifier: GPL-3.0-or-later
// Measures lip contacts and openings in pixels: draws frames with each part of the head in a flat colour and counts.
import fs from 'node:fs';
import path from 'node:path';
import './built-heads.mjs';
import { build } from './daemon.mjs';
import { headPage } from './head-page.mjs';
import { withoutHead } from './mouth-poses.mjs';
import { COLOURS, mouthCamera, paint, SPAN } from './mouth-seen.mjs';
import { kindOf, shownWithin } from './mouth.mjs';

const [SKIN, UPPER] = [0, 1];
const [WIDTH, HEIGHT] = [260, 200];
const MM = SPAN / WIDTH;
const HALF = Math.round(4 / MM); // half of the columns examined: the middle 8 mm of the mouth

/** Largest opening, mm², that counts as closed: a seam of single pixels. */
const CLOSED = 1;
/** Minimum share of the columns in which the lip must reach the teeth. */
const MET = 0.9;

/** @returns {Promise<{look: function(number[][]): Promise<object[]>, close: function}>} look: for each frame the area of the opening in mm², its
 * height in the middle in mm, and whether the lower lip reaches the edge of the upper teeth */
export async function mouthPixels(browser, model = 'mara') {
  const page = await headPage(browser);
  const head = JSON.parse(fs.readFileSync(path.join(process.env.FACCIA_MODELS ?? path.join(build, 'models'), `heads/${model}.json`)));
  await page.load('flat', head, paint);
  const camera = mouthCamera(head, 0, [WIDTH, HEIGHT]);
  return {
    look: async (frames) => (await page.counts('flat', frames.map(withoutHead), camera, Object.values(COLOURS), HALF)).map(read),
    close: () => page.page.close(),
  };
}

function read({ areas, columns }) {
  const inside = (runs) => runs.filter(([part]) => part > SKIN);
  const heights = columns.map((runs) => inside(runs).reduce((sum, [, pixels]) => sum + pixels, 0)).sort((a, b) => a - b);
  const met = columns.filter((runs) => inside(runs).every(([part]) => part === UPPER)).length;
  return { area: areas.slice(1).reduce((a, b) => a + b) * MM * MM, height: heights[heights.length >> 1] * MM, met: met >= MET * columns.length };
}

/**
 * Counts contacts and openings over the phones of a .fap.
 * @param {function(number[][]): Promise<object[]>} look
 */
export async function readPixels(look, phones, { fps, frames }) {
  const sounds = phones.filter((phone) => phone.end > phone.start && kindOf(phone)).map((phone) => ({ phone, kind: kindOf(phone), shown: shownWithin(phone, fps) }));
  const numbers = [...new Set(sounds.flatMap(({ shown }) => Array.from({ length: shown.end - shown.first }, (_, i) => Math.min(shown.first + i, frames.length - 1))))];
  const seen = new Map();
  for (let i = 0; i < numbers.length; i += 50) {
    const part = numbers.slice(i, i + 50);
    for (const [k, result] of (await look(part.map((n) => frames[n]))).entries()) seen.set(part[k], result);
  }
  const out = { lips: 0, closed: 0, teeth: 0, met: 0, open: 0, gaps: [], misses: [] };
  for (const { phone, kind, shown } of sounds) {
    const during = Array.from({ length: shown.end - shown.first }, (_, i) => seen.get(Math.min(shown.first + i, frames.length - 1)));
    const [best] = during.map(({ area }) => area).sort((a, b) => a - b);
    if (kind === 'lips') {
      out.lips++;
      out.closed += best < CLOSED;
      if (best >= CLOSED) out.misses.push({ ...phone, area: best });
    } else if (kind === 'teeth') {
      const met = during.some((frame) => frame.met);
      out.teeth++;
      out.met += met;
      if (!met) out.misses.push(phone);
    } else {
      out.open++;
      out.gaps.push({ phone, seconds: phone.end - phone.start, mm: Math.max(...during.map(({ height }) => height)) });
    }
  }
  return out;
}
