// SPDX-License-Identifier: GPL-3.0-or-later
// A recording whose picture and sound both encode the time: the jaw opens and closes linearly, with a click whenever it starts to
// open. And a probe that reads both from a page: drawn pixels and played samples.
import { wavOf } from '../lib/wav.mjs';

export const PERIOD = 1; // seconds from click to click
const JAW_MOST = 800;
const FPS = 25;
const RATE = 48000;

/** Jaw opening at a time. */
const opening = (seconds) => {
  const place = (seconds % PERIOD) / PERIOD;
  return JAW_MOST * (place < 0.5 ? 2 * place : 2 - 2 * place);
};

/**
 * Time since the jaw had that opening, given the approximate time since a click: the nearest solution.
 * @returns {number} seconds; negative: in the future. NaN near the turning points, where it is ambiguous
 */
export function sinceOpen(value, seconds) {
  const place = value / JAW_MOST / 2;
  if (place < 0.1 || place > 0.4) return NaN;
  const times = [-1, 0, 1].flatMap((n) => [n + place, n + 1 - place]);
  return times.map((time) => seconds - time * PERIOD).reduce((a, b) => (Math.abs(b) < Math.abs(a) ? b : a));
}

export function fap(seconds) {
  const mask = Array.from({ length: 68 }, (_, i) => (i === 2 ? 1 : 0)).join(' ');
  const frames = seconds * FPS;
  return `2.1 jaw ${FPS} ${frames}\n` +
    Array.from({ length: frames }, (_, k) => `${mask}\n${k} ${Math.round(opening(k / FPS))}\n`).join('');
}

export function wav(seconds) {
  const samples = new Int16Array(seconds * RATE);
  for (let click = 0; click < seconds; click += PERIOD)
    for (let i = 0; i < 48; i++) samples[click * RATE + i] = 20000 * (i % 12 < 6 ? 1 : -1);
  return wavOf(samples, RATE);
}

/**
 * Starts recording the page, which keeps the number of each picture in window.drawn.
 * @returns {Promise<() => Promise<{clicks: number[], openings: {picture: number, opening: number}[]}>>} returns the audio frames
 *   at which clicks began, and the jaw opening in each picture
 */
export async function probe(page) {
  await page.evaluate(async (most) => {
    const element = document.querySelector('talking-head');
    const { stage, player } = element.debugParts();
    const gl = stage.view.renderer.getContext();
    const box = [0.3, 0.1, 0.4, 0.5].map((share, i) => Math.round(share * (i % 2 ? gl.drawingBufferHeight : gl.drawingBufferWidth)));
    const size = 4 * box[2] * box[3];
    const free = [];
    window.pixels = null; // callback (picture, pixels)
    // Copied asynchronously after drawing, so that nothing blocks.
    const draw = stage.view.draw.bind(stage.view);
    stage.view.draw = () => {
      draw();
      if (!window.pixels) return;
      const take = window.pixels;
      const picture = window.drawn.length - 1;
      const buffer = free.pop() ?? gl.createBuffer();
      gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
      gl.bufferData(gl.PIXEL_PACK_BUFFER, size, gl.STREAM_READ);
      gl.readPixels(...box, gl.RGBA, gl.UNSIGNED_BYTE, 0);
      gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
      const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      const fetch = () => {
        if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return void setTimeout(fetch, 20);
        gl.deleteSync(fence);
        const pixels = new Uint8Array(size);
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
        gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, pixels);
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
        free.push(buffer);
        take(picture, pixels);
      };
      setTimeout(fetch, 20);
    };
    const pose = (value) => new Promise((resolve) => {
      window.pixels = (_, pixels) => resolve(pixels);
      element.pose({ 3: value });
    });
    element.setAttribute('still', '');
    const rest = await pose(0);
    const measure = (pixels) => pixels.reduce((sum, value, i) => sum + Math.abs(value - rest[i]), 0);
    const scale = []; // [opening, measure]
    for (let value = 0; value <= most; value += 50) scale.push([value, measure(await pose(value))]);
    element.pose(null);
    window.openings = [];
    window.pixels = (picture, pixels) => {
      const found = measure(pixels);
      const above = scale.findIndex(([, at]) => at >= found);
      if (above <= 0) return;
      const [[a, from], [b, to]] = [scale[above - 1], scale[above]];
      window.openings.push({ picture, opening: a + ((found - from) / (to - from)) * (b - a) });
    };
    // Taps the samples at the output.
    const source = `registerProcessor('clicks', class extends AudioWorkletProcessor {
      process([[samples]]) {
        if (samples) for (let i = 0; i < samples.length; i++)
          if (Math.abs(samples[i]) > 0.2 && !(currentFrame + i < this.mutedUntil)) {
            this.mutedUntil = currentFrame + i + sampleRate / 2;
            this.port.postMessage(currentFrame + i);
          }
        return true;
      }
    })`;
    window.clicks = [];
    const timer = setInterval(async () => {
      if (!player.audio?.node) return;
      clearInterval(timer);
      await player.context.audioWorklet.addModule(URL.createObjectURL(new Blob([source], { type: 'text/javascript' })));
      const tap = new AudioWorkletNode(player.context, 'clicks', { numberOfOutputs: 0 });
      tap.port.onmessage = ({ data }) => window.clicks.push(data);
      player.audio.node.connect(tap);
    }, 20);
  }, JAW_MOST);
  return () => page.evaluate(() => {
    window.pixels = null;
    document.querySelector('talking-head').removeAttribute('still');
    return { clicks: window.clicks, openings: window.openings };
  });
}
