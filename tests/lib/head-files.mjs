// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a head in file formats of other programs: OBJ with MTL, PLY as text and binary, VRML97, each with its points file.
import fs from 'node:fs';
import path from 'node:path';

const triples = (list) => Array.from({ length: list.length / 3 }, (_, i) => Array.from(list.slice(3 * i, 3 * i + 3)));
const pairs = (list) => Array.from({ length: list.length / 2 }, (_, i) => Array.from(list.slice(2 * i, 2 * i + 2)));
const words = (list) => list.map((one) => one.map((x) => Number(x.toFixed(5))).join(' '));

/** @param {object} head unpacked @param {string} folder */
export function writeHeadFiles(head, folder) {
  const write = (name, text) => fs.writeFileSync(path.join(folder, name), text);
  const points = (name, place) => write(name, JSON.stringify({ frame: 'file', fdp: Object.fromEntries(Object.entries(head.fdp).map(([one, p]) => [one, place(p)])) }));
  write('skin.webp', Buffer.from(head.textures.skin.data, 'base64'));
  write('head.mtl', head.parts.map(({ name }) => `newmtl ${name}\nKd 0.8 0.7 0.6\n${name === 'skin' ? 'map_Kd skin.webp\n' : ''}`).join(''));
  let from = 1;
  const objects = head.parts.map((part) => {
    const place = triples(part.position).map(([x, y, z]) => [x, y + 1600, z]);
    const faces = triples(part.index).map((corners) => `f ${corners.map((v) => `${from + v}/${from + v}`).join(' ')}`);
    from += place.length;
    return [`o ${part.name}`, `usemtl ${part.name}`, ...words(place).map((one) => `v ${one}`), ...words(pairs(part.uv)).map((one) => `vt ${one}`), ...faces].join('\n');
  });
  write('head.obj', `# mm, standing on the floor\nmtllib head.mtl\n${objects.join('\n')}\n`);
  points('obj-points.json', ([x, y, z]) => [x, y + 1600, z]);

  const [skin] = head.parts;
  const vertices = triples(skin.position).map((p, v) => [...p, skin.uv[2 * v], skin.uv[2 * v + 1]]);
  const plyHead = (format) =>
    ['ply', `format ${format} 1.0`, 'comment TextureFile skin.webp', `element vertex ${vertices.length}`, ...['x', 'y', 'z', 's', 't'].map((name) => `property float ${name}`),
      `element face ${skin.index.length / 3}`, 'property list uchar int vertex_indices', 'end_header', ''].join('\n');
  write('head.ply', `${plyHead('ascii')}${words(vertices).join('\n')}\n${triples(skin.index).map((face) => `3 ${face.join(' ')}`).join('\n')}\n`);
  const bytes = Buffer.alloc(20 * vertices.length + (13 * skin.index.length) / 3);
  vertices.flat().forEach((x, i) => bytes.writeFloatBE(x, 4 * i));
  triples(skin.index).forEach((face, t) => {
    const at = 20 * vertices.length + 13 * t;
    bytes.writeUInt8(3, at);
    face.forEach((v, k) => bytes.writeInt32BE(v, at + 1 + 4 * k));
  });
  write('binary.ply', Buffer.concat([Buffer.from(plyHead('binary_big_endian')), bytes]));
  points('ply-points.json', (p) => p);

  // like modelling programs: z up, cm, names, a transform, and lists with trailing commas
  const shapes = head.parts.map((part) => {
    const place = words(triples(part.position).map(([x, y, z]) => [x, -z, y])).join(',\n');
    const look = `Appearance { material DEF M_${part.name} Material { diffuseColor 0.8 0.7 0.6 } ${part.name === 'skin' ? 'texture ImageTexture { url [ "skin.webp" ] }' : ''} }`;
    const faces = triples(part.index).map((corners) => corners.join(', ')).join(', -1, ');
    return `DEF ${part.name} Transform { translation 0 0 160 scale 0.1 0.1 0.1 children [ Shape { appearance ${look} geometry IndexedFaceSet { solid FALSE coord Coordinate { point [ ${place}, ] }
texCoord TextureCoordinate { point [ ${words(pairs(part.uv)).join(', ')} ] } coordIndex [ ${faces}, -1 ] } } ] }`;
  });
  write('head.wrl', `#VRML V2.0 utf8\n# z is up\n${shapes.join('\n')}\n`);
  points('wrl-points.json', ([x, y, z]) => [x / 10, -z / 10, y / 10 + 160]);
}
