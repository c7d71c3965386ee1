// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the command voices of the documentation as printed: programs packaged by Debian directly; others, and servers, as stand-ins that
// speak their protocol.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { Worker } from 'node:worker_threads';
import { errors } from '../../lib/boundaries.mjs';
import { faccia } from '../../lib/command.mjs';
import { ordinary, root } from '../../lib/daemon.mjs';
import { cases } from '../../lib/long.mjs';
import { checkOrder, loudest, phones, say, words } from '../../lib/speech.mjs';
import { austen, manzoni } from '../../lib/texts.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const workers = [];
after(async () => {
  await Promise.all(workers.map((worker) => worker.terminate()));
  fs.rmSync(folder, { recursive: true });
});

const manual = fs.readFileSync(path.join(root, 'server/plugins/README.md'), 'utf8');
const examples = [...manual.matchAll(/```json\n([^]*?)```/g)].map(([, text]) => text).filter((text) => JSON.parse(text).command?.voices.length);
const exampleOf = (id) => {
  const text = examples.find((example) => JSON.parse(example).command.voices.some((voice) => voice.id === id));
  assert.ok(text, `the documentation shows no voice "${id}"`);
  return text;
};

/** Writes a configuration. Returns an environment that names it. */
const configured = (text) => {
  const file = path.join(folder, `config-${fs.readdirSync(folder).length}.json`);
  fs.writeFileSync(file, text);
  // only Debian's programs: plugins may not read a user's home
  // some programs are slow to start on a busy machine
  return { FACCIA_VOICE_CONFIG: file, FACCIA_DEADLINE_BASE: '60', PATH: '/usr/local/bin:/usr/bin:/bin' };
};

/** Starts a server of lib/ in a thread. Returns its port. */
async function serve(name, workerData) {
  const worker = new Worker(new URL(`../../lib/${name}.mjs`, import.meta.url), { workerData });
  workers.push(worker);
  return new Promise((resolve, reject) => worker.once('message', resolve).once('error', reject));
}

const speaks = (env, lang, id, text, ...options) => {
  const said = say(['-l', lang, '-v', `command:${id}`, ...options], text, env);
  assert.equal(said.status, 0, said.stderr);
  assert.equal(said.stderr, '');
  checkOrder(said);
  assert.ok(loudest(said) > 2000, `loudest ${loudest(said)}`);
  return said;
};

/** Checks that the lips close on every p, b and m of a voice. */
const closes = (env, lang, id, text) => {
  const { stdout, stderr } = faccia(['eval', '-l', lang, '-v', `command:${id}`, '-e', 'dominance', '-r', '170', '--json', '-', '-'], { input: text, env });
  assert.equal(stderr, '');
  for (const row of JSON.parse(stdout).rows) {
    assert.ok(row.bilabials > 10);
    assert.equal(row.lips_seen, 1, JSON.stringify(row));
  }
};

