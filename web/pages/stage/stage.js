// SPDX-License-Identifier: MIT
// The face of a room without anything else, for OBS and other programs that put pages into a picture.
import { tokenOfTab } from '../shared/access.js';
import './talking-head.js';

/** Parameters of the address that are attributes of the element. */
const ATTRIBUTES = ['lang', 'model', 'avatar', 'view', 'quality', 'life', 'still', 'expression', 'caption-size', 'caption-colours'];

const head = document.querySelector('talking-head');
const wish = new URL(location.href).searchParams;
const token = tokenOfTab();

for (const name of ATTRIBUTES) if (wish.has(name)) head.setAttribute(name, wish.get(name));
head.captions = wish.get('captions') ?? 'off';
if (!wish.has('still')) head.still = false; // whatever the machine that streams is set to
if (wish.has('background')) document.body.style.background = wish.get('background');
if (token) head.token = token;
head.room = wish.get('room') ?? 'home';
document.title = `${head.room} · faccia`;
head.addEventListener('joined', () => document.body.classList.add('live'));
head.addEventListener('error', ({ detail }) => console.warn('faccia:', detail.message));
