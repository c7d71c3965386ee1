// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the engines with people they were not tuned on: node tests/bench/run.mjs people FOLDER [--plots FOLDER] [MEASURE...]
// FOLDER: output of tests/bench/people-fetch.py: people.json, and NAME.csv and NAME.phones.csv of each recording. The unit is the person: recordings
// of
// one person are averaged first, intervals are bootstrapped over persons, and the ridge regression is trained on the others (its penalty, too).
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { build } from '../lib/daemon.mjs';
import { curveTable, drawing, figures, interval, ridgeOfOthers, STILL } from '../lib/people-statistics.mjs';

const words = process.argv.slice(2), option = words.indexOf('--plots');
const [, plots] = option < 0 ? [] : words.splice(option, 2);
const [folder, ...chosen] = words;
if (!folder) throw new Error('usage: people.mjs FOLDER [--plots FOLDER] [MEASURE...]');
const recordings = JSON.parse(fs.readFileSync(path.join(folder, 'people.json'), 'utf8'));
const HEADS = { aperture: 'lip aperture', LI: 'lower lip', LS: 'upper lip', AR: 'width', PI: 'lower protrusion', PS: 'upper protrusion', EM: 'jaw' };
const OURS = 'dominance on';
const ENGINES = { [OURS]: '`dominance` (with contacts)', 'dominance off': '`dominance` without contacts', 'cohen-massaro off': '`cohen-massaro`', 'cohen-massaro on': '`cohen-massaro` with contacts', 'table off': '`table`', 'table on': '`table` with contacts', ridge: 'ridge regression, trained on the other persons', 'another person ': 'another person' };
const BASELINES = ['table off', 'table on', 'cohen-massaro on', 'ridge', 'another person '];

/** Rows of all frames: the engines' curves beside the person's. */
function evaluate(recording, shift) {
  const files = (one) => [path.join(folder, `${one.name}.csv`), path.join(folder, `${one.name}.phones.csv`)];
  const [curves, phones] = files(recording);
  const args = ['eval', '--lang', recording.lang, '--contacts', 'both', '-e', 'dominance', '-e', 'cohen-massaro', '-e', 'table', '--shift', String(shift), '--curve-table', '-', '--recording', curves, '--phones', phones];
  const other = recordings.find(({ person, text, lang }) => person !== recording.person && text && text === recording.text && lang === recording.lang);
  if (other) args.push('--other', files(other)[0], '--other-phones', files(other)[1]);
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), args, { maxBuffer: 1 << 28 });
  if (status !== 0) throw new Error(`faccia ${args.join(' ')}: ${stderr}`);
  return curveTable(String(stdout));
}

const phonesOf = ({ name }) =>
  fs.readFileSync(path.join(folder, `${name}.phones.csv`), 'utf8').trim().split('\n').slice(1).map((line) => {
    const [start, end] = line.split(',').map(Number);
    return { start, end };
  });

function report(title, shiftOf, groups) {
  const all = recordings.map((recording) => ({ ...recording, phones: phonesOf(recording), curves: evaluate(recording, shiftOf(recording)), shift: shiftOf(recording) / 1000 }));
  const measured = (one, engine, measure) => Boolean(one.curves[engine]?.[measure]?.measured);
  const measures = Object.keys(HEADS).filter((measure) => (!chosen.length || chosen.includes(measure)) && all.some((one) => measured(one, OURS, measure)));
  ridgeOfOthers(all, [...new Set(all.map(({ person }) => person))], measures);
  if (plots && groups.length > 1) {
    fs.mkdirSync(plots, { recursive: true });
    for (const one of all) fs.writeFileSync(path.join(plots, `${one.name}.svg`), drawing(one.name, one, measures));
  }
  for (const test of groups) {
    const some = all.filter((one) => Boolean(one.test) === test);
    if (some.length) tables(`${title}: ${test ? 'persons on film, on whom nothing was chosen' : 'persons by articulograph and microbeam, on whom constants were chosen'}`, some, measures.filter((m) => some.some((one) => measured(one, OURS, m))));
  }
}

function tables(title, all, measures) {
  const persons = [...new Set(all.map(({ person }) => person))];
  /** person -> mean figure of that person's recordings */
  const byPerson = (engine, measure, figure) =>
    new Map(persons.flatMap((person) => {
      const own = all.filter((one) => one.person === person && one.curves[engine]?.[measure]?.measured).map((one) => figures(one.curves[engine][measure])).filter(({ moved }) => moved >= STILL);
      return own.length ? [[person, own.reduce((sum, f) => sum + f[figure], 0) / own.length]] : [];
    }));
  const mean = (map) => [...map.values()].reduce((a, b) => a + b, 0) / map.size;
  const head = `${measures.map((m) => HEADS[m]).join(' | ')} |\n|---|${'---|'.repeat(measures.length)}`;
  console.log(`\n## ${title}\n\nCorrelation / RMS mm, mean over ${persons.length} persons (in brackets where fewer); a curve that moves by less than ${STILL} mm (standard deviation) does not count.\n\n| engine | ${head}`);
  for (const [engine, label] of Object.entries(ENGINES)) {
    const cells = measures.map((m) => {
      const r = byPerson(engine, m, 'r');
      return r.size ? `${mean(r).toFixed(2)} / ${mean(byPerson(engine, m, 'rms')).toFixed(2)}${r.size < persons.length ? ` (${r.size})` : ''}` : '';
    });
    if (cells.some(Boolean)) console.log(`| ${label} | ${cells.join(' | ')} |`);
  }
  for (const [figure, what, better] of [['r', 'Correlation', 1], ['rms', 'RMS mm', -1]]) {
    console.log(`\n${what} of \`dominance\` less that of a baseline, with the 95 % bootstrap interval over persons; bold where it leaves out zero (+ better, - worse):\n\n| less | ${head}`);
    for (const baseline of BASELINES) {
      const cells = measures.map((m) => {
        const [ours, theirs] = [byPerson(OURS, m, figure), byPerson(baseline, m, figure)];
        const differences = [...ours].filter(([person]) => theirs.has(person)).map(([person, value]) => value - theirs.get(person));
        if (differences.length < 3) return '';
        const { value, low, high } = interval(differences);
        const text = `${value.toFixed(3)} [${low.toFixed(3)}, ${high.toFixed(3)}]`;
        return low > 0 || high < 0 ? `**${text}** ${value * better > 0 ? '+' : '-'}` : text;
      });
      if (cells.some(Boolean)) console.log(`| ${ENGINES[baseline]} | ${cells.join(' | ')} |`);
    }
  }
}

report('Times as they are labelled', () => 0, [false, true]);
if (recordings.some(({ late }) => late)) report('Labels that are late put right (Haskins: predictions 30 ms earlier)', ({ late }) => -(late ?? 0), [false]);
