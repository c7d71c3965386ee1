/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The network's weights, evaluation and file format. */
#include "server/live/lip_network.h"
#include "server/base/mem.h"
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIP_LAYERS = 2, LIP_VOICE_PARTS = 3 };

/* outputs = bias + weight * inputs; row-major. */
struct lip_affine {
    size_t inputs, outputs;
    const float *weight, *bias; /* within the network's values */
};

struct lip_network {
    size_t taps, middle, size, head_count;
    unsigned delays[LIP_HEADS_MOST];
    struct lip_affine conv, input[LIP_LAYERS], hidden[LIP_LAYERS], heads[LIP_HEADS_MOST],
        mouths[LIP_HEADS_MOST];
    /* Voice detection weights, a row each: the memory, its running mean, and its recent deviation from it.
     * The products are added to voice_bias. */
    const float *voice, *voice_bias;
    float *values;
};

/* Rate of the running means per frame; higher at first. */
#define VOICE_PACE 0.04F

struct lip_state {
    const struct lip_network *network;
    float *frames;             /* the convolution's last inputs, oldest first */
    float *middle;             /* its output */
    float *memory[LIP_LAYERS]; /* of the recurrent layers */
    float *mean, *off;         /* recent mean of the last layer's memory, and the deviation from it */
    float heard;               /* number of frames, saturating */
    float *gates, *recurrent;  /* of the current step: from the input, from the memory */
};

struct lip_state *lip_state_new(const struct lip_network *n) {
    struct lip_state *s = mem_alloc(sizeof *s);
    s->network = n;
    s->frames = mem_alloc(n->taps * LIP_FEATURES * sizeof *s->frames);
    s->middle = mem_alloc(n->middle * sizeof *s->middle);
    for (int i = 0; i < LIP_LAYERS; i++)
        s->memory[i] = mem_alloc(n->size * sizeof **s->memory);
    s->mean = mem_alloc(n->size * sizeof *s->mean);
    s->off = mem_alloc(n->size * sizeof *s->off);
    s->gates = mem_alloc(3 * n->size * sizeof *s->gates);
    s->recurrent = mem_alloc(3 * n->size * sizeof *s->recurrent);
    return s;
}

void lip_state_free(struct lip_state *s) {
    if (!s)
        return;
    free(s->frames);
    free(s->middle);
    for (int i = 0; i < LIP_LAYERS; i++)
        free(s->memory[i]);
    free(s->mean);
    free(s->off);
    free(s->gates);
    free(s->recurrent);
    free(s);
}

/* Sums four products at a time, which compilers vectorise. */
static float product(const float *a, const float *b, size_t count) {
    float sum[4] = {0}, rest = 0;
    size_t i = 0;
    for (; i + 4 <= count; i += 4)
        for (int k = 0; k < 4; k++)
            sum[k] += a[i + (size_t)k] * b[i + (size_t)k];
    for (; i < count; i++)
        rest += a[i] * b[i];
    return sum[0] + sum[1] + (sum[2] + sum[3]) + rest;
}

static void affine(const struct lip_affine *a, const float *in, float *out) {
    for (size_t i = 0; i < a->outputs; i++)
        out[i] = a->bias[i] + product(a->weight + i * a->inputs, in, a->inputs);
}

static float sigmoid(float x) {
    return 1 / (1 + expf(-x));
}

/* Gate order: reset, update, new. */
static void recur(struct lip_state *s, int layer, const float *in) {
    size_t size = s->network->size;
    float *h = s->memory[layer];
    affine(&s->network->input[layer], in, s->gates);
    affine(&s->network->hidden[layer], h, s->recurrent);
    for (size_t i = 0; i < size; i++) {
        float reset = sigmoid(s->gates[i] + s->recurrent[i]);
        float update = sigmoid(s->gates[size + i] + s->recurrent[size + i]);
        float fresh = tanhf(s->gates[2 * size + i] + reset * s->recurrent[2 * size + i]);
        h[i] = (1 - update) * fresh + update * h[i];
    }
}

static void softmax(float x[LIP_CLASSES]) {
    float most = x[0], sum = 0;
    for (int i = 1; i < LIP_CLASSES; i++)
        most = fmaxf(most, x[i]);
    for (int i = 0; i < LIP_CLASSES; i++)
        sum += x[i] = expf(x[i] - most);
    for (int i = 0; i < LIP_CLASSES; i++)
        x[i] /= sum;
}

