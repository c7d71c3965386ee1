// SPDX-License-Identifier: GPL-3.0-or-later
// Lip recognition from sound alone: any sound format, in any pieces; accuracy with a voice that the network was not trained on.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { build } from '../../lib/daemon.mjs';
import { compared, correlation } from '../../lib/hearing.mjs';
import { cases, further } from '../../lib/long.mjs';
import { wavOf } from '../../lib/wav.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const hear = (args, input) => faccia(['hear', ...args], { input });
const sound = (name, seconds, rate, channels, of) => {
  const samples = Int16Array.from({ length: Math.round(seconds * rate) * channels }, (_, i) => Math.max(-32768, Math.min(32767, 32768 * of(Math.floor(i / channels) / rate, i % channels))));
  fs.writeFileSync(file(name), wavOf(samples, rate, channels));
  return file(name);
};
const lines = (text) => text.trim().split('\n').map((line) => JSON.parse(line));
const heard = (args, input, options = []) => {
  const { status, stdout, stderr } = faccia([...options, 'hear', ...args], { input });
  assert.equal(status, 0, stderr);
  assert.equal(stderr, '');
  const all = lines(stdout);
  return { frames: all.filter((l) => l.type === 'frame'), phones: all.filter((l) => l.type === 'phone') };
};
/** Gap between the inner lips in the middle, FAP units. */
const gap = ({ faps }) => -((faps[4] ?? 0) + (faps[5] ?? 0));

const say = (name, lang, voice, text) => {
  const { status, stderr } = faccia(['say', '-l', lang, '-v', voice, '--wav', file(`${name}.wav`), '--json', file(`${name}.json`), text]);
  assert.equal(status, 0, stderr);
  return { wav: file(`${name}.wav`), phones: JSON.parse(fs.readFileSync(file(`${name}.json`))).phones };
};
// Spanish is not in the training set
const spoken = say('es', 'es', 'espeak:es', `Mi primo Pablo compra pan y tomates en la plaza. Un poco más tarde prepara la sopa para mamá.
  El tren de la mañana sale a las siete, y nosotros tenemos que llegar antes. ¿Dónde está la llave de la puerta grande? La busco desde el lunes.
  En el jardín de mi abuela hay rosas, limones y un banco viejo. Todos los domingos comemos juntos bajo el árbol.`);

for (const [what, of] of [['silence', () => 0], ['its mean alone', () => 0.4], ['a hum far below speech', (t) => 0.0005 * Math.sin(314 * t)]])
  test(`${what}: the lips rest`, () => {
    const { frames, phones } = heard([sound('rest.wav', 3, 16000, 1, of)]);
    assert.equal(frames.length, 75);
    assert.ok(frames.every((f) => Object.keys(f.faps).every((n) => !(n >= 4 && n <= 11))), JSON.stringify(frames.find((f) => Object.keys(f.faps).length)));
    assert.deepEqual(phones.map((p) => p.class), ['silence']);
  });

test('the lips rest after speech', () => {
  const { samples, rate } = read(spoken.wav);
  const long = new Int16Array(samples.length + 2 * rate);
  long.set(samples);
  fs.writeFileSync(file('long.wav'), wavOf(long, rate));
  const { frames } = heard([file('long.wav')]);
  assert.ok(frames.slice(0, -50).some((f) => gap(f) > 50));
  assert.ok(frames.slice(-25).every((f) => gap(f) === 0));
});

/** Synthetic music without speech: chords, a beat of noise and thumps, and a tune. Takes s, returns -1..1. */
const noise = ((seed) => () => ((seed = (seed * 1103515245 + 12345) % 2147483648) / 1073741824 - 1))(7);
const band = (t) => {
  const beat = t % 0.5, bar = Math.floor(t / 2) % 4, root = [196, 147, 165, 131][bar];
  const chord = [1, 1.25, 1.5, 2].reduce((sum, m) => sum + [1, 2, 3, 4].reduce((all, n) => all + Math.sin(6.2832 * root * m * n * t) / n, 0), 0) / 14;
  const tune = Math.sin(6.2832 * 4 * root * [1, 1.125, 1.25, 1.5][Math.floor(t / 0.25) % 4] * t) * Math.exp(-6 * (t % 0.25));
  return 0.5 * (chord * Math.exp(-0.6 * (t % 2)) + 0.2 * tune + 0.5 * Math.exp(-25 * beat) * Math.sin(6.2832 * 65 * beat) + 0.25 * Math.exp(-40 * ((t + 0.25) % 0.5)) * noise());
};

