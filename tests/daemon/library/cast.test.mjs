// SPDX-License-Identifier: GPL-3.0-or-later
// Who speaks in a play: the cast by the source and by WORK.cast.json, and speech with it.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { Daemon, build, eventually, root } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-cast-'));
const works = path.join(folder, 'works');
const program = path.join(build, 'server/cli/faccia');
const put = (name, text) => fs.writeFileSync(path.join(works, name), text);
const ajv = new Ajv({ strict: false });
for (const name of ['library', 'cast']) ajv.addSchema(JSON.parse(fs.readFileSync(path.join(root, `protocol/schema/${name}.json`))), name);
const PLAY = path.join(root, 'models/library/la-chiave.xml');

let daemon, voices;
const ask = async (address, status = 200, options = {}) => {
  const response = await fetch(`${daemon.url}${address}`, options);
  const text = await response.text();
  assert.equal(response.status, status, text);
  return text ? JSON.parse(text) : null;
};
const castOf = async (work) => {
  const cast = await ask(`/v1/library/works/${work}/cast`);
  const check = ajv.getSchema('library#/$defs/cast');
  assert.ok(check(cast), ajv.errorsText(check.errors));
  return cast;
};
const byId = ({ cast }) => Object.fromEntries(cast.map((member) => [member.id, member]));
const tei = (persons, speeches, lang = 'it') =>
  `<TEI xml:lang="${lang}"><teiHeader><profileDesc><particDesc><listPerson>${persons}</listPerson></particDesc></profileDesc></teiHeader><text><body><div>${speeches}</div></body></text></TEI>`;

before(async () => {
  fs.mkdirSync(works);
  fs.copyFileSync(PLAY, path.join(works, 'la-chiave.xml'));
  put('parole.xml', tei('', '<castList><castItem><role>Donna Elvira</role>, <roleDesc>vedova</roleDesc></castItem><castItem><role>Momolo</role>, <roleDesc>servo di Donna Elvira</roleDesc></castItem><castItem><role>Il Notaio</role></castItem><castItem><role>Andrea</role></castItem></castList><sp><speaker>ELV.</speaker><p>Chi è là, a quest\'ora?</p></sp><sp><speaker>Momolo.</speaker><p>Sono io.</p></sp><sp><speaker>NOTAIO</speaker><p>E io.</p></sp><sp><speaker>Andrea</speaker><p>Anche.</p></sp><sp><speaker>Voce</speaker><p>No.</p></sp>'));
  put('due.xml', tei('<person xml:id="a" sex="2"><persName>Uno</persName></person><person xml:id="b"><sex value="M"/><persName>Ada</persName><age value="80"/></person><personGrp xml:id="c" sex="FEMALE"><name>Coro</name></personGrp>', '<sp who="#a"><p>Uno.</p></sp><sp who="#b"><p>Due, due.</p></sp><sp who="#a #c"><p>T.</p></sp>'));
  put('gruppo.xml', tei('<person xml:id="k"><persName>Kim</persName></person>', '<castList><castItem sameAs="#k"><role>Kim</role>, <roleDesc>regina</roleDesc></castItem></castList><spGrp><sp who="#k"><p>Uno.</p></sp><sp who="#l"><p>Due.</p></sp></spGrp>'));
  put('coro.xml', tei(Array.from({ length: 700 }, (_, i) => `<person xml:id="p${i}" sex="FEMALE"/>`).join(''), Array.from({ length: 700 }, (_, i) => `<sp who="#p${i}"><p>Parola ${'x'.repeat(i % 50)}.</p></sp>`).join('')));
  put('prosa.md', `---\nlang: it\n---\n${Array.from({ length: 3 }, () => 'La sera scese sul porto, e i pescatori tirarono a riva le barche senza dire una parola.').join(' ')}\n\n«Chi va là?» disse Renzo.\n\n«Sono io», rispose Lucia.\n\n«E che vuoi a quest'ora?»\n\n«Niente, passavo di qui.»\n\nNiente.\n\nE poi niente.\n\n«Che notte è questa!»\n`);
  daemon = await Daemon.start(['--library', works, '--library-index', path.join(folder, 'index'), '--editing'], { FACCIA_STATE: folder });
  await eventually(async () => (await ask('/v1/library')).state === 'ready', 'the library');
  voices = new Map((await ask('/v1/voices')).voices.map((voice) => [voice.id, voice]));
});
after(async () => {
  assert.equal((await daemon.stop()).code, 0, daemon.log);
  fs.rmSync(folder, { recursive: true });
});

