// SPDX-License-Identifier: GPL-3.0-or-later
// The idle face of a stream: idling, mood, and transitions between idling and speech.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon, framesOf } from '../../lib/daemon.mjs';
import { BROWS, CHEEKS, HEAD, largestStep, MOUTH, timeline } from '../../lib/face.mjs';
import { patient } from '../../lib/patient.mjs';
import { violations } from '../../lib/schema.mjs';

const SMILE = 12;
const sentence = 'La mamma parla piano con Beppe, e poi dorme.';
let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const idle = (stream) => stream.chunks.filter((c) => c.utterance === 0);
/** Waits until the idle clock reaches `seconds`. */
const idled = (stream, seconds) => stream.until(() => idle(stream).some((c) => (c.start + c.samples) / c.sampleRate >= seconds));

patient('idle media are silent chunks of utterance 0, without a gap, little ahead of time', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'idle', on: true, seed: 7 });
  await idled(stream, 2);
  let [sample, frame] = [0, 0];
  for (const chunk of stream.chunks) {
    assert.deepEqual([chunk.utterance, chunk.audioCodec, chunk.sampleRate, chunk.samples, chunk.fps], [0, 0, 8000, 960, 25]);
    assert.deepEqual([chunk.start, chunk.firstFrame], [sample, frame]);
    sample += chunk.samples;
    frame += chunk.frames.length;
    const early = (chunk.start + chunk.samples) / 8000 - (chunk.arrived - stream.chunks[0].arrived) / 1000;
    assert.ok(early < 0.26, `${early} s ahead`);
  }
  assert.equal(frame, Math.ceil((sample * 25) / 8000));
  assert.ok(framesOf(stream.chunks).some(({ values }) => HEAD.some((n) => values[n])), 'she moves');
  await stream.close();
});

patient('off is off, and on again counts from 0', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'idle' });
  await idled(stream, 0.5);
  stream.send({ type: 'idle', on: true }); // repeating it changes nothing
  await idled(stream, 1);
  assert.deepEqual(stream.chunks.map((c) => c.start), stream.chunks.map((_, i) => 960 * i));
  stream.send({ type: 'idle', on: false });
  stream.send({ type: 'ping', id: 'x' });
  await stream.wait({ type: 'pong' });
  const before = stream.chunks.length;
  // another idle face serves as a clock
  const clock = await daemon.stream();
  clock.send({ type: 'idle' });
  await clock.until(() => clock.chunks.length > 10);
  await clock.close();
  assert.equal(stream.chunks.length, before);
  stream.send({ type: 'idle' });
  await stream.until(() => stream.chunks.length > before);
  assert.equal(stream.chunks[before].start, 0);
  await stream.close();
});

patient('frames come at the rate of the stream', async () => {
  for (const fps of [12.5, 60, 120]) {
    const stream = await daemon.stream(`?fps=${fps}`);
    stream.send({ type: 'idle', seed: 1 });
    await idled(stream, 1);
    assert.equal(framesOf(stream.chunks).length, Math.ceil((stream.chunks.length * 960 * fps) / 8000));
    await stream.close();
  }
});

patient('the same seed gives the same idle face, another one another', async () => {
  const face = async (seed) => {
    const stream = await daemon.stream();
    stream.send({ type: 'idle', seed });
    await idled(stream, 3);
    await stream.close();
    return framesOf(stream.chunks).slice(0, 75).map(({ values }) => [...values]);
  };
  const [one, again, other] = await Promise.all([face(7), face(7), face(8)]);
  assert.deepEqual(one, again);
  assert.notDeepEqual(one, other);
});

test('life 0 and still keep the head from moving', async () => {
  for (const [query, life] of [['', 0], ['?still=1', 1]]) {
    const stream = await daemon.stream(query);
    stream.send({ type: 'idle', life });
    await idled(stream, 1.5);
    for (const { values } of framesOf(stream.chunks)) for (const n of HEAD) assert.equal(values[n], 0);
    await stream.close();
  }
});

/** Idles, speaks and idles again; calls `during` in each phase. */
async function listened(speak, during = () => {}) {
  const stream = await daemon.stream();
  stream.send({ type: 'idle', on: true, seed: 3 });
  await idled(stream, 1.5);
  during(stream, 'idle');
  await idled(stream, 2.5);
  stream.send({ type: 'speak', id: 'a', lang: 'it', text: sentence, ...speak });
  await stream.until(() => stream.chunks.some((c) => c.utterance === 1));
  during(stream, 'speech');
  const end = await stream.wait({ type: 'end', id: 'a' });
  const begin = stream.messages.find((m) => m.type === 'begin');
  await idled(stream, begin.idle + end.duration + 0.5);
  during(stream, 'after');
  await idled(stream, begin.idle + end.duration + 1.5);
  await stream.close();
  for (const { arrived: _, ...message } of stream.messages) assert.equal(violations('server', message), null);
  return { ...stream, begin, end, frames: timeline(stream) };
}

