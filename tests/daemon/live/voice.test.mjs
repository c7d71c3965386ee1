// SPDX-License-Identifier: GPL-3.0-or-later
// Live voices: a client sends sound in real time, and listeners get it with a face. The speaker is a voice of espeak-ng that the network was not trained on.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { build, Daemon, eventually, framesOf } from '../../lib/daemon.mjs';
import { MOUTH } from '../../lib/face.mjs';
import { compared } from '../../lib/hearing.mjs';
import { violations } from '../../lib/schema.mjs';
import { bearer, sign } from '../../lib/tokens.mjs';
import { wavOf } from '../../lib/wav.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const file = (name) => path.join(folder, name);
const faccia = (...args) => {
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), args, { maxBuffer: 1 << 28 });
  assert.equal(status, 0, String(stderr));
  return String(stdout);
};

let daemon, spoken;
before(async () => {
  faccia('say', '-l', 'es', '-v', 'espeak:es', '--wav', file('es.wav'), '--json', file('es.json'), 'Mi primo Pablo compra pan y tomates en la plaza.');
  const data = fs.readFileSync(file('es.wav'));
  spoken = { rate: data.readUInt32LE(24), samples: new Int16Array(data.buffer.slice(data.byteOffset + 44)), phones: JSON.parse(fs.readFileSync(file('es.json'))).phones };
  fs.writeFileSync(file('v.wav'), wavOf(spoken.samples, spoken.rate));
  spoken.heard = faccia('hear', '-l', 'es', '--fps', '50', '--ndjson', '-', '--json', file('v.json'), file('v.wav')).trim().split('\n').map((line) => JSON.parse(line));
  spoken.classes = JSON.parse(fs.readFileSync(file('v.json'))).phones;
  daemon = await Daemon.start(['--open-seconds', '4', '--max-voices', '3', '--max-queue', '2']);
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

/** Resamples the sound, the same on all channels. */
const resampled = (rate, channels = 1) =>
  Int16Array.from({ length: Math.floor((spoken.samples.length / spoken.rate) * rate) * channels }, (_, i) => {
    const x = (Math.floor(i / channels) / rate) * spoken.rate, k = Math.min(spoken.samples.length - 2, Math.floor(x));
    return spoken.samples[k] + (x - k) * (spoken.samples[k + 1] - spoken.samples[k]);
  });
const bytesOf = (samples) => Buffer.from(samples.buffer, samples.byteOffset, samples.byteLength);

/** Sends like a microphone, at `speed` times real time. */
async function pour(stream, bytes, bytesASecond, { speed = 1, ms = 20 } = {}) {
  const begin = performance.now();
  for (let at = 0; at < bytes.length;) {
    const due = Math.min(bytes.length, Math.ceil(((performance.now() - begin + ms) / 1000) * speed * bytesASecond));
    for (; at < due; at = Math.min(due, at + 200000)) stream.socket.send(bytes.subarray(at, Math.min(due, at + 200000)));
    await sleep(ms);
  }
}
const begin = (stream, id, more = {}) => stream.send({ type: 'voice', id, codec: 'pcm_s16le', rate: spoken.rate, lang: 'es', ...more });
const ended = (stream, id) => stream.wait({ type: 'end', id });
const valid = (stream) => stream.messages.forEach(({ arrived, ...message }) => assert.equal(violations('server', message), null, `${arrived} ${JSON.stringify(message)}`));
const soundOf = (chunks) => chunks.flatMap((c) => [...(c.audio ?? new Int16Array(c.samples))]);
const mouth = ({ values }) => MOUTH.filter((n) => n !== 12 && n !== 13 && n !== 59 && n !== 60).map((n) => values[n] ?? 0).join();
const told = (stream, type) => stream.messages.filter((m) => m.type === type).map((m) => m.code);

/**
 * Sends the whole sound; repeats it if the machine was so busy that sound was dropped, or came so late that silence was put in its
 * place. beside: runs along with each attempt and is awaited.
 */
async function live(bytes, bytesASecond, more, { beside = () => {}, ...how } = {}) {
  for (let again = 0; ; again++) {
    const stream = await daemon.stream();
    begin(stream, 'v', more);
    const pouring = pour(stream, bytes, bytesASecond, how), besides = beside();
    await pouring;
    stream.send({ type: 'close', id: 'v' });
    const end = await ended(stream, 'v'), other = await besides;
    const late = end.reason === 'done' && end.duration > bytes.length / bytesASecond + 0.01;
    if (again === 3 || !(late || told(stream, 'warning').includes('skipped'))) return { stream, end, other };
    await stream.close();
  }
}

test('returns the sound unchanged, with the face that `faccia hear` generates from it', async () => {
  const { stream, end } = await live(bytesOf(spoken.samples), 2 * spoken.rate, { still: true, fps: 50 });
  const first = stream.messages.find((m) => m.type === 'begin');
  assert.equal(end.reason, 'done');
  assert.deepEqual([first.rate, first.fps, first.lang, first.engine, first.lookahead, first.captions], [spoken.rate, 50, 'es', 'network', 80, false]);
  assert.ok(!('voice' in first) && !('markup' in first));
  assert.deepEqual(told(stream, 'error').concat(told(stream, 'warning')), []);
  assert.deepEqual(stream.messages.map((m) => m.type), ['hello', 'begin', 'end']);
  valid(stream);
  const sound = soundOf(stream.chunks);
  assert.equal(sound.length, Math.round(end.duration * spoken.rate));
  assert.deepEqual(sound, [...spoken.samples]);
  const held = spoken.heard.filter((l) => l.type === 'frame');
  const frames = framesOf(stream.chunks);
  assert.equal(frames.length, held.length);
  frames.forEach((frame, k) => assert.equal(mouth(frame), mouth({ values: held[k].faps }), `frame ${k}`));
  // the lips close on most /p b m/
  const found = compared('closed', spoken.phones, spoken.classes);
  assert.ok(found.said >= 8 && found.found >= 0.7 * found.said, `${found.found} of ${found.said}`);
  const gap = ({ values }) => -((values[4] ?? 0) + (values[5] ?? 0));
  assert.ok(frames.filter((f) => gap(f) > 50).length > 10);
  await stream.close();
});

test('accepts pieces of any size, even single bytes', async () => {
  const stream = await daemon.stream();
  begin(stream, 'v');
  const bytes = bytesOf(spoken.samples).subarray(0, spoken.rate);
  for (let at = 0, n = 0; at < bytes.length; n++) {
    const size = [1, 3, 0, 700][n % 4];
    stream.socket.send(bytes.subarray(at, at + size));
    at += size;
  }
  stream.send({ type: 'close', id: 'v' });
  await ended(stream, 'v');
  assert.deepEqual(soundOf(stream.chunks), [...spoken.samples.subarray(0, spoken.rate / 2)]);
  await stream.close();
});

for (const [rate, channels, codec] of [[8000, 1], [44100, 2], [96000, 8], [48000, 1, 'pcm']])
  test(`accepts ${rate} Hz, ${channels} channels`, async () => {
    const { stream, end: { duration, reason } } = await live(bytesOf(resampled(rate, channels)), 2 * rate * channels, { rate, channels, codec });
    assert.equal(reason, 'done');
    assert.ok(Math.abs(duration - spoken.samples.length / spoken.rate) < 0.01, `${duration}`);
    const frames = framesOf(stream.chunks), gaps = frames.map(({ values }) => -((values[4] ?? 0) + (values[5] ?? 0)));
    assert.ok(gaps.filter((g) => g > 50).length > 5 && gaps.filter((g) => g <= 0).length > 5);
    await stream.close();
  });

test('a client that stops sending: silence, the lips go to rest, and then the voice is closed', async () => {
  const stream = await daemon.stream();
  begin(stream, 'v', { still: true });
  await pour(stream, bytesOf(spoken.samples), 2 * spoken.rate);
  const end = await ended(stream, 'v');
  assert.equal(end.reason, 'done');
  assert.deepEqual(told(stream, 'warning'), ['unfinished']);
  const frames = framesOf(stream.chunks), seconds = spoken.samples.length / spoken.rate;
  assert.ok(end.duration > seconds + 1, `${end.duration}`);
  const rest = frames.filter((f) => f.time > seconds + 0.7);
  assert.ok(rest.length > 10 && rest.every((f) => Object.entries(f.values).every(([n, x]) => !MOUTH.includes(Number(n)) || !x)), JSON.stringify(rest[0]));
  await stream.close();
});

test('a voice that stalls and resumes is heard again', async () => {
  const stream = await daemon.stream();
  begin(stream, 'v');
  const half = bytesOf(spoken.samples).subarray(0, 2 * Math.floor(spoken.samples.length / 2)), rest = bytesOf(spoken.samples).subarray(half.length);
  await pour(stream, half, 2 * spoken.rate);
  await stream.until(() => stream.chunks.at(-1).start + stream.chunks.at(-1).samples > spoken.samples.length / 2 + spoken.rate / 5);
  await pour(stream, rest, 2 * spoken.rate);
  stream.send({ type: 'close', id: 'v' });
  const end = await ended(stream, 'v'), sound = soundOf(stream.chunks);
  assert.equal(end.reason, 'done');
  assert.deepEqual(sound.slice(0, half.length / 2), [...spoken.samples.subarray(0, half.length / 2)]);
  assert.deepEqual(sound.slice(-rest.length / 2), [...spoken.samples.subarray(half.length / 2)]);
  await stream.close();
});

test('faster than real time: reports it once and drops the excess, without affecting others', async () => {
  const minute = Buffer.alloc(2 * 96000 * 60, bytesOf(resampled(96000)));
  const flood = async () => {
    const fast = await daemon.stream();
    begin(fast, 'v', { rate: 96000 });
    for (let at = 0; at < minute.length; at += 100000) fast.socket.send(minute.subarray(at, at + 100000));
    fast.send({ type: 'close', id: 'v' });
    const end = await ended(fast, 'v');
    await fast.close();
    return { end, warnings: told(fast, 'warning') };
  };
  const { stream, end, other: fast } = await live(bytesOf(spoken.samples), 2 * spoken.rate, {}, { beside: flood });
  assert.equal(fast.end.reason, 'done');
  assert.ok(fast.end.duration < 30, `${fast.end.duration}`);
  assert.deepEqual(fast.warnings, ['skipped']);
  assert.equal(end.reason, 'done');
  assert.deepEqual(told(stream, 'warning'), []);
  await stream.close();
});

test('follows a clock that runs 3 % fast', async () => {
  const twelve = new Int16Array(12 * spoken.rate).map((_, i) => spoken.samples[i % spoken.samples.length]);
  const { stream, end } = await live(bytesOf(twelve), 2 * spoken.rate, {}, { speed: 1.03 });
  assert.equal(end.reason, 'done');
  // sent within 12 / 1.03 s
  assert.ok(end.duration < 11.95, `${end.duration} s are heard of 12, which came in ${(12 / 1.03).toFixed(2)}`);
  assert.deepEqual(told(stream, 'warning'), []);
  await stream.close();
});

test('an operator speaks and the kiosk plays it; a higher priority interrupts the operator, who interrupts the rest', async () => {
  const [kiosk, desk] = [await daemon.stream('?room=k'), await daemon.stream('?room=k&watch=1&audio=none&fap=none')];
  await kiosk.wait({ type: 'joined' });
  kiosk.send({ type: 'speak', id: 'low', priority: 'background', lang: 'it', text: 'Una frase lunga che nessuno sentirà fino alla fine, perché qualcuno vuole parlare.' });
  await kiosk.wait({ type: 'begin', id: 'low' });
  begin(desk, 'v');
  const speaking = pour(desk, bytesOf(spoken.samples), 2 * spoken.rate);
  assert.equal((await ended(kiosk, 'low')).reason, 'stopped');
  const { utterance, captions } = await kiosk.wait({ type: 'begin', id: 'v' });
  assert.equal(captions, false);
  await kiosk.until(() => framesOf(kiosk.chunks, utterance).length > 10);
  kiosk.send({ type: 'speak', id: 'fire', priority: 'alarm', lang: 'it', text: 'Attenzione!' });
  assert.equal((await ended(kiosk, 'v')).reason, 'stopped');
  await ended(kiosk, 'fire');
  await speaking; // the remaining sound is ignored
  assert.deepEqual(told(desk, 'error'), []);
  desk.send({ type: 'close', id: 'v' });
  desk.send({ type: 'ping', id: 'p' });
  await desk.wait({ type: 'pong', id: 'p' });
  assert.deepEqual(told(desk, 'error'), []);
  valid(kiosk);
  await Promise.all([kiosk.close(), desk.close()]);
});

test('drops sound sent before its turn or during a pause; a disconnecting speaker ends the voice', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'a', lang: 'it', text: 'Prima questa frase, che dura un poco.' });
  begin(stream, 'v');
  await pour(stream, bytesOf(spoken.samples), 2 * spoken.rate);
  await stream.wait({ type: 'begin', id: 'v' });
  stream.send({ type: 'pause' });
  await stream.wait({ type: 'paused' });
  await pour(stream, bytesOf(spoken.samples), 2 * spoken.rate);
  const before = stream.chunks.length;
  stream.send({ type: 'resume' });
  await stream.until(() => stream.chunks.length > before);
  stream.send({ type: 'cancel', id: 'v' });
  const end = await ended(stream, 'v');
  assert.equal(end.reason, 'stopped');
  assert.ok(end.duration < 3 * (spoken.samples.length / spoken.rate) - 1, `${end.duration}`);
  begin(stream, 'w');
  await pour(stream, bytesOf(spoken.samples).subarray(0, 2 * spoken.rate), 2 * spoken.rate);
  await stream.wait({ type: 'begin', id: 'w' });
  await stream.close();
});

