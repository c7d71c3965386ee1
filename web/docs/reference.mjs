// SPDX-License-Identifier: MIT
// Generates the reference pages as Markdown from the schemas, the element's manifest and the programs' help.

const cell = (text) => String(text ?? '').replaceAll('|', '\\|').replaceAll('<', '&lt;').replaceAll('{{', '&#123;&#123;').replace(/\s+/g, ' ').trim();
const code = (text) => (text ? `\`${String(text).replaceAll('|', '\\|').replace(/\s+/g, ' ')}\`` : '');
const table = (head, rows) => (rows.length ? `| ${head.join(' | ')} |\n|${head.map(() => '---|').join('')}\n${rows.map((row) => `| ${row.join(' | ')} |`).join('\n')}\n` : '');
const sentence = (text) => (text ? `${cell(text)}\n\n` : '');

/** Resolves "$ref" in a document or in a schema of the protocol. */
function resolver(document, schema) {
  const within = (whole, pointer) => pointer.split('/').slice(1).reduce((at, key) => at[key.replaceAll('~1', '/').replaceAll('~0', '~')], whole);
  return function resolve(node, home = document) {
    if (!node?.$ref) return { node, home };
    const [file, pointer = ''] = node.$ref.split('#');
    const whole = file ? schema(file.replace(/^.*\//, '').replace('.json', '')) : home;
    const { $ref: _, ...rest } = node;
    const found = resolve(within(whole, pointer), whole);
    return { node: { ...found.node, ...rest }, home: found.home };
  };
}

/** The type of a schema in a few words. */
function typeOf(resolve, raw, home, depth = 0) {
  const { node, home: at } = resolve(raw, home);
  if (!node) return '';
  const type = (one) => typeOf(resolve, one, at, depth + 1);
  if (node.const !== undefined) return JSON.stringify(node.const);
  if (node.enum) return node.enum.map((one) => JSON.stringify(one)).join(' or ');
  if (node.oneOf || node.anyOf) {
    const each = (node.oneOf ?? node.anyOf).map(type).filter(Boolean);
    if (each.length) return [...new Set(each)].join(' or ');
  }
  const name = Array.isArray(node.type) ? node.type.join(' or ') : node.type ?? (node.properties ? 'object' : '');
  if (name === 'array') return depth < 2 && node.items ? `list of ${type(node.items)}` : 'list';
  const [low, high] = [node.minimum ?? node.exclusiveMinimum, node.maximum ?? node.exclusiveMaximum];
  const range = low !== undefined && high !== undefined ? `, ${low} to ${high}` : low !== undefined ? `, from ${low}` : high !== undefined ? `, up to ${high}` : '';
  const length = node.maxLength ? `, up to ${node.maxLength} characters` : '';
  return `${name}${range}${length}`;
}

/** @param {object} document openapi.json @param {(name: string) => object} schema reads a schema of the protocol */
export function openapi(document, schema) {
  const resolve = resolver(document, schema);
  const lines = ['# HTTP reference', '', 'Made of `openapi.json`, which the daemon serves as <a href="/v1/openapi.json" target="_self">/v1/openapi.json</a>. What the requests mean: [HTTP](/protocol/http).', ''];
  for (const [address, operations] of Object.entries(document.paths))
    for (const [method, operation] of Object.entries(operations)) {
      if (!operation.operationId) continue;
      lines.push(`## ${method.toUpperCase()} ${address.replaceAll('{', '&#123;')} {#${operation.operationId}}`, '', sentence(operation.summary) + sentence(operation.description));
      const parameters = [...(operations.parameters ?? []), ...(operation.parameters ?? [])].map((one) => resolve(one).node);
      lines.push(table(['parameter', 'in', 'type', 'meaning'], parameters.map((one) => [`${code(one.name)}${one.required ? ' (required)' : ''}`, one.in, cell(typeOf(resolve, one.schema, document)), cell(one.description ?? resolve(one.schema).node?.description)])));
      const body = operation.requestBody && resolve(operation.requestBody).node;
      if (body) lines.push(`Body: ${Object.keys(body.content).map(code).join(', ')}${body.required ? ', required' : ''}. ${cell(body.description)}`, '');
      const answers = Object.entries(operation.responses).map(([status, one]) => ({ status, ...resolve(one).node }));
      const generic = answers.filter(({ status, description }) => status >= '400' && description === 'What was wrong.');
      lines.push(table(['status', 'content', 'meaning'], answers.filter((one) => !generic.includes(one)).map(({ status, content = {}, description }) =>
        [status, Object.keys(content).map(code).join(', '), cell(description)])));
      if (generic.length) lines.push(`Errors: ${generic.map(({ status }) => status).join(', ')}, with a [code](/protocol/errors).`, '');
    }
  return `${lines.join('\n')}\n`;
}

/** @param {object} document asyncapi.json @param {(name: string) => object} schema reads a schema of the protocol */
export function asyncapi(document, schema) {
  const resolve = resolver(document, schema);
  const lines = ['# Message reference', '', 'Made of `asyncapi.json`, which the daemon serves as <a href="/v1/asyncapi.json" target="_self">/v1/asyncapi.json</a>, and of the schemas that it refers to. What the messages mean: [WebSocket](/protocol/websocket).', ''];
  for (const [side, title] of [['client', 'Messages of the client'], ['server', 'Messages of the server']]) {
    lines.push(`## ${title}`, '');
    for (const [name, message] of Object.entries(document.components.messages)) {
      if (!name.startsWith(`${side}.`)) continue;
      const type = name.slice(side.length + 1);
      lines.push(`### ${type} {#${side}-${type}}`, '', sentence(message.summary ?? message.description));
      if (!message.payload) continue;
      const { node, home } = resolve(message.payload.schema ?? message.payload);
      lines.push(node.description && node.description !== message.summary ? sentence(node.description) : '');
      const needed = node.required ?? [];
      lines.push(table(['member', 'type', 'meaning'], Object.entries(node.properties ?? {}).filter(([member]) => member !== 'type').map(([member, raw]) =>
        [`${code(member)}${needed.includes(member) ? ' (required)' : ''}`, cell(typeOf(resolve, raw, home)), cell(resolve(raw, home).node?.description)])));
    }
  }
  return `${lines.join('\n')}\n`;
}

/** @param {object} manifest custom-elements.json */
export function elementApi(manifest) {
  const [element] = manifest.modules[0].declarations;
  const fields = element.members.filter(({ kind }) => kind === 'field'), methods = element.members.filter(({ kind }) => kind === 'method');
  const shown = (one) => cell(one.description).replace(/\]\([^)]*\)/g, ']').replace(/\[([^\]]*)\]/g, '$1');
  return [
    '# Types of the element', '',
    'Made of <a href="/custom-elements.json" target="_self">custom-elements.json</a>, the custom elements manifest that editors read. What each does: [Attributes, methods, events](/element/reference).', '',
    '## Attributes', '', table(['attribute', 'property', 'type', 'meaning'], element.attributes.map((one) => [code(one.name), code(one.fieldName), code(one.type?.text), shown(one)])),
    '## Properties', '', table(['property', 'type', 'meaning'], fields.map((one) => [code(one.name), code(one.type?.text), shown(one)])),
    '## Methods', '', ...methods.map((one) => {
      const list = (one.parameters ?? []).map((p) => `${p.rest ? '...' : ''}${p.name}${p.optional ? '?' : ''}: ${p.type?.text ?? 'unknown'}`).join(', ');
      return `### ${one.name} {#method-${one.name}}\n\n\`\`\`ts\n${one.name}(${list}): ${one.return?.type?.text ?? 'void'}\n\`\`\`\n\n${sentence(one.description)}`;
    }),
    '## Events', '', table(['event', 'type', 'when'], element.events.map((one) => [code(one.name), code(one.type?.text), shown(one)])),
    '## Parts', '', table(['part', 'what it is'], element.cssParts.map((one) => [code(one.name), shown(one)])),
    '## Custom properties', '', table(['property', 'of'], element.cssProperties.map((one) => [code(one.name), shown(one)])),
  ].join('\n');
}

