// SPDX-License-Identifier: GPL-3.0-or-later
// A bill of materials of what the Debian packages ship, as CycloneDX 1.5 (JSON): node sbom.mjs FOLDER
// FOLDER has the .deb files, and gets faccia_VERSION.cdx.json. It names the packages with the SHA-256 of their files, what of Debian they need,
// in the versions that they were built with, what is compiled into the programs, and the npm packages that are in the scripts: those that
// web/build.mjs tells to have read and those that web/docs/pages.mjs names, of all that `npm sbom` knows.
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { bundled } from '../../web/docs/pages.mjs';
import { bill, debianLicences, npmPackages, run, sha256 } from './sbom-parts.mjs';

const web = path.join(import.meta.dirname, '../../web');
const [folder] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node sbom.mjs FOLDER');
  process.exit(2);
}
const field = (deb, name) => run('dpkg-deb', ['-f', deb, name]).trim();

/** The npm packages that are in the scripts. */
function scripts() {
  const made = mkdtempSync(path.join(os.tmpdir(), 'faccia-sbom-'));
  try {
    run(process.execPath, [path.join(web, 'build.mjs'), path.join(made, 'web'), path.join(made, 'read')], { cwd: web });
    const documentation = bundled.map((name) => `node_modules/${name}/`).join('\n');
    return npmPackages(`${readFileSync(path.join(made, 'read'), 'utf8')}\n${documentation}`);
  } finally {
    rmSync(made, { recursive: true });
  }
}

const installed = new Map();
/** Returns the Debian package installed on this machine, the base of the others. */
function debian(name) {
  if (!installed.has(name)) {
    let version = '';
    try {
      version = run('dpkg-query', ['-W', '-f', '${Version}', name], { stdio: ['ignore', 'pipe', 'ignore'] });
    } catch {
      // not on this machine: any will do
    }
    const purl = `pkg:deb/debian/${name}${version ? `@${encodeURIComponent(version)}` : ''}`;
    const licenses = debianLicences(name, ['/']);
    installed.set(name, { 'bom-ref': purl, type: 'library', name, ...(version ? { version } : {}), purl, ...(licenses.length ? { licenses } : {}) });
  }
  return installed.get(name)['bom-ref'];
}

const debs = readdirSync(folder).filter((name) => name.endsWith('.deb') && !name.includes('dbgsym')).sort().map((name) => path.join(folder, name));
const own = new Map(debs.map((deb) => {
  const [name, version] = [field(deb, 'Package'), field(deb, 'Version')];
  const purl = `pkg:deb/faccia/${name}@${version}?arch=${field(deb, 'Architecture')}`;
  const hashes = sha256(deb);
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
const about = { 'bom-ref': `faccia@${version}`, type: 'application', name: 'faccia', version, licenses: [{ license: { id: 'GPL-3.0-or-later' } }] };
const components = [...own.values(), ...packed, ...[...installed.values()].sort((a, b) => (a.name < b.name ? -1 : 1))];
const all = { ref: about['bom-ref'], dependsOn: [...own.values()].map((one) => one['bom-ref']) };
writeFileSync(path.join(folder, `faccia_${version}.cdx.json`), `${JSON.stringify(bill(about, components, [all, ...dependencies]), null, 2)}\n`);
