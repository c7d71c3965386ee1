// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of aligned phone boundaries against known ones.

/** Reduces a phone's name to its sound, so that names of two voices can be compared. */
const kind = (phone) => phone.ipa.replace(/[ː͡ˈˌ]/g, '').replace('ɹ', 'r').slice(0, 1);

/** Pairs equal phones of two lists, in order, by minimum edit distance. */
export function pairs(known, found) {
  const a = known.filter((p) => p.ipa), b = found.filter((p) => p.ipa);
  const cost = Array.from({ length: a.length + 1 }, () => new Float64Array(b.length + 1));
  const change = (i, j) => (kind(a[i - 1]) === kind(b[j - 1]) ? 0 : 1.5);
  for (let i = 0; i <= a.length; i++)
    for (let j = 0; j <= b.length; j++)
      cost[i][j] = !i ? j : !j ? i : Math.min(cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + change(i, j));
  const list = [];
  for (let i = a.length, j = b.length; i && j; ) {
    if (cost[i][j] === cost[i - 1][j - 1] + change(i, j)) {
      if (!change(i, j)) list.push([a[i - 1], b[j - 1]]);
      i--;
      j--;
    } else if (cost[i][j] === cost[i - 1][j] + 1) i--;
    else j--;
  }
  return list.reverse();
}

/** Errors of phone starts: {phones, pairs, median, p90 (ms), within50 (share)}. */
export function errors(known, found) {
  const list = pairs(known, found);
  const ms = list.map(([a, b]) => Math.abs(a.start - b.start) * 1000).sort((x, y) => x - y);
  return {
    phones: known.filter((p) => p.ipa).length,
    pairs: ms.length,
    median: ms[Math.floor(ms.length / 2)],
    p90: ms[Math.floor(ms.length * 0.9)],
    within50: ms.filter((x) => x <= 50).length / ms.length,
  };
}

const CLASSES = [
  ['affricate', /^(t͡?ʃ|d͡?ʒ|tʃ|dʒ|ts|dz|CH|JH|t_S|d_Z|ch|sch|t_s|tS|dZ)$/], ['lip stop', /^([pb]ː?|pp|bb|P|B|[pb]ʰ|[pb]ʲ)$/], ['tip stop', /^([tdʈɖ]ː?|tt|dd|T|D|[td]ʰ|[td]ʲ|c|ɟ|J\\)$/],
  ['back stop', /^([kgɡ]ː?|kk|gg|K|G|kʰ|[kɡ]ʲ)$/], ['teeth', /^([fv]ː?|ff|vv|F|V|[fv]ʲ)$/], ['hiss', /^([szʃʒʂʐɕʑ]ː?|ss|zz|S|Z|SH|ZH|sh|zh|[sz]ʲ|ɕː)$/],
  ['dental', /^(θ|ð|TH|DH)$/], ['m', /^(mː?|mm|M|mʲ)$/], ['n', /^([nŋɲ]ː?|nn|N|NG|nʲ)$/], ['l', /^([lɫʎ]ː?|ll|L|lʲ|ɫ̩)$/], ['r', /^([rɹɾʀʁɻ]ː?|rr|R|rʲ|P\\|r̝|r̝̊)$/],
  ['glide', /^([wj]|W|Y)$/], ['h', /^([hxɦɣ]ʲ?|HH|hh|X)$/],
];
/** Reduces the name of a phone, in IPA, ARPAbet, SAMPA or festvox-ru's names, to a class that most readings share; '' for none. */
export function soundClass(name) {
  const plain = name.replace(/[ˈˌ]/g, '').replace(/(?<=[A-Z])\d$/, '');
  if (!plain || /^(pau|sp|sil|H)$/.test(plain)) return '';
  return CLASSES.find(([, names]) => names.test(plain))?.[0] ?? 'vowel';
}
