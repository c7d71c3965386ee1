#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** Third-party heads: runs `faccia head import`, `calibrate`, `points`, `fdp` and `check`. See ../../README.md. */
import fs from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { calibrate } from '../../../web/element/head/model/calibrate.mjs';
import { ModelError } from '../../../web/element/head/model/check.mjs';
import { readModel } from '../../../web/element/head/model/model.mjs';
import { unpack } from '../lib/deform.mjs';
import { closeLids } from './actions/closed-lids.mjs';
import { findPoints } from './face/find-points.mjs';
import { pictureBeside } from './formats/beside.mjs';
import { calibrationOf } from './formats/fdp-node.mjs';
import { readPoints, writeXface } from './formats/points.mjs';
import { readScene } from './formats/read-scene.mjs';
import { isSceneText, sceneText } from './formats/scene-text.mjs';
import { addShapes } from './formats/shape-files.mjs';
import { textOf } from './formats/text.mjs';
import { writeFdp } from './formats/write-fdp.mjs';
import { Budget, FileError } from './limits.mjs';
import { makeHead } from './make-head.mjs';
import { placeHead } from './mesh/place.mjs';
import { packModel } from './pack-model.mjs';
import { reportHead } from './report.mjs';

const USAGE = `Usage: faccia head import FILE [--points FILE] [--shapes FOLDER] [-o HEAD.json]
       faccia head calibrate HEAD.json --points FILE [-o HEAD.json]
       faccia head points HEAD.json [-o FILE.fdp | FILE.json]
       faccia head fdp HEAD.json -o FILE.wrl | FILE.bt | FILE.xmt
       faccia head check HEAD.json
Makes a head of a GLB, glTF, VRM, FBX, OBJ, PLY or VRML file, or an MPEG-4 scene (BIFS text, XMT-A) with the animation table of its FDP; has a head take the
feature points of somebody; writes a head's feature points (Xface's .fdp, or JSON), or the whole head as MPEG-4's FDP node with an animation table; says what a
head lacks and what its FAPs will not do.

  -p, --points FILE   feature points: Xface's .fdp, JSON, an MPEG-4 scene with an FDP, or a head's own file (import: found by themselves where the file brings none)
      --shapes FOLDER import: meshes with the same vertices, named by what they show (jawOpen.obj, viseme_PP.obj, or the 37 of Turkish letters: bpa.obj...)
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
  credit: { type: 'string', multiple: true }, unit: { type: 'string' }, up: { type: 'string' }, shapes: { type: 'string' }, help: { type: 'boolean', short: 'h' },
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
  const text = fs.readFileSync(file, 'utf8');
  let json;
  try {
    json = JSON.parse(text);
  } catch (error) {
    throw new FileError('', /^\s*\{/.test(text) ? error.message : "no head model, which is JSON; 'faccia head import' makes one of files of other kinds");
  }
  return { json, model: readModel(json) };
});

const sceneOf = (file) => {
  const bytes = fs.readFileSync(file);
  return isSceneText(textOf(bytes)) ? { scene: sceneText(path.extname(file) || '.bt', bytes, new Budget()) } : { text: textOf(bytes) };
};

/** Feature points of a file of any kind. */
const pointsOf = (file) => within(file, () => {
  const { scene, text } = sceneOf(file);
  return scene ? { frame: 'file', fdp: calibrationOf(scene, new Budget()).featurePointsCoord, parts: {}, influences: [] } : readPoints(text);
});

/** A calibration from a file: JSON, or the FDP of an MPEG-4 scene, in whatever unit, with its texture beside it. */
const calibrationFrom = (file) => within(file, () => {
  const { scene, text } = sceneOf(file);
  if (!scene) {
    const given = JSON.parse(text);
    return given.featurePointsCoord ? given : { featurePointsCoord: given.fdp };
  }
  const { featurePointsCoord, textureCoord, url, line } = calibrationOf(scene, new Budget());
  const { fdp } = placeHead({ meshes: [], unit: null }, { frame: 'file', fdp: featurePointsCoord }, {});
  const picture = url && Object.keys(textureCoord).length >= 4 ? pictureBeside(file, url, `line ${line}`, [], new Budget()) : null;
  return { featurePointsCoord: fdp, ...(picture ? { textureCoord, texture: { type: picture.type, data: picture.data.toString('base64') } } : {}) };
});

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
  if (values.shapes) await addShapes(scene, values.shapes, file);
  const own = scene.points;
  const found = points ? points.find && (await find(scene, values.up, points)) : own ? null : await find(scene, values.up, null);
  const name = (values.name ?? path.basename(file, path.extname(file))).toLowerCase().replace(/[^a-z0-9_-]+/g, '-');
  const options = {
    name, title: values.title ?? name, unit: values.unit, up: found ? 'y' : values.up,
    licence: values.licence ?? scene.licence ?? 'LicenseRef-unknown', credits: values.credit ?? scene.credits ?? (scene.copyright ? [String(scene.copyright)] : []),
  };
  const chosen = found ? found.points : points ? { ...points, origin: points.frame === 'head' ? own?.origin : undefined } : own;
  const { head: made, notes, used, tabled } = makeHead(scene, chosen, options);
  readModel(made); // as clients will
  const { head, notes: lids } = closeLids(made);
  const out = values.output ?? `${name}.json`;
  write(out, JSON.stringify(head));
  for (const note of [...(found?.notes ?? []), ...notes, ...lids]) console.log(note);
  if (tabled) console.log(`actions of ${tabled} FAPs from its animation table, of the rest from zones`);
  else console.log(used.length ? `actions from ${used.length} morph targets, and zones` : 'actions from zones about the feature points');
  tell(head);
}

function calibrateHead(file, values) {
  if (!values.points) throw new Usage('calibrate wants --points');
  const { json, model } = readHead(file);
  const calibration = calibrationFrom(values.points);
  const taken = within(values.points, () => calibrate(json.calibration ? calibrate(model, json.calibration, 'calibration.') : model, calibration));
  const { title, licence, credits, about, voice, breath } = json;
  const head = packModel({ name: values.name ?? json.name, title: values.title ?? title, licence: values.licence ?? licence, credits: values.credit ?? credits, ...(about ? { about } : {}), ...(voice ? { voice } : {}), ...(breath ? { breath } : {}) }, taken);
  write(values.output ?? file, JSON.stringify(head));
}

function writePoints(file, values) {
  const { json, model } = readHead(file);
  const xface = values.output?.endsWith('.fdp');
  const text = xface ? writeXface(unpack(json)) : `${JSON.stringify({ frame: 'head', fdp: model.fdp }, null, 1)}\n`;
  if (values.output) write(values.output, text);
  else process.stdout.write(text);
}

/** Writes a head as an MPEG-4 scene, with its textures beside it. */
function writeScene(file, values) {
  const form = path.extname(values.output ?? '').slice(1).toLowerCase();
  if (!['wrl', 'bt', 'xmt'].includes(form)) throw new Usage('fdp wants --output FILE.wrl, FILE.bt or FILE.xmt');
  const { json } = readHead(file);
  const beside = values.output.slice(0, -form.length - 1);
  const pictures = {};
  for (const [name, { type, data }] of Object.entries(json.textures ?? {})) {
    const picture = `${beside}-${name.replace(/[^\w-]/g, '_')}.${type.split('/')[1].replace('jpeg', 'jpg')}`;
    write(picture, Buffer.from(data, 'base64'));
    pictures[name] = path.basename(picture);
  }
  write(values.output, writeFdp(unpack(json), pictures, form));
}

const COMMANDS = { import: importHead, calibrate: calibrateHead, points: writePoints, fdp: writeScene, check: (file) => tell(readHead(file).json) };

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
  if (!COMMANDS[command] || !file || rest.length) throw new Usage('import, calibrate, points, fdp or check is wanted, and one file');
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
