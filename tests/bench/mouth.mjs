// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts and openings of 25 sentences a language, at four rates, neutral and in five emotions, by both blends, with all engines of the
// language. Usage: [RATES=320] node tests/bench/mouth.mjs [LANG]...
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { SHORT, addMouth, readMouth } from '../lib/mouth.mjs';
import { sentences } from '../lib/sentences.mjs';

const FPS = 50;
const engines = { it: ['dominance', 'cohen-massaro', 'table'], 'pt-BR': ['dominance', 'context'], tr: ['dominance', 'syllable'], en: ['dominance', 'cohen-massaro', 'table'] };
const emotions = [null, 'anger', 'happiness', 'sadness', 'surprise', 'disgust'];
const rates = (process.env.RATES ?? '80,160,240,320').split(',');
const env = { ...process.env, FACCIA_MODELS: path.join(build, 'models'), FACCIA_PLUGINS: path.join(build, 'server/plugins'), FACCIA_WORKER: path.join(build, 'server/voice/faccia-voice') };
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const [fap, json] = ['a.fap', 'a.json'].map((name) => path.join(folder, name));

function speak(lang, engine, rate, emotion, blend) {
  const words = sentences[lang].join('\n');
  const text = `<speak>${emotion ? `<emotion><category name="${emotion}"/>${words}</emotion>` : words}</speak>`;
  const say = () => execFileSync(path.join(build, 'server/app/faccia'), ['say', '--lang', lang, '--engine', engine, '--rate', rate, '--blend', blend, '--markup', 'ssml', '--fps', FPS, '--fap', fap, '--json', json, '-'], { env, input: text, stdio: ['pipe', 'pipe', 'pipe'] });
  try {
    say();
  } catch (e) {
    console.log(`again: ${e.stderr}`); // a voice may be too slow to start on a busy machine
    say();
  }
  return readMouth(JSON.parse(fs.readFileSync(json)).phones, parseFap(fs.readFileSync(fap, 'utf8')));
}

const langs = process.argv.length > 2 ? process.argv.slice(2) : Object.keys(sentences);
for (const lang of langs) {
  for (const engine of engines[lang]) {
    for (const rate of rates) {
      for (const blend of ['regions', 'weighted']) {
        const sum = emotions.reduce((all, emotion) => addMouth(all, speak(lang, engine, rate, emotion, blend)), {});
        const gaps = sum.gaps.toSorted((a, b) => a.mm - b.mm);
        const long = gaps.filter((g) => g.seconds >= SHORT);
        const below = (mm) => gaps.filter((g) => g.mm < mm).length;
        console.log(`${lang} ${engine} ${rate} ${blend}: lips ${sum.closed}/${sum.lips}, teeth ${sum.met}/${sum.teeth}; open vowels ${sum.open}: median ${gaps[gaps.length >> 1].mm.toFixed(1)} mm, ` +
          `below 1 mm ${below(1)}, below 3 mm ${below(3)}; of ${SHORT * 1000} ms and more ${long.length}: least ${long[0].mm.toFixed(1)} mm`);
      }
    }
  }
}
fs.rmSync(folder, { recursive: true });
