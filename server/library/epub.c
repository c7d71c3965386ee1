/* SPDX-License-Identifier: GPL-3.0-or-later */
/* EPUB 3.3 (W3C) and 2.0.1: the container's first package, its spine in order. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/readers.h"
#include "server/library/xml_walk.h"
#include <stdlib.h>
#include <string.h>
#include <zip.h>

enum { ITEMS_MAX = 10000, PATH_BYTES_MAX = 1024 };

struct manifest_item {
    char *id, *href, *type;
};

struct package {
    struct zip *zip;
    uint64_t left; /* bytes that may still be read */
    struct builder *b;
    struct work_meta *meta;
    char *opf;
    struct manifest_item *items;
    size_t item_count, item_cap;
    char **spine;
    size_t spine_count, spine_cap;
    char **wanted; /* the meta that is being captured */
    struct buf capture;
};

/* A path that stays in the archive; else an error. */
static int check_path(const char *path, struct error *e) {
    bool out = path[0] == '/' || strchr(path, '\\') || strlen(path) > PATH_BYTES_MAX;
    for (const char *at = path; at && !out; at = strchr(at, '/')) {
        at += *at == '/';
        out = !strncmp(at, "..", 2) && (at[2] == '/' || !at[2]);
        if (!*at)
            break;
    }
    return out ? error_set(e, ERROR_BAD_WORK, "'%.100s' leads out of the archive", path) : 0;
}

/* The file whole. -1 with *e. */
static int get(struct package *p, const char *path, struct buf *out, struct error *e) {
    struct zip_stat stat;
    if (check_path(path, e))
        return -1;
    if (zip_stat(p->zip, path, 0, &stat) || !(stat.valid & ZIP_STAT_SIZE))
        return error_set(e, ERROR_BAD_WORK, "the archive has no '%.100s'", path);
    uint64_t most = p->left < WORK_FILE_BYTES_MAX ? p->left : WORK_FILE_BYTES_MAX;
    if (stat.size > most)
        return error_set(e, ERROR_BAD_WORK, "'%.100s' has %llu bytes, more than is read of an archive", path,
                         (unsigned long long)stat.size);
    struct zip_file *file = zip_fopen(p->zip, path, 0);
    if (!file)
        return error_set(e, ERROR_BAD_WORK, "'%.100s': %.100s", path, zip_strerror(p->zip));
    zip_int64_t got = 1;
    while (got > 0 && out->size <= most) { /* what a file says of its size need not be true */
        got = zip_fread(file, buf_reserve(out, 65536), 65536);
        out->size += got > 0 ? (size_t)got : 0;
    }
    bool failed = got < 0;
    zip_fclose(file);
    p->left -= out->size < p->left ? out->size : p->left;
    if (failed || out->size > most)
        return error_set(e, ERROR_BAD_WORK, "'%.100s' %s", path,
                         failed ? "cannot be unpacked" : "is larger than it says");
    return 0;
}

static void container_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct package *p = w->ctx;
    const char *path = strcmp(name, "rootfile") ? NULL : xml_attribute(attributes, "full-path");
    if (path && !p->opf)
        p->opf = mem_strdup(path);
}

static void nothing(struct xml_walk *w, const char *name) {
    (void)w;
    (void)name;
}

static void no_text(struct xml_walk *w, const char *text, size_t size) {
    (void)w;
    (void)text;
    (void)size;
}

static char *copy(const char *text) {
    return mem_strdup(text ? text : "");
}

static void package_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct package *p = w->ctx;
    struct work_meta *m = p->meta;
    const struct {
        const char *name;
        char **to;
    } wanted[] = {{"title", &m->title},  {"creator", &m->author}, {"language", &m->lang},
                  {"date", &m->date},    {"rights", &m->licence}, {"publisher", &m->publisher},
                  {"source", &m->source}};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        if (!strcmp(name, wanted[i].name))
            p->wanted = wanted[i].to;
    buf_free(&p->capture);
    if (!strcmp(name, "item") && p->item_count < ITEMS_MAX) {
        p->items = mem_grow(p->items, &p->item_cap, p->item_count + 1, sizeof *p->items);
        p->items[p->item_count++] = (struct manifest_item){copy(xml_attribute(attributes, "id")),
                                                           copy(xml_attribute(attributes, "href")),
                                                           copy(xml_attribute(attributes, "media-type"))};
    }
    if (!strcmp(name, "itemref") && p->spine_count < ITEMS_MAX) {
        p->spine = mem_grow(p->spine, &p->spine_cap, p->spine_count + 1, sizeof *p->spine);
        p->spine[p->spine_count++] = copy(xml_attribute(attributes, "idref"));
    }
}

