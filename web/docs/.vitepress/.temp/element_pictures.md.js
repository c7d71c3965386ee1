import { ssrRenderAttrs, ssrRenderAttr } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const _imports_0 = "/docs/pictures/pictures.webp";
const __pageData = JSON.parse('{"title":"Pictures","description":"","frontmatter":{},"headers":[],"relativePath":"element/pictures.md","filePath":"element/pictures.md"}');
const _sfc_main = { name: "element/pictures.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="pictures" tabindex="-1">Pictures <a class="header-anchor" href="#pictures" aria-label="Permalink to &quot;Pictures&quot;">​</a></h1><p>Where there is no WebGL 2, or with <code>quality=&quot;pictures&quot;</code>, the face is a set of photographs (<code>protocol/pictures.md</code>) in place of the head: one for each of the 34 context visemes of P. D. P. Costa&#39;s thesis and a few more, on a plain 2D canvas. The same FAPs drive it, so every engine and language does: the two nearest pictures are warped by five anchors of lips and chin, dissolved, and laid over the face by a mask; lips that touch are always shown by pictures of lips that touch. Lids close, the head&#39;s turns shift the canvas; gaze and brows stay still. The set comes instead of the head&#39;s file: 165 kB for Mara&#39;s (her head: 0.91 MB). A picture of 480 x 624 takes some 2.5 ms of processor time on the page&#39;s thread (<code>tests/bench/pictures.mjs</code>). A head without a set shows its poster where WebGL is missing, and itself elsewhere. <code>view=&quot;mouth&quot;</code> works, other views are the portrait.</p><p><img${ssrRenderAttr("src", _imports_0)} alt="Mara as pictures: at rest, /m/, two /a/, a blink"></p><div class="language-html vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">html</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">talking-head</span><span class="c91387ddaa9"> src</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;ws://127.0.0.1:8080/v1/stream&quot;</span><span class="c91387ddaa9"> quality</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;pictures&quot;</span><span class="c91387ddaa9"> pictures</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;anna.json&quot;</span><span class="cc50c31ba69">&gt;&lt;/</span><span class="ce2f342ff08">talking-head</span><span class="cc50c31ba69">&gt;</span></span></code></pre></div><p>Anybody&#39;s photographs become a set: <code>node models/tools/pictures/make-set.mjs FOLDER -o anna.json</code>, or of a video <code>make-set.mjs anna.mp4 --times times.json -o anna.json</code> (<code>--help</code> names the mouths that are wanted). It finds the face by itself, lays the photographs onto each other by eyes and bridge of the nose, evens their light, and says which are unfit and why: no face, turned aside, blurred, too dark, cut off, or a mouth that is not the viseme&#39;s. The page names the set by the attribute <code>pictures</code> (or gives it to <code>showHead</code>). Without <code>quality=&quot;pictures&quot;</code> it is shown only where there is no WebGL 2. On a daemon&#39;s own disk, <code>models/pictures/NAME.json</code> is the set of the head NAME.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("element/pictures.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const pictures = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  pictures as default
};
