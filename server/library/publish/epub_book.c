/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/publish/epub_book.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/library/publish/publish_internal.h"
#include "server/library/publish/temp_file.h"
#include "server/library/works/work.h"
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <sndfile.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <zip.h>

/* ---- the parts of the archive wait on disk until it is complete, in an unnamed file, so that nothing is
 * left behind; sound as MP3, which every reading system supports. Errors are -1 (or NULL) with errno. ---- */

struct reading {
    struct temp_piece piece;
    uint64_t at;
    zip_error_t error;
};

static zip_int64_t read_piece(struct reading *r, void *data, zip_uint64_t size) {
    uint64_t left = r->piece.size - r->at;
    ssize_t n = pread(r->piece.temp->file, data, size < left ? size : left, (off_t)(r->piece.start + r->at));
    if (n < 0)
        zip_error_set(&r->error, ZIP_ER_READ, errno);
    else
        r->at += (uint64_t)n;
    return n;
}

static zip_int64_t on_source(void *self, void *data, zip_uint64_t size, zip_source_cmd_t command) {
    struct reading *r = self;
    switch (command) {
    case ZIP_SOURCE_OPEN:
        r->at = 0;
        return 0;
    case ZIP_SOURCE_READ:
        return read_piece(r, data, size);
    case ZIP_SOURCE_CLOSE:
        return 0;
    case ZIP_SOURCE_STAT: {
        zip_stat_t *stat = data;
        zip_stat_init(stat);
        stat->valid = ZIP_STAT_SIZE;
        stat->size = r->piece.size;
        return (zip_int64_t)sizeof *stat;
    }
    case ZIP_SOURCE_ERROR:
        return zip_error_to_data(&r->error, data, size);
    case ZIP_SOURCE_FREE:
        free(r);
        return 0;
    case ZIP_SOURCE_SUPPORTS:
        return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE,
                                              ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, -1);
    default:
        zip_error_set(&r->error, ZIP_ER_OPNOTSUPP, 0);
        return -1;
    }
}

/* Adds a piece to the archive under that name, compressed if `packed`. The file must outlive zip_close. -1:
 * see zip_strerror. */
