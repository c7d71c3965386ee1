/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/sound/book_sound.h"
#include "server/base/archive_path.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/sound/memory_file.h"
#include "server/library/align/book_texts.h"
#include "server/library/align/sound/aac_file.h"
#include "server/library/align/sound/mono_reader.h"
#include <expat.h>
#include <math.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <zip.h>

#define CODE ERROR_BAD_SOUND

enum {
    DOCUMENT_BYTES = 64 << 20, /* of a package or SMIL document */
    SOUND_BYTES = 256 << 20,   /* of one file of sound, unpacked */
    ITEMS_MAX = 10000,
    CLIPS_MAX = 200000,
    HOURS_MAX = 100,
    RATE_MIN = 8000,
    RATE_MAX = 192000,
};

struct item {
    char *id, *path, *overlay;
    bool read; /* an overlay that several pages share is read once */
};

/* A clip: contiguous ones are joined. */
struct clip {
    size_t file;
    double begin, end;    /* seconds; end < 0: of the file */
    uint64_t from, start; /* samples: of its file, and of the book */
    uint64_t samples;
};

/* The text that a clip reads, named by its document and id. */
struct named_text {
    char *document, *id;
    size_t clip;
    double begin, end; /* as of a clip */
};

struct sound_part {
    char *path;
    uint64_t samples;
};

struct book_sound {
    struct zip *zip;
    struct item *items;
    size_t item_count, item_cap;
    char **spine;
    size_t spine_count, spine_cap;
    struct clip *clips;
    size_t clip_count, clip_cap;
    struct named_text *names;
    size_t name_count, name_cap;
    struct sound_part *files;
    size_t file_count, file_cap;
    uint64_t samples;
    uint32_t rate;
    /* the file that is open */
    size_t open; /* index + 1; 0: none */
    struct buf data;
    struct memory_file memory;
    struct aac_file *aac; /* NULL: libsndfile reads it by itself */
    SNDFILE *file;
    struct mono_reader reader;
};

/* ---- documents ---- */

struct reading {
    struct book_sound *book;
    const char *path; /* of the document */
    char *found;      /* of the container: path of the package */
    char *text;       /* of a SMIL document: what the open `par` reads; NULL: not known */
    bool unnamed;     /* the last clip waits for its text */
};

static char *resolve(const char *document, const char *href) {
    char *joined = archive_path_join(document, href), *path = archive_path_resolve(joined, NULL);
    free(joined);
    return path;
}

/* The local name of an element or attribute. */
static const char *attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (!strcmp(book_local_name(attributes[0]), name))
            return attributes[1];
    return NULL;
}

static void container_start(void *ctx, const char *name, const char **attributes) {
    struct reading *r = ctx;
    const char *path = strcmp(book_local_name(name), "rootfile") ? NULL : attribute(attributes, "full-path");
    if (path && !r->found)
        r->found = mem_strdup(path);
}

static void package_start(void *ctx, const char *name, const char **attributes) {
    struct reading *r = ctx;
    struct book_sound *b = r->book;
    const char *id = attribute(attributes, "id"), *href = attribute(attributes, "href"),
               *overlay = attribute(attributes, "media-overlay"), *ref = attribute(attributes, "idref");
    if (!strcmp(book_local_name(name), "item") && id && href && b->item_count < ITEMS_MAX) {
        b->items = mem_grow(b->items, &b->item_cap, b->item_count + 1, sizeof *b->items);
        b->items[b->item_count++] = (struct item){.id = mem_strdup(id),
                                                  .path = resolve(r->path, href),
                                                  .overlay = overlay ? mem_strdup(overlay) : NULL};
    } else if (!strcmp(book_local_name(name), "itemref") && ref && b->spine_count < ITEMS_MAX) {
        b->spine = mem_grow(b->spine, &b->spine_cap, b->spine_count + 1, sizeof *b->spine);
        b->spine[b->spine_count++] = mem_strdup(ref);
    }
}

/* Reads a clock value of SMIL 3.0: "1:02:03.5", "02:03.5", "3.5s", "5min", "1h", "350ms". -1: none. */
static double clock_of(const char *text) {
    static const struct {
        const char *name;
        double seconds;
    } units[] = {{"h", 3600}, {"min", 60}, {"s", 1}, {"ms", 0.001}, {"", 1}};
    double sum = 0;
    char *end;
    if (!text)
        return -1;
    for (;; text = end + 1) {
        double value = strtod(text, &end);
        if (end == text || !(value >= 0))
            return -1;
        sum = 60 * sum + value;
        if (*end != ':')
            break;
    }
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (!strcmp(end, units[i].name))
            return sum * units[i].seconds;
    return -1;
}

