// SPDX-License-Identifier: GPL-3.0-or-later
// faccia fit on recordings made from the face itself: lips of VCV words in mm, with noise. The resulting pack must speak.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { isDeepStrictEqual } from 'node:util';
import { faccia } from '../../lib/command.mjs';
import { root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const MNS = 21; // mm, of the Italian pack's speaker

const models = path.join(folder, 'models');
fs.cpSync(path.join(root, 'models/speech'), path.join(models, 'speech'), { recursive: true });
fs.copyFileSync(path.join(root, 'models/expressions.json'), path.join(models, 'expressions.json'));

/** Records a text in that language: the phones, and lower lip and jaw at 100 Hz, scaled by `scale`, with up to 0.2 mm of noise, and silence at both
 * ends. */
function record(file, text, seed, { lang = 'it', scale = 1 } = {}) {
  const name = path.join(folder, file);
  const { status, stderr } = faccia(['say', '--still', '--lang', lang, '--fps', '100', '--fap', `${name}.fap`, '--json', `${name}.say.json`, text], { env: { FACCIA_MODELS: models } });
  assert.equal(status, 0, stderr);
  const { phones, duration } = JSON.parse(fs.readFileSync(`${name}.say.json`));
  const { frames } = parseFap(fs.readFileSync(`${name}.fap`, 'utf8'));
  let random = seed;
  const noise = () => ((random = (random * 16807) % 2147483647), (random / 2147483647 - 0.5) * 0.4);
  const lead = 0.2;
  const rows = Array.from({ length: 20 }, (_, k) => [k / 100, noise(), noise()]).concat(
    frames.map((f, k) => [lead + k / 100, (-scale * f[5] * MNS) / 1024 + noise(), (scale * f[3] * MNS) / 1024 + noise()]));
  fs.writeFileSync(`${name}.csv`, 'time,LI,EM\n' + rows.map((r) => r.map((v) => v.toFixed(4)).join(',')).join('\n') + '\n');
  fs.writeFileSync(`${name}.phones.csv`, `start,end,ipa\n0,${lead},_\n` +
    phones.map((p) => `${(lead + p.start).toFixed(4)},${(lead + p.end).toFixed(4)},${p.ipa ? (p.stress === 2 ? 'ˈ' : '') + p.ipa : '_'}`).join('\n') + '\n');
  assert.ok(duration > 0.2);
  return `${name}.csv`;
}
const recordWord = (word, seed) => record(word, `${word}.`, seed);

const SENTENCES = ['La barca scivolò sul mare piatto e calmo.', 'Due gatti dormono sopra la sedia.', 'Non vedono che nebbia dopo la cena.', 'Sul prato fiorisce una rosa gialla.'];

test('one sentence of a speaker with wider vowels and a lower jaw improves the prediction of the others, at any scale', () => {
  const { groups, phones } = JSON.parse(fs.readFileSync(path.join(root, 'models/speech/it.json')));
  const pack = { tag: 'it-x-true', name: 'vero', inherits: 'it', sources: ['test'], voices: ['espeak:it'], abbreviations: [], phones: {} };
  for (const [ipa, { sampa, group }] of Object.entries(phones))
    if (group) pack.phones[ipa] = { sampa, like: ipa, ...(groups[group].kind === 'vowel' ? { gain: { LI: 1.5 } } : { shift: { EM: 2 } }) };
  fs.writeFileSync(path.join(models, 'speech/it-x-true.json'), JSON.stringify(pack));
  const [first, ...others] = SENTENCES.map((text, i) => record(`s${i}`, text, i + 3, { lang: 'it-x-true', scale: i % 2 ? 0.8 : 1.25 }));
  const file = path.join(models, 'speech/it-x-fitted.json');
  const { status, stderr } = faccia(['fit', '--first', '2', '--then', '5', '--output', file, ...others.flatMap((other) => ['--test', other]), first]);
  assert.equal(status, 0, stderr);
  const tests = [...stderr.matchAll(/^(\w+), test recordings: unfitted ([\d.]+) mm, fitted ([\d.]+) mm; each at its own scale: unfitted ([\d.]+) mm, fitted ([\d.]+) mm$/gm)];
  assert.deepEqual(tests.map(([, name]) => name), ['LI', 'EM'], stderr);
  for (const [line, , before, after, shapeBefore, shapeAfter] of tests) {
    assert.ok(Number(after) <= 1.02 * before && Number(shapeAfter) <= 1.02 * shapeBefore, line);
  }
  assert.ok(tests[1][5] < 0.92 * tests[1][4], `the jaw's habit was learnt: ${tests[1][0]}`);
  const fitted = JSON.parse(fs.readFileSync(file));
  assert.equal(fitted.inherits, 'it');
  assert.ok(Object.keys(fitted.phones).length > 20, 'what was not recorded goes with what was');
  const said = faccia(['say', '--lang', fitted.tag, 'Ana sala la sala.'], { env: { FACCIA_MODELS: models } });
  assert.equal(said.status, 0, said.stderr);
  assert.equal(JSON.parse(said.stdout).lang, fitted.tag, 'the voice speaks Italian, the lips are that speaker\'s');
  assert.ok(JSON.parse(said.stdout).phones.length > 8);
  for (const lang of ['it', 'it-CH'])
    assert.equal(JSON.parse(faccia(['say', '--lang', lang, 'Ana.'], { env: { FACCIA_MODELS: models } }).stdout).lang, 'it', 'who does not ask for it does not get it');
});

/** Replaces the lips that are drawn, which divide the opening by their shape, by the engine's own parameters. */
function asTheEngine(file, scale) {
  const times = file.replace(/csv$/, 'phones.csv');
  const { status, stdout, stderr } = faccia(['eval', '--curve-table', '-', '-e', 'dominance', '--contacts', 'engine', '--recording', file, '--phones', times]);
  assert.equal(status, 0, stderr);
  const curves = { LI: new Map(), EM: new Map() };
  for (const row of stdout.trim().split('\n').slice(1).map((line) => line.split(','))) curves[row[3]]?.set(Number(row[4]).toFixed(2), Number(row[6]));
  const noise = (k, step) => 0.2 * Math.sin(k * step); // mm
  fs.writeFileSync(file, `time,LI,EM\n${[...curves.LI.keys()].map((time, k) => [time, scale * curves.LI.get(time) + noise(k, 11), scale * curves.EM.get(time) + noise(k, 13)].join(',')).join('\n')}\n`);
  return file;
}

test('changes nothing for a speaker like the pack, and says so', () => {
  const file = asTheEngine(record('same', SENTENCES[1], 5), 1.4);
  const { status, stdout, stderr } = faccia(['fit', '--first', '2', '--then', '5', '--compare', file]);
  assert.equal(status, 0, stderr);
  for (const name of ['LI', 'EM'])
    assert.match(stderr, new RegExp(`^${name}: unfitted .*; kept unchanged: the held-out gain is below one standard error; speaker scale 1\\.[34]\\d$`, 'm'));
  assert.deepEqual(JSON.parse(stdout).phones, {});
  const scaled = faccia(['fit', '--first', '2', '--then', '5', '--own', file]);
  const { a } = JSON.parse(scaled.stdout).phones;
  const { a: base } = JSON.parse(fs.readFileSync(path.join(root, 'models/speech/it.json'))).phones;
  const [context] = Object.keys(a.targets.LI);
  const ratio = a.targets.LI[context].T / (base.targets.LI[context] ?? base.targets.LI.any).T;
  assert.ok(ratio > 1.25 && ratio < 1.55, `${ratio}`);
});

test('ignores values marked as unseen, by frame and by parameter', () => {
  const lines = fs.readFileSync(record('seen', SENTENCES[0], 9), 'utf8').trim().split('\n').slice(1).map((line) => line.split(',').map(Number));
  const middle = (t) => t > 0.5 && t < 0.9;
  const fit = (name, heading, row) => {
    const file = path.join(folder, `${name}.csv`);
    fs.writeFileSync(file, `${heading}\n${lines.map((line) => row(...line).join(',')).join('\n')}\n`);
    fs.copyFileSync(path.join(folder, 'seen.phones.csv'), path.join(folder, `${name}.phones.csv`));
    return faccia(['fit', '--strength', '1', '--first', '1', '--then', '1', '--rest', file]);
  };
  const pack = (...args) => {
    const { status, stdout, stderr } = fit(...args);
    assert.equal(status, 0, stderr);
    return JSON.parse(stdout).phones;
  };
  const spoilt = (t) => (middle(t) ? 8 : 0);
  const sure = (t) => (middle(t) ? 0.2 : 0.9);
  const [plain, marked] = [0, 1].map((off) => pack('unseen', 'time,LI,EM,confidence,EM_confidence', (t, li, em) => [t, li, em + off * spoilt(t), 1, sure(t)]));
  assert.deepEqual(marked, plain, 'of the jaw');
  const [still, whole] = [0, 1].map((off) => pack('unseen', 'time,LI,EM,confidence', (t, li, em) => [t, li + off * spoilt(t), em + off * spoilt(t), sure(t)]));
  assert.deepEqual(whole, still, 'of all');
  assert.notDeepEqual(pack('unseen', 'time,LI,EM', (t, li, em) => [t, li, em + spoilt(t)]), plain, 'and without a confidence it does');
  const never = fit('unseen', 'time,LI,EM,EM_confidence', (t, li, em) => [t, li, em, 0]);
  assert.equal(never.status, 0, never.stderr);
  assert.ok(!/^EM:/m.test(never.stderr), 'what is never seen is not fitted');
  const wrong = fit('unseen', 'time,LI,EM,EM_confidence', (t, li, em) => [t, li, em, 'sure']);
  assert.equal(wrong.status, 1);
  assert.match(wrong.stderr, /unseen\.csv: 2:1: EM_confidence: 'sure' is not a number/);
});

test('reads curves and phones in every form in one command, with the same result', () => {
  const at = (name) => path.join(folder, name);
  const phones = [['', '', 0, 0.2], ['ɑː', 'A:', 0.2, 0.35, 'AA1'], ['p', 'p', 0.35, 0.45, 'P'], ['iː', 'i:', 0.45, 0.6, 'IY0'], ['tʃ', 'tS', 0.6, 0.7, 'CH'], ['', '', 0.7, 0.9]];
  const stressed = (ipa, mark) => (ipa === 'ɑː' || ipa === 'A:' ? mark : '') + ipa;
  const arpabet = ([, , , , name]) => name ?? 'sil';
  const forms = {
    'ipa.phones.csv': 'start,end,ipa\n' + phones.map(([ipa, , from, to]) => `${from},${to},${stressed(ipa, 'ˈ') || '_'}`).join('\n'),
    'arpabet.phones.csv': 'start;end;arpabet\n' + phones.map((p) => `${p[2]};${p[3]};${arpabet(p)}`).join('\n'),
    'sampa.phones.csv': 'start\tend\tsampa\n' + phones.map(([, sampa, from, to]) => `${from}\t${to}\t${stressed(sampa, '%').replace('%', '"') || '_'}`).join('\n'),
    'praat.TextGrid': `File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n0.9\n<exists>\n1\n"IntervalTier"\n"phones"\n0\n0.9\n${phones.length}\n` +
      phones.map(([, sampa, from, to]) => `${from}\n${to}\n"${stressed(sampa, '""')}"`).join('\n') + '\n',
    'tool.json': JSON.stringify({ phones: phones.map(([ipa, , start, end]) => ({ ipa, start, end, stress: ipa === 'ɑː' ? 2 : 0 })) }),
    'festival.lab': '#\n' + phones.map((p) => `${p[3]} 100 ${arpabet(p)}`).join('\n') + '\n',
    'htk.mlf': '#!MLF!#\n"*/htk.lab"\n' + phones.map((p) => `${Math.round(p[2] * 1e7)} ${Math.round(p[3] * 1e7)} ${arpabet(p)}`).join('\n') + '\n.\n',
  };
  const frames = Array.from({ length: 90 }, (_, k) => [k / 100, 5 * Math.sin(k / 12), 2 * Math.cos(k / 9)]);
  const fit = (file) => {
    const { status, stdout, stderr } = faccia(['fit', '--base', 'en', '--strength', '3', '--first', '1', '--then', '1', file]);
    assert.equal(status, 0, `${file}: ${stderr}`);
    return JSON.parse(stdout).phones;
  };
  const packs = Object.entries(forms).map(([name, text]) => {
    const [stem] = name.split('.');
    fs.writeFileSync(at(name), text);
    fs.writeFileSync(at(`${stem}.csv`), 'time,LI,EM\n' + frames.map((row) => row.join(',')).join('\n'));
    return fit(at(`${stem}.csv`));
  });
  assert.ok(packs[0]['ɑ'].targets.LI && packs[0].p.targets.EM);
  for (const [i, pack] of packs.entries()) assert.ok(isDeepStrictEqual(pack, packs[0]), Object.keys(forms)[i]);

  // an articulograph's file through the converter: sensors 1 and 2 are lower lip and jaw, 250 Hz
  const sensors = Array.from({ length: 225 }, (_, i) => {
    const t = i / 250;
    const k = t * 100;
    return [0, 0, 30 - 5 * Math.sin(k / 12), 0, 0, 0, 0, 0, 0, 10 - 2 * Math.cos(k / 9), 0, 0, 0, 0];
  });
  const head = 'AG50xDATA_V003\n00000080\nNumberOfChannels=2\nSamplingFrequencyHz=250\n'.padEnd(79) + '\n';
  fs.writeFileSync(at('ema.pos'), Buffer.concat([Buffer.from(head), Buffer.from(Float32Array.from(sensors.flat()).buffer)]));
  const converted = spawnSync(path.join(root, 'models/tools/articulograph.py'), ['--sensors', '1=ll,2=jaw', at('ema.pos')]);
  assert.equal(converted.status, 0, String(converted.stderr));
  fs.writeFileSync(at('ema.csv'), converted.stdout);
  fs.writeFileSync(at('ema.TextGrid'), forms['praat.TextGrid']);
  const pack = fit(at('ema.csv'));
  assert.deepEqual(Object.keys(pack), Object.keys(packs[0]));
  const { LI } = pack['ɑ'].targets;
  for (const [context, { T }] of Object.entries(LI)) assert.ok(Math.abs(T - packs[0]['ɑ'].targets.LI[context].T) < 0.1, context);
});

test('reads a TextGrid with X-SAMPA, markers as columns, and a test recording, in one command', () => {
  const [one, two] = ['apa', 'ala'].map((word, i) => recordWord(word, i + 20));
  for (const file of [one, two]) {
    const name = file.slice(0, -4);
    const lines = fs.readFileSync(file, 'utf8').trim().split('\n').slice(1).map((line) => line.split(',').map(Number));
    fs.writeFileSync(file, 't,ll_z,jaw_z\n' + lines.map(([t, low, jaw]) => [t, 30 - low, 10 - jaw].join(',')).join('\n'));
    const rows = fs.readFileSync(`${name}.phones.csv`, 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
    fs.rmSync(`${name}.phones.csv`);
    fs.rmSync(`${name}.json`, { force: true });
    const end = rows.at(-1)[1];
    fs.writeFileSync(`${name}.TextGrid`, `File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n${end}\n<exists>\n1\n"IntervalTier"\n"phones"\n0\n${end}\n${rows.length}\n` +
      rows.map(([from, to, ipa]) => `${from}\n${to}\n"${{ _: '', tʃ: 'tS' }[ipa] ?? ipa}"`).join('\n') + '\n');
  }
  const { status, stdout, stderr } = faccia(['fit', '--first', '2', '--then', '3', '--test', two, one]);
  assert.equal(status, 0, stderr);
  assert.match(stderr, /^LI: unfitted [\d.]+ mm, fitted [\d.]+; held out: unfitted [\d.]+, fitted [\d.]+; (?:strength [\d.]+ mm, |kept unchanged: )/m);
  assert.match(stderr, /^EM, test recordings: unfitted [\d.]+ mm, fitted [\d.]+ mm; each at its own scale: /m);
  const targets = Object.values(JSON.parse(stdout).phones).flatMap((phone) => Object.values(phone.targets ?? {})).flatMap((contexts) => Object.values(contexts));
  for (const { T } of targets) assert.ok(T >= -3 && T <= 30, `${T} mm is no mouth's`);
});

/** Points of the paths of a colour in a chart, in the units of its first pair of axes, whose numbers stand beside them. */
function drawn(svg, colour, attribute = 'stroke') {
  const ticks = (pattern) => [...svg.matchAll(pattern)].map(([, at, value]) => [Number(at), Number(value)]);
  const [y0, y1] = ticks(/<text x="51\.0" y="([\d.]+)" font-size="10" text-anchor="end" fill="#444444">(-?[\d.]+)</g);
  const [x0, x1] = ticks(/<text x="([\d.]+)" y="[\d.]+" font-size="10" text-anchor="middle" fill="#444444">([\d.]+)</g);
  const linear = ([p, a], [q, b], off) => (at) => a + ((at + off - p) * (b - a)) / (q - p);
  const [x, y] = [linear(x0, x1, 0), linear(y0, y1, 3.5)]; // numbers stand 3.5 below their line
  return [...svg.matchAll(new RegExp(`<path d="M([^"hvZ]+)Z?"[^>]* ${attribute}="${colour}"`, 'g'))].map(([, path]) => path.split('L').map((point) => point.split(' ').map(Number)).map(([px, py]) => [x(px), y(py)]));
}
const rms = (list) => Math.sqrt(list.reduce((sum, v) => sum + v * v, 0) / list.length);

test('the charts show the numbers: recorded mean and deviation, fitted curve and its error, dominances of which one is 1 at its target', () => {
  const takes = [31, 47, 90].map((seed) => record(`plot${seed}`, 'apa.', seed));
  const plots = path.join(folder, 'plots');
  const { status, stderr } = faccia(['fit', '--own', '--strength', '1', '--first', '1', '--then', '2', '--output', path.join(folder, 'plot.json'), '--plot', plots, ...takes]);
  assert.equal(status, 0, stderr);
  assert.deepEqual(fs.readdirSync(plots).sort(), ['EM.svg', 'LI.svg']);
  const beside = stderr.match(/^lips and jaw: fitted ([\d.]+) mm, the mean of 2 parameters; below 0\.3 mm in Leone's fits to one sequence at a time$/m);
  const fitted = [...stderr.matchAll(/^(?:LI|EM): unfitted [\d.]+ mm, fitted ([\d.]+);/gm)].map(([, mm]) => Number(mm));
  assert.ok(Math.abs(Number(beside[1]) - (fitted[0] + fitted[1]) / 2) < 0.0011, stderr);
  const values = takes.map((file) => fs.readFileSync(file, 'utf8').trim().split('\n').slice(1).map((line) => line.split(',').map(Number)));
  for (const [name, column] of [['LI', 1], ['EM', 2]]) {
    const svg = fs.readFileSync(path.join(plots, `${name}.svg`), 'utf8');
    const [, before, after] = stderr.match(new RegExp(`^${name}, drawn: unfitted ([\\d.]+) mm, fitted ([\\d.]+) mm: `, 'm')).map(Number);
    const [recorded] = drawn(svg, '#0072b2').filter((line) => line.length > 20);
    const mean = recorded.map(([t]) => values.reduce((sum, rows) => sum + rows[Math.round(t * 100)][column], 0) / 3);
    assert.ok(recorded.every(([, mm], i) => Math.abs(mm - mean[i]) < 0.03), `${name}: the mean of what was recorded`);
    const [band] = drawn(svg, '#d9e8f5', 'fill');
    const deviations = recorded.map(([t, mm]) => Math.sqrt(values.reduce((sum, rows) => sum + (rows[Math.round(t * 100)][column] - mm) ** 2, 0) / 2));
    assert.equal(band.length, 2 * recorded.length);
    assert.ok(recorded.every(([, mm], i) => Math.abs(band[i][1] - mm - deviations[i]) < 0.05 && Math.abs(mm - band.at(-1 - i)[1] - deviations[i]) < 0.05), `${name}: its standard deviation`);
    for (const [colour, error] of [['#666666', before], ['#d55e00', after]]) {
      const [curve] = drawn(svg, colour).filter((line) => line.length > 20);
      const at = new Map(recorded.map(([t, mm]) => [t.toFixed(2), mm]));
      assert.ok(Math.abs(rms(curve.map(([t, mm]) => mm - at.get(t.toFixed(2)))) - error) < 0.02, `${name}: ${error} mm is what is drawn`);
      assert.ok(svg.includes(`${error.toFixed(3)} mm`));
    }
    const dominances = [...drawn(svg, '#009e73'), ...drawn(svg, '#cc79a7')].filter((line) => line.length > 3);
    assert.ok(dominances.length >= 3, 'a, p and a at least');
    assert.ok(svg.includes('3 repetitions') && svg.includes('>p</text>'));
  }
  const one = faccia(['fit', '--strength', '1', '--first', '1', '--then', '1', '--plot', takes[0], takes[0]]);
  assert.equal(one.status, 1);
  assert.match(one.stderr, /--plot: cannot make the folder .*plot31\.csv/);
});

test('names the error in a recording', () => {
  const bad = path.join(folder, 'bad.csv');
  fs.writeFileSync(bad, 'time,LI\n0,0\n0.01,x\n');
  fs.writeFileSync(path.join(folder, 'bad.phones.csv'), 'start,end,ipa\n0,0.01,_\n');
  const { status, stderr } = faccia(['fit', bad]);
  assert.equal(status, 1);
  assert.match(stderr, /bad/);
  assert.equal(faccia(['fit', '--strength', '0', bad]).status, 2);
  assert.match(faccia(['fit', '--first', '1.5', bad]).stderr, /--first: must be an integer from 1 to 1000/);
  assert.equal(faccia(['fit']).status, 2);
  assert.match(faccia(['fit', '--nothing']).stderr, /Try 'faccia fit --help'/);
  assert.equal(faccia(['fit', '--help']).status, 0);
  assert.equal(faccia(['fit', path.join(folder, 'nowhere.csv')]).status, 1);
});