const italian = 'Il babbo compra pane e burro per la bambina. La mamma prepara la pappa, e poi parte subito con il treno per Palermo.';
const english = 'My mother bought a pair of brown boots for Bob. Please bring the map, the lamp and a paper cup to the room upstairs.';
const said = (text) => text.match(/[\p{L}']+/gu);

for (const [id, lang, text] of [['espeak', 'it', italian], ['flite', 'en', english], ['wave', 'en', english]]) {
  test(`${id} speaks, and its lips close`, () => {
    const env = configured(exampleOf(id));
    assert.deepEqual(words(speaks(env, lang, id, text)), said(text));
    closes(env, lang, id, text);
  });
  if (id === 'wave') continue;
  test(`${id} speaks at the requested rate`, () => {
    const env = configured(exampleOf(id));
    const [slow, fast] = ['100', '250'].map((rate) => speaks(env, lang, id, text, '--rate', rate).json.duration);
    assert.ok(slow > 1.8 * fast, `${slow} s and ${fast} s`);
  });
}

test('MaryTTS: returns sound, phone times and words', async () => {
  const example = exampleOf('mary');
  const [{ times }] = JSON.parse(example).command.voices;
  const port = await serve('marytts', { names: times.names });
  const env = configured(example.replaceAll('localhost:59125', `localhost:${port}`));
  const text = 'Perché "mamma & papà" = ciò che gli gnomi, 100% felici, dicono?';
  const spoken = speaks(env, 'it', 'mary', text, '--normalize', 'off'); // the server gets & and % unchanged
  const asked = { INPUT_TYPE: 'TEXT', LOCALE: 'it', VOICE: 'istc-lucia-hsmm', INPUT_TEXT: text };
  const answer = async (more) => fetch(`http://127.0.0.1:${port}/process`, { method: 'POST', body: new URLSearchParams({ ...asked, ...more }) });
  const durations = await (await answer({ OUTPUT_TYPE: 'REALISED_DURATIONS' })).text();
  const known = durations.trim().split('\n').slice(1).map((line) => line.split(' '));
  assert.ok(known.length > 30 && known.some(([, , name]) => /^.1$/.test(name)) && known.some(([, , name]) => /^(.)\1$/.test(name)), durations);
  assert.equal(phones(spoken), known.map(([, , name]) => times.names[name].replace('ˈ', '') || '_').join(' '));
  spoken.json.phones.forEach((phone, i) => {
    assert.ok(Math.abs(phone.end - known[i][0]) < 2e-3 || i === known.length - 1, `${phone.ipa} ends at ${phone.end}, not ${known[i][0]}`);
    assert.equal(phone.stress ?? 0, /1$/.test(known[i][2]) ? 2 : 0);
  });
  const wav = Buffer.from(await (await answer({ OUTPUT_TYPE: 'AUDIO', AUDIO: 'WAVE_FILE' })).arrayBuffer());
  assert.deepEqual(spoken.pcm, new Int16Array(wav.buffer.slice(wav.byteOffset + 44, wav.byteOffset + wav.length)));
  const heard = words(spoken);
  for (const word of ['mamma', 'papà', 'gnomi', 'dicono']) assert.ok(heard.includes(word), heard.join(' '));
  closes(env, 'it', 'mary', italian);
});

test('MaryTTS: reports a server that refuses or is missing', async () => {
  const example = exampleOf('mary');
  const port = await serve('marytts', { names: {} });
  const other = configured(example.replaceAll('localhost:59125', `localhost:${port}`).replaceAll('istc-lucia-hsmm', 'nobody'));
  assert.match(say(['-v', 'command:mary'], 'Ciao.', other).stderr, /"curl" exited with status 22: curl: \(22\) .*400/);
  const nobody = configured(example.replaceAll('localhost:59125', 'localhost:1'));
  assert.match(say(['-v', 'command:mary'], 'Ciao.', nobody).stderr, /"curl" exited with status 7: curl: \(7\)/);
});

// Behaves like Piper: speaks each line of its input at 22050 Hz, as samples or into a file.
const piper = `#!/bin/sh
scale=1 raw=
while [ $# -gt 0 ]; do
    case $1 in
    --model) model=$2 && shift 2 ;;
    --length_scale) scale=$2 && shift 2 ;;
    --output_raw) raw=yes && shift ;;
    --output_file) file=$2 && shift 2 ;;
    *) echo "piper: unknown $1" >&2 && exit 1 ;;
    esac
done
[ "$model" = it_IT-paola-medium.onnx ] || { echo "piper: no model" >&2; exit 1; }
echo "[info] Loaded voice" >&2
rate=$(awk "BEGIN { print int(170 / $scale) }")
while IFS= read -r line || [ -n "$line" ]; do
    if [ "$raw" ]; then
        printf %s "$line" | espeak-ng -v it+f2 -s "$rate" --stdout | tail -c +45
    else
        printf %s "$line" | espeak-ng -v it+f2 -s "$rate" -w "$file"
    fi
done
`;
const withPiper = () => {
  fs.writeFileSync(path.join(folder, 'piper'), piper, { mode: 0o755 });
  return { PATH: `${folder}:${process.env.PATH}` };
};

test('Piper: reads samples from standard output', () => {
  const env = { ...configured(exampleOf('piper')), ...withPiper() };
  const spoken = speaks(env, 'it', 'piper', italian);
  assert.equal(spoken.rate, 22050);
  assert.deepEqual(words(spoken), said(italian));
  const slow = speaks(env, 'it', 'piper', italian, '--rate', '100');
  assert.ok(slow.json.duration > 1.4 * spoken.json.duration, `${slow.json.duration} s`);
  closes(env, 'it', 'piper', italian);
});

test('Piper: reads a file', () => {
  const example = JSON.parse(exampleOf('piper'));
  const [{ raw: _, ...voice }] = example.command.voices;
  voice.argv = [...voice.argv.filter((word) => word !== '--output_raw'), '--output_file', '{output}'];
  const env = { ...configured(JSON.stringify({ command: { voices: [{ ...voice, sound: 'file' }] } })), ...withPiper() };
  assert.deepEqual(words(speaks(env, 'it', 'piper', italian)), said(italian));
});

const wyoming = async (change = (text) => text) => {
  const port = await serve('wyoming');
  return configured(change(exampleOf('wyoming').replace('"10200"', `"${port}"`)));
};

test('speaks through a Wyoming server', async () => {
  const env = await wyoming();
  const spoken = speaks(env, 'it', 'wyoming', italian);
  assert.equal(spoken.rate, 22050);
  assert.deepEqual(words(spoken), said(italian));
  // the output is exactly the server's sound
  const { stdout } = spawnSync('espeak-ng', ['-v', 'it', '--stdout', '--', 'La mamma.']);
  const { pcm } = speaks(env, 'it', 'wyoming', 'La mamma.');
  assert.deepEqual(pcm, new Int16Array(stdout.buffer.slice(stdout.byteOffset + 44, stdout.byteOffset + stdout.length)));
  closes(env, 'it', 'wyoming', italian);
});

for (const [name, change, message] of [
  ['without the voice', (text) => text.replace('paola-medium', 'nobody'), /exited with status 1: there is no voice it_IT-nobody/],
  ['that hangs up', (text) => text.replace('"--voice"', '"--speaker", "hangs-up", "--voice"'), /exited with status 1: the server hung up/],
  ['that sends too much', (text) => text.replace('"--voice"', '"--speaker", "huge", "--voice"'), /an event of 99999999999 bytes/],
  ['that is none', (text) => text.replace('"--voice"', '"--speaker", "babble", "--voice"'), /JSONDecodeError/],
  ['that is not there', (text) => text.replace(/"localhost", "\d+"/, '"localhost", "1"'), /Connection refused/],
])
  test(`reports a Wyoming server ${name}`, async () => {
    const { status, stderr } = say(['-l', 'it', '-v', 'command:wyoming'], 'Ciao.', await wyoming(change));
    assert.equal(status, 1);
    assert.match(stderr, message);
  });

test('discards times that run past the sound', () => {
  const voice = { id: 'x', lang: 'it', argv: ['espeak-ng', '-v', 'it', '--stdout', '--', '{text}'], times: { format: 'lab', argv: ['printf', '#\\n9 125 p\\n19 125 a\\n'] } };
  const spoken = say(['-l', 'it', '-v', 'command:x'], italian, configured(JSON.stringify({ command: { voices: [voice] } })));
  assert.equal(spoken.status, 0, spoken.stderr);
  assert.match(spoken.stderr, /times run past its sound/);
  checkOrder(spoken);
  assert.deepEqual(words(spoken), said(italian));
});

test('moves the lips in short sentences', () => {
  const list = austen.replace(/[^\p{L} ]/gu, '').split(/\s+/).filter(Boolean);
  const text = Array.from({ length: 20 }, (_, i) => `${list.slice(4 * i, 4 * i + 4).join(' ')}.`).join('\n\n');
  const { json } = speaks(configured(exampleOf('flite')), 'en', 'flite', text);
  assert.ok(json.words.length > 70, `${json.words.length} of 80 words`); // espeak-ng reports some pairs as one word, such as "of a"
  for (const phone of json.phones) assert.ok(phone.ipa || phone.end - phone.start < 1, `the mouth is closed at ${phone.start}`);
});

test('leaves the mouth closed when the sound is far too short for its text', () => {
  const voice = { id: 'x', lang: 'it', raw: 16000, argv: ['printf', '%1000s%.0s', '', '{text}'] };
  const spoken = say(['-l', 'it', '-v', 'command:x'], italian, configured(JSON.stringify({ command: { voices: [voice] } })));
  assert.equal(spoken.status, 0, spoken.stderr);
  assert.match(spoken.stderr, /the mouth stays closed: the recording ends before the text/);
  assert.equal(phones(spoken).replace(/[_ ]/g, ''), '');
});

// Makes the text ASCII without quotation marks, so that text2wave finds the same sentences.
const plain = (text) => text.normalize('NFD').replace(/[\p{M}"]/gu, '').replace(/Mrs?\./g, 'Mister').replace(/[;:.] *(\w)/g, (_, first) => `. ${first.toUpperCase()}`);

for (const [voice, lang, gender, text] of cases([['lp', 'it', 'female', manzoni]], [['pc', 'it', 'male', manzoni], ['kal', 'en', 'male', austen]]))
  test(`alignment finds the phones of Festival's ${voice} at their reported times`, () => {
    const names = JSON.parse(fs.readFileSync(path.join(root, 'server/plugins/festival/festival.json'))).languages[lang].phones;
    const unknown = { id: 'unknown', lang, gender, feed: true, argv: ['text2wave', '-eval', `(voice_${voice}_diphone)`] };
    const told = { ...unknown, id: 'told', times: { format: 'lab', names },
      argv: [...unknown.argv, '-eval', '(set! after_synth_hooks (list (lambda (utt) (utt.save.segs utt "{times}"))))'] };
    const env = configured(JSON.stringify({ command: { voices: [unknown, told] } }));
    const [known, found] = ['told', 'unknown'].map((id) => say(['-l', lang, '-v', `command:${id}`], plain(text), env, ordinary)); // ordinary build: takes a minute with the sanitizers
    for (const { status, stderr } of [known, found]) assert.deepEqual([status, stderr], [0, '']);
    const e = errors(known.json.phones, found.json.phones);
    if (process.env.FACCIA_SHOW) console.log(voice, e);
    assert.ok(e.pairs > 0.7 * e.phones && e.median <= 20 && e.within50 >= 0.9, JSON.stringify(e));
  });
