import { resolveComponent, useSSRContext } from "vue";
import { ssrRenderAttrs, ssrRenderAttr, ssrRenderComponent } from "vue/server-renderer";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const _imports_0 = "/docs/pictures/picture.png";
const __pageData = JSON.parse('{"title":"What faccia is","description":"","frontmatter":{},"headers":[],"relativePath":"start/index.md","filePath":"start/index.md"}');
const _sfc_main = { name: "start/index.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  const _component_LiveFace = resolveComponent("LiveFace");
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="what-faccia-is" tabindex="-1">What faccia is <a class="header-anchor" href="#what-faccia-is" aria-label="Permalink to &quot;What faccia is&quot;">​</a></h1><p>faccia is a talking-head server. The daemon, <code>facciad</code>, takes a text. A voice plugin speaks it, a model of coarticulation works out what lips, jaw and tongue do, an expression engine moves brows, eyes and head, and browsers draw the head with WebGL. The head is sent once. After that only sound and MPEG-4 face animation parameters (FAPs) travel.</p><p><img${ssrRenderAttr("src", _imports_0)} alt="Mara speaks the first lines of the Divine Comedy, with captions"></p>`);
  _push(ssrRenderComponent(_component_LiveFace, {
    text: "Hello. I am Mara. I say what you send me.",
    lang: "en"
  }, null, _parent));
  _push(`<h2 id="two-commands" tabindex="-1">Two commands <a class="header-anchor" href="#two-commands" aria-label="Permalink to &quot;Two commands&quot;">​</a></h2><p>On Debian 12:</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">sh</span><span class="c8be07ae4bd"> server/run.sh</span></span></code></pre></div><p>installs what is missing, builds, and starts the daemon; then open <a href="http://127.0.0.1:8080/" target="_blank" rel="noreferrer">http://127.0.0.1:8080/</a>. Options of <code>facciad</code> may follow, such as <code>--port 9000</code>.</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">sh</span><span class="c8be07ae4bd"> tests/run.sh</span></span></code></pre></div><p>installs, builds and runs every test. Both commands are quick when there is nothing to do.</p><p>The daemon listens on this machine only. <a href="/docs/operating/">Run it</a> tells how to let other machines in.</p><h2 id="where-to-go" tabindex="-1">Where to go <a class="header-anchor" href="#where-to-go" aria-label="Permalink to &quot;Where to go&quot;">​</a></h2><table tabindex="0"><thead><tr><th>you want</th><th>read</th></tr></thead><tbody><tr><td>a face on your page</td><td><a href="/docs/start/page.html">On a page</a></td></tr><tr><td>a screen that speaks to people at home</td><td><a href="/docs/start/kitchen.html">In a kitchen</a></td></tr><tr><td>sound, timing or animation from a program</td><td><a href="/docs/start/script.html">From a script</a></td></tr><tr><td>texts that are read aloud in a portal</td><td><a href="/docs/start/portal.html">In a portal</a></td></tr><tr><td>to change faccia</td><td><a href="/docs/architecture/contributing.html">Contributing</a></td></tr></tbody></table><p>Languages with a speech pack of their own are Italian, Brazilian Portuguese, Turkish and English. Every other language that a voice speaks moves the lips by the International Phonetic Alphabet: <code>build/server/app/faccia voices</code> lists them.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("start/index.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const index = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  index as default
};
