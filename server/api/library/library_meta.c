/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/library/library_page.h"
#include "server/base/json/error_json.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char *text_of(const json_t *object, const char *name) {
    const char *text = json_string_value(json_object_get(object, name));
    return text ? text : "";
}

static const char *title_of(const json_t *work) {
    const char *title = text_of(work, "title");
    return *title ? title : text_of(work, "id");
}

/* Escapes text for XML or HTML. Control characters, which XML does not allow, become spaces. */
/* A member as text; NULL: it is missing or null. */
static json_t *known(const json_t *work, const char *name) {
    return *text_of(work, name) ? json_string(text_of(work, name)) : NULL;
}

static void library_escape(struct buf *out, const char *text) {
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        const char *entity = c == '&'   ? "&amp;"
                             : c == '<' ? "&lt;"
                             : c == '>' ? "&gt;"
                             : c == '"' ? "&quot;"
                                        : NULL;
        if (entity)
            buf_add(out, entity, strlen(entity));
        else
            buf_add(out, c < ' ' ? " " : text, 1);
    }
}

static void element(struct buf *out, const char *name, const char *text) {
    if (!*text)
        return;
    buf_printf(out, "<%s>", name);
    library_escape(out, text);
    buf_printf(out, "</%s>\n", name);
}

/* Writes the escaped address of a work or one of its sections (0: the work). */
static void put_address(struct buf *out, const char *base, const char *work, unsigned section) {
    library_escape(out, base);
    buf_printf(out, "/library/%s", work);
    if (section)
        buf_printf(out, "/%u", section);
}

void library_atom(struct buf *out, const json_t *newest, const char *base) {
    const json_t *works = json_object_get(newest, "works"), *work;
    const char *last = text_of(json_array_get(works, 0), "updated");
    size_t i;
    buf_printf(
        out,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<feed xmlns=\"http://www.w3.org/2005/Atom\">\n<id>");
    library_escape(out, base);
    buf_printf(out, "/library</id>\n<title>faccia</title>\n<updated>%s</updated>\n<link rel=\"self\" href=\"",
               *last ? last : "1970-01-01T00:00:00Z");
    library_escape(out, base);
    buf_printf(out, "/library/feed.xml\"/>\n<link rel=\"alternate\" type=\"text/html\" href=\"");
    library_escape(out, base);
    buf_printf(out, "/library\"/>\n<author><name>faccia</name></author>\n");
    json_array_foreach(works, i, work) {
        const char *id = text_of(work, "id");
        buf_printf(out, "<entry xml:lang=\"");
        library_escape(out, text_of(work, "lang"));
        buf_printf(out, "\">\n<id>");
        put_address(out, base, id, 0);
        buf_printf(out, "</id>\n<title>");
        library_escape(out, title_of(work));
        buf_printf(out, "</title>\n<updated>%s</updated>\n", text_of(work, "updated"));
        if (*text_of(work, "author")) {
            buf_printf(out, "<author><name>");
            library_escape(out, text_of(work, "author"));
            buf_printf(out, "</name></author>\n");
        }
        buf_printf(out, "<link rel=\"alternate\" type=\"text/html\" href=\"");
        put_address(out, base, id, 0);
        buf_printf(out, "\"/>\n<summary>");
        library_escape(out, title_of(work));
        buf_printf(out, "</summary>\n</entry>\n");
    }
    buf_printf(out, "</feed>\n");
}

void library_sitemap(struct buf *out, const json_t *newest, const char *base) {
    const json_t *work;
    size_t i;
    buf_printf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<urlset "
                    "xmlns=\"http://www.sitemaps.org/schemas/sitemap/0.9\">\n");
    json_array_foreach(json_object_get(newest, "works"), i, work) {
        buf_printf(out, "<url><loc>");
        put_address(out, base, text_of(work, "id"), 0);
        buf_printf(out, "</loc><lastmod>%s</lastmod></url>\n", text_of(work, "updated"));
    }
    buf_printf(out, "</urlset>\n");
}

