// SPDX-License-Identifier: GPL-3.0-or-later
// Every door, with its real counterpart where Debian has it: each side is killed in each state and starts again, and all works as before.
// For faccia-satellite see satellite.test.mjs.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';
import { connect } from '../../lib/wyoming-events.mjs';

const LONG = 'Una frase lunga durante la quale uno dei due se ne va, e che per questo nessuno sentirà mai fino alla fine.';
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-restarts-'));
const door = (name) => path.join(build, 'server/bridges', name);
const running = new Set();
let port, daemon, count = 0;

function start(program, options, env = {}) {
  const child = spawn(program, options, { env: { ...process.env, ...env } });
  child.text = '';
  for (const out of [child.stdout, child.stderr]) out.setEncoding('utf8').on('data', (text) => (child.text += text));
  child.stdin.on('error', () => {});
  child.exited = once(child, 'exit').then(([code]) => (running.delete(child), code));
  running.add(child);
  return child;
}
const stop = (child) => (child.kill('SIGTERM'), child.exited);
const kill = (child) => (child.kill('SIGKILL'), child.exited);
const freePort = () => new Promise((resolve) => {
  const server = net.createServer().listen(0, '127.0.0.1', () => {
    const { port: free } = server.address();
    server.close(() => resolve(free));
  });
});
const startDaemon = async () => (daemon = await Daemon.start(['--port', String(port), '--hold', '60']));
async function restartDaemon() {
  daemon.process.kill('SIGKILL');
  await daemon.exited;
  await startDaemon();
}
async function listener(room) {
  const stream = await daemon.stream(`?lang=it&room=${room}`);
  await stream.wait({ type: 'joined' });
  return stream;
}

before(async () => {
  port = await freePort();
  await startDaemon();
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  await Promise.all([...running].map(kill));
  fs.rmSync(folder, { recursive: true });
});

test('MQTT: mosquitto, faccia-mqtt and the daemon are killed while it is idle, speaking, asking and muted', async () => {
  const brokerPort = await freePort(), file = path.join(folder, 'mosquitto.conf');
  fs.writeFileSync(file, `listener ${brokerPort} 127.0.0.1\nallow_anonymous true\npersistence false\nlog_dest stderr\nuser root\n`);
  let broker, bridge, heard;
  const publish = (topic, payload) => start('mosquitto_pub', ['-p', String(brokerPort), '-q', '1', '-t', topic, '-m', typeof payload === 'string' ? payload : JSON.stringify(payload)]).exited;
  const startBroker = async () => {
    broker = start('/usr/sbin/mosquitto', ['-c', file]);
    await eventually(() => broker.text.includes('running') || broker.text.includes('Opening ipv4'), 'the broker');
  };
  /** Records what is published; retained messages first. */
  const listen = () => (heard = start('mosquitto_sub', ['-p', String(brokerPort), '-q', '1', '-t', '#', '-F', '%t %p']));
  const told = (line) => eventually(() => heard.text.split('\n').some((l) => l.startsWith(line)), `${line} in ${heard.text}`);
  const startBridge = () => (bridge = start(door('faccia-mqtt'), ['--room', 'kitchen', '--broker', `127.0.0.1:${brokerPort}`, '--url', daemon.url]));
  await startBroker();
  startBridge();
  listen();
  let stream = await listener('kitchen');
  const works = async () => {
    const id = `w${count++}`;
    await told('faccia/bridge online');
    await told('faccia/kitchen/now/available online');
    await told('homeassistant/device/faccia_kitchen/config');
    await publish('faccia/kitchen/mute', 'OFF');
    await publish('faccia/kitchen/stop', 'x');
    await publish('faccia/kitchen/say', { id, text: 'Tutto bene.', lang: 'it' });
    await told(`faccia/kitchen/said {"id":"${id}","reason":"done"}`);
    await stream.wait({ type: 'end', id, reason: 'done' });
  };
  const states = {
    idle: async () => {},
    speaking: async () => {
      const id = `s${count++}`;
      await publish('faccia/kitchen/say', { id, text: LONG, lang: 'it' });
      await stream.wait({ type: 'begin', id });
    },
    asking: async () => {
      const id = `q${count++}`;
      await publish('faccia/kitchen/ask', { id, text: 'Sì?', lang: 'it', choices: ['Sì', 'No'] });
      await stream.wait({ type: 'asked', id });
    },
    muted: async () => {
      const from = stream.messages.length;
      await publish('faccia/kitchen/mute', 'ON');
      await stream.wait({ type: 'state', state: 'muted' }, { from });
    },
  };
  await works();
  for (const reach of Object.values(states)) {
    await reach();
    await kill(broker);
    await kill(heard);
    await startBroker();
    listen();
    await works();
    await reach();
    await kill(bridge);
    await told('faccia/bridge offline');
    await kill(heard);
    startBridge();
    listen();
    await works();
    await reach();
    await stream.close();
    await restartDaemon();
    await kill(heard);
    listen();
    stream = await listener('kitchen');
    await works();
  }
  await stream.close();
  assert.equal(await stop(bridge), 0, bridge.text);
  await stop(heard);
  await stop(broker);
});

