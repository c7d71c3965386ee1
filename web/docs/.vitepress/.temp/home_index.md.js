import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Screens and desks","description":"","frontmatter":{},"headers":[],"relativePath":"home/index.md","filePath":"home/index.md"}');
const _sfc_main = { name: "home/index.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="screens-and-desks" tabindex="-1">Screens and desks <a class="header-anchor" href="#screens-and-desks" aria-label="Permalink to &quot;Screens and desks&quot;">​</a></h1><p><code>room.html?room=kitchen</code> is a face for a screen on the wall: it says what is said in that room, shows what it is doing (ready, listening, thinking, speaking, microphone off, not connected) in words and by a sign of its own shape, and offers answers as big buttons. A touch anywhere stops her; <code>1</code> to <code>8</code> answer. Further parameters: <code>lang</code> of the page, <code>model</code>, <code>view</code>, <code>clock</code>, <code>sleep=22-7</code> (dark and drawing nothing between those hours, until something happens or somebody touches it), <code>token</code>. The state <code>asleep</code> (a sensor&#39;s, by HTTP or MQTT) does the same by day: nobody is there. The screen is kept on where the browser allows it; the picture moves by a few pixels each minute so that it does not burn in; a lost daemon is found again. It can be installed (<code>room.webmanifest</code>). It takes Chrome 94, Firefox 93 or Safari 16.4: a tablet of 2018 that gets the updates of its browser (Chrome and WebView on Android 7 and later, iPadOS 17) has one; an older browser is told so on the screen. No tablet of that age was at hand to try it on.</p><p><code>operator.html?room=kitchen</code> is the desk of somebody who speaks through that face (a Wizard of Oz): free text, at once or waiting in a list that can still be changed; a scene of prepared lines with variants, moods, answers and where they lead (JSON as <code>/v1/schema/scene.json</code>, or CSV; kept in the browser and, with <code>--scenes FOLDER</code>, by the server, where what another desk has saved meanwhile is not overwritten); questions with answers; moods, states, rate and volume; hearing a text before others do; and a log of all that happened, who chose what and when, as CSV or JSON. Her mood is dragged on a disc. Several desks can be open: each sees who else is there (or only looks on), what is said in the room, and by whom (<code>operator.html?room=kitchen&amp;name=Anna</code>; where there are tokens, their subject). What was not said to its end is told.</p><p>A study asks first: the desk&#39;s button has the screen show what is written down, by whom, and that a no changes nothing; two big buttons (or <code>1</code> and <code>2</code>) answer. Until there is a yes, and after a no, the log has nothing of the listener: no answers, nothing that was heard, no touch; after a yes the screen shows that notes are taken, with a button to end that, and then what was noted of the listener is forgotten.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("home/index.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const index = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  index as default
};
