// SPDX-License-Identifier: GPL-3.0-or-later
// Playback of synthesised sentences when listeners interrupt, pause, jump or defer them: nothing is synthesised twice, and the head
// does not jump for clients that show frames in order of arrival.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';
import { HEAD } from '../../lib/face.mjs';
import { patient } from '../../lib/patient.mjs';

let daemon;
before(async () => (daemon = await Daemon.start(['--cache', '0'])));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/** Total number of sentences requested from voices. */
const asked = () => daemon.metric('faccia_sentences_asked_total');

/** Number of sentences requested from voices during `act`. */
async function askedBy(act) {
  const before = await asked();
  await act();
  return (await asked()) - before;
}

const text = `<speak>La mamma parla piano con Beppe, e poi dorme davvero. <mark name="due"/>Domani il bambino compra una palla
  rossa, forse blu. <mark name="tre"/>La sera il nonno racconta una fiaba lunga, e tutti ascoltano. Poi basta.</speak>`;
const SENTENCES = 4;
const spokenSo = (stream, id, count) => stream.until(() => stream.messages.filter((m) => m.type === 'sentence' && m.id === id).length >= count);

test('jumps back and forth, and pauses, replay spoken audio', async () => {
  const stream = await daemon.stream('?audio=pcm&fap=plain');
  stream.send({ type: 'idle', seed: 2 });
  const count = await askedBy(async () => {
    stream.send({ type: 'speak', id: 'a', lang: 'it', markup: 'ssml', text });
    await spokenSo(stream, 'a', 2);
    stream.send({ type: 'pause' });
    await stream.wait({ type: 'paused' });
    const heard = stream.chunks.length;
    await stream.until(() => stream.chunks.slice(heard).some(({ utterance }) => utterance === 0)); // idle media play meanwhile
    stream.send({ type: 'resume' });
    stream.send({ type: 'jump', mark: 'tre' });
    await spokenSo(stream, 'a', 3);
    for (const mark of ['due', 'tre', 'due']) {
      const from = stream.messages.length;
      stream.send({ type: 'jump', mark });
      await stream.wait({ type: 'mark', name: mark }, { from });
      await stream.wait({ type: 'word' }, { from });
    }
    await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  });
  assert.equal(count, SENTENCES, 'each sentence is spoken once');
  const sentences = stream.messages.filter((m) => m.type === 'sentence');
  const again = sentences.filter((m) => m.start === sentences.at(-2).start);
  assert.ok(again.length >= 3, `it was played several times: ${sentences.map((m) => m.start)}`);
  assert.ok(again.every((m) => m.duration === again[0].duration), 'and is the same each time');
  await stream.close();
});

test('queued speech stays rendered when something else is spoken first', async () => {
  const stream = await daemon.stream('?audio=pcm&fap=plain');
  stream.send({ type: 'idle', seed: 2 });
  const before = await asked();
  const count = await askedBy(async () => {
    stream.send({ type: 'speak', id: 'a', lang: 'it', text: 'La mamma parla piano con Beppe, e poi dorme davvero molto a lungo.' });
    stream.send({ type: 'speak', id: 'b', lang: 'it', text: 'Il secondo aspetta. E poi parla.' });
    await stream.wait({ type: 'word', id: 'a' });
    while ((await asked()) < before + 3) await pause(20); // synthesised ahead of its turn
    for (const id of ['c', 'd']) {
      stream.send({ type: 'speak', id, lang: 'it', text: 'Ecco!', mode: 'interrupt' });
      await stream.wait({ type: 'word', id });
    }
    await stream.wait({ type: 'end', id: 'b', reason: 'done' });
  });
  assert.equal(count, 1 + 2 + 2);
  await stream.close();
});