test('the persons of a play have their sex and age from the source, voices of that sex, and nobody speaks as another does', async () => {
  const all = await castOf('la-chiave');
  const cast = byId(all);
  assert.deepEqual(Object.keys(cast).sort(), ['anselmo', 'lisetta', 'lisetta+tullio', 'nina', 'tullio']);
  assert.deepEqual(['anselmo', 'lisetta', 'nina', 'tullio'].map((id) => [cast[id].name, cast[id].sex, cast[id].age, cast[id].about]), [['Anselmo', 'male', 'old', 'vecchio orologiaio'], ['Lisetta', 'female', 'adult', 'fornaia'], ['Nina', 'female', 'child', 'bambina'], ['Tullio', 'male', 'adult', 'barcaiolo']]);
  for (const { sex, voice } of all.cast.filter((member) => member.sex)) {
    assert.equal(voices.get(voice).gender, sex);
    assert.equal(voices.get(voice).lang.slice(0, 2), 'it');
  }
  assert.equal(new Set(all.cast.map(({ voice, pitch, rate }) => `${voice} ${pitch} ${rate}`)).size, 5);
  const heads = new Map((await ask('/v1/models')).models.map((model) => [model.name, model]));
  assert.equal(heads.get(cast.anselmo.head).voice.gender, 'male');
  assert.equal(heads.get(cast.lisetta.head).voice.gender, 'female');
  assert.equal(new Set(['anselmo', 'lisetta', 'nina', 'tullio'].map((id) => cast[id].head)).size, 4);
  assert.deepEqual(await castOf('la-chiave'), all); // the same again
  const order = all.cast.map(({ characters }) => characters);
  const play = (await ask('/v1/library/works/la-chiave')).sections.map(({ number }) => ask(`/v1/library/works/la-chiave/sections/${number}`));
  const blocks = (await Promise.all(play)).flatMap((section) => section.blocks);
  for (const { id, first } of all.cast) {
    const words = blocks.find(({ who }) => who === id).text.replace(/\s+/g, ' ').trim();
    assert.ok(words === first || (first.endsWith('…') && words.startsWith(first.slice(0, -1)) && first.length > 100 && Buffer.from(first).length <= 160), `${id}: ${first}`);
  }
  assert.deepEqual(order, [...order].sort((a, b) => b - a));
});

test('without marks of sex, names and descriptions tell; abbreviated names are found in the cast list', async () => {
  const cast = byId(await castOf('parole'));
  assert.deepEqual(Object.fromEntries(Object.values(cast).map(({ id, name, sex, sex_from }) => [id, [name, sex, sex_from]])), {
    elv: ['Donna Elvira', 'female', 'description'],
    momolo: ['Momolo', 'male', 'description'],
    notaio: ['Il Notaio', 'male', 'description'],
    andrea: ['Andrea', 'male', 'name'],
    voce: ['Voce', undefined, undefined],
  });
  assert.equal(voices.get(cast.voce.voice).gender, 'male'); // as most others
});

