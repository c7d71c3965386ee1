// SPDX-License-Identifier: MIT
// Makes the npm package @faccia/client in a folder, ready for `npm pack` and `npm publish`: node pack.mjs FOLDER
import { build } from 'esbuild';
import { chmodSync, copyFileSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { messageTypes } from './messages.mjs';

const here = path.dirname(fileURLToPath(import.meta.url));
const [out] = process.argv.slice(2);
if (!out) {
  console.error('usage: node pack.mjs FOLDER');
  process.exit(2);
}
rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });

await build({
  entryPoints: [path.join(here, 'client.mjs')],
  outfile: path.resolve(out, 'client.js'),
  absWorkingDir: path.join(here, '../..'), // esbuild's comments give paths relative to this folder
  bundle: true, format: 'esm', target: 'es2022', legalComments: 'none', banner: { js: '// faccia, MIT' },
});
for (const side of ['client', 'server']) writeFileSync(path.join(out, `${side}-messages.d.ts`), await messageTypes(side));
for (const name of ['client.d.ts', 'README.md']) copyFileSync(path.join(here, name), path.join(out, name));
copyFileSync(path.join(here, '../../LICENSES/MIT.txt'), path.join(out, 'LICENSE'));

const { version } = JSON.parse(readFileSync(path.join(here, '../package.json')));
writeFileSync(path.join(out, 'package.json'), `${JSON.stringify({
  name: '@faccia/client',
  version,
  description: 'What a faccia server says, without a face: messages, sound and MPEG-4 face animation',
  keywords: ['talking head', 'text to speech', 'lip sync', 'viseme', 'MPEG-4', 'FAP'],
  license: 'MIT',
  type: 'module',
  sideEffects: false,
  main: './client.js',
  types: './client.d.ts',
  exports: { '.': { types: './client.d.ts', default: './client.js' }, './package.json': './package.json' },
  files: ['client.js', '*.d.ts'],
}, null, 2)}\n`);
// npm packs files with their modes: independent of the packing user.
for (const file of readdirSync(out, { recursive: true, withFileTypes: true }))
  if (file.isFile()) chmodSync(path.join(file.parentPath ?? file.path, file.name), 0o644);
