/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Old spellings of a language, rewritten as they are spelled today (models/normalization/spelling). */
#include "server/base/etag.h"
#include "server/base/json/json_place.h"
#include "server/base/mem.h"
#include "server/library/words.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RULES_MAX = 200, PART_BYTES = 24 };

/* Replaces a part of a word. */
struct rule {
    char from[PART_BYTES], to[PART_BYTES];
    bool begins, ends; /* only at the beginning, or at the end, of a word */
};

struct language {
    json_t *words, *keep; /* whole words, and their spelling of today; words that no rule changes */
    struct rule *rules;
    size_t count;
};

struct spellings {
    struct language languages[STEM_LANGUAGES];
    uint64_t hash;
};

static int read_rule(const struct json_place *at, struct rule *rule) {
    const char *texts[2];
    if (json_place_array(at))
        return -1;
    if (json_array_size(at->json) != 2)
        return json_place_fail(at, "must be a part of a word and what replaces it");
    for (size_t i = 0; i < 2; i++) {
        struct json_place item = json_place_item(at, i);
        texts[i] = json_string_value(item.json);
        if (!texts[i] || (!i && !*texts[i]) || strlen(texts[i]) >= PART_BYTES)
            return json_place_fail(&item, "must be a string of less than %d bytes", PART_BYTES);
    }
    size_t size = strlen(texts[0]);
    rule->begins = texts[0][0] == '^';
    rule->ends = size > 1 && texts[0][size - 1] == '$';
    snprintf(rule->from, sizeof rule->from, "%.*s", (int)(size - rule->begins - rule->ends),
             texts[0] + rule->begins);
    snprintf(rule->to, sizeof rule->to, "%s", texts[1]);
    return *rule->from ? 0 : json_place_fail(at, "names no letter");
}

static int read_language(struct language *l, const struct json_place *root) {
    static const char *const keys[] = {"words", "keep", "rules", NULL};
    struct json_place words = json_place_key(root, "words"), keep = json_place_key(root, "keep"),
                      rules = json_place_key(root, "rules");
    const char *key, *text;
    json_t *value;
    if (json_place_keys(root, keys) || json_place_object(&words) || json_place_array(&keep) ||
        json_place_array(&rules))
        return -1;
    json_object_foreach(words.json, key, value) {
        struct json_place word = json_place_key(&words, key);
        if (json_place_text(&word, &text))
            return -1;
    }
    l->words = json_incref(words.json);
    l->keep = json_object();
    for (size_t i = 0; i < json_array_size(keep.json); i++) {
        struct json_place word = json_place_item(&keep, i);
        if (json_place_text(&word, &text))
            return -1;
        json_object_set_new(l->keep, text, json_true());
    }
    l->count = json_array_size(rules.json);
    if (l->count > RULES_MAX)
        return json_place_fail(&rules, "has more than %d rules", RULES_MAX);
    l->rules = mem_alloc((l->count + 1) * sizeof *l->rules);
    for (size_t i = 0; i < l->count; i++) {
        struct json_place rule = json_place_item(&rules, i);
        if (read_rule(&rule, &l->rules[i]))
            return -1;
    }
    return 0;
}

struct spellings *spellings_load(const char *folder, struct error *e) {
    struct spellings *s = mem_alloc(sizeof *s);
    s->hash = HASH_BEGIN;
    for (size_t i = 0; folder && i < STEM_LANGUAGES; i++) {
        struct json_place root;
        char path[4096];
        snprintf(path, sizeof path, "%s/%s.json", folder, stems_language(i));
        if (access(path, F_OK))
            continue;
        if (json_place_load(path, ERROR_BAD_NORMALIZATION, &root, e))
            goto failed;
        int result = read_language(&s->languages[i], &root);
        char *text = json_dumps(root.json, JSON_COMPACT | JSON_SORT_KEYS);
        s->hash = hash_add(s->hash, text, text ? strlen(text) : 0);
        free(text);
        json_decref(root.json);
        if (result)
            goto failed;
    }
    return s;
failed:
    spellings_free(s);
    return NULL;
}

void spellings_free(struct spellings *s) {
    for (size_t i = 0; s && i < STEM_LANGUAGES; i++) {
        json_decref(s->languages[i].words);
        json_decref(s->languages[i].keep);
        free(s->languages[i].rules);
    }
    free(s);
}

uint64_t spellings_hash(const struct spellings *s) {
    return s ? s->hash : 0;
}

/* Replaces the rule's part wherever it stands in the word. Returns false if the result is too long. */
static bool apply(const struct rule *rule, char word[WORD_BYTES_MAX]) {
    char out[WORD_BYTES_MAX];
    size_t size = strlen(word), from = strlen(rule->from), to = strlen(rule->to), at = 0, length = 0;
    while (at < size) {
        bool here = !strncmp(word + at, rule->from, from) && (!rule->begins || at == 0) &&
                    (!rule->ends || at + from == size);
        size_t take = here ? from : 1, put = here ? to : 1;
        if (length + put >= sizeof out)
            return false;
        memcpy(out + length, here ? rule->to : word + at, put);
        length += put;
        at += take;
    }
    out[length] = '\0';
    memcpy(word, out, length + 1);
    return true;
}

bool spellings_modern(const struct spellings *s, size_t language, const char *lower,
                      char out[WORD_BYTES_MAX]) {
    const struct language *l = s && language < STEM_LANGUAGES ? &s->languages[language] : NULL;
    const char *known = l ? json_string_value(json_object_get(l->words, lower)) : NULL;
    if (!l || !l->rules || json_object_get(l->keep, lower) || strlen(lower) >= WORD_BYTES_MAX)
        return false;
    snprintf(out, WORD_BYTES_MAX, "%.*s", WORD_BYTES_MAX - 1, known ? known : lower);
    for (size_t i = 0; !known && i < l->count; i++)
        if (!apply(&l->rules[i], out))
            return false;
    return *out && strcmp(out, lower) != 0;
}
