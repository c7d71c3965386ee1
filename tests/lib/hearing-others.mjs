// SPDX-License-Identifier: GPL-3.0-or-later
// Lip sync of the same sound by other packages, rhubarb-lip-sync-wasm and wawa-lipsync, installed from npm in a folder.
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const moduleOf = (folder, name, file) => import(pathToFileURL(path.join(folder, 'node_modules', name, file)).href);
export const versionOf = (folder, name) => JSON.parse(fs.readFileSync(path.join(folder, 'node_modules', name, 'package.json'), 'utf8')).version;

/** Resamples linearly. */
function resampled(samples, rate, to) {
  return Float64Array.from({ length: Math.floor((samples.length * to) / rate) }, (_, k) => {
    const x = (k * rate) / to, i = Math.min(samples.length - 2, Math.floor(x));
    return samples[i] + (x - i) * (samples[i + 1] - samples[i]);
  });
}

// Mouths of Hanna-Barbera: A closed for P B M, G for F V, E slightly and F tightly rounded. X, at rest, counts as silence.
const RHUBARB = { A: 'closed', G: 'teeth', E: 'middle-round', F: 'close-round' };
export async function rhubarb(folder) {
  const { Rhubarb } = await moduleOf(folder, 'rhubarb-lip-sync-wasm', 'dist/index.js');
  return async (samples, rate) => {
    const pcm = Int16Array.from(resampled(samples, rate, 16000), (x) => Math.max(-32768, Math.min(32767, Math.round(32768 * x))));
    const { log, warn, error } = console;
    Object.assign(console, { log: () => {}, warn: () => {}, error: () => {} }); // silences its progress messages
    try {
      const { mouthCues } = await Rhubarb.getLipSync(Buffer.from(pcm.buffer), {});
      return mouthCues.map(({ start, end, value }) => ({ class: RHUBARB[value] ?? 'other', start, end }));
    } finally {
      Object.assign(console, { log, warn, error });
    }
  };
}

/** Imitates the Web Audio API's AnalyserNode: Blackman window, smoothing 0.8, -100 to -30 dB as bytes. `at`: samples played so far. */
class Analyser {
  smoothing = 0.8;
  at = 0;
  constructor(samples) {
    this.samples = samples;
  }
  get frequencyBinCount() {
    return this.fftSize / 2;
  }
  getByteFrequencyData(out) {
    const n = this.fftSize, re = new Float64Array(n), im = new Float64Array(n);
    for (let i = 0; i < n; i++) {
      const t = (2 * Math.PI * i) / n;
      re[i] = (this.samples[this.at - n + i] ?? 0) * (0.42 - 0.5 * Math.cos(t) + 0.08 * Math.cos(2 * t));
    }
    transform(re, im);
    this.smoothed ??= new Float64Array(n / 2);
    for (let k = 0; k < n / 2; k++) {
      this.smoothed[k] = this.smoothing * this.smoothed[k] + ((1 - this.smoothing) * Math.hypot(re[k], im[k])) / n;
      out[k] = Math.max(0, Math.min(255, Math.floor((255 / 70) * (20 * Math.log10(this.smoothed[k] + 1e-30) + 100))));
    }
  }
}

/** In-place FFT; the length is a power of two. */
function transform(re, im) {
  const n = re.length;
  for (let i = 1, j = 0; i < n; i++) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) [re[i], re[j]] = [re[j], re[i]];
  }
  for (let length = 2; length <= n; length *= 2)
    for (let k = 0; k < length / 2; k++) {
      const [c, s] = [Math.cos((-2 * Math.PI * k) / length), Math.sin((-2 * Math.PI * k) / length)];
      for (let a = k; a < n; a += length) {
        const b = a + length / 2, x = re[b] * c - im[b] * s, y = re[b] * s + im[b] * c;
        [re[b], im[b]] = [re[a] - x, im[a] - y];
        [re[a], im[a]] = [re[a] + x, im[a] + y];
      }
    }
}

const WAWA = { viseme_PP: 'closed', viseme_FF: 'teeth', viseme_CH: 'rounded', viseme_O: 'middle-round', viseme_U: 'close-round', viseme_sil: 'silence' };
/** Runs wawa-lipsync without the page that it expects: sound at 48 kHz, sampled 60 times a second by the sound's clock. */
export async function wawa(folder) {
  const { Lipsync } = await moduleOf(folder, 'wawa-lipsync', 'dist/wawa-lipsync.es.js');
  return (samples, rate) => {
    const sound = resampled(samples, rate, 48000), analyser = new Analyser(sound), clock = performance.now;
    globalThis.window = { AudioContext: class {
      sampleRate = 48000;
      createAnalyser = () => analyser;
    } };
    const out = [];
    try {
      const lips = new Lipsync();
      for (let k = 1; k * 800 <= sound.length; k++) {
        analyser.at = k * 800;
        performance.now = () => (1000 * k) / 60;
        lips.processAudio();
        out.push({ class: WAWA[lips.viseme] ?? 'other', start: k / 60, end: (k + 1) / 60 });
      }
    } finally {
      performance.now = clock;
      delete globalThis.window;
    }
    return out;
  };
}
