// SPDX-License-Identifier: GPL-3.0-or-later
// `meson install`: where files go, and that they run from there, staged and moved, without the build tree; and an external voice plugin
// built with only the installed header.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, root } from '../../lib/daemon.mjs';

// Only the ordinary build has heads and pages; it contains the models folder.
const ordinary = process.env.FACCIA_MODELS ? path.dirname(process.env.FACCIA_MODELS) : build;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-install-'));
after(() => fs.rmSync(folder, { recursive: true }));
const run = (program, args, options) => {
  const { status, stdout, stderr, error } = spawnSync(program, args, { encoding: 'utf8', maxBuffer: 1 << 28, ...options });
  assert.equal(status, 0, `${program} ${args.join(' ')}: ${error ?? stderr}`);
  return stdout;
};
// Variables of the test run, which users do not set.
const { FACCIA_MODELS, FACCIA_WEB, FACCIA_BUILD, FACCIA_ARTEFACTS, ...plain } = process.env;
const clean = { FACCIA_MODELS: undefined, FACCIA_WEB: undefined, FACCIA_BUILD: undefined, FACCIA_ARTEFACTS: undefined };
const options = Object.fromEntries(JSON.parse(run('meson', ['introspect', ordinary, '--buildoptions'])).map(({ name, value }) => [name, value]));
const stage = path.join(folder, 'stage'), installed = path.join(stage, options.prefix);
const within = (option, ...rest) => path.join(installed, options[option], ...rest);

before(() => run('meson', ['install', '-C', ordinary, '--destdir', stage, '--no-rebuild', '--quiet']));

test('installs files where Debian expects them', () => {
  const files = [
    ...['facciad', 'faccia'].map((name) => within('bindir', name)),
    ...['faccia-align', 'faccia-reader', 'faccia-recogniser', 'faccia-voice', 'plugins/espeak.so', 'plugins/command.so', 'plugins/festival.json', 'plugins/wyoming.py'].map((name) => within('libdir', 'faccia', name)),
    ...['boundaries.json', 'expressions.json', 'speech/it.json', 'speech/alphabets/ipa.json', 'speech/letters/tr.json', 'speech/visemes/pt.json', 'normalization/it.json', 'heads/mara.json', 'heads/mara.json.gz', 'heads/mara.glb', 'hear/network.bin', 'stimuli/page.html']
      .map((name) => within('datadir', 'faccia/models', name)),
    ...['index.html', 'speak.js', 'talking-head.js', 'talking-head-worklet.js', 'opus-decoder.js', 'faps.json', 'docs/index.html', 'docs/start/page.html.gz'].map((name) => within('datadir', 'faccia/web', name)),
    within('includedir', 'faccia-voice.h'),
    within('libdir', 'pkgconfig/faccia-voice.pc'),
    within('datadir', 'doc/faccia/README.md'),
    ...['facciad.service', 'facciad.socket'].map((name) => path.join(installed, 'lib/systemd/system', name)),
  ];
  for (const file of files) assert.ok(fs.statSync(file, { throwIfNoEntry: false })?.size, file);
  assert.match(fs.readFileSync(path.join(installed, 'lib/systemd/system/facciad.service'), 'utf8'), new RegExp(`^ExecStart=${path.join(options.prefix, options.bindir)}/facciad$`, 'm'));
  // files built for tests must not be installed
  const all = fs.readdirSync(installed, { recursive: true, encoding: 'utf8' });
  assert.deepEqual(all.filter((name) => /\.(a|c\.o|h)$/.test(name)), [path.join(options.includedir, 'faccia-voice.h')]);
  assert.deepEqual(all.filter((name) => name.endsWith('.so')).map((name) => path.basename(name, '.so')).filter((name) => !['command', 'espeak', 'festival', 'kokoro', 'libonnxruntime', 'recording'].includes(name)), []);
});

