// SPDX-License-Identifier: GPL-3.0-or-later
// Films by `faccia film`, decoded again: every picture is there once and shows its own moment, and the sound is that of `faccia say`.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { PNG } from 'pngjs';
import { faceValues } from '../../web/element/face/face-mixer.mjs';
import { writeFap } from '../../web/pages/player/file.js';
import { faccia } from '../lib/command.mjs';
import { build, eventually, root } from '../lib/daemon.mjs';
import { descendantsOf, stillRunning } from '../lib/descendants.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { shownWithin } from '../lib/mouth.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'film-'));
after(() => fs.rmSync(folder, { recursive: true }));
const at = (name) => path.join(folder, name);

const TEXT = '<speak>La mamma va. <break time="500ms"/> Il papà beve.</speak>';
const SAID = ['--lang', 'it', '--voice', 'espeak:it', '--markup', 'ssml', '--still', '--seed', '3'];
const SMALL = ['--size', '160x120'];

/** Films, and returns what was printed. */
function film(output, ...args) {
  const { status, stderr } = faccia(['film', '-o', at(output), ...args]);
  assert.equal(status, 0, stderr);
  return stderr;
}

const ffmpeg = (args) => {
  const { status, stdout, stderr } = spawnSync('ffmpeg', ['-v', 'error', ...args], { maxBuffer: 1 << 30 });
  assert.equal(status, 0, String(stderr));
  return stdout;
};
const sound = (file) => ffmpeg(['-i', at(file), '-f', 's16le', '-c:a', 'pcm_s16le', '-']);

/** The pictures of a film, as red, green, blue (and alpha with another format). */
function pictures(file, bytes, { format = 'rgb24', decoder = [] } = {}) {
  const all = ffmpeg([...decoder, '-i', at(file), '-fps_mode', 'passthrough', '-f', 'rawvideo', '-pix_fmt', format, '-']);
  assert.equal(all.length % bytes, 0);
  return Array.from({ length: all.length / bytes }, (_, k) => all.subarray(k * bytes, (k + 1) * bytes));
}

/** Mean difference of two pictures' values. */
const apart = (a, b) => a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;

/** The inside of the mouth in the view `mouth`: pixels much darker than lips. */
function dark(picture, [top, bottom, left, right] = [40, 90, 45, 115]) {
  let count = 0;
  for (let y = top; y < bottom; y++)
    for (let x = left; x < right; x++) {
      const i = 3 * (160 * y + x);
      count += picture[i] + picture[i + 1] + picture[i + 2] < 220;
    }
  return count;
}

const said = {};
test('what is filmed is spoken', () => {
  for (const name of ['wav', 'fap', 'json']) {
    const { status, bytes, stderr } = faccia(['say', ...SAID, `--${name}`, '-', TEXT]);
    assert.equal(status, 0, stderr);
    said[name] = bytes;
  }
  said.face = parseFap(String(said.fap));
  said.phones = JSON.parse(said.json).phones;
});

