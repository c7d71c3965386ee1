// SPDX-License-Identifier: GPL-3.0-or-later
// A fresh Debian 12 in a folder, and commands that run in it.
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import path from 'node:path';

/** As an archive, made once. @param {string} file */
export function freshArchive(file) {
  if (!fs.existsSync(file))
    execFileSync('mmdebstrap', ['--variant=minbase', '--quiet', '--hook-dir=/usr/share/mmdebstrap/hooks/merged-usr', '--include=usr-is-merged', '--dpkgopt=path-exclude=/usr/share/man/*', '--dpkgopt=path-exclude=/usr/share/doc/*',
      '--dpkgopt=path-exclude=/usr/share/locale/*', 'bookworm', file], { stdio: ['ignore', 'ignore', 'inherit'] });
  return file;
}

/** A machine of its own, as far as files go: it shares the network. */
export class Fresh {
  /** @param {string} folder @param {string} archive */
  constructor(folder, archive) {
    this.folder = folder;
    fs.mkdirSync(folder);
    execFileSync('tar', ['-x', '-f', archive, '-C', folder, '--exclude=./dev/*']);
    for (const name of ['null', 'zero', 'random', 'urandom', 'full', 'tty']) execFileSync('cp', ['-a', `/dev/${name}`, path.join(folder, 'dev')]);
    fs.copyFileSync('/etc/resolv.conf', path.join(folder, 'etc/resolv.conf'));
    fs.copyFileSync('/etc/hosts', path.join(folder, 'etc/hosts'));
    execFileSync('mount', ['-t', 'proc', 'proc', path.join(folder, 'proc')]);
    fs.writeFileSync(path.join(folder, 'usr/sbin/policy-rc.d'), '#!/bin/sh\nexit 101\n', { mode: 0o755 }); // there is no systemd to start it
  }

  /** @param {string} file @returns {string} its place outside */
  at(file) {
    return path.join(this.folder, file);
  }

  #options = { encoding: 'utf8', maxBuffer: 1 << 28, env: { PATH: '/usr/sbin:/usr/bin:/sbin:/bin', DEBIAN_FRONTEND: 'noninteractive', LC_ALL: 'C.UTF-8' } };

  /** @param {...string} command @returns {{status: number, stdout: string, stderr: string}} */
  try(...command) {
    return spawnSync('chroot', [this.folder, ...command], this.#options);
  }

  run(...command) {
    const { status, stdout, stderr } = this.try(...command);
    if (status !== 0) throw new Error(`${command.join(' ')}: ${status}\n${stdout}\n${stderr}`);
    return stdout;
  }

  /** @param {string} user @param {string[]} command */
  start(user, command) {
    return spawn('chroot', [`--userspec=${user}`, this.folder, ...command], { env: this.#options.env });
  }

  /** Packages of ours, with what they depend on. @param {string} folder where they lie @param {string[]} names @param {...string} others of Debian's */
  install(folder, names, ...others) {
    fs.mkdirSync(this.at('packages'));
    const files = fs.readdirSync(folder).filter((name) => name.endsWith('.deb') && !name.includes('dbgsym'));
    for (const file of files) fs.copyFileSync(path.join(folder, file), this.at(`packages/${file}`));
    this.run('apt-get', 'update');
    this.run('apt-get', 'install', '-y', '--no-install-recommends', ...others, ...names.map((name) => `/packages/${files.find((file) => file.startsWith(`${name}_`))}`));
  }

  /** The daemon, as the unit would start it. @param {(address: string) => Promise<void>} look */
  async daemon(look) {
    const child = this.start('faccia', ['facciad', '--port', '0', '--cache-file', '']);
    let log = '';
    const address = await new Promise((resolve, reject) => {
      child.stderr.setEncoding('utf8').on('data', (text) => {
        log += text;
        const found = log.match(/http:\/\/127\.0\.0\.1:\d+/);
        if (found) resolve(found[0]);
      });
      child.on('exit', (code) => reject(new Error(`exit ${code}: ${log}`)));
    });
    try {
      await look(address);
    } catch (error) {
      throw new Error(`${error.message}\n${log}`, { cause: error });
    } finally {
      child.removeAllListeners('exit');
      const exited = once(child, 'exit');
      child.kill('SIGTERM');
      await exited;
    }
  }

  remove() {
    spawnSync('umount', [this.at('proc')]);
    fs.rmSync(this.folder, { recursive: true });
  }
}
