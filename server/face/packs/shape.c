/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/shape.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
#include "server/face/packs/speech_pack_read.h"
#include <stdlib.h>
#include <string.h>

static const struct speech_phone *read_phone(const struct json_place *at, const struct speech_pack *pack) {
    const char *name;
    if (json_place_text(at, &name))
        return NULL;
    const struct speech_phone *phone = speech_pack_phone(pack, name, strlen(name));
    if (!phone)
        json_place_fail(at, "there is no phone \"%s\"", name);
    else if (!phone->group)
        json_place_fail(at, "\"%s\" is made of parts", name);
    return phone && phone->group ? phone : NULL;
}

/* Which contexts count, as a set of bits. */
static int read_beside(const struct json_place *at, char *const *contexts, size_t count, unsigned *set) {
    *set = (1u << count) - 1;
    if (!at->json)
        return 0;
    if (json_place_array(at))
        return -1;
    *set = 0;
    for (size_t i = 0; i < json_array_size(at->json); i++) {
        struct json_place item = json_place_item(at, i);
        size_t context;
        if (json_place_choice(&item, (const char *const *)contexts, &context))
            return -1;
        *set |= 1u << context;
    }
    return *set ? 0 : json_place_fail(at, "must name a context");
}

static void mean_targets(const struct speech_phone *phone, unsigned set, double stress,
                         double mm[PARAM_COUNT]) {
    size_t counted = 0;
    for (size_t context = 0; context < SPEECH_MAX_CONTEXTS; context++) {
        if (!(set >> context & 1))
            continue;
        counted++;
        for (size_t p = 0; p < PARAM_COUNT; p++) {
            size_t i = context * PARAM_COUNT + p;
            mm[p] += phone->plain[i].T + stress * (phone->stressed[i].T - phone->plain[i].T);
        }
    }
    for (size_t p = 0; p < PARAM_COUNT; p++)
        mm[p] /= (double)counted;
}

static void to_faps(const struct speech_pack *pack, const struct speech_phone *phone,
                    const double mm[PARAM_COUNT], double faps[FAP_COUNT + 1]) {
    struct contact_demand demand[CONTACT_TEETH + 1] = {0};
    demand[phone->contact.kind] = (struct contact_demand){&phone->contact, 1};
    fapmap_add(&pack->fapu, mm, faps);
    fapmap_touch(&pack->fapu, demand, faps);
    fapmap_part_lips(&pack->fapu, faps);
}

static unsigned all_contexts(const struct speech_pack *pack, const struct speech_phone *phone) {
    size_t count = speech_phone_is_vowel(phone) ? pack->vowel_context_count : pack->consonant_context_count;
    return (1u << count) - 1;
}

void shape_of_phone(const struct speech_pack *pack, const struct speech_phone *phone,
                    double faps[FAP_COUNT + 1]) {
    double mm[PARAM_COUNT] = {0};
    mean_targets(phone, all_contexts(pack, phone), 0, mm);
    to_faps(pack, phone, mm, faps);
}

static int read_shape(const struct json_place *at, const struct speech_pack *pack,
                      double faps[FAP_COUNT + 1]) {
    static const char *const keys[] = {"phone", "beside", "stress", "gain", "shift", NULL};
    if (json_place_keys(at, keys))
        return -1;
    if (!json_object_size(at->json))
        return 0;
    struct json_place name = json_place_key(at, "phone"), beside = json_place_key(at, "beside"),
                      stressed = json_place_key(at, "stress");
    const struct speech_phone *phone = read_phone(&name, pack);
    if (!phone)
        return -1;
    bool vowel = speech_phone_is_vowel(phone);
    unsigned set;
    double stress = 0, mm[PARAM_COUNT] = {0};
    struct target_change changes[PARAM_COUNT];
    if (read_beside(&beside, vowel ? pack->vowel_contexts : pack->consonant_contexts,
                    vowel ? pack->vowel_context_count : pack->consonant_context_count, &set) ||
        (stressed.json && json_place_real(&stressed, 0, 1, &stress)) || speech_read_changes(at, changes))
        return -1;
    mean_targets(phone, set, stress, mm);
    for (size_t p = 0; p < PARAM_COUNT; p++)
        mm[p] = changes[p].gain * mm[p] + changes[p].shift;
    to_faps(pack, phone, mm, faps);
    return 0;
}

int shapes_read(const struct json_place *at, const struct speech_pack *pack, struct shapes *out) {
    *out = (struct shapes){0};
    if (json_place_object(at))
        return -1;
    out->items = mem_alloc((json_object_size(at->json) + 1) * sizeof *out->items);
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        struct json_place child = json_place_key(at, key);
        struct shape *shape = &out->items[out->count++];
        shape->name = mem_strdup(key);
        if (read_shape(&child, pack, shape->faps))
            return -1;
    }
    return 0;
}

void shapes_free(struct shapes *shapes) {
    for (size_t i = 0; i < shapes->count; i++)
        free(shapes->items[i].name);
    free(shapes->items);
    *shapes = (struct shapes){0};
}

int shapes_choose(const struct json_place *at, const struct shapes *shapes, size_t *out) {
    const char *name;
    if (json_place_text(at, &name))
        return -1;
    for (*out = 0; *out < shapes->count; ++*out)
        if (!strcmp(shapes->items[*out].name, name))
            return 0;
    return json_place_fail(at, "there is no shape \"%s\"", name);
}
