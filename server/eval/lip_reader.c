/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/lip_reader.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

const uint8_t reader_faps[READER_FAPS] = {4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 16,
                                          17, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60};

int lip_reader_half(const char *word, size_t size) {
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (size_t i = 0; i < size; i++) {
        unsigned char c = (unsigned char)word[i];
        hash = (hash ^ (c >= 'A' && c <= 'Z' ? c + 32u : c)) * 16777619u;
    }
    return (hash >> 16 ^ hash) & 1;
}

void lip_reader_add(struct lip_reader *r, int half, const struct lip_reader_sample *sample) {
    if (r->count[half] == READER_MAX)
        return;
    r->samples[half] = mem_grow(r->samples[half], &r->cap[half], r->count[half] + 1, sizeof *sample);
    r->samples[half][r->count[half]++] = *sample;
}

/* A feature that never changed in what was learnt tells nothing and becomes 0. */
static void scale(struct lip_reader *r) {
    const struct lip_reader_sample *learnt = r->samples[READER_LEARN];
    double n = (double)r->count[READER_LEARN];
    for (int k = 0; k < READER_FEATURES; k++) {
        double sum = 0, squares = 0;
        for (size_t i = 0; i < r->count[READER_LEARN]; i++)
            sum += learnt[i].features[k];
        for (size_t i = 0; i < r->count[READER_LEARN]; i++)
            squares += (learnt[i].features[k] - sum / n) * (learnt[i].features[k] - sum / n);
        double deviation = sqrt(squares / n);
        for (int half = 0; half < READER_HALVES; half++)
            for (size_t i = 0; i < r->count[half]; i++) {
                float *x = &r->samples[half][i].features[k];
                *x = deviation > 1e-9 ? (float)((*x - sum / n) / deviation) : 0;
            }
    }
}

static const void *nearest(const struct lip_reader *r, const struct lip_reader_sample *sample) {
    const void *class = NULL;
    float best = INFINITY;
    for (size_t i = 0; i < r->count[READER_LEARN]; i++) {
        const struct lip_reader_sample *learnt = &r->samples[READER_LEARN][i];
        float distance = 0;
        for (int k = 0; k < READER_FEATURES; k++) {
            float d = learnt->features[k] - sample->features[k];
            distance += d * d;
        }
        if (distance < best) {
            best = distance;
            class = learnt->class;
        }
    }
    return class;
}

static size_t count_class(const struct lip_reader *r, int half, const void *class) {
    size_t count = 0;
    for (size_t i = 0; i < r->count[half]; i++)
        count += r->samples[half][i].class == class;
    return count;
}

static const void *most_frequent(const struct lip_reader *r) {
    const void *class = NULL;
    size_t most = 0;
    for (size_t i = 0; i < r->count[READER_LEARN]; i++) {
        size_t count = count_class(r, READER_LEARN, r->samples[READER_LEARN][i].class);
        if (count > most) {
            most = count;
            class = r->samples[READER_LEARN][i].class;
        }
    }
    return class;
}

struct lip_reader_result reader_run(struct lip_reader *r) {
    struct lip_reader_result result = {0};
    if (!r->count[READER_LEARN])
        return result;
    scale(r);
    result.read = r->count[READER_READ];
    for (size_t i = 0; i < r->count[READER_READ]; i++)
        result.right += nearest(r, &r->samples[READER_READ][i]) == r->samples[READER_READ][i].class;
    result.usual = count_class(r, READER_READ, most_frequent(r));
    return result;
}

void lip_reader_free(struct lip_reader *r) {
    for (int half = 0; half < READER_HALVES; half++)
        free(r->samples[half]);
    *r = (struct lip_reader){0};
}
