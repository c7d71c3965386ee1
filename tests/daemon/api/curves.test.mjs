// SPDX-License-Identifier: GPL-3.0-or-later
// Curves for other engines: ARKit weights and visemes. By the shapes' definitions (models/shapes/arkit.json), the weights must move lips
// and lids as the FAPs do.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import dgram from 'node:dgram';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, build, root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { sentences } from '../../lib/sentences.mjs';

const { shapes } = JSON.parse(fs.readFileSync(path.join(root, 'models/shapes/arkit.json')));
const { ids } = JSON.parse(fs.readFileSync(path.join(root, 'models/shapes/viseme-ids.json')));
const VISEMES = ['sil', 'PP', 'FF', 'TH', 'DD', 'kk', 'CH', 'SS', 'nn', 'RR', 'aa', 'E', 'I', 'O', 'U'];
const COLUMNS = `Timecode,BlendShapeCount,EyeBlinkLeft,EyeLookDownLeft,EyeLookInLeft,EyeLookOutLeft,EyeLookUpLeft,EyeSquintLeft,EyeWideLeft,
EyeBlinkRight,EyeLookDownRight,EyeLookInRight,EyeLookOutRight,EyeLookUpRight,EyeSquintRight,EyeWideRight,JawForward,JawRight,JawLeft,JawOpen,
MouthClose,MouthFunnel,MouthPucker,MouthRight,MouthLeft,MouthSmileLeft,MouthSmileRight,MouthFrownLeft,MouthFrownRight,MouthDimpleLeft,
MouthDimpleRight,MouthStretchLeft,MouthStretchRight,MouthRollLower,MouthRollUpper,MouthShrugLower,MouthShrugUpper,MouthPressLeft,MouthPressRight,
MouthLowerDownLeft,MouthLowerDownRight,MouthUpperUpLeft,MouthUpperUpRight,BrowDownLeft,BrowDownRight,BrowInnerUp,BrowOuterUpLeft,BrowOuterUpRight,
CheekPuff,CheekSquintLeft,CheekSquintRight,NoseSneerLeft,NoseSneerRight,TongueOut,HeadYaw,HeadPitch,HeadRoll,LeftEyeYaw,LeftEyePitch,LeftEyeRoll,
RightEyeYaw,RightEyePitch,RightEyeRoll`.replaceAll('\n', '').split(',');

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-curves-'));
const file = (name) => path.join(folder, name);
let daemon;
before(async () => { daemon = await Daemon.start(); });
after(async () => {
  fs.rmSync(folder, { recursive: true });
  assert.equal((await daemon.stop()).code, 0);
});