/* Escapes the special characters of TeX; the rest stays UTF-8, as biber expects. Braces become commands:
 * BibTeX counts even escaped ones, so "\\{" would leave the field open. */
/* Adds a work to a catalogue, once. */
static void add_publication(json_t *list, json_t *seen, const json_t *work, const char *base) {
    const char *id = text_of(work, "id");
    if (json_object_get(seen, id))
        return;
    json_object_set_new(seen, id, json_true());
    json_array_append_new(
        list, json_pack("{s{ss so ss so* so* so*} s[{ss so ss}] s[{so ss}]}", "metadata", "@type",
                        "http://schema.org/Book", "identifier", json_sprintf("%s/library/%s", base, id),
                        "title", title_of(work), "author", known(work, "author"), "language",
                        known(work, "lang"), "published", known(work, "date"), "links", "rel",
                        "http://opds-spec.org/acquisition/open-access", "href",
                        json_sprintf("%s/library/%s", base, id), "type", "text/html", "images", "href",
                        json_sprintf("%s/icon-512.png", base), "type", "image/png"));
}

void library_opds(struct buf *out, const json_t *list, const char *base) {
    static const char type[] = "application/opds+json";
    json_t *publications = json_array(), *links = json_array(), *seen = json_object(), *work;
    const json_t *titles = json_object_get(list, "titles"),
                 *found = json_object_get(json_object_get(list, "facets"), "work");
    size_t i;
    json_array_foreach(json_object_get(list, "works"), i, work)
        add_publication(publications, seen, work, base);
    json_array_foreach(titles, i, work) add_publication(publications, seen, work, base);
    json_array_foreach(found, i, work)
        add_publication(publications, seen, json_object_get(work, "value"), base);
    json_array_append_new(links, json_pack("{ss so ss}", "rel", "self", "href",
                                           json_sprintf("%s/library/opds.json", base), "type", type));
    json_array_append_new(links, json_pack("{ss so ss sb}", "rel", "search", "href",
                                           json_sprintf("%s/library/opds.json{?query}", base), "type", type,
                                           "templated", 1));
    if (*text_of(list, "next") && !found)
        json_array_append_new(
            links, json_pack("{ss so ss}", "rel", "next", "href",
                             json_sprintf("%s/library/opds.json?after=%s", base, text_of(list, "next")),
                             "type", type));
    json_t *catalogue = json_pack("{s{ss} so so}", "metadata", "title", "faccia", "links", links,
                                  "publications", publications);
    json_print(out, catalogue, JSON_COMPACT);
    json_decref(catalogue);
    json_decref(seen);
}

/* Adds a field of CSV and what follows it. */
static void put_field(struct buf *out, const char *text, const char *end) {
    buf_add(out, "\"", 1);
    buf_printf(out, "%s", *text && strchr("=+-@\t\r", *text) ? "'" : ""); /* no formula of a spreadsheet */
    for (; *text; text++)
        buf_printf(out, *text == '"' ? "%c\"" : "%c", *text);
    buf_printf(out, "\"%s", end);
}

void library_csv(struct buf *out, const json_t *concordance, const char *base) {
    const json_t *line;
    size_t i;
    buf_printf(out, "left,match,right,passage,kind,lang,work,title,author,address\r\n");
    json_array_foreach(json_object_get(concordance, "lines"), i, line) {
        static const char *const own[] = {"left", "match", "right", "passage", "kind", "lang"},
                                 *const of_work[] = {"id", "title", "author"};
        const json_t *work = json_object_get(line, "work");
        for (size_t k = 0; k < sizeof own / sizeof *own; k++)
            put_field(out, text_of(line, own[k]), ",");
        for (size_t k = 0; k < sizeof of_work / sizeof *of_work; k++)
            put_field(out, text_of(work, of_work[k]), ",");
        buf_printf(out, "\"%s/library.html?at=%s\"\r\n", base, text_of(line, "passage"));
    }
}

