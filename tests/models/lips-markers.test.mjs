// SPDX-License-Identifier: GPL-3.0-or-later
// The six articulatory parameters from markers: on the face of one of our heads, which speaks known FAPs and moves, written as others write tracks.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { FURTHER, MARKERS, PARAMETERS } from '../../models/tools/lips/articulation.mjs';
import { readMap } from '../../models/tools/lips/markers.mjs';
import { readC3d } from '../../models/tools/lips/read-c3d.mjs';
import { readCsv, readTrc } from '../../models/tools/lips/read-table.mjs';
import { pose, unitLength, unpack } from '../../models/tools/lib/deform.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { toC3d, toCsv, toTrc } from './lips/write-tracks.mjs';

const built = fileURLToPath(new URL('../../build/', import.meta.url));
const tool = fileURLToPath(new URL('../../models/tools/lips/faccia-lips.mjs', import.meta.url));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-lips-'));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

const head = unpack(JSON.parse(fs.readFileSync(path.join(built, 'models/heads/mara.json'), 'utf8')));
const skin = head.parts.find(({ name }) => name === 'skin');
const POINTS = ['9.3', '8.1', '8.3', '8.4', '8.2', '2.1', '10.5', '10.6']; // in the order of the thesis
const nearest = (p) => {
  let [best, least] = [0, Infinity];
  for (let v = 0; v < skin.position.length / 3; v++) {
    const far = Math.hypot(...p.map((x, k) => x - skin.position[3 * v + k]));
    if (far < least) [best, least] = [v, far];
  }
  return best;
};
const vertices = POINTS.map((point) => nearest(head.fdp[point]));
/** Degrees: of her nose and ear lobes. */
const tilt = (() => {
  const [nose, left, right] = [0, 6, 7].map((m) => head.fdp[POINTS[m]]);
  return (Math.atan2((left[1] + right[1]) / 2 - nose[1], nose[2] - (left[2] + right[2]) / 2) * 180) / Math.PI;
})();
const RATE = 100;
const COUNT = 120;

/** Motion of the face: at rest for 0.2 s, then all six parameters move independently. */
const told = Array.from({ length: COUNT }, (_, i) => {
  const t = Math.max(0, i / RATE - 0.25);
  const wave = (hertz, size) => size * Math.sin(2 * Math.PI * hertz * t);
  return [wave(2, 4) ** 2 / 4, wave(1.7, 1.2) ** 2, wave(1.3, 5), wave(2.2, 1.5), wave(1.9, 1), wave(1.1, 3) ** 2 / 3];
});
const fapsOf = ([li, ls, ar, pi, ps, em], turns) => {
  const faps = { 52: -li, 51: -ls, 53: ar / 2, 54: ar / 2, 16: pi, 17: ps, 3: em };
  return { ...Object.fromEntries(Object.entries(faps).map(([fap, x]) => [fap, x / unitLength(head, fap)])), ...turns };
};
const at = (faps) => {
  const posed = pose(head, skin, faps);
  return vertices.map((v) => [...posed.slice(3 * v, 3 * v + 3)]);
};
/** What a camera sees of it while the head stands still: a protruded lip also comes down a little. */
const mm = told.map((values) => {
  const [was, is] = [at({}), at(fapsOf(values))];
  const by = (m, k) => is[m][k] - was[m][k];
  const wide = ([, , left, right]) => Math.hypot(...left.map((x, k) => x - right[k]));
  return [-by(4, 1), by(1, 1), wide(is) - wide(was), by(4, 2), by(1, 2), -by(5, 1)];
});
const places = told.map((values, i) => {
  const posed = pose(head, skin, fapsOf(values, { 48: 9000 * Math.sin(i / 17), 49: 15000 * Math.sin(i / 23), 50: 6000 * Math.sin(i / 29) }));
  return vertices.map((v) => [...posed.slice(3 * v, 3 * v + 3)].map((x, k) => x + [40, -12, 300][k]));
});
const tracks = { names: [...MARKERS], rate: RATE, places };

const TILT = `--tilt=${tilt}`;
const run = (...args) => spawnSync('node', [tool, ...args], { encoding: 'utf8' });
const put = (name, data) => {
  const file = path.join(folder, name);
  fs.writeFileSync(file, data);
  return file;
};
const curvesIn = (text) => {
  const [names, ...rows] = text.trim().split('\n').map((line) => line.split(','));
  return { names, rows: rows.map((row) => row.map(Number)) };
};

