// SPDX-License-Identifier: GPL-3.0-or-later
// MPEG-4's FDP node with its animation table: a head written as VRML, BIFS text and XMT-A comes back with the same actions; somebody else's
// table, with bends, in other units and in either reading of its negative intervals; errors; a calibration from an FDP.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test, { after } from 'node:test';
import { ARKIT, VISEMES } from '../../models/tools/avatar/shapes.mjs';
import { Budget, FileError } from '../../models/tools/import/limits.mjs';
import { readVrml } from '../../models/tools/import/formats/read-vrml.mjs';
import { checkEyelids, checkNeutral } from '../../models/tools/lib/check.mjs';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { FAPS } from '../../models/tools/lib/faps.mjs';
import { Drive } from '../../web/element/head/mesh/influences.mjs';
import { readModel } from '../../web/element/head/model/model.mjs';
import { models } from '../lib/built-heads.mjs';

const build = process.env.FACCIA_BUILD ?? new URL('../../build', import.meta.url).pathname;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-fdp-'));
after(() => fs.rmSync(folder, { recursive: true }));
const at = (name) => path.join(folder, name);
const maraFile = path.join(models, 'heads/mara.json');
const load = (file) => unpack(JSON.parse(fs.readFileSync(file, 'utf8')));
const mara = load(maraFile);
const faccia = (...words) => spawnSync(path.join(build, 'server/cli/faccia'), ['--models', models, 'head', ...words], { encoding: 'utf8', cwd: folder });

function well(...words) {
  const { status, stdout, stderr } = faccia(...words);
  assert.equal(status, 0, stderr);
  return stdout;
}

function imported(file, ...more) {
  const said = well('import', at(file), '--name', 'guest', '-o', at('guest.json'), ...more);
  const json = JSON.parse(fs.readFileSync(at('guest.json'), 'utf8'));
  readModel(json);
  return { head: unpack(json), json, said };
}

const vertexAt = (list, v) => [list[3 * v], list[3 * v + 1], list[3 * v + 2]];
const far = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);

/** For each vertex of a part those of another at the same place, when `shift` is added: their order may be another. */
function pairs(a, b, shift) {
  const cells = new Map();
  const cell = (p, d = [0, 0, 0]) => p.map((x, k) => Math.floor(x / 0.5) + d[k]).join();
  for (let v = 0; v < b.position.length / 3; v++) {
    const key = cell(vertexAt(b.position, v));
    (cells.get(key) ?? cells.set(key, []).get(key)).push(v);
  }
  const around = [-1, 0, 1];
  return Array.from({ length: a.position.length / 3 }, (_, v) => {
    const p = vertexAt(a.position, v).map((x, k) => x + shift[k]);
    const found = around.flatMap((x) => around.flatMap((y) => around.flatMap((z) => cells.get(cell(p, [x, y, z])) ?? []))).filter((w) => far(p, vertexAt(b.position, w)) < 0.02);
    return found;
  });
}

/** Largest distance of a part's vertices in a pose, mm. */
function apart(a, b, name, faps, matched, shift) {
  const [p, q] = [a, b].map((head) => pose(head, head.parts.find((part) => part.name === name), faps));
  return matched.reduce((most, list, v) => {
    const wanted = vertexAt(p, v).map((x, k) => x + shift[k]);
    return Math.max(most, Math.min(...list.map((w) => far(wanted, vertexAt(q, w)))));
  }, 0);
}

