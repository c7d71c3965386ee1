/* SPDX-License-Identifier: GPL-3.0-or-later */
/* EPUB 3.3 (W3C) and 2.0.1: reads the container's first package, its spine in order. */
#include "server/base/archive_path.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <utf8proc.h>
#include <zip.h>

enum { ITEMS_MAX = 10000, PATH_BYTES_MAX = 1024, AUTHOR_BYTES_MAX = 4096 };

struct manifest_item {
    char *id, *href, *type;
    size_t line, column; /* position in the package document */
};

struct spine_item {
    char *id;
    size_t line, column;
};

struct creator {
    char *id, *name;
    bool other; /* a translator, illustrator or the like */
};

struct package {
    struct zip *zip;
    uint64_t left; /* bytes that may still be unpacked */
    struct builder *b;
    struct work_meta *meta;
    char *opf;
    struct manifest_item *items;
    size_t item_count, item_cap;
    struct spine_item *spine;
    size_t spine_count, spine_cap;
    char **read; /* paths of the documents read, sorted */
    size_t read_count, read_cap;
    char **wanted; /* metadata field that is being captured */
    struct buf capture;
    struct creator *creators;
    size_t creator_count, creator_cap;
    char *refined;    /* id of the creator whose role is being captured */
    char **encrypted; /* paths */
    size_t encrypted_count, encrypted_cap;
    bool too_many,
        told_again; /* too_many: the item limit was reported; told_again: so was a repeated document */
};

/* Resolves ".", ".." and empty parts in place. Fails if the path leaves the archive. */
static int normalise(char *path, struct error *e) {
    bool leaves = path[0] == '/' || strchr(path, '\\') || strlen(path) > PATH_BYTES_MAX, above;
    if (!leaves) {
        char *resolved = archive_path_resolve(path, &above);
        if (!above)
            memcpy(path, resolved, strlen(resolved) + 1); /* never longer */
        leaves = above;
        free(resolved);
    }
    return leaves ? error_set(e, ERROR_BAD_WORK, "'%.100s' leads outside the archive", path) : 0;
}

/* Finds a name that is the same but for composed and decomposed letters. NULL: none. */
static const char *equivalent_name(struct package *p, const char *path) {
    utf8proc_uint8_t *wanted = utf8proc_NFC((const utf8proc_uint8_t *)path);
    const char *found = NULL;
    zip_int64_t count = zip_get_num_entries(p->zip, 0);
    for (zip_int64_t i = 0; wanted && !found && i < count; i++) {
        const char *name = zip_get_name(p->zip, (zip_uint64_t)i, 0);
        utf8proc_uint8_t *composed = name ? utf8proc_NFC((const utf8proc_uint8_t *)name) : NULL;
        if (composed && !strcmp((char *)composed, (char *)wanted))
            found = name;
        free(composed);
    }
    free(wanted);
    return found;
}

