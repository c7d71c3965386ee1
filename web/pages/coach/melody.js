// SPDX-License-Identifier: MIT
// The pitch of both voices over the words, each in semitones above its own usual one, on the model's time.
import { prosody } from '../player/prosody.js';

const REACH = 9; // semitones shown to each side

function curve(buffer) {
  const { times, pitch } = prosody(buffer.getChannelData(0), buffer.sampleRate);
  const voiced = pitch.filter((hertz) => hertz !== null).sort((a, b) => a - b);
  const usual = voiced[voiced.length >> 1];
  return times.map((time, i) => ({ time, tone: pitch[i] === null ? null : 12 * Math.log2(pitch[i] / usual) }));
}

/** The moment of the model that a moment of the recording stands for. @returns {number|null} */
function modelTime(phones, time) {
  const phone = phones.find(({ start, end }) => time >= start && time < end);
  if (!phone) return null;
  const { start, end, model_start: from, model_end: to } = phone;
  return from + ((time - start) / Math.max(1e-3, end - start)) * (to - from);
}

/**
 * @param {HTMLCanvasElement} canvas @param {AudioBuffer} model @param {AudioBuffer} own
 * @param {{words: object[], phones: object[]}} heard as the server answers
 */
export function drawMelody(canvas, model, own, { words, phones }) {
  const pen = canvas.getContext('2d'), style = getComputedStyle(canvas);
  const { width, height } = canvas;
  const x = (time) => (time / model.duration) * width;
  const y = (tone) => height * 0.45 * (1 - Math.max(-REACH, Math.min(REACH, tone)) / REACH);
  const line = (points, colour, dash, thick) => {
    pen.strokeStyle = colour;
    pen.lineWidth = thick;
    pen.setLineDash(dash);
    pen.beginPath();
    let open = false;
    for (const { time, tone } of points) {
      const drawn = time !== null && tone !== null;
      if (drawn && open) pen.lineTo(x(time), y(tone));
      else if (drawn) pen.moveTo(x(time), y(tone));
      open = drawn;
    }
    pen.stroke();
  };
  pen.clearRect(0, 0, width, height);
  line(curve(model), style.getPropertyValue('--soft'), [8, 6], 4);
  line(curve(own).map(({ time, tone }) => ({ time: modelTime(phones, time), tone })), style.getPropertyValue('--accent'), [], 4);
  pen.fillStyle = style.color;
  pen.font = '20px system-ui, sans-serif';
  for (const { text, model_start: from, model_end: to } of words)
    pen.fillText(text, x(from), height - 8, Math.max(12, x(to) - x(from)));
}
