import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Svelte 5","description":"","frontmatter":{},"headers":[],"relativePath":"frameworks/svelte.md","filePath":"frameworks/svelte.md"}');
const _sfc_main = { name: "frameworks/svelte.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="svelte-5" tabindex="-1">Svelte 5 <a class="header-anchor" href="#svelte-5" aria-label="Permalink to &quot;Svelte 5&quot;">​</a></h1><p>Name the attributes: <code>{...spread}</code> sets them as text when the script comes later.</p><div class="language-svelte vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">svelte</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">script</span><span class="cc50c31ba69">&gt;</span><span class="ccda0485202">let</span><span class="cc50c31ba69"> head;&lt;/</span><span class="cf98f533606">script</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="cfb14c55d4d">talking-head</span><span class="c838c4456c6"> bind</span><span class="cc50c31ba69">:</span><span class="c939a68f972">this</span><span class="c2d26d90b6d">=</span><span class="cc50c31ba69">{head} </span><span class="c91387ddaa9">src</span><span class="c2d26d90b6d">=</span><span class="c8be07ae4bd">&quot;ws://127.0.0.1:8080/v1/stream&quot;</span><span class="c91387ddaa9"> lang</span><span class="c2d26d90b6d">=</span><span class="c8be07ae4bd">&quot;it&quot;</span><span class="c91387ddaa9"> rate</span><span class="c2d26d90b6d">=</span><span class="cc50c31ba69">{</span><span class="c6d1bc78e57">180</span><span class="cc50c31ba69">} </span><span class="c91387ddaa9">captions</span><span class="c2d26d90b6d">=</span><span class="cc50c31ba69">{</span><span class="c6d1bc78e57">false</span><span class="cc50c31ba69">}</span></span>
<span class="line"><span class="c91387ddaa9">  onword</span><span class="c2d26d90b6d">=</span><span class="cc50c31ba69">{(</span><span class="c46d70a4716">event</span><span class="cc50c31ba69">) </span><span class="ccda0485202">=&gt;</span><span class="c91387ddaa9"> show</span><span class="cc50c31ba69">(event.detail.text)}&gt;&lt;/</span><span class="cf98f533606">talking-head</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">button</span><span class="c91387ddaa9"> onclick</span><span class="c2d26d90b6d">=</span><span class="cc50c31ba69">{() </span><span class="ccda0485202">=&gt;</span><span class="cc50c31ba69"> head.</span><span class="c91387ddaa9">speak</span><span class="cc50c31ba69">(</span><span class="c8be07ae4bd">&#39;Ciao.&#39;</span><span class="cc50c31ba69">)}&gt;Ciao&lt;/</span><span class="ce2f342ff08">button</span><span class="cc50c31ba69">&gt;</span></span></code></pre></div><p>Types of the template: <code>import &#39;@faccia/talking-head/svelte&#39;</code>.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("frameworks/svelte.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const svelte = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  svelte as default
};
