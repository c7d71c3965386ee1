#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Builds a hairstyle for portraits: make-wear.mjs RECIPE.json OUTPUT.json [--modules DIR]. The recipe is that of a head that wears it (models/wear).
 * Writes OUTPUT.json, which has the hair and where on the skull it sits but no face (web/portrait/dress.mjs), and the picture of a head with it, OUTPUT.webp.
 */
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { readModel } from '../../../web/element/head/model/model.mjs';
import { placesOf } from '../../../web/portrait/dress.mjs';
import { openAssets } from '../head/assets.mjs';
import { buildHead } from '../head/head.mjs';
import { readRecipe } from '../head/recipe.mjs';
import { drawPoster } from '../lib/poster.mjs';

const SMALLER = 4; // by how much the textures of what is only seen in the picture are smaller than a head's
const FEWER = 12; // directions from which light reaches its skin
const KEPT = ['format', 'version', 'name', 'title', 'about', 'licence', 'credits', 'fapu', 'fdp'];

const here = path.dirname(fileURLToPath(import.meta.url));
const [recipeFile, outFile, option, modules = path.join(here, '../..')] = process.argv.slice(2);
if (!outFile || (option && option !== '--modules')) {
  console.error('usage: make-wear.mjs RECIPE.json OUTPUT.json [--modules DIR]');
  process.exit(2);
}
const short = (x) => Math.round(10 * x) / 10;

const recipe = readRecipe(recipeFile);
for (const [name, texture] of Object.entries(recipe.textures)) if (name !== 'hair') texture.size /= SMALLER;
recipe.skin.occlusion.directions = FEWER;
for (const word of ['beard', 'glasses']) for (const place of ['parts', 'textures', 'materials']) delete recipe[place][word];
const head = await buildHead(openAssets(modules), recipe);
const { skull } = placesOf(readModel(head));
const parts = head.parts.filter(({ name }) => name.startsWith('hair'));
const materials = Object.fromEntries(parts.map(({ material }) => [material, head.materials[material]]));
const textures = Object.fromEntries(Object.values(materials).map(({ texture }) => [texture, head.textures[texture]]));
const turns = head.turns.filter(({ name }) => parts.some((part) => part.turns.some(({ turn }) => turn === name)));
const kept = Object.fromEntries(KEPT.map((key) => [key, head[key]]));
fs.writeFileSync(outFile, JSON.stringify({ ...kept, skull: skull.map((p) => p && p.map(short)), turns, textures, materials, parts }));
fs.writeFileSync(outFile.replace(/(\.json)?$/, '.webp'), await drawPoster(head));
