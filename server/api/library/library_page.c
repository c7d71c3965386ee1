/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/library/library_page.h"
#include "server/base/mem.h"
#include <ctype.h>
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

/* Most marks drawn inside each other. Each line reopens the open ones, so this bounds the output. */
enum { MARKS_OPEN_MAX = 16 };

/* Order at one place: marks end, then notes stand, then marks begin. */
enum mark_edge { EDGE_END, EDGE_POINT, EDGE_START };

struct edge {
    size_t at; /* UTF-16 units */
    enum mark_edge kind;
    size_t number; /* index of the mark */
    const json_t *mark;
};

/* One pass over a block: its text, and the edges of its marks in text order. */
struct pass {
    struct buf *out;
    const char *text; /* the rest of the text */
    size_t at;        /* UTF-16 units before the rest */
    struct edge *edges;
    size_t count, next;
    const json_t *open[MARKS_OPEN_MAX];
    size_t depth;
    bool drawing;
};

static int compare_edges(const void *left, const void *right) {
    const struct edge *a = left, *b = right;
    if (a->at != b->at)
        return a->at < b->at ? -1 : 1;
    if (a->kind != b->kind)
        return a->kind < b->kind ? -1 : 1;
    int order = a->number < b->number ? -1 : a->number > b->number;
    return a->kind == EDGE_END ? -order : order; /* the mark opened last ends first */
}

static void put_edge(struct pass *p, const json_t *mark, size_t number, enum mark_edge kind) {
    size_t at = place_of(mark, kind == EDGE_END ? "end" : "start");
    p->edges[p->count++] = (struct edge){at, kind, number, mark};
}

static void pass_open(struct pass *p, struct buf *out, const json_t *block) {
    const json_t *marks = json_object_get(block, "marks"), *mark;
    size_t i;
    *p = (struct pass){.out = out, .text = text_of(block, "text")};
    p->edges = mem_alloc((2 * json_array_size(marks) + 1) * sizeof *p->edges);
    json_array_foreach(marks, i, mark) {
        const char *kind = text_of(mark, "kind");
        if (!strcmp(kind, "note")) {
            put_edge(p, mark, i, EDGE_POINT);
        } else if ((!strcmp(kind, "emphasis") || !strcmp(kind, "foreign") || !strcmp(kind, "stage")) &&
                   place_of(mark, "start") < place_of(mark, "end")) {
            put_edge(p, mark, i, EDGE_START);
            put_edge(p, mark, i, EDGE_END);
        }
    }
    qsort(p->edges, p->count, sizeof *p->edges, compare_edges);
}

static bool is_kind(const json_t *mark, const char *kind) {
    return !strcmp(text_of(mark, "kind"), kind);
}

static const char *element_of(const json_t *mark) {
    return is_kind(mark, "emphasis") ? "em" : is_kind(mark, "foreign") ? "i" : "span";
}

static void draw_start(struct pass *p, const json_t *mark) {
    if (p->drawing)
        open_tag(p->out, element_of(mark), is_kind(mark, "stage") ? "stage" : "", mark);
}

static void draw_end(struct pass *p, const json_t *mark) {
    if (p->drawing)
        buf_printf(p->out, "</%s>", element_of(mark));
}

/* Ends a mark. Marks opened after it are closed with it and reopened, because elements must nest. */
static void end_mark(struct pass *p, const json_t *mark) {
    size_t at = p->depth;
    while (at && p->open[at - 1] != mark)
        at--;
    if (!at)
        return; /* it was nested too deeply to be drawn */
    for (size_t i = p->depth; i >= at; i--)
        draw_end(p, p->open[i - 1]);
    p->depth--;
    for (size_t i = at - 1; i < p->depth; i++) {
        p->open[i] = p->open[i + 1];
        draw_start(p, p->open[i]);
    }
}

/* Handles the edges up to the current place; at that place, those up to kind `last`. */
static void pass_edges(struct pass *p, enum mark_edge last) {
    for (; p->next < p->count; p->next++) {
        const struct edge *e = &p->edges[p->next];
        if (e->at > p->at || (e->at == p->at && e->kind > last))
            return;
        if (e->kind == EDGE_END) {
            end_mark(p, e->mark);
        } else if (e->kind == EDGE_START && p->depth < MARKS_OPEN_MAX) {
            draw_start(p, e->mark);
            p->open[p->depth++] = e->mark;
        } else if (e->kind == EDGE_POINT && p->drawing) {
            add(p->out, "<a class=\"note-mark\" href=\"#");
            add_text(p->out, text_of(e->mark, "note"));
            add(p->out, "\">*</a>");
        }
    }
}

static void pass_text(struct pass *p, size_t to) {
    while (*p->text && p->at < to) {
        size_t size = 1;
        pass_edges(p, EDGE_START);
        while ((p->text[size] & 0xc0) == 0x80)
            size++;
        if (p->drawing)
            add_sign(p->out, p->text, size);
        p->at += size > 3 ? 2 : 1;
        p->text += size;
    }
}

/* Adds the text from one place to another, in UTF-16 units, with its marks. to SIZE_MAX: to the end.
 * Stretches of a block must come in order; a mark that spans two of them is closed and reopened. */
static void add_stretch(struct pass *p, size_t from, size_t to) {
    pass_text(p, from);
    pass_edges(p, EDGE_END);
    p->drawing = true;
    for (size_t i = 0; i < p->depth; i++)
        draw_start(p, p->open[i]);
    pass_text(p, to);
    pass_edges(p, EDGE_POINT);
    for (size_t i = p->depth; i-- > 0;)
        draw_end(p, p->open[i]);
    p->drawing = false;
}

