// SPDX-License-Identifier: GPL-3.0-or-later
// The pronunciation coach: POST /v1/coach and `faccia coach`, with recordings of other voices than the model's.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { spoken } from '../../lib/heard-speech.mjs';
import { wavOf } from '../../lib/wav.mjs';

const TEXT = 'La mamma mangia il pane nella casa.', MODEL = 'espeak:it+f2', LEARNER = 'espeak:it';
const SECONDS = 6, RATE = 16000;

let daemon;
before(async () => {
  daemon = await Daemon.start(['--coach-seconds', String(SECONDS)]);
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null }, daemon.log);
});

/** A recording of somebody who says the text. */
async function said(text, more = {}) {
  const query = new URLSearchParams({ lang: 'it', voice: LEARNER, format: 'wav', text, ...more });
  return Buffer.from(await (await daemon.get(`/v1/speech?${query}`)).arrayBuffer());
}

async function compare(body, query = {}, options = {}) {
  const members = new URLSearchParams({ lang: 'it', voice: MODEL, text: TEXT, ...query });
  for (const [name, value] of [...members]) if (value === 'undefined') members.delete(name);
  const answer = await daemon.get(`/v1/coach?${members}`, { method: 'POST', body, headers: { 'content-type': 'audio/wav' }, ...options });
  return { status: answer.status, ...(await answer.json()) };
}

const share = (phones, state) => phones.filter((phone) => phone.state === state).length / phones.length;
const phonesOf = ({ words, phones }, text) => phones.filter(({ word }) => words[word].text === text);
const silence = (seconds, rate = RATE) => wavOf(new Int16Array(seconds * rate), rate);

test('the text said by another voice: most is good, nothing is different, and the times are in order', async () => {
  const answer = await compare(await said(TEXT));
  assert.equal(answer.status, 200, JSON.stringify(answer));
  assert.equal(answer.other, false);
  assert.equal(answer.voice, MODEL);
  assert.deepEqual(answer.words.map(({ text }) => text), TEXT.replace('.', '').split(' '));
  assert.ok(share(answer.phones, 'good') > 0.6 && share(answer.phones, 'different') === 0, JSON.stringify(answer.phones));
  for (const list of [answer.words, answer.phones])
    list.forEach((one, i) => {
      assert.ok(one.end >= one.start && one.model_end > one.model_start, JSON.stringify(one));
      if (i) assert.ok(one.start >= list[i - 1].start, JSON.stringify(one));
    });
  for (const { text, utf16_start, utf16_end } of answer.words) assert.equal(TEXT.slice(utf16_start, utf16_end), text);
  assert.deepEqual(phonesOf(answer, 'mamma').map(({ class: own }) => own), ['closed', 'open', 'closed', 'closed', 'open']);
});

test('one vowel is another: that phone is different, and says what is heard', async () => {
  const answer = await compare(await said(TEXT.replace('casa', 'cosa')));
  const different = answer.phones.filter(({ state }) => state === 'different');
  assert.deepEqual(different.map(({ ipa, class: own, heard }) => [ipa, own, heard]), [['a', 'open', 'middle-round']], JSON.stringify(answer.phones));
  assert.equal(answer.words[different[0].word].text, 'casa');
  assert.equal(answer.words[different[0].word].state, 'different');
});

test('other words are told, and nobody is called wrong', async () => {
  const answer = await compare(await said('Il sole tramonta dietro le colline verdi.'));
  assert.equal(answer.other, true);
  assert.equal(share(answer.phones, 'unsure'), 1);
});

test('a recording with pauses, silence around it and stereo is compared as well', async () => {
  const wav = await said('<speak>La mamma, <break time="700ms"/> mangia il pane <break time="500ms"/> nella casa.</speak>', { markup: 'ssml' });
  const samples = new Int16Array(wav.buffer.slice(wav.byteOffset + 44, wav.byteOffset + wav.length - (wav.length % 2))), rate = wav.readUInt32LE(24);
  const stereo = new Int16Array(2 * (samples.length + rate));
  samples.forEach((x, i) => stereo.fill(x, 2 * (i + rate / 2), 2 * (i + rate / 2) + 2));
  const answer = await compare(wavOf(stereo, rate, 2));
  assert.ok(share(answer.phones, 'good') > 0.6 && share(answer.phones, 'different') === 0, JSON.stringify(answer.phones));
  assert.ok(answer.words[0].start > 0.4, JSON.stringify(answer.words[0]));
});

test('FLAC and Ogg are read like WAV; a film container is refused', async () => {
  const wav = await said(TEXT), states = (await compare(wav)).words.map(({ state }) => state);
  const coded = (...args) => {
    const { stdout, stderr } = spawnSync('ffmpeg', ['-loglevel', 'error', '-i', '-', ...args, '-'], { input: wav, maxBuffer: 1 << 26 });
    assert.ok(stdout.length, String(stderr));
    return stdout;
  };
  assert.deepEqual((await compare(coded('-f', 'flac'))).words.map(({ state }) => state), states);
  const opus = await compare(coded('-c:a', 'libopus', '-b:a', '32k', '-f', 'ogg'));
  assert.ok(opus.status === 200 && share(opus.phones, 'good') > 0.5, JSON.stringify(opus));
  const webm = await compare(coded('-c:a', 'libopus', '-f', 'webm'));
  assert.equal(`${webm.status} ${webm.code}`, '400 bad-sound');
});

