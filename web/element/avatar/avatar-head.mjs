// SPDX-License-Identifier: MIT
import { AmbientLight, DirectionalLight, Euler, Group, Matrix4, Quaternion, SRGBColorSpace, Vector3 } from 'three';
import { faceValues } from '../face/face-mixer.mjs';
import { View } from '../head/view.mjs';
import { BREATH } from '../head/model/model.mjs';
import { BoneTurn, JAW_RADIANS } from './rig.mjs';

const AU = 1e-5; // radians
const BREATH_TARGET = 'breath'; // a morph target, as faccia's own avatars have it
/** Degrees that a shape turns the eye by, as ARKit has it. */
const LOOKS = { Up: [25, -1], Down: [25, 1], In: [30, 1], Out: [30, 1] };
const EYES = [['Left', 23, 25, 1], ['Right', 24, 26, -1]];
const TIP_AT_TEETH = 61; // FAP 45: up to this value the tip of the tongue is at the teeth, not out
const TIP_OUT = 450; // and here wholly
const PIVOT = [0, -30, -70]; // mm from the eyes: what a head without bones turns about
const LIGHTS = [
  [0xfff4ea, 2.1, [-260, 320, 700]],
  [0xdfeaff, 0.7, [500, 60, 400]],
  [0xffffff, 0.45, [200, 300, -600]],
];

/** Radians down, to the head's left, to its right shoulder, as the head's FAPs are applied one after the other. */
const turned = (pitch, yaw, roll) => new Quaternion().setFromEuler(new Euler(pitch, yaw, roll, 'ZYX'));

/** An avatar as a head: FAPs go in, and its own shapes and bones do the rest. The same as Head, for files of others. */
export class AvatarHead {
  uniforms = { fade: { value: 0 } }; // as of a head: the picture's edge is the view's matter here

  /**
   * @param {object} gltf @param {ReturnType<import('./controls.mjs').controlsOf>} controls
   * @param {object} found see landmarksOf @param {import('./solver.mjs').Solver} solver
   */
  constructor(gltf, controls, found, solver) {
    this.meshes = controls.meshes;
    this.controls = controls;
    this.solver = solver;
    this.found = found;
    const { scale, origin, axes } = found.place;
    const placed = new Group();
    placed.matrixAutoUpdate = false;
    placed.matrix = new Matrix4().makeTranslation(...origin.map((value) => -value));
    const turn = new Matrix4().makeBasis(...axes.map((axis) => new Vector3(...axis))).transpose();
    placed.matrix.multiply(turn).scale(new Vector3(scale, scale, scale));
    placed.add(gltf.scene);
    this.whole = new Group();
    this.whole.add(placed);
    this.group = new Group();
    this.group.add(this.whole, new AmbientLight(0xffffff, 0.75), ...LIGHTS.map(lamp));
    const { bones } = controls;
    this.head = bones.head ? new BoneTurn(bones.head) : null;
    this.eyes = EYES.map(([name]) => (bones[`${name.toLowerCase()}Eye`] ? new BoneTurn(bones[`${name.toLowerCase()}Eye`]) : null));
    const jaw = controls.face.find(({ bone }) => bone);
    this.jaw = jaw ? new BoneTurn(jaw.bone) : null;
    this.base = this.meshes.map((mesh) => mesh.morphTargetInfluences?.slice());
    this.breathing = this.meshes.map((mesh) => ({ mesh, index: mesh.morphTargetDictionary?.[BREATH_TARGET] }));
    this.breathing = this.breathing.filter(({ index }) => index !== undefined);
    for (const mesh of this.meshes) mesh.frustumCulled = false;
    const { rest } = found;
    this.model = {
      fapu: found.fapu,
      fdp: { 2.1: rest.chin, 2.2: rest.upper, 2.3: rest.lower, 2.4: rest.cornerL, 2.5: rest.cornerR },
      view: viewOf(rest, found.fapu.ES),
    };
    this.setFaps(faceValues({}));
  }

