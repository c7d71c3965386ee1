// SPDX-License-Identifier: GPL-3.0-or-later
// The command line: files, standard streams, exit codes, messages.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { build, root } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const say = (args, input) => faccia(['say', ...args], { input });

test('writes consistent sound, face and timing', () => {
  const names = { wav: file('a.wav'), fap: file('a.fap'), json: file('a.json') };
  const { status, stderr } = say(['--lang', 'it', '--fps', '30', '--wav', names.wav, '--fap', names.fap, '--json', names.json, 'La mamma', 'parla piano. Ciao!']);
  assert.equal(status, 0, stderr);
  assert.equal(stderr, '');
  const json = JSON.parse(fs.readFileSync(names.json));
  const wav = fs.readFileSync(names.wav);
  assert.equal(wav.readUInt32LE(40), wav.length - 44, 'the true length stands in the header');
  assert.equal(wav.readUInt32LE(4), wav.length - 8);
  assert.ok(Math.abs((wav.length - 44) / 2 / json.rate - json.duration) < 1e-4);
  const lines = fs.readFileSync(names.fap, 'utf8').trim().split('\n');
  const count = Number(lines[0].split(' ').at(-1));
  assert.equal(count, Math.ceil(json.duration * 30 - 1e-6));
  assert.equal(lines.length, 1 + 2 * count);
  assert.equal(json.fps, 30);
  for (const phone of json.phones) {
    assert.ok(phone.end > phone.start);
    assert.equal(typeof phone.ipa, 'string');
    assert.equal(typeof phone.sampa, 'string');
  }
  assert.deepEqual(json.words.map((w) => w.text), ['La', 'mamma', 'parla', 'piano', 'Ciao']);
});

test('reads settings from a file, the environment and options, as the daemon does', () => {
  const config = path.join(folder, 'settings.json');
  const broken = path.join(folder, 'broken.json');
  fs.writeFileSync(config, JSON.stringify({ listen: { port: -5 }, speech: { lang: 'tr' }, voices: { sandbox: 'off' } }));
  fs.writeFileSync(broken, '{');
  const langOf = (args, env = {}) => JSON.parse(faccia([...args, 'say', '--json', '-', 'Merhaba.'], { env }).stdout).lang;
  assert.equal(langOf(['--config', config]), 'tr', 'what concerns the daemon alone is passed over');
  assert.equal(langOf([], { FACCIA_CONFIG: config, FACCIA_LANG: 'en' }), 'en');
  assert.equal(langOf(['--lang', 'pt-BR'], { FACCIA_LANG: 'en' }), 'pt-BR');
  assert.equal(faccia(['voices'], { env: { FACCIA_PORT: 'x' } }).status, 0);
  for (const [args, why] of [
    [['--sandbox', 'maybe', 'voices'], /--sandbox: 'maybe' is not one of on\|off \(bad-field\)/],
    [['--config', broken, 'voices'], /--config: .*broken.json:1:1: .*\(bad-settings\)/],
    [['--port', '1', 'voices'], /try 'faccia --help' \(bad-option\)/],
  ]) {
    const { status, stderr } = faccia(args);
    assert.equal(status, 2, stderr);
    assert.match(stderr, why);
  }
  const nowhere = faccia(['--models', '/nowhere', 'voices']);
  assert.equal(nowhere.status, 1);
  assert.match(nowhere.stderr, /no language pack in '\/nowhere\/speech' \(bad-speech-pack\)/);
});

test('takes the limits of voices from the environment', () => {
  const { status, stderr } = faccia(['say', 'Ciao.'], { env: { FACCIA_DEADLINE_BASE: 'soon' } });
  assert.equal(status, 2);
  assert.match(stderr, /FACCIA_DEADLINE_BASE: 'soon' is not a number from 0.1 to 3600/);
  const small = faccia(['say', 'Ciao.'], { env: { FACCIA_DEADLINE_BASE: '20', FACCIA_WORKER_MEMORY: '50' } });
  assert.match(small.stderr, /FACCIA_WORKER_MEMORY: '50' is not a whole number from 64 to 1048576/);
  assert.equal(faccia(['say', 'Ciao.'], { env: { FACCIA_DEADLINE_BASE: '20', FACCIA_WORKER_PROCESSOR: '' } }).status, 0);
});

test('reads and writes standard streams', () => {
  const { status, bytes } = say(['--wav', '-', '-'], 'Ciao.');
  assert.equal(status, 0);
  assert.equal(bytes.toString('latin1', 0, 4), 'RIFF');
  assert.ok(JSON.parse(say(['Ciao.']).stdout).phones.length > 3, 'without outputs the timing is printed');
  fs.writeFileSync(file('text'), 'Buongiorno.');
  assert.match(say(['--file', file('text'), '--fap', '-']).stdout, /^2\.1 /);
});

for (const [lang, text] of [['it', 'Buongiorno.'], ['pt-BR', 'Bom dia, coração.'], ['tr', 'Günaydın, nasılsınız?'], ['en', 'Good morning, how are you?']])
  test(`speaks ${lang} without a warning`, () => {
    const { status, stdout, stderr } = say(['--lang', lang, text]);
    assert.equal(status, 0, stderr);
    const json = JSON.parse(stdout);
    assert.equal(json.lang, lang);
    assert.deepEqual(json.warnings, []);
  });

test('selects a voice by its id, in another language', () => {
  const json = JSON.parse(say(['--voice', 'espeak:en-gb', 'Hello.']).stdout);
  assert.equal(json.voice, 'espeak:en-gb');
  assert.equal(json.lang, 'en');
});