test('the mood of the stream moves the face, and the voice moves the mouth', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'idle', seed: 3 });
  stream.send({ type: 'express', mix: [{ name: 'joy' }], ease: 0 });
  begin(stream, 'v', { fps: 50 });
  await pour(stream, bytesOf(spoken.samples), 2 * spoken.rate);
  stream.send({ type: 'close', id: 'v' });
  await ended(stream, 'v');
  const { utterance, idle } = stream.messages.find((m) => m.type === 'begin');
  assert.ok(idle >= 0);
  const frames = framesOf(stream.chunks, utterance);
  assert.ok(frames.some((f) => f.values[48]) && frames.filter((f) => (f.values[59] ?? 0) > 50).length > frames.length / 2, 'the head moves, the corners are up');
  const closed = spoken.classes.filter((p) => p.class === 'closed' && p.end - p.start > 0.05);
  const shut = closed.filter((p) => frames.some((f) => f.time >= p.start - 0.01 && f.time <= p.end + 0.01 && (f.values[4] ?? 0) + (f.values[5] ?? 0) >= 0));
  assert.ok(closed.length > 4 && shut.length >= 0.9 * closed.length, `${shut.length} of ${closed.length}`);
  await stream.close();
});

test('at the end of a phrase the head nods and looks at the listener; without life only the mouth moves', async () => {
  const rest = new Int16Array(Math.round(1.2 * spoken.rate)), all = Int16Array.from([...spoken.samples, ...rest]);
  const faces = [];
  for (const life of [1, 0]) {
    const stream = await daemon.stream();
    begin(stream, 'v', { fps: 50, life });
    await pour(stream, bytesOf(all), 2 * spoken.rate);
    stream.send({ type: 'close', id: 'v' });
    assert.equal((await ended(stream, 'v')).reason, 'done');
    faces.push(framesOf(stream.chunks));
    await stream.close();
  }
  const [lively, still] = faces, at = ({ values }, n) => values[n] ?? 0;
  const loud = spoken.samples.findLastIndex((x) => Math.abs(x) > 300) / spoken.rate;
  const after = lively.filter(({ time }) => time > loud + 0.5 && time < loud + 0.9);
  assert.ok(after.length > 10 && after.every((f) => Math.abs(at(f, 23) + at(f, 49)) < 3 && Math.abs(at(f, 25) + at(f, 48)) < 3), 'her eyes are at the listener, wherever the head is');
  assert.ok(Math.max(...after.map((f) => at(f, 48))) - Math.min(...after.map((f) => at(f, 48))) > 800, 'she nods');
  assert.ok(still.length > 50 && still.every((f) => [19, 23, 25, 31, 33, 48, 49].every((n) => !at(f, n))));
});

