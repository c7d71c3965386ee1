// SPDX-License-Identifier: MIT

const MOST = 4;

/**
 * Converts a mixture of affects to the protocol's form. Takes a list of {name, intensity}, an object {joy: 0.6}, or a
 * string "joy 0.6, surprise 0.2" (the default intensity is 1).
 * @returns {{name: string, intensity: number}[]} at most four, the strongest
 */
export function readMix(mix) {
  const parts = typeof mix === 'string' ? fromText(mix) : Array.isArray(mix) ? mix : fromObject(mix ?? {});
  return parts
    .map(({ name, intensity = 1 }) => ({ name: String(name), intensity: Math.min(1, Math.max(0, Number(intensity) || 0)) }))
    .filter(({ name, intensity }) => name && intensity > 0)
    .sort((a, b) => b.intensity - a.intensity)
    .slice(0, MOST);
}

const fromObject = (mix) => Object.entries(mix).map(([name, intensity]) => ({ name, intensity }));

function fromText(text) {
  return text.split(',').flatMap((part) => {
    const [, name, number] = /^\s*([\w-]+)(?:\s+([\d.]+))?\s*$/.exec(part) ?? [];
    return name ? [{ name, intensity: number === undefined ? 1 : Number(number) }] : [];
  });
}

/** As an attribute has it. @param {{name: string, intensity: number}[]} mix */
export const writeMix = (mix) => mix.map(({ name, intensity }) => `${name} ${intensity}`).join(', ');
