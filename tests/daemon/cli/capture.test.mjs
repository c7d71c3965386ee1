// SPDX-License-Identifier: GPL-3.0-or-later
// `faccia fap capture`: recordings of ARKit's shapes become FAPs.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import dgram from 'node:dgram';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { build, root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const { shapes } = JSON.parse(fs.readFileSync(path.join(root, 'models/shapes/arkit.json')));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-capture-'));
const file = (name) => path.join(folder, name);
const program = path.join(build, 'server/cli/faccia');
const recorders = [];
after(() => {
  for (const child of recorders) child.kill('SIGKILL');
  fs.rmSync(folder, { recursive: true });
});

const run = (...args) => spawnSync(program, args, { encoding: 'utf8' });
function faccia(...args) {
  const { status, stdout, stderr } = run(...args);
  assert.equal(status, 0, stderr);
  return stdout;
}
/** Converts rows of a CSV. @returns the face, with fps and frames by FAP number */
function captured(text, ...options) {
  fs.writeFileSync(file('in.csv'), text);
  return parseFap(faccia('fap', 'capture', ...options, file('in.csv')));
}
const names = Object.keys(shapes);
const capital = (name) => name[0].toUpperCase() + name.slice(1);
const timecode = (k, fps = 60) => `00:32:${String(9 + Math.floor(k / fps)).padStart(2, '0')}:${String(k % fps).padStart(2, '0')}.500`;
const csv = (rows, columns = names.map(capital)) =>
  `Timecode,BlendShapeCount,${columns.join(',')}\r\n${rows.map((row, k) => `${row.time ?? timecode(k)},61,${columns.map((name) => row[name] ?? 0).join(',')}\r\n`).join('')}`;
const rows = (count, row) => Array.from({ length: count }, (_, k) => row(k));

test('each shape moves the FAPs of its definition', () => {
  const { fps, frames } = captured(csv(rows(names.length + 60, (k) => (k < names.length ? { [capital(names[k])]: 1, ...(names[k] === 'mouthClose' ? { JawOpen: 1 } : {}) } : {}))));
  assert.equal(fps, 60);
  assert.equal(frames.length, names.length + 60);
  names.forEach((name, k) => {
    const expected = { ...shapes[name].faps };
    if (name === 'mouthClose') for (const [n, value] of Object.entries(shapes.jawOpen.faps)) expected[n] = (expected[n] ?? 0) + value;
    for (let n = 3; n <= 68; n++) assert.equal(frames[k][n] ?? 0, expected[n] ?? 0, `${name}, FAP ${n}`);
  });
});

test('weights are kept within bounds, and lids meet but do not cross', () => {
  const { frames: [over, crossed] } = captured(csv(rows(60, (k) => [{ JawOpen: 1.5, MouthClose: 3, MouthSmileLeft: -1 }, { EyeBlinkLeft: 1, EyeSquintLeft: 1, CheekSquintLeft: 1 }][k] ?? {})));
  for (const [n, value] of Object.entries(shapes.jawOpen.faps)) assert.equal(over[n] ?? 0, value + (shapes.mouthClose.faps[n] ?? 0), `FAP ${n}`);
  assert.ok(Math.abs(crossed[19] + crossed[21] - 1024) <= 1, `${crossed[19]} ${crossed[21]}`);
});

