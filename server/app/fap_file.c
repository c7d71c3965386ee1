/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/fap_file.h"
#include "protocol/fapcfile.h"
#include "server/app/cli.h"
#include "server/app/cli_file.h"
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
                                                     : read_text(path, &bytes, out);
    if (!status)
        out->bytes = bytes.size;
    buf_free(&bytes);
    return status;
}

void fap_file_free(struct fap_file *file) {
    fapfile_free(&file->face); /* frames of .fapc come from the same malloc, its name is NULL */
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

int fap_file_write(const char *path, const struct buf *bytes) {
    struct cli_file file;
    if (cli_create(&file, path))
        return EXIT_FAILED;
    fwrite(bytes->data, 1, bytes->size, file.file);
    return cli_finish(&file, true) ? EXIT_FAILED : EXIT_DONE;
}