/* Unpacks a whole file. -1 with *e. */
static int get(struct package *p, const char *path, struct buf *out, struct error *e) {
    struct zip_stat stat;
    const char *other = zip_name_locate(p->zip, path, 0) < 0 ? equivalent_name(p, path) : NULL;
    path = other ? other : path;
    if (zip_stat(p->zip, path, 0, &stat) || !(stat.valid & ZIP_STAT_SIZE))
        return error_set(e, ERROR_BAD_WORK, "the archive has no '%.100s'", path);
    uint64_t most = p->left < WORK_FILE_BYTES_MAX ? p->left : WORK_FILE_BYTES_MAX;
    if (stat.size > most)
        return error_set(e, ERROR_BAD_WORK, "'%.100s' has %llu bytes, more than the limit for an archive",
                         path, (unsigned long long)stat.size);
    struct zip_file *file = zip_fopen(p->zip, path, 0);
    if (!file)
        return error_set(e, ERROR_BAD_WORK, "'%.100s': %.100s", path, zip_strerror(p->zip));
    zip_int64_t got = 1;
    while (got > 0 && out->size <= most) { /* the size in the directory is not trustworthy */
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

/* META-INF/encryption.xml: fonts that are only obfuscated do not matter. */
static void encryption_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct package *p = w->ctx;
    const char *path = strcmp(name, "CipherReference") ? NULL : xml_attribute(attributes, "URI");
    if (!path || p->encrypted_count == ITEMS_MAX)
        return;
    p->encrypted = mem_grow(p->encrypted, &p->encrypted_cap, p->encrypted_count + 1, sizeof *p->encrypted);
    p->encrypted[p->encrypted_count++] = mem_strdup(path);
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

/* Keeps a creator's id and role. EPUB 3 tells the role in a `meta` that refers to it. */
static void start_creator(struct package *p, const char *name, const char **attributes) {
    const char *id = xml_attribute(attributes, "id"), *role = xml_attribute(attributes, "role"),
               *property = xml_attribute(attributes, "property"),
               *refines = xml_attribute(attributes, "refines");
    free(p->refined);
    p->refined = NULL;
    if (!strcmp(name, "creator") && p->creator_count < ITEMS_MAX) {
        p->creators = mem_grow(p->creators, &p->creator_cap, p->creator_count + 1, sizeof *p->creators);
        p->creators[p->creator_count++] =
            (struct creator){.id = copy(id), .other = role && *role && strcmp(role, "aut") != 0};
    } else if (!strcmp(name, "meta") && property && !strcmp(property, "role") && refines && *refines == '#') {
        p->refined = mem_strdup(refines + 1);
    }
}

static void end_creator(struct package *p, const char *text) {
    for (size_t i = 0; p->refined && i < p->creator_count; i++)
        if (!strcmp(p->creators[i].id, p->refined))
            p->creators[i].other = strcmp(text, "aut") != 0;
    if (p->wanted == &p->meta->author && p->creator_count && !p->creators[p->creator_count - 1].name)
        p->creators[p->creator_count - 1].name = mem_strdup(text);
}

/* Joins the authors with semicolons; without an author, all creators. */
static void set_author(struct package *p) {
    struct buf names = {0};
    bool authors = false;
    for (size_t i = 0; i < p->creator_count; i++)
        authors = authors || (!p->creators[i].other && p->creators[i].name);
    for (size_t i = 0; i < p->creator_count; i++)
        if (p->creators[i].name && (!authors || !p->creators[i].other) && names.size < AUTHOR_BYTES_MAX)
            buf_printf(&names, "%s%s", names.size ? "; " : "", p->creators[i].name);
    buf_add(&names, "", 1);
    work_meta_set(&p->meta->author, (char *)names.data);
    buf_free(&names);
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
    const char *event = strcmp(name, "date") ? NULL : xml_attribute(attributes, "event");
    if (event && !strstr(event, "publication"))
        p->wanted = NULL; /* when the file was made */
    buf_free(&p->capture);
    start_creator(p, name, attributes);
    bool item = !strcmp(name, "item"), itemref = !strcmp(name, "itemref");
    if ((item && p->item_count == ITEMS_MAX) || (itemref && p->spine_count == ITEMS_MAX)) {
        if (!p->too_many) {
            struct error e;
            error_at_line(&e, ERROR_BAD_WORK, xml_walk_line(w), xml_walk_column(w),
                          "%.100s: the limit for a book is %d items: the rest is dropped", p->opf, ITEMS_MAX);
            build_problem(p->b, &e, true);
        }
        p->too_many = true;
        return;
    }
    if (item) {
        p->items = mem_grow(p->items, &p->item_cap, p->item_count + 1, sizeof *p->items);
        p->items[p->item_count++] = (struct manifest_item){
            copy(xml_attribute(attributes, "id")), copy(xml_attribute(attributes, "href")),
            copy(xml_attribute(attributes, "media-type")), xml_walk_line(w), xml_walk_column(w)};
    }
    if (itemref) {
        p->spine = mem_grow(p->spine, &p->spine_cap, p->spine_count + 1, sizeof *p->spine);
        p->spine[p->spine_count++] = (struct spine_item){copy(xml_attribute(attributes, "idref")),
                                                         xml_walk_line(w), xml_walk_column(w)};
    }
}

static void package_end(struct xml_walk *w, const char *name) {
    struct package *p = w->ctx;
    (void)name;
    if ((p->refined || p->wanted == &p->meta->author) && p->capture.size) {
        char *text = mem_strndup((char *)p->capture.data, p->capture.size);
        end_creator(p, text);
        free(text);
    } else if (p->wanted && p->capture.size) {
        char *text = mem_strndup((char *)p->capture.data, p->capture.size);
        static const char white[] = " \t\r\n";
        char tag[LANG_BYTES + 1];
        size_t bad, space = strspn(text, white);
        if (p->wanted != &p->meta->lang) {
            work_meta_set(p->wanted, text);
        } else if (lang_read(text + space, strcspn(text + space, white), tag, &bad)) {
            free(p->meta->lang); /* replaces the default */
            p->meta->lang = mem_strdup(tag);
        } else {
            struct error e;
            error_at_line(&e, ERROR_BAD_VALUE, xml_walk_line(w), xml_walk_column(w),
                          "%.100s: \"%.40s\" is not a language tag (BCP 47, such as pt-BR)", p->opf, text);
            build_problem(p->b, &e, false);
        }
        free(text);
    }
    p->wanted = NULL;
    free(p->refined);
    p->refined = NULL;
    buf_free(&p->capture);
}

static void package_text(struct xml_walk *w, const char *text, size_t size) {
    struct package *p = w->ctx;
    if ((p->wanted || p->refined) && p->capture.size + size < 1000)
        buf_add(&p->capture, text, size);
}

static int compare_items(const void *a, const void *b) {
    return strcmp(((const struct manifest_item *)a)->id, ((const struct manifest_item *)b)->id);
}

/* Reports a problem at the package's reference. */
static void tell(struct package *p, const struct spine_item *ref, bool serious, const char *format,
                 const char *what) {
    struct error e, why;
    error_set(&why, ERROR_BAD_WORK, format, what);
    error_at_line(&e, why.code, ref->line, ref->column, "%.60s: %.180s", p->opf, why.message);
    build_problem(p->b, &e, serious);
}

/* Index of the path in the sorted list, or where to insert it. */
static size_t place_of(const struct package *p, const char *path, bool *there) {
    size_t low = 0, high = p->read_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (strcmp(p->read[middle], path) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    *there = low < p->read_count && !strcmp(p->read[low], path);
    return low;
}

/* True when the document has not been read yet. Takes ownership of the path. */
static bool is_new(struct package *p, const struct spine_item *ref, char *path) {
    bool there;
    size_t at = place_of(p, path, &there);
    if (there) {
        if (!p->told_again)
            tell(p, ref, false, "'%.100s' is in the spine again: each document is read once", path);
        p->told_again = true;
        free(path);
        return false;
    }
    p->read = mem_grow(p->read, &p->read_cap, p->read_count + 1, sizeof *p->read);
    memmove(p->read + at + 1, p->read + at, (p->read_count - at) * sizeof *p->read);
    p->read[at] = path;
    p->read_count++;
    return true;
}

static bool is_text(const char *type) {
    static const char *const types[] = {"application/xhtml+xml",    "text/html",
                                        "text/x-oeb1-document",     "image/svg+xml",
                                        "application/x-dtbook+xml", NULL};
    return xml_is_one(type, types);
}

/* An error in a document drops that document only. */
static void read_document(struct package *p, const struct spine_item *ref) {
    struct error e, told;
    struct buf data = {0};
    const struct manifest_item key = {.id = ref->id};
    const struct manifest_item *item =
        p->item_count ? bsearch(&key, p->items, p->item_count, sizeof key, compare_items) : NULL;
    if (!item) {
        tell(p, ref, true, "the spine refers to '%.80s', which is not an item", ref->id);
        return;
    }
    if (!is_text(item->type)) {
        tell(p, ref, false, "'%.100s' is not a text: it is skipped", item->href);
        return;
    }
    char *path = archive_path_join(p->opf, item->href);
    if (normalise(path, &e)) {
        error_at_line(&told, e.code, item->line, item->column, "%.60s: %.180s", p->opf, e.message);
        build_problem(p->b, &told, true);
        free(path);
        return;
    }
    if (!is_new(p, ref, path))
        return;
    for (size_t i = 0; i < p->encrypted_count; i++)
        if (!strcmp(p->encrypted[i], path)) {
            tell(p, ref, true, "'%.100s' is encrypted (DRM): it cannot be read", path);
            return;
        }
    if (get(p, path, &data, &e)) {
        build_problem(p->b, &e, true);
    } else if (xhtml_read((char *)data.data, data.size, path, p->b, &e)) {
        error_at_line(&told, e.code, e.line, e.column, "%.100s: %.140s", path, e.message);
        build_problem(p->b, &told, true);
    }
    buf_free(&data);
}

static int read_package(struct package *p, struct error *e) {
    struct buf data = {0};
    struct error ignored; /* a list of encrypted files that cannot be read: they will tell themselves */
    struct xml_walk encryption = {.ctx = p, .start = encryption_start, .end = nothing, .text = no_text};
    struct xml_walk container = {.ctx = p, .start = container_start, .end = nothing, .text = no_text};
    struct xml_walk package = {.ctx = p, .start = package_start, .end = package_end, .text = package_text};
    int result = get(p, "META-INF/container.xml", &data, e) ||
                 xml_walk(&container, data.size ? (char *)data.data : "", data.size, e);
    buf_free(&data);
    if (!result && !p->opf)
        result = error_set(e, ERROR_BAD_WORK, "the container names no package");
    if (!result)
        result = normalise(p->opf, e) || get(p, p->opf, &data, e) ||
                 xml_walk(&package, data.size ? (char *)data.data : "", data.size, e);
    buf_free(&data);
    if (!result)
        set_author(p);
    if (zip_name_locate(p->zip, "META-INF/encryption.xml", 0) >= 0 &&
        !get(p, "META-INF/encryption.xml", &data, &ignored))
        xml_walk(&encryption, data.size ? (char *)data.data : "", data.size, &ignored);
    buf_free(&data);
    if (p->item_count)
        qsort(p->items, p->item_count, sizeof *p->items, compare_items);
    p->b->work_lang = p->meta->lang;
    for (size_t i = 0; !result && i < p->spine_count && !p->b->stopped; i++)
        read_document(p, &p->spine[i]);
    p->b->work_lang = NULL;
    return result ? -1 : 0;
}

/* libzip closes its descriptor, so it gets a copy. */
static struct zip *open_zip(int fd, int *why) {
    int own = dup(fd);
    struct zip *zip = own >= 0 ? zip_fdopen(own, 0, why) : NULL;
    if (!zip && own >= 0)
        close(own);
    return zip;
}

int epub_read(int fd, struct work_meta *meta, struct builder *b, struct error *e) {
    struct package p = {.b = b, .meta = meta, .left = WORK_ARCHIVE_BYTES_MAX};
    int why = 0, result;
    meta->format = "epub";
    p.zip = open_zip(fd, &why);
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
        free(p.spine[i].id);
    for (size_t i = 0; i < p.read_count; i++)
        free(p.read[i]);
    for (size_t i = 0; i < p.creator_count; i++) {
        free(p.creators[i].id);
        free(p.creators[i].name);
    }
    for (size_t i = 0; i < p.encrypted_count; i++)
        free(p.encrypted[i]);
    free(p.encrypted);
    free(p.creators);
    free(p.refined);
    free(p.read);
    free(p.items);
    free(p.spine);
    free(p.opf);
    buf_free(&p.capture);
    return result;
}
