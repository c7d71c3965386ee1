// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings from a folder, uploaded, and on the command line; and speech in all formats.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { violations } from '../../lib/schema.mjs';
import { wavOf } from '../../lib/wav.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-play-'));
const media = path.join(folder, 'media');
const file = (name) => path.join(media, name);
const faccia = (...args) => spawnSync(path.join(build, 'server/cli/faccia'), args, { encoding: 'utf8', maxBuffer: 1 << 26 });

/** Makes a .fap whose FAP 3 is the number of the frame. */
const fap = (frames, fps = 25, value = (k) => k) => {
  const mask = Array.from({ length: 68 }, (_, i) => (i === 2 ? 1 : 0)).join(' ');
  return `2.1 recording ${fps} ${frames}\n` + Array.from({ length: frames }, (_, k) => `${mask}\n${k} ${value(k)}\n`).join('');
};

/** Makes sound whose samples are their own numbers, on all channels. */
const wav = (samples, rate = 16000, channels = 2) =>
  wavOf(Int16Array.from({ length: samples * channels }, (_, i) => Math.floor(i / channels) % 30000), rate, channels);

let daemon;
before(async () => {
  fs.mkdirSync(media);
  fs.writeFileSync(file('both.fap'), fap(60));
  fs.writeFileSync(file('both.wav'), wav(5 * 16000));
  fs.writeFileSync(file('mute.fap'), fap(10, 10));
  fs.writeFileSync(file('bad.fap'), `${fap(3)}1 0 x\n`);
  fs.writeFileSync(file('greta.fap'), fap(3).replaceAll(/0\n(?=\d+ \d+\n)/g, '0 0\n'));
  fs.writeFileSync(file('set.fap'), fap(3).replaceAll(/0\n(?=\d+ \d+\n)/g, '0 1\n'));
  fs.writeFileSync(file('bare.fap'), fap(3).replace(/.*/, '3'));
  fs.writeFileSync(file('fast.fap'), fap(3, 500));
  fs.writeFileSync(file('noise.fap'), fap(3));
  fs.writeFileSync(file('noise.wav'), 'this is no sound');
  fs.writeFileSync(file('large.fap'), fap(2000));
  fs.writeFileSync(path.join(folder, 'secret.fap'), fap(3));
  fs.writeFileSync(file('.hidden.fap'), fap(3));
  const mask = Array.from({ length: 68 }, (_, i) => (i < 3 ? 1 : 0)).join(' ');
  const high = [0, 1, 2].map((k) => `${mask}\n${k} 10 2 ${30 + k} 1 1 40 3 ${20 + k} 0 1 ${5 + k}\n`).join('');
  fs.writeFileSync(file('high.fap'), `2.1 high 25 3\n${high}`);
  const two = Array.from({ length: 68 }, (_, i) => (i < 2 ? 1 : 0)).join(' ');
  // /p/, half /a/ and half /p/, /a/; with joy at 0, half and full
  const shown = [[1, 0, 63, 0], [10, 1, 32, 32], [10, 0, 63, 63]].map(([a, b, blend, joy], k) => `${two}\n${k} ${a} ${b} ${blend} 0 1 ${joy} 0 0 0 0\n`);
  fs.writeFileSync(file('visemes.fap'), `2.1 visemes 25 3\n${shown.join('')}`);
  fs.mkdirSync(file('folder.fap'));
  daemon = await Daemon.start(['--media', media, '--max-play', '200000']);
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const samples = (chunks) => chunks.flatMap((c) => Array.from(c.audio ?? new Int16Array(c.samples)));

test('a recording with 69 flags per line, or only a number of frames above them, plays like any other, with a note', async () => {
  const stream = await daemon.stream('?lang=it');
  stream.send({ type: 'play', id: 'g', name: 'greta' });
  stream.send({ type: 'play', id: 'b', name: 'bare' });
  await stream.wait({ type: 'end', id: 'b', reason: 'done' });
  const { code, line, column, message } = await stream.wait({ type: 'warning', id: 'g' });
  assert.deepEqual({ code, line, column, message }, { code: 'ignored', line: 2, column: 137, message: '69 flags, the last is ignored' });
  assert.equal(stream.messages.filter((m) => m.type === 'warning').length, 1);
  for (const utterance of [1, 2]) assert.deepEqual(stream.chunks.filter((c) => c.utterance === utterance).flatMap((c) => c.frames.map((f) => f[3])), [0, 1, 2]);
  stream.send({ type: 'play', id: 's', name: 'set' });
  const error = await stream.wait({ type: 'error', id: 's' });
  assert.deepEqual([error.code, error.line, error.column], ['bad-fap', 2, 137]);
  await stream.close();
});

test('a recording plays unchanged, to the sample and the value, in its turn', async () => {
  const stream = await daemon.stream('?lang=it');
  stream.send({ type: 'speak', id: 's', text: 'Prima.' });
  stream.send({ type: 'play', id: 'p', name: 'both' });
  stream.send({ type: 'play', id: 'm', name: 'mute' });
  await stream.wait({ type: 'end', id: 'm', reason: 'done' });
  const { arrived, ...begin } = await stream.wait({ type: 'begin', id: 'p' });
  assert.ok(arrived > (await stream.wait({ type: 'end', id: 's' })).arrived);
  assert.deepEqual({ play: begin.play, rate: begin.rate, fps: begin.fps, voice: begin.voice }, { play: 'both', rate: 16000, fps: 25, voice: undefined });
  const chunks = stream.chunks.filter((c) => c.utterance === 2);
  const heard = samples(chunks);
  assert.equal(heard.length, 5 * 16000, 'the sound is longer than the face');
  assert.ok(heard.every((value, i) => value === i % 30000));
  const frames = chunks.flatMap((c) => c.frames);
  assert.equal(frames.length, 125);
  assert.ok(frames.every((frame, k) => frame[3] === Math.min(k, 59)), 'the last frame stays');
  const mute = stream.chunks.filter((c) => c.utterance === 3);
  assert.ok(mute.every((c) => !c.audio));
  assert.deepEqual(mute.flatMap((c) => c.frames.map((f) => f[3])), [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
  assert.equal((await stream.wait({ type: 'end', id: 'm' })).duration, 1);
  for (const { arrived: _, ...message } of stream.messages) assert.equal(violations('server', message), null, JSON.stringify(message));
  await stream.close();
});

test('pauses, interrupts and stops it like speech', async () => {
  const stream = await daemon.stream('?lang=it');
  stream.send({ type: 'play', id: 'a', name: 'both' });
  await stream.until(() => stream.chunks.length > 2);
  stream.send({ type: 'pause' });
  const paused = await stream.wait({ type: 'paused', id: 'a' });
  stream.send({ type: 'jump', mark: 'x' });
  await stream.wait({ type: 'error', code: 'unknown-mark' });
  stream.send({ type: 'rate', rate: 100 });
  stream.send({ type: 'resume' });
  assert.equal((await stream.wait({ type: 'resumed' })).sample, paused.sample);
  stream.send({ type: 'speak', id: 'b', text: 'Ehi!', mode: 'interrupt' });
  await stream.wait({ type: 'end', id: 'a', reason: 'stopped' });
  stream.send({ type: 'play', id: 'c', name: 'both', mode: 'replace' });
  await stream.wait({ type: 'begin', id: 'c' });
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'c', reason: 'stopped' });
  for (let i = 0; i < 200; i++) {
    stream.send({ type: 'play', id: `n${i}`, name: 'both' });
    stream.send({ type: 'stop' });
  }
  await stream.wait({ type: 'end', id: 'n199', reason: 'stopped' });
  const all = stream.chunks.filter((c) => c.utterance === 1);
  all.forEach((c, i) => assert.equal(c.start, i ? all[i - 1].start + all[i - 1].samples : 0));
  await stream.close();
});

for (const [name, expected] of [
  ['nowhere', { code: 'unknown-media', field: 'name' }],
  ['../secret', { code: 'bad-field', field: 'name' }],
  ['..', { code: 'bad-field', field: 'name' }],
  ['/etc/passwd', { code: 'bad-field', field: 'name' }],
  ['', { code: 'bad-field', field: 'name' }],
  ['both\0', { code: 'bad-field', field: 'name' }],
  ['x'.repeat(101), { code: 'bad-field', field: 'name' }],
  [5, { code: 'bad-field', field: 'name' }],
  ['folder', { code: 'unknown-media', field: 'name' }],
  ['bad', { code: 'bad-fap', line: 8 }],
  ['fast', { code: 'bad-fap', line: 1 }],
  ['noise', { code: 'bad-sound' }],
  ['large', { code: 'media-too-large' }],
])
  test(`rejects ${String(name).slice(0, 20)}`, async () => {
    const stream = await daemon.stream();
    stream.send({ type: 'play', id: 'x', name });
    await stream.wait({ type: 'error', id: 'x', ...expected });
    await stream.wait({ type: 'end', id: 'x', reason: 'failed' });
    await stream.close();
  });

test('lists the folder by playable names', async () => {
  const { media: list } = await (await daemon.get('/v1/media')).json();
  const names = ['bad', 'bare', 'both', 'fast', 'greta', 'high', 'large', 'mute', 'noise', 'set', 'visemes'];
  assert.deepEqual(list, names.map((name) => ({ name, sound: ['both', 'noise'].includes(name) })));
  const head = await daemon.get('/v1/media', { method: 'HEAD' });
  assert.equal(head.status, 200);
  assert.equal(await head.text(), '');
});

test('a client that requests the list and disconnects leaks nothing', async () => {
  const { hostname, port } = new URL(daemon.url);
  const gone = Array.from({ length: 200 }, () => new Promise((resolve) => {
    const socket = net.connect(Number(port), hostname, () => socket.write('GET /v1/media HTTP/1.1\r\nHost: localhost\r\n\r\n', () => socket.resetAndDestroy()));
    socket.on('close', resolve).on('error', () => {});
  }));
  await Promise.all(gone);
  const lists = await Promise.all(Array.from({ length: 20 }, async () => (await daemon.get('/v1/media')).json()));
  assert.ok(lists.every(({ media: list }) => list.length === 11));
});

test('keeps visemes and expressions of a recording (FAP 1 and 2)', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'play', name: 'high' });
  await stream.wait({ type: 'end', reason: 'done' });
  const frames = stream.chunks.flatMap((c) => c.frames);
  assert.deepEqual(stream.chunks.flatMap((c) => c.visemes.map((v) => [...v])), [0, 1, 2].map((k) => [10, 2, 30 + k, 1]));
  assert.deepEqual(stream.chunks.flatMap((c) => c.expressions.map((e) => [...e])), [0, 1, 2].map((k) => [1, 40, 3, 20 + k, 0, 1]));
  assert.deepEqual(frames.map((f) => f[3]), [5, 6, 7]);
  const { status, stdout, stderr } = faccia('play', file('high.fap'), '--fap', '-');
  assert.equal(status, 0, stderr);
  assert.match(stdout, /^2 10 2 32 1 1 40 3 22 0 1 7 /m);
  await stream.close();
});

