/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The simplest baseline: a table with one target for each phone and parameter, reached in the phone's middle,
 * and half a cosine from one to the next. No context, no dominance, no look-ahead: what a better engine adds
 * has to be seen beside this. The targets are those of the pack, each the mean over the phone's contexts. */
#include "server/base/mem.h"
#include "server/face/engines/engine.h"
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <stdlib.h>

struct table_key {
    double at; /* s */
    double mm[PARAM_COUNT];
};

struct table {
    struct speech_fapu fapu;
    struct table_key *keys; /* at rises strictly; the first and the last are at rest */
    size_t count, cap;
};

static void add_key(struct table *table, double at, const double mm[PARAM_COUNT]) {
    if (table->count && at <= table->keys[table->count - 1].at)
        return;
    table->keys = mem_grow(table->keys, &table->cap, table->count + 1, sizeof *table->keys);
    struct table_key *key = &table->keys[table->count++];
    key->at = at;
    for (int p = 0; p < PARAM_COUNT; p++)
        key->mm[p] = mm[p];
}

static void phone_targets(const struct speech_pack *pack, const struct phone_segment *item,
                          double mm[PARAM_COUNT]) {
    const struct speech_phone *phone = item->phone;
    size_t contexts = phone->group->vowel ? pack->vowel_context_count : pack->consonant_context_count;
    for (size_t p = 0; p < PARAM_COUNT; p++) {
        mm[p] = 0;
        for (size_t c = 0; c < contexts; c++) {
            double plain = phone->plain[c * PARAM_COUNT + p].T,
                   stressed = phone->stressed[c * PARAM_COUNT + p].T;
            mm[p] += (plain + item->stress * (stressed - plain)) / (double)contexts;
        }
    }
}

static void table_add(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]) {
    const struct table *table = self;
    (void)cursor;
    size_t low = 0, high = table->count - 1; /* the last key at or before t lies from low to before high */
    while (low + 1 < high) {
        size_t middle = (low + high) / 2;
        if (table->keys[middle].at <= t)
            low = middle;
        else
            high = middle;
    }
    const struct table_key *from = &table->keys[low], *to = &table->keys[high];
    double part = to == from ? 0 : fmin(fmax((t - from->at) / (to->at - from->at), 0), 1);
    double weight = (1 - cos(M_PI * part)) / 2, mm[PARAM_COUNT];
    for (int p = 0; p < PARAM_COUNT; p++)
        mm[p] = from->mm[p] + weight * (to->mm[p] - from->mm[p]);
    fapmap_add(&table->fapu, mm, faps);
}

static void table_free(void *self) {
    struct table *table = self;
    free(table->keys);
    free(table);
}

static struct speech_layer layer(const struct speech_pack *pack, const struct sentence_audio *u,
                                 struct phone_segments *g) {
    (void)u;
    struct table *table = mem_alloc(sizeof *table);
    double rest[PARAM_COUNT];
    table->fapu = pack->fapu;
    for (int p = 0; p < PARAM_COUNT; p++)
        rest[p] = pack->rest.coefficients[p].T;
    add_key(table, 0, rest);
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        double mm[PARAM_COUNT], length = item->end - item->start;
        if (item->phone) {
            phone_targets(pack, item, mm);
            add_key(table, (item->start + item->end) / 2, mm);
        } else if (length >
                   pack->rest.reach + pack->rest.leave) { /* it does not wait half the pause to close */
            add_key(table, item->start + pack->rest.reach, rest);
            add_key(table, item->end - pack->rest.leave, rest);
        } else {
            add_key(table, (item->start + item->end) / 2, rest);
        }
    }
    add_key(table, g->end, rest);
    return (struct speech_layer){table_add, table_free, table};
}

static bool speaks(const struct speech_pack *pack) {
    return pack != NULL;
}

const struct face_engine engine_table = {"table", false, speaks, layer};
