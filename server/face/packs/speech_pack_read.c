/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/speech_pack_read.h"
#include "server/base/mem.h"
#include <string.h>

const char *const speech_params[PARAM_COUNT + 1] = {"LI", "LS", "AR", "PI", "PS",
                                                    "EM", "TH", "TA", "TB", NULL};

static const struct {
    const char *name;
    size_t offset;
    double min, max;
} members[] = {
    {"t", offsetof(struct coefficients, t), 0, 1},
    {"T", offsetof(struct coefficients, T), -50, 50},
    {"alpha", offsetof(struct coefficients, alpha), 0, 1},
    {"k", offsetof(struct coefficients, k), 0, 1},
    {"theta_bw", offsetof(struct coefficients, theta_bw), 0, 1e6},
    {"theta_fw", offsetof(struct coefficients, theta_fw), 0, 1e6},
    {"c_bw", offsetof(struct coefficients, c_bw), 0.1, 10},
    {"c_fw", offsetof(struct coefficients, c_fw), 0.1, 10},
    {"p_bw", offsetof(struct coefficients, p_bw), 0.1, 10},
    {"p_fw", offsetof(struct coefficients, p_fw), 0.1, 10},
    {"beta_bw", offsetof(struct coefficients, beta_bw), -10, 10},
    {"beta_fw", offsetof(struct coefficients, beta_fw), -10, 10},
};
enum { MEMBERS = sizeof members / sizeof *members, TARGET_MEMBERS = 2 };

int speech_read_coefficients(const struct json_place *at, bool with_target, struct coefficients *out) {
    const char *allowed[MEMBERS + 1] = {0};
    size_t first = with_target ? 0 : TARGET_MEMBERS;
    for (size_t i = first; i < MEMBERS; i++)
        allowed[i - first] = members[i].name;
    if (json_place_keys(at, allowed))
        return -1;
    for (size_t i = first; i < MEMBERS; i++) {
        struct json_place value = json_place_key(at, members[i].name);
        double *member = (double *)((char *)out + members[i].offset);
        if (value.json && json_place_real(&value, members[i].min, members[i].max, member))
            return -1;
    }
    return 0;
}

int speech_read_parameters(const struct json_place *at, struct coefficients out[PARAM_COUNT]) {
    if (!at->json)
        return 0;
    if (json_place_keys(at, speech_params))
        return -1;
    for (int p = 0; p < PARAM_COUNT; p++) {
        struct json_place child = json_place_key(at, speech_params[p]);
        if (child.json && speech_read_coefficients(&child, false, &out[p]))
            return -1;
    }
    return 0;
}

/* One parameter's contexts. "any" stands for all that are not named. */
static int read_contexts(const struct json_place *at, char *const *contexts, int p,
                         struct coefficients *table, bool *seen) {
    const char *allowed[SPEECH_MAX_CONTEXTS + 2] = {"any"};
    for (size_t i = 0; contexts[i]; i++)
        allowed[i + 1] = contexts[i];
    if (json_place_keys(at, allowed))
        return -1;
    struct json_place any = json_place_key(at, "any");
    for (size_t i = 0; contexts[i]; i++) {
        struct json_place own = json_place_key(at, contexts[i]);
        const struct json_place *from = own.json ? &own : &any;
        if (!from->json)
            continue;
        if (speech_read_coefficients(from, true, &table[i * PARAM_COUNT + p]))
            return -1;
        if (seen)
            seen[i * PARAM_COUNT + p] = true;
    }
    return 0;
}

int speech_read_targets(const struct json_place *at, char *const *contexts, struct coefficients *table,
                        bool *seen) {
    if (json_place_keys(at, speech_params))
        return -1;
    for (int p = 0; p < PARAM_COUNT; p++) {
        struct json_place child = json_place_key(at, speech_params[p]);
        if (child.json && read_contexts(&child, contexts, p, table, seen))
            return -1;
    }
    return 0;
}

const struct speech_group *speech_find_group(const struct speech_pack *pack, const char *name) {
    for (; pack; pack = pack->base)
        for (size_t i = 0; i < pack->group_count; i++)
            if (!strcmp(pack->groups[i].name, name))
                return &pack->groups[i];
    return NULL;
}

static int read_group(const struct speech_pack *pack, const struct json_place *at, struct speech_group *g) {
    static const char *const keys[] = {"kind", "viseme", "context", "coefficients", NULL};
    static const char *const kinds[] = {"consonant", "vowel", NULL};
    struct json_place kind = json_place_key(at, "kind"), viseme = json_place_key(at, "viseme"),
                      context = json_place_key(at, "context"),
                      coefficients = json_place_key(at, "coefficients");
    size_t is_vowel;
    int number;
    if (json_place_keys(at, keys) || json_place_choice(&kind, kinds, &is_vowel) ||
        json_place_whole(&viseme, 0, 14, &number))
        return -1;
    g->vowel = is_vowel;
    g->viseme = (uint8_t)number;
    char *const *contexts = g->vowel ? pack->consonant_contexts : pack->vowel_contexts;
    if (json_place_choice(&context, (const char *const *)contexts, &g->context) ||
        json_place_keys(&coefficients, speech_params))
        return -1;
    for (int p = 0; p < PARAM_COUNT; p++) {
        g->coefficients[p] = (struct coefficients){.t = 0.5, .c_bw = 1, .c_fw = 1, .p_bw = 1, .p_fw = 1};
        struct json_place child = json_place_key(&coefficients, speech_params[p]);
        for (size_t i = TARGET_MEMBERS; i < MEMBERS; i++) {
            struct json_place member = json_place_key(&child, members[i].name);
            if (!member.json)
                return json_place_fail(&member, "is missing");
        }
        if (speech_read_coefficients(&child, false, &g->coefficients[p]))
            return -1;
    }
    return 0;
}

int speech_read_groups(struct speech_pack *pack, const struct json_place *at) {
    if (json_place_object(at))
        return -1;
    pack->groups = mem_alloc((json_object_size(at->json) + 1) * sizeof *pack->groups);
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        struct json_place child = json_place_key(at, key);
        struct speech_group *g = &pack->groups[pack->group_count];
        if (read_group(pack, &child, g))
            return -1;
        g->name = mem_strdup(key);
        pack->group_count++;
    }
    return 0;
}
