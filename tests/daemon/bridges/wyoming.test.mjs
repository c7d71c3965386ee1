// SPDX-License-Identifier: GPL-3.0-or-later
// faccia-wyoming with a client written after the protocol's specification, because its library is not packaged.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import net from 'node:net';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';

let daemon;
const running = new Set();

async function start(...options) {
  const child = spawn(path.join(build, 'server/bridges/faccia-wyoming'), ['--listen', '0', '--url', daemon.url, ...options]);
  running.add(child);
  child.text = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (child.text += text));
  child.exited = once(child, 'exit').then(([code]) => (running.delete(child), code));
  const [, port] = await eventually(() => child.text.match(/port (\d+)/), 'the port');
  return { child, port: Number(port), stop: () => (child.kill('SIGTERM'), child.exited) };
}

/** Connects an assistant that sends and receives events. */
async function connect(port) {
  const socket = net.connect(port, '127.0.0.1');
  await once(socket, 'connect');
  const events = [];
  let bytes = Buffer.alloc(0);
  socket.on('error', () => {});
  socket.on('data', (data) => {
    bytes = Buffer.concat([bytes, data]);
    for (let end; (end = bytes.indexOf(10)) >= 0; ) {
      const { type, data_length = 0, payload_length = 0 } = JSON.parse(bytes.subarray(0, end));
      if (bytes.length < end + 1 + data_length + payload_length) return;
      const more = bytes.subarray(end + 1, end + 1 + data_length);
      events.push({ type, data: data_length ? JSON.parse(more) : {}, payload: bytes.subarray(end + 1 + data_length, end + 1 + data_length + payload_length) });
      bytes = bytes.subarray(end + 1 + data_length + payload_length);
    }
  });
  return {
    events, socket,
    send: (type, data, { inLine = false } = {}) => {
      const text = JSON.stringify(data ?? {});
      socket.write(inLine ? `${JSON.stringify({ type, data })}\n` : `${JSON.stringify({ type, data_length: Buffer.byteLength(text) })}\n${text}`);
    },
    heard: (type) => eventually(() => events.find((e) => e.type === type), `${type}; ${events.map((e) => e.type)}`),
    closed: () => eventually(() => socket.closed || socket.destroyed, 'the end of the connection'),
  };
}
const pcmOf = (events) => Buffer.concat(events.filter((e) => e.type === 'audio-chunk').map((e) => e.payload));
const loudest = (pcm) => new Int16Array(pcm.buffer.slice(pcm.byteOffset, pcm.byteOffset + pcm.length)).reduce((most, v) => Math.max(most, Math.abs(v)), 0);

let door;
before(async () => {
  daemon = await Daemon.start();
  door = await start();
});
after(async () => {
  assert.equal(await door.stop(), 0, door.child.text);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  for (const child of running) child.kill('SIGKILL');
});

test('describes itself: its voices, their languages, and streaming', async () => {
  const client = await connect(door.port);
  client.send('describe');
  const [tts] = (await client.heard('info')).data.tts;
  assert.equal(tts.supports_synthesize_streaming, true);
  assert.ok(tts.installed && tts.name && tts.version && 'url' in tts.attribution);
  const voice = tts.voices.find((v) => v.name === 'espeak:it');
  assert.deepEqual(voice.languages, ['it']);
  assert.ok(voice.installed && voice.description);
  client.socket.end();
});

test('speaks a text with the daemon\'s own sound, in chunks with their times', async () => {
  const client = await connect(door.port);
  const text = 'La cena è pronta.';
  client.send('synthesize', { text, voice: { name: 'espeak:it' } });
  await client.heard('audio-stop');
  const [first, ...rest] = client.events;
  assert.equal(first.type, 'audio-start');
  assert.deepEqual([first.data.width, first.data.channels, first.data.rate], [2, 1, 22050]);
  const wav = Buffer.from(await (await daemon.get('/v1/speech?voice=espeak:it&markup=plain', { method: 'POST', body: text, headers: { 'content-type': 'text/plain' } })).arrayBuffer());
  assert.ok(pcmOf(client.events).equals(wav.subarray(44)));
  const chunks = rest.filter((e) => e.type === 'audio-chunk');
  let at = 0;
  for (const { data, payload } of chunks) {
    assert.ok(Math.abs(data.timestamp - (1000 * at) / 22050) < 0.1);
    at += payload.length / 2;
  }
  // the next request selects by language, with its data in the header line
  client.events.length = 0;
  client.send('synthesize', { text: 'Good morning.', voice: { language: 'en' } }, { inLine: true });
  await client.heard('audio-stop');
  assert.ok(loudest(pcmOf(client.events)) > 1000);
  client.events.length = 0;
  client.send('synthesize', { text: '<speak>Uno <break time="2s"/> due.</speak>', text_format: 'ssml', voice: { name: 'espeak:it' } });
  await client.heard('audio-stop');
  assert.ok(pcmOf(client.events).length > 2.5 * 44100);
  client.socket.end();
});