test('sex in numbers, elements and groups; several who speak at once', async () => {
  const cast = byId(await castOf('due'));
  assert.deepEqual([cast.a.sex, cast.b.sex, cast.b.age, cast['a+c'].sex], ['female', 'male', 'old', 'female']);
  const { blocks } = await ask('/v1/library/works/due/sections/1');
  assert.deepEqual(blocks.map(({ who, speaker }) => [who, speaker]), [['a', 'Uno'], ['b', 'Ada'], ['a+c', 'Uno, Coro']]);
});

test('a person of the cast list may be named by sameAs; a group of speeches is read without a warning', async () => {
  const cast = byId(await castOf('gruppo'));
  assert.deepEqual([cast.k.sex, cast.k.about, cast.l.passages], ['female', 'regina', 1]);
  assert.ok(!(await ask('/v1/library')).problems.some(({ file }) => file === 'gruppo.xml'));
});

test('a cast has at most 500 members: those who say most', async () => {
  const { cast } = await castOf('coro');
  assert.equal(cast.length, 500);
  assert.ok(cast.every(({ id }) => Number(id.slice(1)) % 50 >= 14));
});

test('in prose the narrator tells who speaks; the paragraphs around tell the turns, and the file beside the work decides', async () => {
  const all = await castOf('prosa'), cast = byId(all);
  assert.deepEqual([all.told, Object.keys(cast).sort(), (await castOf('la-chiave')).told], [true, ['lucia', 'renzo', 'voice-1'], false]);
  assert.match(cast.lucia.first, /^«?Sono io»?,?$/);
  assert.deepEqual([cast.lucia.name, cast.lucia.sex, cast.renzo.sex, cast['voice-1'].voice, cast['voice-1'].pitch], ['Lucia', 'female', 'male', undefined, 1.14]);
  const speech = async (passage, query = '') => (await ask(`/v1/speech?passage=prosa:1:${passage}&format=json${query}`)).speakers?.map(({ id }) => id).filter(Boolean) ?? [];
  assert.deepEqual(await speech('p4', '&dialogue=voices'), ['renzo'], 'by the turns before it');
  assert.deepEqual(await speech('p5', '&dialogue=voices'), ['lucia']);
  assert.deepEqual(await speech('p8', '&dialogue=voices'), ['voice-1']);
  assert.deepEqual(await speech('p4'), []);
  put('prosa.cast.json', '{"cast":{"renzo":{"voice":"espeak:it","pitch":0.7}}}');
  await eventually(async () => byId(await castOf('prosa')).renzo.pitch === 0.7, 'the file');
  assert.deepEqual((await castOf('prosa')).problems, []);
});

