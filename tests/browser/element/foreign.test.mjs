// SPDX-License-Identifier: GPL-3.0-or-later
// Third-party avatars instead of a head: movement of lips and lids in mm and pixels, for any naming of shapes; and files that are not
// avatars.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { models } from '../../lib/built-heads.mjs';
import { artefacts, build, Daemon, root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { bonesOnly, oddNames, partsOf, visemesOnly, vrm0, writeGlb } from '../../lib/foreign-avatars.mjs';
import { packed } from '../../lib/packed-avatars.mjs';
import { fiveLines, servePages } from '../../lib/page-server.mjs';

const own = fs.readFileSync(path.join(models, 'heads/mara.glb'));
const { fdp, textures } = JSON.parse(fs.readFileSync(path.join(models, 'heads/mara.json')));
const TEXT = 'La mamma abbraccia il papà, e la bimba mangia una pera.';
const policy = fs.readFileSync(path.join(root, 'web/docs/element/looks.md'), 'utf8').match(/```csp\n([^]*?)```/)[1].replace(/\s+/g, ' ').trim();

let daemon, browser, pages, page, track;
const glb = (body) => ({ body, type: 'model/gltf-binary', headers: { 'content-length': String(body.length) } });
const without = () => {
  const parts = partsOf(own);
  for (const mesh of parts.json.meshes) {
    delete mesh.weights;
    delete mesh.extras;
    for (const primitive of mesh.primitives) delete primitive.targets;
  }
  delete parts.json.extensions;
  return parts;
};

/** Files that are not avatars, with the expected errors. */
async function hostile() {
  const spoilt = await packed(own, { spoil: (draco) => draco.fill(255, 40, 90) });
  const { json } = without();
  const changed = (change) => {
    const parts = partsOf(own);
    change(parts.json, parts);
    return writeGlb(parts);
  };
  return {
    missing: [undefined, 'missing'],
    text: [Buffer.from('<!doctype html><p>no avatar</p>'), 'not-glb'],
    'no-shapes': [writeGlb(without()), 'no-face'],
    short: [own.subarray(0, own.length >> 1), 'damaged'],
    'bad-json': [writeGlb({ json: null, binary: null }), 'damaged'],
    circle: [changed(({ nodes }) => nodes[0].children.push(0)), 'damaged'],
    elsewhere: [changed(({ images: [image] }) => Object.assign(image, { uri: 'http://127.0.0.1:9/spy.png', bufferView: undefined })), 'unsupported'],
    unknown: [changed((one) => (one.extensionsRequired = ['KHR_gaussian_splatting']) && (one.meshes[0].primitives[0].extensions = { KHR_gaussian_splatting: {} })), 'unsupported'],
    draco: [spoilt, 'unsupported'], // the page's policy forbids WebAssembly
    endless: [changed(({ accessors }) => (accessors[0].count = 2 ** 40)), 'too-large'],
    beyond: [changed(({ bufferViews }) => (bufferViews[0].byteOffset = 2 ** 30)), 'damaged'],
    'no-mouth': [changed((one) => {
      delete one.extensions;
      for (const { extras } of one.meshes) extras?.targetNames.forEach((name, i, names) => (names[i] = i ? `_${i}` : 'cheekPuff'));
    }), 'no-face'],
    json: [Buffer.from(JSON.stringify(json)), 'not-glb'],
  };
}

before(async () => {
  const odd = oddNames(own);
  const odder = { ...odd.map, shapes: { ...odd.map.shapes, jawOpen: 'there is none' } };
  pages = await servePages({
    '/own.glb': glb(own),
    '/own.vrm': glb(own),
    '/visemes.glb': glb(visemesOnly(own)),
    '/zero.vrm': glb(vrm0(own)),
    '/odd.glb': glb(odd.glb),
    '/odd.json': { body: JSON.stringify(odd.map), type: 'application/json' },
    '/odder.json': { body: JSON.stringify(odder), type: 'application/json' },
    '/nonsense.json': { body: '{"format": ', type: 'application/json' },
    '/bones.glb': glb(bonesOnly(own)),
    '/packed.glb': glb(await packed(own, { webp: Buffer.from(textures.clothes.data, 'base64') })),
    '/large.glb': { body: own.subarray(0, 100), type: 'model/gltf-binary', headers: { 'content-length': String(2 ** 30) } },
    ...Object.fromEntries(Object.entries(await hostile()).flatMap(([name, [body]]) => (body ? [[`/${name}.glb`, glb(body)]] : []))),
  });
  daemon = await Daemon.start(['--origin', pages.url]);
  const csp = policy.replaceAll('http://127.0.0.1:8080', daemon.url).replaceAll('ws://127.0.0.1:8080', daemon.url.replace('http', 'ws'));
  const headers = { 'content-security-policy': csp.replace('connect-src', `connect-src ${pages.url}`) };
  pages.files['/'] = { body: fiveLines(daemon.url, 'lang="it" still="on"'), headers };
  const wasm = headers['content-security-policy'].replace('script-src', "script-src 'wasm-unsafe-eval'");
  pages.files['/packed'] = { ...pages.files['/'], headers: { 'content-security-policy': wasm } };
  browser = await launch();
  page = await browser.newPage({ viewport: { width: 500, height: 560 } });
  page.problems = [];
  page.asked = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('request', (request) => page.asked.push(request.url()));
  await page.addInitScript(({ points }) => {
    window.violations = [];
    window.heard = [];
    document.addEventListener('securitypolicyviolation', (e) => window.violations.push(`${e.effectiveDirective} ${e.blockedURI}`));
    for (const type of ['ready', 'error', 'progress'])
      document.addEventListener(type, (e) => e.target.localName === 'talking-head' && window.heard.push({ type, ...e.detail }), true);
    window.head = () => document.querySelector('talking-head');
    /** The head that displays the avatar. Vertices at feature points are known from the original mesh. */
    window.avatar = () => window.head().debugParts().stage.view?.head;
    window.measure = () => {
      window.avatar().setFaps(new Float32Array(69));
      const mesh = window.avatar().meshes.find(({ name, geometry }) => name === 'skin' || geometry.attributes.position.count > 7000);
      const at = mesh.position.clone();
      const { position } = mesh.geometry.attributes;
      const nearest = ([x, y, z]) => {
        let [best, least] = [0, Infinity];
        for (let v = 0; v < position.count; v++) {
          const far = Math.hypot(1000 * position.getX(v) - x, 1000 * (position.getY(v) - 1.55) - y, 1000 * position.getZ(v) - z);
          if (far < least) [best, least] = [v, far];
        }
        return best;
      };
      const found = Object.fromEntries(Object.entries(points).map(([name, point]) => [name, nearest(point)]));
      const height = (name) => 1000 * mesh.getVertexPosition(found[name], at).y;
      const all = () => ({
        middle: height('2.2') - height('2.3'),
        left: height('2.6') - height('2.8'),
        right: height('2.7') - height('2.9'),
        eyes: [height('3.1') - height('3.3'), height('3.2') - height('3.4')],
        chin: height('2.1'),
      });
      mesh.updateMatrixWorld(true);
      const rest = all();
      return (frames) =>
        frames.map((faps) => {
          window.avatar().setFaps(faps);
          window.avatar().group.updateMatrixWorld(true);
          mesh.skeleton?.update();
          const { middle, left, right, eyes, chin } = all();
          return { gaps: [middle - rest.middle, left - rest.left, right - rest.right], lids: eyes.map((eye, i) => eye / rest.eyes[i]), chin: chin - rest.chin };
        });
    };
  }, { points: Object.fromEntries(['2.1', '2.2', '2.3', '2.6', '2.7', '2.8', '2.9', '3.1', '3.2', '3.3', '3.4'].map((name) => [name, fdp[name]])) });
  await visit('/');
  track = spoken(TEXT);
});
after(async () => {
  await browser?.close();
  await pages?.close();
  assert.equal((await daemon.stop()).code, 0);
});

function spoken(text) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foreign-'));
  const [fap, json] = ['a.fap', 'a.json'].map((file) => path.join(folder, file));
  execFileSync(path.join(build, 'server/cli/faccia'), ['say', '--lang', 'it', '--fps', '50', '--still', '--fap', fap, '--json', json, text], { stdio: 'ignore' });
  const out = { ...parseFap(fs.readFileSync(fap, 'utf8')), phones: JSON.parse(fs.readFileSync(json)).phones };
  fs.rmSync(folder, { recursive: true });
  return out;
}

