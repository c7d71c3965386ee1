// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy of `faccia hear` on speakers outside its training set, beside a loudness follower and the chance level: closed lips, teeth on lip and rounding
// within +-40 ms of their alignment by `faccia align` with the text, at each lookahead, in noise, in telephone bandwidth and through Opus; and its CPU load.
// Needs ffmpeg and Debian's asterisk-core-sounds-it, -it-wav, -it-g722 (Italian, a man, 8 and 16 kHz), -en, -es, -fr, -ru with -g722 (English and Spanish: the same woman; French and
// Russian: one other speaker each), pocketsphinx-testdata (English, five sentences) and festvox-kallpc16k (a voice with known phone times).
// Joins the recordings of each speaker with half a second of silence between.
// node tests/bench/run.mjs hear [PROMPTS of each, 40] [--only NAME,...] [--others FOLDER] [--truth FOLDER]
// `faccia align` hears with the same network; independent are KAL, and with --truth the people of tests/bench/align-truth-people.py (its output), whose phones
// were labelled (`truth`).
// FOLDER: where `npm install rhubarb-lip-sync-wasm wawa-lipsync` was run; also measures these packages. Rhubarb takes twice real time.
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { build } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { added, classOf, compared, correlation, follower, inNoise, kinds, telephone } from '../lib/hearing.mjs';
import { rhubarb, versionOf, wawa } from '../lib/hearing-others.mjs';
import { alignedPhones, prompts } from '../lib/prompts.mjs';
import { wavOf } from '../lib/wav.mjs';

const faccia = path.join(build, 'server/cli/faccia');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const file = (name) => path.join(folder, name);
const run = (...options) => execFileSync(faccia, options, { stdio: ['ignore', 'pipe', 'pipe'], maxBuffer: 1 << 28 });

const samplesOf = (sound) => {
  const data = fs.readFileSync(sound), rate = data.readUInt32LE(24);
  const pcm = new Int16Array(data.buffer.slice(data.byteOffset + 44, data.byteOffset + data.length - (data.length % 2)));
  return { rate, samples: Float64Array.from(pcm, (x) => x / 32768) };
};

/** Converts a 16 kHz G.722 recording to WAV. */
function wide(prompt) {
  const sound = file(`${prompt.lang}-${prompt.name.replace('/', '-')}.wav`);
  execFileSync('ffmpeg', ['-v', 'error', '-y', '-f', 'g722', '-i', prompt.sound, '-bitexact', sound]);
  return { ...prompt, sound };
}

/** Evenly chosen prompts that the aligner accepts: [{sound, phones}]. */
function reader(lang, suffix) {
  const all = prompts(lang, suffix), chosen = all.filter((_, i) => Math.floor(((i + 1) * wanted) / all.length) > Math.floor((i * wanted) / all.length));
  return chosen.map((prompt) => (suffix === 'wav' ? prompt : wide(prompt))).map((prompt) => ({ sound: prompt.sound, phones: alignedPhones(faccia, prompt, folder) })).filter((p) => p.phones);
}

function sphinx() {
  const place = '/usr/share/pocketsphinx/test/data/librivox';
  const lines = fs.readFileSync(path.join(place, 'transcription'), 'utf8').matchAll(/<s> (.*?) *<\/s> \((.*)\)/g);
  return [...lines].map(([, text, name]) => ({ sound: path.join(place, `${name}.wav`), phones: aligned(path.join(place, `${name}.wav`), text) }));
}

/** Aligns an English recording. */
function aligned(sound, text) {
  fs.writeFileSync(file('text.txt'), text);
  run('align', '-q', sound, '--text', file('text.txt'), '-l', 'en', '--json', file('align.json'));
  return JSON.parse(fs.readFileSync(file('align.json'))).phones;
}

