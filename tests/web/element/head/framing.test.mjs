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

/** The lips' vertices, moved: those within their contours at rest. */
function lipsOf(head, { position }, moved) {
  const [upper, lower, corner] = [head.fdp['8.1'] ?? head.fdp['2.2'], head.fdp['8.2'] ?? head.fdp['2.3'], head.fdp['2.4']];
  return moved.filter((_, i) => {
    const v = i - (i % 3);
    return Math.abs(position[v]) < corner[0] && position[v + 1] < upper[1] && position[v + 1] > lower[1] && position[v + 2] > corner[2];
  });
}
