// SPDX-License-Identifier: GPL-3.0-or-later
// `faccia fap capture`: recordings of ARKit's shapes become FAPs.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const { shapes } = JSON.parse(fs.readFileSync(path.join(root, 'models/shapes/arkit.json')));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-capture-'));
const file = (name) => path.join(folder, name);
const program = path.join(build, 'server/cli/faccia');
after(() => fs.rmSync(folder, { recursive: true }));

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
  assert.deepEqual([49, 48, 50].map((n) => radians.frames[5][n]), [20000, 10000, -5000]);
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
