/* SPDX-License-Identifier: MIT */
#include "protocol/fba/fba_arith.h"

enum { QUARTER = 1 << 14, HALF = 1 << 15, THREE_QUARTERS = HALF + QUARTER, TOP = 65535, ZEROS_MAX = 22 };

/* ---- frequencies, summed from the end: the symbol 0 has the highest part of the interval ---- */

static uint32_t count_of(const struct fba_model *m) {
    return (uint32_t)(m->max - m->min) + 1;
}

static uint32_t lowest_bit(uint32_t i) {
    return i & (~i + 1);
}

/* Makes a Fenwick tree of the frequencies in sums[1..n]. */
static void sum_up(struct fba_model *m) {
    uint32_t n = count_of(m);
    m->total = 0;
    for (uint32_t i = 1; i <= n; i++)
        m->total += m->sums[i];
    for (uint32_t i = 1; i <= n; i++)
        if (i + lowest_bit(i) <= n)
            m->sums[i + lowest_bit(i)] = (uint16_t)(m->sums[i + lowest_bit(i)] + m->sums[i]);
}

void fba_model_reset(struct fba_model *m, int min, int max) {
    m->min = min;
    m->max = max;
    for (uint32_t i = 1, n = count_of(m); i <= n; i++)
        m->sums[i] = 1;
    sum_up(m);
}

/* Sum of the frequencies of the symbols 0..count-1. */
static uint32_t sum_before(const struct fba_model *m, uint32_t count) {
    uint32_t sum = 0;
    for (uint32_t i = count; i; i -= lowest_bit(i))
        sum += m->sums[i];
    return sum;
}

/* Finds the symbol whose interval contains the cumulative frequency `before`. */
static uint32_t symbol_at(const struct fba_model *m, uint32_t before) {
    uint32_t n = count_of(m), at = 0, step = 1;
    while (step * 2 <= n)
        step *= 2;
    for (; step; step /= 2)
        if (at + step <= n && m->sums[at + step] <= before) {
            at += step;
            before -= m->sums[at];
        }
    return at < n ? at : n - 1;
}

static void halve(struct fba_model *m) {
    uint32_t n = count_of(m);
    for (uint32_t i = n; i; i--)
        if (i + lowest_bit(i) <= n)
            m->sums[i + lowest_bit(i)] = (uint16_t)(m->sums[i + lowest_bit(i)] - m->sums[i]);
    for (uint32_t i = 1; i <= n; i++)
        m->sums[i] = (uint16_t)((m->sums[i] + 1) / 2);
    sum_up(m);
}

static void count_symbol(struct fba_model *m, uint32_t symbol) {
    if (m->total == FBA_TOTAL_MAX)
        halve(m);
    m->total++;
    for (uint32_t i = symbol + 1, n = count_of(m); i <= n; i += lowest_bit(i))
        m->sums[i]++;
}

/* The part of the interval that belongs to the symbol. */
static void narrow(const struct fba_model *m, uint32_t symbol, uint32_t *low, uint32_t *high) {
    uint32_t length = *high - *low + 1, before = sum_before(m, symbol), behind = sum_before(m, symbol + 1);
    *high = *low + length * (m->total - before) / m->total - 1;
    *low += length * (m->total - behind) / m->total;
}

/* ---- decoding ---- */

static void read_bit(struct fba_decoder *d) {
    if (d->zeros == ZEROS_MAX) {
        if (!fba_bit(d->bits) && d->bad == SIZE_MAX)
            d->bad = d->bits->at - 1;
        d->zeros = 0;
    }
    unsigned bit = fba_bit(d->bits);
    d->zeros = bit ? 0 : d->zeros + 1;
    d->code = d->code << 1 | bit;
    d->ends[d->read++ % 16] = d->bits->at;
}

void fba_decoder_begin(struct fba_decoder *d, struct fba_bits *bits) {
    *d = (struct fba_decoder){.bits = bits, .high = TOP, .bad = SIZE_MAX};
    for (int i = 0; i < 16; i++)
        read_bit(d);
}

int fba_decode(struct fba_decoder *d, struct fba_model *m, bool adapt) {
    uint32_t length = d->high - d->low + 1;
    uint32_t cum = ((d->code - d->low + 1) * m->total - 1) / length;
    uint32_t symbol = symbol_at(m, m->total - 1 - cum);
    narrow(m, symbol, &d->low, &d->high);
    for (;;) {
        uint32_t take = d->high < HALF                                  ? 0
                        : d->low >= HALF                                ? HALF
                        : d->low >= QUARTER && d->high < THREE_QUARTERS ? QUARTER
                                                                        : UINT32_MAX;
        if (take == UINT32_MAX)
            break;
        d->low = (d->low - take) * 2;
        d->high = (d->high - take) * 2 + 1;
        d->code -= take;
        read_bit(d);
    }
    if (adapt)
        count_symbol(m, symbol);
    return m->min + (int)symbol;
}

const char *fba_decoder_end(struct fba_decoder *d) {
    d->bits->at = d->ends[(d->read - FBA_LOOK_AHEAD - 1) % 16];
    if (d->bad < d->bits->at && d->bad < d->bits->size) {
        d->bits->at = d->bad;
        return "no stuffing bit after 22 zeros";
    }
    return d->bits->at > d->bits->size ? "the stream ends within a frame" : NULL;
}

/* ---- encoding ---- */

static void put_bit(struct fba_encoder *e, unsigned bit) {
    if (e->zeros == ZEROS_MAX) {
        fba_put(e->sink, 1, 1);
        e->zeros = 0;
    }
    fba_put(e->sink, bit, 1);
    e->zeros = bit ? 0 : e->zeros + 1;
}

static void put_with_opposites(struct fba_encoder *e, unsigned bit) {
    put_bit(e, bit);
    for (; e->opposite; e->opposite--)
        put_bit(e, !bit);
}

void fba_encoder_begin(struct fba_encoder *e, struct fba_sink *sink) {
    *e = (struct fba_encoder){.sink = sink, .high = TOP};
}

void fba_encode(struct fba_encoder *e, struct fba_model *m, int value, bool adapt) {
    uint32_t symbol = (uint32_t)(value - m->min);
    narrow(m, symbol, &e->low, &e->high);
    for (;;) {
        uint32_t take = 0;
        if (e->high < HALF)
            put_with_opposites(e, 0);
        else if (e->low >= HALF) {
            put_with_opposites(e, 1);
            take = HALF;
        } else if (e->low >= QUARTER && e->high < THREE_QUARTERS) {
            e->opposite++;
            take = QUARTER;
        } else
            break;
        e->low = (e->low - take) * 2;
        e->high = (e->high - take) * 2 + 1;
    }
    if (adapt)
        count_symbol(m, symbol);
}

void fba_encoder_end(struct fba_encoder *e) {
    e->opposite++;
    put_with_opposites(e, e->low >= QUARTER);
}
