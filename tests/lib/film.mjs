// SPDX-License-Identifier: GPL-3.0-or-later
/** Films a built-in head: pictures with known FAPs, as a camera in front of it would take them. */
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { drawHead, shadowsOf } from '../../models/tools/lib/portrait.mjs';

const sharp = createRequire(new URL('../../models/package.json', import.meta.url))('sharp');
const heads = fileURLToPath(new URL('../../build/models/heads/', import.meta.url));
export const headOf = (name) => unpack(JSON.parse(fs.readFileSync(path.join(heads, `${name}.json`), 'utf8')));

/** Natural sway of the head, about two degrees: FAPs 48 to 50 at t seconds. */
export const sway = (t) => ({ 48: Math.round(2500 * Math.sin(2.1 * t)), 49: Math.round(3500 * Math.sin(1.3 * t + 1)), 50: Math.round(1500 * Math.sin(1.7 * t + 2)) });

/**
 * @param {object} head unpacked @param {object[]} frames FAPs by number @param {string} folder for 0001.png etc.; existing files are kept
 * @param {{height?: number, tell?: (number: number) => void}} [options] height: of the whole portrait, of which only the face is drawn
 */
export async function film(head, frames, folder, { height = 360, tell = () => {} } = {}) {
  fs.mkdirSync(folder, { recursive: true });
  const width = Math.round((height * 480) / 560);
  const crop = { x: Math.round(width * 0.16), y: Math.round(height * 0.16), width: Math.round(width * 0.68), height: Math.round(height * 0.66) };
  const shadows = await shadowsOf(head, {});
  for (const [i, faps] of frames.entries()) {
    const file = path.join(folder, `${String(i + 1).padStart(4, '0')}.png`);
    if (fs.existsSync(file)) continue;
    const picture = await drawHead(head, { width, height, faps, shadows, crop });
    const raw = { width: picture.width, height: picture.height, channels: 4 };
    await sharp(Buffer.from(picture.data.buffer), { raw }).flatten({ background: '#c8c8c8' }).png({ compressionLevel: 3 }).toFile(`${file}.part`);
    fs.renameSync(`${file}.part`, file);
    tell(i + 1);
  }
}

const [LINES, SHOWN, DISTANCE] = [820, 205, 700]; // pixels; mm of height at the face; distance from the camera, mm

/** The same, drawn by the page. @param {object} page of headPage @param {string} name of the loaded head @param {number} [points] pixels per mm */
export async function shoot(page, name, frames, folder, points = 4) {
  fs.mkdirSync(folder, { recursive: true });
  const [width, height] = [660, LINES].map((side) => Math.round((side * points) / 4));
  const camera = { target: [0, -29, 0], distance: DISTANCE + 60, fov: (360 / Math.PI) * Math.atan(SHOWN / 2 / DISTANCE), width, height, level: 'high' };
  for (const [i, faps] of frames.entries()) {
    const file = path.join(folder, `${String(i + 1).padStart(4, '0')}.png`);
    if (fs.existsSync(file)) continue;
    await sharp(await page.shot(name, faps, camera)).flatten({ background: '#c8ccd0' }).png({ compressionLevel: 1 }).toFile(`${file}.part`);
    fs.renameSync(`${file}.part`, file);
  }
}
