import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"React 19","description":"","frontmatter":{},"headers":[],"relativePath":"frameworks/react.md","filePath":"frameworks/react.md"}');
const _sfc_main = { name: "frameworks/react.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="react-19" tabindex="-1">React 19 <a class="header-anchor" href="#react-19" aria-label="Permalink to &quot;React 19&quot;">​</a></h1><p>Events are <code>on</code> and their name, in small letters.</p><div class="language-jsx vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">jsx</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="ccda0485202">import</span><span class="cd7dbc59330"> &#39;http://127.0.0.1:8080/talking-head.js&#39;</span><span class="c2d26d90b6d">; </span><span class="c251a9d2a5e">// or a copy of the built files</span></span>
<span class="line"><span class="ccda0485202">const</span><span class="ca0311475a2"> head</span><span class="ccda0485202"> =</span><span class="c805c41d3ef"> useRef</span><span class="c2d26d90b6d">(</span><span class="ca0311475a2">null</span><span class="c2d26d90b6d">);</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="c6d1bc78e57">talking-head</span><span class="c91387ddaa9"> ref</span><span class="ccda0485202">=</span><span class="cc50c31ba69">{head} </span><span class="c7b997ff61c">src</span><span class="c752efeb453">=</span><span class="c04d1a22d33">&quot;ws://127.0.0.1:8080/v1/stream&quot;</span><span class="c7b997ff61c"> lang</span><span class="c752efeb453">=</span><span class="c04d1a22d33">&quot;it&quot;</span><span class="c7b997ff61c"> rate</span><span class="c752efeb453">=</span><span class="cc50c31ba69">{</span><span class="c2ad9c62739">180</span><span class="cc50c31ba69">} </span><span class="c7b997ff61c">captions</span><span class="c752efeb453">=</span><span class="cc50c31ba69">{</span><span class="c2ad9c62739">false</span><span class="cc50c31ba69">} </span><span class="c7b997ff61c">expression</span><span class="c752efeb453">=</span><span class="cc50c31ba69">{{ joy: </span><span class="c2ad9c62739">0.6</span><span class="cc50c31ba69"> }}</span></span>
<span class="line"><span class="c7b997ff61c">  onword</span><span class="ccda0485202">=</span><span class="cc50c31ba69">{(</span><span class="c4fe492e057">event</span><span class="cc50c31ba69">) </span><span class="c752efeb453">=&gt;</span><span class="cc50c31ba69"> console.</span><span class="c7b997ff61c">log</span><span class="cc50c31ba69">(event.detail.text)} </span><span class="c7b997ff61c">onend</span><span class="ccda0485202">=</span><span class="cc50c31ba69">{(</span><span class="c4fe492e057">event</span><span class="cc50c31ba69">) </span><span class="c752efeb453">=&gt;</span><span class="cc50c31ba69"> console.</span><span class="c7b997ff61c">log</span><span class="cc50c31ba69">(event.detail.reason)} </span><span class="c2d26d90b6d">/&gt;</span></span>
<span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">button</span><span class="c91387ddaa9"> onClick</span><span class="ccda0485202">=</span><span class="cc50c31ba69">{() </span><span class="ccda0485202">=&gt;</span><span class="cc50c31ba69"> head.current.</span><span class="c7b997ff61c">speak</span><span class="cc50c31ba69">(</span><span class="c04d1a22d33">&#39;Ciao.&#39;</span><span class="cc50c31ba69">)}&gt;Ciao&lt;/</span><span class="cf98f533606">button</span><span class="cc50c31ba69">&gt;</span></span></code></pre></div><p>Types of the template: <code>import &#39;@faccia/talking-head/react&#39;</code>.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("frameworks/react.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const react = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  react as default
};
