// SPDX-License-Identifier: GPL-3.0-or-later
// Mouth frames: the mouth through one sentence of each language, a picture every 80 ms with the phone that is heard, for the eye to judge.
// Usage: node tests/bench/run.mjs mouth-frames [--head mara] [--out FILE.webp] [--every 80] [--width 120] [LANG]...
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { launch } from '../lib/browser.mjs';
import { heads } from '../lib/built-heads.mjs';
import { root } from '../lib/daemon.mjs';
import { headPage } from '../lib/head-page.mjs';
import { closeUp, said } from '../lib/mouth-poses.mjs';
import { captioned } from '../lib/picture-sheets.mjs';

/** With closures, tucked and round lips, and open and spread vowels. */
const SENTENCES = {
  it: 'Buongiorno, la farfalla vola sul fiume.',
  'pt-BR': 'Bom dia, a fada viu uma chuva fina.',
  tr: 'Günaydın, babam bu şarkıyı seviyor.',
  en: 'Good morning, the boat moves with five fish.',
};

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    head: { type: 'string', default: 'mara' }, out: { type: 'string', default: path.join(root, 'web/frames.webp') },
    every: { type: 'string', default: '80' }, width: { type: 'string', default: '120' },
  },
});
const [width, every] = [Number(values.width), Number(values.every) / 1000];
const langs = positionals.length ? positionals : Object.keys(SENTENCES);
const unknown = langs.find((lang) => !SENTENCES[lang]);
if (unknown) throw new Error(`no language '${unknown}': ${Object.keys(SENTENCES).join(' ')}`);
if (!(width >= 60 && width <= 600 && every >= 0.01 && every <= 1)) throw new Error('--width is 60 to 600 pixels, --every 10 to 1000 milliseconds');

const head = JSON.parse(fs.readFileSync(path.join(heads, `${values.head}.json`)));
const camera = closeUp(head, 2 * width);
const browser = await launch();
const page = await headPage(browser);
await page.load('head', head);

const parts = [];
for (const lang of langs) {
  const { phones, fps, frames } = said(SENTENCES[lang], ['--lang', lang, '--still']);
  const figures = [];
  for (let t = phones[0].start; t < phones.at(-1).end; t += every) {
    const png = await page.shot('head', frames[Math.min(frames.length - 1, Math.round(t * fps))], camera);
    const phone = phones.find(({ end }) => t < end);
    figures.push({ png, caption: phone.ipa });
  }
  parts.push({ title: SENTENCES[lang], lang, figures });
}
const sheet = await captioned(browser, parts, { columns: 12, width, gap: 4 });
await browser.close();
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');
await sharp(sheet).webp({ quality: 82, effort: 6 }).toFile(values.out);
console.log(`${values.out}: ${fs.statSync(values.out).size} bytes`);