/** Makes a models folder with a modified network. */
function modelsWith(change) {
  const own = path.resolve(build, process.env.FACCIA_MODELS ?? 'models'), models = fs.mkdtempSync(file('models-'));
  fs.mkdirSync(path.join(models, 'hear'));
  fs.symlinkSync(path.join(own, 'speech'), path.join(models, 'speech'));
  const network = fs.readFileSync(path.join(own, 'hear/network.bin'));
  fs.writeFileSync(path.join(models, 'hear/network.bin'), change(network));
  return models;
}

test('in music the lips rest after a second, and later speech is shown', further, () => {
  const alone = heard([sound('music.wav', 12, 16000, 1, band)]).frames, resting = alone.slice(25).filter((f) => gap(f) === 0).length;
  assert.ok(resting >= 0.9 * (alone.length - 25), `${resting} of ${alone.length - 25} frames at rest`);
  // the network's speech detector keeps the mouth closed: with its bias (last in the file) at the maximum it does not
  const models = modelsWith((network) => Buffer.concat([network.subarray(0, -2), Buffer.of(0xff, 0x7b)]));
  const deaf = heard([file('music.wav')], undefined, ['--models', models]).frames.slice(25);
  assert.ok(deaf.filter((f) => gap(f) === 0).length < 0.3 * deaf.length);
  const { rate, samples } = read(spoken.wav), music = Array.from({ length: 6 * rate }, (_, i) => Math.round(16000 * band(i / rate)));
  fs.writeFileSync(file('then.wav'), wavOf(Int16Array.from([...music, ...samples]), rate));
  const closed = heard([file('then.wav')]).phones.map((p) => ({ ...p, start: p.start - 6, end: p.end - 6 })), found = compared('closed', spoken.phones, closed), without = compared('closed', spoken.phones, heard([spoken.wav]).phones);
  assert.ok(found.found >= without.found - 3, `${found.found} of ${found.said}, ${without.found} without music before`);
});

test('sound reduced to its signs still gives a face of the right length, within bounds', () => {
  const { frames } = heard([sound('loud.wav', 2, 22050, 1, (t) => 9 * Math.sin(900 * t) * Math.sin(9 * t))]);
  assert.equal(frames.length, 50);
  assert.ok(frames.every((f) => Object.values(f.faps).every((x) => Math.abs(x) < 2000)));
});

function read(wav) {
  const data = fs.readFileSync(wav);
  return { rate: data.readUInt32LE(24), samples: new Int16Array(data.buffer.slice(data.byteOffset + 44)) };
}

test('closes at the same times from 8 to 96 kHz and with one and eight channels', further, () => {
  const { rate, samples } = read(spoken.wav);
  const at = (t) => {
    const x = t * rate, i = Math.min(samples.length - 2, Math.floor(x));
    return (samples[i] + (x - i) * (samples[i + 1] - samples[i])) / 32768;
  };
  const closed = ({ phones }) => phones.filter((p) => p.class === 'closed');
  const whole = closed(heard([spoken.wav]));
  for (const [hz, channels] of [[8000, 1], [16000, 8], [44100, 2], [96000, 1]]) {
    const other = closed(heard([sound('rate.wav', samples.length / rate, hz, channels, at)]));
    const same = whole.filter((a) => other.some((b) => b.start < a.end && a.start < b.end)).length;
    assert.ok(same >= 0.75 * whole.length, `${hz} Hz, ${channels} channels: ${same} of ${whole.length}`);
  }
});

