// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy of lip tracking in films. One of our heads speaks sentences with different habits (vowels 1.5 times as open, consonants narrower); pictures
// of it as drawn by the page, swaying, are analysed by `faccia head lips`, and the curves are compared with the played FAPs. With --fit, a pack is
// fitted to some sentences, and its prediction of the others is compared with the film and with the played FAPs. With --markers, eight markers on
// the face replace the film.
// node tests/bench/run.mjs seen-lips [HEAD] [--sentences 0,1,2,3] [--lines 1080|720|480] [--crf N] [--iris] [--fps N] [--points 4] [--fit] [--fitted 2] [--markers]
// Keeps the pictures in build/seen-lips. --lines is the height of a whole picture that shows 27 cm; --crf compresses with x264. The scale comes from
// the distance of the pupils, or with --iris from the iris.
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { PARAMETERS } from '../../models/tools/lips/articulation.mjs';
import { pose } from '../../models/tools/lib/deform.mjs';
import { launch } from '../lib/browser.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { headOf, shoot, sway } from '../lib/film.mjs';
import { headPage } from '../lib/head-page.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const text = { type: 'string' };
const { values: wanted, positionals: [name = 'samuel'] } = parseArgs({
  allowPositionals: true,
  options: { sentences: { ...text, default: '0,1,2,3' }, lines: { ...text, default: '1080' }, crf: text, iris: { type: 'boolean' }, fps: { ...text, default: '25' }, points: { ...text, default: '4' }, fit: { type: 'boolean' }, fitted: { ...text, default: '2' }, markers: { type: 'boolean' } },
});
const [fps, lines, marked] = [Number(wanted.fps), Number(wanted.lines), wanted.markers];
const folder = path.join(root, 'build/seen-lips', `${name}-${fps}${marked ? '-markers' : wanted.points === '4' ? '' : `-${wanted.points}`}`);
const models = path.join(folder, 'models');
const faccia = path.join(root, 'build/server/cli/faccia');
const env = { ...process.env, FACCIA_MODELS: models };
const SENTENCES = ['La barca scivola sul mare.', 'Una nuvola bianca passa piano.', 'Due gatti dormono sopra la sedia.', 'Sul prato fiorisce una rosa.', 'Mio padre beve il vino.', 'La pioggia batte sui vetri.',
  'Domani vado a Bologna.', 'Che bella giornata di maggio!', 'Il fiume scorre sotto il ponte.', 'Vorrei una tazza di latte.', 'Le mele cadono dagli alberi.', 'Papà compra pane e burro.'];
const FITTED = Number(wanted.fitted); // number of sentences to fit; the others are predicted
const IRIS = 10.9; // diameter in faccia's heads, mm
const BELIEVED = 0.25; // as in faccia fit
const REST = 0.3; // s of rest before and after

fs.mkdirSync(models, { recursive: true });
fs.cpSync(path.join(root, 'models/speech'), path.join(models, 'speech'), { recursive: true });
fs.copyFileSync(path.join(root, 'models/expressions.json'), path.join(models, 'expressions.json'));

function writeSpeaker() {
  const { groups, phones } = JSON.parse(fs.readFileSync(path.join(root, 'models/speech/it.json'), 'utf8'));
  const pack = { tag: 'it-x-true', name: 'vero', inherits: 'it', sources: ['a bench'], voices: ['espeak:it'], abbreviations: [], phones: {} };
  for (const [ipa, { sampa, group }] of Object.entries(phones))
    if (group) pack.phones[ipa] = { sampa, like: ipa, ...(groups[group].kind === 'vowel' ? { gain: { LI: 1.5 } } : { shift: { AR: -2 } }) };
  fs.writeFileSync(path.join(models, 'speech/it-x-true.json'), JSON.stringify(pack));
}

