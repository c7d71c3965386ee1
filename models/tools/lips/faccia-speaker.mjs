#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** Fits a speech pack to a film of a person reading, or measures how close each engine comes to the film: implements `faccia speaker` and `faccia eval --film`. */
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { fileURLToPath } from 'node:url';

const USAGE = `Usage: faccia speaker FILM --text WORDS [OPTION]...
       faccia speaker FILM... [OPTION]...
       faccia eval --film FILM --text WORDS [OPTION]...
Aligns a film's sound to its words, follows its lips in mm of the iris, prints how near each engine comes to them, and fits a speech pack to them, with
the error that it reaches on sounds that were held out. 'faccia eval --film' fits nothing. The words of several films are in NAME.txt beside NAME.mp4.

  -t, --text WORDS      what is said in the film
  -l, --lang TAG        it, pt-BR, tr, en, or any other that a voice speaks (it)
  -o, --output FILE     the pack; without it nothing is fitted
      --tag TAG         its language tag (that of the base, then -x-speaker)
      --film FILM       a film to compare with only; may be repeated
      --keep FOLDER     keeps the curves and phones there, for 'faccia eval --recording' and 'faccia fit'
      --faccia PROGRAM  the program (the one that was called, or faccia)
      --models DIR      its models (those of the program that was called)
      --engine NAME, --contacts HOW, --shift MS, --json FILE, --curve-table FILE   as for 'faccia eval --recording' (--contacts engine)
      --fps N, --rest FROM-TO, --iris MM, --pupils MM, --like HEAD   as for 'faccia head lips'
  -h, --help            print this and exit
Needs ffmpeg and Node.js, and for pictures the sources with npm's packages in web/ and models/. Exit status: 0 done, 1 failed, 2 wrong usage.
`;

const text = { type: 'string' };
const OF_LIPS = ['fps', 'rest', 'iris', 'pupils', 'like'];
const OF_EVAL = ['contacts', 'shift', 'json', 'curve-table'];
const OPTIONS = {
  text: { ...text, short: 't' }, lang: { ...text, short: 'l', default: 'it' }, output: { ...text, short: 'o' }, tag: text, film: { ...text, multiple: true }, keep: text,
  faccia: { ...text, default: 'faccia' }, models: text, engine: { ...text, short: 'e', multiple: true, default: [] },
  ...Object.fromEntries([...OF_LIPS, ...OF_EVAL].map((name) => [name, text])), help: { type: 'boolean', short: 'h' },
};

class Usage extends Error {}

function choices(argv) {
  let parsed;
  try {
    parsed = parseArgs({ args: argv, options: OPTIONS, allowPositionals: true });
  } catch (error) {
    throw new Usage(error.message);
  }
  const { values, positionals } = parsed;
  if (values.help) return values;
  if (values.film && values.output !== undefined) throw new Usage("--film: nothing is fitted to it; a pack is made by 'faccia speaker FILM --output FILE'");
  if (values.film && positionals.length) throw new Usage(`unexpected '${positionals[0]}': the words of a film are given with --text`);
  const films = values.film ?? positionals;
  if (!films.length) throw new Usage('a film is wanted');
  if (values.text !== undefined && films.length > 1) throw new Usage('--text is of one film; the words of several are in NAME.txt beside each');
  return { ...values, films };
}

/** Runs a program whose messages the user sees; throws when it fails. */
function run(program, args, options = {}) {
  const { status, error } = spawnSync(program, args, { stdio: ['ignore', 'inherit', 'inherit'], ...options });
  if (error) throw new Error(`${program}: ${error.code === 'ENOENT' ? 'is not installed' : error.message}`);
  if (status !== 0) throw new Error(`${path.basename(program)} failed`);
}

const faccia = ({ faccia: program, models }, args) => run(program, [...(models === undefined ? [] : ['--models', models]), ...args]);

function words(film, given) {
  if (given !== undefined) return given;
  const beside = path.join(path.dirname(film), `${path.parse(film).name}.txt`);
  if (!fs.existsSync(beside)) throw new Usage(`${film}: its words are wanted, with --text or in ${beside}`);
  return fs.readFileSync(beside, 'utf8');
}

/** Returns the files of a film's curves and phones in the folder. @returns {{ curves: string, phones: string }} */
function follow(film, number, folder, options) {
  const at = (ending) => path.join(folder, `${number}-${path.parse(film).name}.${ending}`);
  if (!fs.existsSync(film)) throw new Error(`${film}: no such file`);
  fs.writeFileSync(at('txt'), words(film, options.text));
  console.error(`${film}: aligning its sound to the words`);
  run('ffmpeg', ['-v', 'error', '-y', '-i', film, '-ac', '1', '-ar', '16000', at('wav')]);
  faccia(options, ['align', '--certain', '--lang', options.lang, '--quiet', '--text', at('txt'), '--json', at('json'), at('wav')]);
  console.error(`${film}: following its lips`);
  const lips = OF_LIPS.flatMap((name) => (options[name] === undefined ? [] : [`--${name}`, options[name]]));
  run(process.execPath, [fileURLToPath(new URL('faccia-lips.mjs', import.meta.url)), path.resolve(film), ...lips, '-o', at('csv')]);
  return { curves: at('csv'), phones: at('json') };
}

function main(argv) {
  const options = choices(argv);
  if (options.help) return process.stdout.write(USAGE);
  const folder = options.keep ?? fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-speaker-'));
  fs.mkdirSync(folder, { recursive: true });
  try {
    const recordings = options.films.map((film, i) => follow(film, i + 1, folder, options));
    const asked = [...OF_EVAL.map((name) => [name, name === 'contacts' ? (options.contacts ?? 'engine') : options[name]]), ...options.engine.map((name) => ['engine', name])];
    faccia(options, ['eval', '--lang', options.lang, ...asked.flatMap(([name, value]) => (value === undefined ? [] : [`--${name}`, value])), ...recordings.flatMap(({ curves, phones }) => ['--recording', curves, '--phones', phones])]);
    if (!options.output) return;
    const tag = options.tag ?? `${options.lang}-x-speaker`;
    faccia(options, ['fit', '--rest', '--own', '--base', options.lang, '--tag', tag, '--output', options.output, ...recordings.map(({ curves }) => curves)]);
    console.error(`${options.output}: put it into models/speech/${tag}.json; 'faccia eval --lang ${tag} --recording ...' tells how near it comes`);
  } finally {
    if (!options.keep) fs.rmSync(folder, { recursive: true, force: true });
  }
}

try {
  main(process.argv.slice(2));
} catch (error) {
  console.error(`faccia speaker: ${error.message}${error instanceof Usage ? "\nTry 'faccia speaker --help'." : ''}`);
  process.exit(error instanceof Usage ? 2 : 1);
}
