// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a bill of materials (CycloneDX 1.5): npm packages bundled into scripts, Debian packages, and the bill around them.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, readFileSync } from 'node:fs';
import path from 'node:path';

const root = path.join(import.meta.dirname, '../..');
const web = path.join(root, 'web');
export const run = (program, args, options) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'inherit'], ...options });
export const sha256 = (file) => [{ alg: 'SHA-256', content: createHash('sha256').update(readFileSync(file)).digest('hex') }];

/** Third-party code that these packages contain, according to their licences (also named by web/package/pack.mjs). */
const INSIDE = {
  three: [['draco', 'Apache-2.0'], ['basis_universal', 'Apache-2.0']],
  'opus-decoder': [['libopus', 'BSD-3-Clause']],
  '@vladmandic/human': [['@tensorflow/tfjs', 'Apache-2.0']],
};

/** The npm packages whose files are named in a text, as `npm sbom` of web/ describes them. */
export function npmPackages(text) {
  const read = text.match(/node_modules\/(?:@[^/\s"]+\/)?[^/\s"]+(?=\/)/g) ?? [];
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
}

/** The names of the licences in a copyright file of Debian (machine-readable, or what it points to); they are Debian's, not all SPDX's. */
export function debianLicences(name, roots) {
  const file = roots.map((place) => path.join(place, 'usr/share/doc', name, 'copyright')).find(existsSync);
  if (!file) return [];
  const text = readFileSync(file, 'utf8');
  const fields = [...text.matchAll(/^License:[ \t]*(\S[^\n]*)$/gm)].map(([, words]) => words.trim());
  const common = [...text.matchAll(/\/usr\/share\/common-licenses\/([A-Za-z]+(?:-[\d.]*\d)?)/g)].map(([, word]) => word);
  return [...new Set(fields.length ? fields : common)].sort().map((licence) => ({ license: { name: licence } }));
}

/** A bill of materials for the subject in metadata; components and dependencies are the subject's. */
export const bill = (component, components, dependencies) => ({
  bomFormat: 'CycloneDX',
  specVersion: '1.5',
  version: 1,
  metadata: {
    ...(process.env.SOURCE_DATE_EPOCH ? { timestamp: new Date(1000 * Number(process.env.SOURCE_DATE_EPOCH)).toISOString() } : {}),
    component,
  },
  components,
  dependencies,
});
