// SPDX-License-Identifier: MIT
// import '@faccia/talking-head/svelte': <talking-head> in Svelte 5's templates.
import type { HTMLAttributes } from 'svelte/elements';
import type { TalkingHead, TalkingHeadAttributes, TalkingHeadHandlers } from './talking-head.js';

declare module 'svelte/elements' {
  interface SvelteHTMLElements {
    'talking-head': Omit<HTMLAttributes<TalkingHead>, keyof TalkingHeadAttributes | keyof TalkingHeadHandlers> &
      TalkingHeadAttributes & TalkingHeadHandlers;
  }
}
