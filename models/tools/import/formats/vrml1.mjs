// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * The scene of a VRML 1.0 file, as LUCIA's head is stored in: nodes change a state (coordinates, texture, material, place), and an
 * IndexedFaceSet draws with it. A Separator restores the state at its end.
 */
import { FileError } from '../limits.mjs';
import { matrixOf, product, vrmlTransform } from './matrix.mjs';

const MOST_NODES = 1e5;
const ALL = -3; // whichChild of a Switch
const RESTORING = ['Separator', 'WWWAnchor', 'LOD', 'LevelOfDetail', 'Switch'];

const number = (value, fallback) => (typeof value === 'number' ? value : (value?.[0] ?? fallback));

/** The place that a node gives to what follows; null: it gives none. */
function placeOf({ type, fields, line }) {
  const at = `line ${line}`;
  if (type === 'MatrixTransform') return matrixOf({ matrix: fields.matrix }, at);
  return ['Transform', 'Translation', 'Rotation', 'Scale'].includes(type) ? vrmlTransform({ ...fields, scale: fields.scaleFactor }, at) : null;
}

/** Fields of VRML97's IndexedFaceSet for one that draws with a state. */
function facesAs({ fields, line }, { Coordinate3, TextureCoordinate2, Material, MaterialBinding, ShapeHints }) {
  const { textureCoordIndex, materialIndex } = fields;
  const indices = (list) => (Array.isArray(list) && list.some((i) => i >= 0) ? list : undefined);
  const binding = String(MaterialBinding?.fields.value ?? 'OVERALL');
  const tints = /^PER_(VERTEX|FACE)/.test(binding) ? Material?.fields.diffuseColor : null;
  return {
    line,
    fields: {
      coord: Coordinate3, texCoord: TextureCoordinate2, coordIndex: fields.coordIndex, texCoordIndex: indices(textureCoordIndex),
      ccw: ShapeHints?.fields.vertexOrdering !== 'CLOCKWISE',
      ...(tints?.length > 3 ? { color: { fields: { color: tints } }, colorIndex: indices(materialIndex), colorPerVertex: binding.startsWith('PER_VERTEX') } : {}),
    },
  };
}

/**
 * @param {object[]} roots nodes as read, each with its nodes and fields
 * @param {{draw: (set: object, matrix: number[], name: string|null, appearance: object, solid: boolean) => void, work: (steps: number, at: string) => void}} ports
 *   draw: the set and the appearance as of VRML97
 */
export function walkVrml1(roots, { draw, work }) {
  let visited = 0;
  let last = null; // the coordinates read last, for a set outside the Separator that holds them, as LUCIA's is printed
  const looks = new Map(); // appearances by material and texture
  const appearanceOf = ({ Material, Texture2 }) => {
    const of = looks.get(Material) ?? new Map();
    looks.set(Material, of);
    const { filename } = Texture2?.fields ?? {};
    if (!of.has(Texture2)) {
      const texture = filename ? { line: Texture2.line, fields: { url: filename } } : undefined;
      of.set(Texture2, { name: null, fields: { material: Material && { name: Material.name, fields: { ...Material.fields, diffuseColor: Material.fields.diffuseColor?.slice(0, 3) } }, texture } });
    }
    return of.get(Texture2);
  };
  const shown = ({ type, nodes, fields }) => {
    if (type === 'LOD' || type === 'LevelOfDetail') return nodes.slice(0, 1);
    if (type !== 'Switch') return nodes;
    const which = number(fields.whichChild, -1);
    return which === ALL ? nodes : nodes.slice(which, which < 0 ? 0 : which + 1);
  };
  const walk = (node, state, name) => {
    if (!node?.type) return;
    if (++visited > MOST_NODES) throw new FileError(`line ${node.line}`, 'more nodes than a head has');
    work(100, `line ${node.line}`);
    const place = placeOf(node);
    if (place) state.matrix = product(state.matrix, place);
    else if (node.type === 'IndexedFaceSet') {
      const full = state.Coordinate3 ? state : { ...last, ...state };
      const { vertexOrdering, shapeType } = full.ShapeHints?.fields ?? {};
      const solid = shapeType === 'SOLID' && /CLOCKWISE$/.test(vertexOrdering ?? '');
      draw(facesAs(node, full), state.matrix, node.name ?? name, appearanceOf(full), solid);
    } else if (/^(Coordinate3|TextureCoordinate2|Texture2|Material|MaterialBinding|ShapeHints)$/.test(node.type)) {
      state[node.type] = node;
      last = { ...last, [node.type]: node };
    }
    const own = node.name ?? name;
    const inner = RESTORING.includes(node.type) ? { ...state } : state;
    const { matrix } = state;
    for (const child of shown(node)) walk(child, inner, own);
    if (node.type === 'TransformSeparator') state.matrix = matrix;
  };
  const state = { matrix: matrixOf({}, '') };
  for (const root of roots) walk(root, state, null);
}
