// SPDX-License-Identifier: MIT
// Made by protocol/make-messages.py from protocol/messages.json: change that.

/** Attributes that are defaults of `speak`: the member each stands for, and what its text is. */
export const SPEAK_ATTRIBUTES = {
  lang: { member: 'lang', type: String },
  voice: { member: 'voice', type: String },
  markup: { member: 'markup', type: String },
  rate: { member: 'rate', type: Number },
  life: { member: 'life', type: Number },
  blend: { member: 'blend', type: String },
  contacts: { member: 'contacts', type: String },
  normalization: { member: 'normalize', type: String },
  verse: { member: 'verse', type: String },
};