test('has each picture once, at its time, and the sound sample by sample', () => {
  film('exact.mp4', ...SAID, '--model', 'mara', '--view', 'mouth', '--lossless', ...SMALL, TEXT);
  const shown = pictures('exact.mp4', 160 * 120 * 3);
  const { fps, frames } = said.face;
  const samples = (said.wav.length - 44) / 2;
  assert.equal(shown.length, Math.ceil((samples / said.wav.readUInt32LE(24)) * fps));
  assert.equal(shown.length, frames.length);
  assert.ok(sound('exact.mp4').equals(said.wav.subarray(44)));
  const still = [];
  for (let k = 1; k < shown.length; k++) {
    const moves = frames[k].some((value, n) => value !== frames[k - 1][n]);
    if (!moves) still.push(k);
    if (!moves) assert.ok(shown[k].equals(shown[k - 1]), `picture ${k} moves, the face does not`);
  }
  const large = (k) => Math.max(...[3, 4, 5, 10, 11, 12].map((n) => Math.abs(frames[k][n] - frames[k - 1][n]))) > 30;
  const doubled = shown.flatMap((picture, k) => (k && large(k) && picture.equals(shown[k - 1]) ? [k] : []));
  assert.deepEqual(doubled, []);
  assert.ok(still.length >= 3 && shown.some((_, k) => k && large(k)), `${still.length}`);
  // closed lips at their pictures, open ones between them
  const opening = shown.map((picture) => dark(picture));
  const during = (phone) => {
    const { first, end } = shownWithin(phone, fps);
    return opening.slice(first, end);
  };
  const sounds = (pattern) => said.phones.filter(({ ipa }) => pattern.test(ipa));
  const closed = sounds(/^[mpb]/).map((phone) => Math.min(...during(phone)));
  const open = sounds(/^a/).map((phone) => Math.max(...during(phone)));
  assert.ok(closed.length >= 6 && open.length >= 6, `${closed} ${open}`);
  assert.ok(Math.max(...closed) + 10 < Math.min(...open), `closed ${closed}, open ${open}`);
});

test('numbered pictures and one picture are those of the film, with its sound', () => {
  film('name-%03d.png', ...SAID, '--model', 'mara', '--view', 'mouth', ...SMALL, TEXT);
  const shown = pictures('exact.mp4', 160 * 120 * 3);
  const names = fs.readdirSync(folder).filter((name) => /^name-\d{3}\.png$/.test(name)).sort();
  assert.equal(names.length, shown.length);
  assert.equal(names[0], 'name-001.png');
  for (const [k, name] of names.entries()) assert.ok(pictures(name, 160 * 120 * 3)[0].equals(shown[k]), name);
  assert.ok(fs.readFileSync(at('name.wav')).subarray(44).equals(said.wav.subarray(44)));
  film('one.png', ...SAID, '--model', 'mara', '--view', 'mouth', '--at', String(7 / said.face.fps), ...SMALL, TEXT);
  assert.ok(pictures('one.png', 160 * 120 * 3)[0].equals(shown[7]));
});

test('a sheet shows the visemes of a language', () => {
  const [width, height] = [160, 120];
  const cell = (sheet, k) => {
    const rows = Array.from({ length: height }, (_, y) => {
      const from = 3 * (5 * width * (Math.floor(k / 5) * height + y) + (k % 5) * width);
      return sheet.subarray(from, from + 3 * width);
    });
    return Buffer.concat(rows);
  };
  const [it, en] = ['it', 'en'].map((lang) => {
    film(`${lang}.png`, '--visemes', lang, '--model', 'mara', '--view', 'mouth', ...SMALL);
    const [sheet] = pictures(`${lang}.png`, 5 * width * 3 * height * 3);
    return Array.from({ length: 15 }, (_, k) => cell(sheet, k));
  });
  const [rest, lips, open] = [0, 1, 10].map((k) => dark(it[k]));
  assert.ok(open > Math.max(rest, lips) + 20, `${rest} ${lips} ${open}`);
  assert.equal(new Set(it.map((one) => one.toString('latin1'))).size, 15);
  assert.ok(it[1].equals(en[1]) && !it[14].equals(en[14])); // English has an u of its own
});

test('the mouth has a back behind every tongue', () => {
  film('through.png', '--visemes', 'it', '--model', 'ettore', '--view', 'mouth', '--background', '#ff00ff', ...SMALL);
  const [sheet] = pictures('through.png', 800 * 360 * 3);
  const through = (column, row) => {
    let count = 0;
    for (let y = 120 * row + 40; y < 120 * row + 90; y++)
      for (let x = 160 * column + 45; x < 160 * column + 115; x++) {
        const [red, green, blue] = sheet.subarray(3 * (800 * y + x));
        count += red > 200 && green < 40 && blue > 200;
      }
    return count;
  };
  const open = Array.from({ length: 15 }, (_, k) => through(k % 5, Math.floor(k / 5)));
  assert.deepEqual(open, Array(15).fill(0));
});

