// SPDX-License-Identifier: MIT
// What leaves the operator's page, and what is heard there alone.

/** Gives the reader a file. */
export function download(name, what, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([what], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/**
 * A text as she would say it, for the operator alone.
 * @param {string} text @param {{lang: string, token: string|null}} how @throws {{code: string}}
 */
export async function preview(text, { lang, token }) {
  const answer = await fetch(`v1/speech?format=ogg&lang=${encodeURIComponent(lang)}`, {
    method: 'POST', body: text,
    headers: { 'content-type': 'text/plain', ...(token ? { authorization: `Bearer ${token}` } : {}) },
  });
  if (!answer.ok) throw await answer.json();
  const sound = new AudioContext(), source = sound.createBufferSource();
  source.buffer = await sound.decodeAudioData(await answer.arrayBuffer());
  source.connect(sound.destination);
  source.onended = () => sound.close();
  source.start();
}
