// SPDX-License-Identifier: GPL-3.0-or-later
// The container: built from the packages on the local Debian, small, run by an unprivileged user on read-only files.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { checkBill } from '../lib/bill.mjs';
import { freshArchive } from './fresh.mjs';

const packages = process.env.FACCIA_PACKAGES;
const root = path.resolve(import.meta.dirname, '../..');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-container-'));
const env = { ...process.env, BUILDAH_ISOLATION: 'chroot', STORAGE_DRIVER: 'vfs' };
const store = ['--root', path.join(folder, 'store'), '--runroot', path.join(folder, 'run')];
const buildah = (...args) => execFileSync('buildah', [...store, ...args], { encoding: 'utf8', env, maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'pipe'] }).trim();
let container, mounted, health;

before(() => {
  const base = buildah('from', 'scratch');
  buildah('add', base, freshArchive(path.join(packages, 'debian.tar')), '/');
  buildah('commit', '--rm', base, 'localhost/debian');
  buildah('build', '--format', 'docker', '--pull-never', '--build-arg', 'BASE=localhost/debian', '-t', 'localhost/faccia', '-f', path.join(root, 'server/packaging/Containerfile'), packages);
  container = buildah('from', 'localhost/faccia');
  mounted = buildah('mount', container);
});
after(() => {
  spawnSync('buildah', [...store, 'rm', '--all'], { env });
  fs.rmSync(folder, { recursive: true, force: true });
});

// A third of it is Debian itself; libicu, for numbers and dates in words, has 37 MB, the ten heads 31, espeak-ng's data 12.
test('is small: 225 MB at most', () => {
  const bytes = Number(execFileSync('du', ['-sb', mounted], { encoding: 'utf8' }).split('\t')[0]);
  assert.ok(bytes < 225e6, `${bytes} bytes`);
});

test('the bill of materials names every package in it, with its version', () => {
  execFileSync('node', [path.join(root, 'server/packaging/sbom-container.mjs'), mounted, packages]);
  const bom = JSON.parse(fs.readFileSync(path.join(packages, fs.readdirSync(packages).find((name) => /^faccia-container_.*\.cdx\.json$/.test(name))), 'utf8'));
  checkBill(bom);
  const debs = bom.components.filter((one) => one.purl.startsWith('pkg:deb/'));
  const installed = execFileSync('dpkg-query', ['--admindir', path.join(mounted, 'var/lib/dpkg'), '-W', '-f', '${Package} ${Version}\n'], { encoding: 'utf8' }).trim().split('\n');
  assert.deepEqual(debs.map((one) => `${one.name} ${one.version}`).sort(), installed.sort());
  const named = (name) => bom.components.find((one) => one.name === name);
  assert.match(named('faccia').purl, /^pkg:deb\/faccia\//);
  for (const name of ['faccia', 'faccia-data', 'three']) assert.ok(named(name).licenses.length, name);
  const next = (name) => bom.dependencies.find(({ ref }) => ref === named(name).purl).dependsOn;
  for (const name of ['libc6', 'faccia-data']) assert.ok(next('faccia').includes(named(name).purl), name);
});

test('runs as an unprivileged user, and reports its health', () => {
  const { config } = JSON.parse(buildah('inspect', '--format', '{{.Config}}', 'localhost/faccia'));
  assert.equal(config.User, 'faccia');
  health = config.Healthcheck.Test.slice(1);
  assert.equal(health[0], 'bash');
});

test('speaks on a read-only file system', () => {
  execFileSync('mount', ['--bind', '-o', 'ro', mounted, mounted]);
  try {
    const check = health[2].replace('8080', '8099');
    const script = `facciad --port 8099 & daemon=$!
      for i in $(seq 100); do (exec 3<>/dev/tcp/127.0.0.1/8099) 2>/dev/null && break; sleep 0.1; done
      exec 3<>/dev/tcp/127.0.0.1/8099
      printf 'GET /v1/speech?text=Mamma&format=fap HTTP/1.0\\r\\nHost: localhost\\r\\n\\r\\n' >&3
      cat <&3
      (${check}) && echo healthy
      kill $daemon; wait
      (${check}) 2>/dev/null || echo gone`;
    const { stdout, stderr } = spawnSync('chroot', ['--userspec=faccia', mounted, 'bash', '-c', script], {
      encoding: 'utf8', env: { PATH: process.env.PATH }, // not where the tests have their models
    });
    assert.match(stdout, /^HTTP\/1.. 200/, stderr);
    assert.ok(stdout.split('\n').length > 20);
    assert.match(stdout, /healthy\ngone\n$/);
  } finally {
    execFileSync('umount', [mounted]);
  }
});
