// SPDX-License-Identifier: GPL-3.0-or-later
/** Builds a head in the format of protocol/head-model.md from a recipe. */
import { Actions } from '../lib/actions.mjs';
import { eyeActions, lidWeights } from './actions/act-eyes.mjs';
import { faceActions } from './actions/act-face.mjs';
import { headTurns } from './actions/act-head.mjs';
import { jawActions } from './actions/act-jaw.mjs';
import { mouthActions } from './actions/act-mouth.mjs';
import { mouthFigures, placeTeeth, placeTongue } from '../lib/anatomy.mjs';
import { cutCavity } from './cavity.mjs';
import { makeTeeth } from './teeth.mjs';
import { tongueActions } from './actions/act-tongue.mjs';
import { readBase } from './assets.mjs';
import { layOut, packIslands } from './atlas.mjs';
import { lowered, warpParts } from './body/arms.mjs';
import { applyBreath, breathing } from './body/breath.mjs';
import { modelNeck } from './body/neck.mjs';
import { thickened } from './body/thicken.mjs';
import { layCollar } from './collar.mjs';
import { growHair } from './hair/grow.mjs';
import { eyePart } from '../lib/eye.mjs';
import { readTopology } from '../lib/hm08.mjs';
import { addMoustache } from './moustache.mjs';
import { measureUnits, pointOf, readLandmarks } from '../lib/landmarks.mjs';
import { groupVertices } from '../lib/mesh.mjs';
import { roundLobes } from './lobes.mjs';
import { mouthGrid } from './mouth-grid.mjs';
import { closeLips, setLids } from './neutral.mjs';
import { packHead } from '../lib/pack.mjs';
import { applyActions, applyHeadTurns, proxyPart, skinPart } from '../lib/parts.mjs';
import { alongLips, refine, rounded, skinDetail } from './refine.mjs';
import { buildShape, targetInMm } from './shape.mjs';
import { makeTextures, opacityOf } from './paint/textures.mjs';
import { addWisps } from './wisps.mjs';

/** The parts that every head has; all others are proxies, too: clothes, a beard, glasses. */
const ALWAYS = ['skin', 'hair', 'eye_l', 'eye_r', 'teeth_upper', 'teeth_lower', 'tongue', 'mouth', 'lashes', 'brows'];
const HAIR_AT = 6; // its place among the parts

/** Parts with a body. */
const BREATHES = ['skin', 'clothes'];

/** Smaller displacements (mm per mm of the FAP) are omitted. */
const LEAST_MOVE = 2e-3;

/** Defaults for the inside of the mouth. */
const CAVITY = { follows: true, material: 'mouth' };
const CAVITY_LOOK = { color: [0.4, 0.15, 0.13], roughness: 0.4, specular: 0.3, alpha: 'opaque', double_sided: false, subsurface: 0.3 };

export async function buildHead(assets, given) {
  const recipe = {
    ...given,
    parts: { mouth: CAVITY, ...given.parts },
    materials: { mouth: CAVITY_LOOK, ...given.materials },
  };
  const base = readBase(assets);
  const topology = readTopology(base);
  const { p, eyes } = buildShape(assets, base, recipe);
  const ctx = makeContext(assets, base, topology, p, eyes);

  ctx.grid = gridOf(ctx, recipe);
  closeLips(p, topology, ctx.grid, recipe.faps.mouth.tuck);
  Object.assign(ctx, readLandmarks(base, topology, p, recipe));
  roundLobes(p, ctx.inGroup('body'), ctx.fdp);
  for (const side of ['l', 'r'])
    setLids(ctx, side, lidWeights(ctx, side, recipe.faps.lids), recipe.eyes.opening);
  Object.assign(ctx, readLandmarks(base, topology, p, recipe));
  const eyeSpec = eyeGeometry(recipe.eyes, eyes.radius - recipe.eyes.inset);
  ctx.fdp['3.5'] = [eyes.l[0], eyes.l[1], eyes.l[2] + eyeSpec.radius + eyeSpec.bulge];
  ctx.fdp['3.6'] = [eyes.r[0], eyes.r[1], eyes.r[2] + eyeSpec.radius + eyeSpec.bulge];
  ctx.fapu = measureUnits(ctx.fdp);
  ctx.grid = gridOf(ctx, recipe);
  ctx.figures = mouthFigures(recipe);
  ctx.teeth = placeTeeth(ctx, ctx.figures);
  placeTongue(ctx, ctx.fdpVertex['6.1'], ctx.teeth);
  Object.assign(ctx.fdp, tongueLandmarks(ctx, recipe));

  const actions = new Actions(ctx);
  jawActions(actions, ctx, ctx.grid, recipe.faps.jaw);
  mouthActions(actions, ctx, ctx.grid, recipe.faps.mouth);
  eyeActions(actions, ctx, recipe.faps.lids);
  faceActions(actions, ctx, recipe.faps.face);
  tongueActions(actions, ctx, recipe.faps.tongue);
  const head = headTurns(ctx, recipe.faps.head);

  ctx.warp = lowered(ctx, recipe.body.arms);
  const parts = makeParts(ctx, recipe, eyeSpec);
  warpParts(parts, ctx.warp);
  parts.forEach(({ name }, i) => {
    if (recipe.parts[name].hem) parts[i] = thickened(parts[i], recipe.parts[name].hem);
  });
  parts[0] = refine(parts[0], skinDetail(ctx, parts[0], recipe.parts.skin), alongLips(topology.mouth));
  parts[0] = modelNeck(parts[0], ctx, parts.find(({ name }) => name === 'clothes'), recipe.skin.neck);
  if (recipe.parts.hair.grown) parts.splice(HAIR_AT, 0, growHair(parts[0], parts.filter(({ name }) => name === 'clothes'), ctx.fdp, recipe.parts.hair.grown));
  layOut(parts[0], recipe.skin.atlas);
  const [whole] = parts;
  parts.splice(0, 1, ...cutCavity(ctx, whole));
  for (const [i, { name }] of parts.entries()) {
    const { longestEdge, material } = recipe.parts[name];
    if (longestEdge && name !== 'skin') parts[i] = rounded(parts[i], longestEdge);
    parts[i] = await haired(parts[i], parts[0], recipe, ctx);
    if (recipe.textures[recipe.materials[material]?.texture]?.paint === 'cloth') packIslands(parts[i]);
  }
  for (const part of parts) {
    if (recipe.parts[part.name].follows) applyActions(part, actions, LEAST_MOVE);
    applyHeadTurns(part, head);
    if (BREATHES.includes(part.name)) applyBreath(part, breathing(ctx));
    part.material = recipe.parts[part.name].material;
  }
  const textures = await makeTextures({ ctx, recipe, parts: [whole, ...parts.slice(1)], eyeSpec });
  const materials = Object.fromEntries(Object.entries(recipe.materials).filter(([, m]) => m));
  return packHead({
    recipe,
    fapu: ctx.fapu,
    fdp: ctx.fdp,
    figures: ctx.figures,
    turns: [...actions.turns, ...head.turns],
    textures,
    materials,
    parts,
  });
}