static void add_block(struct buf *out, const json_t *block) {
    const char *kind = text_of(block, "kind");
    const json_t *lines = json_object_get(block, "lines"), *line;
    size_t i;
    const char *name = !strcmp(kind, "head") ? "h2" : "p";
    if (!strcmp(kind, "page"))
        return;
    struct pass pass;
    pass_open(&pass, out, block);
    open_tag(out, name, !strcmp(kind, "paragraph") || !strcmp(kind, "head") ? "" : kind, block);
    if (json_array_size(lines)) {
        json_array_foreach(lines, i, line) {
            open_tag(out, "span", "line", line);
            add_stretch(&pass, place_of(line, "start"), place_of(line, "end"));
            add(out, "</span>\n");
        }
    } else {
        add_stretch(&pass, 0, SIZE_MAX);
    }
    buf_printf(out, "</%s>\n", name);
    free(pass.edges);
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

/* A box to search in; it needs no script. */
static void add_search_box(struct buf *out, const char *query) {
    add(out, "<form class=\"find\" role=\"search\" action=\"/library\">"
             "<input type=\"search\" name=\"q\" required maxlength=\"1000\" aria-label=\"Search\" value=\"");
    add_text(out, query);
    add(out, "\"> <button aria-label=\"Search\">&rarr;</button></form>\n");
}

/* The text of a snippet, with its matches marked. */
static void add_snippet(struct buf *out, const json_t *snippet) {
    const json_t *marks = json_object_get(snippet, "marks"), *mark;
    struct pass pass;
    size_t i, at = 0;
    pass_open(&pass, out, snippet);
    json_array_foreach(marks, i, mark) {
        size_t start = (size_t)json_integer_value(json_array_get(mark, 0)),
               end = (size_t)json_integer_value(json_array_get(mark, 1));
        add_stretch(&pass, at, start);
        add(out, "<mark>");
        add_stretch(&pass, start, end);
        add(out, "</mark>");
        at = end;
    }
    add_stretch(&pass, at, SIZE_MAX);
    free(pass.edges);
}

/* Adds text for the query of an address. */
static void add_encoded(struct buf *out, const char *text) {
    for (; *text; text++)
        buf_printf(out, strchr("-_.~", *text) || isalnum((unsigned char)*text) ? "%c" : "%%%02X",
                   (unsigned char)*text);
}

static void add_results(struct buf *out, const json_t *answer) {
    const json_t *results = json_object_get(answer, "results"), *one;
    const json_t *titles = json_object_get(answer, "titles");
    size_t i;
    add_search_box(out, text_of(answer, "query"));
    buf_printf(out, "<p class=\"total\">%zu%s</p>\n", place_of(answer, "total"),
               json_is_true(json_object_get(answer, "counted")) ? "" : "+");
    if (json_array_size(titles)) {
        add(out, "<ul id=\"works\">\n");
        json_array_foreach(titles, i, one) {
            add(out, "<li>");
            add_link(out, text_of(one, "id"), 1, text_of(one, "title"));
            add(out, "</li>\n");
        }
        add(out, "</ul>\n");
    }
    add(out, "<ol id=\"found\">\n");
    json_array_foreach(results, i, one) {
        const json_t *work = json_object_get(one, "work"), *section = json_object_get(one, "section");
        add(out, "<li><a href=\"/library/");
        add_text(out, text_of(work, "id"));
        buf_printf(out, "/%zu#", place_of(section, "number"));
        add_text(out, text_of(one, "passage"));
        add(out, "\"><cite>");
        add_text(out, text_of(work, "title"));
        add(out, "</cite> ");
        add_text(out, text_of(section, "title"));
        add(out, "</a><p lang=\"");
        add_text(out, text_of(one, "lang"));
        add(out, "\">");
        add_snippet(out, json_object_get(one, "snippet"));
        add(out, "</p></li>\n");
    }
    add(out, "</ol>\n");
    if (*text_of(answer, "next")) {
        add(out, "<p><a rel=\"next\" href=\"/library?q=");
        add_encoded(out, text_of(answer, "query"));
        buf_printf(out, "&amp;after=%s\">\xe2\x86\x92</a></p>\n", text_of(answer, "next"));
    }
}

/* Lists works, or the sections of a work. */
static void add_list(struct buf *out, const json_t *answer) {
    const json_t *sections = json_object_get(answer, "sections");
    const json_t *works = json_object_get(answer, "works"), *item;
    size_t i;
    if (works)
        add_search_box(out, "");
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
    else if (json_object_get(answer, "results"))
        add_results(out, answer);
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
    [LIBRARY_AS_JSON] = "application/json",
    [LIBRARY_AS_PAGE] = "text/html; charset=utf-8",
    [LIBRARY_AS_OEMBED] = "application/json",
    [LIBRARY_AS_ATOM] = "application/atom+xml",
    [LIBRARY_AS_SITEMAP] = "application/xml",
    [LIBRARY_AS_BIBTEX] = "application/x-bibtex; charset=utf-8",
    [LIBRARY_AS_DUBLIN_CORE] = "application/xml",
    [LIBRARY_AS_OPDS] = "application/opds+json",
    [LIBRARY_AS_CSV] = "text/csv; charset=utf-8; header=present",
};

void library_page(enum library_form form, const char *base, const char *section, struct buf *answer) {
    static void (*const others[])(struct buf *, const json_t *, const char *) = {
        [LIBRARY_AS_PAGE] = add_page,
        [LIBRARY_AS_ATOM] = library_atom,
        [LIBRARY_AS_SITEMAP] = library_sitemap,
        [LIBRARY_AS_BIBTEX] = library_bibtex,
        [LIBRARY_AS_DUBLIN_CORE] = library_dublin_core,
        [LIBRARY_AS_OPDS] = library_opds,
        [LIBRARY_AS_CSV] = library_csv,
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
