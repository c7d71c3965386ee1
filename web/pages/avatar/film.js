// SPDX-License-Identifier: MIT
// Samples pictures from a video that the user has chosen. The browser plays the file in place; it stays in the page.

const LOOKS = 120; // maximum number; the face detector takes up to a second for each
const APART = 0.2; // s, minimum between two samples; a pose is held longer
const FAR = 1e7; // s: beyond any end
const PATIENCE_MS = 20000; // for one picture

const unread = () => Object.assign(new Error('the video cannot be played here'), { code: 'no_video' });

/** Waits for an event, an error, or for too long. */
function once(video, type) {
  return new Promise((resolve, reject) => {
    const end = new AbortController();
    const { signal } = end;
    const timer = setTimeout(() => settle(() => reject(unread())), PATIENCE_MS);
    const settle = (how) => {
      clearTimeout(timer);
      end.abort();
      how();
    };
    video.addEventListener(type, () => settle(resolve), { signal });
    video.addEventListener('error', () => settle(() => reject(unread())), { signal });
  });
}

function seek(video, seconds) {
  const there = once(video, 'seeked');
  video.currentTime = seconds;
  return there;
}

/**
 * Reads a video frame by frame.
 * @param {Blob} file
 * @param {(picture: HTMLCanvasElement, share: number) => Promise<void>} look called for each frame; share: its position, 0 to 1
 * @throws {Error} code no_video: not a video that this browser plays
 */
export async function throughFilm(file, look) {
  const url = URL.createObjectURL(file);
  const video = Object.assign(document.createElement('video'), { muted: true, playsInline: true, preload: 'auto' });
  try {
    const known = once(video, 'loadeddata');
    video.src = url;
    await known;
    if (!video.videoWidth) throw unread(); // sound alone
    if (!Number.isFinite(video.duration)) await seek(video, FAR); // recordings made by a browser lack their duration
    const seconds = Number.isFinite(video.duration) ? video.duration : video.currentTime;
    const canvas = Object.assign(document.createElement('canvas'), { width: video.videoWidth, height: video.videoHeight });
    const count = Math.max(1, Math.min(LOOKS, Math.floor(seconds / APART)));
    for (let i = 0; i < count; i++) {
      await seek(video, ((i + 0.5) * seconds) / count);
      canvas.getContext('2d').drawImage(video, 0, 0); // createImageBitmap fails for a video outside the document
      await look(canvas, i / count);
    }
  } finally {
    video.removeAttribute('src');
    video.load();
    URL.revokeObjectURL(url);
  }
}
