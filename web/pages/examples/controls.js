// SPDX-License-Identifier: MIT
// Creates fields for attributes and custom properties from their entries in custom-elements.json.

/** Details that the types lack: bounds of numbers and lengths, initial colours. */
export const RANGES = {
  rate: { min: 60, max: 400, step: 10 },
  life: { min: 0, max: 2, step: 0.1 },
  '--talking-head-caption-size': { min: 0.8, max: 3, step: 0.1, unit: 'rem' },
  '--talking-head-said-strength': { min: 40, max: 100, step: 1, unit: '%' },
};
const COLOURS = {
  '--talking-head-caption-background': '#101014', '--talking-head-caption-color': '#ffffff',
  '--talking-head-word-background': '#ffd60a', '--talking-head-word-color': '#101014',
};

/**
 * @param {{name: string, type?: {text: string}}} about of the manifest
 * @returns {{kind: 'select'|'checkbox'|'range'|'color'|'text', choices?: string[], min?: number, max?: number, step?: number,
 *   unit?: string}}
 */
export function controlOf({ name, type }) {
  const text = type?.text ?? '';
  const choices = [...text.matchAll(/'([^']+)'/g)].map(([, choice]) => choice);
  if (RANGES[name]) return { kind: 'range', ...RANGES[name] };
  if (/^--.*-(color|background)$/.test(name)) return { kind: 'color' };
  if (text === 'boolean') return { kind: 'checkbox' };
  if (text === 'boolean | null') return { kind: 'select', choices: ['on', 'off'] };
  return choices.length ? { kind: 'select', choices } : { kind: 'text' };
}

/** Returns the text of an attribute, or the value of a custom property; null: not set. */
export const valueOf = (head, name) => (name.startsWith('--') ? head.style.getPropertyValue(name).trim() || null : head.getAttribute(name));

export function setValue(head, name, value) {
  if (name.startsWith('--')) head.style.setProperty(name, value ?? '');
  else if (value === null) head.removeAttribute(name);
  else head.setAttribute(name, value);
}

const made = (tag, properties, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};

function input(head, { fieldName }, { kind, choices, unit = '', ...range }) {
  if (kind === 'select') return made('select', {}, new Option('(not set)', ''), ...choices.map((choice) => new Option(choice)));
  const field = made('input', { type: kind, ...range });
  if (kind === 'text') Object.assign(field, { autocomplete: 'off', spellcheck: false, autocapitalize: 'none' });
  if (kind === 'range') field.dataset.unit = unit;
  // without the attribute, the property's default applies, and some are on by default
  if (kind === 'checkbox') field.dataset.without = String(head.cloneNode()[fieldName]);
  return field;
}

/** Reads a field as a value for the element. */
function read(field, name) {
  if (field.type === 'checkbox') return field.checked === (field.dataset.without === 'true') ? null : field.checked ? 'on' : 'off';
  if (field.type === 'range') return field.value + field.dataset.unit;
  return field.value === '' && name !== 'label' ? null : field.value;
}

function show(field, value, name) {
  if (field.type === 'checkbox') field.checked = value === null ? field.dataset.without === 'true' : !['off', 'false'].includes(value);
  else if (field.type === 'range') field.value = value === null ? (Number(field.min) + Number(field.max)) / 2 : parseFloat(value);
  else field.value = value ?? COLOURS[name] ?? '';
}

/** Removes Markdown syntax. */
const plain = (text) => text.replaceAll('`', '').replace(/\[([^\]]+)\]\([^)]+\)/g, '$1');

/**
 * @param {HTMLElement} head @param {object[]} abouts attributes and custom properties of the manifest
 * @param {Record<string, string[]>} known choices for text values, from the server
 * @returns {{nodes: Node[], refresh: () => void}} the fields; refresh: shows what the element has
 */
export function controls(head, abouts, known) {
  const shown = abouts.map((about) => {
    const control = controlOf(about);
    const field = input(head, about, control);
    const id = `control-${about.name.replace(/^--/, '')}`;
    const value = made('output', { className: 'value' });
    const hint = made('p', { id: `${id}-hint`, className: 'hint', textContent: plain(about.description) });
    Object.assign(field, { id, name: about.name });
    field.setAttribute('aria-describedby', hint.id);
    if (known[about.name]) {
      field.setAttribute('list', `${id}-known`);
      hint.append(made('datalist', { id: `${id}-known` }, ...known[about.name].map((one) => new Option(one, one))));
    }
    field.addEventListener(field.type === 'text' ? 'change' : 'input', () => setValue(head, about.name, read(field, about.name)));
    const label = made('label', { htmlFor: id, className: 'field' }, made('span', {}, made('code', { textContent: about.name }), ' ', value), field);
    return { about, field, value, node: made('div', { className: 'control' }, label, hint) };
  });
  const refresh = () => {
    for (const { about: { name }, field, value } of shown) {
      const now = valueOf(head, name);
      if (field !== document.activeElement || field.type !== 'text') show(field, now, name);
      value.textContent = now === null ? 'not set' : field.type === 'range' ? now : '';
    }
  };
  refresh();
  return { nodes: shown.map(({ node }) => node), refresh };
}
