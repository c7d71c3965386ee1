/* SPDX-License-Identifier: MIT */
#include "protocol/fba/fba.h"
#include "protocol/fba/fba_plane.h"
#include <stdlib.h>
#include <string.h>

enum { FPS_DEFAULT = 30, SIXTEENTHS = 16 };

struct reader {
    struct fba_bits bits;
    struct fba_error *error;
    const struct fba_limits *limits;
    struct fba_plane *plane;
    struct fba_file file;
    size_t cap;
    struct fap_frame frame; /* the latest */
    bool started;           /* an I frame was read */
    size_t skip;            /* how many frames repeat the latest */
};

/* Reports an error at a position in bits. Returns -1. */
static int fail_at(struct reader *r, size_t at, const char *message) {
    at = at < r->bits.size ? at : r->bits.size;
    *r->error = (struct fba_error){at / 8, (int)(at % 8), message};
    return -1;
}

static int check_end(struct reader *r) {
    return r->bits.at > r->bits.size ? fail_at(r, r->bits.size, "the stream ends within a frame") : 0;
}

/* The position of the first start code of a face object, or size. Codes of the sequence and the visual object
 * may stand before it. */
static size_t find_start(const uint8_t *data, size_t size) {
    static const uint8_t before[] = {0xb0, 0xb2, 0xb5}; /* sequence, user data, visual object */
    for (size_t i = 0; i + 4 <= size; i++) {
        if (data[i] || data[i + 1] || data[i + 2] != 1)
            continue;
        uint8_t code = data[i + 3];
        if (code == (FBA_OBJECT_START & 0xff) || (!i && code == (FBA_OBJECT_START_DRAFT & 0xff)))
            return i;
        if (!memchr(before, code, sizeof before))
            return size;
    }
    return size;
}

bool fba_is(const uint8_t *data, size_t size) {
    return size >= 4 && !data[0] && !data[1] && data[2] == 1 && find_start(data, size) < size;
}

static int read_marker(struct reader *r) {
    size_t at = r->bits.at;
    return fba_bit(&r->bits) ? 0 : fail_at(r, at, "a marker bit is 0");
}

/* ---- header ---- */

static int read_rate(struct reader *r) {
    size_t at = r->bits.at;
    uint32_t whole = fba_bits_get(&r->bits, 8), part = fba_bits_get(&r->bits, 4);
    bool offset = fba_bit(&r->bits);
    if (check_end(r))
        return -1;
    if (!whole && !part)
        return fail_at(r, at, "the frame rate is 0");
    double fps = (whole + part / (double)SIXTEENTHS) * (offset ? 1000.0 / 1001 : 1);
    if (r->file.count && fps != r->file.fps)
        return fail_at(r, at, "the frame rate changes");
    r->file.fps = fps;
    return 0;
}

static int read_skip(struct reader *r) {
    size_t at = r->bits.at;
    uint32_t more;
    do {
        more = fba_bits_get(&r->bits, 4);
        r->skip += more;
        if (r->skip > r->limits->frames)
            return fail_at(r, at, "more frames than one file may have");
    } while (more == 15);
    return check_end(r);
}

/* Temporal header, 6.2.10.3. */
static int read_times(struct reader *r, bool intra) {
    if (intra && fba_bit(&r->bits) && read_rate(r))
        return -1;
    if (intra && fba_bit(&r->bits)) { /* time code: frames follow one another here */
        fba_bits_get(&r->bits, 11);
        if (read_marker(r))
            return -1;
        fba_bits_get(&r->bits, 6);
    }
    r->skip = 0;
    return fba_bit(&r->bits) ? read_skip(r) : check_end(r);
}

static void set_mask(uint8_t *mask, int n, bool on) {
    uint8_t bit = (uint8_t)(1u << ((n - 1) % 8));
    mask[(n - 1) / 8] = (uint8_t)(on ? mask[(n - 1) / 8] | bit : mask[(n - 1) / 8] & ~bit);
}

static int read_masks(struct reader *r) {
    for (int g = 0; g < FBA_GROUPS; g++) {
        if (read_marker(r))
            return -1;
        uint32_t type = fba_bits_get(&r->bits, 2);
        for (int n = fba_group_begin[g]; n < fba_group_begin[g + 1]; n++) {
            bool on = type == 3 || ((type == 1 || type == 2) && fba_bit(&r->bits));
            set_mask(r->plane->mask, n, on);
            if (type == 2 && !on)
                set_mask(r->file.interpolated, n, true);
        }
    }
    return check_end(r);
}

