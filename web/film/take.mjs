// SPDX-License-Identifier: MIT
// Films a take in the page itself, with the browser's own coders: frame by frame, as fast as it can.
import {
  AudioBufferSource, BufferTarget, CanvasSource, getFirstEncodableAudioCodec, getFirstEncodableVideoCodec, Mp4OutputFormat,
  Output, QUALITY_HIGH, WebMOutputFormat,
} from 'mediabunny';
import { roomImage } from './backdrop.mjs';
import { Place } from './place.mjs';

const SPEECH_BITS = 96e3;

/** The first kind of file that this browser codes. @returns {Promise<{video: string, audio: string|null, format: object}>} */
async function codersFor({ width, height, buffer }) {
  const none = Object.assign(new Error('no coder'), { code: 'no-coder' });
  if (!globalThis.VideoEncoder) throw none;
  const kinds = [
    { format: new Mp4OutputFormat({ fastStart: 'in-memory' }), videos: ['avc'], audios: ['aac'] },
    { format: new WebMOutputFormat(), videos: ['vp9', 'vp8'], audios: ['opus'] },
    { format: new Mp4OutputFormat({ fastStart: 'in-memory' }), videos: ['avc'], audios: ['opus'] },
  ];
  const sound = buffer && { numberOfChannels: buffer.numberOfChannels, sampleRate: buffer.sampleRate, bitrate: SPEECH_BITS };
  for (const { format, videos, audios } of kinds) {
    const video = await getFirstEncodableVideoCodec(videos, { width, height, bitrate: QUALITY_HIGH });
    const audio = sound && (await getFirstEncodableAudioCodec(audios, sound));
    if (video && (audio || !sound)) return { video, audio, format };
  }
  throw none;
}

/**
 * Makes a film of faces and their sound.
 * @param {{frames: ArrayLike<number>[], fps: number, buffer: AudioBuffer|null}} take frames: FAPs by number
 * @param {{head: object, width: number, height: number, view: string|null}} look head: its model
 * @param {(share: number) => void} told how much of it is drawn, 0 to 1 @param {AbortSignal} signal stops it
 * @returns {Promise<{blob: Blob, suffix: string}|null>} null: stopped
 */
export async function filmTake({ frames, fps, buffer }, { head, ...look }, told, signal) {
  const { video, audio, format } = await codersFor({ ...look, buffer });
  const place = await Place.open({ ...look, level: null }, { image: roomImage(look.width, look.height) }, head, 0, look.width);
  const output = new Output({ format, target: new BufferTarget() });
  const pictures = new CanvasSource(place.view.renderer.domElement, { codec: video, bitrate: QUALITY_HIGH });
  const sound = audio && new AudioBufferSource({ codec: audio, bitrate: SPEECH_BITS });
  try {
    output.addVideoTrack(pictures, { frameRate: fps });
    if (sound) output.addAudioTrack(sound);
    await output.start();
    if (sound) await sound.add(buffer);
    sound?.close();
    const values = new Float32Array(place.head.faps.length);
    for (const [k, frame] of frames.entries()) {
      if (signal.aborted) {
        await output.cancel();
        return null;
      }
      values.set(frame);
      place.show(values);
      await pictures.add(k / fps, 1 / fps);
      told((k + 1) / frames.length);
    }
    pictures.close();
    await output.finalize();
    return { blob: new Blob([output.target.buffer], { type: format.mimeType }), suffix: format.fileExtension };
  } finally {
    place.close();
  }
}
