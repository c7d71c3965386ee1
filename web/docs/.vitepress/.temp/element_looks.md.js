import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Looks and captions","description":"","frontmatter":{},"headers":[],"relativePath":"element/looks.md","filePath":"element/looks.md"}');
const _sfc_main = { name: "element/looks.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="looks-and-captions" tabindex="-1">Looks and captions <a class="header-anchor" href="#looks-and-captions" aria-label="Permalink to &quot;Looks and captions&quot;">​</a></h1><p>Parts and custom properties are in <a href="/docs/element/reference.html#looks">the reference</a>.</p><h2 id="captions" tabindex="-1">Captions <a class="header-anchor" href="#captions" aria-label="Permalink to &quot;Captions&quot;">​</a></h2><p>They show what is said, word by word on the audio&#39;s clock, in pieces for which there are two lines of room. Of marked-up text they show the words, not the tags. Said, present and coming words have a contrast of more than 4.5 : 1 in all the colours that can be chosen; the present word has a ground of its own and is underlined. Where the system chooses the colours (<code>forced-colors</code>), it has those of selected text, and a frame.</p><h2 id="content-security-policy" tabindex="-1">Content security policy <a class="header-anchor" href="#content-security-policy" aria-label="Permalink to &quot;Content security policy&quot;">​</a></h2><p>The strictest one that it works under, with the address of your own server. The element makes no markup from text (no Trusted Types policy is needed), has its styles in a constructed sheet, and its audio worklet in a file beside the script.</p><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>default-src &#39;none&#39;; script-src http://127.0.0.1:8080; style-src &#39;self&#39;;</span></span>
<span class="line"><span>connect-src http://127.0.0.1:8080 ws://127.0.0.1:8080;</span></span>
<span class="line"><span>img-src http://127.0.0.1:8080;</span></span>
<span class="line"><span>require-trusted-types-for &#39;script&#39;; trusted-types &#39;none&#39;</span></span></code></pre></div><p><code>img-src</code> is for the poster, which is left out where it is forbidden. <code>script-src</code> concerns the worklet, too; where that is forbidden the page itself does its work (<code>sound</code>: <code>on</code>, <code>no-worklet</code>). Browsers that cannot decode Opus by themselves (no WebCodecs) need <code>&#39;wasm-unsafe-eval&#39;</code> for the decoder in <code>opus-decoder.js</code>; without it they ask the server for PCM, which is many times the bytes. A frame of another origin needs <code>allow=&quot;autoplay&quot;</code>, or a tap in it.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("element/looks.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const looks = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  looks as default
};
