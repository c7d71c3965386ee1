// SPDX-License-Identifier: GPL-3.0-or-later
// Memory used for a greedy client returns to the system after it disconnects; a modest client is served meanwhile.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { build, Daemon, Stream, eventually } from '../../lib/daemon.mjs';

const sanitized = fs.readFileSync(path.join(build, 'server/daemon/facciad')).includes('__asan_init');
const skip = sanitized && 'the sanitizer has an allocator of its own, which keeps what was freed; tests/run.sh runs it in the ordinary build, too ("limits")';
const CONNECTIONS = 40, MB = 1 << 20;

test('returns memory to the system', { skip }, async (t) => {
  const daemon = await Daemon.start(['--max-rooms', '300', '--max-message', String(2 * MB), '--max-text', String(2 * MB), '--open-seconds', '60']);
  const resident = () => Number(fs.readFileSync(`/proc/${daemon.process.pid}/status`, 'utf8').match(/VmRSS:\s+(\d+)/)[1]) / 1024; // MB
  const modest = await daemon.stream('?room=modest');
  let said = 0;
  const serve = async () => {
    modest.send({ type: 'speak', id: `u${++said}`, lang: 'it', text: `Frase ${said}.` });
    await modest.wait({ type: 'end', id: `u${said}`, reason: 'done' }, { milliseconds: 60000 });
  };
  await serve();
  const before = resident();
  const address = `ws://127.0.0.1:${daemon.port}/v1/stream?audio=none&fap=none`;
  const greedy = [];
  for (let i = 0; i < CONNECTIONS; i++) {
    const stream = await Stream.open(address, { localAddress: '127.0.0.2' });
    greedy.push(stream);
    stream.send({ type: 'join', room: `greedy-${i}`, id: 'j' });
    // an open text stays in memory, and so do the texts that wait behind it
    stream.send({ type: 'speak', open: true, id: 'o', lang: 'it', text: '' });
    for (let k = 0; k < 4; k++) stream.send({ type: 'speak', id: `w${k}`, lang: 'it', text: `Parola ${i} ${k}. `.repeat(8000) });
  }
  await eventually(() => resident() > before + 100, 'the daemon to take memory', 120000);
  await serve();
  const most = resident();
  for (const stream of greedy) stream.socket.terminate();
  await daemon.left(3);
  await eventually(async () => {
    await serve();
    return resident() < before + 48;
  }, `memory to be given back: ${before.toFixed()} MB before, ${most.toFixed()} MB at most`, 60000);
  t.diagnostic(`${before.toFixed()} MB before, ${most.toFixed()} MB at most, ${resident().toFixed()} MB after`);
  await modest.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});
