// SPDX-License-Identifier: GPL-3.0-or-later
/** Cuts the takes of a session after their tone, and finds words and phones in them. */
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { mouthsIn } from './mouths.mjs';
import { toTextGrid } from './textgrid.mjs';
import { findTone } from './tone.mjs';

const RATE = 16000; // Hz, of the sound that is aligned
const MOST = { takes: 20000, bytes: 16 << 20, sound: 1 << 28 };
const PATIENCE_MS = 600000;

export class TakeError extends Error {}

/** The takes that are kept, from session.json. */
export function readTakes(folder) {
  const file = path.join(folder, 'session.json');
  let session;
  try {
    if (fs.statSync(file).size > MOST.bytes) throw new TakeError(`more than ${MOST.bytes >> 20} MB`);
    session = JSON.parse(fs.readFileSync(file, 'utf8'));
  } catch (error) {
    throw new TakeError(`${file}: ${error.code === 'ENOENT' ? 'there is none; the page of the session saves it' : error.message}`);
  }
  const { lang, takes } = session ?? {};
  if (typeof lang !== 'string' || !/^[A-Za-z-]{2,20}$/.test(lang)) throw new TakeError(`${file}: lang: a language tag is wanted`);
  if (!Array.isArray(takes) || takes.length > MOST.takes) throw new TakeError(`${file}: takes: a list of at most ${MOST.takes} is wanted`);
  for (const [i, { file: name, text } = {}] of takes.entries()) {
    if (typeof name !== 'string' || !/^[\w-]+\.(webm|mp4)$/.test(name)) throw new TakeError(`${file}: takes[${i}]: file: NAME.webm or NAME.mp4 is wanted`);
    if (takes[i].fps !== undefined && !(takes[i].fps >= 1 && takes[i].fps <= 1000)) throw new TakeError(`${file}: takes[${i}]: fps: 1 to 1000 is wanted`);
    if (typeof text !== 'string') throw new TakeError(`${file}: takes[${i}]: text: what was said is wanted`);
  }
  return { lang, takes: takes.filter(({ kept }) => kept !== false) };
}

function ffmpeg(args, options = {}) {
  try {
    return execFileSync('ffmpeg', ['-v', 'error', '-nostdin', '-y', '-protocol_whitelist', 'file,pipe', ...args], { maxBuffer: MOST.sound, timeout: PATIENCE_MS, stdio: ['ignore', 'pipe', 'pipe'], ...options });
  } catch (error) {
    if (error.code === 'ENOENT') throw new TakeError("films are read by the program ffmpeg, which is not here (Debian: apt install ffmpeg)");
    throw new TakeError(String(error.stderr ?? error.message).trim().split('\n')[0] || error.message);
  }
}

/** The phones of a take, from faccia align. */
function align({ program, models }, base, lang) {
  const { status, stderr } = spawnSync(program, [...(models ? ['--models', models] : []), 'align', '--quiet', '--certain', '--lang', lang, '--text', `${base}.txt`, '--json', `${base}.json`, `${base}.wav`], { encoding: 'utf8', timeout: PATIENCE_MS });
  if (status) throw new TakeError(stderr.trim().split('\n').at(-1) || `${program} align failed`);
}

/** Cuts one take. @returns {{seconds: number, mouths: {viseme: string, seconds: number}[]}} */
export function cutTake(source, base, { text, fps = 30 }, options) {
  const pcm = ffmpeg(['-i', `file:${source}`, '-vn', '-ac', '1', '-ar', String(RATE), '-f', 's16le', '-']);
  const samples = new Int16Array(pcm.buffer.slice(pcm.byteOffset, pcm.byteOffset + (pcm.length & ~1)));
  const tone = findTone(samples, RATE);
  const from = tone ? tone.to : 0;
  const seconds = samples.length / RATE - from;
  if (!tone && !options.toneless) throw new TakeError('no tone of 1 kHz at its beginning (--no-tone: it has none)');
  if (seconds < 0.2) throw new TakeError('nothing follows the tone');
  const part = ['-i', `file:${source}`, '-ss', String(from)]; // after the input: recorders write no index to seek in
  // recorders leave pictures out when they are late: each is shown until the next, and the last until the end
  ffmpeg([...part, '-vf', `fps=${fps},tpad=stop=-1:stop_mode=clone`, '-t', String(seconds), '-c:v', 'libx264', '-crf', '14', '-preset', 'veryfast', '-pix_fmt', 'yuv420p', '-c:a', 'aac', '-b:a', '192k', `file:${base}.mp4`]);
  ffmpeg([...part, '-vn', '-ac', '1', '-ar', '48000', '-c:a', 'pcm_s16le', `file:${base}.wav`]);
  fs.writeFileSync(`${base}.txt`, `${text}\n`);
  if (options.align === false) return { seconds, mouths: [] };
  align(options, base, options.lang);
  const { phones, words } = JSON.parse(fs.readFileSync(`${base}.json`, 'utf8'));
  const tiers = [
    { name: 'words', intervals: words.map(({ start, end, text: word }) => ({ start, end, text: word })) },
    { name: 'phones', intervals: phones.map(({ start, end, ipa }) => ({ start, end, text: ipa })) },
  ];
  fs.writeFileSync(`${base}.TextGrid`, toTextGrid(Math.max(seconds, phones.at(-1)?.end ?? 0), tiers));
  return { seconds, mouths: /\s/.test(text.trim()) ? [] : mouthsIn(phones) };
}

/** Writes the picture of each mouth, as make-set.mjs takes them: p1.png, p1-2.png... */
export function writeMouths(folder, base, mouths, counts) {
  for (const { viseme, seconds } of mouths) {
    const number = (counts.get(viseme) ?? 0) + 1;
    counts.set(viseme, number);
    ffmpeg(['-ss', String(seconds), '-i', `file:${base}.mp4`, '-frames:v', '1', `file:${path.join(folder, `${viseme}${number > 1 ? `-${number}` : ''}.png`)}`]);
  }
}
