// SPDX-License-Identifier: GPL-3.0-or-later
// Several daemons and a real Redis: a sentence spoken by one is not synthesised by another, and without Redis each works alone.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { Redis } from '../../lib/redis.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-cluster-'));
const spoken = path.join(folder, 'spoken');
const PASSWORD = 'p@ss:1';
// A slow voice that logs a line for each sentence.
const SLOW = `echo "$1" >> ${spoken}; sleep 1.2; head -c 32000 /dev/zero`;
const config = path.join(folder, 'voices.json');
fs.writeFileSync(config, JSON.stringify({ command: { voices: [{ id: 'slow', lang: 'it', raw: 16000, argv: ['sh', '-c', SLOW, 'sh', '{text}'] }] } }));

let [redis, one, two] = [];
const cluster = async (daemon) => (await (await daemon.get('/healthz')).json()).cluster;
const is = (daemon, state) => eventually(async () => (await cluster(daemon)) === state, `the cluster to be ${state}`);
const counted = (daemon, result) => daemon.metric(`faccia_cluster_sentences_total{result="${result}"}`);
const lines = () => (fs.existsSync(spoken) ? fs.readFileSync(spoken, 'utf8').trim().split('\n').filter(Boolean).length : 0);
async function say(daemon, text, voice = 'espeak:it') {
  const response = await daemon.get(`/v1/speech?format=json&lang=it&voice=${voice}`, { method: 'POST', body: text, headers: { 'content-type': 'text/plain' } });
  assert.equal(response.status, 200, await response.clone().text());
  return response.text();
}
const start = (address = redis.url) => Daemon.start(['--cluster', address, '--voice-config', config, '--sandbox', 'off']);

before(async () => {
  redis = await Redis.start({ password: PASSWORD, database: 2 });
  [one, two] = await Promise.all([start(), start()]);
  await Promise.all([is(one, 'up'), is(two, 'up')]);
});
after(async () => {
  for (const daemon of [one, two]) assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  redis.stop();
  fs.rmSync(folder, { recursive: true });
});

/** Keys of the sentences in Redis, or [] while one is claimed. */
const sentences = () => (redis.names('*making').length ? [] : redis.names('*speech'));

test('reuses a sentence spoken by another daemon, unchanged', async () => {
  const text = 'La mamma parla piano con Beppe.';
  const first = await say(one, text);
  await eventually(() => sentences().length === 1, 'the sentence in Redis');
  assert.equal(await say(two, text), first);
  assert.deepEqual([await counted(one, 'miss'), await counted(two, 'hit'), await counted(two, 'miss')], [1, 1, 0]);
  // now the daemon's own cache has it, so Redis is not queried
  await say(two, text);
  assert.equal(await counted(two, 'hit'), 1);
  const left = Number(redis.cli('ttl', ...sentences()));
  assert.ok(left > 167 * 3600 && left <= 168 * 3600, `${left} s`);
});

test('simultaneous requests for a sentence wait for the one daemon that generates it', async () => {
  const before = lines();
  const answers = await Promise.all([one, two, one, two].map((daemon) => say(daemon, 'Una frase cara.', 'command:slow')));
  assert.equal(new Set(answers).size, 1);
  assert.equal(lines() - before, 1);
  assert.ok((await counted(one, 'waited')) + (await counted(two, 'waited')) >= 1);
});

test('speaks the sentence even when the generating daemon dies', async () => {
  const third = await start();
  await is(third, 'up');
  const before = lines();
  const lost = say(third, 'Una frase interrotta.', 'command:slow').catch(() => 'lost');
  await eventually(() => lines() === before + 1, 'the third to speak');
  const waiting = say(two, 'Una frase interrotta.', 'command:slow');
  await eventually(() => redis.names('*making').length, 'the claim');
  third.process.kill('SIGKILL');
  assert.equal(await lost, 'lost');
  assert.match(await waiting, /"duration"/);
  assert.equal(lines(), before + 2);
});

