#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Averages the detector's landmarks and the feature points over the faces of built heads: make-template.mjs
 * FACE-POINTS.json HEAD.json... >face-template.json. In mm, from between the eyes; landmarks that no head has are null.
 */
import fs from 'node:fs';
import path from 'node:path';

const [points, ...files] = process.argv.slice(2);
const table = JSON.parse(fs.readFileSync(points, 'utf8'));
const heads = files.map((file) => ({ fdp: JSON.parse(fs.readFileSync(file, 'utf8')).fdp, at: table[path.basename(file, '.json')].at }));
const mean = (list) => list.length && [0, 1, 2].map((k) => Math.round((10 * list.reduce((sum, p) => sum + p[k], 0)) / list.length) / 10);
const at = heads[0].at.map((_, i) => mean(heads.map((head) => head.at[i]).filter(Boolean)) || null);
const names = Object.keys(heads[0].fdp).filter((name) => heads.every(({ fdp }) => fdp[name]));
process.stdout.write(`${JSON.stringify({ at, fdp: Object.fromEntries(names.map((name) => [name, mean(heads.map(({ fdp }) => fdp[name]))])) })}\n`);
