import { resolveComponent, useSSRContext } from "vue";
import { ssrRenderAttrs, ssrRenderComponent, ssrRenderAttr } from "vue/server-renderer";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const _imports_0 = "/docs/pictures/emotions.webp";
const __pageData = JSON.parse('{"title":"Mark up a text","description":"","frontmatter":{},"headers":[],"relativePath":"markup/index.md","filePath":"markup/index.md"}');
const _sfc_main = { name: "markup/index.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  const _component_LiveFace = resolveComponent("LiveFace");
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="mark-up-a-text" tabindex="-1">Mark up a text <a class="header-anchor" href="#mark-up-a-text" aria-label="Permalink to &quot;Mark up a text&quot;">​</a></h1><p>A marked-up text says how it is to be spoken and what the face shows. The kind is recognised: APML, JSML, SSML (not all of it), EmotionML, BML, FML.</p><div class="language-xml vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">xml</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="cc50c31ba69">&lt;</span><span class="ce2f342ff08">speak</span><span class="c91387ddaa9"> xml:lang</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;it&quot;</span><span class="cc50c31ba69">&gt;Buongiorno! &lt;</span><span class="ce2f342ff08">emotion</span><span class="cc50c31ba69">&gt;&lt;</span><span class="ce2f342ff08">category</span><span class="c91387ddaa9"> name</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;happiness&quot;</span><span class="cc50c31ba69">/&gt;Che bella sorpresa!&lt;/</span><span class="ce2f342ff08">emotion</span><span class="cc50c31ba69">&gt;</span></span>
<span class="line"><span class="cc50c31ba69">  &lt;</span><span class="ce2f342ff08">break</span><span class="c91387ddaa9"> time</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;300ms&quot;</span><span class="cc50c31ba69">/&gt; &lt;</span><span class="ce2f342ff08">emphasis</span><span class="c91387ddaa9"> level</span><span class="cc50c31ba69">=</span><span class="c8be07ae4bd">&quot;strong&quot;</span><span class="cc50c31ba69">&gt;Davvero&lt;/</span><span class="ce2f342ff08">emphasis</span><span class="cc50c31ba69">&gt; bella.&lt;/</span><span class="ce2f342ff08">speak</span><span class="cc50c31ba69">&gt;</span></span></code></pre></div>`);
  _push(ssrRenderComponent(_component_LiveFace, {
    lang: "it",
    label: "Parla",
    markup: "ssml",
    text: "<speak xml:lang='it'>Buongiorno! <emotion><category name='happiness'/>Che bella sorpresa!</emotion> <break time='300ms'/> <emphasis level='strong'>Davvero</emphasis> bella.</speak>"
  }, null, _parent));
  _push(`<p><code>faccia check</code> names what in a text would not be acted on, with line and column; <code>faccia say</code> speaks it:</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c6d1bc78e57">printf</span><span class="c8be07ae4bd"> &#39;%s\\n&#39;</span><span class="c8be07ae4bd"> &#39;&lt;speak xml:lang=&quot;it&quot;&gt;Buongiorno! &lt;emphasis&gt;Davvero&lt;/emphasis&gt;.&lt;/speak&gt;&#39;</span><span class="ccda0485202"> &gt;</span><span class="c8be07ae4bd"> letter.xml</span></span>
<span class="line"><span class="c91387ddaa9">build/server/app/faccia</span><span class="c8be07ae4bd"> check</span><span class="c8be07ae4bd"> letter.xml</span></span>
<span class="line"><span class="c91387ddaa9">build/server/app/faccia</span><span class="c8be07ae4bd"> say</span><span class="c6d1bc78e57"> --lang</span><span class="c8be07ae4bd"> tr</span><span class="c8be07ae4bd"> &#39;&lt;SENT&gt;&lt;HAPPY&gt;Merhaba&lt;/HAPPY&gt;, benim adım Mara.&lt;/SENT&gt;&#39;</span><span class="c6d1bc78e57"> --wav</span><span class="c8be07ae4bd"> a.wav</span><span class="c6d1bc78e57"> --fap</span><span class="c8be07ae4bd"> a.fap</span></span></code></pre></div><ul><li><a href="/docs/markup/elements.html">What each element does</a> to the voice and to the face. The voice follows as far as its engine can: Festival&#39;s emotions are factors of rate and pitch, and its <code>slt</code> has no pitch.</li><li><a href="/docs/markup/expressions.html">Expressions</a> are data: a new entry in <code>models/expressions.json</code> can be asked for by name in every markup.</li><li><a href="/docs/markup/gestures.html">Gestures</a> are files with a name: <code>&lt;gesture name=&quot;wink&quot;/&gt;</code>.</li><li><a href="/docs/markup/lexicons.html">Lexicons</a> say how names are spoken.</li><li>The <a href="/editor.html" target="_self">editor</a> marks up a text by selecting words; the <a href="/player.html" target="_self">Face Player</a> makes gestures.</li></ul><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">build/server/app/faccia</span><span class="c8be07ae4bd"> expressions</span></span></code></pre></div><p><img${ssrRenderAttr("src", _imports_0)} alt="Six emotions on one face: joy, sadness, anger, fear, disgust, surprise"></p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("markup/index.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const index = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  index as default
};
