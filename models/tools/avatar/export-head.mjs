#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Writes a built head as an avatar for other programs: export-head.mjs HEAD.json OUTPUT.glb. The file is a GLB and an avatar of
 * VRM 1.0 in one: protocol/avatars.md.
 */
import fs from 'node:fs';
import path from 'node:path';
import { makeAvatar } from './avatar.mjs';
import { unpack } from '../lib/deform.mjs';

const [file, out, ...rest] = process.argv.slice(2);
if (!file || !out || rest.length) {
  console.error('usage: export-head.mjs HEAD.json OUTPUT.glb');
  process.exit(2);
}
try {
  const avatar = await makeAvatar(unpack(JSON.parse(fs.readFileSync(file, 'utf8'))));
  fs.writeFileSync(out, avatar);
  console.log(`${path.basename(out)}: ${avatar.length} bytes`);
} catch (error) {
  console.error(`export-head: ${file}: ${error.message}`);
  process.exit(1);
}
