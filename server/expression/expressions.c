/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/json_place.h"
#include "server/base/mem.h"
#include "server/expression/expressions_internal.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Minimum time of any movement, s, which limits the step between frames. */
#define SECONDS_MIN 0.08
#define SECONDS_MAX 10

/* Reads an optional number; keeps *out if it is missing. */
static int read_number(const struct json_place *at, const char *key, double min, double max, double *out) {
    struct json_place number = json_place_key(at, key);
    return number.json ? json_place_real(&number, min, max, out) : 0;
}

struct number {
    const char *key;
    double min, max, *out;
};

/* An optional object of optional numbers. The list ends with a NULL key. */
static int read_numbers(const struct json_place *up, const char *key, const struct number *numbers) {
    struct json_place at = json_place_key(up, key);
    const char *allowed[8] = {0};
    if (!at.json)
        return 0;
    for (size_t i = 0; numbers[i].key; i++)
        allowed[i] = numbers[i].key;
    if (json_place_keys(&at, allowed))
        return -1;
    for (; numbers->key; numbers++)
        if (read_number(&at, numbers->key, numbers->min, numbers->max, numbers->out))
            return -1;
    return 0;
}

static int read_pose(const struct json_place *at, struct pose *out) {
    const char *name;
    json_t *value;
    if (!at->json)
        return 0;
    if (json_place_object(at))
        return -1;
    json_object_foreach(at->json, name, value) {
        struct json_place number = json_place_key(at, name);
        int faps[2];
        size_t count = pose_faps_named(name, faps);
        double amount;
        if (!count)
            return json_place_fail(&number, "unknown FAP");
        /* FAPs without negative values may still subtract within a mixture. */
        if (json_place_real(&number, -fap_table[faps[0]].max, fap_table[faps[0]].max, &amount))
            return -1;
        for (size_t i = 0; i < count; i++)
            pose_add(out, faps[i], amount);
    }
    return 0;
}

static int read_key(const struct json_place *at, struct expression *x) {
    static const char *const keys[] = {"at", "pose", NULL};
    struct json_place when = json_place_key(at, "at"), pose = json_place_key(at, "pose");
    x->keys = mem_resize(x->keys, (x->key_count + 1) * sizeof *x->keys);
    struct gesture_key *key = &x->keys[x->key_count++];
    *key = (struct gesture_key){0};
    if (json_place_keys(at, keys) || json_place_real(&when, -SECONDS_MAX, SECONDS_MAX, &key->at) ||
        read_pose(&pose, &key->pose))
        return -1;
    if (x->key_count > 1 && !(key->at >= key[-1].at + SECONDS_MIN - 1e-9))
        return json_place_fail(&when, "must be at least %g after the previous one", SECONDS_MIN);
    return 0;
}

static int read_gesture(const struct json_place *at, struct expression *x) {
    static const char *const allowed[] = {"anchor", "keys", NULL}, *const anchors[] = {"start", "end", NULL};
    struct json_place anchor = json_place_key(at, "anchor"), keys = json_place_key(at, "keys");
    size_t choice = ANCHOR_START;
    if (!at->json)
        return 0;
    if (json_place_keys(at, allowed) || (anchor.json && json_place_choice(&anchor, anchors, &choice)) ||
        json_place_array(&keys))
        return -1;
    x->anchor = (enum gesture_anchor)choice;
    size_t count = json_array_size(keys.json);
    if (count < 3)
        return json_place_fail(&keys, "must have at least three keys");
    for (size_t i = 0; i < count; i++) {
        struct json_place key = json_place_item(&keys, i);
        if (read_key(&key, x))
            return -1;
        if ((i == 0 || i + 1 == count) && x->keys[i].pose.count)
            return json_place_fail(&key, "the first and the last key must be at rest");
    }
    return 0;
}

