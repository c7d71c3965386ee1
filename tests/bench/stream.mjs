// SPDX-License-Identifier: GPL-3.0-or-later
// Size of the stream, and errors of the lips by coding: five minutes of Italian with expressions and life as .fapc, ASCII .fap, gzipped
// .fap, and JSON of 52 blend shapes at 60 fps, which takes a few seconds; and its beginning streamed live (Opus and FAPC) with default
// options, with packed events like the page, and with 12 kbit/s Opus in addition, in real time.
// Usage: node tests/bench/run.mjs stream [SECONDS [LIVE]]
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import zlib from 'node:zlib';
import WebSocket from 'ws';
import { isCompact } from '../../protocol/chunk/compact.mjs';
import { build, Daemon, root } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { quantile } from './figures.mjs';
import { prose } from './text.mjs';

const seconds = Number(process.argv[2] ?? 300);
const live = Number(process.argv[3] ?? Math.min(seconds, 60));
const feelings = ['joy', 'sadness', 'surprise', 'hope', 'anger', 'gratitude', 'fear', 'satisfaction'];
const felt = (length) => `<emotionml version="1.0" xmlns="http://www.w3.org/2009/10/emotionml" category-set="http://www.w3.org/TR/emotion-voc/xml#occ-categories">${
  prose(length).match(/[^.]+\./g).map((s, i) => `<emotion><category name="${feelings[i % 8]}" value="0.7"/>${s.trim()}</emotion>`).join('\n')}</emotionml>`;
const text = felt(seconds);

const daemon = await Daemon.start([], { FACCIA_MAX_TEXT: '10000000' });
const ask = (format, fps = 25) => fetch(`${daemon.url}/v1/speech?lang=it&format=${format}&fps=${fps}`, {
  method: 'POST', body: text, headers: { 'content-type': 'application/emotionml+xml' },
});

/** Size of a server frame's header (RFC 6455, 5.2). */
const framing = (size) => (size < 126 ? 2 : size < 65536 ? 4 : 10);

