// SPDX-License-Identifier: GPL-3.0-or-later
// Background alignment of the library's recordings: reports, killed processes, changed files.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { Daemon, build, eventually, ordinary, root } from '../../lib/daemon.mjs';

// not in /tmp, which the aligner may always read; given as a relative path, as an operator may
const folder = fs.mkdtempSync(path.join(fs.realpathSync(build), 'alignment-'));
const works = path.join(folder, 'works');
const kept = path.join(folder, 'index.voices');
const options = (percent) => ['--library', path.relative(process.cwd(), works), '--library-index', path.join(folder, 'index'), '--library-align', String(percent)];
const put = (name, text) => fs.writeFileSync(path.join(works, name), text);
const work = (text) => `---\ntitle: Prova\nlang: it\n---\n${text}\n`;
const say = (name, text) => execFileSync(path.join(ordinary, 'server/cli/faccia'), ['say', '--lang', 'it', '--wav', path.join(works, `${name}.wav`), text]);
const ajv = new Ajv({ strict: false });
ajv.addSchema(JSON.parse(fs.readFileSync(path.join(root, 'protocol/schema/library.json'))), 'library');
const valid = (name, value) => {
  const check = ajv.getSchema(`library#/$defs/${name}`);
  assert.ok(check(value), `${ajv.errorsText(check.errors)}\n${JSON.stringify(value).slice(0, 500)}`);
  return value;
};

const MONTE = 'La luna sale sul monte. Il gatto dorme vicino al fuoco.';
const SKIPPED = 'Questa frase non viene letta da nessuno nella registrazione.';
const NOTTE = 'La notte passa lenta, e domani è un altro giorno per tutti.';
const LONG = [MONTE, NOTTE];

let daemon;
const ask = async (address) => (await daemon.get(`/v1/library${address}`)).json();
const list = async () => valid('library', await ask(''));
const recording = async (id) => valid('work', await ask(`/works/${id}`)).recordings[0];
/** Lists the processes that align this library. */
const aligners = () => fs.readdirSync('/proc').filter((name) => /^\d+$/.test(name)).filter((pid) => {
  try {
    const [program, where] = fs.readFileSync(`/proc/${pid}/cmdline`, 'utf8').split('\0');
    return program.endsWith('/faccia-align') && where === kept;
  } catch {
    return false;
  }
});
/** Raises the aligners' priority: idle processes would never finish beside other tests. */
const hurry = () => {
  for (const pid of aligners())
    for (const one of [pid, ...fs.readFileSync(`/proc/${pid}/task/${pid}/children`, 'utf8').split(' ').filter(Boolean)]) {
      spawnSync('chrt', ['--other', '--pid', '0', one]);
      spawnSync('renice', ['-n', '0', '-p', one]);
    }
};
const hurried = (condition, what) => eventually(() => { try { hurry(); } catch { /* the process has just ended */ } return condition(); }, what, 240000);
const until = (id, state) => hurried(async () => { const one = await recording(id); return one?.state === state && one; }, `${id} ${state}`);
const stop = async () => assert.equal((await daemon.stop()).code, 0, daemon.log);

before(() => {
  fs.mkdirSync(works);
  put('a-lungo.md', work(LONG.join('\n\n')));
  say('a-lungo', LONG.join(' '));
  put('detto.md', work(`# Il monte\n\n${MONTE}\n\n${SKIPPED} ${NOTTE}\n\n# Fine\n\nIl pescatore torna a casa.`));
  say('detto', `Il monte. ${MONTE} Qui invece si sente qualcosa che il testo non ha proprio. ${NOTTE} Fine. Il pescatore torna a casa.`);
  put('rotto.md', work(MONTE));
  put('rotto.wav', 'this is no sound');
  put('senza.md', work(NOTTE));
});
after(() => {
  daemon?.process.kill('SIGKILL');
  fs.rmSync(folder, { recursive: true });
});

