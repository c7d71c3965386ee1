// SPDX-License-Identifier: GPL-3.0-or-later
// What tests/bench/people.mjs computes: figures of two curves, bootstrap over persons, and a ridge regression from phones to lips.

/** The CSV of `faccia eval --curve-table` of one recording: engine and contacts -> parameter -> { times, measured, predicted }; measured is null where it was not recorded. */
export function curveTable(csv) {
  const out = {};
  for (const line of csv.trim().split('\n').slice(1)) {
    const [, engine, contacts, parameter, time, measured, predicted] = line.split(',');
    const curve = ((out[`${engine} ${contacts}`] ??= {})[parameter] ??= { times: [], measured: measured ? [] : null, predicted: [] });
    curve.times.push(Number(time));
    curve.measured?.push(Number(measured));
    curve.predicted.push(Number(predicted));
  }
  return out;
}

const mean = (list) => list.reduce((a, b) => a + b, 0) / list.length;

/** Least standard deviation of a measured curve, mm: the accuracy of an articulograph. */
export const STILL = 0.5;

/** Pearson's correlation (0 where a curve is constant), the error left when a constant is taken off, and the person's standard deviation. */
export function figures({ measured, predicted }) {
  const [m, p] = [mean(measured), mean(predicted)];
  let mm = 0, pp = 0, mp = 0, dd = 0;
  for (let i = 0; i < measured.length; i++) {
    const a = measured[i] - m, b = predicted[i] - p;
    mm += a * a;
    pp += b * b;
    mp += a * b;
    dd += (a - b) ** 2;
  }
  return { r: mm > 1e-9 && pp > 1e-9 ? mp / Math.sqrt(mm * pp) : 0, rms: Math.sqrt(dd / measured.length), moved: Math.sqrt(mm / measured.length) };
}

/** mulberry32: the same numbers for the same seed. @returns {() => number} 0 to 1 */
export function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

const RESAMPLES = 10000;

/** The mean and the percentile bootstrap's 95 % interval. */
export function interval(values, seed = 1) {
  const next = random(seed);
  const means = Array.from({ length: RESAMPLES }, () => mean(values.map(() => values[Math.floor(next() * values.length)]))).sort((a, b) => a - b);
  return { value: mean(values), low: means[Math.floor(0.025 * RESAMPLES)], high: means[Math.floor(0.975 * RESAMPLES)] };
}

/** Solves A x = b for a symmetric positive matrix (Cholesky); b has several columns. */
export function solve(matrix, columns) {
  const n = matrix.length, l = matrix.map((row) => [...row]);
  for (let i = 0; i < n; i++)
    for (let j = 0; j <= i; j++) {
      let sum = l[i][j];
      for (let k = 0; k < j; k++) sum -= l[i][k] * l[j][k];
      l[i][j] = i === j ? Math.sqrt(sum) : sum / l[j][j];
    }
  return columns.map((b) => {
    const x = [...b];
    for (let i = 0; i < n; i++) {
      for (let k = 0; k < i; k++) x[i] -= l[i][k] * x[k];
      x[i] /= l[i][i];
    }
    for (let i = n; i-- > 0; ) {
      for (let k = i + 1; k < n; k++) x[i] -= l[k][i] * x[k];
      x[i] /= l[i][i];
    }
    return x;
  });
}

/** Lags in s at which the regression sees the phones' targets: about two phones before and behind. */
const LAGS = Array.from({ length: 13 }, (_, i) => (i - 6) * 0.03);
const PENALTIES = [0.03, 0.1, 0.3, 1, 3, 10];
const INPUTS = ['LI', 'LS', 'PI', 'PS', 'EM'];

function at({ times, predicted }, t) {
  const i = Math.min(Math.max(Math.floor((t - times[0]) / (times[1] - times[0])), 0), times.length - 1);
  return predicted[i];
}

/** What is known of each frame: the targets of the phones sounding at each lag (each phone's is the plain table's value in its middle). */
function features({ curves, phones, shift }) {
  const table = curves['table off'];
  const targets = phones.map(({ start, end }) => INPUTS.map((p) => (table[p] ? at(table[p], (start + end) / 2 + shift) : 0)));
  const first = phones.findIndex(({ end }) => end + shift > table.LI.times[0]);
  const sounding = (t) => {
    const i = phones.findIndex(({ end }) => t < end + shift);
    return targets[i < 0 ? targets.length - 1 : Math.max(i, first)];
  };
  return table.LI.times.map((t) => LAGS.flatMap((lag) => sounding(t + lag)));
}

