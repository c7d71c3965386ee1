// SPDX-License-Identifier: GPL-3.0-or-later
// Rules for JavaScript outside web/, which has its own: names exist and are used. Run from the top of the tree (as
// tests/protocol/format.test.mjs does): node web/node_modules/eslint/bin/eslint.js --config tests/eslint.config.js tests models/tools
// protocol server
import globals from '../web/node_modules/globals/index.js';

export default [
  {
    // Import attributes, which this version of ESLint cannot read; tests of the web client load these files.
    ignores: ['protocol/fap.mjs', 'protocol/fapc/fapc-model.mjs', '**/node_modules/**'],
  },
  {
    files: ['**/*.{js,mjs}'],
    languageOptions: { ecmaVersion: 2024, sourceType: 'module', globals: { ...globals.node, ...globals.browser, $state: 'readonly' /* Svelte's */ } },
    rules: { 'no-undef': 'error', 'no-unused-vars': ['error', { args: 'none', ignoreRestSiblings: true, varsIgnorePattern: '^_' }] },
  },
];
