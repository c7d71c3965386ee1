// SPDX-License-Identifier: GPL-3.0-or-later
// Choosing a voice by gender when none is named, and the voice that suits a head.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon } from '../../lib/daemon.mjs';

const faccia = path.join(build, 'server/cli/faccia');
let daemon, voices;
before(async () => {
  daemon = await Daemon.start();
  ({ voices } = await (await daemon.get('/v1/voices')).json());
});
after(async () => assert.equal((await daemon.stop()).code, 0));

const spoken = async (query) => (await daemon.get(`/v1/speech?text=Ciao&format=json&${query}`)).json();
const genderOf = (id) => voices.find((voice) => voice.id === id)?.gender;

test('a gender selects among the voices of the language; a name takes precedence', async () => {
  for (const gender of ['female', 'male']) {
    if (!voices.some((voice) => /^en/.test(voice.lang) && voice.gender === gender)) continue;
    const { voice } = await spoken(`lang=en&gender=${gender}`);
    assert.equal(genderOf(voice), gender, voice);
  }
  const named = voices.find((voice) => /^en/.test(voice.lang));
  assert.equal((await spoken(`lang=en&voice=${encodeURIComponent(named.id)}&gender=${named.gender === 'male' ? 'female' : 'male'}`)).voice, named.id);
  assert.equal((await spoken('lang=it&gender=neither')).code, 'bad-field');
});

test('a region selects a voice of that variety, of the usual gender; without one there, the language suffices', async () => {
  for (const [lang, wanted] of [['en-GB', /^espeak:en-gb(\+|$)/], ['en-US', /^espeak:en-us/], ['pt-PT', /^espeak:pt(\+|$)/], ['pt-BR', /^espeak:pt-br/], ['pt', /^espeak:pt-br/], ['it-CH', /^espeak:it/], ['es-MX', /^espeak:es(\+|-|$)/]]) {
    const { voice } = await spoken(`lang=${lang}`);
    assert.match(voice, wanted, lang);
  }
  assert.equal(genderOf((await spoken('lang=en-GB')).voice), genderOf((await spoken('lang=en')).voice));
  const { voice } = await spoken('lang=en-GB&gender=male');
  assert.equal(voices.find(({ id }) => id === voice).lang, 'en-GB');
  assert.equal(genderOf(voice), 'male');
  const european = await (await daemon.get('/v1/speech?format=json&lang=pt-PT&text=Bom%20dia%2C%20tia.')).json();
  const brazilian = await (await daemon.get('/v1/speech?format=json&lang=pt-BR&text=Bom%20dia%2C%20tia.')).json();
  const ipa = ({ phones }) => phones.map((phone) => phone.ipa).join('');
  assert.ok(/d?ʒ/.test(ipa(brazilian)) && !/d?ʒ/.test(ipa(european)), `${ipa(european)} and ${ipa(brazilian)}`);
});

test('faccia voices --model lists the voices that suit a head', () => {
  const list = JSON.parse(execFileSync(faccia, ['voices', '--model', 'bruno', '--json'])).voices;
  assert.ok(list.length && list.every(({ gender }) => gender === 'male'));
  const none = spawnSync(faccia, ['voices', '--model', 'nobody'], { encoding: 'utf8' });
  assert.equal(none.status, 1);
  assert.match(none.stderr, /unknown head model 'nobody'/);
});

test('the heads state their gender, the default first, and have posters', async () => {
  const { models } = await (await daemon.get('/v1/models')).json();
  assert.equal(models[0].name, 'mara');
  for (const { name, about, voice, poster } of models) {
    assert.ok(about && voice.gender, name);
    const answer = await daemon.get(`/v1/${poster}`);
    assert.equal(answer.headers.get('content-type'), 'image/webp');
    assert.equal(Buffer.from(await answer.arrayBuffer()).toString('latin1', 8, 12), 'WEBP');
  }
});
