// SPDX-License-Identifier: GPL-3.0-or-later
// Effect of each part of visible speech: engines, the contact layer, shape and resistance separately; closures at the times of the phones.
//     node tests/bench/run.mjs ablation [LANG...]
import { spawnSync } from 'node:child_process';
import path from 'node:path';
import { build } from '../lib/daemon.mjs';

const texts = {
  it: 'La mamma parla piano, papà beve il vino. Abbiamo una bomba per il pubblico, e un fiume favoloso. Fabio vuole provare la pompa prima di pagare. Ieri sera pioveva, ma il vapore passava fra le piante. Un bravo fabbro batte il ferro e poi beve vino buono. Piove ancora, prendi l\'ombrello e vieni via con Vittoria.',
  'pt-BR': 'A mamãe fala baixo, o papai bebe vinho. Uma bomba para o público, e um favor famoso. Fábio quer provar a pimenta antes de pagar. O vapor passava entre as plantas. Um bom homem bate o ferro e bebe vinho puro.',
  tr: 'Babam bana biber verdi, annem portakal seviyor. Fabrika, vapur ve mavi boya. Pembe perde pencereye çok yakışmış. Akşam bembeyaz bir vapur geçti. Fatma evin bahçesinde mavi papatya buldu.',
  en: 'My mother baked a pie, but father brought very few berries. Happy people move five boxes. Bob found a map of the moving river. The vapour passed before the evening. Please pay for my broom and five brown envelopes.',
};
const percent = (value) => (value === null ? '' : `${Math.round(100 * value)}`);
for (const lang of process.argv.length > 2 ? process.argv.slice(2) : Object.keys(texts)) {
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['eval', '--lang', lang, '--rates', '80,160,240,320', '--ablation', '--json', '-', texts[lang]], { maxBuffer: 1 << 28 });
  if (status !== 0) throw new Error(String(stderr));
  const { rows } = JSON.parse(stdout);
  console.log(`\n${lang}: ${rows[0].bilabials} bilabials, ${rows[0].labiodentals} labiodentals; % at 80, 160, 240, 320 words a minute\n`);
  console.log('| engine | contacts | lips close | held | lip on teeth | held | vowels open | shapes apart |\n|---|---|---|---|---|---|---|---|');
  for (const key of new Set(rows.map((row) => `${row.engine} | ${row.contacts}`))) {
    const own = rows.filter((row) => `${row.engine} | ${row.contacts}` === key);
    const list = (name) => own.map((row) => percent(row[name])).join(' ');
    console.log(`| ${key} | ${['lips_seen', 'lips_held', 'teeth_seen', 'teeth_held', 'opening', 'reader'].map(list).join(' | ')} |`);
  }
}