const handOver = (a, b) => a.utterance !== b.utterance;
const quietly = (a, b) => !a.utterance && !b.utterance;

patient('from idling to speech and back nothing jumps', async () => {
  const { frames, begin, end, chunks } = await listened({});
  assert.ok(largestStep(frames, HEAD, handOver).step < 200, JSON.stringify(largestStep(frames, HEAD, handOver)));
  for (const faps of [BROWS, MOUTH, CHEEKS]) assert.ok(largestStep(frames, faps, handOver).step < 40, JSON.stringify(largestStep(frames, faps, handOver)));
  // no frame is missing around the transition
  assert.ok(!frames.slice(1).some(({ time }, i) => time - frames[i].time >= 0.081), 'nothing comes before');
  // idling continues at the clock's time
  const back = chunks.slice(chunks.findIndex((c) => c.utterance === 1)).find((c) => c.utterance === 0);
  assert.ok(back.start / 8000 >= begin.idle + end.duration - 0.01);
});

test('an utterance with its own seed does not depend on earlier ones', async () => {
  // Compares lids and head. They are only nearly equal: the voice's output varies by some samples, and the head follows it.
  const alive = [...HEAD, 19, 20, 21, 22];
  const face = (chunks) => framesOf(chunks, 1).map(({ values }) => alive.map((n) => values[n]));
  const alone = async (seed) => {
    const stream = await daemon.stream();
    stream.send({ type: 'speak', lang: 'it', text: sentence, seed });
    await stream.wait({ type: 'end' });
    await stream.close();
    return face(stream.chunks);
  };
  const [same, other, { chunks }] = await Promise.all([alone(11), alone(12), listened({ seed: 11 })]);
  const difference = (a, b) => a.slice(0, b.length).reduce((sum, frame, i) => sum + frame.reduce((s, v, n) => s + Math.abs(v - b[i][n]), 0), 0);
  assert.ok(difference(same, other) > 3 * difference(same, face(chunks)), `${difference(same, other)}, ${difference(same, face(chunks))}`);
});

test('the mood shows while idle and while speaking, and fades in and out', async () => {
  const { frames, begin } = await listened({}, (stream, part) => {
    if (part === 'idle') stream.send({ type: 'express', mix: [{ name: 'joy', intensity: 1 }], ease: 0.4 });
    if (part === 'speech') stream.send({ type: 'express', mix: [{ name: 'sadness', intensity: 1 }], ease: 0.4 });
    if (part === 'after') stream.send({ type: 'express', mix: [], ease: 0.4 });
  });
  const smile = (from, to) => {
    const values = frames.filter(({ time }) => time >= from && time < to).map(({ values: v }) => v[SMILE]);
    return values.reduce((sum, value) => sum + value, 0) / values.length;
  };
  assert.ok(Math.abs(smile(0.5, 1.4)) < 40, 'neutral at first');
  assert.ok(smile(begin.idle - 0.4, begin.idle) > 120, 'she smiles');
  const last = frames.at(-1).time;
  const sad = frames.filter(({ time }) => time > last - 1.2 && time < last - 0.9);
  assert.ok(sad.every(({ values }) => values[SMILE] < -20), 'she is sad');
  assert.ok(Math.abs(smile(last - 0.1, last + 1)) < 60, 'neutral at the end');
  for (const faps of [BROWS, MOUTH, CHEEKS]) {
    assert.ok(largestStep(frames, faps, quietly).step < 120, JSON.stringify(largestStep(frames, faps, quietly)));
    assert.ok(largestStep(frames, faps, handOver).step < 60, JSON.stringify(largestStep(frames, faps, handOver)));
  }
});

patient('a pause leaves the face of the utterance as it would have been, and she idles meanwhile', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'idle', on: true, seed: 3 });
  const said = [];
  for (const id of ['whole', 'paused']) {
    stream.send({ type: 'speak', id, lang: 'it', text: sentence, seed: 5 });
    const { utterance } = await stream.wait({ type: 'begin', id });
    const own = () => stream.chunks.filter((c) => c.utterance === utterance);
    if (id === 'paused') {
      await stream.until(() => own().length > 7);
      stream.send({ type: 'pause' });
      await stream.wait({ type: 'paused' });
      const from = stream.chunks.length;
      await stream.until(() => stream.chunks.length > from + 8);
      const meanwhile = framesOf(stream.chunks.slice(from), 0);
      assert.ok(largestStep(meanwhile.map((f) => ({ ...f, utterance: 0 })), HEAD).step > 0, 'she moves');
      stream.send({ type: 'resume' });
    }
    await stream.wait({ type: 'end', id, reason: 'done' });
    said.push(framesOf(own()).map(({ values }) => [...values]));
  }
  assert.ok(said[0].length > 50);
  assert.deepEqual(said[1], said[0]);
  // the idle clock keeps counting
  const starts = idle(stream).map((c) => c.start);
  assert.ok(starts.every((start, i) => !i || start > starts[i - 1]));
  await stream.close();
});