test('plays a text written word by word sentence by sentence, and ignores its copy', async () => {
  const client = await connect(door.port);
  client.send('synthesize-start', { voice: { name: 'espeak:it' } });
  for (const word of ['Ho chiama', 'to il dott. Rossi', ' per telefono. ', 'Viene ']) client.send('synthesize-chunk', { text: word });
  await client.heard('audio-chunk'); // before the text ends
  for (const word of ['alle 3', '.30', '? ', 'Bene']) client.send('synthesize-chunk', { text: word });
  client.send('synthesize', { text: 'Ho chiamato il dott. Rossi per telefono. Viene alle 3.30? Bene' });
  client.send('synthesize-stop');
  await client.heard('synthesize-stopped');
  const types = client.events.map((e) => e.type).filter((type) => type !== 'audio-chunk');
  assert.deepEqual(types, ['audio-start', 'audio-stop', 'synthesize-stopped']);
  const one = pcmOf(client.events).length;
  client.events.length = 0;
  client.send('synthesize', { text: 'Ho chiamato il dott. Rossi per telefono. Viene alle 3.30? Bene', voice: { name: 'espeak:it' } });
  await client.heard('audio-stop');
  const whole = pcmOf(client.events).length;
  assert.ok(Math.abs(one / whole - 1) < 0.2, `${one} ${whole}`);
  client.events.length = 0;
  client.send('synthesize-start', { voice: { name: 'espeak:it' } });
  client.send('synthesize-chunk', { text: ' ' });
  client.send('synthesize-stop');
  await client.heard('synthesize-stopped');
  assert.deepEqual(client.events.map((e) => e.type), ['synthesize-stopped']);
  client.socket.end();
});

test('text written word by word is one utterance in the room; a client that disconnects leaves what it wrote', async () => {
  const kiosk = await daemon.stream('?lang=it&room=parlour');
  await kiosk.wait({ type: 'joined' });
  const both = await start('--room', 'parlour');
  const client = await connect(both.port);
  client.send('synthesize-start', { voice: { name: 'espeak:it' } });
  for (const word of ['È arrivata ', 'la posta. Ci sono ', 'tre lettere, ']) client.send('synthesize-chunk', { text: word });
  await kiosk.wait({ type: 'sentence', text: 'È arrivata la posta.' }); // before the text ends
  for (const word of ['del dott. Neri. ', 'Le apro?']) client.send('synthesize-chunk', { text: word });
  client.send('synthesize-stop');
  await client.heard('synthesize-stopped');
  await kiosk.wait({ type: 'end', reason: 'done' });
  const said = (from) => kiosk.messages.slice(from).filter((m) => m.type === 'sentence').map((m) => m.text);
  assert.deepEqual(said(0), ['È arrivata la posta.', 'Ci sono tre lettere, del dott. Neri.', 'Le apro?']);
  assert.equal(kiosk.messages.filter((m) => m.type === 'begin').length, 1);
  const from = kiosk.messages.length;
  client.send('synthesize-start', { voice: { name: 'espeak:it' } });
  client.send('synthesize-chunk', { text: 'Questo è tutto. E poi ' });
  await kiosk.wait({ type: 'sentence', text: 'Questo è tutto.' }, { from });
  client.socket.write('{"type":"synthesize-chunk","data_length":40}\n{"text":"nient'); // half a frame
  client.socket.destroy();
  await kiosk.wait({ type: 'warning', code: 'unfinished' }, { from });
  await kiosk.wait({ type: 'end', reason: 'done' }, { from });
  assert.deepEqual(said(from), ['Questo è tutto.', 'E poi']);
  assert.equal(await both.stop(), 0, both.child.text);
  await kiosk.close();
});

