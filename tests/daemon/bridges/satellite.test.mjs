// SPDX-License-Identifier: GPL-3.0-or-later
// faccia-satellite between the daemon and a stand-in for Home Assistant, which does what its Wyoming integration does: it connects,
// sends run-satellite, takes run-pipeline and the microphone's sound, and sends states, words, the answer's text and its sound.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import net from 'node:net';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';
import { connect, serve, tone } from '../../lib/wyoming-events.mjs';

const program = path.join(build, 'server/bridges/faccia-satellite');
const running = new Set();
let port, daemon, kiosk, door, assistant, count = 0;

const freePort = () => new Promise((resolve) => {
  const server = net.createServer().listen(0, '127.0.0.1', () => {
    const { port: free } = server.address();
    server.close(() => resolve(free));
  });
});
async function start(listen, url, ...options) {
  const child = spawn(program, ['--listen', String(listen), '--url', url, '--room', 'kitchen', '--lang', 'it', ...options]);
  running.add(child);
  child.text = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (child.text += text));
  child.stdout.resume();
  child.exited = once(child, 'exit').then(([code]) => (running.delete(child), code));
  await eventually(() => child.text.includes('listening on') || child.exitCode !== null, 'the satellite');
  await eventually(() => child.text.includes('connected to the daemon'), 'the daemon');
  return child;
}
const stop = (child) => (child.kill('SIGTERM'), child.exited);

/** Connects as Home Assistant does. */
async function assist(to = port) {
  const peer = await connect(to);
  peer.send('run-satellite');
  peer.send('describe');
  await peer.heard('info');
  return peer;
}
/** Says something in the room; returns the id of the utterance. */
function speak(seconds = 1, by = kiosk) {
  const id = `h${count++}`, sound = tone(seconds);
  by.send({ type: 'hear', id, lang: 'it', codec: 'pcm_s16le', rate: 16000 });
  for (let at = 0; at < sound.length; at += 3200) by.socket.send(sound.subarray(at, at + 3200));
  by.send({ type: 'close', id });
  return id;
}
/** Recognises the words of the current pipeline. */
function recognise(words, peer = assistant) {
  peer.send('transcribe', { language: 'it' });
  peer.send('voice-started', { timestamp: 10 });
  peer.send('voice-stopped', { timestamp: 800 });
  peer.send('transcript', { text: words });
}
function playSound(seconds, peer = assistant, rate = 22050) {
  const format = { rate, width: 2, channels: 1 }, sound = tone(seconds, rate);
  peer.send('audio-start', { ...format, timestamp: 0 });
  for (let at = 0; at < sound.length; at += 2048) peer.send('audio-chunk', { ...format, timestamp: Math.floor((500 * at) / rate) }, sound.subarray(at, at + 2048));
  peer.send('audio-stop', { timestamp: 1000 * seconds });
}
function reply(text, seconds = 0.5, peer = assistant) {
  peer.send('synthesize', { text, voice: { name: 'it_IT-paola-medium', language: 'it' } });
  playSound(seconds, peer);
}
const states = (from, stream = kiosk) => stream.messages.slice(from).filter((m) => m.type === 'state').map((m) => m.state);
const idle = (from, stream = kiosk) => eventually(() => states(from, stream).at(-1) === 'idle', `idle; ${states(from, stream)}`);

before(async () => {
  port = await freePort();
  daemon = await Daemon.start(['--recogniser', `tcp://127.0.0.1:${port}`]);
  kiosk = await daemon.stream('?lang=it&room=kitchen');
  await kiosk.wait({ type: 'joined' });
  door = await start(port, daemon.url);
  assistant = await assist();
});
after(async () => {
  await kiosk.close();
  assert.equal(await stop(door), 0, door.text);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  for (const child of running) child.kill('SIGKILL');
  assistant.socket.destroy();
});

test('describes itself as a satellite, and answers pings', async () => {
  const { data } = await assistant.heard('info');
  assert.deepEqual([data.satellite.name, data.satellite.installed, data.satellite.has_vad, data.satellite.attribution], ['kitchen', true, true, { name: 'faccia', url: '' }]);
  for (const kind of ['asr', 'tts', 'handle', 'intent', 'wake', 'mic', 'snd']) assert.deepEqual(data[kind], [], kind);
  assistant.send('ping', { text: 'x' });
  assert.deepEqual((await assistant.heard('pong')).data, { text: 'x' });
});

