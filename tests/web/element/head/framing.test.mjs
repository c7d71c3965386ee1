// SPDX-License-Identifier: GPL-3.0-or-later
// Framing of each head in wide, square and tall places: by the position of the meshes in the picture.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { pose, unpack } from '../../../../models/tools/lib/deform.mjs';
import { framed } from '../../../../web/element/head/framing.mjs';
import { heads as folder } from '../../../lib/built-heads.mjs';

const heads = fs.readdirSync(folder).filter((file) => file.endsWith('.json')).map((file) => unpack(JSON.parse(fs.readFileSync(path.join(folder, file)))));
const PLACES = { phone: 0.46, portrait: 0.77, square: 1, 'television': 16 / 9, strip: 4 };
const OPEN = { 3: 550, 4: -330, 8: -330, 9: -330, 5: -600, 10: -600, 11: -600 };

/** The box of points in the picture: -1 to 1 from left to right and from bottom to top. */
function box(points, { target, distance, fov }, aspect) {
  const tangent = Math.tan((fov * Math.PI) / 360);
  const out = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
  for (let i = 0; i < points.length; i += 3) {
    const half = (target[2] + distance - points[i + 2]) * tangent;
    const [x, y] = [(points[i] - target[0]) / half / aspect, (points[i + 1] - target[1]) / half];
    out.left = Math.min(out.left, x);
    out.right = Math.max(out.right, x);
    out.bottom = Math.min(out.bottom, y);
    out.top = Math.max(out.top, y);
  }
  return out;
}

const above = (points, y) => points.filter((_, i) => points[i - (i % 3) + 1] > y);
const part = (head, name) => head.parts.find((one) => one.name === name);

for (const [place, aspect] of Object.entries(PLACES))
  test(`the views fit their frame: ${place}`, () => {
    for (const head of heads) {
      const [chin, lips] = [head.fdp['2.1'], ['2.2', '2.3', '2.4', '2.5'].flatMap((point) => head.fdp[point])];
      const skin = part(head, 'skin');
      const whole = above([...skin.position, ...part(head, 'hair').position], chin[1]);
      const face = above(skin.position, chin[1]).filter((_, i, all) => all[i - (i % 3) + 2] > chin[2] - 60);
      const at = (name) => framed(head, name, aspect);
      for (const name of [null, 'bust']) {
        const { left, right, top, bottom } = box(whole, at(name), aspect);
        assert.ok(left > -1 && right < 1 && top < 1, `${head.name}, ${name ?? 'portrait'}: head ${JSON.stringify({ left, right, top })}`);
        assert.ok(bottom > -0.7, `${head.name}, ${name ?? 'portrait'}: the chin is above what fades, ${bottom.toFixed(2)}`);
        assert.ok(top - bottom > (aspect < 0.7 ? 0.4 : name ? 0.7 : 1), `${head.name}, ${name ?? 'portrait'}: no stamp, ${(top - bottom).toFixed(2)}`);
      }
      const portrait = box(whole, at(null), aspect);
      const bust = box(whole, at('bust'), aspect);
      assert.ok(bust.top - bust.bottom < portrait.top - portrait.bottom, `${head.name}: a bust shows more`);
      const near = box(face, at('face'), aspect);
      assert.ok(near.bottom > -1 && near.left > -1.05 && near.right < 1.05, `${head.name}, face: ${JSON.stringify(near)}`);
      assert.ok(at('face').distance < at(null).distance, `${head.name}: the face is nearer`);
      assert.ok(near.top - near.bottom > 1.2 * Math.min(1, aspect / 0.78), `${head.name}, face: ${(near.top - near.bottom).toFixed(2)} of 2 high`);
      const mouth = box(lips, at('mouth'), aspect);
      const width = mouth.right - mouth.left;
      assert.ok(width < 1.4 && width * Math.max(1, aspect) > 0.7, `${head.name}, mouth: ${width.toFixed(2)} of 2 wide`);
      // Wide open, the lips and what is between them stay in the picture.
      const moved = pose(head, skin, OPEN);
      const opened = box(lipsOf(head, skin, moved), at('mouth'), aspect);
      assert.ok(opened.bottom > -1 && opened.top < 1, `${head.name}, mouth open: ${JSON.stringify(opened)}`);
    }
  });