test('a speech that was exported comes back: lips that touch touch, the rest to a fraction of a millimetre', () => {
  for (const [lang, text] of [['it', 'Mamma, il babbo beve piano, e poi parla.'], ['en', 'My mother bought a big blue boat for Bob.']]) {
    faccia('say', '--lang', lang, '--seed', '3', '--fps', '60', '--fap', file('a.fap'), '--arkit', file('a.csv'), `${text} ${text}`);
    const was = parseFap(fs.readFileSync(file('a.fap'), 'utf8'));
    const is = captured(fs.readFileSync(file('a.csv'), 'utf8'));
    assert.deepEqual([is.fps, is.frames.length], [60, was.frames.length]);
    const gap = (frame, [upper, lower]) => -((frame[upper] ?? 0) + (frame[lower] ?? 0)) * (21 / 1024);
    let squares = 0, count = 0, touching = 0;
    was.frames.forEach((frame, k) => {
      const [before, after] = [gap(frame, [4, 5]), gap(is.frames[k], [4, 5])];
      if (before <= 0) {
        touching++;
        assert.ok(after <= 0.05, `frame ${k} of ${lang} is open by ${after} mm`); // rounding of six decimals and of whole units
      }
      squares += (before - after) ** 2;
      count++;
      for (const n of [48, 49, 50]) assert.ok(Math.abs((frame[n] ?? 0) - is.frames[k][n]) <= 2, `FAP ${n} of frame ${k}`);
    });
    assert.ok(touching > 10 && Math.sqrt(squares / count) < 0.6, `${touching} closures, ${Math.sqrt(squares / count)} mm`);
    // once more: what has been through the shapes stays as it is
    faccia('play', '--arkit', file('b.csv'), write('b.fap', faccia('fap', 'capture', file('a.csv'))));
    const again = captured(fs.readFileSync(file('b.csv'), 'utf8'));
    const worst = Math.max(...is.frames.map((frame, k) => Math.abs(gap(frame, [4, 5]) - gap(again.frames[k], [4, 5]))));
    assert.ok(worst < 1, `${worst} mm`);
  }
});
function write(name, text) {
  fs.writeFileSync(file(name), text);
  return file(name);
}

test('turns of the head, in the units of the app and of this program', () => {
  const columns = ['EyeLookDownLeft', 'EyeLookUpLeft', 'HeadYaw', 'HeadPitch', 'HeadRoll', 'LeftEyePitch', 'JawOpen'];
  const looks = (k) => ({ EyeLookDownLeft: k % 2 ? 0.3 : 0, EyeLookUpLeft: k % 2 ? 0 : 0.2, HeadYaw: 0.2, HeadPitch: 0.1, HeadRoll: -0.05 });
  const gaze = (k) => (k % 2 ? 0.3 : -0.2);
  const radians = captured(csv(rows(60, (k) => ({ ...looks(k), LeftEyePitch: 0.61 * gaze(k) })), columns));
  assert.deepEqual([49, 48, 50].map((n) => radians.frames[5][n]), [20000, -10000, 5000]);
  const halves = captured(csv(rows(60, (k) => ({ ...looks(k), LeftEyePitch: -0.14 * gaze(k) })), columns));
  assert.deepEqual([49, 48, 50].map((n) => halves.frames[5][n]), [0.2, -0.1, 0.05].map((turn) => Math.round(turn * Math.PI * 1e5)));
});

test('keeps time: missing frames, midnight, other rates, rows without a face', () => {
  const open = (times, ...options) => captured(csv(times.map((time, k) => ({ time, JawOpen: k / 10 })), ['JawOpen']), ...options);
  const jaw = ({ frames }) => frames.map((frame) => frame[3]);
  assert.deepEqual(jaw(open(['00:00:59:58.000', '00:01:00:00.000', '00:01:00:01.000'])), [0, 50, 100, 200], 'a missing frame is between its neighbours');
  assert.deepEqual(jaw(open(['23:59:59:23', '00:00:00:00'])), [0, 100]);
  assert.deepEqual(jaw(open(['00:00:00:00', '00:00:00:01', '00:00:00:02'], '--rate', '60', '--fps', '30')), [0, 200]);
  assert.equal(open(['00:00:00:00', '00:00:00:29']).fps, 30);
  assert.equal(open(['00:00:00:00', '00:00:01:00'], '--rate', '25', '--fps', '50').frames.length, 51);
  const hole = captured('\ufefftimecode,blendshapecount,JAWOPEN,Note\n00:00:00:00,52,0,x\n00:00:00:01,0\n\n00:00:00:02,52,0.2,\n');
  assert.deepEqual(jaw(hole), [0, 100, 200]);
});

