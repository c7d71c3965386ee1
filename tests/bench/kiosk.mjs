// SPDX-License-Identifier: GPL-3.0-or-later
// Accelerated hours of a room's page: sentences, questions, moods, sleep, a connection cut every hour. Reports the browser's memory after each hour
// and a garbage collection: heap, DOM nodes, listeners, audio nodes, timers.
// Usage: node tests/bench/run.mjs kiosk [--hours 8] [--says 6] (sentences in an hour) [--webgl]
import { parseArgs } from 'node:util';
import { launch } from '../lib/browser.mjs';
import { Daemon } from '../lib/daemon.mjs';
import { liveIn } from '../lib/hours.mjs';
import { kilobytesOf } from './figures.mjs';

const { values: options } = parseArgs({ options: { hours: { type: 'string', default: '8' }, says: { type: 'string', default: '6' }, webgl: { type: 'boolean', default: false } } });
const daemon = await Daemon.start();
const browser = await launch({ webgl: options.webgl, idling: true, forced: true, whole: true });
const started = performance.now();
console.log(' hour   heap kB   nodes   listeners   sound nodes   timers   daemon kB');
let hour = 0;
const { places, links, said, answers, problems } = await liveIn(browser, daemon, {
  hours: Number(options.hours), says: Number(options.says),
  each: ({ heap, nodes, listeners, audio, timers }) => console.log([`${++hour}`.padStart(5), (heap / 1024).toFixed(0).padStart(9), String(nodes).padStart(7),
    String(listeners).padStart(11), String(audio).padStart(13), String(timers).padStart(8), String(kilobytesOf(daemon.process.pid)).padStart(11)].join(' ')),
});
console.log(`\n${hour} hours in ${((performance.now() - started) / 1000).toFixed(0)} s: ${said} sentences, ${answers} answers, ${links} links; the picture was at ${places.length} places`);
if (problems.length) console.log(problems.join('\n'));
await browser.close();
await daemon.stop();
