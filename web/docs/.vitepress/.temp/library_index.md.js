import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"A library that speaks","description":"","frontmatter":{},"headers":[],"relativePath":"library/index.md","filePath":"library/index.md"}');
const _sfc_main = { name: "library/index.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="a-library-that-speaks" tabindex="-1">A library that speaks <a class="header-anchor" href="#a-library-that-speaks" aria-label="Permalink to &quot;A library that speaks&quot;">​</a></h1><p><code>facciad --library FOLDER</code> serves a folder of works: TEI, EPUB, Markdown, plain text, APML, JSML and SSML. A recording of the same name beside a work (FLAC, WAV, Ogg, MP3) is aligned to its text.</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">build/server/app/faccia</span><span class="c8be07ae4bd"> library</span><span class="c8be07ae4bd"> models/library</span></span>
<span class="line"><span class="c91387ddaa9">sh</span><span class="c8be07ae4bd"> server/run.sh</span><span class="c6d1bc78e57"> --library</span><span class="c8be07ae4bd"> models/library</span></span>
<span class="line"><span class="c91387ddaa9">curl</span><span class="c8be07ae4bd"> &#39;http://127.0.0.1:8080/v1/library/search?q=amore&#39;</span></span>
<span class="line"><span class="c91387ddaa9">curl</span><span class="c8be07ae4bd"> &#39;http://127.0.0.1:8080/v1/speech?passage=mare:1:g1&amp;format=ogg&#39;</span><span class="c6d1bc78e57"> -o</span><span class="c8be07ae4bd"> verses.ogg</span></span></code></pre></div><p>The first command reads the folder and names what is wrong with line and column; the last one gets the speech of a passage.</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">build/server/app/faccia</span><span class="c8be07ae4bd"> library</span><span class="c8be07ae4bd"> export</span><span class="c8be07ae4bd"> models/library</span><span class="c8be07ae4bd"> mare</span><span class="c6d1bc78e57"> --epub</span><span class="c8be07ae4bd"> mare.epub</span></span></code></pre></div><p>makes a book that is heard and marked as it is read. Captions, TextGrid and <code>.fap</code> files come out, too.</p><ul><li><a href="/library.html" target="_self">The page of the library</a> is for reading and listening. Keys, a timer, wide spacing, the mouth alone, and what was opened stays for when there is no network: <a href="/docs/start/pages.html">The pages</a>.</li><li><code>/library</code> serves the same texts to those who run no script.</li><li>Texts and faces in other sites: <a href="/docs/library/embedding.html">Into your own site</a>.</li><li>The requests: <a href="/docs/library/protocol.html">Over HTTP</a>.</li></ul></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("library/index.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const index = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  index as default
};
