// SPDX-License-Identifier: GPL-3.0-or-later
// The table of the theses in the documentation: each command runs as printed, and each test and picture is there.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';
import { unpack } from '../../../models/tools/lib/deform.mjs';
import { ordinary, root } from '../../lib/daemon.mjs';
import { openStudio } from '../../lib/photographs.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-theses-'));
after(() => fs.rmSync(folder, { recursive: true }));
const put = (name, text) => fs.writeFileSync(path.join(folder, name), text);

const rows = fs.readFileSync(path.join(root, 'web/docs/research/theses.md'), 'utf8').split('\n').filter((line) => /^\| 00\d \|/.test(line)).map((line) => {
  const [, thesis, item, command, source, picture] = line.split(' |').map((cell) => cell.replace(/^\|?\s*/, '').trim());
  const code = (cell) => cell.match(/^`([^`]+)`$/)?.[1] ?? null;
  return { thesis: line.slice(2, 5), item: thesis.startsWith('00') ? item : thesis, command: [item, command, source].map(code).find((c) => /^(faccia|node) /.test(c ?? '')), cells: [command, source, picture].map((cell) => code(cell ?? '')) };
});

/* Inputs of the names that the table has. */
before(() => {
  fs.symlinkSync(path.join(root, 'models'), path.join(folder, 'models'));
  fs.copyFileSync(path.join(ordinary, 'models/heads/mara.json'), path.join(folder, 'mara.json'));
  put('apml.xml', '<apml><performative type="inform"><rheme affect="joy">Ciao.</rheme></performative></apml>');
  put('jsml.xml', '<SENT><SAD>hüzün</SAD> <HAPPY>sevinç</HAPPY></SENT>');
  const phones = ['', 'a', 'p', 'a', '', 'a', 'm', 'a', ''];
  const at = (i) => 0.2 * i;
  put('her.phones.csv', `start,end,phone\n${phones.map((ipa, i) => `${at(i)},${at(i + 1)},${ipa || '_'}`).join('\n')}\n`);
  const opening = (t) => (phones[Math.min(8, Math.floor(t / 0.2))] === 'a' ? 8 * Math.sin((Math.PI * (t % 0.2)) / 0.2) : 0);
  put('her.csv', `time,LI\n${Array.from({ length: 180 }, (_, k) => `${(k / 100).toFixed(2)},${opening(k / 100).toFixed(3)}`).join('\n')}\n`);
  const markers = { nose: [0, 40, 20], upperLip: [0, 8, 15], leftCorner: [25, 0, 5], rightCorner: [-25, 0, 5], lowerLip: [0, -8, 13], chin: [0, -35, 8], leftEar: [70, 40, -80], rightEar: [-70, 40, -80] };
  const table = (axes, place) => `${['time', ...Object.keys(markers).flatMap((name) => axes.map((axis) => `${name}_${axis}`))].join(',')}\n${Array.from({ length: 60 }, (_, k) => [(k / 100).toFixed(2), ...Object.entries(markers).flatMap(([name, p]) => place(p.map((v, axis) => v - (name === 'lowerLip' && axis === 1 && k > 30 ? 4 : 0))))].join(',')).join('\n')}\n`;
  put('markers.csv', table(['x', 'y', 'z'], (p) => p));
  const projections = [-200, 200].map((x) => [[1000, 0, -500, 1000 * -x + 500 * 1000], [0, -1000, -500, 500 * 1000], [0, 0, -1, 1000]]);
  put('cameras.json', JSON.stringify({ cameras: projections.map((projection) => ({ projection })) }));
  for (const [i, name] of ['left.csv', 'right.csv'].entries())
    put(name, table(['x', 'y'], (p) => {
      const [x, y, w] = projections[i].map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
      return [x / w, y / w];
    }));
  put('transcription.txt', '0: 680 ##\n1: 1048 nn\n2: 3464 \'a~\n3: 5686 uu\n4: 8694 ##\n5: 10538\n');
  put('one.json', JSON.stringify({ lang: 'it', carrier: 'Dice {item}.', snrs: [0], items: [{ name: 'mamma', text: 'mamma' }], page: {} }));
  put('answers.csv', `listener,mode,snr,correct\n${['a', 'b'].flatMap((who) => ['audio', 'face'].flatMap((mode, m) => [0, 1, 2].map((k) => `${who},${mode},-12,${Number(k < m + (who === 'a'))}`))).join('\n')}\n`);
});

/* Photographs of a few mouths, for a set of pictures. */
before(async () => {
  const take = await openStudio(unpack(JSON.parse(fs.readFileSync(path.join(ordinary, 'models/heads/rosa.json'), 'utf8'))));
  const { poses } = JSON.parse(fs.readFileSync(path.join(root, 'models/pictures/poses.json'), 'utf8'));
  fs.mkdirSync(path.join(folder, 'photographs'));
  for (const name of ['rest', 'p1', 'u', 'a', 'i1', 't1', 'o', 'e', 'f2'])
    fs.writeFileSync(path.join(folder, 'photographs', `${name}.png`), await take(poses.find((pose) => pose.name === name).faps));
});

test('the table has all three theses', () => {
  assert.ok(rows.length >= 20, `${rows.length} rows`);
  assert.deepEqual([...new Set(rows.map(({ thesis }) => thesis))], ['000', '001', '002']);
});

describe('each row', () => {
  for (const { thesis, item, command, cells } of rows)
    test(`${thesis} ${item}: ${command}`, () => {
      assert.ok(command, 'a command');
      const named = cells.find((cell) => /^(daemon|unit|models|browser|web|protocol)\/\S+\.(test\.mjs|c)$/.test(cell ?? ''));
      assert.ok(named && fs.existsSync(path.join(root, 'tests', named)), `its test: ${named}`);
      const shell = command.replace(/(^|&& )faccia /g, `$1"${path.join(ordinary, 'server/cli/faccia')}" --models "${path.join(ordinary, 'models')}" `);
      const { status, stdout, stderr } = spawnSync('sh', ['-c', shell], { cwd: folder, encoding: 'utf8', maxBuffer: 1 << 26 });
      assert.equal(status, 0, `${stderr.slice(0, 2000)}${stdout.slice(0, 500)}`);
      for (const [, output] of command.matchAll(/ (?:--wav|--fap|--svg|-o) ([\w-]+\.(?:wav|fap|svg|html|json|csv|wrl|png))/g)) assert.ok(fs.statSync(path.join(folder, output)).size > 40, output);
      const picture = cells.find((cell) => /\.(svg|png|webp)$/.test(cell ?? ''));
      if (!picture) return;
      if (picture.startsWith('build/test-artefacts/')) assert.ok(fs.readFileSync(path.join(root, 'tests', named), 'utf8').includes(path.basename(picture)), `${named} takes ${picture}`);
      else assert.ok([root, folder].some((at) => fs.existsSync(path.join(at, picture))), picture);
    });
});