test('a head written with its animation table comes back as it was, in three forms', (t) => {
  const [first, ...others] = ['wrl', 'bt', 'xmt'].map((form) => {
    well('fdp', maraFile, '-o', at(`mara.${form}`));
    const { head, json, said } = imported(`mara.${form}`);
    assert.match(said, /actions of 6\d FAPs from its animation table/, form);
    return { head, text: JSON.stringify({ ...json, title: '' }) };
  });
  for (const other of others) assert.equal(other.text === first.text, true, 'the forms hold the same');
  const { head } = first;
  assert.deepEqual(head.parts.map(({ name }) => name).sort(), mara.parts.map(({ name }) => name).sort());
  assert.ok(head.textures.skin.data === mara.textures.skin.data);
  assert.deepEqual(['skin', 'hair', 'lashes'].map((name) => head.materials[name].alpha), ['opaque', 'cutout', 'blend']);
  for (const [unit, value] of Object.entries(mara.fapu)) assert.ok(Math.abs(head.fapu[unit] - value) < 0.01, unit);
  const shift = head.fdp['9.3'].map((x, k) => x - mara.fdp['9.3'][k]);
  let [worst, count] = [{ most: 0 }, 0];
  for (const name of ['skin', 'mouth', 'tongue', 'teeth_lower', 'lashes', 'brows', 'eye_l', 'eye_r']) {
    const matched = pairs(mara.parts.find((part) => part.name === name), head.parts.find((part) => part.name === name), shift);
    assert.ok(matched.every((list) => list.length), `${name}: every vertex is there`);
    for (const [shape, faps] of Object.entries({ ...ARKIT, ...VISEMES, wide: { 3: 900, 5: -500, 4: -200 }, eyes: { 23: 30000, 24: 30000, 25: -20000, 26: -20000 }, blink: { 19: 900, 20: 900 } })) {
      const most = apart(mara, head, name, Object.fromEntries(Object.entries(faps).filter(([fap]) => !FAPS[fap]?.headTurn)), matched, shift);
      count++;
      if (most > worst.most) worst = { most, name, shape };
    }
  }
  t.diagnostic(`${count} poses of parts: at most ${worst.most.toFixed(2)} mm off (${worst.name}, ${worst.shape})`);
  assert.ok(worst.most < 1, `${worst.name} ${worst.shape}`);
  assert.deepEqual([...checkNeutral(head), ...checkEyelids(head)], []);
});

// ---- a stranger's file: centimetres, z up, everything in one set but the eyes, tables before the meshes, a transform with a scale ----

const BORDERS = [-400, 0, 200, 600];
const POINTS = Object.entries({ 2: 14, 3: 14, 4: 6, 5: 4, 6: 4, 7: 1, 8: 10, 9: 15, 10: 10, 11: 6 }).flatMap(([group, count]) => Array.from({ length: count }, (_, i) => `${group}.${i + 1}`));
const toFile = ([x, y, z]) => [x / 10, -z / 10, y / 10 + 150]; // z up, the face to -y
const words = (list) => list.map((x) => Number(x.toFixed(6))).join(' ');

/** Vectors of a bend for each interval, in the axes of a head. */
const vectorOf = (v, j) => [0.01 * (v % 7), 0.2 * j + 0.3, 0.05 * (v % 3) - 0.02 * j];

function strangeScene({ slopes, fap = 5, borders = BORDERS, more = '' }) {
  const skin = mara.parts.find(({ name }) => name === 'skin');
  const vertices = Array.from({ length: 40 }, (_, i) => 50 * i + 3);
  const displacements = vertices.flatMap((v) => borders.slice(1).flatMap((_, j) => {
    const d = vectorOf(v, j).map((x) => (borders[j] < 0 && !slopes ? -x : x));
    return [d[0], -d[2], d[1]];
  }));
  const shape = ({ name, position, index }) => `Shape { geometry DEF ${name} IndexedFaceSet {
    coord Coordinate { point [ ${Array.from({ length: position.length / 3 }, (_, v) => words(toFile(vertexAt(position, v)))).join(', ')} ] }
    coordIndex [ ${Array.from({ length: index.length / 3 }, (_, i) => `${index.slice(3 * i, 3 * i + 3).join(' ')} -1`).join(' ')} ] } }`;
  const [left, right] = ['eye_l', 'eye_r'].map((name) => mara.parts.find((part) => part.name === name));
  return {
    vertices,
    text: `#VRML V2.0 utf8
Face { fdp FDP {
  featurePointsCoord Coordinate { point [ ${POINTS.map((name) => (mara.fdp[name] ? words(toFile(mara.fdp[name])) : '1e38 1e38 1e38')).join(', ')} ] }
  faceDefTables [
    FaceDefTables { fapID ${fap} faceDefMesh FaceDefMesh { faceSceneGraphNode USE skin
      intervalBorders [ ${borders.join(', ')} ] coordIndex [ ${vertices.join(' ')} ] displacements [ ${words(displacements)} ] } }
    FaceDefTables { fapID 23 faceDefTransform [ FaceDefTransform { faceSceneGraphNode USE Turning fieldId 1 rotationDef 0 0 1 2 } ] }
    FaceDefTables { fapID 1 highLevelSelect 3 }
    ${more}
  ]
  faceSceneGraph [ ${shape(skin)} DEF Turning Transform { center ${words(toFile([31, 0, 0]))} children [ ${shape(left)} ] } ${shape(right)} ]
} }`,
  };
}

