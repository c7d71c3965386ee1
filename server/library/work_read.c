/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which reader a file is for. */
#include "server/base/open_below.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/readers.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum work_kind { KIND_NONE, KIND_XML, KIND_EPUB, KIND_MARKDOWN, KIND_PLAIN, KIND_APML, KIND_JSML, KIND_SSML };

static enum work_kind kind_of(const char *path) {
    static const struct {
        const char *ending;
        enum work_kind kind;
    } kinds[] = {{".xml", KIND_XML},     {".tei", KIND_XML},           {".epub", KIND_EPUB},
                 {".md", KIND_MARKDOWN}, {".markdown", KIND_MARKDOWN}, {".txt", KIND_PLAIN},
                 {".apml", KIND_APML},   {".jsml", KIND_JSML},         {".ssml", KIND_SSML}};
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    for (size_t i = 0; dot && (!slash || dot > slash + 1) && i < sizeof kinds / sizeof *kinds; i++)
        if (!strcasecmp(dot, kinds[i].ending))
            return kinds[i].kind;
    return KIND_NONE;
}

bool work_is(const char *path) {
    return kind_of(path) != KIND_NONE;
}

/* "mare.it.txt" is Italian. */
static void lang_of_name(const char *path, struct work_meta *meta) {
    static const char *const tags[] = {"it", "pt", "pt-BR", "tr", "en", NULL};
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    const char *name = slash ? slash + 1 : path;
    for (const char *const *tag = tags; dot && *tag; tag++) {
        size_t length = strlen(*tag);
        if ((size_t)(dot - name) > length + 1 && dot[-1 - (long)length] == '.' &&
            !strncasecmp(dot - length, *tag, length)) {
            free(meta->lang);
            meta->lang = mem_strdup(*tag);
        }
    }
}

static int load(FILE *file, struct buf *data, struct error *e) {
    size_t got = 1;
    while (got && data->size <= WORK_FILE_BYTES_MAX) {
        got = fread(buf_reserve(data, 1 << 18), 1, 1 << 18, file);
        data->size += got;
    }
    if (ferror(file))
        return error_set(e, ERROR_BAD_WORK, "%s", strerror(errno));
    return data->size > WORK_FILE_BYTES_MAX
               ? error_set(e, ERROR_BAD_WORK, "the file has more than %d bytes", WORK_FILE_BYTES_MAX)
               : 0;
}

/* The line and column of a byte. */
static int bad_byte(const struct buf *data, size_t byte, const char *what, struct error *e) {
    size_t line = 1, column = 1;
    for (size_t i = 0; i < byte; i++) {
        column = data->data[i] == '\n' ? 1 : column + ((data->data[i] & 0xC0) != 0x80);
        line += data->data[i] == '\n';
    }
    return error_at_line(e, ERROR_BAD_WORK, line, column, "%s", what);
}

static int read_text(enum work_kind kind, const struct buf *data, struct work_meta *meta, struct builder *b,
                     struct error *e) {
    size_t skip = data->size >= 3 && !memcmp(data->data, "\xEF\xBB\xBF", 3) ? 3 : 0;
    const char *text = data->size ? (const char *)data->data + skip : "";
    size_t size = data->size - skip, bad = utf8_check(text, size);
    if (bad < size)
        return bad_byte(data, bad + skip, "this is not UTF-8", e);
    if (memchr(text, 0, size))
        return bad_byte(data, (size_t)((const char *)memchr(text, 0, size) - text) + skip, "a NUL character",
                        e);
    if (kind == KIND_MARKDOWN)
        return commonmark_read(text, size, meta, b, e);
    if (kind == KIND_PLAIN)
        return plain_work_read(text, size, meta, b, e);
    return markup_work_read(text, size,
                            kind == KIND_APML   ? "apml"
                            : kind == KIND_JSML ? "jsml"
                                                : "ssml",
                            meta, b, e);
}

