import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Limits","description":"","frontmatter":{},"headers":[],"relativePath":"protocol/limits.md","filePath":"protocol/limits.md"}');
const _sfc_main = { name: "protocol/limits.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="limits" tabindex="-1">Limits <a class="header-anchor" href="#limits" aria-label="Permalink to &quot;Limits&quot;">​</a></h1><p><code>hello.limits</code> states those in force; these are the defaults (options of <code>facciad</code> change them).</p><table tabindex="0"><thead><tr><th>member</th><th>default</th><th>what</th></tr></thead><tbody><tr><td><code>text_bytes</code></td><td>100000</td><td>the text of one <code>speak</code> or of one <code>POST</code></td></tr><tr><td><code>message_bytes</code></td><td>262144</td><td>one message of the client; one 16 times as long ends the connection, 1009</td></tr><tr><td><code>queue</code></td><td>32</td><td>utterances that wait on one stream</td></tr><tr><td><code>open</code></td><td>8</td><td>texts that one client may be writing at a time</td></tr><tr><td><code>connections</code></td><td>1000</td><td>open connections</td></tr><tr><td><code>rooms</code></td><td>100</td><td>rooms that have somebody in them</td></tr><tr><td><code>play_bytes</code></td><td>16777216</td><td>an uploaded recording; the <code>.fap</code> file of one in the folder</td></tr></tbody></table><p>Not stated, as few clients come near them: <code>--max-per-address</code> and <code>--max-requests</code> (none), <code>--send-bytes</code> (262144: unsent media for one client at which its stream waits, or, in a room, moves it on), <code>--lag-seconds</code> (5: media that wait for longer move him on in a room, too), <code>--send-bytes-max</code> (4194304: it is closed, <code>too-slow</code>), <code>--stall-seconds</code> (10: a client that takes nothing for so long is closed), <code>--ping-seconds</code> (30: a socket that is silent for so long is pinged, RFC 6455, 5.5.2, and closed when it stays so for a third longer; browsers answer by themselves), <code>--hold</code> (0: so many seconds what is said in an empty room waits for somebody), <code>--max-voices</code> (16) and <code>--voice-seconds</code> (2): see <a href="/docs/protocol/own-voice.html#somebodys-own-voice">Somebody&#39;s own voice</a>.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("protocol/limits.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const limits = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  limits as default
};