/** Runs faccia and returns its output in these formats. */
function faccia(args, formats, text) {
  const { status, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), [...args, ...formats.flatMap((format) => [`--${format}`, file(format)])],
    { input: text, encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return formats.map((format) => fs.readFileSync(file(format), 'utf8'));
}
const lines = (text) => text.trim().split('\n').map((line) => JSON.parse(line));
const frames = (text) => lines(text).filter(({ type }) => type === 'frame');
const get = async (query) => {
  const response = await daemon.get(`/v1/speech?${query}`);
  assert.equal(response.status, 200);
  return { type: response.headers.get('content-type'), text: await response.text() };
};

/** The value of a FAP by the weights. */
const made = (weights, fap) => Object.entries(weights).reduce((sum, [name, weight]) => sum + weight * (shapes[name].faps[fap] ?? 0), 0);
const MNS = 21 / 1024; // mm per FAP unit on the face of the definitions
/** Gap between the lips, in mm, in the middle and on both sides, by FAPs and by weights; below 0: pressed. */
const gaps = (faps, arkit) => [[4, 5], [8, 10], [9, 11]].map(([upper, lower]) => ({
  was: -MNS * (faps[upper] + faps[lower]),
  is: -MNS * (made(arkit, upper) + made(arkit, lower)),
}));

test('writes the columns of Live Link Face', () => {
  const [csv, fap] = faccia(['say', '-l', 'it', '--seed', '3', '-'], ['arkit', 'fap'], 'La mamma parla piano, e poi se ne va.');
  assert.ok(csv.endsWith('\r\n'));
  const [header, ...rows] = csv.trimEnd().split('\r\n').map((row) => row.split(','));
  assert.deepEqual(header, COLUMNS);
  assert.equal(header.length, 63);
  assert.deepEqual(header.slice(2, 54).map((name) => name[0].toLowerCase() + name.slice(1)), Object.keys(shapes));
  const said = parseFap(fap).frames;
  assert.equal(rows.length, said.length);
  rows.forEach((row, k) => {
    assert.equal(row.length, 63);
    assert.equal(row[0], `00:00:0${Math.floor(k / 25)}:${String(k % 25).padStart(2, '0')}.000`);
    assert.equal(row[1], '61');
    for (const weight of row.slice(2, 54)) assert.ok(weight >= 0 && weight <= 1, row.join());
    // radians: the head to its left, up, to its left shoulder; the eyes to their right, down; the columns of an eye are those of the eye whose shapes have the other name
    for (const [column, fap, sign] of [[54, 49, 1], [55, 48, -1], [56, 50, -1], [57, 24, -1], [58, 26, 1], [60, 23, -1], [61, 25, 1]])
      assert.ok(Math.abs(row[column] - sign * said[k][fap] * 1e-5) < 2e-6, `${header[column]} of frame ${k}`);
  });
  const moved = (name) => Math.max(...rows.map((row) => Math.abs(row[COLUMNS.indexOf(name)])));
  assert.ok(moved('JawOpen') > 0.1 && moved('MouthClose') > 0.05 && moved('HeadYaw') > 0);
});

test('counts thousandths of a frame where seconds are not whole frames', () => {
  const [csv] = faccia(['say', '-l', 'it', '--still', '--fps', '12.5', '-'], ['arkit'], 'La mamma parla piano, e poi se ne va.');
  const times = csv.trimEnd().split('\r\n').slice(1, 16).map((row) => row.split(',')[0]);
  assert.equal(times[12], '00:00:00:12.000');
  assert.equal(times[13], '00:00:01:00.500');
});

test('returns the same over HTTP, by GET and by POST', async () => {
  const text = 'Buongiorno, come va?';
  const query = `lang=it&still=1&text=${encodeURIComponent(text)}`;
  const { type, text: csv } = await get(`${query}&format=arkit`);
  assert.equal(type, 'text/csv; charset=utf-8');
  const [own] = faccia(['say', '-l', 'it', '--still', '-'], ['arkit'], text);
  assert.equal(csv, own);
  const posted = await daemon.get('/v1/speech', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ text, lang: 'it', still: true, format: 'arkit' }) });
  assert.equal(await posted.text(), csv);

  const live = await get(`${query}&format=arkit-ndjson`);
  assert.equal(live.type, 'application/x-ndjson');
  const rows = csv.trimEnd().split('\r\n').slice(1).map((row) => row.split(',').slice(2, 54).map(Number));
  const said = frames(live.text);
  assert.equal(said.length, rows.length);
  said.forEach(({ arkit, head }, k) => {
    Object.keys(shapes).forEach((name, i) => assert.ok(Math.abs((arkit[name] ?? 0) - rows[k][i]) < 1e-4, `${name} of frame ${k}`));
    assert.equal(head.length, 3);
  });
  assert.ok(lines(live.text).some(({ type, text: word }) => type === 'word' && word === 'come'), 'events come with it');
  assert.equal(lines(live.text).at(-1).type, 'end');
});

test('visemes: sounds with their times, and weights that sum up', async () => {
  const { type, text } = await get(`lang=it&still=1&format=visemes&text=${encodeURIComponent('La mamma parla, e Piero fischia.')}`);
  assert.equal(type, 'application/x-ndjson');
  const all = lines(text);
  const sounds = all.filter(({ type: kind }) => kind === 'viseme');
  assert.ok(!all.some(({ type: kind }) => kind === 'phone'));
  for (const { viseme, id, ipa, duration } of sounds) {
    assert.ok(VISEMES.includes(viseme) && duration > 0);
    if (ipa) assert.ok(ids[id].phones.includes(ipa), `${ipa}: ${id}`);
    else assert.deepEqual([viseme, id], ['sil', 0]);
  }
  sounds.slice(1).forEach((sound, i) => assert.ok(Math.abs(sound.time - sounds[i].time - sounds[i].duration) < 2e-3, 'they touch'));
  const of = (wanted) => sounds.filter(({ ipa }) => ipa === wanted).map(({ viseme, id }) => `${viseme} ${id}`);
  assert.deepEqual(of('m'), ['PP 21', 'PP 21']); // a long consonant is one segment
  assert.deepEqual(of('p'), ['PP 21', 'PP 21']);
  assert.deepEqual(of('f'), ['FF 18']);
  const said = frames(text);
  for (const { visemes } of said) {
    const weights = Object.values(visemes);
    assert.ok(weights.length <= 2 && Object.keys(visemes).every((name) => VISEMES.includes(name)));
    assert.ok(Math.abs(weights.reduce((sum, w) => sum + w, 0) - 1) < 1e-3);
  }
  // in the middle of a sound its viseme dominates
  for (const { time, duration, viseme } of sounds.filter(({ ipa, duration: length }) => ipa && length > 0.05)) {
    const frame = said[Math.round((time + duration / 2) * 25)];
    if (frame && Math.abs(frame.time - time - duration / 2) < 0.01) assert.ok((frame.visemes[viseme] ?? 0) > 0.5, JSON.stringify([time, viseme, frame]));
  }
});

