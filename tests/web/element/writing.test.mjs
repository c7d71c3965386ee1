// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { Speech } from '../../../web/element/speech/speech.mjs';
import { PlainText } from '../../../web/element/captions/plain-text.mjs';

/** A speech whose server is played by the test. */
function rig(linked = true) {
  const sent = [];
  const link = { up: linked };
  const player = { rate: 1000, written: 0, flushed: 0, open() {}, write() {}, finish() {}, release() {}, hold() {}, flush() { this.flushed++; }, heard: () => ({ position: 0, running: true }) };
  const speech = new Speech({ player, send: (message) => link.up && sent.push(message) > 0, emit() {}, state: () => (link.up ? 'open' : 'connecting') });
  return { speech, sent, link, player };
}

const after = (sent) => sent.map(({ type, text }) => (text === undefined ? type : `${type} ${text}`));

test('sends written text at once, and the promise resolves with the end', async () => {
  const { speech, sent } = rig();
  const writing = speech.write({ lang: 'it' });
  writing.write('Ciao');
  writing.write('');
  writing.flush();
  writing.write(' a tutti.');
  writing.close();
  writing.write('Troppo tardi.');
  writing.close();
  assert.deepEqual(sent[0], { lang: 'it', open: true, type: 'speak', text: '', id: 'u1' });
  assert.deepEqual(after(sent.slice(1)), ['text Ciao', 'flush', 'text  a tutti.', 'close']);
  assert.ok(sent.every((message) => message.id === 'u1'));
  speech.hear({ type: 'end', id: 'u1', utterance: 1, reason: 'failed' });
  assert.equal((await writing.done).reason, 'failed');
});

test('sends text written before the connection when it opens', () => {
  const { speech, sent, link } = rig(false);
  const writing = speech.write();
  writing.write('Prima');
  writing.write(' di tutto.');
  writing.close();
  assert.deepEqual(sent, []);
  link.up = true;
  speech.linked();
  assert.deepEqual(after(sent), ['speak Prima di tutto.', 'close']);
});

test('reads a stream to its end, across split characters, and closes after an error', async () => {
  const { speech, sent } = rig();
  const bytes = new TextEncoder().encode('È là.');
  const writing = speech.write();
  await writing.from(new ReadableStream({
    start(controller) {
      for (const byte of bytes) controller.enqueue(Uint8Array.of(byte));
      controller.close();
    },
  }));
  assert.equal(sent.filter((m) => m.type === 'text').map((m) => m.text).join(''), 'È là.');
  assert.equal(sent.at(-1).type, 'close');
  const broken = speech.write();
  await assert.rejects(broken.from((async function* () {
    yield 'Fin qui';
    throw new Error('gone');
  })()), /gone/);
  assert.deepEqual(after(sent.slice(-2)), ['text Fin qui', 'close']);
});

test('cancels one of two texts', async () => {
  const { speech, sent, player } = rig();
  const [one, two] = [speech.write(), speech.write()];
  two.write('Resta.');
  one.cancel();
  one.write('Non più.');
  assert.deepEqual(after(sent.slice(-1)), ['cancel']);
  assert.equal(sent.at(-1).id, 'u1');
  speech.hear({ type: 'end', id: 'u1', utterance: 1, reason: 'stopped' });
  assert.equal((await one.done).reason, 'stopped');
  assert.equal(player.flushed, 0, 'it had not begun');
  two.write('Ancora.');
  assert.deepEqual(after(sent.slice(-1)), ['text Ancora.']);
});

test('captions omit what the server omits', () => {
  const source = '# Idee\n- **due** uo*va* 😀 a `casa`';
  const plain = new PlainText(source, 'markdown');
  assert.equal(plain.text, 'Idee\ndue uova  a casa');
  assert.equal(plain.text.slice(plain.at(source.indexOf('due')), plain.at(source.indexOf('** uo'))), 'due');
});
