import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Svelte 5","description":"","frontmatter":{},"headers":[],"relativePath":"frameworks/svelte.md","filePath":"frameworks/svelte.md"}');
const _sfc_main = { name: "frameworks/svelte.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="svelte-5" tabindex="-1">Svelte 5 <a class="header-anchor" href="#svelte-5" aria-label="Permalink to &quot;Svelte 5&quot;">​</a></h1><p>Name the attributes: <code>{...spread}</code> sets them as text when the script comes later.</p><div class="language-svelte vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">svelte</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">script</span><span class="cc50c31ba69">&gt;</span><span class="c752efeb453">let</span><span class="cc50c31ba69"> head;&lt;/</span><span class="cf98f533606">script</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="cf98f533606">talking-head</span><span class="c752efeb453"> bind</span><span class="cc50c31ba69">:</span><span class="c2ad9c62739">this</span><span class="cc50c31ba69">={head} </span><span class="c7b997ff61c">src</span><span class="cc50c31ba69">=</span><span class="c04d1a22d33">&quot;ws://127.0.0.1:8080/v1/stream&quot;</span><span class="c7b997ff61c"> lang</span><span class="cc50c31ba69">=</span><span class="c04d1a22d33">&quot;it&quot;</span><span class="c7b997ff61c"> rate</span><span class="cc50c31ba69">={</span><span class="c2ad9c62739">180</span><span class="cc50c31ba69">} </span><span class="c7b997ff61c">captions</span><span class="cc50c31ba69">={</span><span class="c2ad9c62739">false</span><span class="cc50c31ba69">}</span></span>
<span class="line"><span class="c7b997ff61c">  onword</span><span class="c2d26d90b6d">=</span><span class="cc50c31ba69">{(</span><span class="c4fe492e057">event</span><span class="cc50c31ba69">) </span><span class="c752efeb453">=&gt;</span><span class="c91387ddaa9"> show</span><span class="cc50c31ba69">(event.detail.text)}</span><span class="c2d26d90b6d">&gt;</span><span class="cc50c31ba69">&lt;/talking-head&gt;</span></span>
<span class="line"><span class="c752efeb453">&lt;</span><span class="c5aa627c567">button</span><span class="cc4c5c7138c"> onclick</span><span class="ccda0485202">=</span><span class="cc50c31ba69">{() </span><span class="c2d26d90b6d">=&gt;</span><span class="cc50c31ba69"> head.</span><span class="cc4c5c7138c">speak</span><span class="cc50c31ba69">(</span><span class="c8be07ae4bd">&#39;Ciao.&#39;</span><span class="c5b6ec9c184">)}&gt;Ciao&lt;/button&gt;</span></span></code></pre></div><p>Types of the template: <code>import &#39;@faccia/talking-head/svelte&#39;</code>.</p></div>`);
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