test('what is said in the room goes to the assistant; the face says its answer, and shows its states', async () => {
  const from = kiosk.messages.length, before = assistant.events.length;
  const id = speak(1);
  const { data } = await assistant.heard('run-pipeline', { from: before });
  assert.deepEqual([data.start_stage, data.end_stage, data.restart_on_end], ['asr', 'tts', false]);
  await assistant.heard('audio-stop', { from: before });
  const chunks = assistant.events.slice(before).filter((e) => e.type === 'audio-chunk');
  assert.ok(Buffer.concat(chunks.map((e) => e.payload)).equals(tone(1)), 'the whole sound');
  assert.ok(chunks.every((e) => e.data.rate === 16000 && e.data.width === 2 && e.data.channels === 1));
  recognise('Che ore sono?');
  await kiosk.wait({ type: 'heard', id, text: 'Che ore sono?', final: true }, { from });
  await kiosk.wait({ type: 'state', state: 'thinking', text: 'Che ore sono?' }, { from });
  reply('**Sono** le otto. 😀');
  await kiosk.wait({ type: 'end', reason: 'done' }, { from });
  await assistant.heard('played', { from: before });
  await idle(from);
  assert.deepEqual(kiosk.messages.slice(from).filter((m) => m.type === 'word').map((m) => m.text), ['Sono', 'le', 'otto']);
  assert.equal(kiosk.messages.slice(from).filter((m) => m.type === 'begin').length, 1, 'the assistant’s own sound is not played');
  assert.deepEqual([...new Set(states(from))].filter((state) => state !== 'idle'), ['listening', 'thinking']);
});

test('an announcement, which has no text, moves the face to its sound, in real time', async () => {
  const from = kiosk.messages.length, before = assistant.events.length;
  playSound(1);
  assert.equal((await kiosk.wait({ type: 'begin' }, { from })).captions, false);
  const { duration } = await kiosk.wait({ type: 'end', reason: 'done' }, { from });
  assert.ok(duration > 0.9 && duration < 2, `${duration} s`);
  await assistant.heard('played', { from: before });
});

test('an answer that somebody stops has been played, and the next words are heard', async () => {
  for (const answers of [() => reply('Una risposta lunga, che nessuno vuole sentire fino alla fine, perché è tardi.', 5), () => playSound(10)]) {
    const from = kiosk.messages.length, before = assistant.events.length;
    answers();
    await kiosk.wait({ type: 'begin' }, { from });
    kiosk.send({ type: 'stop' });
    await kiosk.wait({ type: 'end', reason: 'stopped' }, { from });
    await assistant.heard('played', { from: before });
    const id = speak(0.5);
    await assistant.heard('run-pipeline', { from: before });
    recognise('Basta così.');
    await kiosk.wait({ type: 'heard', id, text: 'Basta così.', final: true }, { from });
    assistant.send('error', { text: '', code: 'duplicate_wake_up_detected' });
    await idle(from);
  }
});

test('the assistant begins a conversation: the face asks, and the next words go to the pipeline', async () => {
  const from = kiosk.messages.length, before = assistant.events.length;
  assistant.send('run-pipeline', { start_stage: 'asr', end_stage: 'tts', announce_text: 'Vuoi la luce?' });
  await kiosk.wait({ type: 'asked', question: 'Vuoi la luce?' }, { from });
  await assistant.heard('played', { from: before });
  speak();
  assert.equal((await assistant.heard('run-pipeline', { from: before })).data.end_stage, 'tts');
  recognise('Sì, grazie.');
  await kiosk.wait({ type: 'heard', text: 'Sì, grazie.', final: true }, { from });
  reply('Ecco la luce.');
  await kiosk.wait({ type: 'sentence', text: 'Ecco la luce.' }, { from });
  await assistant.heard('played', { from: before, is: (e) => assistant.events.indexOf(e) > assistant.events.findLastIndex((o) => o.type === 'run-pipeline') });
  const next = assistant.events.length;
  assistant.send('run-pipeline', { start_stage: 'tts', end_stage: 'tts', announce_text: 'Solo un avviso.' });
  await kiosk.wait({ type: 'sentence', text: 'Solo un avviso.' }, { from });
  await assistant.heard('played', { from: next });
});

