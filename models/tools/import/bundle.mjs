// SPDX-License-Identifier: GPL-3.0-or-later
/** Puts faccia-head.mjs, or another tool, into one file that needs nothing but Node.js: bundle.mjs OUTPUT [TOOL]. What it reads of the repository while it runs goes in, too. */
import fs from 'node:fs';
import { fileURLToPath } from 'node:url';
import path from 'node:path';
import { build } from '../../../web/node_modules/esbuild/lib/main.js';

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

await build({
  entryPoints: [process.argv[3] ?? path.join(here, 'faccia-head.mjs')],
  outfile: process.argv[2],
  bundle: true, platform: 'node', target: 'node18', format: 'esm', plugins: [texts], logLevel: 'error',
});
