// SPDX-License-Identifier: MIT
import { edgesMaterial, edgesTarget, leapOf } from './edges.mjs';
import { framed } from './framing.mjs';
import {
  Mesh, NoBlending, OrthographicCamera, PerspectiveCamera, PlaneGeometry, Scene, ShaderMaterial, Vector3, WebGLRenderer,
  WebGLRenderTarget,
} from 'three';

const FADE = 0.08; // of the picture's height, over which shoulders vanish that end in it
const SOFTWARE_ANISOTROPY = 2; // each more is a texture read more, and faces look at the viewer
const CLOSE = ['face', 'mouth']; // views that end in the skin

/** A canvas with a head on it: camera, resolution, smoothing of edges. The background stays transparent. */
export class View {
  #framing = null;
  #fading = true;
  #software = null;
  #turned = { yaw: 0, pitch: 0 };
  #eye = new Vector3(); // from where the head is seen, a direction
  targetOptions = {}; // of what is drawn into before it is shown
  smooths = true; // whether edges may be made soft after drawing, where samples are dear

  /** @param {HTMLCanvasElement} canvas @throws without WebGL 2 */
  constructor(canvas) {
    const context = canvas.getContext('webgl2', {
      alpha: true,
      antialias: false, // done here, so that it can be switched
      powerPreference: 'low-power',
      premultipliedAlpha: true,
    });
    if (!context) throw new Error('no WebGL 2');
    this.renderer = new WebGLRenderer({ canvas, context, antialias: false, alpha: true });
    this.renderer.setClearColor(0, 0);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(26, 1, 50, 3000);
    this.size = { width: 1, height: 1 };
    this.level = null;
    this.head = null;
    this.point = 0; // mm that a point of the picture is large where the face is; 0: not known yet
    this.target = null;
    this.copy = new ShaderMaterial({
      uniforms: { picture: { value: null } },
      vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader:
        'uniform sampler2D picture; void main() { gl_FragColor = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }',
      blending: NoBlending,
      depthTest: false,
      depthWrite: false,
    });
    this.edges = edgesMaterial();
    this.copyScene = new Scene();
    this.copyScene.add(new Mesh(new PlaneGeometry(2, 2), this.copy));
    this.copyScene.children[0].frustumCulled = false;
    this.copyCamera = new OrthographicCamera();
  }

  /** Whether the CPU draws it. */
  get software() {
    return (this.#software ??= this.#named());
  }

  #named() {
    const gl = this.renderer.getContext();
    const named = gl.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER;
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(gl.getParameter(named) ?? '');
  }

  /** @param {import('./head.mjs').Head} head */
  show(head) {
    this.head?.dispose();
    this.scene.clear();
    this.head = head;
    this.scene.add(head.group);
    if (this.level) this.setLevel(this.level);
    this.#frame();
  }

  /** In CSS pixels. */
  resize(width, height) {
    this.size = { width: Math.max(1, width), height: Math.max(1, height) };
    this.#layOut();
  }

  /** Whether edges are made soft after drawing: see edges.mjs. */
  get #smoothed() {
    return this.smooths && this.level.soft && this.software;
  }

  /** @param {typeof import('./quality.mjs').LEVELS[0]} level */
  setLevel(level) {
    this.level = level;
    const most = this.software ? SOFTWARE_ANISOTROPY : this.renderer.capabilities.getMaxAnisotropy();
    const anisotropy = Math.min(level.anisotropy, most);
    this.head?.setQuality(level.fine, anisotropy, level.samples > 0 && !this.#smoothed);
    this.#layOut();
  }

  /** @param {string|null} name `face`, `bust`, `mouth`; null: the portrait that the model asks for */
  set framing(name) {
    this.#framing = name;
    this.#frame();
  }

  /** @param {boolean} fading whether the shoulders vanish towards the lower border */
  set fading(fading) {
    this.#fading = fading;
    this.#frame();
  }

  /** @param {{yaw: number, pitch: number}} degrees that the head is turned to the right of the picture, and down */
  set turned({ yaw, pitch }) {
    if (yaw === this.#turned.yaw && pitch === this.#turned.pitch) return;
    this.#turned = { yaw, pitch };
    this.#frame();
  }

  #layOut() {
    if (!this.level) return;
    const { width, height } = this.size;
    const ratio = Math.min((globalThis.devicePixelRatio || 1) * this.level.share, this.level.ratio);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.target?.dispose();
    this.target = this.#newTarget(Math.floor(width * ratio), Math.floor(height * ratio));
    this.#frame();
  }

  #newTarget(width, height) {
    const { samples } = this.level;
    if (this.#smoothed) return edgesTarget(width, height);
    return samples ? new WebGLRenderTarget(width, height, { samples, ...this.targetOptions }) : null;
  }

  /** The portrait that the model asks for; in a narrow picture from farther away, so that it fits. */
  #frame() {
    if (!this.head) return;
    const aspect = this.size.width / this.size.height;
    const { target, distance, fov } = framed(this.head.model, this.#framing, aspect);
    this.camera.fov = fov;
    this.camera.aspect = aspect;
    const [yaw, pitch] = [-this.#turned.yaw, this.#turned.pitch].map((degrees) => (degrees * Math.PI) / 180);
    const level = distance * Math.cos(pitch);
    const from = [level * Math.sin(yaw), distance * Math.sin(pitch), level * Math.cos(yaw)];
    this.camera.position.set(...from.map((value, k) => value + target[k]));
    this.camera.lookAt(...target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.edges.uniforms.leap.value = leapOf(this.camera, distance);
    const pixels = this.size.height * this.renderer.getPixelRatio();
    this.point = (2 * distance * Math.tan((fov / 2) * (Math.PI / 180))) / pixels;
    this.head.point = this.point;
    const ends = this.#fading && !CLOSE.includes(this.#framing) && this.head.model.view.bottom === undefined;
    this.head.uniforms.fade.value = ends ? FADE * pixels : 1e-3;
  }

  draw() {
    if (!this.head) return;
    this.head.seenFrom(this.camera.getWorldDirection(this.#eye).negate());
    this.renderer.setRenderTarget(this.target);
    this.renderer.render(this.scene, this.camera);
    if (!this.target) return;
    this.renderer.setRenderTarget(null);
    const shown = this.target.depthTexture ? this.edges : this.copy;
    shown.uniforms.picture.value = this.target.texture;
    this.edges.uniforms.depth.value = this.target.depthTexture;
    this.copyScene.children[0].material = shown;
    this.renderer.render(this.copyScene, this.copyCamera);
  }

  /** Notes what has been asked to be drawn. @returns {() => boolean} whether it is done */
  mark() {
    const gl = this.renderer.getContext();
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush(); // else it is never reached
    return () => {
      if (!gl.isContextLost() && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
      gl.deleteSync(fence);
      return true;
    };
  }

  dispose() {
    this.head?.dispose();
    this.target?.dispose();
    this.copy.dispose();
    this.edges.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss(); // browsers count contexts, and forget them late
  }
}