test('an answer to a question of the room is recognised, and not acted upon', async () => {
  const from = kiosk.messages.length, before = assistant.events.length;
  kiosk.send({ type: 'choices', id: 'pill', question: 'Hai preso la medicina?', choices: ['Sì', 'Non ancora'] });
  await kiosk.wait({ type: 'choices', id: 'pill' }, { from });
  await eventually(async () => {
    const begun = assistant.events.length; // the satellite may not have heard of the question yet
    speak(0.5);
    const { data } = await assistant.heard('run-pipeline', { from: begun });
    if (data.end_stage !== 'asr') recognise('');
    return data.end_stage === 'asr';
  }, 'a pipeline that only recognises');
  recognise('Non ancora.');
  assert.equal((await kiosk.wait({ type: 'chosen', id: 'pill' }, { from })).choice, 1);
  assert.ok(before < assistant.events.length);
});

test('shows what went wrong; silence is nobody’s trouble', async () => {
  const from = kiosk.messages.length, before = assistant.events.length;
  const id = speak();
  await assistant.heard('audio-stop', { from: before });
  assistant.send('error', { text: 'No speech-to-text engine', code: 'stt-provider-missing' });
  await kiosk.wait({ type: 'state', state: 'error', text: 'No speech-to-text engine' }, { from });
  await kiosk.wait({ type: 'error', code: 'recogniser-failed', id }, { from });
  const next = assistant.events.length, later = kiosk.messages.length;
  const quiet = speak();
  await assistant.heard('audio-stop', { from: next });
  assistant.send('error', { text: 'No text recognized', code: 'stt-no-text-recognized' });
  assert.equal((await kiosk.wait({ type: 'heard', id: quiet, final: true }, { from: later })).text, '');
  assert.ok(!states(later).includes('error'));
});

test('shows when timers end, and says so', async () => {
  const from = kiosk.messages.length;
  assistant.send('timer-started', { id: 'p', total_seconds: 300, name: 'pasta' });
  await eventually(() => kiosk.messages.slice(from).some((m) => m.type === 'state' && m.state === 'idle' && /^⌛ pasta \d\d:\d\d$/.test(m.text)), 'the timer');
  assistant.send('timer-started', { id: 'q', total_seconds: 30, name: null });
  await eventually(() => kiosk.messages.slice(from).some((m) => /^⌛ \d\d:\d\d · ⌛ pasta/.test(m.text)), 'both, in order');
  assistant.send('timer-updated', { id: 'q', is_active: false, total_seconds: 20 });
  assistant.send('timer-cancelled', { id: 'q' });
  assistant.send('timer-finished', { id: 'p' });
  await kiosk.wait({ type: 'sentence', text: 'Il timer per pasta è scaduto.' }, { from });
  await kiosk.wait({ type: 'end', reason: 'done' }, { from });
  assistant.send('timer-finished', { id: 'unknown' });
  await kiosk.wait({ type: 'sentence', text: 'Il timer è scaduto.' }, { from });
  await kiosk.wait({ type: 'end', reason: 'done' }, { from: kiosk.messages.length - 1 }).catch(() => {});
  assert.equal(kiosk.messages.findLast((m) => m.type === 'state').text ?? '', '', 'no timer is left');
});

test('switched off, in another room, or without an assistant it hears nothing, and says why', async () => {
  const refused = async (stream, reason) => {
    const from = stream.messages.length, id = speak(0.3, stream);
    assert.match((await stream.wait({ type: 'error', code: 'recogniser-failed', id }, { from })).message, reason);
  };
  assistant.send('pause-satellite');
  await kiosk.wait({ type: 'state', state: 'muted' });
  const from = kiosk.messages.length;
  await refused(kiosk, /has switched this satellite off/);
  await eventually(() => states(from).at(-1) === 'muted', `muted again; ${states(from)}`);
  assistant.send('run-satellite');
  await idle(from);
  const hall = await daemon.stream('?lang=it&room=hall');
  await hall.wait({ type: 'joined' });
  await refused(hall, /serves the room kitchen/);
  await hall.close();
  const before = assistant.events.length;
  assistant.socket.destroy();
  await eventually(() => door.text.includes('the assistant is gone'), 'the end of the assistant');
  await refused(kiosk, /no assistant is connected/);
  assert.equal(before, assistant.events.length);
  assistant = await assist();
});

