import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"What a screen reader reads, on a face","description":"","frontmatter":{},"headers":[],"relativePath":"home/screen-readers.md","filePath":"home/screen-readers.md"}');
const _sfc_main = { name: "home/screen-readers.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="what-a-screen-reader-reads-on-a-face" tabindex="-1">What a screen reader reads, on a face <a class="header-anchor" href="#what-a-screen-reader-reads-on-a-face" aria-label="Permalink to &quot;What a screen reader reads, on a face&quot;">​</a></h1><p><code>sd_faccia</code> is an output module of speech-dispatcher, and so a voice of Orca and of every program that speaks through it. Where somebody looks at the room&#39;s face (a page with <code>&lt;talking-head room=&quot;reader&quot;&gt;</code>, or <code>room.html?room=reader</code>), she says what is read, and her lips can be read along; where nobody does, the sound alone goes to speech-dispatcher, which plays it.</p><p>In <code>speechd.conf</code>, and the module in speech-dispatcher&#39;s folder of modules (<code>/usr/lib/speech-dispatcher-modules</code> in Debian):</p><div class="language- vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang"></span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>AddModule &quot;faccia&quot; &quot;sd_faccia&quot; &quot;faccia.conf&quot;</span></span>
<span class="line"><span>DefaultModule faccia</span></span></code></pre></div><p>In <code>modules/faccia.conf</code>, if it is other than this:</p><div class="language- vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang"></span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>FacciaUrl &quot;http://127.0.0.1:8080&quot;</span></span>
<span class="line"><span>FacciaRoom &quot;reader&quot;</span></span>
<span class="line"><span># FacciaTokenFile &quot;/etc/faccia/reader.token&quot;</span></span></code></pre></div><table tabindex="0"><thead><tr><th>of speech-dispatcher</th><th>here</th></tr></thead><tbody><tr><td>text (SSML) with index marks</td><td>spoken; marks are told as they are heard</td></tr><tr><td>stop, pause</td><td>at once; after a pause it goes on from the last mark</td></tr><tr><td>rate, pitch, volume</td><td>−100, 0, 100: 53, 160, 480 words a minute; half, as it is, double the pitch; a quarter, half, full volume</td></tr><tr><td>language, voice, voice type</td><td>the language; a voice by its id; female or male. What the daemon does not know is left out: it is spoken all the same, as is a text whose markup is broken</td></tr><tr><td>characters, spelling</td><td>letter by letter (<code>say-as</code>). A space alone is passed over</td></tr><tr><td>keys</td><td>read as words</td></tr><tr><td>sound icons</td><td>the sound of that name (<code>--audio</code> of the daemon), else its name</td></tr><tr><td>punctuation, capitals</td><td>as the language&#39;s reading has them; the setting is passed over</td></tr></tbody></table><p>Tried with Debian&#39;s speech-dispatcher 0.11.4 and <code>spd-say</code>, not with Orca.</p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("home/screen-readers.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const screenReaders = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  screenReaders as default
};
