/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The .fapc export: the face as coded packets, each as soon as its frames are there. As in the stream,
 * without FAP 1 and 2, which say again for simple decoders what the others say. */
#include "protocol/fapcfile.h"
#include "server/base/mem.h"
#include "server/export/export.h"
#include <stdlib.h>

struct fapc_coder {
    struct fapcfile_writer writer;
    size_t count; /* frames that wait for a packet */
    struct fap_frame frames[FAPC_FRAMES_MAX];
};

static struct fapc_coder *begin(struct export *x) {
    if (!x->coder) {
        struct fapc_coder *c = x->coder = mem_alloc(sizeof *c);
        c->count = 0;
        fapcfile_begin(&c->writer, x->fps, FAPC_QUALITY, buf_reserve(&x->out, FAPCFILE_HEADER_BYTES));
        x->out.size += FAPCFILE_HEADER_BYTES;
    }
    return x->coder;
}

static void put_packet(struct export *x, struct fapc_coder *c) {
    size_t cap = FAPCFILE_PACKET_BYTES + (c->count + 1) * FAPC_FRAME_BYTES_MAX;
    x->out.size += fapcfile_packet(&c->writer, c->frames, c->count, buf_reserve(&x->out, cap), cap);
    c->count = 0;
}

void export_fapc_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    struct fapc_coder *c = begin(x);
    uint32_t end = export_frames_until(x, segment, to);
    for (; x->frames < end; x->frames++) {
        struct fap_frame *frame = &c->frames[c->count++];
        export_frame(x, segment, x->frames, frame);
        frame->mask[0] &= (uint8_t)~3u;
        if (c->count == c->writer.frames)
            put_packet(x, c);
    }
}

void export_fapc_end(struct export *x) {
    struct fapc_coder *c = begin(x);
    if (c->count)
        put_packet(x, c);
}

void export_fapc_free(struct export *x) {
    free(x->coder);
    x->coder = NULL;
}
