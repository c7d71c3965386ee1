// SPDX-License-Identifier: GPL-3.0-or-later
// Stop and pause in a real browser: time until silence, and resuming at the same place.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, openPage } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';

let daemon, browser;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

const text = 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura, ché la diritta via era smarrita.';

/** Opens a page with a sound meter: window.loud() returns the largest sample of the last 3 ms. */
async function open() {
  const page = await openPage(browser, daemon.url);
  await page.evaluate(() => {
    const connect = AudioNode.prototype.connect;
    AudioNode.prototype.connect = function (to, ...rest) {
      if (to !== this.context.destination) return connect.call(this, to, ...rest);
      const meter = this.context.createAnalyser();
      meter.fftSize = 128;
      connect.call(meter, this.context.destination);
      const block = new Float32Array(128);
      window.loud = () => {
        meter.getFloatTimeDomainData(block);
        return Math.max(...block.map(Math.abs));
      };
      return connect.call(this, meter, ...rest);
    };
    window.head = document.querySelector('talking-head');
    /** Waits for loud speech, calls act, and returns the ms until permanent silence, or null. */
    window.silence = async (act) => {
      const tick = () => new Promise((resolve) => setTimeout(resolve, 1));
      while (!(window.loud?.() > 0.02)) await tick();
      const began = performance.now();
      act();
      let silent = null; // time of the first silent sample, which a busy page may take late
      while (performance.now() - began < 1500) { // longer than the media sent ahead
        await tick();
        if (window.loud() > 1e-4) silent = null;
        else silent ??= performance.now();
      }
      return silent && silent - began;
    };
  });
  // sound needs a gesture of the user
  await page.mouse.click(5, 5);
  return page;
}

test('stop silences the voice; resume continues at the paused position', async (t) => {
  const page = await open();
  const times = { stop: [], pause: [] };
  for (let i = 0; i < 5; i++)
    times.stop.push(await page.evaluate(async (what) => {
      const ended = window.head.speak(what, { lang: 'it' });
      const time = await window.silence(() => window.head.stop());
      if ((await ended).reason !== 'stopped') throw new Error('not stopped');
      return time;
    }, text));
  for (let i = 0; i < 5; i++)
    times.pause.push(await page.evaluate(async (what) => {
      const ended = window.head.speak(what, { lang: 'it' });
      const time = await window.silence(() => window.head.pause());
      const at = window.head.debug().audioTime;
      for (let i = 0; i < 20; i++) await new Promise(requestAnimationFrame); // idle motion continues meanwhile
      if (window.head.debug().audioTime !== at) throw new Error(`the clock went on, ${at} to ${window.head.debug().audioTime}`);
      window.head.resume();
      while (!(window.loud() > 0.02)) await new Promise((resolve) => setTimeout(resolve, 1));
      if (window.head.debug().audioTime > at + 2) throw new Error('it did not go on where it was');
      window.head.stop();
      await ended;
      return time;
    }, text));
  // includes the browser's audio block and the fade of 5 ms; a busy page samples rarely
  for (const [what, list] of Object.entries(times)) t.diagnostic(`silent after ${what}: ${list.map((ms) => ms?.toFixed(0)).join(', ')} ms`);
  // the server's lead is 400 ms: most of the five are silent long before that has been played
  for (const list of Object.values(times)) {
    assert.ok(list.every((ms) => ms !== null), JSON.stringify(times));
    assert.ok([...list].sort((x, y) => x - y)[2] < 200, JSON.stringify(times));
  }
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('jumps, changes the rate and interrupts through the element', async () => {
  const page = await open();
  const heard = await page.evaluate(async () => {
    const { head } = window;
    const events = [];
    for (const type of ['word', 'mark', 'jumped', 'paused', 'resumed', 'end'])
      head.addEventListener(type, ({ detail }) => events.push(detail.text ?? detail.name ?? detail.reason ?? type));
    const marked = '<speak>Prima di tutto una lunga introduzione che nessuno ascolta. <mark name="qui"/>Ecco il punto. Fine.</speak>';
    const first = head.speak(marked, { lang: 'it', markup: 'ssml' });
    await new Promise((resolve) => head.addEventListener('word', resolve, { once: true }));
    head.jump('qui');
    await new Promise((resolve) => head.addEventListener('mark', resolve, { once: true }));
    head.rate = 250;
    await head.speak('Ehi.', { lang: 'it', mode: 'interrupt' });
    await first;
    return events;
  });
  assert.ok(heard.includes('jumped') && heard.includes('qui') && heard.includes('Ehi'), heard.join(' '));
  assert.ok(!heard.includes('introduzione') && !heard.includes('Fine'), heard.join(' '));
  assert.deepEqual(heard.filter((word) => ['done', 'stopped'].includes(word)), ['stopped', 'done']);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('for users who prefer reduced motion the affect of a text shows, and nothing but the lips moves beside it', async () => {
  const page = await open(); // the tests' browser asks for reduced motion
  const said = (affect) => page.evaluate(async ([words, mood]) => {
    const head = document.querySelector('talking-head');
    const most = Array(69).fill(0);
    const watch = setInterval(() => head.debug().fapValues.forEach((value, n) => (most[n] = Math.max(most[n], Math.abs(value)))), 10);
    await head.speak(words, { lang: 'it', markup: 'ssml', ...(mood ? { affect: mood } : {}) });
    clearInterval(watch);
    return most;
  }, ['<speak>Mi <emphasis level="strong">dispiace</emphasis> molto, davvero.</speak>', affect]);
  const plain = await said(null);
  for (const fap of [19, 21, 31, 32, 37]) assert.equal(plain[fap], 0, `FAP ${fap} moves without an affect`);
  const sad = await said('sadness');
  assert.ok(sad[31] > 100 && sad[37] > 40 && sad[59] > 0, `brows ${sad[31]}, together ${sad[37]}`);
  for (const fap of [23, 24, 25, 26, 48, 49, 50]) assert.equal(sad[fap], 0, `FAP ${fap} moves`);
  assert.ok(plain[3] > 20, 'and it speaks');
  await page.close();
});