test('gives the same result to the last bit in one piece or many, from a file or standard input', () => {
  const { rate, samples } = read(spoken.wav);
  const whole = hear(['--ndjson', '-', spoken.wav]).stdout, raw = Buffer.from(samples.buffer);
  assert.ok(whole.length > 10000);
  assert.equal(hear(['--raw', String(rate), '--ndjson', '-', '-'], raw).stdout, whole);
  fs.writeFileSync(file('raw'), raw);
  const slow = spawnSync('sh', ['-c', 'dd if="$1" bs=997 status=none | "$0" hear --raw "$2" -', path.join(build, 'server/cli/faccia'), file('raw'), String(rate)], { maxBuffer: 1 << 28 });
  assert.equal(String(slow.stdout), whole);
});

test('files: as many frames as the sound is long, with contacts', () => {
  const { status, stderr } = hear(['--fps', '30', '--fap', file('a.fap'), '--json', file('a.json'), spoken.wav]);
  assert.equal(status, 0, stderr);
  const { rate, samples } = read(spoken.wav), seconds = samples.length / rate;
  const fap = fs.readFileSync(file('a.fap'), 'utf8').trim().split('\n'), count = Math.ceil(seconds * 30 - 1e-6);
  assert.equal(fap[0], `2.1 faccia 30 ${count}`);
  assert.equal(fap.length, 1 + 2 * count);
  const { phones, lookahead } = JSON.parse(fs.readFileSync(file('a.json')));
  assert.equal(lookahead, 0.08);
  phones.forEach((p, i) => assert.ok(p.end > p.start && (!i || p.start === phones[i - 1].end) && p.sure >= 0 && p.sure <= 1));
  assert.equal(phones[0].start, 0);
  assert.ok(Math.abs(phones.at(-1).end - seconds) < 0.03);
});

for (const ms of cases([0, 120], [40, 80]))
  test(`an unseen voice: most /p b m/ close, ${ms} ms after`, () => {
    const { frames, phones } = heard(['--fps', '50', '--lookahead', String(ms), spoken.wav]);
    const found = compared('closed', spoken.phones, phones), lucky = [-0.3, -0.2, 0.2, 0.3].map((shift) => compared('closed', spoken.phones, phones, { shift }));
    const chance = lucky.reduce((sum, x) => sum + x.found, 0) / lucky.reduce((sum, x) => sum + x.said, 0);
    assert.ok(found.said > 15 && found.found > 0.7 * found.said, `${found.found} of ${found.said}`);
    assert.ok(found.found / found.said > chance + 0.25, `${found.found} of ${found.said}, by chance ${chance.toFixed(2)}`);
    // the face shows it: lips meet, and open for vowels
    const closed = phones.filter((p) => p.class === 'closed' && p.end - p.start > 0.03);
    const shut = closed.filter((p) => frames.some((f) => f.time >= p.start - 0.01 && f.time <= p.end + 0.01 && gap(f) <= 0)).length;
    assert.ok(shut >= 0.9 * closed.length, `${shut} of ${closed.length} closures are seen`);
    const open = phones.filter((p) => p.class === 'open' && p.end - p.start > 0.06);
    assert.ok(open.filter((p) => frames.some((f) => f.time >= p.start && f.time <= p.end && gap(f) > 30)).length >= 0.8 * open.length);
  });

test('uses the network\'s own mouth, or a named engine on the same sounds', () => {
  const [own, named, engine] = [[], ['-e', 'network'], ['-e', 'dominance']].map((args) => heard([...args, spoken.wav]));
  assert.deepEqual(named, own);
  assert.deepEqual(engine.phones, own.phones);
  const wide = ({ faps }) => (faps[6] ?? 0) + (faps[7] ?? 0);
  const between = (of) => correlation(own.frames.map((f, k) => [of(f), of(engine.frames[k])]));
  for (const of of [gap, wide]) assert.ok(between(of) > 0.5 && between(of) < 0.99, `${between(of)}`);
});

