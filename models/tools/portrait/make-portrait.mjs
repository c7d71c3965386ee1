#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * A head from photographs of a face: make-portrait.mjs PHOTO... -o HEAD.json [--name NAME] [--title TITLE] [--like HEAD]
 * [--eyes HEAD] [--keep beard,glasses] [--heads FOLDER] [--points FILE]. Says in one line what it did. Exit status: 0 done, 1 failed (with
 * the picture and what is wrong with it), 2 wrong usage. Nothing is written unless all is well.
 */
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { makeHead, nearest, inOrder } from '../../../web/src/portrait/portrait.mjs';
import { PortraitError } from '../../../web/src/portrait/problem.mjs';
import { openEye } from './eye.mjs';
import { flat, textures } from './images.mjs';

const built = fileURLToPath(new URL('../../../build/', import.meta.url));
const usage = `usage: make-portrait.mjs PHOTO... -o HEAD.json [--name NAME] [--title TITLE] [--like HEAD] [--eyes HEAD]
       [--keep beard,glasses] [--heads FOLDER] [--points FILE]`;

function wrong(text) {
  console.error(text);
  process.exit(2);
}

function options() {
  const text = { type: 'string' };
  try {
    return parseArgs({
      allowPositionals: true,
      options: { out: { ...text, short: 'o' }, name: text, title: text, like: text, eyes: text, keep: text, heads: text, points: text },
    });
  } catch (error) {
    return wrong(`${error.message}\n${usage}`);
  }
}

const { values, positionals: photos } = options();
if (!photos.length || !values.out) wrong(usage);
const name = values.name ?? path.basename(values.out, '.json').toLowerCase();
if (!/^[a-z0-9_-]+$/.test(name)) wrong(`--name ${name}: small letters, digits, - and _ are wanted`);
const heads = values.heads ?? path.join(built, 'models/heads');
const table = JSON.parse(fs.readFileSync(values.points ?? path.join(built, 'web/face-points.json'), 'utf8'));
for (const option of ['like', 'eyes'])
  if (values[option] && !Object.hasOwn(table, values[option])) wrong(`--${option} ${values[option]}: there are ${Object.keys(table).join(', ')}`);

const head = (which) => JSON.parse(fs.readFileSync(path.join(heads, `${which}.json`), 'utf8'));

async function look(eye, file) {
  try {
    const picture = await flat(file);
    return { picture, landmarks: await eye(picture) };
  } catch (error) {
    if (error instanceof PortraitError) error.message = `${file}: ${error.message}`;
    throw error;
  }
}

try {
  const eye = await openEye();
  const views = [];
  for (const photo of photos) views.push(await look(eye, photo));
  const [front] = inOrder(views, Object.values(table)[0]);
  const like = values.like ?? nearest(front, table)[0].name;
  const made = await makeHead(head(like), table[like], views, textures, {
    name, title: values.title, keep: values.keep?.split(','), eyes: values.eyes ? head(values.eyes) : null,
  });
  fs.writeFileSync(`${values.out}.part`, JSON.stringify(made.head));
  fs.renameSync(`${values.out}.part`, values.out);
  const notes = [`like ${like}`, `${made.sides} pictures from the side`, ...(made.parted ? ['the lips are parted: a picture with closed lips gives a better mouth'] : [])];
  console.log(`${values.out}: ${notes.join('; ')}`);
} catch (error) {
  if (!(error instanceof PortraitError)) throw error;
  console.error(`${error.message} (${error.code})`);
  process.exitCode = 1;
}