test('each quality fills the picture with the same head', () => {
  const [low, fine, high] = ['low', 'fine', 'high'].map((quality) => {
    film(`${quality}.png`, ...SAID, '--model', 'mara', '--at', '0.2', '--quality', quality, ...SMALL, TEXT);
    return pictures(`${quality}.png`, 160 * 120 * 3)[0];
  });
  assert.ok(apart(low, fine) < 8 && apart(high, fine) < 8, `${apart(low, fine)} ${apart(high, fine)}`);
  assert.ok(!low.equals(fine) && !high.equals(fine));
});

test('a set of pictures is filmed in the place of its head, on each background, and a file of a head or a set is', () => {
  const one = (name, ...args) => {
    film(name, ...SAID, '--at', '0.2', ...SMALL, ...args, TEXT);
    return pictures(name, 160 * 120 * 4, { format: 'rgba' })[0];
  };
  const head = one('as-head.png', '--model', 'mara', '--background', 'skyblue');
  const set = one('as-set.png', '--model', 'mara', '--background', 'skyblue', '--quality', 'pictures');
  assert.ok(apart(head, set) < 8 && !head.equals(set), `${apart(head, set)}`);
  const blue = [0, 159].map((x) => [...set.subarray(4 * x, 4 * x + 4)]);
  assert.deepEqual(blue, Array(2).fill([135, 206, 235, 255]));
  const own = one('own.png', '--pictures', path.join(build, 'models/pictures/mara.json'), '--background', 'skyblue');
  assert.ok(own.equals(set));
  assert.ok(one('file.png', '--model', path.join(build, 'models/heads/mara.json'), '--background', 'skyblue').equals(head));
  const clear = one('clear.png', '--model', 'mara', '--background', 'transparent', '--quality', 'pictures');
  assert.equal(clear[3], 0);
  const middle = 4 * (160 * 60 + 80);
  assert.deepEqual(clear.subarray(middle, middle + 4), set.subarray(middle, middle + 4));
  // where the head lets light through, the same colour stands before it
  const soft = Array.from({ length: 160 * 120 }, (_, i) => 4 * i).filter((i) => clear[i + 3] > 100 && clear[i + 3] < 250);
  assert.ok(soft.length > 20, `${soft.length}`);
  for (const i of soft) for (let k = 0; k < 3; k++) {
    const share = clear[i + 3] / 255;
    assert.ok(Math.abs(clear[i + k] * share + [135, 206, 235][k] * (1 - share) - set[i + k]) < 6, `${i}`);
  }
});

test('a set of pictures moves its lips as the score does, once for each picture', () => {
  film('set.mp4', ...SAID, '--model', 'mara', '--view', 'mouth', '--quality', 'pictures', '--lossless', ...SMALL, TEXT);
  const shown = pictures('set.mp4', 160 * 120 * 3), { fps, frames } = said.face;
  assert.equal(shown.length, frames.length);
  assert.ok(sound('set.mp4').equals(said.wav.subarray(44)));
  const during = (ipa) => said.phones.filter((phone) => phone.ipa === ipa).map(({ start, end }) => dark(shown[Math.round(((start + end) / 2) * fps)], [42, 65, 62, 98]));
  assert.ok(Math.min(...during('a')) > Math.max(...during('m')) + 4, `a ${during('a')} m ${during('m')}`);
});

