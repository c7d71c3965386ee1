import { ssrRenderAttrs, ssrRenderAttr } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const _imports_0 = "/docs/pictures/library.webp";
const __pageData = JSON.parse('{"title":"In a portal","description":"","frontmatter":{},"headers":[],"relativePath":"start/portal.md","filePath":"start/portal.md"}');
const _sfc_main = { name: "start/portal.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="in-a-portal" tabindex="-1">In a portal <a class="header-anchor" href="#in-a-portal" aria-label="Permalink to &quot;In a portal&quot;">​</a></h1><p>A folder of texts becomes a library to read, search and hear. Check it first; the program names what is wrong with line and column:</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">build/server/app/faccia</span><span class="c8be07ae4bd"> library</span><span class="c8be07ae4bd"> models/library</span></span></code></pre></div><p>Then serve it, and search in it:</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">sh</span><span class="c8be07ae4bd"> server/run.sh</span><span class="c6d1bc78e57"> --library</span><span class="c8be07ae4bd"> models/library</span></span>
<span class="line"><span class="c91387ddaa9">curl</span><span class="c8be07ae4bd"> &#39;http://127.0.0.1:8080/v1/library/search?q=amore&#39;</span></span></code></pre></div><p><code>library.html</code> is the page for reading and listening; <code>/library</code> needs no script. Put a text with its face into another site with a frame, a link (oEmbed) or the element: <a href="/docs/library/embedding.html">Into your own site</a>. Formats and options: <a href="/docs/library/">A library that speaks</a>.</p><p><img${ssrRenderAttr("src", _imports_0)} alt="A poem with line numbers; beside it the face that reads it, and the buttons to go on, repeat, see the mouth alone"></p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("start/portal.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const portal = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  portal as default
};
