// SPDX-License-Identifier: GPL-3.0-or-later
// Starts every program in adverse conditions: closed descriptors, pipes without a reader, file size limits, blocked signals.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, eventually } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const sources = path.join(import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname), '../../../server');

/** All executables below a folder of the build. */
const programs = ['daemon', 'cli', 'library', 'bridges', 'voice'].flatMap((part) => {
  const under = path.join(build, 'server', part);
  return fs.readdirSync(under).map((name) => path.join(under, name))
    .filter((file) => fs.statSync(file).isFile() && fs.statSync(file).mode & 0o100 && fs.readFileSync(file).subarray(1, 4).toString() === 'ELF' && !file.endsWith('.so'));
});
const shell = (command, file) => spawnSync('bash', ['-c', command, 'bash', file], { encoding: 'utf8', timeout: 60000, env: { ...process.env, LD_BIND_NOW: '' } });

test('each main begins with the start-up routine, and nothing else sets its signals', () => {
  const mains = fs.readdirSync(sources, { recursive: true }).filter((file) => file.endsWith('.c')).map((file) => [file, fs.readFileSync(path.join(sources, file), 'utf8')]);
  const begun = mains.filter(([, text]) => /^int main\(/m.test(text));
  assert.ok(begun.length >= 11 && programs.length >= 10, `${begun.length} ${programs.length}`);
  for (const [file, text] of begun) assert.match(text.slice(text.search(/^int main\(/m)), /^int main\([^)]*\) \{(?:(?!\n\}).)*?program_begin\(\);/s, file);
  for (const [file, text] of mains) if (file !== 'base/program.c') assert.ok(!/signal\(SIG(PIPE|XFSZ)/.test(text), file);
});

for (const file of programs) {
  test(`${path.basename(file)}: survives closed descriptors and a file size limit without a signal`, () => {
    for (const [what, command] of Object.entries({
      'a pipe that nobody reads': '"$1" --help > >(exec <&-; sleep 0.2) 2>&1; exit $?',
      'standard input closed': '"$1" --help <&- >/dev/null 2>&1',
      'all descriptors closed': '"$1" --help <&- >&- 2>&-',
      'a file that may not grow': `cd ${folder}; ulimit -f 0; exec "$1" --help >out 2>&1`,
    })) {
      const { status, signal } = shell(command, file);
      assert.ok(signal === null && status < 126, `${what}: ${status} ${signal}`);
    }
  });
}

test('long-running programs: standard descriptors are open, no signal is blocked, SIGPIPE and SIGXFSZ are ignored', async () => {
  const bit = (n) => 1n << BigInt(n - 1);
  for (const [name, ...options] of [['bridges/faccia-wyoming', '--listen', '0'], ['bridges/faccia-satellite', '--listen', '0'], ['bridges/faccia-lva', '--assistant', 'ws://127.0.0.1:1'], ['bridges/faccia-mqtt', '--broker', '127.0.0.1:1'], ['daemon/facciad', '--port', '0']]) {
    const file = path.join(build, 'server', name);
    if (!fs.existsSync(file)) continue;
    const child = spawn('env', ['--block-signal=TERM', '--ignore-signal=CHLD', 'bash', '-c', 'exec "$@" <&- >&- 2>&-', 'bash', file, ...options], { stdio: 'ignore' });
    const ended = once(child, 'exit');
    const status = () => fs.readFileSync(`/proc/${child.pid}/status`, 'utf8');
    const mask = (field) => BigInt(`0x${new RegExp(`${field}:\\s+(\\w+)`).exec(status())[1]}`);
    await eventually(() => fs.readlinkSync(`/proc/${child.pid}/exe`) === fs.realpathSync(file) && (mask('SigIgn') & bit(13)) && (mask('SigCgt') & bit(15)), `${name} to start`);
    assert.ok(mask('SigIgn') & bit(25), `${name}: SIGXFSZ`);
    assert.ok(!(mask('SigIgn') & bit(17)), `${name}: SIGCHLD`);
    assert.equal(mask('SigBlk') & bit(15), 0n, `${name}: SIGTERM is heard`);
    for (const fd of [0, 1, 2]) assert.equal(fs.readlinkSync(`/proc/${child.pid}/fd/${fd}`), '/dev/null', `${name}: ${fd}`);
    child.kill('SIGTERM');
    assert.deepEqual(await ended, [0, null], name);
  }
});

test('reports an index that reaches the file size limit; the daemon continues', async () => {
  const works = path.join(folder, 'works');
  fs.mkdirSync(works);
  fs.writeFileSync(path.join(works, 'b.txt'), Array.from({ length: 20000 }, (_, i) => `amore parola numero ${i} che parla piano`).join('\n\n'));
  const child = spawn('bash', ['-c', 'ulimit -f 1024; exec "$@"', 'bash', path.join(build, 'server/daemon/facciad'), '--port', '0', '--library', works, '--library-index', path.join(folder, 'i.db')], { stdio: ['ignore', 'ignore', 'pipe'] });
  let log = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (log += text));
  const ended = once(child, 'exit');
  await eventually(() => /(error|warning): .*(full|disk|write|I\/O|index)/i.test(log) || child.exitCode !== null || child.signalCode, `what is told; ${log}`);
  const [, port] = await eventually(() => /listening on .*?:(\d+)/.exec(log) ?? (child.signalCode && [0, 0]), 'the port');
  assert.equal(child.signalCode, null, log);
  assert.equal((await fetch(`http://127.0.0.1:${port}/v1/health`).catch((e) => ({ status: e.message }))).status < 600, true, log);
  child.kill('SIGTERM');
  assert.deepEqual(await ended, [0, null], log);
});
