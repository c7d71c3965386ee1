// SPDX-License-Identifier: GPL-3.0-or-later
// Films ordered from the daemon: they are those of `faccia film`, their progress is told, and nothing of them is left behind.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../lib/browser.mjs';
import { faccia } from '../lib/command.mjs';
import { Daemon, eventually } from '../lib/daemon.mjs';
import { descendantsOf, stillRunning } from '../lib/descendants.mjs';
import { parseFap } from '../lib/fapfile.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'film-jobs-'));
fs.mkdirSync(path.join(folder, 'works'));
fs.writeFileSync(path.join(folder, 'works/mare.txt'), 'Il mare\n\nIl mare è calmo.\n');
let daemon;
before(async () => {
  daemon = await Daemon.start(['--library', path.join(folder, 'works'), '--library-index', path.join(folder, 'index'), '--max-films', '3', '--film-seconds', '20']);
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library to be read');
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

const TEXT = '<speak>La mamma va. <break time="500ms"/> Il papà beve.</speak>';
const SAID = { lang: 'it', voice: 'espeak:it', markup: 'ssml', still: true, seed: 3 };
const SMALL = { size: '160x120', view: 'mouth', model: 'mara' };

const post = (order) => daemon.get('/v1/films', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(order) });
async function order(members) {
  const answer = await post({ text: TEXT, ...SAID, ...SMALL, ...members });
  assert.equal(answer.status, 202);
  const job = await answer.json();
  assert.equal(answer.headers.get('location'), `/v1/films/${job.id}`);
  return job;
}
const look = async ({ id }) => (await daemon.get(`/v1/films/${id}`)).json();
const remove = ({ id }) => daemon.get(`/v1/films/${id}`, { method: 'DELETE' });
async function finish(job, seen = () => {}) {
  return eventually(async () => {
    const now = await look(job);
    seen(now);
    return (now.state === 'done' || now.state === 'failed') && now;
  }, 'the film', 400000);
}
async function download({ film }, name) {
  const answer = await daemon.get(film);
  assert.equal(answer.status, 200);
  fs.writeFileSync(path.join(folder, name), Buffer.from(await answer.arrayBuffer()));
  return { file: path.join(folder, name), type: answer.headers.get('content-type') };
}
const ffmpeg = (args) => {
  const { status, stdout, stderr } = spawnSync('ffmpeg', ['-v', 'error', ...args], { maxBuffer: 1 << 30 });
  assert.equal(status, 0, String(stderr));
  return stdout;
};
const decode = (file) => ffmpeg(['-i', file, '-fps_mode', 'passthrough', '-f', 'rawvideo', '-pix_fmt', 'rgb24', '-']);

test('a film over HTTP has the pictures and the sound of faccia film', async () => {
  const shares = [];
  const done = await finish(await order({}), ({ progress }) => shares.push(progress));
  assert.equal(done.state, 'done', JSON.stringify(done));
  assert.ok(shares.every((share, k) => share >= (shares[k - 1] ?? 0)) && shares.some((share) => share > 0 && share < 1), `${shares}`);
  const { file, type } = await download(done, 'http.mp4');
  assert.equal(type, 'video/mp4');
  assert.equal(fs.statSync(file).size, done.bytes);
  const own = path.join(folder, 'own.mp4');
  const { status, stderr } = faccia(['film', '-o', own, '--lang', 'it', '--voice', 'espeak:it', '--markup', 'ssml', '--still', '--seed', '3', '--size', '160x120', '--view', 'mouth', '--model', 'mara', TEXT]);
  assert.equal(status, 0, stderr);
  const [http, mine] = [file, own].map(decode);
  assert.ok(http.length > 0 && http.equals(mine));
  const said = parseFap(String(faccia(['say', '--lang', 'it', '--voice', 'espeak:it', '--markup', 'ssml', '--still', '--seed', '3', '--fap', '-', TEXT]).bytes));
  assert.equal(http.length, said.frames.length * 160 * 120 * 3);
  const [sound, own_] = [file, own].map((name) => ffmpeg(['-i', name, '-f', 's16le', '-c:a', 'pcm_s16le', '-']));
  assert.ok(sound.equals(own_));
  assert.equal((await remove(done)).status, 204);
  assert.equal((await daemon.get(done.film)).status, 404);
});

test('a passage of the library, transparent, with captions, and a head that listens', async () => {
  const done = await finish(await order({ text: undefined, markup: undefined, passage: 'mare:1', model: 'samuel', format: 'webm', background: 'transparent', captions: 'track', size: '320x120', partner: 'bruno' }));
  assert.equal(done.state, 'done', JSON.stringify(done));
  const { file, type } = await download(done, 'passage.webm');
  assert.equal(type, 'video/webm');
  assert.match(String(ffmpeg(['-i', file, '-map', '0:s', '-f', 'webvtt', '-'])), /Il mare è calmo/);
  const first = ffmpeg(['-c:v', 'libvpx-vp9', '-i', file, '-frames:v', '1', '-f', 'rawvideo', '-pix_fmt', 'rgba', '-']);
  const alphas = [0, 80, 159, 160, 240, 319].map((x) => first[4 * (320 * 60 + x) + 3] > 128); // through both mouths
  assert.deepEqual(alphas, [false, true, false, false, true, false]);
  await remove(done);
});

test('only so many are kept, one that is stopped leaves nothing, and too long a text fails', async () => {
  const jobs = [await order({}), await order({}), await order({})];
  const full = await post({ text: 'Ciao.', lang: 'it' });
  assert.deepEqual([full.status, (await full.json()).code], [503, 'queue-full']);
  await eventually(async () => (await look(jobs[0])).state === 'drawing', 'a film that is drawn');
  assert.equal((await remove(jobs[0])).status, 204);
  await eventually(async () => (await look(jobs[1])).state === 'drawing', 'the next one');
  const long = await order({ text: 'Ciao. '.repeat(200), markup: 'plain' });
  for (const job of jobs.slice(1)) await remove(job);
  const failed = await finish(long);
  assert.deepEqual([failed.state, failed.error.code, failed.error.message], ['failed', 'text-too-long', 'a film may take at most 20 seconds']);
  const others = [await order({}), await order({}), await order({})]; // the last in place of the one that failed
  assert.equal((await daemon.get(`/v1/films/${long.id}`)).status, 404);
  for (const job of others) await remove(job);
});

test('a film ends with a killed daemon, and so do its browser and its coder', async () => {
  const killed = await Daemon.start(['--film-seconds', '600']);
  const answer = await killed.get('/v1/films', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ ...SAID, ...SMALL, markup: 'plain', text: 'Ciao. '.repeat(200) }) });
  const { id } = await answer.json();
  await eventually(async () => (await (await killed.get(`/v1/films/${id}`)).json()).progress > 0, 'a picture', 400000);
  const all = descendantsOf(killed.process.pid);
  for (const pattern of [/faccia .*film/, /chromium/, /^ffmpeg/]) assert.ok(all.some(({ command }) => pattern.test(command)), `${pattern} ${JSON.stringify(all)}`);
  killed.process.kill('SIGKILL');
  await killed.exited;
  await eventually(() => stillRunning(all).length === 0, 'all to end', 60000).catch((error) => assert.fail(`${error.message}: ${JSON.stringify(stillRunning(all))}`));
});

