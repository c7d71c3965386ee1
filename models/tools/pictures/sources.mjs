// SPDX-License-Identifier: GPL-3.0-or-later
/** Reads the photographs of a set: from a folder, or from a video with the times of its poses. */
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';

const MOST = 500; // photographs
const MOST_BYTES = 1 << 28; // of a frame, as PNG
const PATIENCE_MS = 60000;

export class SourceError extends Error {}

/** @typedef {{name: string, label: string, read: () => string|Buffer}} Photograph read: returns a path or the contents */

/** Finds files named after visemes, with a trailing number if there are several. @returns {{photographs: Photograph[], strange: string[]}} */
function inFolder(folder, nameOf) {
  const files = fs.readdirSync(folder, { withFileTypes: true }).filter((one) => one.isFile() && !one.name.startsWith('.')).map(({ name }) => name).sort();
  if (files.length > MOST) throw new SourceError(`${folder}: ${files.length} files: at most ${MOST}`);
  const photographs = [];
  const strange = [];
  for (const file of files) {
    const word = path.basename(file, path.extname(file));
    const name = nameOf(word) ?? nameOf(word.replace(/[-_ ]\d+$/, ''));
    if (name) photographs.push({ name, label: file, read: () => path.join(folder, file) });
    else strange.push(file);
  }
  return { photographs, strange };
}

function frameAt(video, seconds) {
  let bytes;
  try {
    bytes = execFileSync('ffmpeg', ['-v', 'error', '-nostdin', '-protocol_whitelist', 'file', '-ss', String(seconds), '-i', `file:${video}`, '-frames:v', '1', '-f', 'image2pipe', '-c:v', 'png', '-'],
      { maxBuffer: MOST_BYTES, timeout: PATIENCE_MS, stdio: ['ignore', 'pipe', 'pipe'] });
  } catch (error) {
    if (error.code === 'ENOENT') throw new SourceError('videos are read by the program ffmpeg, which is not here');
    throw new SourceError(`${video}: ${String(error.stderr ?? error.message).trim().split('\n')[0] || error.message}`);
  }
  return bytes.length ? bytes : null;
}

function readGrid(file) {
  try {
    const bytes = fs.readFileSync(file);
    return bytes[0] === 0xfe && bytes[1] === 0xff ? bytes.swap16().toString('utf16le') : bytes[0] === 0xff && bytes[1] === 0xfe ? bytes.toString('utf16le') : bytes.toString();
  } catch (error) {
    throw new SourceError(`${file}: ${error.message}`);
  }
}

/** Times of a PRAAT TextGrid (long or short form): the middle of each interval, and each point, that is named after a viseme. Others are ignored. */
function timesOfGrid(file, text, nameOf) {
  if (!/^\ufeff?\s*File type\s*=\s*"ooTextFile/.test(text)) throw new SourceError(`${file}: no TextGrid`);
  const tokens = [...text.matchAll(/"((?:[^"]|"")*)"|(?<![\w\[])(-?\d+(?:\.\d+)?(?:e-?\d+)?)(?![\w\]])/g)].map(([, word, number]) => (word === undefined ? Number(number) : word.replaceAll('""', '"')));
  const times = [];
  let tier = null;
  let numbers = [];
  for (const token of tokens) {
    if (typeof token === 'number') numbers.push(token);
    else {
      const name = nameOf(token);
      if (name && tier === 'IntervalTier' && numbers.length >= 2) times.push({ name, seconds: (numbers.at(-2) + numbers.at(-1)) / 2 });
      else if (name && tier === 'TextTier' && numbers.length) times.push({ name, seconds: numbers.at(-1) });
      if (token === 'IntervalTier' || token === 'TextTier') tier = token;
      numbers = [];
    }
  }
  if (!times.length) throw new SourceError(`${file}: no interval is named after a viseme or pose`);
  return times;
}

function timesOf(file, nameOf) {
  if (/\.textgrid$/i.test(file)) return timesOfGrid(file, readGrid(file), nameOf);
  let times;
  try {
    times = JSON.parse(fs.readFileSync(file, 'utf8'));
  } catch (error) {
    throw new SourceError(`${file}: ${error.message}`);
  }
  if (!times || typeof times !== 'object' || Array.isArray(times)) throw new SourceError(`${file}: an object is wanted: visemes and their seconds`);
  return Object.entries(times).flatMap(([word, value]) => {
    const name = nameOf(word);
    if (!name) throw new SourceError(`${file}: ${word}: no viseme or pose is called so`);
    return [value].flat().map((seconds, i) => {
      if (!Number.isFinite(seconds) || seconds < 0) throw new SourceError(`${file}: ${word}${Array.isArray(value) ? `[${i}]` : ''}: seconds are wanted`);
      return { name, seconds };
    });
  });
}

function inVideo(video, file, nameOf) {
  const times = timesOf(file, nameOf);
  if (times.length > MOST) throw new SourceError(`${file}: ${times.length} times: at most ${MOST}`);
  const photographs = times.map(({ name, seconds }) => ({
    name, label: `${name} at ${seconds} s`,
    read() {
      const bytes = frameAt(video, seconds);
      if (!bytes) throw new SourceError(`the video has no picture at ${seconds} s`);
      return bytes;
    },
  }));
  return { photographs, strange: [] };
}

/**
 * @param {string} source @param {string|null} times a JSON file with the times of a video @param {(word: string) => string|null} nameOf maps the
 *   name of a file or time to a viseme @throws {SourceError}
 */
export function openSource(source, times, nameOf) {
  let info;
  try {
    info = fs.statSync(source);
  } catch (error) {
    throw new SourceError(`${source}: ${error.code === 'ENOENT' ? 'there is none' : error.message}`);
  }
  if (!info.isDirectory() && !times) throw new SourceError(`${source}: a folder of photographs is wanted, or a video with --times`);
  if (info.isDirectory() && times) throw new SourceError(`${source}: --times goes with a video`);
  return info.isDirectory() ? inFolder(source, nameOf) : inVideo(source, times, nameOf);
}
