// SPDX-License-Identifier: GPL-3.0-or-later
// The schema of client messages and the daemon must agree: both refuse the same messages of tests/corpus/client, and the same variants
// of valid messages that are damaged in one place.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { damages, edited } from '../../lib/damage.mjs';
import { Daemon, root } from '../../lib/daemon.mjs';
import { agrees, corpus, schema } from '../../lib/verdicts.mjs';

const refused = schema('protocol/schema/client.json');

/** A valid message of each type. */
const messages = [
  { type: 'speak', text: 'Uno.', id: 'a', lang: 'it', voice: 'espeak:it', engine: 'dominance', markup: 'plain', life: 1, blend: 'regions', rate: 120, pitch: 1, volume: 1, fps: 25, still: false, seed: 1, mode: 'replace', phones: true, gender: 'female', contacts: 'on', priority: 'chat', topic: 't', bell: true, again: true },
  { type: 'stop' },
  { type: 'pause' },
  { type: 'resume' },
  { type: 'rate', rate: 120 },
  { type: 'idle', on: true, life: 1, seed: 2 },
  { type: 'express', mix: [{ name: 'joy', intensity: 0.5 }], ease: 0.5 },
  { type: 'media', audio: 'none', fap: 'none', kilobits: 16, events: 'text', blocked: false },
  { type: 'join', room: 'hall', watch: true, as: 'Anna' },
  { type: 'consent', consent: 'asked', text: 'x' },
  { type: 'leave' },
  { type: 'model', name: 'mara' },
  { type: 'head', head: 'mara' },
  { type: 'play', name: 'all-faps', id: 'p', mode: 'queue' },
  { type: 'jump', mark: 'qui' },
  { type: 'authorize', token: 'x' },
  { type: 'ping', id: 'x' },
  { type: 'text', id: 'x', text: 'Uno.' },
  { type: 'flush', id: 'x' },
  { type: 'close', id: 'x' },
  { type: 'cancel', id: 'x' },
  { type: 'choose', id: 'q', choice: 1 }, // without choices on offer
  { type: 'choices', id: 'q', question: 'Sì?', choices: ['Sì', 'No'] },
  { type: 'state', state: 'thinking', text: 'x', mix: [{ name: 'hope', intensity: 0.3 }], ease: 1 },
  { type: 'ask', id: 'a', text: 'Sì?', choices: ['Sì'], seconds: 5, wait: false, lang: 'it', rate: 120, mode: 'queue' },
  { type: 'backdrop', source: 'x.png' },
  { type: 'manner', speed: 0.8, pitch: 1, volume: 1.2 },
  { type: 'said', id: 'w', text: 'Sì', final: true, confidence: 0.5, lang: 'it' },
  { type: 'overhear', on: true },
  { type: 'drive', frames: [{ time: 0.5, faps: { 3: 10 } }] },
  { type: 'hear', id: 'h', codec: 'pcm_s16le', rate: 16000, channels: 1, lang: 'it' },
  { type: 'voice', id: 'v', codec: 'pcm_s16le', rate: 16000, channels: 1, lookahead: 80, lang: 'it', engine: 'network', fps: 25, life: 1, still: false, mode: 'queue', priority: 'chat', topic: 't' },
];

/** Errors that only the daemon can detect, by code. */
const readerOnly = {
  'unknown-voice': 'hello names the voices',
  'unknown-language': 'hello names the languages',
  'unknown-engine': 'hello names the engines',
  'unknown-expression': 'hello names the expressions',
  'unknown-model': 'hello names the models',
  'unknown-codec': 'hello names the codings',
  'unknown-utterance': 'it depends on what has been said before',
  'not-speaking': 'it depends on what has been said before',
  'unknown-media': 'what lies in the folder',
  'unknown-mark': 'the marks stand in the text',
  driven: 'it depends on who drives',
  'no-choices': 'it depends on what is offered',
  'too-many-voices': 'it depends on what is being heard',
};

/** Invalid by the schema, but accepted by the daemon. */
const lenient = [[/^(speak|ask|play|idle|voice|hear)$/, (edit) => Object.values(edit.set ?? {})[0] === null, 'null is taken as left out: protocol/README.md']];

let daemon, stream, number = 0;
before(async () => {
  daemon = await Daemon.start(['--media', path.join(root, 'protocol/vectors/fap'), '--recogniser', 'cat >/dev/null']);
  stream = await daemon.stream();
});
after(() => daemon.stop());

/** Sends a message and then a ping. Returns the error that comes before the pong, or undefined. */
async function answer(message) {
  const from = stream.messages.length, id = `next-${++number}`;
  stream.send({ type: 'stop' });
  stream.send(message);
  stream.send({ type: 'ping', id });
  const pong = await stream.wait({ type: 'pong', id }, { from });
  return stream.messages.slice(from, stream.messages.indexOf(pong)).find((m) => m.type === 'error');
}

test('the schema and the daemon reject invalid documents of the corpus at the same position', async () => {
  for (const entry of corpus('client')) {
    const error = await answer(entry.message), places = refused(entry.message), what = `${entry.name}: ${JSON.stringify(error)}; the schema: ${places}`;
    assert.ok(error?.code && error.message, what);
    if (entry.place) assert.equal(error.field, entry.place, what);
    assert.equal(entry.readerOnly, 'why' in entry, what);
    if (entry.readerOnly) assert.deepEqual(places, [], what);
    else assert.ok(agrees(places, error.field ?? ''), what);
  }
});

test('the corpus contains each declared message', () => {
  const { client: declared } = JSON.parse(fs.readFileSync(path.join(root, 'protocol/messages.json')));
  const seldom = ['calibrate', 'lexicon']; // more than 12 at once are too many: tests/daemon/rooms/notices.test.mjs
  assert.deepEqual([...messages.map(({ type }) => type), ...seldom].sort(), Object.keys(declared).sort());
});

for (const message of messages)
  test(`${message.type}: schema and daemon agree on every damage`, async () => {
    const right = await answer(message);
    assert.deepEqual(refused(message), []);
    assert.ok(!right || right.code in readerOnly, JSON.stringify(right));
    const wrong = [];
    for (const edit of damages(message)) {
      const damaged = edited(message, edit);
      if (typeof damaged !== 'object' || Array.isArray(damaged) || !damaged) continue; // anything but a JSON object is spoken as text
      const error = await answer(damaged), places = refused(damaged);
      const what = `${JSON.stringify(edit)}: daemon ${JSON.stringify(error)}, schema ${JSON.stringify(places)}`;
      const known = error ? error.code in readerOnly : lenient.some(([type, of]) => type.test(message.type) && of(edit));
      if (Boolean(error) !== Boolean(places.length) && !known) wrong.push(what);
    }
    assert.deepEqual(wrong, []);
  });
