import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Vue 3","description":"","frontmatter":{},"headers":[],"relativePath":"frameworks/vue.md","filePath":"frameworks/vue.md"}');
const _sfc_main = { name: "frameworks/vue.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="vue-3" tabindex="-1">Vue 3 <a class="header-anchor" href="#vue-3" aria-label="Permalink to &quot;Vue 3&quot;">​</a></h1><p>Tell the Vue plugin, or the app, that the tag is no component of Vue: <code>compilerOptions.isCustomElement</code> has to know the name. These pages are made so.</p><div class="language-vue vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">vue</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">script</span><span class="c91387ddaa9"> setup</span><span class="cc50c31ba69">&gt;</span><span class="ccda0485202">import</span><span class="c2d26d90b6d"> { ref } </span><span class="ccda0485202">from</span><span class="cd7dbc59330"> &#39;vue&#39;</span><span class="c2d26d90b6d">; </span><span class="ccda0485202">const</span><span class="ca0311475a2"> head</span><span class="ccda0485202"> =</span><span class="c805c41d3ef"> ref</span><span class="c2d26d90b6d">(</span><span class="ca0311475a2">null</span><span class="c2d26d90b6d">);&lt;/</span><span class="c48ec3e897a">script</span><span class="c2d26d90b6d">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="cf98f533606">template</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">  &lt;</span><span class="cfb14c55d4d">talking-head</span><span class="c91387ddaa9"> ref</span><span class="c2d26d90b6d">=</span><span class="c8be07ae4bd">&quot;head&quot;</span><span class="c91387ddaa9"> src</span><span class="c2d26d90b6d">=</span><span class="c8be07ae4bd">&quot;ws://127.0.0.1:8080/v1/stream&quot;</span><span class="c91387ddaa9"> lang</span><span class="c2d26d90b6d">=</span><span class="c8be07ae4bd">&quot;it&quot;</span><span class="c165ded72f8"> :rate</span><span class="c6c7f347b39">=</span><span class="c2d15327af8">&quot;180&quot;</span><span class="c91387ddaa9"> captions</span><span class="c2d26d90b6d">=</span><span class="c8be07ae4bd">&quot;off&quot;</span><span class="c165ded72f8"> @word</span><span class="c6c7f347b39">=</span><span class="c2d15327af8">&quot;show($event.detail.text)&quot;</span><span class="cc50c31ba69"> /&gt;</span></span>
<span class="line"><span class="cc50c31ba69">  &lt;</span><span class="ce2f342ff08">button</span><span class="c165ded72f8"> @click</span><span class="c6c7f347b39">=</span><span class="c2d15327af8">&quot;head.speak(&#39;Ciao.&#39;)&quot;</span><span class="c6c7f347b39">&gt;Ciao&lt;/</span><span class="c91a38e7e45">button</span><span class="c6c7f347b39">&gt;</span></span>
<span class="line"><span class="c6c7f347b39">&lt;/</span><span class="c91a38e7e45">template</span><span class="c6c7f347b39">&gt;</span></span></code></pre></div><p>Types of the template: <code>import &#39;@faccia/talking-head/vue&#39;</code>.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("frameworks/vue.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const vue = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  vue as default
};