/* New ranges: a marker before every fourth FAP of a group, 5 bits for each FAP of the mask. */
static int read_range(struct reader *r, uint8_t *range) {
    for (int g = 1; g < FBA_GROUPS; g++)
        for (int n = fba_group_begin[g], k = 0; n < fba_group_begin[g + 1]; n++, k++) {
            if (k % 4 == 0 && read_marker(r))
                return -1;
            if (fba_plane_has(r->plane, n))
                range[n] = (uint8_t)fba_bits_get(&r->bits, 5);
        }
    return check_end(r);
}

static int read_intra_header(struct reader *r) {
    struct fba_plane *p = r->plane;
    p->quant = (int)fba_bits_get(&r->bits, 5);
    if (read_masks(r))
        return -1;
    fba_bit(&r->bits); /* suggested_gender */
    size_t at = r->bits.at;
    if (fba_bit(&r->bits))
        return fail_at(r, at, "segments of 16 frames (DCT coding) are not read");
    uint8_t *const ranges[] = {p->ranges.i_max, p->ranges.i_min, p->ranges.p_max, p->ranges.p_min};
    uint32_t stated = fba_bits_get(&r->bits, 4);
    for (int i = 0; i < 4; i++)
        if (stated >> (3 - i) & 1 && read_range(r, ranges[i]))
            return -1;
    fba_plane_reset(p);
    return check_end(r);
}

/* ---- values ---- */

static int end_codeword(struct reader *r, struct fba_decoder *d) {
    const char *message = fba_decoder_end(d);
    return message ? fail_at(r, r->bits.at, message) : 0;
}

static int read_high_part(struct reader *r, struct fba_decoder *d, bool intra, int part) {
    struct fba_plane *p = r->plane;
    int most = fba_high_most(part, p->quant), step = fba_high_step(part, p->quant);
    if (intra) {
        fba_model_reset(&p->even, 0, most);
        p->high_shown[part] = fba_decode(d, &p->even, false) * step;
    } else {
        p->high_shown[part] += fba_decode(d, &p->high[part], true) * step;
    }
    int shown = p->high_shown[part]; /* at most 78 more in each frame */
    return shown < 0 ? 0 : shown > fba_high_most(part, 0) ? fba_high_most(part, 0) : shown;
}

static int read_high(struct reader *r, bool intra) {
    struct fba_decoder d;
    int v[FBA_HIGH];
    if (fba_plane_has(r->plane, 1)) {
        fba_decoder_begin(&d, &r->bits);
        for (int part = 0; part < 3; part++)
            v[part] = read_high_part(r, &d, intra, part);
        if (end_codeword(r, &d))
            return -1;
        r->frame.viseme =
            (struct fap_viseme){(uint8_t)v[0], (uint8_t)v[1], (uint8_t)v[2], (uint8_t)fba_bit(&r->bits)};
    }
    if (fba_plane_has(r->plane, 2)) {
        fba_decoder_begin(&d, &r->bits);
        for (int part = 3; part < FBA_HIGH; part++)
            v[part] = read_high_part(r, &d, intra, part);
        if (end_codeword(r, &d))
            return -1;
        r->frame.expression =
            (struct fap_expression){(uint8_t)v[3], (uint8_t)v[4], (uint8_t)v[5], (uint8_t)v[6], 0, 0};
        r->frame.expression.init_face = (uint8_t)fba_bit(&r->bits);
        r->frame.expression.def = (uint8_t)fba_bit(&r->bits);
    }
    return check_end(r);
}

static int read_values(struct reader *r, bool intra) {
    struct fba_plane *p = r->plane;
    struct fba_decoder d;
    if (read_high(r, intra))
        return -1;
    size_t at = r->bits.at;
    fba_decoder_begin(&d, &r->bits);
    for (int n = 3; n <= FAP_COUNT; n++) {
        if (!fba_plane_has(p, n))
            continue;
        int64_t value = (int64_t)fba_decode(&d, fba_plane_model(p, n, intra), !intra) * fba_step(n, p->quant);
        value += intra ? 0 : p->shown[n];
        if (value < INT32_MIN || value > INT32_MAX)
            return fail_at(r, at, "a value exceeds 32 bits");
        p->shown[n] = r->frame.value[n] = (int32_t)value;
    }
    return end_codeword(r, &d);
}

