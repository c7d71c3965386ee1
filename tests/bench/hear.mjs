// SPDX-License-Identifier: GPL-3.0-or-later
// What `faccia hear` sees in the voices of people that it was not trained on, beside a follower of loudness and chance: closed lips, teeth on the lip, rounding,
// +-40 ms about where `faccia align` with the text finds them, at each lookahead, in noise and in the band of a telephone; and how much of a core it takes.
// Wants Debian's asterisk-core-sounds-it and -it-wav (Italian, one man, 8 kHz) and pocketsphinx-testdata (English, five sentences of a reader).
// node tests/bench/hear.mjs [PROMPTS, 120] [--others FOLDER]
// FOLDER: where `npm install rhubarb-lip-sync-wasm wawa-lipsync` was run; then they hear the same in the same run, and, with ffmpeg, what Opus leaves of it is
// heard, too. Rhubarb takes twice as long as somebody speaks: 12 prompts are enough for it.
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { build } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { added, compared, correlation, follower, inNoise, kinds, telephone } from '../lib/hearing.mjs';
import { rhubarb, versionOf, wawa } from '../lib/hearing-others.mjs';
import { alignedPhones, prompts } from '../lib/prompts.mjs';
import { wavOf } from '../lib/wav.mjs';

const faccia = path.join(build, 'server/app/faccia');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const file = (name) => path.join(folder, name);
const run = (...options) => execFileSync(faccia, options, { stdio: ['ignore', 'pipe', 'pipe'], maxBuffer: 1 << 28 });

const samplesOf = (sound) => {
  const data = fs.readFileSync(sound), rate = data.readUInt32LE(24);
  const pcm = new Int16Array(data.buffer.slice(data.byteOffset + 44, data.byteOffset + data.length - (data.length % 2)));
  return { rate, samples: Float64Array.from(pcm, (x) => x / 32768) };
};

function english() {
  const place = '/usr/share/pocketsphinx/test/data/librivox';
  const lines = fs.readFileSync(path.join(place, 'transcription'), 'utf8').matchAll(/<s> (.*?) *<\/s> \((.*)\)/g);
  return [...lines].map(([, text, name]) => {
    fs.writeFileSync(file('text.txt'), text);
    const sound = path.join(place, `${name}.wav`);
    run('align', '-q', sound, '--text', file('text.txt'), '-l', 'en', '--json', file('align.json'));
    return { sound, phones: JSON.parse(fs.readFileSync(file('align.json'))).phones };
  });
}

const { values: { others }, positionals: [count] } = parseArgs({ options: { others: { type: 'string' } }, allowPositionals: true });
const all = prompts(), wanted = Number(count ?? 120);
const chosen = all.filter((_, i) => Math.floor(((i + 1) * wanted) / all.length) > Math.floor((i * wanted) / all.length));
const italian = chosen.map((prompt) => ({ sound: prompt.sound, phones: alignedPhones(faccia, prompt, folder) })).filter((p) => p.phones);
const sets = { Italian: italian, English: english() };

const hearing = (samples, rate, lookahead, lang) => {
  fs.writeFileSync(file('x.wav'), wavOf(Int16Array.from(samples, (x) => Math.max(-32768, Math.min(32767, Math.round(32768 * x)))), rate));
  run('hear', '-l', lang, '--lookahead', String(lookahead), '--json', file('x.json'), file('x.wav'));
  return JSON.parse(fs.readFileSync(file('x.json'))).phones;
};

/** Through Opus at 8 kbit/s and back, at 16 kHz. */
function opus(samples, rate) {
  const wav = wavOf(Int16Array.from(samples, (x) => Math.max(-32768, Math.min(32767, Math.round(32768 * x)))), rate);
  const ogg = execFileSync('ffmpeg', ['-v', 'error', '-i', '-', '-c:a', 'libopus', '-b:a', '8k', '-application', 'voip', '-f', 'ogg', '-'], { input: wav, maxBuffer: 1 << 26 });
  const raw = execFileSync('ffmpeg', ['-v', 'error', '-i', '-', '-f', 's16le', '-ar', '16000', '-ac', '1', '-'], { input: ogg, maxBuffer: 1 << 26 });
  return Float64Array.from({ length: raw.length >> 1 }, (_, i) => raw.readInt16LE(2 * i) / 32768);
}

