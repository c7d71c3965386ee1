// SPDX-License-Identifier: GPL-3.0-or-later
// The schemas against the examples of the written protocol: what the client sends there is valid, or is there to be refused.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { violations } from '../lib/schema.mjs';

const text = fs.readFileSync(new URL('../../protocol/README.md', import.meta.url), 'utf8');
const sent = [...text.matchAll(/^> (\{.*\})$/gm)].map((match) => JSON.parse(match[1]));

test('the examples of the client are valid', () => {
  assert.ok(sent.length >= 4);
  for (const message of sent) {
    const wrong = violations('client', message);
    assert.equal(wrong === null, message.type !== 'dance', wrong);
  }
});

test('the schemas refuse what is not in the protocol', () => {
  assert.ok(violations('client', { type: 'speak' }));
  assert.ok(violations('client', { type: 'speak', text: 'a', rate: 5000 }));
  assert.ok(violations('server', { type: 'end', stream: 's1', utterance: 1, reason: 'bored', duration: 1 }));
  assert.ok(violations('server', { type: 'pong', extra: 1 }));
  assert.ok(violations('head-model', { format: 'faccia-head' }));
});
