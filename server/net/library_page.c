/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/library_page.h"
#include "server/net/library_meta.h"
#include <jansson.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static void add(struct buf *out, const char *html) {
    buf_add(out, html, strlen(html));
}

static void add_sign(struct buf *out, const char *at, size_t size) {
    if (*at == '<')
        add(out, "&lt;");
    else if (*at == '>')
        add(out, "&gt;");
    else if (*at == '&')
        add(out, "&amp;");
    else if (*at == '"')
        add(out, "&quot;");
    else
        buf_add(out, at, size);
}

static void add_text(struct buf *out, const char *text) {
    for (; text && *text; text++)
        add_sign(out, text, 1);
}

static const char *text_of(const json_t *object, const char *name) {
    const char *text = json_string_value(json_object_get(object, name));
    return text ? text : "";
}

static size_t place_of(const json_t *object, const char *name) {
    return (size_t)json_integer_value(json_object_get(object, name));
}

/* <NAME id="..." lang="..."> */
static void open_tag(struct buf *out, const char *name, const char *class, const json_t *block) {
    const char *id = text_of(block, "id"), *lang = text_of(block, "lang");
    buf_printf(out, "<%s", name);
    if (*class)
        buf_printf(out, " class=\"%s\"", class);
    if (*id) {
        add(out, " id=\"");
        add_text(out, id);
        add(out, "\"");
    }
    if (*lang) {
        add(out, " lang=\"");
        add_text(out, lang);
        add(out, "\"");
    }
    add(out, ">");
}

static void add_mark(struct buf *out, const json_t *mark, size_t at) {
    const char *kind = text_of(mark, "kind");
    size_t start = place_of(mark, "start"), end = place_of(mark, "end");
    bool emphasis = !strcmp(kind, "emphasis"), foreign = !strcmp(kind, "foreign");
    if (!strcmp(kind, "note") && start == at) {
        add(out, "<a class=\"note-mark\" href=\"#");
        add_text(out, text_of(mark, "note"));
        add(out, "\">*</a>");
    } else if (start < end && end == at && (emphasis || foreign)) {
        add(out, emphasis ? "</em>" : "</i>");
    } else if (start < end && start == at && emphasis) {
        add(out, "<em>");
    } else if (start < end && start == at && foreign) {
        open_tag(out, "i", "", mark);
    }
}

/* The text from one place to another, in UTF-16 units, with its marks; to: SIZE_MAX = its end. */
static void add_stretch(struct buf *out, const json_t *block, size_t from, size_t to) {
    const char *text = text_of(block, "text");
    const json_t *marks = json_object_get(block, "marks"), *mark;
    size_t at = 0, i;
    for (bool more = true; more && at <= to;) {
        size_t size = 1;
        while (*text && (text[size] & 0xc0) == 0x80)
            size++;
        json_array_foreach(marks, i, mark) if (at >= from && place_of(mark, "start") >= from &&
                                               (at < to || place_of(mark, "end") == at))
            add_mark(out, mark, at);
        more = *text;
        if (more && at >= from && at < to)
            add_sign(out, text, size);
        at += size > 3 ? 2 : 1;
        text += more ? size : 0;
    }
}

static void add_block(struct buf *out, const json_t *block) {
    const char *kind = text_of(block, "kind");
    const json_t *lines = json_object_get(block, "lines"), *line;
    size_t i;
    const char *name = !strcmp(kind, "head") ? "h2" : "p";
    if (!strcmp(kind, "page"))
        return;
    open_tag(out, name, !strcmp(kind, "paragraph") || !strcmp(kind, "head") ? "" : kind, block);
    if (json_array_size(lines)) {
        json_array_foreach(lines, i, line) {
            open_tag(out, "span", "line", line);
            add_stretch(out, block, place_of(line, "start"), place_of(line, "end"));
            add(out, "</span>\n");
        }
    } else {
        add_stretch(out, block, 0, SIZE_MAX);
    }
    buf_printf(out, "</%s>\n", name);
}

static void add_link(struct buf *out, const char *work, long long section, const char *text) {
    add(out, "<a href=\"/library/");
    add_text(out, work);
    if (section > 0)
        buf_printf(out, "/%lld", section);
    add(out, "\">");
    add_text(out, text);
    add(out, "</a>");
}

static void add_sound(struct buf *out, const char *id, bool recording) {
    add(out, "<p><audio controls preload=\"none\" src=\"/v1/speech?passage=");
    add_text(out, id);
    buf_printf(out, "&amp;format=ogg%s\"></audio></p>\n", recording ? "&amp;voice=recording" : "");
}

static void add_section(struct buf *out, const json_t *section) {
    const json_t *work = json_object_get(section, "work"), *blocks = json_object_get(section, "blocks"),
                 *block;
    const char *id = text_of(work, "id"), *title = text_of(work, "title");
    size_t i;
    add(out, "<p class=\"crumbs\"><a href=\"/library\">&#8962;</a> &rsaquo; ");
    add_link(out, id, 0, title);
    add(out, " &middot; ");
    add_text(out, text_of(work, "author"));
    add(out, " &middot; <a href=\"/library.html?at=");
    add_text(out, text_of(section, "id"));
    add(out, "\">faccia</a></p>\n");
    if (json_is_object(json_object_get(section, "recording")))
        add_sound(out, text_of(section, "id"), true);
    add_sound(out, text_of(section, "id"), false);
    add(out, "<div id=\"passage\" lang=\"");
    add_text(out, text_of(work, "lang"));
    add(out, "\">\n");
    json_array_foreach(blocks, i, block) add_block(out, block);
    add(out, "</div>\n<nav class=\"turn\" aria-label=\"&#8596;\">");
    static const char *const ways[][2] = {{"previous", "\xe2\x86\x90"}, {"next", "\xe2\x86\x92"}};
    for (i = 0; i < 2; i++) {
        const json_t *to = json_object_get(section, ways[i][0]);
        if (json_is_integer(to))
            add_link(out, id, json_integer_value(to), ways[i][1]);
    }
    add(out, "</nav>\n");
}

