// SPDX-License-Identifier: GPL-3.0-or-later
// The demo page in a real browser: the head loads and speaks, sound plays, the mouth opens on /a/ and closes on /p b m/.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { difference, launch, openPage, picture, record } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const JAW = 3;
const UPPER = 4; // lower_t_midlip: positive = down
const LOWER = 5; // raise_b_midlip: positive = up
const text = 'La mamma e il papà parlano, e Beppe beve.';

let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ idling: true });
  page = await openPage(browser, daemon.url);
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

const post = (format) => daemon.get(`/v1/speech?lang=it&still=1&fps=100&format=${format}`, { method: 'POST', body: text, headers: { 'content-type': 'text/plain' } });

test('shows the head', async () => {
  const png = await picture(page, 'neutral', {});
  const colours = new Set();
  for (let i = 0; i < png.data.length; i += 400) colours.add(png.data.readUIntBE(i, 3) & 0xf0f0f0);
  assert.ok(colours.size > 40, `${colours.size} colours`);
  assert.deepEqual(page.problems, []);
});

/** Speaks the text once and returns the log. */
async function spokenOnce() {
  await page.evaluate(() => (window.heard = []));
  await record(page);
  await page.click('#speak');
  await page.waitForFunction(() => window.heard.some((e) => e.type === 'word' && e.text === 'papà'), null, { timeout: 30000 });
  const caption = await page.evaluate(() => document.querySelector('talking-head').shadowRoot.querySelector('.captions').textContent);
  assert.match(caption, /papà/);
  await page.waitForFunction(() => window.heard.some((e) => e.type === 'end'), null, { timeout: 30000 });
  const { log, heard } = await page.evaluate(() => ((window.logging = false), { log: window.log, heard: window.heard }));
  return { log, heard, underruns: log.at(-1).underruns - log[0].underruns };
}

test('speaks a sentence: sound plays, the face follows, captions run', async () => {
  await page.fill('#text', text);
  await page.evaluate(() => {
    const element = document.querySelector('talking-head');
    for (const type of ['begin', 'word', 'end']) element.addEventListener(type, (event) => window.heard?.push({ type, ...event.detail, state: element.debug().state }));
    element.pose(null);
  });
  let once = await spokenOnce();
  for (let again = 0; again < 3 && once.underruns; again++) once = await spokenOnce(); // repeats, because the machine was too busy
  const { log, heard, underruns } = once;
  const spoken = log.filter((l) => l.running && l.audioTime !== null);
  const duration = heard.find((e) => e.type === 'end').duration;
  assert.equal(heard.find((e) => e.type === 'end').reason, 'done');
  assert.ok(Math.max(...spoken.map((l) => l.audioTime)) > duration - 0.3, 'the sound was played to its end');
  assert.equal(underruns, 0);
  assert.ok(Math.max(...spoken.map((l) => l.fapValues[JAW])) > 150, 'the jaw opened');
  assert.ok(heard.filter((e) => e.type === 'word').length >= 8);
  // the drawn face is in sync with the sound, allowing for the age of the drawing
  const late = spoken.map((l) => Math.abs(l.audioTime - l.frameTime - l.frameAge / 1000));
  assert.ok(late.sort((a, b) => a - b)[Math.floor(late.length / 2)] < 0.02, `median skew ${late[Math.floor(late.length / 2)]}`);
  assert.deepEqual(page.problems, []);
});

test('opens on /a/ and closes on /p b m/, in FAPs and in pixels', async (t) => {
  t.after(() => page.evaluate(() => document.querySelector('talking-head').pose(null)));
  const { phones } = await (await post('json')).json();
  const { fps, frames } = parseFap(await (await post('fap')).text());
  const at = (phone, place) => frames[Math.round((phone.start + place * (phone.end - phone.start)) * fps)];
  const opening = (frame) => -frame[UPPER] - frame[LOWER]; // distance of the lips

  const open = phones.filter((p) => p.ipa === 'a' && p.stress === 2).map((p) => at(p, 0.5)).sort((a, b) => opening(b) - opening(a))[0];
  const neutral = await picture(page, 'rest', {});
  const wide = await picture(page, 'open-a', open);
  const mouth = difference(neutral, await picture(page, 'lips-apart', { 4: -300, 5: -600, 8: -250, 9: -250, 10: -500, 11: -500 }));
  assert.ok(mouth.right - mouth.left < neutral.width / 3, 'only the mouth moves');
  const shownOpen = difference(neutral, wide, mouth).count; // pixels of teeth, tongue and darkness between the lips
  assert.ok(opening(open) > 150, `opening of /a/ ${opening(open)}`);
  assert.ok(shownOpen > 300, `${shownOpen} pixels changed on /a/`);

  const closures = phones.filter((p) => ['p', 'b', 'm', 'pː', 'bː', 'mː'].includes(p.ipa));
  assert.ok(closures.length >= 6);
  for (const [i, phone] of closures.entries()) {
    const frame = at(phone, 0.5);
    assert.ok(opening(frame) <= 0, `/${phone.ipa}/ at ${phone.start}: opening ${opening(frame)}`);
    const closed = await picture(page, `closed-${i}-${phone.ipa}`, frame);
    const shown = difference(neutral, closed, mouth).count;
    assert.ok(shown < shownOpen / 5, `/${phone.ipa}/: ${shown} pixels changed, ${shownOpen} on /a/`);
  }
});

