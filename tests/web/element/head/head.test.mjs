// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { faceValues } from '../../../../web/element/face/face-mixer.mjs';
import { deform } from '../../../../web/element/head/mesh/deform.mjs';
import { Drive, influencesOf, packInfluences, turned, WHOLE_HEAD } from '../../../../web/element/head/mesh/influences.mjs';
import { httpBase, ModelAssembler } from '../../../../web/element/head/model/source.mjs';
import { ModelError, readModel } from '../../../../web/element/head/model/model.mjs';
import { Normals } from '../../../../web/element/head/mesh/normals.mjs';
import { bakeOcclusion, throughHair } from '../../../../web/element/head/shading/occlusion.mjs';
import { Governor, LEVELS } from '../../../../web/element/head/quality.mjs';

const base64 = (array) => Buffer.from(array.buffer).toString('base64');
const near = (actual, expected, tolerance = 1e-3) =>
  [...actual].forEach((value, i) => assert.ok(Math.abs(value - expected[i]) < tolerance, `${[...actual]} is not ${expected}`));

/** A square sheet of (n + 1)^2 vertices, 10 mm each way, facing z. */
function sheet(n, place = (x, y) => [x, y, 0]) {
  const position = [];
  const index = [];
  for (let j = 0; j <= n; j++) for (let i = 0; i <= n; i++) position.push(...place(10 * i, 10 * j));
  for (let j = 0; j < n; j++)
    for (let i = 0; i < n; i++) {
      const [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([x, y]) => y * (n + 1) + x);
      index.push(a, b, c, a, c, d);
    }
  return { position: Float32Array.from(position), index: Uint16Array.from(index), vertices: (n + 1) ** 2, smooth: null };
}

const turns = [
  { name: 'yaw', fap: 49, pivot: [0, 0, -50], axis: [0, 1, 0], radians: 1e-5 },
  { name: 'jaw', fap: 3, pivot: [0, 0, -10], axis: [1, 0, 0], radians: 0.001 },
  { name: 'pitch', fap: 48, pivot: [0, 0, -50], axis: [1, 0, 0], radians: 1e-5 },
];

/** A model of one part with the four corners of a square. */
function json(part) {
  return {
    format: 'faccia-head', version: 1, name: 'tiny', turns,
    fapu: { IRISD: 10.24, ES: 10.24, ENS: 10.24, MNS: 20.48, MW: 40.96 },
    parts: [
      {
        name: 'skin', material: 'skin', vertices: 4,
        position: { data: base64(Int16Array.of(0, 0, 0, 100, 0, 0, 100, 100, 0, 0, 100, 0)), scale: 0.1, offset: [0, 5, 0] },
        index: { data: base64(Uint16Array.of(0, 1, 2, 0, 2, 3)) },
        ...part,
      },
    ],
  };
}

function posed(part, faps) {
  const model = readModel(json(part));
  const drive = new Drive(model);
  const influences = influencesOf(model.parts[0], drive);
  drive.slotValues = new Float32Array(drive.slots.length);
  drive.set(faceValues(faps));
  return deform(model.parts[0], influences, drive);
}

const move = (fap, sign, vertex, delta) => ({
  fap, sign, vertices: base64(Uint16Array.of(vertex)), deltas: { data: base64(Int16Array.of(...delta)), scale: 0.001 },
});

test('positions are value times scale plus offset', () => {
  near(readModel(json({})).parts[0].position, [0, 5, 0, 10, 5, 0, 10, 15, 0, 0, 15, 0]);
});

test('rejects data that is not a head model', () => {
  assert.throws(() => readModel({ format: 'gltf' }), ModelError);
  assert.throws(() => readModel({ ...json({}), version: 2 }), ModelError);
  assert.throws(() => readModel(json({ turns: [{ turn: 'nose', weight: 1 }] })), ModelError);
});

