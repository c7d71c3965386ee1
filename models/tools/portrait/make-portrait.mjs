#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Makes a head from photographs of a face by adapting a built head: make-portrait.mjs PHOTO... -o HEAD.json --like HEAD [--name NAME] [--title TITLE]
 * [--eyes HEAD] [--hair photo|head|none|#RRGGBB] [--light STOPS] [--keep beard,glasses] [--poses FOLDER|VIDEO [--times FILE]] [--heads FOLDER] [--points FILE]. Prints a summary and the
 * unsuitable pose pictures. Without --like it only prints the head with the most similar face, because hairstyle and clothes are not guessed from a
 * picture. Exit status: 0 done, 1 failed (with
 * the picture and what is wrong with it), 2 wrong usage. Nothing is written unless all is well.
 */
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { hairOf } from '../../../web/portrait/hair.mjs';
import { asProfile, makeHead, nearest, inOrder } from '../../../web/portrait/portrait.mjs';
import { PortraitError } from '../../../web/portrait/problem.mjs';
import { coded, linear } from '../../../web/portrait/skin.mjs';
import { openSource, SourceError } from '../pictures/sources.mjs';
import { listOf, nameOf, withOwnActions } from './actions/actions.mjs';
import { openEye } from './eye.mjs';
import { flat, textures } from './images.mjs';

const built = fileURLToPath(new URL('../../../build/', import.meta.url));
const usage = `usage: make-portrait.mjs PHOTO... -o HEAD.json --like HEAD [--name NAME] [--title TITLE] [--eyes HEAD]
       [--hair photo|head|none|#RRGGBB] [--light STOPS] [--keep beard,glasses] [--poses FOLDER|VIDEO [--times TIMES.json]] [--heads FOLDER] [--points FILE]
The head is an approximation: the face seen from the front and its skin are the photograph's, all else is the head's that --like names.
--like: whose hair, clothes, ears, teeth and movements it has; left out, the tool says whose face is nearest, and makes no head
--hair: its colour (photo unless given: the picture's, where it is recognised), or none
--light: stops by which the skin is lighter than in the picture, which may be in the shade: 0.5, -0.5...
--poses: how the person moves: a folder with smile.jpg, brows-up.jpg... (another of the same is smile-2.jpg), or a video, for which TIMES.json says when each is seen, in
seconds ({"smile": 2.4, "open": [4.1, 9]}), in the same light and with the same camera as the front, which has closed lips then:
${listOf()}`;

function wrong(text) {
  console.error(text);
  process.exit(2);
}

function options() {
  const text = { type: 'string' };
  try {
    return parseArgs({
      allowPositionals: true,
      options: { out: { ...text, short: 'o' }, name: text, title: text, like: text, eyes: text, hair: text, light: text, keep: text, poses: text, times: text, heads: text, points: text, help: { type: 'boolean', short: 'h' } },
    });
  } catch (error) {
    return wrong(`${error.message}\n${usage}`);
  }
}

const { values, positionals: photos } = options();
if (values.help) {
  console.log(usage);
  process.exit(0);
}
if (!photos.length || !values.out || (values.times && !values.poses)) wrong(usage);
const name = values.name ?? path.basename(values.out, '.json').toLowerCase();
if (!/^[a-z0-9_-]+$/.test(name)) wrong(`--name ${name}: small letters, digits, - and _ are wanted`);
const hairWanted = values.hair ?? 'photo';
if (!/^(photo|head|none|#[0-9a-f]{6})$/i.test(hairWanted)) wrong(`--hair ${hairWanted}: photo, head, none or a colour such as #6b4a2a is wanted`);
const light = Number(values.light ?? 0);
if (!(Math.abs(light) <= 2)) wrong(`--light ${values.light}: a number from -2 to 2 is wanted`);
const heads = values.heads ?? path.join(built, 'models/heads');
const table = JSON.parse(fs.readFileSync(values.points ?? path.join(built, 'web/face-points.json'), 'utf8'));
for (const option of ['like', 'eyes'])
  if (values[option] && !Object.hasOwn(table, values[option])) wrong(`--${option} ${values[option]}: there are ${Object.keys(table).join(', ')}`);

const head = (which) => JSON.parse(fs.readFileSync(path.join(heads, `${which}.json`), 'utf8'));

const linearOf = (text) => [1, 3, 5].map((at) => linear[parseInt(text.slice(at, at + 2), 16)]);
const codeOf = (colour) => `#${colour.map((x) => Math.round(coded(x)).toString(16).padStart(2, '0')).join('')}`;

async function look(eye, file) {
  try {
    const picture = await flat(file);
    try {
      return { picture, landmarks: await eye(picture) };
    } catch (error) {
      if (error.code !== 'no_face') throw error;
      return asProfile(picture, table);
    }
  } catch (error) {
    if (error instanceof PortraitError) error.message = `${file}: ${error.message}`;
    throw error;
  }
}

try {
  const posed = values.poses ? openSource(values.poses, values.times ?? null, nameOf) : null;
  for (const file of posed?.strange ?? []) console.log(`${file}: left out: no pose is called so`);
  const eye = await openEye();
  const views = [];
  for (const photo of photos) views.push(await look(eye, photo));
  const seen = views.filter(({ landmarks }) => landmarks);
  if (!seen.length) throw new PortraitError('turned', `${photos[0]}: one picture must show the face from the front`);
  const [front] = inOrder(seen, Object.values(table)[0]);
  const { like } = values;
  if (!like) wrong(`--like HEAD: whose hairstyle and clothes it is to have is not guessed from the picture. There are ${Object.keys(table).join(', ')}; nearest in face is ${nearest(front, table)[0].name}`);
  const seenHair = hairOf(front.picture, front.landmarks);
  const hair = { photo: seenHair.kind === 'none' ? 'none' : seenHair.colour, head: null, none: 'none' }[hairWanted] ?? (hairWanted.startsWith('#') ? linearOf(hairWanted) : null);
  const made = await makeHead(head(like), table[like], views, textures, {
    name, title: values.title, keep: values.keep?.split(','), eyes: values.eyes ? head(values.eyes) : null, hair, light,
  });
  const own = posed && (await withOwnActions(made.head, head(like), table[like], front, posed.photographs, eye));
  for (const reason of own?.unfit ?? []) console.log(`${reason.replace(': ', ': unfit: ')}`);
  fs.writeFileSync(`${values.out}.part`, JSON.stringify(own?.head ?? made.head));
  fs.renameSync(`${values.out}.part`, values.out);
  const HAIR = { hair: seenHair.colour && `hair ${codeOf(seenHair.colour)} in the picture`, none: 'no hair above the forehead in the picture', unsure: 'the picture does not tell the hair: --hair' };
  const notes = [`like ${like}`, HAIR[seenHair.kind], `${made.sides} pictures half from the side, ${made.profiles} from the side`, ...(made.parted ? ['the lips are parted: a picture with closed lips gives a better mouth'] : []),
    ...(made.bearded && !values.keep?.includes('beard') ? ['the beard is taken off: --like a head that has one and --keep beard give it another'] : []),
    ...(own ? [`${own.taken.length} poses, ${own.actions} actions of its own`] : [])];
  console.log(`${values.out}: ${notes.join('; ')}`);
} catch (error) {
  if (!(error instanceof PortraitError || error instanceof SourceError)) throw error;
  console.error(error.code ? `${error.message} (${error.code})` : error.message);
  process.exitCode = 1;
}
