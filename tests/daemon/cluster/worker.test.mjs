// SPDX-License-Identifier: GPL-3.0-or-later
// Voices on other machines: faccia-worker, daemons and a real Redis. Workers die, freeze or stop, and Redis is lost: another worker
// speaks the sentence, or it fails with an error that says why.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';
import { Redis } from '../../lib/redis.mjs';
import { bearer, sign } from '../../lib/tokens.mjs';
import { Worker } from '../../lib/worker.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-worker-'));
/** Makes a folder with these plugins. */
const plugins = (name, ...files) => {
  const at = path.join(folder, name);
  fs.mkdirSync(at);
  for (const file of files) fs.symlinkSync(path.join(build, file), path.join(at, path.basename(file)));
  return at;
};
const puppets = plugins('puppets', 'tests/plugins/puppet.so');
const near = plugins('near', 'server/plugins/espeak.so');
const far = plugins('far', 'server/plugins/command.so');
const both = plugins('both', 'server/plugins/espeak.so', 'tests/plugins/puppet.so');
const spoken = path.join(folder, 'spoken');
const gate = path.join(folder, 'gate');
// Logs a line for each sentence: the worker's pid and the text. Sentences that begin with "wait" wait until the gate is open.
const SCRIPT = `echo "$PPID $1" >> ${spoken}; case $1 in wait*) while [ ! -e ${gate} ]; do sleep 0.05; done;; esac; head -c 16000 /dev/zero`;
const config = path.join(folder, 'voices.json');
fs.writeFileSync(config, JSON.stringify({ command: { voices: [{ id: 'dear', lang: 'it', raw: 16000, argv: ['sh', '-c', SCRIPT, 'sh', '{text}'] }] } }));
const lines = () => (fs.existsSync(spoken) ? fs.readFileSync(spoken, 'utf8').trim().split('\n').filter(Boolean) : []);
const asked = (text) => lines().filter((line) => line.endsWith(text));
const open = (is) => (is ? fs.writeFileSync(gate, '') : fs.rmSync(gate, { force: true }));

const ask = (daemon, text, voice, format = 'json') =>
  daemon.get(`/v1/speech?format=${format}&lang=it&voice=${voice}`, { method: 'POST', body: text, headers: { 'content-type': 'text/plain' } });
async function say(daemon, text, voice = 'command:dear', format = 'json') {
  const response = await ask(daemon, text, voice, format);
  const body = Buffer.from(await response.arrayBuffer());
  assert.equal(response.status, 200, String(body));
  return body;
}
const voices = async (daemon) => (await (await daemon.get('/v1/voices')).json()).voices.map((voice) => voice.id);
const has = (daemon, voice, is = true) => eventually(async () => (await voices(daemon)).includes(voice) === is, `${voice} to be ${is ? '' : 'no longer '}there`);

let redis, one, two;
const running = new Set();
/** Starts a worker and waits until it announces its voices, because those of an earlier worker stay listed for a while. */
async function worker(...options) {
  const started = await Worker.start(['--cluster', redis.url, '--plugins', far, '--voice-config', config, '--sandbox', 'off', '--deadline-base', '60', ...options]);
  running.add(started);
  const ready = Date.now(), until = () => redis.cli('zrange', 'faccia:{work}:voices', '0', '-1', 'withscores').split('\n').map(Number);
  await eventually(() => until().some((ms) => ms > ready + 4000), 'its voices to be announced');
  return started;
}
async function dismiss(...workers) {
  for (const each of workers) {
    running.delete(each);
    assert.deepEqual(await each.stop(), { code: 0, signal: null }, each.log);
  }
}
const start = (...options) => Daemon.start(['--cluster', redis.url, '--plugins', near, '--cache', '0', '--deadline-base', '60', ...options]);

before(async () => {
  redis = await Redis.start({ password: 'p@ss:1', database: 1 });
  [one, two] = await Promise.all([start(), start()]);
});
after(async () => {
  open(true);
  for (const each of running) each.process.kill('SIGKILL');
  for (const daemon of [one, two]) assert.deepEqual(await daemon.stop(), { code: 0, signal: null }, daemon.log);
  redis.stop();
  fs.rmSync(folder, { recursive: true });
});

test('a voice on another machine sounds the same, sample for sample and phone for phone', async () => {
  const local = await Daemon.start(['--plugins', both]);
  const remote = await Daemon.start(['--cluster', redis.url, '--plugins', puppets]);
  const speaker = await Worker.start(['--cluster', redis.url, '--plugins', near]);
  await has(remote, 'espeak:it');
  const text = 'La mamma parla piano con Beppe. Quanti anni ha? Ne ha 42, <credo>.';
  for (const format of ['json', 'wav', 'textgrid'])
    assert.deepEqual(await say(remote, text, 'espeak:it', format), await say(local, text, 'espeak:it', format), format);
  const all = await voices(local);
  assert.deepEqual((await voices(remote)).sort(), all.sort());
  await dismiss(speaker);
  await has(remote, 'espeak:it', false);
  for (const daemon of [local, remote]) assert.deepEqual(await daemon.stop(), { code: 0, signal: null }, daemon.log);
});

