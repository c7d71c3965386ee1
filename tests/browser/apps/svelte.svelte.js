// SPDX-License-Identifier: GPL-3.0-or-later
import { flushSync, mount, unmount } from 'svelte';
import Heads from './Heads.svelte';

let app = null;
const state = $state({ names: [], greeting: undefined, head: {} });
window.render = ({ names, greeting, ...head }) => {
  Object.assign(state, { names, greeting, head });
  app ??= mount(Heads, { target: document.getElementById('app'), props: { state } });
  flushSync();
};
window.unmount = () => {
  unmount(app);
  app = null;
};
