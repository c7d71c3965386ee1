// SPDX-License-Identifier: GPL-3.0-or-later
// Affects change the loudness of speech, but none startles: at most -17 LUFS.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build } from '../../lib/daemon.mjs';
import { cases } from '../../lib/long.mjs';
import { LOUDEST, loudness } from '../../lib/loudness.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-loudness-'));
after(() => fs.rmSync(folder, { recursive: true }));

for (const lang of cases(['tr'], ['it', 'en', 'pt']))
  test(`${lang}: the loudest affects are louder than none, and not too loud`, () => {
    const of = (affect) => loudness(path.join(build, 'server/cli/faccia'), path.join(folder, 'x.wav'), lang, affect).level;
    const none = of(null);
    assert.ok(none < LOUDEST - 1 && none > -22, String(none));
    for (const affect of ['anger', 'surprise', 'hate', 'joy']) {
      const level = of(affect);
      assert.ok(level <= LOUDEST && level > none, `${affect}: ${level}, without it ${none}`);
    }
    assert.ok(of('sadness') < none - 1);
  });