test('reports an unknown format, with a suggestion', async () => {
  const response = await daemon.get('/v1/speech?text=a&lang=it&format=arkti');
  assert.equal(response.status, 400);
  const { code, message } = await response.json();
  assert.equal(code, 'unknown-format');
  assert.match(message, /arkit/);
});

// The following tests only run programs, without the daemon.
for (const lang of ['it', 'en', 'tr', 'pt-BR'])
  for (const rate of [160, 320])
    test(`lips touch where they should, ${lang} at ${rate} words a minute`, (t) => {
      const [fap, ndjson] = faccia(['say', '-l', lang, '--rate', String(rate), '--still', '-'], ['fap', 'arkit-ndjson'], sentences[lang].join(' '));
      const said = parseFap(fap).frames;
      const weighed = frames(ndjson);
      assert.equal(said.length, weighed.length);
      const counts = { closed: 0, open: 0, squares: 0 };
      said.forEach((faps, k) => {
        const { arkit } = weighed[k];
        assert.ok((arkit.mouthClose ?? 0) <= (arkit.jawOpen ?? 0), `frame ${k}`);
        const pairs = gaps(faps, arkit);
        if (pairs.every(({ was }) => was <= 0)) {
          counts.closed++;
          pairs.forEach(({ is }, i) => assert.ok(is < 0.02, `frame ${k}, pair ${i}: ${is} mm`));
        } else if (pairs[0].was > 1) {
          counts.open++;
          counts.squares += (pairs[0].is - pairs[0].was) ** 2;
          assert.ok(pairs[0].is > 0.5 * pairs[0].was, `frame ${k}: open by ${pairs[0].was} mm, shown by ${pairs[0].is}`);
        }
      });
      const rms = Math.sqrt(counts.squares / counts.open);
      t.diagnostic(`${counts.closed} frames closed; ${counts.open} open, off by ${rms.toFixed(2)} mm`);
      assert.ok(counts.closed > 100 && counts.open > 200, JSON.stringify(counts));
      assert.ok(rms < 0.5, `${rms} mm`);
    });

test('closed lids give a blink of 1, and gaze directions are kept', () => {
  const [fap, ndjson] = faccia(['say', '-l', 'it', '--fps', '100', '--seed', '5', '-'], ['fap', 'arkit-ndjson'], `${sentences.it.slice(0, 8).join(' ')}`);
  const weighed = frames(ndjson);
  let met = 0, awake = 0;
  parseFap(fap).frames.forEach((faps, k) => {
    const { arkit } = weighed[k];
    for (const [upper, lower, side] of [[19, 21, 'Left'], [20, 22, 'Right']]) {
      const blink = arkit[`eyeBlink${side}`] ?? 0;
      if (faps[upper] + faps[lower] >= 1024) {
        met++;
        assert.equal(blink, 1, `frame ${k}`);
      } else if (faps[upper] + faps[lower] < 100) {
        awake++;
        assert.ok(blink < 0.2, `frame ${k}: ${blink}`);
      }
    }
    const yaw = made(arkit, 23);
    assert.ok(Math.abs(yaw - Math.max(-52360, Math.min(52360, faps[23]))) < 400, `frame ${k}: ${yaw}, not ${faps[23]}`);
  });
  assert.ok(met > 10 && awake > 500, `${met}, ${awake}`);
});

test('exports visemes and ARKit weights from a recording', () => {
  const mask = ['1', '0', '1', ...Array(65).fill('0')].join(' ');
  fs.writeFileSync(file('r.fap'), `2.1 r 25 2\n${mask}\n0 1 10 21 0 500\n${mask}\n1 14 14 63 0 0\n`);
  const [visemes, arkit] = faccia(['play', file('r.fap')], ['visemes', 'arkit-ndjson']);
  const [first, second] = frames(visemes);
  assert.ok(Math.abs(first.visemes.PP - 1 / 3) < 1e-3 && Math.abs(first.visemes.aa - 2 / 3) < 1e-3);
  assert.deepEqual(second.visemes, { U: 1 });
  assert.ok(frames(arkit)[0].arkit.jawOpen > 0.3);
});

/** The messages of an OSC bundle, as [address, ...values]. */
function readBundle(bytes) {
  const text = (at) => bytes.toString('latin1', at, bytes.indexOf(0, at));
  const after = (at) => at + 4 * Math.floor(text(at).length / 4 + 1);
  assert.equal(text(0), '#bundle');
  const messages = [];
  for (let at = 16; at < bytes.length; at += 4 + bytes.readUInt32BE(at)) {
    assert.equal(bytes.readUInt32BE(at) % 4, 0);
    const types = after(at + 4);
    let place = after(types);
    const message = [text(at + 4)];
    for (const type of text(types).slice(1)) {
      message.push(type === 's' ? text(place) : bytes.readFloatBE(place));
      place = type === 's' ? after(place) : place + 4;
    }
    assert.equal(place, at + 4 + bytes.readUInt32BE(at), 'nothing is left over');
    messages.push(message);
  }
  return messages;
}

