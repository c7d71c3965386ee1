/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/publish/epub_book.h"
#include "server/base/mem.h"
#include "server/publish/epub_package.h"
#include "server/publish/spool.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zip.h>

struct kept_file {
    char name[24];
    struct spool_piece piece;
    bool packed;
};

struct epub_book {
    char *path;
    struct spool spool;
    struct spool_sound *sound;
    struct kept_file *files;
    size_t count, cap;
    struct epub_package package;
};

struct epub_book *epub_book_open(const char *path, const struct work_meta *meta, const char *hash) {
    struct epub_book *b = mem_alloc(sizeof *b);
    b->path = mem_strdup(path);
    b->package.meta = meta;
    b->package.hash = hash;
    if (!spool_open(&b->spool, path))
        return b;
    int why = errno;
    epub_book_free(b);
    errno = why;
    return NULL;
}

void epub_book_free(struct epub_book *b) {
    struct spool_piece nothing;
    if (!b)
        return;
    if (b->sound)
        spool_sound_end(b->sound, &nothing);
    spool_close(&b->spool);
    epub_package_free(&b->package);
    free(b->files);
    free(b->path);
    free(b);
}

int epub_book_sound(struct epub_book *b, const struct sentence_audio *audio) {
    if (!b->sound)
        b->sound = spool_sound_open(&b->spool, audio->sample_rate);
    return b->sound ? spool_sound_add(b->sound, audio->pcm, audio->samples) : -1;
}

static void keep(struct epub_book *b, const char *prefix, unsigned number, const char *ending,
                 struct spool_piece piece, bool packed) {
    b->files = mem_grow(b->files, &b->cap, b->count + 1, sizeof *b->files);
    struct kept_file *f = &b->files[b->count++];
    *f = (struct kept_file){.piece = piece, .packed = packed};
    snprintf(f->name, sizeof f->name, "EPUB/%s%u%s", prefix, number, ending);
}

int epub_book_section(struct epub_book *b, const struct section *section, const struct recital_part *part,
                      uint32_t rate) {
    struct buf text = {0}, overlay = {0};
    struct spool_piece piece;
    uint64_t ms = epub_smil(&overlay, section->number, part, rate);
    bool spoken = ms > 0 && b->sound;
    int result = 0;
    if (b->sound) { /* what no word is known of is not heard */
        result = spool_sound_end(b->sound, &piece);
        b->sound = NULL;
    }
    if (spoken && !result) {
        keep(b, "s", section->number, ".mp3", piece, false);
        result = spool_add(&b->spool, &overlay, &piece);
        keep(b, "s", section->number, ".smil", piece, true);
    }
    epub_xhtml(&text, section, part, b->package.meta->lang);
    if (!result)
        result = spool_add(&b->spool, &text, &piece);
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
    static const char type[] = "application/epub+zip"; /* first, and as it is (OCF 3.3, 4.3) */
    if (add_text(zip, "mimetype", type, sizeof type - 1, false) ||
        add_text(zip, "META-INF/container.xml", epub_container, strlen(epub_container), true) ||
        add_text(zip, "EPUB/package.opf", opf->data, opf->size, true) ||
        add_text(zip, "EPUB/nav.xhtml", nav->data, nav->size, true) ||
        add_text(zip, "EPUB/style.css", epub_style, strlen(epub_style), true))
        return -1;
    for (size_t i = 0; i < b->count; i++)
        if (spool_to_zip(&b->files[i].piece, zip, b->files[i].name, b->files[i].packed))
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
