// SPDX-License-Identifier: GPL-3.0-or-later
// Loudness of speech (EBU R 128), by ffmpeg's ebur128.
import { execFileSync, spawnSync } from 'node:child_process';

/** The loudest that any affect may be, LUFS: -19 within 2. */
export const LOUDEST = -17;

export const TEXTS = {
  it: 'Domani mattina andiamo insieme al mercato, e poi torniamo a casa. Che cosa vuole mangiare per pranzo? Non mi aspettavo di vederla qui.',
  en: 'Tomorrow morning we go to the market together, and then we come home. What would you like for lunch? I did not expect to see you here.',
  pt: 'Amanhã de manhã vamos juntos ao mercado, e depois voltamos para casa. O que quer comer no almoço? Não esperava ver você aqui.',
  tr: 'Yarın sabah birlikte pazara gidiyoruz, sonra eve dönüyoruz. Öğle yemeğinde ne yemek istersiniz? Sizi burada görmeyi beklemiyordum.',
};

/** Speaks the text of the language. @returns {{level: number, peak: number}} LUFS, dBTP @param {string} faccia program @param {string} file for the sound */
export function loudness(faccia, file, lang, affect) {
  execFileSync(faccia, ['say', '-l', lang, ...(affect ? ['--affect', affect] : []), '--wav', file, TEXTS[lang]], { stdio: ['ignore', 'ignore', 'pipe'] });
  const { stderr } = spawnSync('ffmpeg', ['-nostats', '-i', file, '-af', 'ebur128=peak=true', '-f', 'null', '-'], { encoding: 'utf8' });
  const summary = stderr.slice(stderr.lastIndexOf('Summary:'));
  return { level: Number(/I:\s+(-?[\d.]+)/.exec(summary)[1]), peak: Number(/Peak:\s+(-?[\d.]+)/.exec(summary)[1]) };
}
