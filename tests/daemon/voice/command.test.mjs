// SPDX-License-Identifier: GPL-3.0-or-later
// Programs as voices: real programs, failing ones, and invalid configurations.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, Daemon } from '../../lib/daemon.mjs';
import { checkOrder, loudest, phones, say, words } from '../../lib/speech.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));

const script = (name, text) => {
  fs.writeFileSync(path.join(folder, name), `#!/bin/sh\n${text}\n`, { mode: 0o755 });
  return path.join(folder, name);
};
let configs = 0;
const configure = (...voices) => {
  const file = path.join(folder, `config-${configs++}.json`);
  fs.writeFileSync(file, JSON.stringify({ command: { voices: voices.map((v) => ({ lang: 'it', ...v })) } }));
  return { FACCIA_VOICE_CONFIG: file };
};
const speak = (voice, text) => say(['-l', voice.lang ?? 'it', '-v', `command:${voice.id}`], text, configure(voice));
const speaks = (voice, text) => {
  const said = speak(voice, text);
  assert.equal(said.status, 0, said.stderr);
  assert.equal(said.stderr, '');
  checkOrder(said);
  return said;
};
const length = (said) => said.pcm.length / said.rate;

test('reads espeak-ng from standard output, at the requested rate', () => {
  const voice = { id: 'e', argv: ['espeak-ng', '-v', 'it', '-s', '{rate}', '--stdout', '--', '{text}'] };
  const said = speaks(voice, '-La mamma $(mamma x) parla; piano.');
  assert.equal(said.rate, 22050);
  assert.ok(loudest(said) > 5000);
  const slow = say(['-v', 'command:e', '--rate', '90'], 'La mamma parla piano.', configure(voice));
  const fast = say(['-v', 'command:e', '--rate', '250'], 'La mamma parla piano.', configure(voice));
  assert.ok(length(slow) > 1.7 * length(fast));
  // the output is exactly the program's sound
  const { stdout } = spawnSync('espeak-ng', ['-v', 'it', '-s', '170', '--stdout', '--', 'La mamma.']);
  const plain = speaks(voice, 'La mamma.');
  assert.deepEqual(plain.pcm.slice(0, 1000), new Int16Array(stdout.buffer.slice(stdout.byteOffset + 44, stdout.byteOffset + 44 + 2000)));
});

test('writes text2wave\'s text to its standard input', () => {
  const said = speaks({ id: 't', lang: 'en', feed: true, argv: ['text2wave', '-eval', '(voice_kal_diphone)'] }, 'Good morning.');
  assert.equal(said.rate, 16000);
  assert.ok(loudest(said) > 3000);
});

test('reads a file in any format, and raw samples', () => {
  const file = speaks({ id: 'f', sound: 'file', argv: ['espeak-ng', '-v', 'it', '-w', '{output}', '{text}'] }, 'Ciao, mamma.');
  assert.ok(length(file) > 0.5);
  const raw = script('raw', 'espeak-ng -v it --stdout "$1" | tail -c +45');
  const samples = speaks({ id: 'r', raw: 22050, argv: [raw, '{text}'] }, 'Ciao, mamma.');
  assert.deepEqual(samples.pcm, file.pcm);
});

const timed = (format, times, more = {}) => ({
  id: 'x', sound: 'file', ...more,
  argv: [script(`${format}-${configs++}`, `espeak-ng -v it -w "$1" "$3"; cat >"$2" <<'END'\n${times}\nEND`), '{output}', '{times}', '{text}'],
  times: { format, ...more.times },
});