async function visit(where) {
  await page.goto(new URL(where, pages.url).href);
  await page.waitForFunction(() => window.heard.some(({ type }) => type === 'ready'), null, { timeout: 120000 });
}

/** Sets the attributes. Waits for `ready` or the error. */
async function open(avatar, map = null) {
  await page.evaluate(([address, mapping]) => {
    window.heard.length = 0;
    const head = window.head();
    head.avatarMap = mapping;
    head.avatar = address;
  }, [avatar, map]);
  await page.waitForFunction(() => window.heard.some(({ type }) => type === 'ready'), null, { timeout: 120000 });
  return page.evaluate(() => window.heard.slice());
}

async function shot(name, faps, view = 'mouth') {
  await page.evaluate(async ([values, framing]) => {
    window.head().view = framing;
    window.head().pose(values);
    for (let i = 0; i < 4; i++) await new Promise(requestAnimationFrame);
  }, [faps, view]);
  fs.mkdirSync(artefacts, { recursive: true });
  return PNG.sync.read(await page.locator('talking-head').screenshot({ path: path.join(artefacts, `foreign-${name}.png`) }));
}

/** Counts pixels between the lips in the middle of the mouth: darker than skin, or grey like teeth. */
function between({ width, height, data }) {
  let count = 0;
  for (let y = Math.round(height * 0.25); y < height * 0.75; y++)
    for (let x = Math.round(width * 0.44); x < width * 0.56; x++) {
      const [r, g] = data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3);
      if (r < 70 || (r - g) / r < 0.13) count++;
    }
  return count / width;
}

