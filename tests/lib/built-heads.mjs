// SPDX-License-Identifier: GPL-3.0-or-later
// The built heads. Without them a test file that needs them fails once, with instructions.
import fs from 'node:fs';
import path from 'node:path';
import { ordinary } from './daemon.mjs';

/** The folder of built models. */
export const models = process.env.FACCIA_MODELS ?? path.join(ordinary, 'models');
export const heads = path.join(models, 'heads');

if (!fs.existsSync(path.join(heads, 'mara.json')))
  throw new Error(`this test needs the built heads, and ${heads} has no mara.json: sh server/run.sh --build-only makes them (npm ci --ignore-scripts in models/, then a build)`);
