// SPDX-License-Identifier: GPL-3.0-or-later
// sd_faccia as a speech-dispatcher module: its protocol line by line, and the real speech-dispatcher with spd-say.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const program = path.join(build, 'server/bridges/sd_faccia');
const config = path.join(folder, 'modules/faccia.conf');
const running = new Set();
let daemon;

function start(file, options, env = {}) {
  const child = spawn(file, options, { env: { ...process.env, ...env } });
  running.add(child);
  child.log = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (child.log += text));
  child.stdin.on('error', () => {});
  child.exited = once(child, 'exit').then(([code]) => (running.delete(child), code));
  return child;
}

/** Starts a module with this test as its server: lines in, lines and sound out. */
function load(options = [config]) {
  const child = start(program, options);
  let bytes = Buffer.alloc(0);
  const module = { child, lines: [], sound: [], send: (...lines) => child.stdin.write(`${lines.join('\n')}\n`) };
  child.stdout.on('data', (data) => {
    bytes = Buffer.concat([bytes, data]);
    for (let end; (end = bytes.indexOf(10)) >= 0; bytes = bytes.subarray(end + 1)) {
      const line = bytes.subarray(0, end);
      if (line.subarray(0, 10).toString('latin1') === '705-AUDIO\0') {
        const plain = [];
        for (let i = 10; i < line.length; i++) plain.push(line[i] === 0x7d ? line[++i] ^ 0x20 : line[i]);
        module.sound.push(Buffer.from(plain));
      } else module.lines.push(line.toString());
    }
  });
  module.told = (line, from = 0) => eventually(() => module.lines.slice(from).includes(line), `${line}; ${module.lines.join(' | ')} ${child.log}`);
  module.speak = async (text, command = 'SPEAK') => {
    module.lines.length = module.sound.length = 0;
    module.send(command);
    await module.told('202 OK RECEIVING MESSAGE');
    module.send(...text.split('\n'), '.');
    await module.told('200 OK SPEAKING');
  };
  return module;
}

