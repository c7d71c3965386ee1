/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Phones of a pack: targets and coefficients in every context, and contacts. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/face/packs/speech_pack_internal.h"
#include <stdlib.h>
#include <string.h>

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

/* Overwrites the coefficients that the object names; with_target allows t and T. */
static int speech_read_coefficients(const struct json_place *at, bool with_target, struct coefficients *out) {
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

/* Reads {"LI": {"a": {"t": ..., "T": ...}, "any": {...}}, ...} into table[context * PARAM_COUNT + param]
 * and marks in seen (may be NULL) which entries were given. */
static int speech_read_targets(const struct json_place *at, char *const *contexts, struct coefficients *table,
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

static const struct speech_group *speech_find_group(const struct speech_pack *pack, const char *name) {
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

/* Number of contexts of a vowel or a consonant. */
static size_t speech_context_count(const struct speech_pack *pack, bool vowel) {
    return vowel ? pack->vowel_context_count : pack->consonant_context_count;
}

static int speech_read_contact(const struct json_place *at, struct contact_rule *contact) {
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

/* Reads the phone's "coefficients", which replace the table's in every context. */
static int read_own_coefficients(const struct json_place *at, struct speech_phone *phone, size_t count) {
    for (size_t i = 0; i < count && at->json; i += PARAM_COUNT)
        if (speech_read_parameters(at, phone->plain + i) || speech_read_parameters(at, phone->stressed + i))
            return -1;
    return 0;
}

/* Reads the phone's own coefficients, gain, shift and targets. is_like: the tables are already filled. */
static int speech_read_tables(const struct speech_pack *pack, const struct json_place *at,
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

/* Finds the named group and copies its coefficients to the phone's tables of `count` entries. */
static int speech_read_group_of(const struct speech_pack *pack, const struct json_place *at,
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

/* Phones may refer to others of the same file in any order, so each is read on first use. */
struct phone_reader {
    struct speech_pack *pack;
    const struct json_place *at; /* the object "phones" */
    struct speech_phone **read;  /* in file order; NULL until it is read */
    bool *busy;
};

static const struct speech_phone *read_phone(struct phone_reader *r, const char *name);

void speech_phone_free(struct speech_phone *phone) {
    if (!phone)
        return;
    free(phone->ipa);
    free(phone->sampa);
    free(phone->plain);
    free(phone->stressed);
    free(phone->parts);
    free(phone);
}

/* Finds a referenced phone in this file, else in the inherited pack. */
static const struct speech_phone *named(struct phone_reader *r, const struct json_place *at, const char *name,
                                        const char *self) {
    if (strcmp(name, self) != 0 && json_object_get(r->at->json, name))
        return read_phone(r, name);
    const struct speech_phone *phone =
        r->pack->base ? speech_pack_phone(r->pack->base, name, strlen(name)) : NULL;
    if (!phone)
        json_place_fail(at, "there is no phone \"%s\"", name);
    return phone;
}

static void add_scaled(struct coefficients *sum, const struct coefficients *c, double weight) {
    double *a = (double *)sum;
    const double *b = (const double *)c;
    for (size_t i = 0; i < sizeof *sum / sizeof(double); i++)
        a[i] += weight * b[i];
}

static int mix_in(struct speech_phone *phone, const struct json_place *at, const struct speech_phone *model,
                  double weight, size_t count) {
    if (!model->group)
        return json_place_fail(at, "\"%s\" is made of parts", model->ipa);
    if (model->group->vowel != phone->group->vowel)
        return json_place_fail(at, "vowels and consonants do not mix");
    for (size_t i = 0; i < count; i++) {
        add_scaled(&phone->plain[i], &model->plain[i], weight);
        add_scaled(&phone->stressed[i], &model->stressed[i], weight);
    }
    return 0;
}

/* Reads "like": "e" or {"i": 0.6, "e": 0.4}, the weighted mean of other phones. Group and contact are
 * those of the heaviest. */
static int read_like(struct phone_reader *r, const struct json_place *at, struct speech_phone *phone,
                     size_t *count) {
    const struct speech_phone *models[8];
    double weights[8], sum = 0;
    size_t n = 0, heaviest = 0;
    if (json_is_string(at->json)) {
        if (!(models[n++] = named(r, at, json_string_value(at->json), phone->ipa)))
            return -1;
        sum = weights[0] = 1;
    } else {
        if (json_place_object(at))
            return -1;
        const char *key;
        json_t *value;
        json_object_foreach(at->json, key, value) {
            struct json_place child = json_place_key(at, key);
            if (n == sizeof models / sizeof *models)
                return json_place_fail(&child, "is one too many to be mixed");
            if (json_place_real(&child, 0.01, 1, &weights[n]) ||
                !(models[n] = named(r, &child, key, phone->ipa)))
                return -1;
            sum += weights[n];
            if (weights[n] > weights[heaviest])
                heaviest = n;
            n++;
        }
        if (!n)
            return json_place_fail(at, "must name a phone");
    }
    if (!models[heaviest]->group)
        return json_place_fail(at, "\"%s\" is made of parts", models[heaviest]->ipa);
    phone->group = models[heaviest]->group;
    phone->viseme = models[heaviest]->viseme;
    phone->contact = models[heaviest]->contact;
    *count = speech_context_count(r->pack, phone->group->vowel) * PARAM_COUNT;
    phone->plain = mem_alloc(*count * sizeof *phone->plain);
    phone->stressed = mem_alloc(*count * sizeof *phone->stressed);
    for (size_t i = 0; i < n; i++)
        if (mix_in(phone, at, models[i], weights[i] / sum, *count))
            return -1;
    return 0;
}

static int read_parts(struct phone_reader *r, const struct json_place *at, struct speech_phone *phone) {
    static const char *const keys[] = {"phone", "share", NULL};
    if (json_place_array(at))
        return -1;
    size_t n = json_array_size(at->json);
    if (!n || n > 4)
        return json_place_fail(at, "must have 1 to 4 items");
    phone->parts = mem_alloc(n * sizeof *phone->parts);
    for (phone->part_count = 0; phone->part_count < n; phone->part_count++) {
        struct speech_part *part = &phone->parts[phone->part_count];
        struct json_place item = json_place_item(at, phone->part_count),
                          name = json_place_key(&item, "phone"), share = json_place_key(&item, "share");
        const char *text;
        if (json_place_keys(&item, keys) || json_place_text(&name, &text) ||
            json_place_real(&share, 0.01, 1, &part->share) ||
            !(part->phone = named(r, &name, text, phone->ipa)))
            return -1;
        if (part->phone->part_count)
            return json_place_fail(&name, "\"%s\" is itself made of parts", text);
    }
    return 0;
}

static int fill_phone(struct phone_reader *r, const struct json_place *at, struct speech_phone *phone) {
    static const char *const keys[] = {"sampa", "like",   "group",   "viseme",   "contact",
                                       "gain",  "shift",  "targets", "stressed", "coefficients",
                                       "parts", "source", NULL};
    static const char *const part_keys[] = {"sampa", "parts", "source", NULL};
    struct json_place sampa = json_place_key(at, "sampa"), like = json_place_key(at, "like"),
                      group = json_place_key(at, "group"), viseme = json_place_key(at, "viseme"),
                      contact = json_place_key(at, "contact"), parts = json_place_key(at, "parts"),
                      source = json_place_key(at, "source");
    const char *text;
    int number;
    size_t count = 0;
    if (json_place_keys(at, parts.json ? part_keys : keys) || json_place_text(&sampa, &text))
        return -1;
    phone->sampa = mem_strdup(text);
    if (source.json && json_place_text(&source, &text))
        return -1;
    if (parts.json)
        return read_parts(r, &parts, phone);
    if (like.json && read_like(r, &like, phone, &count))
        return -1;
    if ((group.json || !like.json) && speech_read_group_of(r->pack, &group, phone, &count))
        return -1;
    if (viseme.json) {
        if (json_place_whole(&viseme, 0, 14, &number))
            return -1;
        phone->viseme = (uint8_t)number;
    }
    if (contact.json && speech_read_contact(&contact, &phone->contact))
        return -1;
    return speech_read_tables(r->pack, at, phone, count, like.json != NULL);
}

static size_t feature_letter(const struct alphabet *alphabet, const char *ipa) {
    uint32_t code;
    const struct letter *l =
        utf8_next(ipa, strlen(ipa), &code) == strlen(ipa) ? alphabet_find(alphabet, code) : NULL;
    return l ? (size_t)(l - alphabet->letters) + 1 : 0;
}

static const struct speech_phone *read_phone(struct phone_reader *r, const char *name) {
    struct json_place at = json_place_key(r->at, name);
    size_t order = 0;
    for (void *it = json_object_iter(r->at->json); strcmp(json_object_iter_key(it), name) != 0;
         it = json_object_iter_next(r->at->json, it))
        order++;
    if (r->read[order])
        return r->read[order];
    if (r->busy[order]) {
        json_place_fail(&at, "is described by itself");
        return NULL;
    }
    r->busy[order] = true;
    struct speech_phone *phone = mem_alloc(sizeof *phone);
    phone->ipa = mem_strdup(name);
    phone->feature_letter = feature_letter(r->pack->alphabet, name);
    if (fill_phone(r, &at, phone)) {
        speech_phone_free(phone);
        return NULL;
    }
    return r->read[order] = phone;
}

static int by_ipa(const void *a, const void *b) {
    return strcmp((*(struct speech_phone *const *)a)->ipa, (*(struct speech_phone *const *)b)->ipa);
}

int speech_read_phones(struct speech_pack *pack, const struct json_place *at) {
    if (json_place_object(at))
        return -1;
    size_t n = json_object_size(at->json);
    struct phone_reader r = {pack, at, mem_alloc((n + 1) * sizeof(struct speech_phone *)), mem_alloc(n + 1)};
    const char *key;
    json_t *value;
    int result = 0;
    json_object_foreach(at->json, key, value) {
        if (!read_phone(&r, key)) {
            result = -1;
            break;
        }
    }
    pack->phones = r.read;
    for (size_t i = 0; i < n; i++)
        if (r.read[i])
            pack->phones[pack->phone_count++] = r.read[i];
    free(r.busy);
    qsort(pack->phones, pack->phone_count, sizeof *pack->phones, by_ipa);
    for (size_t i = 0; i < pack->phone_count; i++) {
        size_t ipa = strlen(pack->phones[i]->ipa), sampa = strlen(pack->phones[i]->sampa);
        size_t longer = ipa > sampa ? ipa : sampa;
        if (longer > pack->longest)
            pack->longest = longer;
    }
    return result;
}
