// SPDX-License-Identifier: GPL-3.0-or-later
// POST /v1/audio/speech, as the `openai` package of npm calls it.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import OpenAI from 'openai';
import { Daemon, build } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-openai-'));
const secret = path.join(folder, 'secret');
fs.writeFileSync(secret, `${'k'.repeat(40)}\n`, { mode: 0o600 });
let daemon, client;
before(async () => {
  daemon = await Daemon.start(['--lang', 'en']);
  client = new OpenAI({ apiKey: 'none', baseURL: `${daemon.url}/v1`, maxRetries: 0 });
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const speak = async (more) => {
  const answer = await client.audio.speech.create({ model: 'tts-1', voice: 'alloy', input: 'The train leaves at **noon**.', ...more });
  return { type: answer.headers.get('content-type'), data: Buffer.from(await answer.arrayBuffer()) };
};
const list = async (path) => (await daemon.get(path)).json();
const seconds = (pcm) => pcm.length / 2 / 24000;

test('each format of the client, mp3 if it names none', async () => {
  const begins = { mp3: ['audio/mpeg', /^\xff[\xe0-\xff]/], opus: ['audio/ogg', /^OggS/], aac: ['audio/aac', /^\xff[\xf0-\xf9]/], flac: ['audio/flac', /^fLaC/], wav: ['audio/wav', /^RIFF/] };
  for (const [format, [type, magic]] of Object.entries(begins)) {
    const answer = await speak({ response_format: format });
    assert.equal(answer.type, type);
    assert.match(answer.data.toString('latin1'), magic);
  }
  assert.equal((await speak({})).type, 'audio/mpeg');
  const wav = await speak({ response_format: 'wav' }), pcm = await speak({ response_format: 'pcm' });
  const expected = (wav.data.length - 44) / 2 / wav.data.readUInt32LE(24);
  assert.ok(expected > 0.8 && Math.abs(seconds(pcm.data) - expected) < 0.01, `${seconds(pcm.data)} s of ${expected}`);
});

test('what clients choose from: models, voices; each can be spoken with', async () => {
  assert.deepEqual((await client.models.list()).data.map(({ id, object }) => [id, object]), ['tts-1', 'tts-1-hd', 'gpt-4o-mini-tts'].map((id) => [id, 'model']));
  const { models } = await list('/v1/audio/models'), { voices } = await list('/v1/audio/voices');
  assert.ok(models.some(({ id }) => id === 'tts-1'));
  const own = (await list('/v1/voices')).voices;
  assert.deepEqual(voices.filter(({ lang }) => lang).map(({ id }) => id), own.map(({ id }) => id));
  assert.ok(voices.every(({ id, name }) => id && name));
  for (const voice of ['alloy', 'verse', own.find(({ lang }) => lang === 'tr').id]) {
    assert.ok(voices.some(({ id }) => id === voice), voice);
    assert.ok((await speak({ voice, response_format: 'pcm' })).data.length > 10000, voice);
  }
});

test('aac: ffmpeg hears the sound of the wav', async () => {
  const pcmOf = (format, data) => execFileSync('ffmpeg', ['-v', 'error', '-f', format, '-i', '-', '-f', 's16le', '-ac', '1', '-ar', '22050', '-'], { input: data, maxBuffer: 1 << 26 });
  const energy = (pcm) => Array.from({ length: Math.floor(pcm.length / 4410) }, (_, i) => Array.from({ length: 2205 }, (__, k) => pcm.readInt16LE(4410 * i + 2 * k) ** 2).reduce((a, b) => a + b) / 2205);
  const loudness = async (format) => energy(pcmOf(format, (await speak({ response_format: format, input: 'The train leaves at noon, and nobody waits.' })).data)).map((e) => 10 * Math.log10(e + 100));
  const [wav, aac] = [await loudness('wav'), await loudness('aac')];
  assert.ok(aac.length >= wav.length && aac.length < wav.length + 4, `${aac.length} of ${wav.length}`);
  const mean = (values) => values.reduce((a, b) => a + b) / values.length;
  const same = (by) => { // correlation with the sound `by` tenths of a second later
    const pairs = wav.map((a, i) => [a, aac[i + by] ?? 20]);
    const [x, y] = [0, 1].map((k) => mean(pairs.map((pair) => pair[k])));
    const sum = (f) => pairs.reduce((total, [a, b]) => total + f(a - x, b - y), 0);
    return sum((a, b) => a * b) / Math.sqrt(sum((a) => a * a) * sum((_, b) => b * b));
  };
  assert.ok(Math.max(same(0), same(1)) > 0.9, `${same(0)} ${same(1)}`);
});

test('json: words and visemes with their times; Markdown is not said', async () => {
  const timing = JSON.parse((await speak({ response_format: 'json' })).data);
  assert.deepEqual(timing.words.map(({ text }) => text), ['The', 'train', 'leaves', 'at', 'noon']);
  assert.ok(timing.phones.some(({ sampa }) => sampa === 'u:' || sampa === 'u'), JSON.stringify(timing.phones));
});

test('voices by gender, by their own name, and as objects', async () => {
  const voice = async (name) => JSON.parse((await speak({ response_format: 'json', voice: name })).data).voice;
  const { voices } = await list('/v1/voices');
  const gender = (id) => voices.find((each) => each.id === id).gender;
  assert.equal(gender(await voice('nova')), 'female');
  assert.equal(gender(await voice('onyx')), 'male');
  assert.equal(await voice('espeak:en-gb'), 'espeak:en-gb');
  assert.equal(await voice({ id: 'espeak:en-gb' }), 'espeak:en-gb');
});

test('speed is a factor of the voice\'s own', async () => {
  const [slow, usual, fast] = await Promise.all([0.5, 1, 2].map((speed) => speak({ response_format: 'pcm', speed })));
  assert.ok(seconds(slow.data) > 1.6 * seconds(usual.data) && seconds(fast.data) < 0.65 * seconds(usual.data), `${[slow, usual, fast].map(({ data }) => seconds(data))}`);
});

test('instructions: the first affect that they name, unless it is denied', async () => {
  const said = async (instructions) => (await speak({ response_format: 'pcm', instructions })).data;
  const affect = async (name) => Buffer.from(await (await daemon.get(`/v1/speech?lang=en&format=pcm&affect=${name}&text=${encodeURIComponent('The train leaves at **noon**.')}`)).arrayBuffer());
  const plain = await said(undefined), sad = await affect('sadness');
  assert.notDeepEqual(plain, sad);
  assert.deepEqual(await said('Not angry, please: speak in a SAD and weary tone.'), sad);
  assert.deepEqual(await said('Speak clearly.'), plain);
});

test('a stream of events', async () => {
  const answer = await client.audio.speech.create({ model: 'tts-1', voice: 'nova', input: 'One. Two.', response_format: 'pcm', stream_format: 'sse' });
  assert.equal(answer.headers.get('content-type'), 'text/event-stream');
  const events = (await answer.text()).split('\n\n').filter(Boolean).map((line) => JSON.parse(line.replace(/^data: /, '')));
  assert.deepEqual(events.pop(), { type: 'speech.audio.done', usage: { input_tokens: 0, output_tokens: 0, total_tokens: 0 } });
  assert.ok(events.length > 1 && events.every(({ type }) => type === 'speech.audio.delta'));
  const whole = Buffer.concat(events.map(({ audio }) => Buffer.from(audio, 'base64')));
  assert.deepEqual(whole, (await speak({ voice: 'nova', input: 'One. Two.', response_format: 'pcm' })).data);
  // a format that is written at its end is one event
  const flac = await client.audio.speech.create({ model: 'x', voice: 'nova', input: 'One.', response_format: 'flac', stream_format: 'sse' });
  assert.equal((await flac.text()).match(/audio\.delta/g).length, 1);
});

test('what is wrong is said in the client\'s form, with its parameter', async () => {
  const fails = (more, status, code, param) => assert.rejects(speak(more), (error) => {
    assert.deepEqual([error.status, error.code, error.param, error.type], [status, code, param, 'invalid_request_error'], error.message);
    return error.message.length > 20 && error.message.includes(param ?? "speak");
  });
  await fails({ response_format: 'amr' }, 400, 'unknown-format', 'response_format');
  await fails({ voice: 'nobody' }, 400, 'unknown-voice', 'voice');
  await fails({ voice: 7 }, 400, 'bad-field', 'voice');
  await fails({ speed: 9 }, 400, 'bad-field', 'speed');
  await fails({ input: '' }, 400, 'empty-text', null);
  await fails({ input: undefined }, 400, 'missing-field', 'input');
  await fails({ stream_format: 'xml' }, 400, 'bad-field', 'stream_format');
  await fails({ instructions: ['sad'] }, 400, 'bad-field', 'instructions');
  await fails({ input: 'a'.repeat(100001) }, 413, 'text-too-long', 'input');
  const broken = await fetch(`${daemon.url}/v1/audio/speech`, { method: 'POST', headers: { 'content-type': 'application/json' }, body: '{"input":' });
  assert.deepEqual([broken.status, (await broken.json()).error.code], [400, 'bad-json']);
});

test('the key is the token', async () => {
  const own = await Daemon.start(['--secret-file', secret]);
  const token = execFileSync(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secret, '--subject', 'app', '--rights', 'speak'], { encoding: 'utf8' }).trim();
  const ask = (apiKey) => new OpenAI({ apiKey, baseURL: `${own.url}/v1`, maxRetries: 0 }).audio.speech.create({ model: 'x', voice: 'alloy', input: 'Sì.' });
  assert.equal((await ask(token)).status, 200);
  await assert.rejects(ask('none'), { status: 401 });
  assert.equal((await own.stop()).code, 0);
});
