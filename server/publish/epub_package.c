/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/publish/epub_package.h"
#include "server/publish/epub_text.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

const char epub_container[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<container xmlns=\"urn:oasis:names:tc:opendocument:xmlns:"
    "container\" version=\"1.0\"><rootfiles><rootfile full-path=\"EPUB/package.opf\" "
    "media-type=\"application/oebps-package+xml\"/></rootfiles></container>\n";

const char epub_style[] =
    "body { line-height: 1.5; }\n"
    ".verse { margin: 1em 0; }\n"
    ".verse br { display: none; }\n"
    ".line { display: block; position: relative; padding: 0 2.5em 0 1.5em; text-indent: -1.5em; }\n"
    ".line.in { padding-left: 3em; }\n"
    ".line[data-n]::after { content: attr(data-n); position: absolute; right: 0; text-indent: 0; font-size: "
    "0.75em; }\n"
    ".speaker { margin-bottom: 0; font-variant: small-caps; }\n"
    ".stage { font-style: italic; }\n"
    ".item { margin-left: 1.5em; }\n"
    "aside { margin: 0.5em 1.5em; font-size: 0.9em; }\n"
    ".heard { color: #000; background: #ffe08a; }\n";

static void put(struct buf *out, const char *text) {
    epub_escape(out, text, strlen(text));
}

static void element(struct buf *out, const char *name, const char *text) {
    if (!text || !*text)
        return;
    buf_printf(out, "<%s>", name);
    put(out, text);
    buf_printf(out, "</%s>\n", name);
}

/* W3C-DTF as far as a day: what else a work says of its date is not one here. */
static bool is_date(const char *date) {
    static const char form[] = "dddd-dd-dd";
    size_t size = date ? strlen(date) : 0;
    for (size_t i = 0; i < size && size < sizeof form; i++)
        if (form[i] == '-' ? date[i] != '-' : date[i] < '0' || date[i] > '9')
            return false;
    return size == 4 || size == 7 || size == 10;
}

static void open_lists(struct epub_package *p, unsigned level) {
    struct buf *nav = &p->nav;
    if (!p->depth) {
        buf_printf(nav, "<ol>\n");
        p->depth = 1;
    } else if (level > p->depth) {
        buf_printf(nav, "\n<ol>\n");
        p->depth++;
    } else {
        for (; p->depth > level; p->depth--)
            buf_printf(nav, "</li>\n</ol>\n");
        buf_printf(nav, "</li>\n");
    }
}

void epub_package_section(struct epub_package *p, const struct section *section, uint64_t ms) {
    unsigned n = section->number;
    open_lists(p, section->level ? section->level : 1);
    buf_printf(&p->nav, "<li><a href=\"s%u.xhtml\">", n);
    if (section->title && *section->title)
        put(&p->nav, section->title);
    else
        buf_printf(&p->nav, "%u", n);
    buf_printf(&p->nav, "</a>");
    buf_printf(&p->manifest, "<item id=\"s%u\" href=\"s%u.xhtml\" media-type=\"application/xhtml+xml\"", n,
               n);
    if (ms)
        buf_printf(&p->manifest,
                   " media-overlay=\"o%u\"/>\n<item id=\"o%u\" href=\"s%u.smil\" "
                   "media-type=\"application/smil+xml\"/>\n<item id=\"a%u\" href=\"s%u.mp3\" "
                   "media-type=\"audio/mpeg\"",
                   n, n, n, n, n);
    buf_printf(&p->manifest, "/>\n");
    buf_printf(&p->spine, "<itemref idref=\"s%u\"/>\n", n);
    if (ms) {
        buf_printf(&p->times, "<meta property=\"media:duration\" refines=\"#o%u\">", n);
        epub_clock(&p->times, ms);
        buf_printf(&p->times, "</meta>\n");
    }
    p->ms += ms;
}

static void put_time_of_writing(struct buf *out) {
    time_t now = time(NULL);
    struct tm utc;
    char text[32];
    gmtime_r(&now, &utc);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    buf_printf(out, "<meta property=\"dcterms:modified\">%s</meta>\n", text);
}

/* A UUID of version 8 (RFC 9562, 5.8) of the file's hash: the same file is the same book. */
static void put_identifier(const char *h, struct buf *out) {
    buf_printf(out, "<dc:identifier id=\"id\">urn:uuid:%.8s-%.4s-8%.3s-a%.3s-%.12s</dc:identifier>\n", h,
               h + 8, h + 13, h + 17, h + 20);
}

static void put_access(const struct epub_package *p, const char *voice, struct buf *out) {
    static const char *const always[][2] = {{"accessMode", "textual"},
                                            {"accessModeSufficient", "textual"},
                                            {"accessibilityFeature", "structuralNavigation"},
                                            {"accessibilityFeature", "tableOfContents"},
                                            {"accessibilityFeature", "readingOrder"},
                                            {"accessibilityHazard", "none"}};
    static const char *const heard[][2] = {{"accessMode", "auditory"},
                                           {"accessModeSufficient", "auditory"},
                                           {"accessibilityFeature", "synchronizedAudioText"}};
    for (size_t i = 0; i < sizeof always / sizeof *always; i++)
        buf_printf(out, "<meta property=\"schema:%s\">%s</meta>\n", always[i][0], always[i][1]);
    for (size_t i = 0; p->ms && i < sizeof heard / sizeof *heard; i++)
        buf_printf(out, "<meta property=\"schema:%s\">%s</meta>\n", heard[i][0], heard[i][1]);
    buf_printf(out, "<meta property=\"schema:accessibilitySummary\">Plain text%s</meta>\n",
               p->ms ? ", all of which is read aloud and marked while it is heard." : ".");
    if (!p->ms)
        return;
    buf_add(out, p->times.data, p->times.size);
    buf_printf(out, "<meta property=\"media:duration\">");
    epub_clock(out, p->ms);
    buf_printf(
        out,
        "</meta>\n<meta property=\"media:active-class\">heard</meta>\n<meta property=\"media:narrator\">");
    put(out, voice);
    buf_printf(out, "</meta>\n");
}

void epub_package_write(const struct epub_package *p, const char *voice, struct buf *out) {
    const struct work_meta *m = p->meta;
    buf_printf(out,
               "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<package xmlns=\"http://www.idpf.org/2007/opf\" "
               "version=\"3.0\" unique-identifier=\"id\" xml:lang=\"");
    put(out, m->lang);
    buf_printf(out, "\">\n<metadata xmlns:dc=\"http://purl.org/dc/elements/1.1/\">\n");
    put_identifier(p->hash, out);
    element(out, "dc:title", m->title && *m->title ? m->title : "?");
    element(out, "dc:language", m->lang);
    element(out, "dc:creator", m->author);
    element(out, "dc:publisher", m->publisher);
    element(out, "dc:date", is_date(m->date) ? m->date : NULL);
    element(out, "dc:rights", m->licence);
    element(out, "dc:source", m->source);
    put_time_of_writing(out);
    put_access(p, voice, out);
    buf_printf(out, "</metadata>\n<manifest>\n<item id=\"nav\" href=\"nav.xhtml\" "
                    "media-type=\"application/xhtml+xml\" properties=\"nav\"/>\n<item id=\"style\" "
                    "href=\"style.css\" media-type=\"text/css\"/>\n");
    buf_add(out, p->manifest.data, p->manifest.size);
    buf_printf(out, "</manifest>\n<spine>\n");
    buf_add(out, p->spine.data, p->spine.size);
    buf_printf(out, "</spine>\n</package>\n");
}

void epub_package_nav(struct epub_package *p, struct buf *out) {
    const struct work_meta *m = p->meta;
    for (; p->depth; p->depth--)
        buf_printf(&p->nav, "</li>\n</ol>\n");
    buf_printf(out,
               "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE html>\n<html "
               "xmlns=\"http://www.w3.org/1999/xhtml\" xmlns:epub=\"http://www.idpf.org/2007/ops\" lang=\"");
    put(out, m->lang);
    buf_printf(out, "\" xml:lang=\"");
    put(out, m->lang);
    buf_printf(out, "\">\n<head>\n<title>");
    put(out, m->title && *m->title ? m->title : "?");
    buf_printf(out, "</title>\n</head>\n<body>\n<nav epub:type=\"toc\" id=\"toc\" role=\"doc-toc\">\n<h1>");
    put(out, m->title && *m->title ? m->title : "?");
    buf_printf(out, "</h1>\n");
    buf_add(out, p->nav.data, p->nav.size);
    buf_printf(out, "</nav>\n</body>\n</html>\n");
}

void epub_package_free(struct epub_package *p) {
    buf_free(&p->manifest);
    buf_free(&p->spine);
    buf_free(&p->times);
    buf_free(&p->nav);
}
