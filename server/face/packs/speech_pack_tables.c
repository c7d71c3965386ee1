/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of a phone: targets and coefficients in every context, and what has to touch. */
#include "server/base/mem.h"
#include "server/face/packs/speech_pack_read.h"

size_t speech_context_count(const struct speech_pack *pack, bool vowel) {
    return vowel ? pack->vowel_context_count : pack->consonant_context_count;
}

int speech_read_contact(const struct json_place *at, struct contact_rule *contact) {
    static const char *const kinds[] = {"none", "lips", "teeth", NULL};
    static const char *const keys[3][6] = {{"kind", NULL},
                                           {"kind", "onset", "release", "press", NULL},
                                           {"kind", "onset", "release", "reach", "retract", NULL}};
    struct json_place kind = json_place_key(at, "kind"), onset = json_place_key(at, "onset"),
                      release = json_place_key(at, "release"), press = json_place_key(at, "press"),
                      reach = json_place_key(at, "reach"), retract = json_place_key(at, "retract");
    size_t k;
    if (json_place_object(at) || json_place_choice(&kind, kinds, &k) || json_place_keys(at, keys[k]))
        return -1;
    *contact = (struct contact_rule){.kind = (enum contact_kind)k};
    if (k == CONTACT_NONE)
        return 0;
    if (json_place_real(&onset, 0, 0.1, &contact->onset) ||
        json_place_real(&release, 0, 0.1, &contact->release))
        return -1;
    if (k == CONTACT_LIPS)
        return json_place_real(&press, 0.02, 1, &contact->press);
    return json_place_real(&reach, 0, 5, &contact->reach) ||
                   json_place_real(&retract, 0, 5, &contact->retract)
               ? -1
               : 0;
}

int speech_read_changes(const struct json_place *at, struct target_change out[PARAM_COUNT]) {
    for (size_t p = 0; p < PARAM_COUNT; p++)
        out[p] = (struct target_change){1, 0};
    for (int is_gain = 0; is_gain < 2; is_gain++) {
        struct json_place change = json_place_key(at, is_gain ? "gain" : "shift");
        if (change.json && json_place_keys(&change, speech_params))
            return -1;
        for (size_t p = 0; change.json && p < PARAM_COUNT; p++) {
            struct json_place child = json_place_key(&change, speech_params[p]);
            if (child.json && json_place_real(&child, -20, 20, is_gain ? &out[p].gain : &out[p].shift))
                return -1;
        }
    }
    return 0;
}

static int change_targets(const struct json_place *at, struct speech_phone *phone, size_t count) {
    struct target_change changes[PARAM_COUNT];
    if (speech_read_changes(at, changes))
        return -1;
    for (size_t i = 0; i < count; i++) {
        const struct target_change *change = &changes[i % PARAM_COUNT];
        phone->plain[i].T = change->gain * phone->plain[i].T + change->shift;
        phone->stressed[i].T = change->gain * phone->stressed[i].T + change->shift;
    }
    return 0;
}

static void apply_parameters(struct coefficients *table, size_t count,
                             const struct coefficients own[PARAM_COUNT]) {
    for (size_t i = 0; i < count; i++) {
        struct coefficients c = own[i % PARAM_COUNT];
        c.t = table[i].t;
        c.T = table[i].T;
        table[i] = c;
    }
}

/* "coefficients" of the phone: those it names replace the table's, in every context. */
static int read_own_coefficients(const struct json_place *at, struct speech_phone *phone, size_t count) {
    for (size_t i = 0; i < count && at->json; i += PARAM_COUNT)
        if (speech_read_parameters(at, phone->plain + i) || speech_read_parameters(at, phone->stressed + i))
            return -1;
    return 0;
}

int speech_read_tables(const struct speech_pack *pack, const struct json_place *at,
                       struct speech_phone *phone, size_t count, bool is_like) {
    struct json_place targets = json_place_key(at, "targets"), stressed = json_place_key(at, "stressed"),
                      coefficients = json_place_key(at, "coefficients");
    char *const *contexts = phone->group->vowel ? pack->vowel_contexts : pack->consonant_contexts;
    if (read_own_coefficients(&coefficients, phone, count) || change_targets(at, phone, count))
        return -1;
    bool seen[SPEECH_MAX_CONTEXTS * PARAM_COUNT] = {false};
    if (targets.json || !is_like) {
        if (speech_read_targets(&targets, contexts, phone->plain, seen))
            return -1;
        for (size_t i = 0; i < count && !is_like; i++) {
            struct json_place parameter = json_place_key(&targets, speech_params[i % PARAM_COUNT]);
            if (!seen[i])
                return json_place_fail(&parameter, "has no target in the context \"%s\"",
                                       contexts[i / PARAM_COUNT]);
        }
        for (size_t i = 0; i < count; i++)
            if (seen[i])
                phone->stressed[i] = phone->plain[i];
    }
    if (!stressed.json)
        return 0;
    return phone->group->vowel ? speech_read_targets(&stressed, contexts, phone->stressed, NULL)
                               : json_place_fail(&stressed, "is for vowels only");
}

int speech_read_group_of(const struct speech_pack *pack, const struct json_place *at,
                         struct speech_phone *phone, size_t *count) {
    const char *name;
    if (json_place_text(at, &name))
        return -1;
    const struct speech_group *group = speech_find_group(pack, name);
    if (!group)
        return json_place_fail(at, "there is no group \"%s\"", name);
    if (phone->group && phone->group->vowel != group->vowel)
        return json_place_fail(at, "is a group of another kind");
    phone->group = group;
    phone->viseme = group->viseme;
    *count = speech_context_count(pack, group->vowel) * PARAM_COUNT;
    if (!phone->plain) {
        phone->plain = mem_alloc(*count * sizeof *phone->plain);
        phone->stressed = mem_alloc(*count * sizeof *phone->stressed);
    }
    apply_parameters(phone->plain, *count, group->coefficients);
    apply_parameters(phone->stressed, *count, group->coefficients);
    return 0;
}
