// SPDX-License-Identifier: MIT
// A short turn before the camera: the sharpest pictures from the front and from either side. They stay in the page.

const MOST = 120; // looks: who has not turned by then is not going to

/**
 * Looks until each side has been seen, or it is stopped.
 * @param {HTMLVideoElement} video @param {{readPicture: Function, find: Function, TurnPicker: Function, table: object}} tools
 * @param {{signal: AbortSignal, wants: (side: string|null) => void}} page wants: which side to turn to; null: any that was seen
 * @returns {Promise<{picture: ImageData, landmarks: number[][]}[]>} the front first
 */
export async function takeTurn(video, { readPicture, find, TurnPicker, table }, { signal, wants }) {
  const picker = new TurnPicker(Object.values(table)[0]);
  for (let look = 0; look < MOST && !picker.done && !signal.aborted; look++) {
    wants(picker.missing[0] ?? null);
    await new Promise((resolve) => setTimeout(resolve)); // the page is seen, and heard
    if (signal.aborted) break;
    const picture = await readPicture(video);
    const landmarks = await find(picture).catch(() => null); // no face just now
    if (landmarks) picker.take({ picture, landmarks });
  }
  return picker.views;
}
