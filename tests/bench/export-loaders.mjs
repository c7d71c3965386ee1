// SPDX-License-Identifier: GPL-3.0-or-later
// Loads an exported head with the loaders of others, in a browser: TalkingHead speaks with it, three-vrm, Babylon.js and model-viewer open its mouth. Prints
// which shapes moved, and draws it. Their packages come from a folder of their own:
// npm install --prefix DIR @met4citizen/talkinghead @pixiv/three-vrm @babylonjs/core @babylonjs/loaders @google/model-viewer
// FACCIA_BUILD=build node tests/bench/run.mjs export-loaders DIR OUT [HEAD.glb]
import fs from 'node:fs';
import http from 'node:http';
import { createRequire } from 'node:module';
import path from 'node:path';
import { launch } from '../lib/browser.mjs';
import { heads } from '../lib/built-heads.mjs';
import { root } from '../lib/daemon.mjs';

const { build } = createRequire(path.join(root, 'web/package.json'))('esbuild');
const [folder, out, glb = path.join(heads, 'mara.glb')] = process.argv.slice(2);
if (!out) throw new Error('usage: run.mjs export-loaders DIR OUT [HEAD.glb]');
const modules = path.join(path.resolve(folder), 'node_modules');
const own = path.join(modules, '@met4citizen/talkinghead/node_modules/three');
const three = fs.existsSync(own) ? '/node_modules/@met4citizen/talkinghead/node_modules/three' : '/node_modules/three';
const page = `<!doctype html><meta charset="utf-8"><body style="margin:0;background:#ccc"><div id="stage" style="width:600px;height:600px"></div>
<script type="importmap">${JSON.stringify({ imports: {
    three: `${three}/build/three.module.js`, 'three/addons/': `${three}/examples/jsm/`,
    talkinghead: '/node_modules/@met4citizen/talkinghead/modules/talkinghead.mjs', '@pixiv/three-vrm': '/node_modules/@pixiv/three-vrm/lib/three-vrm.module.js',
    babylon: '/babylon.js', 'model-viewer': '/node_modules/@google/model-viewer/dist/model-viewer.min.js',
  } })}</script>`;