test('visemes and expressions move the face where a recording has no other FAPs', async () => {
  const [open, corner] = [3, 59];
  const stream = await daemon.stream();
  stream.send({ type: 'play', name: 'visemes' });
  await stream.wait({ type: 'end', reason: 'done' });
  const [p, half, a] = stream.chunks.flatMap((c) => c.frames);
  assert.ok(a[open] > 300 && Math.abs(half[open] - (a[open] + p[open]) / 2) < 0.1 * a[open], `jaw ${[p[open], half[open], a[open]]}`);
  // a positive FAP 4 or 5 brings the inner lips together
  const gap = (f) => -f[4] - f[5];
  assert.ok(gap(p) < gap(half) && gap(half) < gap(a), `lips ${[gap(p), gap(half), gap(a)]}`);
  assert.ok(a[corner] > half[corner] && half[corner] > 50, `corners ${[p[corner], half[corner], a[corner]]}`);
  // the command line gives the same frames
  const played = faccia('play', file('visemes.fap'), '--fap', '-');
  assert.equal(played.status, 0, played.stderr);
  const same = parseFap(played.stdout).frames;
  assert.equal(same.length, 3);
  for (const [k, f] of [p, half, a].entries()) for (let n = 3; n <= 68; n++) assert.equal(same[k][n] ?? 0, f[n], `frame ${k}, FAP ${n}`);
  // with the default codec, which omits FAPs 1 and 2
  const coded = await daemon.stream('?fap=fapc');
  coded.send({ type: 'play', name: 'visemes' });
  await coded.wait({ type: 'end', reason: 'done' });
  assert.ok(coded.chunks.flatMap((c) => c.frames)[2][open] > 300);
  await Promise.all([stream.close(), coded.close()]);
});