patient('after a stop she idles at once', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'idle', seed: 2 });
  await idled(stream, 0.5);
  stream.send({ type: 'speak', id: 'a', lang: 'it', text: sentence.repeat(5) });
  await stream.until(() => stream.chunks.filter((c) => c.utterance === 1).length > 8);
  stream.send({ type: 'stop' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'stopped');
  const from = stream.chunks.length;
  await stream.until(() => stream.chunks.length > from + 5);
  assert.ok(stream.chunks.slice(from).every((c) => c.utterance === 0));
  const [first] = stream.chunks.slice(from);
  const begin = stream.messages.find((m) => m.type === 'begin');
  const spoken = stream.chunks.filter((c) => c.utterance === 1).at(-1);
  assert.ok(first.start / 8000 < begin.idle + (spoken.start + spoken.samples) / spoken.sampleRate, 'what was not heard is forgotten');
  const numbers = stream.chunks.slice(from).map((c) => c.start);
  numbers.slice(1).forEach((start, i) => assert.equal(start - numbers[i], 960));
  await stream.close();
});

test('queued utterances share one life clock', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'idle', seed: 4 });
  await idled(stream, 1);
  for (const id of ['a', 'b']) stream.send({ type: 'speak', id, lang: 'it', text: 'Uno, due.' });
  await stream.wait({ type: 'end', id: 'b' });
  await idled(stream, stream.messages.find((m) => m.type === 'begin' && m.id === 'b').idle + 2);
  const frames = timeline(stream);
  assert.ok(largestStep(frames, HEAD, handOver).step < 200, JSON.stringify(largestStep(frames, HEAD, handOver)));
  await stream.close();
});

test('reports invalid members of idle and express with their field, and changes nothing', async () => {
  const stream = await daemon.stream();
  const joy = { name: 'joy', intensity: 0.5 };
  const wrong = [
    [{ type: 'idle', on: 'yes' }, 'bad-field', 'on'],
    [{ type: 'idle', life: 3 }, 'bad-field', 'life'],
    [{ type: 'idle', seed: -1 }, 'bad-field', 'seed'],
    [{ type: 'idle', seed: 'x' }, 'bad-field', 'seed'],
    [{ type: 'express' }, 'missing-field', 'mix'],
    [{ type: 'express', mix: 'joy' }, 'bad-field', 'mix'],
    [{ type: 'express', mix: [joy, joy, joy, joy, joy] }, 'bad-field', 'mix'],
    [{ type: 'express', mix: [{}] }, 'missing-field', 'mix.0.name'],
    [{ type: 'express', mix: ['joy'] }, 'missing-field', 'mix.0.name'],
    [{ type: 'express', mix: [joy, { name: 'boredom' }] }, 'unknown-expression', 'mix.1.name'],
    [{ type: 'express', mix: [joy, { name: 'fear', intensity: 2 }] }, 'bad-field', 'mix.1.intensity'],
    [{ type: 'express', mix: [joy, { name: 'fear', intensity: 'much' }] }, 'bad-field', 'mix.1.intensity'],
    [{ type: 'express', mix: [], ease: -1 }, 'bad-field', 'ease'],
    [{ type: 'express', mix: [], ease: '1' }, 'bad-field', 'ease'],
  ];
  for (const [message, code, field] of wrong) {
    const from = stream.messages.length;
    stream.send(message);
    await stream.wait({ type: 'error', code, field }, { from });
  }
  assert.equal(stream.chunks.length, 0);
  stream.send({ type: 'idle' });
  await idled(stream, 0.5);
  assert.ok(framesOf(stream.chunks).every(({ values }) => Math.abs(values[SMILE]) < 40), 'no smile');
  await stream.close();
});