static int temp_file_to_zip(const struct temp_piece *piece, struct zip *zip, const char *name, bool packed) {
    struct reading *r = mem_alloc(sizeof *r);
    r->piece = *piece;
    zip_source_t *source = zip_source_function(zip, on_source, r);
    if (!source) {
        free(r);
        return -1;
    }
    zip_int64_t number = zip_file_add(zip, name, source, ZIP_FL_ENC_UTF_8);
    if (number < 0) {
        zip_source_free(source);
        return -1;
    }
    return zip_set_file_compression(zip, (zip_uint64_t)number, packed ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
}

struct temp_sound {
    struct temp_file *temp;
    sf_count_t at, size; /* bytes from the end of the file's finished pieces */
    SNDFILE *file;
    int failed; /* errno */
};

static sf_count_t length_of(void *self) {
    return ((struct temp_sound *)self)->size;
}

static sf_count_t seek_to(sf_count_t offset, int whence, void *self) {
    struct temp_sound *s = self;
    sf_count_t from = whence == SEEK_CUR ? s->at : whence == SEEK_END ? s->size : 0;
    if (from + offset < 0)
        return -1;
    return s->at = from + offset;
}

static sf_count_t read_some(void *to, sf_count_t count, void *self) {
    struct temp_sound *s = self;
    ssize_t n = pread(s->temp->file, to, (size_t)count, (off_t)s->temp->end + s->at);
    s->at += n > 0 ? n : 0;
    return n > 0 ? n : 0;
}

static sf_count_t write_some(const void *from, sf_count_t count, void *self) {
    struct temp_sound *s = self;
    ssize_t n = pwrite(s->temp->file, from, (size_t)count, (off_t)s->temp->end + s->at);
    if (n != count)
        s->failed = n < 0 ? errno : ENOSPC;
    s->at += n > 0 ? n : 0;
    if (s->at > s->size)
        s->size = s->at;
    return n > 0 ? n : 0;
}

static sf_count_t where(void *self) {
    return ((struct temp_sound *)self)->at;
}

static struct temp_sound *temp_sound_open(struct temp_file *temp, uint32_t rate) {
    static const SF_VIRTUAL_IO io = {length_of, seek_to, read_some, write_some, where};
    SF_INFO info = {
        .samplerate = (int)rate, .channels = 1, .format = SF_FORMAT_MPEG | SF_FORMAT_MPEG_LAYER_III};
    struct temp_sound *s = mem_alloc(sizeof *s);
    s->temp = temp;
    s->file = sf_open_virtual((SF_VIRTUAL_IO *)&io, SFM_WRITE, &info, s);
    if (!s->file) {
        free(s);
        errno = ENOTSUP; /* libsndfile was built without MP3 */
        return NULL;
    }
    return s;
}

/* pcm NULL: silence */
static int temp_sound_add(struct temp_sound *s, const int16_t *pcm, uint32_t samples) {
    static const int16_t silence[4096];
    for (uint32_t done = 0; done < samples && !s->failed;) {
        uint32_t size = pcm || samples - done < 4096 ? samples - done : 4096;
        if (sf_write_short(s->file, pcm ? pcm + done : silence, size) != (sf_count_t)size && !s->failed)
            s->failed = EIO;
        done += size;
    }
    errno = s->failed;
    return s->failed ? -1 : 0;
}

/* Finishes the piece and frees the encoder. */
static int temp_sound_end(struct temp_sound *s, struct temp_piece *piece) {
    int failed = sf_close(s->file) && !s->failed ? EIO : s->failed;
    *piece = (struct temp_piece){s->temp, s->temp->end, (uint64_t)s->size};
    s->temp->end += (uint64_t)s->size;
    free(s);
    errno = failed;
    return failed ? -1 : 0;
}

/* ---- the package document and the navigation document ---- */

struct epub_package {
    const struct work_meta *meta;      /* borrowed */
    const char *hash;                  /* SHA-256 of the work's file, 64 hexadecimal digits; borrowed */
    struct buf manifest, spine, times; /* filled section by section */
    struct buf nav;
    unsigned depth; /* number of open lists in the navigation */
    uint64_t ms;    /* total duration of the overlays */
};

static const char epub_container[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<container xmlns=\"urn:oasis:names:tc:opendocument:xmlns:"
    "container\" version=\"1.0\"><rootfiles><rootfile full-path=\"EPUB/package.opf\" "
    "media-type=\"application/oebps-package+xml\"/></rootfiles></container>\n";

static const char epub_style[] =
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

/* W3C-DTF down to the day; other dates of a work are omitted. */
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

/* ms: duration of the section's overlay; 0 = none. */
static void epub_package_section(struct epub_package *p, const struct section *section, uint64_t ms) {
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

/* A version 8 UUID (RFC 9562, 5.8) from the file's hash, so that the same file makes the same book. */
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

static void epub_package_write(const struct epub_package *p, const char *voice, struct buf *out) {
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

static void epub_package_nav(struct epub_package *p, struct buf *out) {
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

static void epub_package_free(struct epub_package *p) {
    buf_free(&p->manifest);
    buf_free(&p->spine);
    buf_free(&p->times);
    buf_free(&p->nav);
}

struct kept_file {
    char name[24];
    struct temp_piece piece;
    bool packed;
};

struct epub_book {
    char *path;
    struct temp_file temp;
    struct temp_sound *sound;
    struct kept_file *files;
    size_t count, cap;
    struct epub_package package;
};

struct epub_book *epub_book_open(const char *path, const struct work_meta *meta, const char *hash) {
    struct epub_book *b = mem_alloc(sizeof *b);
    b->path = mem_strdup(path);
    b->package.meta = meta;
    b->package.hash = hash;
    if (!temp_file_open(&b->temp, path))
        return b;
    int why = errno;
    epub_book_free(b);
    errno = why;
    return NULL;
}

void epub_book_free(struct epub_book *b) {
    struct temp_piece nothing;
    if (!b)
        return;
    if (b->sound)
        temp_sound_end(b->sound, &nothing);
    temp_file_close(&b->temp);
    epub_package_free(&b->package);
    free(b->files);
    free(b->path);
    free(b);
}

int epub_book_sound(struct epub_book *b, const struct sentence_audio *audio) {
    if (!b->sound)
        b->sound = temp_sound_open(&b->temp, audio->sample_rate);
    return b->sound ? temp_sound_add(b->sound, audio->pcm, audio->samples) : -1;
}

static void keep(struct epub_book *b, const char *prefix, unsigned number, const char *ending,
                 struct temp_piece piece, bool packed) {
    b->files = mem_grow(b->files, &b->cap, b->count + 1, sizeof *b->files);
    struct kept_file *f = &b->files[b->count++];
    *f = (struct kept_file){.piece = piece, .packed = packed};
    snprintf(f->name, sizeof f->name, "EPUB/%s%u%s", prefix, number, ending);
}

int epub_book_section(struct epub_book *b, const struct section *section, const struct narration_part *part,
                      uint32_t rate) {
    struct buf text = {0}, overlay = {0};
    struct temp_piece piece;
    uint64_t ms = epub_smil(&overlay, section->number, part, rate);
    bool spoken = ms > 0 && b->sound;
    int result = 0;
    if (b->sound) { /* without known words there is nothing to play */
        result = temp_sound_end(b->sound, &piece);
        b->sound = NULL;
    }
    if (spoken && !result) {
        keep(b, "s", section->number, ".mp3", piece, false);
        result = temp_file_add(&b->temp, &overlay, &piece);
        keep(b, "s", section->number, ".smil", piece, true);
    }
    epub_xhtml(&text, section, part, b->package.meta->lang);
    if (!result)
        result = temp_file_add(&b->temp, &text, &piece);
    keep(b, "s", section->number, ".xhtml", piece, true);
    epub_package_section(&b->package, section, spoken ? ms : 0);
    buf_free(&text);
    buf_free(&overlay);
    return result;
}

/* The text must outlive zip_close. */
static int add_text(struct zip *zip, const char *name, const void *text, size_t size, bool packed) {
    zip_source_t *source = zip_source_buffer(zip, text, size, 0);
    zip_int64_t number = source ? zip_file_add(zip, name, source, ZIP_FL_ENC_UTF_8) : -1;
    if (source && number < 0)
        zip_source_free(source);
    return number < 0 ? -1
                      : zip_set_file_compression(zip, (zip_uint64_t)number,
                                                 packed ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
}

static int fill(struct epub_book *b, struct zip *zip, const struct buf *opf, const struct buf *nav) {
    static const char type[] = "application/epub+zip"; /* must come first and uncompressed (OCF 3.3, 4.3) */
    if (add_text(zip, "mimetype", type, sizeof type - 1, false) ||
        add_text(zip, "META-INF/container.xml", epub_container, strlen(epub_container), true) ||
        add_text(zip, "EPUB/package.opf", opf->data, opf->size, true) ||
        add_text(zip, "EPUB/nav.xhtml", nav->data, nav->size, true) ||
        add_text(zip, "EPUB/style.css", epub_style, strlen(epub_style), true))
        return -1;
    for (size_t i = 0; i < b->count; i++)
        if (temp_file_to_zip(&b->files[i].piece, zip, b->files[i].name, b->files[i].packed))
            return -1;
    return 0;
}

int epub_book_close(struct epub_book *b, const char *voice, char why[200]) {
    struct buf opf = {0}, nav = {0};
    int number = 0;
    struct zip *zip = zip_open(b->path, ZIP_CREATE | ZIP_TRUNCATE, &number);
    epub_package_write(&b->package, voice, &opf);
    epub_package_nav(&b->package, &nav);
    int result = zip ? fill(b, zip, &opf, &nav) : -1;
    if (!zip) {
        zip_error_t error;
        zip_error_init_with_code(&error, number);
        snprintf(why, 200, "%s", zip_error_strerror(&error));
        zip_error_fini(&error);
    } else if (result || zip_close(zip)) {
        snprintf(why, 200, "%s", zip_strerror(zip));
        zip_discard(zip);
        result = -1;
    }
    buf_free(&opf);
    buf_free(&nav);
    epub_book_free(b);
    return result;
}