const fence = (text) => `\`\`\`txt\n${text.trimEnd()}\n\`\`\`\n`;

/** @param {Record<string, {help: string, commands?: Record<string, string>}>} help what help.mjs wrote */
export function commandLine(help) {
  const lines = ['# Command line', '', 'What each program says when it is asked for `--help`.', ''];
  for (const [program, { help: text, commands = {} }] of Object.entries(help)) {
    lines.push(`## ${program}`, '', fence(text));
    for (const [command, words] of Object.entries(commands)) lines.push(`### ${program} ${command}`, '', fence(words));
  }
  return lines.join('\n');
}

/** @param {Record<string, {help: string}>} help what help.mjs wrote */
export function settings(help) {
  const { facciad: { help: text } } = help;
  const option = /^ {2,6}(?:-\w, )?--([a-z0-9-]+)(?: (\S+))?\s+(.*?)/;
  const fallback = / \(((?:[^()]|\([^()]*\))*)\)/, member = / \[([a-z0-9_.]+)\]/;
  const rows = [...text.matchAll(new RegExp(`${option.source}(?:${fallback.source})?(?:${member.source})$`, 'gm'))];
  const groups = new Map();
  for (const row of rows) {
    const [name] = row[5].split('.');
    groups.set(name, [...(groups.get(name) ?? []), row]);
  }
  return [
    '# Settings', '',
    'Made of what `facciad --help` says. Each setting is an option (`--port 9000`), a variable of the environment (`FACCIA_PORT=9000`) and a member of the file that `--config` names',
    '(`{"listen": {"port": 9000}}`). Options override the environment, which overrides the file. `facciad --print-config` prints the settings in force as such a file, `facciad --print-schema` its JSON Schema.', '',
    ...[...groups].map(([name, list]) => `## ${name}\n\n${table(['option', 'member', 'default', 'meaning'], list.map(([, name, value, meaning, usual, at]) =>
      [code(`--${name}${value ? ` ${value}` : ''}`), code(at), code(usual), cell(meaning)]))}`),
  ].join('\n');
}