test('pictures of a moment and of an expression are those of faccia film', async () => {
  const rgb = 160 * 120 * 3;
  const taken = async (name, members) => {
    const done = await finish(await order({ format: 'png', ...members }));
    assert.equal(done.state, 'done', JSON.stringify(done));
    const { file, type } = await download(done, name);
    await remove(done);
    assert.equal(type, 'image/png');
    return decode(file);
  };
  const own = (name, ...args) => {
    const { status, stderr } = faccia(['film', '-o', path.join(folder, name), '--size', '160x120', '--view', 'mouth', '--model', 'mara', ...args]);
    assert.equal(status, 0, stderr);
    return decode(path.join(folder, name));
  };
  const moment = await taken('moment.png', { at: 0.28 });
  assert.equal(moment.length, rgb);
  assert.ok(moment.equals(own('own-moment.png', '--lang', 'it', '--voice', 'espeak:it', '--markup', 'ssml', '--still', '--seed', '3', '--at', '0.28', TEXT)));
  const none = { text: undefined, markup: undefined, voice: undefined, lang: undefined };
  const joy = await taken('joy.png', { ...none, expression: 'joy' });
  assert.ok(joy.length === rgb && joy.equals(own('own-joy.png', '--expression', 'joy')));
  assert.ok(!joy.equals(own('half.png', '--expression', 'affect:joy=0.2')));
  const late = await finish(await order({ format: 'png', at: 99 }));
  assert.deepEqual([late.state, late.error.code], ['failed', 'film-failed']);
  assert.match(late.error.message, /99 is after the end/);
  await remove(late);
});

