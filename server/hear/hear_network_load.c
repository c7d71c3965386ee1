/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/hear/hear_network_internal.h"
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAGIC_BYTES = 8, FIXED = 7, NUMBER_BYTES = 4, TAPS_MOST = 32, SIZE_MOST = 1024 };

static const char magic[MAGIC_BYTES + 1] = "FACHEAR2";

static unsigned number_at(const uint8_t *at) {
    return at[0] | (unsigned)at[1] << 8 | (unsigned)at[2] << 16 | (unsigned)at[3] << 24;
}

/* Half precision (IEEE 754 binary16), little endian. */
static float half_at(const uint8_t *at) {
    unsigned bits = at[0] | (unsigned)at[1] << 8, exponent = bits >> 10 & 31;
    float fraction = (float)(bits & 1023);
    float size = exponent == 31 ? NAN
                 : exponent     ? ldexpf(1024 + fraction, (int)exponent - 25)
                                : ldexpf(fraction, -24);
    return bits >> 15 ? -size : size;
}

static struct hear_affine take(const float **at, size_t inputs, size_t outputs) {
    struct hear_affine a = {inputs, outputs, *at, *at + inputs * outputs};
    *at += (inputs + 1) * outputs;
    return a;
}

/* A recurrent layer's weights stand before its biases, those for the input before those for the memory. */
static void take_layer(struct hear_network *n, int layer, size_t inputs, const float **at) {
    size_t gates = 3 * n->size;
    n->input[layer] = (struct hear_affine){inputs, gates, *at, *at + gates * (inputs + n->size)};
    n->hidden[layer] =
        (struct hear_affine){n->size, gates, *at + gates * inputs, n->input[layer].bias + gates};
    *at += gates * (inputs + n->size + 2);
}

/* How many weights there have to be; 0: the numbers are wrong. */
static size_t read_sizes(struct hear_network *n, const uint8_t *data, size_t size) {
    unsigned numbers[FIXED];
    if (size < MAGIC_BYTES + FIXED * NUMBER_BYTES || memcmp(data, magic, MAGIC_BYTES) != 0)
        return 0;
    for (size_t i = 0; i < FIXED; i++)
        numbers[i] = number_at(data + MAGIC_BYTES + i * NUMBER_BYTES);
    n->taps = numbers[1];
    n->middle = numbers[2];
    n->size = numbers[3];
    n->head_count = numbers[6];
    if (numbers[0] != HEAR_FEATURES || !n->taps || n->taps > TAPS_MOST || !n->middle ||
        n->middle > SIZE_MOST || !n->size || n->size > SIZE_MOST || numbers[4] != HEAR_CLASSES ||
        numbers[5] != PARAM_COUNT || !n->head_count || n->head_count > HEAR_HEADS_MOST ||
        size < MAGIC_BYTES + (FIXED + n->head_count) * NUMBER_BYTES)
        return 0;
    for (size_t i = 0; i < n->head_count; i++) {
        n->delays[i] = number_at(data + MAGIC_BYTES + (FIXED + i) * NUMBER_BYTES);
        if (n->delays[i] > 100 || (i && n->delays[i] <= n->delays[i - 1]))
            return 0;
    }
    size_t gates = 3 * n->size;
    return (n->taps * HEAR_FEATURES + 1) * n->middle + gates * (n->middle + n->size + 2) +
           gates * (2 * n->size + 2) + n->head_count * (n->size + 1) * (HEAR_CLASSES + PARAM_COUNT);
}

static int read_all(struct hear_network *n, const uint8_t *data, size_t size, struct error *e) {
    size_t count = read_sizes(n, data, size);
    if (!count)
        return error_plain(e, ERROR_BAD_NETWORK);
    size_t head = MAGIC_BYTES + (FIXED + n->head_count) * NUMBER_BYTES;
    if (size - head != 2 * count)
        return error_set(e, ERROR_BAD_NETWORK, "it should hold %zu weights, and holds %zu", count,
                         (size - head) / 2);
    n->values = mem_alloc(count * sizeof *n->values);
    for (size_t i = 0; i < count; i++) {
        n->values[i] = half_at(data + head + 2 * i);
        if (!isfinite(n->values[i]))
            return error_set(e, ERROR_BAD_NETWORK, "weight %zu is no number", i);
    }
    const float *at = n->values;
    n->conv = take(&at, n->taps * HEAR_FEATURES, n->middle);
    take_layer(n, 0, n->middle, &at);
    take_layer(n, 1, n->size, &at);
    for (size_t i = 0; i < n->head_count; i++) {
        n->heads[i] = take(&at, n->size, HEAR_CLASSES);
        n->mouths[i] = take(&at, n->size, PARAM_COUNT);
    }
    return 0;
}

struct hear_network *hear_network_load(const char *path, struct error *e) {
    enum { MOST = 16 << 20 };
    FILE *file = fopen(path, "rb");
    if (!file) {
        error_set(e, ERROR_BAD_NETWORK, "%.180s: %s", path, strerror(errno));
        return NULL;
    }
    struct hear_network *n = mem_alloc(sizeof *n);
    uint8_t *data = mem_alloc(MOST);
    size_t size = fread(data, 1, MOST, file);
    int status = read_all(n, data, size, e);
    fclose(file);
    free(data);
    if (!status)
        return n;
    hear_network_free(n);
    return NULL;
}

void hear_network_free(struct hear_network *n) {
    if (n)
        free(n->values);
    free(n);
}

size_t hear_network_delays(const struct hear_network *n, unsigned delays[HEAR_HEADS_MOST]) {
    memcpy(delays, n->delays, sizeof n->delays);
    return n->head_count;
}
