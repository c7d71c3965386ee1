// SPDX-License-Identifier: MIT
// The plots of the Face Player: sound, spectrum, pitch and intensity, phones and words, curves; one time line, one cursor.
import { FFT, uPlot } from './player-kit.js';
import { prosody } from './prosody.js';

const WINDOW = 512;
const PEAKS = 2000; // columns of the wave
const SYNC = 'player';
const NEAR = 12; // pixels to a key

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Makes the options that all plots share. */
const options = (width, height, hooks, series, y) => ({
  width,
  height,
  legend: { show: false },
  cursor: { sync: { key: SYNC }, drag: { x: false, y: false }, y: false },
  scales: { x: { time: false }, y },
  axes: [
    { stroke: colour('--soft'), grid: { stroke: colour('--hair'), width: 1 }, ticks: { stroke: colour('--hair') }, size: 28 },
    { stroke: colour('--soft'), grid: { show: false }, ticks: { stroke: colour('--hair') }, size: 56 },
  ],
  padding: [6, 8, 0, 0],
  series: [{}, ...series],
  hooks,
});

/** Returns the highest and lowest sample of each column. */
function peaks(samples, rate) {
  const step = Math.max(1, Math.ceil(samples.length / PEAKS));
  const [x, high, low] = [[], [], []];
  for (let i = 0; i < samples.length; i += step) {
    let [most, least] = [-1, 1];
    for (let k = i; k < Math.min(samples.length, i + step); k++) {
      most = Math.max(most, samples[k]);
      least = Math.min(least, samples[k]);
    }
    x.push(i / rate);
    high.push(most);
    low.push(least);
  }
  return [x, high, low];
}