for (const [what, more, code, field] of [
  ['no rate', { rate: undefined }, 'missing-field', 'rate'],
  ['too slow', { rate: 7999 }, 'bad-field', 'rate'],
  ['too fast', { rate: 96001 }, 'bad-field', 'rate'],
  ['half a sample', { rate: 16000.5 }, 'bad-field', 'rate'],
  ['a rate of words', { rate: 'fast' }, 'bad-field', 'rate'],
  ['no channels', { channels: 0 }, 'bad-field', 'channels'],
  ['nine channels', { channels: 9 }, 'bad-field', 'channels'],
  ['a lookahead that is none', { lookahead: 50 }, 'bad-field', 'lookahead'],
  ['a codec that is none', { codec: 'shellac' }, 'unknown-codec', 'codec'],
  ['a codec of numbers', { codec: 7 }, 'bad-field', 'codec'],
  ['Opus at 44.1 kHz', { codec: 'opus', rate: 44100 }, 'bad-field', 'rate'],
  ['Opus with three channels', { codec: 'opus', rate: 48000, channels: 3 }, 'bad-field', 'channels'],
  ['no id', { id: undefined }, 'missing-field', 'id'],
  ['an engine that is none', { engine: 'x' }, 'unknown-engine', 'engine'],
  ['frames that are none', { fps: 500 }, 'bad-field', 'fps'],
])
  test(`${what}: rejects it with ${code}`, async () => {
    const stream = await daemon.stream();
    begin(stream, 'v', more);
    const error = await stream.wait({ type: 'error' });
    assert.deepEqual([error.code, error.field], [code, field], error.message);
    assert.equal((await stream.wait({ type: 'end' })).reason, 'failed');
    valid(stream);
    await stream.close();
  });

