import { resolveComponent, useSSRContext } from "vue";
import { ssrRenderAttrs, ssrRenderComponent } from "vue/server-renderer";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"On a page","description":"","frontmatter":{},"headers":[],"relativePath":"start/page.md","filePath":"start/page.md"}');
const _sfc_main = { name: "start/page.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  const _component_LiveFace = resolveComponent("LiveFace");
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="on-a-page" tabindex="-1">On a page <a class="header-anchor" href="#on-a-page" aria-label="Permalink to &quot;On a page&quot;">​</a></h1><p>Put one script and one element into the page:</p><div class="language-html vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">html</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">script</span><span class="c91387ddaa9"> type</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;module&quot;</span><span class="c91387ddaa9"> src</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;http://127.0.0.1:8080/talking-head.js&quot;</span><span class="cc50c31ba69">&gt;&lt;/</span><span class="ce2f342ff08">script</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">talking-head</span><span class="c91387ddaa9"> id</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;face&quot;</span><span class="c91387ddaa9"> src</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;ws://127.0.0.1:8080/v1/stream&quot;</span><span class="c91387ddaa9"> lang</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;it&quot;</span><span class="cc50c31ba69">&gt;&lt;/</span><span class="ce2f342ff08">talking-head</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">button</span><span class="c91387ddaa9"> onclick</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;</span><span class="cc50c31ba69">face</span><span class="c8be07ae4bd">.</span><span class="c91387ddaa9">speak</span><span class="c8be07ae4bd">(&#39;Buongiorno a tutti!&#39;)&quot;</span><span class="cc50c31ba69">&gt;Parla&lt;/</span><span class="ce2f342ff08">button</span><span class="cc50c31ba69">&gt;</span></span></code></pre></div>`);
  _push(ssrRenderComponent(_component_LiveFace, {
    text: "Buongiorno a tutti!",
    lang: "it",
    label: "Parla"
  }, null, _parent));
  _push(`<p>A page of another origin has to be allowed: start the daemon with <code>--origin https://example.org</code> (<code>--origin null</code> for files). If something is wrong, the picture says so, and an <code>error</code> event names the <a href="/docs/element/reference.html#events">reason</a>.</p><p>Then:</p><ul><li>choose who speaks: <code>model=&quot;bruno&quot;</code>, or a head of your own: <code>avatar=&quot;anna.vrm&quot;</code> (<a href="/docs/element/avatars.html">Avatars</a>);</li><li>set a mood: <code>expression=&quot;joy 0.6&quot;</code>;</li><li>speak a text while a language model writes it: <code>face.open(response.body)</code>;</li><li>have it read your article: <code>for=&quot;text&quot;</code> and <code>read()</code> (<a href="/docs/element/reading.html">Reading the page</a>);</li><li>use it in <a href="/docs/frameworks/">React, Vue or Svelte</a>.</li></ul><p>Try all of it, with source to copy, in the <a href="/examples.html" target="_self">examples</a>.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("start/page.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const page = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  page as default
};
