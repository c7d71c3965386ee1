// SPDX-License-Identifier: GPL-3.0-or-later
// faccia-mqtt between a real broker (mosquitto) and the daemon.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const running = new Set();
let daemon, kiosk, broker, port, safePort, bridge, heard;

function start(program, options, env = {}) {
  const child = spawn(program, options, { env: { ...process.env, ...env } });
  child.text = '';
  for (const out of [child.stdout, child.stderr]) out.setEncoding('utf8').on('data', (text) => (child.text += text));
  child.exited = once(child, 'exit').then(([code]) => (running.delete(child), code));
  running.add(child);
  return child;
}
const stop = (child) => (child.kill('SIGTERM'), child.exited);

/** Makes a private authority, a broker certificate signed by it, an unrelated authority, and a user. */
function certify() {
  const run = (program, ...options) => {
    const { status, stderr } = spawnSync(program, options, { cwd: folder });
    assert.equal(status, 0, `${program} ${options.join(' ')}: ${stderr}`);
  };
  for (const name of ['ca', 'other']) run('openssl', 'req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-days', '2', '-subj', `/CN=${name}`, '-keyout', `${name}.key`, '-out', `${name}.crt`);
  run('openssl', 'req', '-newkey', 'rsa:2048', '-nodes', '-subj', '/CN=127.0.0.1', '-keyout', 'broker.key', '-out', 'broker.csr');
  fs.writeFileSync(path.join(folder, 'names'), 'subjectAltName=IP:127.0.0.1\n');
  run('openssl', 'x509', '-req', '-in', 'broker.csr', '-CA', 'ca.crt', '-CAkey', 'ca.key', '-CAcreateserial', '-days', '2', '-extfile', 'names', '-out', 'broker.crt');
  run('mosquitto_passwd', '-b', '-c', 'passwords', 'casa', 'una parola segreta');
}

const freePort = () => new Promise((resolve) => {
  const server = net.createServer().listen(0, '127.0.0.1', () => {
    const { port: free } = server.address();
    server.close(() => resolve(free));
  });
});
const startBroker = async () => {
  broker = start('/usr/sbin/mosquitto', ['-c', path.join(folder, 'mosquitto.conf')]);
  await eventually(() => broker.text.includes('running') || broker.text.includes('Opening ipv4'), 'the broker');
};
/** Records everything published, one line each: topic, retained flag, payload. */
const listen = async () => {
  heard = start('mosquitto_sub', ['-p', String(port), '-q', '1', '-t', '#', '-F', '%t %r %p']);
  await publish('test', 'listening', ['-r']); // retained: the subscriber gets it even if it starts later
  await saidOn('test');
};
const lines = () => heard.text.split('\n').slice(0, -1) // the last line may be incomplete
  .map((line) => {
  const [topic, retained, ...payload] = line.split(' ');
  return { topic, retained: retained === '1', payload: payload.join(' ') };
});
const saidOn = (topic, payload = () => true, from = 0) =>
  eventually(() => lines().slice(from).find((line) => line.topic === topic && (typeof payload === 'string' ? payload === line.payload : payload(line.payload))), `${topic} ${payload}`);
const publish = (topic, payload, options = []) => start('mosquitto_pub', ['-p', String(port), '-q', '1', '-t', topic, '-m', typeof payload === 'string' ? payload : JSON.stringify(payload), ...options]).exited;

before(async () => {
  daemon = await Daemon.start(['--recogniser', 'cat >/dev/null; echo abbastanza bene']);
  port = await freePort();
  safePort = await freePort();
  certify();
  const at = (name) => path.join(folder, name);
  fs.writeFileSync(at('mosquitto.conf'), `per_listener_settings true\nlistener ${port} 127.0.0.1\nallow_anonymous true\n` +
    `listener ${safePort} 127.0.0.1\nallow_anonymous false\npassword_file ${at('passwords')}\ncafile ${at('ca.crt')}\ncertfile ${at('broker.crt')}\nkeyfile ${at('broker.key')}\n` +
    'persistence false\nlog_dest stderr\nuser root\n');
  await startBroker();
  kiosk = await daemon.stream('?lang=it&room=kitchen');
  await kiosk.wait({ type: 'joined' });
  bridge = start(path.join(build, 'server/bridges/faccia-mqtt'), ['--room', 'kitchen', '--room', 'hall', '--room', 'floor.1', '--broker', `127.0.0.1:${port}`, '--url', daemon.url]);
  await listen();
  await saidOn('homeassistant/device/faccia_kitchen/config');
  await saidOn('faccia/kitchen/now/available', 'online');
});
after(async () => {
  await kiosk.close();
  assert.equal(await stop(bridge), 0, bridge.text);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  await Promise.all([...running].map(stop));
  fs.rmSync(folder, { recursive: true });
});

