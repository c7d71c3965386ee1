// SPDX-License-Identifier: GPL-3.0-or-later
// Data shared by heads and its savings: in transfers, if a second head omitted the data of the first; in the browser's memory, which stores equal
// data once. FACCIA_BUILD=build node tests/bench/run.mjs sharing
import fs from 'node:fs';
import path from 'node:path';
import zlib from 'node:zlib';
import { fileURLToPath } from 'node:url';
import { readModel } from '../../web/element/head/model/model.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const built = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'models/heads');
const LEAST = 400; // characters: references to shorter ones cost more than they save
const heads = fs.readdirSync(built).filter((file) => file.endsWith('.json')).map((file) => JSON.parse(fs.readFileSync(path.join(built, file))));
heads.sort((a, b) => a.rank - b.rank);
const packed = (value) => zlib.gzipSync(typeof value === 'string' ? value : JSON.stringify(value), { level: 9 }).length;
const kB = (bytes) => (bytes / 1000).toFixed(0);

/** All long strings of a head (arrays and images in base64) with their paths. */
function texts(value, place = [], out = new Map()) {
  if (typeof value === 'string') {
    if (value.length >= LEAST) out.set(value, place[0] === 'parts' ? `${place[1]} ${place[2]}` : place.slice(0, 2).join(' '));
  } else if (value && typeof value === 'object')
    for (const [key, one] of Object.entries(value)) texts(one, [...place, place.at(-1) === 'parts' ? one.name : key], out);
  return out;
}

const own = heads.map((head) => texts(head));
const kinds = new Map();
for (const [text, kind] of new Map(own.flatMap((one) => [...one]))) {
  const count = own.filter((one) => one.has(text)).length;
  const row = kinds.get(kind) ?? kinds.set(kind, { all: 0, same: 0 }).get(kind);
  const bytes = packed(text);
  row.all += bytes * count;
  row.same += bytes * (count - 1);
}
console.log(`| of ${heads.length} heads | kB, packed | of these the same as in another |\n|---|---|---|`);
for (const [kind, { all, same }] of [...kinds].sort((a, b) => b[1].same - a[1].same)) if (same > 2000) console.log(`| ${kind} | ${kB(all)} | ${kB(same)} |`);

const without = (value, known) =>
  typeof value === 'string' ? (known.has(value) ? '=' : value)
  : Array.isArray(value) ? value.map((one) => without(one, known))
  : value && typeof value === 'object' ? Object.fromEntries(Object.entries(value).map(([key, one]) => [key, without(one, known)])) : value;
const whole = heads.map(packed);
const rest = heads.slice(1).map((head) => packed(without(head, own[0])));
const mean = (list) => list.reduce((sum, x) => sum + x, 0) / list.length;
console.log(`\nAfter ${heads[0].title}: ${heads.slice(1).map(({ title }, i) => `${title} ${kB(rest[i])} of ${kB(whole[i + 1])}`).join(', ')} kB; ${kB(mean(whole.slice(1)) - mean(rest))} kB less in the mean, ${((1 - mean(rest) / mean(whole.slice(1))) * 100).toFixed(0)} %.`);

/** Bytes of distinct arrays and pictures in models. */
function memory(models, jsons) {
  const [buffers, images] = [new Set(), new Map()];
  const walk = (value) => {
    if (ArrayBuffer.isView(value)) buffers.add(value.buffer);
    else if (value && typeof value === 'object') Object.values(value).forEach(walk);
  };
  models.forEach(({ parts }) => walk(parts));
  for (const { textures } of jsons) for (const { data, width, height } of Object.values(textures)) images.set(data, width * height * 4);
  const sum = (list) => [...list].reduce((all, x) => all + x, 0);
  return { arrays: sum([...buffers].map(({ byteLength }) => byteLength)), images: sum(images.values()) };
}
const models = heads.map(readModel);
const MB = ({ arrays, images }) => `${(arrays / 1e6).toFixed(1)} MB of arrays, ${(images / 1e6).toFixed(1)} MB of pictures`;
console.log(`\nIn memory: ${heads[0].title} ${MB(memory([models[0]], [heads[0]]))}; ${heads[1].title} ${MB(memory([models[1]], [heads[1]]))}; both ${MB(memory(models.slice(0, 2), heads.slice(0, 2)))}; all ${MB(memory(models, heads))}, ${MB(heads.map((head, i) => memory([models[i]], [head])).reduce((a, b) => ({ arrays: a.arrays + b.arrays, images: a.images + b.images })))} if nothing were shared.`);

console.log('\n| texture | pixels | kB as WebP | MB on the graphics processor, with mipmaps |\n|---|---|---|---|');
for (const [name, { type, width, height, data }] of Object.entries(heads[0].textures))
  console.log(`| ${name} (${type}) | ${width} x ${height} | ${kB((data.length * 3) / 4)} | ${((width * height * 4 * 4) / 3 / 1e6).toFixed(1)} |`);
