/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The .fba export: the face as coded packets, each as soon as its frames are there. As in the stream, without
 * FAP 1 and 2, which say again for simple decoders what the others say. */
#include "protocol/fbafile.h"
#include "server/base/mem.h"
#include "server/stream/export.h"
#include <stdlib.h>

struct fba_coder {
    struct fbafile_writer writer;
    size_t count; /* frames that wait for a packet */
    struct fap_frame frames[FBA_FRAMES_MAX];
};

static struct fba_coder *begin(struct export *x) {
    if (!x->coder) {
        struct fba_coder *c = x->coder = mem_alloc(sizeof *c);
        c->count = 0;
        fbafile_begin(&c->writer, x->fps, FBA_QUALITY, buf_reserve(&x->out, FBAFILE_HEADER_BYTES));
        x->out.size += FBAFILE_HEADER_BYTES;
    }
    return x->coder;
}

static void put_packet(struct export *x, struct fba_coder *c) {
    size_t cap = FBAFILE_PACKET_BYTES + (c->count + 1) * FBA_FRAME_BYTES_MAX;
    x->out.size += fbafile_packet(&c->writer, c->frames, c->count, buf_reserve(&x->out, cap), cap);
    c->count = 0;
}

void export_fba_piece(struct export *x, const struct scene *scene, uint32_t to) {
    struct fba_coder *c = begin(x);
    uint32_t end = export_frames_until(x, scene, to);
    for (; x->frames < end; x->frames++) {
        struct fap_frame *frame = &c->frames[c->count++];
        scene_frame(scene, x->fps, x->frames, frame);
        frame->mask[0] &= (uint8_t)~3u;
        if (c->count == c->writer.frames)
            put_packet(x, c);
    }
}

void export_fba_end(struct export *x) {
    struct fba_coder *c = begin(x);
    if (c->count)
        put_packet(x, c);
}

void export_fba_free(struct export *x) {
    free(x->coder);
    x->coder = NULL;
}
