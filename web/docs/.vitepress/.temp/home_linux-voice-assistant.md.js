import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"A face for Linux Voice Assistant","description":"","frontmatter":{},"headers":[],"relativePath":"home/linux-voice-assistant.md","filePath":"home/linux-voice-assistant.md"}');
const _sfc_main = { name: "home/linux-voice-assistant.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="a-face-for-linux-voice-assistant" tabindex="-1">A face for Linux Voice Assistant <a class="header-anchor" href="#a-face-for-linux-voice-assistant" aria-label="Permalink to &quot;A face for Linux Voice Assistant&quot;">​</a></h1><p><code>faccia-lva</code> is a peripheral of Linux Voice Assistant: it listens to its peripheral API and shows in a room what the assistant does. One line starts it:</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">faccia-lva</span><span class="c6d1bc78e57"> --assistant</span><span class="c8be07ae4bd"> ws://192.168.1.3:6055</span><span class="c6d1bc78e57"> --room</span><span class="c8be07ae4bd"> kitchen</span><span class="c6d1bc78e57"> --lang</span><span class="c8be07ae4bd"> it</span></span></code></pre></div><table tabindex="0"><thead><tr><th>the assistant tells</th><th>the room shows</th></tr></thead><tbody><tr><td><code>wake_word_detected</code>, <code>listening</code></td><td><code>listening</code></td></tr><tr><td><code>stt_text</code>, <code>thinking</code></td><td><code>thinking</code>, with what was understood</td></tr><tr><td><code>tts_text</code></td><td>its text as the <a href="/docs/protocol/rooms.html#choices-and-states">state</a>&#39;s; or the face says it, where the assistant is silent itself: its volume is 0 or muted (<code>--speak silent</code>, the default; <code>always</code>, <code>never</code>)</td></tr><tr><td><code>tts_finished</code>, <code>idle</code></td><td><code>idle</code></td></tr><tr><td><code>muted</code></td><td><code>muted</code>, until it is taken back</td></tr><tr><td><code>pipeline_error</code>, <code>timer_ringing</code></td><td>the reason, the timer&#39;s name</td></tr></tbody></table><p>A connection that ends is made again. Tested beside a stand-in that speaks the API&#39;s text; the assistant itself is packaged nowhere and was not tried.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("home/linux-voice-assistant.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const linuxVoiceAssistant = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  linuxVoiceAssistant as default
};
