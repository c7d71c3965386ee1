// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the examples of protocol/scripting.md as printed, with another port.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, root } from '../../lib/daemon.mjs';

const text = fs.readFileSync(path.join(root, 'protocol/scripting.md'), 'utf8');
const examples = [...text.matchAll(/```(\w+)(?: (\w+)=(\w+))?\n([^]*?)```/g)].map(([, language, key, value, code]) => ({ language, [key]: value, code }));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-scripting-'));

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

/** Runs a program in the folder and returns its output. Its standard input stays open like a terminal unless given. */
async function run(program, args, stdin) {
  const child = spawn(program, args, {
    cwd: folder,
    // faccia as built; wscat from npm; python3 is Debian's, as its package with the library is
    env: { ...process.env, PATH: `${path.join(build, 'server/cli')}:${path.join(build, 'server/daemon')}:${path.join(root, 'tests/node_modules/.bin')}:/usr/bin:${process.env.PATH}` },
  });
  if (stdin) child.stdin.end(stdin === 'text' ? 'La mamma parla.\nIl papà no.\n' : '');
  let out = '', complaints = '';
  child.stdout.setEncoding('utf8').on('data', (piece) => (out += piece));
  child.stderr.setEncoding('utf8').on('data', (piece) => (complaints += piece));
  const [status] = await once(child, 'close');
  assert.equal(status, 0, `${complaints}\n${out}`);
  return out;
}

const interpreters = {
  sh: (code, stdin) => run('sh', ['-ec', code], stdin),
  python: (code, stdin) => run('python3', ['-c', code], stdin),
  js: (code) => {
    // in a folder where it finds the package ws
    fs.writeFileSync(path.join(folder, 'script.mjs'), code);
    fs.rmSync(path.join(folder, 'node_modules'), { force: true });
    fs.symlinkSync(path.join(root, 'tests/node_modules'), path.join(folder, 'node_modules'));
    return run(process.execPath, ['script.mjs']);
  },
};

test('every example is in a language that this test runs', () => {
  assert.ok(examples.length >= 8);
  for (const { language } of examples) assert.ok(language in interpreters, language);
});

for (const { language, room, needs, stdin, code } of examples) {
  const missing = needs && spawnSync('which', [needs]).status !== 0;
  test(`${language}: ${code.split('\n')[0]}`, { skip: missing && `${needs} is not installed` }, async () => {
    const listener = room && (await daemon.stream(`?room=${room}`));
    await listener?.wait({ type: 'joined' });
    const out = await interpreters[language](code.replaceAll('127.0.0.1:8080', `127.0.0.1:${daemon.port}`), stdin ?? (code.includes('sys.stdin') && 'text'));
    assert.doesNotMatch(out, /error/);
    if (code.includes('faccia read')) assert.match(out, /signor\tSig\.[^]*Il signor Rossi paga tre euro e cinquanta\n/);
    else if (!/-o /.test(code) && !room) assert.match(out, /mamma/);
    if (code.includes('faccia.text.v1')) assert.match(out, /word [\d.]+ mamma[^]*end done/);
    if (room) await listener.wait({ type: 'end' });
    if (code.includes('/v1/play')) {
      // the uploaded recording may have been stopped in the middle
      const end = await listener.wait((m) => m.type === 'end' && m.utterance === 3);
      assert.ok(['stopped', 'done'].includes(end.reason), end.reason);
    }
    if (code.includes('/v1/events')) assert.match(out, /event: word\ndata: \{.*"text":"mi"/);
    await listener?.close();
  });
}

test('answers a close in the text protocol when everything has been spoken', async () => {
  const { default: WebSocket } = await import('ws');
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream?lang=it`, ['faccia.text.v1']);
  const lines = [];
  socket.on('message', (data) => lines.push(String(data)));
  await once(socket, 'open');
  socket.send('La mamma parla piano, e il papà la ascolta.');
  socket.send('Poi tace.');
  socket.close(1000);
  const [code] = await once(socket, 'close');
  assert.equal(code, 1000);
  assert.equal(lines.filter((line) => line.startsWith('end done')).length, 2, lines.join('\n'));
  // a client with nothing to receive can disconnect at once
  const silent = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream`, ['faccia.text.v1']);
  await once(silent, 'open');
  silent.close();
  await once(silent, 'close');
});

test('text clients get all events as lines, also when they join late', async () => {
  const { default: WebSocket } = await import('ws');
  const open = async (query) => {
    const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream?${query}`, ['faccia.text.v1']);
    const lines = [];
    socket.on('message', (data) => lines.push(String(data)));
    await once(socket, 'open');
    const until = async (pattern, least = 1) => {
      while (lines.filter((line) => pattern.test(line)).length < least) await once(socket, 'message');
      return lines.find((line) => pattern.test(line));
    };
    return { send: (line) => socket.send(line), lines, until, close: () => socket.close() };
  };
  const first = await open('lang=it&room=righe&markup=ssml&phones=1');
  first.send('<speak>La mamma <mark name="qui"/> parla piano, e <nonsense/> il papà la ascolta volentieri tutta la sera.</speak>');
  await first.until(/^word [\d.]+ mamma$/);
  const second = await open('lang=it&room=righe');
  await second.until(/^begin \S+$/);
  await second.until(/^sentence 0\.000 [\d.]+$/);
  await second.until(/^word [\d.]+ mamma$/);
  second.send('/pause');
  await first.until(/^paused [\d.]+$/);
  second.send('/jump qui');
  await first.until(/^jumped [\d.]+ qui$/);
  second.send('/resume');
  await first.until(/^resumed [\d.]+$/);
  await second.until(/^word [\d.]+ papà$/);
  await first.until(/^phone [\d.]+ m$/);
  await first.until(/^mark [\d.]+ qui$/);
  await first.until(/^warning \S+ .* \(line 1, column \d+\)$/);
  await second.until(/^end done [\d.]+$/);
  second.send('/lang xx');
  second.send('Sì.');
  assert.match(await second.until(/^error /), /^error unknown-language lang /);
  second.send('/fly');
  await second.until(/^error unknown-command /);
  second.send('/leave');
  await second.until(/^left righe$/);
  for (const line of [...first.lines, ...second.lines]) assert.doesNotMatch(line, /[{}\n]|undefined|null/, line);
  first.close();
  second.close();
});

test('files written by curl have the types that their names say', () => {
  const bytes = (name) => fs.readFileSync(path.join(folder, name));
  assert.equal(bytes('mamma.wav').toString('latin1', 0, 4), 'RIFF');
  assert.equal(bytes('mamma.ogg').toString('latin1', 28, 36), 'OpusHead');
  assert.match(bytes('mamma.fap').toString('latin1', 0, 4), /^2\.1 /);
});