test('a different rate generates speech again; the same rate does not', async () => {
  const stream = await daemon.stream('?audio=pcm&fap=plain');
  const speak = (id) => stream.send({ type: 'speak', id, lang: 'it', rate: 150, markup: 'ssml', text });
  assert.equal(
    await askedBy(async () => {
      speak('same');
      await spokenSo(stream, 'same', 1);
      stream.send({ type: 'rate', rate: 150 });
      await stream.wait({ type: 'end', id: 'same' });
    }),
    SENTENCES,
  );
  assert.ok(
    (await askedBy(async () => {
      speak('other');
      await spokenSo(stream, 'other', 2);
      stream.send({ type: 'rate', rate: 300 });
      stream.send({ type: 'jump', mark: 'due' });
      await stream.wait({ type: 'end', id: 'other' });
    })) > SENTENCES,
  );
  await stream.close();
});

test('a new life, seed or mood applies at once without generating speech again', async () => {
  const stream = await daemon.stream('?audio=pcm&fap=plain');
  stream.send({ type: 'idle', seed: 2 });
  const count = await askedBy(async () => {
    stream.send({ type: 'speak', id: 'a', lang: 'it', text: 'La mamma parla piano con Beppe, e poi dorme davvero molto a lungo, fino a domani.' });
    await stream.wait({ type: 'word', id: 'a' });
    stream.send({ type: 'idle', seed: 9, life: 2 });
    stream.send({ type: 'express', mix: [{ name: 'joy', intensity: 1 }] });
    await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  });
  assert.equal(count, 1);
  const SMILE = 12;
  const last = stream.chunks.filter((c) => c.utterance === 1).at(-1).frames[0];
  assert.ok(last[SMILE] > 60, 'the mood is on the sentence that was being said');
  await stream.close();
});

/** Largest step of the head between consecutive frames in order of arrival, in radians at 25 fps. */
function largestHeadStep({ chunks }, from = 0) {
  const frames = chunks.slice(from).flatMap((c) => c.frames);
  let largest = 0;
  for (let i = 1; i < frames.length; i++) for (const n of HEAD) largest = Math.max(largest, Math.abs(frames[i][n] - frames[i - 1][n]) / 1e5);
  return largest;
}

/** Idles, speaks, pauses, jumps and interrupts. Returns the largest step of the head for each. */
async function steered(seed) {
  const stream = await daemon.stream('?audio=pcm&fap=plain');
  const steps = {};
  let from = 0;
  const measure = (what) => {
    steps[what] = Number(largestHeadStep(stream, Math.max(0, from - 1)).toFixed(4));
    from = stream.chunks.length;
  };
  const more = (count) => {
    const have = stream.chunks.length;
    return stream.until(() => stream.chunks.length >= have + count);
  };
  stream.send({ type: 'idle', seed });
  await more(15);
  measure('idling');
  stream.send({ type: 'speak', id: 'a', lang: 'it', markup: 'ssml', text });
  await spokenSo(stream, 'a', 1);
  await more(8);
  measure('speaking');
  stream.send({ type: 'pause' });
  await more(20);
  measure('pause');
  stream.send({ type: 'resume' });
  await more(8);
  measure('resume');
  stream.send({ type: 'jump', mark: 'tre' });
  await more(8);
  measure('jump');
  stream.send({ type: 'pause' });
  await more(6);
  stream.send({ type: 'jump', mark: 'due' });
  stream.send({ type: 'resume' });
  await more(10);
  measure('jump in a pause');
  stream.send({ type: 'speak', id: 'b', lang: 'it', mode: 'interrupt', text: 'Scusa, una cosa importante e piuttosto lunga.' });
  await stream.wait({ type: 'word', id: 'b' });
  await more(4);
  measure('barge-in');
  stream.send({ type: 'stop' });
  await more(10);
  measure('stop');
  stream.send({ type: 'idle', seed: seed + 10 });
  await more(10);
  measure('another seed');
  if (process.env.SHOW) console.log(JSON.stringify(steps));
  await stream.close();
  return steps;
}

patient('pauses, jumps and barge-ins do not make the head step (three streams at once)', async () => {
  for (const steps of await Promise.all([3, 4, 5].map(steered)))
    for (const [what, step] of Object.entries(steps)) assert.ok(step < 0.03, `${what}: ${JSON.stringify(steps)}`);
});
