// SPDX-License-Identifier: MIT
import {
  AddEquation, CustomBlending, DataTexture, LessEqualDepth, LinearFilter, Mesh, NearestFilter, OneFactor,
  OneMinusDstAlphaFactor, OrthographicCamera, PlaneGeometry, Scene, ShaderMaterial, Texture, Vector2,
} from 'three';
import { paintRoom } from '../element/room-backdrop.mjs';

const NO_IMAGE = new DataTexture(new Uint8Array(4), 1, 1);

/** The room that the element shows for `backdrop="room"`. @returns {HTMLCanvasElement} */
export function roomImage(width, height) {
  const canvas = Object.assign(document.createElement('canvas'), { width, height });
  paintRoom(canvas.getContext('2d'), width, height);
  return canvas;
}

/** The part of an image that covers a picture: its share of the width and the height, from the middle. */
export function covering(image, width, height) {
  const wide = image.width * height > image.height * width;
  return wide ? [(image.height * width) / (image.width * height), 1] : [1, (image.width * height) / (image.height * width)];
}

/** A colour or an image behind a head that is drawn already. Colours stay as they are: nothing is lit. */
export class Backdrop {
  /**
   * @param {import('three').WebGLRenderer} renderer
   * @param {{colour?: number[], image?: TexImageSource, width: number, height: number, part?: number[], deep?: boolean}} look
   *   colour: red, green, blue, 0 to 1; the size of the picture; part: where in its width the canvas begins, and its share;
   *   deep: whether the canvas has the depth of what is drawn, so that only the rest need be filled
   */
  constructor(renderer, { colour = [0, 0, 0], image = null, width, height, part = [0, 1], deep = false }) {
    this.renderer = renderer;
    const texture = image ? new Texture(image) : NO_IMAGE;
    const exact = image?.width === width && image.height === height; // nothing is between its points
    const filter = exact ? NearestFilter : LinearFilter;
    Object.assign(texture, { minFilter: filter, magFilter: filter, flipY: false, needsUpdate: true });
    const material = new ShaderMaterial({
      uniforms: {
        picture: { value: texture },
        colour: { value: [...colour, 1] },
        share: { value: new Vector2(...(image ? covering(image, width, height) : [0, 0])) },
        part: { value: new Vector2(...part) },
      },
      vertexShader: `uniform vec2 part; varying vec2 at;
        void main() { at = vec2(part.x + (0.5 + 0.5 * position.x) * part.y - 0.5, -0.5 * position.y); gl_Position = vec4(position.xy, 1.0, 1.0); }`,
      fragmentShader: `uniform sampler2D picture; uniform vec4 colour; uniform vec2 share; varying vec2 at;
        void main() { gl_FragColor = share.x > 0.0 ? vec4(texture2D(picture, at * share + 0.5).rgb, 1.0) : colour; }`,
      blending: CustomBlending,
      blendEquation: AddEquation,
      blendSrc: OneMinusDstAlphaFactor,
      blendDst: OneFactor,
      depthTest: deep,
      depthFunc: LessEqualDepth,
      depthWrite: false,
    });
    this.scene = new Scene();
    this.scene.add(new Mesh(new PlaneGeometry(2, 2), material));
    this.scene.children[0].frustumCulled = false;
    this.camera = new OrthographicCamera();
  }

  /** Fills what the canvas shows nothing of. */
  draw() {
    const { renderer } = this;
    renderer.autoClear = false;
    renderer.setRenderTarget(null);
    renderer.render(this.scene, this.camera);
    renderer.autoClear = true;
  }
}
