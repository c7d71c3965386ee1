import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Engines","description":"","frontmatter":{},"headers":[],"relativePath":"protocol/engines.md","filePath":"protocol/engines.md"}');
const _sfc_main = { name: "protocol/engines.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="engines" tabindex="-1">Engines <a class="header-anchor" href="#engines" aria-label="Permalink to &quot;Engines&quot;">​</a></h1><p>An engine makes the movements of the mouth from the phones and their times. All speak the same phones; <code>hello</code> lists them.</p><table tabindex="0"><thead><tr><th>name</th><th>what it is</th></tr></thead><tbody><tr><td><code>dominance</code></td><td>the default: a curve for each articulatory parameter in which neighbouring sounds blend (E. Leone, &quot;LUCIA-WebGL&quot;, after Cohen, Massaro, Cosi and Perin)</td></tr><tr><td><code>context</code></td><td>visemes that depend on the sounds around them, and a smooth way from one to the next (P. D. P. Costa, 2009, for Brazilian Portuguese). For languages with a table of such: <code>pt-BR</code>. Its rules are the source&#39;s; its shapes stand in until a speaker of the language has been measured</td></tr><tr><td><code>syllable</code></td><td>a shape for each letter by the vowel of its syllable, and a straight way from one to the next (E. Akagündüz, 2004, for Turkish); needs no phones from the voice. For languages with a table of letters: <code>tr</code>. Its rules are the source&#39;s; its shapes stand in until a speaker of the language has been measured</td></tr><tr><td><code>cohen-massaro</code></td><td>a baseline: the function of Cohen and Massaro (1993) as it was, its extents fitted to the same targets</td></tr><tr><td><code>table</code></td><td>a baseline: one target for each phone, reached in its middle, and half a cosine from one to the next</td></tr></tbody></table><p>Over any of them lies, or does not lie, the layer of contacts (<code>contacts</code>): whatever the engine and the expressions made of the lips, they touch in every bilabial (p b m), and the lower lip touches the upper teeth in every labiodental (f v), for at least 42 ms, with a ramp of 15 to 70 ms before and after it. Closures are what this layer makes, not an engine. Measured up to 320 words a minute, it makes all of them; at 500, 95.5 % in Turkish; and a <code>.fap</code> of 25 frames a second may not show one that lies between two frames. <code>engine</code>: as <code>facciad --contacts</code> says, and unless that says <code>on</code> or <code>off</code>, <code>dominance</code>, <code>context</code> and <code>syllable</code> have it and the two baselines do not. An unknown value is a <code>bad-field</code>.</p><p>An engine that lacks what it needs for a language is refused for it: <code>unknown-engine</code>.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("protocol/engines.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const engines = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  engines as default
};
