// SPDX-License-Identifier: GPL-3.0-or-later
// Runs benchmarks, after installing what they need beyond server/run.sh: npm packages of the tests, Debian packages.
//     node tests/bench/run.mjs                      lists them
//     node tests/bench/run.mjs NAME [ARGUMENT]...   runs one
//     node tests/bench/run.mjs --moment [NAME]...   runs each with minimal work, to check that it still works
// Imports only Node.js modules, because it runs before anything is installed.
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const folder = fileURLToPath(new URL('.', import.meta.url));
const root = path.join(folder, '../..');

const browser = ['chromium', 'chromium-headless-shell'];
const italian = ['asterisk-core-sounds-it', 'asterisk-core-sounds-it-wav'];
const [lp, pc, slt, kal] = ['festvox-italp16k', 'festvox-itapc16k', 'festvox-us-slt-hts', 'festvox-kallpc16k'].map((voice) => ['festival', voice]);
const picture = (name) => path.join(process.env.FACCIA_ARTEFACTS ?? os.tmpdir(), `bench-${name}`);

/**
 * Benchmarks: `packages`, Debian packages; `moment`, arguments of the shortest run; `long`, why even that takes more than seconds; `without`, why there is
 * no short run.
 */
export const benchmarks = {
  ablation: { moment: ['tr'], long: 'speaks 25 sentences at three rates with five engines' },
  align: { packages: [...lp, ...pc, ...slt, ...kal, 'sox'], moment: ['kal', '2'], long: 'aligns recordings' },
  'align-confidence': { packages: [...italian, ...lp, ...pc, ...slt, ...kal], moment: ['4', '--voices', 'kal'], long: 'aligns recordings with texts of other words' },
  'align-people': { packages: italian, moment: ['4'], long: 'aligns recordings' },
  'align-recovery': { packages: italian, moment: ['6'], long: 'aligns recordings' },
  'align-truth': { packages: ['sox', 'pocketsphinx', 'pocketsphinx-en-us', 'pocketsphinx-testdata'], without: 'needs recordings that tests/bench/align-truth-people.py prepares' },
  broadcast: { moment: ['10'], long: 'builds against libwebsockets' },
  cache: { packages: ['redis-server', ...lp], moment: ['1', 'espeak:it'], long: 'speaks with and without each cache' },
  'cluster-rooms': { packages: ['redis-server'], moment: ['20', '2', '1', '1'], long: 'starts Redis and daemons for each turn' },
  coach: { packages: ['ffmpeg', ...italian, 'asterisk-core-sounds-en', 'asterisk-core-sounds-en-g722'], moment: ['4'], long: 'compares recordings of people' },
  'coach-picture': { packages: [...browser, 'ffmpeg'], moment: [picture('coach.webp')], long: 'films a head and draws a page' },
  conversation: { packages: ['pocketsphinx', 'pocketsphinx-en-us', 'flite', 'ffmpeg'], moment: ['--turns', '2', '--timed', '1'], long: 'listens in real time' },
  cpu: { packages: ['espeak-ng'], moment: ['2', '2', '1'] },
  crossings: { moment: ['--minutes', '0.05', '--affects', 'joy', 'mara'], long: 'loads a head and the sounds of all languages' },
  day: { moment: ['--hours', '0.01', '--minutes', '0.1'], long: 'speaks for a tenth of a minute' },
  'emotions-picture': { packages: browser, moment: ['mara', picture('emotions.webp')], long: 'draws a head seven times' },
  drive: { moment: ['3'] },
  engine: { packages: ['espeak-ng'], moment: [] },
  'export-loaders': { packages: browser, without: 'needs a folder with the npm packages of others' },
  faces: { packages: browser, moment: ['--turns', '1'], long: 'draws two faces' },
  film: { packages: ['chromium-headless-shell', 'ffmpeg'], moment: ['--seconds', '1', '--turns', '1', '--quality', 'low'], long: 'draws in software' },
  'first-media': { moment: ['1'] },
  'first-picture': { packages: browser, moment: ['1'], long: 'draws each head' },
  fps: { packages: browser, moment: ['--seconds', '1', '--turns', '1', '--only', 'low'], long: 'draws in software' },
  frame: { packages: browser, moment: ['--rounds', '1', '--frames', '1', '--level', 'low'], long: 'draws in software' },
  growth: { packages: ['redis-server'], moment: ['16', '0', '1', '2'], long: 'starts Redis and up to eight daemons' },
  hear: { packages: ['ffmpeg', 'festival', 'asterisk-core-sounds-it', 'asterisk-core-sounds-it-wav', 'asterisk-core-sounds-it-g722', 'asterisk-core-sounds-en',
    'asterisk-core-sounds-en-g722', 'asterisk-core-sounds-es', 'asterisk-core-sounds-es-g722', 'asterisk-core-sounds-fr', 'asterisk-core-sounds-fr-g722',
    'asterisk-core-sounds-ru', 'asterisk-core-sounds-ru-g722', 'pocketsphinx-testdata', 'festvox-kallpc16k'], moment: ['2', '--only', 'it8'], long: 'hears recordings twelve times' },
  'hear-picture': { packages: [...browser, 'pocketsphinx-testdata'], moment: [picture('hear.webp')], long: 'draws in real time' },
  idle: { moment: ['10'], long: 'watches for half a minute' },
  kiosk: { packages: browser, moment: ['--hours', '0.1', '--says', '10'], long: 'plays hours in a browser' },
  'kitchen-picture': { packages: browser, moment: [picture('kiosk.webp')], long: 'draws two pages' },
  layers: { moment: [] },
  library: { packages: ['sqlite3'], moment: ['1', '20'], long: 'indexes a megabyte' },
  'library-ahead': { packages: lp, moment: ['espeak:it', '2'], long: 'speaks a work ahead' },
  'library-load': { moment: ['4', '20', '1', '1'], long: 'searches for some seconds a turn' },
  lighthouse: { packages: browser, moment: ['voices'], long: 'audits a page twice' },
  'listening-picture': { packages: [...browser, 'pocketsphinx', 'pocketsphinx-en-us', 'flite', 'ffmpeg'], moment: [picture('listening.webp')], long: 'draws two pages' },
  live: { moment: ['2'] },
  'looks-picture': { packages: browser, moment: [picture('looks'), '--heads', 'mara', '--looks', 'rest', '--size', '200'], long: 'draws a head' },
  loudness: { packages: ['ffmpeg'], moment: ['tr'], long: 'speaks with every affect' },
  markup: { moment: [], long: 'reads hundreds of megabytes' },
  mouth: { packages: browser, moment: ['--rates', '160', '--engines', 'table'], long: 'speaks 25 sentences in four languages' },
  'mouth-blind': { packages: browser, moment: ['--out', picture('blind'), '--width', '60', 'mara'], long: 'draws twelve mouths' },
  'mouth-frames': { packages: browser, moment: ['--out', picture('frames.webp'), '--width', '60', '--every', '400', 'tr'], long: 'draws a mouth through a sentence' },
  'mouth-picture': { packages: browser, moment: ['mara', picture('mouth.png')], long: 'draws twelve mouths' },
  'mouth-shapes': { packages: browser, moment: ['--width', '100', 'tr'], long: 'draws and measures each sound of four languages' },
  open: { moment: ['1'] },
  people: { without: 'needs recordings of people, which tests/bench/people-fetch.py gets' },
  phones: { packages: [...lp, ...pc, ...slt, ...kal], moment: ['espeak:it'], long: 'speaks 25 sentences' },
  pictures: { packages: browser, moment: [], long: 'draws in software' },
  'portrait-picture': { packages: ['python3-skimage'], moment: [picture('portrait.webp')], long: 'makes a head and draws it' },
  portraits: { without: 'needs photographs of people' },
  poses: { packages: browser, moment: ['--only', 'smile'], long: 'draws a head and makes two of it' },
  readings: { moment: ['1', '0.1'] },
  'readings-others': { packages: ['espeak-ng', ...lp, ...kal], moment: ['5'], long: 'takes two packages from npm' },
  'seen-lips': { packages: [...browser, 'ffmpeg'], moment: ['--sentences', '0', '--lines', '480'], long: 'films a face' },
  sharing: { moment: [], long: 'packs all heads twice' },
  sides: { moment: [], long: 'makes three portraits' },
  skew: { packages: browser, moment: ['3', 'low'], long: 'draws in software for half a minute' },
  sound: { packages: ['sox', ...lp], moment: ['espeak:it'], long: 'codes some minutes of sound' },
  'speak-picture': { packages: browser, moment: [picture('picture.png')], long: 'draws a page' },
  speakers: { moment: ['--seconds', '2', '2'] },
  stall: { moment: ['1000'] },
  strict: { packages: ['libwebsockets-dev'], moment: [], long: 'waits for what libwebsockets never answers' },
  stream: { moment: ['2', '2'], long: 'listens in real time' },
  teeth: { packages: browser, moment: ['mara'], long: 'draws each sound' },
  tempo: { packages: [...italian, ...pc], moment: ['1', 'voice'], long: 'speaks at six rates' },
  'text-first': { packages: browser, moment: ['1'], long: 'loads pages over a slow line' },
  voices: { packages: ['espeak-ng', 'time', ...lp, ...pc], moment: ['3', 'espeak:it'], long: 'compares with other programs' },
};

