/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A speech as one file, which <talking-head> speaks without a daemon: protocol/bundle.md. */
#include "server/base/mem.h"
#include "server/export/export.h"
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Events without frames. */
static const struct export_format events_format = {
    .name = "events", .piece = export_ndjson_piece, .end = export_ndjson_end};

enum { EVENTS, FACE, SOUND, PARTS };

struct bundle {
    struct export parts[PARTS];
};

static struct bundle *begin(struct export *x) {
    if (x->coder)
        return x->coder;
    struct bundle *b = x->coder = mem_alloc(sizeof *b);
    const struct export_format *formats[PARTS] = {&events_format, export_by_name("fapc"),
                                                  export_by_name("ogg")};
    for (int i = 0; i < PARTS; i++)
        export_begin(&b->parts[i], formats[i], &x->source);
    return b;
}

/* Parts advance by the same EXPORT_PIECE_MS as their owner. */
void export_bundle_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    struct bundle *b = begin(x);
    (void)to;
    for (int i = 0; i < PARTS; i++) {
        b->parts[i].source.text = x->source.text; /* an open text grows */
        export_piece(&b->parts[i], segment);
    }
}

static void put_part(struct buf *out, const char type[4], const void *data, size_t size) {
    uint8_t length[4];
    for (int i = 0; i < 4; i++)
        length[i] = (uint8_t)(size >> (8 * i));
    buf_add(out, type, 4);
    buf_add(out, length, sizeof length);
    buf_add(out, data, size);
}

static void put_info(struct export *x) {
    json_t *info = json_pack("{ss}", "text", x->source.text ? x->source.text : "");
    if (x->source.model)
        json_object_set_new(info, "model", json_string(x->source.model));
    char *text = json_dumps(info, JSON_COMPACT);
    put_part(&x->out, "INFO", text, strlen(text));
    free(text);
    json_decref(info);
}

void export_bundle_end(struct export *x) {
    static const char types[PARTS][4] = {"EVNT", "FAPC", "OPUS"};
    struct bundle *b = begin(x);
    uint8_t sum[4];
    buf_add(&x->out, "FACCIA1\n", 8);
    put_info(x);
    for (int i = 0; i < PARTS; i++) {
        export_end(&b->parts[i]);
        put_part(&x->out, types[i], b->parts[i].out.data, b->parts[i].out.size);
    }
    if (x->source.head_size)
        put_part(&x->out, "HEAD", x->source.head, x->source.head_size);
    uLong crc = crc32_z(crc32_z(0, NULL, 0), x->out.data, x->out.size);
    for (int i = 0; i < 4; i++)
        sum[i] = (uint8_t)(crc >> (8 * i));
    put_part(&x->out, "SUM ", sum, sizeof sum);
}

void export_bundle_free(struct export *x) {
    struct bundle *b = x->coder;
    for (int i = 0; b && i < PARTS; i++)
        export_free(&b->parts[i]);
    free(b);
    x->coder = NULL;
}