test('reads phone times in all formats', () => {
  const names = { tS: 'tʃ', a1: 'a', o: 'o', pau: '' };
  const lab = speaks(timed('lab', 'signal x\nnfields 1\n#\n0.1 125 pau\n0.2 125 tS\n0.25 125 a1\n0.4 125 o', { times: { names } }), 'Ciao.');
  assert.equal(phones(lab), '_ tʃ a o _');
  assert.ok(Math.abs(lab.json.phones[1].start - 0.1) < 1e-3 && Math.abs(lab.json.phones[3].end - 0.4) < 1e-3);
  const htk = speaks(timed('htk', '0 1000000 sil\n1000000 2000000 tʃ\n2000000 4000000 a'), 'Ciao.');
  assert.equal(phones(htk), '_ tʃ a _');
  const intervals = [[0, 0.1, ''], [0.1, 0.2, 'tʃ'], [0.2, 0.4, 'a']];
  const tiers = [['words', [[0, 0.4, 'ciao "ciao"']]], ['phones', intervals]];
  const long = `File type = "ooTextFile"\nObject class = "TextGrid"\n\nxmin = 0\nxmax = 0.4\ntiers? <exists>\nsize = 2\nitem []:\n` +
    tiers.map(([name, list], i) => `    item [${i + 1}]:\n        class = "IntervalTier"\n        name = "${name}"\n        xmin = 0\n        xmax = 0.4\n        intervals: size = ${list.length}\n` +
      list.map(([a, b, text], k) => `        intervals [${k + 1}]:\n            xmin = ${a}\n            xmax = ${b}\n            text = "${text.replaceAll('"', '""')}"\n`).join('')).join('');
  const short = `File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n0.4\n<exists>\n2\n` +
    tiers.map(([name, list]) => `"IntervalTier"\n"${name}"\n0\n0.4\n${list.length}\n` + list.map(([a, b, text]) => `${a}\n${b}\n"${text.replaceAll('"', '""')}"\n`).join('')).join('');
  for (const grid of [long, short])
    assert.equal(phones(speaks(timed('textgrid', grid, { times: { tier: 'phones' } }), 'Ciao.')), '_ tʃ a _');
  const json = { phones: [{ ipa: 'tʃ', start: 0, end: 0.1 }, { ipa: 'a', start: 0.1, end: 0.2, stress: 2 }, { ipa: 'o', start: 0.2, end: 0.3 }], words: [{ text: 'Ciao', start: 0, end: 0.3 }] };
  const own = speaks(timed('json', JSON.stringify(json)), 'Ciao.');
  assert.equal(phones(own), 'tʃ a o _');
  assert.deepEqual(words(own), ['Ciao']);
  assert.equal(own.json.phones[1].stress, 2);
});

test('reads times from a second program, and names that the table lacks', () => {
  const voice = { id: 'd', sound: 'stdout', argv: ['espeak-ng', '-v', 'it', '--stdout', '{text}'],
    times: { format: 'lab', argv: ['printf', '#\\n0.2 125 a\\n0.4 125 Q\\n'], names: { a: 'a' } } };
  const said = speak(voice, 'Ciao.');
  assert.match(said.stderr, /no IPA for the phone "Q"/);
  assert.equal(said.json.phones[0].ipa, 'a');
});

const faults = [
  ['a program that is not there', { argv: ['/nowhere/at-all', '{text}'] }, /"\/nowhere\/at-all" cannot be started: No such file/],
  ['a program that fails', { argv: [script('fails', 'echo first >&2; echo "no voice today" >&2; exit 3'), '{text}'] }, /exited with status 3: no voice today/],
  ['a program that says why bit by bit', { argv: [script('halves', 'printf "first\\nno voi" >&2; sleep 0.1; printf "ce today" >&2; exit 3'), '{text}'] }, /exited with status 3: no voice today\n/],
  ['a program that is killed', { argv: [script('dies', 'kill -9 $$'), '{text}'] }, /was killed by signal 9/],
  ['a program that writes no sound', { argv: ['echo', '{text}'] }, /wrote no sound \(\d+ bytes\)/],
  ['a program that writes nothing', { argv: ['true', '{text}'] }, /wrote no sound/],
  ['a program that writes no file', { sound: 'file', argv: ['true', '{text}', '{output}'] }, /did not write its file/],
  ['a program that never ends', { seconds: 0.5, argv: [script('sleeps', 'sleep 1000'), '{text}'] }, /took too long/],
  ['a program that writes without end', { bytes: 100000, argv: ['yes', '{text}'] }, /wrote too much/],
  ['times that are none', timed('lab', 'nothing to see'), /the times, line 1/],
];
for (const [name, voice, message] of faults)
  test(`${name} costs its sentence, with the reason`, () => {
    const { status, stderr } = speak({ id: 'x', ...voice }, 'Ciao.');
    assert.equal(status, 1);
    assert.match(stderr, message);
  });