test('two workers share the sentences', async () => {
  const workers = await Promise.all([worker(), worker()]);
  await Promise.all([has(one, 'command:dear'), has(two, 'command:dear')]);
  const before = lines().length;
  const all = [one, two].flatMap((daemon) => ['prima', 'seconda'].map((text) => say(daemon, `wait ${text} ${daemon.port}`)));
  await eventually(() => lines().length === before + 2, 'both to speak');
  assert.equal(new Set(lines().slice(before).map((line) => line.split(' ')[0])).size, 2);
  await eventually(async () => (await one.metric('faccia_cluster_queue_sentences{priority="live"}')) === 4, 'four to be counted');
  open(true);
  await Promise.all(all);
  assert.equal(lines().length, before + 4);
  await eventually(async () => (await one.metric('faccia_cluster_queue_sentences{priority="live"}')) === 0, 'none to be left');
  open(false);
  await dismiss(...workers);
});

for (const [signal, what] of [['SIGKILL', 'dies'], ['SIGSTOP', 'freezes'], ['SIGTERM', 'is ended']])
  test(`a worker that ${what} loses no sentence`, async () => {
    const text = `wait for ${what}`;
    const first = await worker();
    await has(one, 'command:dear');
    const answer = say(one, text);
    await eventually(() => asked(text).length === 1, 'the first to speak');
    const second = await worker();
    first.process.kill(signal);
    await eventually(() => asked(text).length === 2, 'the second to speak');
    open(true);
    assert.match(String(await answer), /"duration"/);
    if (signal === 'SIGSTOP') {
      // the frozen worker resumes, and its result is ignored
      first.process.kill('SIGCONT');
      await first.logged(/claimed by another worker, or (was|is) no longer needed/);
    }
    open(false);
    running.delete(first);
    if (signal === 'SIGSTOP') await dismiss(first);
    else assert.deepEqual(await first.exited, signal === 'SIGKILL' ? { code: null, signal } : { code: 0, signal: null });
    await dismiss(second);
  });

test('gives up a sentence that no worker survives', async () => {
  await has(one, 'command:dear', false);
  const text = 'wait for the end of all';
  let speaker = await worker();
  await has(one, 'command:dear');
  const answer = ask(one, text, 'command:dear');
  for (let times = 1; times <= 3; times++) {
    await eventually(() => asked(text).length === times, `it to be spoken ${times} times`);
    running.delete(speaker);
    const next = await worker();
    speaker.process.kill('SIGKILL');
    speaker = next;
  }
  const response = await answer;
  assert.equal(response.status, 500);
  assert.match((await response.json()).message, /workers crashed on the sentence/);
  await speaker.logged(/3 workers lost a sentence/);
  assert.equal(asked(text).length, 3);
  await dismiss(speaker);
});


/** Returns the only entry of all queues. */
const entry = () => {
  const key = redis.names('faccia:{work}:q:*').find((name) => redis.cli('xlen', name) !== '0');
  const fields = redis.cli('xrange', key, '-', '+').split('\n');
  return { key, to: fields.at(-1) };
};

test('live sentences precede prerendering', async () => {
  const works = path.join(folder, 'works');
  fs.mkdirSync(works);
  fs.writeFileSync(path.join(works, 'uno.it.txt'), 'wait ahead');
  const speaker = await worker();
  // a daemon without local voices waits for remote ones
  const ahead = await Daemon.start(['--cluster', redis.url, '--plugins', far, '--library', works, '--library-index', path.join(folder, 'index'), '--library-ahead', 'command:dear']);
  await ahead.logged(/ready: 1 voices/);
  await eventually(() => asked('wait ahead').length === 1, 'the work to be spoken ahead');
  await has(two, 'command:dear');
  const live = say(two, 'wait live');
  await eventually(() => asked('wait live').length === 1, 'who is heard to be spoken');
  assert.equal(asked('wait ahead').length, 1);
  await eventually(async () => (await two.metric('faccia_cluster_queue_sentences{priority="ahead"}')) === 1, 'the other to wait');
  const next = say(two, 'straight on');
  await eventually(async () => (await two.metric('faccia_cluster_queue_sentences{priority="live"}')) === 2, 'the next to wait');
  open(true);
  await Promise.all([live, next]);
  await eventually(() => asked('wait ahead').length === 2, 'the work to be spoken again');
  const order = lines().map((line) => line.slice(line.indexOf(' ') + 1));
  assert.deepEqual(order.slice(-4), ['wait ahead', 'wait live', 'straight on', 'wait ahead']);
  open(false);
  assert.deepEqual(await ahead.stop(), { code: 0, signal: null }, ahead.log);
  await dismiss(speaker);
});