/** Where the standard has a vertex go, mm: by its sum over intervals. */
function byRule(v, value, unit, borders = BORDERS) {
  const zero = borders.indexOf(0);
  const out = [0, 0, 0];
  for (let j = 0; j + 1 < borders.length; j++) {
    const low = j === 0 ? -Infinity : borders[j];
    const high = j + 2 === borders.length ? Infinity : borders[j + 1];
    const part = j >= zero ? Math.max(0, Math.min(value, high) - borders[j]) : Math.min(0, Math.max(value, low) - borders[j + 1]);
    vectorOf(v, j).forEach((x, k) => (out[k] += x * part * unit));
  }
  return out;
}

test('takes a table of somebody else: bends, units, axes, and turned Transforms', () => {
  for (const slopes of [true, false]) {
    const { text, vertices } = strangeScene({ slopes });
    fs.writeFileSync(at('guest.wrl'), text);
    const { head, json, said } = imported('guest.wrl', '--up', 'z', '--unit', 'cm');
    assert.match(said, /actions of 2 FAPs from its animation table/);
    assert.match(said, /visemes and expressions of the animation table/);
    const skin = head.parts.find(({ name }) => name === 'skin');
    const shift = head.fdp['9.3'].map((x, k) => x - mara.fdp['9.3'][k]);
    const rest = mara.parts.find(({ name }) => name === 'skin').position;
    const unit = head.fapu.MNS / 1024;
    const model = readModel(json);
    for (const value of [-900, -400, -100, 0, 100, 200, 350, 600, 1000]) {
      const posed = pose(head, skin, { 5: value });
      const slots = new Drive(model).set(Float32Array.from({ length: 69 }, (_, n) => (n === 5 ? value : 0)));
      for (const v of vertices) {
        const p = vertexAt(rest, v).map((x, k) => x + shift[k]);
        const own = Array.from({ length: skin.position.length / 3 }, (_, w) => w).filter((w) => far(vertexAt(skin.position, w), p) < 0.02);
        const goal = byRule(v, value, unit).map((x, k) => x + p[k]);
        assert.ok(own.some((w) => far(vertexAt(posed, w), goal) < 0.05), `vertex ${v} at ${value}, slopes ${slopes}`);
        const w = own.find((one) => far(vertexAt(posed, one), goal) < 0.05);
        const page = [0, 0, 0]; // as the page's numbers have it
        for (const move of model.parts.find(({ name }) => name === 'skin').moves.filter(({ fap }) => fap === 5)) {
          const i = move.vertices.indexOf(w);
          const amount = slots.slotValues[slots.slot(5, move.sign, move.from)];
          if (i >= 0) for (let k = 0; k < 3; k++) page[k] += amount * move.deltas[3 * i + k];
        }
        assert.ok(far(page, byRule(v, value, unit)) < 0.05, `the page: vertex ${v} at ${value}`);
      }
    }
    const eye = head.parts.find(({ name }) => name === 'eye_l');
    const turn = head.turns.find(({ fap, name }) => fap === 23 && name.startsWith('table'));
    assert.ok(Math.abs(turn.radians - 2e-5) < 1e-9 && far(turn.axis, [0, 1, 0]) < 1e-6 && far(turn.pivot, [31 + shift[0], shift[1], shift[2]]) < 0.1, JSON.stringify(turn));
    assert.deepEqual(eye.turns.filter((one) => head.turns.find(({ name }) => name === one.turn).fap === 23).map((one) => one.turn), [turn.name]);
    assert.ok(skin.turns.some((one) => one.turn === 'jaw'), 'what the table does not say comes from zones');
  }
});