test('aligns recordings one by one at low priority within their share, and leaves nothing after the daemon ends', async () => {
  daemon = await Daemon.start(options(1), {}, { voices: false });
  const all = await eventually(async () => { const now = await list(); return now.alignment.aligning && now; }, 'the first recording');
  assert.deepEqual(all.alignment, { waiting: 2, aligning: 1, aligned: 0, stale: 0, failed: 0, work: 'a-lungo', share: all.alignment.share });
  assert.deepEqual(all.works.map(({ id, alignment }) => [id, alignment]), [['a-lungo', 'aligning'], ['detto', 'waiting'], ['rotto', 'waiting'], ['senza', undefined]]);
  assert.equal((await recording('a-lungo')).state, 'aligning');
  assert.equal(await daemon.metric('faccia_library_recordings{state="aligning"}'), 1);
  const pids = aligners();
  assert.equal(pids.length, 1);
  const stat = () => fs.readFileSync(`/proc/${pids[0]}/stat`, 'utf8').replace(/^.*\) /, '').split(' ');
  await eventually(() => stat()[16] === '19' && stat()[38] === '5', 'nice 19, SCHED_IDLE'); // set by the aligner itself
  const ticks = Number(execFileSync('getconf', ['CLK_TCK'], { encoding: 'utf8' }));
  await hurried(async () => (await daemon.metric('faccia_library_alignment_share')) > 0 && (await list()).alignment.share > 0, 'the first sentence');
  const share = () => {
    const [used, begun] = [Number(stat()[11]) + Number(stat()[12]), Number(stat()[19])];
    return used / (Number(fs.readFileSync('/proc/uptime', 'utf8').split(' ')[0]) * ticks - begun);
  };
  await eventually(() => share() < 0.5, 'its rest');
  daemon.process.kill('SIGKILL');
  assert.equal((await daemon.exited).signal, 'SIGKILL');
  await eventually(() => !aligners().length, 'the end of the aligner');
  assert.ok(!fs.existsSync(path.join(kept, 'a-lungo.alignment.json')));
});

test('resumes alignment; lists passages missing from the recording or the text; gives the reason of each failure', async () => {
  const before = fs.readdirSync(works).sort();
  fs.writeFileSync(path.join(kept, 'a-lungo.timing.json.1.part'), '{');
  daemon = await Daemon.start(options(100), {}, { voices: false });
  const rotto = await until('rotto', 'failed');
  assert.deepEqual([rotto.file, rotto.voice], ['rotto.wav', 'recording:rotto']);
  assert.match(rotto.why, /^rotto\.wav: /);
  await daemon.logged(/warning: library: cannot align rotto\.wav: rotto\.wav: /);
  const long = await until('a-lungo', 'aligned');
  assert.deepEqual([long.missing, long.unread, long.unwritten], [0, [], []]);
  const detto = await until('detto', 'aligned');
  assert.deepEqual([detto.missing, detto.unread.length, detto.unwritten.length], [1, 1, 1]);
  const [unread] = detto.unread, [unwritten] = detto.unwritten;
  const { text } = await ask(`/passages/${unread.passage}`);
  assert.deepEqual([unread.passage, text.slice(unread.start, unread.end), unread.confidence], ['detto:1:p2', SKIPPED, 0]);
  assert.ok(unwritten.seconds > 1.5 && unwritten.seconds < 5, JSON.stringify(unwritten));
  const first = valid('section', await ask('/works/detto/sections/1')).recording, second = (await ask('/works/detto/sections/2')).recording;
  assert.deepEqual([first.unread, first.unwritten, second.state, second.unread, second.sentences], [[unread], [unwritten], 'aligned', [], undefined]);
  assert.deepEqual([(await ask('/works/senza')).recordings, (await ask('/works/senza/sections/1')).recording], [[], null]);
  assert.deepEqual(fs.readdirSync(works).sort(), before, 'nothing is written beside the works');
  assert.deepEqual(fs.readdirSync(kept).filter((name) => name.endsWith('.part')), []);
  await stop();
});

