// SPDX-License-Identifier: GPL-3.0-or-later
/** Markers' tracks in the files that others write: C3D of three kinds of machines, TRC, CSV. Tracks are {names, rate, places: mm[frame][marker]}. */

const BLOCK = 512;

function vax(value) {
  const ieee = Buffer.alloc(4);
  ieee.writeFloatBE(value * 4);
  return Buffer.from([ieee[1], ieee[0], ieee[3], ieee[2]]);
}

/** @param {{kind?: 84|85|86, whole?: number}} [form] the machine; whole: the scale of coordinates that are whole numbers */
export function toC3d({ names, rate, places }, { kind = 84, whole = 0 } = {}) {
  const short = (x) => {
    const out = Buffer.alloc(2);
    if (kind === 86) out.writeInt16BE(x);
    else out.writeInt16LE(x);
    return out;
  };
  const float = (x) => {
    if (kind === 85) return vax(x);
    const out = Buffer.alloc(4);
    if (kind === 86) out.writeFloatBE(x);
    else out.writeFloatLE(x);
    return out;
  };
  const entry = (group, name, body) => Buffer.concat([Buffer.from([name.length, group & 255]), Buffer.from(name), short(2 + body.length), body]);
  const width = Math.max(...names.map((name) => name.length));
  const words = (list, size) => Buffer.concat([Buffer.from([255, 2, size, list.length]), Buffer.from(list.map((word) => word.padEnd(size)).join('')), Buffer.from([0])]);
  const scale = whole || -1;
  const body = Buffer.concat([
    Buffer.from([1, 0x50, 2, kind]), entry(-1, 'POINT', Buffer.from([0])),
    entry(1, 'LABELS', words(names, width)), entry(1, 'UNITS', words(['mm'], 2)),
    entry(1, 'SCALE', Buffer.concat([Buffer.from([4, 0]), float(scale), Buffer.from([0])])),
    entry(1, 'RATE', Buffer.concat([Buffer.from([4, 0]), float(rate), Buffer.from([0])])),
    Buffer.from([0, 0]),
  ]);
  const parameters = Buffer.concat([body, Buffer.alloc(BLOCK * Math.ceil(body.length / BLOCK) - body.length)]);
  const start = 2 + parameters.length / BLOCK;
  const header = Buffer.concat([Buffer.from([2, 0x50]), short(names.length), short(0), short(1), short(places.length), short(0), float(scale), short(start), short(0), float(rate)]);
  const number = (x) => (whole ? short(Math.round(x / whole)) : float(x));
  const data = places.flatMap((frame) => frame.flatMap((p) => [...(p ?? [0, 0, 0]), p ? 0 : -1].map((x, k) => (whole && k === 3 ? short(x) : number(x)))));
  return Buffer.concat([header, Buffer.alloc(BLOCK - header.length), parameters, ...data]);
}

export function toTrc({ names, rate, places }) {
  const row = (frame, i) => [i + 1, (i / rate).toFixed(5), ...frame.flatMap((p) => (p ? p.map((x) => x.toFixed(4)) : ['', '', '']))].join('\t');
  return [
    'PathFileType\t4\t(X/Y/Z)\ttest.trc', 'DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames',
    [rate, rate, places.length, names.length, 'mm', rate, 1, places.length].join('\t'), `Frame#\tTime\t${names.join('\t\t\t')}`,
    `\t\t${names.map((_, i) => `X${i + 1}\tY${i + 1}\tZ${i + 1}`).join('\t')}`, '', ...places.map(row), '',
  ].join('\r\n');
}

export function toCsv({ names, rate, places }, separator = ',') {
  const rows = places.map((frame, i) => [(i / rate).toFixed(5), ...frame.flatMap((p) => (p ? p.map((x) => x.toFixed(4)) : ['', '', '']))]);
  return `${[['time', ...names.flatMap((name) => ['x', 'y', 'z'].map((axis) => `${name}_${axis}`))], ...rows].map((row) => row.join(separator)).join('\n')}\n`;
}
