import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Gestures","description":"","frontmatter":{},"headers":[],"relativePath":"markup/gestures.md","filePath":"markup/gestures.md"}');
const _sfc_main = { name: "markup/gestures.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="gestures" tabindex="-1">Gestures <a class="header-anchor" href="#gestures" aria-label="Permalink to &quot;Gestures&quot;">​</a></h1><p>A gesture is a stretch of face movement with a name, which texts ask for: <code>&lt;gesture name=&quot;wink&quot;/&gt;</code> in APML and JSML, <code>&lt;faccia:gesture name=&quot;wink&quot;/&gt;</code> in SSML, <code>&amp;lt;gesture lexeme=&quot;WINK&quot;/&gt;</code> in BML (<a href="/docs/markup/elements.html">protocol/markup.md</a>). Each is a file of this folder, or of the operator&#39;s own (<code>--gestures DIR</code>; there a gesture takes the place of one here that has its name). The Face Player (<code>/player.html</code>) makes such files of a stretch that was drawn or spoken. <code>faccia expressions --kind gesture</code> lists them.</p><p>The file is read strictly: what is wrong with it is said with its path, such as <code>curves.head_roll[3]</code>, and nothing starts. <code>../gestures.schema.json</code> says the same for editors.</p><table tabindex="0"><thead><tr><th>key</th><th>meaning</th><th>if left out</th></tr></thead><tbody><tr><td><code>format</code>, <code>version</code></td><td><code>faccia-gesture</code>, 1</td><td></td></tr><tr><td><code>name</code></td><td>by which texts ask for it: small letters, figures, hyphens, 48 at most</td><td></td></tr><tr><td><code>about</code></td><td>for people</td><td></td></tr><tr><td><code>fps</code></td><td>frames a second of the curves, 1 to 60</td><td></td></tr><tr><td><code>blend</code></td><td>seconds in which it comes (<code>in</code>) and goes (<code>out</code>), at least 0.08; the curves need not begin and end at rest</td><td>0.2, 0.3</td></tr><tr><td><code>mouth</code></td><td>the part of its mouth that stays while she speaks, 0 to 1: <code>lips</code> (with the jaw), <code>corners</code></td><td>0.3, 0.7</td></tr><tr><td><code>curves</code></td><td>FAPs by their names (without a side: both), each a list of 3 to 600 values in FAP units, all of one length, 10 s at most</td><td></td></tr></tbody></table><p>It is added to what the face does. Lips that must close do so whatever it asks for. Eyes stay on the listener when the head moves, unless a curve moves the eyes. One that does not fit before the end of its sentence begins earlier; one that is longer than the sentence is made faster and smaller. At most 256 in all.</p><p>Those here were drawn by us, as splines through a few points: bow, brow-flash, look-down, look-left, look-right, look-up, nod-twice, roll-eyes, shake-slowly, shrug, think, wink.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("markup/gestures.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const gestures = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  gestures as default
};