test('says what is wrong with a file, and where', () => {
  const head = 'Timecode,BlendShapeCount,JawOpen\n';
  for (const [text, place, pattern] of [
    ['', ':1: ', /no column Timecode/],
    ['a,b\n1,2\n', ':1: ', /no column Timecode/],
    ['Timecode,HeadYaw\n', ':1: ', /no column is a shape/],
    ['Timecode,JawOpen,jawopen\n', ':1:18: ', /occurs twice/],
    [`Timecode,JawOpen${',x'.repeat(300)}\n`, ':1:526: ', /more than 256 columns/],
    [head, ':1: ', /no row with values/],
    [`${head}00:00:00:00,1,x\n`, ':2:15: ', /no number/],
    [`${head}00:00:00:00,1,nan\n`, ':2:15: ', /no number/],
    [`${head}00:00:00:00,1,\n`, ':2:15: ', /no number/],
    [`${head}00:00:00:00,1,${'1'.repeat(99)}\n`, ':2:15: ', /no number/],
    [`${head}00:00:00,1,0\n`, ':2:1: ', /no timecode/],
    [`${head}00:61:00:00,1,0\n`, ':2:1: ', /no timecode/],
    [`${head}00:00:00:00,1,0,5\n`, ':2:17: ', /more fields/],
    [`${head}00:00:00:00,1\n`, ':2:1: ', /fewer fields/],
    [`${head}00:00:00:05,1,0\n00:00:00:05,1,0\n`, ':3: ', /not after the one before/],
    [`${head}00:00:00:00,1,0\n11:00:00:00,1,0\n`, ':3: ', /more than 4194304 frames/],
  ]) {
    fs.writeFileSync(file('bad.csv'), text);
    const options = text.includes('11:00') ? ['--fps', '1000'] : [];
    const { status, stdout, stderr } = run('fap', 'capture', ...options, file('bad.csv'));
    assert.deepEqual([status, stdout], [1, ''], text);
    assert.ok(stderr.includes(`bad.csv${place}`), `${stderr} for ${text}`);
    assert.match(stderr, pattern);
  }
  assert.equal(run('fap', 'capture').status, 2);
  assert.equal(run('fap', 'capture', '--fps', '0', 'x').status, 2);
  assert.match(run('fap', 'capture', '--loud').stderr, /Try 'faccia fap --help'/);
});

/** Starts a recording of what comes by UDP. @returns its port, and end(signal), which gives status, face and messages */
async function record(...options) {
  const child = spawn(program, ['fap', 'capture', '--udp', '0', ...options], { stdio: ['ignore', 'pipe', 'pipe'] });
  recorders.push(child); // a failed test leaves it behind
  let stdout = '', stderr = '';
  child.stdout.setEncoding('utf8').on('data', (text) => (stdout += text));
  const closed = once(child, 'close');
  while (!/port \d+/.test(stderr)) stderr += (await once(child.stderr.setEncoding('utf8'), 'data'))[0];
  child.stderr.on('data', (text) => (stderr += text));
  const end = async (signal) => {
    if (signal) child.kill(signal);
    const [status] = await closed;
    return { status, stderr, face: stdout && parseFap(stdout) };
  };
  return { port: Number(/port (\d+)/.exec(stderr)[1]), child, end };
}
const padded = (text) => Buffer.from(text + '\0'.repeat(4 - (Buffer.byteLength(text) % 4)));
const float = (value) => {
  const bytes = Buffer.alloc(4);
  bytes.writeFloatBE(value);
  return bytes;
};
const size = (bytes) => {
  const head = Buffer.alloc(4);
  head.writeUInt32BE(bytes.length);
  return Buffer.concat([head, bytes]);
};
const value = (name, weight) => Buffer.concat([padded('/VMC/Ext/Blend/Val'), padded(',sf'), padded(name), float(weight)]);
const apply = Buffer.concat([padded('/VMC/Ext/Blend/Apply'), padded(',')]);
const bundle = (...parts) => Buffer.concat([padded('#bundle'), Buffer.alloc(8), ...parts.map(size)]);

test('records what a puppet is sent by the VMC protocol, in its time', async () => {
  const recording = await record('--fps', '50');
  faccia('say', '--lang', 'it', '--seed', '2', '--fps', '50', '--fap', file('p.fap'), '--osc', `127.0.0.1:${recording.port}`, 'Mamma, il babbo beve piano e poi parla. Poi tace.');
  const { status, face } = await recording.end('SIGINT');
  assert.equal(status, 0);
  const jaw = ({ frames }) => frames.map((frame) => frame[3]);
  const [was, is] = [jaw(parseFap(fs.readFileSync(file('p.fap'), 'utf8'))), jaw(face)];
  assert.ok(Math.abs(was.length - is.length) < 25, `${was.length} frames were sent, ${is.length} are there`);
  const mean = (list) => list.reduce((sum, x) => sum + x, 0) / list.length;
  const fit = (shift) => {
    const pairs = was.map((x, k) => [x, is[k + shift]]).filter(([, y]) => y !== undefined);
    const [a, b] = [mean(pairs.map(([x]) => x)), mean(pairs.map(([, y]) => y))];
    const sum = (f) => pairs.reduce((total, [x, y]) => total + f(x - a, y - b), 0);
    return sum((x, y) => x * y) / Math.sqrt(sum((x) => x * x) * sum((_, y) => y * y));
  };
  const best = Math.max(...Array.from({ length: 21 }, (_, i) => fit(i - 10)));
  assert.ok(best > 0.8, `the jaw follows by ${best}`);
});