test('speaks a published text, and publishes its words and end', async () => {
  await publish('faccia/kitchen/say', 'La cena è pronta.');
  await kiosk.wait({ type: 'sentence', text: 'La cena è pronta.' });
  await saidOn('faccia/kitchen/now/state', 'speaking');
  await saidOn('faccia/kitchen/now/words', 'La cena è pronta.');
  await saidOn('faccia/kitchen/said', (p) => JSON.parse(p).reason === 'done');
  await publish('faccia/kitchen/say', { id: 'a', text: 'Buon appetito.', lang: 'it', priority: 'alarm' });
  await kiosk.wait({ type: 'begin', id: 'a', lang: 'it' });
  await saidOn('faccia/kitchen/said', '{"id":"a","reason":"done"}');
});

test('speaks nothing twice: repeated ids, retained messages', async () => {
  await publish('faccia/kitchen/say', { id: 'once', text: 'Una volta.', lang: 'it' });
  await publish('faccia/kitchen/say', { id: 'once', text: 'Una volta.', lang: 'it' });
  await publish('faccia/kitchen/say', { id: 'next', text: 'Poi.', lang: 'it' });
  await saidOn('faccia/kitchen/said', '{"id":"next","reason":"done"}');
  assert.equal(kiosk.messages.filter((m) => m.type === 'begin' && m.id === 'once').length, 1);
  assert.equal(lines().filter((l) => l.topic === 'faccia/kitchen/said' && l.payload.includes('"once"')).length, 1);
});

test('reports an empty room, an unknown voice and a muted room', async () => {
  await publish('faccia/hall/say', { id: 'h', text: 'C’è nessuno?', lang: 'it' });
  await saidOn('faccia/hall/said', (p) => JSON.parse(p).reason === 'unheard');
  await publish('faccia/kitchen/say', { id: 'v', text: 'Ciao.', voice: 'nobody:x' });
  const { message } = JSON.parse((await saidOn('faccia/kitchen/said', (p) => JSON.parse(p).id === 'v' && JSON.parse(p).reason === 'failed')).payload);
  assert.match(message, /nobody:x/);
  await publish('faccia/kitchen/mute', 'ON');
  await saidOn('faccia/kitchen/now/state', 'muted');
  await publish('faccia/kitchen/say', { id: 'm', text: 'Ciao.', lang: 'it' });
  await saidOn('faccia/kitchen/said', '{"id":"m","reason":"muted"}');
  await publish('faccia/kitchen/mute', 'OFF');
  await saidOn('faccia/kitchen/now/mute', 'OFF', lines().findLastIndex((l) => l.payload === 'ON'));
});

test('presence puts the face to sleep and wakes it', async () => {
  await publish('faccia/kitchen/presence', 'OFF');
  await kiosk.wait({ type: 'state', state: 'asleep' });
  await saidOn('faccia/kitchen/now/presence', 'OFF');
  await saidOn('faccia/kitchen/now/state', 'asleep');
  const later = await daemon.stream('?room=kitchen');
  await later.wait({ type: 'state', state: 'asleep' });
  await later.close();
  const from = kiosk.messages.length;
  await publish('faccia/kitchen/presence', 'home');
  await kiosk.wait({ type: 'state', state: 'idle' }, { from });
  await saidOn('faccia/kitchen/now/presence', 'ON', lines().findLastIndex((l) => l.topic.endsWith('now/presence') && l.payload === 'OFF'));
});