/** Streams with these options. Returns received bytes and duration. */
async function hear(query) {
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream?lang=it${query}`, { perMessageDeflate: false });
  const sum = { chunks: 0, audio: 0, fap: 0, heads: 0, framing: 0, texts: 0, duration: 0 };
  await new Promise((resolve, reject) => {
    socket.on('error', reject).on('open', () => socket.send(JSON.stringify({ type: 'speak', markup: 'emotionml', text: felt(live) })));
    let begun = false;
    socket.on('message', (data, binary) => {
      if (!begun && !binary) begun = JSON.parse(data).type === 'begin'; // excludes hello with the list of heads and voices, which is sent once
      if (!begun) return;
      sum.framing += framing(data.length);
      if (!binary) {
        const message = JSON.parse(data);
        sum.texts += data.length;
        if (message.type === 'error') reject(new Error(String(data)));
        if (message.type !== 'end') return;
        sum.duration = message.duration;
        resolve();
        return;
      }
      sum.chunks++;
      const parts = partsOf(data);
      sum.audio += parts.audio;
      sum.fap += parts.fap;
      sum.texts += parts.events;
      sum.heads += data.length - parts.audio - parts.fap - parts.events;
    });
  });
  socket.close();
  return sum;
}

/** Bytes of sound and face in a compact chunk (protocol/README.md, "Compact chunks"). */
function partsOf(data) {
  if (!isCompact(data)) throw new Error('not a compact chunk');
  let at = 1;
  const number = () => {
    let [value, scale] = [0, 1];
    for (; data[at] >= 128; scale *= 128) value += (data[at++] & 127) * scale;
    return value + data[at++] * scale;
  };
  const opus = ((data[0] >> 4) & 3) === 2;
  if (data[0] & 0x40) for (let i = opus ? 6 : 5; i; i--) number();
  if (data[0] & 2) number();
  number();
  const audio = number();
  const events = data[0] & 1 ? number() : 0;
  return { audio, events, fap: data.length - at - audio - events };
}

// the 52 shapes of phone face trackers, each driven by the most similar FAP
const shapes = { browDownLeft: 31, browDownRight: 32, browInnerUp: 31, browOuterUpLeft: 35, browOuterUpRight: 36, cheekPuff: 39,
  cheekSquintLeft: 41, cheekSquintRight: 42, eyeBlinkLeft: 19, eyeBlinkRight: 20, eyeLookDownLeft: 25, eyeLookDownRight: 26,
  eyeLookInLeft: 23, eyeLookInRight: 24, eyeLookOutLeft: 23, eyeLookOutRight: 24, eyeLookUpLeft: 25, eyeLookUpRight: 26,
  eyeSquintLeft: 21, eyeSquintRight: 22, eyeWideLeft: 19, eyeWideRight: 20, jawForward: 14, jawLeft: 15, jawOpen: 3, jawRight: 15,
  mouthClose: 5, mouthDimpleLeft: 53, mouthDimpleRight: 54, mouthFrownLeft: 12, mouthFrownRight: 13, mouthFunnel: 16,
  mouthLeft: 6, mouthLowerDownLeft: 10, mouthLowerDownRight: 11, mouthPressLeft: 8, mouthPressRight: 9, mouthPucker: 17,
  mouthRight: 7, mouthRollLower: 16, mouthRollUpper: 17, mouthShrugLower: 18, mouthShrugUpper: 4, mouthSmileLeft: 59,
  mouthSmileRight: 60, mouthStretchLeft: 6, mouthStretchRight: 7, mouthUpperUpLeft: 8, mouthUpperUpRight: 9, noseSneerLeft: 61,
  noseSneerRight: 62, tongueOut: 45 };
const { faps } = JSON.parse(fs.readFileSync(path.join(root, 'protocol/fap-table.json'), 'utf8'));
const weight = (values, n) => Math.round(Math.min(1, Math.abs(values[n]) / (faps[n - 1].max / 4)) * 1000) / 1000;
const shapesJson = (frames) => frames.reduce((sum, values, k) => sum + JSON.stringify({
  time: Math.round((k / 60) * 1000) / 1000, blendshapes: Object.fromEntries(Object.entries(shapes).map(([name, n]) => [name, weight(values, n)])),
}).length, 0);

const ways = ['', '&events=packed', '&events=packed&kilobits=12'];
const hearing = Promise.all(ways.map(hear));
hearing.catch(() => {}); // its failure is thrown where it is awaited
const ascii = await (await ask('fap')).text();
const at60 = parseFap(await (await ask('fap', 60)).text());
const file = await (await ask('fapc')).arrayBuffer();
const original = parseFap(ascii);
const duration = original.frames.length / original.fps;
const rate = (bytes) => (bytes * 8) / 1000 / duration;

/** Errors of all lip points over all frames, mm. */
function lipErrors(decoded) {
  const units = JSON.parse(fs.readFileSync(path.join(build, 'models/heads/mara.json'), 'utf8')).fapu;
  const points = new Map();
  for (const f of faps)
    if (/^(2\.[2-9]|8\.\d+)$/.test(f.fdp)) points.set(f.fdp, [...(points.get(f.fdp) ?? []), { n: f.number, mm: units[f.unit] / 1024 }]);
  return decoded.frames.flatMap((values, k) => [...points.values()].map((axes) =>
    Math.hypot(...axes.map(({ n, mm }) => (values[n] - original.frames[k][n]) * mm))));
}
const faccia = (args, input) => spawnSync(path.join(build, 'server/cli/faccia'), ['fap', ...args, '-'], { input, maxBuffer: 1 << 28 }).stdout;
const lossless = faccia(['encode', '--quality', '0'], ascii);
// from the same frames, because repeated speech differs slightly
const errors = lipErrors(parseFap(String(faccia(['decode'], faccia(['encode'], ascii)))));
const exact = lipErrors(parseFap(String(faccia(['decode'], lossless))));
const mean = errors.reduce((a, b) => a + b, 0) / errors.length;

const table = (rows) => rows.forEach(([name, value, against]) =>
  console.log(`${name.padEnd(58)}${value.toFixed(2).padStart(10)} kbit/s${against ? `${(value / against).toFixed(1).padStart(9)} x` : ''}`));
const coded = rate(file.byteLength);
console.log(`${duration.toFixed(0)} s of speech, 25 frames a second; x: times the .fapc file\n`);
table([
  ['.fapc file', coded],
  ['.fapc file, lossless', rate(lossless.length), coded],
  ['ASCII .fap', rate(ascii.length), coded],
  ['ASCII .fap, gzip -9', rate(zlib.gzipSync(ascii, { level: 9 }).length), coded],
  ['JSON of 52 blend shapes, 60 a second', rate(shapesJson(at60.frames)), coded],
]);
console.log(`lips of the default head: off by ${mean.toFixed(3)} mm on average, ${quantile(errors, 0.99).toFixed(3)} in 99 %, ${quantile(errors, 1).toFixed(3)} at most; lossless ${quantile(exact, 1).toFixed(3)}\n`);

const all = await hearing;
await daemon.stop();
all.forEach((heard, i) => {
  const part = (bytes) => (bytes * 8) / 1000 / heard.duration;
  console.log(`live, ${ways[i] || 'no wishes'}, ${heard.duration.toFixed(0)} s, ${heard.chunks} chunks\n`);
  table([
    ['FAPs', part(heard.fap)],
    ['sound (Opus)', part(heard.audio)],
    ['heads of the chunks', part(heard.heads)],
    ['WebSocket framing', part(heard.framing)],
    ['FAPs, sound, heads and framing', part(heard.fap + heard.audio + heard.heads + heard.framing)],
    ['events (sentences, words)', part(heard.texts)],
    ['all', part(heard.fap + heard.audio + heard.heads + heard.framing + heard.texts)],
  ]);
  console.log();
});
