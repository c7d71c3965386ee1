// SPDX-License-Identifier: MIT
/**
 * Poses that show a person's own way of moving: the informative ones of Leone's thesis ("LUCIA-WebGL", 3.3), and some more.
 * Each has the unknowns of model.mjs that move in it; its FAPs and their greatest strength, as in models/expressions.json and
 * models/pictures/poses.json; and the instruction for the person.
 */

/** "6 7: 20; 3: -5" */
const faps = (text) => Object.fromEntries(text.split('; ').flatMap((one) => {
  const [list, value] = one.split(': ');
  return list.split(' ').map((fap) => [fap, Number(value)]);
}));
const [UPPER, LOWER, WIDE, UP] = ['4 8 9 51 55 56', '5 10 11 52 57 58', '6 7 53 54', '12 13 59 60'];
/** Mouths of models/pictures/poses.json, without the tongue. */
const VISEMES = {
  joy: '3: 120; 4: -220; 5: -100; 6 53: 168; 7 54: 152; 8: -284; 9: -257; 10: -84; 11: -76; 12 59: 368; 13 60: 333; 51: -187; 52: -85; 55: -241; 56: -218; 57: -71; 58: -65',
  surprise: '3: 620; 4: -50; 5: -590; 6 7 53 54: -70; 8 9: -30; 10 11: -450; 12 13 59 60: -190; 51: -43; 52: -502; 55 56: -26; 57 58: -383',
  o: '3: 387; 4: -46; 5: -426; 6 7: -88; 8 9: 119; 10 11: -209; 12 13 59 60: -54; 16: 67; 17: 103; 18: 17; 51: -102; 52: -266; 53 54: -26; 55 56: -12; 57 58: -117',
  p1: '3: 171; 4: -19; 5: 34; 6 7 53 54: 16; 8 9: -11; 10 11: 25; 12 13 59 60: -16; 16: -18; 17: -36; 18: 46; 51: 84; 52: 186; 55 56: 80; 57 58: 164',
  a: '3: 503; 4: -107; 5: -480; 6 7 53 54: 13; 8 9: -71; 10 11: -398; 12 13 59 60: -57; 16: -10; 17: -6; 51: -84; 52: -340; 55 56: -58; 57 58: -279',
  e: '3: 301; 4: -98; 5: -416; 6 7 53 54: 20; 8 9: -68; 10 11: -344; 12 13 59 60: -30; 16: -17; 17: -23; 51: -80; 52: -282; 55 56: -57; 57 58: -228',
  i1: '3: 177; 4: -69; 5: -341; 6 7 53 54: 42; 8 9: -43; 10 11: -285; 12 13 59 60: -9; 16: -37; 17: -56; 51: -65; 52: -194; 55 56: -46; 57 58: -152',
  u: '3: 298; 4: -25; 5: -339; 6 7: -97; 8 9: 114; 10 11: -179; 12 13 59 60: -46; 16: 103; 17: 146; 18: 25; 51: -82; 52: -204; 53 54: -35; 55 56: -13; 57 58: -99',
  f1: '3: 122; 4 10 11: -59; 5: -73; 6 7 53 54: 12; 8 9: -47; 12 13 59 60: -11; 16: -149; 17: -25; 18: 47; 51: -51; 52: 154; 55 56: -43; 57 58: 165',
};
/** @param {string} name of models/pictures/poses.json */
export const viseme = (name) => faps(VISEMES[name]);
export const VISEMES_TAKEN = Object.keys(VISEMES);

const BROWS = ['browInnerLeft', 'browInnerRight', 'browMiddleLeft', 'browMiddleRight', 'browOuterLeft', 'browOuterRight'];
const SQUEEZE = ['squeezeLeft', 'squeezeRight'];
const CORNERS = ['cornerLeft', 'cornerRight', 'aside'];
const CHEEKS = ['cheekLeft', 'cheekRight'];
const NOSE = ['nostrilLeft', 'nostrilRight', 'noseUp'];
const LIPS = ['LI', 'LS', 'AR', 'PI', 'PS', 'thinUpper', 'thinLower'];
const OPEN = [...LIPS, 'EM', ...CORNERS];

const pose = (moves, asked, ask) => ({ moves, faps: typeof asked === 'string' ? faps(asked) : asked, ask });
export const POSES = {
  'brows-up': pose([...BROWS, ...SQUEEZE], '31 32: 110; 33 34: 130; 35 36: 90', 'brows as high as they go'),
  'brows-down': pose([...BROWS, ...SQUEEZE], '31 32: -95; 33 34: -70; 35 36: -25; 37 38: 45', 'brows down and together'),
  sneer: pose([...BROWS, ...SQUEEZE, ...NOSE, ...CHEEKS, ...CORNERS, ...LIPS],
    `${UPPER}: -150; 61 62: 40; 63: 60; 41 42: 90; 31 32: -60`, 'nose wrinkled, upper lip up'),
  smile: pose([...CORNERS, ...CHEEKS, ...LIPS], `${UP}: 360; ${WIDE}: 150; 41 42: 130`, 'a broad smile, lips closed'),
  laugh: pose([...OPEN, ...CHEEKS], { ...viseme('joy'), 41: 130, 42: 130 }, 'a broad smile that shows the teeth'),
  sad: pose([...CORNERS, ...BROWS, ...SQUEEZE, ...LIPS],
    `${UP}: -210; 31 32: 300; 33 34: 60; 35 36: -110; 37 38: 40`, 'corners of the mouth down, inner ends of the brows up'),
  'mouth-left': pose([...CORNERS, ...LIPS], '6 53: 150; 7 54: -150', 'the closed mouth to your left'),
  'mouth-right': pose([...CORNERS, ...LIPS], '6 53: -150; 7 54: 150', 'the closed mouth to your right'),
  open: pose(OPEN, viseme('surprise'), 'the mouth wide open'),
  funnel: pose(OPEN, viseme('o'), 'a long O'),
  kiss: pose([...LIPS, ...CORNERS], `${WIDE}: -140; 16: 170; 17: 220`, 'a kiss'),
  teeth: pose([...LIPS, ...CORNERS, ...CHEEKS], `${UPPER}: -200; ${LOWER}: -180; ${WIDE}: 90`, 'teeth together and bared'),
  dimple: pose([...LIPS, ...CORNERS], `${WIDE}: 150`, 'lips closed and drawn aside'),
  m: pose([...LIPS, ...CORNERS], viseme('p1'), 'lips pressed, as for M'),
  a: pose(OPEN, viseme('a'), 'a long A'),
  e: pose(OPEN, viseme('e'), 'a long E'),
  i: pose(OPEN, viseme('i1'), 'a long I'),
  u: pose(OPEN, viseme('u'), 'a long U'),
  f: pose(OPEN, viseme('f1'), 'a long F'),
};

/** Poses of the thesis that are left out, with the reason. */
export const LEFT_OUT = Object.fromEntries([
  ['puff', 'the front does not show cheeks that come forward'],
  ['jaw-front', 'the front does not show a jaw that comes forward'],
  ...['lip-down', 'jaw-left', 'jaw-right', 'chew'].map((name) =>
    [name, "jaw and the middle of the lips keep the base's way"]),
]);

/** @param {string} word for example a file's name @returns {string|null} the pose of that name, left out or not */
export function nameOf(word) {
  const name = word.toLowerCase().replace(/[ _]/g, '-');
  return Object.hasOwn(POSES, name) || Object.hasOwn(LEFT_OUT, name) ? name : null;
}