test('reuses known alignments; realigns after a change of text or sound, but not of the date', async () => {
  const times = path.join(kept, 'detto.timing.json');
  const made = fs.statSync(times).mtimeMs;
  daemon = await Daemon.start(options(100), {}, { program: path.join(ordinary, 'server/daemon/facciad') }); // the rest takes minutes with the sanitizers
  const known = await eventually(async () => { const now = await list(); return now.alignment.aligned === 2 && now.alignment; }, 'what is known');
  assert.deepEqual([known.failed, known.waiting], [1, 0]);
  assert.doesNotMatch(daemon.log, /aligning /);
  const asked = async (passage, words) => {
    const spoken = await (await daemon.get(`/v1/speech?passage=${passage}&voice=recording&format=json`)).json();
    assert.deepEqual([spoken.voice, spoken.words?.slice(0, words.length).map(({ text }) => text)], ['recording:detto', words], JSON.stringify(spoken).slice(0, 300));
  };
  await asked('detto:1:p1', ['La', 'luna']);

  const now = new Date();
  fs.utimesSync(path.join(works, 'detto.wav'), now, now);
  await daemon.logged(/aligning detto\.wav/);
  await until('detto', 'aligned');
  assert.equal(fs.statSync(times).mtimeMs, made, 'the same sound has the same times');

  put('detto.md', work(`${MONTE}\n\n${NOTTE}`)); // while the voice has the old text loaded
  const detto = await hurried(async () => { const one = await recording('detto'); return one.state === 'aligned' && one.missing === 0 && one; }, 'the other text');
  assert.equal(detto.sentences, 3);
  assert.ok(detto.unwritten.length > 0);
  await asked('detto:1:p2', ['La', 'notte', 'passa']);

  say('rotto', MONTE);
  assert.equal((await until('rotto', 'aligned')).missing, 0);
  say('senza', NOTTE);
  assert.equal((await until('senza', 'aligned')).missing, 0);
  fs.rmSync(path.join(works, 'senza.wav'));
  await eventually(async () => !(await ask('/works/senza')).recording && !(await recording('senza')), 'the end of it');

  await stop();
});

test('uses a TextGrid next to a recording without aligning it', async () => {
  const at = (ending) => path.join(works, `griglia.${ending}`);
  put('griglia.md', work(`${MONTE}\n\n${NOTTE}`));
  execFileSync(path.join(ordinary, 'server/cli/faccia'), ['say', '--lang', 'it', '--wav', at('wav'), '--textgrid', at('TextGrid'), '--json', path.join(folder, 'griglia.json'), `${MONTE} ${NOTTE}`]);
  const said = JSON.parse(fs.readFileSync(path.join(folder, 'griglia.json'))).words;
  daemon = await Daemon.start(options(100), {}, { program: path.join(ordinary, 'server/daemon/facciad') });
  await until('griglia', 'aligned');
  const { words } = await (await daemon.get('/v1/speech?passage=griglia:1:p1&voice=recording&format=json')).json();
  assert.equal(words.length, 11);
  for (const [i, { start, text }] of words.entries())
    assert.ok(text === said[i].text && Math.abs(start - words[0].start - (said[i].start - said[0].start)) < 0.02, `${text} ${start}, ${said[i].text} ${said[i].start}`);
  assert.doesNotMatch(daemon.log, /aligning griglia\.wav/);
  fs.writeFileSync(at('TextGrid'), 'this is no grid');
  const answer = await daemon.get('/v1/speech?passage=griglia:1:p2&voice=recording&format=json');
  assert.ok(answer.status >= 400);
  assert.match(await answer.text(), /griglia\.TextGrid:1:1/);
  await stop();
});

test('aligns a recording as the lexicon of its work and the number rules read its text', async () => {
  const phones = (name) => JSON.parse(fs.readFileSync(path.join(kept, `${name}.timing.json`))).phones.map(({ ipa }) => ipa).join('');
  const read = 'Canta la vecchia signora del porto per ventisei minuti.';
  put('nomi.md', work('Canta Zyx per 26 min.'));
  put('nomi.pls', `<lexicon version="1.0" xmlns="http://www.w3.org/2005/01/pronunciation-lexicon" alphabet="ipa" xml:lang="it">
<lexeme><grapheme>Zyx</grapheme><alias>la vecchia signora del porto</alias></lexeme></lexicon>`);
  put('parole.md', work(read));
  for (const name of ['nomi', 'parole']) say(name, read);
  daemon = await Daemon.start(options(100), {}, { program: path.join(ordinary, 'server/daemon/facciad') });
  for (const name of ['nomi', 'parole']) assert.equal((await until(name, 'aligned')).missing, 0);
  assert.equal(phones('nomi'), phones('parole'));
  await stop();
});
