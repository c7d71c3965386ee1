// SPDX-License-Identifier: MIT
import { setCompanions } from './companions.mjs';
import { TalkingHead } from './element.mjs';
import { PlainText } from './captions/plain-text.mjs';

// Servers have no custom elements, and a page may load the script twice: the first definition counts.
if (globalThis.customElements && !customElements.get('talking-head')) customElements.define('talking-head', TalkingHead);

export { PlainText, setCompanions, TalkingHead };