test('reports what is wrong with a table at its line', () => {
  const small = (tables, set = 'geometry DEF S IndexedFaceSet { coord Coordinate { point [0 0 0 1 0 0 0 1 0] } coordIndex [0 1 2 -1] }') =>
    `#VRML V2.0 utf8\nFDP {\n faceDefTables [\n${tables}\n]\n faceSceneGraph [ DEF T Transform { children [ Shape { ${set} } ] } ] }`;
  const table = (borders, vertices, displacements, of = 'USE S') => `FaceDefTables { fapID 5 faceDefMesh FaceDefMesh { faceSceneGraphNode ${of}\n intervalBorders [${borders}] coordIndex [${vertices}] displacements [${displacements}] } }`;
  const cases = [
    [small(table('0 0', '0', '1 0 0')), /line \d: FaceDefMesh of FAP 5: intervalBorders must increase/],
    [small(table('5 9', '0', '1 0 0')), /line \d: FaceDefMesh of FAP 5: one of intervalBorders must be 0/],
    [small(table('0 9', '0 1', '1 0 0')), /line \d: FaceDefMesh of FAP 5: displacements must have a vector for each interval of each vertex/],
    [small(table('0 9', '3', '1 0 0')), /line \d: coordIndex must be of the 3 points of the set/],
    [small(table('0 9', '0', '1 0 0', 'USE T')), /line 4: faceSceneGraphNode must be an IndexedFaceSet of the face/],
    [small(table('0 9', '0', '1 0 0', 'USE Nobody')), /line 4: faceSceneGraphNode must be an IndexedFaceSet of the face/],
    [small('FaceDefTables { fapID 69 }'), /line 4: fapID must be a FAP, 1 to 68/],
    ['#VRML V2.0 utf8\nFDP { featurePointsCoord Coordinate { point [0 0 0] } faceSceneGraph [ Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0 1 0 0 0 1 0] } coordIndex [0 1 2 -1] } } ] }', /an FDP has 84 feature points, of 3 numbers each/],
    ['<XMT-A><Body><FDP><faceDefTables></FDP></Body></XMT-A>', /line 1: <\/FDP> closes nothing/],
    ['<XMT-A>\n<Body>\n<Shape USE="x"/></Body></XMT-A>', /line 3: USE x: there is no such node/],
  ];
  for (const [text, message] of cases) {
    const name = text[0] === '<' ? 'bad.xmt' : 'bad.wrl';
    fs.writeFileSync(at(name), text);
    const { status, stderr } = faccia('import', at(name), '-o', at('bad.json'));
    assert.equal(status, 1, text);
    assert.match(stderr, message);
    assert.ok(!fs.existsSync(at('bad.json')));
  }
});

test('takes the scene of a file as MPEG-4 programs write it: descriptors before it, commands around and after it', () => {
  const shape = '{ geometry IndexedFaceSet { coord Coordinate { point [0 0 0 1 0 0 0 1 0] } coordIndex [0 1 2 -1] solid false } }';
  const descriptor = 'InitialObjectDescriptor {\n objectDescriptorID 1\n esDescr [ ES_Descriptor { ES_ID 1 decConfigDescr DecoderConfigDescriptor { decSpecificInfo BIFSConfig { isCommandStream true } } } ]\n}\n';
  const element = '<Shape><geometry><IndexedFaceSet coordIndex="0 1 2 -1"><coord><Coordinate point="0 0 0 1 0 0 0 1 0"/></coord></IndexedFaceSet></geometry></Shape>';
  const scenes = {
    'plain.bt': `${descriptor}OrderedGroup { children [ DEF B Background2D { url [od:10] } Shape ${shape} ] }\nAT 2000 { REPLACE B BY Shape ${shape} }\n`,
    'command.bt': `${descriptor}RAP AT 0 {\n REPLACE SCENE BY OrderedGroup { children [ DEF S Shape ${shape} ] }\n ROUTE S.a TO S.b\n}\nAT D200 { APPEND TO S.children Shape ${shape} }\n`,
    'scene.xmt': `<?xml version="1.0"?>\n<XMT-A xmlns="urn:mpeg:mpeg4:xmta:schema:2002">\n<Header><InitialObjectDescriptor binaryID="1" ><Descr><esDescr><ES_Descriptor ES_ID='es1'/></esDescr></Descr></InitialObjectDescriptor></Header><Body><Replace><Scene>
      <ProtoDeclare name="P">${element}</ProtoDeclare><OrderedGroup><children>${element}</children></OrderedGroup></Scene></Replace><par begin="2"><Insert atNode="G" position="END">${element}</Insert><Replace atNode="S">${element}</Replace></par></Body></XMT-A>`,
  };
  for (const [name, text] of Object.entries(scenes)) assert.equal(readVrml(name, Buffer.from(text), new Budget()).meshes.length, 1, name);
});

