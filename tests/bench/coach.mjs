// SPDX-License-Identifier: GPL-3.0-or-later
// Judgement of `faccia coach` on recordings of people: how often it calls a sound different that they say as the text wants (false), and how often it
// notices that the text wants another sound than they say (found): one letter of the text is changed so that one sound is of another class.
// Readers: an Italian man and an American woman (Debian's asterisk-core-sounds-it-wav, -en-g722); every other prompt chose the thresholds (dev).
// node tests/bench/run.mjs coach [PROMPTS of each, 110] [--learners FOLDER] [--choose]
// FOLDER: a checkout of speechocean762 (adults with Mandarin as their first language read English): four sentences of 30 speakers of its training part
// (dev) and of 30 of its test part. What they say is not always what the text wants, so that part of what counts as false is true.
// --choose: also prints the thresholds that the dev part gives.
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { build } from '../lib/daemon.mjs';
import { prompts } from '../lib/prompts.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: { learners: { type: 'string' }, choose: { type: 'boolean' } } });
const wanted = Number(positionals[0] ?? 110);
const SPEAKERS = 30, SENTENCES = 4, CHANGES = 2, WORDS = [3, 12], ADULT = 16;
const FALSE_MOST = 0.05, GOOD_FROM = -0.3;

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
process.on('exit', () => fs.rmSync(folder, { recursive: true }));

/** The same numbers in each run. */
let seed = 7;
const random = (most) => {
  seed = (Math.imul(seed, 1103515245) + 12345) >>> 0;
  return (seed >>> 8) % most;
};
const chosen = (list, count) => list.filter((_, i) => Math.floor(((i + 1) * count) / list.length) > Math.floor((i * count) / list.length));
const isShort = (text) => {
  const count = text.trim().split(/\s+/).length;
  return count >= WORDS[0] && count <= WORDS[1] && !/\d/.test(text);
};

// Readings: {group, lang, text, sound}

function readers(lang, suffix, name) {
  return chosen(prompts(lang, suffix).filter(({ text }) => isShort(text)), wanted).map(({ text, sound }, i) => {
    const wav = suffix === 'wav' ? sound : path.join(folder, `${lang}-${i}.wav`);
    if (suffix !== 'wav') execFileSync('ffmpeg', ['-v', 'error', '-y', '-f', 'g722', '-i', sound, wav]);
    return { group: `${name}, ${i % 2 ? 'dev' : 'test'}`, lang, text, sound: wav };
  });
}

function learners(corpus) {
  const table = (part, name) => new Map(fs.readFileSync(path.join(corpus, part, name), 'utf8').trim().split('\n').map((line) => line.split(/[\t ]+(.*)/)));
  return ['train', 'test'].flatMap((part) => {
    const [texts, sounds, speakers, ages] = ['text', 'wav.scp', 'utt2spk', 'spk2age'].map((name) => table(part, name));
    const by = new Map();
    for (const [id, text] of texts)
      if (isShort(text) && Number(ages.get(speakers.get(id))) >= ADULT) by.set(speakers.get(id), [...(by.get(speakers.get(id)) ?? []), id]);
    return chosen([...by.keys()].sort(), SPEAKERS).flatMap((speaker) =>
      chosen(by.get(speaker), SENTENCES).map((id) => {
        const text = texts.get(id).toLowerCase();
        return { group: `learners, ${part === 'train' ? 'dev' : 'test'}`, lang: 'en', text: `${text[0].toUpperCase()}${text.slice(1)}.`, sound: path.join(corpus, sounds.get(id)) };
      }));
  });
}

// Changes of a letter

const VOWELS = 'aeiou', CONSONANTS = 'pbmfvtdnlrs';
function* changed(text) {
  for (let tries = 0; tries < 40; tries++) {
    const i = 1 + random(text.length - 2), letter = text[i], pool = VOWELS.includes(letter) ? VOWELS : CONSONANTS;
    const [before, after] = [text[i - 1].toLowerCase(), text[i + 1].toLowerCase()];
    if (!pool.includes(letter) || before === letter || after === letter || 'qcghz'.includes(before)) continue;
    if (pool === VOWELS && (VOWELS.includes(before) || VOWELS.includes(after))) continue;
    if (pool === CONSONANTS && !VOWELS.includes(before) && before !== ' ') continue;
    yield text.slice(0, i) + pool[random(pool.length)] + text.slice(i + 1);
  }
}

