// SPDX-License-Identifier: GPL-3.0-or-later
// Writes FBA bitstreams of every form that ISO/IEC 14496-2 allows a sender, with more than `faccia fap encode` uses: ranges left
// to the defaults, masks of each type, frames without start codes, time codes, skipped frames, codes of the drafts.
import { faps } from '../../protocol/fap.mjs';

const GROUPS = [2, 16, 12, 8, 4, 5, 3, 10, 4, 4];

class Model {
  constructor(min, max) {
    this.min = min;
    this.counts = Array(max - min + 1).fill(1);
  }
  total(from = 0) {
    return this.counts.slice(from).reduce((sum, count) => sum + count, 0);
  }
  add(symbol) {
    if (this.total() === 16383) this.counts = this.counts.map((count) => Math.trunc((count + 1) / 2));
    this.counts[symbol]++;
  }
}

export class FbaWriter {
  /** @param {{start?: number, plane?: number, before?: number[]}} codes before: bytes before the start code */
  constructor({ start = 0x1ba, plane = 0x1bb, before = [] } = {}) {
    this.bits = before.flatMap((byte) => [...byte.toString(2).padStart(8, '0')].map(Number));
    this.plane = plane;
    this.put(start, 32);
    this.shown = Array(69).fill(0);
    this.parts = [0, 0, 0, 0, 0, 0, 0];
    this.ranges = ['i_steps', 'i_steps', 'p_steps', 'p_steps'].map((steps) => faps.map((fap) => Math.ceil(fap[steps] / 60) * 60));
  }

  put(value, count) {
    for (let i = count - 1; i >= 0; i--) this.bits.push(Math.floor(value / 2 ** i) & 1);
  }

  code(value) {
    this.bits.push(0);
    while (this.bits.length % 8) this.bits.push(1);
    this.put(value, 32);
  }

  /** @param {[Model, number, boolean][]} symbols model, value, whether it adapts */
  codeword(symbols) {
    let [low, high, waiting, zeros] = [0, 65535, 0, 0];
    const out = (bit) => {
      if (zeros === 22) {
        this.bits.push(1);
        this.stuffed = (this.stuffed ?? 0) + 1;
        zeros = 0;
      }
      this.bits.push(bit);
      zeros = bit ? 0 : zeros + 1;
    };
    const settle = (bit) => {
      out(bit);
      for (; waiting; waiting--) out(1 - bit);
    };
    for (const [model, value, adapt] of symbols) {
      const symbol = value - model.min;
      if (!(symbol >= 0 && symbol < model.counts.length)) throw new RangeError(`${value} is not in ${model.min}..${model.min + model.counts.length - 1}`);
      const [range, total] = [high - low + 1, model.total()];
      high = low - 1 + Math.floor((range * model.total(symbol)) / total);
      low += Math.floor((range * model.total(symbol + 1)) / total);
      while (high < 32768 || low >= 32768 || (low >= 16384 && high < 49152)) {
        const base = high < 32768 ? 0 : low >= 32768 ? 32768 : 16384;
        if (base === 16384) waiting++;
        else settle(base ? 1 : 0);
        [low, high] = [2 * (low - base), 2 * (high - base) + 1];
      }
      if (adapt) model.add(symbol);
    }
    waiting++;
    settle(low < 16384 ? 0 : 1);
  }