test('an assistant that restarts takes over from its former connection', async () => {
  const former = assistant;
  assistant = await assist();
  await former.closed();
  const from = kiosk.messages.length;
  speak();
  await assistant.heard('audio-stop');
  recognise('Eccomi.');
  await kiosk.wait({ type: 'heard', text: 'Eccomi.', final: true }, { from });
  assistant.send('error', { text: '', code: 'duplicate_wake_up_detected' });
  await idle(from);
});

/** Brings a satellite of its own to a state. */
const stages = {
  idle: async () => {},
  listening: async ({ stream, peer }) => {
    stream.send({ type: 'hear', id: `h${count++}`, lang: 'it', codec: 'pcm_s16le', rate: 16000 });
    stream.socket.send(tone(0.5));
    await peer.heard('audio-chunk');
  },
  thinking: async ({ stream, peer }) => {
    speak(0.5, stream);
    await peer.heard('audio-stop');
    recognise('Che tempo fa?', peer);
    await stream.wait({ type: 'state', state: 'thinking', text: 'Che tempo fa?' });
  },
  speaking: async (all) => {
    await stages.thinking(all);
    reply('Una risposta lunga, che nessuno ascolterà fino alla fine perché qualcuno se ne va.', 3, all.peer);
    await all.stream.wait({ type: 'begin' });
  },
  announcing: async ({ stream, peer }) => {
    playSound(5, peer);
    await stream.wait({ type: 'begin' });
  },
};
let satelliteLog = () => '';
/** Someone asks, and is answered. */
async function works({ stream, peer }) {
  const from = stream.messages.length, before = peer.events.length;
  const id = speak(0.5, stream);
  await peer.heard('audio-stop', { from: before });
  recognise('Ci sei?', peer);
  const { text } = await stream.wait((m) => m.id === id && (m.final || m.type === 'error'), { from });
  assert.equal(text, 'Ci sei?', `${JSON.stringify(stream.messages.slice(from))} ${peer.events.slice(before).map((e) => e.type)} ${satelliteLog()}`);
  reply('Ci sono.', 0.2, peer);
  await stream.wait({ type: 'sentence', text: 'Ci sono.' }, { from });
  await peer.heard('played', { from: before });
  await idle(from, stream);
}

for (const [name, reach] of Object.entries(stages))
  test(`the assistant, the satellite and the daemon are killed and start again while it is ${name}`, async () => {
    const ear = await freePort(), own = String(await freePort());
    const options = ['--port', own, '--recogniser', `tcp://127.0.0.1:${ear}`];
    const all = { daemon: await Daemon.start(options) };
    const join = async () => {
      all.stream = await all.daemon.stream('?lang=it&room=kitchen');
      await all.stream.wait({ type: 'joined' });
    };
    await join();
    let satellite = await start(ear, all.daemon.url);
    satelliteLog = () => satellite.text;
    all.peer = await assist(ear);
    await works(all);
    // the assistant
    await reach(all);
    const from = all.stream.messages.length;
    all.peer.kill();
    await eventually(() => satellite.text.includes('the assistant is gone'), 'the end of the assistant');
    if (name !== 'idle') await idle(from, all.stream);
    all.stream.send({ type: 'stop' });
    await all.stream.close();
    await join();
    all.peer = await assist(ear);
    await works(all);
    // the satellite
    await reach(all);
    satellite.kill('SIGKILL');
    await satellite.exited;
    await all.peer.closed();
    all.stream.send({ type: 'stop' });
    satellite = await start(ear, all.daemon.url);
    all.peer = await assist(ear);
    await all.stream.close();
    await join();
    await works(all);
    // the daemon
    await reach(all);
    all.daemon.process.kill('SIGKILL');
    await all.daemon.exited;
    await eventually(() => satellite.text.includes('the daemon is unreachable'), 'the loss of the daemon');
    const times = satellite.text.split('connected to the daemon').length;
    all.peer.send('ping', {});
    await all.peer.heard('pong');
    all.daemon = await Daemon.start(options);
    await eventually(() => satellite.text.split('connected to the daemon').length > times, 'the daemon again');
    await join();
    await works(all);
    await all.stream.close();
    assert.equal(await stop(satellite), 0, satellite.text);
    assert.deepEqual(await all.daemon.stop(), { code: 0, signal: null });
  });

