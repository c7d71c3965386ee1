// SPDX-License-Identifier: GPL-3.0-or-later
// Modules of the pages' sources, for tests that call them in a page: what the daemon serves is one script for each page.
import { createRequire } from 'node:module';
import path from 'node:path';

const web = path.resolve(import.meta.dirname, '../../web');

/** Bundles web/FILE and answers `address` with it. @param {import('playwright-core').Page} page @param {string} file @param {string} address */
export async function serveModule(page, file, address) {
  const { build } = createRequire(path.join(web, 'package.json'))('esbuild');
  const bundle = await build({ entryPoints: [path.join(web, file)], bundle: true, format: 'esm', write: false });
  await page.route(`**${address}`, (route) => route.fulfill({ contentType: 'text/javascript', body: bundle.outputFiles[0].text }));
}