test('publishes states, moods, choices and the selected answer', async () => {
  await publish('faccia/kitchen/state', 'listening');
  await kiosk.wait({ type: 'state', state: 'listening' });
  await saidOn('faccia/kitchen/now/state', 'listening');
  await publish('faccia/kitchen/express', 'joy 0.7 surprise');
  await saidOn('faccia/kitchen/now/mood', 'joy 0.7 surprise');
  await eventually(() => kiosk.messages.filter((m) => m.type === 'state' && m.state === 'listening').length === 2, 'the state again, with its mood');
  await publish('faccia/kitchen/choices', { id: 'q', question: 'Ha preso la medicina?', choices: ['Sì', 'Non ancora'] });
  await kiosk.wait({ type: 'choices', id: 'q' });
  kiosk.send({ type: 'choose', id: 'q', choice: 1 });
  const chosen = JSON.parse((await saidOn('faccia/kitchen/chosen')).payload);
  assert.deepEqual([chosen.event_type, chosen.choice, chosen.text], ['chosen', 1, 'Non ancora']);
});

test('asks a question, and publishes its answer and what is heard', async () => {
  await publish('faccia/kitchen/ask', { id: 'pill', lang: 'it', text: 'Come sta?', seconds: 60 });
  await kiosk.wait({ type: 'asked', id: 'pill' });
  kiosk.send({ type: 'hear', id: 'h', rate: 16000 });
  kiosk.send({ type: 'close', id: 'h' });
  const answered = JSON.parse((await saidOn('faccia/kitchen/answered')).payload);
  assert.deepEqual([answered.event_type, answered.id, answered.reason, answered.text], ['answered', 'pill', 'heard', 'abbastanza bene']);
  const heard = JSON.parse((await saidOn('faccia/kitchen/heard')).payload);
  assert.deepEqual([heard.event_type, heard.id, heard.text, heard.final], ['heard', 'h', 'abbastanza bene', true]);
});

test('Home Assistant discovers a device with all functions of the room, also after its restart', async () => {
  const from = lines().length;
  await publish('homeassistant/status', 'online');
  const { payload } = await saidOn('homeassistant/device/faccia_kitchen/config', undefined, from);
  const config = JSON.parse(payload);
  assert.deepEqual(Object.fromEntries(Object.entries(config.cmps).map(([key, c]) => [key, c.p])), {
    say: 'notify', text: 'text', voice: 'select', head: 'select', mood: 'select', mute: 'switch', presence: 'switch', stop: 'button', state: 'sensor', words: 'sensor', choice: 'event', heard: 'event', answer: 'event' });
  assert.equal(new Set(Object.values(config.cmps).map((c) => c.unique_id)).size, 13);
  assert.ok(config.cmps.voice.options.includes('espeak:it') && config.cmps.mood.options.includes('joy'));
  for (const { topic } of config.availability) assert.ok(await saidOn(topic, 'online'), topic);
  // commands as Home Assistant sends them
  await publish(config.cmps.voice.command_topic, 'espeak:it');
  await saidOn(config.cmps.voice.state_topic, 'espeak:it');
  await publish(config.cmps.say.command_topic, 'Detto da casa.');
  await kiosk.wait({ type: 'sentence', text: 'Detto da casa.' });
});

test('refuses an unknown voice, and continues speaking', async () => {
  const from = lines().length;
  await publish('faccia/kitchen/voice', 'nobody:x');
  const { payload } = await saidOn('faccia/kitchen/refused', undefined, from);
  assert.deepEqual(JSON.parse(payload), { command: 'voice', message: 'unknown voice "nobody:x"' });
  assert.equal((await saidOn('faccia/kitchen/now/voice', undefined, from)).payload, 'espeak:it', 'what shows the choice shows the old one');
  await publish('faccia/kitchen/say', { id: 'voiced', text: 'Parlo ancora.' });
  await saidOn('faccia/kitchen/said', '{"id":"voiced","reason":"done"}');
});

test('a voice can be taken back: "default" is one of the options', async () => {
  const { cmps } = JSON.parse((await saidOn('homeassistant/device/faccia_kitchen/config')).payload);
  assert.equal(cmps.voice.options[0], 'default');
  assert.equal(cmps.voice.value_template, "{{ value or 'default' }}");
  const from = lines().length;
  await publish(cmps.voice.command_topic, 'default');
  await saidOn(cmps.voice.state_topic, '', from);
  await publish('faccia/kitchen/say', { id: 'own', text: 'Con la mia voce.', lang: 'it' });
  await saidOn('faccia/kitchen/said', '{"id":"own","reason":"done"}');
});

