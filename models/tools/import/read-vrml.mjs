// SPDX-License-Identifier: GPL-3.0-or-later
/** VRML97 (ISO/IEC 14772-1), as modelling programs write it, and VRML 1.0: the scene's IndexedFaceSets with transforms, materials and textures. */
import { pictureBeside } from './beside.mjs';
import { cutFace, turnedOver } from './corners.mjs';
import { FileError, MOST } from './file-error.mjs';
import { apply, matrixOf, mirrors, product } from './matrix.mjs';
import { textOf } from './text.mjs';
import { vrmlTransform } from './vrml-transform.mjs';
import { walkVrml1 } from './vrml1.mjs';

const TOKEN = /#[^\r\n]*|"(?:[^"\\]|\\.)*"|[[\]{}]|[^\s,[\]{}"#]+|\r\n|\r|\n/g;

class Reader {
  /** @param {boolean} old whether it is VRML 1.0: nodes stand in nodes without a field, and values may be words */
  constructor(text, budget, old = false) {
    this.old = old;
    this.text = text;
    this.budget = budget;
    this.line = 1;
    this.defined = new Map();
    this.words = this.tokens();
    this.advance();
  }

  *tokens() {
    for (const [word] of this.text.matchAll(TOKEN)) {
      if (word === '\n' || word[0] === '\r') this.line++;
      else if (word[0] === '"') {
        yield word;
        this.line += word.split('\n').length - 1;
      } else if (word[0] !== '#') yield word;
    }
  }

  advance() {
    const before = this.word;
    this.word = this.words.next().value;
    return before;
  }

  fail(what) {
    throw new FileError(`line ${this.line}`, what);
  }

  /** Reads a node, or resolves USE. */
  node(depth) {
    let name = null;
    if (this.word === 'USE') {
      this.advance();
      const used = this.advance();
      if (!this.defined.has(used)) this.fail(`USE ${String(used).slice(0, 40)}: there is no such node`);
      return this.defined.get(used);
    }
    if (this.word === 'DEF') {
      this.advance();
      name = this.advance();
    }
    return this.body(this.advance(), name, depth);
  }

  body(type, name, depth) {
    if (depth > MOST.depth) this.fail('nodes within nodes within nodes: too deep');
    const node = { type, name, fields: {}, nodes: [], line: this.line };
    if (this.word !== '{') this.fail(`"{" must follow ${String(node.type).slice(0, 40)}`);
    this.advance();
    while (this.word !== '}') {
      if (this.word === undefined) this.fail(`the file ends within a ${node.type}`);
      if (this.old && ['DEF', 'USE'].includes(this.word)) {
        node.nodes.push(this.node(depth + 1));
        continue;
      }
      const field = this.advance();
      if (this.old && this.word === '{') {
        this.budget.keep(1, () => `line ${this.line}`);
        node.nodes.push(this.body(field, null, depth + 1));
        continue;
      }
      if (!/^[A-Za-z_]/.test(field)) this.fail(`"${field.slice(0, 40)}" is no field of a ${node.type}`);
      if (field === 'ROUTE') {
        this.skipRoute();
        continue;
      }
      if (/^(EXTERN)?PROTO$/.test(field)) this.fail(`${field} is not read`);
      node.fields[field] = this.value(depth);
    }
    this.advance();
    if (name) this.defined.set(name, node);
    return node;
  }

  /** Ignores animation: a head at rest does not use it. */
  skipRoute() {
    this.advance();
    if (this.advance() !== 'TO') this.fail('ROUTE wants TO');
    this.advance();
  }

  value(depth) {
    if (this.word === '[') {
      this.advance();
      const list = [];
      while (this.word !== ']') {
        if (this.word === undefined) this.fail('the file ends within a list');
        list.push(this.item(depth));
      }
      this.advance();
      return list;
    }
    if (!/^[-+.\d]/.test(this.word ?? '')) return this.item(depth);
    const list = [];
    while (/^[-+.\d]/.test(this.word ?? '')) list.push(this.item(depth));
    return list;
  }

