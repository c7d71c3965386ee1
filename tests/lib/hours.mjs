// SPDX-License-Identifier: GPL-3.0-or-later
// Simulates hours of a page in seconds: its date and timers of a second or more advance on command. Drawing, sound and network run in real
// time, because a fake clock for everything would separate the face from the sound's clock.
import net from 'node:net';
import { once } from 'node:events';

/** Call in the page before its scripts. `window.hours.forward(milliseconds)` advances the time. */
function quicken() {
  const LONG = 1000;
  const real = { Date, WebSocket };
  for (const name of ['setTimeout', 'setInterval', 'clearTimeout', 'clearInterval']) real[name] = window[name].bind(window);
  const timers = new Map();
  let ahead = 0, number = 1 << 30, unanswered = 0;
  const add = (call, milliseconds, every, values) => {
    timers.set(++number, { call, at: real.Date.now() + ahead + milliseconds, every, values });
    return number;
  };
  window.setTimeout = (call, milliseconds = 0, ...values) =>
    (milliseconds < LONG ? real.setTimeout(call, milliseconds, ...values) : add(call, milliseconds, 0, values));
  window.setInterval = (call, milliseconds = 0, ...values) =>
    (milliseconds < LONG ? real.setInterval(call, milliseconds, ...values) : add(call, milliseconds, milliseconds, values));
  for (const name of ['clearTimeout', 'clearInterval']) window[name] = (timer) => timers.delete(timer) || real[name](timer);
  window.Date = class extends real.Date {
    constructor(...values) {
      super(...(values.length ? values : [real.Date.now() + ahead]));
    }

    static now() {
      return real.Date.now() + ahead;
    }
  };
  window.WebSocket = class extends real.WebSocket {
    constructor(...values) {
      super(...values);
      unanswered = 0;
      this.addEventListener('message', ({ data }) => data.includes?.('"pong"') && (unanswered = 0));
      this.addEventListener('close', () => (unanswered = 0));
    }

    send(data) {
      if (data.includes?.('"ping"')) unanswered++;
      super.send(data);
    }
  };
  /** Requests in flight are answered before the time advances, so that no answer takes hours. */
  const { port1, port2 } = new MessageChannel(); // browsers throttle zero-length timers
  const breathe = async () => {
    await new Promise((resolve) => (port1.onmessage = resolve, port2.postMessage(0)));
    for (const from = performance.now(); unanswered && performance.now() - from < 3000; ) await new Promise((resolve) => real.setTimeout(resolve, 1));
  };
  let turn = Promise.resolve(), turns = 0;
  async function advance(milliseconds) {
    const end = real.Date.now() + ahead + milliseconds;
    for (;;) {
      const due = [...timers.entries()].filter(([, timer]) => timer.at <= end).sort(([, a], [, b]) => a.at - b.at)[0];
      if (!due) break;
      const [id, timer] = due;
      ahead = Math.max(ahead, timer.at - real.Date.now());
      if (timer.every) timer.at += timer.every;
      else timers.delete(id);
      timer.call(...timer.values);
      await breathe();
    }
    ahead = Math.max(ahead, end - real.Date.now());
    turns--;
  }
  const forward = (milliseconds) => (turns++, turn = turn.then(() => advance(milliseconds)));
  // Real time passes, too: on a busy machine a page may need a timer of a second before a sentence ends.
  real.setInterval(() => turns || forward(0), 100);
  window.hours = {
    get timers() {
      return timers.size;
    },
    forward,
  };
}

