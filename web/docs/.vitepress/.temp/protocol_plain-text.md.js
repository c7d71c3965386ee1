import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Plain text","description":"","frontmatter":{},"headers":[],"relativePath":"protocol/plain-text.md","filePath":"protocol/plain-text.md"}');
const _sfc_main = { name: "protocol/plain-text.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="plain-text" tabindex="-1">Plain text <a class="header-anchor" href="#plain-text" aria-label="Permalink to &quot;Plain text&quot;">​</a></h1><p>With the sub-protocol <code>faccia.text.v1</code> both sides send lines of text, and no media come. A line is spoken, with the defaults of the address; one that begins with <code>/</code> is a command (<code>//</code> speaks a line that begins with <code>/</code>):</p><p><code>/stop</code> · <code>/pause</code> · <code>/resume</code> · <code>/jump MARK</code> · <code>/play NAME</code> · <code>/interrupt TEXT</code> · <code>/replace TEXT</code> · <code>/join ROOM</code> · <code>/leave</code> · <code>/token TOKEN</code> · <code>/mood AFFECT [INTENSITY] ...</code> · <code>/help</code>, and for the lines that follow <code>/lang</code>, <code>/voice</code>, <code>/rate</code>, <code>/pitch</code>, <code>/volume</code>, <code>/engine</code>, <code>/markup</code>, <code>/phones</code>, each with a value.</p><p>The answers are the messages of the other protocol, their type and what matters of them, times in seconds: <code>hello SERVER</code>, <code>begin VOICE</code>, <code>sentence TIME DURATION</code>, <code>word TIME TEXT</code>, <code>mark TIME NAME</code>, <code>phone TIME IPA</code>, <code>paused [TIME]</code>, <code>resumed [TIME]</code>, <code>jumped TIME MARK</code>, <code>warning</code> and <code>error CODE [FIELD] MESSAGE</code>, <code>end REASON DURATION</code>, <code>joined ROOM</code>, <code>left ROOM</code>, <code>authorized SUBJECT</code>.</p><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>&gt; La mamma parla.</span></span>
<span class="line"><span>&lt; begin espeak:it+f2</span></span>
<span class="line"><span>&lt; word 0.000 La</span></span>
<span class="line"><span>&lt; word ... mamma</span></span>
<span class="line"><span>&lt; end done ...</span></span>
<span class="line"><span>&gt; /dance</span></span>
<span class="line"><span>&lt; error unknown-command ...</span></span>
<span class="line"><span>&gt; /lang xx</span></span>
<span class="line"><span>&gt; Ciao.</span></span>
<span class="line"><span>&lt; error unknown-language lang ...</span></span>
<span class="line"><span>&lt; end failed ...</span></span></code></pre></div></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("protocol/plain-text.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const plainText = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  plainText as default
};