static void put_tex(struct buf *out, const char *text) {
    for (; *text; text++)
        if (strchr("\\~^", *text))
            buf_printf(out, *text == '\\'  ? "{\\textbackslash}"
                            : *text == '~' ? "{\\textasciitilde}"
                                           : "{\\textasciicircum}");
        else if (*text == '{' || *text == '}')
            buf_printf(out, "{\\textbrace%s}", *text == '{' ? "left" : "right");
        else if (strchr("&%$#_", *text))
            buf_printf(out, "\\%c", *text);
        else
            buf_add(out, (unsigned char)*text < ' ' || *text == 0x7f ? " " : text, 1);
}

/* Copies a URL, escaping what would end the field or the line. */
static void put_tex_url(struct buf *out, const char *url) {
    for (; *url; url++)
        if (strchr("{}\\", *url) || (unsigned char)*url <= ' ' || *url == 0x7f)
            buf_printf(out, "%%%02X", (unsigned char)*url);
        else
            buf_add(out, url, 1);
}

static void tex_field(struct buf *out, const char *name, const char *text, bool whole) {
    if (!*text)
        return;
    buf_printf(out, ",\n  %s = {%s", name, whole ? "{" : "");
    put_tex(out, text);
    buf_printf(out, "}%s", whole ? "}" : "");
}

void library_bibtex(struct buf *out, const json_t *work, const char *base) {
    const char *date = text_of(work, "date");
    char year[5] = "";
    if (strspn(date, "0123456789") == 4)
        memcpy(year, date, 4);
    buf_printf(out, "@book{%s", text_of(work, "id"));
    tex_field(out, "title", title_of(work), true);
    tex_field(out, "author", text_of(work, "author"),
              true); /* in braces: which part is the surname is not known */
    tex_field(out, "publisher", text_of(work, "publisher"), false);
    tex_field(out, "year", year, false);
    tex_field(out, *year ? "" : "date", *year ? "" : date, false);
    tex_field(out, "language", text_of(work, "lang"), false);
    tex_field(out, "note", text_of(work, "source"), false);
    buf_printf(out, ",\n  url = {");
    put_tex_url(out, base);
    buf_printf(out, "/library/");
    put_tex_url(out, text_of(work, "id"));
    buf_printf(out, "}\n}\n");
}

void library_dublin_core(struct buf *out, const json_t *work, const char *base) {
    buf_printf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<oai_dc:dc "
                    "xmlns:oai_dc=\"http://www.openarchives.org/OAI/2.0/oai_dc/\" "
                    "xmlns:dc=\"http://purl.org/dc/elements/1.1/\">\n");
    element(out, "dc:title", title_of(work));
    element(out, "dc:creator", text_of(work, "author"));
    element(out, "dc:publisher", text_of(work, "publisher"));
    element(out, "dc:date", text_of(work, "date"));
    element(out, "dc:language", text_of(work, "lang"));
    element(out, "dc:rights", text_of(work, "licence"));
    element(out, "dc:source", text_of(work, "source"));
    buf_printf(out, "<dc:type>Text</dc:type>\n<dc:identifier>");
    put_address(out, base, text_of(work, "id"), 0);
    buf_printf(out, "</dc:identifier>\n</oai_dc:dc>\n");
}

static void set(json_t *object, const char *name, const char *text) {
    if (*text)
        json_object_set_new(object, name, json_string(text));
}

static json_t *named(const char *type, const char *name) {
    return *name ? json_pack("{ss ss}", "@type", type, "name", name) : NULL;
}

static json_t *book_of(const json_t *work, const char *base) {
    json_t *book = json_pack("{ss ss}", "@type", "Book", "name", title_of(work));
    json_object_set_new(book, "@id", json_sprintf("%s/library/%s", base, text_of(work, "id")));
    json_object_set_new(book, "url", json_sprintf("%s/library/%s", base, text_of(work, "id")));
    set(book, "inLanguage", text_of(work, "lang"));
    set(book, "datePublished", text_of(work, "date"));
    set(book, "license", text_of(work, "licence"));
    set(book, "isBasedOn", text_of(work, "source"));
    if (*text_of(work, "author"))
        json_object_set_new(book, "author", named("Person", text_of(work, "author")));
    if (*text_of(work, "publisher"))
        json_object_set_new(book, "publisher", named("Organization", text_of(work, "publisher")));
    return book;
}