test('the face of a room speaks it at the same time; the client may get silence of the same length', async () => {
  const kiosk = await daemon.stream('?lang=it&room=kitchen');
  await kiosk.wait({ type: 'joined' });
  const silent = await start('--room', 'kitchen', '--silent');
  const client = await connect(silent.port);
  client.send('synthesize', { text: 'Detto dalla faccia.', voice: { name: 'espeak:it' } });
  await client.heard('audio-stop');
  await kiosk.wait({ type: 'sentence', text: 'Detto dalla faccia.' });
  const { duration } = await kiosk.wait({ type: 'end', reason: 'done' });
  assert.equal(loudest(pcmOf(client.events)), 0);
  assert.ok(Math.abs(pcmOf(client.events).length / 44100 - duration) < 0.1);
  client.socket.end();
  assert.equal(await silent.stop(), 0, silent.child.text);
  await kiosk.close();
});

// The room accepts the text and fails later because of its voice: the face must not stay silent.
test('the face of a room uses its own voice where the requested one is unknown, and the caller gets an error', async () => {
  const kiosk = await daemon.stream('?lang=it&room=bath');
  await kiosk.wait({ type: 'joined' });
  const own = await start('--room', 'bath');
  await new Promise((resolve) => setTimeout(resolve, 300));
  for (const [i, voice] of [{ name: 'nobody:x' }, { name: 'nobody:x', language: 'en' }, { language: 'xx' }, { language: 'c' }].entries()) {
    const client = await connect(own.port);
    client.send('synthesize', { text: `Numero ${i}.`, voice });
    await client.heard(voice.name ? 'error' : 'audio-stop');
    await kiosk.wait({ type: 'sentence', text: `Numero ${i}.` });
    client.socket.end();
  }
  assert.equal(await own.stop(), 0, own.child.text);
  await kiosk.close();
});

const spoken = async (body) => (await daemon.get('/v1/speech?format=wav&voice=espeak:it&markup=plain', { method: 'POST', body })).arrayBuffer();