test('applies rate and fps', () => {
  const duration = (args) => JSON.parse(say([...args, 'Una frase come tante altre, né lunga né corta.']).stdout).duration;
  assert.ok(duration(['--rate', '100']) > 1.5 * duration(['--rate', '250']));
});

test('reads markup, prints its warnings, and applies the blend', () => {
  const { stdout, stderr, status } = say(['--lang', 'it', '--life', '0.5', '--blend', 'weighted', '<speak>Uno\n <bark/><mark name="qui"/>due.</speak>']);
  assert.equal(status, 0);
  assert.match(stderr, /warning: 2:2: /);
  assert.deepEqual(JSON.parse(stdout).marks.map((mark) => mark.name), ['qui']);
  assert.deepEqual(JSON.parse(say(['--lang', 'it', '--markup', 'plain', 'Uno <mark name="qui"/>']).stdout).marks, []);
});

test('the help lists each option that protocol/messages.json declares, and completion offers their values', () => {
  const { members } = JSON.parse(fs.readFileSync(path.join(root, 'protocol/messages.json'))).client.speak;
  const { stdout } = say(['--help']);
  const options = Object.keys(members).filter((name) => members[name].option);
  assert.ok(options.length > 10);
  for (const name of options) assert.match(stdout, new RegExp(`^ +(-[a-z], )?--${name}\\b`, 'm'), name);
  const complete = (...line) => execFileSync('bash', ['-c', 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); compopt() { :; }; _faccia "$1"; echo "${COMPREPLY[*]}"',
    'bash', path.join(root, 'server/packaging/completion/faccia'), path.join(build, 'server/cli/faccia'), ...line], { encoding: 'utf8' }).trim().split(' ');
  assert.deepEqual(complete('say', '--contacts', ''), members.contacts.words);
  assert.deepEqual(complete('say', '--markup', 's'), ['ssml']);
  const offered = complete('say', '--');
  for (const name of options) assert.ok(offered.includes(`--${name}`), name);
});

const wrong = [
  [[], 2, /no text/],
  [['--lang', 'xx', 'a'], 2, /lang: no language 'xx'/],
  [['--voice', 'nobody', 'a'], 2, /voice/],
  [['--engine', 'steam', 'a'], 2, /engine/],
  [['--lang', 'it', '--engine', 'context', 'a'], 2, /engine: .*'context' does not speak 'it'/],
  [['--fps', '0', 'a'], 2, /--fps: must be a number/],
  [['--rate', 'fast', 'a'], 2, /--rate/],
  [['--life', '3', 'a'], 2, /--life: must be a number from 0 to 2/],
  [['--blend', 'some', 'a'], 2, /--blend: must be one of auto, regions, weighted/],
  [['--markup', 'xyz', 'a'], 2, /markup: no markup 'xyz'/],
  [['--markup', 'ssml', '<speak>\n<p>a</speak>'], 1, /2:\d+: /],
  [['--nothing'], 2, /Try 'faccia say --help'/],
  [['--wav', '-', '--fap', '-', 'a'], 2, /only one/],
  [['--file', '/nowhere/text', 'a'], 2, /unexpected 'a'/],
  [['--file', '/nowhere/text'], 1, /\/nowhere\/text: No such file/],
  [['--wav', '/nowhere/a.wav', 'a'], 1, /\/nowhere\/a\.wav: No such file/],
  [['--wav', '/dev/full', 'a'], 1, /\/dev\/full: No space left/],
  [[' '], 1, /nothing to speak/],
];
for (const [args, code, message] of wrong)
  test(`say ${args.join(' ')}: exits with ${code}`, () => {
    const { status, stderr } = say(args, '');
    assert.match(stderr, message);
    assert.equal(status, code);
  });

test('reports invalid UTF-8 with its byte', () => {
  const { status, stderr } = say(['-'], Buffer.from([0x61, 0x62, 0xff]));
  assert.equal(status, 1);
  assert.match(stderr, /byte 2: the text is not UTF-8/);
});

test('turns a timed transcription into a face without a voice', () => {
  fs.writeFileSync(file('timed.txt'), "0: 680 ##\n1: 1048 nn\n2: 3464 'a~\n3: 5686 uu\n4: 89546 ##\n5: 95270\n");
  const { status, stdout } = faccia(['timed', file('timed.txt')]);
  assert.equal(status, 0);
  const lines = stdout.split('\n');
  assert.equal(lines[0], '2.1 faccia 30 90'); // 2.98 s
  assert.equal(lines.length, 1 + 2 * 90 + 1);
  fs.writeFileSync(file('wrong.txt'), '0: 680 ##\n1: 1048 qq\n2: 2000\n');
  const wrong = faccia(['timed', file('wrong.txt')]);
  assert.equal(wrong.status, 1);
  assert.match(wrong.stderr, /wrong\.txt:2:1: unknown symbol qq/);
});

test('prints commands, help and lists', () => {
  assert.equal(faccia([]).status, 2);
  assert.equal(faccia(['sing']).status, 2);
  for (const args of [['--help'], ['say', '--help'], ['voices', '--help'], ['models', '--help'], ['timed', '--help'], ['--version']]) {
    const { status, stdout } = faccia(args);
    assert.equal(status, 0);
    assert.ok(stdout.length > 5);
  }
  const voices = JSON.parse(faccia(['voices', '--json', '--lang', 'it']).stdout).voices;
  assert.ok(voices.some((v) => v.id === 'espeak:it') && voices.every((v) => v.lang.startsWith('it')));
  const models = JSON.parse(faccia(['models', '--json']).stdout).models;
  assert.ok(models.some((m) => m.name === 'mara' && m.bytes > 100000));
});