test('takes single messages, nested bundles and any case; ignores what is malformed', async () => {
  const recording = await record('--seconds', '0.5');
  const socket = dgram.createSocket('udp4');
  const send = (bytes) => new Promise((resolve) => socket.send(bytes, recording.port, '127.0.0.1', resolve));
  const good = value('JAWOPEN', 0.5);
  for (let cut = 0; cut < good.length; cut++) await send(bundle(good.subarray(0, cut)).subarray(0, 20 + cut));
  await send(Buffer.from('/VMC'));
  await send(Buffer.concat([padded('#bundle'), Buffer.alloc(8), Buffer.from([255, 255, 255, 255, 1])]));
  let deep = bundle(value('mouthPucker', 1));
  for (let i = 0; i < 50; i++) deep = bundle(deep);
  await send(deep); // too deep to be taken
  await send(apply); // nothing has come yet
  await send(bundle(value('eyeBlinkLeft', NaN), value('Fun', 1), bundle(good)));
  await send(value('tongueOut', 1));
  await send(apply);
  const { status, face } = await recording.end();
  socket.close();
  assert.equal(status, 0);
  assert.equal(face.fps, 60);
  assert.deepEqual([3, 45, 16, 19].map((n) => face.frames[0][n]), [500, 450, 0, 0]);
});

/** A rotation of Unity, in radians: about y, then x, then z */
const turned = (x, y, z) => {
  const [a, b, c] = [x, y, z].map((angle) => [Math.sin(angle / 2), Math.cos(angle / 2)]);
  return [b[1] * a[0] * c[1] + b[0] * a[1] * c[0], b[0] * a[1] * c[1] - b[1] * a[0] * c[0], b[1] * a[1] * c[0] - b[0] * a[0] * c[1], b[1] * a[1] * c[1] + b[0] * a[0] * c[0]];
};
const bone = (name, rotation) => Buffer.concat([padded('/VMC/Ext/Bone/Pos'), padded(',sfffffff'), padded(name), ...[0, 1.5, 0, ...rotation].map(float)]);

test('the head turns as its bone does by the VMC protocol', async () => {
  const recording = await record();
  const socket = dgram.createSocket('udp4');
  const send = (bytes) => new Promise((resolve) => socket.send(bytes, recording.port, '127.0.0.1', resolve));
  await send(bundle(bone('Head', [0, 0, 0, NaN]), bone('Head', [0, 0, 0, 9]), bone('Hips', turned(1, 1, 1)), value('jawOpen', 0.1), apply));
  for (const pose of [[turned(0, 0.2, 0), turned(0, 0.1, 0)], [turned(0, 0, 0), turned(0.3, -0.2, 0.1)]])
    for (let k = 0; k < 5; k++) {
      await sleep(40);
      await send(bundle(bone('Neck', pose[0]), bone('Head', pose[1]), value('jawOpen', 0.1), apply));
    }
  const { status, face } = await recording.end('SIGINT');
  socket.close();
  assert.equal(status, 0);
  const [first, last] = [face.frames[0], face.frames.at(-1)];
  assert.deepEqual([48, 49, 50].map((n) => first[n]), [0, 0, 0], 'what is no rotation is ignored');
  assert.ok(face.frames.some((frame) => frame[49] === -30000 && frame[48] === 0), 'neck and head together, to the right');
  assert.deepEqual([48, 49, 50].map((n) => last[n]), [30000, 20000, -10000], 'down, to the left, to the left shoulder');
});