test('bad input has its error, and costs nobody else anything', async () => {
  const wav = await said(TEXT);
  const cases = [
    [wav, { text: undefined }, '400 missing-field'],
    [wav, { text: '' }, '400 empty-text'],
    [wav, { text: '...' }, '400 empty-text'],
    [wav, { voice: 'nobody' }, '400 unknown-voice'],
    [wav, { passage: 'none:1', text: undefined }, '404 unknown-passage'],
    [wav, { text: `${TEXT} `.repeat(12) }, '413 text-too-long'],
    [Buffer.alloc(0), {}, '400 bad-sound'],
    [Buffer.from('no sound at all'), {}, '400 bad-sound'],
    [wav.subarray(0, 44), {}, '400 bad-sound'],
    [silence(2), {}, '400 misaligned'],
    [silence(0.05), {}, '400 misaligned'],
    [silence(SECONDS + 1), {}, '413 media-too-large'],
    [Buffer.alloc(SECONDS * 48000 * 8 + (1 << 17)), {}, '413 media-too-large'],
    [silence(1, 4000), {}, '400 bad-sound'],
  ];
  for (const [body, query, wanted] of cases) {
    const { status, code, message } = await compare(body, query);
    assert.equal(`${status} ${code}`, wanted, `${JSON.stringify(query).slice(0, 80)} ${message}`);
  }
  for (let i = 0; i < 24; i++) {
    const damaged = Buffer.from(wav.subarray(0, wav.length >> (i % 3)));
    for (let k = 0; k <= i; k++) damaged[(k * 7919 + i * 104729) % (i % 2 ? 44 : damaged.length)] ^= 1 << (k % 8);
    const { status } = await compare(damaged);
    assert.ok([200, 400, 413].includes(status), String(status));
  }
  const noise = Int16Array.from({ length: 2 * RATE }, (_, i) => ((i * 1103515245 + 12345) >> 8) % 20000);
  const loud = await compare(wavOf(noise, RATE));
  assert.ok(loud.status === 400 || share(loud.phones, 'different') === 0, JSON.stringify(loud));
  assert.equal((await compare(wav)).status, 200);
});

test('a client may have two in work, and gets its places back when it leaves', async () => {
  const wav = await said(TEXT);
  const answers = await Promise.all(Array.from({ length: 6 }, () => compare(wav)));
  const count = (wanted) => answers.filter(({ status, code }) => `${status} ${code ?? ''}`.trim() === wanted).length;
  assert.equal(count('200') + count('503 queue-full'), 6, JSON.stringify(answers.map(({ status, code }) => [status, code])));
  assert.ok(count('200') >= 2 && count('503 queue-full') >= 1, JSON.stringify(answers.map(({ status }) => status)));
  const request = `POST /v1/coach?lang=it&text=Ciao HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: ${wav.length}\r\n\r\n`;
  for (const part of [0, 1000, wav.length])
    for (let i = 0; i < 2; i++) {
      const socket = net.connect(daemon.port, '127.0.0.1', () => socket.write(Buffer.concat([Buffer.from(request), wav.subarray(0, part)]), () => setTimeout(() => socket.destroy(), 20 * i)));
      await new Promise((resolve) => socket.on('close', resolve));
    }
  await eventually(async () => (await compare(wav)).status === 200, 'a free place');
});

test('where it is turned off, or not allowed, it says so', async () => {
  const off = await Daemon.start(['--coach-seconds', '0']);
  try {
    const answer = await off.get('/v1/coach?lang=it&text=ciao', { method: 'POST', body: silence(1) });
    assert.equal(answer.status, 503);
    assert.equal((await answer.json()).code, 'no-coach');
    assert.equal((await off.get('/v1/coach?text=ciao')).status, 405);
  } finally {
    await off.stop();
  }
  const secret = path.join(fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-coach-')), 'secret');
  fs.writeFileSync(secret, 'a secret of the tests, of thirty-two bytes and more\n', { mode: 0o600 });
  const closed = await Daemon.start(['--secret-file', secret]);
  try {
    assert.equal((await closed.get('/v1/coach?lang=it&text=ciao', { method: 'POST', body: silence(1) })).status, 401);
  } finally {
    await closed.stop();
    fs.rmSync(path.dirname(secret), { recursive: true });
  }
});

test('faccia coach prints the comparison, and hears what the daemon does', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-coach-')), file = path.join(folder, 'a.wav');
  try {
    fs.writeFileSync(file, spoken('We call it bear.'));
    const table = faccia(['coach', '-l', 'en', file, 'We call it bear.']);
    assert.equal(table.status, 0, table.stderr);
    const lines = table.stdout.trim().split('\n');
    assert.equal(lines.length, 4, table.stdout);
    assert.match(lines[3], /bear +\w+ +b/);
    const { status, stdout } = faccia(['coach', '-l', 'en', '-v', 'espeak:en-us+f2', '--json', '-', file, 'We call it bear.']);
    assert.equal(status, 0);
    const { status: code, ...answer } = await compare(fs.readFileSync(file), { lang: 'en', voice: 'espeak:en-us+f2', text: 'We call it bear.' });
    assert.equal(code, 200);
    const heard = ({ words, phones }) => [words.map(({ text, state }) => [text, state]), phones.map(({ ipa, class: own, heard: other }) => [ipa, own, other])];
    assert.deepEqual(heard(JSON.parse(stdout)), heard(answer));
    for (const [args, wanted] of [[['coach'], 2], [['coach', file, 'ciao', '-v', 'nobody'], 2], [['coach', '/none.wav', 'ciao'], 1], [['coach', '--help'], 0]])
      assert.equal(faccia(args).status, wanted, args.join(' '));
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
});
