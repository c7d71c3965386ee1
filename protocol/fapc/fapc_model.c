/* SPDX-License-Identifier: MIT */
#include "protocol/fapc/fapc_model.h"
#include <string.h>

enum {
    LONG_BITS = 30,
    INPUT_MAX = 1 << 20,
    SEEN = 6,    /* how much the probabilities of the table count for */
    ACTIVE = 16, /* where the activity begins */
    UNIT = 4096, /* of the weights */
};

int32_t fapc_step(int n, int quality) {
    int32_t step = (int32_t)fap_table[n].quant_step * quality * fapc_habits[n].eighths >> 3;
    return step > 1 ? step : 1;
}

static void begin_with(struct range_context *contexts, const uint16_t *zeros, size_t count) {
    for (size_t i = 0; i < count; i++)
        contexts[i] = (struct range_context){zeros[i], SEEN};
}

void fapc_reset(struct fapc_state *s, int quality) {
    uint8_t sequence = s->sequence;
    *s = (struct fapc_state){.sequence = sequence, .quality = (uint8_t)quality};
    for (int i = 0; i < FAPC_CTX_COUNT; i++)
        s->contexts[i].zero = 32768;
    for (int n = 3; n <= FAP_COUNT; n++) {
        int group = fapc_habits[n].group;
        begin_with(s->contexts + n * FAPC_ZEROS, fapc_prior_zero[group], FAPC_ZEROS);
        begin_with(s->contexts + FAPC_CTX_SIGN + n * FAPC_SIGNS, fapc_prior_sign[group], FAPC_SIGNS);
        s->activity[n] = ACTIVE;
    }
    for (int group = 0; group < FAPC_GROUPS; group++)
        begin_with(s->contexts + FAPC_CTX_SIZE + group * FAPC_CLASSES * FAPC_UNARY, fapc_prior_size[group],
                   FAPC_CLASSES * FAPC_UNARY);
}

void fapc_next_frame(struct fapc_state *s) {
    memmove(s->value[1], s->value[0], 3 * sizeof s->value[0]);
    memset(s->error, 0, sizeof s->error);
}

static int64_t clamp(int64_t x, int64_t limit) {
    return x < -limit ? -limit : x > limit ? limit : x;
}

static int sign(int32_t x) {
    return (x > 0) - (x < 0);
}

/* Rounded down; b > 0. */
static int64_t divide(int64_t a, int64_t b) {
    return a / b - (a % b < 0);
}

/* Prediction made before a value is coded. */
struct guess {
    int32_t level;
    int zero, sign, size, length; /* contexts */
};

static struct guess guess(const struct fapc_state *s, int n) {
    static const int32_t bounds[FAPC_CLASSES - 1] = {5, 16, 48, 160, 500};
    const struct fapc_habit *habit = &fapc_habits[n];
    const int16_t *weights = s->quality ? habit->weights : habit->exact;
    const int32_t *now = s->value[0], *a = s->value[1], *b = s->value[2], *c = s->value[3];
    int m = habit->models[0], k = habit->models[1], size = 0; /* entry 0 of the values is always 0 */
    const int32_t inputs[FAPC_WEIGHTS] = {a[n] - b[n], b[n] - c[n], now[m] - a[m], now[k] - a[k],
                                          a[n],        a[m],        a[k]};
    int64_t unit = (int64_t)UNIT * fapc_step(n, s->quality), sum = (int64_t)a[n] * UNIT;
    for (int i = 0; i < FAPC_WEIGHTS; i++)
        sum += weights[i] * clamp(inputs[i], INPUT_MAX);
    int64_t level = divide(2 * sum + unit, 2 * unit), rest = sum - level * unit; /* half a unit at most */
    int64_t off = 6 * (rest < 0 ? -rest : rest) / unit;
    while (size < FAPC_CLASSES - 1 && s->activity[n] >= bounds[size])
        size++;
    int way = sign(s->error[m]);
    return (struct guess){
        (int32_t)level,
        n * FAPC_ZEROS + (size < 3 ? size : 3) * 6 + (way ? 3 : 0) + (off < 2 ? (int)off : 2),
        FAPC_CTX_SIGN + n * FAPC_SIGNS + (way + 1) * 5 + (int)clamp(divide(10 * rest + unit, 2 * unit), 2) +
            2,
        FAPC_CTX_SIZE + (habit->group * FAPC_CLASSES + size) * FAPC_UNARY,
        FAPC_CTX_LONG + habit->group * FAPC_LONG,
    };
}

/* After the level is known: the state goes on to it. */
static void follow(struct fapc_state *s, int n, int32_t level, int32_t error) {
    int32_t size = error < 0 ? -error : error;
    s->value[0][n] = level * fapc_step(n, s->quality);
    s->error[n] = error;
    s->activity[n] = (s->activity[n] * 5 >> 3) + 16 * (size < 255 ? size : 255);
}

/* To the nearest step, halves away from 0. */
static int32_t quantise(int32_t value, int32_t step) {
    int32_t v = (int32_t)clamp(value, FAPC_VALUE_MAX);
    return v < 0 ? -((-v + step / 2) / step) : (v + step / 2) / step;
}

static void put_long(struct fapc_state *s, struct range_encoder *e, int at, uint32_t x) {
    int bits = 0;
    while (x >> bits > 1)
        bits++;
    for (int b = 0; b < bits; b++)
        range_put(e, &s->contexts[at + b], 1);
    range_put(e, &s->contexts[at + bits], 0);
    while (bits-- > 0)
        range_put_even(e, (int)(x >> bits & 1));
}

void fapc_put_value(struct fapc_state *s, struct range_encoder *e, int n, int32_t value) {
    struct guess g = guess(s, n);
    int32_t level = quantise(value, fapc_step(n, s->quality)), error = level - g.level;
    range_put(e, &s->contexts[g.zero], error != 0);
    if (error) {
        uint32_t rest = (uint32_t)(error < 0 ? -error : error) - 1;
        range_put(e, &s->contexts[g.sign], error < 0);
        for (uint32_t i = 0; i < FAPC_UNARY && i <= rest; i++)
            range_put(e, &s->contexts[g.size + (int)i], i < rest);
        if (rest >= FAPC_UNARY)
            put_long(s, e, g.length, rest - FAPC_UNARY + 1);
    }
    follow(s, n, level, error);
}

/* Returns 0 if the number has no end. */
static uint32_t get_long(struct fapc_state *s, struct range_decoder *d, int at) {
    int bits = 0;
    uint32_t x = 1;
    while (range_get(d, &s->contexts[at + bits]))
        if (++bits > LONG_BITS)
            return 0;
    for (int b = 0; b < bits; b++)
        x = x << 1 | (uint32_t)range_get_even(d);
    return x;
}

bool fapc_get_value(struct fapc_state *s, struct range_decoder *d, int n) {
    struct guess g = guess(s, n);
    int64_t error = 0;
    if (range_get(d, &s->contexts[g.zero])) {
        int negative = range_get(d, &s->contexts[g.sign]);
        error = 1;
        while (error <= FAPC_UNARY && range_get(d, &s->contexts[g.size + (int)error - 1]))
            error++;
        if (error > FAPC_UNARY) {
            uint32_t x = get_long(s, d, g.length);
            if (!x)
                return false;
            error = FAPC_UNARY + (int64_t)x;
        }
        error = negative ? -error : error;
    }
    int64_t level = g.level + error, limit = FAPC_VALUE_MAX / fapc_step(n, s->quality) + 1;
    if (level < -limit || level > limit)
        return false;
    follow(s, n, (int32_t)level, (int32_t)error);
    return true;
}
