// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon's file of secrets and the bridges' file of a token are not mixed up: neither takes the other's, and no secret is ever sent.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build } from '../../lib/daemon.mjs';
import { sign } from '../../lib/tokens.mjs';

const secret = 'c2VjcmV0IHRoYXQgc2lnbnMgdG9rZW5zLCBsb25nIGVub3VnaA==';
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bridge-tokens-'));
const file = (name, text) => {
  const where = path.join(folder, name);
  fs.writeFileSync(where, text, { mode: 0o600 });
  return where;
};

// collects what a bridge would send to a daemon
let listener, sent = '';
before(async () => {
  listener = net.createServer((socket) => socket.on('data', (data) => (sent += data)).on('error', () => {}));
  await new Promise((resolve) => listener.listen(0, '127.0.0.1', resolve));
});
after(() => {
  listener.close();
  fs.rmSync(folder, { recursive: true });
});

const bridges = { 'faccia-say': ['x'], 'faccia-live': ['x.wav'], 'faccia-mqtt': [], 'faccia-wyoming': ['--listen', '127.0.0.1:0'], 'faccia-satellite': ['--listen', '127.0.0.1:0'], 'faccia-lva': [] };
const nothing = { secret: `${secret}\n`, 'two parts': 'abc.def\n', 'four parts': 'a.b.c.d\n', 'an empty part': 'abc..def\n', words: 'my token is abc.def.ghi\n', empty: '' };

async function run(program, options, env = {}, input = 'ignore') {
  const child = spawn(path.join(build, 'server/bridges', program), options, { env: { ...process.env, ...env }, stdio: [input, 'ignore', 'pipe'] });
  let stderr = '';
  // with FACCIA_TOKEN the program warns and goes on, so it is stopped after its first line
  child.stderr.setEncoding('utf8').on('data', (text) => (stderr += text) && env.FACCIA_TOKEN && stderr.includes('\n') && child.kill());
  const timer = setTimeout(() => child.kill(), 30000);
  const [status] = await once(child, 'close');
  clearTimeout(timer);
  return { status, stderr };
}

for (const [program, more] of Object.entries(bridges))
  if (fs.existsSync(path.join(build, 'server/bridges', program)))
    test(`${program} rejects a file without a token, and says what it contains`, async () => {
      const url = `http://127.0.0.1:${listener.address().port}`;
      for (const [name, text] of Object.entries(nothing)) {
        const { status, stderr } = await run(program, ['--url', url, '--token-file', file('token', text), ...more]);
        assert.equal(status, 1, `${name}: ${stderr}`);
        assert.match(stderr, /token: contains no token/, name);
        if (name === 'secret') assert.match(stderr, /52 characters with 0 dots, perhaps the secret/);
        assert.equal(stderr.includes(secret), false, 'the secret is not written anywhere');
      }
      assert.match((await run(program, ['--url', url, ...more], { FACCIA_TOKEN: secret })).stderr, /FACCIA_TOKEN: contains no token/);
      assert.equal(sent.includes(secret), false, 'nor sent');
    });

if (fs.existsSync(path.join(build, 'server/bridges/sd_faccia')))
  test('sd_faccia, whose file is named in its configuration, does the same', async () => {
    const config = (text) => file('faccia.conf', `FacciaUrl "http://127.0.0.1:${listener.address().port}"\nFacciaTokenFile "${file('token', text)}"\n`);
    for (const [name, text] of Object.entries(nothing)) {
      const { status, stderr } = await run('sd_faccia', [config(text)], {}, 'pipe'); // as speech-dispatcher starts it
      assert.equal(status, 1, `${name}: ${stderr}`);
      assert.match(stderr, /token: contains no token/, name);
      assert.equal(stderr.includes(secret), false, 'the secret is not written anywhere');
    }
    assert.equal(sent.includes(secret), false, 'nor sent');
  });

test('faccia-say sends a token', async () => {
  const token = sign({ secret });
  const { stderr } = await run('faccia-say', ['--url', `http://127.0.0.1:${listener.address().port}`, '--token-file', file('good', `${token}\r\n`), 'x']);
  assert.doesNotMatch(stderr, /contains no token/);
  assert.ok(sent.includes(`Bearer ${token}`));
});

test('the daemon rejects --token-file, however it is set, and names the right option', () => {
  const where = file('secrets', `${secret}\n`), config = file('config.json', JSON.stringify({ access: { token_file: where } }));
  const start = (options, env = {}) => spawnSync(path.join(build, 'server/daemon/facciad'), ['--port', '0', ...options], { encoding: 'utf8', timeout: 20000, env: { ...process.env, ...env } });
  for (const [options, env, name] of [[['--token-file', where], {}, '--token-file'], [[], { FACCIA_TOKEN_FILE: where }, 'FACCIA_TOKEN_FILE'], [['--config', config], {}, 'access.token_file']]) {
    const { status, stderr } = start(options, env);
    assert.notEqual(status, 0, name);
    assert.match(stderr, new RegExp(`${name.replace('.', '\\.')}.*--secret-file`), name);
  }
});
