// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of the layers of the face (layers.c). Usage: node tests/bench/run.mjs layers
import { execFileSync } from 'node:child_process';
import path from 'node:path';
import { root } from '../lib/daemon.mjs';
import { needProgram } from './need.mjs';

execFileSync(needProgram('layers'), [path.join(root, 'models'), '60'], { stdio: 'inherit' });
