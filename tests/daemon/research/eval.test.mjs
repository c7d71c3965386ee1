// SPDX-License-Identifier: GPL-3.0-or-later
// faccia eval, faccia stimuli, faccia anova: figures, files, exit codes, messages.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { artefacts } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { further } from '../../lib/long.mjs';

const UPPER = 4;
const LOWER = 5;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const json = (args, input) => {
  const { status, stdout, stderr } = faccia(args, { input });
  assert.equal(status, 0, stderr);
  return JSON.parse(stdout);
};

const texts = {
  it: 'La mamma parla piano, papà beve il vino. Abbiamo una bomba per il pubblico, e un fiume favoloso.',
  'pt-BR': 'A mamãe fala baixo, o papai bebe vinho. Uma bomba para o público, e um favor famoso.',
  tr: 'Babam bana biber verdi, annem portakal seviyor. Fabrika, vapur ve mavi boya.',
  en: 'My mother baked a pie, but father brought very few berries. Happy people move five boxes.',
};
for (const [lang, text] of Object.entries(texts))
  test(`with the default engine lips close and reach the teeth at every rate: ${lang}`, () => {
    const report = json(['eval', '--lang', lang, '--engine', 'dominance', '--rates', '320,80,200,80', '--json', '-', text]);
    assert.equal(report.lang, lang);
    assert.deepEqual(report.rows.map((row) => row.rate), [80, 200, 320], 'sorted, each once');
    for (const row of report.rows) {
      assert.ok(row.bilabials > 3 && row.labiodentals > 1 && row.words > 10, JSON.stringify(row));
      for (const name of ['lips_seen', 'lips_held', 'teeth_seen', 'teeth_held']) assert.equal(row[name], 1, `${name} at ${row.rate}`);
      assert.equal(row.overlap, 0);
      assert.ok(row.opening > 0.2 && row.opening < 1.3, `opening ${row.opening}`);
      assert.ok(row.speed > 20 && row.jerk > 1000);
      for (const name of Object.keys(report.measures)) assert.ok(name in row, name);
    }
    assert.ok(report.rows[0].opening > report.rows[2].opening, 'fast vowels open less');
    assert.ok(report.rows[0].seconds > 1.5 * report.rows[2].seconds);
    // an engine's figures do not depend on the other engines
    const all = json(['eval', '--lang', lang, '--rates', '80', '--json', '-', text]);
    assert.deepEqual(all.rows.find((row) => row.engine === 'dominance'), report.rows[0]);
  });