const uint = (value) => {
  const bytes = Buffer.alloc(4);
  bytes.writeInt32BE(value);
  return bytes;
};
const link = (values, { frame = 0, part = 0.5, rate = 60, device = '5B5F6A2C-8A0B-4D0C-9B0E-0B2E6F6E3C11', subject = 'iPhone Ñ' } = {}) => {
  const name = Buffer.from(subject);
  return Buffer.concat([Buffer.from([6]), uint(device.length), Buffer.from(device), uint(name.length), name, uint(frame), float(part), uint(rate), uint(1), Buffer.from([61]), ...Array.from({ length: 61 }, (_, i) => float(values[i] ?? 0))]);
};

test('records Live Link Face by its own clock', async () => {
  const recording = await record('--fps', '30');
  const socket = dgram.createSocket('udp4');
  const send = (bytes) => new Promise((resolve) => socket.send(bytes, recording.port, '127.0.0.1', resolve));
  const good = link({ 17: 0.5 });
  for (let cut = 1; cut < good.length; cut += 3) await send(good.subarray(0, cut));
  await send(link({ 17: NaN }));
  await send(Buffer.concat([good.subarray(0, 1), Buffer.from([0xff, 0xff, 0xff, 0xff]), good.subarray(5)]));
  // 30 frames of a second, sent faster: in Unreal's order left and right of the jaw are exchanged
  for (let frame = 0; frame <= 30; frame++) await send(link({ 17: frame / 30, 15: 1, 22: 0.5, 52: 0.2, 53: 0.1, 54: 0.05 }, { frame: 1000 + frame, rate: 30 }));
  await sleep(300);
  const other = dgram.createSocket('udp4');
  await new Promise((resolve) => other.send(link({ 17: 1 }, { frame: 1031, rate: 30 }), recording.port, '127.0.0.1', resolve));
  await sleep(200);
  const { status, face } = await recording.end('SIGINT');
  socket.close();
  other.close();
  assert.equal(status, 0);
  assert.equal(face.frames.length, 31, 'another sender is not heard meanwhile');
  face.frames.forEach((frame, k) => assert.ok(Math.abs(frame[3] - (1000 * k) / 30) <= 1, `${k}: ${frame[3]}`));
  const { jawLeft, mouthRight } = shapes;
  assert.equal(face.frames[0][15], jawLeft.faps[15] + (mouthRight.faps[15] ?? 0) * 0.5);
  assert.deepEqual([48, 49, 50].map((n) => face.frames[9][n]), [-10000, 20000, -5000]);
});

test('takes the text of iFacialMocap, in both versions', async () => {
  const recording = await record('--seconds', '1');
  const socket = dgram.createSocket('udp4');
  const send = (text) => new Promise((resolve) => socket.send(Buffer.from(text), recording.port, '127.0.0.1', resolve));
  for (const nothing of ['jawOpen', 'jawOpen-', 'jawOpen-x', 'jawOpen-nan', 'Fun-5', '|||', '=head#', 'head#1,2', 'head#1,inf,2', `${'x'.repeat(300)}-5|`, 'FMV3\x01']) await send(nothing);
  await send('jawOpen-50|eyeBlink_L-0|tongueOut-100|hapihapi-7|=head#5.729578,-11.459156,2.864789,-0.03,-0.1,-0.66|rightEye#6,2.4,0.2|leftEye#6,-1.6,-0.2|-0.6|||3|');
  await sleep(300);
  for (let k = 0; k < 3; k++, await sleep(60)) await send('jawOpen&-25|JAWFORWARD&0|eyeBlinkRight&100|=head#-5.729578,0,0,0,0,0|leftEye#0,0,0|___iFacialMocap');
  const { status, face } = await recording.end();
  socket.close();
  assert.equal(status, 0);
  const [first, last] = [face.frames[0], face.frames.at(-1)];
  assert.deepEqual([3, 45, 19, 20].map((n) => first[n]), [500, 450, 0, 0]);
  assert.deepEqual([48, 49, 50].map((n) => first[n]), [10000, -20000, 5000], 'down, to the right, to the right shoulder');
  assert.deepEqual([3, 45, 48, 49].map((n) => last[n]), [0, 450, -10000, 0], 'what a packet leaves out stays');
  assert.ok(last[20] > 800 && last[19] < 100, `${last[19]} ${last[20]}`);
});

