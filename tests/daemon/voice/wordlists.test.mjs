// SPDX-License-Identifier: GPL-3.0-or-later
// Every phone of a voice has a lip shape: speaks word lists of each language with its voices, without a warning. FACCIA_WORDS: number of
// words, spread over each list (0 = all, which takes a quarter of an hour).
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { build } from '../../lib/daemon.mjs';

const wanted = Number(process.env.FACCIA_WORDS ?? 3000);
const lists = [
  ['it', '/usr/share/dict/italian', ['espeak:it', 'espeak:it+f2']],
  ['pt-BR', '/usr/share/dict/brazilian', ['espeak:pt-br']],
  ['tr', '/usr/share/hunspell/tr_TR.dic', ['espeak:tr']],
  ['en', '/usr/share/dict/american-english', ['espeak:en-us', 'espeak:en-gb']],
];

/** Reads a word list. Hunspell dictionaries begin with their size and have flags after a slash. */
function words(file) {
  const bytes = fs.readFileSync(file);
  const text = new TextDecoder('utf-8').decode(bytes);
  const all = text.split(/\r?\n/).map((line) => line.replace(/[/\t].*/, '')).filter((word) => /^\p{L}{2,}$/u.test(word));
  const step = wanted ? Math.max(1, all.length / wanted) : 1;
  return Array.from({ length: Math.floor(all.length / step) }, (_, i) => all[Math.floor(i * step)]);
}

for (const [lang, file, voices] of lists)
  for (const voice of voices)
    test(`${lang}: the pack knows every phone of ${voice}`, () => {
      const chosen = words(file);
      assert.ok(chosen.length > 1000, `${chosen.length} words in ${file}`);
      const { status, stdout, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['say', '--lang', lang, '--voice', voice, '-'], {
        input: chosen.join(', ') + '.', maxBuffer: 1 << 30,
      });
      assert.equal(status, 0, String(stderr).slice(0, 500));
      const { phones, warnings } = JSON.parse(stdout);
      assert.deepEqual(warnings.slice(0, 5), []);
      assert.ok(phones.length > 3 * chosen.length);
    });
