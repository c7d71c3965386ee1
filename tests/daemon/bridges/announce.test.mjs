// SPDX-License-Identifier: GPL-3.0-or-later
// faccia-say: the exit status tells a shell script what became of an announcement.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { saidBy } from '../../lib/command.mjs';
import { build, Daemon } from '../../lib/daemon.mjs';

let daemon, kiosk;
before(async () => {
  daemon = await Daemon.start(['--hold', '2', '--recogniser', 'cat >/dev/null; echo abbastanza bene']);
  kiosk = await daemon.stream('?lang=it&room=kitchen');
  await kiosk.wait({ type: 'joined' });
});
after(async () => {
  await kiosk.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

/** Runs faccia-say. Returns its status and standard error. */
async function run(options, { input, url = daemon.url, env = {}, argv0 } = {}) {
  const child = spawn(path.join(build, 'server/bridges/faccia-say'), options, { argv0, env: { ...process.env, FACCIA_URL: url, ...env } });
  let stderr = '', stdout = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (stderr += text));
  child.stdout.setEncoding('utf8').on('data', (text) => (stdout += text));
  child.stdin.end(input);
  const [status] = await once(child, 'close');
  return { status, stderr: saidBy(stderr), ...(stdout ? { stdout } : {}) };
}
const kitchen = ['--room', 'kitchen', '--lang', 'it'];

test('accepts an announcement at once; --wait waits until it is heard', async () => {
  assert.deepEqual(await run([...kitchen, 'La cena', 'è pronta.']), { status: 0, stderr: '' });
  const { id } = await kiosk.wait({ type: 'begin' });
  assert.deepEqual((await kiosk.wait({ type: 'sentence', id })).text, 'La cena è pronta.');
  await kiosk.wait({ type: 'end', id, reason: 'done' });
  kiosk.messages.length = 0;
  assert.deepEqual(await run([...kitchen, '--wait', '-'], { input: 'Buon appetito.' }), { status: 0, stderr: '' });
  assert.ok(kiosk.messages.some((m) => m.type === 'end' && m.reason === 'done'), 'it was heard before');
});

test('exits with status 3 without a listener: at once, or when a held announcement expires', async () => {
  assert.equal((await run(['--room', 'cellar', '--lang', 'it', 'Ciao.'])).status, 0); // held until a listener joins
  const given = await run(['--room', 'cellar', '--lang', 'it', '--wait', 'Ciao.']);
  assert.equal(given.status, 3);
  assert.match(given.stderr, /no listener joined/);
  const own = await Daemon.start();
  assert.equal((await run(['--room', 'cellar', '--lang', 'it', 'Ciao.'], { url: own.url })).status, 3);
  assert.equal((await own.stop()).code, 0);
});

test('reports an interrupted announcement; --if-quiet does not interrupt other speech', async () => {
  kiosk.messages.length = 0;
  const waits = run([...kitchen, '--wait', '--priority', 'background', 'Una storia che nessuno ascolterà fino alla fine, perché qualcosa la interrompe molto prima. '.repeat(20)]);
  await kiosk.wait({ type: 'begin' });
  assert.equal((await run([...kitchen, '--if-quiet', 'Ehi.'])).status, 4);
  assert.equal((await run([...kitchen, '--wait', '-p', 'alarm', 'Al fuoco!'])).status, 0);
  assert.equal((await waits).status, 5);
});

test('has a bell sound before it', async () => {
  kiosk.messages.length = 0;
  assert.equal((await run([...kitchen, '--bell', '--wait', 'È pronto.'])).status, 0);
  assert.equal((await kiosk.wait({ type: 'begin' })).bell, true);
  assert.ok((await kiosk.wait({ type: 'word' })).time >= 1.39);
});

test('reports invalid input', async () => {
  assert.equal((await run([])).status, 2);
  assert.equal((await run(['--help'])).status, 0);
  assert.equal((await run(['--nothing', 'x'])).status, 2);
  assert.equal((await run([...kitchen, '-'], { input: 'a\0b' })).status, 2);
  assert.equal((await run(['x'], { url: 'kitchen' })).status, 2);
  for (const [options, message] of [
    [['--room', 'no spaces', 'x'], /letters, digits/],
    [[...kitchen, '--priority', 'high', 'x'], /background, chat, alarm/],
    [[...kitchen, '--lang', 'xx', 'x', '--wait'], /xx/],
    [[...kitchen, '--token-file', '/nowhere', 'x'], /\/nowhere/],
  ]) {
    const { status, stderr } = await run(options);
    assert.equal(status, 1, stderr);
    assert.match(stderr, message);
  }
  // also without waiting, when it does not follow the room
  for (const [option, value] of [['--lang', 'xx'], ['--voice', 'nobody:x'], ['--markup', 'nroff']]) {
    const { status, stderr } = await run(['--room', 'kitchen', option, value, 'x']);
    assert.deepEqual([status, stderr.includes(value)], [1, true], stderr);
  }
  const gone = await run([...kitchen, 'x'], { url: 'http://127.0.0.1:9' });
  assert.equal(gone.status, 1);
  assert.match(gone.stderr, /connect/i);
});

test('exits with status 6, unheard, while every browser blocks the sound, and succeeds once one plays it', async () => {
  kiosk.send({ type: 'media', blocked: true });
  const blocked = await run([...kitchen, '--wait', 'Ciao.']);
  assert.equal(blocked.status, 6);
  assert.match(blocked.stderr, /clicks or taps/);
  const other = await daemon.stream('?lang=it&room=kitchen');
  await other.wait({ type: 'joined' });
  assert.equal((await run([...kitchen, '--wait', 'Ciao.'])).status, 0, 'another one hears it');
  await other.close();
  kiosk.send({ type: 'media', blocked: 1 });
  await kiosk.wait({ type: 'error', code: 'bad-field', field: 'blocked' });
  kiosk.send({ type: 'media', blocked: false });
  assert.equal((await run([...kitchen, '--wait', 'Ciao.'])).status, 0);
});

test('sends a token to a daemon that requires one', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  const [secret, token] = ['secret', 'token'].map((name) => path.join(folder, name));
  fs.writeFileSync(secret, `${'s'.repeat(40)}\n`, { mode: 0o600 });
  const own = await Daemon.start(['--secret-file', secret, '--hold', '60']);
  const signed = spawn(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secret, '-s', 'cron'], { stdio: ['ignore', fs.openSync(token, 'w'), 'inherit'] });
  await once(signed, 'close');
  const refused = await run([...kitchen, 'Ciao.'], { url: own.url });
  assert.equal(refused.status, 1);
  assert.match(refused.stderr, /token/);
  assert.equal((await run([...kitchen, '--token-file', token, 'Ciao.'], { url: own.url })).status, 0);
  assert.equal((await own.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

test('faccia-ask without --choices prints what somebody says; status 7 if nobody does, 3 if nobody is there', async () => {
  kiosk.messages.length = 0;
  const ask = (...words) => run([...kitchen, ...words], { argv0: 'faccia-ask' });
  const asked = ask('Come sta?');
  const { id } = await kiosk.wait({ type: 'asked', question: 'Come sta?', seconds: 60 });
  assert.ok(kiosk.messages.some((m) => m.type === 'end' && m.id === id));
  kiosk.send({ type: 'hear', id: 'h', rate: 16000 });
  kiosk.send({ type: 'close', id: 'h' });
  assert.deepEqual(await asked, { status: 0, stderr: '', stdout: 'abbastanza bene\n' });
  assert.deepEqual(await ask('--seconds', '1', 'Nessuno?'), { status: 7, stderr: 'faccia-ask: nobody has answered\n' });
  const replaced = ask('E adesso?');
  await kiosk.wait({ type: 'asked', question: 'E adesso?' });
  kiosk.send({ type: 'ask', lang: 'it', text: 'Altro?', seconds: 1 });
  assert.deepEqual(await replaced, { status: 7, stderr: 'faccia-ask: the question was withdrawn\n' });
  const nobody = await run(['--room', 'attic', '--lang', 'it', 'Chi è là?'], { argv0: 'faccia-ask' });
  assert.equal(nobody.status, 3, nobody.stderr);
});

test('--choices: prints the answer that somebody chooses, before or after the question is said', async () => {
  for (const early of [true, false]) {
    kiosk.messages.length = 0;
    const asked = run([...kitchen, '--choices', 'Sì|Non ancora', '--seconds', '60', 'Hai preso la medicina?']);
    const { id, question, choices } = await kiosk.wait({ type: 'choices' });
    assert.deepEqual([question, choices], ['Hai preso la medicina?', ['Sì', 'Non ancora']]);
    if (!early) await kiosk.wait({ type: 'end', id, reason: 'done' }, { milliseconds: 60000 });
    kiosk.send({ type: 'choose', id, choice: 1 });
    assert.deepEqual(await asked, { status: 0, stderr: '', stdout: 'Non ancora\n' });
  }
});

test('--choices: status 7 without an answer in time, or when others take its place; the answers are withdrawn', async () => {
  kiosk.messages.length = 0;
  const asked = run([...kitchen, '--choices', 'Sì|No', '--seconds', '1', 'Sei lì?']);
  await kiosk.wait({ type: 'choices', choices: ['Sì', 'No'] });
  assert.deepEqual(await asked, { status: 7, stderr: 'faccia-ask: nobody has chosen an answer\n' });
  await kiosk.wait({ type: 'choices', choices: [] });
  const replaced = run([...kitchen, '--choices', 'Sì|No', 'E adesso?']);
  await kiosk.wait({ type: 'choices', question: 'E adesso?' });
  kiosk.send({ type: 'choices', id: 'mine', choices: ['Tè', 'Caffè'] });
  assert.deepEqual(await replaced, { status: 7, stderr: 'faccia-ask: the question was withdrawn\n' });
  kiosk.send({ type: 'choose', id: 'mine', choice: 0 });
  await kiosk.wait({ type: 'chosen', id: 'mine' });
  const nobody = await run(['--room', 'attic', '--lang', 'it', '--choices', 'Sì|No', 'Chi è là?']);
  assert.equal(nobody.status, 3, nobody.stderr);
  const many = await run([...kitchen, '--choices', 'a|b|c|d|e|f|g|h|i', 'Quale?']);
  assert.equal(many.status, 1);
  assert.match(many.stderr, /up to 8 texts/);
  assert.equal((await run([...kitchen, '--choices', 'Sì|No', '--seconds', 'soon', 'Quando?'])).status, 2);
});
