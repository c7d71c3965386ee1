// SPDX-License-Identifier: GPL-3.0-or-later
// Skew between face and sound in headless Chromium with software rendering, 640 x 480, during Italian speech: for each frame the
// position in the speech heard when it is displayed, minus that of the face it shows. Both times come from the browser's traces of
// its compositor and sound system, not from the page. The same run also evaluates simpler players. Then a second, independent
// measurement from pixels and samples alone, with a recording whose jaw moves and whose sound clicks.
// Usage: node tests/bench/run.mjs skew [SECONDS [low|high|auto]]
import { Daemon } from '../lib/daemon.mjs';
import { launch, openPage } from '../lib/browser.mjs';
import { quantile } from './figures.mjs';
import { fap, PERIOD, probe, sinceOpen, wav } from './jaw.mjs';
import { watchOthers } from './others.mjs';
import { prose } from './text.mjs';
import { categories, pictures, soundOf } from './trace.mjs';

const seconds = Number(process.argv[2] ?? 60);
const quality = process.argv[3] ?? 'low';
const JAW_SECONDS = 12;
const QUIET = 0.1; // maximum load by other programs, in processors, because it delays drawing unpredictably

/** Makes the page record, for each frame, its position in the speech and the sound clocks. */
const note = (page) => page.evaluate(() => {
  const element = document.querySelector('talking-head');
  const { stage, player } = element.debugParts();
  const { frame } = stage.ports;
  window.drawn = [];
  window.reports = new Map(); // position in the speech at audio frames
  stage.ports.frame = (now, ahead) => {
    performance.mark(`picture${window.drawn.length}`);
    const shown = frame(now, ahead);
    const { context, map, offset } = player;
    const stamp = context?.getOutputTimestamp();
    if (player.audio) for (const report of map.reports) window.reports.set(report.frame, { ...report, position: report.position + offset });
    const heard = player.heard(now, ahead / 1000);
    const { frameTime } = element.debug();
    window.drawn.push({
      seconds: heard.running ? frameTime : null, // of the utterance
      start: frameTime === null ? null : heard.position / player.rate - frameTime, // of the utterance on the player
      current: context?.currentTime ?? null,
      heardNow: stamp ? stamp.contextTime + (now - stamp.performanceTime) / 1000 : null,
    });
    return shown;
  };
});

const PATIENCE_MS = 120000; // in addition to the duration of the speech, for busy machines

/** Speaks (or plays) and waits for the end, with a timeout. */
const until = (page, seconds, text) => page.evaluate(({ words, most }) => new Promise((resolve, reject) => {
  const element = document.querySelector('talking-head');
  const timer = setTimeout(() => reject(new Error(`not at its end after ${most / 1000} s: ${JSON.stringify(element.debug())}`)), most);
  element.addEventListener('end', () => resolve(clearTimeout(timer)), { once: true });
  if (words) element.speak(words, { lang: 'it' });
}), { words: text, most: 1000 * seconds + PATIENCE_MS });

const say = (name, late) => {
  if (!late.length) return void console.log(`${name}: nothing was measured, of too few pictures`);
  const off = late.map(Math.abs);
  const share = (most) => `${((100 * off.filter((x) => x <= most).length) / off.length).toFixed(1)} %`;
  const at = (q) => quantile(off, q).toFixed(1);
  console.log(`${name}: ${share(10)} within 10 ms, ${share(20)} within 20 ms; off by ${at(0.5)} ms (50 %), ${at(0.9)} (90 %), ` +
    `${at(0.99)} (99 %); median ${quantile(late, 0.5).toFixed(1)} ms late`);
};

const daemon = await Daemon.start();
const browser = await launch({ idling: true });
const page = await openPage(browser, daemon.url, { quality: 'low' });
await page.evaluate(() => Object.assign(document.querySelector('talking-head').style,
  { width: '640px', height: '480px', position: 'fixed', inset: 0, maxWidth: 'none' }));
const stopWatching = watchOthers();
await browser.startTracing(page, { categories });
await note(page);
await page.evaluate(() => new Promise((resolve) => {
  const element = document.querySelector('talking-head');
  element.addEventListener('joined', () => resolve(), { once: true });
  element.setAttribute('room', 'bench');
}));

