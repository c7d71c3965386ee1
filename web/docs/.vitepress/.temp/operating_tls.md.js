import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"TLS","description":"","frontmatter":{},"headers":[],"relativePath":"operating/tls.md","filePath":"operating/tls.md"}');
const _sfc_main = { name: "operating/tls.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="tls" tabindex="-1">TLS <a class="header-anchor" href="#tls" aria-label="Permalink to &quot;TLS&quot;">​</a></h1><p>Browsers keep the microphone, the camera, a screen that stays on and use without a network for pages that come by HTTPS.</p><p>With a certificate of your own: <code>--tls-cert FILE --tls-key FILE</code>. SIGHUP reads both again.</p><p>In a home, the daemon makes one:</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">sh</span><span class="c8be07ae4bd"> server/run.sh</span><span class="c6d1bc78e57"> --tls-self-signed</span><span class="c8be07ae4bd"> tls</span></span></code></pre></div><p>The folder <code>tls</code> then holds the certificate and <code>ca.pem</code>. A device trusts the daemon once it has taken <code>ca.pem</code> as a certificate authority, whose key nobody has. Other machines that come without TLS are sent to <code>https:</code>. <code>--hsts SECONDS</code> tells browsers to use nothing else.</p><p>Behind a proxy that has a certificate, three lines of Caddy do, and the daemon is told <code>--host-name example.org</code>:</p><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>example.org {</span></span>
<span class="line"><span>    reverse_proxy 127.0.0.1:8080</span></span>
<span class="line"><span>}</span></span></code></pre></div></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("operating/tls.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const tls = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  tls as default
};