test('mesh, feature points and the zone of a FAP are drawn over the face', () => {
  const one = (name, ...args) => {
    film(name, ...SAID, '--model', 'ettore', '--at', '0.2', '--background', 'white', ...SMALL, ...args, TEXT);
    return pictures(name, 160 * 120 * 3)[0];
  };
  /** Rows of the pixels that an overlay made much more like this colour. */
  const plain = one('bare.png');
  const rows = (shown, colour) => Array.from({ length: 160 * 120 }, (_, i) => i).filter((i) => {
    const far = (picture) => colour.reduce((sum, value, k) => sum + Math.abs(value - picture[3 * i + k]), 0);
    return far(plain) - far(shown) > 60;
  }).map((i) => Math.floor(i / 160));
  const mesh = rows(one('mesh.png', '--show', 'mesh'), [0, 114, 178]), zone = rows(one('zone.png', '--show', 'zone=3'), [213, 94, 0]);
  assert.ok(mesh.length > 2000, `${mesh.length}`);
  assert.ok(zone.length > 60 && Math.min(...zone) > 52, `${zone.length} from row ${Math.min(...zone)}`); // the jaw, below the eyes
  const both = one('both.png', '--show', 'points,mesh');
  assert.ok(rows(both, [0, 158, 115]).length > 60 && rows(both, [0, 114, 178]).length > 1000);
});

test('what cannot be filmed as pictures, or shown, is told', () => {
  const refused = (...args) => faccia(['film', '-o', at('no.png'), '--at', '0', ...args, 'Ciao.']);
  for (const [args, pattern] of [
    [['--pictures', at('missing.json')], /--pictures: .*missing\.json: No such file/],
    [['--pictures', path.join(build, 'models/heads/mara.json')], /--pictures: .*mara\.json: this is not a set of pictures/],
    [['--model', path.join(build, 'models/pictures/mara.json')], /--model: .*mara\.json: this is not a head model/],
    [['--model', at('missing.json')], /--model: .*missing\.json: No such file/],
    [['--quality', 'pictures', '--show', 'mesh'], /--show: pictures have nothing behind them/],
    [['--show', 'mesh,bones'], /--show: invalid value 'mesh,bones': expected mesh, points, or zone=/],
    [['--pictures', 'x.json', '--model', 'mara'], /--pictures: it takes the place of --model/],
    [['--pictures', 'x.json', '--quality', 'low'], /--pictures: it takes the place of --model, and has one quality/],
  ]) {
    const { status, stderr } = refused(...args);
    assert.notEqual(status, 0);
    assert.match(stderr, pattern);
  }
});

const PLAY = `<TEI xmlns="http://www.tei-c.org/ns/1.0"><teiHeader><fileDesc><titleStmt><title>La barca</title></titleStmt><publicationStmt><p/></publicationStmt>
<sourceDesc><p/></sourceDesc></fileDesc><profileDesc><langUsage><language ident="it"/></langUsage></profileDesc></teiHeader><text><body><div><head>Sul molo</head>
<sp><speaker>Anna</speaker><p>Hai visto la barca?</p></sp><sp><speaker>Ugo</speaker><p>No, non la vedo.</p></sp><sp><speaker>Anna</speaker><p>Arriva adesso.</p></sp>
</div></body></text></TEI>`;

test('two heads show a scene of the library: one speaks, the other rests', () => {
  fs.mkdirSync(at('works'));
  fs.writeFileSync(at('works/barca.xml'), PLAY);
  film('pair.mp4', '--library', at('works'), '--passage', 'barca:1', '--still', '--model', 'mara', '--partner', 'bruno', '--view', 'mouth', '--lossless', '--captions', 'track', '--size', '320x120');
  const shown = pictures('pair.mp4', 320 * 120 * 3);
  const half = (picture, side) => Buffer.concat(Array.from({ length: 120 }, (_, y) => picture.subarray(3 * (320 * y + 160 * side), 3 * (320 * y + 160 * side + 160))));
  const cues = [...String(ffmpeg(['-i', at('pair.mp4'), '-map', '0:s', '-f', 'webvtt', '-'])).matchAll(/([\d:.]+) --> ([\d:.]+)\n(.*)/g)]
    .map(([, start, end, text]) => ({ text, from: start, to: end }))
    .map(({ text, ...times }) => ({ text, ...Object.fromEntries(Object.entries(times).map(([name, time]) => [name, Math.ceil(25 * time.split(':').reduce((sum, part) => 60 * sum + Number(part), 0))])) }));
  assert.deepEqual(cues.map(({ text }) => text.replace(/<[^>]*>/g, '')), ['Sul molo', 'Hai visto la barca?', 'No, non la vedo.', 'Arriva adesso.']);
  const kinds = cues.map(({ from, to }) => [0, 1].map((side) => new Set(shown.slice(from + 3, to).map((picture) => half(picture, side).toString('latin1'))).size));
  const speaks = [0, 0, 1, 0];
  for (const [i, side] of speaks.entries()) assert.ok(kinds[i][side] > 4 && kinds[i][1 - side] === 1, JSON.stringify(kinds));
  film('block.mp4', '--library', at('works'), '--passage', 'barca:1:p2', '--lossless', ...SMALL);
  const only = pictures('block.mp4', 160 * 120 * 3).length;
  assert.ok(only > 15 && only < shown.length / 2, `${only} of ${shown.length}`);
});