/* The markup whose root an .xml has; KIND_XML: another. */
static enum work_kind kind_of_root(const struct buf *data) {
    static const struct {
        const char *root;
        enum work_kind kind;
    } roots[] = {{"apml", KIND_APML}, {"jsml", KIND_JSML}, {"speak", KIND_SSML}};
    const char *at = data->size ? (const char *)data->data : "", *end = at + data->size;
    while ((at = at < end ? memchr(at, '<', (size_t)(end - at)) : NULL)) {
        at++;
        for (size_t i = 0; i < sizeof roots / sizeof *roots; i++)
            if ((size_t)(end - at) > strlen(roots[i].root) &&
                !strncasecmp(at, roots[i].root, strlen(roots[i].root)) &&
                strchr(" \t\r\n>", at[strlen(roots[i].root)]))
                return roots[i].kind;
        if (at < end && *at != '?' && *at != '!')
            break;
    }
    return KIND_XML;
}

/* data: of the file; NULL: it is read from `file`. */
static int read_any(const char *path, FILE *file, const struct buf *data, struct work_meta *meta,
                    const struct work_sink *sink, struct error *e) {
    struct builder b;
    struct buf loaded = {0};
    enum work_kind kind = kind_of(path);
    builder_open(&b, sink);
    lang_of_name(path, meta);
    int result = kind == KIND_EPUB ? epub_read(fileno(file), meta, &b, e) : data ? 0 : load(file, &loaded, e);
    data = data ? data : &loaded;
    builder_allow(&b, data->size); /* of an EPUB nothing is known here */
    if (!result && kind == KIND_XML)
        kind = kind_of_root(data);
    if (!result && kind == KIND_XML)
        result = tei_read((char *)data->data, data->size, meta, &b, e);
    else if (!result && kind != KIND_EPUB)
        result = read_text(kind, data, meta, &b, e);
    bool nothing = !result && !b.sections && !b.section.count;
    if (builder_close(&b) && !result)
        result = builder_why(&b, e);
    buf_free(&loaded);
    if (nothing && !result)
        result = error_set(e, ERROR_BAD_WORK, "there is no text in it");
    return result;
}

FILE *work_open(const char *folder, const char *path, struct error *e) {
    FILE *file = open_file_below(folder, path);
    if (!file)
        error_set(e, ERROR_BAD_WORK, "%s", error_is_outside(errno) ? WORK_OUTSIDE : strerror(errno));
    return file;
}

int work_read_file(const char *name, FILE *file, struct work_meta *meta, const struct work_sink *sink,
                   struct error *e) {
    return read_any(name, file, NULL, meta, sink, e);
}

int work_read(const char *folder, const char *path, struct work_meta *meta, const struct work_sink *sink,
              struct error *e) {
    FILE *file = work_open(folder, path, e);
    if (!file)
        return -1;
    int result = work_read_file(path, file, meta, sink, e);
    fclose(file);
    return result;
}

static int pass_section(void *ctx, const struct section *section) {
    (void)ctx;
    (void)section;
    return 0;
}

static void keep_first(void *ctx, const struct error *problem, bool serious) {
    struct error *first = ctx;
    if (serious && !*first->message)
        *first = *problem;
}

int work_check(const char *name, const void *data, size_t size, struct error *e) {
    enum work_kind kind = kind_of(name);
    struct error first = {0};
    const struct work_sink sink = {&first, pass_section, keep_first};
    const struct buf text = {.data = (uint8_t *)data, .size = size};
    struct work_meta meta = {.lang = mem_strdup("en")};
    if (kind == KIND_NONE || kind == KIND_EPUB) {
        work_meta_free(&meta);
        return error_in_field(e, ERROR_BAD_FIELD, "name",
                              "must end in .xml, .tei, .md, .txt, .apml, .jsml or .ssml");
    }
    int result = read_any(name, NULL, &text, &meta, &sink, e);
    work_meta_free(&meta);
    if (result || !*first.message)
        return result;
    *e = first;
    return -1;
}
