/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/fap_file.h"
#include "protocol/fapc/fapcfile.h"
#include "protocol/fba/fba.h"
#include "server/cli/cli.h"
#include <stdlib.h>

static int read_coded(const char *path, const struct buf *bytes, struct fap_file *out) {
    struct fapcfile file;
    struct fapcfile_error e;
    if (fapcfile_read(bytes->data, bytes->size, &file, &e)) {
        cli_complain("%s: byte %zu: %s", path, e.byte, e.message);
        return -1;
    }
    *out = (struct fap_file){.format = "fapc"};
    out->face = (struct fapfile){.fps = file.fps, .count = file.count, .frames = file.frames};
    return 0;
}

static int read_fba(const char *path, const struct buf *bytes, struct fap_file *out) {
    struct fba_file file;
    struct fba_error e;
    if (fba_read(bytes->data, bytes->size, NULL, &file, &e)) {
        cli_complain("%s: byte %zu, bit %d: %s", path, e.byte, e.bit, e.message);
        return -1;
    }
    *out = (struct fap_file){.format = "fba"};
    out->face = (struct fapfile){.fps = file.fps, .count = file.count, .frames = file.frames};
    return 0;
}

static int read_text(const char *path, const struct buf *bytes, struct fap_file *out) {
    struct fapfile_error e;
    *out = (struct fap_file){.format = "fap"};
    if (fapfile_read(bytes->size ? (char *)bytes->data : "", bytes->size, &out->face, &e)) {
        cli_complain("%s:%zu:%zu: %s", path, e.line, e.column, e.message);
        return -1;
    }
    const struct fapfile_error *note = &out->face.note;
    if (note->message)
        cli_complain("%s:%zu:%zu: warning: %s", path, note->line, note->column, note->message);
    return 0;
}

int fap_file_read(const char *path, struct fap_file *out) {
    struct buf bytes = {0};
    int status = cli_read(path, &bytes);
    if (!status)
        status = fapcfile_is(bytes.data, bytes.size) ? read_coded(path, &bytes, out)
                 : fba_is(bytes.data, bytes.size)    ? read_fba(path, &bytes, out)
                                                     : read_text(path, &bytes, out);
    if (!status)
        out->bytes = bytes.size;
    buf_free(&bytes);
    return status;
}

void fap_file_free(struct fap_file *file) {
    fapfile_free(&file->face); /* frames of .fapc and FBA are malloc'ed, too, and their name is NULL */
}

int fap_file_code(const struct fapfile *face, int quality, struct buf *out) {
    struct fapcfile_writer writer;
    fapcfile_begin(&writer, face->fps, quality, buf_reserve(out, FAPCFILE_HEADER_BYTES));
    out->size += FAPCFILE_HEADER_BYTES;
    for (size_t at = 0; at < face->count; at += writer.frames) {
        size_t count = face->count - at < writer.frames ? face->count - at : writer.frames;
        size_t size = fapcfile_packet(&writer, face->frames + at, count,
                                      buf_reserve(out, FAPCFILE_PACKET_CAP), FAPCFILE_PACKET_CAP);
        if (!size)
            return -1;
        out->size += size;
    }
    return 0;
}

void fap_file_text(const struct fapfile *face, const char *name, struct buf *out) {
    size_t length = fapfile_write_header(name, face->fps, face->count, NULL, 0);
    fapfile_write_header(name, face->fps, face->count, buf_reserve(out, length + 1), length + 1);
    out->size += length;
    for (size_t k = 0; k < face->count; k++) {
        size_t room = 2048, size = fapfile_write_frame(&face->frames[k], k, buf_reserve(out, room), room);
        out->size += size; /* 68 flags, and 66 values of at most 12 characters */
    }
}

int fap_file_fba(const struct fapfile *face, int quant, double intra_seconds, const uint8_t *left,
                 struct buf *out, size_t *limited) {
    struct fba_options options = {.quant = quant, .intra_seconds = intra_seconds, .left = left};
    struct fba_written written;
    if (fba_write(face->frames, face->count, face->fps, &options, &written))
        return -1;
    buf_add(out, written.data, written.size);
    free(written.data);
    *limited = written.limited;
    return 0;
}

int fap_file_write(const char *path, const struct buf *bytes) {
    struct cli_file file;
    if (cli_create(&file, path))
        return EXIT_FAILED;
    fwrite(bytes->data, 1, bytes->size, file.file);
    return cli_finish(&file, true) ? EXIT_FAILED : EXIT_DONE;
}