static int read_basic(const struct json_place *at, struct expression *x) {
    static const char *const names[] = {"joy", "sadness", "anger", "fear", "disgust", "surprise", NULL};
    size_t choice;
    if (!at->json)
        return 0;
    if (strcmp(x->kind, "affect") != 0)
        return json_place_fail(at, "only an affect can be a basic emotion");
    if (json_place_choice(at, names, &choice))
        return -1;
    x->basic = (uint8_t)(choice + 1);
    x->basics[x->basic] = 1;
    return 0;
}

void expression_begin(struct expression *x, const char *kind) {
    *x = (struct expression){.kind = kind,
                             .curve = {.attack = 0.3, .sustain = 1, .settle = 1, .decay = 0.4},
                             .mouth = {0.3, 0.7},
                             .articulation = 1,
                             .voice = {.rate = 1, .pitch = 1, .range = 1, .volume = 1},
                             .life = {1, 1, 1}};
}

/* Fills *x (begun, with its name) from its object, except for its mixture. Returns -1 with the root's
 * error; *x may be freed in any case. */
static int entry_read(const struct json_place *at, struct expression *x) {
    static const char *const allowed[] = {"aliases", "basic",     "activation", "evaluation", "mix",
                                          "pose",    "asymmetry", "curve",      "mouth",      "articulation",
                                          "voice",   "quality",   "life",       "gesture",    NULL};
    const struct number curve[] = {
        {"attack", SECONDS_MIN, SECONDS_MAX, &x->curve.attack}, {"hold", 0, SECONDS_MAX, &x->curve.hold},
        {"settle", SECONDS_MIN, SECONDS_MAX, &x->curve.settle}, {"sustain", 0, 1, &x->curve.sustain},
        {"decay", SECONDS_MIN, SECONDS_MAX, &x->curve.decay},   {0}};
    const struct number mouth[] = {{"lips", 0, 1, &x->mouth.lips}, {"corners", 0, 1, &x->mouth.corners}, {0}};
    const struct number voice[] = {{"rate", 0.5, 2, &x->voice.rate},
                                   {"pitch", 0.5, 2, &x->voice.pitch},
                                   {"range", 0.2, 3, &x->voice.range},
                                   {"volume", 0.2, 2, &x->voice.volume},
                                   {0}};
    struct score_quality *q = &x->voice.quality;
    const struct number quality[] = {{"tilt", -QUALITY_TILT_MAX, QUALITY_TILT_MAX, &q->tilt},
                                     {"aspiration", 0, 1, &q->aspiration},
                                     {"jitter", 0, QUALITY_JITTER_MAX, &q->jitter},
                                     {"shimmer", 0, QUALITY_SHIMMER_MAX, &q->shimmer},
                                     {"flutter", 0, QUALITY_FLUTTER_MAX, &q->flutter},
                                     {"tremor", 0, QUALITY_TREMOR_MAX, &q->tremor},
                                     {0}};
    const struct number life[] = {{"blink_rate", 0.1, 4, &x->life.blink_rate},
                                  {"blink_length", 0.5, 3, &x->life.blink_length},
                                  {"motion", 0, 3, &x->life.motion},
                                  {0}};
    struct json_place aliases = json_place_key(at, "aliases"), basic = json_place_key(at, "basic"),
                      pose = json_place_key(at, "pose"), gesture = json_place_key(at, "gesture"),
                      mix = json_place_key(at, "mix");
    if (json_place_keys(at, allowed) || (aliases.json && json_place_texts(&aliases, &x->aliases)) ||
        read_basic(&basic, x) || read_pose(&pose, &x->pose) || read_gesture(&gesture, x) ||
        read_number(at, "activation", -1, 1, &x->activation) ||
        read_number(at, "evaluation", -1, 1, &x->evaluation) ||
        read_number(at, "articulation", 0.5, 1.5, &x->articulation) || read_numbers(at, "curve", curve) ||
        read_numbers(at, "mouth", mouth) || read_numbers(at, "voice", voice) ||
        read_numbers(at, "quality", quality) || read_numbers(at, "life", life))
        return -1;
    return mix.json && x->basic ? json_place_fail(&mix, "a basic emotion cannot be a mixture") : 0;
}

#define ASYMMETRY_MAX 0.5

