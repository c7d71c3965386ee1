#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** Measures how a person's lips and jaw move, in mm: implements `faccia head lips`. See README.md. */
import fs from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { FileError, MOST } from '../import/limits.mjs';
import { filled, fromRest, LONGEST_GAP, smoothed, toCsv } from './curves.mjs';
import { fapsOfMarkers, toFap } from './fap-tracks.mjs';
import { allNumbersOf, readMap, rowsOfMarkers } from './markers.mjs';
import { readC3d } from './read-c3d.mjs';
import { readCsv, readTrc } from './read-table.mjs';
import { inSpace, readCameras } from './stereo.mjs';

const USAGE = `Usage: faccia head lips FOLDER --fps N [-o CURVES.csv]
       faccia head lips VIDEO [--fps N] [-o CURVES.csv]
       faccia head lips TRACKS.(c3d|trc|csv) [--markers MAP.json] [-o CURVES.csv] [--fap FACE.fap]
       faccia head lips LEFT.csv RIGHT.csv --cameras CAMERAS.json [--markers MAP.json] [-o CURVES.csv] [--fap FACE.fap]
Tells how a person who reads moves lips and jaw: the six articulatory parameters in mm, as 'faccia fit' and 'faccia eval --recording' take them. From
pictures of a face (a folder of them in the order of their names, or a video, for which ffmpeg is wanted), or from the tracks of markers on it, in
space or in the pictures of two cameras.

  -o, --output FILE     the curves (standard output)
      --fps N           pictures in a second (of a video: 25 are taken)
      --markers FILE    JSON: the name or number of each marker: nose, upperLip, leftCorner, rightCorner, lowerLip, chin, leftEar, rightEar, and
                        any other at a feature point of MPEG-4, such as 4.1
      --cameras FILE    JSON: {"cameras": [{"projection": [[4 numbers], [4], [4]]}, {...}], "unit": "mm"}; the tracks are NAME_x, NAME_y in pixels
      --fap FILE        the face of all markers as FAPs, with the turns of the head
      --fapu LIST       its lengths in mm: MW=52,ES=62,ENS=50,MNS=19 (MW measured at rest, the others in proportion)
      --tilt DEGREES    how far the plane of nose and ear lobes falls towards the nose (0: opening is measured square to it)
      --unit UNIT       of a table: mm, cm, dm, m, in (mm)
      --rest FROM-TO    seconds in which the closed mouth rests (the first 0.2; in pictures, if
                        the lips are apart there, the longest time in which they are closed)
      --all             also the thesis's other four parameters (of markers), and the velocity of each in mm/s
      --smooth MS       standard deviation of a Gaussian over time (0)
      --iris MM         how wide the person's iris is (11.7, an adult's)
      --pupils MM       or, better, how far the pupils are from each other
      --like HEAD       of ours, whose skin the person's is taken to move like (pictures; mara)
  -h, --help            print this and exit
Exit status: 0 done, 1 failed, 2 wrong usage.
`;

const text = { type: 'string' };
const OPTIONS = {
  output: { ...text, short: 'o' }, fps: text, markers: text, tilt: text, cameras: text, fap: text, fapu: text, unit: text, rest: text, smooth: text, iris: text, pupils: text, like: text, all: { type: 'boolean' }, help: { type: 'boolean', short: 'h' },
};
const REST = [0, 0.2]; // s
const VIDEO_FPS = 25;
const READERS = { '.c3d': readC3d, '.trc': (bytes) => readTrc(bytes.toString()), '.csv': (bytes, options) => readCsv(bytes.toString(), options) };

class Usage extends Error {}

function number(values, name, [least, most]) {
  if (values[name] === undefined) return undefined;
  const value = Number(values[name]);
  if (!(values[name].trim() && value >= least && value <= most)) throw new Usage(`--${name} ${values[name]}: ${least} to ${most} is wanted`);
  return value;
}

function choices(argv) {
  let parsed;
  try {
    parsed = parseArgs({ args: argv, options: OPTIONS, allowPositionals: true });
  } catch (error) {
    throw new Usage(error.message);
  }
  const { values, positionals } = parsed;
  const rest = values.rest?.split('-').map(Number);
  if (rest && !(rest[0] >= 0 && rest[1] > rest[0])) throw new Usage(`--rest ${values.rest}: FROM-TO in seconds is wanted`);
  return {
    ...values, files: positionals, rest,
    fps: number(values, 'fps', [1, 1000]), smooth: number(values, 'smooth', [0, 1000]), iris: number(values, 'iris', [5, 20]), pupils: number(values, 'pupils', [30, 90]),
    tilt: ((number(values, 'tilt', [-60, 60]) ?? 0) * Math.PI) / 180,
  };
}

function readFile(file, choices) {
  if (fs.statSync(file).size > MOST.bytes) throw new FileError('', `more than ${MOST.bytes >> 20} MB`);
  return READERS[path.extname(file).toLowerCase()](fs.readFileSync(file), choices);
}

/** @returns {{tracks: import('./tracks.mjs').Tracks, map: object|null}} */
function readTracks(files, options) {
  const map = options.markers ? within(options.markers, () => readMap(fs.readFileSync(options.markers, 'utf8'))) : null;
  if (options.cameras === undefined) return { tracks: readFile(files[0], { fps: options.fps, unit: options.unit }), map };
  const cameras = within(options.cameras, () => readCameras(fs.readFileSync(options.cameras, 'utf8')));
  return { tracks: inSpace(files.map((file) => within(file, () => readFile(file, { fps: options.fps, flat: true }))), cameras), map };
}