const CASES = {
  'own.glb': { tolerance: 0.25, eyes: true },
  'visemes.glb': { tolerance: 0.6, eyes: true },
  'zero.vrm': { tolerance: 0.4, eyes: true },
  'odd.glb': { map: 'odd.json', tolerance: 0.25, eyes: true },
  'bones.glb': { tolerance: 0.25, eyes: false },
  'packed.glb': { where: '/packed', tolerance: 0.3, eyes: true }, // needs WebAssembly
};

for (const [file, { where, map, tolerance, eyes }] of Object.entries(CASES))
  test(`${file}: closes lips and lids, and opens vowels`, async (t) => {
    if (where) await visit(where);
    const events = await open(`/${file}`, map && `/${map}`);
    assert.deepEqual(events.filter(({ type }) => type === 'error'), []);
    assert.ok(events.some(({ type, ratio }) => type === 'progress' && ratio === 1));
    assert.match(events.find(({ type }) => type === 'ready').credits.join(), /MakeHuman|faccia/);
    const { phones, fps, frames } = track;
    const touching = frames.filter((f) => f[4] + f[5] >= 0 && f[8] + f[10] >= 0 && f[9] + f[11] >= 0);
    const vowels = phones.filter(({ ipa, start, end }) => ipa.startsWith('a') && end - start > 0.06).map(({ start, end }) => frames[Math.round(((start + end) / 2) * fps)]);
    assert.ok(touching.length > 20 && vowels.length >= 3);
    const blink = Array.from({ length: 69 }, (_, n) => ({ 19: 940, 20: 940, 21: 84, 22: 84 })[n] ?? 0);
    const wink = blink.map((value, n) => (n % 2 ? value : 0));
    const measured = await page.evaluate((all) => {
      const of = window.measure();
      return all.map((one) => of(one));
    }, [touching, vowels, [blink, wink]]);
    const [shut, wide, [closed, winked]] = measured;
    const gaps = shut.flatMap((one) => one.gaps);
    t.diagnostic(`gaps of ${touching.length} frames: ${Math.min(...gaps).toFixed(2)} to ${Math.max(...gaps).toFixed(2)} mm; vowels ${wide.map((one) => one.gaps[0].toFixed(1))} mm, chin ${wide.map((one) => one.chin.toFixed(1))}; lids ${closed.lids.map((x) => x.toFixed(2))}`);
    assert.ok(Math.max(...gaps) < tolerance, `${Math.max(...gaps)} mm between closed lips`);
    assert.ok(Math.min(...gaps) > -2.5, `${Math.min(...gaps)} mm into each other`);
    for (const { gaps: [middle], chin } of wide) assert.ok(middle > 2 && chin < -0.5, `${middle} mm open, chin ${chin} mm`);
    if (eyes) {
      assert.ok(closed.lids.every((share) => share < 0.12), `lids ${closed.lids}`);
      assert.ok(winked.lids[0] < 0.12 && winked.lids[1] > 0.9, `wink ${winked.lids}`);
    }
    const sparse = (frame) => Object.fromEntries([...frame].map((value, n) => [n, value]).filter(([n, value]) => n > 2 && value));
    const [rest, closure, vowel] = [await shot(`${file}-rest`, {}), await shot(`${file}-m`, sparse(touching[touching.length >> 1])), await shot(`${file}-a`, sparse(vowels[0]))].map(between);
    if (eyes) await shot(`${file}-blink`, sparse(blink), null);
    t.diagnostic(`points between the lips: ${rest} ${closure} ${vowel}`);
    assert.ok(closure < 0.15 && vowel > 0.8, `${rest} ${closure} ${vowel}`);
    assert.deepEqual(await page.evaluate(() => window.violations), []);
  });

