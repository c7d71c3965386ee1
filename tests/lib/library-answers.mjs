// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of a library (protocol/library.md) for testing pages without one.

const verses = ['Il mare è calmo, la luna è piena,', 'la barca torna con la vela scura,', 'e chi la guarda dalla riva attende', 'una parola, e ancora non la sente.', 'Poi si alza il vento, e il giorno ricomincia.'];
const lines = (first) => verses.map((line, i) => {
  const start = verses.slice(0, i).join('\n').length + (i ? 1 : 0);
  return { id: `mare:1:l${first + i}`, n: String(first + i), start, end: start + line.length };
});
const work = { id: 'mare', title: 'Il mare', author: 'A. Rossi', lang: 'it' };
export const section = {
  id: 'mare:1', number: 1, title: 'Canto primo', level: 1, previous: null, next: null, recording: null, work,
  blocks: [
    { kind: 'head', id: 'mare:1:h1', lang: 'it', text: 'Canto primo', level: 1 },
    { kind: 'speaker', text: 'Anna' },
    { kind: 'verse', id: 'mare:1:g1', lang: 'it', speaker: 'Anna', text: verses.join('\n'), lines: lines(1) },
    { kind: 'page', n: '12' },
    { kind: 'paragraph', id: 'mare:1:p1', lang: 'it', text: 'Disse good morning, e basta.',
      marks: [{ kind: 'foreign', start: 6, end: 18, lang: 'en' }, { kind: 'note', start: 18, end: 18, note: 'mare:1:n1' }, { kind: 'emphasis', start: 22, end: 27 }] },
    { kind: 'note', id: 'mare:1:n1', lang: 'it', n: '1', text: 'In inglese nel testo.' },
    { kind: 'stage', text: 'Escono.' },
    { kind: 'verse', id: 'mare:1:g2', lang: 'it', text: verses.join('\n'), lines: lines(6) },
    { kind: 'verse', id: 'mare:1:g3', lang: 'it', text: verses.join('\n'), lines: lines(11) },
  ],
};
const result = (passage, n, text, marks) => ({
  passage, kind: 'line', n, block: 'mare:1:g1', lang: 'it', score: 7.4, work, section: { id: 'mare:1', number: 1, title: 'Canto primo' }, recording: false,
  snippet: { text, marks, before: false, after: false },
});

/** Functions of the query, by path. */
export const answers = {
  '/v1/library': () => ({
    state: 'ready', done: 1, of: 1, languages: ['it'], authors: ['A. Rossi'], characters: 700, problems: [],
    works: [{ ...work, date: '2026', format: 'tei', file: 'mare.xml', sections: 1, passages: 19, characters: 700, hash: '9f', recording: false }],
  }),
  '/v1/library/works/mare': () => ({ ...work, passages: 19, characters: 700, recording: false, hash: '9f', sections: [{ id: 'mare:1', number: 1, title: 'Canto primo', level: 1 }] }),
  '/v1/library/works/mare/sections/1': () => section,
  '/v1/library/search': (query) => {
    const results = /luna/i.test(query.get('q')) ? [result('mare:1:l1', '1', verses[0], [[20, 24]]), result('mare:1:l6', '6', verses[0], [[20, 24]])] : [];
    const count = results.length;
    const facet = (...values) => (count ? values.map((value) => ({ value, count })) : []);
    return {
      results, total: count, counted: true, ranked: true, titles: [],
      facets: { author: facet('A. Rossi'), lang: facet('it'), form: facet('verse'), century: facet(21), work: facet({ id: 'mare', title: 'Il mare' }) },
    };
  },
};

/** Serves the answers to a page. @param {import('playwright-core').Page} page */
export const answerLibrary = (page) =>
  page.route('**/v1/library**', (route) => {
    const { pathname, searchParams } = new URL(route.request().url());
    const answer = answers[pathname];
    return answer ? route.fulfill({ json: answer(searchParams) }) : route.fulfill({ status: 404, json: { type: 'error', code: 'not-found', message: '-' } });
  });
