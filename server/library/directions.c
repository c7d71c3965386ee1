/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/directions.h"
#include "server/base/etag.h"
#include "server/base/json/json_place.h"
#include "server/base/mem.h"
#include "server/library/words.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

struct entry {
    char word[WORD_BYTES_MAX]; /* folded; without the asterisk */
    bool any_ending;
    char *affect;
};

struct directions {
    struct {
        struct entry *list;
        size_t count, cap;
    } languages[STEM_LANGUAGES];
    uint64_t hash;
};

static int read_words(struct directions *d, size_t language, const struct json_place *root,
                      const char *affect) {
    struct json_place words = json_place_key(root, affect);
    if (json_place_array(&words))
        return -1;
    for (size_t i = 0; i < json_array_size(words.json); i++) {
        struct json_place item = json_place_item(&words, i);
        struct word word;
        const char *text;
        size_t at = 0;
        if (json_place_text(&item, &text))
            return -1;
        size_t size = strlen(text);
        bool any_ending = text[size - 1] == '*';
        if (!words_next(text, size, language == 2, &at, &word) || word.from || word.to != size - any_ending)
            return json_place_fail(&item, "must be one word, perhaps with an asterisk at its end");
        d->languages[language].list = mem_grow(d->languages[language].list, &d->languages[language].cap,
                                               d->languages[language].count + 1, sizeof(struct entry));
        struct entry *entry = &d->languages[language].list[d->languages[language].count++];
        *entry = (struct entry){.any_ending = any_ending, .affect = mem_strdup(affect)};
        snprintf(entry->word, sizeof entry->word, "%s", word.folded);
        d->hash = hash_add(d->hash, text, size);
    }
    d->hash = hash_add(d->hash, affect, strlen(affect));
    return 0;
}

struct directions *directions_load(const char *folder, struct error *e) {
    struct directions *d = mem_alloc(sizeof *d);
    d->hash = HASH_BEGIN;
    for (size_t i = 0; folder && i < STEM_LANGUAGES; i++) {
        struct json_place root;
        const char *affect;
        json_t *value;
        char path[4096];
        int result;
        snprintf(path, sizeof path, "%s/%s.json", folder, stems_language(i));
        if (access(path, F_OK))
            continue;
        result = json_place_load(path, ERROR_BAD_EXPRESSIONS, &root, e) || json_place_object(&root) ? -1 : 0;
        if (!result)
            json_object_foreach(root.json, affect, value) result =
                result || read_words(d, i, &root, affect) ? -1 : 0;
        json_decref(root.json);
        if (result) {
            directions_free(d);
            return NULL;
        }
    }
    return d;
}

void directions_free(struct directions *d) {
    for (size_t i = 0; d && i < STEM_LANGUAGES; i++) {
        for (size_t k = 0; k < d->languages[i].count; k++)
            free(d->languages[i].list[k].affect);
        free(d->languages[i].list);
    }
    free(d);
}

uint64_t directions_hash(const struct directions *d) {
    return d ? d->hash : 0;
}

const char *directions_affect(const struct directions *d, const char *lang, const char *text, size_t size) {
    size_t language = 0;
    struct word word;
    while (d && language < STEM_LANGUAGES && strncasecmp(lang, stems_language(language), 2) != 0)
        language++;
    if (!d || language == STEM_LANGUAGES)
        return NULL;
    for (size_t at = 0; words_next(text, size, language == 2, &at, &word);)
        for (size_t i = 0; i < d->languages[language].count; i++) {
            const struct entry *entry = &d->languages[language].list[i];
            if (entry->any_ending ? !strncmp(word.folded, entry->word, strlen(entry->word))
                                  : !strcmp(word.folded, entry->word))
                return entry->affect;
        }
    return NULL;
}

void direction_mood_follow(struct direction_mood *m, const struct directions *directions,
                           const struct block *b) {
    const char *lang = b->lang ? b->lang : m->lang, *text = b->text.size ? (const char *)b->text.data : "",
               *found;
    m->who[0] = '\0';
    if (b->kind == BLOCK_SPEAKER || b->kind == BLOCK_HEAD) {
        m->affect = NULL;
        m->speaks[0] = '\0';
    } else if (b->kind == BLOCK_STAGE) {
        found = directions_affect(directions, lang, text, b->text.size);
        m->affect = found ? found : m->affect;
    } else if (cast_id_of_block(b, m->who)) {
        if (*m->speaks && strcmp(m->speaks, m->who) != 0)
            m->affect = NULL;
        memcpy(m->speaks, m->who, sizeof m->speaks);
        for (size_t i = 0; i < b->mark_count; i++)
            if (b->marks[i].kind == MARK_STAGE && b->marks[i].end <= b->text.size &&
                (found = directions_affect(directions, lang, text + b->marks[i].start,
                                           b->marks[i].end - b->marks[i].start))) {
                m->affect = found;
                break;
            }
    }
}