test('survives damaged scenes: any change is read or refused in bounded work', () => {
  const scene = `Face { fdp FDP { featurePointsCoord Coordinate { point [${POINTS.map((_, i) => `${i} 0 1`).join(' ')}] } faceDefTables [ FaceDefTables { fapID 3 faceDefMesh [ FaceDefMesh { faceSceneGraphNode USE S intervalBorders [-9 0 9] coordIndex [0 2] displacements [1 0 0 0 1 0 0 0 1 1 1 1] } ]
    faceDefTransform FaceDefTransform { faceSceneGraphNode USE T fieldId 1 rotationDef 1 0 0 1 } } ] faceSceneGraph [ DEF T Transform { center 1 2 3 children [ Shape { geometry DEF S IndexedFaceSet { coord Coordinate { point [0 0 0 1 0 0 0 1 0] } coordIndex [0 1 2 -1] } } ] } ] } }`;
  const xml = `<XMT-A><Body><Face><fdp><FDP><faceDefTables><FaceDefTables fapID="3"><faceDefMesh><FaceDefMesh intervalBorders="-9 0 9" coordIndex="0 2" displacements="1 0 0 0 1 0 0 0 1 1 1 1"><faceSceneGraphNode><IndexedFaceSet USE="S"/></faceSceneGraphNode></FaceDefMesh></faceDefMesh></FaceDefTables></faceDefTables>
    <faceSceneGraph><Transform DEF="T"><children><Shape><geometry><IndexedFaceSet DEF="S" coordIndex="0 1 2 -1"><coord><Coordinate point="0 0 0 1 0 0 0 1 0"/></coord></IndexedFaceSet></geometry></Shape></children></Transform></faceSceneGraph></FDP></fdp></Face></Body></XMT-A>`;
  let state = 7;
  const dice = (below) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
  let [read, refused] = [0, 0];
  for (let i = 0; i < 4000; i++) {
    let text = [scene, xml][i % 2];
    const bits = text.split(/(?<=[\s<>"[\]{}])/);
    for (let k = dice(2); k >= 0; k--) {
      const from = dice(bits.length);
      const [what, to] = [dice(9) % 5, dice(bits.length)];
      if (what === 0) bits.splice(from, 1 + dice(6));
      else if (what === 1) bits.splice(to, 0, ...bits.slice(from, from + 1 + dice(20)));
      else if (what === 2) bits[from] = ['-1 ', '1e39 ', 'NaN ', '0 ', '99999999999 ', 'USE T ', 'NULL ', '[ ', '} ', '<', '"'][dice(11)];
      else if (what === 3) [bits[from], bits[to]] = [bits[to], bits[from]];
      else bits.length = from;
      if (!bits.length) bits.push(' ');
    }
    text = bits.join('');
    try {
      readVrml(i % 2 ? 'a.xmt' : 'a.bt', Buffer.from(text), new Budget({ numbers: 1e5, steps: 1e6 }));
      read++;
    } catch (error) {
      assert.ok(error instanceof FileError || error instanceof TypeError || error instanceof RangeError, `${error.stack}\n${text}`); // as readScene takes them
      refused++;
    }
  }
  assert.ok(read > 200 && refused > 200, `${read} read, ${refused} refused`);
});

test('a head takes the feature points of an FDP, of any unit', () => {
  const wide = Object.fromEntries(Object.entries(mara.fdp).map(([name, [x, y, z]]) => [name, [['8.3', '2.4'].includes(name) ? x + 3 : ['8.4', '2.5'].includes(name) ? x - 3 : x, y, z]]));
  fs.writeFileSync(at('wide.bt'), `Group { children [ Face { fdp FDP { featurePointsCoord Coordinate { point [ ${POINTS.map((name) => (wide[name] ? words(wide[name].map((x) => x / 1000 + 1)) : '3.4e38 3.4e38 3.4e38')).join(' ')} ] } } } ] }\n`);
  well('calibrate', maraFile, '--points', at('wide.bt'), '-o', at('wide.json'));
  const head = load(at('wide.json'));
  assert.ok(Math.abs(head.fapu.MW - mara.fapu.MW - 6) < 0.1, `${head.fapu.MW} ${mara.fapu.MW}`);
  const { status, stderr } = faccia('calibrate', maraFile, '--points', at('mara.wrl').replace('mara', 'none'));
  assert.equal(status, 1);
  assert.match(stderr, /none\.wrl/);
});
