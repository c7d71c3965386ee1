#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** Makes the prompter page of a recording session, and cuts what it records: implements `faccia session`. */
import fs from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { ListError, listNames, pageText, readLines, readList } from './lists.mjs';
import { cutTake, readTakes, TakeError, writeMouths } from './takes.mjs';

const USAGE = `Usage: faccia session --list LIST -o PAGE.html
       faccia session --lines FILE --lang TAG -o PAGE.html
       faccia session --cut FOLDER -o FOLDER [OPTION]...
Makes a page that prompts a speaker item by item, sounds a tone of 1 kHz, and records sound and film together; and cuts what it has recorded, so that
'faccia speaker', 'faccia fit', 'faccia head lips' and make-set.mjs take it.

      --list LIST           ${listNames().join(', ')}, or a file of that form
      --lines FILE          instead: a text, each line an item
  -l, --lang TAG            the language of its lines
      --repetitions N       how often each item is recorded (as the list says)
      --cut FOLDER          of takes, with session.json: each becomes NAME.mp4, .wav and .txt from the tone's end on, and .TextGrid and .json with
                            its words and phones
      --mouths FOLDER       also writes there the picture of each context viseme in single words, for make-set.mjs
      --no-align            neither words nor phones
      --no-tone             the takes have no tone: nothing is cut off
  -o, --output PATH         what is written
  -h, --help                print this and exit
Cutting needs ffmpeg. Exit status: 0 done, 1 failed, 2 wrong usage.
`;

const text = { type: 'string' };
const flag = { type: 'boolean' };
const OPTIONS = {
  list: text, lines: text, lang: { ...text, short: 'l' }, repetitions: text, cut: text, mouths: text, output: { ...text, short: 'o' }, faccia: { ...text, default: 'faccia' }, models: text,
  'no-align': flag, 'no-tone': flag, help: { ...flag, short: 'h' },
};

class Usage extends Error {}

function choices(argv) {
  let values;
  try {
    ({ values } = parseArgs({ args: argv, options: OPTIONS }));
  } catch (error) {
    throw new Usage(error.message);
  }
  if (values.help) return values;
  if ([values.list, values.lines, values.cut].filter((one) => one !== undefined).length !== 1) throw new Usage('one of --list, --lines and --cut is wanted');
  if (values.lines !== undefined && values.lang === undefined) throw new Usage('--lines: a language is wanted, too: --lang');
  if (values.output === undefined) throw new Usage('where to? --output');
  if (values.mouths !== undefined && values['no-align']) throw new Usage('--mouths: phones are wanted for it');
  const repetitions = values.repetitions === undefined ? undefined : Number(values.repetitions);
  if (repetitions !== undefined && !(Number.isInteger(repetitions) && repetitions >= 1 && repetitions <= 50)) throw new Usage(`--repetitions ${values.repetitions}: 1 to 50 are possible`);
  return { ...values, repetitions };
}

function makePage(options) {
  const list = options.list === undefined ? readLines(options.lines, options.lang) : readList(options.list);
  const data = JSON.stringify({ ...list, repetitions: options.repetitions ?? list.repetitions });
  fs.writeFileSync(options.output, pageText().replace('{{data}}', () => data.replaceAll('<', '\\u003c')));
  console.log(`${options.output}: ${list.items.length} items`);
}

function cut(options) {
  const { lang, takes } = readTakes(options.cut);
  const counts = new Map();
  let failed = 0;
  for (const folder of [options.output, options.mouths]) if (folder !== undefined) fs.mkdirSync(folder, { recursive: true });
  for (const take of takes) {
    const base = path.join(options.output, path.basename(take.file, path.extname(take.file)));
    try {
      const { seconds, mouths } = cutTake(path.join(options.cut, take.file), base, take, { program: options.faccia, models: options.models, lang: options.lang ?? lang, align: !options['no-align'], toneless: options['no-tone'] });
      if (options.mouths !== undefined) writeMouths(options.mouths, base, mouths, counts);
      console.log(`${take.file}: ${seconds.toFixed(2)} s`);
    } catch (error) {
      if (!(error instanceof TakeError)) throw error;
      failed++;
      console.error(`faccia: ${take.file}: ${error.message}`);
    }
  }
  if (failed) console.error(`faccia: ${failed} of ${takes.length} takes could not be cut`);
  return failed || !takes.length ? 1 : 0;
}

try {
  const options = choices(process.argv.slice(2));
  if (options.help) process.stdout.write(USAGE);
  else if (options.cut !== undefined) process.exitCode = cut(options);
  else makePage(options);
} catch (error) {
  if (error instanceof Usage) {
    console.error(`faccia: ${error.message}\nTry 'faccia session --help'.`);
    process.exitCode = 2;
  } else if (error instanceof ListError || error instanceof TakeError || error.code) {
    console.error(`faccia: ${error.message}`);
    process.exitCode = 1;
  } else throw error;
}