const SAID = ['My brother put the paper boat in the bath before five.', 'Every Friday we visit the village by the river.', 'Please move the blue van from in front of my gate.',
  'The baby began to laugh when the puppy barked.', 'Never leave the oven on for more than half an hour.', 'I believe the map was published above a bookshop.',
  'Perhaps the farmer will buy some sheep and a bull.', 'We climbed up the steep path with heavy bags.', 'The chief of police found a knife behind the shelf.', 'Five brave women saved a family from the flood.'];
/** A voice with known times, against which the alignment can be measured, too. */
function kal() {
  return SAID.map((text, k) => {
    const sound = file(`kal-${k}.wav`);
    run('say', '-l', 'en', '-v', 'festival:kal', '--wav', sound, '--json', file('kal.json'), text);
    return { sound, text, phones: JSON.parse(fs.readFileSync(file('kal.json'))).phones };
  });
}

const { values: { others, only, truth }, positionals: [count] } = parseArgs({ options: { others: { type: 'string' }, only: { type: 'string' }, truth: { type: 'string' } }, allowPositionals: true });

// The sounds that are compared; all others count alike.
const ARPABET = { P: 'p', B: 'b', M: 'm', F: 'f', V: 'v', W: 'w', UW: 'u', UH: 'ʊ', OW: 'oʊ', AO: 'ɔ', OY: 'ɔɪ', SH: 'ʃ', ZH: 'ʒ', CH: 'tʃ', JH: 'dʒ' };
const SAMPA = { O: 'ɔ', 'O:': 'ɔ', OI: 'ɔ', U: 'ʊ', S: 'ʃ', Z: 'ʒ', tS: 'tʃ', dZ: 'dʒ', 't_S': 'tʃ', 'P\\': 'v' };

/** People with labelled phones, as 16 kHz. Without the Russian, whom the network learnt from. */
function labelled(place) {
  return fs.readdirSync(place).filter((name) => name.endsWith('.truth.json')).map((name) => ({ name: name.slice(0, -'.truth.json'.length), ...JSON.parse(fs.readFileSync(path.join(place, name))) }))
    .filter(({ phones, lang }) => phones.length && lang !== 'ru')
    .map(({ name, phones: labels }) => {
      const arpabet = labels.every(({ label }) => !/[a-z]/.test(label));
      const phones = labels.map(({ label, ...times }) => ({ ...times, ipa: arpabet ? (ARPABET[label.replace(/\d/, '')] ?? 'ə') : (SAMPA[label] ?? (/^[pbmfvwuo]/.test(label) ? label : 'ə')) }));
      execFileSync('ffmpeg', ['-v', 'error', '-y', '-i', path.join(place, `${name}.wav`), '-ar', '16000', '-ac', '1', '-bitexact', file(`truth-${name}.wav`)]);
      return { sound: file(`truth-${name}.wav`), phones };
    });
}

const wanted = Number(count ?? 40);
const people = {
  it8: ['Italian, a man, 8 kHz (asterisk-core-sounds-it-wav)', 'it', () => reader('it', 'wav')],
  it16: ['Italian, the same man, 16 kHz (asterisk-core-sounds-it-g722)', 'it', () => reader('it', 'g722')],
  librivox: ['English, a reader (pocketsphinx-testdata, librivox)', 'en', sphinx],
  en: ['English, a woman (asterisk-core-sounds-en-g722)', 'en', () => reader('en', 'g722')],
  es: ['Spanish, the same woman (asterisk-core-sounds-es-g722)', 'es', () => reader('es', 'g722')],
  fr: ['French, a woman (asterisk-core-sounds-fr-g722)', 'fr', () => reader('fr', 'g722')],
  ru: ['Russian, a woman (asterisk-core-sounds-ru-g722)', 'ru', () => reader('ru', 'g722')],
  kal: ["English, Festival's KAL, by its own times", 'en', kal],
  ...(truth ? { truth: ['English, and a Czech: nine people by labels that no aligner of ours made', 'en', () => labelled(truth)] } : {}),
};
const chosen = only ? only.split(',') : Object.keys(people);

