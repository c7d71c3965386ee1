// SPDX-License-Identifier: GPL-3.0-or-later
// Listeners who are heard: the sound of a client becomes words, by a real engine (pocketsphinx), by commands and by a server of the
// Wyoming protocol.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { opusOf, POCKETSPHINX, samplesOf, spoken } from '../../lib/heard-speech.mjs';
import { violations } from '../../lib/schema.mjs';
import { sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-ear-'));
const open = new Set();
after(async () => {
  for (const daemon of open) assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

async function daemonWith(recogniser, options = []) {
  const daemon = await Daemon.start([...(recogniser ? ['--recogniser', recogniser] : []), ...options]);
  open.add(daemon);
  return daemon;
}
const close = async (daemon) => {
  open.delete(daemon);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
};
const begin = (stream, id = 'h', more = {}) => stream.send({ type: 'hear', id, codec: 'pcm_s16le', rate: 16000, lang: 'en', ...more });
const final = (stream, id = 'h') => stream.wait({ type: 'heard', id, final: true });
const valid = (...streams) => streams.forEach(({ messages }) => messages.forEach(({ arrived: _, ...message }) => assert.equal(violations('server', message), null, JSON.stringify(message))));
const of = (stream, type) => stream.messages.filter((m) => m.type === type);

/** Says something to the daemon, and returns the final words. */
async function say(stream, bytes, { id = 'h', ...more } = {}) {
  begin(stream, id, more);
  for (const part of Array.isArray(bytes) ? bytes : [bytes]) stream.socket.send(part);
  stream.send({ type: 'close', id });
  return stream.wait(({ type, id: of, final: whole }) => of === id && (type === 'error' || (type === 'heard' && whole)));
}

test('recognises English speech, as samples and as Opus, for the speaker and the operator', async () => {
  const daemon = await daemonWith(POCKETSPHINX);
  const [speaker, operator, other] = await Promise.all([daemon.stream(), daemon.stream(), daemon.stream()]);
  assert.equal((await speaker.wait({ type: 'hello' })).hears, true);
  for (const stream of [speaker, other]) stream.send({ type: 'join', room: 'kitchen' });
  operator.send({ type: 'join', room: 'kitchen', watch: true, as: 'desk' });
  await operator.wait({ type: 'observers' });
  await other.wait({ type: 'joined' });
  const second = spoken('the second one');
  begin(speaker, 'a');
  await other.wait({ type: 'state', state: 'listening' });
  speaker.socket.send(samplesOf(second));
  speaker.send({ type: 'close', id: 'a' });
  assert.equal((await final(speaker, 'a')).text, 'the second one');
  const { arrived: _, ...told } = await final(operator, 'a');
  assert.deepEqual(told, { type: 'heard', stream: 'kitchen', id: 'a', text: 'the second one', final: true, by: (await speaker.wait({ type: 'hello' })).stream });
  await other.wait({ type: 'state', state: 'idle' });
  assert.equal((await say(speaker, opusOf(second), { id: 'b', codec: 'opus', rate: undefined })).text, 'the second one');
  assert.equal((await say(speaker, samplesOf(spoken('yes please'), 44100, 2), { id: 'c', rate: 44100, channels: 2 })).text, 'yes please');
  assert.equal((await say(speaker, Buffer.alloc(32000), { id: 'd' })).text, '');
  assert.deepEqual(of(other, 'heard'), []);
  for (const id of ['a', 'b', 'c', 'd']) assert.equal(of(operator, 'heard').filter((m) => m.id === id && m.final).length, 1);
  valid(speaker, operator, other);
  await close(daemon);
});

test('chooses an answer on offer by its words, once, and in any language with words', async () => {
  const daemon = await daemonWith(`[ $HEAR_LANG = en ] && exec ${POCKETSPHINX}; cat >/dev/null; echo 'Beh, la seconda, grazie.'`);
  const [speaker, screen] = await Promise.all([daemon.stream('?room=kitchen'), daemon.stream('?room=kitchen')]);
  const { stream: me } = await speaker.wait({ type: 'hello' });
  await screen.wait({ type: 'joined' });
  const offer = (id, choices) => screen.send({ type: 'choices', id, choices });
  offer('a', ['Tea', 'Coffee']);
  await speaker.wait({ type: 'choices', id: 'a' });
  await say(speaker, samplesOf(spoken('the second one')), { id: '1' });
  const { arrived: _, ...chosen } = await screen.wait({ type: 'chosen' });
  assert.deepEqual(chosen, { type: 'chosen', stream: 'kitchen', id: 'a', choice: 1, text: 'Coffee', by: me });
  await say(speaker, samplesOf(spoken('the second one')), { id: '2' }); // nothing is on offer
  offer('b', ['Tè', 'Caffè', 'Latte']);
  await speaker.wait({ type: 'choices', id: 'b' });
  await say(speaker, Buffer.alloc(3200), { id: '3', lang: 'it' });
  await screen.wait({ type: 'chosen', id: 'b', choice: 1, text: 'Caffè' });
  offer('c', ['Sì']); // there is no second
  await speaker.wait({ type: 'choices', id: 'c' });
  await say(speaker, Buffer.alloc(3200), { id: '4', lang: 'it' });
  screen.send({ type: 'choose', id: 'c', choice: 0 });
  await speaker.wait({ type: 'chosen', id: 'c', choice: 0 });
  assert.equal(of(screen, 'chosen').length, 3);
  assert.deepEqual(of(screen, 'error').concat(of(speaker, 'error')), []);
  await close(daemon);
});

test('gives a command the samples and the language, and takes its lines', async () => {
  const daemon = await daemonWith('if [ $HEAR_LANG = it ]; then echo one; echo two; wc -c; else head -c 2 >/dev/null; echo \'{"text":"a\\u0007 b","final":false}\'; cat >/dev/null; echo \'{"text":"a bee","confidence":0.75}\'; echo \'{"text":"sees","confidence":0.5}\'; fi');
  const stream = await daemon.stream();
  assert.equal((await say(stream, Buffer.alloc(32000), { id: 'a', lang: 'it' })).text, 'one two 32000');
  const third = await say(stream, Buffer.alloc(3 * 16000), { id: 'b', lang: 'it', rate: 24000 });
  assert.ok(Math.abs(Number(third.text.split(' ')[2]) - 32000) < 200, third.text); // resampled
  begin(stream, 'c', { lang: 'tr' });
  stream.socket.send(Buffer.alloc(3200));
  await stream.wait({ type: 'heard', id: 'c', text: 'a  b', final: false });
  stream.send({ type: 'close', id: 'c' });
  const { text, confidence } = await final(stream, 'c');
  assert.deepEqual({ text, confidence }, { text: 'a bee sees', confidence: 0.5 });
  valid(stream);
  await close(daemon);
});

test('asks, and returns the answer to those who may speak: over the stream and over HTTP, chosen, heard, late or withdrawn', async () => {
  const daemon = await daemonWith("cat >/dev/null; echo 'il secondo'");
  const [desk, screen] = await Promise.all([daemon.stream('?room=kitchen&lang=it'), daemon.stream('?room=kitchen')]);
  await screen.wait({ type: 'joined' });
  const answered = (id) => desk.wait({ type: 'answered', id });
  // one of its choices, by voice, while she still speaks
  desk.send({ type: 'ask', id: 'a', text: 'Tè o caffè? Oppure niente, per oggi.', choices: ['Tè', 'Caffè'] });
  await screen.wait({ type: 'choices', id: 'a', question: 'Tè o caffè? Oppure niente, per oggi.' });
  await say(screen, Buffer.alloc(3200), { id: '1', lang: 'it' });
  const { arrived: _, by, ...first } = await answered('a');
  assert.deepEqual(first, { type: 'answered', stream: 'kitchen', id: 'a', reason: 'chosen', text: 'Caffè', choice: 1 });
  // any words, over HTTP; the answer waits
  const post = (message) => daemon.get('/v1/rooms/kitchen/commands', { method: 'POST', body: JSON.stringify({ type: 'ask', lang: 'it', ...message }) });
  const posted = post({ id: 'b', text: 'Quale?' });
  await screen.wait({ type: 'asked', id: 'b', question: 'Quale?', seconds: 60 });
  await say(screen, Buffer.alloc(3200), { id: '2', lang: 'it' });
  const response = await posted;
  assert.deepEqual([response.status, await response.json()], [200, { type: 'answered', stream: 'kitchen', id: 'b', reason: 'heard', text: 'il secondo', by }]);
  // nothing in time: its choices are withdrawn
  const from = screen.messages.length;
  assert.deepEqual((({ id, reason }) => [id, reason])(await (await post({ id: 'c', text: 'E ora?', choices: ['Sì', 'No'], seconds: 1 })).json()), ['c', 'timeout']);
  await screen.wait({ type: 'choices', id: 'c', choices: [] }, { from });
  // others take its place
  desk.send({ type: 'ask', id: 'd', text: 'Uno?', choices: ['Sì'] });
  desk.send({ type: 'ask', id: 'e', text: 'Due?', choices: ['Sì'] });
  assert.equal((await answered('d')).reason, 'withdrawn');
  desk.send({ type: 'choices', choices: ['Altro'] });
  assert.equal((await answered('e')).reason, 'withdrawn');
  // cut short by its listener, it waits all the same
  desk.send({ type: 'ask', id: 'f', text: 'Una domanda molto lunga, che nessuno vorrà ascoltare fino alla sua fine, perché sa già la risposta.' });
  await screen.wait({ type: 'word', id: 'f' });
  screen.send({ type: 'stop' });
  await screen.wait({ type: 'asked', id: 'f' });
  await say(screen, Buffer.alloc(3200), { id: '3', lang: 'it' });
  assert.equal((await answered('f')).text, 'il secondo');
  desk.send({ type: 'ask', id: 'g', text: '' });
  await desk.wait({ type: 'error', id: 'g', code: 'empty-text' });
  desk.send({ type: 'ask', id: 'h', text: 'Sì?', choices: 'Sì' });
  await desk.wait({ type: 'error', id: 'h', field: 'choices' });
  desk.send({ type: 'ask', id: 'i', text: 'Sì?', seconds: 0 });
  await desk.wait({ type: 'error', id: 'i', field: 'seconds' });
  // a client that does not wait for it, and a room that empties
  const gone = new AbortController(), lost = daemon.get('/v1/rooms/kitchen/commands', { method: 'POST', signal: gone.signal, body: '{"type":"ask","id":"k","text":"Sì?","lang":"it"}' }).catch(() => {});
  await screen.wait({ type: 'asked', id: 'k' });
  gone.abort();
  await lost;
  const last = post({ id: 'l', text: 'Chi resta?' });
  await screen.wait({ type: 'asked', id: 'l' });
  valid(desk, screen);
  for (const stream of [desk, screen]) await stream.close();
  assert.equal((await (await last).json()).reason, 'failed');
  await close(daemon);
});

for (const [what, command, pattern] of [
  ['cannot be found', 'no-such-program', /exited with status 127.*no-such-program/],
  ['fails', 'cat >/dev/null; echo "no model" >&2; exit 3', /exited with status 3: no model/],
  ['is killed', 'cat >/dev/null; kill -9 $$', /killed by signal 9/],
  ['hangs', 'sleep 1000', /took more than 2 s/],
  ['babbles', 'yes | tr -d "\\n"', /wrote too much/],
  ['writes where it may not', 'cat >/dev/null; echo x >/etc/faccia-ear', /exited with status [12].*\/etc\/faccia-ear/],
  ['is a server that cannot be reached', 'tcp://127.0.0.1:1', /exited with status 1: 127.0.0.1:1: Connection refused/],
  ['is an address without a port', 'tcp://127.0.0.1', /tcp:\/\/HOST:PORT/],
])
  test(`says so when the recogniser ${what}; others are served meanwhile`, async () => {
    const daemon = await daemonWith(command, ['--hear-seconds', '2']);
    const [stream, beside] = await Promise.all([daemon.stream(), daemon.stream()]);
    const answer = say(stream, Buffer.alloc(8000));
    beside.send({ type: 'ping', id: 1 });
    await beside.wait({ type: 'pong' });
    const { type, code, message } = await answer;
    assert.deepEqual([type, code], ['error', 'recogniser-failed']);
    assert.match(message, pattern);
    assert.equal(of(stream, 'error').length, 1);
    await close(daemon);
  });

test('ignores the rest of an utterance whose recogniser has died', async () => {
  const daemon = await daemonWith('exit 4'), stream = await daemon.stream();
  begin(stream);
  await stream.wait({ type: 'error', id: 'h', code: 'recogniser-failed' });
  stream.socket.send(Buffer.alloc(100));
  stream.send({ type: 'close', id: 'h' });
  stream.send({ type: 'ping', id: 2 });
  await stream.wait({ type: 'pong', id: 2 });
  stream.socket.send(Buffer.alloc(100)); // of nothing
  await stream.wait({ type: 'error', code: 'binary-message' });
  assert.equal(of(stream, 'error').length, 2);
  await close(daemon);
});

test('refuses what it cannot hear', async () => {
  const deaf = await daemonWith(null), daemon = await daemonWith(`cat >/dev/null; echo ok; cd ${folder}; while [ ! -e go ]; do sleep 0.1; done`, ['--max-voices', '6']);
  const none = await deaf.stream(), stream = await daemon.stream();
  assert.equal((await none.wait({ type: 'hello' })).hears, false);
  assert.equal((await say(none, Buffer.alloc(0))).code, 'no-recogniser');
  await close(deaf);
  for (const [more, code, field] of [[{ rate: undefined }, 'missing-field', 'rate'], [{ codec: 'shellac' }, 'unknown-codec', 'codec'], [{ rate: 7 }, 'bad-field', 'rate'], [{ lang: 'no good' }, 'bad-field', 'lang']]) {
    begin(stream, 'x', more);
    const { code: told, field: where } = await stream.wait({ type: 'error', id: 'x', code, field });
    assert.deepEqual([told, where], [code, field]);
  }
  stream.send({ type: 'hear', codec: 'opus' });
  await stream.wait({ type: 'error', code: 'missing-field', field: 'id' });
  // a client has four at a time, of which one hears; all of them end
  const before = stream.messages.length;
  for (const id of ['1', '2', '3', '4', '5']) begin(stream, id);
  await stream.wait({ type: 'error', id: '5', code: 'too-many-voices' }, { from: before });
  begin(stream, '4'); // in place of the one before
  stream.send({ type: 'close', id: '4' });
  const more = await daemon.stream();
  for (let i = 0; i < 3; i++) begin(more, `b${i}`);
  await more.wait({ type: 'error', id: 'b2', code: 'too-many-voices' });
  fs.writeFileSync(path.join(folder, 'go'), '');
  for (const id of ['1', '2', '3', '4']) assert.equal((await final(stream, id)).text, 'ok');
  assert.equal(of(stream, 'heard').filter(({ id, final: whole }) => id === '4' && whole).length, 1);
  await close(daemon);
});

test('closes an utterance that is too long, by its sound and by the clock', async () => {
  const daemon = await daemonWith('wc -c', ['--hear-seconds', '1']);
  const stream = await daemon.stream();
  begin(stream, 'a');
  stream.socket.send(Buffer.alloc(64000));
  await stream.wait({ type: 'warning', id: 'a', code: 'unfinished' });
  assert.equal((await final(stream, 'a')).text, '32000');
  begin(stream, 'b');
  await stream.wait({ type: 'warning', id: 'b', code: 'unfinished' });
  assert.equal((await final(stream, 'b')).text, '0');
  await close(daemon);
});

const ours = (name) => fs.readdirSync('/proc').filter((pid) => {
  try {
    return fs.readFileSync(`/proc/${pid}/cmdline`, 'utf8').includes(name);
  } catch {
    return false;
  }
});

test('ends the recogniser when the client leaves its room or disconnects, and the state with it', async () => {
  const mark = String(1000000 + Math.floor(Math.random() * 1e6)), daemon = await daemonWith(`sleep ${mark} & wait`);
  const [stream, other] = await Promise.all([daemon.stream('?room=hall'), daemon.stream('?room=hall')]);
  await other.wait({ type: 'joined' });
  for (const leave of [() => stream.send({ type: 'leave' }), () => stream.socket.terminate()]) {
    const from = other.messages.length;
    stream.send({ type: 'join', room: 'hall' });
    begin(stream, `x${from}`);
    await other.wait({ type: 'state', state: 'listening' }, { from });
    await eventually(() => ours(`sleep\0${mark}`).length === 1, 'the program runs');
    leave();
    await other.wait({ type: 'state', state: 'idle' }, { from });
    await eventually(() => !ours(mark).some((pid) => Number(pid) !== daemon.process.pid), 'the program and its child have ended');
  }
  // another's state stays
  const from = other.messages.length;
  begin(other, 'y');
  await other.wait({ type: 'state', state: 'listening' }, { from });
  other.send({ type: 'state', state: 'thinking' });
  await other.wait({ type: 'state', state: 'thinking' }, { from });
  const late = await daemon.stream('?room=hall');
  other.send({ type: 'leave' });
  await other.wait({ type: 'left' }, { from });
  late.send({ type: 'ping', id: 1 });
  await late.wait({ type: 'pong' });
  assert.deepEqual(of(late, 'state').map(({ state }) => state), ['thinking']);
  await close(daemon);
});

test('tells the words to those with the right only', async () => {
  const secret = 'a-secret-that-is-long-enough-for-tests', file = path.join(folder, 'secrets');
  fs.writeFileSync(file, `${secret}\n`, { mode: 0o600 });
  const daemon = await daemonWith('cat >/dev/null; echo words', ['--secret-file', file]);
  const token = (sub, rights, room = 'hall') => sign({ secret, claims: { sub, rights, room } });
  const enter = (sub, rights, query = '') => daemon.stream(`?room=hall&token=${token(sub, rights)}${query}`);
  const [speaker, desk, curious, deputy] = await Promise.all([enter('nonna', 'listen'), enter('desk', 'listen speak', '&watch=1'), enter('curious', 'listen', '&watch=1'), enter('deputy', 'listen speak')]);
  const events = await fetch(`${daemon.url}/v1/events?room=hall&watch=1&token=${token('bridge', 'listen speak')}`);
  const reader = events.body.pipeThrough(new TextDecoderStream()).getReader();
  for (const stream of [speaker, desk, curious, deputy]) await stream.wait({ type: 'joined' });
  assert.equal((await say(speaker, Buffer.alloc(3200))).text, 'words');
  assert.equal((await final(desk)).by, 'nonna');
  for (let text = ''; !/event: heard\ndata: .*"final":true/.test(text);) {
    const { value, done } = await reader.read();
    assert.ok(!done);
    text += value;
  }
  await reader.cancel();
  for (const stream of [curious, deputy]) {
    stream.send({ type: 'ping', id: 1 });
    await stream.wait({ type: 'pong' });
    assert.deepEqual(of(stream, 'heard'), []);
  }
  const outside = await daemon.stream(), elsewhere = await daemon.stream(`?token=${token('nonna', 'listen')}`);
  assert.equal((await say(outside, Buffer.alloc(0))).code, 'token-needed');
  assert.equal((await say(elsewhere, Buffer.alloc(0))).code, 'forbidden');
  await close(daemon);
});

/** A stand-in for a server of the Wyoming protocol: counts the bytes of sound, and answers as the language says. */
async function wyoming() {
  const heard = [];
  const server = net.createServer((socket) => {
    let bytes = Buffer.alloc(0), size = 0, lang;
    const send = (type, data) => {
      const body = Buffer.from(JSON.stringify(data));
      socket.write(`${JSON.stringify({ type, version: '1.8.0', data_length: body.length })}\n`);
      socket.write(body);
    };
    socket.on('error', () => {});
    socket.on('data', (part) => {
      bytes = Buffer.concat([bytes, part]);
      for (let end; (end = bytes.indexOf('\n')) >= 0;) {
        const { type, data_length: length = 0, payload_length: payload = 0 } = JSON.parse(bytes.subarray(0, end));
        if (bytes.length < end + 1 + length + payload) return;
        const data = length ? JSON.parse(bytes.subarray(end + 1, end + 1 + length)) : {};
        bytes = bytes.subarray(end + 1 + length + payload);
        heard.push(type);
        if (type === 'transcribe') lang = data.language;
        if (type === 'audio-start') assert.deepEqual(data, { rate: 16000, width: 2, channels: 1 });
        size += payload;
        if (type === 'audio-chunk' && lang === 'fr') socket.end();
        if (type !== 'audio-stop') continue;
        if (lang === 'de') return void send('error', { text: 'no model', code: 'x' });
        if (lang === 'es') return void socket.write('HTTP/1.1 400 Bad Request\r\n\r\n');
        for (const text of ['in ', 'parts']) send('transcript-chunk', { text });
        send('transcript', { text: `${lang} ${size}` });
      }
    });
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  server.unref();
  return { server, heard, address: `tcp://localhost:${server.address().port}` };
}

test('asks a server of the Wyoming protocol', async () => {
  const { server, heard, address } = await wyoming(), daemon = await daemonWith(address);
  const stream = await daemon.stream();
  const answer = await say(stream, Buffer.alloc(20000), { id: 'it', lang: 'it' });
  assert.equal(answer.text, 'it 20000');
  assert.deepEqual(of(stream, 'heard').map(({ text, final: whole }) => [text, whole]), [['in', false], ['in parts', false], ['it 20000', false], ['it 20000', true]]);
  assert.deepEqual([heard[0], heard[1], heard.at(-1)], ['transcribe', 'audio-start', 'audio-stop']);
  for (const [lang, pattern] of [['de', /no model/], ['fr', /the server hung up/], ['es', /a line is not a JSON object with a type/]]) {
    const { code, message } = await say(stream, Buffer.alloc(20000), { id: lang, lang });
    assert.equal(code, 'recogniser-failed');
    assert.match(message, pattern);
  }
  valid(stream);
  await close(daemon);
  server.close();
});
