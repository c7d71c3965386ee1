// SPDX-License-Identifier: MIT
// Made by protocol/make-messages.py from protocol/messages.json: change that.

/** Attributes that are defaults of `speak`, with what their text is. */
export const SPEAK_ATTRIBUTES = {
  lang: String,
  voice: String,
  markup: String,
  rate: Number,
  life: Number,
  blend: String,
  contacts: String,
  normalize: String,
};
