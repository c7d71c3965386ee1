// SPDX-License-Identifier: GPL-3.0-or-later
// A bill of materials of what the Debian packages ship, as CycloneDX 1.5 (JSON): node sbom.mjs FOLDER
// FOLDER has the .deb files, and gets faccia_VERSION.cdx.json. It names the packages with the SHA-256 of their files, what of Debian they need,
// in the versions that they were built with, what is compiled into the programs, and the npm packages that are in the scripts: those that
// web/build.mjs tells to have read, of all that `npm sbom` knows.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';

const root = path.join(import.meta.dirname, '../..');
const web = path.join(root, 'web');
const [folder] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node sbom.mjs FOLDER');
  process.exit(2);
}
/** What some of them bring of others, as their own licences say (web/package/pack.mjs names them, too). */
const INSIDE = {
  three: [['draco', 'Apache-2.0'], ['basis_universal', 'Apache-2.0'], ['meshoptimizer', 'MIT']],
  'opus-decoder': [['libopus', 'BSD-3-Clause']],
  '@vladmandic/human': [['@tensorflow/tfjs', 'Apache-2.0']],
};
const run = (program, args, options) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'inherit'], ...options });
const field = (deb, name) => run('dpkg-deb', ['-f', deb, name]).trim();

/** The npm packages that are in the scripts, as `npm sbom` describes them. */
function scripts() {
  const made = mkdtempSync(path.join(os.tmpdir(), 'faccia-sbom-'));
  try {
    run(process.execPath, [path.join(web, 'build.mjs'), path.join(made, 'web'), path.join(made, 'read')], { cwd: web });
    const read = readFileSync(path.join(made, 'read'), 'utf8').match(/node_modules\/(?:@[^/\s]+\/)?[^/\s]+(?=\/)/g) ?? [];
    const names = new Set(read.map((name) => name.slice('node_modules/'.length)));
    const known = JSON.parse(run('npm', ['sbom', '--sbom-format', 'cyclonedx'], { cwd: web, stdio: ['ignore', 'pipe', 'ignore'] })).components;
    const version = (name) => JSON.parse(readFileSync(path.join(web, 'node_modules', name, 'package.json'), 'utf8')).version;
    return [...names].sort().map((name) => {
      const found = known.find((one) => one['bom-ref'] === `${name}@${version(name)}`);
      if (!found) throw new Error(`npm sbom does not know ${name}`);
      const { type, version: its, purl, hashes, licenses } = found;
      const components = INSIDE[name]?.map(([part, id]) => ({ type: 'library', name: part, licenses: [{ license: { id } }] }));
      return { 'bom-ref': purl, type, name, version: its, purl, hashes, licenses, components };
    });
  } finally {
    rmSync(made, { recursive: true });
  }
}

const installed = new Map();
/** A package of Debian as it is on this machine, on which the others are built. */
function debian(name) {
  if (!installed.has(name)) {
    let version = '';
    try {
      version = run('dpkg-query', ['-W', '-f', '${Version}', name], { stdio: ['ignore', 'pipe', 'ignore'] });
    } catch {
      // not on this machine: any will do
    }
    const purl = `pkg:deb/debian/${name}${version ? `@${encodeURIComponent(version)}` : ''}`;
    installed.set(name, { 'bom-ref': purl, type: 'library', name, ...(version ? { version } : {}), purl });
  }
  return installed.get(name)['bom-ref'];
}

const debs = readdirSync(folder).filter((name) => name.endsWith('.deb') && !name.includes('dbgsym')).sort().map((name) => path.join(folder, name));
const own = new Map(debs.map((deb) => {
  const [name, version] = [field(deb, 'Package'), field(deb, 'Version')];
  const purl = `pkg:deb/faccia/${name}@${version}?arch=${field(deb, 'Architecture')}`;
  const hashes = [{ alg: 'SHA-256', content: createHash('sha256').update(readFileSync(deb)).digest('hex') }];
  return [name, { 'bom-ref': purl, type: 'application', name, version, purl, hashes, licenses: [{ license: { id: 'GPL-3.0-or-later' } }] }];
}));
const packed = scripts();
const dependencies = debs.map((deb) => {
  const name = field(deb, 'Package');
  const needed = field(deb, 'Depends').split(',').map((one) => one.trim().split(/[\s|(:]/)[0]).filter(Boolean);
  const parts = needed.map((one) => own.get(one)?.['bom-ref'] ?? debian(one));
  const content = run('dpkg-deb', ['-c', deb]);
  if (content.includes('/web/talking-head.js')) parts.push(...packed.map((one) => one['bom-ref']));
  if (/\/usr\/bin\/facciad\b/.test(content)) parts.push(debian('uthash-dev'));
  return { ref: own.get(name)['bom-ref'], dependsOn: [...new Set(parts)].sort() };
});
const { version } = own.values().next().value;
const bom = {
  bomFormat: 'CycloneDX',
  specVersion: '1.5',
  version: 1,
  metadata: {
    ...(process.env.SOURCE_DATE_EPOCH ? { timestamp: new Date(1000 * Number(process.env.SOURCE_DATE_EPOCH)).toISOString() } : {}),
    component: { 'bom-ref': `faccia@${version}`, type: 'application', name: 'faccia', version, licenses: [{ license: { id: 'GPL-3.0-or-later' } }] },
  },
  components: [...own.values(), ...packed, ...[...installed.values()].sort((a, b) => (a.name < b.name ? -1 : 1))],
  dependencies: [{ ref: `faccia@${version}`, dependsOn: [...own.values()].map((one) => one['bom-ref']) }, ...dependencies],
};
writeFileSync(path.join(folder, `faccia_${version}.cdx.json`), `${JSON.stringify(bom, null, 2)}\n`);
