import { ssrRenderAttrs, ssrRenderAttr } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const _imports_0 = "/docs/pictures/people.webp";
const _imports_1 = "/docs/pictures/portrait.webp";
const _imports_2 = "/docs/pictures/mouth.png";
const __pageData = JSON.parse('{"title":"Choose a head","description":"","frontmatter":{},"headers":[],"relativePath":"heads/index.md","filePath":"heads/index.md"}');
const _sfc_main = { name: "heads/index.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="choose-a-head" tabindex="-1">Choose a head <a class="header-anchor" href="#choose-a-head" aria-label="Permalink to &quot;Choose a head&quot;">​</a></h1><p>Eight people can speak, each with a voice that suits:</p><p><img${ssrRenderAttr("src", _imports_0)} alt="Eight people: Mara, Bruno, Rosa, Ettore, Amina, Samuel, Mei and Luca"></p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">build/server/app/faccia</span><span class="c8be07ae4bd"> models</span></span></code></pre></div><p>Other heads:</p><table tabindex="0"><thead><tr><th>head</th><th>how</th></tr></thead><tbody><tr><td>a new person of our kind</td><td><a href="/docs/heads/making.html#a-new-head">a recipe of a page</a></td></tr><tr><td>from one photograph</td><td><a href="/avatar.html" target="_self">the page of portraits</a>, in the browser; the picture stays there. An approximation, not a likeness: <a href="/docs/heads/making.html#a-head-from-a-photograph">what carries over</a></td></tr><tr><td>a GLB, VRM, FBX, OBJ, PLY or VRML97 file</td><td><code>faccia head import</code>: <a href="/docs/heads/making.html#heads-of-other-origin">heads of other origin</a></td></tr><tr><td>a GLB or VRM as it is, on the page</td><td><code>&lt;talking-head avatar=&quot;anna.vrm&quot;&gt;</code>: <a href="/docs/element/avatars.html">Avatars</a></td></tr><tr><td>photographs, without WebGL</td><td><a href="/docs/heads/pictures.html">Sets of pictures</a></td></tr><tr><td>a head of yours with somebody&#39;s measures</td><td><a href="/docs/heads/model.html#calibration">Calibration</a></td></tr></tbody></table><p>Heads go out, too, as GLB and VRM for other programs:</p><div class="language-sh vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">sh</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span class="c91387ddaa9">build/server/app/faccia</span><span class="c8be07ae4bd"> head</span><span class="c8be07ae4bd"> export</span><span class="c8be07ae4bd"> mara</span><span class="c6d1bc78e57"> --vrm</span><span class="c8be07ae4bd"> mara.vrm</span></span></code></pre></div><p><img${ssrRenderAttr("src", _imports_1)} alt="A photograph, and the head made of it: at rest, saying a, turned"></p><p>(Eileen Collins, photographed by NASA.)</p><p>Curves for other engines: <a href="/docs/heads/arkit.html">ARKit</a>, <a href="/docs/heads/visemes.html">visemes</a>. A speaker&#39;s own lips, from film or markers: <a href="/docs/heads/lips.html">Lips</a>.</p><h2 id="what-is-seen-of-the-mouth" tabindex="-1">What is seen of the mouth <a class="header-anchor" href="#what-is-seen-of-the-mouth" aria-label="Permalink to &quot;What is seen of the mouth&quot;">​</a></h2><p>Teeth and tongue lie where anatomy has them, and show what a lip reader looks for, counted in pixels for every sound of four languages: <a href="/docs/heads/making.html#what-is-seen-of-teeth-and-tongue">what is seen of teeth and tongue</a>.</p><p><img${ssrRenderAttr("src", _imports_2)} alt="Twelve mouths: p b m, f v, th, t d n, l, s z, sh, i, e, a, o, u"></p></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("heads/index.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const index = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  index as default
};