  item(depth) {
    const { word } = this;
    if (word === undefined) this.fail('the file ends where a value is wanted');
    this.budget.keep(1, () => `line ${this.line}`);
    if (/^[-+.\d]/.test(word)) {
      const number = Number(this.advance());
      if (!Number.isFinite(number)) this.fail(`"${word.slice(0, 40)}" is no number`);
      return number;
    }
    if (word[0] === '"') return this.advance().slice(1, -1).replace(/\\(.)/g, '$1');
    if (['TRUE', 'FALSE', 'NULL'].includes(word)) return { TRUE: true, FALSE: false, NULL: null }[this.advance()];
    if (this.old && /^[A-Z_(]/.test(word)) return this.wordOrMask();
    if (!/^[A-Za-z_]/.test(word)) this.fail(`"${word.slice(0, 40)}" is no value`);
    return this.node(depth + 1);
  }

  /** A word of VRML 1.0 such as COUNTERCLOCKWISE, or several in brackets. */
  wordOrMask() {
    const first = this.advance();
    if (first[0] !== '(') return first;
    for (let word = first; word !== undefined && !word.endsWith(')'); ) word = this.advance();
    return first;
  }
}

const listOf = (value) => (Array.isArray(value) ? value : value ? [value] : []);

function facesOf({ fields, line }, matrix, name, material, meshes, budget) {
  const fail = (what) => {
    throw new FileError(`line ${line}`, what);
  };
  const points = listOf(fields.coord?.fields?.point);
  if (!points.length || points.length % 3) fail('an IndexedFaceSet without the points of its corners');
  const texture = listOf(fields.texCoord?.fields?.point);
  const tints = listOf(fields.color?.fields?.color);
  const tintIndex = listOf(fields.colorIndex);
  const coordIndex = listOf(fields.coordIndex);
  const texIndex = listOf(fields.texCoordIndex);
  // a node repeated by USE is created, and counted, each time
  budget.work(4 * coordIndex.length, `line ${line}`);
  const mesh = { name, material, position: [], uv: [], colors: [], index: [], targets: {}, from: [] };
  let ofFace = 0;
  const known = new Map();
  let face = [];
  const close = () => {
    if (face.length && face.length < 3) fail('a face must have three corners or more');
    const corners = fields.ccw === false ? face.reverse() : face;
    if (corners.length) cutFace(corners, (v) => mesh.position.slice(3 * v, 3 * v + 3), (...three) => mesh.index.push(...three), (steps) => budget.work(steps, `line ${line}`));
    budget.keep(3 * Math.max(0, corners.length - 2), `line ${line}`);
    face = [];
    ofFace++;
  };
  coordIndex.forEach((p, i) => {
    if (p === -1) return close();
    if (!Number.isInteger(p) || p < 0 || p >= points.length / 3) fail(`coordIndex ${i} is ${p}, but there are ${points.length / 3} points`);
    const t = texture.length ? (texIndex[i] ?? p) : -1;
    if (t >= texture.length / 2) fail(`texCoordIndex ${i} is ${t}, but there are ${texture.length / 2} points`);
    const c = !tints.length ? -1 : fields.colorPerVertex === false ? (tintIndex[ofFace] ?? ofFace) : (tintIndex[i] ?? p);
    if (c >= tints.length / 3) fail(`the colour of coordIndex ${i} is ${c}, but there are ${tints.length / 3}`);
    const key = `${p}/${t}/${c}`;
    if (!known.has(key)) {
      budget.keep(8, `line ${line}`); // counts colours and texture coordinates, too
      known.set(key, mesh.position.length / 3);
      mesh.position.push(points[3 * p], points[3 * p + 1], points[3 * p + 2]);
      mesh.uv.push(...(t < 0 ? [0, 0] : [texture[2 * t], texture[2 * t + 1]]));
      if (c >= 0) mesh.colors.push(...tints.slice(3 * c, 3 * c + 3));
      mesh.from.push(p);
    }
    face.push(known.get(key));
    return undefined;
  });
  close();
  if (!mesh.index.length) return;
  const index = Uint32Array.from(mesh.index);
  meshes.push({ ...mesh, position: apply(matrix, mesh.position), uv: texture.length ? Float64Array.from(mesh.uv) : null, index: mirrors(matrix) ? turnedOver(index) : index, colors: tints.length ? Float64Array.from(mesh.colors) : null });
}

export function readVrml(file, bytes, budget) {
  const text = textOf(bytes);
  const old = /^#VRML V[12]\.0 ascii/.test(text); // LUCIA's files of VRML 1.0 say 2.0
  if (!old && !/^#VRML V2\.0 utf8/.test(text)) throw new FileError('line 1', 'this is no VRML: it must begin with "#VRML V2.0 utf8" or "#VRML V1.0 ascii"');
  const reader = new Reader(text, budget, old);
  const roots = [];
  while (reader.word !== undefined) {
    if (reader.word !== 'ROUTE') roots.push(reader.node(0));
    else {
      reader.advance();
      reader.skipRoute();
    }
  }
  const [meshes, materials, notes] = [[], [], []];
  const known = new Map();
  const materialOf = (appearance, solid) => {
    if (!appearance?.fields) return -1;
    const sides = known.get(appearance) ?? {};
    known.set(appearance, sides);
    if (sides[solid] === undefined) {
      sides[solid] = materials.length;
      const { diffuseColor, transparency } = appearance.fields.material?.fields ?? {};
      const look = { name: appearance.fields.material?.name ?? appearance.name ?? `material ${materials.length}`, color: diffuseColor ?? [0.8, 0.8, 0.8], roughness: 0.6, alpha: listOf(transparency)[0] > 0 ? 'blend' : 'opaque', double_sided: !solid, picture: null };
      const url = listOf(appearance.fields.texture?.fields?.url)[0];
      if (typeof url === 'string') {
        const picture = pictureBeside(file, url, `line ${appearance.fields.texture.line}`, notes, budget);
        if (picture) Object.assign(look, { picture, color: [1, 1, 1] });
      }
      materials.push(look);
    }
    return sides[solid];
  };
  const draw = (set, matrix, name, appearance, solid) => {
    facesOf(set, matrix, name ?? `mesh ${meshes.length}`, materialOf(appearance, solid), meshes, budget);
    if (meshes.length > MOST.meshes) throw new FileError(`line ${set.line}`, `more than ${MOST.meshes} meshes are no head`);
  };
  let visited = 0;
  const walk = (node, matrix, name) => {
    if (!node?.type) return;
    if (++visited > 1e5) throw new FileError(`line ${node.line}`, 'more nodes than a head has');
    budget.work(100, `line ${node.line}`);
    const own = node.name ?? name;
    if (node.type === 'Shape') {
      const { geometry, appearance } = node.fields;
      if (geometry?.type === 'IndexedFaceSet') draw(geometry, matrix, geometry.name ?? own, appearance, geometry.fields.solid !== false);
      return;
    }
    const inner = node.type === 'Transform' ? product(matrix, vrmlTransform(node.fields, `line ${node.line}`)) : matrix;
    const { children, choice, whichChoice = -1, level } = node.fields;
    // of alternatives, reads the chosen one of a Switch and the nearest level of an LOD
    const shown = node.type === 'Switch' ? listOf(choice).slice(whichChoice, whichChoice < 0 ? 0 : whichChoice + 1) : node.type === 'LOD' ? listOf(level).slice(0, 1) : listOf(children);
    for (const child of shown) walk(child, inner, own);
  };
  if (old) walkVrml1(roots, { draw, work: (steps, at) => budget.work(steps, at) });
  else for (const root of roots) walk(root, matrixOf({}, ''), null);
  if (!meshes.length) throw new FileError('', 'there is no IndexedFaceSet in it');
  return { meshes, materials, notes, unit: null };
}