test('rejects sound without a voice, an empty voice, half a sample, too many voices', async () => {
  const stream = await daemon.stream(), others = [];
  stream.socket.send(Buffer.alloc(320));
  await stream.wait({ type: 'error', code: 'binary-message' });
  begin(stream, 'v');
  stream.send({ type: 'close', id: 'v' });
  assert.equal((await ended(stream, 'v')).reason, 'failed');
  assert.equal(stream.messages.find((m) => m.type === 'error' && m.id === 'v').code, 'bad-sound');
  begin(stream, 'w');
  stream.socket.send(Buffer.alloc(3201));
  stream.send({ type: 'close', id: 'w' });
  await ended(stream, 'w');
  const warning = stream.messages.find((m) => m.type === 'warning');
  assert.deepEqual([warning.code, warning.byte, warning.id], ['bad-sound', 3201, 'w']);
  for (let i = 0; i < 4; i++) {
    others.push(await daemon.stream());
    begin(others[i], `x${i}`);
    others[i].send({ type: 'ping' });
    await others[i].wait({ type: 'pong' });
  }
  assert.deepEqual(others.map((o) => told(o, 'error')), [[], [], [], ['too-many-voices']]);
  await Promise.all(others.slice(0, 3).map((o) => o.close()));
  await eventually(async () => {
    const id = `again ${others[3].messages.length}`;
    begin(others[3], id);
    others[3].socket.send(bytesOf(spoken.samples).subarray(0, spoken.rate));
    return (await others[3].wait((m) => m.id === id)).type === 'begin';
  }, 'room for another');
  await Promise.all([stream.close(), others[3].close()]);
});

