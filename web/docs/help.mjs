// SPDX-License-Identifier: MIT
// Collects the programs' --help as JSON: node help.mjs PROGRAM... Run separately, so that the site is rebuilt only when a
// text changes.
import { execFileSync } from 'node:child_process';
import path from 'node:path';

const ask = (program, ...args) => execFileSync(program, args, { encoding: 'utf8' });
const all = {};
for (const program of process.argv.slice(2)) {
  const name = path.basename(program), help = ask(program, '--help');
  all[name] = { help };
  if (name === 'faccia')
    all[name].commands = Object.fromEntries([...help.split("\n'faccia COMMAND")[0].matchAll(/^ {2}([a-z]+) {2}/gm)].map(([, command]) => [command, ask(program, command, '--help')]));
  if (name === 'facciad') all[name].schema = JSON.parse(ask(program, '--print-schema'));
}
process.stdout.write(JSON.stringify(all, null, 1));
