#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Makes a set of pictures of a person: see ../../README.md. Reports every unsuitable photograph with the reason; writes nothing unless the
 * set is complete.
 */
import fs from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { readPictures } from '../../../web/element/pictures/set.mjs';
import { toneOf } from '../../../web/portrait/skin.mjs';
import { openEye } from '../portrait/eye.mjs';
import { flat } from '../portrait/images.mjs';
import { PortraitError } from '../../../web/portrait/problem.mjs';
import { blinkUnfit, mouthUnfit, unfit, unfitRest, usual } from './judge.mjs';
import { measures, seenIn } from './look.mjs';
import { BLINK, listOf, nameOf, posed, poses, visemes } from './names.mjs';
import { makeSet } from './set.mjs';
import { openSource, SourceError } from './sources.mjs';

const LEAST = 8; // fewer pictures of the mouth cannot show speech
const USAGE = `Usage: make-set.mjs FOLDER -o SET.json [OPTION]...
       make-set.mjs VIDEO --times TIMES.json -o SET.json [OPTION]...
Makes a set of pictures, which speaks where no head can be drawn, from photographs of a person. FOLDER has a photograph for each mouth, called as
below: p1.jpg, sh1.png, a.webp; another try is p1-2.jpg, and the first one that is fit is taken. TIMES.json says when each is seen in a video, in
seconds: {"rest": 0.4, "p1": [1.24, 7.9], "sh1": 3.1}, or TIMES.TextGrid has intervals or points of these names; videos are read by ffmpeg.

      -o, --output FILE     what is written
          --times FILE      of a video
          --name NAME       small letters, digits, - and _ (the file's)
          --title TITLE     how it is called
          --licence ID      an SPDX expression (LicenseRef-portrait)
          --credit TEXT     whom it is owed to; may be given again
      -h, --help            print this and exit

Look straight into the camera in even light, the face at least 250 pixels wide, and hold the head still. The 34 mouths of Portuguese that the set should
have, and, from 'joy' on, what other languages and moods want (none of them must be there but 'rest'):
${listOf()}
Exit status: 0 done, 1 failed, 2 wrong usage.
`;

const text = { type: 'string' };
const OPTIONS = { output: { ...text, short: 'o' }, times: text, name: text, title: text, licence: text, credit: { ...text, multiple: true }, help: { type: 'boolean', short: 'h' } };

function wrong(message) {
  console.error(`make-set: ${message}\nTry 'make-set.mjs --help'.`);
  process.exit(2);
}

function parsed() {
  try {
    return parseArgs({ options: OPTIONS, allowPositionals: true });
  } catch (error) {
    return wrong(error.message);
  }
}

class NoSet extends Error {}

/** Measures all photographs; reports those without a face. @returns {Promise<{seen: object[], unfits: Map}>} */
async function lookAt(photographs, unfits) {
  const eye = await openEye();
  const views = [];
  let rest = null;
  for (const one of photographs) {
    if (one.name === 'rest' && rest) continue;
    try {
      const picture = await flat(one.read());
      const landmarks = await eye(picture);
      const seen = { ...seenIn({ picture, landmarks }, rest), bright: toneOf(picture, landmarks).reduce((a, b) => a + b) };
      const reason = one.name === 'rest' ? unfitRest(seen) : null;
      if (reason) throw new PortraitError('unfit', reason);
      if (one.name === 'rest') rest = seen;
      else views.push({ ...one, seen });
    } catch (error) {
      if (!(error instanceof PortraitError || error instanceof SourceError)) throw error;
      if (one.name !== 'rest' && !rest) break;
      unfits.set(one.label, error.message);
    }
  }
  return { rest, views };
}

/** Returns the first suitable photograph of each viseme, in the order of the list. */
function chosen(rest, views, fapu, unfits) {
  const usually = { sharp: usual([rest, ...views.map(({ seen }) => seen)]), bright: rest.bright };
  const found = new Map([['rest', rest]]);
  for (const { name, label, seen } of views) {
    const reason = unfit(seen, rest, usually) ?? (name === BLINK ? blinkUnfit(seen, rest) : mouthUnfit(seen, rest, posed.get(name).faps, fapu));
    if (reason) unfits.set(label, reason);
    else if (!found.has(name)) found.set(name, seen);
  }
  const fit = poses.filter(({ name }) => found.has(name)).map((pose) => ({ pose, seen: found.get(pose.name) }));
  return { fit, blink: found.get(BLINK) ?? null };
}

async function run(source, values) {
  const unfits = new Map();
  const tell = () => unfits.forEach((reason, label) => console.log(`${label}: unfit: ${reason}`));
  const name = values.name ?? path.basename(values.output, '.json').toLowerCase();
  const { photographs, strange } = openSource(source, values.times ?? null, nameOf);
  if (!photographs.some((one) => one.name === 'rest')) throw new SourceError(`${source}: 'rest' is wanted: the face with closed lips`);
  photographs.sort((a, b) => Number(b.name === 'rest') - Number(a.name === 'rest') || Number(a.name === BLINK) - Number(b.name === BLINK)); // the reference for the others
  for (const file of strange) console.log(`${file}: left out: no viseme is called so`);
  const { rest, views } = await lookAt(photographs, unfits);
  if (!rest) {
    tell();
    throw new NoSet("no photograph of 'rest' is fit, and without it there is no set");
  }
  const fapu = measures(rest);
  const { fit, blink } = chosen(rest, views, fapu, unfits);
  const credits = values.credit ?? ['The rights of the pictures are those of the person in them and of who took them'];
  const { set, bytes, cut } = await makeSet(rest, fit, blink, fapu, { name, title: values.title ?? name, licence: values.licence ?? 'LicenseRef-portrait', credits });
  for (const one of cut) unfits.set(one, 'the border of the picture cuts the mouth');
  tell();
  const mouths = set.regions[0].pictures.map((one) => one.name);
  const missing = visemes.filter((one) => !mouths.includes(one));
  if (missing.length) console.log(`without ${missing.join(' ')}: what is nearest stands for them`);
  if (!blink) console.log(`without '${BLINK}': it will not blink`);
  if (mouths.length < LEAST) throw new NoSet(`${mouths.length} pictures of the mouth are fit: at least ${LEAST} are wanted`);
  readPictures(set); // as clients will
  fs.writeFileSync(`${values.output}.part`, JSON.stringify(set));
  fs.renameSync(`${values.output}.part`, values.output);
  console.log(`${values.output}: ${mouths.length} pictures of the mouth${blink ? ', blinks' : ''}, ${bytes} bytes compressed`);
}

const { values, positionals } = parsed();
if (values.help) {
  process.stdout.write(USAGE);
  process.exit(0);
}
if (positionals.length !== 1 || !values.output) wrong('one folder or video is wanted, and --output');
const name = values.name ?? path.basename(values.output, '.json').toLowerCase();
if (!/^[a-z0-9_-]+$/.test(name)) wrong(`--name ${name}: small letters, digits, - and _ are wanted`);
try {
  await run(positionals[0], values);
} catch (error) {
  const known = error instanceof NoSet || error instanceof SourceError || typeof error.code === 'string' || /do not go into/.test(error.message);
  console.error(`make-set: ${known ? error.message : error.stack}`);
  process.exitCode = 1;
}
