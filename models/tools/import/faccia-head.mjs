#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** Third-party heads: runs `faccia head import`, `calibrate`, `points` and `check`. See ../../README.md. */
import fs from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { calibrate } from '../../../web/element/head/model/calibrate.mjs';
import { ModelError } from '../../../web/element/head/model/check.mjs';
import { readModel } from '../../../web/element/head/model/model.mjs';
import { unpack } from '../lib/deform.mjs';
import { FileError } from './file-error.mjs';
import { findPoints } from './find-points.mjs';
import { makeHead, readScene } from './make-head.mjs';
import { packModel } from './pack-model.mjs';
import { readPoints, writeXface } from './points.mjs';
import { reportHead } from './report.mjs';

const USAGE = `Usage: faccia head import FILE [--points FILE] [-o HEAD.json]
       faccia head calibrate HEAD.json --points FILE [-o HEAD.json]
       faccia head points HEAD.json [-o FILE.fdp | FILE.json]
       faccia head check HEAD.json
Makes a head of a GLB, glTF, VRM, FBX, OBJ, PLY or VRML file; has a head take the feature points of somebody; writes a head's feature points (Xface's
.fdp, or JSON); says what a head lacks and what its FAPs will not do.

  -p, --points FILE   feature points: Xface's .fdp, JSON, or a head's own file (import: found by themselves where the file brings none)
  -o, --output FILE   what is written (import: NAME.json beside where you are)
      --name NAME     the head's name (the file's, in small letters)
      --title TITLE   how it is called
      --licence ID    an SPDX expression (import: LicenseRef-unknown)
      --credit TEXT   whom it is owed to; may be given again
      --unit UNIT     of the file: mm, cm, dm, m, in (guessed where it does not say)
      --up AXIS       of the file: y or z (y; found by itself along with the points)
  -h, --help          print this and exit
Exit status: 0 done, 1 failed, 2 wrong usage.
`;

const OPTIONS = {
  points: { type: 'string', short: 'p' }, output: { type: 'string', short: 'o' }, name: { type: 'string' }, title: { type: 'string' }, licence: { type: 'string' },
  credit: { type: 'string', multiple: true }, unit: { type: 'string' }, up: { type: 'string' }, help: { type: 'boolean', short: 'h' },
};

class Usage extends Error {}

const within = (file, work) => {
  try {
    return work();
  } catch (error) {
    throw Object.assign(error, { file: error.file ?? file });
  }
};

const readHead = (file) => within(file, () => {
  const json = JSON.parse(fs.readFileSync(file, 'utf8'));
  return { json, model: readModel(json) };
});

const pointsOf = (file) => within(file, () => readPoints(fs.readFileSync(file, 'utf8')));

/** Writes a file atomically. */
function write(file, text) {
  const half = `${file}.${process.pid}.part`;
  try {
    fs.writeFileSync(half, text);
    fs.renameSync(half, file);
  } catch (error) {
    fs.rmSync(half, { force: true });
    throw Object.assign(error, { file });
  }
}

function tell(json) {
  const { lacks, faps } = reportHead(unpack(json));
  for (const line of [...lacks, ...faps]) console.log(line);
  console.log(`${json.name}: ${json.parts.length} parts, ${68 - 2 - faps.filter((line) => line.endsWith('does nothing')).length} of 66 FAPs act`);
}

/** Finds feature points. Loads the detector, a separate file, only if needed. */
async function find(scene, up, points) {
  if (points?.landmarks) return findPoints(scene, null, { up, points });
  const beside = new URL('./faccia-eye.mjs', import.meta.url);
  if (!fs.existsSync(beside)) throw new FileError('', 'it brings no feature points: --points FILE (the program that finds them was not built)');
  const { openEye } = await import(beside.href);
  return findPoints(scene, await openEye(), { up, points });
}

async function importHead(file, values) {
  if (values.unit && !['mm', 'cm', 'dm', 'm', 'in'].includes(values.unit)) throw new Usage('--unit must be mm, cm, dm, m or in');
  if (values.up && !['y', 'z'].includes(values.up)) throw new Usage('--up must be y or z');
  const points = values.points ? pointsOf(values.points) : null;
  const scene = await readScene(file);
  const own = scene.points;
  const found = points ? points.find && (await find(scene, values.up, points)) : own ? null : await find(scene, values.up, null);
  const name = (values.name ?? path.basename(file, path.extname(file))).toLowerCase().replace(/[^a-z0-9_-]+/g, '-');
  const options = {
    name, title: values.title ?? name, unit: values.unit, up: found ? 'y' : values.up,
    licence: values.licence ?? scene.licence ?? 'LicenseRef-unknown', credits: values.credit ?? scene.credits ?? (scene.copyright ? [String(scene.copyright)] : []),
  };
  const chosen = found ? found.points : points ? { ...points, origin: points.frame === 'head' ? own?.origin : undefined } : own;
  const { head, notes, used } = makeHead(scene, chosen, options);
  readModel(head); // as clients will
  const out = values.output ?? `${name}.json`;
  write(out, JSON.stringify(head));
  for (const note of [...(found?.notes ?? []), ...notes]) console.log(note);
  console.log(used.length ? `actions from ${used.length} morph targets, and zones` : 'actions from zones about the feature points');
  tell(head);
}

function calibrateHead(file, values) {
  if (!values.points) throw new Usage('calibrate wants --points');
  const { json, model } = readHead(file);
  const given = JSON.parse(within(values.points, () => fs.readFileSync(values.points, 'utf8')));
  const calibration = given.featurePointsCoord ? given : { featurePointsCoord: given.fdp };
  const taken = within(values.points, () => calibrate(json.calibration ? calibrate(model, json.calibration, 'calibration.') : model, calibration));
  const { title, licence, credits, about, voice } = json;
  const head = packModel({ name: values.name ?? json.name, title: values.title ?? title, licence: values.licence ?? licence, credits: values.credit ?? credits, ...(about ? { about } : {}), ...(voice ? { voice } : {}) }, taken);
  write(values.output ?? file, JSON.stringify(head));
}

function writePoints(file, values) {
  const { json, model } = readHead(file);
  const xface = values.output?.endsWith('.fdp');
  const text = xface ? writeXface(unpack(json)) : `${JSON.stringify({ frame: 'head', fdp: model.fdp }, null, 1)}\n`;
  if (values.output) write(values.output, text);
  else process.stdout.write(text);
}

const COMMANDS = { import: importHead, calibrate: calibrateHead, points: writePoints, check: (file) => tell(readHead(file).json) };

async function main(argv) {
  let parsed;
  try {
    parsed = parseArgs({ args: argv, options: OPTIONS, allowPositionals: true });
  } catch (error) {
    throw new Usage(error.message);
  }
  const { values, positionals } = parsed;
  if (values.help) return process.stdout.write(USAGE);
  const [command, file, ...rest] = positionals;
  if (!COMMANDS[command] || !file || rest.length) throw new Usage('import, calibrate, points or check is wanted, and one file');
  try {
    return await COMMANDS[command](file, values);
  } catch (error) {
    throw Object.assign(error, { file: error.file ?? file });
  }
}

try {
  await main(process.argv.slice(2));
} catch (error) {
  const known = error instanceof FileError || error instanceof ModelError || error instanceof SyntaxError || typeof error.code === 'string';
  if (error instanceof Usage) {
    console.error(`faccia head: ${error.message}\nTry 'faccia head --help'.`);
    process.exit(2);
  }
  console.error(`faccia head: ${error.file ? `${error.file}: ` : ''}${known ? error.message : error.stack}`);
  process.exit(1);
}
