// SPDX-License-Identifier: GPL-3.0-or-later
/** Yields pictures in chronological order, from a folder or a video split by ffmpeg. Holds one at a time. */
import { spawn } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { PortraitError } from '../../../web/portrait/problem.mjs';
import { FileError } from '../import/limits.mjs';
import { flat } from '../portrait/images.mjs';

const PICTURES = /\.(jpe?g|png|webp|tiff?|gif|avif)$/i;
const LONGEST = 1280; // pixels of a video's picture
const MOST_BYTES = LONGEST * LONGEST * 3 + 64;

/** @yields {{picture: object, name: string}} @throws {FileError} */
export async function* picturesOf(folder) {
  const names = fs.readdirSync(folder).filter((name) => PICTURES.test(name)).sort(new Intl.Collator('en', { numeric: true }).compare);
  if (!names.length) throw new FileError('', 'there are no pictures in it (JPEG, PNG, WebP, TIFF, GIF, AVIF)');
  for (const [i, name] of names.entries()) {
    try {
      yield { picture: await flat(path.join(folder, name)), name, count: names.length };
    } catch (error) {
      if (error instanceof PortraitError) throw new FileError(`frame ${i + 1} (${name})`, error.message);
      throw error;
    }
  }
}

/** @yields {{picture: object, name: string}} @throws {FileError} */
export async function* framesOf(video, fps) {
  const filter = `fps=${fps},scale=w='min(${LONGEST},iw)':h='min(${LONGEST},ih)':force_original_aspect_ratio=decrease`;
  const program = spawn('ffmpeg', ['-v', 'error', '-nostdin', '-protocol_whitelist', 'file,pipe', '-i', `file:${video}`, '-an', '-sn', '-vf', filter, '-f', 'image2pipe', '-c:v', 'ppm', '-'], { stdio: ['ignore', 'pipe', 'pipe'] });
  const said = [];
  program.stderr.on('data', (data) => said.length < 20 && said.push(data));
  const ended = new Promise((resolve) => {
    program.on('error', resolve);
    program.on('close', (status) => resolve(status));
  });
  let number = 0;
  try {
    for await (const picture of portableMaps(program.stdout)) yield { picture, name: `frame ${++number}` };
    const how = await ended;
    if (how?.code === 'ENOENT') throw new FileError('', 'a video is taken apart by ffmpeg, which is not there (Debian: apt install ffmpeg); a folder with its pictures does without');
    if (how !== 0) throw new FileError(number ? `after frame ${number}` : '', `ffmpeg: ${Buffer.concat(said).toString().trim().split('\n').pop() || how}`);
    if (!number) throw new FileError('', 'there is no picture in it');
  } finally {
    program.kill();
  }
}

/** Reads consecutive PPM pictures from a stream. */
async function* portableMaps(stream) {
  let waiting = [];
  let held = 0;
  let head = null;
  for await (const chunk of stream) {
    waiting.push(chunk);
    held += chunk.length;
    while (held >= (head?.all ?? 1)) {
      const bytes = Buffer.concat(waiting);
      waiting = [bytes];
      if (!head) {
        head = headOf(bytes);
        if (!head) break; // more of it is to come
        continue;
      }
      yield pictureIn(bytes, head);
      waiting = [bytes.subarray(head.all)];
      held -= head.all;
      head = null;
    }
  }
  if (held) throw new FileError('', 'its last picture is cut off');
}

function headOf(bytes) {
  const found = /^P6\s(\d+)\s(\d+)\s255\s/.exec(bytes.subarray(0, 64).toString('latin1'));
  if (!found) {
    if (bytes.length < 64) return null;
    throw new FileError('', 'ffmpeg has sent no picture');
  }
  const [width, height] = [Number(found[1]), Number(found[2])];
  const all = found[0].length + width * height * 3;
  if (all > MOST_BYTES) throw new FileError('', `pictures of ${width} x ${height} pixels`);
  return { width, height, at: found[0].length, all };
}

function pictureIn(bytes, { width, height, at }) {
  const data = new Uint8ClampedArray(width * height * 4).fill(255);
  for (let i = 0; i < width * height; i++) for (let k = 0; k < 3; k++) data[4 * i + k] = bytes[at + 3 * i + k];
  return { width, height, data };
}
