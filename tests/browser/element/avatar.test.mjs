// SPDX-License-Identifier: GPL-3.0-or-later
// Loads an exported head in three.js: its shapes must match faccia's own head at the same FAPs, vertex by vertex. The artefacts contain
// the pictures.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { PNG } from 'pngjs';
import { pose, unpack } from '../../../models/tools/lib/deform.mjs';
import { launch } from '../../lib/browser.mjs';
import { models } from '../../lib/built-heads.mjs';
import { artefacts, root } from '../../lib/daemon.mjs';

const web = fileURLToPath(new URL('../../../web/', import.meta.url));
const shapes = (name) => JSON.parse(fs.readFileSync(path.join(root, `models/shapes/${name}.json`)));
const SIZE = 420;
const EYES = 1550; // mm from the floor

// Runs in the page.
const script = `
import { AmbientLight, DirectionalLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
const renderer = new WebGLRenderer({ canvas: document.querySelector('canvas'), antialias: true, preserveDrawingBuffer: true });
renderer.setClearColor(0x606468);
const scene = new Scene();
const camera = new PerspectiveCamera(26, 1, 0.1, 10);
camera.position.set(0, 1.528, 0.62);
camera.lookAt(0, 1.528, 0);
const key = new DirectionalLight(0xffffff, 2.4);
key.position.set(-0.5, 2.2, 1);
scene.add(key, new AmbientLight(0xffffff, 1.1));
let avatar;
const meshes = () => { const out = []; avatar.scene.traverse((o) => { if (o.isMesh) out.push(o); }); return out; };
window.load = async (url) => {
  if (avatar) scene.remove(avatar.scene);
  avatar = await new GLTFLoader().loadAsync(url);
  scene.add(avatar.scene);
  avatar.scene.updateMatrixWorld(true);
  return meshes().map((mesh) => ({ name: mesh.name, targets: Object.keys(mesh.morphTargetDictionary ?? {}) }));
};
window.show = (weights, size, turn = 0) => {
  for (const mesh of meshes()) {
    mesh.frustumCulled = false;
    mesh.morphTargetInfluences?.fill(0);
    for (const [name, weight] of Object.entries(weights)) {
      const at = mesh.morphTargetDictionary?.[name];
      if (at !== undefined) mesh.morphTargetInfluences[at] = weight;
    }
  }
  avatar.scene.getObjectByName('Head').rotation.y = turn;
  avatar.scene.updateMatrixWorld(true);
  renderer.setSize(size, size, false);
  renderer.render(scene, camera);
  return renderer.domElement.toDataURL('image/png').slice(22);
};
window.vertices = (name) => {
  const mesh = meshes().find((one) => one.name === name);
  const at = new Vector3();
  return Array.from({ length: mesh.geometry.attributes.position.count }, (_, i) => mesh.getVertexPosition(i, at).toArray()).flat();
};
`;

let browser, page;
before(async () => {
  browser = await launch();
  const { build: bundle } = createRequire(path.join(web, 'package.json'))('esbuild');
  const { outputFiles } = await bundle({ stdin: { contents: script, resolveDir: web }, bundle: true, format: 'esm', write: false });
  page = await browser.newPage();
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.route('http://avatars.test/**', (route) => {
    const name = new URL(route.request().url()).pathname.slice(1);
    if (name.endsWith('.glb')) return route.fulfill({ path: path.join(models, 'heads', name), contentType: 'model/gltf-binary' });
    if (name === 'script.js') return route.fulfill({ body: outputFiles[0].text, contentType: 'text/javascript' });
    return route.fulfill({ body: name ? '' : '<link rel="icon" href="data:,"><canvas></canvas><script type="module" src="script.js"></script>', contentType: 'text/html' });
  });
  await page.goto('http://avatars.test/');
  await page.waitForFunction(() => window.load);
});
after(async () => browser?.close());

const draw = async (weights, turn) => PNG.sync.read(Buffer.from(await page.evaluate(([w, size, t]) => window.show(w, size, t), [weights, SIZE, turn]), 'base64'));
const load = (name) => page.evaluate((url) => window.load(url), `${name}.glb`);
const head = (name) => unpack(JSON.parse(fs.readFileSync(path.join(models, `heads/${name}.json`))));

/** Counts clearly different pixels. */
function differing(a, b) {
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4) count += Math.abs(a.data[i] - b.data[i]) + Math.abs(a.data[i + 1] - b.data[i + 1]) + Math.abs(a.data[i + 2] - b.data[i + 2]) > 60;
  return count;
}

