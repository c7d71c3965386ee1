// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings with their texts: accuracy of alignment against known times; times read from files; a folder of recordings as voices.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { errors } from '../../lib/boundaries.mjs';
import { faccia } from '../../lib/command.mjs';
import { build, Daemon, ordinary } from '../../lib/daemon.mjs';
import { cases, further } from '../../lib/long.mjs';
import { checkOrder, largestStep, phones, say, words } from '../../lib/speech.mjs';
import { compareTempo } from '../../lib/tempo.mjs';
import { austen, manzoni } from '../../lib/texts.mjs';
import { wavOf } from '../../lib/wav.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const write = (name, data) => {
  fs.mkdirSync(path.dirname(file(name)), { recursive: true });
  fs.writeFileSync(file(name), data);
  return file(name);
};
const run = (args, from = build, env = {}) => faccia(args, { from, env });
/** Writes samples as a sound file. */
const wav = (name, pcm, rate) => write(name, wavOf(pcm, rate));
const align = (sound, text, { lang = 'it', from = build, more = [] } = {}) => {
  const result = run(['align', sound, '--text', write('transcript.txt', text), '-l', lang, '--json', file('out.json'), ...more], from);
  return result.status === 0 ? { ...result, json: JSON.parse(fs.readFileSync(file('out.json'))) } : result;
};
const aligned = (sound, text, options) => {
  const result = align(sound, text, options);
  assert.equal(result.status, 0, result.stderr);
  checkOrder(result);
  return result;
};
/** Synthesised speech as a recording, with its true times. */
const recordings = new Map();
const recorded = (voice, lang, text) => {
  const key = voice + text;
  if (!recordings.has(key)) {
    const said = say(['-l', lang, '-v', voice], text);
    assert.equal(said.status, 0, said.stderr);
    recordings.set(key, { ...said, path: wav(`${recordings.size}.wav`, said.pcm, said.rate) });
  }
  return recordings.get(key);
};
const join = (...parts) => {
  const all = new Int16Array(parts.reduce((sum, p) => sum + p.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
};
/** Reproducible noise. */
const noise = (samples, loudness, seed = 1) => {
  let state = seed;
  return Int16Array.from({ length: samples }, () => {
    state = (Math.imul(state, 1664525) + 1013904223) | 0;
    return (state / 2 ** 31) * loudness;
  });
};
const wordStarts = ({ json }) => Object.fromEntries(json.words.map((w) => [w.byte_start, w.start]));

const ipaOf = ({ json }) => json.phones.map(({ ipa }) => ipa).join('');

test('aligns numbers, abbreviations and words of a lexicon as they are read', () => {
  const text = 'Il Sig. Zyx pagò € 3,50 a QTX il 26 novembre.';
  const read = 'Il signor Zaccaria della Ponte pagò tre euro e cinquanta a palla il ventisei novembre.';
  const lexicon = write('names.pls', `<lexicon version="1.0" xmlns="http://www.w3.org/2005/01/pronunciation-lexicon" alphabet="ipa" xml:lang="it">
<lexeme><grapheme>Zyx</grapheme><alias>Zaccaria della Ponte</alias></lexeme><lexeme><grapheme>QTX</grapheme><phoneme>ˈpalla</phoneme></lexeme></lexicon>`);
  const truth = recorded('espeak:it', 'it', read);
  const wanted = aligned(truth.path, read);
  const found = aligned(truth.path, text, { more: ['--lexicon', lexicon] });
  assert.equal(ipaOf(found), ipaOf(wanted));
  const [own, other] = [found, wanted].map(({ json }) => json.words.map((word) => word.text));
  assert.deepEqual(own.slice(0, 4), ['Il', 'Sig', 'Zyx', 'pagò']);
  const start = ({ json }, word) => json.words.find((one) => one.text === word).start;
  for (const [a, b] of [['pagò', 'pagò'], ['novembre', 'novembre'], ['26', 'ventisei'], ['QTX', 'palla']]) {
    assert.ok(own.includes(a) && other.includes(b), `${own}`);
    assert.ok(Math.abs(start(found, a) - start(wanted, b)) < 0.05, `${a}: ${start(found, a)}, not ${start(wanted, b)}`);
  }
  assert.notEqual(ipaOf(aligned(truth.path, text)), ipaOf(wanted), 'without the lexicon');
});

for (const [lang, text, voices] of cases([['it', manzoni, ['lp', 'pc']]], [['en', austen, ['slt', 'kal']]]))
  test(`known voices in ${lang}: half of the phones begin within 20 ms, nine in ten within 50 ms`, () => {
    let within = 0, all = 0;
    for (const voice of voices) {
      const truth = recorded(`festival:${voice}`, lang, text);
      const found = aligned(truth.path, text, { lang, from: ordinary });
      const e = errors(truth.json.phones, found.json.phones);
      assert.ok(e.pairs > 0.75 * e.phones, `${voice}: ${e.pairs} of ${e.phones} phones are the same`);
      assert.ok(e.median <= 20, `${voice}: median ${e.median} ms`);
      assert.ok(e.within50 >= 0.87, `${voice}: ${e.within50}`);
      within += e.within50 * e.pairs;
      all += e.pairs;
    }
    assert.ok(within / all >= 0.9, `${within / all} within 50 ms`);
  });

const short = 'La mamma prepara il pane, e il bambino mangia una mela. Il sole tramonta presto d\'inverno.\nPippo beve il tè dopo pranzo! Dove abita la signora Bianchi?\n';

test('tolerates noise and silence at the ends, and long pauses between sentences', () => {
  const truth = recorded('festival:pc', 'it', short);
  const { pcm, rate } = truth;
  const quiet = (seconds) => noise(seconds * rate, 20);
  // inserts half a minute of silence into the pause before "Il sole"
  const at = truth.json.words.find((w) => w.text === 'Il').start, cut = Math.round((at - 0.15) * rate);
  const parts = join(noise(1.5 * rate, 1500), quiet(4), pcm.subarray(0, cut), quiet(30), pcm.subarray(cut), quiet(3), noise(2 * rate, 1500));
  const found = aligned(wav('pauses.wav', parts, rate), short);
  const starts = wordStarts(found);
  let last = 0;
  for (const word of truth.json.words) {
    const expected = word.start + 5.5 + (word.start >= at - 0.01 ? 30 : 0), start = starts[word.byte_start];
    if (start === undefined) continue; // the two voices split some words differently
    assert.ok(Math.abs(start - expected) < 0.15, `${word.text} at ${start}, not ${expected}`);
    last = start;
  }
  assert.ok(last > 38);
});

test('finds the text after music', () => {
  const { pcm, rate, json } = recorded('festival:pc', 'it', short);
  const music = new Int16Array(12 * rate).map((_, i) => {
    const beat = (i / rate) % 1.5;
    return Math.exp(-2 * beat) * [262, 330, 392, 523].reduce((sum, f) => sum + 2500 * Math.sin((2 * Math.PI * f * i) / rate), 0);
  });
  const found = aligned(wav('music.wav', join(music, pcm), rate), short), starts = wordStarts(found);
  const pairs = json.words.map((word) => [word.text, word.start + 12, starts[word.byte_start]]).filter(([, , start]) => start !== undefined);
  assert.ok(pairs.length > 20);
  for (const [text, expected, start] of pairs) assert.ok(Math.abs(start - expected) < 0.15, `${text} at ${start}, not ${expected}`);
});

// Sentences of "Sense and Sensibility", read for LibriVox; from Debian's pocketsphinx-testdata.
const people = '/usr/share/pocketsphinx/test/data/librivox';
test('human readers: vowels are louder than stops, pauses are silent, and all words are covered', () => {
  const lines = fs.readFileSync(path.join(people, 'transcription'), 'utf8').trim().split('\n');
  const loudness = { vowel: [], closure: [], pause: [] };
  assert.equal(lines.length, 5);
  for (const line of lines) {
    const [, text, name] = line.match(/^<s> (.*) <\/s> \((.*)\)$/);
    const sound = path.join(people, `${name}.wav`), data = fs.readFileSync(sound);
    const pcm = new Int16Array(data.buffer.slice(data.byteOffset + 44, data.byteOffset + data.length - (data.length % 2)));
    const { json } = aligned(sound, text, { lang: 'en' });
    assert.deepEqual(json.words.map((w) => w.text), text.split(/ +/));
    const level = (from, to) => {
      let sum = 1;
      const a = Math.round(from * json.rate), b = Math.min(pcm.length, Math.round(to * json.rate));
      for (let i = a; i < b; i++) sum += pcm[i] * pcm[i];
      return 10 * Math.log10(sum / Math.max(1, b - a));
    };
    for (const { ipa, start, end } of json.phones) {
      const middle = (start + end) / 2;
      if (!ipa && end - start > 0.05) loudness.pause.push(level(start + 0.02, end - 0.02));
      // a stop's quietest moment is its closure
      else if (/^[ptkbdɡ]/.test(ipa)) loudness.closure.push(Math.min(...[0, 0.01, 0.02, 0.03].map((t) => level(start + t, start + t + 0.01))));
      else if (/^[aeiouɑɔɛɪʊʌæə]/.test(ipa)) loudness.vowel.push(level(middle - 0.015, middle + 0.015));
    }
    const spoken = json.phones.filter((p) => p.ipa);
    assert.ok(spoken[0].start < 0.5 && spoken.at(-1).end > json.duration - 0.6, `${name}: ${spoken[0].start} to ${spoken.at(-1).end} of ${json.duration}`);
  }
  const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];
  const [vowel, closure, pause] = ['vowel', 'closure', 'pause'].map((kind) => median(loudness[kind]));
  assert.ok(loudness.closure.length > 40 && loudness.vowel.length > 60);
  assert.ok(vowel > closure + 10 && vowel > pause + 15, `${vowel} dB, closures ${closure} dB, pauses ${pause} dB`);
});

test('aligns files whose second channel is inverted or whose recorder crashed', () => {
  const truth = recorded('festival:pc', 'it', short), { pcm, rate } = truth;
  const both = Int16Array.from({ length: 2 * pcm.length }, (_, i) => (i % 2 ? -1 : 1) * pcm[i >> 1]);
  const first = words(aligned(truth.path, short, { from: ordinary }));
  assert.deepEqual(words(aligned(write('inverted.wav', wavOf(both, rate, 2)), short, { from: ordinary })), first);
  for (const length of [0, 0xffffffff]) {
    const dead = wavOf(pcm, rate);
    dead.writeUInt32LE(length, 4);
    dead.writeUInt32LE(length, 40);
    assert.deepEqual(words(aligned(write('dead.wav', dead), short, { from: ordinary })), first, `${length}`);
    const heard = spawnSync(path.join(ordinary, 'server/cli/faccia'), ['hear', '--fap', file('dead.fap'), file('dead.wav')], { encoding: 'utf8' });
    assert.equal(heard.status, 0, heard.stderr);
    assert.ok(fs.statSync(file('dead.fap')).size > 1000);
  }
});

test('in noise, no word marked reliable begins more than a second off', () => {
  for (const voice of ['pc', 'lp']) {
    const truth = recorded(`festival:${voice}`, 'it', short), { pcm, rate } = truth;
    const at = truth.json.words.find((w) => w.text === 'Pippo').start, cut = Math.round((at - 0.02) * rate);
    for (const loud of [1000, 3000]) {
      const parts = join(noise(2 * rate, loud), pcm.subarray(0, cut), noise(3 * rate, loud), pcm.subarray(cut));
      const found = aligned(wav('noisy.wav', parts, rate), short, { from: ordinary });
      const real = wordStarts(truth);
      for (const w of found.json.words) {
        if (real[w.byte_start] === undefined || !(w.end > w.start)) continue;
        const off = Math.abs(w.start - real[w.byte_start] - (real[w.byte_start] > at - 0.1 ? 5 : 2));
        assert.ok(off < 1 || w.confidence < 0.5, `${voice} ${loud}: ${w.text} at ${w.start} is off by ${off} with confidence ${w.confidence}`);
      }
    }
  }
});

// J. Milton, "When I consider how my light is spent" (1673)
const sonnet = `When I consider how my light is spent,
Ere half my days, in this dark world and wide,
And that one talent which is death to hide
Lodged with me useless, though my soul more bent
To serve therewith my Maker, and present
My true account, lest he returning chide;
Doth God exact day-labour, light denied?
I fondly ask. But patience, to prevent
That murmur, soon replies, God doth not need
Either man's work or his own gifts; who best
Bear his mild yoke, they serve him best. His state
Is kingly. Thousands at his bidding speed
And post o'er land and ocean without rest;
They also serve who only stand and wait.
`;

test('finds all fourteen lines of a slow sonnet with pauses and hiss', () => {
  const said = say(['-l', 'en', '-v', 'espeak:en-us', '-r', '90'], sonnet, {}, ordinary);
  assert.equal(said.status, 0, said.stderr);
  const { pcm, rate } = said, real = wordStarts(said), pause = new Int16Array(Math.round(0.7 * rate));
  const bytes = sonnet.trim().split('\n').reduce((all, line) => [...all, all.at(-1) + Buffer.byteLength(line) + 1], [0]).slice(0, 14);
  const cuts = bytes.map((byte, i) => (i ? Math.round((real[byte] - 0.02) * rate) : 0));
  const sound = join(...cuts.flatMap((cut, i) => [pcm.subarray(cut, cuts[i + 1] ?? pcm.length), pause]));
  const hiss = noise(sound.length, 100, 7);
  sound.forEach((x, i) => (sound[i] = Math.max(-32768, Math.min(32767, x + hiss[i]))));
  const found = aligned(wav('sonnet.wav', sound, rate), sonnet, { lang: 'en', from: ordinary }), starts = wordStarts(found);
  assert.doesNotMatch(found.stderr, /not in the recording/);
  bytes.forEach((byte, i) => {
    const expected = real[byte] + i * pause.length / rate;
    assert.ok(Math.abs(starts[byte] - expected) < 0.3, `line ${i + 1} at ${starts[byte]}, not ${expected}`);
  });
});

test('reports a wrong transcript with position and time; where a text diverges later, only the unread part', () => {
  const italian = recorded('festival:pc', 'it', manzoni);
  const wrong = align(italian.path, austen, { lang: 'en', from: ordinary });
  assert.equal(wrong.status, 1);
  assert.match(wrong.stderr, /transcript\.txt:1:\d+: the words are not those of the recording, at 0:\d\d\.\d of the recording/);
  const small = align(recorded('festival:pc', 'it', short).path, austen.slice(0, 120), { lang: 'en' });
  assert.equal(small.status, 1);
  assert.match(small.stderr, /transcript\.txt:1:\d+: /);
  const certain = aligned(recorded('festival:pc', 'it', short).path, austen.slice(0, 120), { lang: 'en', more: ['--certain'] });
  const { words: forced } = certain.json; // single ones may sound alike by chance
  assert.ok(forced.length > 15 && forced.reduce((sum, { confidence }) => sum + confidence, 0) < 0.4 * forced.length, JSON.stringify(forced));
  const [first] = manzoni.split('\n');
  const half = align(italian.path, `${first}\n\n${first.split(' ').reverse().join(' ')}\n${austen}`, { from: ordinary });
  assert.equal(half.status, 0, half.stderr);
  assert.match(half.stderr, /warning: .*transcript\.txt:4:\d+: not in the recording: "However little/);
  for (const { byte_start, start, end, confidence } of half.json.sentences)
    assert.equal(byte_start < Buffer.byteLength(first), end > start && confidence > 0.3, `${byte_start}: ${start} to ${end}, ${confidence}`);
});

test('aligns a text longer than the recording, and a recording longer than the text', () => {
  const truth = recorded('festival:pc', 'it', manzoni);
  const part = wav('part.wav', truth.pcm.subarray(0, 20 * truth.rate), truth.rate);
  const more = align(part, manzoni, { from: ordinary });
  assert.equal(more.status, 0, more.stderr);
  assert.match(more.stderr, /transcript\.txt:3:\d+: not in the recording: /);
  const until = truth.json.words.find((w) => w.start > 17).byte_start;
  for (const { byte_start, byte_end, start, end } of more.json.sentences)
    if (byte_end < until || byte_start > until + 200) assert.equal(end > start, byte_start < until, `${byte_start}`);
  const less = aligned(truth.path, `${manzoni.slice(0, manzoni.indexOf('vien,'))}vien.`, { from: ordinary });
  assert.match(less.stderr, /the recording continues for \d+ s after its text/);
});

test('reports wrong usage and invalid files', () => {
  const sound = recorded('festival:pc', 'it', short).path;
  const text = write('ok.txt', short);
  for (const [args, status, message] of [
    [[sound], 2, /--text or a --timing/],
    [[], 2, /one sound/],
    [[sound, '--text', text, '--gender', 'x'], 2, /gender/],
    [[sound, '--text', text, '-l', 'xx'], 1, /no voice to align with speaks 'xx'/],
    [[sound, '--text', text, '-e', 'xx'], 2, /unknown engine 'xx'/],
    [[sound, '--text', text, '--fps', '0'], 2, /fps/],
    [[sound, '--text', file('none')], 1, /none: No such file/],
    [[file('none.wav'), '--text', text], 1, /none\.wav: .*No such file/],
    [[text, '--text', text], 1, /ok\.txt: /],
    [[sound, '--text', write('bytes.txt', Buffer.from([65, 0xff]))], 1, /^faccia: \S+bytes\.txt: byte 1: the text is not UTF-8/],
    [[sound, '--text', write('empty.txt', ' \n… —')], 1, /no words/],
    [[sound, '--timing', write('broken.TextGrid', 'File type = "ooTextFile"\nObject class = "TextGrid"\n0 1 <exists> 1\n"IntervalTier" "a" 0 1 2\n0 1 "x"\n')], 1, /broken\.TextGrid:\d+:1: expected the next interval/],
    [[sound, '--text', text, '--json', '/nowhere/x'], 1, /nowhere/],
  ]) {
    const result = run(['align', ...args]);
    assert.equal(result.status, status, result.stderr);
    assert.match(result.stderr, message);
  }
});

test('writes face and sound with the times; reads several sound formats', further, () => {
  const truth = recorded('festival:pc', 'it', short);
  const first = aligned(truth.path, short, { more: ['--fap', file('a.fap'), '--wav', file('a.wav')] });
  assert.deepEqual(fs.readFileSync(file('a.wav')), fs.readFileSync(truth.path));
  const frames = fs.readFileSync(file('a.fap'), 'latin1').split('\n');
  assert.equal(Number(frames[0].split(' ')[3]), Math.ceil((truth.pcm.length / truth.rate) * 25));
  assert.equal(frames.filter((line) => line).length, 1 + 2 * Number(frames[0].split(' ')[3]));
  for (const ending of ['flac', 'ogg', 'aiff']) {
    const made = spawnSync('sox', [truth.path, file(`same.${ending}`)]);
    assert.equal(made.status, 0, String(made.stderr));
    const same = aligned(file(`same.${ending}`), short);
    assert.deepEqual(words(same), words(first));
    same.json.words.forEach((w, i) => assert.ok(Math.abs(w.start - first.json.words[i].start) < 0.05, `${ending} ${w.text}`));
  }
});

test('aligns a chapter of eleven minutes in the memory of a short one', further, async () => {
  const sentences = manzoni.replaceAll('\n', ' ').split(/(?<=[,;.:]) /).filter((s) => s.length > 10);
  let text = '', seed = 7;
  while (text.length < 10800) {
    seed = (seed * 16807) % 2147483647;
    text += `${sentences[seed % sentences.length].replace(/[,;:.]$/, '')}. `;
  }
  const truth = say(['-l', 'it', '-v', 'espeak:it+f2', '-r', '140'], text, {}, ordinary); // ordinary build: speaking is not under test
  assert.equal(truth.status, 0, truth.stderr);
  const sound = wav('chapter.wav', truth.pcm, truth.rate), seconds = truth.pcm.length / truth.rate;
  assert.ok(seconds > 660, `${seconds} s`);
  const most = async (sound, text) => {
    const child = spawn(path.join(ordinary, 'server/cli/faccia'),
      ['align', sound, '--text', write('chapter.txt', text), '--gender', 'male', '--json', file('chapter.json'), '--fap', file('chapter.fap')]);
    let peak = 0;
    const timer = setInterval(() => {
      try {
        peak = Math.max(peak, Number(fs.readFileSync(`/proc/${child.pid}/status`, 'latin1').match(/VmHWM:\s+(\d+)/)?.[1] ?? 0));
      } catch {
        // the process has ended
      }
    }, 20);
    const [status] = await once(child, 'exit');
    clearInterval(timer);
    assert.equal(status, 0);
    return peak;
  };
  const part = wav('minute.wav', truth.pcm.subarray(0, truth.rate * 90), truth.rate);
  const until = [...truth.json.words].reverse().find((w) => w.end < 85);
  const small = await most(part, text.slice(0, Buffer.from(text).subarray(0, until.byte_end).toString().length));
  const large = await most(sound, text);
  assert.ok(small > 10000 && large < small + 20000, `${small} and ${large} kB`);
  const found = JSON.parse(fs.readFileSync(file('chapter.json')));
  const e = errors(truth.json.phones.filter((p) => p.start > 600), found.phones.filter((p) => p.start > 600));
  assert.ok(e.median < 20 && e.within50 > 0.9, JSON.stringify(e));
});

test('combines times from files with words found in the sound', () => {
  const truth = recorded('festival:pc', 'it', short);
  const names = write('names.json', JSON.stringify({ A: 'a', pau: '' }));
  const list = truth.json.phones;
  const lab = write('x.lab', `#\n${list.map((p) => `${p.end} 125 ${p.ipa === 'a' ? 'A' : p.ipa || 'pau'}`).join('\n')}\n`);
  const found = aligned(truth.path, short, { more: ['--timing', lab, '--names', names] });
  const sounding = (said) => said.json.phones.filter((p) => p.ipa);
  assert.equal(phones(found).replaceAll(/[_ ]+/g, ' '), phones(truth).replaceAll(/[_ ]+/g, ' '));
  sounding(found).forEach((p, i) => assert.ok(Math.abs(p.start - sounding(truth)[i].start) < 1e-3));
  const boundaries = new Set(found.json.phones.map((p) => p.start.toFixed(3)));
  const starts = wordStarts(found);
  for (const word of truth.json.words)
    if (starts[word.byte_start] !== undefined) assert.ok(Math.abs(starts[word.byte_start] - word.start) < 0.15, word.text);
  const on = found.json.words.filter((w) => boundaries.has(w.start.toFixed(3))).length;
  assert.ok(on > 0.8 * found.json.words.length, `${on} of ${found.json.words.length} words begin with a phone`);
  // words whose times are in the file need no alignment; without a text, only the file is used
  const own = write('own.json', JSON.stringify(truth.json));
  assert.deepEqual(words(aligned(truth.path, short, { more: ['--timing', own] })).join(' ').replace(/[^\p{L} ]/gu, ' ').split(/\s+/), words(truth).join(' ').replace(/[^\p{L} ]/gu, ' ').split(/\s+/));
  const alone = run(['align', truth.path, '--timing', lab, '--names', names]);
  assert.equal(alone.status, 0, alone.stderr);
  assert.deepEqual(JSON.parse(alone.stdout).words, []);
  const foreign = run(['align', truth.path, '--timing', own, '--text', write('austen.txt', austen)]);
  assert.equal(foreign.status, 1);
  assert.match(foreign.stderr, /\d+ of the \d+ words of the times are not in the text/);
});

test('a TextGrid with words needs no text: tiers are found by name or by option', () => {
  const truth = recorded('festival:pc', 'it', short);
  const quoted = (text) => `"${text.replaceAll('"', '""')}"`;
  const tier = (name, list) => `"IntervalTier"\n${quoted(name)}\n0\n${truth.json.duration}\n${list.length}\n${list.map(({ start, end, text, ipa }) => `${start}\n${end}\n${quoted(text ?? ipa)}`).join('\n')}\n`;
  const grid = (...tiers) => write('own.TextGrid', `File type = "ooTextFile"\nObject class = "TextGrid"\n0\n${truth.json.duration}\n<exists>\n${tiers.length}\n${tiers.join('')}`);
  const said = truth.json.words.flatMap(({ text, start, end }) => {
    const parts = text.split(/(?<=')/); // an apostrophe separates two words
    return parts.map((part, i) => ({ text: part, start: start + (i / parts.length) * (end - start), end: start + ((i + 1) / parts.length) * (end - start) }));
  });
  const check = (timing, ...more) => {
    const result = run(['align', truth.path, '--timing', timing, ...more]);
    assert.equal(result.status, 0, result.stderr);
    const { words: list, phones: sounds } = JSON.parse(result.stdout);
    assert.deepEqual(list.map((w) => w.text), said.map((w) => w.text.replace(/[^\p{L}]/gu, '')));
    list.forEach((w, i) => assert.ok(Math.abs(w.start - said[i].start) < 0.21, `${w.text} at ${w.start}, not ${said[i].start}`));
    assert.ok(sounds.filter((p) => p.ipa).length > 60);
  };
  check(grid(tier('anna - words', said), tier('anna - phones', truth.json.phones)));
  const two = grid(tier('one', said), tier('two', truth.json.phones));
  check(two, '--tier', 'two', '--word-tier', 'one');
  const unknown = run(['align', truth.path, '--timing', two]);
  assert.equal(unknown.status, 1);
  assert.match(unknown.stderr, /no tier is named "phones": choose one of "one", "two"/);
});

// Seconds: a generous deadline for slow machines.
const PATIENCE = '300';
const patience = ['--deadline-base', PATIENCE];
const library = (name, config = {}) => ({ FACCIA_DEADLINE_BASE: PATIENCE, FACCIA_VOICE_CONFIG: write(`${name}.json`, JSON.stringify({ recording: { folder: file(name), seconds: 300, ...config } })) });

test('aligns a folder of recordings: voices, sentences, the whole text, missing passages', () => {
  const truth = recorded('festival:lp', 'it', manzoni), english = recorded('festival:kal', 'en', austen);
  fs.mkdirSync(file('shelf'), { recursive: true });
  fs.copyFileSync(truth.path, file('shelf/promessi.wav'));
  write('shelf/promessi.txt', manzoni);
  fs.copyFileSync(english.path, file('shelf/pride.wav'));
  write('shelf/pride.txt', austen);
  write('shelf/pride.json', JSON.stringify({ lang: 'en', gender: 'male', name: 'Pride', licence: 'CC0-1.0' }));
  fs.copyFileSync(english.path, file('shelf/untold.wav'));
  const env = library('shelf');
  const voices = run(['voices'], build, env).stdout;
  assert.match(voices, /recording:pride +en +male +recorded +Pride/);
  assert.match(voices, /recording:promessi +it +neutral +recorded +promessi/);
  assert.doesNotMatch(voices, /untold/);
  // the whole text plays the whole recording
  const whole = say(['-v', 'recording:promessi'], manzoni, env, ordinary);
  assert.equal(whole.status, 0, whole.stderr);
  assert.equal(whole.stderr, '');
  checkOrder(whole);
  const first = truth.pcm.length - whole.pcm.length;
  assert.ok(first >= 0 && first < truth.rate, `${first} samples are missing`);
  assert.ok(largestStep(whole) <= largestStep(truth));
  assert.deepEqual([...whole.pcm.subarray(20000, 20050)], [...truth.pcm.subarray(20000, 20050)]);
  assert.ok(errors(truth.json.phones, whole.json.phones).within50 > 0.9);
  assert.ok(fs.existsSync(file('shelf/promessi.timing.json')), 'the alignment is kept');
  // some of its words, spelled differently
  const words_ = say(['-v', 'recording:promessi', '--pitch', '1.5'], 'DALL\'ALTRA  parte: e il ponte', env);
  assert.equal(words_.status, 0, words_.stderr);
  assert.match(words_.stderr, /recordings keep their pitch/);
  assert.equal(words(words_).length, 6);
  const at = truth.json.words.find((w) => w.text.startsWith('dall')).start, length = words_.pcm.length / words_.rate;
  assert.ok(length > 1 && length < 3, `${length} s`);
  const place = Math.round(at * truth.rate);
  const needle = words_.pcm.subarray(8000, 8020).join();
  let found = false;
  for (let i = place; i < place + 2 * truth.rate && !found; i++) found = truth.pcm.subarray(i, i + 20).join() === needle;
  assert.ok(found, 'it is the same stretch of the recording');
  const none = say(['-v', 'recording:promessi'], 'Quel ramo del lago di Garda.', env);
  assert.equal(none.status, 1);
  assert.match(none.stderr, /not in the recording: after 5 words it has "Como" instead of "Garda"/);
  const alien = say(['-v', 'recording:promessi'], 'Zucchine.', env);
  assert.match(alien.stderr, /it has no word "Zucchine"/);
});

test('stored alignments: rejects those of other recordings, uses a cache folder, prefers the user\'s own', further, () => {
  const truth = recorded('festival:pc', 'it', short);
  fs.mkdirSync(file('kept/cache'), { recursive: true });
  fs.copyFileSync(truth.path, file('kept/a.wav'));
  write('kept/a.txt', short);
  const env = library('kept', { cache: file('kept/cache') });
  const speak = (text) => say(['-v', 'recording:a'], text, env);
  const before = speak(short);
  assert.equal(before.status, 0, before.stderr);
  const kept = JSON.parse(fs.readFileSync(file('kept/cache/a.timing.json')));
  assert.ok(!fs.existsSync(file('kept/a.timing.json')));
  assert.equal(kept.samples, truth.pcm.length);
  // the stored alignment is used
  write('kept/cache/a.timing.json', JSON.stringify({ ...kept, phones: kept.phones.map((p) => ({ ...p, ipa: 'm' })) }));
  assert.match(phones(speak(short)), /^[m_ ]+$/);
  // a changed text is aligned again
  write('kept/a.txt', `${short} `);
  assert.equal(phones(speak(short)), phones(before));
  // the user's TextGrid takes precedence
  const grid = `File type = "ooTextFile"\nObject class = "TextGrid"\n0\n1\n<exists>\n2\n"IntervalTier"\n"words"\n0\n1\n2\n0.1\n0.4\n"La"\n0.4\n1\n"mamma"\n"IntervalTier"\n"phones"\n0\n1\n1\n0.1\n1\n"l"\n`;
  write('kept/a.TextGrid', grid);
  assert.equal(phones(speak('La mamma')).replaceAll('_', '').trim(), 'l');
  write('kept/a.TextGrid', grid.replace('0.1\n1\n"l"', '1\n0.1\n"l"'));
  const broken = speak('La mamma');
  assert.equal(broken.status, 1);
  assert.match(broken.stderr, /a\.TextGrid:\d+:1: the interval is not in order/);
});

for (const [name, config, message] of [
  ['no folder', {}, null],
  ['a folder that is not there', { folder: '/nowhere' }, /folder: \/nowhere: No such file/],
  ['an unknown setting', { folders: 'x' }, /folders: unknown setting/],
  ['a number that is none', { folder: '/tmp', pause: 'long' }, /pause: must be a number/],
])
  test(`reads a configuration with ${name}`, () => {
    const { status, stderr, stdout } = run(['voices', '-l', 'it'], build, { FACCIA_VOICE_CONFIG: write('wrong.json', JSON.stringify({ recording: config })) });
    assert.equal(status, 0);
    assert.match(stdout, /espeak:it/);
    if (message) assert.match(stderr, message);
    else assert.equal(stderr, '');
  });

test('streams a recording like any speech, sentence by sentence', async (t) => {
  const truth = recorded('festival:pc', 'it', short);
  fs.mkdirSync(file('stream'), { recursive: true });
  fs.copyFileSync(truth.path, file('stream/a.wav'));
  write('stream/a.txt', short);
  const daemon = await Daemon.start([...patience, '--voice-config', library('stream').FACCIA_VOICE_CONFIG]);
  t.after(() => daemon.process.kill('SIGKILL'));
  const { voices } = await (await daemon.get('/v1/voices')).json();
  assert.equal(voices.find((v) => v.id === 'recording:a').quality, 'recorded');
  // slower and faster: the pitch stays, and phones match the sound
  const pace = voices.find((v) => v.id === 'recording:a').words_per_minute;
  assert.equal(pace, Math.trunc(short.match(/[\p{L}\p{N}]+/gu).length / (truth.pcm.length / truth.rate / 60)));
  const speech = (format, more = '') => daemon.get(`/v1/speech?voice=recording:a&format=${format}${more}`, { method: 'POST', body: short, headers: { 'content-type': 'text/plain' } });
  const heard = async (rate) => {
    const more = rate ? `&rate=${rate}` : '', data = Buffer.from(await (await speech('wav', more)).arrayBuffer());
    return { rate: data.readUInt32LE(24), pcm: new Int16Array(data.buffer.slice(data.byteOffset + 44, data.byteOffset + data.length)), json: await (await speech('json', more)).json() };
  };
  const own = await heard();
  for (const part of [0.6, 1.7]) {
    const rate = Math.round(pace * part), speed = rate / pace, is = await heard(rate), { pitch, pitches, lag, most, duration } = compareTempo(own, is, speed);
    const what = `${speed} times: ${JSON.stringify({ pitch, pitches, lag, most, duration })}`;
    assert.ok(pitches > 8 && Math.abs(pitch) < 0.02, what);
    assert.ok(Math.abs(duration - 1) < 0.002 && lag <= 0.01 && most <= 0.03, what);
    checkOrder(is);
    assert.deepEqual(is.json.phones.map((p) => p.ipa), own.json.phones.map((p) => p.ipa));
    own.json.phones.forEach((p, i) => assert.ok(Math.abs(is.json.phones[i].start * speed - p.start) < 0.03, `${what}, phone ${i}`));
    own.json.words.forEach((w, i) => assert.ok(Math.abs(is.json.words[i].end * speed - w.end) < 0.03, `${what}, ${w.text}`));
    assert.deepEqual(is.json.warnings ?? [], []);
  }
  // a change within a sentence, and a mark after it
  const ssml = (body) => `<speak xml:lang="it">${body}</speak>`, slow = ssml('La mamma prepara il pane, e <prosody rate="50%">il bambino mangia</prosody> <mark name="m"/>una mela.');
  const asked = await daemon.get('/v1/speech?voice=recording:a&format=json', { method: 'POST', body: slow, headers: { 'content-type': 'application/ssml+xml' } });
  const parts = await asked.json(), lasts = ({ words }, i) => words[i].end - words[i].start;
  for (const i of [0, 1, 2]) assert.ok(Math.abs(lasts(parts, i) - lasts(own.json, i)) < 0.03, parts.words[i].text);
  for (const i of [7, 8]) assert.ok(Math.abs(lasts(parts, i) - 2 * lasts(own.json, i)) < 0.06, parts.words[i].text);
  const stream = await daemon.stream();
  for (const id of ['once', 'again']) {
    stream.send({ type: 'speak', voice: 'recording:a', id, text: short });
    const end = await stream.wait({ type: 'end', id, reason: 'done' }, { milliseconds: 60000 });
    assert.ok(end.duration > 8);
    assert.equal(stream.messages.filter((m) => m.type === 'sentence' && m.id === id).length, 4);
  }
  stream.send({ type: 'speak', voice: 'recording:a', id: 'stop', text: short });
  await stream.wait({ type: 'begin', id: 'stop' });
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'stop', reason: 'stopped' });
  await stream.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('maps repeated words to two places of the recording, in spite of the cache', further, async (t) => {
  const text = 'La mamma prepara il pane. Il sole tramonta presto. La mamma prepara il pane. Dove abita la signora?';
  const truth = recorded('festival:pc', 'it', text);
  const hiss = noise(truth.pcm.length, 40), pcm = truth.pcm.map((x, i) => x + hiss[i]);
  write('twice/a.txt', text);
  wav('twice/a.wav', pcm, truth.rate);
  const daemon = await Daemon.start([...patience, '--voice-config', library('twice').FACCIA_VOICE_CONFIG]);
  t.after(() => daemon.process.kill('SIGKILL'));
  const spoken = async (body) => {
    const answer = await daemon.get('/v1/speech?voice=recording:a&format=wav', { method: 'POST', body, headers: { 'content-type': 'text/plain' } });
    assert.equal(answer.status, 200);
    return new Int16Array((await answer.arrayBuffer()).slice(44));
  };
  for (let i = 0; i < 2; i++) {
    const heard = await spoken(text);
    assert.ok(heard.length > 0.9 * pcm.length);
    let start = 0;
    while (start < truth.rate && heard.subarray(0, 50).some((x, k) => x !== pcm[start + k])) start++;
    assert.ok(heard.every((x, k) => x === pcm[start + k]), 'what is heard is the recording, sample by sample');
  }
  // The text around a sentence decides which of two places is played, independent of earlier speech.
  for (const [part, last] of [[text.slice(text.lastIndexOf('La mamma')), true], [text.slice(0, 45), false]]) {
    const heard = await spoken(part);
    const at = last ? pcm.length - heard.length : 0;
    assert.ok(heard.length < 0.7 * pcm.length && heard.every((x, k) => x === pcm[at + k]), `${part}: not from its own place`);
  }
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('aligns programs that do not report times', further, () => {
  const script = write('speaks', '#!/bin/sh\nespeak-ng -v it+f2 --stdout -- "$1"\n');
  fs.chmodSync(script, 0o755);
  const config = (lang) => ({ FACCIA_VOICE_CONFIG: write('command.json', JSON.stringify({ command: { voices: [{ id: 'x', lang, argv: [script, '{text}'] }] } })) });
  const text = 'La mamma prepara il pane per il bambino.';
  const said = say(['-v', 'command:x'], text, config('it'));
  assert.equal(said.status, 0, said.stderr);
  assert.equal(said.stderr, '');
  checkOrder(said);
  const truth = say(['-l', 'it', '-v', 'espeak:it+f2', '-r', '175'], text);
  assert.equal(words(said).length, words(truth).length);
  const e = errors(truth.json.phones, said.json.phones);
  assert.ok(e.median <= 20 && e.within50 >= 0.9, JSON.stringify(e));
  const unknown = say(['-v', 'command:x', '-l', 'it'], text, config('xx'));
  assert.equal(unknown.status, 0);
  assert.match(unknown.stderr, /the mouth stays closed: no voice to align with speaks 'xx'/);
});
