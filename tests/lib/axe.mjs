// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the current state of a page with axe-core.
import fs from 'node:fs';
import { createRequire } from 'node:module';

const source = fs.readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

const ALL = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];

/**
 * @param {import('playwright-core').Page} page @param {string[]} [rules] default: all of WCAG 2.2 AA and best practices
 * @returns {Promise<string[]>} violated rules with their places
 */
export async function violations(page, rules = ALL) {
  if (!(await page.evaluate(() => 'axe' in window))) await page.evaluate(source); // evaluated directly, because the page's policy forbids added scripts
  const found = await page.evaluate((runOnly) => window.axe.run(document, { runOnly, resultTypes: ['violations'] }), rules);
  return found.violations.flatMap(({ id, help, nodes }) => nodes.map(({ target, any }) => `${id}: ${help}: ${target} ${any[0]?.message ?? ''}`));
}