/** Joins recordings: {samples, rate, phones}. */
function together(list) {
  const samples = [], phones = [];
  let rate = 0;
  for (const { sound, phones: own } of list) {
    const one = samplesOf(sound), from = samples.length / one.rate;
    rate = one.rate;
    phones.push(...own.map((p) => ({ ...p, start: p.start + from, end: p.end + from })));
    for (const x of one.samples) samples.push(x);
    for (let i = 0; i < rate / 2; i++) samples.push(0);
    phones.push({ ipa: '', start: phones.at(-1).end, end: samples.length / rate });
  }
  return { samples: Float64Array.from(samples), rate, phones };
}

const write = (name, samples, rate) => fs.writeFileSync(file(name), wavOf(Int16Array.from(samples, (x) => Math.max(-32768, Math.min(32767, Math.round(32768 * x)))), rate));
const hearing = (samples, rate, lookahead, lang) => {
  write('x.wav', samples, rate);
  run('hear', '-l', lang, '--lookahead', String(lookahead), '--json', file('x.json'), file('x.wav'));
  return JSON.parse(fs.readFileSync(file('x.json'))).phones;
};

/** Encodes and decodes with Opus at 8 kbit/s, 16 kHz. */
function opus(samples, rate) {
  write('x.wav', samples, rate);
  const ogg = execFileSync('ffmpeg', ['-v', 'error', '-i', file('x.wav'), '-c:a', 'libopus', '-b:a', '8k', '-application', 'voip', '-f', 'ogg', '-'], { maxBuffer: 1 << 26 });
  const raw = execFileSync('ffmpeg', ['-v', 'error', '-i', '-', '-f', 's16le', '-ar', '16000', '-ac', '1', '-'], { input: ogg, maxBuffer: 1 << 28 });
  return Float64Array.from({ length: raw.length >> 1 }, (_, i) => raw.readInt16LE(2 * i) / 32768);
}

const percent = (a, b) => (b ? `${Math.round((100 * a) / b)}` : '-');
const LOOKAHEADS = [0, 40, 80, 120];
const ears = others ? { rhubarb: await rhubarb(others), wawa: await wawa(others) } : {};
async function table(name, { samples, rate, phones, list }, lang) {
  const said = kinds.map((kind) => `${kind} ${compared(kind, phones, []).said}`).join(', ');
  console.log(`\n${name}: ${list.length} recordings, ${phones.at(-1).end.toFixed(0)} s; said: ${said}\n`);
  console.log('Found/false, %, at 0, 40, 80, 120 ms; in brackets what chance would find at 80 ms\n');
  console.log(`| sound | how | ${kinds.join(' | ')} |\n|---|---|---|---|---|`);
  const same = (x) => x, ours = (samples, rate) => LOOKAHEADS.map((ms) => hearing(samples, rate, ms, lang)), loudness = (samples, rate) => [follower(samples, rate)];
  const ear = (which) => async (samples, rate) => [await ears[which](samples, rate)];
  const conditions = [
    ['clean', 'faccia', same, ours],
    ...[20, 10, 5].map((db) => [`noise ${db} dB`, 'faccia', (x) => inNoise(x, db), ours]),
    ['telephone', 'faccia', telephone, ours],
    ['Opus 8 kbit/s', 'faccia', opus, (samples) => ours(samples, 16000)],
    ['clean', 'loudness', same, loudness],
    ['noise 10 dB', 'loudness', (x) => inNoise(x, 10), loudness],
    ...(list[0].text ? [['clean', 'faccia align, with the text', same, () => [together(list.map((item) => ({ ...item, phones: aligned(item.sound, item.text) }))).phones.map((p) => ({ ...p, class: classOf(p.ipa) }))]]] : []),
    ...(others ? [['rhubarb', 'rhubarb-lip-sync-wasm'], ['wawa', 'wawa-lipsync']].map(([which, package_]) => ['clean', `${package_} ${versionOf(others, package_)}`, same, ear(which)]) : []),
  ];
  for (const [what, how, through, ear] of conditions) {
    const heard = await ear(through(samples, rate), rate), settled = heard[2] ?? heard[0];
    const cell = (kind) => {
      const each = heard.map((one) => compared(kind, phones, one)).map((sum) => `${percent(sum.found, sum.said)}/${percent(sum.wrong, sum.shown)}`);
      const chance = [-0.3, -0.2, 0.2, 0.3].map((shift) => compared(kind, phones, settled, { shift })).reduce(added);
      return `${each.join(' ')} (${percent(chance.found, chance.said)})`;
    };
    console.log(`| ${what} | ${how} | ${kinds.map((kind) => (how === 'loudness' && kind !== 'closed' ? '-' : cell(kind))).join(' | ')} |`);
  }
}

