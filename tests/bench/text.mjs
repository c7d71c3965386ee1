// SPDX-License-Identifier: GPL-3.0-or-later
// The texts that the benchmarks speak: plain Italian prose of our own, as long as asked for.
const paragraph = `La mattina il bibliotecario apre le grandi finestre della sala e lascia entrare la luce. Sui tavoli aspettano
i libri del giorno prima, ancora aperti alla pagina in cui qualcuno li ha lasciati. Prima di riporli ne legge sempre una riga, a
bassa voce, come si saluta un amico. Poi prepara il caffè, sfoglia il giornale e pensa a chi verrà. Verrà la maestra con i
bambini, che vogliono storie di lupi e di mare. Verrà il signore che non sente bene, e che guarda le labbra di chi parla per
capire ogni parola. Per lui il bibliotecario parla piano, senza fretta, e non copre mai la bocca con la mano. `;

/** Italian text that espeak-ng at its own rate speaks for about so many seconds (13 characters a second). */
export function prose(seconds) {
  const one = paragraph.replace(/\s+/g, ' ');
  const count = Math.max(1, Math.ceil((seconds * 13) / one.length));
  return one.repeat(count);
}

/** One sentence of it. */
export const sentence = 'Per lui il bibliotecario parla piano, senza fretta, e non copre mai la bocca con la mano.';