/** Centred sums of squares and products of some recordings, each weighing the same. */
function moments(list, measures) {
  const n = LAGS.length * INPUTS.length;
  const xx = Array.from({ length: n }, () => new Array(n).fill(0)), xy = measures.map(() => new Array(n).fill(0));
  for (const { x, curves } of list) {
    const centre = x[0].map((_, i) => mean(x.map((row) => row[i])));
    const y = measures.map((m) => curves['table off'][m]?.measured ?? null), my = y.map((values) => values && mean(values));
    for (let k = 0; k < x.length; k++) {
      const row = x[k].map((v, i) => v - centre[i]);
      for (let i = 0; i < n; i++) {
        for (let j = 0; j < n; j++) xx[i][j] += (row[i] * row[j]) / x.length;
        for (let m = 0; m < measures.length; m++) if (y[m]) xy[m][i] += (row[i] * (y[m][k] - my[m])) / x.length;
      }
    }
  }
  return { xx, xy };
}

function train(list, measures, penalty) {
  const { xx, xy } = moments(list, measures);
  return solve(xx.map((row, i) => row.map((v, j) => v + (i === j ? penalty * list.length : 0))), xy);
}

const predict = (weights, x) => x.map((row) => row.reduce((sum, v, i) => sum + v * weights[i], 0));

/**
 * Adds the curves `ridge` to each recording, from weights of the other persons, of whom those marked `test` never count; the penalty is the one that suits
 * each of these best when it is left out in turn.
 */
export function ridgeOfOthers(all, persons, measures) {
  for (const one of all) one.x = features(one);
  for (const person of persons) {
    const others = all.filter((one) => one.person !== person && !one.test), rest = [...new Set(others.map((one) => one.person))];
    const score = (penalty) =>
      mean(rest.flatMap((left) => {
        const weights = train(others.filter((one) => one.person !== left), measures, penalty);
        return others.filter((one) => one.person === left).flatMap((one) => measures.flatMap((m, k) => (one.curves['table off'][m]?.measured ? [figures({ ...one.curves['table off'][m], predicted: predict(weights[k], one.x) }).r] : [])));
      }));
    const penalty = PENALTIES.map((p) => [score(p), p]).sort((a, b) => b[0] - a[0])[0][1];
    const weights = train(others, measures, penalty);
    for (const one of all.filter((o) => o.person === person)) {
      one.curves.ridge = {};
      measures.forEach((m, k) => {
        const curve = one.curves['table off'][m];
        if (curve?.measured) one.curves.ridge[m] = { ...curve, predicted: predict(weights[k], one.x) };
      });
    }
  }
}

const PLOT = { width: 900, height: 130, left: 60, top: 24 };
const LINES = { measured: '#000', 'dominance on': '#c2185b', 'table off': '#1976d2', ridge: '#388e3c' };

/** An SVG of one recording: for each measured parameter the person's curve beside the engines', each less its mean, mm over s. */
export function drawing(title, { curves, phones, shift }, measures) {
  const shown = measures.filter((m) => curves['dominance on']?.[m]?.measured);
  const { times } = curves['dominance on'][shown[0]];
  const x = (t) => (PLOT.left + ((t - times[0]) / (times.at(-1) - times[0])) * (PLOT.width - PLOT.left - 10)).toFixed(1);
  const rows = shown.map((m, row) => {
    const lines = Object.keys(LINES).flatMap((name) => {
      const curve = curves[name === 'measured' ? 'dominance on' : name]?.[m];
      const values = name === 'measured' ? curve.measured : curve?.predicted;
      if (!values) return [];
      const middle = mean(values);
      return [[name, values.map((v) => v - middle)]];
    });
    const most = Math.max(1, ...lines.flatMap(([, values]) => values.map(Math.abs)));
    const y = (v) => (PLOT.top + PLOT.height * (row + 0.5) - (v / most) * (PLOT.height / 2 - 6)).toFixed(1);
    return `<text x="4" y="${y(0)}">${m}</text><text x="4" y="${Number(y(0)) + 14}">±${most.toFixed(1)} mm</text><path d="M${PLOT.left} ${y(0)}H${PLOT.width - 10}" stroke="#ddd"/>` +
      lines.map(([name, values]) => `<polyline fill="none" stroke="${LINES[name]}" points="${values.map((v, i) => `${x(times[i])},${y(v)}`).join(' ')}"/>`).join('');
  });
  const bottom = PLOT.top + PLOT.height * shown.length;
  const bounds = phones.map(({ end }) => end + shift).filter((t) => t > times[0] && t < times.at(-1)).map((t) => `<path d="M${x(t)} ${PLOT.top}V${bottom}" stroke="#eee"/>`).join('');
  const legend = Object.entries(LINES).map(([name, colour], i) => `<text x="${PLOT.left + 240 + 150 * i}" y="16" fill="${colour}">${name === 'measured' ? 'person' : name}</text>`).join('');
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${PLOT.width} ${bottom + 6}" font-family="sans-serif" font-size="12"><text x="4" y="16">${title}</text>${legend}${bounds}${rows.join('')}</svg>\n`;
}
