// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Bundles a tool into one file that needs only Node.js, and the face detector into another, which loads its networks from where the pages
 * have them: bundle.mjs TOOL OUTPUT [EYE]. Embeds files of the repository that are read at run time.
 */
import fs from 'node:fs';
import { fileURLToPath } from 'node:url';
import path from 'node:path';
import { build } from '../../../web/node_modules/esbuild/lib/main.js';
import { decoders } from '../../../web/decoders.mjs';

const READS = /fs\.readFileSync\(new URL\('([^']+)', import\.meta\.url\), 'utf8'\)/g;
const here = path.dirname(fileURLToPath(import.meta.url));

const texts = {
  name: 'texts',
  setup({ onLoad }) {
    onLoad({ filter: /models[/\\]tools[/\\].*\.mjs$/ }, ({ path: file }) => ({
      contents: fs.readFileSync(file, 'utf8').replace(READS, (_, name) => JSON.stringify(fs.readFileSync(path.join(path.dirname(file), name), 'utf8'))),
    }));
  },
};

/** Globals that third-party CommonJS code expects. */
const ROOM = `import { createRequire as ownRequire } from 'node:module'; import { fileURLToPath as ownPath } from 'node:url'; import { dirname as ownFolder } from 'node:path';
const require = ownRequire(import.meta.url); const __filename = ownPath(import.meta.url); const __dirname = ownFolder(__filename);`;
const TOOL = '/* faccia, GPL-3.0-or-later. Contains three.js, MIT, (c) three.js authors; meshoptimizer, MIT, (c) Arseny Kapoulkine; decoders of Draco and Basis Universal, Apache-2.0, (c) their authors. */';
const common = { bundle: true, platform: 'node', target: 'node18', format: 'esm', plugins: [texts, decoders], loader: { '.wasm': 'binary' }, logLevel: 'error' };
const [, , tool, output, eye] = process.argv;
await build({ ...common, entryPoints: [tool], outfile: output, ...(eye ? { banner: { js: `${TOOL}\n${ROOM}` } } : {}) });
if (eye) await build({
  ...common, entryPoints: [path.join(here, 'faccia-eye.mjs')], outfile: eye, minify: true,
  banner: {
    js: `/* faccia, GPL-3.0-or-later. Contains @vladmandic/human, MIT, (c) Vladimir Mandic, with TensorFlow.js, Apache-2.0, (c) Google LLC. */
${ROOM}`,
  },
});
