// SPDX-License-Identifier: GPL-3.0-or-later
// Kokoro's voices with the installed packages, as described in server/plugins/README.md. Skipped where the tree has no weights (sh
// server/run.sh --with kokoro --build-only).
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { eventually, root } from '../lib/daemon.mjs';
import { Fresh, freshArchive } from './fresh.mjs';

const packages = process.env.FACCIA_PACKAGES;
const plugin = path.join(root, 'build/server/plugins/kokoro.so');
const there = fs.existsSync(plugin) && fs.existsSync(path.join(root, 'server/plugins/kokoro/node_modules/.faccia-lock'));

/** Returns the commands of the README in order, without sudo and systemd. */
function steps() {
  const text = fs.readFileSync(path.join(root, 'server/plugins/README.md'), 'utf8');
  const [block] = text.match(/^ {4}D=\$\(pkg-config .*\n(?: {4}.+\n)+/m);
  return block.replace(/ && sudo systemctl restart facciad/, '').replaceAll('sudo ', '');
}

test('the commands of the README install Kokoro next to the packages, and removing them keeps it', { skip: there ? false : 'Kokoro is not installed: sh server/run.sh --with kokoro --build-only' }, async (t) => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-kokoro-'));
  const machine = new Fresh(path.join(folder, 'root'), freshArchive(path.join(packages, 'debian.tar')));
  const tree = machine.at('tree');
  t.after(() => {
    execFileSync('umount', [tree]);
    machine.remove();
    fs.rmSync(folder, { recursive: true });
  });
  fs.mkdirSync(tree);
  execFileSync('mount', ['--bind', '-o', 'ro', root, tree]);
  machine.install(packages, ['faccia', 'faccia-data', 'faccia-voice-dev'], 'pkg-config');
  machine.run('sh', '-euc', `cd /tree\n${steps()}`);
  const { voices } = JSON.parse(machine.run('faccia', 'voices', '--json'));
  assert.ok(voices.some(({ plugin: of, id }) => of === 'kokoro' && id === 'kokoro:if_sara'), JSON.stringify(voices));
  await machine.daemon(async (address) => {
    const offered = await eventually(async () => {
      const list = (await (await fetch(`${address}/v1/voices`)).json()).voices ?? [];
      return list.find(({ id }) => id === 'kokoro:if_sara');
    }, 'the voice');
    assert.equal(offered.plugin, 'kokoro');
    const answer = await fetch(`${address}/v1/speech?text=La+mamma+parla.&voice=kokoro:if_sara&lang=it`);
    assert.equal(answer.status, 200, await answer.clone().text());
    const pcm = new Int16Array((await answer.arrayBuffer()).slice(44));
    assert.ok(pcm.length > 10000 && pcm.some((sample) => Math.abs(sample) > 3000));
  });
  machine.run('apt-get', 'remove', '-y', 'faccia', 'faccia-data');
  const [left] = machine.run('sh', '-c', 'ls -d /usr/lib/*/faccia/plugins').split('\n');
  assert.deepEqual(fs.readdirSync(machine.at(left)).sort(), ['kokoro', 'kokoro.json', 'kokoro.so']);
});