/** The lane (0 to 15) of a subject's sentences: FNV-1a of its key. */
const lane = (subject) => [...`s ${subject}`].reduce((hash, c) => Math.imul(hash ^ c.charCodeAt(0), 16777619) >>> 0, 2166136261) % 16;

test('a client with many sentences does not delay another', async () => {
  const secret = 'a secret of thirty-two bytes or more';
  const file = path.join(folder, 'secrets');
  fs.writeFileSync(file, `${secret}\n`, { mode: 0o600 });
  const guarded = await start('--secret-file', file);
  const speaker = await worker();
  const other = ['berta', 'carla', 'dora'].find((name) => lane(name) !== lane('anna'));
  const by = async (sub, text) => {
    const { headers } = bearer(sign({ secret, claims: { sub } }));
    const response = await guarded.get('/v1/speech?format=json&lang=it&voice=command:dear', { method: 'POST', body: text, headers: { ...headers, 'content-type': 'text/plain' } });
    assert.equal(response.status, 200, await response.clone().text());
  };
  await eventually(async () => (await guarded.get('/v1/voices', bearer(sign({ secret })))).text().then((text) => text.includes('command:dear')), 'the voice');
  const all = [by('anna', 'wait anna')];
  await eventually(() => asked('wait anna').length === 1, 'the first to be spoken');
  const queued = (count) => eventually(() => redis.names('faccia:{work}:q:*').reduce((sum, key) => sum + Number(redis.cli('xlen', key)), 0) === count, `${count} in the queue`);
  const again = ['uno', 'due', 'tre', 'quattro', 'cinque'].map((word) => `anna again ${word}`); // words, because digits would be normalised
  for (const [i, text] of again.entries()) {
    all.push(by('anna', text));
    await queued(2 + i);
  }
  all.push(by(other, 'only once'));
  await queued(7);
  open(true);
  await Promise.all(all);
  open(false);
  const order = lines().slice(-7).map((line) => line.slice(line.indexOf(' ') + 1));
  assert.ok(order.indexOf('only once') <= 2, String(order));
  assert.deepEqual(order.filter((text) => text.startsWith('anna again')), again);
  assert.deepEqual(await guarded.stop(), { code: 0, signal: null }, guarded.log);
  await dismiss(speaker);
});

test('limits the queue, and reports when it is full', async () => {
  const bound = await start('--cluster-queue', '2');
  const speaker = await worker();
  await has(bound, 'command:dear');
  const first = say(bound, 'wait within');
  await eventually(() => asked('wait within').length === 1, 'the first to be spoken');
  const second = say(bound, 'within, too');
  await eventually(async () => (await bound.metric('faccia_cluster_queue_sentences{priority="live"}')) === 2, 'the second to wait');
  const third = await ask(bound, 'one too many', 'command:dear');
  assert.equal(third.status, 503);
  const error = await third.json();
  assert.deepEqual([error.code, error.message], ['voice-unavailable', 'the voice command is unavailable: its queue is full']);
  open(true);
  await Promise.all([first, second]);
  assert.equal(asked('one too many').length, 0);
  assert.match(String(await say(bound, 'room again')), /"duration"/);
  open(false);
  assert.deepEqual(await bound.stop(), { code: 0, signal: null }, bound.log);
  await dismiss(speaker);
});