/** A TCP proxy to the daemon whose connections can be cut. @param {number} port of the daemon */
export async function wireTo(port) {
  const ends = new Set();
  const server = net.createServer((near) => {
    const far = net.connect(port, '127.0.0.1');
    for (const [end, other] of [[near, far], [far, near]]) {
      ends.add(end);
      end.pipe(other).on('error', () => {});
      end.on('error', () => {}).on('close', () => (ends.delete(end), other.destroy()));
    }
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  const cut = () => ends.forEach((end) => end.destroy());
  return { url: `http://127.0.0.1:${server.address().port}`, cut, close: () => (server.close(), cut()) };
}

/** Measures what the page still holds after garbage collection. */
async function holds(page, cdp) {
  for (let i = 0; i < 3; i++) await cdp.send('HeapProfiler.collectGarbage');
  const { metrics } = await cdp.send('Performance.getMetrics');
  const of = (name) => metrics.find((each) => each.name === name).value;
  return { heap: of('JSHeapUsedSize'), nodes: of('Nodes'), listeners: of('JSEventListeners'), audio: of('AudioHandlers'), timers: await page.evaluate(() => window.hours.timers) };
}

/**
 * Opens the page of a room and simulates hours. Each hour has `says` sentences, every second one with a question answered by touch, a mood,
 * states, sleep mode and waking, and `cuts` of the connection.
 * @param {import('playwright-core').Browser} browser @param {import('./daemon.mjs').Daemon} daemon
 * @param {{hours: number, says?: number, cuts?: number, each?: (sample: object) => void}} life
 * @returns {Promise<{samples: object[], places: string[], links: number, said: number, answers: number, problems: string[]}>}
 *   samples: one per hour; places: positions of the picture; links: number of connections
 */
export async function liveIn(browser, daemon, { hours, says = 6, cuts = 1, room = 'mese', each = () => {} }) {
  const wire = await wireTo(daemon.port);
  try {
    return await live(browser, daemon, wire, { hours, says, cuts, room, each });
  } finally {
    wire.close();
  }
}

async function live(browser, daemon, wire, { hours, says, cuts, room, each }) {
  const page = await browser.newPage({ locale: 'it-IT', viewport: { width: 800, height: 600 } });
  const problems = [];
  const told = { samples: [], places: [], links: 0, said: 0, answers: 0, problems };
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.addInitScript(quicken);
  const cdp = await page.context().newCDPSession(page);
  await cdp.send('Performance.enable');
  await page.goto(`${wire.url}/room.html?room=${room}&clock&sleep=22-7`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 120000 });
  await page.evaluate(() => {
    const place = document.querySelector('#place'), head = document.querySelector('talking-head');
    window.lived = { places: new Set(), links: 1, ends: 0, answers: 0 };
    new MutationObserver(() => window.lived.places.add(place.style.transform)).observe(place, { attributes: true, attributeFilter: ['style'] });
    head.addEventListener('joined', () => window.lived.links++);
    head.addEventListener('end', () => window.lived.ends++);
    head.addEventListener('chosen', () => window.lived.answers++);
  });
  const post = async (what, body) => {
    const answer = await daemon.get(`/v1/${what}`, { method: 'POST', body: typeof body === 'string' ? body : JSON.stringify(body) });
    if (!answer.ok) throw new Error(`${what}: ${await answer.text()}`);
  };
  const command = (body) => post(`rooms/${room}/commands`, body);
  const until = (condition, value) => page.waitForFunction(condition, value, { timeout: 60000 });
  const forward = (milliseconds) => page.evaluate((time) => window.hours.forward(time), milliseconds);
  const linked = () => until(() => ['idle', 'listening', 'thinking'].includes(document.body.dataset.state));
  const say = async (i) => {
    const before = await page.evaluate(() => window.lived.ends);
    await command({ type: 'state', state: 'thinking', text: `Domanda ${i}`, mix: [{ name: ['joy', 'hope', 'surprise'][i % 3], intensity: 0.5 }] });
    await post(`say?room=${room}&lang=it&rate=300`, `Sono le ${i % 24}.`);
    await until((count) => window.lived.ends > count, before);
    await command({ type: 'state', state: 'idle' });
    told.said++;
    if (i % 2) return;
    await command({ type: 'choices', id: `q${i}`, question: `Va bene, domanda ${i}?`, choices: ['Sì', 'No', 'Non so'] });
    await until(() => document.querySelector('.answers button') !== null); // keeps no handle, which would prevent garbage collection
    await page.evaluate(() => document.querySelector('.answers button').click());
    await until(() => document.querySelector('#question').hidden);
    told.answers++;
  };
  for (let hour = 0; hour < hours; hour++) {
    for (let i = 0; i < says; i++) {
      await say(hour * says + i);
      await forward(3600000 / says);
      if (i < cuts) {
        wire.cut();
        await until(() => document.body.dataset.state === 'offline');
        while (await page.evaluate(() => document.body.dataset.state === 'offline')) await forward(1000);
        await linked();
      }
    }
    const sample = await holds(page, cdp);
    told.samples.push(sample);
    each(sample);
  }
  const { places, links } = await page.evaluate(() => ({ ...window.lived, places: [...window.lived.places] }));
  await page.close();
  return { ...told, places, links };
}
