#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Compares the affects of expressions.json with the action units of FACS on a built head: check-expressions.mjs FACCIA HEAD.json [--write].
 * Prints a table and what is wrong, and exits with 1 if anything is. FACCIA is the built program; --write puts the table into expressions.md.
 */
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import { unpack } from '../lib/deform.mjs';
import { readFapFrames } from '../lib/fap-frames.mjs';
import { AFFECTS, faultsOf, tableOf, unitsTable } from './facs.mjs';
import { measuring } from './measure.mjs';

const [faccia, file, write] = process.argv.slice(2);
if (!faccia || !file || (write && write !== '--write')) {
  console.error('usage: check-expressions.mjs FACCIA HEAD.json [--write]');
  process.exit(2);
}
const measure = measuring(unpack(JSON.parse(fs.readFileSync(file, 'utf8'))));
const frame = (affect) => readFapFrames(execFileSync(faccia, ['expressions', '--fap', `${affect}=1`], { encoding: 'utf8' }))[0];
const moves = Object.fromEntries(Object.keys(AFFECTS).map((affect) => [affect, measure(frame(affect))]));
const table = tableOf(moves);
if (write) {
  const page = new URL('../../expressions.md', import.meta.url);
  fs.writeFileSync(page, [unitsTable(), table].reduce(replaced, fs.readFileSync(page, 'utf8')));
} else console.log(table.join('\n'));
const faults = Object.entries(moves).flatMap(([affect, all]) => faultsOf(affect, all));
for (const fault of faults) console.log(fault);
process.exit(faults.length ? 1 : 0);

/** Replaces the table with the same first line. */
function replaced(text, rows) {
  const lines = text.split('\n');
  const start = lines.indexOf(rows[0]);
  if (start < 0) throw new Error(`expressions.md has no table that begins with ${rows[0]}`);
  let end = start;
  while (lines[end].startsWith('|')) end++;
  return [...lines.slice(0, start), ...rows, ...lines.slice(end)].join('\n');
}