test('say --voice-file takes a recording instead of a text', () => {
  const { status, stdout } = faccia(['say', '-l', 'it', '--fps', '30', '--voice-file', spoken.wav, '--json', '-']);
  assert.equal(status, 0);
  assert.equal(stdout, hear(['-l', 'it', '--fps', '30', '--json', '-', spoken.wav]).stdout);
  for (const phone of JSON.parse(stdout).phones) {
    const sum = Object.values(phone.likely).reduce((a, b) => a + b, 0);
    assert.ok(phone.likely[phone.class] > 0 && Math.abs(sum - 1) < 0.15, JSON.stringify(phone));
  }
  for (const [args, message] of [[['ciao'], /'ciao' is not used here: .*faccia align/], [['--wav', 'a.wav'], /wav/]]) {
    const refused = faccia(['say', '--voice-file', spoken.wav, ...args]);
    assert.equal(refused.status, 2);
    assert.match(refused.stderr, message);
  }
});

test('uses and names the general lips for a language without a pack', () => {
  const { status, stdout, stderr } = hear(['-l', 'x"', '--json', '-', sound('rest.wav', 0.5, 16000, 1, () => 0)]);
  assert.equal(status, 0, stderr);
  assert.equal(JSON.parse(stdout).lang, 'und');
});

fs.writeFileSync(file('empty.wav'), '');
fs.writeFileSync(file('none.wav'), wavOf(new Int16Array(0), 16000));
fs.writeFileSync(file('text.wav'), 'no sound');
for (const [what, args, status, message] of [
  ['an empty file', ['empty.wav'], 1, /empty\.wav: /],
  ['no samples', ['none.wav'], 1, /none\.wav: contains no sound/],
  ['a text', ['text.wav'], 1, /text\.wav: /],
  ['nothing there', ['nowhere.wav'], 1, /nowhere\.wav: /],
  ['too slow', ['slow.wav'], 1, /4000 samples a second; 8000 to 96000/],
  ['too many channels', ['many.wav'], 1, /9 channels; at most 8/],
  ['a lookahead that it has not', ['--lookahead', '50', 'rest.wav'], 2, /lookahead: there is no lookahead of 50 ms/],
  ['an engine that is none', ['--engine', 'x', 'rest.wav'], 2, /engine: unknown engine 'x'/],
  ['standard input without a rate', ['-'], 2, /--raw and - belong together/],
  ['a rate with a file', ['--raw', '16000', 'rest.wav'], 2, /--raw and - belong together/],
  ['a rate out of range', ['--raw', '7000', '-'], 2, /--raw: must be an integer from 8000 to 96000/],
  ['two files to standard output', ['--fap', '-', '--json', '-', 'rest.wav'], 1, /only one file can go to standard output/],
  ['no sound', [], 2, /exactly one sound file is needed/],
  ['with its text', ['--text', 'a.txt', 'rest.wav'], 2, /'a\.txt' is not used here: with a transcript, use 'faccia align SOUND --text FILE'/],
])
  test(`${what}: reports it and writes nothing`, () => {
    sound('rest.wav', 0.2, 16000, 1, () => 0);
    sound('slow.wav', 0.2, 4000, 1, () => 0);
    sound('many.wav', 0.2, 16000, 9, () => 0);
    const result = hear(args.map((a) => (a.endsWith('.wav') ? file(a) : a)));
    assert.equal(result.status, status, result.stderr);
    assert.match(result.stderr, message);
    assert.equal(result.stderr.trim().split('\n').length, 1);
    assert.equal(result.stdout, '');
  });

test('a truncated file gives the face of its beginning', () => {
  const data = fs.readFileSync(spoken.wav);
  fs.writeFileSync(file('cut.wav'), data.subarray(0, data.length / 2 - 1));
  const { frames } = heard([file('cut.wav')]);
  const seconds = (data.length / 2 - 45) / 2 / data.readUInt32LE(24);
  assert.ok(Math.abs(frames.length - 25 * seconds) < 2, `${frames.length}`);
});

test('reports a broken network', () => {
  const models = modelsWith(() => Buffer.from('FACHEAR2'));
  const { status, stderr } = faccia(['--models', models, 'hear', spoken.wav]);
  assert.equal(status, 1);
  assert.match(stderr, /network\.bin: this is not a lip recogniser's network/);
});