test('one client cannot take all places', async () => {
  const other = await Daemon.start(['--max-films', '4', '--max-films-per-client', '2']);
  const { hostname, port } = new URL(other.url);
  const send = (localAddress, text = 'Ciao. '.repeat(40)) => new Promise((resolve, reject) => {
    const request = http.request({ hostname, port, path: '/v1/films?lang=it&size=160x120', method: 'POST', localAddress }, (answer) => {
      answer.setEncoding('utf8');
      let body = '';
      answer.on('data', (data) => (body += data));
      answer.on('end', () => resolve({ status: answer.statusCode, ...JSON.parse(body) }));
    });
    request.on('error', reject);
    request.end(text);
  });
  const first = [await send('127.0.0.1'), await send('127.0.0.1'), await send('127.0.0.1')];
  assert.deepEqual(first.map(({ status }) => status), [202, 202, 503]);
  assert.deepEqual([first[2].code, first[2].message], ['queue-full', '2 films of this client are being made or are waiting']);
  const second = await send('127.0.0.2');
  assert.equal(second.status, 202);
  for (const { id } of [first[0], first[1], second]) await other.get(`/v1/films/${id}`, { method: 'DELETE' });
  await other.stop();
});

test('a daemon removes what a killed one has left', async () => {
  const mine = () => fs.readdirSync('/tmp').filter((name) => name.startsWith('faccia-films-')).map((name) => `/tmp/${name}`);
  const before = mine();
  const living = await Daemon.start();
  await living.get('/v1/films?lang=it&size=160x120', { method: 'POST', body: 'Ciao. '.repeat(20) });
  const [held] = mine().filter((name) => !before.includes(name));
  const left = fs.mkdtempSync('/tmp/faccia-films-');
  fs.writeFileSync(path.join(left, 'one.wav'), 'sound');
  for (const name of [held, left]) fs.utimesSync(name, new Date(0), new Date(0));
  const next = await Daemon.start();
  assert.deepEqual([held, left].map((name) => fs.existsSync(name)), [true, false]);
  await next.stop();
  await living.stop();
});

test('the first page downloads a film, and stops one', async () => {
  const browser = await launch({ webgl: false });
  const page = await browser.newPage({ locale: 'it-IT' });
  await page.goto(daemon.url);
  await page.waitForFunction(() => document.querySelector('#voice').options.length > 1);
  await page.fill('#text', 'Ciao mamma.');
  await page.click('#film');
  assert.equal(await page.textContent('#film'), 'Interrompi il filmato');
  await page.click('#film');
  await page.waitForFunction(() => document.querySelector('#film').textContent === 'Scarica un filmato');
  assert.equal(await page.isVisible('#film-progress'), false);
  const downloaded = page.waitForEvent('download', { timeout: 400000 });
  await page.click('#film');
  await page.waitForFunction(() => document.querySelector('#film-progress').value > 0, null, { timeout: 400000 });
  const download = await downloaded;
  assert.equal(download.suggestedFilename(), 'faccia.mp4');
  await download.saveAs(path.join(folder, 'page.mp4'));
  const length = decode(path.join(folder, 'page.mp4')).length;
  assert.ok(length > 640 * 480 * 3 * 10 && length % (640 * 480 * 3) === 0, `${length}`);
  assert.equal(await page.textContent('#news'), 'Il filmato è tra i download.');
  await browser.close();
});

