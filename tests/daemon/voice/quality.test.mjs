// SPDX-License-Identifier: GPL-3.0-or-later
// Voice quality, heard by acoustic measures: what voqual and signalctrl ask for, and what each affect does beside its rate and pitch. The
// face stays as it is.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { ordinary } from '../../lib/daemon.mjs';
import { measureVoice, readWav } from '../../lib/voice-measures.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-quality-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const models = path.join(ordinary, 'models'), plain = file('models');
const TEXT = { it: 'La mamma ama il mare e la luna. Il nonno viene da lontano.', en: 'My mother loves the moon and the sea.' };

/** Models whose expressions change nothing but rate, pitch, range and volume. */
before(() => {
  fs.mkdirSync(plain);
  for (const name of fs.readdirSync(models)) if (name !== 'expressions.json') fs.symlinkSync(path.join(models, name), path.join(plain, name));
  const expressions = JSON.parse(fs.readFileSync(path.join(models, 'expressions.json'), 'utf8'));
  for (const affect of Object.values(expressions.affect)) delete affect.quality;
  fs.writeFileSync(path.join(plain, 'expressions.json'), JSON.stringify(expressions));
});

/** Says a text. @returns {{voice: object, faps: string, wav: object, warnings: string}} */
function say(text, { voice = 'espeak:it+f2', lang = 'it', from = models, args = [] } = {}) {
  const { status, stderr } = faccia(['--models', from, 'say', '--lang', lang, '--voice', voice, '--seed', '1', '--wav', file('a.wav'), '--fap', file('a.fap'), '--life', '0', ...args, text]);
  assert.equal(status, 0, stderr);
  const wav = readWav(file('a.wav'));
  return { voice: measureVoice(wav), wav, faps: fs.readFileSync(file('a.fap'), 'utf8').split('\n').slice(1).join('\n'), warnings: stderr };
}
const voqual = (type, text = TEXT.it, level = '1') => `<vsml><performative type="inform"><voqual type="${type}" level="${level}">${text}</voqual></performative></vsml>`;
const signal = (type, level, text = TEXT.it) => `<vsml><performative type="inform"><voqual type="modal"><signalctrl type="${type}" level="${level}">${text}</signalctrl></voqual></performative></vsml>`;
const same = (a, b) => a.wav.samples.join() === b.wav.samples.join();
const show = (t, name, { voice }) => t.diagnostic(`${name}: H1-H2 ${voice.h1h2.toFixed(1)} dB, HNR ${voice.hnr.toFixed(1)} dB, jitter ${(100 * voice.jitter).toFixed(2)} %, shimmer ${voice.shimmer.toFixed(2)} dB, slope ${voice.slope.toFixed(1)} dB/oct`);

/** Asserts the direction of each measure: + rises, - falls, by at least the given amount. */
function moves(name, was, is, wanted) {
  for (const [key, least] of Object.entries(wanted)) {
    const change = is.voice[key] - was.voice[key];
    assert.ok(least < 0 ? change <= least : change >= least, `${name}: ${key} ${was.voice[key]} -> ${is.voice[key]}, wanted ${least}`);
  }
}

/** Same face, same length, no louder. */
function staysInPlace(name, was, is) {
  assert.equal(is.wav.samples.length, was.wav.samples.length, name);
  assert.ok(is.faps === was.faps, `${name}: the face moves otherwise`);
  assert.ok(is.voice.rms <= 1.005 * was.voice.rms, `${name}: ${was.voice.rms} -> ${is.voice.rms}`);
  assert.ok(is.voice.peak <= Math.max(was.voice.peak, 0.8913) + 1e-3, `${name}: peak ${is.voice.peak}`);
}

/* its volume, and what changes */
const QUALITIES = {
  soft: [0.8, { h1h2: 0.5, slope: -0.4 }],
  pressed: [0.95, { h1h2: -0.7, slope: 0.4 }],
  tense: [1, { h1h2: -0.5, slope: 0.4 }],
  breathy: [0.9, { h1h2: 1, hnr: -0.5 }],
  harsh: [1, { jitter: 0.004, hnr: -1 }],
  hoarse: [0.95, { hnr: -1 }],
};