static size_t file_of(struct book_sound *b, char *path) {
    for (size_t i = b->file_count; i--;)
        if (!strcmp(b->files[i].path, path)) {
            free(path);
            return i;
        }
    b->files = mem_grow(b->files, &b->file_cap, b->file_count + 1, sizeof *b->files);
    b->files[b->file_count] = (struct sound_part){.path = path};
    return b->file_count++;
}

/* Keeps which text the clip reads. */
static void name_clip(struct reading *r) {
    struct book_sound *b = r->book;
    char *hash = r->text ? strchr(r->text, '#') : NULL;
    struct named_text *n = b->name_count ? &b->names[b->name_count - 1] : NULL;
    if (!hash || !n || !r->unnamed)
        return;
    char *document = mem_strndup(r->text, (size_t)(hash - r->text));
    n->document = resolve(r->path, document);
    n->id = mem_strdup(hash + 1);
    r->unnamed = false;
    free(document);
}

static void add_name(struct reading *r, double begin, double end) {
    struct book_sound *b = r->book;
    b->names = mem_grow(b->names, &b->name_cap, b->name_count + 1, sizeof *b->names);
    b->names[b->name_count++] = (struct named_text){.clip = b->clip_count - 1, .begin = begin, .end = end};
    r->unnamed = true;
    name_clip(r);
}

/* A `par` joins a text and a clip, in any order. */
static void smil_par(struct reading *r, const char *name, const char **attributes) {
    const char *source = strcmp(name, "text") ? NULL : attribute(attributes, "src");
    if (strcmp(name, "par") != 0 && !source)
        return;
    free(r->text);
    r->text = source ? mem_strdup(source) : NULL;
    r->unnamed = r->unnamed && source;
    name_clip(r);
}

static void smil_start(void *ctx, const char *name, const char **attributes) {
    struct reading *r = ctx;
    struct book_sound *b = r->book;
    const char *source = strcmp(book_local_name(name), "audio") ? NULL : attribute(attributes, "src");
    double begin = clock_of(attribute(attributes, "clipBegin")),
           end = clock_of(attribute(attributes, "clipEnd"));
    smil_par(r, book_local_name(name), attributes);
    if (!source || b->file_count == ITEMS_MAX || b->clip_count == CLIPS_MAX || b->name_count == CLIPS_MAX)
        return;
    begin = begin < 0 ? 0 : begin;
    size_t file = file_of(b, resolve(r->path, source));
    struct clip *last = b->clip_count ? &b->clips[b->clip_count - 1] : NULL;
    if (last && last->file == file && last->end >= 0 && fabs(last->end - begin) < 0.002) {
        last->end = end;
        add_name(r, begin, end);
        return;
    }
    b->clips = mem_grow(b->clips, &b->clip_cap, b->clip_count + 1, sizeof *b->clips);
    b->clips[b->clip_count++] = (struct clip){.file = file, .begin = begin, .end = end};
    add_name(r, begin, end);
}

/* Unpacks a file of the archive. -1 with *e. */
static int get(struct book_sound *b, const char *path, size_t most, struct buf *out, struct error *e) {
    struct zip_file *file = zip_fopen(b->zip, path, 0);
    zip_int64_t got = 1;
    if (!file)
        return error_set(e, CODE, "the book has no '%.100s'", path);
    while (got > 0 && out->size <= most) {
        got = zip_fread(file, buf_reserve(out, 65536), 65536);
        out->size += got > 0 ? (size_t)got : 0;
    }
    zip_fclose(file);
    return got < 0            ? error_set(e, CODE, "'%.100s' cannot be unpacked", path)
           : out->size > most ? error_set(e, CODE, "'%.100s' is too large", path)
                              : 0;
}