test('draws a held pose once, and again only when something changes', async (t) => {
  t.after(() => page.evaluate(() => document.querySelector('talking-head').pose(null)));
  const frames = () => page.evaluate(() => document.querySelector('talking-head').debug().frames);
  await page.evaluate(() => document.querySelector('talking-head').pose({ 3: 400 }));
  // 60 animation frames
  const second = () => page.evaluate(async () => { for (let i = 0; i < 60; i++) await new Promise(requestAnimationFrame); });
  await second();
  const before = await frames();
  await second();
  assert.equal(await frames(), before);
  assert.deepEqual(await page.evaluate(() => document.querySelector('talking-head').faps), { 3: 400 });
  await page.evaluate(() => document.querySelector('talking-head').pose(null));
  await page.waitForFunction((from) => document.querySelector('talking-head').debug().frames > from + 2, before, { timeout: 60000 }); // idle motion continues
});

test('stop silences at once, and the mouth goes to rest', async () => {
  await page.evaluate((long) => void document.querySelector('talking-head').speak(long, { lang: 'it' }), text.repeat(5));
  await page.waitForFunction(() => (document.querySelector('talking-head').debug().audioTime ?? 0) > 0.5, null, { timeout: 60000 });
  const running = await page.evaluate(() => {
    const element = document.querySelector('talking-head');
    element.stop();
    return element.debug().running;
  });
  assert.equal(running, false);
  await page.waitForFunction(() => {
    const { state, fapValues } = document.querySelector('talking-head').debug();
    return state === 'idle' && Math.abs(fapValues[3]) < 10;
  }, null, { timeout: 60000 });
});

test('the mouth rests when the connection drops, and the page reconnects', async () => {
  await page.evaluate((long) => void document.querySelector('talking-head').speak(long, { lang: 'it' }).catch(() => {}), text.repeat(5));
  await page.waitForFunction(() => (document.querySelector('talking-head').debug().audioTime ?? 0) > 0.5, null, { timeout: 60000 });
  const { port } = daemon;
  await daemon.stop();
  await page.waitForFunction(() => {
    const { connection, fapValues, state } = document.querySelector('talking-head').debug();
    return connection !== 'open' && state === 'idle' && Math.abs(fapValues[3]) < 10;
  }, null, { timeout: 10000 });
  daemon = await Daemon.start(['--port', String(port)]);
  await page.waitForFunction(() => document.querySelector('talking-head').debug().connection === 'open', null, { timeout: 30000 });
  const end = await page.evaluate(() => document.querySelector('talking-head').speak('Eccomi.', { lang: 'it' }));
  assert.equal(end.reason, 'done');
  assert.deepEqual(page.problems, []);
});

test('loads the head through the socket when HTTP fails', async () => {
  const other = await browser.newPage();
  await other.route('**/v1/models/**', (route) => route.abort());
  await other.goto(daemon.url);
  await other.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 60000 });
  await other.close();
});

test('prefers-reduced-motion keeps the head still', async () => {
  const other = await browser.newPage({ reducedMotion: 'reduce' });
  await other.goto(daemon.url);
  await other.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 60000 });
  await record(other);
  await other.click('#speak');
  await other.waitForFunction(() => window.log.filter((l) => l.running).length > 60, null, { timeout: 30000 });
  const log = await other.evaluate(() => ((window.logging = false), window.log));
  for (const { fapValues } of log) for (const n of [19, 20, 48, 49, 50]) assert.equal(fapValues[n], 0);
  await other.close();
});
