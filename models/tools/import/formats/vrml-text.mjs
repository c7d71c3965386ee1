// SPDX-License-Identifier: GPL-3.0-or-later
/** Nodes from the text of VRML97, VRML 1.0, and scenes of MPEG-4 (BIFS text). */
import { FileError, MOST } from '../limits.mjs';

const TOKEN = /#[^\r\n]*|"(?:[^"\\]|\\.)*"|[[\]{}]|[^\s,[\]{}"#]+|\r\n|\r|\n/g;

/** @typedef {{type: string, name: string|null, fields: object, nodes: object[], line: number}} Node a number or a list of them is a list */

export class VrmlText {
  /** @param {{old?: boolean, bifs?: boolean}} how old: VRML 1.0, where nodes stand in nodes without a field, and values may be words; bifs: a scene of MPEG-4 */
  constructor(text, budget, { old = false, bifs = false } = {}) {
    this.old = old;
    this.bifs = bifs;
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
      // the node may be defined further down
      node.fields[field] = field === 'faceSceneGraphNode' && this.word === 'USE' ? this.later() : this.value(depth);
    }
    this.advance();
    if (name) this.defined.set(name, node);
    return node;
  }

  later() {
    const { line } = this;
    this.advance();
    return { use: this.advance(), line };
  }

  /** All nodes up to the end. Of the commands of an MPEG-4 scene only a first one that brings the scene is read: later ones animate it. */
  roots() {
    const roots = [];
    const nodes = (until) => {
      while (this.word !== until && this.word !== undefined && !(this.bifs && /^(RAP|AT)$/.test(this.word))) {
        if (this.word !== 'ROUTE') roots.push(this.node(0));
        else {
          this.advance();
          this.skipRoute();
        }
      }
    };
    nodes(undefined);
    if (this.beginsScene()) nodes('}');
    return roots;
  }

  /** Takes `RAP AT 0 { REPLACE SCENE BY`. */
  beginsScene() {
    if (this.word === 'RAP') this.advance();
    if (this.word !== 'AT') return false;
    this.advance();
    this.advance();
    return ['{', 'REPLACE', 'SCENE', 'BY'].every((word) => this.advance() === word);
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
    if (this.bifs && /^(true|false)$/.test(word)) return this.advance() === 'true';
    if (this.bifs && /^od:\d+$/.test(word)) return this.advance(); // another stream
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