/** ES=62,MW=50 @returns {Object<string, number>} */
function lengthsOf(list = '') {
  return Object.fromEntries(list.split(',').filter(Boolean).map((item) => {
    const [, name, value] = /^(ES|ENS|MNS|MW|IRISD)=(\d+(?:\.\d+)?)$/.exec(item) ?? [];
    if (!name || !(value > 0)) throw new Usage(`--fapu ${item}: ES, ENS, MNS, MW or IRISD with its mm is wanted`);
    return [name, Number(value)];
  }));
}

function writeFaps({ tracks, map }, rest, options) {
  const { frames, lengths, used } = fapsOfMarkers(tracks, allNumbersOf(tracks.names, map), { rest, lengths: lengthsOf(options.fapu), tilt: options.tilt });
  write(options.fap, toFap(path.basename(options.fap, path.extname(options.fap)).replace(/\s+/g, '_'), tracks.times, frames, Math.min(options.fps ?? VIDEO_FPS, 120)));
  console.error(`${options.fap}: ${used.length} markers; ${Object.entries(lengths).map(([name, mm]) => `${name} ${mm.toFixed(1)}`).join(', ')} mm`);
}

function within(file, work) {
  try {
    return work();
  } catch (error) {
    throw Object.assign(error, { file });
  }
}

/** Image analysis needs npm packages, which are in the sources. */
async function watch(file, options) {
  const folder = fs.statSync(file).isDirectory();
  if (folder && !options.fps) throw new Usage('pictures in a folder do not say how many there are in a second: --fps');
  let film, watching;
  try {
    [film, watching] = await Promise.all(['film.mjs', 'watch.mjs'].map((name) => import(new URL(name, import.meta.url))));
  } catch (error) {
    if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
    throw new FileError('', "looking at pictures wants faccia's sources with 'npm ci' done in web/ and models/: node models/tools/lips/faccia-lips.mjs");
  }
  const fps = options.fps ?? VIDEO_FPS;
  const pictures = () => (folder ? film.picturesOf(file) : film.framesOf(path.resolve(file), fps));
  return watching.watchLips(pictures, { fps, rest: options.rest, iris: options.iris, pupils: options.pupils, like: options.like, tell: progress() });
}

/** Returns a function that prints how far the work is: always on a terminal, otherwise every five seconds. */
function progress() {
  let told = Date.now();
  return (what, done, count) => {
    const line = `${what}: ${done}${count ? ` of ${count}` : ''} pictures`;
    if (process.stderr.isTTY) process.stderr.write(`\r${line}\u001b[K`);
    else if (Date.now() - told >= 5000) {
      console.error(line);
      told = Date.now();
    }
  };
}

const frames = (gaps) => gaps.slice(0, 12).map(([a, b]) => (a === b ? `${a + 1}` : `${a + 1} to ${b + 1}`)).join(', ') + (gaps.length > 12 ? ` and ${gaps.length - 12} more` : '');

function write(file, csv) {
  if (!file) return process.stdout.write(csv);
  const half = `${file}.${process.pid}.part`;
  try {
    fs.writeFileSync(half, csv);
    fs.renameSync(half, file);
  } catch (error) {
    fs.rmSync(half, { force: true });
    throw Object.assign(error, { file });
  }
}

async function main(argv) {
  const options = choices(argv);
  if (options.help) return process.stdout.write(USAGE);
  const [file, ...more] = options.files;
  if (options.cameras !== undefined ? more.length !== 1 : !file || more.length)
    throw new Usage(options.cameras !== undefined ? '--cameras: the tracks of two cameras are wanted' : 'one folder of pictures, video or file of tracks is wanted');
  if (options.cameras !== undefined && options.files.some((name) => path.extname(name).toLowerCase() !== '.csv')) throw new Usage('--cameras: the tracks must be .csv');
  try {
    const marked = Object.hasOwn(READERS, path.extname(file).toLowerCase()) && fs.statSync(file).isFile();
    if (options.fap !== undefined && !marked) throw new Usage('--fap: tracks of markers are wanted');
    const read = marked ? readTracks(options.files, options) : null;
    const { rows, rest = options.rest ?? REST, notes = [] } = read ? { rows: rowsOfMarkers(read.tracks, read.map, options.tilt) } : await watch(file, options);
    if (process.stderr.isTTY) process.stderr.write('\r\u001b[K');
    for (const note of notes) console.error(note);
    const { rows: known, gaps } = filled(rows);
    if (gaps.length) console.error(`nothing is known of frames ${frames(gaps)}: they are left out (gaps up to ${LONGEST_GAP} s are filled)`);
    if (!known.length) throw new FileError('', marked ? 'no frame has the nose, both ears and another marker' : 'there is no face in any picture');
    const still = fromRest(smoothed(known, (options.smooth ?? 0) / 1000), rest.map((t) => t + rows[0].time));
    if (!still) throw new FileError('', `nothing is known of the time from ${rest.join(' to ')} s, in which the mouth rests: --rest says another`);
    if (options.fap !== undefined) writeFaps(read, rest, options);
    if (options.fap === undefined || options.output !== undefined) write(options.output, toCsv(still, options.all));
    console.error(`${still.length} of ${rows.length} frames, ${(rows.at(-1).time - rows[0].time).toFixed(2)} s`);
  } catch (error) {
    throw Object.assign(error, { file: error.file ?? file });
  }
}

try {
  await main(process.argv.slice(2));
} catch (error) {
  if (error instanceof Usage) {
    console.error(`faccia head lips: ${error.message}\nTry 'faccia head lips --help'.`);
    process.exit(2);
  }
  const known = error instanceof FileError || typeof error.code === 'string';
  console.error(`faccia head lips: ${error.file ? `${error.file}: ` : ''}${known ? error.message : error.stack}`);
  process.exit(1);
}
