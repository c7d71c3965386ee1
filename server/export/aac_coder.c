/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/export/aac_coder.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>
#include <vo-aacenc/voAAC.h>
#include <vo-aacenc/voMem.h>

enum {
    FRAME = 1024,    /* samples of a frame */
    FRAME_MAX = 768, /* bytes of one channel in a frame (6144 bits) */
    HEADER = 7,      /* bytes before each frame */
    DELAY = 2,       /* frames until the last sample is out */
};

/* The library's own functions for memory are not among its public ones. */
static VO_U32 take(VO_S32 id, VO_MEM_INFO *info) {
    (void)id;
    info->VBuffer = info->Size > 0 ? calloc(1, (size_t)info->Size) : NULL;
    return info->VBuffer ? VO_ERR_NONE : VO_ERR_OUTOF_MEMORY;
}

static VO_U32 give(VO_S32 id, VO_PTR data) {
    (void)id;
    free(data);
    return VO_ERR_NONE;
}

static VO_U32 set(VO_S32 id, VO_PTR data, VO_U8 value, VO_U32 size) {
    (void)id;
    memset(data, value, size);
    return VO_ERR_NONE;
}

static VO_U32 copy(VO_S32 id, VO_PTR to, VO_PTR from, VO_U32 size) {
    (void)id;
    memcpy(to, from, size);
    return VO_ERR_NONE;
}

static VO_U32 check(VO_S32 id, VO_PTR data, VO_U32 size) {
    (void)id;
    (void)data;
    (void)size;
    return VO_ERR_NONE;
}

static VO_S32 compare(VO_S32 id, VO_PTR a, VO_PTR b, VO_U32 size) {
    (void)id;
    return memcmp(a, b, size);
}

static VO_U32 move(VO_S32 id, VO_PTR to, VO_PTR from, VO_U32 size) {
    (void)id;
    memmove(to, from, size);
    return VO_ERR_NONE;
}

struct aac_coder {
    VO_AUDIO_CODECAPI library;
    VO_MEM_OPERATOR memory;
    VO_HANDLE handle;
    struct buf *out;
    int16_t frame[FRAME]; /* samples that do not fill a frame yet */
    size_t filled;
};

/* Bits per second: 64000 up to 24 kHz, 96000 above; never more than six bits a sample. */
static int bit_rate(uint32_t rate) {
    int most = (int)(6 * rate), wanted = rate > 24000 ? 96000 : 64000;
    return wanted < most ? wanted : most;
}

struct aac_coder *aac_coder_new(uint32_t rate, struct buf *out) {
    struct aac_coder *c = mem_alloc(sizeof *c);
    *c = (struct aac_coder){.memory = {take, give, set, copy, check, compare, move}, .out = out};
    VO_CODEC_INIT_USERDATA data = {.memflag = VO_IMF_USERMEMOPERATOR, .memData = &c->memory};
    AACENC_PARAM form = {.sampleRate = (int)rate, .bitRate = bit_rate(rate), .nChannels = 1, .adtsUsed = 1};
    if (voGetAACEncAPI(&c->library) != VO_ERR_NONE ||
        c->library.Init(&c->handle, VO_AUDIO_CodingAAC, &data) != VO_ERR_NONE) {
        free(c);
        return NULL;
    }
    if (c->library.SetParam(c->handle, VO_PID_AAC_ENCPARAM, &form) == VO_ERR_NONE)
        return c;
    aac_coder_free(c);
    return NULL;
}

static void code_frame(struct aac_coder *c) {
    VO_CODECBUFFER in = {.Buffer = (VO_PBYTE)c->frame, .Length = sizeof c->frame};
    VO_AUDIO_OUTPUTINFO about;
    c->filled = 0;
    if (c->library.SetInputData(c->handle, &in) != VO_ERR_NONE)
        return;
    for (VO_U32 made = VO_ERR_NONE; made == VO_ERR_NONE;) {
        VO_CODECBUFFER coded = {.Buffer = buf_reserve(c->out, FRAME_MAX + HEADER),
                                .Length = FRAME_MAX + HEADER};
        made = c->library.GetOutputData(c->handle, &coded, &about);
        if (made == VO_ERR_NONE)
            c->out->size += coded.Length;
    }
}

void aac_coder_put(struct aac_coder *c, const int16_t *pcm, size_t count) {
    while (count) {
        size_t now = FRAME - c->filled < count ? FRAME - c->filled : count;
        memcpy(c->frame + c->filled, pcm, now * sizeof *pcm);
        c->filled += now;
        pcm += now;
        count -= now;
        if (c->filled == FRAME)
            code_frame(c);
    }
}

void aac_coder_end(struct aac_coder *c) {
    for (int i = c->filled ? -1 : 0; i < DELAY; i++) {
        memset(c->frame + c->filled, 0, (FRAME - c->filled) * sizeof *c->frame);
        code_frame(c);
    }
}

void aac_coder_free(struct aac_coder *c) {
    if (!c)
        return;
    c->library.Uninit(c->handle);
    free(c);
}