test('a long text arrives complete, also at a slow client', async () => {
  const client = await connect(door.port);
  const text = 'Una frase lunga, che si ripete sempre. '.repeat(400);
  // the second time the sound comes from the cache, so it is reproducible
  const [, whole] = [await spoken(text), await spoken(text)];
  client.send('synthesize', { text, voice: { name: 'espeak:it' } });
  await client.heard('audio-chunk');
  for (let i = 0; i < 3; i++) {
    client.socket.pause();
    await new Promise((resolve) => setTimeout(resolve, 200));
    client.socket.resume();
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  await client.heard('audio-stop');
  assert.equal(pcmOf(client.events).length, whole.byteLength - 44);
  client.socket.end();
});

test('answers simultaneous requests in order', async () => {
  const client = await connect(door.port);
  client.send('ping', { text: 'x' });
  for (const text of ['Uno.', 'Due.', 'Tre.']) client.send('synthesize', { text, voice: { name: 'espeak:it' } });
  client.send('describe');
  await client.heard('info');
  assert.deepEqual(client.events.map((e) => e.type).filter((type) => type !== 'audio-chunk'), ['pong', ...Array(3).fill(['audio-start', 'audio-stop']).flat(), 'info']);
  client.socket.end();
});

test('reports errors or ends the connection; no one else is affected', async () => {
  const other = await connect(door.port);
  const client = await connect(door.port);
  client.send('nonsense', { x: 1 });
  client.send('synthesize', { text: 'Ancora qui.', voice: { name: 'espeak:it' } });
  await client.heard('audio-chunk');
  client.socket.destroy(); // during the speech
  for (const bytes of ['x\n', '{"type":7}\n', '{"type":"a","data_length":-1}\n', '{"type":"a","data_length":99999999}\n', '{"type":"a","data_length":3}\n[1]', '['.repeat(70000)]) {
    const bad = await connect(door.port);
    bad.socket.write(bytes);
    await bad.closed();
  }
  const half = await connect(door.port);
  half.socket.end('{"type":"synthesize","data_length":100}\n{"te');
  await half.closed();
  other.send('synthesize', { text: 'Tutto bene.', voice: { name: 'espeak:it' } });
  await other.heard('audio-stop');
  other.socket.end();
});

test('every text ends with audio-stop, or with an error and the end of the connection', async () => {
  const client = await connect(door.port);
  const speak = async (data) => {
    client.events.length = 0;
    client.send('synthesize', data);
    await client.heard('audio-stop');
    assert.equal(client.events[0].type, 'audio-start');
    return pcmOf(client.events);
  };
  for (const text of ['', ' ', '\n\t ', '👍🏽', ' ❤️\n🇮🇹']) assert.equal((await speak({ text })).length, 0, JSON.stringify(text));
  // an unknown language: the daemon's default speaks
  const usual = await speak({ text: 'Seven.' }), english = await speak({ text: 'Seven.', voice: { language: 'en' } });
  assert.ok(loudest(usual) > 1000 && !usual.equals(english));
  for (const language of ['xx', 'c', 'not a tag\n', '']) assert.ok((await speak({ text: 'Seven.', voice: { language } })).equals(usual), language);
  client.events.length = 0;
  client.send('synthesize-start', { voice: { language: 'xx' } });
  client.send('synthesize-chunk', { text: 'Uno. Due.' });
  client.send('describe'); // during the speech
  await client.heard('info');
  client.send('synthesize-chunk', { text: ' Tre.' });
  client.send('synthesize-stop');
  await client.heard('synthesize-stopped');
  assert.ok(pcmOf(client.events).length > 44100, 'all of it');
  client.socket.end();
  // an unknown voice is an error, as in wyoming-piper
  for (const [type, data] of [['synthesize', { text: 'Seven.', voice: { name: 'nobody:x' } }], ['synthesize', { text: 'Seven.', voice: { name: 'nobody:x', language: 'en' } }],
    ['synthesize-start', { voice: { name: 'nobody:x' } }]]) {
    const refused = await connect(door.port);
    refused.send(type, data);
    if (type === 'synthesize-start') {
      refused.send('synthesize-chunk', { text: 'Seven.' });
      refused.send('synthesize-stop');
    }
    const { data: { text, code } } = await refused.heard('error');
    assert.match(text, /nobody:x/);
    assert.equal(code, 'unknown-voice');
    await refused.closed();
    assert.equal(refused.events.length, 1);
  }
  for (const [data, why] of [[{}, /no text/], [{ text: 7 }, /no text/], [{ text: 'a'.repeat(100001) }, /too long/], [{ text: '<speak>', text_format: 'ssml' }, /./]]) {
    const refused = await connect(door.port);
    refused.send('synthesize', data);
    await refused.closed();
    if (refused.events.some((e) => e.type === 'audio-stop')) continue; // it was spoken nevertheless
    assert.match((await refused.heard('error')).data.text, why);
    assert.equal(refused.events.length, 1);
  }
});

test('without its daemon, reports an error for each request and disconnects', async () => {
  const away = await start('--url', 'http://127.0.0.1:1');
  for (const [type, data] of [['describe'], ['synthesize', { text: 'Ciao.' }], ['synthesize-start', {}]]) {
    const client = await connect(away.port);
    client.send(type, data);
    await client.closed();
    assert.deepEqual(client.events.map((e) => e.type), ['error'], type);
  }
  assert.equal(await away.stop(), 0, away.child.text);
});

test('clients that disconnect in the middle of the sound do not affect the others', async () => {
  for (let round = 0; round < 5; round++) {
    const client = await connect(door.port);
    client.send('synthesize', { text: 'Una frase molto lunga. '.repeat(50), voice: { name: 'espeak:it' } });
    await client.heard('audio-chunk');
    client.socket.resetAndDestroy();
  }
  const client = await connect(door.port);
  client.send('synthesize', { text: 'Ancora qui.', voice: { name: 'espeak:it' } });
  await client.heard('audio-stop');
  assert.equal(door.child.exitCode ?? door.child.signalCode, null);
  client.socket.end();
});

test('reports wrong options', async () => {
  const run = async (...options) => {
    const child = spawn(path.join(build, 'server/bridges/faccia-wyoming'), options);
    child.stdout.resume();
    child.stderr.resume();
    return (await once(child, 'exit'))[0];
  };
  for (const options of [['--listen', 'x'], ['--listen', '70000'], ['--listen', 'a.b.c:1'], ['--silent'], ['--nothing'], ['x'], ['--url', 'kitchen']]) assert.equal(await run(...options), 2, String(options));
  assert.equal(await run('--listen', `${door.port}`, '--url', daemon.url), 1);
  assert.equal(await run('--help'), 0);
});