test('speech marks of Amazon Polly: places in bytes, whole milliseconds, symbols of Polly alone', async () => {
  const text = '<speak xml:lang="en">Però <mark name="here"/>the judge sings. Thank you!</speak>';
  const marks = (await get(`lang=en&markup=ssml&format=marks&text=${encodeURIComponent(text)}`)).text.trim().split('\n').map((line) => JSON.parse(line));
  const bytes = Buffer.from(text);
  for (const { type, start, end, value } of marks) if (type === 'word' || type === 'sentence') assert.equal(String(bytes.subarray(start, end)), value);
  assert.deepEqual(marks.filter(({ type }) => type === 'word').map(({ value }) => value), ['Però', 'the', 'judge', 'sings', 'Thank', 'you']);
  assert.equal(marks.filter(({ type }) => type === 'sentence').length, 2);
  for (const [i, { time }] of marks.entries()) assert.ok(Number.isInteger(time) && (i === 0 || time >= marks[i - 1].time), `line ${i}`);
  assert.deepEqual(marks.filter(({ type }) => type === 'ssml').map(({ time, value }) => [value, time]), [['here', marks.find(({ value }) => value === 'the').time]]);
  const visemes = marks.filter(({ type }) => type === 'viseme');
  for (const { value } of visemes) assert.match(value, /^(p|t|S|T|f|k|i|r|s|u|@|a|e|E|o|O|sil)$/);
  const judge = marks.find(({ value }) => value === 'judge').time - 5; // sounds may begin a moment before their word
  assert.deepEqual(visemes.filter(({ time }) => time >= judge).slice(0, 3).map(({ value }) => value), ['S', 'E', 'S']);
  assert.equal(visemes.at(-1).value, 'sil');
});

test('an OSC puppet gets the same weights, in real time', async () => {
  const socket = dgram.createSocket('udp4');
  socket.bind(0, '127.0.0.1');
  await once(socket, 'listening');
  const packets = [];
  socket.on('message', (bytes) => packets.push(bytes));
  const { port } = socket.address();
  const child = spawn(path.join(build, 'server/cli/faccia'), ['say', '-l', 'it', '--still', '--osc', `127.0.0.1:${port}`, '--arkit-ndjson', file('osc'), 'La mamma parla piano, e poi se ne va.'],
    { stdio: ['ignore', 'ignore', 'inherit'] });
  const begun = performance.now();
  const [status] = await once(child, 'close');
  const taken = (performance.now() - begun) / 1000;
  assert.equal(status, 0);
  // a final packet, behind everything that the program sent
  const fence = dgram.createSocket('udp4');
  fence.send('end', port, '127.0.0.1');
  for (; String(packets.at(-1)) !== 'end'; ) await once(socket, 'message');
  fence.close();
  socket.close();
  packets.pop();
  const sent = [];
  let frame = {};
  for (const bytes of packets) {
    assert.ok(bytes.length <= 1400, `${bytes.length} bytes`);
    for (const [address, name, weight] of readBundle(bytes)) {
      if (address === '/VMC/Ext/Blend/Apply') {
        sent.push(frame);
        frame = {};
      } else {
        assert.equal(address, '/VMC/Ext/Blend/Val');
        frame[name] = weight;
      }
    }
  }
  assert.deepEqual(frame, {}, 'the last frame is applied');
  const written = fs.readFileSync(file('osc'), 'utf8');
  const wanted = frames(written).map(({ arkit }) => Object.fromEntries(Object.keys(shapes).map((name) => [name, arkit[name] ?? 0])));
  const same = (a, b) => Object.keys(shapes).every((name) => Math.abs(a[name] - b[name]) < 1e-4);
  // a busy machine may skip frames, but keeps their order and the last one
  let at = 0;
  for (const one of sent) {
    assert.deepEqual(Object.keys(one), Object.keys(shapes));
    while (at < wanted.length && !same(one, wanted[at])) at++;
    assert.ok(at < wanted.length, 'every frame is one of the speech, in its order');
  }
  assert.ok(same(sent.at(-1), wanted.at(-1)) && sent.length > 1);
  assert.ok(taken > lines(written).at(-1).duration - 0.1, `${taken} s: not before its time`);
});

test('reports an invalid address', () => {
  for (const target of ['nowhere', ':1', 'localhost:', 'no such host:1', '127.0.0.1:port']) {
    const { status, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['say', '-l', 'it', '--osc', target, 'a'], { encoding: 'utf8' });
    assert.equal(status, 2, target);
    assert.match(stderr, /--osc: invalid address/);
  }
});
