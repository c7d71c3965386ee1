// SPDX-License-Identifier: GPL-3.0-or-later
// `faccia camera`: the face of a room as pictures, decoded again. There is no virtual camera on test machines: they go to standard output.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { artefacts, build, Daemon, eventually } from '../lib/daemon.mjs';

const program = path.join(build, 'server/cli/faccia');
const [WIDTH, HEIGHT, JAW] = [320, 240, 3];
const folders = () => fs.readdirSync('/tmp').filter((name) => name.startsWith('faccia-camera-'));
let daemon, folder;
before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-camera-test-'));
  daemon = await Daemon.start([], {}, { voices: false });
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  assert.equal((await daemon.stop()).code, 0);
});

/** The last picture of a file of Motion JPEG, as grey values. */
function lastPicture(file) {
  const bytes = fs.readFileSync(file);
  const begin = bytes.lastIndexOf(Buffer.from([0xff, 0xd8, 0xff]), bytes.lastIndexOf(Buffer.from([0xff, 0xd9])));
  if (begin < 0) return null;
  const { stdout } = spawnSync('ffmpeg', ['-v', 'error', '-f', 'mjpeg', '-i', 'pipe:0', '-frames:v', '1', '-f', 'rawvideo', '-pix_fmt', 'gray', '-'], { input: bytes.subarray(begin) });
  return stdout.length === WIDTH * HEIGHT ? stdout : null;
}
const unlike = (a, b) => a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;

test('the face of the room is in the pictures, and moves as it is driven', async () => {
  const before = folders();
  const file = path.join(folder, 'out.mjpeg');
  const camera = spawn(program, ['camera', '--room', 'studio', '--size', `${WIDTH}x${HEIGHT}`, '--fps', '10', '--url', daemon.url, '-'], { stdio: ['ignore', fs.openSync(file, 'w'), 'pipe'] });
  let said = '';
  camera.stderr.setEncoding('utf8').on('data', (text) => (said += text));
  const closed = once(camera, 'close');
  const rest = await eventually(() => {
    assert.equal(camera.exitCode, null, said);
    const picture = lastPicture(file);
    return picture && unlike(picture, Buffer.alloc(picture.length, picture[0])) > 12 ? picture : null; // more than the background
  }, 'a face', 240000);
  assert.match(said, /the room studio is shown in standard output/);
  const driver = await daemon.stream('?room=studio&watch=1');
  await driver.wait({ type: 'joined' });
  const begun = performance.now();
  const timer = setInterval(() => driver.send({ type: 'drive', frames: [{ time: (performance.now() - begun) / 1000, faps: { [JAW]: 1000, 5: -900, 10: -800, 11: -800, 49: 40000 } }] }), 40);
  await eventually(() => unlike(lastPicture(file) ?? rest, rest) > 4, 'a movement', 240000);
  clearInterval(timer);
  await driver.close();
  const own = folders().filter((name) => !before.includes(name));
  assert.ok(own.length >= 1);
  camera.kill('SIGINT');
  const [status] = await closed;
  assert.equal(status, 0, said);
  fs.mkdirSync(artefacts, { recursive: true });
  fs.copyFileSync(file, path.join(artefacts, 'camera.mjpeg'));
  assert.ok(own.length > folders().filter((name) => own.includes(name)).length, 'its folder is gone');
});

test('says what is missing', () => {
  const fails = (status, pattern, ...options) => {
    const ended = spawnSync(program, ['camera', ...options], { encoding: 'utf8', timeout: 120000 });
    assert.equal(ended.status, status, ended.stderr);
    assert.match(ended.stderr, pattern);
    assert.equal(ended.stdout, '');
  };
  const plain = path.join(folder, 'plain');
  fs.writeFileSync(plain, '');
  fails(1, /video99: No such file or directory; v4l2loopback makes such devices/, '--room', 'r', '/dev/video99');
  fails(1, /plain: this is no video device, and no device of v4l2loopback/, '--room', 'r', plain);
  for (const size of ['x', '640', '641x480', '640x480x', '32x32', '4000x4000']) fails(2, /is no size, such as 640x480/, '--room', 'r', '--size', size, '-');
  fails(2, /expected --room and one device/, '-');
  fails(2, /expected --room and one device/, '--room', 'r');
  fails(2, /fps/, '--room', 'r', '--fps', '0', '-');
  fails(1, /contains no token/, '--room', 'r', '--token-file', plain, '-');
  const port = daemon.port === 65535 ? daemon.port - 1 : daemon.port + 1;
  fails(1, /the page cannot be opened: net::ERR_CONNECTION_REFUSED/, '--room', 'r', '--url', `http://127.0.0.1:${port}`, '-');
  const { status, stderr } = spawnSync(program, ['camera', '--room', 'r', '-'], { encoding: 'utf8', env: { ...process.env, PATH: '/nowhere' } });
  assert.equal(status, 1);
  assert.match(stderr, /no browser in PATH: install Debian's chromium-headless-shell/);
});
