// SPDX-License-Identifier: GPL-3.0-or-later
// Makes works for libraries: valid and invalid EPUBs, and texts of any size.
import { execFileSync } from 'node:child_process';

const ZIP = `
import json, sys, zipfile
with zipfile.ZipFile(sys.argv[1], 'w', zipfile.ZIP_DEFLATED) as z:
    for name, text in json.load(sys.stdin).items():
        if isinstance(text, int):
            with z.open(name, 'w') as f:
                for _ in range(text): f.write(bytes(1 << 20))
        else:
            z.writestr(name, text)
`;

/** Writes a ZIP archive: name -> text, or a number of megabytes of zeros. */
export const writeZip = (file, entries) => execFileSync('python3', ['-c', ZIP, file], { input: JSON.stringify(entries) });

const container = (opf) => `<container xmlns="urn:oasis:names:tc:opendocument:xmlns:container" version="1.0"><rootfiles>
<rootfile full-path="${opf}" media-type="application/oebps-package+xml"/></rootfiles></container>`;

/** Makes the files of an EPUB 3 with these documents (name -> body) in its spine. */
export const epub = (documents, { title = 'Un libro', lang = 'it', doctype = '', opf = 'OEBPS/book.opf' } = {}) => {
  const names = Object.keys(documents);
  const entries = {
    mimetype: 'application/epub+zip',
    'META-INF/container.xml': container(opf),
    [opf]: `<package xmlns="http://www.idpf.org/2007/opf" version="3.0" unique-identifier="id"><metadata xmlns:dc="http://purl.org/dc/elements/1.1/">
<dc:identifier id="id">urn:x</dc:identifier><dc:title>${title}</dc:title><dc:creator>A. Rossi</dc:creator><dc:language>${lang}</dc:language></metadata>
<manifest>${names.map((name, i) => `<item id="d${i}" href="${name}" media-type="application/xhtml+xml"/>`).join('')}</manifest>
<spine>${names.map((_, i) => `<itemref idref="d${i}"/>`).join('')}</spine></package>`,
  };
  for (const [name, body] of Object.entries(documents))
    entries[`OEBPS/${name}`] = typeof body === 'number' ? body : `<?xml version="1.0"?>${doctype}<html xmlns="http://www.w3.org/1999/xhtml"><head><title>x</title></head><body>${body}</body></html>`;
  return entries;
};

/** Generates sentences of synthetic words from a seed, with Zipf's distribution (the nth word has frequency 1/n). */
export function* sentencesOf(seed, words = 5000) {
  let state = seed >>> 0 || 1;
  const random = () => ((state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32);
  const syllables = ['ma', 're', 'lu', 'na', 'ti', 'co', 'se', 'vi', 'do', 'pa', 'gio', 'che', 'ra', 'ni', 'fo', 'bel'];
  const word = (n) => {
    let text = '';
    for (let rest = n + 17; rest > 0; rest = Math.floor(rest / 16)) text += syllables[rest % 16];
    return text;
  };
  for (;;) {
    const length = 6 + Math.floor(random() * 12);
    yield Array.from({ length }, () => word(Math.floor(words ** random()) - 1)).join(' ') + '.';
  }
}