test('another voice of the same client replaces the first', async () => {
  const stream = await daemon.stream();
  begin(stream, 'a');
  stream.socket.send(bytesOf(spoken.samples).subarray(0, spoken.rate));
  begin(stream, 'b');
  stream.socket.send(bytesOf(spoken.samples).subarray(0, spoken.rate));
  stream.send({ type: 'close', id: 'b' });
  assert.equal((await ended(stream, 'a')).reason, 'done');
  assert.equal((await ended(stream, 'b')).reason, 'done');
  await stream.close();
});

test('requires a token with the right', async () => {
  const secret = 'a secret of at least thirty-two bytes';
  fs.writeFileSync(file('secret'), secret, { mode: 0o600 });
  const guarded = await Daemon.start(['--secret-file', file('secret')], {}, { voices: false });
  const stream = await guarded.stream('', bearer(sign({ secret, claims: { rights: 'listen' } })));
  begin(stream, 'v');
  assert.equal((await stream.wait({ type: 'error', id: 'v' })).code, 'forbidden');
  const speaker = await guarded.stream('', bearer(sign({ secret })));
  begin(speaker, 'v');
  speaker.socket.send(bytesOf(spoken.samples).subarray(0, spoken.rate));
  await speaker.wait({ type: 'begin', id: 'v' });
  await Promise.all([stream.close(), speaker.close()]);
  assert.deepEqual(await guarded.stop(), { code: 0, signal: null });
});

/** Gets Opus packets of 20 ms from the daemon itself. */
async function opusPackets() {
  const stream = await daemon.stream('?audio=opus&fap=fapc');
  stream.send({ type: 'speak', id: 'o', lang: 'es', text: 'Mi primo Pablo compra pan y tomates en la plaza.' });
  await ended(stream, 'o');
  const packets = stream.chunks.flatMap((c) => (Array.isArray(c.audio) ? c.audio : []));
  await stream.close();
  return packets;
}
async function pourPackets(stream, packets) {
  for (const [i, packet] of packets.entries()) {
    stream.socket.send(packet);
    if (i % 5 === 4) await sleep(100);
  }
}