test('a recorded face is filmed with its own sound, at another rate too', () => {
  fs.writeFileSync(at('said.fap'), said.fap);
  fs.writeFileSync(at('other.wav'), said.wav);
  film('from.mp4', '--from', at('said.fap'), '--audio', at('other.wav'), '--fps', String(2 * said.face.fps), '--still', '--model', 'mara', '--view', 'mouth', '--lossless', ...SMALL);
  const [shown, every] = ['exact.mp4', 'from.mp4'].map((name) => pictures(name, 160 * 120 * 3));
  assert.equal(every.length, 2 * shown.length);
  for (const [k, picture] of shown.entries()) assert.ok(every[2 * k].equals(picture), `${k}`);
  const { bytes } = faccia(['play', at('said.fap'), at('other.wav'), '--wav', '-']);
  assert.ok(sound('from.mp4').equals(bytes.subarray(44)));
});

/** A face at rest that turns its head in the middle, within 0.2 s: 2 s at 25 faces a second. */
const TURNED = writeFap({ name: 'turned', fps: 25, high: [], frames: Array.from({ length: 50 }, (_, k) => faceValues({ 49: 3600 * Math.max(0, Math.min(5, k - 24)) })) });

test('a head breathes, and her hair comes after it, the same in each film; one that keeps still does neither', () => {
  fs.writeFileSync(at('turned.fap'), TURNED);
  const shot = (...args) => {
    film('alive.mp4', '--from', at('turned.fap'), '--model', 'mara', '--background', '#00ff00', '--lossless', ...SMALL, ...args);
    return pictures('alive.mp4', 160 * 120 * 3);
  };
  const changes = (list, from, to) => list.slice(from + 1, to).filter((picture, i) => !picture.equals(list[from + i])).length;
  const alive = shot();
  assert.equal(alive.length, 50);
  assert.ok(changes(alive, 0, 24) > 15, `breath: ${changes(alive, 0, 24)}`);
  for (const [k, picture] of shot().entries()) assert.ok(picture.equals(alive[k]), `picture ${k} of the second film`);
  const breathless = shot('--life', '0');
  assert.equal(changes(breathless, 0, 24), 0);
  assert.ok(changes(breathless, 29, 40) > 5, `hair: ${changes(breathless, 29, 40)}`);
  const still = shot('--still');
  assert.deepEqual([changes(still, 0, 24), changes(still, 29, 50)], [0, 0]);
  film('alive.png', '--from', at('turned.fap'), '--model', 'mara', '--background', '#00ff00', '--at', String(33 / 25), ...SMALL);
  assert.ok(pictures('alive.png', 160 * 120 * 3)[0].equals(alive[33]));
});

