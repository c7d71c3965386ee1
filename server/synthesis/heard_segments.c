/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A heard voice becomes segments: sound whose frames are known. */
#include "server/base/mem.h"
#include "server/synthesis/heard_voice_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCKS_A_SECOND = 100, AHEAD_BLOCKS = 50 };

void heard_frame(void *ctx, uint32_t k, const struct fap_frame *frame) {
    struct heard_voice *h = ctx;
    (void)k; /* they come in order */
    h->frames = mem_grow(h->frames, &h->frame_cap, h->frame_count + 1, sizeof *frame);
    h->frames[h->frame_count++] = *frame;
}

void heard_hear(struct heard_voice *h, const int16_t *samples, size_t count) {
    float block[HEARD_RATE_MOST / BLOCKS_A_SECOND];
    h->pcm = mem_grow(h->pcm, &h->pcm_cap, h->pcm_count + count, sizeof *samples);
    memcpy(h->pcm + h->pcm_count, samples, count * sizeof *samples);
    h->pcm_count += count;
    for (size_t i = 0; i < count; i++)
        block[i] = (float)samples[i] / 32768;
    hearing_write(h->hearing, block, count);
}

/* No more than is soon used up: the rest waits where it can still be left out. */
static void hear_on(struct heard_voice *h) {
    int16_t block[HEARD_RATE_MOST / BLOCKS_A_SECOND];
    size_t size = h->rate / BLOCKS_A_SECOND, count;
    size_t most = size * AHEAD_BLOCKS + (size_t)(h->rate / h->request.fps);
    while (!h->heard_all && h->pcm_count < most && (count = heard_pace_take(&h->pace, block, size)))
        heard_hear(h, block, count);
    if (h->closed && !h->heard_all && h->pcm_count < most) {
        hearing_end(h->hearing);
        h->heard_all = true;
    }
}

/* How many samples make a piece now; 0 = too few. */
static size_t piece_size(const struct heard_voice *h) {
    size_t known = h->pcm_count, most = (size_t)h->rate * HEARD_PIECE_MOST_MS / 1000;
    double end = (double)(h->first_frame + h->frame_count) / h->request.fps * h->rate - h->given;
    if (!h->heard_all && end < (double)known)
        known = end > 0 ? (size_t)end : 0;
    if (!h->heard_all && known < (size_t)h->rate * HEARD_PIECE_MS / 1000)
        return 0;
    return known < most ? known : most;
}

static void *copy_of(const void *from, size_t size) {
    return memcpy(mem_alloc(size), from, size);
}

/* With the frames of its time, and at least one: the last one stays. */
static void hand_on(struct heard_voice *h, size_t size) {
    uint32_t next = frame_from_sample((uint64_t)h->given + size, h->rate, h->request.fps);
    size_t used = next > h->first_frame ? next - h->first_frame : 0;
    used = used < h->frame_count ? used : h->frame_count;
    struct media_segment segment = {
        .audio = mem_alloc(sizeof *segment.audio),
        .start = h->given,
        .sentence = h->handed++,
        .mouth = true,
        .alone = {.still = h->request.still, .life = h->request.life >= 0 ? h->request.life : 1},
        .first_frame = h->first_frame,
        .frame_count = used};
    *segment.audio = (struct sentence_audio){
        .sample_rate = h->rate, .pcm = copy_of(h->pcm, size * sizeof *h->pcm), .samples = (uint32_t)size};
    segment.own = used ? copy_of(h->frames, used * sizeof *h->frames) : NULL;
    segment.frames = segment.own;
    h->given += (uint32_t)size;
    h->pcm_count -= size;
    memmove(h->pcm, h->pcm + size, h->pcm_count * sizeof *h->pcm);
    h->frame_count -= used;
    h->first_frame += (uint32_t)used;
    if (used)
        memmove(h->frames, h->frames + used, h->frame_count * sizeof *h->frames);
    h->callbacks.segment(h->ctx, segment);
}

static void end(struct heard_voice *h) {
    struct error e;
    h->finished = true;
    if (!h->handed) {
        error_set(&e, ERROR_BAD_SOUND, "no sound has come");
        h->callbacks.problem(h->ctx, &e, false);
    }
    h->callbacks.finished(h->ctx, h->handed);
}

void heard_deliver(struct heard_voice *h) {
    size_t size = 1;
    if (h->finished || !h->started)
        return;
    while (size && h->handed - h->released < HEARD_PIECES) {
        hear_on(h);
        size = piece_size(h);
        if (size)
            hand_on(h, size);
    }
    if (h->heard_all && !h->pcm_count)
        end(h);
}

void heard_voice_wait(struct heard_voice *h, unsigned ms) {
    static const int16_t silence[HEARD_RATE_MOST / BLOCKS_A_SECOND];
    h->stalled = true;
    for (unsigned i = 0; !h->heard_all && i < ms * BLOCKS_A_SECOND / 1000; i++)
        heard_hear(h, silence, h->rate / BLOCKS_A_SECOND);
    heard_deliver(h);
}
