// SPDX-License-Identifier: MIT
// An esbuild plugin that removes from three.js what a bundler cannot know to be unused. faccia's heads have their own shaders
// and use no shadow maps, environment maps, morph targets or WebXR. It applies to the script that loads before the first
// picture; the script for avatars contains all of three.js. The build fails if a declaration below does not occur exactly once.
import { readFileSync } from 'node:fs';

/** Declarations of three.module.js with their replacements. */
const INSTEAD = {
  // shader sources of three.js's own materials; it adds these two to every shader
  'const ShaderChunk = {': 'const ShaderChunk = { tonemapping_pars_fragment, colorspace_pars_fragment };',
  'const ShaderLib = {': 'const ShaderLib = {};',
  'ShaderLib.physical = {': '',
  'function WebGLMaterials(': `function WebGLMaterials() {
    this.refreshFogUniforms = () => {};
    this.refreshMaterialUniforms = (uniforms, material) => (material.uniformsNeedUpdate = false);
  }`,
  'function WebGLCubeMaps(': `function WebGLCubeMaps() {
    this.get = (texture) => texture;
    this.dispose = () => {};
  }`,
  'function WebGLCubeUVMaps(': `function WebGLCubeUVMaps() {
    this.get = (texture) => texture;
    this.dispose = () => {};
  }`,
  'class PMREMGenerator {': 'class PMREMGenerator {}',
  'function WebGLMorphtargets(': `function WebGLMorphtargets() {
    this.update = () => {};
  }`,
  'function WebGLUniformsGroups(': `function WebGLUniformsGroups() {
    this.update = this.bind = this.dispose = () => {};
  }`,
  'function WebGLShadowMap(': `function WebGLShadowMap() {
    this.enabled = false;
    this.type = PCFShadowMap;
    this.render = () => {};
  }`,
  'class WebXRDepthSensing {': '',
  'class WebXRManager extends EventDispatcher {': `class WebXRManager extends EventDispatcher {
    enabled = false;
    isPresenting = false;
    getEnvironmentBlendMode() {}
    setAnimationLoop() {}
    dispose() {}
  }`,
};

/** Replaces a declaration that begins a line, up to the first line that closes it at that indentation. */
function replaced(text, begin, instead, file) {
  const from = text.indexOf(`\n${begin}`);
  if (from < 0 || text.indexOf(`\n${begin}`, from + 1) >= 0) throw new Error(`${file}: "${begin}" must occur exactly once`);
  const close = /\n\};?(?=\n)/g;
  close.lastIndex = from;
  if (!close.exec(text)) throw new Error(`${file}: the end of "${begin}" was not found`);
  return `${text.slice(0, from + 1)}${instead}${text.slice(close.lastIndex)}`;
}

export const trimmed = {
  name: 'trimmed',
  setup({ onLoad }) {
    onLoad({ filter: /three[/\\]build[/\\]three\.module\.js$/ }, ({ path: file }) => {
      const whole = readFileSync(file, 'utf8');
      const put = (text, [begin, instead]) => replaced(text, begin, instead, file);
      return { contents: Object.entries(INSTEAD).reduce(put, whole) };
    });
  },
};
