/* SPDX-License-Identifier: MIT */
#include "protocol/fba/fapfit.h"
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* The fields 69 to 75 are there when their FAP is. */
static bool has(const struct fap_frame *frame, int index) {
    return fap_frame_has(frame, index < FAPFIT_HIGH ? index : index < FAPFIT_HIGH + 3 ? 1 : 2);
}

static double value_of(const struct fap_frame *f, int index) {
    if (index < FAPFIT_HIGH)
        return f->value[index];
    const uint8_t high[] = {f->viseme.select1,       f->viseme.select2,        f->viseme.blend,
                            f->expression.select1,   f->expression.intensity1, f->expression.select2,
                            f->expression.intensity2};
    return high[index - FAPFIT_HIGH];
}

static bool has_all(const struct fap_frame *frame, const struct fapfit_set *set) {
    for (int i = 0; i < set->count; i++)
        if (!has(frame, set->index[i]))
            return false;
    return true;
}

static bool is_high(const struct fapfit_set *set) {
    for (int i = 0; i < set->count; i++)
        if (set->index[i] >= FAPFIT_HIGH)
            return true;
    return false;
}

/* Sums `terms` products; impulse: NULL, or a pair for each, without which it does not count. */
static double polynomial(const struct fap_frame *frame, const struct fapfit_set *parent, size_t terms,
                         const double *coefs, const double *exponents, const double *impulse) {
    double sum = 0;
    for (size_t i = 0; i < terms; i++) {
        if (impulse && value_of(frame, (int)impulse[2 * i]) != impulse[2 * i + 1])
            continue;
        double product = coefs[i];
        for (int k = 0; k < parent->count; k++)
            for (int times = (int)exponents[i * parent->count + (size_t)k]; times > 0; times--)
                product *= value_of(frame, parent->index[k]);
        sum += product;
    }
    return sum;
}

/* Sets what the child lacks. Returns how many FAPs. */
static size_t follow(const struct fapfit *fit, const struct fapfit_link *link, struct fap_frame *frame) {
    const struct fapfit_list *field = fit->field;
    const struct fapfit_set *parent = &fit->set[link->parent], *child = &fit->set[link->child];
    const struct fap_frame before = *frame;
    struct fapfit_link at = *link;
    bool high = is_high(parent);
    size_t set = 0;
    for (int k = 0; k < child->count; k++, at.terms++) {
        size_t up = (size_t)field[FAPFIT_NUMERATOR_TERMS].at[at.terms];
        size_t down = (size_t)field[FAPFIT_DENOMINATOR_TERMS].at[at.terms];
        int n = child->index[k];
        if (!fap_frame_has(&before, n)) {
            double above = polynomial(&before, parent, up, field[FAPFIT_NUMERATOR_COEFS].at + at.above,
                                      field[FAPFIT_NUMERATOR_EXP].at + at.above_exp,
                                      high ? field[FAPFIT_NUMERATOR_IMPULSE].at + at.impulse : NULL);
            double below =
                down ? polynomial(&before, parent, down, field[FAPFIT_DENOMINATOR_COEFS].at + at.below,
                                  field[FAPFIT_DENOMINATOR_EXP].at + at.below_exp, NULL)
                     : 1;
            double value = above / below;
            if (isfinite(value)) {
                fap_frame_set(frame, n, fap_clamp(n, (int32_t)fmax(-1e9, fmin(1e9, round(value)))));
                set++;
            }
        }
        at.above += (uint32_t)up;
        at.below += (uint32_t)down;
        at.above_exp += (uint32_t)(up * parent->count);
        at.below_exp += (uint32_t)(down * parent->count);
        at.impulse += high ? (uint32_t)(2 * up) : 0;
    }
    return set;
}

size_t fapfit_apply(const struct fapfit *fit, struct fap_frame *frame) {
    bool done[FAPFIT_SETS_MAX] = {false}; /* or all there from the beginning */
    size_t set = 0;
    for (bool again = true; again;) {
        again = false;
        for (size_t s = 0; s < fit->sets; s++) {
            if (done[s])
                continue;
            done[s] = has_all(frame, &fit->set[s]);
            for (size_t i = 0; !done[s] && i < fit->links; i++)
                if (fit->link[i].child == s && has_all(frame, &fit->set[fit->link[i].parent])) {
                    set += follow(fit, &fit->link[i], frame);
                    done[s] = again = true;
                }
        }
    }
    return set;
}

/* Pairs of inner and outer lips, and of left and right; all of one direction or of mirrored ones, so that
 * equal values mirror. Lips first: a side of the mouth rather follows itself. */
static const uint8_t partners[][2] = {{4, 51},  {5, 52},  {6, 53},  {7, 54},  {8, 55},  {9, 56},  {10, 57},
                                      {11, 58}, {12, 59}, {13, 60}, {6, 7},   {8, 9},   {10, 11}, {12, 13},
                                      {19, 20}, {21, 22}, {23, 24}, {25, 26}, {27, 28}, {29, 30}, {31, 32},
                                      {33, 34}, {35, 36}, {37, 38}, {39, 40}, {41, 42}, {53, 54}, {55, 56},
                                      {57, 58}, {59, 60}, {61, 62}, {65, 66}, {67, 68}};

static bool supply_one(const uint8_t *left, struct fap_frame *frame) {
    bool set = false;
    for (size_t i = 0; i < sizeof partners / sizeof *partners; i++)
        for (int k = 0; k < 2; k++) {
            int n = partners[i][k], from = partners[i][1 - k];
            if (!(left[(n - 1) / 8] >> ((n - 1) % 8) & 1) || fap_frame_has(frame, n) ||
                !fap_frame_has(frame, from))
                continue;
            fap_frame_set(frame, n, frame->value[from]);
            set = true;
        }
    return set;
}

