// SPDX-License-Identifier: GPL-3.0-or-later
// A second reading of MPEG-4's FAP interpolation tables, by fields taken out of the text with regular expressions and functions built
// once as closures; shares nothing with protocol/fba/fapfit_*.c.

/** @param {string} text a FIT node in braces @returns {(frame: Map<number, number>) => Map<number, number>} indices 3 to 75 */
export function fitOf(text) {
  const list = (name) => (new RegExp(`\\b${name}\\s*\\[([^\\]]*)\\]`, 'i').exec(text)?.[1] ?? '').split(/[\s,]+/).filter(Boolean).map(Number);
  const sets = list('FAPs').join(' ').split(' -1').map((part) => part.trim()).filter(Boolean).map((part) => part.split(' ').map(Number));
  const graph = list('Graph');
  const [up, down] = [list('numeratorTerms'), list('denominatorTerms')];
  const [upExp, downExp, impulses, upCoefs, downCoefs] = ['numeratorExp', 'denominatorExp', 'numeratorImpulse', 'numeratorCoefs', 'denominatorCoefs'].map(list);
  const sumOf = (count, coefs, exps, parent, high) => {
    const terms = Array.from({ length: count }, () => ({ c: coefs.shift(), e: parent.map(() => exps.shift()), when: high ? [impulses.shift(), impulses.shift()] : null }));
    return (frame) => terms.reduce((sum, { c, e, when }) => sum + (when && frame.get(when[0]) !== when[1] ? 0 : c * e.reduce((product, power, i) => product * frame.get(parent[i]) ** power, 1)), 0);
  };
  const links = [];
  for (let i = 0; i < graph.length; i += 2) {
    const [parent, child] = [sets[graph[i] - 1], sets[graph[i + 1] - 1]];
    const high = parent.some((n) => n > 68);
    links.push({ parent, to: graph[i + 1] - 1, functions: child.map((n) => {
      const [a, b] = [up.shift(), down.shift()];
      const above = sumOf(a, upCoefs, upExp, parent, high);
      const below = b ? sumOf(b, downCoefs, downExp, parent, false) : () => 1;
      return [n, (frame) => above(frame) / below(frame)];
    }) });
  }
  return (given) => {
    const frame = new Map(given);
    const open = new Set(sets.keys());
    for (let changed = true; changed; ) {
      changed = false;
      for (const s of [...open]) {
        const link = sets[s].every((n) => frame.has(n)) ? null : links.find(({ parent, to }) => to === s && parent.every((n) => frame.has(n)));
        if (!link) continue;
        open.delete(s);
        changed = true;
        const found = link.functions.filter(([n]) => !frame.has(n)).map(([n, f]) => [n, f(frame)]);
        for (const [n, value] of found) if (Number.isFinite(value)) frame.set(n, Math.sign(value) * Math.round(Math.abs(value)));
      }
    }
    return frame;
  };
}
