// SPDX-License-Identifier: GPL-3.0-or-later
// Turning the head by mouse, touch and keys: it follows, stops at its limits and turns back. Swipes scroll the page.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { difference, launch, picture } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

let daemon, browser, server;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ idling: true });
  server = await servePages({
    '/': `<!doctype html><html lang="en"><meta charset="utf-8"><title>Test</title><link rel="icon" href="data:,">
      <style>body { margin: 0; block-size: 4000px } talking-head { inline-size: 300px; block-size: 400px; margin: 100px }</style>
      <script type="module" src="${daemon.url}/talking-head.js"></script>
      <talking-head src="${daemon.url.replace('http', 'ws')}/v1/stream" quality="low" captions="off"></talking-head>`,
  });
});
after(async () => {
  await browser?.close();
  await server?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens a page with one head that moves only by user input. */
async function open(options = {}) {
  const page = await browser.newPage({ viewport: { width: 500, height: 600 }, ...options });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.goto(server.url);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 180000 });
  await page.evaluate(() => document.querySelector('talking-head').pose({}));
  return page;
}

const turned = (page) => page.evaluate(() => document.querySelector('talking-head').debug().turned);
const reaches = (page, yaw, pitch = 0) =>
  page.waitForFunction(([y, p]) => {
    const now = document.querySelector('talking-head').debug().turned;
    const near = (is, wanted) => (wanted ? Math.abs(is - wanted) < 0.5 : is === 0);
    return near(now.yaw, y) && near(now.pitch, p);
  }, [yaw, pitch]);

test('follows the mouse up to a limit, and turns back when released', async () => {
  const page = await open();
  const straight = await picture(page, 'turn-straight', {});
  await page.mouse.move(250, 300);
  await page.mouse.down();
  await page.mouse.move(290, 300, { steps: 4 });
  await reaches(page, 12);
  await page.mouse.move(800, 300, { steps: 4 }); // beyond the picture the drag continues
  await reaches(page, 25);
  const right = await picture(page, 'turn-right', {});
  assert.ok(difference(straight, right).count > 500, 'it is seen');
  await page.mouse.move(-300, 300, { steps: 4 });
  await reaches(page, -25);
  const left = await picture(page, 'turn-left', {});
  assert.ok(difference(left, right).count > 500, 'to either side');
  await page.mouse.move(250, 900, { steps: 4 });
  await reaches(page, 0, 10);
  await page.mouse.up();
  await reaches(page, 0);
  const again = await picture(page, 'turn-back', {});
  assert.ok(difference(straight, again).count < 20, 'as if nothing had been');
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('turns with the arrow keys, on a labelled slider', async () => {
  const page = await open();
  const slider = page.getByRole('slider', { name: 'Turn the head' });
  for (let i = 0; i < 3 && !(await slider.evaluate((element) => element.matches(':focus'))); i++) await page.keyboard.press('Tab');
  assert.equal(await slider.evaluate((element) => getComputedStyle(element).opacity), '1', 'it shows while it has the focus');
  for (let i = 0; i < 7; i++) await page.keyboard.press('ArrowRight');
  await reaches(page, 25);
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('ArrowUp');
  await reaches(page, 20, -5);
  assert.equal(await slider.getAttribute('aria-valuetext'), '20°, -5°');
  await page.keyboard.press('Escape');
  await reaches(page, 0);
  await page.keyboard.press('ArrowLeft');
  await reaches(page, -5);
  await page.keyboard.press('Shift+Tab');
  await reaches(page, 0);
  assert.equal(await slider.evaluate((element) => getComputedStyle(element).opacity), '0');
  await page.close();
});

test('a finger turns it sideways and scrolls the page vertically', async () => {
  const page = await open({ hasTouch: true });
  const client = await page.context().newCDPSession(page);
  const touch = (type, ...points) => client.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y]) => ({ x, y })) });
  await touch('touchStart', [250, 300]);
  for (let x = 250; x >= 150; x -= 20) await touch('touchMove', [x, 300]);
  await reaches(page, -25);
  await touch('touchEnd');
  await reaches(page, 0);
  assert.equal(await page.evaluate(() => scrollY), 0);
  await touch('touchStart', [250, 450]);
  for (let y = 450; y >= 250; y -= 20) await touch('touchMove', [250, y]);
  await touch('touchEnd');
  await page.waitForFunction(() => scrollY > 100);
  await reaches(page, 0);
  await page.close();
});

test('does not turn when off, still, or with reduced motion, unless turn is set to on', async () => {
  const page = await open();
  const slider = page.locator('talking-head .turn');
  const set = (name, value) => page.evaluate(([n, v]) => document.querySelector('talking-head').setAttribute(n, v), [name, value]);
  await set('turn', 'off');
  assert.ok(await slider.isDisabled());
  await page.mouse.move(250, 300);
  await page.mouse.down();
  await page.mouse.move(350, 300, { steps: 4 });
  assert.deepEqual(await turned(page), { yaw: 0, pitch: 0 });
  await page.mouse.up();
  await page.evaluate(() => document.querySelector('talking-head').removeAttribute('turn'));
  assert.ok(await slider.isEnabled());
  await set('still', 'on');
  assert.ok(await slider.isDisabled());
  await set('turn', 'on');
  assert.ok(await slider.isEnabled());
  await page.close();
  const calm = await open({ reducedMotion: 'reduce' });
  assert.ok(await calm.locator('talking-head .turn').isDisabled());
  await calm.evaluate(() => (document.querySelector('talking-head').turn = true));
  await calm.locator('talking-head .turn').focus();
  const path = await calm.evaluate(async () => {
    const head = document.querySelector('talking-head');
    const slider = head.shadowRoot.querySelector('.turn');
    const seen = new Set();
    const look = async () => {
      for (let i = 0; i < 5; i++) {
        await new Promise(requestAnimationFrame);
        seen.add(head.debug().turned.yaw);
      }
    };
    slider.value = 20;
    slider.dispatchEvent(new Event('input'));
    await look();
    slider.blur();
    await look();
    return [...seen];
  });
  assert.ok(path.every((yaw) => yaw === 0 || yaw === 20) && path.includes(20), `at once: ${path}`);
  await calm.close();
});