/** The greatest error of each parameter, mm. */
function errors({ rows }) {
  return PARAMETERS.map((_, p) => Math.max(...rows.map((row) => Math.abs(row[1 + p] - mm[Math.round(row[0] * RATE)][p]))));
}

test('every file format gives the curves of the known FAPs, whatever the head does', () => {
  const forms = {
    'intel.c3d': toC3d(tracks), 'dec.c3d': toC3d(tracks, { kind: 85 }), 'mips.c3d': toC3d(tracks, { kind: 86 }), 'whole.c3d': toC3d(tracks, { whole: 0.02 }),
    'a.trc': toTrc(tracks), 'a.csv': toCsv(tracks), 'b.csv': toCsv(tracks, ';'), 'c.csv': toCsv(tracks).split('\n').slice(1).join('\n'),
  };
  for (const [name, data] of Object.entries(forms)) {
    const { status, stdout, stderr } = run(put(name, data), TILT);
    assert.equal(status, 0, `${name}: ${stderr}`);
    const curves = curvesIn(stdout);
    assert.deepEqual(curves.names, ['time', ...PARAMETERS, 'confidence']);
    assert.equal(curves.rows.length, COUNT);
    const most = errors(curves);
    assert.ok(Math.max(...most) < 0.1, `${name}: ${most.map((x) => x.toFixed(3))}`);
  }
});

test('28 markers: a map assigns the eight that count; without one an error lists their names', () => {
  const more = { ...tracks, names: [...Array.from({ length: 20 }, (_, i) => `B${i}`), ...MARKERS.map((name) => `X:${name}9`)], places: places.map((frame) => [...Array.from({ length: 20 }, (_, i) => [i, i, i]), ...frame]) };
  const file = put('many.c3d', toC3d(more));
  const refused = run(file);
  assert.equal(refused.status, 1);
  assert.match(refused.stderr, /many\.c3d: it has 28 markers.*--markers.*B0, B1/);
  const map = put('map.json', JSON.stringify(Object.fromEntries(MARKERS.map((key, i) => [key, i % 2 ? `${key}9` : 21 + i]))));
  const { status, stdout, stderr } = run(file, '--markers', map, TILT);
  assert.equal(status, 0, stderr);
  assert.ok(Math.max(...errors(curvesIn(stdout))) < 0.1);
});

test('lost markers: a parameter lacks confidence while one of its markers is lost; without the nose a frame is left out', () => {
  const lost = places.map((frame, i) => frame.map((p, m) => ((m === 4 && i >= 40 && i < 50) || (m === 2 && i >= 45 && i < 90) || (m === 0 && i >= 95 && i < 118) ? null : p)));
  for (const [name, data] of [['lost.c3d', toC3d({ ...tracks, places: lost })], ['lost.trc', toTrc({ ...tracks, places: lost })], ['lost.csv', toCsv({ ...tracks, places: lost })]]) {
    const { status, stdout, stderr } = run(put(name, data), TILT);
    assert.equal(status, 0, stderr);
    const { names, rows } = curvesIn(stdout);
    assert.deepEqual(names, ['time', ...PARAMETERS, 'confidence', ...PARAMETERS.map((p) => `${p}_confidence`)]);
    assert.equal(rows.length, COUNT - 23);
    const without = (parameter) => rows.filter((row) => row[names.indexOf(`${parameter}_confidence`)] === 0).map((row) => Math.round(row[0] * RATE));
    const span = (from, to) => Array.from({ length: to - from }, (_, i) => from + i);
    for (const p of ['LI', 'PI']) assert.deepEqual(without(p), span(40, 50), p);
    assert.deepEqual(without('AR'), span(45, 90));
    for (const p of ['LS', 'PS', 'EM']) assert.deepEqual(without(p), [], p);
    for (const row of rows) for (const [i, p] of PARAMETERS.entries()) if (row[names.indexOf(`${p}_confidence`)]) assert.ok(Math.abs(row[1 + i] - mm[Math.round(row[0] * RATE)][i]) < 0.1, `${p} at ${row[0]}`);
    assert.match(stderr, /frames 96 to 118: they are left out/);
  }
});

