// SPDX-License-Identifier: MIT
// Texts of each page by language. The bundler keeps those that a page imports.
import * as it from './it.js';
import * as pt from './pt.js';
import * as tr from './tr.js';
import * as en from './en.js';

export const shared = { it: it.shared, pt: pt.shared, tr: tr.shared, en: en.shared };
export const errors = { it: it.errors, pt: pt.errors, tr: tr.errors, en: en.errors };
export const speak = { it: it.speak, pt: pt.speak, tr: tr.speak, en: en.speak };
export const avatar = { it: it.avatar, pt: pt.avatar, tr: tr.avatar, en: en.avatar };
export const coach = { it: it.coach, pt: pt.coach, tr: tr.coach, en: en.coach };
export const editor = { it: it.editor, pt: pt.editor, tr: tr.editor, en: en.editor };
export const emotion = { it: it.emotion, pt: pt.emotion, tr: tr.emotion, en: en.emotion };
export const library = { it: it.library, pt: pt.library, tr: tr.library, en: en.library };
export const mirror = { it: it.mirror, pt: pt.mirror, tr: tr.mirror, en: en.mirror };
export const operator = { it: it.operator, pt: pt.operator, tr: tr.operator, en: en.operator };
export const player = { it: it.player, pt: pt.player, tr: tr.player, en: en.player };
export const room = { it: it.room, pt: pt.room, tr: tr.room, en: en.room };
export const sayings = { it: it.sayings, pt: pt.sayings, tr: tr.sayings, en: en.sayings };
export const voices = { it: it.voices, pt: pt.voices, tr: tr.voices, en: en.voices };