test('Wyoming: the client, faccia-wyoming and the daemon are killed while it is idle, reading and speaking', async () => {
  const own = await freePort();
  let wyoming, client;
  const startDoor = async () => {
    wyoming = start(door('faccia-wyoming'), ['--listen', String(own), '--url', daemon.url, '--room', 'study']);
    await eventually(() => wyoming.text.includes('listening on'), 'faccia-wyoming');
    client = await connect(own);
  };
  await startDoor();
  const works = async () => {
    const from = client.events.length;
    client.send('describe');
    assert.ok((await client.heard('info', { from })).data.tts[0].voices.length);
    client.send('synthesize', { text: `Tutto bene, ${count++}.`, voice: { name: 'espeak:it' } });
    await client.heard('audio-stop', { from });
    assert.ok(client.events.slice(from).some((e) => e.type === 'audio-chunk'));
  };
  const states = {
    idle: async () => {},
    reading: async () => { // a text that is being written
      const from = client.events.length;
      client.send('synthesize-start', { voice: { name: 'espeak:it' } });
      client.send('synthesize-chunk', { text: `Numero ${count++}. E poi ` });
      await client.heard('audio-chunk', { from });
    },
    speaking: async () => {
      const from = client.events.length;
      client.send('synthesize', { text: `${count++}. ${LONG.repeat(300)}`, voice: { name: 'espeak:it' } });
      await client.heard('audio-chunk', { from });
      client.socket.pause();
    },
  };
  await works();
  for (const reach of Object.values(states)) {
    await reach();
    client.kill();
    client = await connect(own);
    await works();
    await reach();
    await kill(wyoming);
    client.socket.resume();
    await client.closed();
    await startDoor();
    await works();
    await reach();
    await restartDaemon();
    client.socket.resume();
    if (reach !== states.idle) await client.closed(); // after an error, as it waits for audio-stop or the end
    client.socket.destroy();
    client = await connect(own);
    await works();
  }
  client.socket.destroy();
  assert.equal(await stop(wyoming), 0, wyoming.text);
});

test('speech-dispatcher: it, sd_faccia and the daemon are killed while idle, and while the face or the sound card speaks', async () => {
  const modules = path.join(folder, 'programs'), socket = path.join(folder, 'socket');
  fs.mkdirSync(modules);
  fs.mkdirSync(path.join(folder, 'modules'));
  fs.symlinkSync(door('sd_faccia'), path.join(modules, 'sd_faccia'));
  fs.writeFileSync(path.join(folder, 'modules/faccia.conf'), `FacciaUrl "${daemon.url}"\nFacciaRoom "desk"\n`);
  fs.writeFileSync(path.join(folder, 'speechd.conf'), `LogLevel 1\nLogDir "${folder}"\nAudioOutputMethod "alsa"\nAudioALSADevice "null"\nDefaultModule faccia\nAddModule "faccia" "sd_faccia" "faccia.conf"\n`);
  let server, screen;
  const startServer = async () => {
    fs.rmSync(socket, { force: true });
    fs.rmSync(path.join(folder, 'pid'), { force: true });
    server = start('speech-dispatcher', ['-s', '-C', folder, '-c', 'unix_socket', '-S', socket, '-m', modules, '-P', path.join(folder, 'pid'), '-L', folder, '-t', '0']);
    await eventually(() => fs.existsSync(socket), 'the server’s socket');
  };
  /** Pid of the module that the server has started. */
  const module = () => Number(fs.readFileSync(`/proc/${server.pid}/task/${server.pid}/children`, 'utf8').trim().split(' ')[0]);
  const spd = (...options) => start('spd-say', ['-o', 'faccia', '-l', 'it', ...options], { SPEECHD_ADDRESS: `unix_socket:${socket}` });
  await startServer();
  const works = async () => {
    const before = await daemon.metric('faccia_sentences_total{result="spoken"}');
    assert.equal(await spd('-w', `Tutto bene, ${count++}.`).exited, 0);
    assert.ok((await daemon.metric('faccia_sentences_total{result="spoken"}')) > before, 'silence');
  };
  const states = {
    idle: async () => {},
    sound: async () => {
      const before = await daemon.metric('faccia_sentences_asked_total');
      spd('-w', `${count++}. ${LONG}`);
      await eventually(async () => (await daemon.metric('faccia_sentences_asked_total')) > before, 'the sound');
    },
    face: async () => {
      screen = await listener('desk');
      await eventually(async () => (await (await daemon.get('/v1/rooms')).json()).rooms.some((r) => r.name === 'desk' && r.followers === 2), 'the module in the room');
      spd('-w', `${count++}. ${LONG}`);
      await screen.wait({ type: 'begin' });
    },
  };
  const leave = async () => {
    await screen?.close();
    screen = null;
  };
  await works();
  for (const reach of Object.values(states)) {
    await reach();
    await kill(server);
    await leave();
    await startServer();
    await works();
    await reach();
    await leave();
    await restartDaemon();
    await works();
    await reach();
    const old = module();
    process.kill(old, 'SIGKILL');
    await leave();
    // speech-dispatcher does not start a module again by itself; a new server does, after the old one has gone
    await stop(server);
    await startServer();
    await works();
    assert.notEqual(module(), old);
  }
  await stop(server);
});
