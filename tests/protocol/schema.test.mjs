// SPDX-License-Identifier: GPL-3.0-or-later
// The schemas against the examples of the written protocol: what the client sends there is valid, or is there to be
// refused; the server's messages stand there with some of their members.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { violations } from '../lib/schema.mjs';

const read = (name) => fs.readFileSync(new URL(`../../protocol/${name}`, import.meta.url), 'utf8');
const examples = [...read('README.md').matchAll(/```stream\n([^]*?)```/g)].map((match) => match[1]);
const messages = (sign) =>
  examples.flatMap((text) =>
    [...text.matchAll(new RegExp(`^${sign} (\\{.*\\})$`, 'gm'))].map((match) => JSON.parse(match[1])),
  );

for (const name of ['client', 'server', 'head-model', 'timed', 'pictures', 'scene', 'questionnaire', 'library', 'avatar-map'])
  test(`${name} is a strict schema of draft 2020-12`, () => {
    const schema = JSON.parse(read(`schema/${name}.json`));
    const ajv = new Ajv({ strict: true, strictTypes: false, strictRequired: false });
    assert.ok(ajv.validateSchema(schema), ajv.errorsText());
    ajv.compile(schema);
  });

test('the client examples are valid', () => {
  const sent = messages('>');
  assert.ok(sent.length >= 4);
  for (const message of sent) {
    const wrong = violations('client', message);
    const refused = message.type === 'dance' || message.room === 'no spaces' || message.name === '../secret' || message.choices?.includes(7) || message.consent === 'perhaps' || message.codec === 'shellac' || message.featurePointsCoord?.['8.11'];
    assert.equal(wrong === null, !refused, `${JSON.stringify(message)}: ${wrong}`);
  }
});

/** The members of the server's messages, with values for members that an example omits. */
const whole = {
  pong: {},
  phone: { stream: 's', utterance: 1, time: 0, sample: 0, duration: 1, ipa: 'a' },
  mark: { stream: 's', utterance: 1, time: 0, sample: 0, name: 'x' },
  paused: { stream: 's', utterance: 1, time: 0, sample: 0 },
  resumed: { stream: 's', utterance: 1, time: 0, sample: 0 },
  jumped: { stream: 's', utterance: 1, time: 0, sample: 0, mark: 'x' },
  joined: { room: 'x', followers: 1, may_speak: true },
  left: { room: 'x' },
  authorized: { subject: 'x' },
  choices: { stream: 's', choices: ['x'] },
  chosen: { stream: 's', choice: 0, text: 'x', by: 'x' },
  asked: { stream: 's', id: 'x', question: 'x', seconds: 1 },
  answered: { stream: 's', id: 'x', reason: 'chosen', text: 'x', choice: 0, by: 'x' },
  heard: { stream: 's', id: 'x', text: 'x', final: true, by: 'x' },
  state: { stream: 's', state: 'idle' },
  calibrated: { stream: 's' },
  lexicon: { stream: 's', lexicon: '' },
  expressed: { stream: 's', mix: [] },
  driven: { stream: 's', on: true, by: 'x' },
  consent: { stream: 's', consent: 'asked', by: 'x', recorded: false },
  observers: { stream: 's', observers: [], count: 0 },
  begin: { stream: 's', utterance: 1, rate: 22050, fps: 25, voice: 'v', lang: 'it', engine: 'dominance', markup: 'plain', idle: 0 },
  sentence: {
    stream: 's',
    text: 'A',
    utterance: 1,
    time: 0,
    sample: 0,
    duration: 1,
    start: 0,
    end: 1,
    utf16_start: 0,
    utf16_end: 1,
  },
  word: {
    stream: 's',
    utterance: 1,
    time: 0,
    sample: 0,
    duration: 1,
    start: 0,
    end: 1,
    utf16_start: 0,
    utf16_end: 1,
    text: 'x',
  },
  end: { stream: 's', utterance: 1, reason: 'done', duration: 1 },
  speaker: { stream: 's', utterance: 1, time: 0, sample: 0, speaker: 'a', name: 'A' },
  error: { code: 'bad-json', message: 'x', byte: 0, line: 1, column: 1 },
  warning: { stream: 's', utterance: 1, code: 'ignored', message: 'x' },
};

