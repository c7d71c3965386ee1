import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"How things are read","description":"","frontmatter":{},"headers":[],"relativePath":"markup/reading.md","filePath":"markup/reading.md"}');
const _sfc_main = { name: "markup/reading.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="how-things-are-read" tabindex="-1">How things are read <a class="header-anchor" href="#how-things-are-read" aria-label="Permalink to &quot;How things are read&quot;">​</a></h1><p>A text may say how a stretch of it is to be read (<code>say-as</code>: a date, a sum of money, an address of the net...). These files hold the words for that, one JSON file for each language, named in <code>meson.build</code>; a new language is a new file. Digits, telephone numbers, names and addresses need no file. <code>../normalization.schema.json</code> is their schema. The numbers themselves are left to the voice, which knows how to say them.</p><table tabindex="0"><thead><tr><th>key</th><th>meaning</th></tr></thead><tbody><tr><td><code>tag</code></td><td>BCP 47 tag; all varieties of the language are read so</td></tr><tr><td><code>decimal</code>, <code>thousands</code></td><td>the characters in its numbers</td></tr><tr><td><code>plus</code>, <code>and</code></td><td>words; <code>and</code> stands before the last of several parts</td></tr><tr><td><code>order</code></td><td>of day, month and year in a date of three numbers whose order is not given: <code>dmy</code>, <code>mdy</code> or <code>ymd</code></td></tr><tr><td><code>months</code></td><td>the twelve, as they stand in a date</td></tr><tr><td><code>ordinal</code></td><td><code>words</code>: first, second... as many as there are; <code>rules</code>: for other numbers, an ending of the digits and what to write, <code>{n}</code> being the number; the first that fits counts</td></tr><tr><td><code>fraction</code>, <code>parts</code></td><td><code>parts</code>: names of one and of several parts by the number below the line; <code>fraction</code>: for other numbers, with <code>{n}</code> and <code>{d}</code></td></tr><tr><td><code>date</code></td><td>templates by the fields that there are (<code>dmy dm my d m y</code>): <code>{d}</code> the day, <code>{nth}</code> as an ordinal, <code>{m}</code> the month&#39;s name, <code>{y}</code>; <code>first</code>: the word for the first day of a month, where it is an ordinal</td></tr><tr><td><code>time</code></td><td>templates: <code>h</code> full hour, <code>hm</code>, <code>h0m</code> less than ten minutes past, <code>hms</code>; <code>am</code>, <code>pm</code></td></tr><tr><td><code>duration</code></td><td>names of one and of several hours, minutes, seconds</td></tr><tr><td><code>currencies</code></td><td>by ISO 4217 code: <code>signs</code> that stand for it, <code>name</code> and <code>cent</code> of one and of several</td></tr><tr><td><code>units</code></td><td>by symbol: names of one and of several</td></tr><tr><td><code>net</code></td><td>names of the signs in addresses</td></tr></tbody></table></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("markup/reading.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const reading = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  reading as default
};
