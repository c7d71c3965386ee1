// SPDX-License-Identifier: MIT
import { TalkingHead } from './element.mjs';

if (!customElements.get('talking-head')) customElements.define('talking-head', TalkingHead);

export { TalkingHead };
