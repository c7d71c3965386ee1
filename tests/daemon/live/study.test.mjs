// SPDX-License-Identifier: GPL-3.0-or-later
// What listeners say beyond its words: observers hear it with the listener's consent, a study records it, "come?" has the last text said again, and the
// person decides how she speaks.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { opusOf, POCKETSPHINX, samplesOf, spoken } from '../../lib/heard-speech.mjs';
import { violations } from '../../lib/schema.mjs';
import { sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-study-'));
const open = new Set();
after(async () => {
  for (const daemon of open) assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

let count = 0;
async function daemonWith(recogniser, options = []) {
  const sessions = path.join(folder, String(++count));
  fs.mkdirSync(sessions);
  const daemon = await Daemon.start(['--recogniser', recogniser, '--sessions', sessions, ...options]);
  open.add(daemon);
  return Object.assign(daemon, { sessions, recorded: () => fs.readdirSync(sessions) });
}
const close = async (daemon) => {
  open.delete(daemon);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
};
const of = (stream, type) => stream.messages.filter((m) => m.type === type);
const valid = (...streams) => streams.forEach(({ messages }) => messages.forEach(({ arrived: _, ...message }) => assert.equal(violations('server', message), null, JSON.stringify(message))));

async function say(stream, parts, { id, ...more }) {
  stream.send({ type: 'hear', id, codec: 'pcm_s16le', rate: 16000, lang: 'en', ...more });
  for (const part of parts) stream.socket.send(part);
  stream.send({ type: 'close', id });
  return stream.wait({ type: 'heard', id, final: true });
}
async function enter(daemon) {
  const [screen, desk, other] = await Promise.all([daemon.stream('?room=kitchen'), daemon.stream(), daemon.stream()]);
  await screen.wait({ type: 'joined' });
  for (const [stream, as] of [[desk, 'desk'], [other, 'other']]) {
    stream.send({ type: 'join', room: 'kitchen', watch: true, as });
    await stream.wait({ type: 'observers' });
  }
  return { screen, desk, other };
}
async function consent(desk, screen) {
  const text = `May we record session ${++count}?`, from = desk.messages.length;
  desk.send({ type: 'consent', consent: 'asked', text });
  await screen.wait({ type: 'consent', consent: 'asked', text });
  screen.send({ type: 'consent', consent: 'given' });
  return desk.wait({ type: 'consent', consent: 'given' }, { from });
}

test('passes the sound to observers who ask for it, only while the listener consents, as it came', async () => {
  const daemon = await daemonWith('cat >/dev/null; echo yes'), { screen, desk, other } = await enter(daemon);
  const packets = opusOf(spoken('yes please'));
  desk.send({ type: 'overhear' });
  screen.send({ type: 'overhear' }); // a listener is no observer
  desk.send({ type: 'ping', id: 'p' });
  await desk.wait({ type: 'pong' });
  await say(screen, packets, { id: 'a', codec: 'opus', rate: 48000 });
  assert.deepEqual(of(desk, 'overheard'), []);
  await consent(desk, screen);
  await say(screen, packets, { id: 'b', codec: 'opus', rate: 48000 });
  const sound = of(desk, 'overheard');
  assert.deepEqual(sound.map(({ data }) => data), packets.map((packet) => packet.toString('base64')));
  const { by } = await desk.wait({ type: 'heard', id: 'b', final: true });
  for (const { id, by: who, codec, rate, channels } of sound) assert.deepEqual({ id, who, codec, rate, channels }, { id: 'b', who: by, codec: 'opus', rate: 48000, channels: 1 });
  screen.send({ type: 'consent', consent: 'declined' });
  await desk.wait({ type: 'consent', consent: 'declined' });
  await say(screen, packets, { id: 'c', codec: 'opus', rate: 48000 });
  desk.send({ type: 'overhear', on: false });
  await consent(desk, screen);
  await say(screen, packets, { id: 'd', codec: 'opus', rate: 48000 });
  assert.equal(of(desk, 'overheard').length, packets.length);
  assert.deepEqual([...of(screen, 'overheard'), ...of(other, 'overheard')], []);
  valid(screen, desk, other);
  await close(daemon);
});

test('lets nobody overhear who may not speak in the room', async () => {
  const secret = 'a-secret-that-is-long-enough-for-tests', file = path.join(folder, 'secrets');
  fs.writeFileSync(file, `${secret}\n`, { mode: 0o600 });
  const daemon = await daemonWith('cat >/dev/null; echo yes', ['--secret-file', file]);
  const stream = await daemon.stream(`?token=${sign({ secret, claims: { rights: 'listen', room: 'kitchen' } })}`);
  stream.send({ type: 'join', room: 'kitchen', watch: true });
  stream.send({ type: 'overhear' });
  assert.equal((await stream.wait({ type: 'error' })).code, 'forbidden');
  await close(daemon);
});

/** Intervals of a tier of a TextGrid that have a text. */
function tier(grid, name) {
  const [, part] = grid.split(`name = "${name}"`), [own] = part.split('    item [');
  return [...own.matchAll(/xmin = ([\d.]+)\s+xmax = ([\d.]+)\s+text = "(.*)"/g)].map(([, from, to, text]) => ({ from: Number(from), to: Number(to), text })).filter(({ text }) => text);
}

test('records a session while there is consent: sound, events, a TextGrid and a table on one clock', async () => {
  const daemon = await daemonWith(POCKETSPHINX), { screen, desk } = await enter(daemon);
  assert.equal((await consent(desk, screen)).recorded, true);
  desk.send({ type: 'ask', id: 'q', lang: 'en', text: 'Tea, or "black" coffee?', choices: ['Tea', 'Coffee'] });
  await screen.wait({ type: 'asked', id: 'q' });
  const second = spoken('the second one'), seconds = samplesOf(second).length / 32000;
  await say(screen, [samplesOf(second)], { id: 'h' });
  await desk.wait({ type: 'answered', id: 'q', text: 'Coffee' });
  await new Promise((done) => setTimeout(done, 1000 * seconds)); // it was sent faster than it is said, and two would overlap
  await say(screen, opusOf(second), { id: 'i', codec: 'opus', rate: 48000 }); // decoded by another process
  desk.send({ type: 'consent', consent: 'none' });
  assert.equal((await screen.wait({ type: 'consent', consent: 'none' })).recorded, true);
  const [name] = daemon.recorded(), at = path.join(daemon.sessions, name), read = (file) => fs.readFileSync(path.join(at, file), 'utf8');
  assert.match(name, /^kitchen-\d{8}T\d{6}Z$/);
  await eventually(() => !fs.existsSync(path.join(at, 'events.jsonl')), 'the files made of the events');
  assert.equal(fs.statSync(at).mode & 0o777, 0o700);
  assert.deepEqual(fs.readdirSync(at).sort(), ['room.flac', 'session.TextGrid', 'session.csv', 'session.json']);
  const session = JSON.parse(read('session.json')), grid = read('session.TextGrid');
  assert.deepEqual(['choices', 'chosen', 'answered', 'asked', 'heard', 'begin', 'sentence', 'word', 'end', 'consent'].filter((type) => !session.events.some((e) => e.type === type)), []);
  session.events.forEach((event, i) => assert.ok(!i || event.time >= session.events[i - 1].time));
  const pcm = execFileSync('ffmpeg', ['-loglevel', 'error', '-i', path.join(at, 'room.flac'), '-f', 's16le', '-ar', '16000', '-ac', '1', '-'], { maxBuffer: 1 << 28 });
  assert.ok(Math.abs(pcm.length / 32000 - session.seconds) < 0.01, `${pcm.length / 32000} ${session.seconds}`);
  const [heard, again, ...rest] = tier(grid, 'heard'), sound = new Int16Array(pcm.buffer.slice(pcm.byteOffset, pcm.byteOffset + pcm.length));
  assert.deepEqual([heard.text, again.text, rest], ['the second one', 'the second one', []]);
  for (const { from, to } of [heard, again]) assert.ok(Math.abs(to - from - seconds) < 0.1, `${from} ${to}`);
  const power = (from, to) => sound.subarray(Math.round(from * 16000), Math.round(to * 16000)).reduce((sum, x) => sum + x * x, 0);
  assert.ok(power(heard.from, heard.to) + power(again.from, again.to) > 0.999 * power(0, session.seconds)); // the sound lies where the grid says
  assert.equal(tier(grid, 'said')[0].text, 'Tea, or ""black"" coffee?');
  assert.deepEqual(tier(grid, 'words').map(({ text }) => text.replaceAll('"', '')).slice(0, 2), ['Tea', 'or']);
  assert.ok(grid.includes('mark = "chosen: Coffee"'));
  const [columns, ...rows] = read('session.csv').trim().split('\r\n');
  assert.equal(columns, 'time,type,text,by,id');
  assert.equal(rows.length, session.events.filter(({ final }) => final !== false).length);
  // she can still have it deleted
  screen.send({ type: 'consent', consent: 'declined' });
  assert.equal((await desk.wait({ type: 'consent', consent: 'declined' })).recorded, false);
  await eventually(() => !daemon.recorded().length, 'its deletion');
  valid(screen, desk);
  await close(daemon);
});

test('deletes a session whose consent is withdrawn, and completes that of a room that everybody leaves', async () => {
  const daemon = await daemonWith('cat >/dev/null; echo yes'), { screen, desk, other } = await enter(daemon);
  await consent(desk, screen);
  await say(screen, [Buffer.alloc(32000, 7)], { id: 'a' });
  assert.equal(daemon.recorded().length, 1);
  screen.send({ type: 'consent', consent: 'declined' });
  await desk.wait({ type: 'consent', consent: 'declined' });
  await eventually(() => !daemon.recorded().length, 'its deletion');
  await consent(desk, screen);
  for (const stream of [screen, desk, other]) stream.socket.close();
  await eventually(() => fs.existsSync(path.join(daemon.sessions, daemon.recorded()[0], 'session.json')), 'the session');
  await close(daemon);
});

test('completes a session when the daemon stops', async () => {
  const daemon = await daemonWith('cat >/dev/null; echo yes'), { screen, desk } = await enter(daemon);
  await consent(desk, screen);
  await close(daemon);
  assert.deepEqual(fs.readdirSync(path.join(daemon.sessions, daemon.recorded()[0])).sort(), ['room.flac', 'session.TextGrid', 'session.csv', 'session.json']);
});

test('takes words that the device of the listener has recognised, also over HTTP', async () => {
  const daemon = await daemonWith('cat >/dev/null; echo yes'), { screen, desk } = await enter(daemon);
  desk.send({ type: 'ask', id: 'q', lang: 'it', text: 'Che cosa manca?' });
  await screen.wait({ type: 'asked', id: 'q' });
  screen.send({ type: 'said', id: 's', text: 'il la', final: false });
  screen.send({ type: 'said', id: 's', text: 'il latte', lang: 'it', confidence: 0.5 });
  assert.equal((await desk.wait({ type: 'heard', id: 's', final: false })).text, 'il la');
  const { reason, text } = await desk.wait({ type: 'answered', id: 'q' });
  assert.deepEqual([reason, text], ['heard', 'il latte']);
  desk.send({ type: 'choices', id: 'c', choices: ['Tè', 'Caffè'] });
  await screen.wait({ type: 'choices', id: 'c' });
  const response = await daemon.get('/v1/rooms/kitchen/commands', { method: 'POST', body: JSON.stringify({ type: 'said', id: 't', text: 'la seconda', lang: 'it' }) });
  assert.equal(response.status, 202);
  assert.equal((await screen.wait({ type: 'chosen', id: 'c' })).text, 'Caffè');
  screen.send({ type: 'said', text: 'x' });
  await screen.wait({ type: 'error', code: 'missing-field', field: 'id' });
  valid(screen, desk);
  await close(daemon);
});

test('says the last text again when somebody asks "come?", and a question waits anew', async () => {
  const daemon = await daemonWith('cat >/dev/null; echo yes'), { screen, desk } = await enter(daemon);
  const said = (id, text, lang = 'it') => screen.send({ type: 'said', id, text, lang });
  said('0', 'Come?'); // nothing has been said yet
  desk.send({ type: 'speak', id: 'a', lang: 'it', text: 'Buonasera.' });
  await screen.wait({ type: 'end', id: 'a' });
  said('1', 'Come, scusi?');
  await eventually(() => of(screen, 'sentence').filter(({ text }) => text === 'Buonasera.').length === 2, 'it again');
  await eventually(() => of(screen, 'end').length === 2, 'its end');
  desk.send({ type: 'ask', id: 'q', lang: 'it', text: 'Quale?', seconds: 30 });
  await screen.wait({ type: 'asked', id: 'q' });
  said('2', 'Può ripetere, per favore?');
  await eventually(() => of(screen, 'asked').length === 2, 'the question again');
  assert.equal(of(screen, 'sentence').filter(({ text }) => text === 'Quale?').length, 2);
  said('3', 'questa');
  assert.equal((await desk.wait({ type: 'answered', id: 'q' })).text, 'questa');
  assert.equal(of(screen, 'sentence').length, 4);
  valid(screen, desk);
  await close(daemon);
});

const duration = ({ messages }, id) => {
  const words = messages.filter((m) => m.type === 'word' && m.id === id);
  return words.at(-1).time + words.at(-1).duration - words[0].time;
};

test('speaks in the manner that the person in the room wants, and rings a bell first', async () => {
  const daemon = await daemonWith('cat >/dev/null; echo yes'), { screen, desk } = await enter(daemon);
  const speak = async (id, more = {}) => {
    desk.send({ type: 'speak', id, lang: 'it', text: 'Domani mattina andiamo insieme al mercato.', ...more });
    await screen.wait({ type: 'end', id });
  };
  await speak('a');
  screen.send({ type: 'manner', speed: 0.7 });
  await speak('b');
  assert.ok(duration(screen, 'b') > 1.15 * duration(screen, 'a'), `${duration(screen, 'b')} ${duration(screen, 'a')}`);
  screen.send({ type: 'manner' });
  await speak('c', { bell: true });
  assert.ok(Math.abs(duration(screen, 'c') - duration(screen, 'a')) < 0.1);
  assert.equal((await screen.wait({ type: 'begin', id: 'c' })).bell, true);
  const first = (id) => screen.messages.find((m) => m.type === 'word' && m.id === id).time;
  assert.ok(Math.abs(first('c') - first('a') - 1.4) < 0.05, `${first('c')} ${first('a')}`);
  screen.send({ type: 'manner', speed: 9 });
  await screen.wait({ type: 'error', field: 'speed' });
  valid(screen, desk);
  await close(daemon);
});

test('shows a picture behind the face, also to those who join later', async () => {
  const daemon = await daemonWith('cat >/dev/null; echo yes'), { screen, desk } = await enter(daemon);
  desk.send({ type: 'backdrop', source: 'pictures/garden.webp' });
  await screen.wait({ type: 'backdrop', source: 'pictures/garden.webp' });
  const later = await daemon.stream('?room=kitchen');
  await later.wait({ type: 'backdrop', source: 'pictures/garden.webp' });
  desk.send({ type: 'backdrop', source: '' });
  await later.wait({ type: 'backdrop', source: '' });
  const last = await daemon.stream('?room=kitchen');
  last.send({ type: 'ping', id: 'p' });
  await last.wait({ type: 'pong' });
  assert.deepEqual(of(last, 'backdrop'), []);
  valid(screen, desk, later);
  await close(daemon);
});
