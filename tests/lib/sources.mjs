// SPDX-License-Identifier: GPL-3.0-or-later
// The C sources below a folder.
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../../', import.meta.url));

/** Removes comments, keeping line numbers. */
const bare = (text) =>
  text.replace(/"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|\/\*[^]*?\*\/|\/\/.*/g, (part) => (part[0] === '/' ? part.replace(/[^\n]/g, ' ') : part));

/** All .c and .h files of a folder: path from the root, text, and text without comments. */
export function sources(folder) {
  return fs
    .readdirSync(path.join(root, folder), { recursive: true })
    .filter((file) => /\.[ch]$/.test(file) && !file.includes('node_modules'))
    .map((file) => {
      const name = path.posix.join(folder, file);
      const text = fs.readFileSync(path.join(root, name), 'utf8');
      return { name, text, code: bare(text) };
    })
    .sort((a, b) => (a.name < b.name ? -1 : 1));
}
