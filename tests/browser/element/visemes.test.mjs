// SPDX-License-Identifier: GPL-3.0-or-later
// A contact sheet of the head for each language (in the artefacts): the middle of every viseme group between two vowels. The test checks
// that the groups differ in the pixels of the mouth, as lip readers need.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch, openPage, picture } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

// For each language a text and the phones examined: one of each visually distinct group.
const languages = {
  it: ['Apa, afa, sasso, ata, acqua. Vino, ufo, aula, bocca, piedi, cena, sciame, lana.', ['p', 'f', 's', 't', 'k', 'u', 'o', 'i', 'tʃ', 'ʃ', 'a', 'l']],
  'pt-BR': ['A pata fala. O sapo come uva. Chuva, dia, lua, gente.', ['p', 'f', 's', 't', 'k', 'u', 'i', 'ʃ', 'a', 'l']],
  tr: ['Baba fakat susuyor. İki şişe kapı açık, üzüm var, lale, çocuk.', ['b', 'f', 's', 't', 'k', 'u', 'i', 'ʃ', 'a', 'l', 'tʃ']],
  en: ['The path of my father. She saw two boats, a cake, and a lazy fish in the pool.', ['p', 'f', 's', 't', 'k', 'ʃ', 'θ', 'l']],
};

let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  page = await openPage(browser, daemon.url, { quality: 'high' });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Crops the mouth from a picture. */
function mouthOf(png) {
  const [left, top, width, height] = [0.3, 0.52, 0.4, 0.32].map((share, i) => Math.round(share * (i % 2 ? png.height : png.width)));
  const mouth = new PNG({ width, height });
  PNG.bitblt(png, mouth, left, top, width, height, 0, 0);
  return mouth;
}

/** Mean difference of two pictures, 0 to 255. */
function distance(a, b) {
  let sum = 0;
  for (let i = 0; i < a.data.length; i++) sum += Math.abs(a.data[i] - b.data[i]);
  return (sum / a.data.length) * (4 / 3); // the fourth channel is opacity
}

for (const [lang, [text, wanted]] of Object.entries(languages))
  test(`${lang}: all visemes differ`, async () => {
    const post = async (format) => daemon.get(`/v1/speech?lang=${lang}&still=1&fps=100&format=${format}`, { method: 'POST', body: text, headers: { 'content-type': 'text/plain' } });
    const { phones } = await (await post('json')).json();
    const { fps, frames } = parseFap(await (await post('fap')).text());
    const mouths = [];
    for (const ipa of wanted) {
      // the longest phone of a kind is the clearest
      const phone = phones.filter((p) => p.ipa.startsWith(ipa)).sort((a, b) => b.end - b.start - a.end + a.start)[0];
      assert.ok(phone, `no /${ipa}/ among ${phones.map((p) => p.ipa).join(' ')}`);
      const png = await picture(page, `viseme-${lang}-${ipa}`, frames[Math.round(((phone.start + phone.end) / 2) * fps)]);
      mouths.push({ ipa, png: mouthOf(png) });
    }
    const { width, height } = mouths[0].png;
    const sheet = new PNG({ width: width * 4, height: height * Math.ceil(mouths.length / 4) });
    mouths.forEach(({ png }, i) => PNG.bitblt(png, sheet, 0, 0, width, height, (i % 4) * width, Math.floor(i / 4) * height));
    fs.writeFileSync(path.join(artefacts, `visemes-${lang}.png`), PNG.sync.write(sheet));
    // sounds within a group may look alike; these pairs must not
    const pairs = [['p', 'f'], ['b', 'f'], ['p', 'a'], ['b', 'a'], ['f', 's'], ['u', 'i'], ['u', 'a'], ['i', 'a'], ['ʃ', 's']];
    for (const [a, b] of pairs) {
      const [one, other] = [a, b].map((ipa) => mouths.find((m) => m.ipa === ipa));
      if (!one || !other) continue;
      const d = distance(one.png, other.png);
      assert.ok(d > 0.8, `/${a}/ and /${b}/ differ by ${d.toFixed(2)} of 255`);
    }
  });
