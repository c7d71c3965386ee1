// SPDX-License-Identifier: GPL-3.0-or-later
// Texts for the benchmarks: Italian prose written for them, of any length.
import { manzoni } from '../lib/texts.mjs';

const paragraph = `La mattina il bibliotecario apre le grandi finestre della sala e lascia entrare la luce. Sui tavoli aspettano
i libri del giorno prima, ancora aperti alla pagina in cui qualcuno li ha lasciati. Prima di riporli ne legge sempre una riga, a
bassa voce, come si saluta un amico. Poi prepara il caffè, sfoglia il giornale e pensa a chi verrà. Verrà la maestra con i
bambini, che vogliono storie di lupi e di mare. Verrà il signore che non sente bene, e che guarda le labbra di chi parla per
capire ogni parola. Per lui il bibliotecario parla piano, senza fretta, e non copre mai la bocca con la mano. `;

/** Italian text of about that many seconds at espeak-ng's default rate (13 characters a second). */
export function prose(seconds) {
  const one = paragraph.replace(/\s+/g, ' ');
  const count = Math.max(1, Math.ceil((seconds * 13) / one.length));
  return one.repeat(count);
}

/** One sentence of it. */
export const sentence = 'Per lui il bibliotecario parla piano, senza fretta, e non copre mai la bocca con la mano.';

/** Building blocks of sentences: clauses of a novel. */
const clauses = manzoni.split(/[,;:.]\s+/).map((part) => part.trim()).filter((part) => part.length > 12);

/** Random sentences of that total length; each seed gives others. */
export function varied(length, seed) {
  let [text, state] = ['', seed * 2654435761 >>> 0];
  const dice = (count) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * count);
  };
  while (text.length < length) {
    const said = Array.from({ length: 2 + dice(2) }, () => clauses[dice(clauses.length)]).join(', ');
    text += `${said[0].toUpperCase()}${said.slice(1)}. `;
  }
  return text;
}
