// SPDX-License-Identifier: MIT
import { SRGBColorSpace } from 'three';
import { View } from '../head/view.mjs';

const FADE = 'linear-gradient(#000 87%, transparent)'; // where a bust ends
const CLOSE = ['face', 'mouth']; // views that end in the skin

/** A View whose colours are light until the last step, as materials of glTF want it. */
export class AvatarView extends View {
  targetOptions = { colorSpace: SRGBColorSpace };
  smooths = false;

  /** @param {HTMLCanvasElement} canvas @throws when there is no WebGL 2 */
  constructor(canvas) {
    super(canvas);
    this.canvas = canvas;
    this.copy.fragmentShader = `uniform sampler2D picture;
      void main() {
        vec4 light = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
        vec3 own = light.rgb / max(light.a, 1e-4);
        gl_FragColor = vec4(sRGBTransferOETF(vec4(own, 1.0)).rgb * light.a, light.a);
      }`;
    this.framing = null;
  }

  set framing(name) {
    super.framing = name;
    if (this.canvas) this.canvas.style.maskImage = CLOSE.includes(name) ? '' : FADE;
  }

  dispose() {
    super.dispose();
    this.canvas.style.maskImage = '';
  }
}
