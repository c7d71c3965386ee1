// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the tables of tests/readings through other software: espeak-ng, Festival (Italian and English) and the front end of kokoro-js (English).
// A text is correct if its phones equal those that the same engine generates from the correct words, ignoring stress, spaces and pauses.
// Usage: node tests/bench/run.mjs readings-others [TEXTS OF EACH LANGUAGE]
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { root } from '../lib/daemon.mjs';

const most = Number(process.argv[2] ?? Infinity);
const languages = ['it', 'en', 'pt-BR', 'tr'];
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-readings-'));

/** Up to `most` lines of a table, spread over it: each a text and its words. */
function table(lang) {
  const lines = fs.readFileSync(path.join(root, `tests/readings/${lang}.tsv`), 'utf8').split('\n').filter(Boolean).map((line) => line.split('\t'));
  const step = Math.max(1, lines.length / most);
  return lines.filter((_, i) => Math.floor(i / step) !== Math.floor((i - 1) / step) || i === 0).slice(0, most);
}

function espeak(lang, texts) {
  const voice = { it: 'it', en: 'en-us', 'pt-BR': 'pt-br', tr: 'tr' }[lang];
  return texts.map((text) => execFileSync('espeak-ng', ['-q', '--ipa', '-v', voice, '--stdin'], { input: text, encoding: 'utf8' }));
}

/** Festival's modules from text to segments, for all texts in one process. A text that aborts it has no phones. */
function festival(lang, texts) {
  const voice = { it: 'voice_lp_diphone', en: 'voice_kal_diphone' }[lang];
  const quoted = (text) => `"${text.replace(/[’‘]/g, "'").replace(/[\\"]/g, ' ').replace(/[^\x20-\xFF]/g, ' ')}"`;
  const script = `(${voice})
(define (phones_of text)
  (let ((u (eval (list 'Utterance 'Text text))))
    (Initialize u) (Text u) (Token_POS u) (Token u) (POS u) (Phrasify u) (Word u) (PostLex u)
    (mapcar (lambda (s) (format t "%s " (item.name s))) (utt.relation.items u 'Segment))))
${texts.map((text) => `(unwind-protect (phones_of ${quoted(text)}) nil)\n(format t "\\n=\\n")`).join('\n')}`;
  const file = path.join(folder, 'texts.scm');
  fs.writeFileSync(file, script, 'latin1');
  const { stdout } = spawnSync('festival', ['--batch', file], { encoding: 'latin1', maxBuffer: 1 << 28 });
  const found = stdout.split('\n=\n').map((phones) => phones.replace(/\b(?:pau|#)\b|#/g, ''));
  return texts.map((_, i) => found[i] ?? '');
}

/** Phonemes of a text as kokoro-js passes them to its model, which is not loaded here. */
async function kokoro(texts) {
  const modules = path.join(folder, 'node_modules');
  for (const name of ['kokoro-js', 'phonemizer']) {
    fs.mkdirSync(path.join(modules, name), { recursive: true });
    const archive = execFileSync('npm', ['pack', '--silent', `${name}@1.2.1`], { cwd: folder, encoding: 'utf8' }).trim().split('\n').at(-1);
    execFileSync('tar', ['xzf', path.join(folder, archive), '-C', path.join(modules, name), '--strip-components=1']);
  }
  const model = path.join(modules, '@huggingface/transformers');
  fs.mkdirSync(model, { recursive: true });
  fs.writeFileSync(path.join(model, 'package.json'), '{"type":"module","main":"index.js"}');
  fs.writeFileSync(path.join(model, 'index.js'), 'class None {}\nexport { None as StyleTextToSpeech2Model, None as AutoTokenizer, None as Tensor, None as RawAudio };\nexport const env = {};\n');
  const { KokoroTTS } = await import(pathToFileURL(path.join(modules, 'kokoro-js/dist/kokoro.js')));
  const all = [];
  for (const text of texts) {
    const tokenizer = (phonemes) => {
      all.push(phonemes);
      throw new Error('the phonemes are known');
    };
    await new KokoroTTS({}, tokenizer).generate(text, { voice: 'af_heart' }).catch((error) => {
      if (error.message !== 'the phonemes are known') throw error;
    });
  }
  return all;
}

const bare = (phones) => phones.replace(/\([a-z-]+\)/g, '').replace(/[ˈˌ\s.,;:!?…"“”«»()—_'-]/g, '');
const share = (phones, right) => `${((100 * phones.filter((one, i) => bare(one) && bare(one) === bare(right[i])).length) / phones.length).toFixed(0)} %`;

console.log('| | texts | espeak-ng | Festival | Kokoro |\n|---|---|---|---|---|');
for (const lang of languages) {
  const lines = table(lang), texts = lines.map(([text]) => text), words = lines.map(([, right]) => right);
  const row = [lang, lines.length, share(espeak(lang, texts), espeak(lang, words))];
  row.push(['it', 'en'].includes(lang) ? share(festival(lang, texts), festival(lang, words)) : '-');
  row.push(lang === 'en' ? share(await kokoro(texts), await kokoro(words)) : '-');
  console.log(`| ${row.join(' | ')} |`);
}
fs.rmSync(folder, { recursive: true });