const percent = (a, b) => (b ? `${Math.round((100 * a) / b)}` : '-').padStart(3);
const ears = others ? { rhubarb: await rhubarb(others), wawa: await wawa(others) } : {};
async function table(name, list, lang) {
  const seconds = list.reduce((sum, { phones }) => sum + phones.at(-1).end, 0);
  console.log(`\n${name}: ${list.length} recordings, ${seconds.toFixed(0)} s\n`);
  console.log('| sound | how | closed: found, false | teeth: found, false | rounded: found, false | by chance found |\n|---|---|---|---|---|---|');
  const same = (x) => x, loudness = (samples, rate) => follower(samples, rate), at = (ms) => (samples, rate) => hearing(samples, rate, ms, lang);
  const conditions = [
    ...[0, 40, 80, 120].map((ms) => ['clean', `${ms} ms`, same, at(ms)]),
    ...[20, 10, 5].map((db) => [`noise ${db} dB`, '80 ms', (x) => inNoise(x, db), at(80)]),
    ['telephone', '80 ms', telephone, at(80)],
    ...(others ? [['Opus 8 kbit/s', '80 ms', opus, (samples) => hearing(samples, 16000, 80, lang)]] : []),
    ['clean', 'loudness', same, loudness],
    ['noise 10 dB', 'loudness', (x) => inNoise(x, 10), loudness],
    ...(others ? [['clean', `rhubarb-lip-sync-wasm ${versionOf(others, 'rhubarb-lip-sync-wasm')}`, same, ears.rhubarb], ['clean', `wawa-lipsync ${versionOf(others, 'wawa-lipsync')}`, same, ears.wawa]] : []),
  ];
  for (const [what, how, through, ear] of conditions) {
    const sums = {}, chance = {};
    for (const { sound, phones } of list) {
      const { rate, samples } = samplesOf(sound), heard = await ear(through(samples, rate), rate);
      for (const kind of kinds) {
        sums[kind] = added(sums[kind], compared(kind, phones, heard));
        for (const shift of [-0.3, -0.2, 0.2, 0.3]) chance[kind] = added(chance[kind], compared(kind, phones, heard, { shift }));
      }
    }
    const cells = kinds.map((kind) => (how === 'loudness' && kind !== 'closed' ? '-' : `${percent(sums[kind].found, sums[kind].said)} %, ${percent(sums[kind].wrong, sums[kind].shown)} %`));
    const lucky = kinds.map((kind) => (how === 'loudness' && kind !== 'closed' ? '-' : percent(chance[kind].found, chance[kind].said).trim())).join(', ');
    console.log(`| ${what} | ${how} | ${cells.join(' | ')} | ${lucky} % |`);
  }
  console.log(`\nsaid: ${kinds.map((kind) => `${kind} ${list.reduce((sum, { phones }) => sum + compared(kind, phones, []).said, 0)}`).join(', ')}`);
}

// What is seen of the lips, FAP units: how far they are apart in the middle, how wide the mouth is, how far they are pushed forward, how low the jaw is.
const seen = { apart: (f) => -f[4] - f[5], wide: (f) => f[6] + f[7], forward: (f) => f[16] + f[17], jaw: (f) => f[3] };
const framesOf = (name) => parseFap(fs.readFileSync(file(name), 'utf8')).frames;

/** Beside the face that the default engine makes with the text, over the frames in which somebody speaks. */
function mouths(name, list, lang) {
  const faces = list.map(({ sound, phones }) => {
    fs.writeFileSync(file('phones.json'), JSON.stringify({ phones }));
    run('align', '-q', sound, '--timing', file('phones.json'), '-l', lang, '--still', '--fap', file('text.fap'));
    return framesOf('text.fap');
  });
  const speaks = (phones, k) => k / 25 >= phones.find((p) => p.ipa).start && k / 25 <= phones.findLast((p) => p.ipa).end;
  /** of: an item's frames as they are heard, each as numbers in the order of `seen`; their correlations with the text's. */
  const correlations = (of, kinds) => {
    const heard = list.map(of);
    return kinds.map((kind, n) => correlation(heard.flatMap((frames, i) => frames.flatMap((value, k) => (k < faces[i].length && speaks(list[i].phones, k) ? [[seen[kind](faces[i][k]), value[n]]] : [])))).toFixed(2));
  };
  const kinds = Object.keys(seen);
  console.log(`\n${name}, correlation with the face made with the text\n\n| mouth | lookahead | ${kinds.join(' | ')} |\n|---|---|---|---|---|---|`);
  for (const engine of ['network', 'dominance'])
    for (const lookahead of [0, 40, 80, 120]) {
      const heard = ({ sound }) => {
        run('hear', '-l', lang, '-e', engine, '--lookahead', String(lookahead), '--fap', file('x.fap'), sound);
        return framesOf('x.fap').map((f) => kinds.map((kind) => seen[kind](f)));
      };
      console.log(`| ${engine} | ${lookahead} ms | ${correlations(heard, kinds).join(' | ')} |`);
    }
  const loudness = ({ sound }) => {
    const { rate, samples } = samplesOf(sound), hop = rate / 25;
    return Array.from({ length: Math.floor(samples.length / hop) }, (_, k) => [Math.sqrt(samples.slice(Math.max(0, (k - 0.5) * hop), (k + 0.5) * hop).reduce((sum, x) => sum + x * x, 0) / hop)]);
  };
  console.log(`| opens with the amplitude | - | ${correlations(loudness, ['apart'])[0]} | - | - | - |`);
}
await table('Italian (asterisk-core-sounds-it-wav)', sets.Italian, 'it');
await table('English (pocketsphinx-testdata, librivox)', sets.English, 'en');
mouths('Italian', sets.Italian, 'it');
mouths('English', sets.English, 'en');

// The processor's time for a minute, without that for the start.
const { rate, samples } = samplesOf(sets.English[0].sound);
const used = (seconds) => {
  const long = Int16Array.from({ length: seconds * rate }, (_, i) => Math.round(32767 * samples[i % samples.length]));
  fs.writeFileSync(file('long.wav'), wavOf(long, rate));
  return execFileSync('bash', ['-c', `TIMEFORMAT='%U %S'; { time "${faccia}" hear --fap "${file('long.fap')}" "${file('long.wav')}"; } 2>&1`]).toString().trim().split(' ').reduce((sum, x) => sum + Number(x), 0);
};
console.log(`\nprocessor: ${((100 * (used(61) - used(1))) / 60).toFixed(1)} % of a core, face and all`);
fs.rmSync(folder, { recursive: true });