const SOME = ['tense', 'breathy', 'harsh'];
for (const [voice, lang, types] of [['espeak:it+f2', 'it', Object.keys(QUALITIES)], ['festival:lp', 'it', SOME], ['festival:kal', 'en', SOME]])
  test(`${voice} has the qualities of VSML`, (t) => {
    const was = say(voqual('modal', TEXT[lang]), { voice, lang });
    show(t, 'modal', was);
    assert.ok(same(say(voqual('breathy', TEXT[lang], '0'), { voice, lang }), was), 'level 0 changes nothing');
    for (const type of types) {
      const [volume, wanted] = QUALITIES[type], is = say(voqual(type, TEXT[lang]), { voice, lang });
      show(t, type, is);
      moves(type, was, is, wanted);
      staysInPlace(type, volume === 1 ? was : say(signal('volume', volume, TEXT[lang]), { voice, lang }), is);
    }
    const whisper = say(voqual('whispery', TEXT[lang]), { voice, lang });
    assert.ok(whisper.voice.voiced < was.voice.voiced / 3, `whispered: ${whisper.voice.voiced} of the frames are voiced`);
  });

test('the properties of the sound are set one by one', (t) => {
  const was = say(voqual('modal'));
  const wanted = { jitter: [1, { jitter: 0.01 }], shimmer: [1, { shimmer: 0.4 }], aspnoise: [0.3, { hnr: -1 }] };
  for (const [type, [level, change]] of Object.entries(wanted)) {
    const is = say(signal(type, level));
    show(t, type, is);
    moves(type, was, is, change);
    staysInPlace(type, was, is);
  }
  moves('sptilt below the middle', was, say(signal('sptilt', 0.2)), { h1h2: 0.8 });
  moves('sptilt above the middle', was, say(signal('sptilt', 0.8)), { h1h2: -0.8 });
  assert.ok(same(say(signal('sptilt', 0.5)), was), 'the middle is the own tilt');
  for (const type of ['f0flut', 'ampflut']) {
    const is = say(signal(type, 1));
    staysInPlace(type, was, is);
    assert.ok(!same(is, was), type);
  }
});

/* After Drioli, Cosi, Tesser, Tisato 2003, and Gobl and Ni Chasaide 2003: tense anger and joy, lax and breathy sadness, irregular anger, fear
   and disgust. */
const AFFECTS = {
  joy: { h1h2: -0.7, slope: 0.3 },
  anger: { h1h2: -0.8, jitter: 0.001 },
  sadness: { h1h2: 0.5, hnr: -0.3 },
  fear: { h1h2: 0.2, hnr: -0.5 },
  disgust: { jitter: 0.001, hnr: -0.3 },
  surprise: { h1h2: 0.2, hnr: -0.2 },
};

test('each affect changes the quality of the voice its own way, and moves no lips', (t) => {
  for (const [affect, wanted] of Object.entries(AFFECTS)) {
    const text = `<apml><performative type="inform"><rheme affect="${affect}">${TEXT.it}</rheme></performative></apml>`;
    const was = say(text, { from: plain }), is = say(text);
    show(t, `${affect}, by rate and pitch alone`, was);
    show(t, affect, is);
    moves(affect, was, is, wanted);
    staysInPlace(affect, was, is);
  }
});

test('affects are spelled as documents spell them', () => {
  const angry = say(`<apml><performative type="inform"><rheme affect="anger">${TEXT.it}</rheme></performative></apml>`);
  assert.ok(same(say(`<apml><performative type="inform"><affective type="anger" level="1.0">${TEXT.it}</affective></performative></apml>`), angry));
  assert.ok(same(say(TEXT.it, { args: ['--affect', 'anger'] }), angry));
  const less = say(`<apml><performative type="inform"><affective type="anger" level="0.3">${TEXT.it}</affective></performative></apml>`);
  assert.ok(!same(less, angry));
});

test('only the words inside change', () => {
  const words = (inside) => say(`<vsml><performative type="inform">La mamma ama il mare, <voqual type="${inside}">e la luna</voqual>, e il nonno.</performative></vsml>`).wav;
  const was = words('modal').samples, is = words('tense').samples, changed = [...is.keys()].filter((i) => is[i] !== was[i]);
  assert.equal(is.length, was.length);
  assert.ok(changed[0] > 0.3 * is.length && changed.at(-1) < 0.85 * is.length, `${changed[0]} to ${changed.at(-1)} of ${is.length}`);
});

test('what it does not know is told', () => {
  for (const [text, wanted] of [
    [voqual('purple'), /type.*is not a quality of the voice/],
    [voqual('hypernasal'), /the nose is not heard/],
    [voqual('breathy', TEXT.it, '3'), /level.*is not from 0 to 1/],
    [signal('spwarp', 1), /formants are not moved/],
    [signal('colour', 1), /is not a property of the sound/],
    [`<vsml><performative type="inform"><voqual>${TEXT.it}</voqual></performative></vsml>`, /a voqual needs a type/],
  ])
    assert.match(say(text).warnings, wanted);
});
