/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/fit.h"
#include <math.h>
#include <string.h>

/* More digits than any fit can know. */
static json_t *number(double value) {
    return json_real(round(value * 1e4) / 1e4);
}

static json_t *coefficients(const struct coefficients *c) {
    return json_pack("{so so so so so so so so so so so so}", "t", number(c->t), "T", number(c->T), "alpha",
                     number(c->alpha), "k", number(c->k), "theta_bw", number(c->theta_bw), "theta_fw",
                     number(c->theta_fw), "c_bw", number(c->c_bw), "c_fw", number(c->c_fw), "p_bw",
                     number(c->p_bw), "p_fw", number(c->p_fw), "beta_bw", number(c->beta_bw), "beta_fw",
                     number(c->beta_fw));
}

/* The member of that name, made as an empty object when it is not there. */
static json_t *member(json_t *object, const char *name) {
    json_t *found = json_object_get(object, name);
    if (!found) {
        found = json_object();
        json_object_set_new(object, name, found);
    }
    return found;
}

static bool is_changed(const struct coefficients *a, const struct coefficients *b) {
    return memcmp(a, b, sizeof *a) != 0;
}

static void add_entry(json_t *phones, const struct speech_pack *pack, const struct fit *fit,
                      const struct fit_entry *entry) {
    const struct speech_phone *phone = entry->phone;
    char *const *contexts = phone->group->vowel ? pack->vowel_contexts : pack->consonant_contexts;
    bool changed = false;
    for (size_t p = 0; p < PARAM_COUNT; p++)
        changed |= fit->fitted[p] && !fit->kept[p];
    if (!changed)
        return;
    json_t *own = member(phones, phone->ipa);
    json_object_set_new(own, "sampa", json_string(phone->sampa));
    json_object_set_new(own, "like",
                        json_string(phone->ipa)); /* the inherited one: group, contact and the rest */
    json_t *targets = member(own, "targets");
    for (size_t p = 0; p < PARAM_COUNT; p++) {
        size_t at = entry->context * PARAM_COUNT + p;
        if (!fit->fitted[p] || fit->kept[p])
            continue;
        json_object_set_new(member(targets, speech_params[p]), contexts[entry->context],
                            coefficients(&phone->plain[at]));
        if (phone->group->vowel && is_changed(&phone->plain[at], &phone->stressed[at]))
            json_object_set_new(member(member(own, "stressed"), speech_params[p]), contexts[entry->context],
                                coefficients(&phone->stressed[at]));
    }
}

static json_t *texts(char *const *list) {
    json_t *array = json_array();
    for (; *list; list++)
        json_array_append_new(array, json_string(*list));
    return array;
}

json_t *fit_pack(const struct speech_pack *pack, const struct fit *fit, const struct fit_names *names) {
    json_t *phones = json_object();
    for (size_t i = 0; i < fit->entry_count; i++)
        add_entry(phones, pack, fit, &fit->entries[i]);
    for (size_t i = 0; i < fit->other_count; i++)
        add_entry(phones, pack, fit, &fit->others[i]);
    return json_pack("{ss ss ss s[s] so so so}", "tag", names->tag, "name", names->name, "inherits",
                     names->inherits, "sources", names->source, "voices", texts(pack->voices),
                     "abbreviations", texts(pack->abbreviations), "phones", phones);
}