/** Hair with its wisps, a beard with its moustache. */
async function haired(part, skin, recipe, ctx) {
  const { wisps, moustache, material } = recipe.parts[part.name];
  if (moustache) return addMoustache(part, skin, ctx.fdp, moustache);
  if (!wisps) return part;
  const texture = recipe.textures[recipe.materials[material].texture];
  return addWisps(part, skin, wisps, await opacityOf(texture, { ctx, parts: [{ ...part, material }] }, skin));
}

function makeContext(assets, base, topology, p, eyes) {
  const flags = new Map();
  return {
    assets,
    base,
    topology,
    p,
    eyes,
    point: (spec) => pointOf(base, p, spec),
    target: (name) => targetInMm(assets, name),
    inGroup(name) {
      if (!flags.has(name)) {
        const flag = new Uint8Array(p.length / 3);
        for (const v of groupVertices(base, name)) flag[v] = 1;
        flags.set(name, flag);
      }
      return flags.get(name);
    },
  };
}

function tongueLandmarks({ base, topology, p }, recipe) {
  const { fdp } = readLandmarks(base, topology, p, recipe);
  return Object.fromEntries(['6.1', '6.2', '6.3', '6.4'].map((name) => [name, fdp[name]]));
}

function gridOf(ctx, recipe) {
  const x = (name) => Math.abs(ctx.p[recipe.fdp[name] * 3]);
  const middle = {
    upper: { inner: x('2.6/2.7'), outer: x('8.5/8.6') },
    lower: { inner: x('2.8/2.9'), outer: x('8.7/8.8') },
    cornerInner: x('2.4/2.5'),
    cornerOuter: x('8.3/8.4'),
  };
  return mouthGrid(ctx.topology, ctx.p, middle, recipe.faps.mouth.reach);
}

/** Angles at the eyeball from the widths in mm that the recipe gives. */
function eyeGeometry(eyes, radius) {
  const half = (width) => Math.asin(width / 2 / (radius + eyes.bulge * 0.6));
  const irisAngle = half(eyes.iris),
    pupilAngle = half(eyes.iris * eyes.pupil);
  const inside = Array.from({ length: 4 }, (_, i) => (pupilAngle * (i + 1)) / 4);
  const iris = Array.from({ length: 5 }, (_, i) => pupilAngle + ((irisAngle - pupilAngle) * (i + 1)) / 5);
  const white = Array.from({ length: 9 }, (_, i) => irisAngle + ((eyes.span - irisAngle) * (i + 1)) / 9);
  return {
    ...eyes,
    radius,
    irisAngle,
    pupilAngle,
    bulgeAngle: irisAngle * 1.25,
    rings: [...inside, ...iris, ...white],
  };
}

const laid = (ctx, part, { collar }) => (collar ? layCollar(part, ctx, collar) : part);

function makeParts(ctx, recipe, eyeSpec) {
  const spec = recipe.parts;
  const others = Object.keys(spec).filter((name) => !ALWAYS.includes(name));
  const worn = others.map((name) => laid(ctx, proxyPart(ctx, name, spec[name]), spec[name]));
  const clothes = worn.find((part) => part.name === 'clothes');
  const skin = skinPart(ctx, spec.skin, clothes?.proxy.hides);
  return [
    skin,
    eyePart('eye_l', ctx.eyes.l, eyeSpec, { thrust: 27, dilate: 29 }),
    eyePart('eye_r', ctx.eyes.r, eyeSpec, { thrust: 28, dilate: 30 }),
    ...makeTeeth(ctx, ctx.figures, ctx.teeth),
    proxyPart(ctx, 'tongue', spec.tongue),
    ...(spec.hair.grown ? [] : [proxyPart(ctx, 'hair', spec.hair)]), // what is grown stands on the refined skin
    proxyPart(ctx, 'brows', spec.brows),
    proxyPart(ctx, 'lashes', spec.lashes),
    ...worn,
  ];
}
