// SPDX-License-Identifier: MIT
// The custom elements manifest (custom-elements.json): members from the types, the rest from the tables of
// docs/element/reference.md.
import { create, ts } from '@custom-elements-manifest/analyzer';
import { readFileSync } from 'node:fs';

const SEVERAL = 4; // names in a row that lists them without telling each

/**
 * Collects the descriptions of each name in the first column of a section's tables: of rows of its own, rather than of one of
 * many names.
 */
function rows(readme, section) {
  const text = readme.split(`\n## ${section}\n`)[1].split('\n## ')[0];
  const told = new Map(), shared = new Set();
  for (const line of text.split('\n').filter((one) => one.startsWith('| `'))) {
    const [names, ...rest] = line.slice(2, -2).split(' | ');
    const listed = [...names.matchAll(/`([^`]+)`/g)].map(([, name]) => name);
    for (const name of listed) {
      const before = shared.has(name) ? undefined : told.get(name);
      told.set(name, [...(before ? [before] : []), ...rest].join('; '));
      if (listed.length > SEVERAL) shared.add(name);
      else shared.delete(name);
    }
  }
  return [...told].map(([name, description]) => ({ name, description }));
}

/**
 * @param {string} types file with the element's types @param {string} readme file that documents it
 * @param {string} script the module's path in the package
 * @returns {object} the manifest, schema 1.0.0
 */
export function manifest(types, readme, script) {
  const source = ts.createSourceFile(script, readFileSync(types, 'utf8'), ts.ScriptTarget.ES2022, true);
  const { declarations } = create({ modules: [source] }).modules[0];
  const element = declarations.find(({ name }) => name === 'TalkingHead');
  const text = readFileSync(readme, 'utf8');
  const looks = rows(text, 'Looks');
  const told = rows(text, 'Events');
  const events = source.statements.find(({ name }) => name?.text === 'TalkingHeadEventMap').members;
  const fields = new Map(element.members.map((member) => [member.name, member]));
  const camel = (name) => name.replace(/-([a-z])/g, (_, letter) => letter.toUpperCase());
  return {
    schemaVersion: '1.0.0',
    readme: 'README.md',
    modules: [{
      kind: 'javascript-module',
      path: script,
      declarations: [{
        kind: 'class',
        customElement: true,
        tagName: 'talking-head',
        name: 'TalkingHead',
        superclass: { name: 'HTMLElement' },
        description: 'A head that speaks what it is told.',
        members: element.members.filter(({ name }) => !/EventListener$/.test(name)),
        attributes: rows(text, 'Attributes').map(({ name, description }) => {
          const field = fields.get(camel(name));
          return { name, description, ...(field ? { fieldName: field.name, type: field.type } : {}) };
        }),
        events: events.map((event) => ({
          name: event.name.text,
          type: { text: event.type.getText() },
          description: told.find(({ name }) => name === event.name.text)?.description,
        })),
        cssParts: looks.filter(({ name }) => !name.startsWith('--')),
        cssProperties: looks.filter(({ name }) => name.startsWith('--')),
        slots: [{ name: '', description: 'Shown only as long as the script has not come.' }],
      }],
      exports: [
        { kind: 'custom-element-definition', name: 'talking-head', declaration: { name: 'TalkingHead', module: script } },
        { kind: 'js', name: 'TalkingHead', declaration: { name: 'TalkingHead', module: script } },
      ],
    }],
  };
}