test('the library downloads a film of a section', async () => {
  const browser = await launch({ webgl: false });
  const page = await browser.newPage({ locale: 'it-IT' });
  await page.goto(`${daemon.url}/library.html#mare:1`);
  await page.waitForFunction(() => !document.querySelector('#film').hidden, null, { timeout: 100000 });
  await page.click('#more-controls summary');
  const downloaded = page.waitForEvent('download', { timeout: 400000 });
  await page.click('#film');
  assert.equal(await page.textContent('#film'), 'Interrompi il filmato');
  const download = await downloaded;
  assert.equal(download.suggestedFilename(), 'mare-1.mp4');
  await download.saveAs(path.join(folder, 'library.mp4'));
  const frames = decode(path.join(folder, 'library.mp4')).length / (640 * 480 * 3);
  assert.ok(Number.isInteger(frames) && frames > 20, `${frames}`);
  await page.waitForFunction(() => document.querySelector('#film').textContent === 'Scarica un filmato');
  await page.route('**/v1/films', (route) => route.fulfill({ status: 503, contentType: 'application/json', body: '{"code":"queue-full","message":"8 films are being made or are waiting"}' }));
  await page.click('#film');
  await page.waitForFunction(() => document.querySelector('#problem').textContent);
  assert.equal(await page.textContent('#film'), 'Scarica un filmato');
  await browser.close();
});

for (const [what, members, code, field] of [
  ['a format', { format: 'avi' }, 'bad-field', 'format'],
  ['a file as background', { background: '/etc/passwd' }, 'bad-field', 'background'],
  ['a transparent MP4', { background: 'transparent' }, 'bad-field', 'background'],
  ['odd sides', { size: '161x120' }, 'bad-field', 'size'],
  ['a view', { view: 'back' }, 'bad-field', 'view'],
  ['a head', { model: '../mara' }, 'unknown-model', 'model'],
  ['a moment of an expression', { format: 'png', at: 0, expression: 'joy' }, 'bad-field', 'at'],
  ['a moment of a film', { at: 1 }, 'bad-field', 'at'],
  ['an expression', { format: 'png', expression: 'nothing' }, 'unknown-expression', 'expression'],
  ['a second head', { partner: '../mara' }, 'unknown-model', 'partner'],
  ['a voice', { voice: 'nobody' }, 'unknown-voice', 'voice'],
  ['an unfinished text', { open: true }, 'bad-field', 'open'],
])
  test(`refuses ${what}`, async () => {
    const answer = await post({ text: TEXT, ...SAID, ...SMALL, ...members });
    const error = await answer.json();
    assert.deepEqual([error.code, error.field], [code, field], JSON.stringify(error));
  });

test('says what is missing, and leaves no folder when it ends', async () => {
  const other = await Daemon.start(['--film-program', '/nowhere']);
  assert.deepEqual(await (await other.get('/v1/films')).json(), { available: false, why: "the server has no program 'faccia', which makes films" });
  const refused = await other.get('/v1/films', { method: 'POST', body: 'Ciao.' });
  assert.deepEqual([refused.status, (await refused.json()).code], [503, 'film-failed']);
  await other.stop();
  const folders = () => fs.readdirSync('/tmp').filter((name) => name.startsWith('faccia-films-'));
  const one = await Daemon.start();
  const before = folders();
  await one.get('/v1/films?lang=it&size=160x120', { method: 'POST', body: 'Ciao.' });
  const [made] = folders().filter((name) => !before.includes(name));
  assert.ok(made);
  assert.deepEqual(await one.stop(), { code: 0, signal: null });
  assert.ok(!folders().includes(made));
});