test('a file beside the work decides otherwise, at once, and its faults are told with their place', async () => {
  const own = (await castOf('la-chiave')).cast.find(({ id }) => id === 'tullio');
  const file = { narrator: { pitch: 0.9 }, cast: { anselmo: { voice: own.voice, pitch: 0.5, head: 'samuel', affect: 'sad' }, nina: { sex: 'male', age: 'adult' } } };
  const check = ajv.getSchema('cast');
  assert.ok(check(file), ajv.errorsText(check.errors));
  put('la-chiave.cast.json', JSON.stringify(file));
  let all = await castOf('la-chiave');
  let cast = byId(all);
  assert.deepEqual([all.file, all.problems, all.narrator], ['la-chiave.cast.json', [], { pitch: 0.9, rate: 1 }]);
  assert.deepEqual([cast.anselmo.voice, cast.anselmo.pitch, cast.anselmo.head, cast.anselmo.affect], [own.voice, 0.5, 'samuel', 'sad']);
  assert.deepEqual([cast.nina.sex, cast.nina.sex_from, cast.nina.age, voices.get(cast.nina.voice).gender], ['male', 'file', 'adult', 'male']);

  put('la-chiave.cast.json', '{"narrator":{"voice":"none:x"},"cast":{"anselmo":{"voice":"none:x","head":"nobody"},"pantalone":{"pitch":1}}}');
  all = await castOf('la-chiave');
  assert.deepEqual(all.problems.map(({ code, field }) => [code, field]).sort(), [['bad-cast', 'cast.anselmo.head'], ['bad-cast', 'cast.anselmo.voice'], ['bad-cast', 'cast.pantalone'], ['bad-cast', 'narrator.voice']]);
  assert.equal(voices.get(byId(all).anselmo.voice).gender, 'male');

  for (const [text, place] of [
    ['{"cast":{\n"anselmo":{"pitch":9}}}', { field: 'cast.anselmo.pitch' }],
    ['{"cast":{"anselmo":{"sex":"boh"}}}', { field: 'cast.anselmo.sex' }],
    ['{"cast":{"anselmo":{"colour":"red"}}}', { field: 'cast.anselmo.colour' }],
    ['{"cast":[]}', { field: 'cast' }],
    ['{"cast":{},\n"cast":{}}', { line: 2 }],
    ['{\n "cast": {"anselmo" 3}}', { line: 2 }],
    ['', { line: 1 }],
    [' '.repeat(300000), {}],
  ]) {
    put('la-chiave.cast.json', text);
    all = await castOf('la-chiave');
    assert.equal(all.problems.length, 1, text.slice(0, 80));
    assert.equal(all.problems[0].code, 'bad-cast');
    for (const [name, value] of Object.entries(place)) assert.equal(all.problems[0][name], value, text.slice(0, 80));
    assert.equal(byId(all).anselmo.sex, 'male'); // the rest is chosen as without the file
    const said = spawnSync(program, ['library', 'cast', path.join(works, 'la-chiave.xml')], { encoding: 'utf8' });
    assert.equal(said.status, 1);
    assert.match(said.stdout, /bad-cast/);
    assert.equal(spawnSync(program, ['library', 'check', works], { encoding: 'utf8' }).status, 1);
  }
  const refused = await ask('/v1/library/files/la-chiave.cast.json', 400, { method: 'PUT', body: '{"cast":{"anselmo":{"pitch":9}}}' });
  assert.deepEqual([refused.code, refused.field], ['bad-cast', 'cast.anselmo.pitch']);
  await eventually(async () => (await ask('/v1/library')).problems.some(({ file, code }) => file === 'la-chiave.cast.json' && code === 'bad-cast'), 'the problem in the list');
  await ask('/v1/library/files/la-chiave.cast.json', 200, { method: 'DELETE', headers: { 'if-match': '*' } });
  await eventually(async () => !(await ask('/v1/library')).problems.length, 'the end of the problem');
  assert.equal((await castOf('la-chiave')).file, null);
  await ask('/v1/library/works/nothing/cast', 404);
});

test('faccia library cast shows what the daemon answers', async () => {
  const said = spawnSync(program, ['library', 'cast', '--json', path.join(works, 'la-chiave.xml')], { encoding: 'utf8' });
  assert.equal(said.status, 0, said.stderr);
  const { work, ...rest } = await castOf('la-chiave');
  assert.equal(work, 'la-chiave');
  assert.deepEqual(JSON.parse(said.stdout), rest);
  const lines = spawnSync(program, ['library', 'cast', path.join(works, 'la-chiave.xml')], { encoding: 'utf8' }).stdout;
  assert.match(lines, /^anselmo +Anselmo +male +source +old/m);
});

// ---- speech