const mistakes = [
  [{ command: { voices: 3 } }, /voices: must be a list/],
  [{ command: { voice: [] } }, /voice: unknown setting/],
  [{ command: { voices: [{ lang: 'it', argv: ['a', '{text}'] }] } }, /voices\[0\]\.id: must be a string/],
  [{ command: { voices: [{ id: 'a', lang: 'it', argv: 'sh -c x' }] } }, /voices\[0\]\.argv: must be a list of strings/],
  [{ command: { voices: [{ id: 'a', lang: 'it', argv: ['a', 1] }] } }, /voices\[0\]\.argv: must be a list of strings/],
  [{ command: { voices: [{ id: 'a', lang: 'it', argv: ['a'] }] } }, /voices\[0\]\.argv: the program is not given the text/],
  [{ command: { voices: [{ id: 'a', lang: 'it', argv: ['a', '{text}'], sound: 'file' }] } }, /voices\[0\]\.argv: .*\{output\}/],
  [{ command: { voices: [{ id: 'a', lang: 'it', argv: ['a', '{text}'], raw: 5 }] } }, /voices\[0\]\.raw: must be a number from 8000 to 192000/],
  [{ command: { voices: [{ id: 'a', lang: 'it', argv: ['a', '{text}'], times: { format: 'x' } }] } }, /voices\[0\]\.times\.format: must be/],
  [{ command: { voices: [{ id: 'a', lang: 'it', argv: ['a', '{text}'], shell: true }] } }, /voices\[0\]\.shell: unknown setting/],
  [{ command: { voices: [{ id: 'a', lang: 'it', argv: ['a', '{text}'] }, { id: 'a', lang: 'it', argv: ['a', '{text}'] }] } }, /voices\[1\]\.id: another voice has it/],
];
for (const [config, message] of mistakes)
  test(`names a mistake in the configuration: ${message.source}`, () => {
    const file = path.join(folder, 'mistake.json');
    fs.writeFileSync(file, JSON.stringify(config));
    const { status, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['voices', '-l', 'it'], { env: { ...process.env, FACCIA_VOICE_CONFIG: file } });
    assert.match(String(stderr), message);
    assert.equal(status, 0, 'the other voices are there');
  });

for (const [text, message] of [['{', /bad\.json/], ['[]', /an object/], ['{"espeak": 1}', /espeak: .*an object/], [null, /bad\.json/]])
  test(`a configuration file that holds ${text} stops the start`, () => {
    const file = path.join(folder, 'bad.json');
    fs.rmSync(file, { force: true });
    if (text !== null) fs.writeFileSync(file, text);
    for (const [program, ...args] of [['daemon/facciad', '--port', '0', '--voice-config', file], ['cli/faccia', 'voices']]) {
      const { status, stderr } = spawnSync(path.join(build, 'server', program), args, { timeout: 20000, env: { ...process.env, FACCIA_VOICE_CONFIG: file } });
      assert.match(String(stderr), message);
      assert.ok(status > 0);
    }
  });

test('a stop ends the program and its children', async (t) => {
  const pids = path.join(folder, 'pids');
  const waits = script('waits', `sleep 1000 & echo $! $$ >${pids}; wait`);
  const daemon = await Daemon.start(['--voice-config', configure({ id: 'w', argv: [waits, '{text}'] }).FACCIA_VOICE_CONFIG]);
  t.after(() => daemon.process.kill('SIGKILL')); // in case an assertion fails
  const stream = await daemon.stream();
  stream.send({ type: 'speak', lang: 'it', voice: 'command:w', id: 'w', text: 'Ciao.' });
  const written = Date.now() + 20000;
  while ((!fs.existsSync(pids) || !fs.readFileSync(pids, 'utf8').includes('\n')) && Date.now() < written) await new Promise((resolve) => setTimeout(resolve, 10));
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'w', reason: 'stopped' });
  const runs = (pid) => {
    try {
      return !/^State:\s+Z/m.test(fs.readFileSync(`/proc/${pid}/status`, 'latin1'));
    } catch {
      return false;
    }
  };
  const deadline = Date.now() + 10000;
  const alive = () => fs.readFileSync(pids, 'utf8').trim().split(' ').filter(runs);
  while (alive().length && Date.now() < deadline) await new Promise((resolve) => setTimeout(resolve, 10));
  assert.deepEqual(alive(), []);
  await stream.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});
