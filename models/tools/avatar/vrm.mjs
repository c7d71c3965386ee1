// SPDX-License-Identifier: GPL-3.0-or-later
/** Turns a GLB into a VRM 1.0 avatar (github.com/vrm-c/vrm-specification, VRMC_vrm-1.0): licence, bones, expressions. */
import { ARKIT, MOODS } from './shapes.mjs';

/** VRM's expressions as weights of shapes; bones direct the eyes, but the gaze expressions exist for applications that use them. */
const PRESETS = {
  aa: { viseme_aa: 1 },
  ih: { viseme_I: 1 },
  ou: { viseme_U: 1 },
  ee: { viseme_E: 1 },
  oh: { viseme_O: 1 },
  blink: { eyeBlinkLeft: 1, eyeBlinkRight: 1 },
  blinkLeft: { eyeBlinkLeft: 1 },
  blinkRight: { eyeBlinkRight: 1 },
  lookUp: { eyeLookUpLeft: 1, eyeLookUpRight: 1 },
  lookDown: { eyeLookDownLeft: 1, eyeLookDownRight: 1 },
  lookLeft: { eyeLookOutLeft: 1, eyeLookInRight: 1 },
  lookRight: { eyeLookInLeft: 1, eyeLookOutRight: 1 },
  neutral: {},
  ...MOODS,
};

/** An expression's binds: every mesh that has the shape. */
function binds(weights, meshes) {
  return Object.entries(weights).flatMap(([shape, weight]) =>
    meshes.filter((mesh) => mesh.moving.has(shape)).map((mesh) => ({ node: mesh.node, index: mesh.targets.indexOf(shape), weight })),
  );
}

const expression = (weights, meshes) => ({
  isBinary: false,
  overrideBlink: 'none',
  overrideLookAt: 'none',
  overrideMouth: 'none',
  morphTargetBinds: binds(weights, meshes),
});

/**
 * @param {object} head @param {Object<string, number>} bones node by name
 * @param {{node: number, targets: string[], moving: Set<string>}[]} meshes
 */
export function vrm(head, bones, meshes, eyesFromHead) {
  const range = (outputScale) => ({ inputMaxValue: 90, outputScale });
  return {
    specVersion: '1.0',
    meta: {
      name: head.title,
      version: '1',
      authors: ['faccia', 'MakeHuman'],
      copyrightInformation: `${head.licence}. ${head.credits.join('; ')}`,
      licenseUrl: 'https://vrm.dev/licenses/1.0/',
      otherLicenseUrl: 'https://creativecommons.org/publicdomain/zero/1.0/',
      avatarPermission: 'everyone',
      allowExcessivelyViolentUsage: true,
      allowExcessivelySexualUsage: true,
      commercialUsage: 'corporation',
      allowPoliticalOrReligiousUsage: true,
      allowAntisocialOrHateUsage: true,
      creditNotation: 'unnecessary',
      allowRedistribution: true,
      modification: 'allowModificationRedistribution',
    },
    humanoid: { humanBones: Object.fromEntries(Object.entries(bones).map(([name, node]) => [name, { node }])) },
    lookAt: {
      type: 'bone',
      offsetFromHeadBone: eyesFromHead,
      rangeMapHorizontalInner: range(30),
      rangeMapHorizontalOuter: range(30),
      rangeMapVerticalDown: range(25),
      rangeMapVerticalUp: range(25),
    },
    expressions: {
      preset: Object.fromEntries(Object.entries(PRESETS).map(([name, weights]) => [name, expression(weights, meshes)])),
      // "perfect sync": applications that have ARKit's weights look for expressions of these names
      custom: Object.fromEntries(Object.keys(ARKIT).map((name) => [name, expression({ [name]: 1 }, meshes)])),
    },
  };
}
