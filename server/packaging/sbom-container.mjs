// SPDX-License-Identifier: GPL-3.0-or-later
// The bill of materials of the container: node sbom-container.mjs ROOT PACKAGES
// ROOT is the image's file system (`buildah mount`), PACKAGES the folder of the .deb files and their bill of materials, which receives
// faccia-container_VERSION.cdx.json: every package of Debian that is in the image, with its version, its licences as its copyright file
// names them (the image's, or this machine's where the image has none), and what it depends on; faccia's with all that their own bill says.
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { bill, debianLicences, run } from './sbom-parts.mjs';

const [image, packages] = process.argv.slice(2);
if (!image || !packages) {
  console.error('usage: node sbom-container.mjs ROOT PACKAGES');
  process.exit(2);
}
const FIELDS = ['${binary:Package}', '${Version}', '${Architecture}', '${source:Package}', '${db:Status-Status}', '${Provides}', '${Pre-Depends},${Depends}'];
const rows = run('dpkg-query', ['--admindir', path.join(image, 'var/lib/dpkg'), '-W', '-f', `${FIELDS.join('\t')}\n`]).split('\n').filter(Boolean);
const installed = rows.map((row) => row.split('\t')).filter(([, , , , status]) => status === 'installed')
  .map(([name, version, arch, source, , provides, needs]) => ({ name: name.replace(/:.*/, ''), version, arch, source, provides, needs }));

const own = JSON.parse(readFileSync(path.join(packages, readdirSync(packages).find((name) => /^faccia_.*\.cdx\.json$/.test(name))), 'utf8'));
const ownOf = ({ name, version }) => own.components.find((one) => one.purl.startsWith('pkg:deb/faccia/') && one.name === name && one.version === version);
const purlOf = ({ name, version, arch }) => `pkg:deb/debian/${encodeURIComponent(name)}@${encodeURIComponent(version)}?arch=${arch}`;
const refs = new Map(installed.map((one) => [one.name, ownOf(one)?.['bom-ref'] ?? purlOf(one)]));
const providers = new Map();
for (const { name, provides } of installed)
  for (const word of provides.split(',').map((part) => part.trim().split(/[\s(]/)[0]).filter(Boolean)) providers.set(word, name);
/** The alternatives that are installed. */
const found = (needs) => needs.split(/[,|]/).map((part) => part.trim().split(/[\s(:]/)[0]).map((name) => refs.get(name) ?? refs.get(providers.get(name))).filter(Boolean);

const components = new Map(), dependencies = [];
/** Includes other packages of the container's bill, except Debian's, which are listed here with the image's versions. */
function take(ref) {
  const one = own.components.find((component) => component['bom-ref'] === ref);
  if (!one || components.has(ref)) return;
  components.set(ref, one);
  for (const next of own.dependencies.find((entry) => entry.ref === ref)?.dependsOn ?? []) if (next.startsWith('pkg:npm/')) take(next);
}
for (const one of installed) {
  const ref = refs.get(one.name);
  const ours = ownOf(one);
  take(ref);
  if (!ours) {
    const licenses = debianLicences(one.name, [image, '/']);
    const properties = one.source !== one.name ? [{ name: 'debian:source', value: one.source }] : undefined;
    components.set(ref, { 'bom-ref': ref, type: 'library', name: one.name, version: one.version, purl: ref, ...(licenses.length ? { licenses } : {}), properties });
  }
  const scripts = ours ? own.dependencies.find((entry) => entry.ref === ref).dependsOn.filter((next) => next.startsWith('pkg:npm/')) : [];
  dependencies.push({ ref, dependsOn: [...new Set([...found(one.needs), ...scripts])].filter((next) => next !== ref).sort() });
}
const { version } = own.metadata.component;
const about = { ...own.metadata.component, 'bom-ref': `faccia-container@${version}`, type: 'container', name: 'faccia-container' };
dependencies.unshift({ ref: about['bom-ref'], dependsOn: installed.map(({ name }) => refs.get(name)).sort() });
writeFileSync(path.join(packages, `faccia-container_${version}.cdx.json`), `${JSON.stringify(bill(about, [...components.values()], dependencies), null, 2)}\n`);