test('a daemon that gives up leaves the sentence to the next', async () => {
  const before = lines();
  const stream = await one.stream();
  stream.send({ type: 'speak', id: 'a', lang: 'it', voice: 'command:slow', text: 'Una frase lasciata.' });
  await eventually(() => lines() === before + 1, 'the first to speak');
  const other = say(two, 'Una frase lasciata.', 'command:slow');
  await eventually(async () => (await counted(two, 'waited')) > 0, 'the other to wait');
  stream.send({ type: 'stop' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'stopped');
  assert.match(await other, /"duration"/);
  assert.equal(lines(), before + 2);
  await stream.close();
});

test('generates a sentence again when its cached value is invalid', async () => {
  const text = 'Una frase guasta.';
  await eventually(() => !redis.names('*making').length, 'what was spoken before to be there');
  redis.cli('flushdb');
  await say(one, text);
  await eventually(() => sentences().length === 1, 'the value');
  redis.cli('set', ...sentences(), 'nonsense');
  const misses = await counted(two, 'miss');
  assert.match(await say(two, text), /"duration"/);
  assert.equal(await counted(two, 'miss'), misses + 1);
});

test('reports a full Redis once, and continues', async () => {
  redis.cli('config', 'set', 'maxmemory-policy', 'noeviction');
  redis.cli('config', 'set', 'maxmemory', '1mb');
  for (const text of ['Primo senza posto.', 'Secondo senza posto.']) assert.match(await say(one, text), /"duration"/);
  await one.logged(/refused a sentence: OOM/);
  assert.match(await say(one, 'Terzo senza posto.'), /"duration"/);
  await eventually(() => !redis.names('*making').length, 'the claims to be left');
  assert.equal(one.log.match(/refused a sentence/g).length, 1);
  redis.cli('config', 'set', 'maxmemory', '0');
  assert.ok(!one.log.includes('continuing without the cluster'));
});

test('waits for no Redis that hangs, dies and returns, and logs it', async () => {
  redis.process.kill('SIGSTOP');
  assert.match(await say(one, 'Redis sta fermo.'), /"duration"/);
  await is(one, 'away');
  await one.logged(/cluster: localhost:\d+: it does not answer; continuing without the cluster/);
  assert.ok(!one.log.includes(PASSWORD) && !one.log.includes(encodeURIComponent(PASSWORD)));
  redis.process.kill('SIGCONT');
  await is(one, 'up');
  redis.stop();
  await Promise.all([is(one, 'away'), is(two, 'away')]);
  assert.match(await say(two, 'Redis non risponde.'), /"duration"/);
  redis.again();
  await Promise.all([is(one, 'up'), is(two, 'up')]);
  const text = 'Redis risponde ancora.';
  const first = await say(one, text);
  await eventually(() => sentences().length === 1, 'the sentence in Redis');
  assert.equal(await say(two, text), first);
});

test('reports a Redis that refuses the login, and a server that is not Redis; speech continues', async () => {
  const liar = net.createServer((socket) => socket.on('error', () => {}).on('data', () => socket.write('HTTP/1.0 400 nonsense\r\n\r\n$5\r\n')));
  await new Promise((resolve) => liar.listen(0, '127.0.0.1', resolve));
  const cases = [
    [`redis://:wrong@127.0.0.1:${redis.port}`, /WRONGPASS/],
    [`redis://127.0.0.1:${liar.address().port}`, /it does not speak the protocol of Redis/],
    ['unix:///nowhere/at.all', /No such file/],
    ['redis://no-such-host.invalid', /cluster: no-such-host\.invalid:6379: /],
  ];
  await Promise.all(
    cases.map(async ([address, said]) => {
      const daemon = await start(address);
      await daemon.logged(said);
      assert.equal(await cluster(daemon), 'away');
      assert.match(await say(daemon, 'Da solo.'), /"duration"/);
      assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
    }),
  );
  liar.close();
});

test('refuses to start with an invalid address', async () => {
  await assert.rejects(start('localhost:6379'), /--cluster: it has no address of Redis: must be redis:\/\//);
});