const lines = async (query) => {
  const response = await fetch(`${daemon.url}/v1/speech?${new URLSearchParams({ format: 'ndjson', ...query })}`);
  const text = await response.text();
  assert.equal(response.status, 200, text);
  return text.trim().split('\n').map((line) => JSON.parse(line));
};
/** What each person says: [id, words] without repetitions of the id. */
const turns = (events) => {
  const found = [];
  let who = null;
  for (const { type, speaker, text } of events) {
    if (type === 'speaker' && speaker !== who) found.push([(who = speaker), '']);
    if (type === 'word') found.at(-1)[1] += `${found.at(-1)[1] && ' '}${text}`;
  }
  return found;
};
const SCENE = [['', 'Scena prima'], ['lisetta', 'Buongiorno Anselmo È ancora caldo'], ['anselmo', 'Caldo Tutto è caldo qui tranne i miei orologi Ho perso la chiave'], ['lisetta', 'Quale chiave'], ['anselmo', 'Quella che li carica tutti Senza di lei non so che ora è'], ['tullio', 'È l\'ora della barca Chi viene all\'isola'], ['anselmo', 'Nessuno finché non la trovo']];
/** Mean pitch of a WAV's voiced parts, by autocorrelation. */
const pitchOf = async (query) => {
  const wav = Buffer.from(await (await fetch(`${daemon.url}/v1/speech?${new URLSearchParams({ format: 'wav', ...query })}`)).arrayBuffer());
  const rate = wav.readUInt32LE(24);
  const pcm = new Int16Array(wav.buffer, wav.byteOffset + 44, (wav.length - 44) >> 1);
  const size = Math.round(rate * 0.05), found = [];
  for (let at = 0; at + 2 * size < pcm.length; at += size) {
    let best = 0, lag = 0, power = 0;
    for (let i = 0; i < size; i++) power += pcm[at + i] ** 2;
    for (let k = Math.round(rate / 400); k < rate / 60 && k < size; k++) {
      let sum = 0;
      for (let i = 0; i < size; i++) sum += pcm[at + i] * pcm[at + i + k];
      if (sum > best) [best, lag] = [sum, k];
    }
    if (power / size > 1e6 && best > 0.6 * power) found.push(rate / lag);
  }
  return found.sort((a, b) => a - b)[found.length >> 1];
};

test('a scene is spoken by its persons, and events tell who speaks', async () => {
  assert.deepEqual(turns(await lines({ passage: 'la-chiave:2' })), SCENE);
  const stream = await daemon.stream();
  stream.send({ type: 'speak', passage: 'la-chiave:2', id: 's' });
  await stream.wait({ type: 'end', id: 's' });
  assert.deepEqual(turns(stream.messages), SCENE);
  assert.deepEqual([...new Set(stream.messages.filter(({ type }) => type === 'speaker').map(({ name }) => name))], ['', 'Lisetta', 'Anselmo', 'Tullio']);
  stream.socket.close();
  const man = await pitchOf({ passage: 'la-chiave:2:p2' }), woman = await pitchOf({ passage: 'la-chiave:2:p1' });
  assert.ok(man * 1.2 < woman, `${man} Hz, ${woman} Hz`);
});

test('stage directions and names are spoken by the narrator when that is asked for', async () => {
  const all = turns(await lines({ passage: 'la-chiave:3', directions: 'spoken', names: 'true' }));
  assert.deepEqual(all.slice(0, 5), [['', 'Scena seconda Entra Nina con qualcosa in mano Nina'], ['nina', 'Nonno'], ['', 'piangendo'], ['nina', 'l\'ho presa io Volevo che il giorno durasse di più'], ['', 'Anselmo piano']]);
  assert.ok(!turns(await lines({ passage: 'la-chiave:3' })).some(([, said]) => /piangendo|Escono/.test(said)));
  const { text, speeches } = await ask('/v1/library/passages/la-chiave:3?directions=spoken&names=true');
  for (const [query, field] of [['directions=loud', 'directions'], ['names=yes', 'names']]) assert.deepEqual((await ask(`/v1/library/passages/la-chiave:3?${query}`, 400)).field, field);
  const known = ajv.getSchema('library#/$defs/passage');
  assert.ok(known(await ask('/v1/library/passages/la-chiave:3')), ajv.errorsText(known.errors));
  assert.equal(text.slice(speeches[0].start, speeches[0].end).trim(), 'Nonno,');
  const words = (await lines({ passage: 'la-chiave:3', directions: 'spoken', names: 'true' })).filter(({ type }) => type === 'word');
  for (const word of words) assert.equal(text.slice(word.utf16_start, word.utf16_end), word.text);
});