for (const name of ['mara', 'bruno'])
  test(`${name}: each shape looks like the source head at the same FAPs`, async () => {
    const parts = await load(name);
    const own = head(name);
    assert.deepEqual(parts.map((part) => part.name).sort(), [...own.parts.map((part) => part.name), 'stand'].sort());
    const { targets } = parts.find((part) => part.name === 'skin');
    assert.equal(targets.length, 68);
    assert.ok(targets.includes('breath'));
    const { shapes: arkit } = shapes('arkit');
    const { visemes } = shapes('visemes');
    for (const [weights, faps] of [
      [{}, {}],
      [{ jawOpen: 1 }, arkit.jawOpen.faps],
      [{ eyeBlinkLeft: 1 }, arkit.eyeBlinkLeft.faps],
      [{ mouthPucker: 1 }, arkit.mouthPucker.faps],
      [{ tongueOut: 1 }, arkit.tongueOut.faps],
      [{ viseme_PP: 1 }, visemes.PP.faps],
    ]) {
      await draw(weights);
      for (const part of own.parts) {
        const shown = await page.evaluate((one) => window.vertices(one), part.name);
        const wanted = pose(own, part, faps);
        assert.equal(shown.length, wanted.length);
        let worst = 0;
        for (let i = 0; i < wanted.length; i++) worst = Math.max(worst, Math.abs(shown[i] * 1000 - (i % 3 === 1 ? EYES : 0) - wanted[i]));
        assert.ok(worst < 0.02, `${name}, ${part.name} at ${JSON.stringify(weights)}: ${worst} mm`);
      }
    }
    assert.deepEqual(page.problems, []);
  });

test('every shape is visible, and a closed mouth is closed', async () => {
  await load('mara');
  const { shapes: arkit } = shapes('arkit');
  const { visemes } = shapes('visemes');
  const all = [{}, ...Object.keys(arkit).map((shape) => ({ [shape]: 1, ...(/^(mouthClose|tongueOut)$/.test(shape) ? { jawOpen: shape === 'mouthClose' ? 1 : 0.5 } : {}) })),
    ...Object.keys(visemes).map((viseme) => ({ [`viseme_${viseme}`]: 1 }))];
  const columns = 10;
  const sheet = new PNG({ width: SIZE * columns, height: SIZE * Math.ceil(all.length / columns) });
  const pictures = [];
  for (const [i, weights] of all.entries()) {
    pictures.push(await draw(weights));
    PNG.bitblt(pictures[i], sheet, 0, 0, SIZE, SIZE, (i % columns) * SIZE, Math.floor(i / columns) * SIZE);
  }
  fs.mkdirSync(artefacts, { recursive: true });
  fs.writeFileSync(path.join(artefacts, 'avatar-shapes.png'), PNG.sync.write(sheet));
  const [rest] = pictures;
  all.forEach((weights, i) => {
    if (i && !weights.viseme_sil) assert.ok(differing(rest, pictures[i]) > 25, `${JSON.stringify(weights)}: ${differing(rest, pictures[i])} pixels`);
  });
  assert.equal(differing(rest, pictures[all.findIndex((weights) => weights.viseme_sil)]), 0);
  const { fdp, parts } = head('mara');
  const { position } = parts.find((part) => part.name === 'skin');
  const nearest = (point) => {
    const far = (v) => Math.hypot(...point.map((x, k) => x - position[3 * v + k]));
    return Array.from({ length: position.length / 3 }, (_, v) => v).reduce((best, v) => (far(v) < far(best) ? v : best));
  };
  const [upper, lower] = [nearest(fdp['2.2']), nearest(fdp['2.3'])];
  const lips = async (weights) => {
    await draw(weights);
    const at = await page.evaluate(() => window.vertices('skin'));
    return 1000 * (at[3 * upper + 1] - at[3 * lower + 1]);
  };
  const [closed, open, over] = [await lips({}), await lips({ jawOpen: 1 }), await lips({ jawOpen: 1, mouthClose: 1 })];
  assert.ok(open - closed > 12 && Math.abs(over - closed) < 0.1, `${closed}, ${open}, ${over} mm`);
  // the head turns with its bone, the shoulders stay
  const turned = await draw({}, 0.5);
  assert.ok(differing(rest, turned) > 2000);
  assert.deepEqual(page.problems, []);
});