/* ---- frames ---- */

static int add_frame(struct reader *r) {
    for (size_t copies = r->skip + 1; copies; copies--) {
        struct fba_file *f = &r->file;
        if (f->count == r->limits->frames)
            return fail_at(r, r->bits.at, "more frames than one file may have");
        if (f->count == r->cap) {
            size_t cap = r->cap ? r->cap * 2 : 64;
            struct fap_frame *frames = realloc(f->frames, cap * sizeof *frames);
            if (!frames)
                return fail_at(r, r->bits.at, "not enough memory");
            f->frames = frames;
            r->cap = cap;
        }
        f->frames[f->count++] = r->frame;
    }
    return 0;
}

static int read_plane(struct reader *r) {
    uint32_t code = fba_bits_next_code(&r->bits);
    if (code == FBA_PLANE_START || code == FBA_PLANE_START_DRAFT)
        fba_bits_skip_code(&r->bits);
    size_t at = r->bits.at;
    bool intra = fba_bit(&r->bits);
    uint32_t parts = fba_bits_get(&r->bits, 2);
    if (check_end(r))
        return -1;
    if (parts & FBA_MASK_BODY)
        return fail_at(r, at + 1, "body animation (BAPs) is not read");
    if (!parts)
        return fail_at(r, at + 1, "a frame without FAPs");
    if (!intra && !r->started)
        return fail_at(r, at, "the first frame is no I frame");
    if (read_times(r, intra) || (intra && read_intra_header(r)))
        return -1;
    if (intra) {
        r->started = true;
        r->frame = (struct fap_frame){0};
        memcpy(r->frame.mask, r->plane->mask, sizeof r->frame.mask);
    }
    return read_values(r, intra) || add_frame(r) ? -1 : 0;
}

/* At the end code, or at what a last byte is filled with: a 0 and 1s, or 0s. */
static bool at_end(const struct reader *r) {
    struct fba_bits ahead = r->bits;
    size_t left = ahead.size - ahead.at;
    if (fba_bits_next_code(&ahead) == FBA_SEQUENCE_END || !left)
        return true;
    if (left > 8)
        return false;
    uint32_t rest = fba_bits_get(&ahead, (int)left);
    return !rest || rest == (1u << (left - 1)) - 1;
}

static int read_all(struct reader *r) {
    while (!at_end(r)) {
        if (r->limits->stop && r->limits->stop(r->limits->ctx))
            return fail_at(r, r->bits.at, "stopped");
        if (read_plane(r))
            return -1;
    }
    return r->file.count ? 0 : fail_at(r, r->bits.at, "there are no frames");
}

int fba_read(const uint8_t *data, size_t size, const struct fba_limits *limits, struct fba_file *out,
             struct fba_error *error) {
    static const struct fba_limits wide = {.frames = FBA_FRAMES_MAX};
    struct reader r = {.error = error, .limits = limits ? limits : &wide, .file.fps = FPS_DEFAULT};
    size_t start = find_start(data, size);
    r.bits = (struct fba_bits){data, size * 8, (start + 4) * 8};
    if (start == size)
        return fail_at(&r, 0, "no start code of a face object (00 00 01 BA)");
    r.plane = calloc(1, sizeof *r.plane);
    if (!r.plane)
        return fail_at(&r, 0, "not enough memory");
    fba_ranges_init(&r.plane->ranges);
    /* a start code right behind the object's: the codes are at bytes, with nothing to stuff */
    struct fba_bits ahead = r.bits;
    uint32_t next = fba_bits_get(&ahead, 32);
    if (ahead.at <= ahead.size && (next == FBA_PLANE_START || next == FBA_PLANE_START_DRAFT))
        r.bits = ahead;
    int status = read_all(&r);
    free(r.plane);
    if (status)
        free(r.file.frames);
    else
        *out = r.file;
    return status;
}

void fba_free(struct fba_file *file) {
    free(file->frames);
    *file = (struct fba_file){0};
}
