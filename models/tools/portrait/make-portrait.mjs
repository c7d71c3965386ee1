#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Makes a head from photographs of a face by adapting a built head: make-portrait.mjs PHOTO... -o HEAD.json --like HEAD [--name NAME] [--title TITLE]
 * [--eyes photo|HEAD] [--hair photo|head|none|#RRGGBB] [--wear seen|hair=HEAD|STYLE|none,beard=KIND,glasses=KIND] [--age YEARS]
 * [--light STOPS] [--keep beard,glasses] [--poses FOLDER|VIDEO [--times FILE]] [--heads FOLDER] [--points FILE]. Prints a summary, what was
 * recognised, and the unsuitable pose pictures. Without --like it only prints the head with the most similar face, because sex, hairstyle and clothes are not guessed from a
 * picture. Exit status: 0 done, 1 failed (with
 * the picture and what is wrong with it), 2 wrong usage. Nothing is written unless all is well.
 */
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { BEARDS, GLASSES, offerOf, OLDEST, wornOf } from '../../../web/portrait/offer.mjs';
import { asProfile, makeHead, nearest, inOrder } from '../../../web/portrait/portrait.mjs';
import { PortraitError } from '../../../web/portrait/problem.mjs';
import { coded, linear } from '../../../web/portrait/skin.mjs';
import { openSource, SourceError } from '../pictures/sources.mjs';
import { listOf, nameOf, withOwnActions } from './actions/actions.mjs';
import { openEye } from './eye.mjs';
import { flat, textures } from './images.mjs';

const built = fileURLToPath(new URL('../../../build/', import.meta.url));
const usage = `usage: make-portrait.mjs PHOTO... -o HEAD.json --like HEAD [--name NAME] [--title TITLE] [--eyes HEAD]
       [--hair photo|head|none|#RRGGBB] [--wear seen|hair=HEAD|none,beard=none|moustache|full,glasses=none|some]
       [--light STOPS] [--keep beard,glasses] [--poses FOLDER|VIDEO [--times TIMES.json]] [--heads FOLDER] [--points FILE]
The head is an approximation: the face seen from the front and its skin are the photograph's, all else is the head's that --like names.
--like: whose hair (but for --wear), clothes, ears, teeth and movements it has; left out, the tool says whose face is nearest, and makes no head
beards: ${BEARDS.join(', ')}; glasses: ${GLASSES.join(', ')}
--wear: what it wears, instead of what the head of --like does; seen: what the picture shows, and what it leaves unsure must be said: seen,hair=mei
--eyes: whose irises (photo unless given: those most similar)
--age: how old the person is, which is not guessed: from 46 on the lines of the skin are deeper
--hair: its colour (photo unless given: the picture's, where it is recognised), or none
--light: stops by which the skin is lighter than in the picture, which may be in the shade: 0.5, -0.5...
--poses: how the person moves: a folder with smile.jpg, brows-up.jpg... (another of the same is smile-2.jpg), or a video, for which TIMES.json says when each is seen, in
seconds ({"smile": 2.4, "open": [4.1, 9]}), in the same light and with the same camera as the front, which has closed lips then:
${listOf()}`;

const ANSWERS = { yes: 'yes', no: 'no', unsure: 'not sure' };

/** What was recognised, in words. */
function told({ traits: { glasses, beard, moustache, bald, long }, styles, unsure }) {
  const said = Object.entries({ glasses, beard, moustache, 'bald head': bald, 'hair beside the neck': long }).map(([name, answer]) => `${name}: ${ANSWERS[answer]}`);
  return `in the picture: ${said.join(', ')}${unsure.includes('covered') ? ', the hair is covered, or dyed' : ''}${unsure.includes('colour') ? ", the hair's colour: not sure" : ''}; most similar hairstyles: ${styles.join(', ')}`;
}

function wrong(text) {
  console.error(text);
  process.exit(2);
}

function options() {
  const text = { type: 'string' };
  try {
    return parseArgs({
      allowPositionals: true,
      options: { out: { ...text, short: 'o' }, name: text, title: text, like: text, eyes: text, hair: text, light: text, age: text, wear: text, keep: text, poses: text, times: text, heads: text, points: text, help: { type: 'boolean', short: 'h' } },
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
const age = values.age === undefined ? null : Number(values.age);
if (age !== null && !(age >= 0 && age <= 120)) wrong(`--age ${values.age}: a number of years is wanted`);
const heads = values.heads ?? path.join(built, 'models/heads');
const table = JSON.parse(fs.readFileSync(values.points ?? path.join(built, 'web/face-points.json'), 'utf8'));
const styles = JSON.parse(fs.readFileSync(path.join(built, 'web/face-wear.json'), 'utf8'));
const all = { ...table, ...styles };
for (const option of ['like', 'eyes'])
  if (values[option] && !(option === 'eyes' && values.eyes === 'photo') && !Object.hasOwn(table, values[option])) wrong(`--${option} ${values[option]}: there are ${Object.keys(table).join(', ')}`);

const words = values.wear?.split(',') ?? [];
const asSeen = words.includes('seen');
const wanted = Object.fromEntries(words.filter((word) => word !== 'seen').map((one) => one.split('=')));
const KINDS = { hair: ['none', ...Object.keys(all)], beard: BEARDS, glasses: GLASSES };
for (const [what, which] of Object.entries(wanted)) {
  if (!Object.hasOwn(KINDS, what)) wrong(`--wear ${what}: there are ${Object.keys(KINDS).join(', ')}, each with = and a kind, and seen`);
  if (!KINDS[what].includes(which)) wrong(`--wear ${what}=${which ?? ''}: there are ${KINDS[what].join(', ')}`);
}

const head = (which) => JSON.parse(fs.readFileSync(Object.hasOwn(styles, which) ? path.join(built, `web/wear-${which}.json`) : path.join(heads, `${which}.json`), 'utf8'));

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
  const offer = offerOf(front, all);
  const seenThere = told(offer);
  if (!like) wrong(`--like HEAD: whose sex, ears and clothes it is to have is not guessed from the picture. There are ${Object.keys(table).join(', ')}; nearest in face is ${nearest(front, table)[0].name}\n${seenThere}`);
  const plain = { hair: like, beard: 'none', glasses: 'none' };
  const choice = { ...(asSeen ? offer.first : plain), ...(values.hair === 'none' ? { hair: 'none' } : {}), ...wanted };
  if (!choice.hair) wrong(`--wear hair=HEAD, or none: the picture does not tell whether the head is bald or its hair long\n${seenThere}`);
  const colour = { photo: offer.colour, head: null }[hairWanted] ?? (hairWanted.startsWith('#') ? linearOf(hairWanted) : null);
  const isBald = choice.hair === 'none' || (!wanted.hair && hairWanted === 'photo' && offer.kind === 'none');
  const worn = await wornOf(choice, like, all, head);
  const own = head(like);
  const eyes = (values.eyes ?? 'photo') === 'photo' ? offer.eyes : values.eyes;
  const made = await makeHead(own, table[like], views, textures, {
    name, title: values.title, ...worn, keep: [...worn.keep, ...(values.keep?.split(',') ?? [])], eyes: head(eyes), age, old: age ? head(OLDEST[own.voice?.gender] ?? OLDEST.female) : null,
    hair: isBald ? 'none' : colour, brows: hairWanted === 'photo' ? offer.brows : null, beard: hairWanted === 'photo' ? offer.beard : null, light,
  });
  const moved = posed && (await withOwnActions(made.head, own, table[like], front, posed.photographs, eye));
  for (const reason of moved?.unfit ?? []) console.log(`${reason.replace(': ', ': unfit: ')}`);
  fs.writeFileSync(`${values.out}.part`, JSON.stringify(moved?.head ?? made.head));
  fs.renameSync(`${values.out}.part`, values.out);
  const HAIR = { hair: offer.colour && `hair ${codeOf(offer.colour)} in the picture`, none: 'no hair above the forehead in the picture', unsure: `the picture does not tell the hair's colour: --hair${offer.colour ? ', or it is like the brows' : ''}` };
  const notes = [`like ${like}`, HAIR[offer.kind], `${made.sides} pictures half from the side, ${made.profiles} from the side`, ...(made.parted ? ['the lips are parted: a picture with closed lips gives a better mouth'] : []),
    ...(made.bearded && choice.beard === 'none' && !values.keep?.includes('beard') ? ['the beard is taken off: --wear beard=full gives it another'] : []),
    ...(moved ? [`${moved.taken.length} poses, ${moved.actions} actions of its own`] : [])];
  console.log(`${values.out}: ${notes.join('; ')}\n${seenThere}\nLook at it: nothing of this is known for certain.`);
} catch (error) {
  if (!(error instanceof PortraitError || error instanceof SourceError)) throw error;
  console.error(error.code ? `${error.message} (${error.code})` : error.message);
  process.exitCode = 1;
}