const upload = (query, parts) => {
  const form = new FormData();
  for (const [name, content] of Object.entries(parts)) form.append(name, new Blob([content]), `${name}.bin`);
  return daemon.get(`/v1/play?${query}`, { method: 'POST', body: form });
};

test('uploads play from memory; invalid ones are reported in the room', async () => {
  const room = await daemon.stream('?room=cinema');
  await room.wait({ type: 'joined' });
  assert.equal((await upload('room=cinema&id=u', { fap: fap(20), sound: wav(16000, 16000, 1) })).status, 202);
  await room.wait({ type: 'end', id: 'u', reason: 'done' });
  assert.deepEqual(samples(room.chunks), Array.from({ length: 16000 }, (_, i) => i));
  assert.deepEqual(room.chunks.flatMap((c) => c.frames).map((f) => f[3]).slice(0, 20), Array.from({ length: 20 }, (_, k) => k));
  assert.equal((await upload('room=cinema&id=v', { fap: 'nonsense' })).status, 202);
  await room.wait({ type: 'error', id: 'v', code: 'bad-fap', line: 1 });
  assert.equal((await daemon.get('/v1/play?room=cinema&name=mute&id=w', { method: 'POST' })).status, 202);
  await room.wait({ type: 'end', id: 'w', reason: 'done' });
  const refused = async (response, status, code) => {
    assert.equal(response.status, status);
    assert.equal((await response.json()).code, code);
  };
  await refused(await upload('room=cinema', { sound: wav(10) }), 400, 'bad-form');
  await refused(await upload('room=nobody', { fap: fap(2) }), 404, 'unknown-room');
  await refused(await upload('room=cinema&mode=x', { fap: fap(2) }), 400, 'bad-field');
  await refused(await upload('room=cinema', { fap: fap(20), sound: wav(100000) }), 413, 'media-too-large');
  await refused(await daemon.get('/v1/play?room=cinema', { method: 'POST', body: 'x' }), 415, 'unsupported-media-type');
  await refused(await daemon.get('/v1/play?room=cinema&name=..%2Fsecret', { method: 'POST' }), 400, 'bad-field');
  await room.close();
});