test('decodes Opus, one packet per message', async () => {
  const packets = await opusPackets(), stream = await daemon.stream();
  assert.ok(packets.length > 50);
  begin(stream, 'v', { codec: 'opus', rate: undefined });
  await pourPackets(stream, packets);
  stream.send({ type: 'close', id: 'v' });
  const end = await ended(stream, 'v');
  assert.equal(end.reason, 'done');
  assert.equal(stream.messages.find((m) => m.type === 'begin').rate, 48000);
  assert.deepEqual(told(stream, 'warning'), []);
  const sent = packets.length / 50; // packets that come late leave silence
  assert.ok(end.duration > sent - 0.15 && end.duration < sent + 1, `${end.duration} of ${sent}`);
  const gaps = framesOf(stream.chunks).map(({ values }) => -((values[4] ?? 0) + (values[5] ?? 0)));
  assert.ok(gaps.filter((g) => g > 50).length > 5 && gaps.filter((g) => g <= 0).length > 5);
  await stream.close();
});

test('truncated or invalid packets: reports the byte once, and the voice continues', async () => {
  const packets = await opusPackets(), stream = await daemon.stream();
  begin(stream, 'v', { codec: 'opus', rate: 24000, channels: 2 });
  const broken = packets.map((packet, i) => (i % 10 === 7 ? Buffer.alloc(i % 20 === 7 ? 0 : 3, 0xff) : i % 10 === 3 ? packet.subarray(0, packet.length / 2) : packet));
  await pourPackets(stream, broken);
  stream.send({ type: 'close', id: 'v' });
  const end = await ended(stream, 'v');
  assert.equal(end.reason, 'done');
  const warnings = stream.messages.filter((m) => m.type === 'warning');
  assert.equal(warnings.length, 1);
  assert.equal(warnings[0].code, 'bad-sound');
  assert.equal(warnings[0].byte, broken.slice(0, 7).reduce((sum, { length }) => sum + length, 0));
  assert.ok(end.duration > packets.length / 50 - 0.3, `${end.duration}`);
  await stream.close();
});

/** The daemon's processes that decode Opus. */
const decoders = () => fs.readFileSync(`/proc/${daemon.process.pid}/task/${daemon.process.pid}/children`, 'utf8').trim().split(' ').filter(Boolean)
  .filter((pid) => /faccia-reader.*\0opus\0/.test(fs.readFileSync(`/proc/${pid}/cmdline`, 'utf8')));

test('decodes a stranger\'s packets in a separate process, whose death costs only the rest of the sound', async () => {
  const packets = await opusPackets(), [stream, beside] = await Promise.all([daemon.stream(), daemon.stream()]);
  await eventually(() => !decoders().length, 'no process of earlier voices');
  begin(beside, 'w', { codec: 'opus', rate: 24000, channels: 2 });
  await pourPackets(beside, packets.slice(0, 10));
  await eventually(() => decoders().length === 1, 'a process that decodes Opus');
  const [first] = decoders();
  begin(stream, 'v', { codec: 'opus', rate: undefined });
  await pourPackets(stream, packets.slice(0, 40));
  await stream.wait({ type: 'begin', id: 'v' });
  const decoder = decoders().find((pid) => pid !== first);
  assert.ok(decoder, 'no process of its own');
  process.kill(Number(decoder), 'SIGTERM');
  const warning = await stream.wait({ type: 'warning', id: 'v', code: 'bad-sound' });
  assert.match(warning.message, /decoder ended its process, by signal 15/);
  assert.equal((await ended(stream, 'v')).reason, 'done');
  await pourPackets(beside, packets.slice(10));
  beside.send({ type: 'close', id: 'w' });
  const end = await ended(beside, 'w');
  assert.equal(end.reason, 'done');
  assert.equal(told(beside, 'warning').includes('bad-sound'), false);
  await eventually(() => !decoders().length, 'the end of the processes');
  await Promise.all([stream.close(), beside.close()]);
});

test('plays packets that arrive all at once together with the end', async () => {
  const packets = (await opusPackets()).slice(0, 100), stream = await daemon.stream();
  begin(stream, 'v', { codec: 'opus', rate: undefined });
  for (const packet of packets) stream.socket.send(packet);
  stream.send({ type: 'close', id: 'v' });
  const end = await ended(stream, 'v');
  assert.equal(end.reason, 'done');
  assert.ok(Math.abs(end.duration - packets.length / 50) < 0.15, `${end.duration}`);
  await stream.close();
});