void fapfit_supply(const uint8_t left[FAP_MASK_BYTES], struct fap_frame *frames, size_t count) {
    for (size_t k = 0; k < count; k++)
        while (supply_one(left, &frames[k]))
            continue;
}

/* ---- writing ---- */

static double half_step(int n, int quant) {
    return 0.5 * fap_table[n].quant_step * (quant ? quant : 1);
}

/* Fits FAP n as a multiple of FAP p. Returns the factor, or NAN if any frame deviates by more than half a
 * quantiser step. */
static double factor_of(const struct fap_frame *frames, size_t count, int n, int p, int quant) {
    double products = 0, squares = 0;
    for (size_t k = 0; k < count; k++) {
        products += (double)frames[k].value[n] * frames[k].value[p];
        squares += (double)frames[k].value[p] * frames[k].value[p];
    }
    double factor = squares ? products / squares : 0;
    for (size_t k = 0; k < count; k++)
        if (fabs(frames[k].value[n] - factor * frames[k].value[p]) > half_step(n, quant))
            return NAN;
    return factor;
}

static bool in_all(const struct fap_frame *frames, size_t count, int n) {
    for (size_t k = 0; k < count; k++)
        if (!fap_frame_has(&frames[k], n))
            return false;
    return count > 0;
}

static int add_function(struct fapfit *fit, double factor) {
    static const enum fapfit_field ones[] = {FAPFIT_NUMERATOR_TERMS, FAPFIT_DENOMINATOR_TERMS,
                                             FAPFIT_NUMERATOR_EXP, FAPFIT_DENOMINATOR_COEFS};
    for (size_t i = 0; i < sizeof ones / sizeof *ones; i++)
        if (fapfit_add(fit, ones[i], 1))
            return -1;
    return fapfit_add(fit, FAPFIT_DENOMINATOR_EXP, 0) || fapfit_add(fit, FAPFIT_NUMERATOR_COEFS, factor) ? -1
                                                                                                         : 0;
}

/* Adds a set with FAP p, a set with the FAPs that depend on it, and the link between them. */
static int add_followers(struct fapfit *fit, int p, const int *of, const double *factors, int *sets) {
    int status = fapfit_add(fit, FAPFIT_FAPS, p) || fapfit_add(fit, FAPFIT_FAPS, -1);
    for (int n = 3; n <= FAP_COUNT && !status; n++)
        if (of[n] == p)
            status = fapfit_add(fit, FAPFIT_FAPS, n) || add_function(fit, factors[n]);
    status = status || fapfit_add(fit, FAPFIT_FAPS, -1) || fapfit_add(fit, FAPFIT_GRAPH, *sets + 1) ||
             fapfit_add(fit, FAPFIT_GRAPH, *sets + 2);
    *sets += 2;
    return status ? -1 : 0;
}

int fapfit_find(const struct fap_frame *frames, size_t count, int quant, struct fapfit *out) {
    int of[FAP_COUNT + 1] = {0}, sets = 0;
    double factors[FAP_COUNT + 1] = {0};
    const char *message;
    bool there[FAP_COUNT + 1] = {false}, followed[FAP_COUNT + 1] = {false};
    memset(out, 0, sizeof *out);
    for (int n = 3; n <= FAP_COUNT; n++)
        there[n] = in_all(frames, count, n);
    for (int n = 3; n <= FAP_COUNT; n++)
        for (int p = 3; there[n] && p < n && !of[n]; p++) {
            double factor = there[p] && !of[p] ? factor_of(frames, count, n, p, quant) : NAN;
            if (!isnan(factor)) {
                of[n] = p;
                factors[n] = factor;
                followed[p] = true;
            }
        }
    for (int p = 3; p <= FAP_COUNT; p++)
        if (followed[p] && add_followers(out, p, of, factors, &sets))
            return -1;
    return fapfit_settle(out, &message);
}

/* Returns whether the table restores every frame if FAP n is left out as well. */
static bool is_given_back(const struct fapfit *fit, const struct fap_frame *frames, size_t count, int quant,
                          const uint8_t *left, int n) {
    for (size_t k = 0; k < count; k++) {
        struct fap_frame frame = frames[k];
        for (int i = 0; i < FAP_MASK_BYTES; i++)
            frame.mask[i] &= (uint8_t)~left[i];
        fapfit_apply(fit, &frame);
        for (int i = 3; i <= FAP_COUNT; i++) {
            bool is_left = i == n || left[(i - 1) / 8] >> ((i - 1) % 8) & 1;
            if (is_left && (!fap_frame_has(&frame, i) ||
                            fabs((double)frame.value[i] - frames[k].value[i]) > half_step(i, quant) + 0.5))
                return false;
        }
    }
    return true;
}

size_t fapfit_leave(const struct fapfit *fit, struct fap_frame *frames, size_t count, int quant,
                    uint8_t left[FAP_MASK_BYTES]) {
    size_t all = 0;
    memset(left, 0, FAP_MASK_BYTES);
    for (int n = FAP_COUNT; n >= 3; n--) {
        uint8_t bit = (uint8_t)(1u << ((n - 1) % 8));
        bool follows = false;
        for (size_t i = 0; i < fit->links; i++)
            follows |=
                memchr(fit->set[fit->link[i].child].index, n, fit->set[fit->link[i].child].count) != NULL;
        if (!follows || !in_all(frames, count, n))
            continue;
        left[(n - 1) / 8] |= bit;
        if (is_given_back(fit, frames, count, quant, left, n))
            all++;
        else
            left[(n - 1) / 8] &= (uint8_t)~bit;
    }
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < FAP_MASK_BYTES; i++)
            frames[k].mask[i] &= (uint8_t)~left[i];
    return all;
}
