/* SPDX-License-Identifier: MIT */
#include "protocol/fba/fba.h"
#include "protocol/fba/fba_plane.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Frames are written in groups: an I frame and the P frames up to the next. A group is quantised first, which
 * gives the ranges that its I frame states; then it is coded. */

struct writer {
    struct fba_sink sink;
    struct fba_plane *plane;
    const struct fap_frame *frames;
    size_t count, group_max; /* frames; of a group */
    double fps;
    const uint8_t *left;
    size_t limited, intra;
    int16_t (*levels)[FAP_COUNT + 1]; /* of the frames of a group */
    int8_t (*high)[FBA_HIGH];
};

static int limit(int64_t value, int least, int most) {
    return (int)(value < least ? least : value > most ? most : value);
}

/* Nearest level; half a step or less is 0, as the quantiser of the standard has it. */
static int64_t level_of(int64_t value, int step) {
    int64_t size = value < 0 ? -value : value;
    size = size <= step / 2 ? 0 : (size + step / 2) / step;
    return value < 0 ? -size : size;
}

/* ---- quantising ---- */

static void parts_of(const struct fap_frame *f, int v[FBA_HIGH]) {
    const int parts[FBA_HIGH] = {f->viseme.select1,       f->viseme.select2,        f->viseme.blend,
                                 f->expression.select1,   f->expression.intensity1, f->expression.select2,
                                 f->expression.intensity2};
    memcpy(v, parts, sizeof parts);
}

static void quantise_high(struct writer *w, const struct fap_frame *f, bool intra, int8_t *levels) {
    struct fba_plane *p = w->plane;
    int v[FBA_HIGH];
    parts_of(f, v);
    for (int part = 0; part < FBA_HIGH; part++) {
        int step = fba_high_step(part, p->quant), most = fba_high_most(part, p->quant);
        int64_t level = level_of(v[part] - (intra ? 0 : p->high_shown[part]), step);
        levels[part] = (int8_t)limit(level, intra ? 0 : -most, most);
        p->high_shown[part] = (intra ? 0 : p->high_shown[part]) + levels[part] * step;
    }
}

/* Quantises the frame; shown becomes what a decoder has. false: a difference is too large for a P frame. */
static bool quantise(struct writer *w, const struct fap_frame *f, bool intra, int16_t *levels) {
    struct fba_plane *p = w->plane;
    int most = fba_levels(FBA_RANGE_MAX, p->quant);
    for (int n = 3; n <= FAP_COUNT; n++) {
        if (!fba_plane_has(p, n))
            continue;
        int step = fba_step(n, p->quant);
        int64_t level = level_of(f->value[n] - (int64_t)(intra ? 0 : p->shown[n]), step);
        if (!intra && (level < -most || level > most))
            return false;
        levels[n] = (int16_t)limit(level, -most, most);
        w->limited += levels[n] != level;
    }
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fba_plane_has(p, n))
            p->shown[n] = (intra ? 0 : p->shown[n]) + levels[n] * fba_step(n, p->quant);
    return true;
}

/* Quantises frames from `begin` up to the next one that needs an I frame. Returns their number. */
static size_t quantise_group(struct writer *w, size_t begin) {
    size_t size = 0;
    for (; size < w->group_max && begin + size < w->count; size++) {
        const struct fap_frame *f = &w->frames[begin + size];
        if (size && memcmp(f->mask, w->plane->mask, sizeof f->mask))
            break;
        memset(w->levels[size], 0, sizeof w->levels[size]);
        if (!quantise(w, f, !size, w->levels[size]))
            break;
        quantise_high(w, f, !size, w->high[size]);
    }
    return size;
}

/* The smallest statement that allows the level. */
static uint8_t statement(int level, int quant) {
    int needed = level > 0 ? (level * (quant ? quant : 1) + FBA_RANGE_STEP - 1) / FBA_RANGE_STEP : 0;
    return (uint8_t)(needed > FBA_RANGE_MAX ? FBA_RANGE_MAX : needed);
}

static void find_ranges(struct writer *w, size_t size) {
    struct fba_plane *p = w->plane;
    p->ranges = (struct fba_ranges){0};
    for (int n = 3; n <= FAP_COUNT; n++) {
        int least = 0, most = 0;
        for (size_t k = 1; k < size; k++) {
            least = w->levels[k][n] < least ? w->levels[k][n] : least;
            most = w->levels[k][n] > most ? w->levels[k][n] : most;
        }
        p->ranges.i_max[n] = statement(w->levels[0][n], p->quant);
        p->ranges.i_min[n] = statement(-w->levels[0][n], p->quant);
        p->ranges.p_max[n] = statement(most, p->quant);
        p->ranges.p_min[n] = statement(-least, p->quant);
    }
}

/* ---- coding ---- */

static void put_rate(struct writer *w) {
    double sixteenths = w->fps * 16, offset = sixteenths * 1001 / 1000;
    bool ntsc = fabs(sixteenths - round(sixteenths)) > 1e-3 && fabs(offset - round(offset)) < 0.02;
    uint32_t rate = (uint32_t)lround(ntsc ? offset : sixteenths);
    rate = rate ? rate : 1;
    fba_put(&w->sink, rate / 16, 8);
    fba_put(&w->sink, rate % 16, 4);
    fba_put(&w->sink, ntsc, 1);
}