test('stops a cancelled sentence at the worker', async () => {
  const speaker = await worker();
  await has(one, 'command:dear');
  const stream = await one.stream();
  stream.send({ type: 'speak', id: 'a', lang: 'it', voice: 'command:dear', text: 'wait for nobody' });
  await eventually(() => asked('wait for nobody').length === 1, 'it to be spoken');
  stream.send({ type: 'stop' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'stopped');
  await speaker.logged(/claimed by another worker, or is no longer needed/);
  assert.match(String(await say(one, 'and now another')), /"duration"/);
  await stream.close();
  await dismiss(speaker);
});

test('reports errors of a remote voice like those of a local one', async () => {
  const speaker = await Worker.start(['--cluster', redis.url, '--plugins', puppets, '--deadline-base', '1']);
  await has(one, 'puppet:plain');
  for (const [trick, code] of [['crash', 'voice-crashed'], ['hang', 'voice-timeout']]) {
    const response = await ask(one, trick, 'puppet:plain');
    assert.equal(response.status, 500);
    const error = await response.json();
    assert.equal(error.code, code);
    assert.match(error.message, /^the voice puppet /);
  }
  assert.match(String(await say(one, 'Poi si continua.', 'puppet:plain')), /"duration"/);
  assert.deepEqual(await speaker.stop(), { code: 0, signal: null }, speaker.log);
});

test('discards foreign data in Redis, with a line in the log, without affecting others', async () => {
  const speaker = await worker();
  await has(one, 'command:dear');
  const answer = say(one, 'wait among nonsense');
  await eventually(() => asked('wait among nonsense').length === 1, 'it to be spoken');
  const { key, to } = entry();
  assert.match(to, /^faccia:\{work\}:to:/);
  redis.cli('xadd', key, '*', 's', 'nonsense', 'r', to);
  redis.cli('xadd', key, '*', 's', 'fw1lnonsense', 'r', to);
  redis.cli('xadd', key, '*', 'other', 'fields');
  redis.cli('xadd', key, '*', 's', 'fw1l', 'r', 'somebody:elses:list');
  for (const junk of ['nonsense', 'fw1l', '']) redis.cli('rpush', to, junk);
  redis.cli('zadd', 'faccia:{work}:voices', '9999999999999', '../.. {}', '9999999999999', 'beef unheard-of');
  redis.cli('set', 'faccia:{work}:voices:beef', '{"voices":"none"}');
  redis.cli('lpush', 'faccia:{work}:q:beef:0:0', 'no stream');
  await one.logged(/ignored an invalid reply/);
  open(true);
  assert.match(String(await answer), /"duration"/);
  await speaker.logged(/discarded a queue entry that is not a sentence/);
  await speaker.logged(/cannot speak a queue entry: /);
  await eventually(() => redis.cli('xlen', key) === '0', 'the queue to be empty');
  assert.equal(redis.cli('exists', 'somebody:elses:list'), '0');
  assert.match(String(await say(one, 'nothing has happened')), /"duration"/);
  open(false);
  redis.cli('del', 'faccia:{work}:voices', 'faccia:{work}:voices:beef', 'faccia:{work}:q:beef:0:0');
  await dismiss(speaker);
});

test('answers survive a lost connection of the listening daemon', async () => {
  const speaker = await worker();
  await has(one, 'command:dear');
  const listening = () => redis.cli('client', 'list').split('\n').filter((line) => line.includes('cmd=blpop')).map((line) => line.match(/^id=(\d+)/)[1]);
  const before = await eventually(() => (listening().length === 2 ? listening() : null), 'both daemons to listen');
  for (const id of before) redis.cli('client', 'kill', 'id', id);
  assert.match(String(await say(one, 'Nessuno ascolta.')), /"duration"/);
  assert.ok(!listening().some((id) => before.includes(id)));
  await dismiss(speaker);
});

test('when Redis dies, sentences fail at once; when it is back, everything continues', async () => {
  const speaker = await worker();
  await has(one, 'command:dear');
  const answer = ask(one, 'wait for Redis', 'command:dear');
  await eventually(() => asked('wait for Redis').length === 1, 'it to be spoken');
  redis.stop();
  const response = await answer;
  assert.equal(response.status, 503);
  const error = await response.json();
  assert.deepEqual([error.code, error.message], ['voice-unavailable', 'the voice command is unavailable: its workers cannot be reached']);
  await one.logged(/\(work\): .*continuing without the cluster/);
  assert.match(String(await say(one, 'Da sola.', 'espeak:it')), /"duration"/);
  await has(one, 'command:dear', false);
  assert.equal((await ask(one, 'Chi parla?', 'command:dear')).status, 400);
  redis.again();
  await has(one, 'command:dear');
  open(true);
  assert.match(String(await say(one, 'Di nuovo.')), /"duration"/);
  open(false);
  // frozen, and resumed before its voices expire
  const frozen = ask(one, 'wait for the thaw', 'command:dear');
  await eventually(() => asked('wait for the thaw').length === 1, 'it to be spoken');
  redis.process.kill('SIGSTOP');
  assert.equal((await frozen).status, 503);
  redis.process.kill('SIGCONT');
  open(true);
  await eventually(async () => (await ask(one, 'E ancora.', 'command:dear')).status === 200, 'it to be spoken again');
  open(false);
  await dismiss(speaker);
});

test('a worker without work reports why', async () => {
  for (const [options, why] of [[['--plugins', far], /--cluster: is missing/], [['--cluster', 'nonsense', '--plugins', far], /it has no address of Redis/]]) {
    const speaker = await Worker.start(options);
    assert.deepEqual(await speaker.exited, { code: 1, signal: null });
    assert.match(speaker.log, why);
  }
});