static float voice(struct lip_state *s) {
    const struct lip_network *n = s->network;
    const float *h = s->memory[LIP_LAYERS - 1];
    float pace = fmaxf(VOICE_PACE, 1 / ++s->heard);
    for (size_t i = 0; i < n->size; i++) {
        s->mean[i] += pace * (h[i] - s->mean[i]);
        s->off[i] += pace * (fabsf(h[i] - s->mean[i]) - s->off[i]);
    }
    return *n->voice_bias + product(n->voice, h, n->size) + product(n->voice + n->size, s->mean, n->size) +
           product(n->voice + 2 * n->size, s->off, n->size);
}

void lip_state_step(struct lip_state *s, const float frame[LIP_FEATURES], size_t head,
                    struct lip_answer *answer) {
    const struct lip_network *n = s->network;
    size_t before = (n->taps - 1) * LIP_FEATURES;
    memmove(s->frames, s->frames + LIP_FEATURES, before * sizeof *s->frames);
    memcpy(s->frames + before, frame, LIP_FEATURES * sizeof *frame);
    affine(&n->conv, s->frames, s->middle);
    for (size_t i = 0; i < n->middle; i++)
        s->middle[i] = fmaxf(0, s->middle[i]);
    recur(s, 0, s->middle);
    recur(s, 1, s->memory[0]);
    affine(&n->heads[head], s->memory[1], answer->likely);
    softmax(answer->likely);
    affine(&n->mouths[head], s->memory[1], answer->mouth);
    answer->voice = voice(s);
}

enum {
    MAGIC_BYTES = 8,
    FIXED = 7,
    NUMBER_BYTES = 4,
    SINGLE_BYTES = 4,
    HALF_BYTES = 2,
    TAPS_MOST = 32,
    SIZE_MOST = 1024
};

static const char magic[MAGIC_BYTES + 1] = "FACHEAR3";

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

