// SPDX-License-Identifier: GPL-3.0-or-later
// What Chromium itself records (chrome://tracing): when each picture was on the display, and when each sample of an
// AudioContext leaves the loudspeaker, as its sound system says. In milliseconds of one clock, which is not the page's.

/** What has to be recorded. */
export const categories = ['blink.user_timing', 'disabled-by-default-devtools.timeline.frame', 'webaudio'];

const FRAME = 'PipelineReporter';
const MAIN = 'SendBeginMainFrameToCommit'; // the page's own part of a frame: its animation callbacks run in it

/** Frames of the compositor: {from, to} of the page's part and `seen`, of those that were shown. */
function shown(events) {
  const open = new Map();
  const frames = [];
  for (const { name, ph, ts, pid, id2, args } of events) {
    if ((ph !== 'b' && ph !== 'e') || !id2) continue;
    const key = `${pid} ${id2.local}`;
    if (name === FRAME && ph === 'b') open.set(key, { state: args.frame_reporter?.state });
    else if (name === FRAME) {
      const frame = open.get(key);
      open.delete(key);
      if (frame?.to && frame.state === 'STATE_PRESENTED_ALL') frames.push({ ...frame, seen: ts / 1000 });
    } else if (name === MAIN && open.has(key)) open.get(key)[ph === 'b' ? 'from' : 'to'] = ts / 1000;
  }
  return frames;
}

/**
 * The pictures that were drawn after the marks `PREFIX0`, `PREFIX1`, ... (performance.mark).
 * @returns {Map<number, {begun: number, seen: number|null}>} by number; null: never shown
 */
export function pictures(events, prefix) {
  const frames = shown(events);
  const found = new Map();
  for (const { name, cat, ts } of events) {
    if (cat !== 'blink.user_timing' || !name.startsWith(prefix)) continue;
    const begun = ts / 1000;
    const frame = frames.find(({ from, to }) => from <= begun && begun <= to);
    found.set(Number(name.slice(prefix.length)), { begun, seen: frame?.seen ?? null });
  }
  return found;
}

const QUANTUM = 128; // frames that an AudioContext renders at a time

/**
 * The sound of the only AudioContext that was made since the recording began.
 * @param {number} rate of the context in Hz
 * @returns {(time: number) => number} the context's frame that is heard then
 */
export function soundOf(events, rate) {
  const anchors = []; // {at, frame}: a frame that leaves the loudspeaker at that time
  let rendered = 0;
  let waiting = 0; // rendered, and not yet taken by the sound system
  let asked = null;
  for (const { name, args } of events.filter(({ cat }) => cat === 'webaudio').sort((a, b) => a.ts - b.ts)) {
    if (name === 'RealtimeAudioDestinationHandler::Render') rendered += QUANTUM;
    if (name === 'AudioDestination::Render') asked = args;
    if (name !== 'PushPullFIFO frames') continue;
    // The count falls when the sound system takes its share: what it takes begins that much earlier.
    if (asked && args.value < waiting && waiting - args.value === asked.frames)
      anchors.push({ at: asked['delay_timestamp (ms)'] + asked['playout_delay (ms)'], frame: rendered - waiting });
    waiting = args.value;
  }
  if (!anchors.length) throw new Error('the browser has recorded no sound');
  return (time) => {
    let k = anchors.findIndex(({ at }) => at > time);
    if (k < 0) k = anchors.length;
    // The sound system is called in steps, some of them late; the loudspeaker runs evenly.
    const near = anchors.slice(Math.max(0, k - 25), k + 25).map(({ at, frame }) => frame - ((at - time) * rate) / 1000);
    return near.sort((a, b) => a - b)[near.length >> 1];
  };
}
