// SPDX-License-Identifier: GPL-3.0-or-later
// faccia visemes: groups phones by measured lips. The face itself is the speaker, so that phones with the same target are known; SciPy's linkage is
// the second opinion on the tree.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const at = (name) => path.join(folder, name);
const TEXTS = [
  'La mamma beve poco pane e buon vino fresco.', 'Vado a vivere fuori, dove il fumo non arriva mai.', 'Beppe pompa bene la bomba piccola, ma non basta.',
  'Una luna nuova illumina la via del vecchio mulino.', 'Poi bussò piano, e Filomena aprì la porta di vimini.',
];
const MNS = 21; // mm
const files = [];

before(() => {
  for (const [n, text] of TEXTS.entries()) {
    const { status, stderr } = faccia(['say', '--still', '--lang', 'it', '--fps', '100', '--fap', at(`${n}.fap`), '--json', at(`${n}.json`), text]);
    assert.equal(status, 0, stderr);
    const { frames } = parseFap(fs.readFileSync(at(`${n}.fap`), 'utf8'));
    const { phones } = JSON.parse(fs.readFileSync(at(`${n}.json`)));
    const mm = (frame, fap) => ((frame[fap] ?? 0) * MNS) / 1024;
    fs.writeFileSync(at(`${n}.csv`), `time,LI,LS,EM\n${frames.map((f, k) => [k / 100, -mm(f, 5), -mm(f, 4), mm(f, 3)].map((x) => x.toFixed(4)).join(',')).join('\n')}\n`);
    fs.writeFileSync(at(`${n}.phones.csv`), `start,end,ipa\n${phones.map(({ start, end, ipa }) => `${start},${end},${ipa || '_'}`).join('\n')}\n`);
    files.push(at(`${n}.csv`));
  }
});

test('phones with the same lips are in one group, apart from others; the tree is that of SciPy', () => {
  const { status, stdout, stderr } = faccia(['visemes', '--count', '4', '--json', at('tree.json'), '--svg', at('tree.svg'), ...files]);
  assert.equal(status, 0, stderr);
  const tree = JSON.parse(fs.readFileSync(at('tree.json')));
  const group = Object.fromEntries(tree.phones.map((phone) => [phone.ipa, phone.group]));
  assert.ok(group.m && group.m === group.b && group.m === group.p, JSON.stringify(group));
  assert.equal(group.f, group.v);
  assert.ok(group.a !== group.m && group.a !== group.f, JSON.stringify(group));
  assert.equal(stdout.trim().split('\n').length, 1 + 4);
  for (const line of stdout.trim().split('\n').slice(1)) assert.match(line, /^ *\d( +-?\d+\.\d\d){3}( +\S+)+$/);
  assert.match(stderr, /^\d+ phones; \d+ groups separate them best \(mean silhouette 0\.\d\d\)$/m);
  const svg = fs.readFileSync(at('tree.svg'), 'utf8');
  assert.equal(svg.match(/<path d="M[\d.]+ [\d.]+H/g).length, tree.phones.length - 1);
  const script = `import json, sys, numpy
from scipy.cluster.hierarchy import linkage, fcluster
tree = json.load(open(sys.argv[1]))
points = numpy.array([[p['mean'][k] / d for k, d in tree['deviation'].items()] for p in tree['phones']])
print(json.dumps({'heights': list(linkage(points, 'ward')[:, 2]), 'groups': [int(g) for g in fcluster(linkage(points, 'ward'), 4, 'maxclust')]}))`;
  const python = spawnSync('/usr/bin/python3', ['-c', script, at('tree.json')], { encoding: 'utf8' });
  assert.equal(python.status, 0, python.stderr);
  const other = JSON.parse(python.stdout);
  for (const [k, height] of other.heights.entries()) assert.ok(Math.abs(height - tree.merges[k].height) < 1e-5, `merge ${k}: ${height} and ${tree.merges[k].height}`);
  const pairs = (list) => list.flatMap((a, i) => list.slice(i + 1).map((b) => a === b));
  assert.deepEqual(pairs(tree.phones.map((phone) => phone.group)), pairs(other.groups));
});

test('reports wrong usage, and recordings with too little', () => {
  for (const [args, code, message] of [
    [[], 2, /no recordings/], [['--count', '1', files[0]], 2, /--count/], [['--least', '500', files[0]], 1, /only 0 of \d+ phones have 500 occurrences/],
    [['--count', '90', ...files], 1, /--count: there are only \d+ phones/], [[at('none.csv')], 1, /none\.csv: No such file/],
  ]) {
    const { status, stderr } = faccia(['visemes', ...args]);
    assert.match(stderr, message);
    assert.equal(status, code, args.join(' '));
  }
});