  /**
   * Writes a frame and returns what a decoder must show: {values, viseme, expression}.
   * @param {{intra?: boolean, start?: boolean, rate?: number[], time?: number[], skip?: number, quant?: number, types?: number[],
   *   mask?: number[], ranges?: (Record<number, number> | number)[], dct?: boolean, body?: number, levels: Record<number, number>,
   *   viseme?: number[], expression?: number[]}} frame types: of the ten groups; mask: FAPs that are sent; ranges: highest and
   *   lowest of I and of P frames, in steps of 60, for all FAPs or each; levels: what is coded; viseme, expression: the values
   */
  frame({ intra, start = intra, rate, time, skip, quant = 1, types, mask, ranges = [], dct = false, body = 1, levels = {}, viseme, expression }) {
    if (start) this.code(this.plane);
    this.put(intra ? 1 : 0, 1);
    this.put(body, 2);
    if (intra) {
      this.put(rate ? 1 : 0, 1);
      if (rate) [8, 4, 1].forEach((size, i) => this.put(rate[i], size));
      this.put(time ? 1 : 0, 1);
      if (time) [5, 6, 1, 6].forEach((size, i) => this.put([time[0], time[1], 1, time[2]][i], size));
    }
    this.put(skip === undefined ? 0 : 1, 1);
    for (let left = skip; left !== undefined; left -= 15) {
      this.put(Math.min(left, 15), 4);
      if (left < 15) break;
    }
    if (intra) this.header({ quant, types, mask, ranges, dct });
    if (dct) return undefined;
    const shown = {};
    if (this.mask[1]) shown.viseme = this.high([0, 1, 2], viseme, 1, intra);
    if (this.mask[2]) shown.expression = this.high([3, 4, 5, 6], expression, 2, intra);
    const sent = [...this.mask.keys()].filter((n) => n > 2 && this.mask[n]);
    this.codeword(sent.map((n) => [(intra ? this.intra : this.inter)[n], levels[n] ?? 0, !intra]));
    if (intra) this.shown.fill(0);
    for (const n of sent) this.shown[n] += (levels[n] ?? 0) * (this.quant ? this.quant * faps[n].quant_step : 1);
    return { ...shown, values: this.shown.map((value, n) => (this.mask[n] && n > 2 ? value : 0)) };
  }

  header({ quant, types, mask = [], ranges, dct }) {
    this.put(quant, 5);
    this.quant = quant;
    this.mask = Array(69).fill(0);
    let n = 1;
    GROUPS.forEach((size, g) => {
      const type = types[g];
      this.put(1, 1);
      this.put(type, 2);
      for (let i = 0; i < size; i++, n++) {
        this.mask[n] = type === 3 || (type && mask.includes(n)) ? 1 : 0;
        if (type === 1 || type === 2) this.put(this.mask[n], 1);
      }
    });
    this.put(1, 1); // suggested_gender
    this.put(dct ? 1 : 0, 1);
    if (dct) return;
    for (let i = 0; i < 4; i++) this.put(ranges[i] === undefined ? 0 : 1, 1);
    ranges.forEach((range, i) => range !== undefined && this.range(this.ranges[i], range));
    const levels = (which, k) => Math.trunc(this.ranges[which][k] / (quant || 1));
    const models = (most, least) => this.mask.map((on, k) => (on && k > 2 ? new Model(-levels(least, k), levels(most, k)) : null));
    [this.intra, this.inter] = [models(0, 1), models(2, 3)];
    this.most = [14, 14, 63, 6, 63, 6, 63].map((most) => (most === 63 && quant ? Math.trunc((63 + Math.trunc(quant / 2)) / quant) : most));
    this.highIntra = this.most.map((most) => new Model(0, most));
    this.highInter = this.most.map((most) => new Model(-most, most));
  }

  range(range, given) {
    let n = 3;
    for (const size of GROUPS.slice(1))
      for (let i = 0; i < size; i++, n++) {
        if (i % 4 === 0) this.put(1, 1);
        if (!this.mask[n]) continue;
        const stated = typeof given === 'number' ? given : given[n];
        this.put(stated, 5);
        range[n] = stated * 60;
      }
  }

  high(which, values, flags, intra) {
    const steps = which.map((part) => ([2, 4, 6].includes(part) ? this.quant || 1 : 1));
    const levels = which.map((part, i) => Math.round((values[i] - (intra ? 0 : this.parts[part])) / steps[i]));
    this.codeword(which.map((part, i) => [(intra ? this.highIntra : this.highInter)[part], levels[i], !intra]));
    which.forEach((part, i) => (this.parts[part] = (intra ? 0 : this.parts[part]) + levels[i] * steps[i]));
    for (let i = 0; i < flags; i++) this.put(values[which.length + i], 1);
    return [...which.map((part) => Math.min([14, 14, 63, 6, 63, 6, 63][part], Math.max(0, this.parts[part]))), ...values.slice(which.length)];
  }

  /** @param {'code' | 'ones' | 'zeros'} how the stream ends */
  end(how = 'code') {
    if (how === 'code') this.code(0x1b1);
    else if (how === 'ones' && this.bits.length % 8) this.bits.push(0);
    while (this.bits.length % 8) this.bits.push(how === 'ones' ? 1 : 0);
    return Buffer.from(Array.from({ length: this.bits.length / 8 }, (_, i) => parseInt(this.bits.slice(8 * i, 8 * i + 8).join(''), 2)));
  }
}