test('a move is value times unit over 1024 times delta', () => {
  // FAP 5 is in MNS, here 20.48 mm: 100 units are 2 mm.
  const { position } = posed({ moves: [move(5, 'both', 1, [0, -1000, 500])] }, { 5: 100 });
  near(position, [0, 5, 0, 10, 3, 1, 10, 15, 0, 0, 15, 0]);
});

test('moves apply to values of their sign', () => {
  const moves = [move(5, 'positive', 1, [0, 1000, 0]), move(5, 'negative', 1, [1000, 0, 0])];
  near(posed({ moves }, { 5: 100 }).position.subarray(3, 6), [10, 7, 0]);
  near(posed({ moves }, { 5: -100 }).position.subarray(3, 6), [8, 5, 0]);
});

test('a turn rotates about its pivot, by its weight', () => {
  const list = [{ turn: 'jaw', vertices: base64(Uint16Array.of(0, 1)), weights: base64(Uint8Array.of(255, 51)) }];
  const { position } = posed({ turns: list }, { 3: 500 });
  const [jaw] = turns.filter(({ name }) => name === 'jaw');
  near(position.subarray(0, 3), turned([0, 5, 0], jaw, 0.5));
  near(position.subarray(3, 6), turned([10, 5, 0], jaw, 0.1));
  near(turned([0, 5, 0], jaw, 0.5), [0, 5 * Math.cos(0.5) - 10 * Math.sin(0.5), 5 * Math.sin(0.5) + 10 * Math.cos(0.5) - 10]);
});

test('the head turns last, pitch before yaw, regardless of the order in the file', () => {
  const list = [{ turn: 'yaw', weight: 1 }, { turn: 'pitch', weight: 1 }, { turn: 'jaw', weight: 1 }];
  const values = { 3: 200, 48: 20000, 49: 30000, 5: 100 };
  const { position } = posed({ turns: list, moves: [move(5, 'both', 2, [0, 0, 1000])] }, values);
  const [yaw, jaw, pitch] = turns;
  const shifted = turned([10, 15, 0], jaw, 0.2);
  shifted[2] += 2;
  near(position.subarray(6, 9), turned(turned(shifted, pitch, 0.2), yaw, 0.3));
});

test('normals of a displaced face are those of the displaced shape', () => {
  const flat = sheet(6);
  const rim = [...Array(49).keys()];
  const bulge = Int16Array.from(rim.flatMap((v) => [0, 0, 1000 * Math.exp(-(((v % 7) - 3) ** 2) / 4)]));
  const part = { ...flat, moves: [], turns: [] };
  part.moves.push({ fap: 5, sign: 'both', vertices: Uint16Array.from(rim), deltas: Float32Array.from(bulge, (d) => d / 1000) });
  const drive = new Drive({ parts: [part], turns: [], headTurns: 0, fapu: { MNS: 1024 } });
  const influences = influencesOf(part, drive);
  near(influences.normals.subarray(0, 3), [0, 0, 1]);
  for (const amount of [1, 2, 4]) {
    drive.set(faceValues({ 5: amount }));
    const { position, normal } = deform(part, influences, drive);
    const exact = new Normals({ ...flat, position }).rest;
    near(normal, exact, 0.06 * amount * amount ** 0.5);
  }
});

test('where neighbours turn by different angles the normals follow the shape', () => {
  const flat = sheet(6);
  const all = Uint16Array.from({ length: 49 }, (_, v) => v);
  const weights = Float32Array.from(all, (v) => Math.floor(v / 7) / 6);
  const part = { ...flat, moves: [], turns: [{ turn: 0, vertices: all, weights, weight: 1 }] };
  const drive = new Drive({ parts: [part], turns: [{ ...turns[1], pivot: [0, -40, -60] }], headTurns: 0, fapu: { MNS: 1024 } });
  const influences = influencesOf(part, drive);
  drive.slotValues = new Float32Array(drive.slots.length);
  drive.set(faceValues({ 3: 150 }));
  const { position, normal } = deform(part, influences, drive);
  near(normal, new Normals({ ...flat, position }).rest, 0.02);
});