static json_t *sound_of(const json_t *section, const char *base, bool recording) {
    const char *id = text_of(section, "id");
    json_t *sound = json_pack("{ss ss ss}", "@type", "AudioObject", "name",
                              recording ? "recording" : "speech", "encodingFormat", "audio/ogg");
    json_object_set_new(
        sound, "contentUrl",
        json_sprintf("%s/v1/speech?passage=%s&format=ogg%s", base, id, recording ? "&voice=recording" : ""));
    set(sound, "inLanguage", text_of(json_object_get(section, "work"), "lang"));
    return sound;
}

static json_t *chapter_of(const json_t *section, const char *base) {
    const json_t *work = json_object_get(section, "work");
    long long number = json_integer_value(json_object_get(section, "number"));
    json_t *chapter = json_pack("{ss sI}", "@type", "Chapter", "position", (json_int_t)number),
           *sounds = json_array();
    const char *title = text_of(section, "title");
    set(chapter, "name", *title ? title : text_of(section, "id"));
    json_object_set_new(chapter, "url",
                        json_sprintf("%s/library/%s/%lld", base, text_of(work, "id"), number));
    set(chapter, "inLanguage", text_of(work, "lang"));
    json_object_set_new(chapter, "isPartOf", book_of(work, base));
    if (json_is_object(json_object_get(section, "recording")))
        json_array_append_new(sounds, sound_of(section, base, true));
    json_array_append_new(sounds, sound_of(section, base, false));
    json_object_set_new(chapter, "audio", sounds);
    return chapter;
}

/* JSON-LD is data, so a policy for scripts does not apply. Escapes "<" so that it cannot end the element. */
static void put_schema_org(struct buf *out, json_t *thing) {
    json_object_set_new(thing, "@context", json_string("https://schema.org"));
    char *text = json_dumps(thing, JSON_COMPACT);
    buf_printf(out, "<script type=\"application/ld+json\">");
    for (const char *c = text ? text : "{}"; *c; c++)
        if (*c == '<')
            buf_printf(out, "\\u003c");
        else
            buf_add(out, c, 1);
    buf_printf(out, "</script>\n");
    free(text);
    json_decref(thing);
}

static void put_link(struct buf *out, const char *rel, const char *type, const char *work, const char *path) {
    buf_printf(out, "<link rel=\"%s\" type=\"%s\" href=\"/library/%s%s\">\n", rel, type, work, path);
}

static void put_meta(struct buf *out, const char *name, const char *text) {
    if (!*text)
        return;
    buf_printf(out, "<meta name=\"%s\" content=\"", name);
    library_escape(out, text);
    buf_printf(out, "\">\n");
}

void library_head(struct buf *out, const json_t *answer, const char *base) {
    const json_t *of = json_object_get(answer, "work"), *work = of ? of : answer;
    put_link(out, "alternate", "application/atom+xml", "", "feed.xml");
    if (!*text_of(work, "id"))
        return;
    put_link(out, "alternate", "application/x-bibtex", text_of(work, "id"), ".bib");
    put_link(out, "alternate", "application/xml", text_of(work, "id"), ".xml");
    buf_printf(out, "<link rel=\"schema.DC\" href=\"http://purl.org/dc/elements/1.1/\">\n");
    put_meta(out, "DC.title", title_of(work));
    put_meta(out, "DC.creator", text_of(work, "author"));
    put_meta(out, "DC.language", text_of(work, "lang"));
    put_meta(out, "DC.date", text_of(work, "date"));
    put_meta(out, "DC.publisher", text_of(work, "publisher"));
    put_meta(out, "DC.rights", text_of(work, "licence"));
    put_schema_org(out, of ? chapter_of(answer, base) : book_of(work, base));
}