static float single_at(const uint8_t *at) {
    uint32_t bits = number_at(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Iterates over the file's weights; with `to` NULL it only counts them. */
struct walk {
    const uint8_t *at;
    float *to;
    size_t bytes, values;
};

/* Per row: the scale, then integers from -127 to 127. */
static void walk_matrix(struct walk *w, size_t inputs, size_t outputs) {
    for (size_t row = 0; w->to && row < outputs; row++) {
        const uint8_t *at = w->at + w->bytes + row * (SINGLE_BYTES + inputs);
        float one = single_at(at);
        for (size_t i = 0; i < inputs; i++)
            w->to[w->values + row * inputs + i] = one * (float)(int8_t)at[SINGLE_BYTES + i];
    }
    w->bytes += outputs * (SINGLE_BYTES + inputs);
    w->values += outputs * inputs;
}

static void walk_biases(struct walk *w, size_t outputs) {
    for (size_t i = 0; w->to && i < outputs; i++)
        w->to[w->values + i] = half_at(w->at + w->bytes + HALF_BYTES * i);
    w->bytes += HALF_BYTES * outputs;
    w->values += outputs;
}

static void walk_affine(struct walk *w, size_t inputs, size_t outputs) {
    walk_matrix(w, inputs, outputs);
    walk_biases(w, outputs);
}

static void walk_all(const struct lip_network *n, struct walk *w) {
    size_t gates = 3 * n->size;
    walk_affine(w, n->taps * LIP_FEATURES, n->middle);
    for (int layer = 0; layer < LIP_LAYERS; layer++) {
        walk_matrix(w, layer ? n->size : n->middle, gates);
        walk_matrix(w, n->size, gates);
        walk_biases(w, gates);
        walk_biases(w, gates);
    }
    for (size_t i = 0; i < n->head_count; i++) {
        walk_affine(w, n->size, LIP_CLASSES);
        walk_affine(w, n->size, PARAM_COUNT);
    }
    walk_matrix(w, n->size, LIP_VOICE_PARTS);
    walk_biases(w, 1);
}

static struct lip_affine take(const float **at, size_t inputs, size_t outputs) {
    struct lip_affine a = {inputs, outputs, *at, *at + inputs * outputs};
    *at += (inputs + 1) * outputs;
    return a;
}

/* A recurrent layer has weights before biases, and those for the input before those for the memory. */
static void take_layer(struct lip_network *n, int layer, size_t inputs, const float **at) {
    size_t gates = 3 * n->size;
    n->input[layer] = (struct lip_affine){inputs, gates, *at, *at + gates * (inputs + n->size)};
    n->hidden[layer] =
        (struct lip_affine){n->size, gates, *at + gates * inputs, n->input[layer].bias + gates};
    *at += gates * (inputs + n->size + 2);
}

/* Validates the sizes. */
static bool read_sizes(struct lip_network *n, const uint8_t *data, size_t size) {
    unsigned numbers[FIXED];
    if (size < MAGIC_BYTES + FIXED * NUMBER_BYTES || memcmp(data, magic, MAGIC_BYTES) != 0)
        return false;
    for (size_t i = 0; i < FIXED; i++)
        numbers[i] = number_at(data + MAGIC_BYTES + i * NUMBER_BYTES);
    n->taps = numbers[1];
    n->middle = numbers[2];
    n->size = numbers[3];
    n->head_count = numbers[6];
    if (numbers[0] != LIP_FEATURES || !n->taps || n->taps > TAPS_MOST || !n->middle ||
        n->middle > SIZE_MOST || !n->size || n->size > SIZE_MOST || numbers[4] != LIP_CLASSES ||
        numbers[5] != PARAM_COUNT || !n->head_count || n->head_count > LIP_HEADS_MOST ||
        size < MAGIC_BYTES + (FIXED + n->head_count) * NUMBER_BYTES)
        return false;
    for (size_t i = 0; i < n->head_count; i++) {
        n->delays[i] = number_at(data + MAGIC_BYTES + (FIXED + i) * NUMBER_BYTES);
        if (n->delays[i] > 100 || (i && n->delays[i] <= n->delays[i - 1]))
            return false;
    }
    return true;
}

static int read_all(struct lip_network *n, const uint8_t *data, size_t size, struct error *e) {
    struct walk all = {0};
    if (!read_sizes(n, data, size))
        return error_plain(e, ERROR_BAD_NETWORK);
    size_t head = MAGIC_BYTES + (FIXED + n->head_count) * NUMBER_BYTES;
    walk_all(n, &all);
    if (size - head != all.bytes)
        return error_set(e, ERROR_BAD_NETWORK, "its weights must have %zu bytes, not %zu", all.bytes,
                         size - head);
    n->values = mem_alloc(all.values * sizeof *n->values);
    struct walk reading = {.at = data + head, .to = n->values};
    walk_all(n, &reading);
    for (size_t i = 0; i < all.values; i++)
        if (!isfinite(n->values[i]))
            return error_set(e, ERROR_BAD_NETWORK, "weight %zu is not a number", i);
    const float *at = n->values;
    n->conv = take(&at, n->taps * LIP_FEATURES, n->middle);
    take_layer(n, 0, n->middle, &at);
    take_layer(n, 1, n->size, &at);
    for (size_t i = 0; i < n->head_count; i++) {
        n->heads[i] = take(&at, n->size, LIP_CLASSES);
        n->mouths[i] = take(&at, n->size, PARAM_COUNT);
    }
    n->voice = at;
    n->voice_bias = at + LIP_VOICE_PARTS * n->size;
    return 0;
}

struct lip_network *lip_network_load(const char *path, struct error *e) {
    enum { MOST = 16 << 20 };
    FILE *file = fopen(path, "rb");
    if (!file) {
        error_set(e, ERROR_BAD_NETWORK, "%.180s: %s", path, strerror(errno));
        return NULL;
    }
    struct lip_network *n = mem_alloc(sizeof *n);
    uint8_t *data = mem_alloc(MOST);
    size_t size = fread(data, 1, MOST, file);
    int status = read_all(n, data, size, e);
    fclose(file);
    free(data);
    if (!status)
        return n;
    lip_network_free(n);
    return NULL;
}

void lip_network_free(struct lip_network *n) {
    if (n)
        free(n->values);
    free(n);
}

size_t lip_network_delays(const struct lip_network *n, unsigned delays[LIP_HEADS_MOST]) {
    memcpy(delays, n->delays, sizeof n->delays);
    return n->head_count;
}