test('keeps the colours of a KTX2 picture, loads decoders on demand, and reports undecodable pictures as damaged', async () => {
  const points = await page.evaluate(() => {
    const { image } = window.avatar().meshes.find(({ name }) => name === 'hair').material.map;
    const canvas = new OffscreenCanvas(image.width, image.height);
    const drawn = canvas.getContext('2d');
    drawn.drawImage(image, 0, 0);
    return [[4, 4], [12, 4], [4, 12], [12, 12]].map(([x, y]) => [...drawn.getImageData(x, y, 1, 1).data]);
  });
  const colours = [[200, 40, 40, 255], [40, 40, 200, 255], [40, 200, 40, 255], [220, 220, 60, 255]];
  colours.forEach((colour, i) => colour.forEach((value, k) => assert.ok(Math.abs(points[i][k] - value) < 12, `${i}: ${points[i]}`)));
  assert.deepEqual(await page.evaluate(() => window.violations), []);
  const asked = page.asked.flatMap((address) => address.match(/talking-head-(draco|basis)\.js$/)?.[1] ?? []);
  assert.deepEqual(asked.sort(), ['basis', 'draco'], 'one script each, and only for this avatar');
  await page.evaluate(() => {
    window.heard.length = 0;
    window.head().avatar = '/draco.glb';
  });
  await page.waitForFunction(() => window.heard.some(({ type, reason }) => type === 'error' && reason === 'damaged'), null, { timeout: 120000 });
  await visit('/');
});

test('turns the head and the eyes on their bones', async () => {
  await open('/own.vrm');
  const turned = await page.evaluate(() => {
    const { controls } = window.avatar();
    const faps = new Float32Array(69);
    faps[49] = 0.3e5;
    faps[23] = faps[24] = -0.2e5;
    faps[25] = faps[26] = 0.1e5;
    const nose = () => {
      window.avatar().group.updateMatrixWorld(true);
      const eye = (bone) => bone.matrixWorld.elements.slice(8, 11).map((x) => Math.round((x / Math.hypot(...bone.matrixWorld.elements.slice(8, 11))) * 100) / 100);
      return { head: eye(controls.bones.head), left: eye(controls.bones.leftEye) };
    };
    window.avatar().setFaps(new Float32Array(69));
    const before = nose();
    window.avatar().setFaps(faps);
    return { before, after: nose() };
  });
  assert.deepEqual(turned.before.head, [0, 0, 1]);
  assert.ok(turned.after.head[0] > 0.28 && turned.after.head[0] < 0.31, 'to its left');
  assert.ok(turned.after.left[0] < 0.12 && turned.after.left[1] < -0.08, 'the eyes back, and down');
});