/** Speaks a sentence: its frames, and its phones in a file. */
function speak(text, n) {
  const base = path.join(folder, `s${n}`);
  execFileSync(faccia, ['say', '--still', '--lang', 'it-x-true', '--fps', String(fps), '--fap', `${base}.fap`, '--json', `${base}.say.json`, text], { env });
  const { phones } = JSON.parse(fs.readFileSync(`${base}.say.json`, 'utf8'));
  const { frames } = parseFap(fs.readFileSync(`${base}.fap`, 'utf8'));
  const still = Array.from({ length: Math.round(REST * fps) }, () => Array(69).fill(0));
  const lead = still.length / fps;
  const all = [...still, ...frames, ...still].map((frame, i) => ({ ...frame, ...sway(i / fps) }));
  const end = lead + phones.at(-1).end;
  const lines = phones.map((p) => `${(lead + p.start).toFixed(4)},${(lead + p.end).toFixed(4)},${p.ipa ? (p.stress === 2 ? 'ˈ' : '') + p.ipa : '_'}`);
  fs.writeFileSync(`${base}.phones.csv`, `start,end,ipa\n0,${lead.toFixed(4)},_\n${lines.join('\n')}\n${end.toFixed(4)},${(all.length / fps).toFixed(4)},_\n`);
  return { base, frames: all };
}

const told = (head, f) => {
  const [mns, mw] = [head.fapu.MNS / 1024, head.fapu.MW / 1024];
  return [-f[5] * mns, -f[4] * mns, (f[6] + f[7]) * mw, f[16] * mns, f[17] * mns, f[3] * mns];
};

/** Compares curves with the played FAPs: raw, without means, after linear regression, and only where they claim visibility. */
function compare(head, takes) {
  for (const [p, parameter] of PARAMETERS.entries()) {
    const pairs = takes.flatMap(({ csv, frames }) => {
      const [names, ...rows] = fs.readFileSync(csv, 'utf8').trim().split('\n').map((line) => line.split(','));
      const [column, sure] = [parameter, `${parameter}_confidence`].map((one) => names.indexOf(one));
      return rows.map((row) => [Number(row[column]), told(head, frames[Math.round(row[0] * fps)])[p], sure < 0 || row[sure] >= BELIEVED]);
    });
    const seen = pairs.filter(([, , believed]) => believed).map(([a, b]) => a - b);
    const rmsSeen = seen.length ? `${Math.sqrt(seen.reduce((sum, x) => sum + x * x, 0) / seen.length).toFixed(2)} mm rms, the median ${seen.map(Math.abs).sort((a, b) => a - b)[seen.length >> 1].toFixed(2)}` : 'none';
    const mean = (of) => pairs.reduce((sum, pair) => sum + of(pair), 0) / pairs.length;
    const [ma, mb] = [mean(([a]) => a), mean(([, b]) => b)];
    const [aa, bb, ab] = [mean(([a]) => (a - ma) ** 2), mean(([, b]) => (b - mb) ** 2), mean(([a, b]) => (a - ma) * (b - mb))];
    const rms = Math.sqrt(mean(([a, b]) => (a - b) ** 2));
    const centred = Math.sqrt(Math.max(0, rms * rms - (ma - mb) ** 2));
    const off = pairs.map(([a, b]) => Math.abs(a - b)).sort((a, b) => a - b);
    console.log(`${parameter}: ${rms.toFixed(2)} mm rms of ${Math.sqrt(bb).toFixed(2)}; without its mean ${centred.toFixed(2)}, after the best line ${Math.sqrt(Math.max(0, bb - (ab * ab) / aa)).toFixed(2)} ` +
      `(slope ${(ab / aa).toFixed(2)}), correlation ${(ab / Math.sqrt(aa * bb)).toFixed(3)}; the median ${off[off.length >> 1].toFixed(2)}, ${Math.round((100 * off.filter((x) => x <= 0.3).length) / off.length)} % within 0.3 mm; where it is seen, ${seen.length} of ${pairs.length}: ${rmsSeen}`);
  }
}

const POINTS = ['9.3', '8.1', '8.3', '8.4', '8.2', '2.1', '10.5', '10.6']; // the thesis's order

/** Writes the tracks of eight face markers, mm. */
function track(head, frames, file) {
  const skin = head.parts.find(({ name: part }) => part === 'skin');
  const distance = (v, p) => Math.hypot(...p.map((x, k) => x - skin.position[3 * v + k]));
  const vertices = POINTS.map((point) => {
    let best = 0;
    for (let v = 1; v < skin.position.length / 3; v++) if (distance(v, head.fdp[point]) < distance(best, head.fdp[point])) best = v;
    return best;
  });
  const rows = frames.map((faps, i) => {
    const now = pose(head, skin, faps);
    return [i / fps, ...vertices.flatMap((v) => [...now.slice(3 * v, 3 * v + 3)])].map((x) => x.toFixed(4)).join(',');
  });
  fs.writeFileSync(file, `${rows.join('\n')}\n`);
}