static void package_end(struct xml_walk *w, const char *name) {
    struct package *p = w->ctx;
    (void)name;
    if (p->wanted && p->capture.size) {
        char *text = mem_strndup((char *)p->capture.data, p->capture.size);
        if (p->wanted == &p->meta->lang) { /* it was the default's */
            free(p->meta->lang);
            p->meta->lang = NULL;
        }
        work_meta_set(p->wanted, text);
        free(text);
    }
    p->wanted = NULL;
    buf_free(&p->capture);
}

static void package_text(struct xml_walk *w, const char *text, size_t size) {
    struct package *p = w->ctx;
    if (p->wanted && p->capture.size + size < 1000)
        buf_add(&p->capture, text, size);
}

/* The path of a reference that stands in the package's file: %-codes decoded, beside that file. */
static char *resolve(const struct package *p, const char *href) {
    const char *slash = strrchr(p->opf, '/');
    struct buf out = {0};
    if (slash)
        buf_add(&out, p->opf, (size_t)(slash - p->opf) + 1);
    for (; *href && *href != '#'; href++) {
        char hex[3] = {href[0], href[0] == '%' ? href[1] : 0, 0};
        if (hex[0] == '%' && hex[1])
            hex[0] = hex[1], hex[1] = href[2];
        char *end, c = *href;
        long code = *href == '%' ? strtol(hex, &end, 16) : 0;
        if (code > 0 && end == hex + 2)
            c = (char)code, href += 2;
        buf_add(&out, &c, 1);
    }
    buf_add(&out, "", 1);
    return (char *)out.data;
}

/* What is wrong in one document costs that document. */
static void read_document(struct package *p, const char *id) {
    struct error e, told;
    struct buf data = {0};
    for (size_t i = 0; i < p->item_count; i++) {
        const struct manifest_item *item = &p->items[i];
        if (strcmp(item->id, id) != 0 || strcmp(item->type, "application/xhtml+xml") != 0)
            continue;
        char *path = resolve(p, item->href);
        if (get(p, path, &data, &e)) {
            build_problem(p->b, &e, true);
        } else if (xhtml_read((char *)data.data, data.size, path, p->b, &e)) {
            error_at_line(&told, e.code, e.line, e.column, "%.100s: %.140s", path, e.message);
            build_problem(p->b, &told, true);
        }
        free(path);
        buf_free(&data);
        return;
    }
}

static int read_package(struct package *p, struct error *e) {
    struct buf data = {0};
    struct xml_walk container = {.ctx = p, .start = container_start, .end = nothing, .text = no_text};
    struct xml_walk package = {.ctx = p, .start = package_start, .end = package_end, .text = package_text};
    int result = get(p, "META-INF/container.xml", &data, e) ||
                 xml_walk(&container, data.size ? (char *)data.data : "", data.size, e);
    buf_free(&data);
    if (!result && !p->opf)
        result = error_set(e, ERROR_BAD_WORK, "the container names no package");
    if (!result)
        result =
            get(p, p->opf, &data, e) || xml_walk(&package, data.size ? (char *)data.data : "", data.size, e);
    buf_free(&data);
    for (size_t i = 0; !result && i < p->spine_count && !p->b->stopped; i++)
        read_document(p, p->spine[i]);
    return result ? -1 : 0;
}

int epub_read(const char *path, struct work_meta *meta, struct builder *b, struct error *e) {
    struct package p = {.b = b, .meta = meta, .left = WORK_ARCHIVE_BYTES_MAX};
    int why = 0, result;
    meta->format = "epub";
    p.zip = zip_open(path, ZIP_RDONLY, &why);
    if (!p.zip) {
        zip_error_t text;
        zip_error_init_with_code(&text, why);
        result = error_set(e, ERROR_BAD_WORK, "%.200s", zip_error_strerror(&text));
        zip_error_fini(&text);
        return result;
    }
    if (zip_get_num_entries(p.zip, 0) > WORK_ARCHIVE_FILES_MAX)
        result = error_set(e, ERROR_BAD_WORK, "the archive has more than %d files", WORK_ARCHIVE_FILES_MAX);
    else
        result = read_package(&p, e);
    zip_discard(p.zip);
    for (size_t i = 0; i < p.item_count; i++) {
        free(p.items[i].id);
        free(p.items[i].href);
        free(p.items[i].type);
    }
    for (size_t i = 0; i < p.spine_count; i++)
        free(p.spine[i]);
    free(p.items);
    free(p.spine);
    free(p.opf);
    buf_free(&p.capture);
    return result;
}
