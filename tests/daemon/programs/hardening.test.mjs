// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the hardening of the ordinary build's programs and plugins in the built files.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { ordinary } from '../../lib/daemon.mjs';

const isElf = (file) => {
  const head = Buffer.alloc(4), fd = fs.openSync(file, 'r');
  fs.readSync(fd, head);
  fs.closeSync(fd);
  return head.toString('latin1') === '\x7fELF';
};

/** Lists the programs and shared modules below the folder. */
const built = (folder) => fs.readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
  const name = path.join(folder, entry.name);
  if (entry.isDirectory()) return entry.name.endsWith('.p') ? [] : built(name);
  return entry.isFile() && (!path.extname(name) || name.endsWith('.so')) && isElf(name) ? [name] : [];
});

const files = built(path.join(ordinary, 'server'));
const read = (file, ...options) => execFileSync('readelf', ['-W', ...options, file], { encoding: 'utf8', maxBuffer: 1 << 26 });
const x86 = process.arch === 'x64';

test('builds the daemon, its workers, the bridges and the plugins', () => {
  const names = files.map((file) => path.basename(file));
  for (const name of ['facciad', 'faccia', 'faccia-say', 'faccia-worker']) assert.ok(names.includes(name), `${name} among ${names}`);
  assert.ok(files.some((file) => file.endsWith('.so')), 'plugins');
});

for (const file of files)
  test(path.relative(ordinary, file), () => {
    const header = read(file, '-h'), segments = read(file, '-l'), dynamic = read(file, '-d');
    assert.match(header, /Type:\s+DYN/, 'position-independent');
    assert.match(segments, /GNU_RELRO/);
    assert.match(dynamic, /BIND_NOW|FLAGS_1\).*\bNOW\b/, 'full RELRO');
    assert.match(segments.match(/GNU_STACK.*/)[0], /RW /, 'no stack that runs');
    if (x86) assert.ok(fs.readFileSync(file).includes(Buffer.from('f30f1efa', 'hex')), 'endbr64 (CET): the linker drops the note of it where, as in Debian 12, the C library has none');
  });

test('the programs have stack protection and checked copies', () => {
  const symbols = files.map((file) => [path.basename(file), read(file, '--dyn-syms')]);
  for (const [name, text] of symbols.filter(([each]) => /^(facciad?|faccia-(?!.*\.so))/.test(each))) {
    assert.match(text, /__stack_chk_fail/, name);
    assert.match(text, /__(vs|s|f)n?printf_chk|__memcpy_chk|__read_chk|__snprintf_chk/, name);
  }
});

test('compiles every C file with these flags', () => {
  const commands = JSON.parse(fs.readFileSync(path.join(ordinary, 'compile_commands.json'), 'utf8')).filter(({ file }) => file.includes('server/') && file.endsWith('.c'));
  assert.ok(commands.length > 100);
  const flags = ['-fstack-protector-strong', '-fstack-clash-protection', '-D_FORTIFY_SOURCE=', ...(x86 ? ['-fcf-protection=full'] : [])];
  for (const { command, file } of commands) for (const flag of flags) assert.ok(command.includes(flag), `${file}: ${flag}`);
});