static void put_masks(struct writer *w) {
    for (int g = 0; g < FBA_GROUPS; g++) {
        int size = fba_group_begin[g + 1] - fba_group_begin[g], set = 0;
        bool left = false;
        for (int n = fba_group_begin[g]; n < fba_group_begin[g + 1]; n++) {
            set += fba_plane_has(w->plane, n);
            left |= !fba_plane_has(w->plane, n) && w->left && (w->left[(n - 1) / 8] >> ((n - 1) % 8) & 1);
        }
        fba_put(&w->sink, 1, 1);
        fba_put(&w->sink, left ? 2 : !set ? 0 : set == size ? 3 : 1, 2);
        for (int n = fba_group_begin[g]; (left || (set && set < size)) && n < fba_group_begin[g + 1]; n++)
            fba_put(&w->sink, fba_plane_has(w->plane, n), 1);
    }
}

static void put_range(struct writer *w, const uint8_t *range) {
    for (int g = 1; g < FBA_GROUPS; g++)
        for (int n = fba_group_begin[g], k = 0; n < fba_group_begin[g + 1]; n++, k++) {
            if (k % 4 == 0)
                fba_put(&w->sink, 1, 1);
            if (fba_plane_has(w->plane, n))
                fba_put(&w->sink, range[n], 5);
        }
}

static void put_intra_header(struct writer *w) {
    struct fba_plane *p = w->plane;
    fba_put(&w->sink, (uint32_t)p->quant, 5);
    put_masks(w);
    fba_put(&w->sink, 0, 1);   /* suggested_gender */
    fba_put(&w->sink, 0, 1);   /* predictive coding */
    fba_put(&w->sink, 0xf, 4); /* all four ranges follow */
    put_range(w, p->ranges.i_max);
    put_range(w, p->ranges.i_min);
    put_range(w, p->ranges.p_max);
    put_range(w, p->ranges.p_min);
    fba_plane_reset(p);
}

static void put_high(struct writer *w, const struct fap_frame *f, bool intra, const int8_t *levels) {
    static const uint8_t begin[] = {0, 3, FBA_HIGH};
    struct fba_plane *p = w->plane;
    for (int n = 1; n <= 2; n++) {
        if (!fba_plane_has(p, n))
            continue;
        struct fba_encoder e;
        fba_encoder_begin(&e, &w->sink);
        for (int part = begin[n - 1]; part < begin[n]; part++) {
            if (intra)
                fba_model_reset(&p->even, 0, fba_high_most(part, p->quant));
            fba_encode(&e, intra ? &p->even : &p->high[part], levels[part], !intra);
        }
        fba_encoder_end(&e);
        if (n == 2)
            fba_put(&w->sink, f->expression.init_face != 0, 1);
        fba_put(&w->sink, n == 1 ? f->viseme.def != 0 : f->expression.def != 0, 1);
    }
}

static void put_values(struct writer *w, bool intra, const int16_t *levels) {
    struct fba_plane *p = w->plane;
    struct fba_encoder e;
    fba_encoder_begin(&e, &w->sink);
    for (int n = 3; n <= FAP_COUNT; n++) {
        if (fba_plane_has(p, n))
            fba_encode(&e, fba_plane_model(p, n, intra), levels[n], !intra);
    }
    fba_encoder_end(&e);
}

static void put_group(struct writer *w, size_t begin, size_t size) {
    for (size_t k = 0; k < size && !w->sink.failed; k++) {
        bool intra = !k;
        if (intra)
            fba_put_code(&w->sink, FBA_PLANE_START);
        fba_put(&w->sink, intra, 1);
        fba_put(&w->sink, FBA_MASK_FAP, 2);
        if (intra) {
            fba_put(&w->sink, 1, 1);
            put_rate(w);
            fba_put(&w->sink, 0, 1); /* no time code */
        }
        /* The last frame before a start code says that it skips none, in 4 more bits: a reader could take a
         * frame of 6 bits for what fills the byte before the code. */
        bool last = k + 1 == size;
        fba_put(&w->sink, last, 1);
        if (last)
            fba_put(&w->sink, 0, 4);
        if (intra)
            put_intra_header(w);
        put_high(w, &w->frames[begin + k], intra, w->high[k]);
        put_values(w, intra, w->levels[k]);
    }
}

static int allocate(struct writer *w) {
    w->plane = calloc(1, sizeof *w->plane);
    w->levels = calloc(w->group_max, sizeof *w->levels);
    w->high = calloc(w->group_max, sizeof *w->high);
    return w->plane && w->levels && w->high ? 0 : -1;
}

int fba_write(const struct fap_frame *frames, size_t count, double fps, const struct fba_options *options,
              struct fba_written *out) {
    struct writer w = {.frames = frames, .count = count, .fps = fps, .left = options->left};
    double group = options->intra_seconds * fps;
    if (!(fps > 0 && fps <= FBA_FPS_MAX) || options->quant < 0 || options->quant > FBA_QUANT_MAX ||
        !(group > 0) || count > FBA_FRAMES_MAX)
        return -1;
    w.group_max = group < 1 ? 1 : group > (double)count ? count + 1 : (size_t)group;
    int status = allocate(&w);
    fba_put_code(&w.sink, FBA_OBJECT_START);
    for (size_t at = 0, size; !status && at < count; at += size) {
        w.plane->quant = options->quant;
        memcpy(w.plane->mask, frames[at].mask, sizeof w.plane->mask);
        size = quantise_group(&w, at);
        find_ranges(&w, size);
        put_group(&w, at, size);
        w.intra++;
    }
    fba_put_code(&w.sink, FBA_SEQUENCE_END);
    free(w.plane);
    free(w.levels);
    free(w.high);
    if (status || w.sink.failed) {
        free(w.sink.data);
        return -1;
    }
    *out = (struct fba_written){w.sink.data, w.sink.size / 8, w.limited, w.intra};
    return 0;
}
