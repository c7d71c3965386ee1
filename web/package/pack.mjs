// SPDX-License-Identifier: MIT
// Makes the npm package @faccia/talking-head in a folder, ready for `npm pack` and `npm publish`: node pack.mjs FOLDER [BUILT]
// BUILT: where build.mjs has put the element (build/web).
import { build } from 'esbuild';
import { chmodSync, copyFileSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { manifest } from './manifest.mjs';

const here = path.dirname(fileURLToPath(import.meta.url));
const web = path.join(here, '..');
const [out, built = path.join(web, '../build/web')] = process.argv.slice(2);
if (!out) {
  console.error('usage: node pack.mjs FOLDER [BUILT]');
  process.exit(2);
}
const dist = path.join(out, 'dist');
rmSync(out, { recursive: true, force: true });
mkdirSync(dist, { recursive: true });

for (const name of ['talking-head.js', 'talking-head-worklet.js', 'talking-head-avatar.js', 'talking-head-draco.js', 'talking-head-basis.js',
  'opus-decoder.js', 'talking-head.d.ts'])
  copyFileSync(path.join(built, name), path.join(dist, name));

// For pages without modules: one global, and companions found beside the script.
await build({
  entryPoints: [path.join(web, 'element/talking-head.mjs')],
  outfile: path.join(dist, 'talking-head.classic.js'),
  bundle: true, minify: true, format: 'iife', globalName: 'faccia', target: 'es2022', legalComments: 'none',
  define: { 'import.meta.url': 'facciaScript' },
  banner: { js: '/* faccia, MIT. Contains three.js, MIT, (c) three.js authors. */ const facciaScript = document.currentScript.src;' },
});

// Type-only files: the element's name in each framework's templates.
for (const name of ['react', 'vue', 'svelte']) {
  writeFileSync(path.join(dist, `${name}.js`), 'export {};\n');
  copyFileSync(path.join(here, `${name}.d.ts`), path.join(dist, `${name}.d.ts`));
}

const { version } = JSON.parse(readFileSync(path.join(web, 'package.json')));
const { three, 'opus-decoder': opus } = JSON.parse(readFileSync(path.join(web, 'package.json'))).devDependencies;
const script = 'dist/talking-head.js';
const apache = 'LICENSE.Apache-2.0.txt';
const types = (name) => ({ types: `./dist/${name}.d.ts`, default: `./dist/${name}.js` });
writeFileSync(path.join(out, 'package.json'), `${JSON.stringify({
  name: '@faccia/talking-head',
  version,
  description: 'A face that speaks: the <talking-head> element of faccia',
  keywords: ['talking head', 'web component', 'custom element', 'lip sync', 'text to speech', 'MPEG-4', 'FAP', 'avatar'],
  license: 'MIT',
  type: 'module',
  sideEffects: ['./dist/talking-head.js', './dist/talking-head.classic.js'],
  main: `./${script}`,
  types: './dist/talking-head.d.ts',
  // for TypeScript's older module resolution (node10), which ignores `exports`
  typesVersions: { '*': Object.fromEntries(['react', 'vue', 'svelte'].map((name) => [name, [`./dist/${name}.d.ts`]])) },
  unpkg: './dist/talking-head.classic.js',
  jsdelivr: './dist/talking-head.classic.js',
  customElements: 'custom-elements.json',
  exports: {
    '.': types('talking-head'),
    './react': types('react'),
    './vue': types('vue'),
    './svelte': types('svelte'),
    './dist/*': './dist/*',
    './custom-elements.json': './custom-elements.json',
    './package.json': './package.json',
  },
  files: ['dist', 'custom-elements.json'],
}, null, 2)}\n`);
writeFileSync(path.join(out, 'custom-elements.json'),
  `${JSON.stringify(manifest(path.join(dist, 'talking-head.d.ts'), path.join(web, 'docs/element/reference.md'), script), null, 2)}\n`);
copyFileSync(path.join(here, 'README.md'), path.join(out, 'README.md'));
writeFileSync(path.join(out, 'LICENSE'), `${readFileSync(path.join(web, '../LICENSES/MIT.txt'), 'utf8')}
The scripts contain three.js ${three} (MIT, three.js authors) with the decoders of Draco and Basis Universal (Apache-2.0, Google LLC
and Binomial LLC), meshoptimizer (MIT, Arseny Kapoulkine) and
opus-decoder ${opus} (MIT, Ethan Halsall) with libopus (BSD-3-Clause, Xiph.Org), @wasm-audio-decoders/common and simple-yenc (MIT,
Ethan Halsall) and @eshaz/web-worker (Apache-2.0, its authors). The text of Apache-2.0: ${apache}
`);
copyFileSync(path.join(web, 'node_modules/@eshaz/web-worker/LICENSE'), path.join(out, apache));
// npm packs files with their modes: independent of the packing user.
for (const file of readdirSync(out, { recursive: true, withFileTypes: true }))
  if (file.isFile()) chmodSync(path.join(file.parentPath ?? file.path, file.name), 0o644);
