// SPDX-License-Identifier: GPL-3.0-or-later
// The Festival voices: sound without clicks, phones known to the language packs, places of words, lips that close; and Festival
// processes that die or hang.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { Daemon, root } from '../../lib/daemon.mjs';
import { cases } from '../../lib/long.mjs';
import { checkOrder, largestStep, loudest, phones, say, words } from '../../lib/speech.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));

const texts = {
  it: `La mamma beve il tè, e il bambino dorme. «Perché piangi?» — domandò Filippo; ma nessuno rispose: c'era un gran silenzio!
Il babbo comprò 25 pomodori, 3 meloni e mezzo chilo di fave. Una volpe affamata vide dei grappoli d'uva. Che cosa fai? Sbagliò.`,
  en: `My mother made some plum jam for the baby. "Why do you cry?" asked Philip, but nobody answered: it was very quiet! Bob bought
25 peaches, 3 melons and half a pound of beans. Five brown foxes jumped over the puppy. What do you mean?`,
};

for (const [voice, lang] of cases([['festival:lp', 'it'], ['festival:slt', 'en']], [['festival:pc', 'it'], ['festival:kal', 'en']])) {
  test(`${voice} speaks a paragraph`, () => {
    const said = say(['-l', lang, '-v', voice], texts[lang]);
    assert.equal(said.status, 0, said.stderr);
    assert.equal(said.stderr, '');
    assert.deepEqual(said.json.warnings, []);
    checkOrder(said);
    assert.ok(largestStep(said) < 40000, `a step of ${largestStep(said)}`);
    assert.ok(loudest(said) > 8000 && loudest(said) <= 32000, `loudest ${loudest(said)}`);
    const read = texts[lang].match(/[\p{L}\d']+/gu);
    assert.deepEqual(words(said), read);
    for (const phone of said.json.phones) assert.ok(phone.ipa || phone.end - phone.start < 1, 'no long silence');
  });

  test(`the lips close on every bilabial of ${voice}`, () => {
    const { stdout, stderr } = faccia(['eval', '-l', lang, '-v', voice, '-e', 'dominance', '-r', '140,190,240', '--json', '-', '-'], { input: texts[lang] });
    assert.equal(stderr, '');
    const { rows } = JSON.parse(stdout);
    assert.equal(rows.length, 3);
    for (const row of rows) {
      assert.ok(row.bilabials > 10);
      assert.equal(row.lips_seen, 1, JSON.stringify(row));
    }
  });
}

const italian = (text, ...more) => {
  const said = say(['-l', 'it', '-v', 'festival:lp', ...more], text);
  assert.equal(said.status, 0, said.stderr);
  return said;
};

test('reads accents, apostrophes, numbers and symbols', () => {
  assert.equal(phones(italian('Perché è così?')), '_ p e r k e ɛ k o s i _');
  assert.equal(phones(italian('Perche\u0301 e\u0300 cosi\u0300?')), '_ p e r k e ɛ k o s i _', 'accents as characters of their own');
  assert.equal(phones(italian('L’amica, un po’.')), '_ l a m i k a _ u n p o _');
  assert.deepEqual(words(italian('Costa 100% e 25 €, forse.')), ['Costa', '100%', 'e', '25 €', 'forse']);
  assert.equal(phones(italian('dice «sì»')), phones(italian('dice "sì"')));
});

test('reads text that Festival cannot read, or crashes on, in a simpler form, or reports it', () => {
  assert.deepEqual(words(italian('Il 1º giorno.')), ['Il', '1º', 'giorno']);
  assert.equal(phones(italian('È.')), '_ ɛ _');
  assert.deepEqual(words(italian('Čapek, Øre, naïve, Straße.')), ['Čapek', 'Øre', 'naïve', 'Straße']);
  const alone = italian('Ecco жизнь qui.', '--normalize', 'off');
  assert.match(alone.stderr, /cannot read the characters/);
  assert.deepEqual(words(alone), ['Ecco', 'qui']);
  const helped = italian('Ecco жизнь qui.'); // a voice of that script reads the word
  assert.equal(helped.stderr, '');
  assert.deepEqual(words(helped), ['Ecco', 'жизнь', 'qui']);
  for (const text of ['...', '!?', '« — »', '     '])
    assert.notEqual(say(['-l', 'it', '-v', 'festival:lp'], text).status, 139);
});

test('passes text to Festival as text, never as Scheme', () => {
  const mark = path.join(folder, 'mark');
  const said = italian(`Uno ") (system "touch ${mark}") (" due \\" tre \\\\ quattro ') (quit) fine.`);
  assert.ok(!fs.existsSync(mark));
  assert.ok(words(said).includes('due') && words(said).includes('fine'));
});

test('applies rate, pitch and volume', () => {
  const plain = italian('La mamma parla piano.');
  const slow = italian('La mamma parla piano.', '--rate', '95');
  assert.ok(slow.json.duration > 1.7 * plain.json.duration, `${slow.json.duration} ${plain.json.duration}`);
  const soft = italian('La mamma parla piano.', '--volume', '0.5');
  assert.ok(Math.abs(loudest(soft) / loudest(plain) - 0.5) < 0.08, `${loudest(soft)} ${loudest(plain)}`);
  assert.equal(soft.json.duration, plain.json.duration);
  // a higher voice has more upward zero crossings
  const periods = ({ pcm }) => pcm.reduce((n, x, i) => n + (i && pcm[i - 1] < 0 && x >= 0), 0);
  const high = italian('La mamma parla piano.', '--pitch', '1.8');
  assert.ok(periods(high) > 1.1 * periods(plain), `${periods(high)} ${periods(plain)}`);
});

/** Median fundamental frequency in Hz, by autocorrelation. */
function pitchOf({ pcm, rate }) {
  const list = [], n = Math.round(rate * 0.04);
  for (let at = 0; at + n + rate / 80 < pcm.length; at += Math.round(rate * 0.01)) {
    const energy = (from) => { let sum = 0; for (let i = 0; i < n; i++) sum += pcm[from + i] ** 2; return sum; };
    const here = energy(at);
    if (here < n * 500 ** 2) continue;
    let best = 0, period = 0;
    for (let lag = Math.round(rate / 450); lag < rate / 80; lag++) {
      let sum = 0;
      for (let i = 0; i < n; i++) sum += pcm[at + i] * pcm[at + lag + i];
      const alike = sum / Math.sqrt(here * energy(at + lag) + 1);
      if (alike > best * 1.02) [best, period] = [alike, lag];
    }
    if (best > 0.85) list.push(rate / period);
  }
  return list.sort((a, b) => a - b)[list.length >> 1];
}

test('emotions change rate and pitch as the table of expressions says', () => {
  const { affect } = JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json')));
  const speak = (voice, name) => {
    const said = say(['-l', 'it', '-v', voice], `<apml><performative type="inform"><rheme${name ? ` affect="${name}"` : ''}>Il postino arriva tardi oggi, con una lunga lettera da Roma.</rheme></performative></apml>`);
    assert.equal(said.status, 0, said.stderr);
    const seconds = said.json.phones.filter((p) => p.ipa).reduce((sum, p) => sum + p.end - p.start, 0);
    return { seconds, pitch: pitchOf(said) };
  };
  for (const voice of ['festival:lp', 'festival:pc']) {
    const plain = speak(voice);
    // all voices use the same table; one emotion raises the pitch, one lowers it
    for (const name of voice === 'festival:lp' ? ['joy', 'sadness', 'anger', 'fear', 'disgust', 'surprise'] : cases(['joy', 'sadness'], ['anger', 'fear', 'disgust', 'surprise'])) {
      const { seconds, pitch } = speak(voice, name), { rate, pitch: factor } = affect[name].voice;
      assert.ok(Math.abs((seconds / plain.seconds) * rate - 1) < 0.02, `${voice} ${name}: ${seconds} s, ${plain.seconds} s`);
      assert.ok(Math.abs(pitch / plain.pitch / factor - 1) < 0.09, `${voice} ${name}: ${pitch} Hz, ${plain.pitch} Hz`);
      assert.equal(pitch > plain.pitch, factor > 1, `${voice} ${name}: ${pitch} Hz, ${plain.pitch} Hz`);
    }
  }
});

test('splits a long sentence into pieces', () => {
  const text = 'una parola dopo l’altra e ancora un’altra, '.repeat(60);
  const said = italian(text);
  assert.equal(said.stderr, '');
  checkOrder(said);
  assert.equal(said.json.words.length, text.match(/[\p{L}’]+/gu).length);
});

/** The Festival processes that descend from a process. */
function festivals(pid) {
  const all = fs.readdirSync('/proc').filter((name) => /^\d+$/.test(name)).map((name) => {
    try {
      const stat = fs.readFileSync(`/proc/${name}/stat`, 'latin1');
      return { pid: Number(name), name: stat.slice(stat.indexOf('(') + 1, stat.lastIndexOf(')')), parent: Number(stat.slice(stat.lastIndexOf(')') + 2).split(' ')[1]) };
    } catch {
      return { pid: 0 }; // it has just ended
    }
  });
  const below = (parent) => all.filter((p) => p.parent === parent).flatMap((p) => [p, ...below(p.pid)]);
  return below(pid).filter((p) => p.name === 'festival');
}

/** Makes a Festival that dies or hangs at the word "adesso". */
const faulty = (what) => {
  const program = path.join(folder, what);
  fs.writeFileSync(program, `#!/usr/bin/env node
const { spawn } = require('child_process');
const child = spawn('festival', process.argv.slice(2), { stdio: ['pipe', 'inherit', 'inherit', 3] });
process.stdin.on('data', (data) => {
  if (!String(data).includes('adesso')) child.stdin.write(data);
  else if ('${what}' === 'dies') { child.kill('SIGKILL'); process.kill(process.pid, 'SIGKILL'); }
});
process.stdin.on('end', () => child.stdin.end());
`, { mode: 0o755 });
  const config = path.join(folder, `${what}.json`);
  fs.writeFileSync(config, JSON.stringify({ festival: { program } }));
  return config;
};

for (const [what, code] of [['dies', 'voice-failed'], ['hangs', 'voice-timeout']])
  test(`a Festival that ${what} costs one sentence`, async (t) => {
    const daemon = await Daemon.start(['--voice-config', faulty(what)]);
    t.after(() => daemon.process.kill('SIGKILL')); // when an assertion fails
    const stream = await daemon.stream();
    stream.send({ type: 'speak', lang: 'it', voice: 'festival:lp', id: 'x', text: 'Una frase.\n\nCade adesso.\n\nPoi si continua.' });
    const error = await stream.wait({ type: 'error', id: 'x' }, { milliseconds: 40000 });
    assert.equal(error.code, code);
    assert.equal((await stream.wait({ type: 'end', id: 'x' }, { milliseconds: 40000 })).reason, 'done');
    assert.deepEqual(stream.messages.filter((m) => m.type === 'word').map((m) => m.text), ['Una', 'frase', 'Poi', 'si', 'continua']);
    await stream.close();
    assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  });

test('restarts a Festival killed while idle, and a stop reaches it', async (t) => {
  const daemon = await Daemon.start();
  t.after(() => daemon.process.kill('SIGKILL')); // when an assertion fails
  const stream = await daemon.stream();
  const speak = (id, text) => stream.send({ type: 'speak', lang: 'it', voice: 'festival:lp', id, text });
  speak('a', 'La prima frase.');
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'done');
  const [festival] = festivals(daemon.process.pid);
  process.kill(festival.pid, 'SIGKILL');
  speak('b', 'La seconda frase.');
  assert.equal((await stream.wait({ type: 'end', id: 'b' })).reason, 'done');
  assert.equal(stream.messages.filter((m) => m.type === 'error').length, 0);
  const [another] = festivals(daemon.process.pid);
  assert.notEqual(another.pid, festival.pid);
  process.kill(another.pid, 'SIGSTOP'); // it will not answer
  await daemon.asks(() => speak('c', 'La terza frase.'));
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'c', reason: 'stopped' });
  speak('d', 'La quarta frase.');
  assert.equal((await stream.wait({ type: 'end', id: 'd' })).reason, 'done');
  await stream.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  assert.deepEqual(festivals(daemon.process.pid), []);
});

test('serves without Festival, and says so', async (t) => {
  const config = path.join(folder, 'none.json');
  fs.writeFileSync(config, JSON.stringify({ festival: { program: '/nowhere/festival' } }));
  const daemon = await Daemon.start(['--voice-config', config]);
  t.after(() => daemon.process.kill('SIGKILL')); // when an assertion fails
  await daemon.logged(/unavailable voices: .*festival: the program "\/nowhere\/festival" is not installed/);
  const { voices } = await (await daemon.get('/v1/voices')).json();
  assert.ok(voices.length && voices.every((v) => v.plugin !== 'festival'));
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});