/** Babylon.js in one file: its modules are more than a thousand. */
const babylon = async () => {
  const contents = `export { Engine, Scene, ArcRotateCamera, HemisphericLight, Vector3, Color4, LoadAssetContainerAsync } from '@babylonjs/core'; import '@babylonjs/loaders/glTF/2.0';`;
  const { outputFiles } = await build({ stdin: { contents, resolveDir: path.resolve(folder) }, bundle: true, format: 'esm', write: false, minify: true, logLevel: 'error' });
  return outputFiles[0].contents;
};
const TYPES = { '.mjs': 'text/javascript', '.js': 'text/javascript', '.glb': 'model/gltf-binary' };
const server = http.createServer(async ({ url }, response) => {
  if (url === '/') return response.writeHead(200, { 'content-type': 'text/html' }).end(page);
  if (url === '/babylon.js') return response.writeHead(200, { 'content-type': 'text/javascript' }).end(await babylon());
  const file = url === '/head.glb' ? glb : path.join(modules, decodeURIComponent(new URL(url, 'http://here').pathname.replace(/^\/node_modules/, '')));
  if ((file !== glb && !file.startsWith(modules)) || !fs.existsSync(file)) return response.writeHead(404).end();
  return response.writeHead(200, { 'content-type': TYPES[path.extname(file)] ?? 'application/octet-stream' }).end(fs.readFileSync(file));
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
const browser = await launch();
const tab = await browser.newPage({ viewport: { width: 600, height: 600 } });
tab.on('console', (message) => message.type() === 'error' && console.log('console:', message.text()));
tab.on('pageerror', (error) => console.log('error:', error.message));
await tab.goto(`http://127.0.0.1:${server.address().port}/`);
fs.mkdirSync(out, { recursive: true });

await tab.mouse.click(10, 10); // sound wants a gesture
const spoken = await tab.evaluate(async () => {
  const { TalkingHead } = await import('talkinghead');
  const head = new TalkingHead(document.querySelector('#stage'), { ttsEndpoint: 'none', lipsyncModules: ['en'], cameraView: 'head', modelFPS: 15 });
  await head.showAvatar({ url: '/head.glb', body: 'F', avatarMood: 'neutral', lipsyncLang: 'en' });
  const audio = new AudioBuffer({ length: 48000, sampleRate: 24000 });
  const visemes = ['aa', 'PP', 'O', 'FF', 'U'];
  head.speakAudio({ audio, words: ['one'], wtimes: [0], wdurations: [1500], visemes, vtimes: visemes.map((_, i) => 300 * i), vdurations: visemes.map(() => 300) });
  const skin = head.morphs.find(({ name }) => name.startsWith('skin'));
  const most = {};
  const until = performance.now() + 40000;
  while (performance.now() < until && Object.keys(most).filter((name) => name.startsWith('viseme')).length < 3) {
    for (const [name, i] of Object.entries(skin.morphTargetDictionary))
      if (skin.morphTargetInfluences[i] > (most[name] ?? 0.05)) most[name] = Number(skin.morphTargetInfluences[i].toFixed(2));
    await new Promise((resolve) => requestAnimationFrame(resolve));
  }
  return { most, head: head.objectHead.getWorldPosition(head.camera.position.clone()).y, camera: head.camera.position.y };
});
console.log('TalkingHead moved', JSON.stringify(spoken));
await tab.screenshot({ path: path.join(out, 'talkinghead.png') });

await tab.reload();
const opened = await tab.evaluate(async () => {
  const THREE = await import('three');
  const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js');
  const { VRMLoaderPlugin } = await import('@pixiv/three-vrm');
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser));
  const gltf = await loader.loadAsync('/head.glb');
  const { vrm } = gltf.userData;
  vrm.expressionManager.setValue('aa', 1);
  vrm.update(0.1);
  vrm.humanoid.getNormalizedBoneNode('head').rotation.y = 0.3;
  vrm.update(0.1);
  const skin = gltf.scene.getObjectByName('skin');
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.setSize(600, 600);
  document.querySelector('#stage').replaceChildren(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color('#ccc');
  scene.add(gltf.scene, new THREE.HemisphereLight('#fff', '#666', 3));
  const camera = new THREE.PerspectiveCamera(25, 1, 0.1, 10);
  camera.position.set(0, 1.52, 0.8);
  camera.lookAt(0, 1.52, 0);
  renderer.render(scene, camera);
  return { aa: skin.morphTargetInfluences[skin.morphTargetDictionary.viseme_aa], expressions: Object.keys(vrm.expressionManager.expressionMap).length, head: vrm.humanoid.getRawBoneNode('head').name };
});
console.log('three-vrm', JSON.stringify(opened));
await tab.screenshot({ path: path.join(out, 'three-vrm.png') });

await tab.reload();
const lit = await tab.evaluate(async () => {
  const { Engine, Scene, ArcRotateCamera, HemisphericLight, Vector3, Color4, LoadAssetContainerAsync } = await import('babylon');
  const canvas = Object.assign(document.createElement('canvas'), { width: 600, height: 600 });
  document.querySelector('#stage').replaceChildren(canvas);
  const engine = new Engine(canvas, true, { preserveDrawingBuffer: true });
  const scene = new Scene(engine);
  scene.clearColor = new Color4(0.8, 0.8, 0.8, 1);
  const container = await LoadAssetContainerAsync('/head.glb', scene);
  container.addAllToScene();
  const camera = new ArcRotateCamera('camera', Math.PI / 2, Math.PI / 2, 0.8, new Vector3(0, 1.52, 0), scene);
  Object.assign(camera, { minZ: 0.01, fov: 0.45 });
  new HemisphericLight('light', new Vector3(0, 1, 0.5), scene).intensity = 1.5;
  const skin = container.meshes.find(({ name }) => name === 'skin');
  const manager = skin.morphTargetManager;
  const targets = Array.from({ length: manager.numTargets }, (_, i) => manager.getTarget(i));
  targets.find(({ name }) => name === 'viseme_aa').influence = 1;
  await scene.whenReadyAsync();
  scene.render();
  return { targets: targets.length, meshes: container.meshes.length, bones: container.skeletons[0]?.bones.length, looks: container.materials.map(({ name, transparencyMode }) => `${name} ${transparencyMode}`).join(', ') };
});
console.log('Babylon.js', JSON.stringify(lit));
await tab.screenshot({ path: path.join(out, 'babylon.png') });

await tab.reload();
const shown = await tab.evaluate(async () => {
  await import('model-viewer');
  const viewer = document.createElement('model-viewer');
  viewer.style.cssText = 'width:600px;height:600px;background:#ccc';
  Object.assign(viewer, { cameraTarget: '0m 1.52m 0m', cameraOrbit: '0deg 90deg 0.8m', minCameraOrbit: 'auto auto 0.3m', fieldOfView: '25deg', interpolationDecay: 1 });
  document.querySelector('#stage').replaceChildren(viewer);
  const loaded = new Promise((resolve, reject) => {
    viewer.addEventListener('load', resolve);
    viewer.addEventListener('error', ({ detail }) => reject(new Error(JSON.stringify(detail))));
  });
  viewer.src = '/head.glb';
  await loaded;
  await new Promise((resolve) => setTimeout(resolve, 3000));
  return { materials: viewer.model.materials.map(({ name }) => name).join(' ') };
});
console.log('model-viewer', JSON.stringify(shown));
await tab.screenshot({ path: path.join(out, 'model-viewer.png') });
await browser.close();
server.close();