static int read_document(struct book_sound *b, const char *path,
                         void (*start)(void *ctx, const char *name, const char **attributes),
                         struct reading *r, struct error *e) {
    struct buf data = {0};
    int result = get(b, path, DOCUMENT_BYTES, &data, e);
    XML_Parser parser = result ? NULL : XML_ParserCreate(NULL);
    r->book = b;
    r->path = path;
    if (parser) {
        XML_SetUserData(parser, r);
        XML_SetStartElementHandler(parser, start);
        if (XML_Parse(parser, data.size ? (char *)data.data : "", (int)data.size, 1) != XML_STATUS_OK)
            result = error_set(e, CODE, "'%.100s', line %lu: %.60s", path, XML_GetCurrentLineNumber(parser),
                               XML_ErrorString(XML_GetErrorCode(parser)));
        XML_ParserFree(parser);
    }
    buf_free(&data);
    return result;
}

static struct item *item_of(const struct book_sound *b, const char *id) {
    for (size_t i = 0; id && i < b->item_count; i++)
        if (!strcmp(b->items[i].id, id))
            return &b->items[i];
    return NULL;
}

static int read_clips(struct book_sound *b, struct error *e) {
    struct reading r = {0};
    if (read_document(b, "META-INF/container.xml", container_start, &r, e))
        return -1;
    if (!r.found)
        return error_set(e, CODE, "the book names no package");
    int result = read_document(b, r.found, package_start, &r, e);
    for (size_t i = 0; !result && i < b->spine_count; i++) {
        const struct item *page = item_of(b, b->spine[i]);
        struct item *overlay = page ? item_of(b, page->overlay) : NULL;
        if (overlay && !overlay->read)
            result = read_document(b, overlay->path, smil_start, &r, e);
        if (overlay)
            overlay->read = true;
        free(r.text);
        r.text = NULL;
        r.unnamed = false;
    }
    free(r.found);
    return result || b->clip_count ? result
                                   : error_set(e, CODE, "the book has no recording (media overlays)");
}

/* ---- sound ---- */

static void close_file(struct book_sound *b) {
    if (b->file)
        sf_close(b->file);
    aac_file_close(b->aac);
    b->aac = NULL;
    b->file = NULL;
    b->open = 0;
    buf_free(&b->data);
}

/* Opens one of the files, unless it is open. */
static int open_file(struct book_sound *b, size_t i, struct error *e) {
    SF_INFO info = {0};
    if (b->open == i + 1)
        return 0;
    close_file(b);
    if (get(b, b->files[i].path, SOUND_BYTES, &b->data, e))
        return -1;
    b->memory = (struct memory_file){.data = b->data.data, .size = (sf_count_t)b->data.size};
    if (aac_file_is(b->data.data, b->data.size)) {
        struct error why;
        b->aac = aac_file_open(b->data.data, b->data.size, &why);
        if (!b->aac)
            return error_set(e, CODE, "'%.100s': %.120s", b->files[i].path, why.message);
    }
    b->file = b->aac ? aac_file_sound(b->aac, &info) : memory_file_open(&b->memory, &info);
    if (!b->file)
        return error_set(e, CODE, "'%.100s': %.80s", b->files[i].path, sf_strerror(NULL));
    if (info.channels < 1 || info.channels > MIXDOWN_CHANNELS_MAX || info.samplerate < RATE_MIN ||
        info.samplerate > RATE_MAX || info.frames < 1 || !info.seekable)
        return error_set(e, CODE, "'%.100s': %d channels of %d samples per second cannot be read",
                         b->files[i].path, info.channels, info.samplerate);
    if (b->rate && b->rate != (uint32_t)info.samplerate)
        return error_set(e, CODE, "'%.100s' has another sample rate than the files before it",
                         b->files[i].path);
    b->rate = (uint32_t)info.samplerate;
    mono_reader_begin(&b->reader, b->file, info.channels);
    b->files[i].samples = (uint64_t)info.frames;
    b->open = i + 1;
    return 0;
}

/* Finds the length of each file, and where each clip lies. */
static int place_clips(struct book_sound *b, struct error *e) {
    for (size_t i = 0; i < b->file_count; i++)
        if (open_file(b, i, e))
            return -1;
    for (size_t i = 0; i < b->clip_count; i++) {
        struct clip *c = &b->clips[i];
        const double length = (double)b->files[c->file].samples;
        double from = fmin(c->begin * b->rate, length),
               to = c->end < 0 ? length : fmin(c->end * b->rate, length);
        c->from = (uint64_t)from;
        c->start = b->samples;
        c->samples = to > from ? (uint64_t)to - c->from : 0;
        b->samples += c->samples;
    }
    if (!b->samples || b->samples / b->rate > HOURS_MAX * 3600ULL)
        return error_set(e, CODE, "the clips of the book have %s",
                         b->samples ? "more than 100 hours" : "no sound");
    return 0;
}

