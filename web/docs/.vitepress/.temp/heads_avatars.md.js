import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Our heads as avatars","description":"","frontmatter":{},"headers":[],"relativePath":"heads/avatars.md","filePath":"heads/avatars.md"}');
const _sfc_main = { name: "heads/avatars.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="our-heads-as-avatars" tabindex="-1">Our heads as avatars <a class="header-anchor" href="#our-heads-as-avatars" aria-label="Permalink to &quot;Our heads as avatars&quot;">​</a></h1><p>The other way round, an avatar of others in place of our heads: <code>&lt;talking-head avatar&gt;</code>, <a href="/docs/element/avatars.html">Avatars</a>.</p><pre><code>faccia head export mara --glb mara.glb
faccia head export mara --vrm mara.vrm
</code></pre><p>writes a head that <code>faccia models</code> lists as a file that other programs load: three.js, Blender, Unity, Unreal, Godot, avatar players. Both files are the same: a GLB (glTF 2.0) that is an avatar of VRM 1.0; who does not know VRM passes it over. The heads are in the public domain (CC0-1.0): the file says so in <code>asset.copyright</code>, <code>extras</code> and VRM&#39;s <code>meta</code>, with the credits of what they were made from. They are made while building, from the built heads (<code>models/tools/avatar/export-head.mjs HEAD.json OUTPUT.glb</code>).</p><table tabindex="0"><thead><tr><th>in it</th><th></th></tr></thead><tbody><tr><td>meshes</td><td>one for each part of the head (<code>skin</code>, <code>hair</code>, <code>eye_l</code>...), pictures as JPEG, or PNG where they are seen through</td></tr><tr><td>morph targets</td><td>ARKit&#39;s 52 (<a href="/docs/heads/arkit.html">arkit.md</a>) and <code>viseme_sil</code>, <code>viseme_PP</code>... (<a href="/docs/heads/visemes.html">visemes.md</a>). <code>skin</code> has all 67, the other parts those that move them; <code>extras.targetNames</code> names them</td></tr><tr><td>bones</td><td><code>head</code> on <code>neck</code> (48 to 50 of the FAPs), <code>leftEye</code>, <code>rightEye</code>; the rest of a body as VRM wants it, which moves nothing</td></tr><tr><td>VRM</td><td><code>aa ih ou ee oh</code> (visemes), <code>blink blinkLeft blinkRight</code>, <code>lookUp</code>..., <code>happy angry sad relaxed surprised neutral</code> (FAP 2&#39;s expressions, <code>models/shapes/moods.json</code>), ARKit&#39;s 52 as custom expressions</td></tr><tr><td>units</td><td>metres, y up, looking along z; the eyes 1.55 m above the floor</td></tr></tbody></table><p>A morph target is the head at the FAPs of its definition (<code>models/shapes/</code>), less the head at rest, so that the weights of <code>format=arkit</code> move it as the FAPs move ours; a morph goes straight where a lid or a jaw turns, so half a blink is not quite half of ours.</p><p>All weights are 0 in the file. The client&#39;s reader of avatars begins the face&#39;s shapes at rest, whatever weights a file shows them at, and passes over empty targets where another of the same meaning moves something (<a href="/docs/element/avatars.html">Avatars</a>).</p><p>A file has 4.8 to 5.7 MB. It lies beside the head, <code>models/heads/NAME.glb</code>.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("heads/avatars.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const avatars = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  avatars as default
};