  /** @param {ArrayLike<number>} values by FAP number, the breath at 0 */
  setFaps(values) {
    this.faps = values;
    this.meshes.forEach((mesh, i) => this.base[i]?.forEach((value, k) => (mesh.morphTargetInfluences[k] = value)));
    const weights = this.solver.solve(values);
    this.controls.face.forEach((control, i) => this.#apply(control, weights[i]));
    if (this.controls.tongue) this.#apply(this.controls.tongue, (values[45] - TIP_AT_TEETH) / (TIP_OUT - TIP_AT_TEETH));
    for (const { mesh, index } of this.breathing) mesh.morphTargetInfluences[index] += values[BREATH];
    this.#turn(values);
    this.#look(values);
  }

  #apply({ binds, bone }, weight) {
    const share = Math.min(1, Math.max(0, weight));
    if (bone) this.jaw.set(turned(share * JAW_RADIANS, 0, 0));
    if (share) for (const { mesh, index, weight: whole } of binds) mesh.morphTargetInfluences[index] += share * whole;
  }

  #turn(values) {
    const [pitch, yaw, roll] = [48, 49, 50].map((fap) => values[fap] * AU);
    if (this.head) {
      this.head.set(turned(pitch, yaw, roll));
      return;
    }
    const pivot = new Vector3(...PIVOT);
    this.whole.quaternion.copy(turned(pitch, yaw, roll));
    this.whole.position.copy(pivot).sub(pivot.clone().applyQuaternion(this.whole.quaternion));
  }

  #look(values) {
    EYES.forEach(([name, yawFap, pitchFap, out], i) => {
      const [yaw, pitch] = [values[yawFap] * AU, values[pitchFap] * AU];
      if (this.eyes[i]) {
        this.eyes[i].set(turned(pitch, yaw, 0));
        return;
      }
      const turns = { Up: pitch, Down: pitch, In: -out * yaw, Out: out * yaw };
      for (const [way, [degrees, sense]] of Object.entries(LOOKS)) {
        const control = this.controls.gaze.get(`eyeLook${way}${name}`);
        if (control) this.#apply(control, (sense * turns[way] * 180) / Math.PI / degrees);
      }
    });
  }

  get triangles() {
    return this.meshes.reduce((sum, { geometry }) => sum + (geometry.index ?? geometry.attributes.position).count / 3, 0);
  }

  set point(_mm) {} // as of a head: its triangles are its maker's matter

  setQuality(_fine, anisotropy) {
    for (const { material } of this.meshes)
      for (const one of Array.isArray(material) ? material : [material])
        if (one.map && one.map.anisotropy !== anisotropy) {
          one.map.anisotropy = anisotropy;
          one.map.needsUpdate = true;
        }
  }

  async slim() {} // as of a head

  seenFrom(_eye) {} // as of a head: all of it is drawn

  /** Gives back what the graphics processor has; it can be drawn anew. */
  dispose() {
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      mesh.skeleton?.dispose();
      for (const material of Array.isArray(mesh.material) ? mesh.material : [mesh.material]) {
        for (const value of Object.values(material)) if (value?.isTexture) value.dispose();
        material.dispose();
      }
    }
  }
}

function lamp([colour, strength, place]) {
  const light = new DirectionalLight(colour, strength);
  light.position.set(...place);
  return light;
}

/** Frames the portrait by the height of the face; from farther away for the wide-set eyes of drawn characters. */
function viewOf({ chin, upper }, eyes) {
  const size = Math.max(0.7, -upper[1] / 62, eyes / 64);
  return { target: [0, -22 * size, 0], distance: Math.max(620 * size, -chin[1] * 5.6), fov: 26 };
}

const FADE = 'linear-gradient(#000 92%, transparent)'; // where a bust ends
const CLOSE = ['face', 'mouth']; // views that end in the skin

/** A View whose colours are light until the last step, as materials of glTF want it. */
export class AvatarView extends View {
  targetOptions = { colorSpace: SRGBColorSpace };
  smooths = false;

  /** @param {HTMLCanvasElement} canvas @throws without WebGL 2 */
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