test('--all: the other four parameters of the thesis, and velocities', () => {
  const { status, stdout, stderr } = run(put('all.csv', toCsv(tracks)), TILT, '--all');
  assert.equal(status, 0, stderr);
  const { names, rows } = curvesIn(stdout);
  const all = [...PARAMETERS, ...FURTHER];
  assert.deepEqual(names, ['time', ...all, 'confidence', ...all.map((p) => `${p}_velocity`)]);
  const column = (name) => rows.map((row) => row[names.indexOf(name)]);
  const [al, am, eas, ead, ar, em, velocity] = ['AL', 'AM', 'EAS', 'EAD', 'AR', 'EM', 'EM_velocity'].map(column);
  for (let i = 0; i < COUNT; i++) {
    assert.ok(Math.abs(eas[i] + ead[i] - ar[i]) < 0.3, `the half widths add up: ${eas[i]} + ${ead[i]} and ${ar[i]}`);
    const lips = (frame) => Math.hypot(...frame[1].map((x, k) => x - frame[4][k]));
    const jaw = (frame) => Math.hypot(...frame[0].map((x, k) => x - frame[5][k]));
    const rest = (measure) => places.slice(0, 21).reduce((sum, frame) => sum + measure(frame), 0) / 21;
    assert.ok(Math.abs(al[i] - (lips(places[i]) - rest(lips))) < 0.02 && Math.abs(am[i] - (jaw(places[i]) - rest(jaw))) < 0.02, `frame ${i}`);
    if (i > 0 && i < COUNT - 1) assert.ok(Math.abs(velocity[i] - ((em[i + 1] - em[i - 1]) * RATE) / 2) < 0.2, `frame ${i}`);
  }
});

test('reports broken and malicious files with their position, and writes nothing', () => {
  const good = toC3d(tracks);
  const changed = (...bytes) => {
    const copy = Buffer.from(good);
    for (const [at, value] of bytes) copy[at] = value;
    return copy;
  };
  const cases = {
    'empty.c3d': ['', /byte 1: 1 bytes are wanted there, and the file has 0/],
    'text.c3d': ['hello, world', /byte 1: this is no C3D file/],
    'cut.c3d': [good.subarray(0, good.length - 40), /byte \d+: \d+ bytes are wanted there, and the file has/],
    'start.c3d': [changed([0, 200]), /byte \d+: 1 bytes are wanted/],
    'kind.c3d': [changed([515, 12]), /byte 515: numbers of kind 12/],
    'huge.c3d': [changed([2, 255], [3, 255], [8, 255], [9, 255]), /at most \d+ places are read/],
    'none.c3d': [changed([2, 0], [3, 0]), /byte 2: there are no markers/],
    'back.c3d': [changed([6, 99], [8, 9]), /frames go from 99 to/],
    'empty.csv': ['', /the file is empty/],
    'word.csv': [toCsv(tracks).replace(/\n0\.02000,[^,]+/, '\n0.02000,left'), /line 4, column 2: "left" is not a number/],
    'time.csv': [toCsv(tracks).replace('\n0.03000', '\n0.01000'), /line 5: the time does not rise/],
    'names.csv': ['time,LI\n0,1\n', /line 1: no three columns are named/],
    'few.csv': ['1,2\n', /line 1: 2 numbers without names/],
    'untimed.csv': [toCsv(tracks).replace(/^time/, 'when'), /line 1: there is no column "time"/],
    'line.trc': ['time\n', /line 1: this is no TRC file/],
    'cut.trc': [toTrc(tracks).slice(0, 60), /DataRate|the file ends/],
    'wide.trc': [toTrc(tracks).replace('\r\n1\t', `\r\n1\t0${'\t1'.repeat(90)}\r\n1\t`), /line 7: 92 fields/],
    'unit.trc': [toTrc(tracks).replace('\tmm\t', '\tfurlongs\t'), /lengths in "furlongs"/],
  };
  const readers = { c3d: (data) => readC3d(Buffer.from(data)), csv: (data) => readCsv(data, {}), trc: readTrc };
  for (const [name, [data, what]] of Object.entries(cases))
    assert.throws(() => readers[name.split('.')[1]](data), (error) => error.constructor.name === 'FileError' && what.test(error.message), name);
  for (const name of ['cut.c3d', 'word.csv', 'wide.trc']) {
    const out = path.join(folder, 'never.csv');
    const { status, stderr } = run(put(name, cases[name][0]), '-o', out);
    assert.equal(status, 1, stderr);
    assert.match(stderr, cases[name][1]);
    assert.ok(stderr.includes(name) && !/ at .*\.mjs/.test(stderr), stderr);
    assert.ok(!fs.existsSync(out), name);
  }
  for (const [map, what] of [['[]', /an object is wanted/], ['{"nose": 1', /JSON/], ['{"nose": true}', /nose: must be a name/], ['{"hat": 1}', /hat: there is no such marker/], ['{"nose": 1}', /upperLip: is missing/]])
    assert.throws(() => readMap(map), what);
});

