// SPDX-License-Identifier: MIT
// Unpacks textures of Basis Universal in KTX2 (KHR_texture_basisu). A separate script: most avatars need none.
import module from 'three/examples/jsm/libs/basis/basis_transcoder.js';
import wasmBinary from 'three/examples/jsm/libs/basis/basis_transcoder.wasm';

const RGBA32 = 13; // cTFRGBA32
const MOST_POINTS = 1 << 26;

/** @returns {Promise<Basis>} @throws where the page's policy forbids WebAssembly */
export async function openBasis() {
  const basis = await module({ wasmBinary });
  basis.initializeBasis();
  return new Basis(basis);
}

class Basis {
  constructor(basis) {
    this.basis = basis;
  }

  /**
   * @param {Uint8Array} bytes of a KTX2 file
   * @param {number} side of the level that is taken, where there are several: the largest within it
   * @returns {{width: number, height: number, data: Uint8ClampedArray}} RGBA
   * @throws {Error} where it is damaged, of another kind, or too large
   */
  decode(bytes, side) {
    // no Buffer of Node.js: more of its kind would be made within
    const file = new this.basis.KTX2File(new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.length));
    try {
      if (!file.isValid() || !(file.isUASTC() || file.isETC1S())) throw new Error('a picture is no KTX2 file of Basis Universal');
      const last = file.getLevels() - 1;
      let level = 0;
      const long = (at) => Math.max(file.getWidth() >> at, file.getHeight() >> at);
      while (level < last && long(level) > side) level++;
      if ((file.getWidth() >> level) * (file.getHeight() >> level) > MOST_POINTS) throw new Error(`a picture has ${file.getWidth()} x ${file.getHeight()} points`);
      if (!file.startTranscoding()) throw new Error('a KTX2 picture cannot be unpacked');
      const { origWidth: width, origHeight: height } = file.getImageLevelInfo(level, 0, 0);
      const data = new Uint8Array(file.getImageTranscodedSizeInBytes(level, 0, 0, RGBA32));
      if (data.length !== 4 * width * height || !file.transcodeImage(data, level, 0, 0, RGBA32, 0, -1, -1)) throw new Error('a KTX2 picture cannot be unpacked');
      return { width, height, data: new Uint8ClampedArray(data.buffer) };
    } finally {
      file.close();
      file.delete();
    }
  }
}