test('chooses a head for the screens of the room', async () => {
  const { cmps } = JSON.parse((await saidOn('homeassistant/device/faccia_kitchen/config')).payload);
  assert.ok(cmps.head.options[0] === 'default' && cmps.head.options.includes('mara'));
  const from = lines().length;
  await publish(cmps.head.command_topic, 'mara');
  await kiosk.wait({ type: 'head', head: 'mara' });
  await saidOn(cmps.head.state_topic, 'mara', from);
  const later = await daemon.stream('?room=kitchen');
  await later.wait({ type: 'head', head: 'mara' });
  await later.close();
  await publish(cmps.head.command_topic, 'nobody');
  assert.match(JSON.parse((await saidOn('faccia/kitchen/refused', undefined, from)).payload).message, /nobody/);
  const next = lines().length;
  await publish(cmps.head.command_topic, 'default');
  await saidOn(cmps.head.state_topic, '', next);
});

test('a room with a dot in its name is announced under an id that Home Assistant accepts', async () => {
  const { topic, payload } = await saidOn('homeassistant/device/faccia_floor_2E1/config');
  assert.match(topic, /^homeassistant\/\w+\/(?:[a-zA-Z0-9_-]+\/)?[a-zA-Z0-9_-]+\/config$/); // the pattern of its discovery
  const { cmps } = JSON.parse(payload);
  const screen = await daemon.stream('?lang=it&room=floor.1');
  await screen.wait({ type: 'joined' });
  await publish(cmps.say.command_topic, 'Primo piano.');
  await screen.wait({ type: 'sentence', text: 'Primo piano.' });
  await screen.close();
});

test('publishes exactly one said for every say, whatever it contains', async () => {
  for (const [payload, message] of [['{{ states("sensor.x") }}', /JSON/], ['{"text":', /JSON/], [{ text: 7 }, /string/], [' ', /./], ['{}', /./]]) {
    const from = lines().length;
    await publish('faccia/kitchen/say', payload);
    const said = JSON.parse((await saidOn('faccia/kitchen/said', undefined, from)).payload);
    assert.equal(said.reason, 'failed');
    assert.match(said.message, message);
    assert.ok(said.id.startsWith('mqtt-'));
  }
  for (const [name, bytes, message] of [['nul', 'a\0b', /NUL/], ['latin', Buffer.from([0x63, 0x69, 0xe0]), /UTF-8/], ['long', 'a '.repeat((1 << 19) + 1), /1 MiB/]]) {
    const file = path.join(folder, name), from = lines().length;
    fs.writeFileSync(file, bytes);
    await start('mosquitto_pub', ['-p', String(port), '-q', '1', '-t', 'faccia/kitchen/say', '-f', file]).exited;
    assert.match(JSON.parse((await saidOn('faccia/kitchen/said', undefined, from)).payload).message, message);
  }
});

test('rejects an invalid text with its reason', async () => {
  for (const [command, payload] of [['express', '[{"name":'], ['express', 'nonsense'], ['state', 'dancing'], ['choices', '{}'], ['choices', '{{ x }}'], ['presence', 'perhaps']]) {
    const from = lines().length;
    await publish(`faccia/kitchen/${command}`, payload);
    const refused = JSON.parse((await saidOn('faccia/kitchen/refused', undefined, from)).payload);
    assert.equal(refused.command, command);
    assert.ok(refused.message.length > 5, `${command} ${payload}: ${refused.message}`);
  }
  await publish('faccia/kitchen/express', 'joy 0.5');
  await saidOn('faccia/kitchen/now/mood', 'joy 0.5');
  assert.ok(!lines().some((l) => l.topic === 'faccia/kitchen/now/mood' && l.payload.includes('nonsense')), 'a mood that was not taken is not shown');
});