function compare({ lang, sound }, text) {
  const { status, stdout } = spawnSync(path.join(build, 'server/cli/faccia'), ['coach', '-l', lang, '--json', '-', sound, text], { maxBuffer: 1 << 26 });
  return status === 0 ? JSON.parse(stdout) : null;
}

// Sounds: {group, class, score, state, changed}

const sounds = [], whole = new Map();
const count = (group, what) => {
  const counts = whole.get(group) ?? { texts: 0, other: 0, strange: 0, told: 0 };
  counts[what]++;
  whole.set(group, counts);
};

function measure(reading, i, all) {
  const { group } = reading, plain = compare(reading, reading.text);
  if (!plain) return;
  count(group, 'texts');
  if (plain.other) count(group, 'other');
  for (const phone of plain.phones) sounds.push({ group, ...phone, changed: false, followed: !plain.other });
  const classes = plain.phones.map((phone) => phone.class);
  let left = CHANGES;
  for (const text of changed(reading.text)) {
    const heard = compare(reading, text), others = heard?.phones.map((phone) => phone.class) ?? [];
    const at = others.length === classes.length ? others.flatMap((own, k) => (own === classes[k] ? [] : [k])) : [];
    if (at.length !== 1 || !others[at[0]]) continue;
    sounds.push({ group, ...heard.phones[at[0]], changed: true });
    if (!--left) break;
  }
  const far = all.filter((other) => other.group === group), strange = far[(far.indexOf(reading) + Math.ceil(far.length / 2)) % far.length];
  const wrong = strange === reading ? null : compare(reading, strange.text);
  if (!wrong) return;
  count(group, 'strange');
  if (wrong.other) count(group, 'told');
}

const all = [...readers('it', 'wav', 'Italian reader'), ...readers('en', 'g722', 'American reader'), ...(values.learners ? learners(values.learners) : [])];
all.forEach(measure);

const percent = (part, of) => (of ? `${((100 * part) / of).toFixed(part && part * 20 < of ? 1 : 0)} %` : '-');
const share = (list, state) => percent(list.filter((sound) => sound.state === state).length, list.length);
const groups = [...whole.keys()];
console.log('| who | recordings; not followed | sounds as the text wants: good, unsure, different (false) | changed: different (found), unsure, good | other text told |');
console.log('|---|---|---|---|---|');
for (const group of groups) {
  const own = sounds.filter((sound) => sound.group === group), as = own.filter((sound) => !sound.changed), not = own.filter((sound) => sound.changed);
  const { texts, other, strange, told } = whole.get(group);
  console.log(`| ${group} | ${texts}; ${percent(other, texts)} | ${as.length}: ${share(as, 'good')}, ${share(as, 'unsure')}, ${share(as, 'different')} | ${not.length}: ${share(not, 'different')}, ${share(not, 'unsure')}, ${share(not, 'good')} | ${percent(told, strange)} |`);
}
const classes = [...new Set(sounds.map((sound) => sound.class).filter(Boolean))].sort();
const tests = groups.filter((group) => group.endsWith('test'));
console.log(`\n| class | ${tests.map((group) => `${group.replace(', test', '')}: sounds, false; changed, found`).join(' | ')} |\n|---|${tests.map(() => '---|').join('')}`);
for (const one of classes) {
  const cells = tests.map((group) => {
    const own = sounds.filter((sound) => sound.group === group && sound.class === one), as = own.filter((sound) => !sound.changed), not = own.filter((sound) => sound.changed);
    return `${as.length}, ${share(as, 'different')}; ${not.length}, ${share(not, 'different')}`;
  });
  console.log(`| ${one} | ${cells.join(' | ')} |`);
}

/** Readers and learners count alike; recordings that are not followed do not. */
function thresholds() {
  const dev = sounds.filter((sound) => sound.group.endsWith('dev') && sound.followed);
  const sides = [dev.filter(({ group }) => !group.startsWith('learners')), dev.filter(({ group }) => group.startsWith('learners'))].filter(({ length }) => length);
  const wrongly = (one, from) => sides.reduce((sum, side) => {
    const own = side.filter((sound) => sound.class === one);
    return sum + own.filter(({ score }) => score < from).length / Math.max(1, own.length) / sides.length;
  }, 0);
  return classes.map((one) => {
    let from = -1;
    while (from > -4.7 && wrongly(one, from) > FALSE_MOST) from = Math.round(from * 10 - 1) / 10;
    return `${one} ${from}`;
  });
}
if (values.choose) console.log(`\ndifferent below: ${thresholds().join(', ')}; good from ${GOOD_FROM}`);