test('asks a telephone for its face, and hears nobody else', async () => {
  const phone = dgram.createSocket('udp4');
  await new Promise((resolve) => phone.bind(0, '127.0.0.1', resolve));
  const asked = new Set();
  let timer;
  phone.on('message', (text, { port }) => {
    asked.add(String(text));
    timer ??= setInterval(() => phone.send('jawOpen&40|=head#0,0,0,0,0,0|', port, '127.0.0.1'), 20);
  });
  const recording = await record('--phone', `127.0.0.1:${phone.address().port}`, '--seconds', '1');
  const { status, face } = await recording.end();
  clearInterval(timer);
  phone.close();
  assert.equal(status, 0);
  assert.deepEqual([...asked].sort(), ['FACEMOTION3D_OtherStreaming', 'iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719|sendDataVersion=v2']);
  assert.ok(face.frames.length > 5 && face.frames.every((frame) => frame[3] === 400), `${face.frames.length}`);
  const other = await record('--phone', '127.0.0.2', '--seconds', '0.5');
  const stranger = dgram.createSocket('udp4');
  for (let k = 0; k < 20; k++) {
    await new Promise((resolve) => stranger.send('jawOpen&40|', other.port, '127.0.0.1', resolve));
    await sleep(10);
  }
  stranger.close();
  assert.match((await other.end('SIGINT')).stderr, /no weight of an ARKit shape has come/);
  assert.match(run('fap', 'capture', '--udp', '0', '--phone', 'phone.example').stderr, /--phone: 'phone\.example' is no numeric address/);
});

test('a sender whose clock stands, or begins anew, is recorded by when it sends', async () => {
  const recording = await record('--fps', '25');
  const socket = dgram.createSocket('udp4');
  const send = (bytes) => new Promise((resolve) => socket.send(bytes, recording.port, '127.0.0.1', resolve));
  const begun = performance.now();
  for (let k = 0; k <= 20; k++) {
    await send(link({ 17: 0.5 }, { frame: k < 10 ? 1337 : k < 15 ? 4 * k : 90000 - 9000 * k }));
    await sleep(40);
  }
  const seconds = (performance.now() - begun) / 1000;
  const { status, face } = await recording.end('SIGINT');
  socket.close();
  assert.equal(status, 0);
  assert.ok(Math.abs(face.frames.length / 25 - seconds) < 0.3, `${face.frames.length} frames in ${seconds} s`);
});

test('warns of a sender that has no ARKit shapes', async () => {
  const recording = await record();
  const socket = dgram.createSocket('udp4');
  const send = (bytes) => new Promise((resolve) => socket.send(bytes, recording.port, '127.0.0.1', resolve));
  let stderr = '';
  recording.child.stderr.on('data', (text) => (stderr += text));
  for (let k = 0; k < 5000 && !stderr.includes('warning'); k++) {
    await send(bundle(value('Joy', 1), apply));
    if (k % 100 === 0) await sleep(10);
  }
  socket.close();
  assert.equal((await recording.end('SIGINT')).status, 1);
  assert.match(stderr, /warning: what comes has no ARKit shapes/);
});

test('says why there is no recording', async () => {
  const idle = await record();
  const { status, stderr } = await idle.end('SIGTERM');
  assert.equal(status, 1);
  assert.match(stderr, /no weight of an ARKit shape has come/);
  for (const address of ['x', '127.0.0.1:', ':39539', 'example.org:1', '127.0.0.1:70000']) {
    const wrong = run('fap', 'capture', '--udp', address);
    assert.equal(wrong.status, 1);
    assert.match(wrong.stderr, /cannot receive at/);
  }
  const taken = dgram.createSocket('udp4');
  await new Promise((resolve) => taken.bind(0, '127.0.0.1', resolve));
  assert.match(run('fap', 'capture', '--udp', `127.0.0.1:${taken.address().port}`).stderr, /address already in use/);
  taken.close();
  assert.equal(run('fap', 'capture', '--udp', '0', '--rate', '60').status, 2);
  assert.equal(run('fap', 'capture', '--seconds', '5', 'x.csv').status, 2);
  assert.equal(run('fap', 'capture', '--udp', '0', '--url', 'http://127.0.0.1:1').status, 2);
});