static size_t clip_at(const struct book_sound *b, uint64_t sample) {
    size_t low = 0, high = b->clip_count;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (b->clips[middle].start <= sample)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static size_t read_book(void *ctx, uint64_t from, int16_t *out, size_t count) {
    struct book_sound *b = ctx;
    size_t done = 0;
    struct error e;
    for (size_t i = clip_at(b, from); i < b->clip_count && done < count; i++) {
        const struct clip *c = &b->clips[i];
        uint64_t into = from + done - c->start;
        if (into >= c->samples)
            continue;
        size_t left = (size_t)(c->samples - into), want = count - done < left ? count - done : left;
        size_t got =
            open_file(b, c->file, &e) ? 0 : mono_reader_read(&b->reader, c->from + into, out + done, want);
        memset(out + done + got, 0,
               (want - got) * sizeof *out); /* a damaged end: later clips keep their place */
        done += want;
    }
    return done;
}

/* ---- texts ---- */

/* Finds the sound of the clip that reads this text. */
static void place_name(const struct book_sound *b, const struct named_text *n, struct sound_clip *out) {
    const struct clip *c = &b->clips[n->clip];
    double end = (double)c->samples, first = c->begin * b->rate,
           from = fmin(fmax(n->begin * b->rate - first, 0), end),
           to = n->end < 0 ? end : fmin(fmax(n->end * b->rate - first, from), end);
    out->open = n->end < 0;
    out->from = c->start + (uint64_t)from;
    out->to = c->start + (uint64_t)to;
}

size_t book_sound_clips(struct book_sound *b, struct sound_clip **clips) {
    struct book_texts texts = {0};
    const char *open = NULL;
    size_t count = 0;
    *clips = mem_alloc((b->name_count + 1) * sizeof **clips);
    for (size_t i = 0; i < b->name_count; i++) {
        const struct named_text *n = &b->names[i];
        struct buf data = {0};
        struct error ignored;
        if (!n->id)
            continue;
        if (!open || strcmp(open, n->document) != 0) {
            book_texts_free(&texts);
            open = n->document;
            if (!get(b, open, DOCUMENT_BYTES, &data, &ignored))
                book_texts_read(&texts, data.size ? (char *)data.data : "", data.size);
            buf_free(&data);
        }
        const struct book_text *text = book_texts_find(&texts, n->id);
        if (!text || text->to <= text->from)
            continue;
        struct sound_clip *clip = &(*clips)[count++];
        place_name(b, n, clip);
        clip->text = mem_strndup((char *)texts.text.data + text->from, text->to - text->from);
    }
    book_texts_free(&texts);
    return count;
}

bool book_sound_is(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && !strcasecmp(dot, ".epub");
}

struct book_sound *book_sound_open(const char *path, struct error *e) {
    struct book_sound *b = mem_alloc(sizeof *b);
    int why = 0;
    b->zip = zip_open(path, ZIP_RDONLY, &why);
    if (!b->zip) {
        zip_error_t text;
        zip_error_init_with_code(&text, why);
        error_set(e, CODE, "%.160s: %.80s", path, zip_error_strerror(&text));
        zip_error_fini(&text);
    } else if (!read_clips(b, e) && !place_clips(b, e)) {
        return b;
    }
    book_sound_close(b);
    return NULL;
}

void book_sound_close(struct book_sound *b) {
    if (!b)
        return;
    close_file(b);
    if (b->zip)
        zip_discard(b->zip);
    for (size_t i = 0; i < b->item_count; i++) {
        free(b->items[i].id);
        free(b->items[i].path);
        free(b->items[i].overlay);
    }
    for (size_t i = 0; i < b->spine_count; i++)
        free(b->spine[i]);
    for (size_t i = 0; i < b->file_count; i++)
        free(b->files[i].path);
    for (size_t i = 0; i < b->name_count; i++) {
        free(b->names[i].document);
        free(b->names[i].id);
    }
    free(b->names);
    free(b->items);
    free(b->spine);
    free(b->clips);
    free(b->files);
    free(b);
}

struct sound_source book_sound_source(struct book_sound *b) {
    return (struct sound_source){read_book, b, b->rate, b->samples};
}