test('speaks after a thousand changes of mood and idling', async () => {
  const stream = await daemon.stream();
  for (let i = 0; i < 1000; i++) {
    stream.send({ type: 'express', mix: [{ name: i % 2 ? 'anger' : 'joy', intensity: (i % 10) / 10 }], ease: (i % 7) / 7 });
    stream.send({ type: 'idle', on: i % 3 > 0, seed: i % 5 });
  }
  stream.send({ type: 'idle', seed: 1 });
  stream.send({ type: 'speak', id: 'a', lang: 'it', text: 'Ecco.' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'done');
  await stream.close();
});

test('lists all expressions, and the affects in hello', async () => {
  const stream = await daemon.stream();
  const hello = await stream.wait({ type: 'hello' });
  const { expressions } = await (await daemon.get('/v1/expressions')).json();
  const affects = expressions.filter((e) => e.kind === 'affect');
  assert.deepEqual(hello.expressions, affects.map((e) => e.name));
  assert.deepEqual(affects.filter((e) => e.basic).map((e) => e.name).sort(), ['anger', 'disgust', 'fear', 'joy', 'sadness', 'surprise']);
  assert.ok(affects.length >= 29);
  for (const { activation, evaluation } of affects) assert.ok(Math.abs(activation) <= 1 && Math.abs(evaluation) <= 1);
  for (const kind of ['performative', 'certainty', 'emphasis', 'boundary']) assert.ok(expressions.some((e) => e.kind === kind), kind);
  // the general engines speak every language, the others those with a table
  for (const { tag, engines } of hello.languages)
    assert.deepEqual(engines, ['dominance', 'cohen-massaro', ...({ 'pt-BR': ['context'], tr: ['syllable'] }[tag] ?? []), 'table'], tag);
  for (const tag of ['it', 'en', 'pt-BR', 'tr']) assert.ok(hello.languages.some((l) => l.tag === tag), tag);
  await stream.close();
});

test('sends markup warnings as events with line and column; begin names the markup', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'a', lang: 'it', text: '<apml>\n<performative type="greet"><rheme affect="joy">Ciao</rheme>\n  <foo/></performative></apml>' });
  await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  const warnings = stream.messages.filter((m) => m.type === 'warning');
  assert.deepEqual(warnings.map((w) => [w.id, w.utterance, w.line, w.column]), [['a', 1, 3, 3]]);
  assert.equal(stream.messages.find((m) => m.type === 'begin').markup, 'apml');
  assert.deepEqual(stream.messages.filter((m) => m.type === 'word').map((m) => m.text), ['Ciao']);
  stream.send({ type: 'speak', id: 'b', markup: 'apml', lang: 'it', text: '<apml>\n<performative' });
  const error = await stream.wait({ type: 'error', id: 'b' });
  assert.equal(error.line, 2);
  stream.send({ type: 'speak', id: 'c', markup: 'plain', lang: 'it', text: 'Tre è < quattro.' });
  await stream.wait({ type: 'end', id: 'c', reason: 'done' });
  assert.equal(stream.messages.find((m) => m.type === 'begin' && m.id === 'c').markup, 'plain');
  await stream.close();
});

const widest = ({ chunks }, fap) => Math.max(...framesOf(chunks, 1).map(({ values }) => Math.abs(values[fap])));

test('shows an affect of markup with life 0, and when still, which keeps head and gaze at rest', async () => {
  const speak = async (options) => {
    const stream = await daemon.stream();
    stream.send({ type: 'speak', lang: 'it', seed: 1, text: '<apml><performative><rheme affect="surprise">Che cosa vedo</rheme></performative></apml>', ...options });
    await stream.wait({ type: 'end', reason: 'done' });
    await stream.close();
    return stream;
  };
  const BROW = 33;
  assert.ok(widest(await speak({ life: 0 }), BROW) > 100);
  assert.ok(widest(await speak({ life: 0, blend: 'weighted' }), BROW) > 60);
  const still = await speak({ still: true });
  assert.ok(widest(still, BROW) > 100);
  for (const fap of [23, 24, 25, 26, 48, 49, 50]) assert.equal(widest(still, fap), 0, `FAP ${fap}`);
});

test('takes the markup of an HTTP request from its type, or detects it', async () => {
  const ssml = '<speak>Uno <mark name="m"/>due</speak>';
  const post = async (type, query = '', body = ssml) =>
    daemon.get(`/v1/speech?lang=it&format=json${query}`, { method: 'POST', body: Buffer.from(body), headers: type ? { 'content-type': type } : {} });
  for (const type of ['application/ssml+xml', 'application/xml', 'text/xml; charset=utf-8', 'application/x-www-form-urlencoded', ''])
    assert.equal((await (await post(type)).json()).marks.length, 1, type);
  assert.equal((await (await post('text/plain')).json()).marks.length, 0);
  assert.equal((await (await post('text/plain', '&markup=ssml')).json()).marks.length, 1);
  assert.equal((await post('image/png')).status, 415);
  const broken = await post('application/ssml+xml', '', '<speak>\n<p>Uno</speak>');
  assert.equal(broken.status, 400);
  assert.equal((await broken.json()).line, 2);
  for (const [query, field] of [['&life=3', 'life'], ['&blend=some', 'blend'], ['&markup=xyz', 'markup']])
    assert.equal((await (await post('text/plain', query)).json()).field, field);
});
