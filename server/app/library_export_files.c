/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/library_export_files.h"
#include "server/app/cli.h"
#include <errno.h>
#include <string.h>

bool library_export_wanted(const struct library_export_files *files) {
    bool wanted = files->epub != NULL;
    for (size_t i = 0; i < EXPORT_OUTPUTS; i++)
        wanted |= files->outputs[i].path != NULL;
    return wanted;
}

static int complain(const char *path) {
    cli_complain("%s: %s", path, strerror(errno));
    return -1;
}

int library_export_open(struct library_export_files *files, const struct work_meta *meta, const char *hash,
                        double fps) {
    static const char *const names[EXPORT_OUTPUTS] = {"wav", "ogg", "fap", "vtt", "textgrid"};
    const struct export_source source = {.lang = meta->lang, .fps = fps};
    if (files->epub && !(files->book = epub_book_open(files->epub, meta, hash)))
        return complain(files->epub);
    for (size_t i = 0; i < EXPORT_OUTPUTS; i++) {
        struct library_export_output *o = &files->outputs[i];
        if (o->path && cli_create(&o->file, o->path))
            return -1;
        if (o->path)
            export_begin(&o->export, export_by_name(names[i]), &source);
    }
    return 0;
}

static int flush(struct library_export_output *o) {
    struct buf *out = &o->export.out;
    bool well = !out->size || fwrite(out->data, 1, out->size, o->file.file) == out->size;
    out->size = 0;
    return well ? 0 : complain(o->path);
}

int library_export_segment(struct library_export_files *files, const struct recital *recital,
                           const struct media_segment *segment, const char *text, const char *markup) {
    if (recital->samples + segment->audio->samples >= UINT32_MAX) {
        cli_complain("this takes more than %.0f hours", (double)UINT32_MAX / recital->rate / 3600);
        return -1;
    }
    if (files->book && epub_book_sound(files->book, segment->audio))
        return complain(files->epub);
    for (size_t i = 0; i < EXPORT_OUTPUTS; i++) {
        struct library_export_output *o = &files->outputs[i];
        if (!o->path)
            continue;
        o->export.source.text = text;
        o->export.source.markup = markup;
        export_segment(&o->export, segment);
        if (o->export.format->streams && flush(o))
            return -1;
    }
    return 0;
}

int library_export_section(struct library_export_files *files, const struct section *section,
                           const struct recital_part *part, uint32_t rate) {
    return files->book && epub_book_section(files->book, section, part, rate) ? complain(files->epub) : 0;
}

/* A file that can be rewound gets its true length. */
static void finish_wav(struct library_export_output *o) {
    uint8_t header[WAV_HEADER_BYTES];
    if (!o->export.sample_rate || fseek(o->file.file, 0, SEEK_SET))
        return;
    wav_header(header, o->export.sample_rate, o->export.samples);
    fwrite(header, 1, sizeof header, o->file.file);
}

int library_export_close(struct library_export_files *files, const struct recital *recital, bool well) {
    char why[200];
    int result = well ? 0 : -1;
    for (size_t i = 0; i < EXPORT_OUTPUTS; i++) {
        struct library_export_output *o = &files->outputs[i];
        bool spoken = well && o->file.file;
        if (spoken) {
            export_end(&o->export);
            spoken = !flush(o);
        }
        if (spoken && i == EXPORT_WAV)
            finish_wav(o);
        if (cli_finish(&o->file, spoken) && well)
            result = -1;
        export_free(&o->export);
    }
    if (!well) {
        epub_book_free(files->book);
    } else if (files->book && epub_book_close(files->book, recital->voice, why)) {
        cli_complain("%s: %s", files->epub, why);
        result = -1;
    }
    files->book = NULL;
    return result;
}
