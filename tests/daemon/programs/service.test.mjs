// SPDX-License-Identifier: GPL-3.0-or-later
// The systemd unit: what its sandbox allows, and that daemon and workers run inside it.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, Daemon } from '../../lib/daemon.mjs';

const unit = path.join(build, 'server/daemon/facciad.service');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-service-'));
after(() => fs.rmSync(folder, { recursive: true }));
const analyze = (...args) => {
  const { status, stdout, stderr } = spawnSync('systemd-analyze', args, { encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return stdout;
};
const settings = (name) =>
  fs.readFileSync(unit, 'utf8').split('\n').filter((line) => line.startsWith(`${name}=`)).map((line) => line.slice(name.length + 1));

test('systemd-analyze rates the exposure of the unit as low', () => {
  const [, exposure] = analyze('security', '--offline=true', unit).match(/exposure level for facciad\.service: ([\d.]+)/);
  assert.ok(Number(exposure) < 3, exposure);
});

test('workers may enter namespaces and filters', () => {
  assert.deepEqual(settings('RestrictNamespaces').join(' ').split(' ').sort(), ['ipc', 'net', 'user']);
});

test('limits memory to a share of the machine', () => {
  const percent = (name) => Number(settings(name).join().match(/^(\d+)%$/)?.[1]);
  const [high, most] = [percent('MemoryHigh'), percent('MemoryMax')];
  assert.ok(high >= 20 && high < most && most <= 90, `MemoryHigh=${high}% MemoryMax=${most}%`);
});

/** Lists the allowed system calls as systemd does: later lines add, lines with ~ remove. */
function allowed() {
  const group = (name) =>
    analyze('syscall-filter', name).split('\n').slice(1).map((line) => line.trim()).filter((word) => word && !word.startsWith('#'))
      .flatMap((word) => (word.startsWith('@') ? group(word) : [word]));
  const calls = new Set(group('@default'));
  for (const line of settings('SystemCallFilter'))
    for (const word of line.replace(/^~/, '').split(' '))
      for (const call of word.startsWith('@') ? group(word) : [word]) line.startsWith('~') ? calls.delete(call) : calls.add(call);
  return calls;
}

test('the daemon starts its workers, speaks and ends behind the filter of the unit', async () => {
  const calls = allowed();
  assert.ok(calls.size > 200 && !calls.has('mount') && !calls.has('ptrace'));
  const list = path.join(folder, 'calls');
  fs.writeFileSync(list, [...calls].join('\n'));
  const script = path.join(folder, 'confined.py');
  fs.writeFileSync(script, `#!/usr/bin/python3
import ctypes, errno, os, sys
seccomp = ctypes.CDLL('libseccomp.so.2')
seccomp.seccomp_init.restype = ctypes.c_void_p
seccomp.seccomp_init.argtypes = [ctypes.c_uint32]
seccomp.seccomp_rule_add_array.argtypes = [ctypes.c_void_p, ctypes.c_uint32, ctypes.c_int, ctypes.c_uint, ctypes.c_void_p]
seccomp.seccomp_load.argtypes = [ctypes.c_void_p]
ALLOW = 0x7fff0000
found = seccomp.seccomp_init(0x00050000 | errno.EPERM)
for name in open('${list}').read().split():
    number = seccomp.seccomp_syscall_resolve_name(name.encode())
    if number >= 0:
        seccomp.seccomp_rule_add_array(found, ALLOW, number, 0, None)
assert seccomp.seccomp_load(found) == 0
os.execv('${path.join(build, 'server/daemon/facciad')}', ['facciad'] + sys.argv[1:])
`, { mode: 0o755 });
  // the leak detector would need ptrace
  const daemon = await Daemon.start([], { ASAN_OPTIONS: `${process.env.ASAN_OPTIONS ?? ''}:detect_leaks=0` }, { program: script });
  assert.match(daemon.log, /ready: \d+ voices/);
  assert.match(fs.readFileSync(`/proc/${daemon.process.pid}/status`, 'utf8'), /^Seccomp:\t2$/m);
  assert.doesNotMatch(daemon.log, /warning|error|not permitted/i);
  const { voices } = await (await daemon.get('/v1/voices')).json();
  const response = await daemon.get('/v1/speech?lang=it&format=json', { method: 'POST', body: 'Sì.' });
  assert.equal(response.status, 200);
  assert.ok((await response.json()).phones.length);
  // a voice that starts another program
  const festival = voices.find((v) => v.plugin === 'festival');
  if (festival)
    assert.equal((await daemon.get(`/v1/speech?voice=${festival.id}`, { method: 'POST', body: 'Sì.' })).status, 200);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});