/** The daemon's processes that decode sound. */
const decoding = () => fs.readdirSync('/proc').filter((pid) => {
  try {
    const [, parent] = fs.readFileSync(`/proc/${pid}/stat`, 'utf8').match(/\) \S (\d+) /);
    return Number(parent) === daemon.process.pid && fs.readFileSync(`/proc/${pid}/cmdline`, 'utf8').split('\0').includes('sound');
  } catch {
    return false;
  }
}).map(Number);

test('decodes sound in a separate process, whose death costs only the rest of the sound', async () => {
  const room = await daemon.stream('?room=killed');
  await room.wait({ type: 'joined' });
  assert.equal((await upload('room=killed&id=k', { fap: fap(150), sound: wav(80000, 8000, 1) })).status, 202);
  await room.wait({ type: 'begin', id: 'k' });
  const [process_, ...others] = await eventually(() => decoding().length && decoding(), 'a process that decodes');
  assert.deepEqual(others, []);
  process.kill(process_, 'SIGABRT');
  const warning = await room.wait({ type: 'warning', id: 'k' });
  assert.equal(warning.code, 'bad-sound');
  assert.match(warning.message, /^the sound is not whole: the process that reads it ended its process, by signal 6/);
  assert.equal((await room.wait({ type: 'end', id: 'k' })).reason, 'done');
  assert.deepEqual(room.chunks.flatMap((c) => c.frames).map((f) => f[3]).slice(0, 150), Array.from({ length: 150 }, (_, k) => k));
  // after a stop none is left
  assert.equal((await upload('room=killed&id=l', { fap: fap(150), sound: wav(80000, 8000, 1) })).status, 202);
  await room.wait({ type: 'begin', id: 'l' });
  room.send({ type: 'stop' });
  await room.wait({ type: 'end', id: 'l', reason: 'stopped' });
  await eventually(() => decoding().length === 0, 'the process to end');
  await room.close();
});

test('survives malformed forms', async () => {
  const room = await daemon.stream('?room=forms');
  await room.wait({ type: 'joined' });
  const whole = `--b\r\nContent-Disposition: form-data; name="fap"; filename="x"\r\n\r\n${fap(2)}\r\n--b--\r\n`;
  for (let i = 0; i < 120; i++) {
    const at = (i * 37) % whole.length;
    const body = i % 3 === 0 ? whole.slice(0, at) : i % 3 === 1 ? whole.slice(0, at) + '\r\n--b\0' + whole.slice(at) : whole.slice(at);
    const type = i % 7 ? 'multipart/form-data; boundary=b' : `multipart/form-data${'; boundary='.repeat(i % 2)}`;
    await daemon.get('/v1/play?room=forms', { method: 'POST', body, headers: { 'content-type': type } }).then((r) => r.arrayBuffer(), () => null);
  }
  room.send({ type: 'stop' });
  room.send({ type: 'ping', id: 1 });
  await room.wait({ type: 'pong' });
  await room.close();
});