/** Turned about a camera's target. @param {number} yaw @param {number} pitch degrees */
function turned(points, { target }, yaw, pitch) {
  const [a, b] = [yaw, pitch].map((degrees) => (degrees * Math.PI) / 180);
  const out = [];
  for (let i = 0; i < points.length; i += 3) {
    const [x, y, z] = [0, 1, 2].map((k) => points[i + k] - target[k]);
    const [u, w] = [x * Math.cos(a) + z * Math.sin(a), z * Math.cos(a) - x * Math.sin(a)];
    out.push(u + target[0], y * Math.cos(b) - w * Math.sin(b) + target[1], y * Math.sin(b) + w * Math.cos(b) + target[2]);
  }
  return out;
}

test('the body goes out of every picture: where it is cut off is below, however the head is turned', () => {
  const CUT = 16; // mm
  const BACK = -120; // mm: what is cut farther behind is hidden by the front
  for (const head of heads)
    for (const [place, aspect] of Object.entries({ ...PLACES, column: 0.25 }))
      for (const name of [null, 'bust'])
        for (const [yaw, pitch] of [[0, 0], [25, 0], [-25, 0], [25, 10], [0, 10], [0, -10]]) {
          const clothes = part(head, 'clothes').position;
          const low = clothes.reduce((least, y, i) => (i % 3 === 1 ? Math.min(least, y) : least), Infinity);
          const rim = clothes.filter((_, i) => clothes[i - (i % 3) + 1] < low + CUT && clothes[i - (i % 3) + 2] > BACK);
          const camera = framed(head, name, aspect);
          const { top } = box(turned(rim, camera, yaw, pitch), camera, aspect);
          assert.ok(top < -1, `${head.name}, ${name ?? 'portrait'}, ${place}, turned by ${yaw}, ${pitch}: the cut at ${top.toFixed(2)}`);
        }
});

test('is composed as a portrait: eyes in the upper third or a little below, room above the hair, shoulders in a bust', () => {
  for (const head of heads)
    for (const [place, aspect] of Object.entries(PLACES)) {
      const hair = [...part(head, 'skin').position, ...part(head, 'hair').position];
      for (const name of [null, 'bust']) {
        const camera = framed(head, name, aspect);
        const [eyes] = [box([0, 0, 0], camera, aspect)].map(({ top }) => (1 - top) / 2);
        const room = (1 - box(hair, camera, aspect).top) / 2;
        if (place !== 'phone') assert.ok(eyes > 0.33 && eyes < 0.48, `${head.name}, ${name}, ${place}: eyes at ${eyes.toFixed(2)}`);
        assert.ok(room > 0.005 && room < (place === 'phone' ? 0.42 : 0.2), `${head.name}, ${name}, ${place}: ${room.toFixed(3)} above the hair`);
      }
      if (aspect < 0.7) continue;
      const shoulders = above(part(head, 'clothes').position, -240);
      const { left, right } = box(shoulders, framed(head, 'bust', aspect), aspect);
      assert.ok(left > -1.25 && right < 1.25, `${head.name}, ${place}: shoulders from ${left.toFixed(2)} to ${right.toFixed(2)}`);
    }
});

test('a head without a body is framed as ever', () => {
  const { view, ...rest } = heads[0];
  const { bottom: _, ...bare } = view;
  assert.deepEqual(framed({ view: bare, ...rest }, null, 1), { target: view.target, distance: view.distance, fov: view.fov });
  assert.ok(framed({ view: bare, ...rest }, null, 0.4).distance > view.distance);
});

/** The lips' vertices, moved: those within their contours at rest. */
function lipsOf(head, { position }, moved) {
  const [upper, lower, corner] = [head.fdp['8.1'] ?? head.fdp['2.2'], head.fdp['8.2'] ?? head.fdp['2.3'], head.fdp['2.4']];
  return moved.filter((_, i) => {
    const v = i - (i % 3);
    return Math.abs(position[v]) < corner[0] && position[v + 1] < upper[1] && position[v + 1] > lower[1] && position[v + 2] > corner[2];
  });
}
