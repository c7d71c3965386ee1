// SPDX-License-Identifier: MIT
import { TalkingHead } from './element.mjs';
import { PlainText } from './plain-text.mjs';

if (!customElements.get('talking-head')) customElements.define('talking-head', TalkingHead);

export { PlainText, TalkingHead };