test('speaks, and hands over to the default head when removed', async (t) => {
  await open('/own.glb');
  // A busy machine draws few pictures a second and may miss a short closure, so the sentence is repeated.
  const gaps = [];
  for (let turn = 0; turn < 6 && !(Math.max(...gaps) > 2 && Math.min(...gaps) < 0.1); turn++) {
    const spoken = await page.evaluate(async (text) => {
      window.head().pose(null);
      const found = [];
      let going = true;
      const look = () => {
        if (window.head().debug().running) found.push(window.avatar().solver.opened[0]);
        if (going) requestAnimationFrame(look);
      };
      look();
      const { reason } = await window.head().speak(text, { lang: 'it' });
      going = false;
      return { reason, found, ...window.head().debug() };
    }, TEXT);
    assert.equal(spoken.reason, 'done');
    t.diagnostic(`${spoken.fps} ${spoken.level} ${spoken.triangles} ${spoken.sound}: ${spoken.found.map((gap) => gap.toFixed(1)).join(' ')}`);
    gaps.push(...spoken.found);
  }
  assert.ok(Math.max(...gaps) > 2 && Math.min(...gaps) < 0.1, `${gaps}`);
  await page.evaluate(() => (window.heard.length = 0));
  await page.evaluate(() => (window.head().avatar = null));
  await page.waitForFunction(() => window.heard.some(({ type, model }) => type === 'ready' && model === 'mara'), null, { timeout: 120000 });
});

test('reports a file that is not an avatar, and shows the default head', async (t) => {
  const files = { ...Object.fromEntries(Object.entries(await hostile()).map(([name, [, reason]]) => [`/${name}.glb`, reason])), '/large.glb': 'too-large' };
  const cases = [...Object.entries(files).map(([file, reason]) => [file, null, reason]), ['/odd.glb', '/odder.json', 'bad-map'], ['/odd.glb', '/nonsense.json', 'bad-map'], ['/odd.glb', '/missing.json', 'missing'], ['/odd.glb', null, 'no-face']];
  for (const [file, map, reason] of cases) {
    await page.evaluate(([address, mapping]) => {
      window.heard.length = 0;
      Object.assign(window.head(), { avatar: null, avatarMap: mapping });
      window.head().avatar = address;
    }, [file, map]);
    await page.waitForFunction(() => window.heard.some(({ type }) => type === 'error'), null, { timeout: 120000 });
    const errors = await page.evaluate(() => window.heard.filter(({ type }) => type === 'error'));
    t.diagnostic(`${file}: ${errors.map((error) => `${error.reason}: ${error.message}`)}`);
    assert.deepEqual(errors.map((error) => [error.code, error.reason]), [['bad-avatar', reason]], file);
  }
  await page.waitForFunction(() => window.heard.some(({ type, model }) => type === 'ready' && model === 'mara'), null, { timeout: 120000 });
  assert.ok(!page.asked.some((address) => address.includes('spy')), 'nothing is fetched from elsewhere');
  assert.ok(await page.locator('talking-head .message').isHidden());
  assert.deepEqual(page.problems, []);
});

test('does not fetch the avatar script without an avatar, and the element contains none of it', async () => {
  const plain = await browser.newPage();
  const asked = [];
  plain.on('request', (request) => asked.push(new URL(request.url()).pathname));
  await plain.goto(pages.url);
  await plain.waitForFunction(() => document.querySelector('talking-head').debug?.().frames > 0, null, { timeout: 120000 });
  assert.ok(asked.includes('/talking-head.js') && !asked.includes('/talking-head-avatar.js'));
  await plain.close();
  const light = await (await daemon.get('/talking-head.js')).text();
  const lazy = await (await daemon.get('/talking-head-avatar.js')).text();
  assert.ok(lazy.includes('KHR_mesh_quantization') && !light.includes('KHR_mesh_quantization'));
});