// Visible lip measures, FAP units: gap in the middle, width, protrusion, jaw opening.
const seen = { apart: (f) => -f[4] - f[5], wide: (f) => f[6] + f[7], forward: (f) => f[16] + f[17], jaw: (f) => f[3] };
const framesOf = (name) => parseFap(fs.readFileSync(file(name), 'utf8')).frames;

/** Compares with the face of the default engine from the text, during speech. */
function mouths(name, { samples, rate, phones }, lang) {
  fs.writeFileSync(file('phones.json'), JSON.stringify({ phones }));
  write('all.wav', samples, rate);
  run('align', '-q', file('all.wav'), '--timing', file('phones.json'), '-l', lang, '--still', '--fap', file('text.fap'));
  const face = framesOf('text.fap'), kinds = Object.keys(seen), hop = rate / 25;
  const speaks = Array.from(face, () => false);
  for (const { ipa, start, end } of phones) if (ipa) speaks.fill(true, Math.ceil(25 * start), Math.floor(25 * end) + 1);
  /** Correlations with the text's face. of: recognised frames as arrays in the order of `kinds`. */
  const correlations = (of, kinds) => kinds.map((kind, n) => correlation(of.flatMap((value, k) => (k < face.length && speaks[k] ? [[seen[kind](face[k]), value[n]]] : []))).toFixed(2));
  console.log(`\n${name}, correlation with the face made with the text\n\n| mouth | lookahead | ${kinds.join(' | ')} |\n|---|---|---|---|---|---|`);
  for (const engine of ['network', 'dominance'])
    for (const lookahead of LOOKAHEADS) {
      run('hear', '-l', lang, '-e', engine, '--lookahead', String(lookahead), '--fap', file('x.fap'), file('all.wav'));
      console.log(`| ${engine} | ${lookahead} ms | ${correlations(framesOf('x.fap').map((f) => kinds.map((kind) => seen[kind](f))), kinds).join(' | ')} |`);
    }
  const loudness = Array.from(face, (_, k) => [Math.sqrt(samples.slice(Math.max(0, (k - 0.5) * hop), (k + 0.5) * hop).reduce((sum, x) => sum + x * x, 0) / hop)]);
  console.log(`| opens with the amplitude | - | ${correlations(loudness, ['apart'])[0]} | - | - | - |`);
}

let spoken;
for (const name of chosen) {
  const [title, lang, of] = people[name], list = of();
  spoken = { ...together(list), list };
  await table(title, spoken, lang);
  mouths(title, spoken, lang);
}

// CPU time per minute, without startup.
const { rate, samples } = spoken;
const used = (seconds) => {
  const long = Int16Array.from({ length: seconds * rate }, (_, i) => Math.round(32767 * samples[i % samples.length]));
  fs.writeFileSync(file('long.wav'), wavOf(long, rate));
  return execFileSync('bash', ['-c', `TIMEFORMAT='%U %S'; { time "${faccia}" hear --fap "${file('long.fap')}" "${file('long.wav')}"; } 2>&1`]).toString().trim().split(' ').reduce((sum, x) => sum + Number(x), 0);
};
console.log(`\nprocessor: ${((100 * (used(61) - used(1))) / 60).toFixed(1)} % of a core, face and all`);
fs.rmSync(folder, { recursive: true });
