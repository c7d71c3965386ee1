// SPDX-License-Identifier: GPL-3.0-or-later
// A telephone: RTP through GStreamer into faccia-live, with the command of protocol/scripting.md and other ports. PCMU packets are made here, also lost, late,
// foreign and invalid ones; ffmpeg sends the other codecs.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import dgram from 'node:dgram';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { build, Daemon, eventually, framesOf } from '../../lib/daemon.mjs';
import { patient } from '../../lib/patient.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const file = (name) => path.join(folder, name);
const root = path.join(import.meta.dirname, '../../..');
const line = fs.readFileSync(path.join(root, 'protocol/scripting.md'), 'utf8').match(/^ {4}gst-launch-1\.0 [^]*? --raw 16000 -$/m)[0];
const sender = dgram.createSocket('udp4');
let daemon, kiosk, spoken;

before(async () => {
  const { status, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['say', '-l', 'es', '-v', 'espeak:es', '--wav', file('es.wav'), '--json', file('es.json'), 'Mi primo Pablo compra pan y tomates en la plaza.']);
  assert.equal(status, 0, String(stderr));
  // the padding lets the jitter buffer settle before the sentence
  assert.equal(spawnSync('sox', [file('es.wav'), file('padded.wav'), 'pad', '1.5']).status, 0);
  const samplesOf = (name) => {
    const raw = spawnSync('sox', [file(name), '-t', 'raw', '-r', '8000', '-e', 'signed', '-b', '16', '-']).stdout;
    return Array.from({ length: raw.length >> 1 }, (_, i) => raw.readInt16LE(2 * i));
  };
  spoken = { samples: samplesOf('es.wav'), padded: samplesOf('padded.wav'), phones: JSON.parse(fs.readFileSync(file('es.json'))).phones };
  daemon = await Daemon.start();
  kiosk = await daemon.stream('?room=kiosk');
  await kiosk.wait({ type: 'joined' });
});
after(async () => {
  sender.close();
  await kiosk.close();
  fs.rmSync(folder, { recursive: true });
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

async function freePort() {
  const socket = dgram.createSocket('udp4').bind(0, '127.0.0.1');
  await once(socket, 'listening');
  const { port } = socket.address();
  socket.close();
  await once(socket, 'close');
  return port;
}

/** Adapts the command to other codecs. */
const codecs = {
  PCMU: (text) => text,
  PCMA: (text) => text.replace('encoding-name=PCMU,payload=0', 'encoding-name=PCMA,payload=8').replace('rtppcmudepay ! mulawdec', 'rtppcmadepay ! alawdec'),
  L16: (text) => text.replace('clock-rate=8000,encoding-name=PCMU,payload=0', 'clock-rate=44100,encoding-name=L16,channels=1,payload=11').replace('rtppcmudepay ! mulawdec', 'rtpL16depay'),
  Opus: (text) => text.replace('clock-rate=8000,encoding-name=PCMU,payload=0', 'clock-rate=48000,encoding-name=OPUS,payload=96').replace('rtppcmudepay ! mulawdec', 'rtpopusdepay ! opusdec plc=true'),
};

/** Runs the command while `send` sends to its port. Returns what the room heard. */
async function through(codec, send) {
  const port = await freePort(), from = kiosk.messages.length;
  const text = codecs[codec](line).replace('port=5004', `address=127.0.0.1 port=${port}`).replace('faccia-live', path.join(build, 'server/bridges/faccia-live'));
  assert.ok(codec === 'PCMU' || text.includes(codec.toUpperCase()), text);
  const child = spawn('sh', ['-c', text], { detached: true, stdio: ['ignore', 'ignore', 'pipe'], env: { ...process.env, FACCIA_URL: daemon.url } });
  let said = '';
  child.stderr.setEncoding('utf8').on('data', (more) => (said += more));
  const exited = once(child, 'close');
  try {
    await eventually(() => new RegExp(`:${port.toString(16).toUpperCase().padStart(4, '0')} `).test(fs.readFileSync('/proc/net/udp', 'utf8')), `port ${port}: ${said}`);
    // the utterance begins when sound arrives
    const [begin] = await Promise.all([kiosk.wait({ type: 'begin', captions: false }, { from, milliseconds: 15000 }), send(port)]);
    await sleep(1500);
    process.kill(-child.pid, 'SIGINT');
    await exited;
    const end = await kiosk.wait({ type: 'end', id: begin.id }, { from, milliseconds: 20000 });
    assert.equal(end.reason, 'done', said);
    const chunks = kiosk.chunks.filter((c) => c.utterance === begin.utterance);
    return { rate: begin.rate, sound: chunks.flatMap((c) => [...c.audio]), frames: framesOf(kiosk.chunks, begin.utterance), said };
  } finally {
    if (child.exitCode === null && child.signalCode === null) process.kill(-child.pid, 'SIGKILL');
  }
}

const loudness = (samples, rate) => Array.from({ length: Math.floor((samples.length / rate) * 100) }, (_, i) => {
  const part = samples.slice((i * rate) / 100, ((i + 1) * rate) / 100);
  return Math.sqrt(part.reduce((sum, x) => sum + x * x, 0) / part.length);
});
const likeness = (a, b, at) => b.reduce((sum, x, i) => sum + x * (a[at + i] ?? 0), 0) / Math.sqrt(b.reduce((sum, x) => sum + x * x, 0) * b.reduce((sum, _, i) => sum + (a[at + i] ?? 0) ** 2, 1e-9));

/** Finds the sentence in the received sound: its start in s, and the correlation. */
function found({ sound, rate }) {
  const a = loudness(sound, rate), b = loudness(spoken.samples, 8000);
  const all = Array.from({ length: Math.max(1, a.length - b.length + 20) }, (_, at) => likeness(a, b, at)), best = all.indexOf(Math.max(...all));
  return { begin: best / 100, like: all[best] };
}

function check(heard, least) {
  const { begin, like } = found(heard), gap = ({ values }) => -((values[4] ?? 0) + (values[5] ?? 0));
  assert.ok(like > 0.75, `like it by ${like.toFixed(2)}`);
  const said = spoken.phones.filter(({ ipa }) => /^[pbm]/.test(ipa));
  const closed = said.filter(({ start, end }) => heard.frames.some((f) => f.time - begin > start - 0.08 && f.time - begin < end + 0.08 && gap(f) <= 0));
  assert.ok(said.length >= 8 && closed.length >= least * said.length, `${closed.length} of ${said.length} /p b m/ are closed`);
  assert.ok(heard.frames.filter((f) => gap(f) > 50).length > 5, 'and it opens');
  return `${closed.length} of ${said.length} /p b m/`;
}

/** Encodes a 16-bit sample in mu-law (ITU-T G.711). */
function mulaw(sample) {
  const sign = sample < 0 ? 0x80 : 0, size = Math.min(32635, Math.abs(sample)) + 132, segment = Math.floor(Math.log2(size)) - 7;
  return ~(sign | (segment << 4) | ((size >> (segment + 3)) & 15)) & 255;
}

function packet(payload, { sequence, time, ssrc = 1, type = 0 }) {
  const head = Buffer.alloc(12);
  head[0] = 0x80;
  head[1] = type;
  head.writeUInt16BE(sequence & 0xffff, 2);
  head.writeUInt32BE(time >>> 0, 4);
  head.writeUInt32BE(ssrc, 8);
  return Buffer.concat([head, payload]);
}

/** Sends the sentence in real time as packets of 20 ms, modified by `mangle`. */
async function telephone(port, mangle = (packets) => packets.map((p) => [p])) {
  const payloads = Array.from({ length: Math.ceil(spoken.padded.length / 160) }, (_, k) => Buffer.from(Array.from({ length: 160 }, (_, i) => mulaw(spoken.padded[160 * k + i] ?? 0))));
  const due = mangle(payloads.map((payload, k) => packet(payload, { sequence: 65500 + k, time: 0xfffffe00 + 160 * k })), payloads);
  const begin = performance.now();
  for (const [k, all] of due.entries()) {
    await sleep(Math.max(0, 20 * k - (performance.now() - begin)));
    for (const one of all) sender.send(one, port, '127.0.0.1');
  }
}

patient('PCMU at 8 kHz: it is heard and its /p b m/ are closed', async (t) => {
  const heard = await through('PCMU', (port) => telephone(port));
  t.diagnostic(check(heard, 0.7));
});

patient('packets in another order, lost ones, wrong ones, and a sender that begins anew', async (t) => {
  const heard = await through('PCMU', (port) => telephone(port, (packets, payloads) => {
    const due = packets.map((p) => [p]), half = due.length >> 1;
    for (let k = 4; k < half - 1; k += 9) [due[k], due[k + 1]] = [due[k + 1], due[k]];
    for (let k = 15; k < due.length; k += 33) due[k] = [];
    for (let k = half; k < due.length; k++) if (due[k].length) due[k] = [packet(payloads[k], { sequence: 7 + k, time: 99 + 160 * k, ssrc: 4711 })];
    for (let k = 2; k < due.length; k += 6) due[k].push(Buffer.from('this is no RTP'), Buffer.alloc(0), Buffer.from([0x80]), due[k][0]?.subarray(0, 11) ?? Buffer.alloc(3));
    return due;
  }));
  t.diagnostic(check(heard, 0.6));
});

for (const [codec, options] of [
  ['PCMA', ['-ar', '8000', '-c:a', 'pcm_alaw']],
  ['L16', ['-ar', '44100', '-c:a', 'pcm_s16be', '-payload_type', '11']],
  ['Opus', ['-ar', '48000', '-c:a', 'libopus', '-b:a', '16k', '-payload_type', '96']],
])
  patient(`${codec}, as ffmpeg sends it`, async (t) => {
    const heard = await through(codec, async (port) => {
      const ffmpeg = spawn('ffmpeg', ['-v', 'error', '-re', '-i', file('padded.wav'), '-ac', '1', ...options, '-f', 'rtp', `rtp://127.0.0.1:${port}?pkt_size=1000`], { stdio: ['ignore', 'ignore', 'pipe'] });
      let said = '';
      ffmpeg.stderr.setEncoding('utf8').on('data', (more) => (said += more));
      const [status] = await once(ffmpeg, 'close');
      assert.equal(status, 0, said);
    });
    t.diagnostic(check(heard, 0.7));
  });
