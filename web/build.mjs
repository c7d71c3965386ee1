// SPDX-License-Identifier: MIT
// Bundles the element and its audio worklet, and copies types, pages and the table of FAPs: node build.mjs FOLDER [DEPFILE]
import { build } from 'esbuild';
import { createHash } from 'node:crypto';
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { decoders } from './decoders.mjs';
import { manifest } from './package/manifest.mjs';
import { trimmed } from './trimmed.mjs';

const here = path.dirname(fileURLToPath(import.meta.url));
const [folder, depfile, contents] = process.argv.slice(2);
const out = folder && path.resolve(folder);
if (!out) {
  console.error('usage: node build.mjs FOLDER [DEPFILE [CONTENTS]]');
  process.exit(2);
}

// Tells bundlers to keep import() of a URL: webpack would look for a module of that
// name, and find none. Minifying takes the comments away that say so.
const left = 'import(/* webpackIgnore: true *//* @vite-ignore */';
function leaveImports(script) {
  const file = path.join(out, script);
  writeFileSync(file, readFileSync(file, 'utf8').replace(/\bimport\((?!["'`/])/g, left));
}

// absWorkingDir: comments that name files are the same wherever it is built
const common = { absWorkingDir: here, bundle: true, minify: true, format: 'esm', target: 'es2022', legalComments: 'none' };
const inputs = new Set(['build.mjs', 'decoders.mjs', 'trimmed.mjs', 'docs/element/reference.md', 'package/manifest.mjs'].map((file) => path.join(here, file)));
const within = {}; // of each script, the files that something of is in it
const note = ({ inputs: found, outputs }) => {
  const files = Object.keys(found).filter((file) => file !== '<stdin>'); // which would make each build do it again
  files.forEach((file) => inputs.add(path.resolve(here, file.replace(/^.*?:/, ''))));
  for (const [script, { inputs: parts }] of Object.entries(outputs))
    within[path.basename(script)] = Object.keys(parts).filter((file) => parts[file].bytesInOutput);
};

mkdirSync(out, { recursive: true });
const result = await build({
  ...common,
  entryPoints: [path.join(here, 'element/talking-head.mjs')],
  outfile: path.join(out, 'talking-head.js'),
  banner: { js: '/* faccia, MIT. Contains three.js, MIT, (c) three.js authors. */' },
  metafile: true,
  plugins: [trimmed],
});
leaveImports('talking-head.js');
note(result.metafile);
const worklet = await build({
  ...common,
  entryPoints: [path.join(here, 'element/audio/worklet.mjs')],
  outfile: path.join(out, 'talking-head-worklet.js'),
  minify: false, // Vite writes a file of less than 4 kB into the script as data:, which a policy of `script-src 'self'` refuses
  banner: { js: '/* faccia, MIT. */' },
  metafile: true,
});
note(worklet.metafile);
const fallback = await build({
  ...common,
  stdin: { contents: "export { OpusDecoder } from 'opus-decoder';", resolveDir: here },
  outfile: path.join(out, 'opus-decoder.js'),
  banner: { js: '/* opus-decoder, MIT, (c) Ethan Halsall; contains libopus, BSD-3-Clause. */' },
  metafile: true,
});
note(fallback.metafile);
// Turns pictures into heads: loaded by a page when it receives a picture.
const portrait = await build({
  ...common,
  entryPoints: [path.join(here, 'portrait/page.mjs')],
  outfile: path.join(out, 'portrait.js'),
  banner: { js: '/* faccia, MIT. Contains @vladmandic/human, MIT, (c) Vladimir Mandic, with TensorFlow.js, Apache-2.0, (c) Google LLC. */' },
  metafile: true,
  external: ['fs', 'worker_threads', 'perf_hooks', 'os'],
});
note(portrait.metafile);
const poses = await build({
  ...common,
  entryPoints: [path.join(here, 'portrait/actions/worker.mjs')],
  outfile: path.join(out, 'portrait-poses.js'),
  format: 'iife', // a worker of any browser
  banner: { js: '/* faccia, MIT. */' },
  metafile: true,
});
note(poses.metafile);
const wasm = 'tfjs-backend-wasm-simd.wasm';
const nets = ['blazeface', 'facemesh', 'iris'].flatMap((net) => [`${net}.json`, `${net}.bin`]);
for (const [folder, files] of [['@tensorflow/tfjs-backend-wasm/dist', [wasm]], ['@vladmandic/human/models', nets]])
  for (const file of files) {
    inputs.add(path.join(here, 'node_modules', folder, file));
    copyFileSync(path.join(here, 'node_modules', folder, file), path.join(out, file));
  }
const avatar = await build({
  ...common,
  entryPoints: [path.join(here, 'element/avatar/avatar.mjs')],
  outfile: path.join(out, 'talking-head-avatar.js'),
  banner: { js: '/* faccia, MIT. Contains three.js, MIT, (c) three.js authors; meshoptimizer, MIT, (c) Arseny Kapoulkine. */' },
  metafile: true,
});
leaveImports('talking-head-avatar.js');
note(avatar.metafile);
for (const [name, credit] of [['draco', 'the decoder of Draco'], ['basis', 'the transcoder of Basis Universal']]) {
  const packed = await build({
    ...common,
    entryPoints: [path.join(here, `element/avatar/packed/${name}.mjs`)],
    outfile: path.join(out, `talking-head-${name}.js`),
    banner: { js: `/* faccia, MIT. Contains ${credit}, Apache-2.0, (c) its authors, as three.js brings it. */` },
    metafile: true,
    plugins: [decoders],
    loader: { '.wasm': 'binary' },
    external: ['fs', 'path'],
  });
  note(packed.metafile);
}
const film = await build({
  ...common,
  entryPoints: [path.join(here, 'film/film.mjs')],
  outfile: path.join(out, 'film.js'),
  banner: { js: '/* faccia, MIT. Contains three.js, MIT, (c) three.js authors. */' },
  metafile: true,
  plugins: [trimmed],
});
note(film.metafile);
const filmKit = await build({
  ...common,
  entryPoints: [path.join(here, 'film/take.mjs')],
  outfile: path.join(out, 'film-kit.js'),
  banner: { js: '/* faccia, MIT. Contains three.js, MIT, (c) three.js authors; Mediabunny, MPL-2.0, (c) Vanilagy and contributors. */' },
  metafile: true,
  plugins: [trimmed],
});
note(filmKit.metafile);
const kit = await build({
  ...common,
  stdin: {
    contents: `export { default as uPlot } from 'uplot'; export { default as FFT } from 'fft.js';
      export { readFapcFile } from '../protocol/fapc/fapcfile.mjs'; export { isFba, readFba, supplyFba } from '../protocol/fba/fba.mjs'; export { mono } from './element/audio/mixdown.mjs';`,
    resolveDir: here,
  },
  outfile: path.join(out, 'player-kit.js'),
  banner: { js: '/* Contains uPlot, MIT, (c) Leon Sorokin, and fft.js, MIT, (c) Fedor Indutny; of faccia, MIT. */' },
  metafile: true,
});
note(kit.metafile);
copyFileSync(path.join(here, 'node_modules/uplot/dist/uPlot.min.css'), path.join(out, 'plot.css'));
// Each page is one script, whose address is that of the page with .js: a browser fetches it at once, not one module after the
// other. The library has a second, small one, which asks for the text before the first has come.
const pages = path.join(here, 'pages');
const scripts = readdirSync(pages).filter((name) => existsSync(path.join(pages, name, `${name}.js`))).map((name) => `${name}/${name}.js`);
const bundled = await build({
  ...common,
  entryPoints: [...scripts, 'library/library-early.js'].map((file) => path.join(pages, file)),
  outdir: out,
  entryNames: '[name]',
  external: ['talking-head', 'player-kit', 'film-kit', 'portrait', 'library', 'library-early', 'stories'].map((name) => `./${name}.js`),
  banner: { js: '/* faccia, MIT. */' },
  metafile: true,
});
note(bundled.metafile);
// Puts the parts that a page names as `<!-- include NAME -->` into it, from the folder `shared`, and marks the page in
// the menu.
function complete(page, name) {
  const own = name === 'index.html' ? './' : name;
  return page
    .replace(/^ *<!-- include (\w+) -->\n/gm, (_, part) => readFileSync(path.join(pages, 'shared', `${part}.html`), 'utf8'))
    .replace(`<a href="${own}" data-text`, `<a href="${own}" aria-current="page" data-text`);
}
// All else is served as it lies in its folder: pages, styles, workers, scripts that no page imports, and the examples, whose
// source their page shows.
const served = ['stories.js', 'library-worker.js', 'room-worker.js', 'room-early.js', 'faccia-card.js'];
for (const file of readdirSync(pages, { recursive: true })) {
  const name = path.basename(file);
  if (!/\.(html|css|svg|png|webmanifest)$/.test(name) && !served.includes(name)) continue;
  inputs.add(path.join(pages, file));
  if (!name.endsWith('.html')) copyFileSync(path.join(pages, file), path.join(out, name));
  else if (path.dirname(file) !== 'shared') writeFileSync(path.join(out, name), complete(readFileSync(path.join(pages, file), 'utf8'), name));
}
// The worker of the room's page keeps all that the page needs to show itself.
const shell = ['room.html', 'room.css', 'page.css', 'room-early.js', 'room.js', 'room.webmanifest', 'icon.svg', 'icon-192.png', 'talking-head.js', 'talking-head-worklet.js'];
const version = createHash('sha256');
for (const file of shell) version.update(readFileSync(path.join(out, file)));
const worker = path.join(out, 'room-worker.js');
writeFileSync(worker, readFileSync(worker, 'utf8').replace('@version@', version.digest('hex').slice(0, 16)).replace("'@files@'", shell.map((file) => `'${file}'`).join(', ')));
const types = path.join(here, 'element/talking-head.d.ts');
inputs.add(types);
copyFileSync(types, path.join(out, 'talking-head.d.ts'));
const faps = path.join(here, '../protocol/fap-table.json');
inputs.add(faps);
copyFileSync(faps, path.join(out, 'faps.json'));
// what the page of examples makes its fields of
writeFileSync(path.join(out, 'custom-elements.json'), JSON.stringify(manifest(types, path.join(here, 'docs/element/reference.md'), 'talking-head.js')));

// The daemon serves FILE.gz as it is, and starts sooner than if it had to compress. meson.build lists the same files.
for (const file of readdirSync(out).filter((name) => /\.(js|css|html|wasm)$/.test(name) || name === 'custom-elements.json' || name === 'faps.json'))
  writeFileSync(path.join(out, `${file}.gz`), gzipSync(readFileSync(path.join(out, file)), { level: 9 }));
if (depfile) {
  const escape = (file) => file.replaceAll(' ', '\\ ');
  writeFileSync(depfile, `${escape(path.join(folder, 'talking-head.js'))}: ${[...inputs].map(escape).join(' ')}\n`);
}
if (contents) writeFileSync(contents, JSON.stringify(within));
