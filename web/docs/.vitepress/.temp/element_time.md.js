import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"How it keeps time","description":"","frontmatter":{},"headers":[],"relativePath":"element/time.md","filePath":"element/time.md"}');
const _sfc_main = { name: "element/time.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="how-it-keeps-time" tabindex="-1">How it keeps time <a class="header-anchor" href="#how-it-keeps-time" aria-label="Permalink to &quot;How it keeps time&quot;">​</a></h1><p>The audio clock drives the face. Samples go to a ring buffer in an AudioWorklet (a ScriptProcessor where pages are not secure), which reports when it starts and stops; with <code>getOutputTimestamp</code> this gives the sample that is heard now, at any moment, and the face is that of the FAP frames round it, interpolated at the display&#39;s rate. When samples are late both wait; nothing drifts.</p><p>A picture shows the face for the sample that is heard when the picture is seen, not when it is begun. Pictures are drawn one at a time, so that this can be foreseen: a fence tells when the last ones were done, and the next takes as long (the median of five; those that come with new captions are counted apart, and captions change with a picture only). Browsers left to themselves queue up to three pictures where drawing is slow, and the face is late by all of them.</p><p>Where there is no graphics processor, it is triangles that take the time: once a head is drawn, it is gone through for vertices that the picture&#39;s points are too large to show, and drawn without them. Then it is looked at from the front in a few poses: what nobody can see from there (skin under hair and cloth, hair behind hair, teeth behind closed lips) is left out as long as the face looks at the viewer, more or less. In <code>high</code> each point is drawn once there, not four times: edges are made soft afterwards where the depth leaps, and the ends of hair are drawn over what stands. When <code>quality</code> changes, the picture as it was lies on top and fades in a quarter of a second; <code>auto</code> goes below <code>low</code> only where pictures come sooner for it.</p><h2 id="the-living-face" tabindex="-1">The living face <a class="header-anchor" href="#the-living-face" aria-label="Permalink to &quot;The living face&quot;">​</a></h2><p>While nobody speaks the server sends an idle face (blinks, gaze, breath, small movements of the head) and the element shows it, as long as it is connected, on the visible part of the page, the page is not hidden, and the face is not to keep <code>still</code> (then for a mood only, without any movement). Idling is drawn some thirty times a second, speech at the display&#39;s rate. Idle media are shown on the page&#39;s clock, 0.15 s behind their coming; from idling to speech and back the face goes over within 90 ms (mouth) and 250 ms (the rest), whatever the two show.</p><p><code>emotion.html</code> is a page that plays with it: a disc of emotions, live on the face, with the mixture as markup and as FAP values.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("element/time.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const time = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  time as default
};
