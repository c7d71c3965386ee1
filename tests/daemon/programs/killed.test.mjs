// SPDX-License-Identifier: GPL-3.0-or-later
// What a killed daemon has started ends with it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { descendantsOf, stillRunning } from '../../lib/descendants.mjs';

test('voices and recognisers end with a killed daemon, even those that are busy', async () => {
  // `exec` tells which is the command: it neither reads nor writes, so that nothing else ends it
  const daemon = await Daemon.start(['--recogniser', 'exec sleep 600']);
  const stream = await daemon.stream();
  stream.send({ type: 'hear', id: 'h', codec: 'pcm_s16le', rate: 16000, lang: 'en' });
  stream.socket.send(Buffer.alloc(3200));
  stream.send({ type: 'speak', text: 'Il mare è calmo. '.repeat(300), lang: 'it' });
  await stream.wait({ type: 'begin' });
  const named = (all, pattern) => all.filter(({ command }) => pattern.test(command));
  const all = await eventually(() => {
    const now = descendantsOf(daemon.process.pid);
    return named(now, /^sleep 600$/).length && now;
  }, 'the recogniser');
  assert.ok(named(all, /faccia-voice/).length >= 1, JSON.stringify(all));
  assert.deepEqual(stillRunning(all).length, all.length);
  daemon.process.kill('SIGKILL');
  await daemon.exited;
  await eventually(() => stillRunning(all).length === 0, 'all to end', 60000).catch((error) => assert.fail(`${error.message}: ${JSON.stringify(stillRunning(all))}`));
});