test('random bytes give an error with a position, or tracks, and nothing else', () => {
  const good = toC3d({ ...tracks, places: places.slice(0, 4) });
  let state = 7;
  const random = (below) => (state = (state * 16807) % 2147483647) % below;
  for (let i = 0; i < 3000; i++) {
    const copy = Buffer.from(good.subarray(0, random(4) ? good.length : random(good.length)));
    for (let n = 1 + random(6); n && copy.length; n--) copy[random(Math.min(copy.length, 900))] = random(256);
    try {
      assert.ok(readC3d(copy).times.length);
    } catch (error) {
      assert.equal(error.constructor.name, 'FileError', error.stack);
    }
  }
});

test('reports wrong usage', () => {
  for (const [args, what] of [[['a', 'b'], /one folder/], [['x.csv', '--rest', '3'], /--rest/], [['x.csv', '--what'], /--what/], [[folder], /--fps/]]) {
    const { status, stderr } = run(...args);
    assert.equal(status, 2, stderr);
    assert.match(stderr, what);
  }
  assert.equal(run(path.join(folder, 'nothing.csv')).status, 1);
});

test('a head copies the lips of the markers: faccia fap capture', () => {
  const curves = put('copied.csv', run(put('copied.c3d', toC3d(tracks)), TILT).stdout);
  const { status, stdout, stderr } = spawnSync(path.join(built, 'server/cli/faccia'), ['fap', 'capture', curves], { encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  const { fps, frames } = parseFap(stdout);
  assert.deepEqual([fps, frames.length], [RATE, COUNT]);
  const was = at({});
  const wide = ([, , left, right]) => Math.hypot(...left.map((x, k) => x - right[k]));
  const copies = frames.map((frame) => {
    const is = at(Object.fromEntries(Array.from(frame, (value, n) => [n, value]).filter(([n, value]) => n > 2 && value)));
    return { LI: was[4][1] - is[4][1], LS: is[1][1] - was[1][1], AR: wide(is) - wide(was), EM: was[5][1] - is[5][1] };
  });
  const pairs = (name) => copies.map((copied, i) => [copied[name], mm[i][PARAMETERS.indexOf(name)]]);
  for (const name of ['AR', 'EM']) {
    const error = Math.max(...pairs(name).map(([is, by]) => Math.abs(is - by)));
    assert.ok(error < 0.8, `${name}: ${error} mm`);
  }
  // lips open as far as the curves say, unless they are rounded; their middle goes its own way with the corners
  const MNS = 21 / 1024; // mm of the modelled speaker in a unit
  const rows = curvesIn(fs.readFileSync(curves, 'utf8')).rows;
  const open = rows.flatMap(([, li, ls, ar], i) => (ar > 0 && li + ls > 0 ? [[-(frames[i][4] + frames[i][5]) * MNS, li + ls]] : []));
  assert.ok(open.length > 30 && Math.max(...open.map(([, by]) => by)) > 3, `${open.length}`);
  for (const [is, by] of open) assert.ok(Math.abs(is - by) < 0.1, `${is} mm, not ${by}`);
  assert.equal(frames.slice(0, 20).every((frame) => frame[3] < 10 && Math.abs(frame[4] + frame[5]) < 40), true, 'at rest');
});

test('says what is wrong with curves of lips, and where', () => {
  const head = `time,${PARAMETERS.join(',')},confidence\n`;
  for (const [text, place, pattern] of [
    ['time,LI\n0,1\n', ':1: ', /columns time, LI, LS, AR, PI, PS and EM/],
    [`time,LI,LI,LS,AR,PI,PS,EM\n`, ':1:9: ', /occurs twice/],
    [head, ':1: ', /no row/],
    [`${head}0,0,0,0,0,0,x,1\n`, ':2:13: ', /no number/],
    [`${head}0,0,0,0,0,0,1e9,1\n`, ':2:13: ', /out of range/],
    [`${head}0,0,0,0,0,0,0,1,2\n`, ':2:17: ', /more fields/],
    [`${head}0,0,0\n`, ':2: ', /fewer fields/],
    [`${head}1,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n`, ':3: ', /not after the one before/],
  ]) {
    const { status, stdout, stderr } = spawnSync(path.join(built, 'server/cli/faccia'), ['fap', 'capture', put('bad.csv', text)], { encoding: 'utf8' });
    assert.deepEqual([status, stdout], [1, ''], text);
    assert.ok(stderr.includes(`bad.csv${place}`), `${stderr} for ${text}`);
    assert.match(stderr, pattern);
  }
});
