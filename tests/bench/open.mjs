// SPDX-License-Identifier: GPL-3.0-or-later
// Latency of open texts: from the last token of the first sentence to the first media message, beside a `speak` of that sentence alone, in
// turns. The writer imitates a language model: a token of up to five characters per interval.
// Usage: node tests/bench/run.mjs open [RUNS]; FACCIA_BUILD=... measures another build
import { setTimeout as sleep } from 'node:timers/promises';
import { Daemon } from '../lib/daemon.mjs';
import { median, quantile } from './figures.mjs';

const runs = Number(process.argv[2] ?? 20);
const daemon = await Daemon.start(['--cache', '0']);
/** The first sentence, and what follows. */
const TEXTS = {
  it: ['Nel mezzo del cammino di nostra vita mi ritrovai per una selva oscura.', ' Poi viene una seconda frase. E una terza.'],
  'pt-BR': ['O vento norte e o sol discutiam para saber qual dos dois era o mais forte.', ' Depois vem uma segunda frase. E uma terceira.'],
  tr: ['Poyraz ile güneş birbirlerinden daha güçlü olduklarını ileri sürerek tartışıyorlardı.', ' Sonra ikinci bir cümle gelir. Bir de üçüncü.'],
  en: ['The north wind and the sun were arguing about which of them was the stronger.', ' Then comes a second sentence. And a third one.'],
};
let lang, first, rest; // the current case
const tokens = (text) => text.match(/[^]{1,5}/g);

/** ms from the last token, whose time `act` returns, to the first media. */
async function measure(act) {
  const stream = await daemon.stream();
  await stream.wait({ type: 'hello' });
  const last = await act(stream);
  await stream.until(() => stream.chunks.length > 0);
  const taken = stream.chunks[0].arrived - last;
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end' });
  await stream.close();
  return taken;
}

const speak = (stream) => {
  const now = performance.now();
  stream.send({ type: 'speak', id: 'a', lang, text: first });
  return now;
};

/** Opens a text without its final full stop, then calls `then`. */
const open = (then) => async (stream) => {
  stream.send({ type: 'speak', id: 'a', lang, open: true });
  for (const text of tokens(first.slice(0, -1))) stream.send({ type: 'text', id: 'a', text });
  await sleep(20);
  const now = performance.now();
  stream.send({ type: 'text', id: 'a', text: '.' });
  await then(stream);
  return now;
};

const paced = (perSecond) =>
  open(async (stream) => {
    for (const text of tokens(rest)) {
      await sleep(1000 / perSecond);
      stream.send({ type: 'text', id: 'a', text });
    }
  });

const ways = {
  'speak of the sentence': speak,
  'closed with the full stop': open((stream) => stream.send({ type: 'close', id: 'a' })),
  'flushed with it': open((stream) => stream.send({ type: 'flush', id: 'a' })),
  'the next token at once': open((stream) => stream.send({ type: 'text', id: 'a', text: ' Poi' })),
  'the next token at 100 a second': paced(100),
  'the next token at 50 a second': paced(50),
  'the next token at 20 a second': paced(20),
  'nothing follows': open(() => {}),
  'the whole text at once, open': async (stream) => {
    const now = performance.now();
    stream.send({ type: 'speak', id: 'a', lang, open: true, text: first + rest });
    stream.send({ type: 'close', id: 'a' });
    return now;
  },
  'the whole text at once, speak': async (stream) => {
    const now = performance.now();
    stream.send({ type: 'speak', id: 'a', lang, text: first + rest });
    return now;
  },
};

for ([lang, [first, rest]] of Object.entries(TEXTS)) {
  const found = Object.fromEntries(Object.keys(ways).map((name) => [name, []]));
  for (let run = -2; run < runs; run++)
    for (const [name, act] of Object.entries(ways)) {
      const taken = await measure(act);
      if (run >= 0) found[name].push(taken);
    }
  const base = median(found['speak of the sentence']);
  console.log(`${lang} (${first.length} characters, ${runs} runs, medians)`);
  for (const [name, all] of Object.entries(found))
    console.log(`  ${name}: ${median(all).toFixed(1)} ms (90 %: ${quantile(all, 0.9).toFixed(1)}), above speak ${(median(all) - base).toFixed(1)} ms`);
}
await daemon.stop();