// Jaw and clicks come first, so that the sound starts with the recording.
const read = await probe(page);
const form = new FormData();
form.append('fap', new Blob([fap(JAW_SECONDS)]), 'jaw.fap');
form.append('sound', new Blob([wav(JAW_SECONDS)]), 'clicks.wav');
const played = until(page, JAW_SECONDS);
const answer = await daemon.get('/v1/play?room=bench', { method: 'POST', body: form });
if (answer.status !== 202) throw new Error(await answer.text());
await played;
const { clicks, openings } = await read();
const recorded = await page.evaluate(() => window.drawn.length);

await page.evaluate((level) => document.querySelector('talking-head').setAttribute('quality', level), quality);
await until(page, 2 * seconds, prose(seconds));
const { drawn, reports, rate, sound } = await page.evaluate(() => ({
  drawn: window.drawn,
  reports: [...window.reports.values()].sort((a, b) => a.frame - b.frame),
  rate: document.querySelector('talking-head').debug().sampleRate,
  sound: document.querySelector('talking-head').debug().sound,
}));
const others = stopWatching();
const events = JSON.parse(await browser.stopTracing()).traceEvents;
await browser.close();
await daemon.stop();
if (sound !== 'on') throw new Error(`no sound: ${sound}`);

const seenAt = pictures(events, 'picture');
const heardAt = soundOf(events, rate);

/** Position in the speech at an audio frame, in seconds of the player; null: none. */
const speechAt = (frame) => {
  const report = reports.findLast((r) => r.frame <= frame);
  return report?.running ? (report.position + frame - report.frame) / rate : null;
};

const speech = { page: [], stamp: [], current: [], undisturbed: [], recording: [] };
let unseen = 0;
let [first, last] = [Infinity, -Infinity];
drawn.forEach((picture, i) => {
  if (picture.seconds === null) return;
  const { seen } = seenAt.get(i) ?? { seen: null };
  if (seen === null) return void unseen++;
  const heard = speechAt(heardAt(seen));
  if (heard === null) return;
  const late = 1000 * (heard - picture.start - picture.seconds);
  if (i < recorded) return void speech.recording.push(late);
  [first, last] = [Math.min(first, seen), Math.max(last, seen)];
  speech.page.push(late);
  if (others(seenAt.get(i).begun, seen) < QUIET) speech.undisturbed.push(late);
  for (const [name, time] of [['stamp', picture.heardNow], ['current', picture.current]]) {
    const naive = speechAt(time * rate);
    if (naive !== null) speech[name].push(1000 * (heard - naive));
  }
});
const spoken = (last - first) / 1000;
console.log(`${speech.page.length} pictures in ${spoken.toFixed(1)} s of speech (${(speech.page.length / spoken).toFixed(1)} a second), ` +
  `${unseen} never shown; quality ${quality}; other programs took ${others(first, last).toFixed(2)} processors`);
if (!speech.page.length) throw new Error('no picture was seen while she spoke');
say('the page', speech.page);
if (speech.undisturbed.length)
  say(`of these the ${speech.undisturbed.length} while others took less than ${QUIET} of a processor`, speech.undisturbed);
say('a face for what is heard when the picture is begun', speech.stamp);
say('a face at AudioContext.currentTime', speech.current);

const jaw = [];
for (const { picture, opening } of openings) {
  const { seen } = seenAt.get(picture) ?? { seen: null };
  if (seen === null) continue;
  const frame = heardAt(seen);
  const k = clicks.findLastIndex((click) => click <= frame);
  if (k < 0 || k + 1 >= clicks.length) continue;
  const heard = (PERIOD * (frame - clicks[k])) / (clicks[k + 1] - clicks[k]); // s since the click
  const late = sinceOpen(opening, heard);
  if (!Number.isNaN(late)) jaw.push(1000 * late);
}
say(`${jaw.length} pictures of the jaw, from pixels and samples alone`, jaw);
say('the recording by its positions, as a check', speech.recording);