const char *const expression_kinds[] = {
    "affect",       "performative", "certainty", "meta-cognitive", "belief-relation", "turn", "emphasis",
    "pitch-accent", "boundary",     "deictic",   "adjectival",     "signal",          NULL};

static const char *const root_keys[] = {
    "sources",  "affect",       "performative", "certainty", "meta-cognitive", "belief-relation", "turn",
    "emphasis", "pitch-accent", "boundary",     "deictic",   "adjectival",     "signal",          NULL};

static int read_kind(const struct json_place *at, const char *kind, struct expressions *all) {
    const char *name;
    json_t *value;
    if (json_place_object(at))
        return -1;
    json_object_foreach(at->json, name, value) {
        struct json_place entry = json_place_key(at, name);
        if (!*name)
            return json_place_fail(at, "an entry has no name");
        if (all->count == EXPRESSIONS_MAX)
            return json_place_fail(&entry, "is one too many: the limit is %d entries", EXPRESSIONS_MAX);
        if (!strcmp(kind, "affect") && all->count == AFFECTS_MAX)
            return json_place_fail(&entry, "is one too many: the limit is %d affects", AFFECTS_MAX);
        all->items = mem_grow(all->items, &all->cap, all->count + 1, sizeof *all->items);
        struct expression *x = &all->items[all->count++];
        expression_begin(x, kind);
        x->name = mem_strdup(name);
        if (entry_read(&entry, x))
            return -1;
    }
    return 0;
}

static int sort_names(const struct json_place *root, struct expressions *all) {
    const struct expression_name *taken;
    if (!expressions_sort_names(all, &taken))
        return 0;
    struct json_place kind = json_place_key(root, taken->kind),
                      entry = json_place_key(&kind, all->items[taken->index].name);
    return json_place_fail(&entry, "the name '%s' occurs twice", taken->name);
}

/* Resolves references to other entries. */
static int finish_entry(const struct json_place *entry, struct expressions *all, struct expression *x) {
    double asymmetry = 0;
    struct json_place uneven = json_place_key(entry, "asymmetry");
    if (mix_read(entry, all, x))
        return -1;
    if (uneven.json && json_place_real(&uneven, -ASYMMETRY_MAX, ASYMMETRY_MAX, &asymmetry))
        return -1;
    pose_complete(&x->pose, false);
    pose_unbalance(&x->pose, asymmetry);
    for (size_t i = 0; i < x->key_count; i++)
        pose_complete(&x->keys[i].pose, false);
    return 0;
}

static int read_all(const struct json_place *root, struct expressions *all) {
    struct json_place sources = json_place_key(root, "sources");
    char **texts;
    if (json_place_keys(root, root_keys) || json_place_texts(&sources, &texts))
        return -1;
    json_texts_free(texts);
    for (const char *const *kind = expression_kinds; *kind; kind++) {
        struct json_place at = json_place_key(root, *kind);
        if (at.json && read_kind(&at, *kind, all))
            return -1;
    }
    if (!all->count)
        return json_place_fail(root, "there is no entry");
    if (sort_names(root, all))
        return -1;
    /* Mixtures are computed before their ingredients are completed with outer lips and gaze. */
    for (int mixed = 1; mixed >= 0; mixed--) {
        for (size_t i = 0; i < all->count; i++) {
            struct expression *x = &all->items[i];
            struct json_place kind = json_place_key(root, x->kind), entry = json_place_key(&kind, x->name);
            if ((json_object_get(entry.json, "mix") != NULL) == mixed && finish_entry(&entry, all, x))
                return -1;
        }
    }
    return 0;
}

static void list_affects(struct expressions *all) {
    struct affect *list = NULL;
    size_t cap = 0;
    for (size_t i = 0; i < all->count; i++) {
        const struct expression *x = &all->items[i];
        if (strcmp(x->kind, "affect") != 0)
            continue;
        list = mem_grow(list, &cap, all->affects.count + 1, sizeof *list);
        list[all->affects.count++] =
            (struct affect){x->name, x->aliases, x->activation, x->evaluation, x->basic != 0};
    }
    all->affects.items = list;
}