test('WebM keeps transparency, captions and every picture', () => {
  film('clear.webm', ...SAID, '--background', 'transparent', '--captions', 'track', ...SMALL, TEXT);
  const shown = pictures('clear.webm', 160 * 120 * 4, { format: 'rgba', decoder: ['-c:v', 'libvpx-vp9'] });
  assert.equal(shown.length, said.face.frames.length);
  const alpha = (picture, x, y) => picture[4 * (160 * y + x) + 3];
  for (const picture of shown) assert.ok(alpha(picture, 4, 4) < 8 && alpha(picture, 80, 60) > 247);
  const captions = String(ffmpeg(['-i', at('clear.webm'), '-map', '0:s', '-f', 'webvtt', '-']));
  assert.match(captions, /La mamma va/);
  assert.match(captions, /Il papà beve/);
  const seconds = sound('clear.webm').length / 2 / 48000;
  assert.ok(Math.abs(seconds - (said.wav.length - 44) / 2 / said.wav.readUInt32LE(24)) < 0.021, `${seconds}`);
});

test('a room is behind the face unless something else is named; GIF, which has few colours, is plain', () => {
  const corner = (file, ...background) => {
    film(file, ...SAID, ...background, ...(file.endsWith('.png') ? ['--at', '0.4'] : ['--fps', '2']), ...SMALL, TEXT);
    return [...pictures(file, 160 * 120 * 3)[0].subarray(0, 3)];
  };
  const [red, green, blue] = corner('room.png');
  assert.ok(red > green + 5 && green > blue + 5 && red < 230, `${red} ${green} ${blue}`);
  assert.deepEqual(corner('named.png', '--background', 'room'), [red, green, blue]);
  const plain = corner('plain.gif');
  assert.ok(plain.every((value, k) => Math.abs(value - [223, 227, 232][k]) < 8), String(plain));
});

test('GIF and MP4 have every picture; captions and backgrounds are drawn', () => {
  film('small.gif', ...SAID, '--fps', '10', '--background', '#00ff00', ...SMALL, TEXT);
  const gif = pictures('small.gif', 160 * 120 * 3);
  assert.equal(gif.length, Math.ceil(((said.wav.length - 44) / 2 / said.wav.readUInt32LE(24)) * 10));
  assert.ok(gif[0][0] < 8 && gif[0][1] > 247 && gif[0][2] < 8, `${[...gif[0].subarray(0, 3)]}`);
  const image = new PNG({ width: 8, height: 8 });
  for (let i = 0; i < 64; i++) image.data.set([i % 8 < 4 ? 255 : 0, 0, i % 8 < 4 ? 0 : 255, 255], 4 * i);
  fs.writeFileSync(at('halves.png'), PNG.sync.write(image));
  const [width, height] = [320, 240];
  film('burnt.mp4', ...SAID, '--background', at('halves.png'), '--captions', 'burn', '--size', `${width}x${height}`, TEXT);
  const shown = pictures('burnt.mp4', width * height * 3);
  assert.equal(shown.length, said.face.frames.length);
  const [left, right] = [6, width - 7].map((x) => [...shown[5].subarray(3 * (width * 6 + x), 3 * (width * 6 + x) + 3)]);
  assert.ok(left[0] > 220 && left[2] < 40 && right[0] < 40 && right[2] > 220, `${left} ${right}`);
  const white = (picture) => {
    let count = 0;
    for (let i = width * 200 * 3; i < picture.length; i += 3) count += Math.min(picture[i], picture[i + 1], picture[i + 2]) > 225;
    return count;
  };
  const pause = said.phones.find(({ ipa, start, end }) => !ipa && start > 0.5 && end - start > 0.3);
  const between = Math.round(((pause.start + pause.end) / 2) * said.face.fps);
  assert.ok(white(shown[8]) > white(shown[between]) + 20, `${white(shown[8])} ${white(shown[between])}`);
});

/** The blocks of commands of a page of the documentation. */
const guide = (page) => [...fs.readFileSync(path.join(root, 'web/docs/start', page), 'utf8').matchAll(/^```sh.*\n([^]*?)^```/gm)].map(([, code]) => code);