test('prints the table, and draws a valid SVG', () => {
  fs.writeFileSync(file('text'), texts.it);
  const table = faccia(['eval', '--engine', 'dominance', '--rates', '100,300', '-'], { input: texts.it });
  assert.equal(table.status, 0, table.stderr);
  assert.match(table.stdout, /^dominance +100 +\d+ +100\.0 +100\.0 +100\.0 +100\.0 /m);
  assert.match(table.stdout, /^dominance +300 /m);
  assert.equal(faccia(['eval', '--file', file('text'), '--svg', file('a.svg')]).status, 0);
  const svg = fs.readFileSync(file('a.svg'), 'utf8');
  assert.doesNotMatch(svg, /[">M L-](nan|inf)/);
  fs.mkdirSync(artefacts, { recursive: true });
  const drawn = spawnSync('rsvg-convert', ['--output', path.join(artefacts, 'eval.png'), file('a.svg')]);
  assert.equal(drawn.status, 0, String(drawn.stderr));
  assert.equal(faccia(['eval', '--rates', '120', '--svg', '-', 'Ah.']).status, 0, 'one rate, one word, no closure');
});

test('reports that a text without any contact has nothing to close', () => {
  const { rows } = json(['eval', '--rates', '120', '--json', '-', 'Ieri.']);
  assert.equal(rows[0].lips_seen, null);
  assert.equal(rows[0].teeth_held, null);
});

test('the listening test: 27 words, three modes, three ratios', () => {
  const { status, stdout, stderr } = faccia(['stimuli', '--out', file('kit')]);
  assert.equal(status, 0, stderr);
  assert.match(stdout, /243 trials/);
  const manifest = JSON.parse(fs.readFileSync(file('kit/manifest.json')));
  assert.equal(manifest.items.length, 27);
  assert.equal(manifest.modes.length, 3);
  assert.deepEqual(manifest.snrs, [-12, -18, -24]);
  assert.equal(manifest.trials.length, 243);
  const sounds = new Set(manifest.trials.map((trial) => trial.wav));
  assert.equal(sounds.size, 81, 'the modes share their sound');
  for (const name of sounds) {
    const wav = fs.readFileSync(file(`kit/${name}`));
    assert.equal(wav.toString('latin1', 0, 4), 'RIFF');
    assert.equal(wav.readUInt16LE(22), 1, 'mono');
    assert.equal(wav.readUInt16LE(34), 16, '16 bit');
  }
  const faces = new Set(manifest.trials.filter((trial) => trial.mode === 'dominance').map((trial) => trial.fap));
  assert.equal(faces.size, 27);
  for (const item of manifest.items) {
    const face = parseFap(fs.readFileSync(file(`kit/fap/${item.name}_dominance.fap`), 'utf8'));
    const gap = (frame) => -(frame[UPPER] + frame[LOWER]);
    const gaps = face.frames.map(gap);
    const begin = Math.floor((item.start - 0.2) * face.fps);
    assert.ok(gaps.slice(0, begin).every((g) => Math.abs(g) < 5), `${item.name}: at rest during the carrier`);
    assert.ok(Math.max(...gaps.slice(begin)) > 60, `${item.name}: the mouth opens`);
  }
  const page = fs.readFileSync(file('kit/index.html'), 'utf8');
  const data = JSON.parse(page.match(/<script type="application\/json" id="data">(.*?)<\/script>/s)[1]);
  assert.equal(Object.keys(data.films).length, new Set(manifest.trials.map((trial) => trial.fap).filter(Boolean)).size);
  assert.doesNotMatch(page, /\{\{/);
});

test('the same seed makes the same noise', () => {
  const set = { lang: 'it', carrier: 'Dice: {item}.', snrs: [0], items: [{ name: 'mamma', text: 'mamma' }], page: {} };
  fs.writeFileSync(file('set.json'), JSON.stringify(set));
  const make = (name, seed) => {
    const { status, stderr } = faccia(['stimuli', '--out', file(name), '--set', file('set.json'), '--seed', seed, '--engine', 'still']);
    assert.equal(status, 0, stderr);
    return fs.readFileSync(file(`${name}/wav/mamma_0dB.wav`));
  };
  const first = make('one', '1');
  assert.deepEqual(make('two', '1'), first);
  assert.notDeepEqual(make('three', '2'), first);
});

test('shows the head, pictures, or films of a real speaker with their own sound', further, () => {
  const set = { lang: 'it', carrier: 'Dice: {item}.', snrs: [0, -6], items: [{ name: 'mamma', text: 'mamma' }], page: {} };
  fs.writeFileSync(file('set.json'), JSON.stringify(set));
  fs.mkdirSync(file('films'));
  fs.writeFileSync(file('films/mamma.webm'), 'pictures that move');
  assert.equal(faccia(['say', '--lang', 'it', '--wav', file('films/mamma.wav'), 'Dice: mamma.']).status, 0);
  const words = (content) => fs.writeFileSync(file('films/words.json'), content);
  words('{"mamma": {"start": 0.4, "end": 0.9}}');
  fs.writeFileSync(file('pictures.json'), '{"format": "faccia-pictures", "name": "anna"}');
  const make = (faces, out = 'seen') => faccia(['stimuli', '--out', file(out), '--set', file('set.json'), '--engine', 'still', '--faces', faces]);
  const made = make(`pictures:${file('pictures.json')},video:${file('films')}`);
  assert.equal(made.status, 0, made.stderr);
  const { modes, trials } = JSON.parse(fs.readFileSync(file('seen/manifest.json')));
  assert.deepEqual(modes, ['audio', 'pictures', 'video'].map((name) => ({ name, kind: name })));
  assert.equal(trials.length, 6);
  for (const trial of trials) {
    assert.equal(trial.mode === 'video', trial.wav.startsWith('wav/mamma_video_'), trial.wav);
    assert.equal(trial.mode === 'pictures', Boolean(trial.fap));
    assert.equal(trial.video, trial.mode === 'video' ? 'video/mamma.webm' : undefined);
    assert.ok(fs.existsSync(file(`seen/${trial.wav}`)));
  }
  assert.equal(fs.readFileSync(file('seen/video/mamma.webm'), 'utf8'), 'pictures that move');
  assert.equal(fs.statSync(file('seen/wav/mamma_video_0dB.wav')).size, fs.statSync(file('films/mamma.wav')).size);
  const page = fs.readFileSync(file('seen/index.html'), 'utf8');
  assert.equal(JSON.parse(page.match(/<script type="application\/json" id="data">(.*?)<\/script>/s)[1]).pictures.name, 'anna');

  const refused = (faces, status, what) => {
    const failed = make(faces, 'refused');
    assert.equal(failed.status, status, failed.stderr);
    assert.match(failed.stderr, what);
    assert.ok(!fs.existsSync(file('refused')), 'nothing is written');
  };
  for (const faces of ['steam', 'video', 'head,head', 'head:x', 'pictures:', '']) refused(faces, 2, /--faces: /);
  refused(`pictures:${file('set.json')}`, 1, /set\.json: format: /);
  refused(`video:${file('nowhere')}`, 1, /nowhere\/words\.json: /);
  for (const [content, what] of [['{', /words\.json: 1:1: /], ['{}', /words\.json: mamma: needs/], ['{"mamma": {"start": 2, "end": 1}}', /words\.json: mamma: needs/]]) {
    words(content);
    refused(`video:${file('films')}`, 1, what);
  }
  words('{"mamma": {"start": 400, "end": 900}}');
  const behind = make(`video:${file('films')}`);
  assert.equal(behind.status, 1);
  assert.match(behind.stderr, /mamma\.wav: the word's time in words\.json is after its end/);
  fs.rmSync(file('films/mamma.webm'));
  refused(`video:${file('films')}`, 1, /no film of 'mamma'/);
});

const means = `snr,mode,mean,variance,n
-12,a,0.3424,0.0077,41
-12,a+a,0.5944,0.0136,41
-12,v+a,0.6396,0.0145,41
`;
test('analyses a printed table', () => {
  const { status, stdout, stderr } = faccia(['anova', '--means', '-'], { input: means });
  assert.equal(status, 0, stderr);
  const f = (hypothesis) => Number(stdout.match(new RegExp(`^ *-12 +${hypothesis.replaceAll('+', '\\+')} +\\d+ +\\d+ +([\\d.]+)`, 'm'))[1]);
  // Costa, MSc thesis, UNICAMP 2009, table 6.2
  for (const [hypothesis, printed] of [['all', 88.3376], ['a = a+a', 122.8871], ['a = v+a', 163.6644], ['a+a = v+a', 2.8801]])
    assert.ok(Math.abs(f(hypothesis) / printed - 1) < 0.04, `${hypothesis}: ${f(hypothesis)}`);
  assert.match(stdout, /a\+a = v\+a .* 0\.0\d\d\d$/m);
});

test('analyses answers', () => {
  const lines = ['listener,mode,snr,correct'];
  for (let listener = 0; listener < 4; listener++)
    for (const [mode, right] of [['audio', 2 + (listener % 2)], ['face', 7 - (listener % 2)]])
      for (let i = 0; i < 10; i++) lines.push(`l${listener},${mode},-18,${Number(i < right)}`);
  const { status, stdout } = faccia(['anova', '--csv', '-'], { input: lines.join('\n') });
  assert.equal(status, 0);
  // means 0.25 and 0.65, both variances 0.01 / 3: F = 4 * 2 * 0.2^2 / (0.01 / 3) = 96
  assert.match(stdout, /-18 +audio = face +1 +6 +96\.0000 +<0\.001/);
});

test('draws the shares of correct answers, and of each listener', () => {
  const shares = { '-12': { audio: [0.1, 0.2, 0.3, 0.4, 0.5], face: [0.5, 0.6, 0.7, 0.8, 0.9] }, '-24': { audio: [0, 0, 0, 0.1, 0.1], face: [0.2, 0.2, 0.3, 0.3, 0.4] } };
  const lines = ['listener,mode,snr,correct'];
  for (const [snr, modes] of Object.entries(shares))
    for (const [mode, list] of Object.entries(modes))
      for (const [listener, share] of list.entries()) for (let i = 0; i < 10; i++) lines.push(`l${listener},${mode},${snr},${Number(i < Math.round(10 * share))}`);
  const { status, stderr } = faccia(['anova', '--csv', '-', '--plot', file('charts')], { input: lines.join('\n') });
  assert.equal(status, 0, stderr);
  const correct = fs.readFileSync(file('charts/correct.svg'), 'utf8'), listeners = fs.readFileSync(file('charts/listeners.svg'), 'utf8');
  for (const name of ['correct.svg', 'listeners.svg']) fs.copyFileSync(file(`charts/${name}`), path.join(artefacts, `anova-${name}`));
  assert.equal(correct.match(/V[\d.]+M[\d.]+ [\d.]+h10/g).length, 4, 'four means with their errors');
  const boxes = [...listeners.matchAll(/<path d="M[\d.]+ ([\d.]+)h[\d.]+M[\d.]+ [\d.]+V([\d.]+)M[\d.]+ ([\d.]+)V([\d.]+)M.*\n<rect .*\n<path d="M[\d.]+ ([\d.]+)h/g)].map((m) => m.slice(1).map(Number));
  assert.equal(boxes.length, 4);
  // heights in the chart, back into shares: 300 pixels for 105 %
  const share = (y) => (1 - (y - 66) / 300) * 1.05;
  const seen = boxes.map((box) => box.map((y) => Math.round(1000 * share(y)) / 1000)); // least, lower quartile, upper quartile, greatest, median
  for (const [i, wanted] of [[0.1, 0.2, 0.4, 0.5, 0.3], [0.5, 0.6, 0.8, 0.9, 0.7], [0, 0, 0.1, 0.1, 0], [0.2, 0.2, 0.3, 0.4, 0.3]].entries())
    for (const [k, value] of wanted.entries()) assert.ok(Math.abs(seen[i][k] - value) < 0.002, `${seen[i]} for ${wanted}`);
  const table = faccia(['anova', '--means', '-', '--plot', file('table')], { input: means });
  assert.equal(table.status, 0, table.stderr);
  assert.deepEqual(fs.readdirSync(file('table')), ['correct.svg']);
  assert.match(faccia(['anova', '--means', '-', '--plot', '/dev/null'], { input: means }).stderr, /cannot make the folder/);
});

test('refuses names that cannot be drawn', () => {
  const { status, stderr } = faccia(['anova', '--csv', '-'], { input: 'listener,mode,snr,correct\nl,"a\tb",0,1\n' });
  assert.equal(status, 1);
  assert.match(stderr, /mode contains a control character/);
});

const wrong = [
  [['eval'], 2, /no text/],
  [['eval', '--rates', '80,', 'a'], 2, /--rates: must be/],
  [['eval', '--rates', '30', 'a'], 2, /--rates: must be/],
  [['eval', '--engine', 'steam', 'a'], 2, /engine: unknown engine 'steam'/],
  [['eval', '--lang', 'xx', 'a'], 2, /no language 'xx'/],
  [['eval', '--fps', '0', 'a'], 2, /--fps: must be a number/],
  [['eval', '--nothing'], 2, /Try 'faccia eval --help'/],
  [['eval', '--json', '-', '--svg', '-', 'a'], 2, /only one/],
  [['eval', '--file', '/nowhere/text'], 1, /\/nowhere\/text: No such file/],
  [['eval', '--rates', '200', '--json', '/nowhere/a', 'a'], 1, /\/nowhere\/a: No such file/],
  [['eval', '--rates', '200', '--svg', '/dev/full', 'a'], 1, /\/dev\/full: No space left/],
  [['eval', ' '], 1, /nothing to speak/],
  [['stimuli'], 2, /no output folder: give --out/],
  [['stimuli', '--out', folder, 'a'], 2, /unexpected 'a'/],
  [['stimuli', '--out', folder, '--engine', 'steam'], 2, /unknown engine 'steam'/],
  [['stimuli', '--out', folder, '--voice', 'nobody'], 2, /voice/],
  [['stimuli', '--out', '/dev/null/kit'], 1, /\/dev\/null\/kit.*: Not a directory/],
  [['stimuli', '--out', folder, '--set', '/nowhere/set'], 1, /\/nowhere\/set: unable to open/],
  [['stimuli', '--nothing'], 2, /Try 'faccia stimuli --help'/],
  [['anova'], 2, /no results/],
  [['anova', '--csv', '/nowhere/a'], 1, /\/nowhere\/a: No such file/],
  [['anova', '--csv', '/dev/null'], 1, /\/dev\/null:1:1: it is empty/],
  [['anova', '--means', '/dev/null', '--csv', '/dev/null'], 1, /\/dev\/null:1:1/],
  [['anova', 'a'], 2, /unexpected 'a'/],
];
for (const [args, code, message] of wrong)
  test(`${args.join(' ')}: exits with ${code}`, () => {
    const { status, stderr } = faccia(args);
    assert.match(stderr, message);
    assert.equal(status, code);
  });

test('rejects invalid sets', () => {
  const good = { lang: 'it', carrier: '{item}.', snrs: [0], items: [{ name: 'mamma', text: 'mamma' }], page: {} };
  for (const [change, message] of [
    [{ carrier: 'Dice.' }, /carrier: must be a sentence/],
    [{ items: [{ name: '../up', text: 'a' }] }, /items\[0\]: needs a text/],
    [{ items: [...good.items, ...good.items] }, /items\[1\]: the name 'mamma' occurs twice/],
    [{ items: [] }, /items: there are none/],
    [{ snrs: ['loud'] }, /snrs\[0\]: must be a number/],
    [{ carrier: '{item}. Ciao.' }, /carrier: must be one sentence/],
  ]) {
    fs.writeFileSync(file('bad.json'), JSON.stringify({ ...good, ...change }));
    const { status, stderr } = faccia(['stimuli', '--out', file('bad'), '--set', file('bad.json')]);
    assert.equal(status, 1);
    assert.match(stderr, message);
  }
  fs.writeFileSync(file('bad.json'), '{"lang": "it",\n}');
  assert.match(faccia(['stimuli', '--out', file('bad'), '--set', file('bad.json')]).stderr, /bad\.json: 2:\d+: /);
});

test('prints the commands and their help', () => {
  for (const command of ['eval', 'stimuli', 'anova']) {
    const { status, stdout } = faccia([command, '--help']);
    assert.equal(status, 0);
    assert.match(stdout, new RegExp(`^Usage: faccia ${command} `));
    assert.match(faccia(['--help']).stdout, new RegExp(`^  ${command} `, 'm'));
  }
});
