// SPDX-License-Identifier: GPL-3.0-or-later
// Sound is coded on threads: messages must still arrive in order in every encoding, and nothing after the end.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { CompactReader, isCompact } from '../../../protocol/chunk/compact.mjs';
import { decodeChunk } from '../../../protocol/chunk/chunk.mjs';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start(['--cache', '0'])));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const text = 'Uno, due e tre. Quattro, cinque, sei e sette. Otto!';

/** Records all events, and chunks as {chunk}, in order. */
async function listen(query) {
  const stream = await daemon.stream(`?lang=it&${query}`);
  const [heard, reader] = [[], new CompactReader()];
  stream.socket.on('message', (data, binary) => heard.push(binary ? { chunk: isCompact(data) ? reader.decode(data) : decodeChunk(data) } : JSON.parse(data)));
  return { stream, heard };
}

/** Checks one utterance that was received completely. */
function check(heard, utterance) {
  const of = heard.filter((m) => (m.chunk ?? m).utterance === utterance);
  assert.equal(of[0].type, 'begin');
  assert.equal(of.at(-1).type, 'end');
  let [until, words] = [0, 0];
  for (const m of of) {
    if (m.chunk) {
      assert.equal(m.chunk.start, until);
      until = m.chunk.start + m.chunk.samples;
    } else if (m.type === 'word' || m.type === 'sentence') {
      assert.ok(m.sample >= until, `${m.type} at ${m.sample} comes after the media until ${until}`);
      words += m.type === 'word';
    }
  }
  return { words, until, end: of.at(-1) };
}

test('sends events before the media in which they begin, and the end after everything', async () => {
  const ways = ['audio=opus&fap=fapc', 'audio=opus&fap=fapc&kilobits=12', 'audio=pcm&fap=plain', 'audio=pcm&fap=fapc', 'audio=none&fap=fapc'];
  const all = await Promise.all(ways.flatMap((way) => ['', '&room=hall'].map((room) => listen(way + room))));
  // all members of the room join before one of them speaks
  for (const { stream } of all.filter((_, i) => i % 2)) await stream.wait({ type: 'joined' });
  all.forEach(({ stream }, i) => (i % 2 === 0 || i === 1) && stream.send({ type: 'speak', id: 'it', text }));
  await Promise.all(all.map(async ({ stream, heard }) => {
    await stream.wait({ type: 'end' }, { milliseconds: 60000 });
    const { words, until, end } = check(heard, 1);
    assert.equal(words, 10);
    assert.equal(end.reason, 'done');
    assert.ok(Math.abs(until / heard.find((m) => m.type === 'begin').rate - end.duration) < 1e-4);
  }));
});

test('stopped repeatedly, sends one end for each utterance and nothing after it', async () => {
  const { stream, heard } = await listen('audio=opus&fap=fapc');
  for (let i = 1; i <= 12; i++) {
    stream.send({ type: 'speak', id: String(i), text });
    if (i % 3) await stream.wait({ type: 'begin', id: String(i) });
    stream.send({ type: 'stop' });
    assert.equal((await stream.wait({ type: 'end', id: String(i) })).reason, 'stopped');
  }
  stream.send({ type: 'speak', id: 'last', text });
  assert.equal((await stream.wait({ type: 'end', id: 'last' })).reason, 'done');
  for (let i = 1; i <= 12; i++) {
    const end = heard.findIndex((m) => m.type === 'end' && m.id === String(i));
    assert.ok(!heard.slice(end).some((m) => m.chunk?.utterance === i));
  }
  assert.equal(check(heard, 13).words, 10);
});