test('the commands of the documentation make what they say', () => {
  const place = at('guide');
  fs.mkdirSync(place);
  for (const code of guide('film.md')) {
    const commands = code.replace(/^sh server\/run\.sh --with film.*$/m, '').replaceAll('build/server', path.join(path.resolve(build), 'server'));
    const { status, stderr } = spawnSync('sh', ['-ec', commands], { cwd: place });
    assert.equal(status, 0, String(stderr));
  }
  const made = Object.fromEntries(fs.readdirSync(place).map((name) => [name, fs.statSync(path.join(place, name)).size]));
  for (const name of ['rosa.mp4', 'hello.webm', 'hello.mp4', 'hello.png', 'joy.png', 'visemes.png', 'recorded.mp4', 'two.mp4', 'film.webp']) assert.ok(made[name] > 5000, `${name}: ${made[name]}`);
  const shown = fs.statSync(path.join(root, 'web/film.webp')).size; // coders and drawing libraries differ a little
  assert.ok(Math.abs(made['film.webp'] / shown - 1) < 0.3 && shown < 1 << 20, `${made['film.webp']}`);
});

/** The folders that a running `faccia film` holds. */
const foldersOf = ({ pid }) => fs.readdirSync(`/proc/${pid}/fd`).flatMap((fd) => {
  try {
    return [fs.readlinkSync(`/proc/${pid}/fd/${fd}`)];
  } catch {
    return []; // it has been closed
  }
}).filter((name) => path.basename(name).includes('faccia-film-') && fs.statSync(name).isDirectory());

test('an interrupted film leaves no file, no folder and no program', async () => {
  const child = spawn(path.join(build, 'server/cli/faccia'), ['film', '-o', at('half-%d.png'), ...SMALL, '--lang', 'it', 'Ciao. '.repeat(60)], { stdio: ['ignore', 'ignore', 'pipe'] });
  for await (const text of child.stderr) if (/picture/.test(text)) break;
  const folders = foldersOf(child);
  assert.equal(folders.length, 2);
  const programs = () => spawnSync('pgrep', ['-f', `${folders[0]}|${folders[1]}|${folder}`]).stdout.toString().trim().split('\n').filter((pid) => pid && Number(pid) !== child.pid);
  assert.ok(programs().length >= 2);
  child.kill('SIGINT');
  const [code, signal] = child.exitCode ?? child.signalCode ? [child.exitCode, child.signalCode] : await once(child, 'exit');
  assert.deepEqual([code, signal], [null, 'SIGINT']);
  assert.deepEqual(programs(), []);
  assert.deepEqual(folders.filter((name) => fs.existsSync(name)), []);
  assert.deepEqual(fs.readdirSync(folder).filter((name) => name.startsWith('half') || name.startsWith('.')), []);
});

test('what a killed film has left is removed by the next one', async () => {
  const start = () => spawn(path.join(build, 'server/cli/faccia'), ['film', '-o', at('killed-%d.png'), ...SMALL, '--lang', 'it', 'Ciao. '.repeat(600)], { stdio: ['ignore', 'ignore', 'pipe'] });
  const drawing = async (child) => {
    for await (const text of child.stderr) if (/picture/.test(text)) break;
  };
  const killed = start();
  await drawing(killed);
  const left = foldersOf(killed);
  assert.equal(left.length, 2);
  const programs = descendantsOf(killed.pid);
  assert.ok(programs.some(({ command }) => /chromium/.test(command)) && programs.some(({ command }) => /^ffmpeg/.test(command)));
  killed.kill('SIGKILL');
  await once(killed, 'exit');
  await eventually(() => stillRunning(programs).length === 0, 'browser and ffmpeg to end', 60000);
  const living = start();
  await drawing(living);
  const own = foldersOf(living);
  for (const name of [...left, ...own]) if (fs.existsSync(name)) fs.utimesSync(name, new Date(0), new Date(0)); // as if a minute had passed: on a busy machine it has
  film('after-%d.png', '--lang', 'it', ...SMALL, 'Ciao.');
  assert.deepEqual([...left, ...own].map((name) => fs.existsSync(name)), [false, false, true, true]);
  living.kill('SIGINT');
  await once(living, 'exit');
  assert.deepEqual(own.map((name) => fs.existsSync(name)), [false, false]);
});

