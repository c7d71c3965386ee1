/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Binary media. .fapc: coded face packets, each as soon as its frames are complete, without FAP 1 and 2,
 * which repeat the other FAPs for simple decoders. */
#include "protocol/fapc/fapcfile.h"
#include "server/base/mem.h"
#include "server/codec/opus_audio.h"
#include "server/export/export.h"
#include <ogg/ogg.h>
#include <stdlib.h>
#include <string.h>

struct fapc_coder {
    struct fapcfile_writer writer;
    size_t count; /* frames waiting for a packet */
    struct fap_frame frames[FAPC_FRAMES_MAX];
};

static struct fapc_coder *begin_fapc(struct export *x) {
    if (!x->coder) {
        struct fapc_coder *c = x->coder = mem_alloc(sizeof *c);
        c->count = 0;
        fapcfile_begin(&c->writer, x->fps, FAPC_QUALITY, buf_reserve(&x->out, FAPCFILE_HEADER_BYTES));
        x->out.size += FAPCFILE_HEADER_BYTES;
    }
    return x->coder;
}

static void put_fapc_packet(struct export *x, struct fapc_coder *c) {
    size_t cap = FAPCFILE_PACKET_BYTES + (c->count + 1) * FAPC_FRAME_BYTES_MAX;
    x->out.size += fapcfile_packet(&c->writer, c->frames, c->count, buf_reserve(&x->out, cap), cap);
    c->count = 0;
}

void export_fapc_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    struct fapc_coder *c = begin_fapc(x);
    uint32_t end = export_frames_until(x, segment, to);
    for (; x->frames < end; x->frames++) {
        struct fap_frame *frame = &c->frames[c->count++];
        export_frame(x, segment, x->frames, frame);
        frame->mask[0] &= (uint8_t)~3u;
        if (c->count == c->writer.frames)
            put_fapc_packet(x, c);
    }
}

void export_fapc_end(struct export *x) {
    struct fapc_coder *c = begin_fapc(x);
    if (c->count)
        put_fapc_packet(x, c);
}

void export_fapc_free(struct export *x) {
    free(x->coder);
    x->coder = NULL;
}

/* Opus in Ogg (RFC 7845), mono; pages end with sentences. */

enum { SERIAL = 1, HEAD_BYTES = 19, BITRATE = 32000 };

struct ogg_coder {
    ogg_stream_state stream;
    struct opus_audio *audio;
    struct buf packets; /* each after its length; the last is held until another follows */
    ogg_int64_t coded;  /* samples at 48 kHz in packets so far */
    ogg_int64_t count;  /* number of packets */
};

static void put_pages(struct export *x, int (*next)(ogg_stream_state *, ogg_page *)) {
    struct ogg_coder *c = x->coder;
    ogg_page page;
    while (next(&c->stream, &page)) {
        buf_add(&x->out, page.header, (size_t)page.header_len);
        buf_add(&x->out, page.body, (size_t)page.body_len);
    }
}

static void put_packet(struct ogg_coder *c, uint8_t *data, size_t size, ogg_int64_t granule, bool last) {
    ogg_packet packet = {.packet = data,
                         .bytes = (long)size,
                         .b_o_s = !c->count,
                         .e_o_s = last,
                         .granulepos = granule,
                         .packetno = c->count};
    c->count++;
    ogg_stream_packetin(&c->stream, &packet);
}

/* Writes the two headers, each on its own page. */
static void begin(struct export *x, uint32_t rate) {
    struct ogg_coder *c = x->coder = mem_alloc(sizeof *c);
    uint8_t head[HEAD_BYTES] = "OpusHead\1\1";
    uint8_t tags[] = "OpusTags\6\0\0\0faccia\0\0\0";
    c->audio = opus_audio_new(rate, BITRATE);
    ogg_stream_init(&c->stream, SERIAL);
    unsigned skip = c->audio ? opus_audio_skip(c->audio) : 0;
    head[10] = (uint8_t)skip;
    head[11] = (uint8_t)(skip >> 8);
    for (int i = 0; i < 4; i++)
        head[12 + i] = (uint8_t)(rate >> (8 * i));
    put_packet(c, head, sizeof head, 0, false);
    put_pages(x, ogg_stream_flush);
    put_packet(c, tags, sizeof tags, 0, false); /* including the string's NUL: the fourth byte of a 0 */
    put_pages(x, ogg_stream_flush);
}

/* Writes all packets except the last, or including it at the end: its granule position marks the end of the
 * stream. */
static void put_packets(struct export *x, bool end) {
    struct ogg_coder *c = x->coder;
    uint8_t *at = c->packets.data, *limit = at + c->packets.size;
    while (at < limit) {
        size_t length = at[0] < 252 ? at[0] : (size_t)at[0] + 4 * (size_t)at[1];
        uint8_t *packet = at + (at[0] < 252 ? 1 : 2);
        bool last = packet + length == limit;
        if (last && !end)
            break;
        c->coded += OPUS_PACKET_SAMPLES;
        ogg_int64_t whole = (ogg_int64_t)opus_audio_skip(c->audio) +
                            ((ogg_int64_t)x->samples * OPUS_RATE + x->sample_rate / 2) / x->sample_rate;
        put_packet(c, packet, length, last && whole < c->coded ? whole : c->coded, last);
        at = packet + length;
    }
    buf_consume(&c->packets, (size_t)(at - c->packets.data));
}

static void add_samples(void *ctx, const int16_t *pcm, size_t count) {
    struct ogg_coder *c = ctx;
    opus_audio_add(c->audio, pcm, count, &c->packets);
}

/* Flushes at a segment's start and end, otherwise when pages are full. */
void export_ogg_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    const struct sentence_audio *u = segment->audio;
    if (!x->coder)
        begin(x, u->sample_rate);
    struct ogg_coder *c = x->coder;
    if (!c->audio)
        return;
    export_samples(x, segment, to, add_samples, c);
    if (c->packets.size)
        put_packets(x, false);
    put_pages(x, x->at && to < u->samples ? ogg_stream_pageout : ogg_stream_flush);
}

void export_ogg_end(struct export *x) {
    struct ogg_coder *c = x->coder;
    if (!c || !c->audio)
        return;
    opus_audio_end(c->audio, &c->packets);
    if (c->packets.size)
        put_packets(x, true);
    put_pages(x, ogg_stream_flush);
}

void export_ogg_free(struct export *x) {
    struct ogg_coder *c = x->coder;
    if (!c)
        return;
    opus_audio_free(c->audio);
    ogg_stream_clear(&c->stream);
    buf_free(&c->packets);
    free(c);
    x->coder = NULL;
}
