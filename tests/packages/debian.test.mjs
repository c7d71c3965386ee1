// SPDX-License-Identifier: GPL-3.0-or-later
// The Debian packages: lintian; in a fresh Debian they are installed, speak, are upgraded, removed and purged.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Fresh, freshArchive } from './fresh.mjs';

const packages = process.env.FACCIA_PACKAGES;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-packages-'));
const debs = fs.readdirSync(packages).filter((name) => name.endsWith('.deb') && !name.includes('dbgsym'));
const named = (name) => debs.find((file) => file.startsWith(`${name}_`));
let machine;

before(() => (machine = new Fresh(path.join(folder, 'root'), freshArchive(path.join(packages, 'debian.tar')))));
after(() => {
  machine?.remove();
  fs.rmSync(folder, { recursive: true });
});

const all = ['faccia', 'faccia-avatars', 'faccia-data', 'faccia-home', 'faccia-voice-dev', 'faccia-voice-festival', 'speech-dispatcher-faccia'];

test('lintian finds nothing, at its strictest', () => {
  assert.deepEqual(debs.map((name) => name.split('_')[0]).sort(), all);
  const changes = fs.readdirSync(packages).find((name) => name.endsWith('.changes'));
  const { stdout } = spawnSync('lintian', ['--pedantic', '--tag-display-limit', '0', path.join(packages, changes)], { encoding: 'utf8' });
  // the time of the last commit, and a maintainer given at build time
  assert.deepEqual(stdout.split('\n').filter((line) => /^[EWIP]:/.test(line)), []);
});

test('install from scratch, with their dependencies', () => {
  machine.install(packages, ['faccia', 'faccia-data', 'faccia-home', 'faccia-voice-dev']);
  assert.match(machine.run('id', 'faccia'), /uid=\d+\(faccia\)/);
  assert.match(machine.run('faccia', '--version'), /^faccia \d/);
  assert.ok(fs.existsSync(machine.at('lib/systemd/system/facciad.service')));
});

const speaks = (address) => fetch(`${address}/v1/speech?text=La+mamma+parla.&lang=it`).then(async (response) => {
  assert.equal(response.status, 200);
  const pcm = new Int16Array((await response.arrayBuffer()).slice(44));
  assert.ok(pcm.length > 10000 && pcm.some((sample) => Math.abs(sample) > 3000));
});

test('the daemon runs there as its own user, serves the page and its heads, and speaks', async () => {
  await machine.daemon(async (address) => {
    assert.match(await (await fetch(address)).text(), /<talking-head/);
    const { models } = await (await fetch(`${address}/v1/models`)).json();
    assert.equal(models.length, 10);
    assert.equal((await fetch(`${address}/v1/models/mara`)).status, 200);
    await speaks(address);
  });
  const fap = machine.run('faccia', 'say', '--lang', 'tr', '--fap', '-', 'Papa.');
  assert.ok(fap.split('\n').length > 20);
});

test('systemd accepts the unit', () => {
  const unit = fs.readFileSync(machine.at('lib/systemd/system/facciad.service'), 'utf8');
  const file = path.join(folder, 'facciad.service');
  fs.writeFileSync(file, unit.replaceAll('/usr/bin/facciad', '/bin/true').replace(/^Documentation=.*\n/m, ''));
  const { stderr } = spawnSync('systemd-analyze', ['verify', file], { encoding: 'utf8' });
  assert.equal(stderr.split('\n').filter((line) => line.includes('facciad.service')).join('\n'), '');
});

test('an upgrade keeps the configuration, and replaces the rest', async () => {
  const kept = 'FACCIA_LANG=tr\n';
  fs.appendFileSync(machine.at('etc/default/facciad'), kept);
  const version = machine.run('dpkg-query', '-W', '-f', '${Version}', 'faccia');
  for (const name of ['faccia', 'faccia-data', 'faccia-home', 'faccia-voice-dev']) {
    const tree = path.join(folder, name);
    execFileSync('dpkg-deb', ['-R', path.join(packages, named(name)), tree]);
    const control = path.join(tree, 'DEBIAN/control');
    fs.writeFileSync(control, fs.readFileSync(control, 'utf8').replaceAll(version, `${version}+newer`));
    execFileSync('dpkg-deb', ['-b', '-Znone', tree, machine.at(`packages/newer-${name}.deb`)], { stdio: 'ignore' });
    fs.rmSync(tree, { recursive: true });
  }
  machine.run('sh', '-c', 'apt-get install -y --no-install-recommends /packages/newer-*.deb');
  assert.equal(machine.run('dpkg-query', '-W', '-f', '${Version}', 'faccia'), `${version}+newer`);
  assert.ok(fs.readFileSync(machine.at('etc/default/facciad'), 'utf8').endsWith(kept));
  await machine.daemon(speaks);
});

test('removal keeps the configuration, purging leaves nothing', () => {
  machine.run('apt-get', 'remove', '-y', 'faccia', 'faccia-data', 'faccia-home', 'faccia-voice-dev');
  assert.equal(machine.try('sh', '-c', 'command -v facciad').status, 127);
  assert.ok(fs.existsSync(machine.at('etc/default/facciad')));
  machine.run('dpkg', '--purge', 'faccia', 'faccia-data', 'faccia-home', 'faccia-voice-dev');
  const left = machine.run('find', '/etc', '/usr', '/lib/systemd', '/var/lib', '-path', '/var/lib/apt', '-prune', '-o', '-iname', '*faccia*', '-print');
  assert.equal(left, '');
});