for (const [what, args, status, message] of [
  ['no output', ['Ciao'], 2, /no output/],
  ['an unknown kind of file', ['-o', 'film.avi', 'Ciao'], 2, /--output: .*\.mp4, \.webm, \.gif, \.webp or \.png/],
  ['an unknown head', ['-o', at('x.mp4'), '-m', 'nobody', 'Ciao'], 1, /--model: unknown head 'nobody'/],
  ['a size that cannot be', ['-o', 'x.mp4', '--size', '9x9', 'Ciao'], 2, /--size/],
  ['odd sides', ['-o', 'x.mp4', '--size', '161x120', 'Ciao'], 2, /--size: .*even/],
  ['transparent MP4', ['-o', 'x.mp4', '--background', 'transparent', 'Ciao'], 2, /--background/],
  ['a background that is none', ['-o', at('x.mp4'), '--background', 'nothing', 'Ciao'], 1, /background 'nothing' is neither a file, nor a colour, nor 'room'/],
  ['a background that is no image', ['-o', at('x.mp4'), '--background', at('name.wav'), 'Ciao'], 1, /background is no image/],
  ['a rate that a GIF cannot have', ['-o', 'x.gif', '--fps', '30', 'Ciao'], 2, /--fps/],
  ['a moment after the end', ['-o', at('x.png'), '--at', '99', 'Ciao'], 1, /--at: 99 is after the end/],
  ['a folder that is not there', ['-o', at('no/x.mp4'), 'Ciao'], 1, /No such file/],
  ['visemes of an unknown language', ['-o', at('x.png'), '--visemes', 'xx'], 1, /--visemes: no mouth shapes for the language 'xx'/],
  ['an unknown expression', ['-o', at('x.png'), '--expression', 'nothing'], 1, /--expression nothing: unknown affect 'nothing'/],
  ['an expression and a text', ['-o', at('x.png'), '--expression', 'joy', 'Ciao'], 2, /--expression: there can be no text/],
  ['visemes and a text', ['-o', at('x.png'), '--visemes', 'it', 'Ciao'], 2, /--visemes: there can be no text/],
  ['a passage without a folder', ['-o', at('x.mp4'), '--passage', 'barca'], 2, /--library/],
  ['an unknown work', ['-o', at('x.mp4'), '--library', folder, '--passage', 'nothing'], 1, /unknown work 'nothing'/],
  ['a passage that is no place', ['-o', at('x.mp4'), '--library', folder, '--passage', 'barca:x'], 1, /WORK:SECTION/],
  ['an unknown partner', ['-o', at('x.mp4'), '--partner', 'nobody', 'Ciao'], 1, /--partner: unknown head 'nobody'/],
  ['two heads of a recording without words', ['-o', at('x.mp4'), '--partner', 'mara', '--from', at('said.fap')], 2, /--partner: .*--words/],
  ['no recording', ['-o', at('x.mp4'), '--from', at('no.fap')], 1, /--from: .*no\.fap/],
])
  test(`refuses ${what}`, () => {
    const said = faccia(['film', ...args]);
    assert.equal(said.status, status, said.stderr);
    assert.match(said.stderr, message);
    assert.ok(!fs.existsSync(at('x.mp4')) && !fs.existsSync(at('x.png')));
  });

test('says what to install', () => {
  const said = faccia(['film', '-o', at('x.mp4'), 'Ciao'], { env: { PATH: '/nowhere' } });
  assert.equal(said.status, 1);
  assert.match(said.stderr, /chromium-headless-shell and ffmpeg .*--with film/);
});