test('Home Assistant’s text: limits its state to 255 characters, and speaks a longer text', async () => {
  const { cmps } = JSON.parse((await saidOn('homeassistant/device/faccia_kitchen/config')).payload);
  assert.deepEqual([cmps.text.min, cmps.text.max, cmps.text.value_template, cmps.words.value_template], [0, 255, '{{ value[:255] }}', '{{ value[:255] }}']);
  for (const part of [cmps.voice, cmps.mood]) assert.ok(part.value_template, 'a state that is one of the options, or None');
  const text = `Comincia ${'una frase che non finisce mai e '.repeat(12)}poi finisce.`;
  assert.ok(text.length > 300);
  await publish(cmps.say.command_topic, text);
  await kiosk.wait({ type: 'word', text: 'Comincia' });
  await publish('faccia/kitchen/stop', '');
});

test('Rhasspy’s hermes: speaks in the room of its site, with a message at the end', async () => {
  await publish('hermes/tts/say', { text: 'Ciao da Hermes.', lang: 'it', id: 'r1', siteId: 'kitchen', sessionId: 's' });
  await kiosk.wait({ type: 'sentence', id: 'r1' });
  const finished = JSON.parse((await saidOn('hermes/tts/sayFinished')).payload);
  assert.deepEqual(finished, { id: 'r1', siteId: 'kitchen', sessionId: 's' });
});

test('ignores invalid messages', async () => {
  for (const [command, payload] of [['say', '{"text":'], ['say', '{"text":7}'], ['say', ' '], ['express', '[{"name":'], ['express', 'nonsense'], ['choices', '{}'], ['state', 'dancing'], ['presence', 'perhaps'], ['dance', 'x'], ['say', '{"id":["a"],"text":"Sì."}']])
    await publish(`faccia/kitchen/${command}`, payload);
  await publish('hermes/tts/say', 'x');
  await publish('faccia/kitchen/say', { id: 'still', text: 'Ci sono.', lang: 'it' });
  await saidOn('faccia/kitchen/said', '{"id":"still","reason":"done"}');
});

test('restores retained topics and speech when the broker restarts', async () => {
  await stop(broker);
  await eventually(() => bridge.text.includes('the broker has gone'), 'the loss of the broker');
  await startBroker();
  await stop(heard);
  await listen();
  await saidOn('faccia/bridge', 'online');
  await saidOn('homeassistant/device/faccia_hall/config');
  await publish('faccia/kitchen/say', { id: 'back', text: 'Rieccomi.', lang: 'it' });
  await saidOn('faccia/kitchen/said', '{"id":"back","reason":"done"}');
});

test('reports a restart of the daemon inside a word, and speaks later texts afterwards', async () => {
  const own = String(await freePort());
  const first = await Daemon.start(['--port', own]);
  const listener = await first.stream('?lang=it&room=attic');
  const second = start(path.join(build, 'server/bridges/faccia-mqtt'), ['--room', 'attic', '--client', 'second', '--base', 'two', '--discovery', 'none', '--broker', `127.0.0.1:${port}`, '--url', first.url]);
  await saidOn('two/attic/now/available', 'online');
  await publish('two/attic/say', { id: 'cut', text: 'Una frase lunga che il demone non potrà finire, perché se ne va prima della fine.', lang: 'it' });
  await listener.wait({ type: 'begin', id: 'cut' });
  first.process.kill('SIGKILL');
  await saidOn('two/attic/said', (p) => JSON.parse(p).id === 'cut' && JSON.parse(p).reason === 'failed');
  await publish('two/attic/say', { id: 'later', text: 'Eccomi.', lang: 'it' });
  const again = await Daemon.start(['--port', own, '--hold', '60']);
  const listens = await again.stream('?lang=it&room=attic');
  await listens.wait({ type: 'end', id: 'later', reason: 'done' });
  await listens.close();
  assert.equal(await stop(second), 0, second.text);
  assert.equal((await again.stop()).code, 0);
  await saidOn('two/bridge', 'offline');
});

/** Starts a bridge for its own room. */
const bridgeOf = (room, broker, options = [], env = {}) =>
  start(path.join(build, 'server/bridges/faccia-mqtt'), ['--room', room, '--client', room, '--base', room, '--discovery', 'none', '--broker', `127.0.0.1:${broker}`, '--url', daemon.url, ...options], env);