struct expressions *expressions_load(const char *path, struct error *e) {
    struct json_place root;
    if (json_place_load(path, ERROR_BAD_EXPRESSIONS, &root, e))
        return NULL;
    struct expressions *all = mem_alloc(sizeof *all);
    if (read_all(&root, all)) {
        expressions_free(all);
        all = NULL;
    } else {
        list_affects(all);
    }
    json_decref(root.json);
    return all;
}

void expression_free(struct expression *x) {
    free(x->name);
    json_texts_free(x->aliases);
    pose_free(&x->pose);
    for (size_t i = 0; i < x->key_count; i++)
        pose_free(&x->keys[i].pose);
    free(x->keys);
}

const struct expressions *expressions_share(const struct expressions *shared) {
    struct expressions *all = (struct expressions *)shared; /* only the reference count changes */
    if (all)
        atomic_fetch_add(&all->others, 1);
    return shared;
}

void expressions_free(const struct expressions *shared) {
    struct expressions *all = (struct expressions *)shared;
    if (!all || atomic_fetch_sub(&all->others, 1))
        return;
    for (size_t i = 0; i < all->count; i++)
        expression_free(&all->items[i]);
    free(all->items);
    free(all->names);
    free((void *)all->affects.items);
    free(all);
}

const struct affects *expressions_affects(const struct expressions *all) {
    return &all->affects;
}

size_t expressions_count(const struct expressions *all) {
    return all->count;
}

const struct expression *expressions_at(const struct expressions *all, size_t index) {
    return &all->items[index];
}

struct expression_info expressions_info(const struct expressions *all, size_t index) {
    const struct expression *x = &all->items[index];
    return (struct expression_info){x->kind, x->name, x->activation, x->evaluation, x->basic != 0};
}

static int by_name(const void *a, const void *b) {
    const struct expression_name *x = a, *y = b;
    int kinds = strcmp(x->kind, y->kind);
    return kinds ? kinds : strcasecmp(x->name, y->name);
}

static int by_name_and_index(const void *a, const void *b) {
    const struct expression_name *x = a, *y = b;
    int names = by_name(a, b);
    return names ? names : (x->index > y->index) - (x->index < y->index);
}

static void add_name(struct expressions *all, size_t index, const char *name) {
    all->names = mem_grow(all->names, &all->name_cap, all->name_count + 1, sizeof *all->names);
    all->names[all->name_count++] = (struct expression_name){all->items[index].kind, name, index};
}

int expressions_sort_names(struct expressions *all, const struct expression_name **taken) {
    all->name_count = 0;
    for (size_t i = 0; i < all->count; i++) {
        add_name(all, i, all->items[i].name);
        for (char **alias = all->items[i].aliases; alias && *alias; alias++)
            add_name(all, i, *alias);
    }
    qsort(all->names, all->name_count, sizeof *all->names, by_name_and_index);
    for (size_t i = 1; i < all->name_count; i++) {
        *taken = &all->names[i];
        if (!by_name(&all->names[i - 1], *taken))
            return -1;
    }
    return 0;
}

struct suggestions expressions_near(const struct expressions *all, const char *kind, const char *name) {
    struct suggestions near = suggestions_for(name);
    bool gesture = !strcmp(kind, EXPRESSION_GESTURE);
    for (size_t i = 0; i < all->name_count; i++)
        if (!strcmp(all->names[i].kind, kind) || (gesture && !strcmp(all->names[i].kind, "signal")))
            suggest_name(&near, all->names[i].name, all->names[i].name);
    return near;
}

int expressions_find(const struct expressions *all, const char *kind, const char *name) {
    struct expression_name wanted[] = {{kind, name, 0}, {kind, EXPRESSION_ANY, 0}};
    for (int i = 0; i < 2; i++) {
        const struct expression_name *found =
            bsearch(&wanted[i], all->names, all->name_count, sizeof wanted[i], by_name);
        if (found)
            return (int)found->index;
    }
    return strcmp(kind, EXPRESSION_GESTURE) ? -1 : expressions_find(all, "signal", name);
}
