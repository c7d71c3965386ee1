// SPDX-License-Identifier: GPL-3.0-or-later
// Bundles scripts of the benchmarks' pages, which may import from web/ and its packages.
import { createRequire } from 'node:module';
import path from 'node:path';
import { root } from '../lib/daemon.mjs';

/** @param {string} contents of a module @param {string} web the folder that its paths start from @returns {Promise<string>} */
export async function bundle(contents, web = path.join(root, 'web')) {
  const { build } = createRequire(path.join(root, 'web/package.json'))('esbuild');
  const { outputFiles } = await build({
    stdin: { contents, resolveDir: web }, bundle: true, format: 'esm', write: false, nodePaths: [path.join(root, 'web/node_modules')],
  });
  return outputFiles[0].text;
}
