import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Where phones are heard","description":"","frontmatter":{},"headers":[],"relativePath":"voices/boundaries.md","filePath":"voices/boundaries.md"}');
const _sfc_main = { name: "voices/boundaries.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="where-phones-are-heard" tabindex="-1">Where phones are heard <a class="header-anchor" href="#where-phones-are-heard" aria-label="Permalink to &quot;Where phones are heard&quot;">​</a></h1><p>A voice says when each of its phones begins. Some say so too early or too late: labels were set by a rule of their own, or by a machine. <code>boundaries.json</code> has by how much, measured beside the sound, and the voice stage moves the boundaries there before the face is made; words and marks go with them. A voice that the table does not name keeps its times. <code>--boundaries own</code> (<code>voices.boundaries</code>, <code>FACCIA_BOUNDARIES</code>) leaves all as they are.</p><table tabindex="0"><thead><tr><th>key</th><th>meaning</th></tr></thead><tbody><tr><td><code>sounds</code></td><td>letters of the IPA, by a name. A phone is told by its last letter where it stands before a boundary, by its first where it stands behind it; marks of length and the like do not count: a vowel before /tʃ/ is one before a stop, /tʃ/ before a vowel is a hiss before it</td></tr><tr><td><code>voices</code></td><td>by the voice&#39;s id (<code>faccia voices</code>), a list of rules, of which the first that fits counts</td></tr><tr><td><code>before</code>, <code>after</code></td><td>names of sounds: what ends before the boundary, what begins behind it</td></tr><tr><td><code>ms</code></td><td>by so much later than the voice says it is heard; less than 0: earlier. -60 to 60</td></tr></tbody></table><p>A phone gives at most a third of its time on either side, so that phones go on touching in their order and the sentence lasts as long as before.</p><p>A new voice is a new entry: written by hand, or measured in 25 sentences of its language, which <code>tests/lib/sentences.mjs</code> has for it, pt-BR, tr and en:</p><pre><code>node tests/bench/run.mjs phones --write models/boundaries.json festival:lp
</code></pre><p>An entry is made where at least 8 boundaries lie 6 ms or more from what is heard there in the median, and where a correction that is learned from every other sentence takes off at least a tenth of the mean error in those between, and the reverse. Looked for are: hisses that begin (their energy from 3.5 kHz up) and end, closures of stops (fall of the energy below 3.5 kHz; voiced ones from 0.9 kHz), nasals, and the instant at which /p/ and /b/ let go, which is to lie as long before the phone&#39;s end as the packs let go of the lips (30 and 12 ms, <code>contact.release</code> in <code>speech/it.json</code>). What is left after it, voice by voice: <code>../tests/bench/README.md</code>.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("voices/boundaries.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const boundaries = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  boundaries as default
};