test('vertices at a seam share their normal', () => {
  const roof = {
    position: Float32Array.of(-10, 0, 0, 0, 0, 10, 0, 10, 10, 0, 0, 10, 0, 10, 10, 10, 0, 0),
    index: Uint16Array.of(0, 1, 2, 3, 5, 4),
    smooth: Uint16Array.of(0, 1, 2, 1, 2, 5),
    vertices: 6,
  };
  const { rest } = new Normals(roof);
  near(rest.subarray(3, 6), [0, 0, 1]);
  near(rest.subarray(9, 12), [0, 0, 1]);
  const moved = roof.position.slice();
  moved[0] += 5;
  const changed = new Normals(roof).displaced([0], moved);
  assert.deepEqual([...changed.keys()].sort(), [0, 1, 2, 3, 4], 'on both sides of the seam');
  assert.deepEqual(changed.get(1), changed.get(3));
});

test('the packed influences match the lists', () => {
  const turnsOf = (...pairs) => pairs.map(([turn, weight]) => ({ turn, weight }));
  const lists = {
    moves: [[], [{ slot: 3, delta: [1, 2, 3], normal: [4, 5, 6] }], [{ slot: 1, delta: [7, 8, 9], normal: [0, 0, 1] }]],
    turns: [turnsOf([0, 0.5], [1, 1], [2, 1]), turnsOf([1, 1], [2, 1]), turnsOf([0, 0.5], [1, 0.25], [2, 1])],
  };
  const { vertices, data, width, height, needs } = packInfluences(lists, { firstHeadTurn: 1, turns });
  assert.deepEqual(needs, { MOVES: 1, OWN_TURNS: 1, PARTIAL_HEAD: 1 });
  assert.equal(data.length, 4 * width * height);
  const texel = (i) => [...data.subarray(4 * i, 4 * i + 4)];
  lists.moves.forEach((list, v) => {
    const [first, count] = vertices.subarray(4 * v);
    assert.equal(count, list.length);
    list.forEach(({ slot, delta, normal }, i) => {
      assert.deepEqual(texel(first + 2 * i), [slot, ...delta]);
      assert.deepEqual(texel(first + 2 * i + 1).slice(1), normal);
    });
  });
  lists.turns.forEach((list, v) => {
    const [, , first, counts] = vertices.subarray(4 * v);
    list.forEach(({ turn, weight }, i) => assert.deepEqual(texel(first + i), [turn, weight, 0, 0]));
    assert.equal(counts % 64, list.filter(({ turn }) => turn === 0).length);
    assert.equal(Math.floor(counts / 64), v === 2 ? 2 : WHOLE_HEAD);
  });
});

test('geometry above a point shades it', () => {
  const ground = sheet(4, (x, y) => [x - 20, 0, 20 - y]);
  const roof = sheet(4, (x, y) => [x - 20, 8, y - 20]);
  const up = (value, count) => Float32Array.from({ length: 3 * count }, (_, i) => (i % 3 === 1 ? value : 0));
  const part = (one, normal, shades, airy = false) => ({ ...one, shades, airy, seen: { position: one.position, normal } });
  const bake = (...parts) => {
    const work = bakeOcclusion(parts);
    for (;;) {
      const { done, value } = work.next();
      if (done) return value[0];
    }
  };
  const middle = 4 * 12;
  const open = bake(part(ground, up(1, 25), true));
  assert.ok(open[middle] > 250 && open[middle + 1] > 250);
  const covered = bake(part(ground, up(1, 25), true), part(roof, up(1, 25), true));
  assert.ok(covered[middle] < 60, `sky ${covered[middle]}`);
  assert.ok(covered[0] > covered[middle] + 60, 'more at the corner');
  assert.deepEqual(bake(part(ground, up(1, 25), true), part(roof, up(1, 25), false)), open, 'unless it is thin');
  const hair = (height) => part(sheet(4, (x, y) => [x - 20, height, y - 20]), up(1, 25), true, true);
  const near = bake(part(ground, up(1, 25), true), hair(8));
  assert.ok(near[middle] > covered[middle] + 40 && near[middle] < open[middle] - 40, `below hair ${near[middle]}`);
  assert.ok(near[middle + 1] > 40, `of the lamp ${near[middle + 1]}`);
  assert.ok(throughHair(1) < 1 && throughHair(1) > throughHair(12) && throughHair(12) > throughHair(40) && throughHair(40) === 0);
  const self = bake(part(ground, up(1, 25), true, true), hair(8));
  assert.deepEqual(self, covered, 'hair shades hair as all else does');
});