test('plays on the command line too, in other formats', () => {
  const out = (name) => path.join(folder, name);
  const { status, stdout, stderr } = faccia('play', file('both.fap'), '--wav', out('o.wav'), '--ogg', out('o.ogg'), '--fap', out('o.fap'), '--ndjson', '-');
  assert.equal(status, 0, stderr);
  const lines = stdout.trim().split('\n').map((line) => JSON.parse(line));
  assert.equal(lines[0].type, 'begin');
  assert.equal(lines.filter((l) => l.type === 'frame').length, 125);
  assert.deepEqual(lines.find((l) => l.frame === 7), { type: 'frame', frame: 7, time: 0.28, faps: { 3: 7 } });
  assert.deepEqual(lines.at(-1), { type: 'end', reason: 'done', duration: 5 });
  assert.equal(fs.statSync(out('o.wav')).size, 44 + 5 * 16000 * 2);
  assert.match(fs.readFileSync(out('o.fap'), 'latin1'), /^2\.1 faccia 25 125\n/);
  const bad = faccia('play', file('bad.fap'));
  assert.equal(bad.status, 1);
  assert.match(bad.stderr, /8:\d+: /);
  assert.equal(faccia('play').status, 2);
  assert.equal(faccia('play', '/nowhere.fap').status, 1);
});

/** Parses the pages of an Ogg stream and lists their errors. */
function pages(data) {
  const list = [];
  for (let at = 0; at < data.length; ) {
    assert.equal(data.toString('latin1', at, at + 4), 'OggS');
    const count = data[at + 26];
    const size = data.subarray(at + 27, at + 27 + count).reduce((a, b) => a + b, 0);
    list.push({ flags: data[at + 5], granule: Number(data.readBigInt64LE(at + 6)), number: data.readUInt32LE(at + 18), body: data.subarray(at + 27 + count, at + 27 + count + size) });
    at += 27 + count + size;
  }
  return list;
}

test('Opus in Ogg: same duration as the WAV, and same sound', async () => {
  const post = async (format) => Buffer.from(await (await daemon.get(`/v1/speech?lang=it&format=${format}`, { method: 'POST', body: 'La mamma parla. Poi tace.' })).arrayBuffer());
  const [sound, ogg] = [await post('wav'), await post('ogg')];
  const list = pages(ogg);
  assert.deepEqual(list.map((p) => p.number), list.map((_, i) => i));
  assert.equal(list[0].flags, 2);
  assert.equal(list.at(-1).flags & 4, 4, 'the last page says so');
  const head = list[0].body;
  assert.equal(head.toString('latin1', 0, 8), 'OpusHead');
  const skip = head.readUInt16LE(10);
  const rate = sound.readUInt32LE(24);
  const seconds = (sound.length - 44) / 2 / rate;
  assert.ok(Math.abs((list.at(-1).granule - skip) / 48000 - seconds) < 1 / 8000);
  assert.ok(ogg.length < sound.length / 5, `${ogg.length} of ${sound.length}`);
});

test('ndjson: writes every line as soon as it is ready, frames and events in order', async () => {
  const response = await daemon.get('/v1/speech?lang=it&format=ndjson&still=1', { method: 'POST', body: 'La mamma parla. Poi tace. Poi ride. Poi dorme. E sogna.' });
  assert.equal(response.headers.get('content-type'), 'application/x-ndjson');
  const lines = (await response.text()).trim().split('\n').map((line) => JSON.parse(line));
  assert.equal(lines[0].type, 'begin');
  assert.equal(lines.at(-1).type, 'end');
  const timed = lines.slice(1, -1);
  timed.forEach((line, i) => assert.ok(!i || line.time >= timed[i - 1].time - 0.04, JSON.stringify(line)));
  const frames = timed.filter((l) => l.type === 'frame');
  assert.deepEqual(frames.map((f) => f.frame), frames.map((_, i) => i));
  assert.equal(frames.length, Math.ceil(lines.at(-1).duration * 25));
  assert.deepEqual(timed.filter((l) => l.type === 'word').slice(0, 3).map((l) => l.text), ['La', 'mamma', 'parla']);
  assert.ok(timed.some((l) => l.type === 'phone' && l.ipa === 'm'));
  const text = await (await daemon.get('/v1/speech?lang=it&format=fap&still=1', { method: 'POST', body: 'La mamma parla. Poi tace. Poi ride. Poi dorme. E sogna.' })).text();
  const same = parseFap(text).frames;
  frames.forEach((frame, k) => assert.equal(frame.faps[51] ?? 0, same[k][51] ?? 0));
});
