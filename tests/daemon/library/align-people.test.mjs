// SPDX-License-Identifier: GPL-3.0-or-later
// Aligns a person's recording to a text that differs from it: one sentence is skipped, one is not in the text, one is read twice.
// The sounds are prompts of Debian's asterisk-core-sounds-it.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { ordinary } from '../../lib/daemon.mjs';
import { alignedPhones, closures, loudness, madeOf, prompts } from '../../lib/prompts.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const faccia = path.join(ordinary, 'server/cli/faccia');
const all = prompts();
const named = (...names) => names.map((name) => all.find((p) => p.name === name));

test('aligns stops of a human recording with its audible closures', () => {
  const found = named('agent-alreadyon', 'agent-incorrect', 'agent-newlocation', 'agent-pass', 'all-circuits-busy-now', 'check-number-dial-again').flatMap((prompt) => {
    const phones = alignedPhones(faccia, prompt, folder);
    assert.ok(phones, prompt.name);
    return closures(phones, loudness(prompt.sound));
  });
  const heard = found.filter(Boolean), off = heard.map((x) => Math.abs(x.start)).sort((a, b) => a - b);
  assert.ok(heard.length >= 10 && heard.length > 0.9 * found.length, `${heard.length} of ${found.length} stops have a closure`);
  assert.ok(off[off.length >> 1] < 0.025, `half of them are off by less than ${off[off.length >> 1]} s`); // by chance: 0.066
});

const story = named('agent-alreadyon', 'all-circuits-busy-now', 'check-number-dial-again', 'agent-pass', 'call-fwd-unconditional', 'agent-newlocation', 'agent-user', 'call-fwd-no-ans');
const other = named('agent-incorrect')[0];
for (const [what, read, unread] of [
  ['a sentence is left out', story.toSpliced(3, 1), 3],
  ['one is read that is not in the text', story.toSpliced(4, 0, other), -1],
  ['one is read twice', story.toSpliced(3, 0, story[3]), -1],
])
  test(`${what}: the other words keep their times`, () => {
    const made = madeOf(read);
    fs.writeFileSync(file('x.wav'), made.wav);
    const lines = story.map((p) => p.text.replace(/[.!?]*\s*$/, '.'));
    fs.writeFileSync(file('x.txt'), lines.join('\n'));
    const { status, stderr } = spawnSync(faccia, ['align', file('x.wav'), '--text', file('x.txt'), '--gender', 'male', '--json', file('x.json')]);
    assert.equal(status, 0, String(stderr));
    const { words, sentences } = JSON.parse(fs.readFileSync(file('x.json')));
    let byte = 0, good = 0;
    story.forEach((prompt, i) => {
      const end = byte + Buffer.byteLength(lines[i]), own = words.filter((w) => w.byte_start >= byte && w.byte_end <= end);
      const known = own.filter((w) => w.end > w.start), places = made.places.filter((p) => p.name === prompt.name);
      byte = end + 1;
      if (i === unread) {
        assert.ok(known.length <= own.length / 4, `${prompt.name} is not read, but ${known.length} of ${own.length} words are found`);
        assert.ok(own.some((w) => w.confidence === 0));
        assert.match(String(stderr), new RegExp(`x\\.txt:${i + 1}:\\d+: not in the recording`));
      } else if (places.some((p) => known.length && Math.abs(known[0].start - p.start) < 0.4 && Math.abs(known.at(-1).end - p.end) < 0.4)) good++;
    });
    const wanted = story.length - (unread < 0 ? 0 : 1);
    assert.ok(good >= wanted - 1, `${good} of ${wanted} sentences lie where they are`); // two similar sentences may be confused
    assert.ok(sentences.length >= 4 && sentences.every((s) => s.confidence >= 0 && s.confidence <= 1));
  });
