// SPDX-License-Identifier: MIT
// import '@faccia/talking-head/vue': <talking-head> in Vue 3's templates.
import type { DefineComponent, HTMLAttributes } from 'vue';
import type { TalkingHeadAttributes, TalkingHeadEventMap } from './talking-head.js';

type Listeners = { [K in keyof TalkingHeadEventMap as `on${Capitalize<K>}`]?: (event: TalkingHeadEventMap[K]) => void };

declare module 'vue' {
  interface GlobalComponents {
    'talking-head': DefineComponent<Omit<HTMLAttributes, keyof TalkingHeadAttributes | keyof Listeners> & TalkingHeadAttributes & Listeners>;
  }
}
