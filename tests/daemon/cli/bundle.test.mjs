// SPDX-License-Identifier: GPL-3.0-or-later
// Bundles: what `faccia say --bundle` and `format=bundle` write, and that their reader takes nothing that is damaged.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { gunzipSync } from 'node:zlib';
import { BundleError, crc32, readBundle, readPair } from '../../../protocol/bundle.mjs';
import { build, Daemon } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bundle-'));
const program = path.join(build, 'server/cli/faccia');
const file = (name) => path.join(folder, name);
const say = (...args) => execFileSync(program, ['say', '--lang', 'it', '--seed', '1', ...args], { encoding: 'utf8' });
const TEXT = 'La mamma parla. Il babbo tace.';

let daemon, bytes, bundle;
before(async () => {
  daemon = await Daemon.start();
  say('--bundle', file('a.faccia'), '--model-url', '../heads/mara.json', '--fapc', file('a.fapc'), '--ogg', file('a.ogg'), '--ndjson', file('a.ndjson'), TEXT);
  bytes = new Uint8Array(fs.readFileSync(file('a.faccia')));
  bundle = readBundle(bytes);
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('holds the sound, the face and the events of the separate files', () => {
  const pair = readPair(new Uint8Array(fs.readFileSync(file('a.fapc'))), new Uint8Array(fs.readFileSync(file('a.ogg'))));
  for (const member of ['fps', 'frames', 'packets', 'skip', 'samples']) assert.deepEqual(bundle[member], pair[member], member);
  const lines = fs.readFileSync(file('a.ndjson'), 'utf8').trim().split('\n').map((line) => JSON.parse(line));
  assert.deepEqual(bundle.events, lines.filter(({ type }) => type !== 'frame'));
  assert.deepEqual([bundle.text, bundle.model, bundle.head], [TEXT, '../heads/mara.json', null]);
  assert.ok(Math.abs(bundle.samples / 48000 - bundle.events.at(-1).duration) < 0.001);
  assert.ok(Math.abs(bundle.frames.length / bundle.fps - bundle.samples / 48000) <= 1 / bundle.fps);
});

test('holds the head, whose voice speaks', () => {
  say('--bundle', file('b.faccia'), '--model', 'bruno', 'Ciao.');
  const { head, events: [{ voice }] } = readBundle(new Uint8Array(fs.readFileSync(file('b.faccia'))));
  assert.equal(JSON.parse(gunzipSync(head)).name, 'bruno');
  const { voice: own } = JSON.parse(say('--json', '-', '--gender', 'male', 'Ciao.'));
  assert.equal(voice, own);
});

test('comes over HTTP, too', async () => {
  const answer = await daemon.get(`/v1/speech?${new URLSearchParams({ format: 'bundle', lang: 'it', text: TEXT })}`);
  assert.equal(answer.status, 200);
  const { text, events, packets } = readBundle(new Uint8Array(await answer.arrayBuffer()));
  assert.equal(text, TEXT);
  assert.deepEqual(events.filter(({ type }) => type === 'word').map(({ text: word }) => word), ['La', 'mamma', 'parla', 'Il', 'babbo', 'tace']);
  assert.ok(packets.length > 50);
});

test('refuses wrong options', () => {
  for (const [args, wrong] of [
    [['--model', 'mara', '--wav', file('x.wav')], /--model and --model-url are for --bundle/],
    [['--bundle', file('x'), '--model', 'mara', '--model-url', 'a'], /exclude each other/],
    [['--bundle', file('x'), '--model', 'nobody'], /unknown head 'nobody'/],
  ]) {
    const { status, stderr } = spawnSync(program, ['say', ...args, 'Ciao.'], { encoding: 'utf8' });
    assert.notEqual(status, 0);
    assert.match(stderr, wrong);
  }
  assert.ok(!fs.existsSync(file('x')) && !fs.existsSync(file('x.wav')));
});

/** Splits a bundle into parts, or joins them with lengths and a checksum that fit. */
function partsOf(whole) {
  const parts = [];
  const view = new DataView(whole.buffer, whole.byteOffset);
  for (let at = 8; at < whole.length; ) {
    const size = view.getUint32(at + 4, true);
    parts.push([String.fromCharCode(...whole.subarray(at, at + 4)), whole.slice(at + 8, at + 8 + size)]);
    at += 8 + size;
  }
  return parts.slice(0, -1);
}
function joined(parts) {
  const pieces = [Buffer.from('FACCIA1\n')];
  const add = (type, data) => {
    const head = Buffer.alloc(8);
    head.write(type, 'latin1');
    head.writeUInt32LE(data.length, 4);
    pieces.push(head, Buffer.from(data));
  };
  for (const [type, data] of parts) add(type, data);
  const sum = Buffer.alloc(4);
  sum.writeUInt32LE(crc32(Buffer.concat(pieces)));
  add('SUM ', sum);
  return new Uint8Array(Buffer.concat(pieces));
}
const changed = (type, change) => joined(partsOf(bytes).map(([name, data]) => [name, name === type ? change(data) : data]));
const text = (change) => (data) => Buffer.from(change(Buffer.from(data).toString()));

function refused(made, wrong, name) {
  assert.throws(() => readBundle(made), (error) => {
    assert.ok(error instanceof BundleError, `${name}: ${error.stack}`);
    assert.match(error.message, wrong, name);
    assert.ok(error.at >= 0 && error.at <= made.length && error.message.endsWith(`(byte ${error.at})`), name);
    return true;
  });
}

test('every cut and every changed byte is noticed', () => {
  for (let size = 0; size < bytes.length; size += size < 400 ? 1 : 97) refused(bytes.slice(0, size), /byte/, `cut at ${size}`);
  for (let at = 0; at < bytes.length; at += at < 400 || at > bytes.length - 40 ? 1 : 89) {
    const made = bytes.slice();
    made[at] ^= 0x10;
    refused(made, /byte/, `changed at ${at}`);
  }
  refused(Uint8Array.from([...bytes, 0]), /follows the checksum/, 'longer');
});

test('what a right checksum protects is checked, too', () => {
  const parts = partsOf(bytes);
  const eventsAt = (part) => bytes.findIndex((_, i) => String.fromCharCode(...bytes.subarray(i, i + 4)) === part) + 8;
  assert.deepEqual(readBundle(joined(parts)), bundle);
  assert.deepEqual(readBundle(joined([['note', Buffer.from('a later part')], ...parts])), bundle, 'unknown parts with a small letter are skipped');
  refused(joined([['Note', Buffer.from('')], ...parts]), /not known here \(byte 8\)/, 'a capital letter');
  refused(joined([...parts].reverse()), /not in its place/, 'another order');
  refused(joined([...parts.slice(0, 1), ...parts]), /not in its place/, 'twice');
  for (const [type] of parts) refused(joined(parts.filter(([name]) => name !== type)), new RegExp(`${type} is missing`), type);
  refused(changed('INFO', text((json) => json.replace('"text"', '"texts"'))), /member of INFO/, 'no text');
  refused(changed('INFO', text((json) => json.replace(/"model":"[^"]*"/, '"model":1'))), /member of INFO/, 'model');
  refused(changed('INFO', () => Buffer.from([0x22, 0xff, 0x22])), /no JSON object/, 'UTF-8');
  const lines = (change) => changed('EVNT', text((all) => change(all.trim().split('\n')).map((line) => `${line}\n`).join('')));
  refused(lines((all) => all.slice(1)), new RegExp(`begin is not the first event, or end not the last \\(byte ${eventsAt('EVNT')}\\)`), 'no begin');
  refused(lines((all) => all.slice(0, -1)), /the events have no end/, 'no end');
  refused(lines((all) => [all[0], all[3], all.at(-2), all[2], all.at(-1)]), /not in the order of time/, 'order');
  refused(lines((all) => [all[0], '{"type":"frame","time":0}', ...all.slice(1)]), /an event that is not known/, 'another event');
  refused(lines((all) => all.map((line) => line.replace('"utf16_end"', '"utf16"'))), /a member of sentence/, 'no place');
  refused(lines((all) => [all[0].replace('"fps":25.0', '"fps":30.0'), ...all.slice(1)]), /frame rates/, 'two rates');
  refused(changed('EVNT', (data) => data.subarray(0, -1)), /cut short/, 'no line feed');
  for (const type of ['FAPC', 'OPUS']) {
    const data = partsOf(bytes).find(([name]) => name === type)[1];
    for (let size = 0; size < data.length; size += size < 120 ? 1 : 53) {
      if (type === 'FAPC' && size > 8 && endsPacket(data, size)) continue; // a shorter face, which is one, too
      refused(changed(type, () => data.slice(0, size)), /byte/, `${type} cut at ${size}`);
    }
  }
  refused(changed('OPUS', (data) => {
    const made = data.slice();
    made[made.length - 3] ^= 1;
    return made;
  }), /damaged page/, 'a page');
});

function endsPacket(data, size) {
  let at = 8;
  while (at < size) at += 3 + data[at + 1] + 256 * data[at + 2];
  return at === size;
}
