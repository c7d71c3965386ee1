// SPDX-License-Identifier: GPL-3.0-or-later
// Comparing engines with people: curves recorded from the face itself serve as people, so results are known. And the contact layer in all interfaces.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../lib/command.mjs';
import { Daemon } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const at = (name) => path.join(folder, name);
const run = (...args) => {
  const { status, stdout, stderr } = faccia(args);
  assert.equal(status, 0, stderr);
  return stdout;
};
const MNS = 21; // mm, of the Italian pack's speaker

/** Speaks a text with an engine and saves its lips as a person's marker data, delayed by `late` seconds. Returns the phones. */
function record(name, text, engine, late = 0) {
  run('say', '--still', '--fps', '100', '--engine', engine, '--fap', at('say.fap'), '--json', at('say.json'), text);
  const { phones } = JSON.parse(fs.readFileSync(at('say.json')));
  const { frames } = parseFap(fs.readFileSync(at('say.fap'), 'utf8'));
  const mm = (v) => ((v * MNS) / 1024).toFixed(3);
  fs.writeFileSync(at(`${name}.csv`), 't,ul_z,ll_z,jaw_z,other\n' + frames.map((f, k) => [(k / 100 + late).toFixed(3), (40 + Number(mm(-f[4]))).toFixed(3), mm(f[5]), mm(-f[3]), 'x'].join(',')).join('\n') + '\n');
  fs.writeFileSync(at(`${name}.json`), JSON.stringify({ phones }));
  return phones;
}
const text = 'La mamma parla piano, papà beve il vino.';
const phones = record('one', text, 'dominance');
record('late', text, 'dominance', 0.03);
const evaluate = (...args) => JSON.parse(run('eval', '--json', '-', ...args)).rows;
const row = (rows, engine, contacts) => rows.find((r) => r.engine === engine && (!contacts || r.contacts === contacts));

test('an engine is like itself, and a baseline is less like it', () => {
  const rows = evaluate('--recording', at('one.csv'), '--phones', at('one.json'));
  assert.deepEqual(rows.map((r) => `${r.engine} ${r.contacts}`), ['dominance on', 'dominance off', 'cohen-massaro off', 'cohen-massaro on', 'table off', 'table on']);
  const own = row(rows, 'dominance', 'on');
  for (const name of ['aperture', 'LI', 'LS', 'EM']) {
    assert.ok(own[name].r > 0.995 && own[name].rms < 0.25, `${name}: ${JSON.stringify(own[name])}`);
    assert.ok(Math.abs(own[name].shift) <= 5);
    assert.ok(row(rows, 'table', 'off')[name].rms > own[name].rms);
  }
  assert.equal(own.AR, undefined, 'not recorded');
  assert.equal(own.reader.right, own.reader.read, 'who learnt from this mouth reads it');
  assert.ok(row(rows, 'cohen-massaro', 'off').reader.right < own.reader.right);
});

test('a shift is found, reported, and can be taken beforehand', () => {
  const args = ['--engine', 'dominance', '--recording', at('late.csv'), '--phones', at('one.json')];
  const [found] = evaluate(...args);
  assert.equal(found.aperture.shift, 30);
  assert.ok(found.aperture.shifted_r > 0.995 && found.aperture.r < 0.97);
  const [taken] = evaluate(...args, '--shift', '30');
  assert.ok(Math.abs(taken.aperture.shift) <= 5 && taken.aperture.r > 0.995);
});

test('times in any form: CSV, TextGrid, .lab, ARPAbet', () => {
  const [json] = evaluate('--engine', 'dominance', '--recording', at('one.csv'), '--phones', at('one.json'));
  fs.writeFileSync(at('one.phones.csv'), 'start;end;label\n' + phones.map((p) => `${p.start};${p.end};${(p.stress === 2 ? 'ˈ' : p.stress === 1 ? 'ˌ' : '') + p.ipa || 'sil'}`).join('\n'));
  const intervals = phones.map((p, i) => `intervals [${i + 1}]:\nxmin = ${p.start}\nxmax = ${p.end}\ntext = "${p.sampa === '_' ? '' : (p.stress === 2 ? '""' : p.stress === 1 ? '%' : '') + p.sampa}"\n`).join('');
  const end = phones.at(-1).end;
  fs.writeFileSync(at('one.TextGrid'), `File type = "ooTextFile"\nObject class = "TextGrid"\n\nxmin = 0\nxmax = ${end}\ntiers? <exists>\nsize = 1\nitem []:\nitem [1]:\nclass = "IntervalTier"\nname = "phones"\nxmin = 0\nxmax = ${end}\nintervals: size = ${phones.length}\n${intervals}`);
  for (const name of ['one.phones.csv', 'one.TextGrid']) {
    const [other] = evaluate('--engine', 'dominance', '--recording', at('one.csv'), '--phones', at(name));
    assert.ok(Math.abs(other.aperture.r - json.aperture.r) < 0.02, `${name}: ${other.aperture.r}, ${json.aperture.r}`);
  }
  fs.writeFileSync(at('a.csv'), 'time,LI\n' + Array.from({ length: 60 }, (_, k) => `${k / 100},${5 * Math.sin(k / 9)}`).join('\n'));
  fs.writeFileSync(at('arpabet.lab'), '#\n0.1 100 SIL\n0.3 100 AA1\n0.35 100 P\n0.5 100 IY0\n');
  fs.writeFileSync(at('ipa.lab'), '#\n0.1 100 \n0.3 100 ˈɑː\n0.35 100 p\n0.5 100 iː\n');
  const [arpabet, ipa] = ['arpabet.lab', 'ipa.lab'].map((name) => evaluate('--lang', 'en', '--recording', at('a.csv'), '--phones', at(name)));
  assert.deepEqual(arpabet, ipa);
});

