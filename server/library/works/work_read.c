/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include "server/library/works/work.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* File formats. */

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
    int why = buf_add_stream(data, file, WORK_FILE_BYTES_MAX);
    if (why == EFBIG)
        return error_set(e, ERROR_BAD_WORK, "the file has more than %d bytes", WORK_FILE_BYTES_MAX);
    return why ? error_set(e, ERROR_BAD_WORK, "%s", strerror(why)) : 0;
}

/* Reports an invalid byte by line and column. */
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

/* The markup of an XML document, by its root; KIND_XML: another vocabulary. */
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

/* data: content of the file; NULL: read it from `file`. */
static int read_any(const char *path, FILE *file, const struct buf *data, struct work_meta *meta,
                    const struct work_sink *sink, struct error *e) {
    struct builder b;
    struct buf loaded = {0};
    enum work_kind kind = kind_of(path);
    builder_open(&b, sink);
    lang_of_name(path, meta);
    int result = kind == KIND_EPUB ? epub_read(fileno(file), meta, &b, e) : data ? 0 : load(file, &loaded, e);
    data = data ? data : &loaded;
    builder_allow(&b, data->size); /* an EPUB's unpacked size is not known here */
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
    work_meta_authors(meta->author);
    if (nothing && !result)
        result = error_set(e, ERROR_BAD_WORK, "it contains no text");
    return result;
}

FILE *work_file_open(const char *folder, const char *path, struct error *e) {
    FILE *file = open_file_below(folder, path);
    if (!file)
        error_set(e, ERROR_BAD_WORK, "%s", error_is_outside(errno) ? WORK_OUTSIDE : strerror(errno));
    return file;
}

static int work_read_file(const char *name, FILE *file, struct work_meta *meta, const struct work_sink *sink,
                          struct error *e) {
    return read_any(name, file, NULL, meta, sink, e);
}