test('with a wake word service, only what follows the wake word is sent', async () => {
  const wakes = { answer: null }; // what the service answers: called at each event of an utterance
  const service = await serve((event, peer) => wakes.answer?.(event, peer));
  const ear = await freePort();
  const home = await Daemon.start(['--recogniser', `tcp://127.0.0.1:${ear}`]);
  const stream = await home.stream('?lang=it&room=kitchen');
  await stream.wait({ type: 'joined' });
  const satellite = await start(ear, home.url, '--wake', `tcp://127.0.0.1:${service.port}`, '--wake-word', 'ok_faccia');
  const peer = await assist(ear);
  assert.deepEqual((await peer.heard('info')).data.satellite.active_wake_words, ['ok_faccia']);
  // nothing for the assistant
  wakes.answer = ({ type }, one) => type === 'audio-stop' && one.send('not-detected');
  let id = speak(1, stream);
  assert.equal((await stream.wait({ type: 'heard', id, final: true })).text, '');
  assert.deepEqual(service.peers[0].events[0].data, { names: ['ok_faccia'] });
  assert.ok(!peer.events.some((e) => e.type === 'run-pipeline'));
  // a wake word and a request in one breath: 0.4 s are the wake word's
  wakes.answer = ({ type, data }, one) => type === 'audio-chunk' && data.timestamp >= 400 && !one.told && (one.told = one.send('detection', { name: 'ok_faccia', timestamp: 400, speaker: null }));
  let before = peer.events.length;
  speak(2, stream);
  await peer.heard('audio-stop', { from: before });
  const order = peer.events.slice(before).map((e) => e.type).filter((type, i, all) => type !== all[i - 1]);
  assert.deepEqual(order, ['detection', 'run-pipeline', 'audio-chunk', 'audio-stop']);
  assert.equal((await peer.heard('detection')).data.name, 'ok_faccia');
  const sound = Buffer.concat(peer.events.slice(before).filter((e) => e.type === 'audio-chunk').map((e) => e.payload));
  assert.ok(sound.equals(tone(2).subarray(2 * 6400)), `${sound.length} bytes`);
  recognise('Accendi la luce.', peer);
  await stream.wait({ type: 'heard', text: 'Accendi la luce.', final: true });
  peer.send('error', { text: '', code: 'duplicate_wake_up_detected' });
  // the wake word alone: the next utterance needs none
  wakes.answer = ({ type }, one) => type === 'audio-stop' && one.send('detection', { name: 'ok_faccia', timestamp: 700 });
  before = peer.events.length;
  const from = stream.messages.length;
  id = speak(0.8, stream);
  assert.equal((await stream.wait({ type: 'heard', id, final: true })).text, '');
  await peer.heard('detection', { from: before });
  await eventually(() => states(from, stream).at(-1) === 'listening', 'it listens on');
  const asked = service.peers.length;
  speak(0.5, stream);
  await peer.heard('audio-stop', { from: before });
  assert.equal(service.peers.length, asked);
  recognise('Che ore sono?', peer);
  await stream.wait({ type: 'heard', text: 'Che ore sono?', final: true }, { from });
  peer.send('error', { text: '', code: 'duplicate_wake_up_detected' });
  // a service that ends, or is not there
  wakes.answer = (_, one) => one.socket.destroy();
  id = speak(0.5, stream);
  assert.match((await stream.wait({ type: 'error', code: 'recogniser-failed', id })).message, /the wake service/);
  await service.close();
  id = speak(0.5, stream);
  assert.match((await stream.wait({ type: 'error', code: 'recogniser-failed', id })).message, /the wake service/);
  await stream.close();
  assert.equal(await stop(satellite), 0, satellite.text);
  assert.deepEqual(await home.stop(), { code: 0, signal: null });
  peer.socket.destroy();
});

