// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a head in Chromium without a daemon: like the element, from any distance and side, or with each part in a flat colour, so that
// pixels tell the visible parts.
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const web = fileURLToPath(new URL('../../web/', import.meta.url));

// Runs in the page. `paint` assigns colours to parts: [prefix of the name, red, green, blue], 0 to 255.
const script = `
import { View } from './element/head/view.mjs';
import { Head } from './element/head/head.mjs';
import { readModel } from './element/head/model/model.mjs';
import { LEVELS } from './element/head/quality.mjs';
import { Vector3 } from 'three';
const canvas = document.querySelector('canvas');
const view = new View(canvas);
const heads = new Map();
window.load = async (name, json, paint) => {
  const wanted = (part) => !paint || paint.some(([start]) => part.name.startsWith(start));
  const head = await Head.create(readModel({ ...json, parts: json.parts.filter(wanted) }));
  heads.set(name, head);
  if (!paint) return;
  for (const mesh of head.group.children) {
    const part = head.parts.find(({ geometry }) => geometry === mesh.geometry).part;
    const color = paint.find(([start]) => part.name.startsWith(start));
    mesh.material.uniforms.flat_color = { value: new Vector3(...color.slice(1).map((x) => x / 255)) };
    mesh.material.fragmentShader = 'uniform vec3 flat_color; void main() { gl_FragColor = vec4(flat_color, 1.0); }';
    mesh.material.needsUpdate = true;
  }
};
const pose = (name, { yaw = 0, pitch = 0, target = [0, -22, 0], distance = 620, fov = 26, width, height, level = 'high' }) => {
  const head = heads.get(name);
  if (view.head !== head) { if (view.head) { view.scene.clear(); view.head = null; } view.show(head); }
  view.level = LEVELS.find((one) => one.name === level);
  view.resize(width, height);
  view.setLevel(view.level);
  head.uniforms.fade.value = 1e-3; // no fading: the picture's edge may cut the face
  view.camera.fov = fov;
  view.camera.aspect = width / height;
  view.camera.position.set(target[0] + distance * Math.sin(yaw) * Math.cos(pitch), target[1] + distance * Math.sin(pitch), target[2] + distance * Math.cos(yaw) * Math.cos(pitch));
  view.camera.lookAt(...target);
  view.camera.updateProjectionMatrix();
  view.camera.updateMatrixWorld();
  return (values) => {
    head.setFaps(Float32Array.from(values));
    view.draw();
  };
};
window.shot = (name, values, camera) => {
  pose(name, camera)(values);
  return canvas.toDataURL('image/png').slice(22);
};
window.counts = (name, frames, camera, colours, half) => {
  const draw = pose(name, camera);
  const gl = canvas.getContext('webgl2');
  const { width, height } = canvas;
  const pixels = new Uint8Array(4 * width * height);
  const partAt = (i) => (pixels[i + 3] ? colours.findIndex((colour) => colour.every((x, k) => Math.abs(x - pixels[i + k]) < 40)) : -1);
  return frames.map((values) => {
    draw(values);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const areas = colours.map(() => 0);
    const box = { left: width, right: -1, top: height, bottom: -1 }; // box of all colours but the first
    for (let i = 0; i < pixels.length; i += 4) {
      const part = partAt(i);
      if (part >= 0) areas[part]++;
      if (part <= 0) continue;
      const [x, y] = [(i / 4) % width, height - 1 - Math.floor(i / 4 / width)];
      Object.assign(box, { left: Math.min(box.left, x), right: Math.max(box.right, x), top: Math.min(box.top, y), bottom: Math.max(box.bottom, y) });
    }
    const columns = [];
    for (let x = Math.round(width / 2) - half; x < Math.round(width / 2) + half; x++) {
      const runs = [];
      for (let y = height - 1; y >= 0; y--) { // from the top; rows are bottom-up
        const part = partAt(4 * (y * width + x));
        if (runs.length && runs.at(-1)[0] === part) runs.at(-1)[1]++;
        else runs.push([part, 1]);
      }
      columns.push(runs);
    }
    return { areas, box, columns };
  });
};
`;

const whole = (faps) => Array.from({ length: 69 }, (_, n) => faps[n] ?? 0);

/**
 * @param {import('playwright-core').Browser} browser
 * @returns a page with load(name, head, paint), shot(name, faps, camera): a PNG's bytes, and counts(name, frames, camera, colours, half): for
 * each frame the number of pixels of each colour, the box of all colours but the first, and the 2 x half middle columns from the top, as runs
 * of [index of the colour, length]
 */
export async function headPage(browser) {
  const { build } = createRequire(path.join(web, 'package.json'))('esbuild');
  const bundle = await build({ stdin: { contents: script, resolveDir: web }, bundle: true, format: 'esm', write: false });
  const page = await browser.newPage({ viewport: { width: 800, height: 800 } });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.setContent('<!doctype html><body style="margin:0;background:#c8ccd0"><canvas></canvas>');
  await page.addScriptTag({ type: 'module', content: bundle.outputFiles[0].text });
  await page.waitForFunction(() => window.shot);
  return {
    page,
    load: (name, head, paint) => page.evaluate(([n, h, p]) => window.load(n, h, p), [name, head, paint]),
    shot: async (name, faps, camera) => Buffer.from(await page.evaluate(([n, v, c]) => window.shot(n, v, c), [name, whole(faps), camera]), 'base64'),
    counts: (name, frames, camera, colours, half) => page.evaluate((all) => window.counts(...all), [name, frames.map(whole), camera, colours, half]),
  };
}