test('TLS and a password: requires both, and reports a missing one', async () => {
  const ca = (name) => ['--ca-file', path.join(folder, `${name}.crt`), '--user', 'casa'];
  const secret = { FACCIA_MQTT_PASSWORD: 'una parola segreta' };
  const safe = bridgeOf('safe', safePort, ca('ca'), secret);
  const wrong = bridgeOf('wrong', safePort, ca('ca'), { FACCIA_MQTT_PASSWORD: 'another' });
  const stranger = bridgeOf('stranger', safePort, ca('other'), secret);
  const plain = bridgeOf('plain', safePort, ['--user', 'casa'], secret);
  const told = start('mosquitto_sub', ['-h', '127.0.0.1', '-p', String(safePort), '--cafile', path.join(folder, 'ca.crt'), '-u', 'casa', '-P', 'una parola segreta', '-q', '1', '-t', '#', '-F', '%t %p']);
  await eventually(() => told.text.includes('safe/safe/now/available online'), 'the bridge on the broker');
  const listener = await daemon.stream('?lang=it&room=safe');
  await listener.wait({ type: 'joined' });
  const said = start('mosquitto_pub', ['-h', '127.0.0.1', '-p', String(safePort), '--cafile', path.join(folder, 'ca.crt'), '-u', 'casa', '-P', 'una parola segreta', '-q', '1', '-t', 'safe/safe/say', '-m', 'Detto in segreto.']);
  await listener.wait({ type: 'sentence', text: 'Detto in segreto.' });
  assert.equal(await said.exited, 0);
  for (const refused of [wrong, stranger, plain]) await eventually(() => /broker/.test(refused.text) || refused.exitCode !== null, 'what is said of the refusal');
  for (const name of ['wrong', 'stranger', 'plain']) assert.ok(!told.text.includes(`${name}/`) && !lines().some((l) => l.topic.startsWith(`${name}/`)), name);
  await listener.close();
  assert.equal(await stop(safe), 0, safe.text);
  for (const refused of [wrong, stranger, plain]) if (refused.exitCode === null) assert.equal(await stop(refused), 0, refused.text);
  await stop(told);
});

test('disconnects from a broker that sends invalid data or stops inside a frame, and retries', async () => {
  const lies = [
    Buffer.from([0xff, 0xff, 0xff, 0xff, 0xff, 0xff]), // not a packet
    Buffer.from([0x20, 0x02, 0x00]), // half of a CONNACK
    Buffer.from([0x20, 0x02, 0x00, 0x00, 0x90, 0xff, 0xff, 0xff, 0x7f]), // a CONNACK, then a frame of 256 MB
  ];
  let came = 0;
  const liar = net.createServer((socket) => {
    socket.on('error', () => {});
    const lie = lies[came++];
    if (lie) return void socket.once('data', () => socket.end(lie));
    const real = net.connect(port, '127.0.0.1').on('error', () => socket.destroy());
    socket.pipe(real).pipe(socket).on('error', () => real.destroy());
  });
  liar.unref();
  await new Promise((resolve) => liar.listen(0, '127.0.0.1', resolve));
  const patient = bridgeOf('patient', liar.address().port);
  await saidOn('patient/patient/now/available', 'online');
  assert.equal(came, lies.length + 1);
  await publish('patient/patient/say', { id: 'p', text: 'Eccomi.', lang: 'it' });
  await saidOn('patient/patient/said', (p) => JSON.parse(p).id === 'p' && JSON.parse(p).reason === 'unheard');
  assert.equal(await stop(patient), 0, patient.text);
});

test('reports wrong options', async () => {
  const run = (...options) => start(path.join(build, 'server/bridges/faccia-mqtt'), options);
  for (const options of [['--room', 'no spaces'], ['--broker', 'x:0'], ['--base', 'a/#'], ['--nothing'], ['x']]) assert.equal(await run(...options).exited, 2, String(options));
  assert.equal(await run('--url', 'kitchen').exited, 1);
  assert.equal(await run('--ca-file', '/nowhere').exited, 1);
  assert.equal(await run('--help').exited, 0);
});
