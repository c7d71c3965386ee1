// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts and openings of 25 sentences a language, at four rates, neutral and in five emotions, by both blends, with all engines of the
// language. Usage: node tests/bench/run.mjs mouth [--pixels [--sentences 3 | --all]] [--contacts on|off|engine] [--rates 80,320]
// [--engines dominance,syllable] [--list] [LANG]...
// Measures mm from the FAPs at 50 fps; with --pixels, drawn frames at 25 fps while the sounds are heard, of the first --sentences (3), neutral and in
// two emotions at 320 words a minute, or of --all. --list prints failures.
import path from 'node:path';
import { parseArgs } from 'node:util';
import { launch } from '../lib/browser.mjs';
import { build } from '../lib/daemon.mjs';
import { mouthPixels, readPixels } from '../lib/mouth-pixels.mjs';
import { spoken, voiced } from '../lib/mouth-poses.mjs';
import { SHORT, addMouth, readMouth } from '../lib/mouth.mjs';
import { sentences } from '../lib/sentences.mjs';

const { values: wanted, positionals } = parseArgs({
  allowPositionals: true,
  options: { pixels: { type: 'boolean' }, all: { type: 'boolean' }, contacts: { type: 'string', default: 'on' }, rates: { type: 'string' }, engines: { type: 'string' }, sentences: { type: 'string', default: '3' }, list: { type: 'boolean' } },
});
const few = wanted.pixels && !wanted.all;
const rates = (wanted.rates ?? (few ? '320' : '80,160,240,320')).split(',');
const emotions = few ? [null, 'anger', 'happiness'] : [null, 'anger', 'happiness', 'sadness', 'surprise', 'disgust'];
const blends = few ? ['regions'] : ['regions', 'weighted'];
const own = { 'pt-BR': ['context'], tr: ['syllable'] };
for (const [name, at] of [['MODELS', 'models'], ['PLUGINS', 'server/plugins'], ['WORKER', 'server/voice/faccia-voice']]) process.env[`FACCIA_${name}`] ??= path.join(build, at);
const browser = wanted.pixels ? await launch({ forced: false }) : undefined;
const screen = browser && (await mouthPixels(browser));

async function speak(lang, engine, rate, emotion, blend) {
  const text = voiced(sentences[lang].slice(0, few ? Number(wanted.sentences) : undefined).join('\n'), emotion);
  const args = ['--lang', lang, '--engine', engine, '--rate', rate, '--blend', blend, '--contacts', wanted.contacts, '--markup', 'ssml', '--fps', screen ? 25 : 50];
  let track;
  try {
    track = spoken(text, ...args);
  } catch {
    track = spoken(text, ...args); // retries, because a voice may start too slowly on a busy machine
  }
  return screen ? readPixels(screen.look, track.phones, track) : readMouth(track.phones, track);
}

const percent = (part, all) => (part === all ? '100' : ((100 * part) / all).toFixed(1));
const langs = positionals.length ? positionals : Object.keys(sentences);
console.log(`contacts ${wanted.contacts}, ${screen ? 'as drawn at 25 frames a second' : 'in mm at 50 frames a second'}; each cell: % of lips closed, of lip at teeth; ` +
  `open vowels below 3 mm, the median opening\n\n| | sounds | ${rates.join(' | ')} |\n|---|---|${rates.map(() => '---|').join('')}`);
const short = {};
for (const lang of langs)
  for (const engine of ['dominance', ...(own[lang] ?? []), 'cohen-massaro', 'table']) {
    if (wanted.engines && !wanted.engines.split(',').includes(engine)) continue;
    const cells = [];
    let count;
    for (const rate of rates) {
      let sum = {};
      for (const blend of blends) for (const emotion of emotions) sum = addMouth(sum, await speak(lang, engine, rate, emotion, blend));
      const gaps = sum.gaps.map(({ mm }) => mm).sort((a, b) => a - b);
      const below = sum.gaps.filter(({ mm }) => mm < 3);
      cells.push(`${percent(sum.closed, sum.lips)}, ${percent(sum.met, sum.teeth)}; ${below.length}, ${gaps[gaps.length >> 1].toFixed(1)} mm`);
      count = `${sum.lips}, ${sum.teeth}, ${sum.open}`;
      const rest = (short[rate] ??= { all: 0, brief: 0, least: Infinity });
      rest.all += below.length;
      for (const { seconds, mm } of below) {
        rest.brief += seconds < SHORT;
        if (seconds >= SHORT) rest.least = Math.min(rest.least, mm);
      }
      if (!wanted.list) continue;
      for (const { phone, mm } of below) console.error(`${lang} ${engine} ${rate}: /${phone.ipa}/ of ${Math.round(1000 * (phone.end - phone.start))} ms at ${phone.start.toFixed(2)}: ${mm.toFixed(1)} mm`);
      for (const miss of sum.misses) console.error(`${lang} ${engine} ${rate}: missed`, miss);
    }
    console.log(`| ${lang} ${engine} | ${count} | ${cells.join(' | ')} |`);
  }
for (const [rate, { all, brief, least }] of Object.entries(short))
  console.log(`\n${rate} words a minute: ${all} open vowels below 3 mm, ${brief} of them under ${SHORT * 1000} ms${all > brief ? `; the least of the others ${least.toFixed(1)} mm` : ''}`);
await screen?.close();
await browser?.close();
