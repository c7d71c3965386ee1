// SPDX-License-Identifier: GPL-3.0-or-later
// The cache of sentences: nothing is synthesised twice, also after a restart.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-cache-'));
after(() => fs.rmSync(folder, { recursive: true }));

const text = 'Il mare era calmo. La barca partì. Il mare era calmo.';
const say = async (daemon, query = 'lang=it', what = text) => {
  const answers = await Promise.all(
    ['wav', 'json'].map((format) => daemon.get(`/v1/speech?${query}&format=${format}`, { method: 'POST', body: what, headers: { 'content-type': 'text/plain' } })),
  );
  assert.ok(answers.every((answer) => answer.ok));
  return { wav: Buffer.from(await answers[0].arrayBuffer()), json: await answers[1].json() };
};
const counts = async (daemon) => {
  const metrics = await (await daemon.get('/metrics')).text();
  return ['hit', 'miss'].map((result) => Number(metrics.match(new RegExp(`^faccia_cache_total\\{result="${result}"\\} (.*)$`, 'm'))[1]));
};

test('reuses the sound of the same sentence to the sample, with its words in their new positions', async () => {
  const daemon = await Daemon.start();
  const first = await say(daemon);
  const [hits, misses] = await counts(daemon);
  const second = await say(daemon);
  assert.ok(second.wav.equals((await say(daemon)).wav));
  assert.deepEqual(await counts(daemon), [hits + 12, misses]);
  assert.deepEqual(second.json.words.map((w) => w.text), first.json.words.map((w) => w.text));
  // a cached sentence elsewhere in a text: word offsets are those of the new place
  const moved = await say(daemon, 'lang=it', `Prima di tutto. ${text}`);
  const sea = moved.json.words.filter((w) => w.text === 'mare');
  assert.equal(sea.length, 2);
  assert.ok(sea[1].start > sea[0].start);
  // other prosody is another cache entry
  const [, before] = await counts(daemon);
  await say(daemon, 'lang=it&rate=250');
  await say(daemon, 'lang=it&pitch=1.5');
  await say(daemon, 'lang=tr');
  assert.ok((await counts(daemon))[1] >= before + 6);
  assert.equal((await daemon.stop()).code, 0);
});

test('without a cache generates every sentence again', async () => {
  const daemon = await Daemon.start(['--cache', '0']);
  await say(daemon);
  await say(daemon);
  assert.deepEqual(await counts(daemon), [0, 0]);
  assert.equal((await daemon.stop()).code, 0);
});

test('the disk cache survives the process, even when killed; a damaged file does no harm', async () => {
  const file = path.join(folder, 'cache');
  const options = ['--cache', '0', '--cache-file', file];
  let daemon = await Daemon.start(options);
  await say(daemon);
  const before = (await say(daemon)).wav;
  assert.equal((await daemon.stop()).code, 0);
  daemon = await Daemon.start(options);
  assert.ok(before.equals((await say(daemon)).wav));
  assert.equal((await counts(daemon))[1], 0);
  await say(daemon, 'lang=it', 'Una frase nuova.');
  daemon.process.kill('SIGKILL');
  await daemon.exited;
  daemon = await Daemon.start(options);
  assert.ok(before.equals((await say(daemon)).wav));
  assert.equal((await daemon.stop()).code, 0);
  // after the header, which identifies the file as a cache
  const handle = fs.openSync(file, 'r+');
  fs.writeSync(handle, 'x'.repeat(20000), 100);
  fs.closeSync(handle);
  daemon = await Daemon.start(options);
  assert.match(daemon.log, /recreating it/);
  assert.ok((await say(daemon)).wav.length > 10000);
  assert.equal((await daemon.stop()).code, 0);
});

test('prerenders works of the library with one voice within a limit, and serves requests from the cache', async () => {
  const works = path.join(folder, 'works');
  fs.mkdirSync(works);
  const paragraphs = (word) => Array.from({ length: 6 }, (_, i) => `${word} numero ${i + 1} torna a casa. Il vento porta l'odore del mare.`).join('\n\n');
  fs.writeFileSync(path.join(works, 'uno.it.txt'), paragraphs('La barca'));
  fs.writeFileSync(path.join(works, 'due.en.txt'), 'The clock is slow.');
  const options = ['--library', works, '--library-index', path.join(folder, 'index'), '--library-ahead', 'espeak:it'];
  let daemon = await Daemon.start(options);
  const ahead = async () => (await (await daemon.get('/v1/library')).json()).ahead;
  const until = (state, sections) => eventually(async () => { const now = await ahead(); return now?.state === state && now.done === sections && now; }, `${state} ${sections}`);
  const done = await until('done', 1);
  assert.deepEqual([done.voice, done.of, done.most], ['espeak:it', 1, 48 << 20]);
  assert.ok(done.bytes > 500000, `${done.bytes}`);
  assert.deepEqual([await daemon.metric('faccia_library_ahead_sections{which="done"}'), await daemon.metric('faccia_library_ahead_bytes')], [1, done.bytes]);
  const [hits, misses] = await counts(daemon);
  const asked = await daemon.get('/v1/speech?passage=uno-it:1:p2&voice=espeak:it&format=json');
  assert.equal((await asked.json()).words[0].text, 'La');
  assert.deepEqual(await counts(daemon), [hits + 2, misses]);
  fs.writeFileSync(path.join(works, 'tre.it.txt'), 'Un altro testo, che viene dopo.');
  await until('done', 2);
  assert.equal((await counts(daemon))[1], misses + 1, 'only what is new is spoken');
  assert.equal((await daemon.stop()).code, 0);

  daemon = await Daemon.start([...options, '--library-ahead-size', '1']);
  fs.writeFileSync(path.join(works, 'quattro.it.txt'), paragraphs('Il pescatore'));
  const full = await eventually(async () => { const now = await ahead(); return now?.state === 'full' && now; }, 'the bound');
  assert.ok(full.bytes >= 1 << 20 && full.bytes < 1.5 * 2 ** 20 && full.done < full.of, JSON.stringify(full));
  assert.equal((await daemon.stop()).code, 0);
  daemon = await Daemon.start([...options, '--library-ahead', 'espeak:nobody']);
  await daemon.logged(/prerendering is off: --library-ahead: .*nobody/);
  assert.equal((await daemon.stop()).code, 0);
});

test('leaves a file that is not a cache unchanged, and refuses to start, naming the option', async () => {
  const file = path.join(folder, 'letter');
  fs.writeFileSync(file, 'Dear Anna,\n');
  await assert.rejects(Daemon.start(['--cache-file', file]), /--cache-file: .*letter is not a sentence cache/);
  assert.equal(fs.readFileSync(file, 'utf8'), 'Dear Anna,\n');
  assert.deepEqual(fs.readdirSync(folder).filter((name) => name.startsWith('letter')), ['letter']);
});
