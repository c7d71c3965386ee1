// SPDX-License-Identifier: GPL-3.0-or-later
// Long texts: other clients are served while one is parsed, it keeps its place in the queue, and it can be stopped at any time.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start(['--max-text', '20000000', '--max-message', '20000000'])));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const million = (begin, piece, end, bytes = 2e6) => begin + piece.repeat(Math.ceil(bytes / piece.length)) + end;
const texts = {
  plain: million('', 'Il vento soffia sulle case. ', ''),
  'SSML with emphases': million('<speak>', '<emphasis>Il vento</emphasis> soffia. ', '</speak>'),
  'SSML with 100,000 emphases in one word': million('<speak>', '<emphasis>a</emphasis>', '</speak>'),
  APML: million('<apml>', '<performative type="inform"><theme affect="joy">Il <emphasis>vento</emphasis></theme> soffia.</performative>', '</apml>'),
  JSML: million('<jsml>', '<SENT>Il <HAPPY>vento</HAPPY> soffia.</SENT>', '</jsml>'),
  BML: million('<bml>', '<speech><text>Il <sync id="a"/>vento.</text></speech><head lexeme="NOD" start="0.5"/>', '</bml>'),
};

for (const [kind, text] of Object.entries(texts))
  test(`answers others while it reads a long text: ${kind}`, async () => {
    const [speaker, other] = [await daemon.stream('?lang=it'), await daemon.stream('?lang=it')];
    speaker.send({ type: 'speak', id: 'long', text });
    // parsing begins when the message arrives, so this pong comes after its start
    speaker.send({ type: 'ping', id: 'taken' });
    await speaker.wait({ type: 'pong', id: 'taken' });
    assert.ok(!speaker.messages.some((m) => m.id === 'long'), 'it is still being read');
    other.send({ type: 'ping', id: 1 });
    const pong = await other.wait({ type: 'pong', id: 1 });
    const first = await speaker.wait({ id: 'long' }, { milliseconds: 30000 });
    assert.ok(pong.arrived < first.arrived);
    await speaker.wait({ type: 'begin', id: 'long' }, { milliseconds: 30000 });
    speaker.send({ type: 'stop' });
    assert.equal((await speaker.wait({ type: 'end', id: 'long' })).reason, 'stopped');
    await speaker.close();
    await other.close();
  });

test('utterances keep their order, and each is spoken', async () => {
  const stream = await daemon.stream('?lang=it');
  const long = million('<speak>', '<!-- nothing -->', 'Uno.</speak>');
  stream.send({ type: 'speak', id: 'a', text: 'Prima.' });
  stream.send({ type: 'speak', id: 'b', text: long });
  stream.send({ type: 'speak', id: 'c', text: 'Dopo.' });
  await stream.wait({ type: 'end', id: 'c' }, { milliseconds: 30000 });
  const order = stream.messages.filter((m) => ['begin', 'end'].includes(m.type)).map((m) => [m.type, m.id, m.utterance, m.reason]);
  assert.deepEqual(order, ['a', 'b', 'c'].flatMap((id, i) => [['begin', id, i + 1, undefined], ['end', id, i + 1, 'done']]));
  assert.deepEqual(stream.messages.filter((m) => m.type === 'word').map((m) => m.text), ['Prima', 'Uno', 'Dopo']);
  await stream.close();
});

test('stop, replace and disconnection take effect while a text is read', async () => {
  const stream = await daemon.stream('?lang=it');
  const text = texts['SSML with emphases'];
  stream.send({ type: 'speak', id: 'a', text });
  stream.send({ type: 'stop' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'stopped');
  stream.send({ type: 'speak', id: 'b', text });
  stream.send({ type: 'rate', rate: 200 });
  stream.send({ type: 'jump', mark: 'nowhere' });
  assert.equal((await stream.wait({ type: 'error' })).code, 'unknown-mark');
  stream.send({ type: 'pause' });
  stream.send({ type: 'resume' });
  stream.send({ type: 'speak', id: 'c', text, mode: 'interrupt' });
  assert.equal((await stream.wait({ type: 'end', id: 'b' })).reason, 'stopped');
  stream.send({ type: 'speak', id: 'd', text: 'Ecco.', mode: 'replace' });
  assert.equal((await stream.wait({ type: 'end', id: 'c' })).reason, 'stopped');
  assert.equal((await stream.wait({ type: 'end', id: 'd' })).reason, 'done');
  assert.ok(!stream.messages.some((m) => m.type === 'begin' && m.id !== 'd'));
  for (let i = 0; i < 8; i++) {
    const gone = await daemon.stream('?lang=it');
    gone.send({ type: 'speak', text });
    gone.send({ type: 'ping', id: 1 });
    await gone.wait({ type: 'pong' });
    gone.socket.terminate();
  }
  stream.send({ type: 'speak', id: 'e', text: 'Ancora.' });
  assert.equal((await stream.wait({ type: 'end', id: 'e' })).reason, 'done');
  await stream.close();
});

test('reports an unreadable document with its position, and speaks the next', async () => {
  const stream = await daemon.stream('?lang=it');
  const bad = million('<speak>', 'Uno due. ', '\n <b></speak>', 1e6);
  stream.send({ type: 'speak', id: 'first', text: 'Prima.' });
  stream.send({ type: 'speak', id: 'bad', text: bad, markup: 'ssml' });
  stream.send({ type: 'speak', id: 'next', text: 'Dopo.' });
  const error = await stream.wait({ type: 'error', id: 'bad' });
  assert.deepEqual([error.code, error.line], ['bad-xml', 2]);
  assert.equal((await stream.wait({ type: 'end', id: 'bad' })).reason, 'failed');
  assert.equal((await stream.wait({ type: 'end', id: 'next' })).reason, 'done');
  const posted = await daemon.get('/v1/speech?lang=it', { method: 'POST', body: bad, headers: { 'content-type': 'application/ssml+xml' } });
  assert.equal(posted.status, 400);
  assert.deepEqual((({ code, line }) => [code, line])(await posted.json()), ['bad-xml', 2]);
  await stream.close();
});

test('speaks a long posted text completely', async () => {
  const text = million('<speak>Uno <mark name="m"/>due.', '<!-- nothing -->', '</speak>', 1e6);
  const json = await (await daemon.get('/v1/speech?lang=it&format=json', { method: 'POST', body: text, headers: { 'content-type': 'application/ssml+xml' } })).json();
  assert.deepEqual(json.words.map((w) => w.text), ['Uno', 'due']);
  assert.equal(json.marks[0].name, 'm');
});

test('the daemon stops while it reads a text', async () => {
  const one = await Daemon.start(['--max-text', '20000000', '--max-message', '20000000']);
  const stream = await one.stream('?lang=it');
  for (let i = 0; i < 6; i++) stream.send({ type: 'speak', text: texts.APML });
  stream.send({ type: 'ping', id: 1 });
  await stream.wait({ type: 'pong' });
  assert.deepEqual(await one.stop(), { code: 0, signal: null });
});