/** Draws the spectrum up to 8 kHz: a column for each step, low frequencies at the bottom. @returns {HTMLCanvasElement} */
function spectrum(samples, rate) {
  const fft = new FFT(WINDOW);
  const bins = Math.min(WINDOW / 2, Math.round((8000 / rate) * WINDOW));
  const columns = Math.min(1600, Math.max(1, Math.floor((samples.length - WINDOW) / (WINDOW / 4))));
  const step = (samples.length - WINDOW) / columns;
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width: columns, height: bins });
  const context = canvas.getContext('2d');
  const image = context.createImageData(columns, bins);
  const [input, output] = [new Array(WINDOW), fft.createComplexArray()];
  for (let c = 0; c < columns; c++) {
    const from = Math.round(c * step);
    for (let i = 0; i < WINDOW; i++) input[i] = (samples[from + i] ?? 0) * (0.5 - 0.5 * Math.cos((2 * Math.PI * i) / WINDOW));
    fft.realTransform(output, input);
    for (let b = 0; b < bins; b++) {
      const level = 20 * Math.log10(Math.hypot(output[2 * b], output[2 * b + 1]) + 1e-6);
      const ink = Math.min(1, Math.max(0, (level + 45) / 75));
      image.data.set([40, 30, 25, Math.round(255 * ink)], 4 * ((bins - 1 - b) * columns + c));
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

export class Plots {
  #plots = [];
  #curves = null;
  #drag = null;

  /**
   * @param {HTMLElement} box
   * @param {object} ports seek(seconds); key(frame, value, from): puts a key there (from: the one moved);
   *   drop(frame): deletes a key
   */
  constructor(box, ports) {
    Object.assign(this, { box, ports, take: null, shown: [], edited: 0, keys: [], time: 0 });
    const fit = (plot) => plot.setSize({ width: this.#width, height: plot.height });
    new ResizeObserver(() => this.#plots.forEach(fit)).observe(box);
  }

  get #width() {
    return Math.max(240, this.box.clientWidth);
  }

  /** @param {{duration: number, samples: Float32Array|null, rate: number, phones: object[], words: object[]}} take */
  open(take) {
    for (const plot of this.#plots) plot.destroy();
    this.take = take;
    this.#plots = [];
    this.#curves = null;
    const x = { time: false, range: [0, take.duration] };
    if (take.samples?.length > WINDOW) {
      const wave = options(this.#width, 90, this.#hooks(), [{}, {}], { range: [-1, 1] });
      wave.bands = [{ series: [1, 2], fill: colour('--accent') }];
      wave.scales.x = x;
      this.#add(wave, peaks(take.samples, take.rate), 'wave');
      const picture = spectrum(take.samples, take.rate);
      const hertz = options(this.#width, 130, this.#hooks((u) => {
        const { left, top, width, height } = u.bbox;
        const [from, to] = [u.valToPos(0, 'x', true), u.valToPos(take.samples.length / take.rate, 'x', true)];
        u.ctx.fillStyle = '#f4eee4';
        u.ctx.fillRect(left, top, width, height);
        u.ctx.drawImage(picture, from, top, to - from, height);
      }), [{ show: true }], { range: [0, Math.min(8, take.rate / 2000)] });
      hertz.scales.x = x;
      this.#add(hertz, [[0, take.duration], [null, null]], 'spectrum');
      const { times, pitch, intensity } = prosody(take.samples, take.rate);
      const lines = [
        { stroke: colour('--accent'), width: 2, points: { show: false }, spanGaps: false },
        { scale: 'dB', stroke: colour('--soft'), width: 1.25, points: { show: false } },
      ];
      const tune = options(this.#width, 110, this.#hooks(null, (u) => this.#names(u, ['Hz', 'dB'], lines)), lines, { range: [50, 450] });
      Object.assign(tune.scales, { x, dB: { range: [-70, 0] } });
      this.#add(tune, [times, pitch, intensity], 'prosody');
    }
    if (take.phones.length || take.words.length) {
      const lane = options(this.#width, 74, this.#hooks((u) => this.#lane(u)), [{}], { range: [0, 2] });
      lane.scales.x = x;
      lane.axes[1].values = () => [];
      this.#add(lane, [[0, take.duration], [null, null]], 'phones');
    }
  }

  /**
   * @param {{number: number, name: string, values: number[]}[]} curves @param {number} edited number of the curve with keys
   * @param {number} fps @param {number[]} keys frames
   */
  show(curves, edited, fps, keys) {
    Object.assign(this, { shown: curves, edited, keys, fps });
    const x = curves[0]?.values.map((_, k) => k / fps) ?? [0];
    const data = [x, ...curves.map(({ values }) => values)];
    const same = this.#curves?.names === `${edited} ${curves.map(({ name }) => name)}`;
    if (same) {
      this.#curves.plot.setData(data);
      return;
    }
    if (this.#curves) {
      this.#plots = this.#plots.filter((plot) => plot !== this.#curves.plot);
      this.#curves.plot.destroy();
    }
    const series = curves.map(({ number }, i) => ({
      stroke: number === edited ? colour('--accent') : `hsl(${(i * 47 + 190) % 360} 45% 50%)`, width: number === edited ? 3 : 1.25, points: { show: false },
    }));
    const plot = options(this.#width, 260, this.#hooks(null, (u) => this.#keyMarks(u)), series, {});
    plot.scales.x = { time: false, range: [0, this.take.duration] };
    this.#curves = { names: `${edited} ${curves.map(({ name }) => name)}`, plot: this.#add(plot, data, 'curves') };
    this.#editable(this.#curves.plot);
  }

  /** Moves the cursor. */
  at(seconds) {
    this.time = seconds;
    for (const plot of this.#plots) plot.redraw(false);
  }

  #add(plotOptions, data, name) {
    const plot = new uPlot(plotOptions, data, this.box);
    plot.root.dataset.plot = name;
    plot.over.addEventListener('click', (event) => {
      if (!this.#drag) this.ports.seek(plot.posToVal(event.offsetX, 'x'));
    });
    this.#plots.push(plot);
    return plot;
  }

  #hooks(before, after) {
    const now = (u) => {
      const x = u.valToPos(this.time, 'x', true);
      u.ctx.fillStyle = colour('--ink');
      u.ctx.fillRect(x - 1, u.bbox.top, 2, u.bbox.height);
    };
    return { drawClear: before ? [before] : [], draw: [...(after ? [after] : []), now] };
  }

  /** Names lines in their colours. */
  #names(u, names, lines) {
    u.ctx.save();
    u.ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    u.ctx.textBaseline = 'top';
    names.forEach((name, i) => {
      u.ctx.fillStyle = lines[i].stroke;
      u.ctx.fillText(name, u.bbox.left + (14 + 26 * i) * devicePixelRatio, u.bbox.top);
    });
    u.ctx.restore();
  }

  #lane(u) {
    const { top, height } = u.bbox;
    const { ctx } = u;
    const scale = devicePixelRatio;
    ctx.save();
    ctx.textAlign = 'center';
    ctx.textBaseline = 'middle';
    const row = (items, at, text, size) => {
      ctx.font = `${size * scale}px system-ui, sans-serif`;
      for (const item of items) {
        const [from, to] = [item.start, item.end].map((time) => u.valToPos(time, 'x', true));
        ctx.strokeStyle = colour('--line');
        ctx.strokeRect(from, top + (at * height) / 2, to - from, height / 2);
        ctx.fillStyle = colour('--ink');
        const word = text(item);
        if (ctx.measureText(word).width > to - from + 6 * scale) continue;
        ctx.fillText(word, (from + to) / 2, top + ((at + 0.5) * height) / 2);
      }
    };
    row(this.take.words, 0, ({ text }) => text, 13);
    row(this.take.phones, 1, ({ ipa }) => ipa, 12);
    ctx.restore();
  }

  #keyMarks(u) {
    const curve = this.shown.find(({ number }) => number === this.edited);
    if (!curve) return;
    const size = 4 * devicePixelRatio;
    for (const [k, value] of this.#drag?.drawn ?? []) {
      u.ctx.fillStyle = colour('--accent');
      u.ctx.fillRect(u.valToPos(k / this.fps, 'x', true) - size / 2, u.valToPos(value, 'y', true) - size / 2, size, size);
    }
    for (const k of this.keys) {
      u.ctx.beginPath();
      u.ctx.arc(u.valToPos(k / this.fps, 'x', true), u.valToPos(curve.values[k], 'y', true), size, 0, 2 * Math.PI);
      u.ctx.fillStyle = colour('--card');
      u.ctx.strokeStyle = colour('--accent');
      u.ctx.lineWidth = 2 * devicePixelRatio;
      u.ctx.fill();
      u.ctx.stroke();
    }
  }

  #frameAt(plot, x) {
    return Math.min(this.shown[0].values.length - 1, Math.max(0, Math.round(plot.posToVal(x, 'x') * this.fps)));
  }

  /** Drag moves a key, Shift-drag draws the curve, a double click adds a key or deletes one. */
  #editable(plot) {
    const { over } = plot;
    const keyNear = (event) => {
      const values = this.shown.find(({ number }) => number === this.edited)?.values;
      if (!values) return undefined;
      const away = (k) =>
        Math.hypot(plot.valToPos(k / this.fps, 'x') - event.offsetX, plot.valToPos(values[k], 'y') - event.offsetY);
      return this.keys.filter((k) => away(k) < NEAR).sort((a, b) => away(a) - away(b))[0];
    };
    over.addEventListener('pointerdown', (event) => {
      const key = keyNear(event);
      if (!event.shiftKey && key === undefined) return;
      this.#drag = event.shiftKey ? { drawn: new Map() } : { from: key, at: null };
      over.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    over.addEventListener('pointermove', (event) => {
      over.style.cursor = keyNear(event) === undefined ? '' : 'grab';
      if (!this.#drag) return;
      const at = { frame: this.#frameAt(plot, event.offsetX), value: plot.posToVal(event.offsetY, 'y') };
      if (!this.#drag.drawn) this.#drag.at = at;
      else {
        this.#drag.drawn.set(at.frame, at.value);
        plot.redraw(false);
      }
    });
    over.addEventListener('pointerup', () => {
      const { from, at, drawn } = this.#drag ?? {};
      if (drawn?.size) this.ports.draw(drawn);
      if (at) this.ports.key(at.frame, Math.round(at.value), from);
      setTimeout(() => (this.#drag = null)); // ignores the click that follows a drag
    });
    over.addEventListener('dblclick', (event) => {
      const key = keyNear(event);
      if (key === undefined) this.ports.key(this.#frameAt(plot, event.offsetX), Math.round(plot.posToVal(event.offsetY, 'y')));
      else this.ports.drop(key);
    });
  }
}