test('another person is brought to the same times', () => {
  run('say', '--still', '--fps', '100', '--rate', '100', '--fap', at('slow.fap'), '--json', at('slow.json'), text);
  const { frames } = parseFap(fs.readFileSync(at('slow.fap'), 'utf8'));
  fs.writeFileSync(at('slow.csv'), 'time,LI,LS\n' + frames.map((f, k) => [k / 100, (-f[5] * MNS) / 1024, (-f[4] * MNS) / 1024].join(',')).join('\n'));
  const rows = evaluate('--recording', at('one.csv'), '--phones', at('one.json'), '--other', at('slow.csv'), '--other-phones', at('slow.json'));
  const other = rows.at(-1);
  assert.equal(other.engine, 'another person');
  assert.ok(other.aperture.r > 0.85, `${other.aperture.r}`);
  fs.writeFileSync(at('b.csv'), 'time,LI,LS\n0,0,0\n0.5,1,1\n');
  fs.writeFileSync(at('b.phones.csv'), 'start,end,ipa\n0,0.2,_\n0.2,0.4,k\n');
  const different = faccia(['eval', '--recording', at('one.csv'), '--phones', at('one.json'), '--other', at('b.csv'), '--other-phones', at('b.phones.csv')]);
  assert.equal(different.status, 1);
  assert.match(different.stderr, /does not say the same/);
});

test('the table of recordings, and ablations', () => {
  const table = run('eval', '--ablation', '--recording', at('one.csv'), '--phones', at('one.json'));
  assert.match(table, /^aperture +r +rms +affine +shift/m);
  assert.match(table, /^dominance-no-resistance -contacts +-?\d/m);
  assert.match(table, /^reader, taught by people/m);
});

test('what cannot be compared is named', () => {
  for (const [args, code, message] of [
    [['--recording', at('one.csv')], 2, /needs --phones/],
    [['--phones', at('one.json')], 2, /--recording comes before/],
    [['--recording', at('one.csv'), '--phones', at('one.json'), '--other', at('one.csv')], 2, /needs both --other/],
    [['--recording', at('none.csv'), '--phones', at('one.json')], 1, /none\.csv: No such file/],
    [['--recording', at('one.csv'), '--phones', at('one.csv')], 1, /one\.csv: /],
    [['--recording', at('one.csv'), '--phones', at('one.json'), '--svg', '-'], 2, /no picture/],
    [['--recording', at('one.csv'), '--phones', at('one.json'), '--engine', 'syllable'], 2, /does not speak/],
    [['--contacts', 'maybe', 'a'], 2, /--contacts: must be one of/],
    [['--shift', '99', 'a'], 2, /--shift: must be/],
  ]) {
    const { status, stderr } = faccia(['eval', ...args]);
    assert.match(stderr, message, args.join(' '));
    assert.equal(status, code, args.join(' '));
  }
});

test('contacts by every door', async () => {
  const widest = (fap) => {
    const { frames } = parseFap(fap);
    return Math.max(...frames.map((f) => f[4] + f[5])); // pressed lips are positive
  };
  const args = ['say', '--still', '--rate', '300', '--engine', 'cohen-massaro', '--fap', '-', 'Papà.'];
  const [engine, on, off] = [[], ['--contacts', 'on'], ['--contacts', 'off']].map((more) => run(...args, ...more));
  assert.equal(engine, off, 'a baseline has none of its own');
  assert.notEqual(on, off);
  assert.ok(widest(on) >= 0);
  assert.equal(run(...args, '--engine', 'dominance'), run(...args, '--engine', 'dominance', '--contacts', 'on'));
  const daemon = await Daemon.start(['--contacts', 'on']);
  const get = async (query) => (await fetch(`http://127.0.0.1:${daemon.port}/v1/speech?lang=it&format=fap&still=1&seed=1&rate=300&text=Papà.&engine=cohen-massaro${query}`)).text();
  try {
    assert.equal(await get(''), await get('&contacts=on'), 'the setting is for requests that say nothing');
    assert.notEqual(await get(''), await get('&contacts=off'));
    assert.match(await get('&contacts=some'), /"field":"contacts"/);
  } finally {
    await daemon.stop();
  }
});
