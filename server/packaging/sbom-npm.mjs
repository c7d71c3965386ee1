// SPDX-License-Identifier: GPL-3.0-or-later
// The bill of materials of an npm package as web/package/pack.mjs or web/client/pack.mjs has put it into a folder: node sbom-npm.mjs FOLDER OUT
// It names the packages whose code is in the scripts, and each file with its SHA-256.
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { bill, npmPackages, run, sha256 } from './sbom-parts.mjs';

const web = path.join(import.meta.dirname, '../../web');
const [folder, out] = process.argv.slice(2);
if (!folder || !out) {
  console.error('usage: node sbom-npm.mjs FOLDER OUT');
  process.exit(2);
}
const { name, version, license } = JSON.parse(readFileSync(path.join(folder, 'package.json'), 'utf8'));
const purl = `pkg:npm/${name.replace('@', '%40')}@${version}`;
/** Files bundled into the scripts: for the element as build.mjs reports them, for the client as named in its comments. */
function read() {
  if (name !== '@faccia/talking-head') return readFileSync(path.join(folder, 'client.js'), 'utf8');
  const made = mkdtempSync(path.join(os.tmpdir(), 'faccia-sbom-'));
  try {
    run(process.execPath, [path.join(web, 'build.mjs'), path.join(made, 'web'), path.join(made, 'read'), path.join(made, 'within')], { cwd: web });
    const within = JSON.parse(readFileSync(path.join(made, 'within'), 'utf8'));
    return readdirSync(path.join(folder, 'dist')).flatMap((script) => within[script] ?? []).join('\n');
  } finally {
    rmSync(made, { recursive: true });
  }
}
const files = readdirSync(folder, { recursive: true, withFileTypes: true }).filter((file) => file.isFile())
  .map((file) => path.relative(folder, path.join(file.parentPath ?? file.path, file.name))).sort();
const parts = npmPackages(read());
const about = {
  'bom-ref': purl, type: 'library', name, version, purl, licenses: [{ license: { id: license } }],
  components: files.map((file) => ({ type: 'file', name: file, hashes: sha256(path.join(folder, file)) })),
};
const refs = parts.map((one) => one['bom-ref']);
writeFileSync(out, `${JSON.stringify(bill(about, parts, [{ ref: purl, dependsOn: refs }, ...refs.map((ref) => ({ ref }))]), null, 2)}\n`);
