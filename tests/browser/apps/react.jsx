// SPDX-License-Identifier: GPL-3.0-or-later
import { StrictMode, useEffect, useRef } from 'react';
import { createRoot } from 'react-dom/client';
import { flushSync } from 'react-dom';

function Head({ name, greeting, ...props }) {
  const head = useRef(null);
  useEffect(() => {
    window.ends = [];
    if (greeting) head.current.speak(greeting, { lang: 'it' }).then((end) => window.ends.push(end.reason));
    return () => head.current?.stop?.();
  }, [greeting]);
  return (
    <talking-head ref={head} data-name={name} {...props} onready={() => window.note(name, 'ready')}
      onword={(event) => window.note(name, event.detail.text)} onend={(event) => window.note(name, event.detail.reason)} />
  );
}

let root = null;
window.render = ({ names, ...props }) => {
  root ??= createRoot(document.getElementById('app'));
  flushSync(() => root.render(<StrictMode>{names.map((name) => <Head key={name} name={name} {...props} />)}</StrictMode>));
};
window.unmount = () => {
  flushSync(() => root.unmount());
  root = null;
};
