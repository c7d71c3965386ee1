import { resolveComponent, useSSRContext } from "vue";
import { ssrRenderAttrs, ssrRenderComponent } from "vue/server-renderer";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"The element","description":"","frontmatter":{},"headers":[],"relativePath":"element/index.md","filePath":"element/index.md"}');
const _sfc_main = { name: "element/index.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  const _component_LiveFace = resolveComponent("LiveFace");
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="the-element" tabindex="-1">The element <a class="header-anchor" href="#the-element" aria-label="Permalink to &quot;The element&quot;">​</a></h1><p><code>&lt;talking-head&gt;</code> shows a head that speaks what it is told. The server makes speech and face (MPEG-4 FAPs); the element draws the head with WebGL 2, plays the sound and shows captions. It is one file without dependencies. Further files lie beside it and are fetched when they are needed: the audio worklet (<code>talking-head-worklet.js</code>), a decoder for browsers that have none (<code>opus-decoder.js</code>), what draws avatars (<code>talking-head-avatar.js</code>, and <code>talking-head-draco.js</code> and <code>talking-head-basis.js</code> for packed ones). Its types are in <code>talking-head.d.ts</code>.</p><div class="language-html vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">html</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">script</span><span class="c91387ddaa9"> type</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;module&quot;</span><span class="c91387ddaa9"> src</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;http://127.0.0.1:8080/talking-head.js&quot;</span><span class="cc50c31ba69">&gt;&lt;/</span><span class="ce2f342ff08">script</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">talking-head</span><span class="c91387ddaa9"> src</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;ws://127.0.0.1:8080/v1/stream&quot;</span><span class="c91387ddaa9"> lang</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;it&quot;</span><span class="cc50c31ba69">&gt;&lt;/</span><span class="ce2f342ff08">talking-head</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">script</span><span class="c91387ddaa9"> type</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;module&quot;</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="ccda0485202">  const</span><span class="ca0311475a2"> head</span><span class="ccda0485202"> =</span><span class="c2d26d90b6d"> document.</span><span class="c805c41d3ef">querySelector</span><span class="c2d26d90b6d">(</span><span class="cd7dbc59330">&#39;talking-head&#39;</span><span class="c2d26d90b6d">);</span></span>
<span class="line"><span class="cc50c31ba69">  head.</span><span class="c91387ddaa9">addEventListener</span><span class="cc50c31ba69">(</span><span class="c8be07ae4bd">&#39;word&#39;</span><span class="c5b6ec9c184">, ({ </span><span class="c5f3017eff7">detail</span><span class="c5b6ec9c184"> }) </span><span class="cc4cdec74ac">=&gt;</span><span class="c5b6ec9c184"> console.</span><span class="c21655cb302">log</span><span class="c5b6ec9c184">(detail.text));</span></span>
<span class="line"><span class="cc4cdec74ac">  await</span><span class="c5b6ec9c184"> head.</span><span class="c21655cb302">speak</span><span class="c5b6ec9c184">(</span><span class="c8be07ae4bd">&#39;</span><span class="c04d1a22d33">Nel mezzo del cammin di nostra vita</span><span class="c8be07ae4bd">&#39;</span><span class="c5b6ec9c184">)</span><span class="c6c7f347b39">;</span></span>
<span class="line"><span class="c2d26d90b6d">&lt;/</span><span class="cf98f533606">script</span><span class="c2d26d90b6d">&gt;</span></span></code></pre></div>`);
  _push(ssrRenderComponent(_component_LiveFace, {
    text: "Nel mezzo del cammin di nostra vita",
    lang: "it",
    label: "Parla"
  }, null, _parent));
  _push(`<p>If the element cannot work, its picture says what to do, in the element&#39;s language, and an <code>error</code> event comes at once. A page of another host, or one that is a file, needs <code>facciad --origin ORIGIN</code> (<code>--origin null</code> for files); a server with tokens wants <code>token</code>. Content of the element (<code>&lt;talking-head&gt;Text&lt;/talking-head&gt;</code>) is shown until the script has come.</p><ul><li><a href="/docs/element/reference.html">Attributes, methods, events</a>, and their <a href="/docs/element/api.html">types</a></li><li><a href="/docs/element/reading.html">Reading the page</a>, <a href="/docs/element/listening.html">Voices without a text</a></li><li><a href="/docs/element/looks.html">Looks and captions</a>, with the strictest content security policy that it works under</li><li><a href="/docs/element/avatars.html">Avatars</a> and <a href="/docs/element/pictures.html">pictures</a> in place of the server&#39;s head</li><li><a href="/docs/element/time.html">How it keeps time</a></li><li><a href="/examples.html" target="_self">Live examples</a> of each attribute, method and event</li></ul><p>From npm: <code>@faccia/talking-head</code>, which <code>node web/package/pack.mjs build/npm/talking-head</code> makes.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("element/index.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const index = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  index as default
};
