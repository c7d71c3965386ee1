// SPDX-License-Identifier: GPL-3.0-or-later
// Reads Chromium's traces (chrome://tracing): when each frame was displayed, and when each sample of an AudioContext is played,
// according to its sound system. Times are ms of one clock, which is not the page's.

/** Trace categories to record. */
export const categories = ['blink.user_timing', 'disabled-by-default-devtools.timeline.frame', 'webaudio'];

const FRAME = 'PipelineReporter';
const MAIN = 'SendBeginMainFrameToCommit'; // the main thread's part of a frame, which runs animation callbacks

/** Displayed compositor frames: {from, to} of the main thread's part, and display time `seen`. */
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
 * Frames drawn after the marks `PREFIX0`, `PREFIX1`, ... (performance.mark).
 * @returns {Map<number, {begun: number, seen: number|null}>} by number; null: never displayed
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

const QUANTUM = 128; // audio frames rendered at a time by an AudioContext

/**
 * Sound of the only AudioContext created since the trace began.
 * @param {number} rate of the context in Hz
 * @returns {(time: number) => number} the context's audio frame heard at a time
 */
export function soundOf(events, rate) {
  const anchors = []; // {at, frame}: the audio frame is played at that time
  let rendered = 0;
  let waiting = 0; // rendered but not yet taken by the sound system
  let asked = null;
  for (const { name, args } of events.filter(({ cat }) => cat === 'webaudio').sort((a, b) => a.ts - b.ts)) {
    if (name === 'RealtimeAudioDestinationHandler::Render') rendered += QUANTUM;
    if (name === 'AudioDestination::Render') asked = args;
    if (name !== 'PushPullFIFO frames') continue;
    // The count drops when the sound system takes frames, which begin that much earlier.
    if (asked && args.value < waiting && waiting - args.value === asked.frames)
      anchors.push({ at: asked['delay_timestamp (ms)'] + asked['playout_delay (ms)'], frame: rendered - waiting });
    waiting = args.value;
  }
  if (!anchors.length) throw new Error('the browser has recorded no sound');
  return (time) => {
    let k = anchors.findIndex(({ at }) => at > time);
    if (k < 0) k = anchors.length;
    // Calls of the sound system are bursty and sometimes late, but playback is even, so the median is used.
    const near = anchors.slice(Math.max(0, k - 25), k + 25).map(({ at, frame }) => frame - ((at - time) * rate) / 1000);
    return near.sort((a, b) => a - b)[near.length >> 1];
  };
}