int work_read(const char *folder, const char *path, struct work_meta *meta, const struct work_sink *sink,
              struct error *e) {
    FILE *file = work_file_open(folder, path, e);
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

/* Checks that a file of that name and content can be read completely; not for EPUB. -1 with *e: "bad-
 * field" for the name, "bad-work" with the first error. */
static int work_check(const char *name, const void *data, size_t size, struct error *e) {
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

/* Frames: u32 kind, u32 size, payload. */
enum frame_kind {
    FRAME_SECTION = 1,
    FRAME_PROBLEM, /* u32: serious; an error */
    FRAME_DONE,    /* metadata; u32: success; an error */
};

enum {
    FRAME_BYTES_MAX = 256 << 20,
    MEGABYTES = 1536,
    SECONDS_LEAST = 4, /* of processor time, plus SECONDS_EACH per megabyte of the file */
    SECONDS_EACH = 2,
    SECONDS_MOST = 60,
    CHECK_SECONDS = 10, /* a client is waiting */
    ERROR_CODES_END = 0
#define COUNT_CODE(identifier, name, status, message) +1
                      ERROR_CODES(COUNT_CODE)
#undef COUNT_CODE
                      + 1,
};

static const char *const markups[] = {"apml", "jsml", "ssml", NULL};
static const char *const formats[] = {"text", "markdown", "tei", "epub", "apml", "jsml", "ssml", NULL};

/* ---- the child writes ---- */

struct saying {
    const struct work_meta *meta;
    int out;
    bool broken; /* the pipe is closed */
    struct buf frame;
};

static void begin_frame(struct saying *s, enum frame_kind kind) {
    s->frame.size = 0;
    wire_put_u32(&s->frame, kind);
    wire_put_u32(&s->frame, 0);
}

static void end_frame(struct saying *s) {
    uint32_t size = (uint32_t)(s->frame.size - 8);
    memcpy(s->frame.data + 4, &size, sizeof size);
    s->broken = s->broken || !write_all(s->out, s->frame.data, s->frame.size);
}

static void put_error(struct buf *b, const struct error *e) {
    wire_put_u32(b, e->code);
    wire_put_u32(b, e->place);
    wire_put_u64(b, e->place == PLACE_BYTE ? e->byte : e->line);
    wire_put_u64(b, e->column);
    wire_put_string(b, e->place == PLACE_FIELD ? e->field : "");
    wire_put_string(b, e->message);
}

static void put_block(struct buf *b, const struct block *block) {
    wire_put_u32(b, block->kind);
    wire_put_string(b, block->name);
    wire_put_string(b, block->lang);
    wire_put_string(b, block->speaker);
    wire_put_string(b, block->who);
    wire_put_string(b, block->n);
    wire_put_string(b, block->source);
    wire_put_string(b, block->markup);
    wire_put_u32(b, block->level);
    wire_put_u32(b, block->item);
    wire_put_u32(b, block->first_line);
    wire_put_u32(b, (uint32_t)block->text.size);
    buf_add(b, block->text.data, block->text.size);
    wire_put_u32(b, (uint32_t)block->mark_count);
    for (size_t i = 0; i < block->mark_count; i++) {
        wire_put_u32(b, block->marks[i].kind);
        wire_put_u32(b, (uint32_t)block->marks[i].start);
        wire_put_u32(b, (uint32_t)block->marks[i].end);
        wire_put_string(b, block->marks[i].value);
    }
    wire_put_u32(b, (uint32_t)block->line_count);
    for (size_t i = 0; i < block->line_count; i++) {
        wire_put_u32(b, (uint32_t)block->lines[i].start);
        wire_put_u32(b, (uint32_t)block->lines[i].end);
        wire_put_u32(b, block->lines[i].indent);
        wire_put_string(b, block->lines[i].n);
    }
}

static int say_section(void *ctx, const struct section *section) {
    struct saying *s = ctx;
    struct buf *b = &s->frame;
    begin_frame(s, FRAME_SECTION);
    wire_put_string(b, s->meta->lang); /* the language is known before the rest of the metadata */
    wire_put_u32(b, section->number);
    wire_put_u32(b, section->level);
    wire_put_string(b, section->title);
    wire_put_u64(b, section->characters);
    wire_put_u32(b, section->passages);
    wire_put_u32(b, section->lines);
    wire_put_u32(b, (uint32_t)section->count);
    for (size_t i = 0; i < section->count; i++)
        put_block(b, &section->blocks[i]);
    end_frame(s);
    return s->broken;
}

static void say_problem(void *ctx, const struct error *problem, bool serious) {
    struct saying *s = ctx;
    begin_frame(s, FRAME_PROBLEM);
    wire_put_u32(&s->frame, serious);
    put_error(&s->frame, problem);
    end_frame(s);
}

static int say_done(struct saying *s, const struct work_meta *m, int result, const struct error *e) {
    const char *const texts[] = {m->lang,      m->title,   m->author, m->date,
                                 m->publisher, m->licence, m->source, m->format};
    const struct error none = {0};
    begin_frame(s, FRAME_DONE);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        wire_put_string(&s->frame, texts[i]);
    wire_put_u32(&s->frame, (uint32_t)m->person_count);
    for (size_t i = 0; i < m->person_count; i++) {
        wire_put_string(&s->frame, m->persons[i].id);
        wire_put_string(&s->frame, m->persons[i].name);
        wire_put_string(&s->frame, m->persons[i].about);
        wire_put_u32(&s->frame, m->persons[i].sex);
        wire_put_u32(&s->frame, m->persons[i].age);
    }
    wire_put_u32(&s->frame, !result);
    put_error(&s->frame, result ? e : &none);
    end_frame(s);
    buf_free(&s->frame);
    return s->broken ? -1 : 0;
}

int work_apart_read(const char *name, const char *lang, int in, int out) {
    struct work_meta meta = {.lang = mem_strdup(lang)};
    struct saying s = {.meta = &meta, .out = out};
    const struct work_sink sink = {&s, say_section, say_problem};
    struct error e = {0};
    FILE *file = fdopen(in, "rb");
    int result = file ? work_read_file(name, file, &meta, &sink, &e)
                      : error_set(&e, ERROR_BAD_WORK, "%s", strerror(errno));
    if (file)
        fclose(file);
    result = say_done(&s, &meta, result, &e);
    work_meta_free(&meta);
    return result;
}

int work_apart_check(const char *name, int in, int out) {
    struct saying s = {.out = out};
    struct buf data = {0};
    struct error e = {0};
    ssize_t got;
    while ((got = read(in, buf_reserve(&data, 1 << 16), 1 << 16)) > 0)
        data.size += (size_t)got;
    int result = work_check(name, data.data, data.size, &e);
    buf_free(&data);
    return say_done(&s, &(struct work_meta){0}, result, &e);
}

/* ---- the parent reads and validates ---- */

static size_t left(const struct wire_reader *r) {
    return r->bad ? 0 : (size_t)(r->end - r->at);
}

/* An optional UTF-8 string. */
static const char *get_text(struct wire_reader *r) {
    const char *text = wire_get_string(r);
    size_t size = text ? strlen(text) : 0;
    if (!text || utf8_check(text, size) == size)
        return text;
    r->bad = true;
    return NULL;
}

static char *copy_text(struct wire_reader *r) {
    const char *text = get_text(r);
    return text ? mem_strdup(text) : NULL;
}

/* Returns the matching entry of the list, or NULL. */
static const char *get_one_of(struct wire_reader *r, const char *const *list) {
    const char *text = get_text(r);
    while (text && *list && strcmp(*list, text) != 0)
        list++;
    r->bad = r->bad || (text && !*list);
    return text ? *list : NULL;
}

/* A number less than the bound. */
static uint32_t get_below(struct wire_reader *r, size_t bound) {
    uint32_t number = wire_get_u32(r);
    if (number < bound)
        return number;
    r->bad = true;
    return 0;
}

static void get_error(struct wire_reader *r, struct error *e) {
    enum error_code code = (enum error_code)get_below(r, ERROR_CODES_END);
    enum error_place place = (enum error_place)get_below(r, PLACE_FIELD + 1);
    uint64_t first = wire_get_u64(r), second = wire_get_u64(r);
    const char *field = get_text(r), *message = get_text(r);
    *e = (struct error){.code = code, .place = place};
    if (place == PLACE_BYTE)
        e->byte = (size_t)first;
    else if (place == PLACE_LINE)
        e->line = (size_t)first, e->column = (size_t)second;
    snprintf(e->field, sizeof e->field, "%s", field ? field : "");
    snprintf(e->message, sizeof e->message, "%s", message ? message : "");
}

static void get_marks(struct wire_reader *r, struct block *b) {
    size_t count = get_below(r, left(r) / 16 + 1);
    b->marks = mem_alloc(count * sizeof *b->marks);
    for (b->mark_cap = count; b->mark_count < count && !r->bad;) {
        struct block_mark *m = &b->marks[b->mark_count++];
        m->kind = (enum mark_kind)get_below(r, MARK_STAGE + 1);
        m->start = get_below(r, b->text.size + 1);
        m->end = get_below(r, b->text.size + 1);
        m->value = copy_text(r);
    }
}

static void get_lines(struct wire_reader *r, struct block *b) {
    size_t count = get_below(r, left(r) / 16 + 1), last = 0;
    b->lines = mem_alloc(count * sizeof *b->lines);
    for (b->line_cap = count; b->line_count < count && !r->bad;) {
        struct block_line *l = &b->lines[b->line_count++];
        l->start = get_below(r, b->text.size + 1);
        l->end = get_below(r, b->text.size + 1);
        l->indent = wire_get_u32(r);
        l->n = copy_text(r);
        r->bad = r->bad || l->start < last || l->end < l->start;
        last = l->end;
    }
}

static void get_block(struct wire_reader *r, struct block *b) {
    b->kind = (enum block_kind)get_below(r, BLOCK_PAGE + 1);
    const char *name = get_text(r);
    snprintf(b->name, sizeof b->name, "%s", name ? name : "");
    b->lang = copy_text(r);
    b->speaker = copy_text(r);
    b->who = copy_text(r);
    b->n = copy_text(r);
    b->source = copy_text(r);
    b->markup = get_one_of(r, markups);
    b->level = wire_get_u32(r);
    b->item = wire_get_u32(r);
    b->first_line = wire_get_u32(r);
    size_t size = get_below(r, left(r) + 1);
    r->bad = r->bad || size > left(r) || utf8_check((const char *)r->at, size) != size ||
             (size && memchr(r->at, 0, size));
    if (r->bad)
        return;
    buf_add(&b->text, r->at, size);
    r->at += size;
    get_marks(r, b);
    get_lines(r, b);
}

static void get_section(struct wire_reader *r, struct section *s) {
    s->number = get_below(r, SECTIONS_MAX + 2);
    s->level = wire_get_u32(r);
    s->title = copy_text(r);
    s->characters = (size_t)wire_get_u64(r);
    s->passages = wire_get_u32(r);
    s->lines = wire_get_u32(r);
    size_t count = get_below(r, left(r) / 32 + 1);
    s->cap = count;
    s->blocks = mem_alloc(count * sizeof *s->blocks);
    while (s->count < count && !r->bad)
        get_block(r, &s->blocks[s->count++]);
}

static void set_lang(struct wire_reader *r, struct work_meta *m) {
    char *lang = copy_text(r);
    if (!lang)
        return;
    free(m->lang);
    m->lang = lang;
}

static void get_meta(struct wire_reader *r, struct work_meta *m) {
    char **const texts[] = {&m->title, &m->author, &m->date, &m->publisher, &m->licence, &m->source};
    set_lang(r, m);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        free(*texts[i]);
        *texts[i] = copy_text(r);
    }
    m->format = get_one_of(r, formats);
    work_persons_free(m->persons, m->person_count);
    m->person_count = 0;
    const size_t count = get_below(r, PERSONS_MAX + 1);
    m->persons = mem_alloc((count + 1) * sizeof *m->persons);
    for (; m->person_count < count && !r->bad; m->person_count++) {
        struct work_person *p = &m->persons[m->person_count];
        p->id = copy_text(r);
        p->name = copy_text(r);
        p->about = copy_text(r);
        p->sex = (enum person_sex)get_below(r, SEX_MALE + 1);
        p->age = wire_get_u32(r);
        r->bad = r->bad || !p->id || !p->name;
    }
}

struct hearing {
    struct reader_process process;
    const struct work_sink *sink; /* NULL: sections and problems are protocol errors */
    struct work_meta *meta;
    unsigned last; /* number of the last section received */
    bool stopped;  /* the sink stopped the reading */
    struct error *error;
};

/* 1: continue; 0: that was the last frame, *result is set; -1: protocol error. */
static int take_frame(struct hearing *h, uint32_t kind, const struct buf *payload, int *result) {
    struct wire_reader r = {.at = payload->data, .end = payload->data + payload->size};
    if (kind == FRAME_SECTION && h->sink) {
        struct section section = {.level = 1};
        set_lang(&r, h->meta);
        get_section(&r, &section);
        h->last = section.number;
        h->stopped = !r.bad && h->sink->section(h->sink->ctx, &section);
        section_free(&section);
    } else if (kind == FRAME_PROBLEM && h->sink) {
        struct error problem;
        bool serious = wire_get_u32(&r);
        get_error(&r, &problem);
        if (!r.bad)
            h->sink->problem(h->sink->ctx, &problem, serious);
    } else if (kind == FRAME_DONE) {
        struct error why;
        get_meta(&r, h->meta);
        bool well = wire_get_u32(&r);
        get_error(&r, &why);
        if (r.bad)
            return -1;
        if (!well)
            *h->error = why;
        *result = well ? 0 : -1;
        return 0;
    } else {
        return -1;
    }
    return r.bad ? -1 : !h->stopped;
}

static int hear(struct hearing *h) {
    struct buf payload = {0};
    uint32_t header[2];
    int result = -1, more = 1;
    char how[160] = "";
    while (more > 0 && reader_process_read(&h->process, header, sizeof header)) {
        payload.size = 0;
        if (header[1] > FRAME_BYTES_MAX ||
            !reader_process_read(&h->process, buf_reserve(&payload, header[1] + 1), header[1]))
            break;
        payload.size = header[1];
        more = take_frame(h, header[0], &payload, &result);
    }
    buf_free(&payload);
    bool ended = !reader_process_end(&h->process, how, sizeof how);
    if (h->stopped)
        return error_set(h->error, ERROR_BAD_WORK, "it was read only in part");
    if (!more)
        return result;
    if (more < 0 || ended || !*how)
        snprintf(how, sizeof how, "%s", "made the process that reads it send invalid data");
    return h->last ? error_set(h->error, ERROR_BAD_WORK, "the process that reads it %s, after section %u",
                               how, h->last)
                   : error_set(h->error, ERROR_BAD_WORK, "the process that reads it %s, in its first section",
                               how);
}

static struct reader_limits limits_of(uint64_t bytes, unsigned most) {
    uint64_t seconds = SECONDS_LEAST + SECONDS_EACH * (bytes >> 20);
    return (struct reader_limits){seconds < most ? (unsigned)seconds : most, MEGABYTES};
}

int work_read_apart(const struct reader *reader, const char *folder, const char *path, struct work_meta *meta,
                    const struct work_sink *sink, const atomic_bool *given_up, struct error *e) {
    struct stat info = {0};
    struct hearing h = {.sink = sink, .meta = meta, .error = e};
    if (!reader || !reader->program || !*reader->program)
        return work_read(folder, path, meta, sink, e);
    FILE *file = work_file_open(folder, path, e);
    if (!file)
        return -1;
    const char *const args[] = {"work", path, meta->lang ? meta->lang : "en", NULL};
    const struct reader_limits limits =
        limits_of(fstat(fileno(file), &info) ? 0 : (uint64_t)info.st_size, SECONDS_MOST);
    int result = reader_process_start(&h.process, reader, &limits, args, fileno(file), given_up, e);
    fclose(file);
    return result ? -1 : hear(&h);
}

int work_check_apart(const struct reader *reader, const char *name, const void *data, size_t size,
                     const atomic_bool *given_up, struct error *e) {
    struct work_meta meta = {0};
    struct hearing h = {.meta = &meta, .error = e};
    if (!reader || !reader->program || !*reader->program)
        return work_check(name, data, size, e);
    const char *const args[] = {"check", name, NULL};
    const struct reader_limits limits = limits_of(size, CHECK_SECONDS);
    int input = reader_input(data, size);
    int result = input < 0 ? error_set(e, ERROR_CANNOT_KEEP, "%s", strerror(errno))
                           : reader_process_start(&h.process, reader, &limits, args, input, given_up, e);
    if (input >= 0)
        close(input);
    result = result ? -1 : hear(&h);
    work_meta_free(&meta);
    return result;
}