/** Inclination of the plane through nose and ears, degrees. */
function tiltOf({ fdp }) {
  const [nose, left, right] = ['9.3', '10.5', '10.6'].map((point) => fdp[point]);
  return (Math.atan2((left[1] + right[1]) / 2 - nose[1], nose[2] - (left[2] + right[2]) / 2) * 180) / Math.PI;
}

/** Scales pictures to a camera's resolution, or compresses them with x264. */
function filmOf(pictures) {
  if (lines === 1080 && wanted.crf === undefined) return pictures;
  const out = `${pictures}-${lines}-${wanted.crf ?? 0}.mp4`;
  const scale = `scale=w=trunc(iw*${lines}/2160)*2:h=trunc(ih*${lines}/2160)*2:flags=area`;
  execFileSync('ffmpeg', ['-v', 'error', '-y', '-framerate', String(fps), '-i', path.join(pictures, '%04d.png'), '-vf', scale, '-c:v', 'libx264', '-crf', wanted.crf ?? '0', '-pix_fmt', 'yuv420p', out]);
  return out;
}

const head = headOf(name);
writeSpeaker();
const takes = wanted.sentences.split(',').map((n) => ({ n, ...speak(SENTENCES[n], n) }));
const missing = takes.filter(({ n, frames }) => !fs.existsSync(path.join(folder, `film${n}`, `${String(frames.length).padStart(4, '0')}.png`)));
if (!marked && missing.length) {
  const browser = await launch({ idling: true });
  const page = await headPage(browser);
  await page.load('head', JSON.parse(fs.readFileSync(path.join(root, `build/models/heads/${name}.json`), 'utf8')));
  for (const { n, frames } of missing) await shoot(page, 'head', frames, path.join(folder, `film${n}`), Number(wanted.points));
  await browser.close();
}
for (const take of takes) {
  const pictures = path.join(folder, `film${take.n}`);
  if (marked) track(head, take.frames, `${pictures}.csv`);
  take.csv = `${take.base}.csv`;
  const source = marked ? [`${pictures}.csv`, `--tilt=${tiltOf(head)}`] : [filmOf(pictures), '--fps', String(fps), ...(wanted.iris ? ['--iris', String(IRIS)] : ['--pupils', String(head.fapu.ES)])];
  const { status, stderr } = spawnSync('node', [path.join(root, 'models/tools/lips/faccia-lips.mjs'), ...source, '-o', take.csv], { encoding: 'utf8' });
  if (status) throw new Error(stderr);
}
console.log(`${name}, ${fps} pictures a second, ${takes.reduce((sum, { frames }) => sum + frames.length, 0)} of them${marked ? '' : `, ${lines} lines${wanted.crf ? `, crf ${wanted.crf}` : ''}`}`);
compare(head, takes);
for (const { base, frames } of takes) {
  const rows = frames.map((frame, i) => [(i / fps).toFixed(4), ...told(head, frame).map((x) => x.toFixed(4))].join(','));
  fs.writeFileSync(`${base}.true.csv`, `time,${PARAMETERS.join(',')}\n${rows.join('\n')}\n`);
  fs.copyFileSync(`${base}.phones.csv`, `${base}.true.phones.csv`);
}
for (const [what, ending] of wanted.fit || marked ? [['as the film shows them', '.csv'], ['as they were played', '.true.csv']] : []) {
  const tests = takes.slice(FITTED).flatMap(({ base }) => ['--test', `${base}${ending}`]);
  const { stderr, status } = spawnSync(faccia, ['fit', '--rest', '--own', '--output', path.join(models, 'speech/it-x-fitted.json'), ...tests, ...takes.slice(0, FITTED).map(({ base }) => `${base}.csv`)], { env, encoding: 'utf8' });
  if (status) throw new Error(stderr);
  console.log(`${what}:\n${stderr.split('\n').filter((line) => /test recordings/.test(line)).join('\n')}`);
}
