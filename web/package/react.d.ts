// SPDX-License-Identifier: MIT
// import '@faccia/talking-head/react': <talking-head> in React 19's JSX.
import type { DetailedHTMLProps, HTMLAttributes } from 'react';
import type { TalkingHead, TalkingHeadAttributes, TalkingHeadHandlers } from './talking-head.js';

declare module 'react' {
  namespace JSX {
    interface IntrinsicElements {
      'talking-head': Omit<DetailedHTMLProps<HTMLAttributes<TalkingHead>, TalkingHead>, keyof TalkingHeadAttributes | keyof TalkingHeadHandlers> &
        TalkingHeadAttributes & TalkingHeadHandlers;
    }
  }
}