/* Works of a list, sections of a work. */
static void add_list(struct buf *out, const json_t *answer) {
    const json_t *sections = json_object_get(answer, "sections");
    const json_t *works = json_object_get(answer, "works"), *item;
    size_t i;
    add(out, "<ul id=\"works\">\n");
    json_array_foreach(works, i, item) {
        add(out, "<li>");
        add_link(out, text_of(item, "id"), 1, text_of(item, "title"));
        add(out, "</li>\n");
    }
    json_array_foreach(sections, i, item) {
        const char *title = text_of(item, "title");
        add(out, "<li>");
        add_link(out, text_of(answer, "id"), (long long)place_of(item, "number"),
                 *title ? title : text_of(item, "id"));
        add(out, "</li>\n");
    }
    add(out, "</ul>\n");
    if (*text_of(answer, "id")) {
        buf_printf(out, "<p class=\"cite\"><a href=\"/library/%s.bib\">BibTeX</a> &middot; ",
                   text_of(answer, "id"));
        buf_printf(out, "<a href=\"/library/%s.xml\">Dublin Core</a></p>\n", text_of(answer, "id"));
    } else {
        add(out, "<p class=\"cite\"><a href=\"/library/feed.xml\">Atom</a></p>\n");
    }
}

static void add_page(struct buf *out, const json_t *answer, const char *base) {
    const json_t *work = json_object_get(answer, "work");
    const char *id = text_of(answer, "id"), *title = text_of(answer, "title"),
               *lang = text_of(work ? work : answer, "lang");
    add(out, "<!doctype html>\n<html lang=\"");
    add_text(out, *lang ? lang : "en");
    add(out, "\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, "
             "initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<title>");
    add_text(out, *title ? title : *id ? id : "faccia");
    add(out,
        "</title>\n<link rel=\"icon\" href=\"/icon.svg\">\n<link rel=\"stylesheet\" href=\"/page.css\">\n"
        "<link rel=\"stylesheet\" href=\"/library.css\">\n");
    if (*id) {
        const char *of = work ? text_of(work, "id") : id;
        add(out, "<link rel=\"alternate\" type=\"application/json+oembed\" href=\"");
        add_text(out, base);
        add(out, "/oembed?format=json&amp;url=");
        add_text(out, base);
        add(out, "/library/");
        add_text(out, of);
        if (work)
            buf_printf(out, "/%zu", place_of(answer, "number"));
        add(out, "\">\n");
    }
    library_head(out, answer, base);
    const char *name = text_of(work ? work : answer, "title");
    add(out, "</head>\n<body><main><div class=\"reading\">\n<h1>");
    add_text(out, *name ? name : "faccia");
    add(out, "</h1>\n");
    if (json_object_get(answer, "blocks"))
        add_section(out, answer);
    else
        add_list(out, answer);
    add(out, "</div></main></body>\n</html>\n");
}

static void add_oembed(struct buf *out, const json_t *work, const char *base, const char *section) {
    struct buf html = {0};
    add(&html, "<iframe src=\"");
    add_text(&html, base);
    add(&html, "/library.html?embed&amp;at=");
    add_text(&html, text_of(work, "id"));
    add(&html, ":");
    add_text(&html, section ? section : "1");
    add(&html, "\" width=\"640\" height=\"720\" allow=\"autoplay\" title=\"");
    add_text(&html, text_of(work, "title"));
    add(&html, "\"></iframe>");
    buf_add(&html, "", 1);
    json_t *answer =
        json_pack("{ss,ss,ss,ss,ss,ss,si,si,ss}", "version", "1.0", "type", "rich", "provider_name", "faccia",
                  "provider_url", base, "title", text_of(work, "title"), "author_name",
                  text_of(work, "author"), "width", 640, "height", 720, "html", (char *)html.data);
    char *text = json_dumps(answer, JSON_COMPACT);
    add(out, text ? text : "{}");
    free(text);
    json_decref(answer);
    buf_free(&html);
}

const char *const library_types[] = {
    [LIBRARY_AS_JSON] = "application/json",       [LIBRARY_AS_PAGE] = "text/html; charset=utf-8",
    [LIBRARY_AS_OEMBED] = "application/json",     [LIBRARY_AS_ATOM] = "application/atom+xml",
    [LIBRARY_AS_SITEMAP] = "application/xml",     [LIBRARY_AS_BIBTEX] = "application/x-bibtex; charset=utf-8",
    [LIBRARY_AS_DUBLIN_CORE] = "application/xml",
};

void library_page(enum library_form form, const char *base, const char *section, struct buf *answer) {
    static void (*const others[])(struct buf *, const json_t *, const char *) = {
        [LIBRARY_AS_PAGE] = add_page,
        [LIBRARY_AS_ATOM] = library_atom,
        [LIBRARY_AS_SITEMAP] = library_sitemap,
        [LIBRARY_AS_BIBTEX] = library_bibtex,
        [LIBRARY_AS_DUBLIN_CORE] = library_dublin_core,
    };
    json_t *json = json_loadb((const char *)answer->data, answer->size, 0, NULL);
    if (!json)
        return;
    struct buf out = {0};
    if (form == LIBRARY_AS_OEMBED)
        add_oembed(&out, json, base, section);
    else
        others[form](&out, json, base);
    json_decref(json);
    buf_free(answer);
    *answer = out;
}