test('loads the model over HTTP from the host of the stream', () => {
  assert.equal(httpBase('ws://here:8080/v1/stream?lang=it'), 'http://here:8080/v1/');
  assert.equal(httpBase('wss://here/faccia/v1/stream'), 'https://here/faccia/v1/');
});

test('joins a model from the parts of the stream', () => {
  const parts = [
    { index: 0, count: 3, kind: 'head', part: 'tiny', data: { name: 'tiny' } },
    { index: 1, count: 3, kind: 'texture', part: 'skin', data: { type: 'image/webp' } },
    { index: 2, count: 3, kind: 'part', part: 'skin', data: { name: 'skin' } },
  ];
  const assembler = new ModelAssembler();
  assert.equal(assembler.take(parts[2]), null, 'the rest of another');
  assert.deepEqual(parts.map((part) => assembler.take(part)).at(-1), {
    name: 'tiny',
    textures: { skin: { type: 'image/webp' } },
    parts: [{ name: 'skin' }],
  });
});

const feed = (governor, interval, frames) => {
  let changes = 0;
  for (let i = 0; i < frames; i++) changes += governor.frame(interval);
  return changes;
};

test('lowers quality while frames are slow, and keeps it while they are fast', () => {
  const governor = new Governor('auto');
  assert.equal(governor.level, LEVELS[0]);
  feed(governor, 1000 / 60, 100);
  assert.equal(governor.index, 0);
  feed(governor, 45, 23);
  assert.equal(governor.index, 1);
  feed(governor, 130, 23);
  assert.equal(governor.index, 3, 'very slow: two steps');
  feed(governor, 1000 / 30, 2000);
  assert.equal(governor.index, 3);
});

test('raises it again when frames are fast, without oscillating', () => {
  const governor = new Governor('auto');
  feed(governor, 45, 30);
  assert.equal(feed(governor, 1000 / 60, 320), 1);
  assert.equal(governor.index, 0);
  feed(governor, 45, 30);
  assert.equal(governor.index, 1);
  assert.equal(feed(governor, 1000 / 60, 320), 0, 'more patient the second time');
});

test('reacts at once to very slow frames, and starts low without a graphics processor', () => {
  const governor = new Governor('auto');
  assert.equal(feed(governor, 400, 8), 1);
  assert.equal(governor.index, 2);
  assert.equal(new Governor('auto', true).level.fine, false);
  assert.equal(new Governor('high', true).level.fine, true);
});

test('goes below low only where frames then come sooner', () => {
  const lost = new Governor('auto', true);
  feed(lost, 60, 25);
  assert.equal(lost.level.name, 'lowest');
  feed(lost, 58, 25);
  assert.equal(lost.level.name, 'low', 'nothing was gained');
  assert.equal(feed(lost, 60, 500), 0, 'and it is not tried again');
  const won = new Governor('auto', true);
  feed(won, 60, 25);
  assert.equal(feed(won, 40, 500), 0);
  assert.equal(won.level.name, 'lowest');
  const far = new Governor('auto');
  feed(far, 200, 10);
  assert.equal(far.index, 2);
  feed(far, 200, 10);
  assert.equal(far.level.name, 'low', 'what low takes is seen first');
});

test('keeps a selected quality', () => {
  for (const wish of ['low', 'high']) {
    const governor = new Governor(wish);
    const { level } = governor;
    feed(governor, 200, 200);
    assert.equal(governor.level, level);
    assert.equal(level.fine, wish === 'high');
  }
});