test('each room has its satellite: one hands on what is said in other rooms', async () => {
  const [first, second] = [await freePort(), await freePort()];
  const home = await Daemon.start(['--recogniser', `tcp://127.0.0.1:${first}`]);
  const hall = await home.stream('?lang=it&room=hall');
  await hall.wait({ type: 'joined' });
  const one = await start(first, home.url, '--others', `127.0.0.1:${second}`), two = await start(second, home.url, '--room', 'hall');
  const [kitchen, peer] = [await assist(first), await assist(second)];
  speak(0.5, hall);
  await peer.heard('audio-stop');
  recognise('Dalla sala.', peer);
  await hall.wait({ type: 'heard', text: 'Dalla sala.', final: true });
  reply('Detto in sala.', 0.2, peer);
  await hall.wait({ type: 'sentence', text: 'Detto in sala.' });
  assert.ok(!kitchen.events.some((e) => e.type === 'run-pipeline'));
  two.kill('SIGKILL');
  await two.exited;
  const id = speak(0.5, hall);
  assert.match((await hall.wait({ type: 'error', code: 'recogniser-failed', id })).message, /of other rooms/);
  await hall.close();
  assert.equal(await stop(one), 0, one.text);
  assert.deepEqual(await home.stop(), { code: 0, signal: null });
  for (const { socket } of [kitchen, peer]) socket.destroy();
});

test('with --speak sound, the face moves to the assistant’s own voice', async () => {
  const ear = await freePort();
  const home = await Daemon.start(['--recogniser', `tcp://127.0.0.1:${ear}`]);
  const stream = await home.stream('?lang=it&room=kitchen');
  await stream.wait({ type: 'joined' });
  const satellite = await start(ear, home.url, '--speak', 'sound');
  const peer = await assist(ear);
  speak(0.5, stream);
  await peer.heard('audio-stop');
  recognise('Chi sei?', peer);
  reply('Non detto dalla faccia.', 1, peer);
  assert.equal((await stream.wait({ type: 'begin' })).captions, false);
  await stream.wait({ type: 'end', reason: 'done' });
  await peer.heard('played');
  assert.ok(!stream.messages.some((m) => m.type === 'sentence'));
  await stream.close();
  assert.equal(await stop(satellite), 0, satellite.text);
  assert.deepEqual(await home.stop(), { code: 0, signal: null });
  peer.socket.destroy();
});

test('wrong bytes end a connection, and nobody else’s', async () => {
  for (const bytes of ['x\n', '{"type":7}\n', '{"type":"a","data_length":-1}\n', '{"type":"a","data_length":3}\n[1]', '['.repeat(70000)]) {
    const bad = await connect(port);
    bad.socket.write(bytes);
    await bad.closed();
  }
  const odd = await connect(port); // not an assistant, nor a recogniser
  for (const type of ['audio-chunk', 'audio-stop', 'transcript', 'synthesize', 'played', 'timer-started', 'timer-', 'run-pipeline', 'pause-satellite']) odd.send(type, {});
  odd.send('ping', {});
  await odd.heard('pong');
  odd.send('transcribe', { language: 'it' });
  odd.send('audio-chunk', { rate: 8000, width: 2, channels: 1 }, tone(0.1));
  await odd.heard('error');
  odd.socket.destroy();
  for (const [type, data] of [['timer-started', {}], ['timer-finished', {}], ['synthesize', { text: ' ' }], ['audio-start', { rate: 1, width: 9, channels: 0 }], ['audio-chunk', {}], ['audio-stop', {}], ['run-pipeline', { start_stage: 'wake' }], ['error', {}]])
    assistant.send(type, data);
  const from = kiosk.messages.length, before = assistant.events.length;
  speak(0.5);
  await assistant.heard('audio-stop', { from: before });
  recognise('Ancora qui.');
  await kiosk.wait({ type: 'heard', text: 'Ancora qui.', final: true }, { from });
});

test('reports wrong options', async () => {
  const run = async (...options) => {
    const child = spawn(program, options, { stdio: 'ignore' });
    return (await once(child, 'exit'))[0];
  };
  for (const options of [['--listen', 'x'], ['--speak', 'loud'], ['--wake', 'nowhere'], ['--wake-word', 'x'], ['--nothing'], ['x'], ['--url', 'kitchen']]) assert.equal(await run(...options), 2, String(options));
  assert.equal(await run('--help'), 0);
  assert.equal(await run('--listen', String(port), '--url', daemon.url), 1, 'the port is taken');
});