/** Speaks with the installation below the folder, and checks which files it opens. */
async function lives(prefix) {
  const trace = path.join(folder, 'trace');
  const env = { ...clean, STRACE: trace, PROGRAM: path.join(prefix, options.bindir, 'facciad') };
  const program = path.join(folder, 'traced.sh');
  fs.writeFileSync(program, '#!/bin/sh\ncd / && exec strace -f -qq -z --seccomp-bpf -e trace=open,openat,execve,readlink -e signal=none -o "$STRACE" -- "$PROGRAM" "$@"\n', { mode: 0o755 });
  const daemon = await Daemon.start(['--cache-file', path.join(folder, 'cache')], env, { program });
  try {
    const health = await (await daemon.get('/healthz')).json();
    assert.equal(health.status, 'ok');
    assert.match(await (await daemon.get('/')).text(), /<talking-head/);
    assert.match(await (await daemon.get('/talking-head.js')).text(), /faccia, MIT/);
    const { models } = await (await daemon.get('/v1/models')).json();
    assert.deepEqual(models.map(({ name }) => name), ['mara', 'bruno', 'rosa', 'ettore', 'amina', 'samuel', 'mei', 'luca', 'celia', 'kemal']);
    const head = await daemon.get('/v1/models/mara');
    assert.equal(head.status, 200);
    assert.equal((await head.json()).format, 'faccia-head');
    const sound = await daemon.get('/v1/speech?text=La+mamma+parla.&lang=it');
    assert.equal(sound.status, 200);
    const pcm = new Int16Array((await sound.arrayBuffer()).slice(44));
    assert.ok(pcm.length > 10000 && pcm.some((sample) => Math.abs(sample) > 3000));
    const fap = await (await daemon.get('/v1/speech?text=Papa.&lang=tr&format=fap')).text();
    assert.ok(fap.split('\n').length > 20);
  } finally {
    // strace ends with the traced process
    const pid = Number(fs.readFileSync(trace, 'utf8').match(/^\d+/)[0]);
    process.kill(pid, 'SIGTERM');
    await daemon.exited;
  }
  const opened = [...fs.readFileSync(trace, 'utf8').matchAll(/"([^"]*)"/g)].map(([, file]) => file);
  assert.ok(opened.some((file) => file.startsWith(prefix)), 'the trace has nothing');
  assert.deepEqual([...new Set(opened.filter((file) => file.startsWith(`${root}/`) || file.startsWith(`${path.resolve(ordinary)}/`)))], []);
}

test('the staged tree serves its page and its head, and speaks, without the build tree', () => lives(installed));

test('a moved tree and its faccia work too', async () => {
  const moved = path.join(folder, 'somewhere else');
  fs.cpSync(installed, moved, { recursive: true });
  await lives(moved);
  const faccia = (...args) => run(path.join(moved, options.bindir, 'faccia'), args, { env: plain, cwd: folder });
  const json = JSON.parse(faccia('say', '--lang', 'it', '--wav', path.join(folder, 'say.wav'), '--json', '-', 'La mamma parla piano.'));
  assert.match(json.voice, /^espeak:it/);
  assert.ok(json.phones.length > 12);
  assert.match(faccia('voices', '--lang', 'it'), /espeak:it/);
  assert.match(faccia('models'), /mara/);
  // alignment also uses a voice worker
  const aligned = JSON.parse(faccia('align', path.join(folder, 'say.wav'), '--text', write('say.txt', 'La mamma parla piano.'), '--quiet'));
  assert.deepEqual(aligned.words.map(({ text }) => text), ['La', 'mamma', 'parla', 'piano']);
});

const kokoro = fs.existsSync(path.join(ordinary, 'server/plugins/kokoro.so'));
test('finds the weights of Kokoro next to it', { skip: kokoro ? false : 'Kokoro is not installed: sh server/run.sh --with kokoro' }, async () => {
  const beside = within('libdir', 'faccia/plugins/kokoro');
  assert.ok(fs.existsSync(path.join(beside, '.faccia-lock')));
  assert.ok(!fs.existsSync(path.join(beside, 'expo-sherpa-onnx')), 'headers are for the build');
  const said = run(within('bindir', 'faccia'), ['say', '-l', 'it', '-v', 'kokoro:if_sara', '--json', '-', 'Ciao.'], { env: plain, cwd: folder });
  assert.ok(JSON.parse(said).phones.length > 3);
});

