// SPDX-License-Identifier: GPL-3.0-or-later
// Requests right after the start get the same voice that they would get later.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, Daemon } from '../../lib/daemon.mjs';

// The plugin "sleepy" starts once a file exists. It has a French voice and sorts before espeak.
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-start-'));
const plugins = path.join(folder, 'plugins'), gate = path.join(folder, 'gate'), config = path.join(folder, 'voices.json');
fs.mkdirSync(plugins);
fs.symlinkSync(path.join(build, 'server/plugins/espeak.so'), path.join(plugins, 'espeak.so'));
fs.symlinkSync(path.join(build, 'tests/plugins/sleepy.so'), path.join(plugins, 'early.so'));
fs.writeFileSync(config, JSON.stringify({ early: { file: gate } }));
after(() => fs.rmSync(folder, { recursive: true }));

const start = (...options) => Daemon.start(['--plugins', plugins, '--voice-config', config, ...options], {}, { voices: false });
const wakeUp = () => fs.writeFileSync(gate, '');
const post = (daemon, query) =>
  daemon.get(`/v1/speech?format=json&${query}`, { method: 'POST', body: 'Bonjour.', headers: { 'content-type': 'text/plain' } });

test('requests wait only for the voice that they would get once all have started', async () => {
  fs.rmSync(gate, { force: true });
  const daemon = await start();
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'french', lang: 'fr', text: 'Bonjour.' });
  stream.send({ type: 'speak', id: 'marked', text: '<speak xml:lang="fr">Bonjour.</speak>' });
  stream.send({ type: 'speak', id: 'nobody', voice: 'early:nobody', text: 'Bonjour.' });
  const other = await daemon.stream();
  other.send({ type: 'speak', id: 'italian', lang: 'it', text: 'Buongiorno.' });
  const posted = [post(daemon, 'lang=fr'), post(daemon, 'voice=early:late'), post(daemon, 'voice=early:nobody')];
  // a request whose voice is already certain is spoken at once
  assert.equal((await other.wait({ type: 'begin', id: 'italian' })).voice, 'espeak:it+f2');
  assert.equal((await other.wait({ type: 'end', id: 'italian' })).reason, 'done');
  const health = await daemon.get('/healthz');
  assert.deepEqual([health.status, (await health.json()).status], [503, 'starting']);
  assert.doesNotMatch(daemon.log, /ready: /);
  assert.ok(!stream.messages.some((m) => m.type === 'begin' || m.type === 'error' || m.type === 'end'));
  wakeUp();
  for (const id of ['french', 'marked']) {
    assert.equal((await stream.wait({ type: 'begin', id })).voice, 'early:late');
    assert.equal((await stream.wait({ type: 'end', id })).reason, 'done');
  }
  assert.equal((await stream.wait({ type: 'error', id: 'nobody' })).code, 'unknown-voice');
  assert.equal((await stream.wait({ type: 'end', id: 'nobody' })).reason, 'failed');
  const [chosen, named, wrong] = await Promise.all(posted);
  assert.deepEqual([chosen.status, (await chosen.json()).voice], [200, 'early:late']);
  assert.equal(named.status, 200);
  assert.deepEqual([wrong.status, (await wrong.json()).code], [400, 'unknown-voice']);
  await daemon.logged(/ready: /);
  assert.equal((await daemon.get('/healthz')).status, 200);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('a voice that does not start delays requests only for the configured time', async () => {
  fs.rmSync(gate, { force: true });
  const daemon = await start('--voice-start', '15');
  const posted = [post(daemon, 'lang=fr'), post(daemon, 'voice=early:late')];
  await daemon.logged(/the voice early is slow to start/);
  const [other, named] = await Promise.all(posted);
  assert.deepEqual([other.status, (await other.json()).voice], [200, 'espeak:fr-fr']);
  assert.deepEqual([named.status, (await named.json()).code], [400, 'unknown-voice']);
  assert.equal((await daemon.get('/healthz')).status, 200);
  // the slow plugin is still used when it starts later
  wakeUp();
  let late;
  do late = await post(daemon, 'voice=early:late');
  while (late.status !== 200);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('health reports that no voice is available yet', async () => {
  fs.rmSync(gate, { force: true });
  const lonely = path.join(folder, 'lonely');
  fs.mkdirSync(lonely);
  fs.symlinkSync(path.join(build, 'tests/plugins/sleepy.so'), path.join(lonely, 'early.so'));
  fs.symlinkSync(path.join(build, 'tests/plugins/refuses.so'), path.join(lonely, 'refuses.so'));
  const daemon = await start('--plugins', lonely, '--voice-start', '10');
  const health = async () => {
    const answer = await daemon.get('/healthz');
    return [answer.status, await answer.json()];
  };
  assert.equal((await health())[1].status, 'starting');
  await daemon.logged(/no voice plugin could be started/);
  const [status, said] = await health();
  assert.deepEqual([status, said.status, said.reason], [503, 'unavailable', 'no voice plugin could be started']);
  assert.doesNotMatch(daemon.log, /ready: /);
  wakeUp();
  await daemon.logged(/ready: 1 voices/);
  assert.deepEqual([(await health())[0], (await health())[1].status, (await health())[1].reason], [200, 'ok', undefined]);
  assert.equal((await post(daemon, 'lang=fr')).status, 200);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('a waiting client may disconnect, and the daemon may be stopped meanwhile', async () => {
  fs.rmSync(gate, { force: true });
  const daemon = await start();
  const [gone, stays] = await Promise.all([daemon.stream(), daemon.stream()]);
  for (const stream of [gone, stays]) stream.send({ type: 'speak', id: 'a', lang: 'fr', text: 'Bonjour.' });
  const posted = post(daemon, 'lang=fr').catch(() => {});
  gone.socket.terminate();
  stays.send({ type: 'stop' });
  assert.equal((await stays.wait({ type: 'end', id: 'a' })).reason, 'stopped');
  stays.send({ type: 'speak', id: 'b', lang: 'fr', text: 'Bonjour.' });
  stays.send({ type: 'ping', id: 1 });
  await stays.wait({ type: 'pong', id: 1 });
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  await posted;
});

test('reports the service as ready when its voices are', () => {
  const script = `
import os, socket, subprocess, sys
heard = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
heard.bind(sys.argv[1] + '/notify')
child = subprocess.Popen(sys.argv[3:], env=dict(os.environ, NOTIFY_SOCKET=sys.argv[1] + '/notify'), stderr=subprocess.PIPE, text=True)
for line in child.stderr:
    if 'listening' in line:
        break
heard.settimeout(0.5)
try:
    print(heard.recv(4096).decode())
except TimeoutError:
    print('nothing yet')
open(sys.argv[2], 'w').close()
heard.settimeout(20)
print(heard.recv(4096).decode().split('\\n')[0])
child.terminate()
child.stderr.read()
print(child.wait())
`;
  fs.rmSync(gate, { force: true });
  const daemon = path.join(build, 'server/daemon/facciad');
  const args = ['-c', script, folder, gate, daemon, '--port', '0', '--plugins', plugins, '--voice-config', config];
  const { stdout, stderr } = spawnSync('python3', args, { encoding: 'utf8', timeout: 60000 });
  assert.equal(stdout, 'nothing yet\nREADY=1\n0\n', stderr);
});