before(async () => {
  daemon = await Daemon.start();
  fs.mkdirSync(path.dirname(config));
  fs.writeFileSync(config, `# where the face is\nFacciaUrl "${daemon.url}"\nFacciaRoom "desk"\n`);
});
after(async () => {
  for (const child of running) child.kill('SIGTERM');
  await Promise.all([...running].map((child) => child.exited));
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

test('loads, is configured, lists its voices and quits', async () => {
  const module = load();
  module.send('INIT');
  await module.told('299 OK LOADED SUCCESSFULLY');
  module.send('AUDIO', 'audio_output_method=server', '.', 'LOGLEVEL', 'log_level=3', '.', 'SET', 'rate=20', 'pitch=-10', 'volume=100', 'language=it', 'voice=FEMALE1', 'synthesis_voice=espeak:it', 'punctuation_mode=none', '.');
  await module.told('203 OK SETTINGS RECEIVED');
  module.send('SET', 'rate=fast', '.');
  await module.told('303 ERROR INVALID PARAMETER OR VALUE');
  module.send('LIST VOICES');
  await module.told('200-espeak:it\tit\tnone');
  module.send('NONSENSE');
  await module.told('300 ERR UNKNOWN COMMAND');
  module.send('SPEAK', '.');
  await module.told('301 ERROR CANT SPEAK');
  module.send('CHAR', 'a', 'b', '.');
  await module.told('305 DATA MORE THAN ONE LINE');
  module.send('QUIT');
  await module.told('210 OK QUIT');
  assert.equal(await module.child.exited, 0, module.child.log);
});

test('without observers, sends the sound and its index marks to the server', async () => {
  const module = load();
  module.send('SET', 'synthesis_voice=espeak:it', '.');
  await module.speak('<speak>Prima frase. <mark name="__spd_1"/> Seconda\nfrase.</speak>');
  await module.told('702 END');
  const events = module.lines.filter((line) => /^70[0-4]/.test(line));
  assert.deepEqual(events, ['701 BEGIN', '700-__spd_1', '700 INDEX MARK', '702 END']);
  const wav = Buffer.from(await (await daemon.get('/v1/speech?voice=espeak:it', { method: 'POST', headers: { 'content-type': 'application/ssml+xml' }, body: '<speak>Prima frase. <mark name="__spd_1"/> Seconda\nfrase.</speak>' })).arrayBuffer());
  assert.ok(Buffer.concat(module.sound).equals(wav.subarray(44)), 'the same sound');
  const samples = module.lines.filter((line) => line.startsWith('705-num_samples=')).reduce((sum, line) => sum + Number(line.split('=')[1]), 0);
  assert.equal(samples * 2, wav.length - 44);
  // letters, keys and icons
  for (const [command, text] of [['CHAR', 'à'], ['CHAR', 'space'], ['KEY', 'control_a'], ['SOUND_ICON', 'bell'], ['SPEAK', 'a < b & c']]) {
    await module.speak(text, command);
    await module.told('702 END');
  }
  // a space is named in the language of the voice
  await module.speak('space', 'CHAR');
  await module.told('702 END');
  assert.ok(Buffer.concat(module.sound).length > 8000, 'spazio');
  module.send('SET', 'spelling_mode=on', '.');
  await module.speak('<speak>casa</speak>');
  await module.told('702 END');
  assert.ok(Buffer.concat(module.sound).length > 44100, 'four letters take a second and more');
  module.send('QUIT');
  assert.equal(await module.child.exited, 0, module.child.log);
});

test('messages that are cut short at once leave no work behind for the next', async () => {
  const module = load();
  const spoken = () => daemon.metric('faccia_sentences_asked_total');
  module.send('SET', 'synthesis_voice=espeak:it', '.');
  await module.speak('<speak>Zero.</speak>');
  await module.told('702 END');
  const before = await spoken();
  for (let i = 0; i < 60; i++) {
    module.lines.length = 0;
    module.send('SPEAK', `<speak>Numero ${i}, e ancora qualcosa.</speak>`, '.', 'STOP');
    await module.told('703 STOP');
  }
  await module.speak('<speak>E adesso basta, davvero.</speak>');
  await module.told('702 END');
  assert.ok(Buffer.concat(module.sound).length > 44100);
  assert.ok((await spoken()) - before < 20, `${(await spoken()) - before} sentences`);
  module.send('QUIT');
  assert.equal(await module.child.exited, 0, module.child.log);
});

test('a wrong language, voice or markup does not cause silence', async () => {
  const module = load();
  const spoken = async (text) => {
    await module.speak(text);
    await eventually(() => module.lines.some((line) => /^70[23]/.test(line)), 'the end');
    assert.ok(module.lines.includes('702 END'), `${text} ${module.lines} ${module.child.log}`);
    return Buffer.concat(module.sound);
  };
  const set = async (...settings) => {
    const from = module.lines.length;
    module.send('SET', ...settings, '.');
    await module.told('203 OK SETTINGS RECEIVED', from);
  };
  const usual = await spoken('<speak>Seven.</speak>');
  await set('language=en');
  const english = await spoken('<speak>Seven.</speak>');
  assert.ok(usual.length > 8000 && !usual.equals(english));
  for (const lang of ['en_US.UTF-8', 'en_GB@euro']) {
    await set(`language=${lang}`);
    assert.ok((await spoken('<speak>Seven.</speak>')).length > 8000, lang);
  }
  await set('language=en', 'synthesis_voice=nobody:x');
  assert.ok((await spoken('<speak>Seven.</speak>')).equals(english), 'its language at least');
  for (const lang of ['c', 'C', 'C.UTF-8', 'POSIX', 'xx', 'tlh-Latn', '!', 'x'.repeat(100)]) {
    await set(`language=${lang}`, `synthesis_voice=${'v'.repeat(200)}`);
    assert.ok((await spoken('<speak>Seven.</speak>')).equals(usual), lang);
  }
  await set('voice_type=female1', 'language=xx');
  assert.ok((await spoken('<speak>Seven.</speak>')).length > 8000);
  for (const text of ['<speak>Uno <b>due</speak>', '<speak>Uno & due < tre</speak>', '<speak><mark name="a">Uno</speak>', '<speak>\u0001 uno</speak>'])
    assert.ok((await spoken(text)).length > 8000, text.slice(0, 80));
  module.send('QUIT');
  assert.equal(await module.child.exited, 0, module.child.log);
});

test('the name of a mark cannot inject protocol lines', async () => {
  const module = load();
  const screen = await daemon.stream('?room=desk&lang=it');
  await screen.wait({ type: 'joined' });
  await eventually(async () => (await (await daemon.get('/v1/rooms')).json()).rooms.some((r) => r.name === 'desk' && r.followers === 2), 'the module in the room');
  module.send('SET', 'language=xx', '.');
  await module.told('203 OK SETTINGS RECEIVED');
  await module.speak('<speak>Seven.</speak>');
  await module.told('702 END'); // the room accepts the request and then fails it: the module plays only the sound
  assert.ok(Buffer.concat(module.sound).length > 8000);
  module.send('SET', 'language=it', '.');
  for (const looks of [true, false]) {
    if (!looks) {
      await screen.close();
      await eventually(async () => (await (await daemon.get('/v1/rooms')).json()).rooms.every((r) => r.name !== 'desk' || !r.listeners), 'nobody in the room');
    }
    await module.speak('<speak>Uno. <mark name="q&#10;702 END&#13;&#10;703 STOP"/> Due.</speak>');
    await module.told('702 END');
    const lines = module.lines.filter((line) => /^70[0-4]/.test(line));
    assert.deepEqual(lines.map((line) => line.replace(/^700-q .*/, '700-q')), ['701 BEGIN', '700-q', '700 INDEX MARK', '702 END'], `${looks}`);
    assert.ok(!module.lines.some((line) => line.includes('\r')));
  }
  module.send('QUIT');
  assert.equal(await module.child.exited, 0, module.child.log);
});

test('with an observer, the face reads; stop and pause act at once', async () => {
  const screen = await daemon.stream('?room=desk');
  await screen.wait({ type: 'joined' });
  const module = load();
  module.send('SET', 'synthesis_voice=espeak:it', 'rate=10', '.');
  await eventually(async () => (await (await daemon.get('/v1/rooms')).json()).rooms.some((r) => r.name === 'desk' && r.followers === 2), 'the module in the room');
  await module.speak('<speak>Prima. <mark name="__spd_1"/> Poi.</speak>');
  await module.told('702 END');
  assert.deepEqual(module.lines.filter((line) => /^70/.test(line)), ['701 BEGIN', '700-__spd_1', '700 INDEX MARK', '702 END']);
  assert.equal(module.sound.length, 0, 'her page is heard');
  assert.ok(screen.messages.some((m) => m.type === 'word' && m.text === 'Prima'));
  for (const [command, told] of [['STOP', '703 STOP'], ['PAUSE', '704 PAUSE']]) {
    screen.messages.length = 0;
    await module.speak('<speak>Una frase molto lunga che nessuno ascolterà fino alla sua fine, perché viene tagliata.</speak>');
    await module.told('701 BEGIN');
    module.send(command);
    await module.told(told);
    await screen.wait({ type: 'end', reason: 'stopped' });
  }
  // a screen reader that stops again and again
  for (let i = 0; i < 50; i++) {
    await module.speak(`<speak>Numero ${i}, e ancora qualcosa.</speak>`);
    module.send('STOP');
    await module.told('703 STOP');
  }
  await module.speak('<speak>E adesso basta.</speak>');
  await module.told('702 END');
  module.send('QUIT');
  assert.equal(await module.child.exited, 0, module.child.log);
  await screen.close();
});

test('a missing or lost daemon stops only the message', async () => {
  const own = await Daemon.start();
  const file = path.join(folder, 'own.conf');
  fs.writeFileSync(file, `FacciaUrl "${own.url}"\nFacciaRoom desk\n`);
  const screen = await own.stream('?room=desk&lang=it');
  await screen.wait({ type: 'joined' });
  const module = load([file]);
  await eventually(async () => (await (await own.get('/v1/rooms')).json()).rooms.some((r) => r.followers === 2), 'the module in the room');
  module.send('SET', 'language=it', '.');
  await module.speak('<speak>Una frase lunga durante la quale il demone se ne va per sempre.</speak>');
  await module.told('701 BEGIN');
  own.process.kill('SIGKILL');
  await module.told('703 STOP');
  await module.speak('<speak>Nessuno.</speak>');
  await module.told('703 STOP');
  module.child.stdin.end();
  assert.equal(await module.child.exited, 0, module.child.log);
});

test('spd-say speaks through the real speech-dispatcher', async () => {
  const modules = path.join(folder, 'programs'), socket = path.join(folder, 'socket');
  fs.mkdirSync(modules);
  fs.symlinkSync(program, path.join(modules, 'sd_faccia'));
  fs.writeFileSync(path.join(folder, 'speechd.conf'), `LogLevel 1\nLogDir "${folder}"\nAudioOutputMethod "alsa"\nAudioALSADevice "null"\nDefaultModule faccia\nAddModule "faccia" "sd_faccia" "faccia.conf"\n`);
  const server = start('speech-dispatcher', ['-s', '-C', folder, '-c', 'unix_socket', '-S', socket, '-m', modules, '-P', path.join(folder, 'pid'), '-L', folder, '-t', '0']);
  await eventually(() => fs.existsSync(socket), 'the server’s socket');
  const say = async (...options) => {
    const child = start('spd-say', ['-o', 'faccia', ...options], { SPEECHD_ADDRESS: `unix_socket:${socket}` });
    let out = '';
    child.stdout.setEncoding('utf8').on('data', (text) => (out += text));
    return { status: await child.exited, out };
  };
  assert.match((await say('-L')).out, /espeak:it\s+it/);
  assert.equal((await say('-w', '-y', 'espeak:it', 'Da sola.')).status, 0);
  const screen = await daemon.stream('?room=desk');
  await screen.wait({ type: 'joined' });
  assert.equal((await say('-w', '-l', 'it', '-r', '20', 'La cena è pronta.')).status, 0);
  assert.ok(screen.messages.some((m) => m.type === 'word' && m.text === 'cena'));
  assert.ok(screen.messages.some((m) => m.type === 'end' && m.reason === 'done'), 'it has waited until it was said');
  // settings of desktops that name no voice of ours: blind users must never be left in silence
  for (const [i, options] of [['-l', 'xx'], ['-l', 'c'], ['-l', 'POSIX'], ['-l', 'de-XX'], ['-y', 'nonsense'], ['-y', 'nonsense', '-l', 'xx'], ['-t', 'child_female', '-l', 'c']].entries()) {
    // with or without a face, the sentence is spoken and -w waits for it
    const before = await daemon.metric('faccia_sentences_total{result="spoken"}');
    assert.equal((await say('-w', ...options, `Parola ${i}.`)).status, 0, String(options));
    assert.ok((await daemon.metric('faccia_sentences_total{result="spoken"}')) > before, `${options}: silence`);
  }
  await screen.close();
  assert.equal((await say('-w', '-y', 'nonsense', '-l', 'xx', 'Da sola, ancora.')).status, 0);
  server.kill('SIGTERM');
  await server.exited;
});