test('one voice speaks all if it is named or the cast is off; who speaks is still told', async () => {
  const voice = [...voices.keys()].find((id) => id.startsWith('espeak:it'));
  for (const query of [{ voice }, { cast: 'off' }]) assert.deepEqual(turns(await lines({ passage: 'la-chiave:2', ...query })), SCENE);
  const pitches = await Promise.all([['la-chiave:2:p1', { cast: 'off' }], ['la-chiave:2:p2', { cast: 'off' }], ['la-chiave:2:p2', { voice, cast: 'on' }]].map(([passage, more]) => pitchOf({ passage, ...more })));
  assert.ok(pitches[1] > 0.8 * pitches[0] && pitches[2] < 0.8 * pitches[0], pitches.join(' '));
});

test('a text names who of a work speaks it, or who speaks which part', async () => {
  const [begin, ...rest] = await lines({ text: 'Ciao a tutti.', work: 'la-chiave:2', speaker: 'anselmo', lang: 'it' });
  assert.equal(begin.voice, byId(await castOf('la-chiave')).anselmo.voice);
  assert.deepEqual(turns(rest), [['anselmo', 'Ciao a tutti']]);
  assert.equal(rest.find(({ type }) => type === 'speaker').name, 'Anselmo');
  assert.deepEqual(turns(await lines({ text: 'Ciao.', speaker: 'Chiunque', lang: 'it' })), [['Chiunque', 'Ciao']]);
  const speakers = JSON.stringify([{ id: 'a', name: 'A & <B>', gender: 'male', pitch: 0.8, at: '7-14 17-22' }, { id: 'b', at: '0-6' }]);
  const text = 'Primo, secondo e terzo già.';
  assert.deepEqual(turns(await lines({ text, speakers, lang: 'it' })), [['b', 'Primo'], ['a', 'secondo'], ['', 'e'], ['a', 'terzo'], ['', 'già']]);
  const vtt = await (await fetch(`${daemon.url}/v1/speech?${new URLSearchParams({ text: 'Ciao. Addio.', lang: 'it', format: 'vtt', speakers: JSON.stringify([{ id: 'a', name: 'A & <B>', at: '0-5' }]) })}`)).text();
  assert.match(vtt, /^<v A &amp; &lt;B&gt;>Ciao\.$/m);
  assert.match(vtt, /^Addio\.$/m);
  for (const [bad, why] of [['{}', /array/], ['[{"id":"a","at":"5-2"}]', /\[0\]\.at/], ['[{"id":"a","at":"0-9"},{"id":"b","at":"3-4"}]', /same part/], ['[{"id":"a","at":"0-9","pitch":9}]', /pitch/], ['[{"at":"0-9"}]', /id/], ['[ ', /end of file/]]) {
    const error = await ask(`/v1/speech?${new URLSearchParams({ text, speakers: bad, lang: 'it', format: 'ndjson' })}`, 400);
    assert.deepEqual([error.code, error.field], ['bad-field', 'speakers']);
    assert.match(error.message, why);
  }
});