const write = (name, text) => {
  fs.writeFileSync(path.join(folder, name), text);
  return path.join(folder, name);
};
const pkgConfig = (...args) => run('pkg-config', [`--define-variable=prefix=${installed}`, ...args, 'faccia-voice'], { env: { ...plain, PKG_CONFIG_PATH: within('libdir', 'pkgconfig') } }).trim();
const cflags = () => pkgConfig('--cflags').split(' ').filter(Boolean);

test('the header compiles alone, in C11 and in C++17', () => {
  const header = fs.readFileSync(within('includedir', 'faccia-voice.h'), 'utf8');
  assert.match(header, /^\/\* SPDX-License-Identifier: MIT \*\//);
  assert.deepEqual([...header.matchAll(/^#include (.*)$/gm)].map(([, name]) => name), ['<stddef.h>', '<stdint.h>']);
  const source = '#include <faccia-voice.h>\nFACCIA_VOICE_READS("/opt/a\\0/opt/b");\nconst struct faccia_voice faccia_voice = {FACCIA_VOICE_ABI, sizeof(struct faccia_voice), "x", "1", "MIT", 0, 0, 0, 0, 0, 0};\n';
  for (const [compiler, standard, file] of [['cc', 'c11', 'alone.c'], ['c++', 'c++17', 'alone.cc']]) {
    const object = path.join(folder, `${file}.so`);
    run(compiler, [`-std=${standard}`, '-pedantic-errors', '-Wall', '-Wextra', '-Werror', '-fPIC', '-shared', '-fvisibility=hidden', ...cflags(), write(file, source), '-o', object]);
    assert.deepEqual(run('nm', ['-D', '--defined-only', '--format=just-symbols', object]).trim().split('\n').sort(), ['faccia_voice', 'faccia_voice_reads'], standard);
  }
});

test('a voice built outside of the tree with only the installed header speaks', async () => {
  const example = path.join(folder, 'example.c');
  fs.copyFileSync(within('datadir', 'doc/faccia/plugins/example.c'), example);
  const plugins = pkgConfig('--variable=plugindir');
  assert.equal(plugins, within('libdir', 'faccia/plugins'));
  run('cc', ['-std=c11', '-Wall', '-Wextra', '-Werror', '-shared', '-fPIC', '-fvisibility=hidden', ...cflags(), example, '-o', path.join(plugins, 'example.so'), '-lm'], { cwd: folder });
  const daemon = await Daemon.start([], clean, { program: within('bindir', 'facciad') });
  const { voices } = await (await daemon.get('/v1/voices')).json();
  assert.equal(voices.find(({ id }) => id === 'example:hum').licence, 'MIT');
  const stream = await daemon.stream('?voice=example:hum');
  stream.send({ type: 'speak', text: 'Uno due tre.', phones: true });
  await stream.wait({ type: 'end' });
  assert.deepEqual(stream.messages.filter((m) => m.type === 'word').map((m) => m.text), ['Uno', 'due', 'tre.']);
  assert.equal(stream.messages.filter((m) => m.type === 'phone' && m.ipa === 'a').length, 3);
  assert.ok(stream.chunks.length > 0);
  await stream.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('rejects a voice of a newer interface, naming both versions', () => {
  const newer = path.join(folder, 'newer');
  fs.mkdirSync(newer);
  const source = '#include <faccia-voice.h>\nconst struct faccia_voice faccia_voice = {FACCIA_VOICE_ABI + 1, sizeof(struct faccia_voice) + 8, "x", "1", "MIT", 0, 0, 0, 0, 0, 0};\n';
  run('cc', ['-shared', '-fPIC', ...cflags(), write('newer.c', source), '-o', path.join(newer, 'newer.so')]);
  const { status, stderr } = spawnSync(within('bindir', 'faccia'), ['voices'], { encoding: 'utf8', env: { ...plain, FACCIA_PLUGINS: newer } });
  assert.notEqual(status, 0);
  const version = Number(fs.readFileSync(within('includedir', 'faccia-voice.h'), 'utf8').match(/#define FACCIA_VOICE_ABI (\d+)/)[1]);
  assert.match(stderr, new RegExp(`version ${version + 1} of the voice interface; this program has version ${version}`));
});
