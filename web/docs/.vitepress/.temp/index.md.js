import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"","description":"","frontmatter":{"layout":"home","hero":{"name":"faccia","text":"A face that speaks","tagline":"Send a text; a browser shows a head that speaks it, with lips that can be read.","image":{"src":"/pictures/picture.png","alt":"Mara speaks","with captions":null},"actions":[{"text":"Start here","link":"/start/"},{"text":"On a page","link":"/start/page","theme":"alt"},{"text":"Protocol","link":"/protocol/","theme":"alt"}]},"features":[{"title":"On any page","details":"One script and one element. Works with React, Vue and Svelte.","link":"/element/"},{"title":"In a kitchen","details":"A screen on the wall, a desk to speak from, MQTT and Home Assistant.","link":"/home/"},{"title":"From a script","details":"curl gets sound, face animation and timing of a text.","link":"/start/script"},{"title":"A library that speaks","details":"TEI, EPUB and Markdown to read, search and hear.","link":"/library/"},{"title":"Marked up","details":"APML, JSML, SSML, EmotionML, BML and FML move the face and the voice.","link":"/markup/"},{"title":"Measured","details":"Every figure with its command and its reference.","link":"/research/"}]},"headers":[],"relativePath":"index.md","filePath":"index.md"}');
const _sfc_main = { name: "index.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("index.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const index = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  index as default
};