test('captions, TextGrid and JSON say who speaks, over HTTP and in exported files', async () => {
  const get = async (format) => (await fetch(`${daemon.url}/v1/speech?${new URLSearchParams({ passage: 'la-chiave:2', format })}`)).text();
  const vtt = await get('vtt');
  assert.match(vtt, /^Scena <[\d:.]+>prima$/m);
  assert.match(vtt, /^<v Lisetta>Buongiorno, <[\d:.]+>Anselmo\.$/m);
  assert.match(vtt, /^<v Tullio>/m);
  const grid = await get('textgrid');
  assert.match(grid, /size = 4/);
  assert.match(grid, /name = "speakers"[^]*text = "Lisetta"[^]*text = "Anselmo"[^]*text = "Tullio"/);
  const timed = JSON.parse(await get('json'));
  const check = new Ajv({ strict: false }).compile(JSON.parse(fs.readFileSync(path.join(root, 'protocol/schema/timed.json'))));
  assert.ok(check(timed), JSON.stringify(check.errors));
  assert.deepEqual([...new Set(timed.speakers.map(({ id }) => id))], ['lisetta', 'anselmo', 'tullio']);
  assert.deepEqual([...new Set(timed.words.map(({ speaker }) => speaker))], [undefined, 'lisetta', 'anselmo', 'tullio']);
  const file = (name) => path.join(folder, name);
  const made = spawnSync(program, ['library', 'export', works, 'la-chiave', '--vtt', file('a.vtt'), '--textgrid', file('a.TextGrid')], { encoding: 'utf8' });
  assert.equal(made.status, 0, made.stderr);
  assert.match(fs.readFileSync(file('a.vtt'), 'utf8'), /^<v Nina>Nonno/m);
  assert.match(fs.readFileSync(file('a.TextGrid'), 'utf8'), /name = "speakers"[^]*text = "Lisetta e Tullio"/);
});

test('stage directions give their speech a mood, which is heard and seen', async () => {
  put('umori.xml', tei('<person xml:id="a" sex="F"><persName>Anna</persName></person><person xml:id="b" sex="M"><persName>Bruno</persName></person>', `
    <sp who="#a"><speaker>Anna</speaker><stage>piangendo</stage><p>Non lo so.</p></sp>
    <sp who="#b"><speaker>Bruno</speaker><stage>con ira, alzandosi</stage><p>Lo sai.</p><p>Lo sai bene.</p></sp>
    <sp who="#a"><speaker>Anna</speaker><p>Non lo so.</p></sp>
    <stage>Bruno ride.</stage>
    <sp who="#b"><speaker>Bruno</speaker><p><stage>siede</stage> Va bene.</p></sp>
    <sp who="#a"><p>Vieni, <stage>teneramente</stage> caro.</p></sp>`));
  put('moods.xml', tei('', '<sp><speaker>KING</speaker><stage>Laughing, to the QUEEN</stage><p>Come here.</p></sp>', 'en'));
  await eventually(async () => (await ask('/v1/library')).works.filter(({ id }) => id === 'umori' || id === 'moods').length === 2, 'the plays');
  const section = async (work) => {
    const answer = await ask(`/v1/library/works/${work}/sections/1`), check = ajv.getSchema('library#/$defs/section');
    assert.ok(check(answer), ajv.errorsText(check.errors));
    return answer.blocks.filter(({ kind }) => kind === 'paragraph');
  };
  assert.deepEqual((await section('umori')).map(({ affect }) => affect), ['sadness', 'anger', 'anger', undefined, undefined, 'love']);
  assert.deepEqual((await section('moods')).map(({ affect }) => affect), ['joy']);
  const passage = await ask('/v1/library/passages/umori:1');
  assert.deepEqual(passage.speeches.map(({ who, affect }) => `${who} ${affect ?? ''}`.trim()), ['a sadness', 'b anger', 'b anger', 'a', 'b', 'a love']);
  const faps = async (address) => (await (await daemon.get(`/v1/speech?format=fap&seed=1&life=0&${address}`)).text());
  assert.notEqual(await faps('passage=umori:1:p1'), await faps('passage=umori:1:p4'), 'the face is sad');
  assert.equal(await faps('passage=umori:1:p1&cast=off'), await faps('passage=umori:1:p4&cast=off'), 'one voice, one mood');
  const { affect: known } = JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json')));
  for (const lang of ['en', 'it', 'pt', 'tr'])
    for (const affect of Object.keys(JSON.parse(fs.readFileSync(path.join(root, `models/directions/${lang}.json`))))) assert.ok(known[affect], `${lang}: ${affect}`);
});