test('the server examples are valid', () => {
  const answers = messages('<');
  assert.ok(answers.length >= 10);
  for (const message of answers) {
    const shown = Object.fromEntries(Object.entries(message).filter(([, value]) => value !== '...'));
    for (const name of Object.keys(message))
      // "..." stands for an existing member
      assert.ok(name in shown || name in whole[message.type], `${message.type} ${name}`);
    assert.equal(violations('server', { ...whole[message.type], ...shown }), null, JSON.stringify(message));
  }
});

// Messages that a client must not send: tests/corpus/client.
const refused = {
  server: [
    { type: 'end', stream: 's1', utterance: 1, reason: 'bored', duration: 1 },
    { type: 'pong', extra: 1 },
    { ...whole.chosen, type: 'chosen', choice: -1 },
    { ...whole.state, type: 'state', state: 'dancing' },
    { ...whole.consent, type: 'consent', consent: 'perhaps' },
    { ...whole.expressed, type: 'expressed', mix: [{ name: 'joy', intensity: 2 }] },
    { ...whole.observers, type: 'observers', observers: ['x'] },
    { ...whole.choices, type: 'choices', choices: [1] },
    { ...whole.word, type: 'word', text: undefined },
    { ...whole.word, type: 'word', time: -1 },
    { ...whole.begin, type: 'begin', utterance: 0 },
    { type: 'error', code: 'Bad Code', message: 'x' },
    { type: 'error', code: 'x', message: 'x', line: 3 },
    { type: 'error', code: 'x', message: 'x', stream: 's' },
    { type: 'paused', stream: 's', utterance: 1 },
    { type: 'jumped', stream: 's', utterance: 1, time: 0, sample: 0 },
    { ...whole.begin, type: 'begin', play: 'x' },
  ],
};
for (const [name, list] of Object.entries(refused))
  test(`the ${name} schema rejects whatever is not in the protocol`, () => {
    for (const message of list) assert.ok(violations(name, message), JSON.stringify(message));
  });

const vector = [0, 0, 0];
const head = () => ({
  format: 'faccia-head',
  version: 1,
  name: 'mara',
  title: 'Mara',
  licence: 'CC0-1.0',
  credits: ['somebody'],
  fapu: { IRISD: 11.9, ES: 62, ENS: 49, MNS: 21, MW: 50 },
  fdp: { 2.1: [0, -92.4, 71.2], '2.10': vector },
  view: { target: vector, distance: 620, fov: 26 },
  turns: [{ name: 'jaw', fap: 3, pivot: vector, axis: [1, 0, 0], radians: 0.0123 }],
  textures: { skin: { type: 'image/webp', width: 1024, height: 1024, data: 'AAAA' } },
  materials: {
    skin: {
      texture: 'skin',
      color: [1, 1, 1],
      roughness: 0.6,
      specular: 0.3,
      alpha: 'opaque',
      double_sided: false,
    },
  },
  parts: [
    {
      name: 'skin',
      material: 'skin',
      vertices: 3,
      triangles: 1,
      position: { data: 'AAAA', scale: 0.005, offset: vector },
      uv: { data: 'AAAA' },
      index: { data: 'AAAA' },
      smooth: { data: 'AAA=' },
      moves: [{ fap: 5, sign: 'both', vertices: 'AAAA', deltas: { data: 'AA==', scale: 0.0001 } }],
      turns: [
        { turn: 'jaw', vertices: 'AAAA', weights: 'AAAA' },
        { turn: 'jaw', weight: 1 },
      ],
    },
  ],
});

test('the schema of the head model accepts a head and rejects a damaged one', () => {
  assert.equal(violations('head-model', head()), null);
  const damages = [
    (h) => delete h.fapu.MNS,
    (h) => (h.fapu.MNS = 0),
    (h) => (h.fdp.chin = vector),
    (h) => (h.version = 2),
    (h) => (h.parts = []),
    (h) => (h.turns[0].fap = 2),
    (h) => (h.turns[0].pivot = [0, 0]),
    (h) => (h.materials.skin.alpha = 'glass'),
    (h) => delete h.parts[0].position.scale,
    (h) => (h.parts[0].index.data = '*'),
    (h) => (h.parts[0].moves[0].sign = 'up'),
    (h) => (h.parts[0].turns[1].vertices = 'AAAA'),
    (h) => delete h.parts[0].turns[0].weights,
    (h) => (h.parts[0].colour = 1),
  ];
  for (const damage of damages) {
    const damaged = head();
    damage(damaged);
    assert.ok(violations('head-model', damaged), String(damage));
  }
});