const say = (text) => process.stderr.write(`${text}\n`);

/** Installs missing npm packages of the tests and Debian packages with server/setup.sh. */
function install(names) {
  const packages = [...new Set(names.flatMap((name) => benchmarks[name].packages ?? []))];
  execFileSync('sh', ['-euc', `root=$1; shift; die() { echo "bench: $*" >&2; exit 1; }; . "$root/server/setup.sh"
    need_modules "$root/tests"; [ $# = 0 ] || need_packages "$@"`, 'sh', root, ...packages], { stdio: ['ignore', 2, 'inherit'] });
  if (!fs.existsSync(path.join(root, 'build/build.ninja'))) throw new Error('build first: sh server/run.sh --build-only');
}

/** Runs a benchmark. @returns {{status: number, output: string, errors: string}} */
export function run(name, argv, { stdio = 'inherit', timeout } = {}) {
  const { status, signal, stdout = '', stderr = '' } = spawnSync(process.execPath, [path.join(folder, `${name}.mjs`), ...argv],
    { stdio, timeout, killSignal: 'SIGKILL', encoding: 'utf8', maxBuffer: 1 << 26 });
  return { status: signal ? 128 : status, output: `${stdout ?? ''}`, errors: `${stderr ?? ''}` };
}

function main([first, ...rest]) {
  if (!first) {
    for (const [name, { long, without }] of Object.entries(benchmarks)) {
      const about = fs.readFileSync(path.join(folder, `${name}.mjs`), 'utf8').split('\n')[1].replace(/^\/\/ /, '');
      console.log(`${name.padEnd(18)}${about}${long || without ? ` (${long ?? without})` : ''}`);
    }
    return 0;
  }
  const moment = first === '--moment';
  const names = moment ? (rest.length ? rest : Object.keys(benchmarks).filter((name) => benchmarks[name].moment)) : [first];
  const unknown = names.find((name) => !Object.hasOwn(benchmarks, name));
  if (unknown) {
    say(`No benchmark '${unknown}'. They are: ${Object.keys(benchmarks).join(' ')}`);
    return 2;
  }
  install(names);
  if (!moment) return run(first, rest).status;
  let failed = 0;
  for (const name of names) {
    const from = performance.now();
    const { status, output, errors } = run(name, benchmarks[name].moment ?? [], { stdio: ['ignore', 'pipe', 'pipe'] });
    const ok = status === 0 && output.trim();
    say(`${ok ? 'ok' : 'FAILED'} ${name} ${((performance.now() - from) / 1000).toFixed(1)} s`);
    if (!ok) {
      failed++;
      say(errors.slice(-2000));
    }
  }
  return failed ? 1 : 0;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) process.exitCode = main(process.argv.slice(2));
